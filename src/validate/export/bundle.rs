//! The contents of `bundle.json`: these types define the format, and its JSON schema is derived from them.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Serialize;

use crate::camera;
use crate::scene::model::{
    Assembly, BackFaces, BinValues, CaptureChoice, Clock, CubeBacks, Effects, Elements, Equations,
    Outside, Pivot, ProjectionKind, Reconstruction, Records, TimeFilter,
};

/// (ct, x, y, z), metres.
pub type FourVector = [f64; 4];
/// In row order; multiplies columns (ct, x, y, z).
pub type Matrix = [FourVector; 4];

/// The description of an exported scene. Lengths are in metres, times are c·t in metres, and c = 1, so that velocities are fractions of
/// the speed of light. Numbers have as many digits as are needed to read them back exactly.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(title = "nullray bundle"))]
#[non_exhaustive]
pub struct Bundle {
    /// Always "nullray-bundle".
    pub format: &'static str,
    /// The version of the format. Readers must refuse unknown versions; keys may be added within a version.
    pub version: u32,
    /// The program that wrote it.
    pub software: String,
    /// Properties of the whole scene.
    pub scene: SceneEntry,
    /// The camera at the moment of the shot.
    pub camera: CameraEntry,
    /// The objects; the channel `object` counts them from 0.
    pub objects: Vec<ObjectEntry>,
    /// Time-resolved radiance of surfaces.
    pub sources: Vec<SourceEntry>,
    /// Lights without extent, except those listed in `scene.undescribed`.
    pub lamps: Vec<LampEntry>,
    /// The channels of the reference, and the auxiliary ones that a candidate may have.
    pub channels: Vec<ChannelEntry>,
    /// The reference pictures; null if they were left out.
    pub reference: Option<ReferenceEntry>,
    /// Test vectors: vertices, and where they are seen; null if they were left out.
    pub vectors: Option<&'static str>,
    /// Every other file of the bundle.
    pub files: Vec<FileEntry>,
}

/// Properties of the whole scene.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct SceneEntry {
    /// The scene file, as it was named.
    pub name: String,
    /// The text of the scene file after all changes, for the record: its paths are relative to its original folder.
    pub text: &'static str,
    /// The speed of light, metres per second; it affects only values given in seconds.
    pub speed_of_light_m_per_s: f64,
    /// Refractive index of the medium, which rests in the world: it delays light without refraction.
    pub medium_index: f64,
    /// η of rays that leave the camera: the medium's index, or 0 if retardation is turned off.
    pub ray_index: f64,
    /// The equations of the reference. The definitions of channels are the exact ones.
    pub equations: Equations,
    /// The effects in the radiance of the reference; W and events always follow the exact physics, except that turning off retardation
    /// means a `ray_index` of 0.
    pub effects: Effects,
    /// Which faces are visible: "as_file" (double-sided materials from both sides, others from the front), "two_sided", "black" (back
    /// faces hide, and are black) or "culled".
    pub back_faces: BackFaces,
    /// Observed linear RGB radiance of rays that hit nothing.
    pub background: [f64; 3],
    /// What the radiance of base colours measures.
    pub base_colour: Radiometry,
    /// Whether lamps, or other lights, illuminate its surfaces: base colours are then reflectances, not radiances.
    pub is_lit: bool,
    /// Contributions to the radiance of the reference that the bundle does not describe, as sentences; empty if there are none. Events, W
    /// and all other channels do not depend on them.
    pub undescribed: Vec<&'static str>,
    /// What replaces data that a cube does not have.
    pub outside: Outside,
    /// Which of several captures of a surface gives its radiance.
    pub captures: CaptureChoice,
    /// Samples per pixel of the scene's own pictures; the reference here has one, at the pixel's centre.
    pub samples_per_pixel: u32,
}

/// A velocity relative to the world.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct VelocityEntry {
    /// The rapidity vector artanh(β) β̂: exact even if β rounds to 1.
    pub rapidity: [f64; 3],
    /// v/c.
    pub beta: [f64; 3],
    /// The Lorentz factor.
    pub gamma: f64,
}

