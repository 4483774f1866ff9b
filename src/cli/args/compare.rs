//! `nullray compare`.

use std::path::PathBuf;

use clap::Args;
use nullray::spacetime::units::Time;
use nullray::validate::compare::{Encoding, NotFinite, Tolerance};

use super::shared::{Json, MemoryLimit, WorkArguments};
use crate::cli::values;

#[derive(Debug, Args)]
#[command(mut_arg("max_memory", |it| it.help("Memory limit, also --memory; pictures that take more are refused. Default: three quarters of what is available")))]
pub struct CompareArguments {
    /// The reference picture: .exr, .png, .npz or .npy.
    #[arg(value_name = "REFERENCE")]
    pub reference: PathBuf,
    /// The picture to test against it.
    #[arg(value_name = "CANDIDATE")]
    pub candidate: PathBuf,
    /// Channels, or groups of channels, to compare: "radiance,event". Both pictures must have them. Default: all that
    /// both have.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub channels: Vec<String>,
    /// The scene that the reference shows. Default: the one in its metadata, as far as that works without meshes
    /// and cubes. Geometric errors are measured in this scene, and diagnoses render it where they need to.
    #[arg(long, value_name = "FILE.toml")]
    pub scene: Option<PathBuf>,
    /// A picture of the same size; only pixels where it is bright are compared.
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,
    /// Compare only this rectangle: left column, top row, width and height.
    #[arg(long, value_name = "X,Y,W,H", value_parser = values::crop, allow_hyphen_values = true)]
    pub crop: Option<[u32; 4]>,
    /// The encoding of a .png: "srgb" or "linear". Default: srgb.
    #[arg(long, value_name = "NAME", value_parser = values::transfer)]
    pub transfer: Option<Encoding>,
    /// How to treat radiance that is NaN or infinite: "refuse", "ignore" (its pixels do not count), "count-as=VALUE".
    /// Default: refuse.
    #[arg(long, value_name = "POLICY", value_parser = values::nan)]
    pub nan: Option<NotFinite>,
    /// What `object` and `primitive` hold where nothing is hit, besides −1 and the largest number of an unsigned type.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub no_hit: Option<i64>,
    /// Width of a time bin, with its unit: "5 mm" or "16 ps". Errors of emission times are then reported in bins too.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub bin_width: Option<Time>,
    /// Pixels per degree of visual angle for FLIP. Default: 67.02, a 3840-pixel display of 0.7 m at 0.7 m.
    #[arg(long, value_name = "N", conflicts_with = "no_flip", value_parser = values::ppd, allow_negative_numbers = true)]
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
    #[command(flatten)]
    pub memory: MemoryLimit,
    #[command(flatten)]
    pub json: Json,
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
    #[command(flatten)]
    pub work: WorkArguments,
}
