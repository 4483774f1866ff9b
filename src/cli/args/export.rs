//! `nullray export`.

use std::path::PathBuf;

use clap::Args;

use super::shared::{SceneArguments, WorkArguments};

#[derive(Debug, Args)]
pub struct ExportArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The directory to write. It appears once it is complete.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Render no reference pictures.
    #[arg(long)]
    pub no_reference: bool,
    /// Copy stored cubes, or only refer to them by path and SHA-256.
    #[arg(long, value_name = "WHAT", default_value = "copy")]
    pub cubes: CubesArgument,
    /// Also write test vectors, as JSON for unit tests in any language: up to 32 vertices of each object, the events at which they are
    /// seen, their film points and their wavelength ratios. Only for perspective cameras whose rays all leave one event.
    #[arg(long)]
    pub vectors: bool,
    /// Replace an export of this name.
    #[arg(long)]
    pub overwrite: bool,
    #[command(flatten)]
    pub work: WorkArguments,
}

/// What to do with stored cubes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum CubesArgument {
    /// Copied into the bundle.
    Copy,
    /// Named with their SHA-256.
    Reference,
}