/// The camera at the moment of the shot, or when its shutter opens.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct CameraEntry {
    /// The kind of camera: "still" and "moving" are points whose rays all leave `shot_event`, and are completely described by the matrix;
    /// "unaberrated" is such a point whose directions are not boosted. The rays of all others leave separate events, and the entry is the
    /// state at the shot.
    pub kind: camera::ViewKind,
    /// Whether all rays leave `shot_event`.
    pub is_point: bool,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Horizontal field of view in the camera frame at the shot, radians.
    pub horizontal_fov_rad: f64,
    /// The projection.
    pub projection: ProjectionKind,
    /// Tangents of half the field of view, across and down, in the camera frame at the shot; null for projections
    /// other than "perspective", and for a "bell" sensor in motion, which is no perspective in the camera frame.
    pub tan_half_fov: Option<[f64; 2]>,
    /// Unit vector of the camera frame that points right in the picture.
    pub right: [f64; 3],
    /// Up.
    pub up: [f64; 3],
    /// Into the picture.
    pub forward: [f64; 3],
    /// P: the pinhole's event of the world at the shot.
    pub shot_event: FourVector,
    /// The camera's proper time at the shot.
    pub time: f64,
    /// The pinhole's event when the camera's clock shows 0.
    pub clock_zero_event: FourVector,
    /// Its velocity at the shot.
    pub velocity: VelocityEntry,
    /// L: maps displacements of the camera frame to the world. The camera frame's axes are the world's, boosted without rotation. Its
    /// first column is the camera's four-velocity.
    pub world_from_camera: Matrix,
    /// The motion of the pinhole: "inertial", "acceleration", "segments", "profile", "keyframes", "animation" or
    /// "circle".
    pub motion: &'static str,
    /// The sensor behind the pinhole; null for a point camera.
    pub sensor: Option<SensorEntry>,
    /// The rotation of the sensor; `right`, `up` and `forward` already include it.
    pub rotation: Option<RotationEntry>,
    /// The exposure; null for an instant.
    pub shutter: Option<ShutterEntry>,
}

/// A sensor perpendicular to the forward axis.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct SensorEntry {
    /// The distance from the sensor to the pinhole as `assembly` defines it, metres.
    pub focal_length: f64,
    /// From the middle of the sensor to the pinhole in the camera's own frame at the shot.
    pub own_focal_length: f64,
    /// Width and height.
    pub size: [f64; 2],
    /// "rigid", "world_length" or "bell".
    pub assembly: Assembly,
}

/// A rotating sensor.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct RotationEntry {
    /// Unit vector along the axis, camera frame.
    pub axis: [f64; 3],
    /// Radians per metre of camera time.
    pub rate_rad_per_m: f64,
    /// What the axis passes through.
    pub through: Pivot,
    /// What the elements see.
    pub elements: Elements,
}

/// A shutter.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct ShutterEntry {
    /// Camera time during which it is open.
    pub duration: f64,
    /// What the picture holds.
    pub records: Records,
}

/// An object at rest in its own frame.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct ObjectEntry {
    /// Its name in the scene.
    pub name: String,
    /// Its geometry in its own frame, a GLB file: single precision.
    pub geometry: String,
    /// If the renderer does not use single precision: the same vertices in double precision, a .npy file of shape (vertices, 3) and type
    /// <f8. Null if those of the GLB file are exact.
    pub positions: Option<String>,
    /// Number of vertices.
    pub vertices: u64,
    /// Number of triangles; the channel `primitive` counts them from 0 through all primitives in turn.
    pub triangles: u64,
    /// Its velocity in the world.
    pub velocity: VelocityEntry,
    /// O: the world event of the object's origin when its clock shows 0.
    pub origin: FourVector,
    /// M: maps displacements of the object's frame to the world; an event y of that frame is O + M y in the world.
    pub world_from_object: Matrix,
    /// The primitives of the GLB file, in its order.
    pub parts: Vec<PartEntry>,
}

/// A primitive of an object.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct PartEntry {
    /// Its first triangle.
    pub first_triangle: u32,
    /// Number of triangles.
    pub triangles: u32,
    /// The material's name in its own file, or "".
    pub material: String,
    /// Linear RGB factor; in the GLB file it is clamped to 1.
    pub base_colour: [f32; 3],
    /// Whether a texture of the GLB file multiplies it.
    pub has_texture: bool,
    /// Whether vertex colours multiply it (`COLOR_0` of the GLB file, linear).
    pub has_vertex_colours: bool,
    /// If it has an alpha mask: the surface exists only where alpha (the product of factor, texture and vertex alpha, all in the GLB
    /// file) is at least this.
    pub alpha_cutoff: Option<f32>,
    /// Whether the material says that its back face is visible.
    pub double_sided: bool,
    /// The sets of texture coordinates that it has. Lower sets that are missing here hold zeros in the GLB file.
    pub uv_sets: Vec<usize>,
    /// The source of its radiance: "base_colour", one "cube", or "pulses" (and `lamps`) that illuminate the base colour.
    pub radiance: &'static str,
    /// The sources, as indices into `sources`.
    pub sources: Vec<usize>,
}

