//! The scene, resolved: every quantity typed and in metres, every name looked up, nothing loaded.

mod camera;
mod light;
mod panel;
mod sky;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DVec3};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::colour::{Continuation, Spectrum};
use crate::io::cube::{
    Axes, BinSizes, Channels, Cube, CubeChannel, Negative, Recorded, Transfer, Wanted,
};
use crate::mesh::Mesh;
use crate::spacetime::{Event, Quantity, Velocity, World};

pub use crate::io::gltf::{BadTextures, BadVertices};
pub use crate::mesh::Shape;

pub use camera::{
    Assembly, CameraModel, Elements, Integration, Motion, Pivot, ProjectionKind, Records, Rotation,
    Sensor, Shutter, Stereo, Turning,
};
pub use light::{Beam, Brightness, EmissionProfile, Lamp, Light, LightKind};
pub use panel::{Panel, Sheet, Show};
pub use sky::{Catalogue, Sky, SkyNegative, SkyRadiance, Stars, Sun};

/// The largest number of bounces.
pub const MOST_BOUNCES: u32 = 64;

/// The largest number of samples per pixel.
pub const MOST_SAMPLES: u32 = 65_536;

/// A scene, ready to be planned. All lengths and times are in metres (time is ct).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Scene {
    /// The scene file as named by the user, or "built-in scene".
    pub name: String,
    /// The text that was parsed, after overrides; goes into the metadata of outputs.
    pub text: String,
    /// The text of the file, without overrides: for messages.
    pub(crate) file_text: Arc<str>,
    /// The folder within which glTF files may refer to other files, besides their own; `None` for no restriction.
    pub folder: Option<PathBuf>,
    /// Files, and COLMAP folders, that were read in addition to the text: spectra, edges of bins, poses and keyframes.
    pub read: Vec<PathBuf>,
    /// Speed of light of this scene, metres per second: only for converting seconds at the edges.
    pub speed_of_light: f64,
    /// Refractive index η ≥ 1 of the world-static medium; affects the delay of light, and what dielectrics reflect and refract.
    pub medium_index: f64,
    /// The camera.
    pub camera: CameraModel,
    /// The objects, in the order of the file.
    pub objects: Vec<Object>,
    /// Lights, in the order of the file.
    pub lights: Vec<Light>,
    /// Time-resolved sources, in the order of the file.
    pub sources: Vec<Source>,
    /// What the radiance of base colours measures, and that of sources without their own quantity.
    pub quantity: Quantity,
    /// How RGB spectra continue outside the range visible at rest.
    pub continuation: Continuation,
    /// Exact special relativity, or the equations of the paper.
    pub equations: Equations,
    /// The four effects, each on unless turned off.
    pub effects: Effects,
    /// How many further times light is reflected after the first surface that it hits.
    pub bounces: u32,
    /// Whether surfaces reflect colours or spectra.
    pub spectra: Spectra,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Which of several captures of a surface gives its radiance.
    pub captures: CaptureChoice,
    /// What replaces data that a source does not have.
    pub outside: Outside,
    /// Back faces, if the scene overrides the files.
    pub back_faces: BackFaces,
    /// Light from infinity.
    pub sky: Option<Sky>,
    /// Linear RGB radiance of rays that hit nothing, as observed, if there is no sky.
    pub background: [f64; 3],
    /// Bits per sample of the PNG: 8 or 16.
    pub bits: u8,
    /// The observed wavelength that is shown as 555 nm, metres, with all others in proportion; `None` for true colours.
    pub false_colour: Option<f64>,
    /// The range that the colours of isochrones span, metres of ct; `None` for the range in each picture.
    pub times: Option<[f64; 2]>,
    /// The range that the colours of luminance span; `None` for the range in each picture.
    pub luminances: Option<[f64; 2]>,
    /// The light whose isochrones are drawn, if it is not that of the picture.
    pub flash_times: Option<FlashTimes>,
    /// Text below pictures, with the camera's time and speed; `None` for no text.
    pub caption: Option<String>,
    /// Display of the PNG: exposure.
    pub exposure: Exposure,
    /// Samples per pixel (powers of 4 are distributed most evenly: their strata are squares, and their Sobol' points fill all intervals).
    pub samples_per_pixel: u32,
    /// Parts of its files that are ignored, in sentences.
    pub passed_over: Vec<String>,
    /// Variants of the scene, in the order of the file.
    pub panels: Vec<Panel>,
    /// How they are arranged on one page.
    pub sheet: Sheet,
}

