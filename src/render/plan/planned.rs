//! The options of a request, and the contents of a plan.

use std::path::PathBuf;
use std::sync::Arc;

use serde::Serialize;

use crate::accel::{ExpectedRays, Precision, Preset};
use crate::camera;
use crate::mesh::Factors;
use crate::render::aov::Aov;
use crate::render::film::Layout;
use crate::scene::model::{BackFaces, Scene};

/// Options of a render that are not in the scene file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// Auxiliary channels.
    pub aovs: Vec<Aov>,
    /// One sample per pixel, at its centre.
    pub pixel_centers: bool,
    /// The memory limit for the scene, bytes. Default: 16 GiB.
    pub memory_limit: u64,
    /// Precision of visibility. Default: certified.
    pub precision: Precision,
    /// Memory held beside the picture, bytes: maps that are warped, films on which lines are traced. Default: 0.
    pub beside: u64,
    /// Memory of the program itself, bytes: its code, stacks, tables, allocator overhead. Default: 0.
    pub program: u64,
    /// The number of pictures rendered from what is loaded: trees are built for their rays. Default: 1.
    pub pictures: u64,
}

impl Default for Request {
    fn default() -> Self {
        Request {
            aovs: Vec::new(),
            pixel_centers: false,
            memory_limit: 16 << 30,
            precision: Precision::Certified,
            beside: 0,
            program: 0,
            pictures: 1,
        }
    }
}

/// What will be done.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Plan {
    /// The scene's name.
    pub scene: String,
    /// How film points become world directions.
    pub view: camera::ViewKind,
    /// Whether parts of the film see nothing: the corners of a fisheye, or what is beyond the poles of a panorama.
    pub has_blind_points: bool,
    /// The rest frames; one BVH each.
    pub frames: Vec<PlannedFrame>,
    /// For each object of the scene, what is loaded of it.
    pub objects: Vec<PlannedObject>,
    /// For each source of the scene: its cube, if it has one and lights anything.
    pub cubes: Vec<Option<PlannedCube>>,
    /// Whether any radiance varies with time.
    pub time_resolved: bool,
    /// Film: size, samples per pixel, channels.
    pub film: Layout,
    /// Rays that will be traced.
    pub rays: Rays,
    /// How much work goes into the trees.
    pub trees: Preset,
    /// Memory, bytes; without decoded textures, whose size is known only when their headers are read.
    pub memory: Memory,
    /// The memory limit, bytes: [`prepare`](crate::render::prepare) keeps textures within it.
    pub memory_limit: u64,
    /// Whether light that surfaces reflect is sampled at wavelengths.
    #[serde(skip)]
    pub(crate) samples_spectra: bool,
    /// Whether parts of cubes are only counted, not read: for [`estimate_reads`](crate::render::estimate_reads).
    #[serde(skip)]
    pub(crate) counts_only: bool,
    /// The scene that was planned.
    #[serde(skip)]
    pub(crate) of: Arc<Scene>,
    /// What is not done, and why.
    pub skipped: Vec<Skipped>,
    /// What the pictures do not show, and other remarks.
    pub notes: Vec<String>,
}

/// Objects at rest relative to each other.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct PlannedFrame {
    /// β in the world.
    pub beta: [f64; 3],
    /// γ.
    pub gamma: f64,
    /// Indices of the objects.
    pub objects: Vec<usize>,
    /// Triangles.
    pub triangles: u64,
}

