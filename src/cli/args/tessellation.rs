//! `nullray tessellation`.

use clap::Args;

use super::shared::{Json, SceneArguments, WorkArguments};
use crate::cli::values;

#[derive(Debug, Args)]
pub struct TessellationArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Largest allowed distance of drawn points from their true positions, pixels.
    #[arg(long, value_name = "N", default_value_t = 0.5, value_parser = values::pixels, allow_hyphen_values = true)]
    pub pixels: f64,
    #[command(flatten)]
    pub json: Json,
    #[command(flatten)]
    pub work: WorkArguments,
}
