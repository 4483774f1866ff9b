//! `nullray page`.

use std::path::PathBuf;

use clap::Args;
use nullray::scene::Heading;
use nullray::spacetime::units::Time;

use super::shared::{Changes, ExposureArgument, ScenePath, WorkArguments};
use crate::cli::values;

#[derive(Debug, Args)]
pub struct PageArguments {
    #[command(flatten)]
    pub scene: ScenePath,
    /// The directory for index.html; created if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// The greatest speed v/c of the slider.
    #[arg(
        long,
        value_name = "BETA",
        default_value_t = 0.9,
        value_parser = values::speed,
        allow_negative_numbers = true
    )]
    pub beta: f64,
    /// Number of speeds on the slider, from 0 in equal steps of rapidity.
    #[arg(long, value_name = "N", default_value_t = 13, value_parser = clap::value_parser!(u32).range(2..=200), allow_negative_numbers = true)]
    pub steps: u32,
    /// Where the camera moves to: x, y, z, -x, -y, -z or a vector like 1,0,-1. Default: ahead.
    #[arg(long, value_name = "DIRECTION", value_parser = values::heading, allow_hyphen_values = true)]
    pub direction: Option<Heading>,
    /// Add a second slider, for the camera's time, that starts here …
    #[arg(
        long,
        value_name = "TIME",
        requires = "to",
        conflicts_with = "time",
        allow_hyphen_values = true
    )]
    pub from: Option<Time>,
    /// … and ends here; both are among its times.
    #[arg(
        long,
        value_name = "TIME",
        requires = "from",
        conflicts_with = "time",
        allow_hyphen_values = true
    )]
    pub to: Option<Time>,
    /// Number of camera times on the second slider.
    #[arg(long, value_name = "N", default_value_t = 9, requires = "from", conflicts_with = "time", value_parser = clap::value_parser!(u32).range(2..=200), allow_negative_numbers = true)]
    pub times: u32,
    /// Make a diagram for each pixel of a grid, columns x rows; a click on the picture shows it: 4x3.
    #[arg(long, value_name = "CxR", value_parser = values::grid, allow_hyphen_values = true)]
    pub grid: Option<[u32; 2]>,
    /// No space-time diagram beside the picture.
    #[arg(long)]
    pub no_diagram: bool,
    /// The heading. Default: the scene's name.
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Words beneath the heading.
    #[arg(long, value_name = "TEXT")]
    pub text: Option<String>,
    #[command(flatten)]
    pub exposure: ExposureArgument,
    /// Maximum size of the page, megabytes.
    #[arg(long, value_name = "MB", default_value_t = 10.0, value_parser = values::not_negative, allow_negative_numbers = true)]
    pub max_size: f64,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub work: WorkArguments,
}
