//! `nullray convert`.

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use nullray::io::cube::{Axes, Channels, Negative, Transfer};
use nullray::spacetime::units::Time;

use super::shared::{MemoryLimit, Quiet};
use crate::cli::values;

#[derive(Debug, Args)]
pub struct ConvertArguments {
    /// A .npy, .npz or .ti file, a folder of numbered pictures, or a pattern for their names; an HDF5 file or a Zarr folder, if the
    /// program was built with the features hdf5 or zarr.
    #[arg(value_name = "FILE")]
    pub input: PathBuf,
    /// A .npy or .npz file to write, or, for a name without an extension, a new folder of EXR frames; an .h5 file or a new Zarr folder
    /// (.zarr), if the program was built with the features hdf5 or zarr.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// The array of an .npz or HDF5 file that holds several; axes named L need the number of an entry in brackets, like "H[3]".
    #[arg(long, value_name = "NAME")]
    pub array: Option<String>,
    /// The order of the input's axes, like "T H W". Default: "H W T [C]"; for pictures "T H W".
    #[arg(long, value_name = "AXES")]
    pub axes: Option<Axes>,
    /// What the input's channels are, in order, like "R,G,B,IR,UV". Default: one is grey, three are red, green and blue.
    #[arg(long, value_name = "NAMES")]
    pub channels: Option<Channels>,
    /// How the codes of PNG and TIFF pictures encode radiance.
    #[arg(long, value_name = "HOW")]
    pub transfer: Option<TransferArgument>,
    /// Bins in which the sensor counted nothing, counted from 0: they are interpolated from their neighbours in time.
    #[arg(
        long,
        value_name = "BINS",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub dead_bins: Vec<usize>,
    /// What to do with samples below 0. Default: keep.
    #[arg(long, value_name = "HOW")]
    pub negative: Option<NegativeArgument>,
    /// The order of the output's axes, H or T first. Default: "H W T C".
    #[arg(long, value_name = "AXES")]
    pub to_axes: Option<Axes>,
    /// Keep these rows: the first, and the one after the last, counted from 0.
    #[arg(long, value_name = "FROM:TO", value_parser = values::range, allow_hyphen_values = true)]
    pub rows: Option<Range<usize>>,
    /// Keep these columns.
    #[arg(long, value_name = "FROM:TO", value_parser = values::range, allow_hyphen_values = true)]
    pub columns: Option<Range<usize>>,
    /// Keep these time bins.
    #[arg(long, value_name = "FROM:TO", value_parser = values::range, allow_hyphen_values = true)]
    pub bins: Option<Range<usize>>,
    /// Merge every N neighbouring bins into one: their sum.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    pub merge: Option<u32>,
    /// Values are per metre, not per bin: merged bins are means.
    #[arg(long)]
    pub density: bool,
    /// The type of samples. Default: the input's.
    #[arg(long = "type", value_name = "TYPE")]
    pub sample_type: Option<SampleType>,
    /// Turn times of arrival at the capture camera into times of emission. FILE holds the distance (not
    /// the depth) of every pixel in metres: a .npy file, a picture rendered from the capture camera as .npz, or an HDF5
    /// file of a capture that says where its sensor and its points are.
    #[arg(long, value_name = "FILE", conflicts_with = "warp", group = "way")]
    pub unwarp: Option<PathBuf>,
    /// The reverse of --unwarp.
    #[arg(long, value_name = "FILE", group = "way")]
    pub warp: Option<PathBuf>,
    /// Also write the surface through the points that the pixels see, if the file gives them, as a .glb file with texture coordinates
    /// into the output.
    #[arg(long, value_name = "FILE")]
    pub surface: Option<PathBuf>,
    /// Refractive index of the medium, for --unwarp and --warp. Default: what the file says, or 1.
    #[arg(long, value_name = "N", requires = "way", value_parser = values::positive, allow_negative_numbers = true)]
    pub medium_index: Option<f64>,
    /// Width of the input's bins, like "0.05 m" or "4 ps"; needed for --unwarp and --warp unless the file says it.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub bin_width: Option<Time>,
    /// Time at the start of the input's bin 0; the program then says where the output starts.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub start: Option<Time>,
    #[command(flatten)]
    pub memory: MemoryLimit,
    #[command(flatten)]
    pub quiet: Quiet,
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

/// What to do with samples below 0.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum NegativeArgument {
    /// They stay.
    Keep,
    /// They become 0.
    Zero,
    /// The cube is refused.
    Refuse,
}

impl From<NegativeArgument> for Negative {
    fn from(negative: NegativeArgument) -> Negative {
        match negative {
            NegativeArgument::Keep => Negative::Keep,
            NegativeArgument::Zero => Negative::Zero,
            NegativeArgument::Refuse => Negative::Refuse,
        }
    }
}

/// How codes encode radiance.
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