/// The equations that a picture follows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Equations {
    /// Special relativity.
    #[default]
    Exact,
    /// Those of Jarabo et al. 2015, with their approximations.
    Paper2015,
}

/// What surfaces reflect.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Spectra {
    /// Red, green and blue as they reach the surface in its rest frame.
    #[default]
    Rgb,
    /// The spectrum, at three wavelengths per sample.
    Sampled,
}

impl Spectra {
    /// Its name in the scene file.
    pub fn name(self) -> &'static str {
        match self {
            Spectra::Rgb => "rgb",
            Spectra::Sampled => "sampled",
        }
    }
}

/// A body with geometry, at rest in its own frame.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Object {
    /// Unique name.
    pub name: String,
    /// Where its triangles come from.
    pub geometry: Geometry,
    /// The spectrum that it emits, in place of base colours and sources.
    pub spectrum: Option<Spectrum>,
    /// Further texture coordinates, as the set after those of the mesh.
    pub texture_coordinates: Option<CoordinateFile>,
    /// Object coordinates from the file's (or shape's) coordinates.
    pub transform: DAffine3,
    /// What to do about vertices that no ray can hit.
    pub bad_vertices: BadVertices,
    /// What to do about textures that cannot be shown.
    pub bad_textures: BadTextures,
    /// Velocity in the world.
    pub velocity: Velocity,
    /// The world event of the object's origin when its clock shows 0.
    pub origin: Event<World>,
    /// A byte range of the scene text to point at in messages.
    pub span: std::ops::Range<usize>,
}

/// A file of texture coordinates, shape (triangles, 3, 2).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CoordinateFile {
    /// Relative paths are already resolved against the scene file.
    pub path: PathBuf,
    /// The array of an `.npz`.
    pub array: Option<String>,
}

/// Where an object's triangles come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// A glTF or GLB file, and a node of it by name (with everything below it), or its default scene.
    Gltf {
        /// Path, relative paths already resolved against the scene file.
        path: PathBuf,
        /// Only this node and its children.
        node: Option<String>,
    },
    /// A built-in shape.
    Shape {
        /// The shape.
        shape: Shape,
        /// Linear RGB base colour.
        colour: [f32; 3],
        /// Metalness, 0 to 1.
        metallic: f32,
        /// Perceptual roughness, 0 to 1.
        roughness: f32,
        /// The fraction of the light not reflected that passes through, 0 to 1.
        transmission: f32,
        /// Refractive index of the body.
        ior: f32,
    },
    /// A mesh in memory, in its own coordinates. Its materials' textures are not available.
    Mesh(Arc<Mesh>),
}

/// A time-resolved source of radiance on surfaces.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Source {
    /// Unique name.
    pub name: String,
    /// The surfaces that it applies to.
    pub binding: Binding,
    /// The radiance.
    pub kind: SourceKind,
    /// What its radiance measures.
    pub quantity: Quantity,
    /// A byte range of the scene text to point at in messages.
    pub span: std::ops::Range<usize>,
}

/// Which surfaces a source is bound to.
#[derive(Debug, Clone, PartialEq)]
pub enum Binding {
    /// All objects of the scene.
    All,
    /// Objects (indices into [`Scene::objects`]) and, if not empty, only these materials of them (names in the glTF file).
    Only {
        /// Object indices, ascending.
        objects: Vec<usize>,
        /// Material names.
        materials: Vec<String>,
    },
}

/// Where a source's radiance comes from.
#[derive(Debug, Clone)]
pub enum SourceKind {
    /// A stored x-y-t cube.
    Cube(Box<CubeSource>),
    /// A spherical pulse of light.
    Pulse(Pulse),
}

