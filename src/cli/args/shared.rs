//! Options that several commands share; each is defined once.

use std::path::{Path, PathBuf};

use clap::Args;
use nullray::Result;
use nullray::accel::Precision;
use nullray::approximate::raster::Method;
use nullray::figures::overlay::Parts;
use nullray::render::aov::Aov;
use nullray::render::plan::Request;
use nullray::render::prepare::LoadedCubes;
use nullray::scene::model::{MOST_SAMPLES, Scene};
use nullray::scene::{Overrides, SceneFile};

use crate::cli::values::AovList;
use crate::cli::{memory, panels, values};

/// The scene to use.
#[derive(Debug, Args)]
pub struct ScenePath {
    /// The scene file (TOML; - for standard input), or a model without a scene (.glb, .gltf). Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    scene: Option<PathBuf>,
}

impl ScenePath {
    /// The file; `None` is the built-in scene.
    pub fn path(&self) -> Option<&Path> {
        self.scene.as_deref()
    }
}

/// The panel of the scene to use.
#[derive(Debug, Args)]
pub struct PanelArgument {
    /// Take this panel of the scene. Default: the scene without its panels.
    #[arg(long, value_name = "NAME")]
    panel: Option<String>,
}

impl PanelArgument {
    /// The panel's name.
    pub fn name(&self) -> Option<&String> {
        self.panel.as_ref()
    }
}

/// A scene or one of its panels, and the changes to it.
#[derive(Debug, Args)]
pub struct SceneArguments {
    #[command(flatten)]
    path: ScenePath,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    panel: PanelArgument,
}

impl SceneArguments {
    /// The scene, or the panel.
    pub fn load(&self) -> Result<Scene> {
        let overrides = self.changes.overrides();
        let memory = self.changes.memory.bytes();
        panels::scene(self.path(), self.panel.name(), &overrides, memory)
    }

    /// The scene of `file`, or the panel; `file` has been read from the path.
    pub fn of(&self, file: &SceneFile) -> Result<Scene> {
        panels::of_file(file, self.panel.name(), &self.changes.overrides())
    }

    /// The file; `None` is the built-in scene.
    pub fn path(&self) -> Option<&Path> {
        self.path.path()
    }
}

/// Changes to a scene.
#[derive(Debug, Args)]
pub struct Changes {
    /// Image size in pixels.
    #[arg(long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// Samples per pixel.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SAMPLES)), allow_negative_numbers = true)]
    pub spp: Option<u32>,
    #[command(flatten)]
    pub edits: Edits,
    /// The radiance that becomes white in a .png, as a percentile of the lit pixels: "95 %", or 95.
    #[arg(long, value_name = "PERCENT", conflicts_with = "white", value_parser = values::percentage, allow_hyphen_values = true)]
    pub exposure: Option<String>,
    /// The radiance that becomes white in a .png.
    #[arg(long, value_name = "RADIANCE", allow_negative_numbers = true)]
    pub white: Option<f64>,
    /// One sample per pixel, exactly at its centre.
    #[arg(long, visible_alias = "pixel-centres", conflicts_with = "spp")]
    pub pixel_centers: bool,
    /// How visibility is computed: "certified" (as exact arithmetic would), or "fast" for previews (f32: rays may
    /// slip through edges, and surfaces at nearly equal depths may be confused).
    #[arg(long, value_name = "certified|fast", default_value = "certified", value_parser = values::precision)]
    pub precision: Precision,
    #[command(flatten)]
    pub memory: MemoryLimit,
    #[command(flatten)]
    pub files: FileAccess,
}

impl Changes {
    /// The changes to the scene file.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            set: self.edits.set.clone(),
            size: self.size,
            samples_per_pixel: self.spp,
            time: self.edits.time.clone(),
            exposure: self.exposure.clone(),
            white: self.white,
            allow_outside: self.files.allow_outside,
            ..Overrides::default()
        }
    }

    /// Whether the command line sets the white point.
    pub fn says_exposure(&self) -> bool {
        let keys = [
            "display",
            "display.white",
            "display.exposure",
            "display.logarithmic",
        ];
        // `--set display={...}` may set any of them.
        let is_set = |(key, _): &(String, String)| keys.contains(&key.as_str());
        self.white.is_some() || self.exposure.is_some() || self.edits.set.iter().any(is_set)
    }

    /// The options of a render that are not in the scene file, with the given number of threads.
    pub fn request(&self, threads: Option<u16>) -> Request {
        Request {
            aovs: Vec::new(),
            pixel_centers: self.pixel_centers,
            memory_limit: self.memory.bytes(),
            precision: self.precision,
            program: memory::program(threads),
            ..Request::default()
        }
    }
}

