//! `nullray film`.

use std::path::PathBuf;

use clap::{Arg, Args};
use nullray::scene::Heading;
use nullray::spacetime::units::Time;

use super::shared::{Changes, ExposureArgument, ScenePath, WorkArguments};
use crate::cli::values;

#[derive(Debug, Args)]
#[command(arg = Arg::new("frames").long("frames").hide(true).allow_hyphen_values(true).value_parser(frames_of_film))]
#[command(mut_arg("time", |time| time.help("The time of the scene's own camera, by its clock, when --flyby passes its place, or when --accelerate or --speeds begin: \"3.2 m\" or \"12 ns\"")))]
pub struct FilmArguments {
    #[command(flatten)]
    pub scene: ScenePath,
    /// Where to write: .apng (animated PNG), .y4m (raw video), or - for raw video on standard output. Repeatable.
    /// Default: the scene's name with .apng, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Number of pictures in the film.
    #[arg(long, value_name = "N", default_value_t = 72, value_parser = clap::value_parser!(u32).range(2..=100_000), allow_negative_numbers = true)]
    pub pictures: u32,
    /// Pictures per second of the film when it is played; also --fps.
    #[arg(long = "play-fps", alias = "fps", value_name = "N", default_value_t = 24.0, value_parser = values::film_rate, allow_hyphen_values = true)]
    pub fps: f64,
    /// Beside each picture: what a camera at rest in the same place sees ("rest"), or the scene's space-time diagram in the
    /// camera's frame ("diagram", with --speeds).
    #[arg(long, value_name = "WHAT")]
    pub beside: Option<Beside>,
    /// Text before the speed or the time beneath each picture.
    #[arg(long, value_name = "TEXT")]
    pub caption: Option<String>,
    /// Nothing beneath the pictures.
    #[arg(long, conflicts_with = "caption")]
    pub no_captions: bool,
    #[command(flatten)]
    pub exposure: ExposureArgument,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub work: WorkArguments,
    // Last, because options that follow would appear under its heading.
    #[command(flatten)]
    pub motion: MotionArguments,
}

/// The motion of a film's camera.
#[derive(Debug, Args)]
#[command(next_help_heading = "Motions")]
pub struct MotionArguments {
    /// Pass the scene's camera position at this speed v/c. Halfway through the film, the point that the camera looks at
    /// is in the middle of the picture; because of aberration, that is long after the camera has passed it.
    #[arg(
        long,
        value_name = "BETA",
        group = "moves",
        value_parser = values::speed,
        allow_negative_numbers = true
    )]
    pub flyby: Option<f64>,
    /// Start at rest at the scene's camera position, and accelerate evenly to this speed v/c.
    #[arg(
        long,
        value_name = "BETA",
        group = "moves",
        value_parser = values::speed,
        allow_negative_numbers = true
    )]
    pub accelerate: Option<f64>,
    /// Stay at one place and moment, and show it at speeds from 0 to this v/c, in equal steps of rapidity.
    #[arg(
        long,
        value_name = "BETA",
        group = "moves",
        value_parser = values::speed,
        allow_negative_numbers = true
    )]
    pub speeds: Option<f64>,
    /// Keep the scene's own camera while light passes by.
    #[arg(long, group = "moves", conflicts_with = "time")]
    pub light: bool,
    /// Where the camera moves to: x, y, z, -x, -y, -z or a vector like 1,0,-1. Default: to its right for --flyby, else ahead.
    #[arg(long, value_name = "DIRECTION", value_parser = values::heading, allow_hyphen_values = true, conflicts_with = "light")]
    pub direction: Option<Heading>,
    /// How far the camera goes, with its unit: "6 m". Default: nine tenths of the way to the point that it looks at;
    /// for --flyby twice the distance to that point, times γ.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true, conflicts_with_all = ["light", "speeds"])]
    pub distance: Option<Time>,
    /// The camera's time at the first picture, with --light. Default: from when light comes into view until it has left,
    /// not counting light that lasts ten times as long as a flash.
    #[arg(long, value_name = "TIME", requires = "to", conflicts_with_all = ["flyby", "accelerate", "speeds"], allow_hyphen_values = true)]
    pub from: Option<Time>,
    /// The camera's time at the last picture, with --light (`render --to` ends before its time).
    #[arg(
        long,
        value_name = "TIME",
        requires = "from",
        conflicts_with_all = ["flyby", "accelerate", "speeds"],
        allow_hyphen_values = true
    )]
    pub to: Option<Time>,
}

/// Refuses the option that chooses the pictures of a sequence in other commands.
fn frames_of_film(said: &str) -> Result<u32, String> {
    Err(match said.parse::<u32>() {
        Ok(count) => format!("the number of a film's pictures is --pictures: --pictures {count}"),
        Err(_) => "a film is made whole; the number of its pictures is --pictures <N>".into(),
    })
}

/// A length in any unit of times: light takes a time for it.
fn length(text: &str) -> Result<Time, String> {
    let length = text.parse::<Time>();
    let length = length.map_err(|error| error.to_string().replace("a time", "a length"))?;
    // The sign does not depend on the speed of light.
    match length.metres(1.0) > 0.0 {
        true => Ok(length),
        false => Err("write a length above 0, like \"6 m\"".into()),
    }
}

/// What is shown beside the pictures of a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Beside {
    /// What a camera at rest sees.
    Rest,
    /// The space-time diagram.
    Diagram,
}

impl Beside {
    /// The name on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Beside::Rest => "rest",
            Beside::Diagram => "diagram",
        }
    }
}
