//! `[[source]]`.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::radiance::Radiance;
use crate::io::cube::{Negative, Transfer};
use crate::scene::at::At;
use crate::scene::model::{BinValues, Clock, FovAxis, ProjectionKind, Reconstruction, TimeFilter};
use crate::scene::values::{Number, NumberOrVector, Vector};
use crate::spacetime::units::{Angle, Time};

/// Time-resolved radiance on the surfaces of objects, from a `cube` of data or from a `pulse`. It replaces the base colour as the
/// surface's radiance; a surface has one cube (or several captures), or any number of pulses.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { pulse = { position = [0, 2, 0], sigma = \"5 cm\" } }"
)]
pub(in crate::scene) struct Source {
    /// A unique name, for messages and `--set`. Default: the cube file's name without its extension, or "pulse", with a number if that
    /// name is taken.
    pub name: Option<At<String>>,
    /// Names of the objects that it applies to. Default: all objects.
    pub objects: Option<At<Vec<At<String>>>>,
    /// Names of the glTF materials that it applies to. Default: all materials of those objects.
    pub materials: Option<At<Vec<At<String>>>>,
    /// A stored x-y-t cube. Excludes `pulse`.
    pub cube: Option<At<Cube>>,
    /// A spherical pulse of light from a point. Excludes `cube`.
    pub pulse: Option<At<Pulse>>,
    /// What this source's radiance measures. Default: the scene's `radiance`.
    pub radiance: Option<At<Radiance>>,
}

/// A stored cube (rows, columns, time bins[, channels]) and its mapping to surface and time.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { file = \"a.npy\", bin_width = \"0.05 m\" }"
)]
pub(in crate::scene) struct Cube {
    /// A .npy, .npz or .ti file, relative to the scene file; or a folder of numbered pictures (.exr, .png, .hdr), or a
    /// pattern for their names, like "frames/{i:03d}.exr" or "streak_%04d.hdr".
    pub file: At<String>,
    /// The array of an .npz file. Default: its only array.
    pub array: Option<At<String>>,
    /// How the codes of .png pictures encode radiance, "linear" or "srgb"; required for them.
    pub transfer: Option<At<Transfer>>,
    /// The order of the array's axes, slowest first as in numpy, like "T H W": H rows, W columns, T time bins, C channels, 1 an axis of
    /// one entry. Without T it is a steady picture: radiance that does not change with time. Default: "H W T", or "H W T C" for four
    /// axes. For pictures, it names files, rows and columns, without the colours: "T H W", the default, for frames, "H W T" for streaks
    /// with time along x.
    pub axes: Option<At<String>>,
    /// What the channels of the array are, in order, each at most once: "R", "G", "B", and companions, "IR" (infrared, 830 to 3500 nm)
    /// and "UV" (ultraviolet, 100 to 360 nm), which shift into view; these need quantity = "rgb". For .exr pictures the names are those
    /// in the file. Default: one channel is grey, three are ["R", "G", "B"].
    pub channels: Option<At<Vec<String>>>,
    /// Time at the start of bin 0, on the clock of `clock`. Default: what the file says (.ti, HDF5, Zarr, and .npz of nullray), or "0 m".
    pub start: Option<At<Time>>,
    /// Time at the centre of bin 0, in place of `start`.
    pub first_center: Option<At<Time>>,
    /// Width of a bin, above 0, like "0.05 m" or "4 ps". Required, except for steady pictures and if the file says it (.ti, HDF5,
    /// Zarr, and .npz of nullray).
    pub bin_width: Option<At<Time>>,
    /// Bins of different widths, in place of `start` and `bin_width`: the start of each bin, and the end of the last,
    /// like ["0 m", "0.1 m", "0.3 m"]; `edges_file` reads them from a file.
    pub edges: Option<At<Vec<At<Time>>>>,
    /// The same from a file.
    pub edges_file: Option<At<EdgesFile>>,
    /// Bins in which the sensor counted nothing, counted from 0: each is interpolated linearly between its nearest live neighbours in
    /// time, by energies per metre where widths differ.
    pub dead_bins: Option<Vec<usize>>,
    /// What to do with samples below 0, which occur in data with a background subtracted: "keep" (they are read as they are, so that
    /// means over many samples are correct), "zero", or "refuse". Default: keep, with a warning that counts them.
    pub negative: Option<At<Negative>>,
    /// The clock of the time axis: "world" (time of emission), "object" (the emitting object's own time
    /// of emission) or "capture" (arrival at the capture camera: time of emission + η × distance to its
    /// pinhole; both in the frame of objects that move). Default: what an .npz of nullray says, or "world".
    pub clock: Option<At<Clock>>,
    /// Whether a value is the integral over its bin, "per_bin", or the mean per metre, "density".
    /// Default: "per_bin".
    pub values: Option<At<BinValues>>,
    /// Reconstruction along time: "nearest", "linear", "cubic", or "cubic_means"
    /// (cubic, with each value taken as its bin's mean and not as the value at its centre). Default: "cubic_means".
    pub filter: Option<At<TimeFilter>>,
    /// Reconstruction across the picture of the cube: "bilinear"; "sharp" (for a `capture`: cubic, with each pixel taken as the mean over
    /// its square: less error, more of the data's noise); or "footprint" (bilinear, averaged over the area of the surface that each
    /// sample covers: no aliasing where a pixel of the picture covers several texels). Default: "bilinear".
    pub reconstruction: Option<At<Reconstruction>>,
    /// Factor on all values, above 0. Default: 1.
    pub scale: Option<At<Number>>,
    /// Surface points address the cube by their texture coordinates TEXCOORD_n with this number n; row 0 of the cube is v = 0. Excludes
    /// `capture`. Default: 0.
    pub uv: Option<At<u32>>,
    /// What the backs of surfaces show, if they are visible: "as_front" (the same light), "black", or "second_half" (their own light:
    /// rows from H/2 on belong to backs, at the same texture coordinates), as written by `bake`; or "as_baked": which of these the .npz
    /// file of `bake` says; refused if it says none. Excludes `capture`. Default: "as_front".
    pub backs: Option<At<Backs>>,
    /// Surface points address the cube by projection into the camera that captured it, if it saw them. Excludes `uv`.
    pub capture: Option<At<Capture>>,
}