/// Changes that apply to any file.
#[derive(Debug, Args)]
pub struct Edits {
    /// Change a key of the file: --set "camera.velocity={beta=[0.5,0,0]}". Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = values::assignment)]
    pub set: Vec<(String, String)>,
    /// The camera's proper time when the picture is taken, with its unit: "3.2 m" or "12 ns".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub time: Option<String>,
}

/// The memory limit.
#[derive(Debug, Args)]
pub struct MemoryLimit {
    /// Memory limit, also --memory; cubes that do not fit are read from disk in parts. Default: three quarters of what
    /// is available.
    #[arg(long, alias = "memory", value_name = "SIZE", value_parser = values::bytes, allow_hyphen_values = true)]
    max_memory: Option<u64>,
}

impl MemoryLimit {
    /// The limit, bytes.
    pub fn bytes(&self) -> u64 {
        memory::limit(self.max_memory)
    }
}

/// Access to files outside a scene's folder.
#[derive(Debug, Args)]
pub struct FileAccess {
    /// Let glTF files refer to files outside their own folder and the scene's.
    #[arg(long)]
    pub allow_outside: bool,
}

/// Threads and memory.
#[derive(Debug, Args)]
pub struct WorkArguments {
    #[command(flatten)]
    pub threads: Threads,
    #[command(flatten)]
    pub quiet: Quiet,
}

/// The number of threads.
#[derive(Debug, Args)]
pub struct Threads {
    /// Worker threads. Default: one per core. The results do not depend on it.
    #[arg(id = "threads", long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    pub count: Option<u16>,
}

/// How much is printed.
#[derive(Debug, Args)]
pub struct Quiet {
    /// Print only errors, and results that options request.
    #[arg(id = "quiet", short, long)]
    pub on: bool,
}

/// The format of a report.
#[derive(Debug, Args)]
pub struct Json {
    /// As JSON.
    #[arg(id = "json", long)]
    pub on: bool,
}

/// The channels of a picture.
#[derive(Debug, Args)]
pub struct ChannelArguments {
    /// Auxiliary channels for .exr and .npz: "all", or a list of channels ("event.ct") and groups of
    /// them ("event").
    #[arg(long, value_name = "LIST", value_parser = values::aovs)]
    pub aovs: Option<AovList>,
}

impl ChannelArguments {
    pub fn list(&self) -> Vec<Aov> {
        self.aovs.clone().map_or(Vec::new(), |list| list.0)
    }
}

/// How a picture is made.
#[derive(Debug, Args)]
pub struct MethodArgument {
    /// How the picture is made: trace, raster:none, raster:uniform=METRES, raster:adaptive=PIXELS, warp:cube=N or
    /// warp:panorama=WxH; see `nullray help render`.
    #[arg(long, value_name = "METHOD", default_value = "trace")]
    pub method: Method,
}

/// What is drawn over a picture.
#[derive(Debug, Args)]
pub struct LineArguments {
    /// Which of "isochrones,outlines,beta,legend" to draw over the picture. Default: all.
    #[arg(long, value_name = "LIST", requires = "overlay", value_parser = Parts::parse)]
    overlay_parts: Option<Parts>,
}

impl LineArguments {
    /// What is drawn.
    pub fn parts(&self) -> Parts {
        self.overlay_parts.unwrap_or_default()
    }
}

/// The exposure of several pictures.
#[derive(Debug, Args)]
pub struct ExposureArgument {
    /// Use one exposure for all pictures, so that they can be compared and do not flicker: the scene's percentile, over small
    /// previews of all panels or speeds, or of the middle third of a sequence or another film. If the range of panels or
    /// speeds is too wide, they share a logarithmic scale. This is the default. If you render parts of a sequence
    /// separately, give --white.
    #[arg(long)]
    same_exposure: bool,
    /// Give each picture its own exposure.
    #[arg(long, conflicts_with = "same_exposure")]
    own_exposure: bool,
}

impl ExposureArgument {
    /// The scenes of all panels of `file`, in order, with one exposure unless each has its own, or `is_shown` says that no file shows it.
    pub fn panels(
        &self,
        file: &SceneFile,
        whole: &Scene,
        changes: &Changes,
        threads: Option<u16>,
        cubes: &mut LoadedCubes,
        is_shown: bool,
    ) -> Result<Vec<Scene>> {
        let mut scenes = panels::load_all(file, whole, &changes.overrides())?;
        if is_shown && self.is_same() {
            panels::same_exposure(whole, &mut scenes, &changes.request(threads), cubes)?;
        }
        Ok(scenes)
    }

    /// Whether one exposure for all is requested.
    pub fn says_same(&self) -> bool {
        self.same_exposure
    }

    /// Whether all share one exposure.
    pub fn is_same(&self) -> bool {
        !self.own_exposure
    }
}
