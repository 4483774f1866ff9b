//! The arguments. One definition makes the parser, the help, the man pages and the completions.

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::DVec3;
use nullray::Result;
use nullray::accel::Precision;
use nullray::approximate::raster::Method;
use nullray::figures::overlay::Parts;
use nullray::io::cube::{Axes, Transfer};
use nullray::render::aov::Aov;
use nullray::render::plan::Request;
use nullray::scene::model::{FovAxis, MOST_SAMPLES, Scene};
use nullray::scene::{Heading, ModelView, Overrides};
use nullray::spacetime::units::{Angle, Time};
use nullray::validate::compare::{Encoding, NotFinite, Tolerance};
use nullray::validate::study;

use super::values::{AovList, MethodList, SampleList};
use super::{help, memory, panels, values};

/// Reference renderer for special relativity and time-resolved light.
///
/// Without a command it renders the built-in scene.
#[derive(Debug, Parser)]
#[command(name = "nullray", version, max_term_width = 100, after_help = help::PROGRAM)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to pictures.
    #[command(after_help = help::RENDER, after_long_help = help::render_long())]
    Render(Box<RenderArguments>),
    /// Make a film of a scene in one line: a fly-by, an acceleration, a row of speeds, or light in flight.
    #[command(after_help = help::FILM)]
    Film(Box<FilmArguments>),
    /// Make a page of HTML with a slider for the speed of the camera, which needs no network.
    #[command(after_help = help::PAGE)]
    Page(Box<PageArguments>),
    /// Render the panels of scenes to contact sheets: one labelled page for each scene.
    #[command(after_help = help::SHEET)]
    Sheet(SheetArguments),
    /// Bake the light of pulsed lamps, with its delays and bounces, into cubes for [[source]]: of what rests relative to each other.
    #[command(after_help = help::BAKE)]
    Bake(BakeArguments),
    /// Draw the space-time diagram of a scene's world lines, or of a file's own [diagram].
    #[command(after_help = help::DIAGRAM)]
    Diagram(Box<DiagramArguments>),
    /// Write a scene as a bundle for other programs: geometry, camera, sources, reference pictures.
    #[command(after_help = help::EXPORT)]
    Export(ExportArguments),
    /// Convert a cube of time-resolved data: its format, axes, part, bins, precision, clock.
    #[command(after_help = help::CONVERT)]
    Convert(ConvertArguments),
    /// Make a mesh of what a capture camera measured: when light first came back, or distances, along its pixels' rays.
    #[command(after_help = help::MESH_FROM_DEPTH)]
    MeshFromDepth(MeshFromDepthArguments),
    /// Compare a picture with its reference: errors, maps, a report, tolerances.
    #[command(after_help = help::compare())]
    Compare(CompareArguments),
    /// Print what a render would load and compute, and what it skips and why, without loading anything heavy.
    #[command(after_help = help::PLAN)]
    Plan(PlanArguments),
    /// Predict how finely a rasterizer has to tessellate the objects of a scene.
    #[command(after_help = help::TESSELLATION)]
    Tessellation(TessellationArguments),
    /// Show what a glTF, npy, npz, ti, exr, png or scene file or a folder of pictures holds.
    #[command(after_help = help::INFO)]
    Info(InfoArguments),
    /// Test this build on this machine: numbers against arbitrary precision, rays against gaps.
    #[command(after_help = help::SELFTEST)]
    Selftest(SelftestArguments),
    /// Measure run time against error: ray tracer, rasterizers, warped pictures.
    #[command(after_help = help::STUDY)]
    Study(StudyArguments),
    /// Print the JSON schema of the scene file, for editors.
    Schema,
    /// Print completions for a shell.
    Completions {
        /// Which shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write one page per command into a directory.
    Man {
        /// Where to write nullray.1, nullray-render.1, …; created if it does not exist.
        #[arg(long, value_name = "DIR")]
        directory: Option<PathBuf>,
    },
}

/// A scene, or a panel of it, and what is changed of it.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// The scene file (TOML), or a model without a scene (.glb, .gltf). Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub changes: Changes,
    /// Take this panel of the scene. Default: the scene without its panels.
    #[arg(long, value_name = "NAME")]
    pub panel: Option<String>,
}

/// How the work is done.
#[derive(Debug, Args)]
pub struct WorkArguments {
    /// Worker threads. Default: one per core. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors and results that are asked for.
    #[arg(short, long)]
    pub quiet: bool,
}

/// The channels of a picture.
#[derive(Debug, Args)]
pub struct ChannelArguments {
    /// Auxiliary channels for .exr and .npz: "all", or a list of channels ("event.ct") and groups of
    /// them ("event").
    #[arg(long, value_name = "LIST", value_parser = values::aovs)]
    pub aovs: Option<AovList>,
}

