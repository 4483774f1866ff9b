//! What was typed. One definition makes the parser, the help, the man pages and the completions.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use nullray::aov::{self, Aov};
use nullray::scene::Overrides;
use nullray::scene::model::MOST_SAMPLES;
use nullray::units::{Percentage, Time};

use super::help;

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
    Render(RenderArguments),
    /// Print what a scene and a request need, and what is skipped and why; nothing heavy is loaded.
    #[command(after_help = help::PLAN)]
    Plan(PlanArguments),
    /// Print what a glTF, npy, npz, exr, png or scene file holds.
    #[command(after_help = help::INFO)]
    Info(InfoArguments),
    /// Print the JSON schema of the scene file, for editors.
    Schema,
    /// Print completions for a shell.
    Completions {
        /// Which shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write one page per command into a directory.
    Man {
        /// Where to write nullray.1, nullray-render.1, …; made where it does not exist.
        #[arg(long, value_name = "DIR")]
        directory: Option<PathBuf>,
    },
}

/// A scene and what is changed of it.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// The scene file (TOML). Default: the built-in scene.
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Image size in pixels.
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// Samples per pixel.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SAMPLES)))]
    pub spp: Option<u32>,
    /// The camera's proper time of the shot, with its unit: "3.2 m" or "12 ns".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub time: Option<String>,
    /// The radiance that becomes white in a .png, as a percentile of the lit pixels: "95 %".
    #[arg(long, value_name = "PERCENT", conflicts_with = "white", value_parser = percentage)]
    pub exposure: Option<String>,
    /// The radiance that becomes white in a .png.
    #[arg(long, value_name = "RADIANCE", allow_negative_numbers = true)]
    pub white: Option<f64>,
    /// Auxiliary channels for .exr and .npz: "all", or a list of channels ("event.ct") and groups of
    /// them ("event").
    #[arg(long, value_name = "LIST", value_parser = aovs)]
    pub aovs: Option<AovList>,
    /// One sample per pixel, exactly at its centre.
    #[arg(long, visible_alias = "pixel-centres", conflicts_with = "spp")]
    pub pixel_centers: bool,
    /// Change a key of the scene file: --set "camera.velocity={beta=[0.5,0,0]}". Repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
    /// The most memory that the scene may take.
    #[arg(long, value_name = "SIZE", default_value = "16GiB", value_parser = bytes)]
    pub max_memory: u64,
}

#[derive(Debug, Args)]
pub struct RenderArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where to write: .png (display), .exr (linear, all channels), .npz (f64). Repeatable.
    /// Default: the scene's name with .png, in the current directory.
    /// A file of this name is replaced when the new one is complete.
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Also write the retarded time as a coloured picture with a legend.
    #[arg(long, value_name = "FILE.png")]
    pub isochrones: Option<PathBuf>,
    /// Distance between isochrones, with its unit. Default: a round number.
    #[arg(long, value_name = "TIME", requires = "isochrones")]
    pub isochrone_step: Option<Time>,
    /// Worker threads. Default: one per core. The pictures do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct InfoArguments {
    /// A .gltf, .glb, .npy, .npz, .exr, .png or .toml file; told apart by content.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
}

/// Parsed `--aovs`.
#[derive(Debug, Clone)]
pub struct AovList(pub Vec<Aov>);

impl SceneArguments {
    /// The changes to the scene file.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            set: self.set.clone(),
            size: self.size,
            samples_per_pixel: self.spp,
            time: self.time.clone(),
            exposure: self.exposure.clone(),
            white: self.white,
        }
    }

    /// What is asked of the scene beyond its file.
    pub fn request(&self) -> nullray::plan::Request {
        nullray::plan::Request {
            aovs: self.aovs.clone().map_or(Vec::new(), |list| list.0),
            pixel_centers: self.pixel_centers,
            memory_limit: self.max_memory,
        }
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text
        .split_once(['x', 'X', '×'])
        .ok_or("write WIDTHxHEIGHT, for instance 640x480")?;
    let pixels = |t: &str| t.trim().parse::<u32>().ok().filter(|n| *n > 0);
    match (pixels(width), pixels(height)) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => Err("width and height are whole numbers above 0".into()),
    }
}

fn assignment(text: &str) -> Result<(String, String), String> {
    let (key, value) = text
        .split_once('=')
        .filter(|(key, _)| !key.trim().is_empty())
        .ok_or("write KEY=VALUE, for instance --set \"camera.time=3 m\"")?;
    Ok((key.trim().into(), value.trim().into()))
}

fn bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1,
        "k" | "kb" | "kib" => 1 << 10,
        "m" | "mb" | "mib" => 1 << 20,
        "g" | "gb" | "gib" => 1 << 30,
        "t" | "tb" | "tib" => 1 << 40,
        other => return Err(format!("\"{other}\" is no unit of memory; write 16GiB")),
    };
    let number = digits
        .trim()
        .parse::<u64>()
        .map_err(|e| format!("{e}; write 16GiB"))?;
    number.checked_mul(unit).ok_or_else(|| "too large".into())
}

fn aovs(text: &str) -> Result<AovList, String> {
    aov::parse(text).map(AovList)
}

/// A percentage; a bare number is one too.
fn percentage(text: &str) -> Result<String, String> {
    let text = match text.trim().parse::<f64>() {
        Ok(number) => format!("{number} %"),
        Err(_) => text.into(),
    };
    let parsed = text.parse::<Percentage>();
    parsed.map(|_| text).map_err(|error| error.to_string())
}
