//! `nullray mesh-from-depth`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use glam::DVec3;
use nullray::io::cube::Axes;
use nullray::scene::model::FovAxis;
use nullray::spacetime::units::{Angle, Time};

use super::shared::{MemoryLimit, Quiet};
use crate::cli::values;

#[derive(Debug, Args)]
pub struct MeshFromDepthArguments {
    /// A cube (.npy, .npz, .ti, pictures), or with --from a map (rows, columns) of metres: .npy, .npz.
    #[arg(value_name = "FILE")]
    pub input: PathBuf,
    /// The .glb file to write. Default: FILE with that extension, in the current directory.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// What the distances come from.
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
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pub fov: Angle,
    /// The axis of the film along which --fov is measured.
    #[arg(long, value_name = "AXIS", default_value = "x")]
    pub fov_axis: FovAxisArgument,
    /// Depth of the near plane on which the capture's rays began, metres.
    #[arg(long, value_name = "METRES", default_value_t = 0.0, value_parser = values::not_negative, allow_negative_numbers = true)]
    pub near_clip: f64,
    /// Where the pulse of light was emitted, metres; for --from first-light.
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    pub lamp: Option<DVec3>,
    /// When the centre of the pulse was emitted. Default: "0 m".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub lamp_time: Option<Time>,
    /// Time at the start of bin 0, by arrival at the camera. Default: what the file says, or "0 m".
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub start: Option<Time>,
    /// Width of a bin, like "0.05 m" or "4 ps"; needed unless the file says it.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub bin_width: Option<Time>,
    /// The array of an .npz file that holds several.
    #[arg(long, value_name = "NAME")]
    pub array: Option<String>,
    /// The order of the cube's axes, like "T H W". Default: "H W T [C]"; for pictures "T H W".
    #[arg(long, value_name = "AXES")]
    pub axes: Option<Axes>,
    /// Refractive index of the medium. Default: what the file says, or 1.
    #[arg(long, value_name = "N", value_parser = values::positive, allow_negative_numbers = true)]
    pub medium_index: Option<f64>,
    /// Take a pixel's first maximum only above this fraction of its highest value. Default: 0.2.
    #[arg(long, value_name = "FRACTION", value_parser = values::positive, allow_negative_numbers = true)]
    pub peak_fraction: Option<f64>,
    /// Leave out pixels below this fraction of the brightest: they are in shadow, where only indirect light arrives. Default: 0.02.
    #[arg(long, value_name = "FRACTION", value_parser = values::positive, allow_negative_numbers = true)]
    pub dark_fraction: Option<f64>,
    /// Do not join neighbours whose distances differ by more than this many pixel widths and by more than they would on a plane.
    #[arg(long, value_name = "PIXELS", default_value_t = 4.0, value_parser = values::positive, allow_negative_numbers = true)]
    pub max_step: f64,
    #[command(flatten)]
    pub memory: MemoryLimit,
    #[command(flatten)]
    pub quiet: Quiet,
}

/// Where the distances come from.
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