/// What is changed of a scene.
#[derive(Debug, Args)]
pub struct Changes {
    /// Image size in pixels.
    #[arg(long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// Samples per pixel.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SAMPLES)))]
    pub spp: Option<u32>,
    /// The camera's proper time when the picture is taken, with its unit: "3.2 m" or "12 ns".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub time: Option<String>,
    /// The radiance that becomes white in a .png, as a percentile of the lit pixels: "95 %".
    #[arg(long, value_name = "PERCENT", conflicts_with = "white", value_parser = values::percentage)]
    pub exposure: Option<String>,
    /// The radiance that becomes white in a .png.
    #[arg(long, value_name = "RADIANCE", allow_negative_numbers = true)]
    pub white: Option<f64>,
    /// One sample per pixel, exactly at its centre.
    #[arg(long, visible_alias = "pixel-centres", conflicts_with = "spp")]
    pub pixel_centers: bool,
    /// Change a key of the scene file: --set "camera.velocity={beta=[0.5,0,0]}". Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = values::assignment)]
    pub set: Vec<(String, String)>,
    /// How visibility is computed: "certified" (as exact arithmetic would), or "fast" for previews (f32: rays may
    /// slip through edges, and surfaces at nearly equal depths may be confused).
    #[arg(long, value_name = "certified|fast", default_value = "certified", value_parser = values::precision)]
    pub precision: Precision,
    /// Memory limit, also --memory: cubes that do not fit are read from disk in parts. Default: three quarters of the machine's.
    #[arg(long, alias = "memory", value_name = "SIZE", value_parser = values::bytes)]
    pub max_memory: Option<u64>,
    /// Let glTF files refer to files outside their own folder and the scene's.
    #[arg(long)]
    pub allow_outside: bool,
}

/// Which moments are rendered, where they are many.
#[derive(Debug, Args)]
#[command(next_help_heading = "Sequences")]
pub struct FrameArguments {
    /// Frames A to B, B not included. Frame k is taken k intervals after the camera's time.
    #[arg(long, value_name = "A..B", value_parser = values::frames, group = "sequence", allow_hyphen_values = true)]
    pub frames: Option<Range<u64>>,
    /// The camera's proper time of frame 0. Frames follow until --to.
    #[arg(
        long,
        value_name = "TIME",
        group = "sequence",
        requires = "to",
        conflicts_with = "time",
        allow_hyphen_values = true
    )]
    pub from: Option<Time>,
    /// The camera's proper time at which the sequence ends; no frame is taken at it.
    #[arg(
        long,
        value_name = "TIME",
        requires = "from",
        conflicts_with = "frames",
        allow_hyphen_values = true
    )]
    pub to: Option<Time>,
    /// Frames per second of the camera's clock. Default: by the scene's camera.frame_interval.
    #[arg(
        long,
        value_name = "N",
        requires = "sequence",
        conflicts_with = "interval",
        value_parser = values::rate,
        allow_hyphen_values = true
    )]
    pub fps: Option<f64>,
    /// Camera time between frames, with its unit: "1 cm" or "40 ps".
    #[arg(
        long,
        value_name = "TIME",
        requires = "sequence",
        allow_hyphen_values = true
    )]
    pub interval: Option<Time>,
}

#[derive(Debug, Args)]
pub struct FilmArguments {
    /// The scene file (TOML), or a model without a scene (.glb, .gltf). Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub motion: MotionArguments,
    /// Where to write: .apng (animated PNG), .y4m (raw video), or - for raw video on standard output. Repeatable.
    /// Default: the scene's name with .apng, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Pictures of the film.
    #[arg(long, value_name = "N", default_value_t = 72, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub pictures: u32,
    /// Pictures per second.
    #[arg(long, value_name = "N", default_value_t = 24.0, value_parser = values::rate, allow_hyphen_values = true)]
    pub fps: f64,
    /// Beside each picture: what a camera at rest in the same place sees ("rest"), or the scene's space-time diagram in the
    /// camera's frame ("diagram", with --speeds).
    #[arg(long, value_name = "WHAT")]
    pub beside: Option<Beside>,
    /// Words in front of the speed or the time beneath each picture.
    #[arg(long, value_name = "TEXT")]
    pub caption: Option<String>,
    /// Nothing beneath the pictures.
    #[arg(long, conflicts_with = "caption")]
    pub no_captions: bool,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub work: WorkArguments,
}