/// A stored cube (H, W, T[, C]) and its mapping to surface and time.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct CubeSource {
    /// The samples.
    pub data: CubeData,
    /// What the channels are; grey, or red, green and blue, if `None`.
    pub channels: Option<Channels>,
    /// How surface points address it.
    pub mapping: Mapping,
    /// Which clock its time axis shows.
    pub clock: Clock,
    /// Its bins in time.
    pub bins: TimeBins,
    /// Whether values are per bin or per metre.
    pub values: BinValues,
    /// Reconstruction along time.
    pub filter: TimeFilter,
    /// Reconstruction across the picture.
    pub reconstruction: Reconstruction,
    /// Factor on all values.
    pub scale: f64,
    /// What to do with samples below 0, if the scene says so; a cube in memory has been treated.
    pub negative: Option<Negative>,
    /// What its file says of its light.
    pub recorded: Recorded,
    /// The keys that the scene omits and its file gives, with their values.
    pub read: Vec<String>,
    /// The keys that the scene omits, with the values assumed.
    pub assumed: Vec<String>,
}

impl Scene {
    /// The companions of `cube` that are visible: the channels beside red, green and blue, if they continue the scene's spectra and
    /// wavelengths are shifted.
    pub fn companions_of(&self, cube: &CubeSource) -> Vec<CubeChannel> {
        match self.effects.doppler && self.continuation == Continuation::Companions {
            true => cube.companions(),
            false => Vec::new(),
        }
    }
}

impl CubeSource {
    /// What to read from `file`, which holds it.
    pub fn wanted<'a>(&'a self, file: &'a CubeFile) -> Wanted<'a> {
        Wanted {
            array: file.array.as_deref(),
            axes: file.axes.as_ref(),
            channels: self.channels.as_ref(),
            transfer: file.transfer,
            dead_bins: &file.dead_bins,
            bin_sizes: file.bin_sizes.as_ref(),
            negative: self.negative,
            memory: None,
        }
    }

    /// The channels beside red, green and blue that the scene declares.
    pub fn companions(&self) -> Vec<CubeChannel> {
        self.channels
            .as_ref()
            .map_or_else(Vec::new, Channels::companions)
    }

    /// Whether lookups may be means over time spans, through `camera`: over parts of an exposure, or over sample footprints.
    pub(crate) fn is_read_over_spans(&self, camera: &CameraModel) -> bool {
        camera.integrated_exposure().is_some() || self.reconstruction == Reconstruction::Footprint
    }
}

/// The bins of a time axis, metres of ct.
#[derive(Debug, Clone, PartialEq)]
pub enum TimeBins {
    /// All of the same width.
    Uniform {
        /// Time at the *start* of bin 0.
        start: f64,
        /// Width of a bin, above 0.
        width: f64,
    },
    /// The start of each bin and the end of the last, ascending.
    Edges(Arc<[f64]>),
}

impl TimeBins {
    /// The start of bin `bin`, and the end of the one before it.
    pub fn edge(&self, bin: usize) -> f64 {
        match self {
            TimeBins::Uniform { start, width } => start + bin as f64 * width,
            TimeBins::Edges(edges) => edges.get(bin).or(edges.last()).copied().unwrap_or(0.0),
        }
    }

    /// The width of a bin; the mean width if they differ.
    pub fn width(&self) -> f64 {
        match self {
            TimeBins::Uniform { width, .. } => *width,
            TimeBins::Edges(edges) => {
                let count = edges.len().saturating_sub(1);
                (self.edge(count) - self.edge(0)) / count.max(1) as f64
            }
        }
    }

    /// The width of the narrowest bin.
    pub fn least_width(&self) -> f64 {
        match self {
            TimeBins::Uniform { width, .. } => *width,
            TimeBins::Edges(edges) => (edges.windows(2))
                .map(|pair| pair[1] - pair[0])
                .fold(f64::INFINITY, f64::min),
        }
    }

