//! `nullray bake`.

use std::path::PathBuf;

use clap::Args;
use nullray::spacetime::units::Time;

use super::render::FlashArguments;
use super::shared::{SceneArguments, WorkArguments};
use crate::cli::values;

#[derive(Debug, Args)]
// Options of every scene that a bake refuses, with the reason, are not shown.
#[command(mut_arg("exposure", |it| it.hide(true)), mut_arg("white", |it| it.hide(true)), mut_arg("time", |it| it.hide(true)))]
#[command(mut_arg("flash", |flash| flash.help("Bake the light of a flash on a model without a scene, as `nullray render MODEL --flash` does; the lamp, bins and samples are chosen automatically").conflicts_with_all(["camera", "object", "uv", "atlas", "start", "bin_width", "bins", "half"])))]
pub struct BakeArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where to write: .npz with the array radiance (H, W, T, 3) of energies per bin, f32, its standard_error by bin and metadata, or
    /// .npy with the energies alone; with several objects, one file per object, named after it. Finished parts are kept in FILE.parts
    /// until the bake is complete: run the same command again to resume. Then objects whose .npz files are complete are not baked again. Default: the scene's name with -light.npz, in the current
    /// directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Bake what the scene's camera sees, by time of arrival, instead of the objects' surfaces. The camera must be at rest relative to
    /// the objects.
    #[arg(long, conflicts_with_all = ["object", "texels", "uv", "atlas"])]
    pub camera: bool,
    /// Bake the surface of this object. Default: all objects that reflect light. Repeatable.
    #[arg(long, value_name = "NAME")]
    pub object: Vec<String>,
    /// Columns and rows of texels of a surface. Default: 64x64.
    #[arg(long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    pub texels: Option<[u32; 2]>,
    /// The set of texture coordinates; no two parts of an object's surface may overlap in it. Default: the first set
    /// without overlaps and with two texels between charts, or an atlas for objects that have none.
    #[arg(long, value_name = "SET", allow_negative_numbers = true)]
    pub uv: Option<u8>,
    /// Make texture coordinates that do not overlap: an atlas of flat charts. They are written with the light, as the array
    /// texture_coordinates of an .npz file.
    #[arg(long, conflicts_with = "uv")]
    pub atlas: bool,
    /// The time at which the first bin starts. Default: 0.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub start: Option<Time>,
    /// Width of a bin, with its unit: "5 cm" or "100 ps". Required, except with --flash.
    #[arg(
        long,
        value_name = "TIME",
        required_unless_present = "flash",
        allow_hyphen_values = true
    )]
    pub bin_width: Option<Time>,
    /// The number of bins.
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=65_536), allow_negative_numbers = true)]
    pub bins: u32,
    /// Energies in half precision.
    #[arg(long)]
    pub half: bool,
    /// Print what would be loaded and how much memory it would take, and bake nothing.
    #[arg(long)]
    pub plan: bool,
    #[command(flatten)]
    pub work: WorkArguments,
    #[command(flatten)]
    pub goal: GoalArguments,
    // Last, because options that follow would appear under its heading.
    #[command(flatten)]
    pub flash: FlashArguments,
}

/// What the number of samples is chosen for.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "Choosing the number of samples")]
pub struct GoalArguments {
    /// As many samples as it takes for this standard error of a bin, relative to the root mean square of all bins: "5 %". A trial of up to
    /// one in 16 texels finds the number, a power of two; with --spp and that number the light has the same bits.
    #[arg(long, value_name = "PERCENT", conflicts_with_all = ["spp", "pixel_centers"], value_parser = values::relative_error, allow_hyphen_values = true)]
    pub error: Option<f64>,
    /// As many samples as are expected to fit in this time: "60 s", "5 min" or "1 h" (without a unit, in seconds); with --error, no more than that needs.
    #[arg(long, value_name = "TIME", conflicts_with_all = ["spp", "pixel_centers"], value_parser = values::work_time, allow_hyphen_values = true)]
    pub budget: Option<f64>,
}
