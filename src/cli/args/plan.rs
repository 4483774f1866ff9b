//! `nullray plan`.

use clap::Args;

use super::render::ModelArguments;
use super::shared::{ChannelArguments, Json, LineArguments, MethodArgument, SceneArguments};

#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    #[command(flatten)]
    pub channels: ChannelArguments,
    #[command(flatten)]
    pub method: MethodArgument,
    /// Plan pictures with overlays, too.
    #[arg(long)]
    pub overlay: bool,
    #[command(flatten)]
    pub lines: LineArguments,
    #[command(flatten)]
    pub json: Json,
    // Last, because options that follow would appear under its heading.
    #[command(flatten)]
    pub model: ModelArguments,
}
