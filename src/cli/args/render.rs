//! `nullray render`.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;
use nullray::scene::model::MOST_BOUNCES;
use nullray::scene::{Flash, Heading, ModelView};
use nullray::spacetime::units::Time;

use super::shared::{
    Changes, ChannelArguments, ExposureArgument, LineArguments, MethodArgument, ScenePath,
    WorkArguments,
};
use crate::cli::values;

// The group `timed` has the options that draw isochrones, one of which --isochrone-step needs.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("timed").multiple(true), mut_arg("flash", |flash| flash.conflicts_with_all(["flyby", "time"])))]
pub struct RenderArguments {
    #[command(flatten)]
    pub scene: ScenePath,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub channels: ChannelArguments,
    /// Where to write: .png (display), .exr (linear, all channels), .npz (f64); for a sequence also a film, .apng or .y4m,
    /// or - for .y4m on standard output. Repeatable.
    /// Default: the scene's name with .png, in the current directory.
    /// An existing file is replaced once the new one is complete.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    #[command(flatten)]
    pub method: MethodArgument,
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
    #[command(flatten)]
    pub lines: LineArguments,
    /// Distance between isochrones, with its unit. Default: a round number.
    #[arg(
        long,
        value_name = "TIME",
        requires = "timed",
        allow_hyphen_values = true
    )]
    pub isochrone_step: Option<Time>,
    /// Radiance and alpha of .exr files in half precision; the other channels stay in single precision.
    #[arg(long)]
    pub half: bool,
    #[command(flatten)]
    pub exposure: ExposureArgument,
    /// Write below each picture (.png, films) this text, the camera's time and, where it moves, its speed (β and γ); ""
    /// for time and speed alone. Default: the scene's display.caption, or nothing.
    #[arg(long, value_name = "TEXT")]
    pub caption: Option<String>,
    /// Pictures per second of a film when it is played. Default: 24.
    #[arg(long, value_name = "N", value_parser = values::film_rate, allow_hyphen_values = true)]
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
    /// Print the scene with all changes made by options, and render nothing. For a model without a scene, print the
    /// scene that is made for it; saved in the current directory, that scene renders the same picture.
    #[arg(long)]
    pub print_scene: bool,
    #[command(flatten)]
    pub passes: PassArguments,
    #[command(flatten)]
    pub model: ModelArguments,
    #[command(flatten)]
    pub flash: FlashArguments,
    /// Columns and rows of texels for the baked light of --flash, for the model and for the floor. Default: 192x192, more
    /// if the model's atlas needs them.
    #[arg(long, value_name = "WxH", requires = "flash", conflicts_with_all = ["flyby", "time"], value_parser = values::size, allow_hyphen_values = true, help_heading = "Flashes of light on models (.glb, .gltf)")]
    pub texels: Option<[u32; 2]>,
    #[command(flatten)]
    pub frames: FrameArguments,
}

/// When to stop rendering passes.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "Progressive rendering")]
pub struct PassArguments {
    /// Render passes of --spp samples until in each tile of 16 x 16 pixels the root mean square of the standard errors of its pixels (in R, G and B) is
    /// at most this fraction of the tile's mean radiance, or of the picture's where that is larger: "1 %" or 0.01. Noisy tiles get
    /// more passes. The files improve with every pass; after Ctrl-C, run the same command again to resume.
    #[arg(long, value_name = "PERCENT", value_parser = values::relative_error, allow_hyphen_values = true)]
    pub error: Option<f64>,
    /// Render passes for this long: "60 s", "5 min" or "1 h"; but at least two. Without a unit, in seconds.
    #[arg(long, value_name = "TIME", value_parser = values::work_time, allow_hyphen_values = true)]
    pub budget: Option<f64>,
    /// Render at most this many passes, an even number. `nullray info` says how many a file has; the same number gives
    /// the same bits, with the same --error if one was given.
    #[arg(long, value_name = "N", value_parser = values::passes, allow_negative_numbers = true)]
    pub passes: Option<u32>,
}