/// What a radiance measures.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct Radiometry {
    /// The word used in scene files, like "integrated" or "line".
    pub quantity: &'static str,
    /// The emitted wavelength of a line, metres.
    pub line_wavelength: Option<f64>,
    /// p: the observed radiance is W⁻ᵖ times the emitted one; 0 if the searchlight effect is turned off.
    pub exponent: u32,
    /// If the quantity is "rgb", how its spectra continue below 360 and above 830 nm: "blackbody", "edge", "dark" or "companions" (given
    /// by the channels of cubes). The observed radiance is then M(W) times the emitted one, with the matrix M that README.md defines, and
    /// the exponent is that of its brightness.
    pub continuation: Option<&'static str>,
}

/// Time-resolved radiance of surfaces.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct SourceEntry {
    /// Its name in the scene.
    pub name: String,
    /// What it measures.
    #[serde(flatten)]
    pub radiometry: Radiometry,
    /// A stored cube, or a pulse.
    #[serde(flatten)]
    pub light: LightEntry,
}

/// The origin of a source's radiance.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum LightEntry {
    /// A stored x-y-t cube.
    Cube(Box<CubeEntry>),
    /// A spherical pulse.
    Pulse(PulseEntry),
}

/// A stored cube: rows, columns, time bins, and channels if it has four dimensions.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct CubeEntry {
    /// The .npy or .npz file: within the bundle if it was copied or written there, else its original path.
    pub file: String,
    /// Whether `file` is within the bundle.
    pub is_copied: bool,
    /// The file's SHA-256.
    pub sha256: String,
    /// The array of an .npz that holds several.
    pub array: Option<String>,
    /// The order of the array's axes, slowest first: H rows, W columns, T bins, C channels, 1 an axis of one entry; null if it is H W T
    /// or H W T C.
    pub axes: Option<String>,
    /// Rows, columns, bins, channels; null for a cube that lights nothing.
    pub shape: Option<[usize; 4]>,
    /// What its channels are, in order: "R", "G", "B", "IR" (infrared, 830 to 3500 nm), "UV" (ultraviolet, 100 to 360 nm); null if one is
    /// grey, or three are red, green and blue.
    pub channels: Option<Vec<&'static str>>,
    /// Time at the start of bin 0.
    pub start: f64,
    /// Width of a bin; null if widths differ.
    pub bin_width: Option<f64>,
    /// If widths differ: the start of each bin, and the end of the last.
    pub bin_edges: Option<Vec<f64>>,
    /// Whether a value is the integral over its bin, or the mean per metre.
    pub values: BinValues,
    /// Factor on all values.
    pub scale: f64,
    /// Reconstruction along time from the centres of bins.
    pub filter: TimeFilter,
    /// Reconstruction across the picture: "bilinear"; "sharp": cubic, with pixels taken as means over their squares; "footprint":
    /// bilinear, averaged over the area that each sample of the picture covers.
    pub reconstruction: Reconstruction,
    /// The clock of the time axis: "world" and "object" are times of emission; "capture" is arrival at the
    /// capture camera, the time of emission in its frame plus η times the distance to its pinhole.
    pub clock: Clock,
    /// How surface points address it.
    pub mapping: MappingEntry,
}