    /// The same bins, as uniform ones if these edges are even but for rounding.
    ///
    /// Rounding to single precision moves an edge by up to 2⁻²⁴ of it, and so a line through two such edges. An edge that is off by a
    /// thousandth of a bin changes a density by 2 ‰ at most: that is how far tables at late times may be rounded to count as even.
    #[must_use]
    pub fn evenly(&self) -> TimeBins {
        let (start, width) = (self.edge(0), self.width());
        let even = TimeBins::Uniform { start, width };
        let TimeBins::Edges(edges) = self else {
            return even;
        };
        let largest = edges
            .iter()
            .fold(0.0, |most: f64, edge| most.max(edge.abs()));
        let tolerated = (1e-3 * width).min(largest / f64::from(1 << 23));
        let is_even = |(bin, edge): (usize, &f64)| (edge - even.edge(bin)).abs() <= tolerated;
        match width > 0.0 && edges.iter().enumerate().all(is_even) {
            true => even,
            false => self.clone(),
        }
    }

    /// The same bins, `time` later.
    pub fn shifted(&self, time: f64) -> TimeBins {
        match self {
            &TimeBins::Uniform { start, width } => TimeBins::Uniform {
                start: start + time,
                width,
            },
            TimeBins::Edges(edges) => {
                TimeBins::Edges(edges.iter().map(|edge| edge + time).collect())
            }
        }
    }
}

/// Where the samples of a cube are.
#[derive(Debug, Clone, PartialEq)]
pub enum CubeData {
    /// In a file, or a sequence of pictures.
    File(CubeFile),
    /// In memory.
    Memory(Arc<Cube>),
}

/// A file of a cube, or a sequence of pictures.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct CubeFile {
    /// Relative paths are already resolved against the scene file.
    pub path: PathBuf,
    /// The array of an `.npz`; needed if it holds several.
    pub array: Option<String>,
    /// The order of its axes, if the scene gives it.
    pub axes: Option<Axes>,
    /// How the codes of PNG pictures encode radiance.
    pub transfer: Option<Transfer>,
    /// Bins in which the sensor counted nothing.
    pub dead_bins: Vec<usize>,
    /// By what these are interpolated where bins differ in width.
    pub bin_sizes: Option<BinSizes>,
}

impl CubeData {
    /// The file that holds them, if any.
    pub fn path(&self) -> Option<&Path> {
        match self {
            CubeData::File(file) => Some(&file.path),
            CubeData::Memory(_) => None,
        }
    }
}

/// How a surface point addresses a cube.
#[derive(Debug, Clone)]
pub enum Mapping {
    /// By texture coordinates of this set; row 0 of the cube is v = 0.
    Uv {
        /// TEXCOORD set.
        set: usize,
        /// What backs show.
        backs: CubeBacks,
    },
    /// By projection into a capture camera, if it saw the point.
    Capture(CaptureCamera),
}

/// The pinhole camera that captured a cube, at rest in the frame of the objects that it captured.
#[derive(Debug, Clone, PartialEq)]
pub struct CaptureCamera {
    /// Pinhole. For objects at rest in the world: world coordinates. For moving ones: their own.
    pub eye: DVec3,
    /// Orthonormal axes: right, up, forward.
    pub axes: [DVec3; 3],
    /// The projection of its pixels.
    pub projection: ProjectionKind,
    /// Field of view of the whole film, radians. The aspect follows from the film's shape.
    pub fov: f64,
    /// The axis along which `fov` is measured.
    pub fov_axis: FovAxis,
    /// The position of the cube on the film; `None` if it covers all of it.
    pub crop: Option<Crop>,
    /// Columns and rows of the pictures of its camera, if they are known and the cube should be one: of this size if it has a place on a
    /// larger film, and of this shape otherwise.
    pub picture: Option<[u32; 2]>,
    /// Depth of the plane on which the capture's rays began, metres, at least 0.
    pub near_clip: f64,
}

impl CaptureCamera {
    /// A perspective camera whose film is the cube, with this horizontal field of view and without a near plane.
    pub fn new(eye: DVec3, axes: [DVec3; 3], horizontal_fov: f64) -> Self {
        CaptureCamera {
            eye,
            axes,
            projection: ProjectionKind::Perspective,
            fov: horizontal_fov,
            fov_axis: FovAxis::X,
            crop: None,
            picture: None,
            near_clip: 0.0,
        }
    }

    /// Columns and rows of the whole film, for a cube of `size` columns and rows.
    pub fn film(&self, size: [usize; 2]) -> [f64; 2] {
        match self.crop {
            Some(crop) => crop.film.map(f64::from),
            None => size.map(|n| n as f64),
        }
    }