/// What the backs of surfaces show of a cube.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub(in crate::scene) enum Backs {
    /// The same as fronts.
    AsFront,
    /// Nothing: they are black, and hide what is behind them.
    Black,
    /// Their own light: the first half of the cube's rows belongs to fronts, the second half to backs, both at the same texture
    /// coordinates.
    SecondHalf,
    /// What the metadata of a file of baked light say.
    AsBaked,
}

/// A table of the edges of bins.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { file = \"edges.npy\", unit = \"1 ps\" }"
)]
pub(in crate::scene) struct EdgesFile {
    /// A .npy or .npz file of one axis, relative to the scene file: the start of each bin, and the end of the last.
    pub file: At<String>,
    /// The array of an .npz file. Default: its only array.
    pub array: Option<At<String>>,
    /// The unit of the numbers, like "1 m" or "1 ps".
    pub unit: At<Time>,
}

/// The pinhole camera that captured a cube, at rest in the frame of the objects that it captured; its coordinates are the world's if
/// those rest in the world, and the objects' own otherwise.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { eye = [0, 1, 5], look_at = [0, 0, 0], hfov = \"40 deg\" }"
)]
pub(in crate::scene) struct Capture {
    /// Position of the pinhole, metres: in the coordinates of the world; if the objects move, in their own, whose zero is their `origin`.
    /// So are `look_at`, `up` and `pose`.
    pub eye: Option<At<Vector>>,
    /// A point on the forward axis.
    pub look_at: Option<At<Vector>>,
    /// The up direction of the data. Default: [0, 1, 0].
    pub up: Option<At<Vector>>,
    /// Takes the pose (and the field of view, unless `hfov` is given) from a camera of this glTF file,
    /// in place of `eye`, `look_at` and `up`.
    pub gltf: Option<At<String>>,
    /// The node of the glTF file that holds the camera. Default: the file's only camera.
    pub node: Option<At<String>>,
    /// The pose as a matrix, or in COLMAP's form, in place of `eye`, `look_at` and `up`.
    pub pose: Option<At<GivenPose>>,
    /// The projection of its pixels: as `camera.projection`. Default: "perspective".
    #[serde(default)]
    pub projection: At<ProjectionKind>,
    /// Horizontal field of view, above 0, up to the projection's limit; the vertical one follows from the cube's shape (square pixels).
    /// Required unless the glTF camera or `fov` gives it.
    pub hfov: Option<At<Angle>>,
    /// The field of view along another axis of the film, given by `fov_axis`, in place of `hfov`.
    pub fov: Option<At<Angle>>,
    /// The axis of `fov`: "x" (as `hfov`), "y", "diagonal", "smaller" or "larger".
    pub fov_axis: Option<At<FovAxis>>,
    /// The whole film, of which the cube is a crop. The field of view is that of the whole film, also the one that COLMAP gives.
    pub crop: Option<At<Crop>>,
    /// The depth of a near plane on which the capture's rays began, metres, at least 0: anything in front of it is not seen, and the
    /// times of `clock = "capture"` lack the path from the pinhole to it, near_clip / cos θ. Default: 0.
    pub near_clip: Option<At<Number>>,
}