/// How the camera of a film moves.
#[derive(Debug, Args)]
#[command(next_help_heading = "Motions")]
pub struct MotionArguments {
    /// Pass the scene's camera position at this speed v/c, which is reached in the middle of the film.
    #[arg(
        long,
        value_name = "BETA",
        group = "moves",
        allow_negative_numbers = true
    )]
    pub flyby: Option<f64>,
    /// Start at rest at the scene's camera position, and accelerate evenly to this speed v/c.
    #[arg(
        long,
        value_name = "BETA",
        group = "moves",
        allow_negative_numbers = true
    )]
    pub accelerate: Option<f64>,
    /// Stay at one place and moment, seen at speeds from 0 to this v/c in equal steps of rapidity.
    #[arg(
        long,
        value_name = "BETA",
        group = "moves",
        allow_negative_numbers = true
    )]
    pub speeds: Option<f64>,
    /// Leave the camera to its own motion while light passes by.
    #[arg(long, group = "moves")]
    pub light: bool,
    /// Where the camera moves to: x, y, z, -x, -y, -z or a vector like 1,0,-1. Default: to its right for --flyby, else ahead.
    #[arg(long, value_name = "DIRECTION", value_parser = values::heading, allow_hyphen_values = true, conflicts_with = "light")]
    pub direction: Option<Heading>,
    /// How far the camera goes, with its unit: "6 m". Default: twice the distance to the point that it looks at.
    #[arg(long, value_name = "LENGTH", conflicts_with_all = ["light", "speeds"])]
    pub distance: Option<Time>,
    /// The camera's time of the first picture of --light. Default: when light comes into view.
    #[arg(long, value_name = "TIME", requires = "to", conflicts_with_all = ["flyby", "accelerate", "speeds"], allow_hyphen_values = true)]
    pub from: Option<Time>,
    /// The camera's time of the last picture of --light.
    #[arg(
        long,
        value_name = "TIME",
        requires = "from",
        allow_hyphen_values = true
    )]
    pub to: Option<Time>,
}

/// What stands beside the pictures of a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Beside {
    /// Those of a camera at rest.
    Rest,
    /// The space-time diagram.
    Diagram,
}

impl Beside {
    /// As the command line has it.
    pub fn word(self) -> &'static str {
        match self {
            Beside::Rest => "rest",
            Beside::Diagram => "diagram",
        }
    }
}

#[derive(Debug, Args)]
pub struct PageArguments {
    /// The scene file (TOML), or a model without a scene (.glb, .gltf). Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// The directory for index.html; created if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// The greatest speed v/c of the slider.
    #[arg(
        long,
        value_name = "BETA",
        default_value_t = 0.9,
        allow_negative_numbers = true
    )]
    pub beta: f64,
    /// Speeds of the slider, from 0, in equal steps of rapidity.
    #[arg(long, value_name = "N", default_value_t = 13, value_parser = clap::value_parser!(u32).range(2..=200))]
    pub steps: u32,
    /// Where the camera moves to: x, y, z, -x, -y, -z or a vector like 1,0,-1. Default: ahead.
    #[arg(long, value_name = "DIRECTION", value_parser = values::heading, allow_hyphen_values = true)]
    pub direction: Option<Heading>,
    /// A second slider, for the camera's time, from here …
    #[arg(
        long,
        value_name = "TIME",
        requires = "to",
        conflicts_with = "time",
        allow_hyphen_values = true
    )]
    pub from: Option<Time>,
    /// … to here.
    #[arg(
        long,
        value_name = "TIME",
        requires = "from",
        allow_hyphen_values = true
    )]
    pub to: Option<Time>,
    /// Times of the second slider.
    #[arg(long, value_name = "N", default_value_t = 9, requires = "from", value_parser = clap::value_parser!(u32).range(2..=200))]
    pub times: u32,
    /// Diagrams of so many columns and rows of pixels, which a click on the picture shows: 4x3.
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
    /// One exposure for all pictures. Default: each has its own, so that none is black or white.
    #[arg(long)]
    pub same_exposure: bool,
    /// The most that the page may have, megabytes.
    #[arg(long, value_name = "MB", default_value_t = 10.0, value_parser = values::seconds)]
    pub max_size: f64,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub work: WorkArguments,
}