    /// The horizontal field of view, radians, of the whole film, for a cube of `size` columns and rows.
    ///
    /// On a plane at depth 1, half the film's width, height and diagonal are the tangents of half their fields of view, and are in the
    /// ratio w : h : √(w² + h²).
    pub fn horizontal_fov(&self, size: [usize; 2]) -> f64 {
        let [w, h] = self.film(size);
        let along = match self.fov_axis {
            FovAxis::X => w,
            FovAxis::Y => h,
            FovAxis::Diagonal => libm::hypot(w, h),
            FovAxis::Smaller => w.min(h),
            FovAxis::Larger => w.max(h),
        };
        // A horizontal field of view is returned as it is, to keep its digits.
        if along == w {
            return self.fov;
        }
        2.0 * libm::atan(libm::tan(0.5 * self.fov) * (w / along))
    }
}

/// An axis of a film along which a field of view is given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum FovAxis {
    /// Across the columns.
    #[default]
    X,
    /// Across the rows.
    Y,
    /// From corner to corner.
    Diagonal,
    /// The one with fewer pixels.
    Smaller,
    /// The one with more pixels.
    Larger,
}

/// The position of a cube on the film of its camera, in columns and rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop {
    /// The size of the whole film.
    pub film: [u32; 2],
    /// The offset of the cube from the left and the top of the film.
    pub offset: [u32; 2],
}

/// The clock that a time axis shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// World time of the emission event.
    #[default]
    World,
    /// The emitting object's own time.
    Object,
    /// Arrival at the capture camera ("warped"): the frame's time of emission plus
    /// η × *distance* to the capture pinhole. Needs a capture camera. The frame's time is world time
    /// for objects at rest in the world and the object's own for others.
    Capture,
}

impl Clock {
    /// That of this name in scene files.
    pub(crate) fn named(name: &str) -> Option<Clock> {
        serde_json::from_value(name.into()).ok()
    }

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Clock::World => "world",
            Clock::Object => "object",
            Clock::Capture => "capture",
        }
    }
}

/// The meaning of a stored value along time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum BinValues {
    /// The integral over the bin.
    #[default]
    PerBin,
    /// The mean density per metre over the bin.
    Density,
}

/// Reconstruction along time from bin-centred values.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TimeFilter {
    /// The bin's own value.
    Nearest,
    /// Linear between bin centres.
    Linear,
    /// Cubic (Catmull–Rom) through bin centres.
    Cubic,
    /// Cubic, with each bin's value taken as its mean, not as the value at its centre: sharper on smooth data, and six bins wide. Of the
    /// four it has the smallest error on all frames of an independent renderer, by factors of 1.07 to 3.4 over linear.
    #[default]
    CubicMeans,
}

/// What the backs of surfaces show of a cube on texture coordinates, if they are visible.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum CubeBacks {
    /// The same as fronts.
    #[default]
    AsFront,
    /// Nothing: they are black, and hide what is behind them.
    Black,
    /// Their own light: the first half of the cube's rows belongs to fronts, the second half to backs, both at the same texture
    /// coordinates.
    SecondHalf,
}

impl CubeBacks {
    /// The key in files of baked light.
    pub(crate) const KEY: &str = "backs";

    /// That of this name in scene files.
    pub(crate) fn named(name: &str) -> Option<CubeBacks> {
        serde_json::from_value(name.into()).ok()
    }

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            CubeBacks::AsFront => "as_front",
            CubeBacks::Black => "black",
            CubeBacks::SecondHalf => "second_half",
        }
    }
}

/// Reconstruction across the picture of a cube.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Reconstruction {
    /// Linear between the centres of pixels, along both axes.
    #[default]
    Bilinear,
    /// Cubic, with each pixel's value taken as the mean over its square: on smooth surfaces 1.1 to 2.7 times less error on all frames of
    /// an independent renderer, more of the data's noise, and up to 80 samples in time where bilinear reads 4.
    Sharp,
    /// Bilinear, averaged over the area of the surface that each sample of the picture covers, if that is wider than a texel or takes
    /// longer than a bin: up to 64 × 64 lookups, each at its own point and time, or over its own part of the time span.
    Footprint,
}