/// The pose of a camera as other programs write it: a matrix, or a quaternion and a translation.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]], convention = \"opengl\" }"
)]
pub(in crate::scene) struct GivenPose {
    /// Four rows of four numbers: a rotation, and the translation in the last column, metres.
    pub matrix: Option<[[f64; 4]; 4]>,
    /// The rotation as a unit quaternion [w, x, y, z], in place of `matrix`; with `translation`.
    pub quaternion: Option<[f64; 4]>,
    /// The translation of `quaternion`, metres.
    pub translation: Option<[f64; 3]>,
    /// The meaning of the matrix, or of the quaternion and translation.
    pub convention: Option<PoseConvention>,
    /// The folder of a COLMAP reconstruction (images.bin and cameras.bin, or .txt), relative to the scene file, in place of the other
    /// keys; with `image`. It also gives the field of view, unless `hfov` or `fov` is given.
    pub colmap: Option<At<String>>,
    /// The name of the camera's image in that reconstruction.
    pub image: Option<At<String>>,
    /// The length of COLMAP's unit, metres, above 0: COLMAP chooses it arbitrarily. Only with `colmap`. Default: 1.
    pub scale: Option<At<Number>>,
}

/// The direction of a pose's transformation, and the axes of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum PoseConvention {
    /// From the camera to the world; the camera looks along −z, y is up: glTF, Blender, `transform_matrix` of NeRF.
    OpenGl,
    /// From the camera to the world; the camera looks along +z, y is down.
    OpenCv,
    /// From the camera to the world; the camera looks along +z, y is up: `to_world` of Mitsuba.
    Mitsuba,
    /// From the world to the camera, which looks along +z, y is down: the lines of COLMAP's images.txt.
    Colmap,
}

/// The position of a cube on the film of the camera that captured it.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { film = [512, 512], offset = [128, 64] }"
)]
pub(in crate::scene) struct Crop {
    /// Columns and rows of the whole film.
    pub film: [u32; 2],
    /// Columns and rows of the film left of the cube and above it. Default: [0, 0].
    #[serde(default)]
    pub offset: [u32; 2],
}

/// A spherical pulse of light from a point at rest in the world, Gaussian in time, that illuminates diffuse surfaces: irradiance ∝ cos θ
/// / r², delayed by the travel time of light.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { position = [0, 2, 0], sigma = \"5 cm\" }"
)]
pub(in crate::scene) struct Pulse {
    /// World position of the point, metres.
    pub position: At<Vector>,
    /// World time at which the pulse's centre is emitted. Default: "0 m".
    #[serde(default = "Pulse::time")]
    pub time: At<Time>,
    /// Standard deviation of the Gaussian in time, above 0, like "5 cm" or "20 ps".
    pub sigma: At<Time>,
    /// Energy per solid angle, at least 0: one number, or linear RGB. Default: 1.
    #[serde(default = "Pulse::intensity")]
    pub intensity: At<NumberOrVector>,
    /// Whether other surfaces cast shadows in its light. Default: true.
    #[serde(default = "Pulse::shadows")]
    pub shadows: bool,
}

impl Pulse {
    fn time() -> At<Time> {
        At::nowhere(Time::customary(0.0))
    }

    fn intensity() -> At<NumberOrVector> {
        At::nowhere(NumberOrVector::Number(1.0))
    }

    fn shadows() -> bool {
        true
    }
}