impl FrameArguments {
    /// Those of a fly-by for which none are given.
    pub fn all_of_flyby() -> Self {
        FrameArguments {
            frames: Some(0..ModelView::FLYBY_FRAMES),
            from: None,
            to: None,
            fps: None,
            interval: None,
        }
    }
}

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("timed").multiple(true))]
pub struct RenderArguments {
    /// The scene file (TOML), or a model without a scene (.glb, .gltf). Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub channels: ChannelArguments,
    /// Where to write: .png (display), .exr (linear, all channels), .npz (f64); of a sequence also a film, .apng or .y4m,
    /// or - for .y4m on standard output. Repeatable.
    /// Default: the scene's name with .png, in the current directory.
    /// An existing file is replaced once the new one is complete.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// How the picture is made: trace, raster:none, raster:uniform=METRES, raster:adaptive=PIXELS, warp:cube=N or
    /// warp:panorama=WxH; see `nullray help render`.
    #[arg(long, value_name = "METHOD", default_value = "trace")]
    pub method: Method,
    /// Also write the retarded time as a coloured picture with a legend.
    #[arg(long, value_name = "FILE.png", group = "timed")]
    pub isochrones: Option<PathBuf>,
    /// Also write the luminance as a coloured picture with a legend.
    #[arg(long, value_name = "FILE.png")]
    pub luminance: Option<PathBuf>,
    /// Also write the display picture with lines drawn over it: where objects are seen and where they
    /// are, isochrones, the camera's velocity; .png, .svg or .pdf. Repeatable.
    #[arg(long, value_name = "FILE", group = "timed")]
    pub overlay: Vec<PathBuf>,
    /// Which of "isochrones,outlines,beta,legend" to draw over the picture. Default: all.
    #[arg(long, value_name = "LIST", requires = "overlay", value_parser = Parts::parse)]
    pub overlay_parts: Option<Parts>,
    /// Distance between isochrones, with its unit. Default: a round number.
    #[arg(long, value_name = "TIME", requires = "timed")]
    pub isochrone_step: Option<Time>,
    /// Radiance and alpha of .exr files in half precision; the other channels stay in single precision.
    #[arg(long)]
    pub half: bool,
    /// One exposure for all frames or panels, so that they can be compared and do not flicker: the scene's percentile
    /// over small previews of them all.
    #[arg(long)]
    pub same_exposure: bool,
    /// Beneath each picture of a film: these words, the camera's time and, where it moves, its speed (β and γ).
    #[arg(long, value_name = "TEXT")]
    pub caption: Option<String>,
    /// Pictures per second of a film when it is played. Default: 24.
    #[arg(long, value_name = "N", value_parser = values::rate, allow_hyphen_values = true)]
    pub play_fps: Option<f64>,
    /// Render this panel of the scene. Default: all panels. Repeatable.
    #[arg(long, value_name = "NAME")]
    pub panel: Vec<String>,
    #[command(flatten)]
    pub work: WorkArguments,
    /// Print statistics at the end: rays, node visits, triangle tests, fall-backs, bytes, times.
    #[arg(long, conflicts_with = "quiet")]
    pub stats: bool,
    /// Write the same statistics as JSON.
    #[arg(long, value_name = "FILE.json")]
    pub stats_json: Option<PathBuf>,
    /// Print the scene, with all that options change of it, and render nothing. Of a model without a scene it is the
    /// scene that this stands for; saved in the current directory, it renders the same picture.
    #[arg(long)]
    pub print_scene: bool,
    #[command(flatten)]
    pub passes: PassArguments,
    #[command(flatten)]
    pub model: ModelArguments,
    #[command(flatten)]
    pub frames: FrameArguments,
}

/// When a picture is good enough.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "Pictures that improve")]
pub struct PassArguments {
    /// Go on until the standard error of each tile of 16 x 16 pixels is at most this part of its radiance, or of the picture's mean
    /// where that is more: "1 %". Passes of --spp samples, more of them where there is more noise. The files improve as they are
    /// done; after Ctrl-C, the same command goes on where it stopped.
    #[arg(long, value_name = "PERCENT", value_parser = values::relative_error)]
    pub error: Option<f64>,
    /// Go on for this long: "60 s", "5 min" or "1 h". Two passes are the least.
    #[arg(long, value_name = "TIME", value_parser = values::work_time)]
    pub budget: Option<f64>,
    /// Go on for so many passes at most, an even number. A file tells how many it has (`nullray info`): so many passes have its bits.
    #[arg(long, value_name = "N", value_parser = values::passes)]
    pub passes: Option<u32>,
}

impl PassArguments {
    /// The first option that is given.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            (self.error.is_some(), "--error"),
            (self.budget.is_some(), "--budget"),
            (self.passes.is_some(), "--passes"),
        ];
        let given = options.into_iter().find(|(is_given, _)| *is_given);
        given.map(|(_, option)| option)
    }
}

/// How a model is looked at that is given in place of a scene.
#[derive(Debug, Args)]
#[command(next_help_heading = "Models without a scene (.glb, .gltf)")]
pub struct ModelArguments {
    /// The camera's speed v/c, from -1 to 1, both not included. Default: at rest; 0.9 for --flyby.
    #[arg(long, value_name = "BETA", allow_negative_numbers = true)]
    pub beta: Option<f64>,
    /// Where the camera moves to: x, y, z, -x, -y, -z, a vector like 1,0,-1, or "towards" the model or "away" from it.
    #[arg(long, value_name = "DIRECTION", value_parser = values::heading, allow_hyphen_values = true)]
    pub direction: Option<Heading>,
    /// Pass the model by, in a sequence of 48 pictures (or those that --frames takes of it).
    #[arg(long)]
    pub flyby: bool,
}

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
    /// One exposure for all panels of a page, so that they can be compared: the scene's percentile over small previews
    /// of them all.
    #[arg(long)]
    pub same_exposure: bool,
    /// Also write each panel, beside its page: the scene's name and the panel's.
    #[arg(long)]
    pub keep_panels: bool,
    #[command(flatten)]
    pub work: WorkArguments,
}