/// A spherical pulse from a point at rest in the world that illuminates diffuse surfaces.
///
/// Irradiance at distance r: I(t − ηr) cos θ / r², with I(t) = intensity · g((t − t₀)/σ)/σ per metre of time, g the unit Gaussian;
/// albedo/π of it is reflected. The albedo is the surface's base colour.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Pulse {
    /// The event of emission of the pulse's centre.
    pub origin: Event<World>,
    /// Standard deviation of the Gaussian in time, metres, above 0.
    pub sigma: f64,
    /// Energy per solid angle, by channel.
    pub intensity: [f64; 3],
    /// Whether other surfaces cast shadows in its light.
    pub shadows: bool,
}

/// The effects of relativity and of the delay of light; each can be turned off separately.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct Effects {
    /// Off: a look direction of the camera frame is used as the same direction in the world.
    pub aberration: bool,
    /// Off: colours are those of the emitted wavelength.
    pub doppler: bool,
    /// Off: the observed radiance is the emitted one.
    pub searchlight: bool,
    /// Off: light takes no time (η = 0 in the ray): surfaces are hit, and their radiance looked up,
    /// at the world time of the shot.
    pub retardation: bool,
}

/// Which of several captures of a surface gives its radiance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CaptureChoice {
    /// All that contain the point, weighted by how well they see it.
    #[default]
    Blend,
    /// The first in the scene that contains it.
    First,
}

/// What replaces data that a source does not have; the coverage channel says where.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct Outside {
    /// Before the first bin.
    pub before: Fill,
    /// After the last bin.
    pub after: Fill,
    /// Beyond the texture's edge (UV outside [0, 1] or outside the capture camera's image).
    pub off_texture: Fill,
    /// Not seen by the capture camera.
    pub occluded: Fill,
}

/// A substitute for missing data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Fill {
    /// Radiance 0.
    Black,
    /// A conspicuous linear RGB radiance; not multiplied by any factor.
    Mark([f64; 3]),
    /// The nearest available data (time or position clamped).
    Hold,
}

/// Which faces of a triangle are visible.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum BackFaces {
    /// By each file's materials: double-sided or culled.
    #[default]
    AsFile,
    /// Both faces alike.
    TwoSided,
    /// Back faces are black, and hide what is behind them.
    Black,
    /// Back faces are absent: rays from behind pass, including shadow rays.
    Culled,
}

/// The light of one flash whose isochrones are drawn, on bodies at rest in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlashTimes {
    /// The flash.
    pub flash: Event<World>,
    /// The clock for the arrival of its light.
    pub clock: FlashClock,
}

/// Where the light of a flash is received, after reaching a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FlashClock {
    /// At the surface: world time.
    World,
    /// At the scene's camera, at rest: its clock shows 0 at this event.
    Camera(Event<World>),
    /// At a capture camera at rest here, whose clock shows world time.
    Capture(DVec3),
}

/// The factor between linear radiance and the display.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Exposure {
    /// This percentile of the brightest channel (of lit pixels, as displayed) becomes white, in (0, 100].
    Percentile(f64),
    /// Radiance of white, above 0.
    White(f64),
    /// Radiances of black and white, both above 0; between them by the logarithm.
    Logarithmic([f64; 2]),
}

impl Exposure {
    /// How many times as bright one part of a picture, or one picture of a series, may be as another on a linear display.
    const LINEAR: f64 = 30.0;
    /// How many times darker black is on a logarithmic display: room for shadows.
    const SHADOWS: f64 = 100.0;
    /// Beyond nine decades neighbouring radiances would share a code.
    const DECADES: f64 = 1e9;

    /// White over black on a logarithmic display for pictures, or parts of one, of which the brightest is `range` times as bright as the
    /// darkest; `None` if a linear display shows them all.
    pub fn white_over_black(range: f64) -> Option<f64> {
        (range > Self::LINEAR).then(|| (range * Self::SHADOWS).min(Self::DECADES))
    }
}

impl Default for Exposure {
    /// The 99th percentile.
    fn default() -> Self {
        Exposure::Percentile(99.0)
    }
}
