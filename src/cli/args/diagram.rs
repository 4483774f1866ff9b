//! Arguments of `nullray diagram`.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;

use super::values;

#[derive(Debug, Args)]
pub struct DiagramArguments {
    /// The scene file (TOML), with a [diagram] table or without. Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Where to write: .svg, .pdf, .png, or .apng (a PNG that moves). Repeatable. Default: the scene's
    /// name with .svg, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Draw in the coordinates of this frame: "world", "camera", or one of the file's; with --pixel also the
    /// object that is seen.
    #[arg(long, value_name = "NAME")]
    pub frame: Option<String>,
    /// Boost the view to this frame step by step, picture by picture.
    #[arg(long, value_name = "NAME")]
    pub boost_to: Option<String>,
    /// Pictures A to B of the animation, B not included, as numbered files ("name-####.svg"); an .apng
    /// holds these alone.
    #[arg(long, value_name = "A..B", value_parser = values::frames, allow_hyphen_values = true)]
    pub frames: Option<Range<u64>>,
    /// Pictures per second in an .apng. Default: diagram.animation.fps.
    #[arg(long, value_name = "N", value_parser = values::rate, allow_hyphen_values = true)]
    pub fps: Option<f64>,
    /// Show ct and one direction of space, or two: "1+1" or "2+1".
    #[arg(long, value_name = "D", value_parser = ["1+1", "2+1"])]
    pub dimensions: Option<String>,
    /// Light on dark.
    #[arg(long)]
    pub dark: bool,
    /// Pixels of a point (1/72 inch) in a .png.
    #[arg(long, value_name = "N", default_value_t = 3.0, value_parser = values::scale)]
    pub scale: f64,
    /// Width and height of the page, points.
    #[arg(long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// Change a key of the file: --set "diagram.frame.S'.velocity=0.8". Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = values::assignment)]
    pub set: Vec<(String, String)>,
    /// The camera's proper time of the shot, with its unit: "3.2 m" or "12 ns".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub time: Option<String>,
    /// Draw this panel of the scene; the scene as it stands without it.
    #[arg(long, value_name = "NAME")]
    pub panel: Option<String>,
    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
    #[command(flatten)]
    pub pixel: PixelArguments,
}

/// From a picture to its diagram.
#[derive(Debug, Args)]
#[command(next_help_heading = "From a pixel")]
pub struct PixelArguments {
    /// Trace the centre of the pixel in column J and row I (from the top left, from 0), and draw its light: from
    /// where and when it comes, and where its source is now. Loads the scene's geometry, but no cubes and textures.
    #[arg(long, value_name = "J,I", value_parser = values::pixel, allow_hyphen_values = true)]
    pub pixel: Option<[u32; 2]>,
    /// Width and height of the picture that --pixel counts in. Default: the scene's.
    #[arg(long, value_name = "WxH", requires = "pixel", value_parser = values::size, allow_hyphen_values = true)]
    pub image_size: Option<[u32; 2]>,
    /// Print the numbers of the pixel as JSON, and nothing else.
    #[arg(long, requires = "pixel")]
    pub json: bool,
    /// The most memory that the geometry may take.
    #[arg(long, value_name = "SIZE", default_value = "16GiB", requires = "pixel", value_parser = values::bytes)]
    pub max_memory: u64,
}