/// What is loaded of an object.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct PlannedObject {
    /// The object's name.
    pub name: String,
    /// The file; `None` for a built-in shape or a mesh in memory.
    pub file: Option<PathBuf>,
    /// The substitute for the file name if there is none.
    #[serde(skip)]
    pub(super) without_file: &'static str,
    /// Files that this one refers to.
    pub files: Vec<PathBuf>,
    /// Triangles.
    pub triangles: u64,
    /// Vertices.
    pub vertices: u64,
    /// Whether texture coordinates are loaded.
    pub uvs: bool,
    /// Whether base colour textures and vertex colours are loaded.
    pub textures: bool,
    /// Whether normals of vertices are loaded.
    pub normals: bool,
    /// What gives it radiance.
    pub radiance: Vec<String>,
    /// Whether it has holes: a material with an alpha mask.
    pub has_masks: bool,
    /// Sets of texture coordinates that its file has.
    pub uv_sets: usize,
    #[serde(skip)]
    pub(super) materials: Vec<String>,
    /// The factors of each material.
    #[serde(skip)]
    pub factors: Vec<Factors>,
    /// Whether a texture may make part of it smoother, or more metallic, than the factors say.
    #[serde(skip)]
    pub has_gloss_textures: bool,
    #[serde(skip)]
    pub(super) images: usize,
    /// Bytes for placing the vertices of its largest primitive by a skin or morph targets.
    #[serde(skip)]
    pub(super) placing: u64,
    /// Whether vertices have colours.
    #[serde(skip)]
    pub(super) has_colours: bool,
    /// Whether vertices have normals.
    #[serde(skip)]
    pub(super) has_normals: bool,
    /// Names of materials that show their base colours under any light.
    #[serde(skip)]
    pub(super) unlit: Vec<String>,
    /// Ignored features of its file, a sentence each.
    #[serde(skip)]
    pub(super) unread: Vec<String>,
}

impl PlannedObject {
    /// Whether the back of any of its materials is visible in `scene`, and shines.
    pub fn shows_backs(&self, scene: &Scene) -> bool {
        let is_seen = |factors: &Factors| match scene.back_faces {
            // Light on its way out of the glass hits its surface from inside.
            _ if scene.bounces > 0 && factors.is_glass() => true,
            BackFaces::AsFile => factors.double_sided,
            BackFaces::TwoSided => true,
            BackFaces::Black | BackFaces::Culled => false,
        };
        self.factors.iter().any(is_seen)
    }
}

/// A cube that is loaded.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct PlannedCube {
    /// The source's name.
    pub source: String,
    /// The file; `None` for a cube in memory.
    pub file: Option<PathBuf>,
    /// The array, if the scene names one.
    pub array: Option<String>,
    /// H, W, T, C.
    pub shape: [usize; 4],
    /// What its channels are, if the scene says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channels: Option<Vec<&'static str>>,
    /// Bytes of its samples.
    pub bytes: u64,
    /// Bytes of its prefix sums over time, for the integration of exposures.
    pub sums: u64,
    /// Rays from the capture camera, one per pixel, if the cube is projected.
    pub capture_rays: u64,
    /// Bytes that may be held of it at a time, if it is read from disk in parts, on demand; `None` if it is loaded whole.
    pub held: Option<u64>,
    /// Bytes that will be read of it then, if that was [estimated](crate::render::estimate_reads).
    pub read: Option<u64>,
}

/// The number of rays for a picture.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Rays {
    /// From the camera.
    pub camera: u64,
    /// Towards pulses and capture cameras, at most.
    pub shadow_at_most: u64,
    /// From surfaces to the next, at most.
    pub bounces_at_most: u64,
    /// From capture cameras, before rendering.
    pub capture: u64,
}

impl Rays {
    /// The rays of this many pictures, for which trees are built.
    pub(super) fn of_pictures(&self, pictures: u64) -> ExpectedRays {
        // Capture cameras are traced once, before the first picture.
        let all = |rays: u64| rays.saturating_mul(pictures);
        ExpectedRays {
            camera: all(self.camera).saturating_add(self.capture),
            shadow: all(self.shadow_at_most),
            bounced: all(self.bounces_at_most),
        }
    }
}

/// Something that is not done.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Skipped {
    /// What.
    pub what: String,
    /// Why.
    pub why: String,
}

/// Bytes, estimated.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Memory {
    /// Triangles and BVHs.
    pub geometry: u64,
    /// Cubes, and what capture cameras saw.
    pub cubes: u64,
    /// The sky's picture, at all resolutions.
    pub sky: u64,
    /// The film.
    pub film: u64,
    /// Temporary memory: a mesh beside its BVH under construction, a picture of the sky beside its copy, the working memory of a
    /// rasterizer or a warp, or copies of the film on their way into files.
    pub temporary: u64,
    /// What the request holds beside the picture.
    pub beside: u64,
    /// What the request reserves for the program itself.
    pub program: u64,
}

impl Memory {
    /// The sum: the peak, up to allocator overhead.
    pub fn total(&self) -> u64 {
        self.geometry
            .saturating_add(self.cubes)
            .saturating_add(self.sky)
            .saturating_add(self.film)
            .saturating_add(self.temporary)
            .saturating_add(self.beside)
            .saturating_add(self.program)
    }
}