#[derive(Debug, Args)]
pub struct BakeArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where to write: .npz with the array radiance (H, W, T, 3) of energies per bin, f32, its standard_error by bin and
    /// metadata, or .npy with the energies alone; with several objects, one file for each, by their names. What is done is kept in
    /// FILE.parts until all is: the same command goes on where it was stopped.
    /// Default: the scene's name with -light.npy, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Bake what the scene's camera sees, which rests with the objects, by the times of arrival; not the objects' surfaces.
    #[arg(long, conflicts_with_all = ["object", "texels", "uv"])]
    pub camera: bool,
    /// Bake the surface of this object. Default: all that reflect light. Repeatable.
    #[arg(long, value_name = "NAME")]
    pub object: Vec<String>,
    /// Columns and rows of texels of a surface.
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "64x64", allow_hyphen_values = true)]
    pub texels: [u32; 2],
    /// The set of texture coordinates of surfaces; no two places of an object may share theirs.
    #[arg(long, value_name = "SET", default_value_t = 0)]
    pub uv: u8,
    /// The time at which the first bin starts. Default: 0.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub start: Option<Time>,
    /// Width of a bin, with its unit: "5 cm" or "100 ps".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub bin_width: Time,
    /// How many bins.
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub bins: u32,
    /// Energies in half precision.
    #[arg(long)]
    pub half: bool,
    /// Print what it would load and how much memory it would take, and bake nothing.
    #[arg(long)]
    pub plan: bool,
    #[command(flatten)]
    pub work: WorkArguments,
}

#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    #[command(flatten)]
    pub channels: ChannelArguments,
    /// Plan a picture that is made so, as for render.
    #[arg(long, value_name = "METHOD", default_value = "trace")]
    pub method: Method,
    /// Plan pictures with lines over them, too.
    #[arg(long)]
    pub overlay: bool,
    /// Which of "isochrones,outlines,beta,legend" are drawn. Default: all.
    #[arg(long, value_name = "LIST", requires = "overlay", value_parser = Parts::parse)]
    pub overlay_parts: Option<Parts>,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct TessellationArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Largest allowed distance of drawn points from their true positions, pixels.
    #[arg(long, value_name = "N", default_value_t = 0.5, value_parser = values::pixels, allow_hyphen_values = true)]
    pub pixels: f64,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub work: WorkArguments,
}