impl PassArguments {
    /// The name of the first option that is given.
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

/// The camera for a model that is given in place of a scene.
#[derive(Debug, Args)]
#[command(next_help_heading = "Models without a scene (.glb, .gltf)")]
pub struct ModelArguments {
    /// The camera's speed v/c, above -1 and below 1: 0.9 or 0.9c. Default: at rest; 0.5 for --flyby.
    #[arg(long, value_name = "BETA", value_parser = values::speed, allow_negative_numbers = true)]
    pub beta: Option<f64>,
    /// Where the camera moves to: x, y, z, -x, -y, -z, a vector like 1,0,-1, or "towards" the model or "away" from it. Default: x.
    #[arg(long, value_name = "DIRECTION", value_parser = values::heading, allow_hyphen_values = true)]
    pub direction: Option<Heading>,
    /// Fly past the model, in a sequence of 48 pictures (or those chosen by --frames).
    #[arg(long)]
    pub flyby: bool,
}

/// Light in flight on a model.
#[derive(Debug, Args)]
#[command(next_help_heading = "Flashes of light on models (.glb, .gltf)")]
pub struct FlashArguments {
    /// Light a model without a scene by a flash, and show the light in flight: a film of 48 pictures (or those chosen by --frames), from
    /// just before the light arrives until it has faded. The model's own lamps and shining panels flash, or else a lamp above the viewer's
    /// left shoulder. A model without a ground of its own gets a floor. The light, direct and indirect, is first baked into NAME-light.npz,
    /// or NAME-light-model.npz and NAME-light-floor.npz, beside the film; a bake of the same light is reused.
    #[arg(long)]
    pub flash: bool,
    /// Number of reflections after the first: the scene's `render.bounces`. Default: what the scene says, and 2 for --flash.
    #[arg(long, value_name = "N", help_heading = None::<&'static str>, value_parser = clap::value_parser!(u32).range(0..=i64::from(MOST_BOUNCES)), allow_negative_numbers = true)]
    bounces: Option<u32>,
}

impl FlashArguments {
    /// The flash whose light is baked into `file`, if there is one.
    pub fn flash(&self, file: impl FnOnce() -> PathBuf) -> Option<Flash> {
        self.flash.then(|| Flash {
            bounces: self.bounces.unwrap_or(2),
            file: file(),
        })
    }

    /// Adds --bounces to the changes of a scene; a flash has bounces of its own.
    pub fn add_to(&self, changes: &mut Changes) {
        let bounces = self.bounces.filter(|_| !self.flash);
        let change = |bounces: u32| ("render.bounces".into(), bounces.to_string());
        changes.edits.set.extend(bounces.map(change));
    }
}

impl ModelArguments {
    /// The view of the model.
    pub fn view(&self, flash: Option<Flash>) -> ModelView {
        ModelView {
            beta: self.beta,
            direction: self.direction,
            flyby: self.flyby,
            flash,
            ..ModelView::default()
        }
    }
}

/// The moments of a sequence.
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
    /// The camera's proper time at which the sequence ends; no frame is taken at it (`film` and `page` include theirs).
    #[arg(
        long,
        value_name = "TIME",
        requires = "from",
        conflicts_with_all = ["frames", "time"],
        allow_hyphen_values = true
    )]
    pub to: Option<Time>,
    /// Frames per second of the camera's clock, in which light goes 299,792 km; not the speed of a film, which is --play-fps.
    /// Default: by the scene's camera.frame_interval.
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

impl FrameArguments {
    /// The frames of a fly-by or a flash for which the command line gives none.
    pub fn all_of_model() -> Self {
        FrameArguments {
            frames: Some(0..ModelView::FLYBY_FRAMES),
            from: None,
            to: None,
            fps: None,
            interval: None,
        }
    }
}
