//! `nullray sheet`.

use std::path::PathBuf;

use clap::Args;

use super::shared::{Changes, ExposureArgument, WorkArguments};

#[derive(Debug, Args)]
pub struct SheetArguments {
    /// The scene files (TOML), with panels or without.
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub changes: Changes,
    /// Where to write the page of one scene. Default: the scene's name with -sheet.png, in the current
    /// directory.
    #[arg(short, long, value_name = "FILE.png", conflicts_with = "directory")]
    pub output: Option<PathBuf>,
    /// Directory for all pages; created if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub directory: Option<PathBuf>,
    #[command(flatten)]
    pub exposure: ExposureArgument,
    /// Also write each panel beside its page, named after the scene and the panel.
    #[arg(long)]
    pub keep_panels: bool,
    #[command(flatten)]
    pub work: WorkArguments,
}