#[derive(Debug, Args)]
pub struct InfoArguments {
    /// A .gltf, .glb, .npy, .npz, .ti, .exr, .png or .toml file, recognised by its content, or a folder of pictures.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct SelftestArguments {
    /// Use 10⁸ rays and a mesh of 10⁷ triangles: takes some minutes and 3 GB of memory.
    #[arg(long)]
    pub thorough: bool,
    /// Run only this check. Repeatable.
    #[arg(long, value_name = "NAME")]
    pub check: Vec<String>,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
    /// Worker threads. Default: one per core. The outcome does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct CompareArguments {
    /// The reference picture: .exr, .png, .npz or .npy.
    #[arg(value_name = "REFERENCE")]
    pub reference: PathBuf,
    /// The picture to test against it.
    #[arg(value_name = "CANDIDATE")]
    pub candidate: PathBuf,
    /// Channels, or groups of channels, to compare, which both pictures must have: "radiance,event". Default: those
    /// that both have.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub channels: Vec<String>,
    /// The scene of which the reference is. Default: the one that its metadata hold, as far as that goes without meshes
    /// and cubes. Geometric errors are those of this scene then, and diagnoses render it where they need to.
    #[arg(long, value_name = "FILE.toml")]
    pub scene: Option<PathBuf>,
    /// A picture of the same size; only pixels where it is bright are compared.
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,
    /// Compare only this rectangle: left column, top row, width and height.
    #[arg(long, value_name = "X,Y,W,H", value_parser = values::crop)]
    pub crop: Option<[u32; 4]>,
    /// The encoding of a .png: "srgb" or "linear". Default: srgb.
    #[arg(long, value_name = "NAME", value_parser = values::transfer)]
    pub transfer: Option<Encoding>,
    /// How to treat radiance that is NaN or infinite: "refuse", "ignore" (its pixels do not count), "count-as=VALUE".
    /// Default: refuse.
    #[arg(long, value_name = "POLICY", value_parser = values::nan)]
    pub nan: Option<NotFinite>,
    /// What `object` and `primitive` hold where nothing is met, beside −1 and the largest number of an unsigned type.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub no_hit: Option<i64>,
    /// Width of a time bin, with its unit: "5 mm" or "16 ps". Errors of emission times are then reported in bins too.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub bin_width: Option<Time>,
    /// Pixels per degree of visual angle for FLIP. Default: 67.02, a 3840-pixel display of 0.7 m at 0.7 m.
    #[arg(long, value_name = "N", conflicts_with = "no_flip", value_parser = values::ppd)]
    pub ppd: Option<f64>,
    /// Skip FLIP, which takes most of the time.
    #[arg(long)]
    pub no_flip: bool,
    /// Compare even if the metadata say that the reference is the approximation.
    #[arg(long)]
    pub allow_swapped: bool,
    /// A limit; if it is exceeded, or the metric cannot be computed, the exit code is 1. Repeatable.
    #[arg(long, value_name = "METRIC=VALUE")]
    pub tolerance: Vec<Tolerance>,
    /// Memory limit. Default: three quarters of the machine's.
    #[arg(long, value_name = "SIZE", value_parser = values::bytes)]
    pub max_memory: Option<u64>,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
    /// Write differences, FLIP and geometric errors as channels.
    #[arg(long, value_name = "FILE.exr")]
    pub maps: Option<PathBuf>,
    /// Write the errors in false colours with a legend.
    #[arg(long, value_name = "FILE.png")]
    pub error_map: Option<PathBuf>,
    /// Write reference, errors and candidate side by side.
    #[arg(long, value_name = "FILE.png")]
    pub strip: Option<PathBuf>,
    /// Write everything as one self-contained page.
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct DiagramArguments {
    /// The scene file (TOML), with a [diagram] table or without. Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Where to write: .svg, .pdf, .png, .tex (TikZ, for \\input), .apng (animated PNG), .y4m (raw video), or - for .y4m
    /// on standard output. Repeatable. Default: the scene's name with .svg, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Text of an .svg or a .pdf as text, to be searched and edited: in the fonts of whoever shows the .svg, in its own in a
    /// .pdf. Default: outlines, which look the same everywhere.
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
    /// holds these alone.
    #[arg(long, value_name = "A..B", value_parser = values::frames, allow_hyphen_values = true)]
    pub frames: Option<Range<u64>>,
    /// Pictures per second in a film. Default: diagram.animation.fps.
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
    /// Change a key of the file: --set "diagram.worldline.Bob.velocity=0.8". Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = values::assignment)]
    pub set: Vec<(String, String)>,
    /// The camera's proper time when the picture is taken, with its unit: "3.2 m" or "12 ns".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub time: Option<String>,
    /// Draw this panel of the scene. Default: the scene without its panels.
    #[arg(long, value_name = "NAME")]
    pub panel: Option<String>,
    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
    #[command(flatten)]
    pub pixel: PixelArguments,
}

/// An end of the light of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Origin {
    /// Where the camera sees it.
    Camera,
    /// Where it was emitted.
    Object,
}

/// From a picture to its diagram.
#[derive(Debug, Args)]
#[command(next_help_heading = "From a pixel")]
pub struct PixelArguments {
    /// Probe the pixel in column J and row I (from the top left, from 0): trace its centre, and draw where and when its
    /// light was emitted, and where its source is now. Loads the scene's geometry, but no cubes and textures.
    #[arg(long, value_name = "J,I", value_parser = values::pixel, allow_hyphen_values = true)]
    pub pixel: Option<[u32; 2]>,
    /// Width and height of the picture that --pixel counts in. Default: the scene's.
    #[arg(long, value_name = "WxH", requires = "pixel", value_parser = values::size, allow_hyphen_values = true)]
    pub image_size: Option<[u32; 2]>,
    /// Where the coordinates of the diagram are 0: where the camera sees the light, or where it was emitted. Default: where
    /// the frame has its origin.
    #[arg(long, value_name = "WHERE", requires = "pixel")]
    pub origin: Option<Origin>,
    /// Print the numbers of the pixel as JSON, and nothing else.
    #[arg(long, requires = "pixel")]
    pub json: bool,
    /// Memory limit for the geometry. Default: three quarters of the machine's.
    #[arg(long, value_name = "SIZE", requires = "pixel", value_parser = values::bytes)]
    pub max_memory: Option<u64>,
    /// Let glTF files refer to files outside their own folder and the scene's.
    #[arg(long, requires = "pixel")]
    pub allow_outside: bool,
}

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
    /// Write test vectors too: vertices, and in which event, where on the film and with which wavelength ratio they are
    /// seen, as JSON for unit tests in any language.
    #[arg(long)]
    pub vectors: bool,
    /// Replace an export of this name.
    #[arg(long)]
    pub overwrite: bool,
    #[command(flatten)]
    pub work: WorkArguments,
}

