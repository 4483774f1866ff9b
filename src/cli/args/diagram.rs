//! `nullray diagram`.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;

use super::shared::{Edits, FileAccess, MemoryLimit, PanelArgument, Quiet, ScenePath};
use crate::cli::values;

#[derive(Debug, Args)]
pub struct DiagramArguments {
    #[command(flatten)]
    pub scene: ScenePath,
    /// Where to write: .svg, .pdf, .png, .tex (TikZ, for \input), .apng (animated PNG), .y4m (raw video), or - for .y4m
    /// on standard output. Repeatable. Default: the scene's name with .svg, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Keep text in .svg and .pdf as text that can be searched and edited: an .svg uses the viewer's fonts, a .pdf embeds
    /// its own. Default: outlines, which look the same everywhere.
    #[arg(long)]
    pub text: bool,
    /// Draw in the coordinates of this frame: "world", "camera", or one of the file's; with --pixel also the
    /// object that is seen.
    #[arg(long, value_name = "NAME")]
    pub frame: Option<String>,
    /// Boost the view to this frame step by step, picture by picture.
    #[arg(long, value_name = "NAME")]
    pub boost_to: Option<String>,
    /// Pictures A to B of the animation, B not included, as numbered files ("name-####.svg"); a film
    /// holds only these.
    #[arg(long, value_name = "A..B", value_parser = values::frames, allow_hyphen_values = true)]
    pub frames: Option<Range<u64>>,
    /// Pictures per second of a film when it is played; also --fps. Default: diagram.animation.fps.
    #[arg(long = "play-fps", alias = "fps", value_name = "N", value_parser = values::film_rate, allow_hyphen_values = true)]
    pub fps: Option<f64>,
    /// Show ct and one direction of space, or two: "1+1" or "2+1".
    #[arg(long, value_name = "D", value_parser = ["1+1", "2+1"])]
    pub dimensions: Option<String>,
    /// Draw in light colours on a dark page.
    #[arg(long)]
    pub dark: bool,
    /// Pixels per point (1/72 inch) in a .png.
    #[arg(long, value_name = "N", default_value_t = 3.0, value_parser = values::scale, allow_negative_numbers = true)]
    pub scale: f64,
    /// Width and height of the page, points.
    #[arg(long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    #[command(flatten)]
    pub edits: Edits,
    #[command(flatten)]
    pub panel: PanelArgument,
    #[command(flatten)]
    pub quiet: Quiet,
    #[command(flatten)]
    pub pixel: PixelArguments,
}

/// The diagram of a pixel of the picture.
#[derive(Debug, Args)]
#[command(
    next_help_heading = "From a pixel",
    mut_arg("max_memory", |arg| arg.requires("pixel")),
    mut_arg("allow_outside", |arg| arg.requires("pixel"))
)]
pub struct PixelArguments {
    /// Probe the pixel in column J and row I, counted from 0 at the top left: trace its centre, and draw where and when its
    /// light was emitted, and where its source is now. Loads the scene's geometry, but no cubes and textures.
    #[arg(long, value_name = "J,I", value_parser = values::pixel, allow_hyphen_values = true)]
    pub pixel: Option<[u32; 2]>,
    /// Width and height of the picture whose pixels --pixel counts. Default: the scene's.
    #[arg(long, value_name = "WxH", requires = "pixel", value_parser = values::size, allow_hyphen_values = true)]
    pub image_size: Option<[u32; 2]>,
    /// Where the coordinates of the diagram are 0: where the camera sees the light, or where it was emitted. Default: at the origin of
    /// the frame.
    #[arg(long, value_name = "WHERE", requires = "pixel")]
    pub origin: Option<Origin>,
    /// Print the numbers of the pixel as JSON, and nothing else.
    #[arg(long, requires = "pixel")]
    pub json: bool,
    #[command(flatten)]
    pub memory: MemoryLimit,
    #[command(flatten)]
    pub files: FileAccess,
}

/// An end of the light ray to a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Origin {
    /// Where the camera sees it.
    Camera,
    /// Where it was emitted.
    Object,
}