/// How surface points address a cube.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(tag = "by", rename_all = "snake_case")]
#[non_exhaustive]
pub enum MappingEntry {
    /// By texture coordinates; row 0 of the cube is v = 0.
    Uv {
        /// TEXCOORD_n.
        set: usize,
        /// What backs show: "black", or "second_half" (rows from H/2 on, at the same texture coordinates). Omitted: the same as fronts.
        #[serde(skip_serializing_if = "Option::is_none")]
        backs: Option<CubeBacks>,
    },
    /// By projection into the camera that captured it, if that saw the point.
    Capture {
        /// Its pinhole: world coordinates for objects at rest in the world, else the first bound object's own.
        eye: [f64; 3],
        /// Unit vector to the right, of the same frame.
        right: [f64; 3],
        /// Up.
        up: [f64; 3],
        /// Forward.
        forward: [f64; 3],
        /// The projection of its pixels.
        projection: ProjectionKind,
        /// Horizontal field of view of the whole film, radians; pixels are square.
        horizontal_fov_rad: f64,
        /// Columns and rows of the whole film, where the cube is a crop of it.
        #[serde(skip_serializing_if = "Option::is_none")]
        film: Option<[u32; 2]>,
        /// Columns and rows of the film left of the cube and above it, where the cube is a crop.
        #[serde(skip_serializing_if = "Option::is_none")]
        offset: Option<[u32; 2]>,
        /// Depth n of a near plane, metres, where there is one: nothing before it is seen, and times of the clock
        /// "capture" are η (r − n / cos θ) after the emission, θ the angle to the forward axis.
        #[serde(skip_serializing_if = "Option::is_none")]
        near_clip: Option<f64>,
    },
}

/// A spherical pulse from a point at rest in the world, reflected diffusely by the base colour: of the
/// irradiance g((t − t₀ − ηr)/σ)/σ · intensity · cos θ / r², albedo/π, g the unit Gaussian.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct PulseEntry {
    /// Where and when its centre is emitted, in the world.
    pub event: FourVector,
    /// σ, metres.
    pub sigma: f64,
    /// Energy per solid angle, linear RGB.
    pub intensity: [f64; 3],
    /// Whether other surfaces cast shadows in its light.
    pub shadows: bool,
}

/// A light without extent: a point, a cone from a point, or parallel light.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct LampEntry {
    /// Its name in the scene.
    pub name: String,
    /// Where it shines to: "point", "spot" or "parallel".
    pub beam: &'static str,
    /// Unit vector of its own frame, whose axes are the world's, boosted without rotation: the axis of the cone, or the way that
    /// parallel light goes; null for a point.
    pub axis: Option<[f64; 3]>,
    /// For a cone, the angles from the axis up to which it has its full intensity, and beyond which it is dark, radians.
    pub cone: Option<[f64; 2]>,
    /// By channel, in its own frame: power per solid angle; for parallel light, power per area on a perpendicular surface.
    pub intensity: [f64; 3],
    /// Factor on the intensity by its proper time.
    pub emission: EmissionEntry,
    /// O: its position in the world when its clock shows 0.
    pub origin: FourVector,
    /// Its velocity in the world.
    pub velocity: VelocityEntry,
    /// M: maps displacements of its frame to the world.
    pub world_from_lamp: Matrix,
    /// Whether surfaces cast shadows in its light.
    pub shadows: bool,
}

/// The brightness of a lamp as a function of its proper time τ.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct EmissionEntry {
    /// "steady": 1; "gaussian": exp(−½ ((τ − centre)/σ)²); "train": such pulses at centre + k period, for k from 0 to count − 1, or for
    /// all integers k if `count` is null; "table": linear between its rows, 0 outside.
    pub kind: &'static str,
    /// The centre of the pulse, or of the first one.
    pub centre: Option<f64>,
    /// σ.
    pub sigma: Option<f64>,
    /// The interval between pulses.
    pub period: Option<f64>,
    /// How many pulses.
    pub count: Option<u32>,
    /// Rows of τ and factor.
    pub table: Option<Vec<[f64; 2]>>,
}

/// A channel.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct ChannelEntry {
    /// Its name in files.
    pub name: &'static str,
    /// What it is, with unit and frame.
    pub meaning: &'static str,
    /// The formula, in the symbols of README.md.
    pub definition: &'static str,
    /// The value where nothing is hit; null if every ray has a value.
    pub no_hit: Option<&'static str>,
    /// Whether the reference has it.
    pub in_reference: bool,
}

/// The reference pictures, by the ray tracer: one ray through each pixel's centre.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct ReferenceEntry {
    /// All channels in double precision, for numpy.
    pub npz: &'static str,
    /// All channels in single precision.
    pub exr: &'static str,
    /// The tone-mapped picture, for viewing.
    pub png: &'static str,
    /// Where the rays go: the ray of column j and row i passes through the film at (j + ½, i + ½) pixels from the top left corner.
    pub sampling: &'static str,
}

/// A file of the bundle.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[non_exhaustive]
pub struct FileEntry {
    /// Its path in the bundle.
    pub path: String,
    /// Its length.
    pub bytes: u64,
    /// Its SHA-256.
    pub sha256: String,
}