#[derive(Debug, Args)]
pub struct ConvertArguments {
    /// A .npy, .npz or .ti file, a folder of numbered pictures, or a pattern for their names.
    #[arg(value_name = "FILE")]
    pub input: PathBuf,
    /// A .npy or .npz file to write, or, of a name without an extension, a new folder of EXR frames.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// The array of an .npz file that holds several.
    #[arg(long, value_name = "NAME")]
    pub array: Option<String>,
    /// The order of the input's axes, like "T H W". Default: "H W T [C]"; of pictures "T H W".
    #[arg(long, value_name = "AXES")]
    pub axes: Option<Axes>,
    /// How codes of PNG pictures stand for radiance.
    #[arg(long, value_name = "HOW")]
    pub transfer: Option<TransferArgument>,
    /// The order of the output's axes, H or T first. Default: "H W T C".
    #[arg(long, value_name = "AXES")]
    pub to_axes: Option<Axes>,
    /// Keep these rows: the first, and the first that is left out, counted from 0.
    #[arg(long, value_name = "FROM:TO", value_parser = values::range)]
    pub rows: Option<Range<usize>>,
    /// Keep these columns.
    #[arg(long, value_name = "FROM:TO", value_parser = values::range)]
    pub columns: Option<Range<usize>>,
    /// Keep these time bins.
    #[arg(long, value_name = "FROM:TO", value_parser = values::range)]
    pub bins: Option<Range<usize>>,
    /// Make one bin of so many neighbours: their sum.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub merge: Option<u32>,
    /// Values are per metre and not per bin: merged bins are means.
    #[arg(long)]
    pub density: bool,
    /// The type of samples. Default: the input's.
    #[arg(long = "type", value_name = "TYPE")]
    pub sample_type: Option<SampleType>,
    /// From times of arrival at the capture camera to times of emission: take off the way. FILE holds the distance (not
    /// the depth) of every pixel in metres: a .npy file, or a picture rendered from the capture camera as .npz.
    #[arg(long, value_name = "FILE", conflicts_with = "warp")]
    pub unwarp: Option<PathBuf>,
    /// The reverse of --unwarp.
    #[arg(long, value_name = "FILE")]
    pub warp: Option<PathBuf>,
    /// Refractive index of the medium, for --unwarp and --warp.
    #[arg(long, value_name = "N", default_value_t = 1.0, value_parser = values::positive)]
    pub medium_index: f64,
    /// Width of the input's bins, like "0.05 m" or "4 ps"; needed for --unwarp and --warp unless the file says it.
    #[arg(long, value_name = "TIME")]
    pub bin_width: Option<Time>,
    /// Time at the start of the input's bin 0, to be told that of the output.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub start: Option<Time>,
    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub struct MeshFromDepthArguments {
    /// A cube (.npy, .npz, .ti, pictures), or with --from a map (rows, columns) of metres: .npy, .npz.
    #[arg(value_name = "FILE")]
    pub input: PathBuf,
    /// The .glb file to write. Default: FILE with that extension, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// What tells how far surfaces are.
    #[arg(long, value_name = "WHAT", default_value = "first-light")]
    pub from: DepthKind,
    /// Position of the camera's pinhole, metres.
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub eye: DVec3,
    /// A point on its forward axis.
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub look_at: DVec3,
    /// A direction that is up in the picture.
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true, default_value = "0,1,0")]
    pub up: DVec3,
    /// Field of view, like "40 deg"; pixels are square.
    #[arg(long, value_name = "ANGLE")]
    pub fov: Angle,
    /// The axis of the film along which that is.
    #[arg(long, value_name = "AXIS", default_value = "x")]
    pub fov_axis: FovAxisArgument,
    /// Depth of the near plane on which the capture's rays began, metres.
    #[arg(long, value_name = "METRES", default_value_t = 0.0)]
    pub near_clip: f64,
    /// Where the pulse of light was sent, metres: of --from first-light.
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub lamp: Option<DVec3>,
    /// When its centre was sent. Default: "0 m".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub lamp_time: Option<Time>,
    /// Time at the start of bin 0, by arrival at the camera. Default: what the file says, or "0 m".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub start: Option<Time>,
    /// Width of a bin, like "0.05 m" or "4 ps"; needed unless the file says it.
    #[arg(long, value_name = "TIME")]
    pub bin_width: Option<Time>,
    /// The array of an .npz file that holds several.
    #[arg(long, value_name = "NAME")]
    pub array: Option<String>,
    /// The order of the cube's axes, like "T H W". Default: "H W T [C]"; of pictures "T H W".
    #[arg(long, value_name = "AXES")]
    pub axes: Option<Axes>,
    /// Refractive index of the medium.
    #[arg(long, value_name = "N", default_value_t = 1.0, value_parser = values::positive)]
    pub medium_index: f64,
    /// The first maximum of a pixel counts from this part of its highest value on.
    #[arg(long, value_name = "PART", default_value_t = 0.2, value_parser = values::positive)]
    pub rise: f64,
    /// Pixels below this part of the brightest are dark, and leave holes: shadow, where light came over other surfaces only.
    #[arg(long, value_name = "PART", default_value_t = 0.02, value_parser = values::positive)]
    pub least: f64,
    /// Neighbours are not joined where their distances differ by more than so many widths of a pixel, and by more than
    /// a plane's would.
    #[arg(long, value_name = "PIXELS", default_value_t = 4.0, value_parser = values::positive)]
    pub tear: f64,
    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

/// What tells how far surfaces are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DepthKind {
    /// When light first came back: a cube by times of arrival, lit by a pulse.
    FirstLight,
    /// A map of distances from the pinhole, along the rays.
    Distance,
    /// A map of depths, along the forward axis.
    Depth,
}

/// An axis of a film.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum FovAxisArgument {
    /// Across the columns.
    X,
    /// Across the rows.
    Y,
    /// From corner to corner.
    Diagonal,
    /// The smaller of x and y.
    Smaller,
    /// The larger of x and y.
    Larger,
}

impl From<FovAxisArgument> for FovAxis {
    fn from(axis: FovAxisArgument) -> FovAxis {
        match axis {
            FovAxisArgument::X => FovAxis::X,
            FovAxisArgument::Y => FovAxis::Y,
            FovAxisArgument::Diagonal => FovAxis::Diagonal,
            FovAxisArgument::Smaller => FovAxis::Smaller,
            FovAxisArgument::Larger => FovAxis::Larger,
        }
    }
}

/// A type of samples.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum SampleType {
    /// Half precision.
    F16,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

/// How codes stand for radiance.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum TransferArgument {
    /// In proportion.
    Linear,
    /// By the transfer function of sRGB.
    Srgb,
}

impl From<TransferArgument> for Transfer {
    fn from(transfer: TransferArgument) -> Transfer {
        match transfer {
            TransferArgument::Linear => Transfer::Linear,
            TransferArgument::Srgb => Transfer::Srgb,
        }
    }
}

#[derive(Debug, Args)]
pub struct StudyArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where to write: .csv, .json, or the plot as .svg, .pdf, .png. Repeatable.
    /// Default: the scene's name with -study.csv, -study.json and -study.svg, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// The methods, separated by semicolons or spaces, as --method of render has them; trace:fast too.
    #[arg(long, value_name = "LIST", default_value = study::METHODS, value_parser = values::methods)]
    pub methods: MethodList,
    /// Samples per pixel to measure each method with.
    #[arg(long, value_name = "LIST", default_value = "1,4,16,64", value_parser = values::samples)]
    pub samples: SampleList,
    /// Runs of each method and number of samples, as far as the budget allows.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub runs: u32,
    /// Time limit for the measurements in seconds, not counting the reference.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = values::seconds)]
    pub budget: f64,
    /// Samples per pixel of the reference picture.
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SAMPLES)))]
    pub reference_spp: u32,
    #[command(flatten)]
    pub work: WorkArguments,
}

/// What becomes of stored cubes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum CubesArgument {
    /// Copied into the bundle.
    Copy,
    /// Named with their SHA-256.
    Reference,
}

impl SceneArguments {
    /// The scene, or the panel.
    pub fn load(&self) -> Result<Scene> {
        let overrides = self.changes.overrides();
        panels::scene(self.scene.as_deref(), self.panel.as_ref(), &overrides)
    }
}

impl ChannelArguments {
    pub fn list(&self) -> Vec<Aov> {
        self.aovs.clone().map_or(Vec::new(), |list| list.0)
    }
}

impl Changes {
    /// The changes to the scene file.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            set: self.set.clone(),
            size: self.size,
            samples_per_pixel: self.spp,
            time: self.time.clone(),
            exposure: self.exposure.clone(),
            white: self.white,
            allow_outside: self.allow_outside,
        }
    }

    /// What is asked of a scene beyond its file.
    pub fn request(&self) -> Request {
        Request {
            aovs: Vec::new(),
            pixel_centers: self.pixel_centers,
            memory_limit: memory::limit(self.max_memory),
            precision: self.precision,
            beside: 0,
        }
    }
}
