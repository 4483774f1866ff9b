//! The results of a study.

use serde::Serialize;

use super::errors::{GeometricError, RadianceError};
use super::options::Subject;
use crate::accel::Precision;
use crate::approximate::raster::{Map, Method, Tessellation};

/// The results of a study.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Study {
    /// Always "nullray-study".
    pub format: &'static str,
    /// The version of the format.
    pub version: u32,
    /// The program that measured it.
    pub software: String,
    /// The scene.
    pub scene: String,
    /// The SHA-256 of its text, after all changes.
    pub scene_sha256: String,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Triangles before any tessellation.
    pub triangles: u64,
    /// Architecture and operating system.
    pub platform: String,
    /// Threads of the pool.
    pub threads: usize,
    /// Seconds to load files and to build what [`Once`] lists; all methods start from there.
    pub prepare_seconds: f64,
    /// What is built once per scene, however many pictures are taken.
    pub once: Once,
    /// The reference for radiance.
    pub reference: Reference,
    /// Method by method, ascending by samples.
    pub entries: Vec<Entry>,
    /// Times at equal geometric error.
    pub verdicts: Vec<Verdict>,
    /// Methods that cannot render the scene.
    pub left_out: Vec<LeftOut>,
    /// Whether the budget ended the runs before all were done.
    pub was_cut_short: bool,
}

/// What is built once per scene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Once {
    /// Seconds for the trees, which the ray tracer needs, warps, and shadows.
    pub tree_seconds: f64,
    /// Bytes of the trees.
    pub tree_bytes: u64,
    /// Seconds to find the distinct vertices, which rasterizers need.
    pub vertex_seconds: f64,
    /// Bytes of the distinct vertices.
    pub vertex_bytes: u64,
}

/// A method that cannot render the scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct LeftOut {
    /// Its name on the command line.
    pub method: String,
    /// The reason.
    pub why: String,
}

/// The picture that radiance is compared with, by the ray tracer.
#[derive(Debug, Clone, Copy, Serialize)]
#[non_exhaustive]
pub struct Reference {
    /// Samples per pixel.
    pub samples: u32,
    /// Wall time.
    pub seconds: f64,
}

/// One method with one number of samples.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Entry {
    /// Its name on the command line.
    pub method: String,
    /// What kind of method.
    pub family: Family,
    /// Samples per pixel.
    pub samples: u32,
    /// The time for a picture; `None` if the budget left no time for it.
    pub timing: Option<Timing>,
    /// Seconds spent once: the part of [`Once`] that the method needs.
    pub once_seconds: f64,
    /// Bytes of what it needs of that.
    pub once_bytes: u64,
    /// Bytes of the film, and of a rasterizer's vertices and triangles or a warp's texels; `None` if there is no picture.
    pub memory: Option<u64>,
    /// The geometric error, a property of the method.
    pub geometry: GeometricError,
    /// The picture's error of radiance.
    pub radiance: Option<RadianceError>,
    /// Whether no other entry beats it.
    pub front: Front,
}

/// Whether an entry is on the fronts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Front {
    /// For time and largest geometric error, among the entries with the fewest samples.
    pub geometry: bool,
    /// For time and relRMSE.
    pub radiance: bool,
}

/// Wall times of pictures, seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Timing {
    /// All runs, in their order.
    pub runs: Vec<f64>,
    /// The median.
    pub median: f64,
    /// The quartiles.
    pub quartiles: [f64; 2],
    /// The median time until the first tile was done: for rasterizers, transforming and dividing all triangles.
    pub setup: f64,
}

/// The fastest methods for a given geometric error.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Verdict {
    /// The largest allowed error of a point, pixels.
    pub pixels: f64,
    /// Samples per pixel.
    pub samples: u32,
    /// Which of the ray tracer (in either precision), rasterizers and warps is fastest; `None` if the quartiles of the ratio of the two
    /// fastest include 1, or if there is one run only, which has no spread.
    pub fastest: Option<String>,
    /// The ray tracer's time, seconds.
    pub trace: Option<f64>,
    /// The time of the ray tracer in single precision, if its error is small enough.
    pub trace_fast: Option<f64>,
    /// The fastest rasterizer with a small enough error, and its time.
    pub raster: Option<(String, f64)>,
    /// The rasterizer's time over the ray tracer's: the median over interleaved runs, and the quartiles.
    pub raster_over_trace: Option<[f64; 3]>,
    /// The number of these runs.
    pub runs: usize,
    /// The fastest warp with a small enough error, and its time.
    pub warp: Option<(String, f64)>,
}

/// Kinds of methods: each is a line of a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)]
#[non_exhaustive]
pub enum Family {
    Trace,
    FastTrace,
    NoTessellation,
    Uniform,
    Adaptive,
    Cube,
    Panorama,
}

impl Family {
    /// All, in the order of legends.
    pub const ALL: [Family; 7] = [
        Family::Trace,
        Family::FastTrace,
        Family::NoTessellation,
        Family::Uniform,
        Family::Adaptive,
        Family::Cube,
        Family::Panorama,
    ];

    /// The family of `subject`.
    pub fn of(subject: &Subject) -> Self {
        match subject.method {
            Method::Trace => match subject.precision {
                Precision::Certified => Family::Trace,
                Precision::Fast => Family::FastTrace,
            },
            // The amount of division is the parameter along a family's line in the plot, not a family of its own.
            Method::Raster(raster) => match raster.tessellation {
                Tessellation::None => Family::NoTessellation,
                Tessellation::Uniform(_) => Family::Uniform,
                Tessellation::Adaptive(_) => Family::Adaptive,
            },
            Method::Warp(warp) => match warp.map {
                Map::Cube(_) => Family::Cube,
                Map::Panorama(_) => Family::Panorama,
            },
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Family::Trace => "ray tracer",
            Family::FastTrace => "ray tracer, f32",
            Family::NoTessellation => "vertices, not re-tessellated",
            Family::Uniform => "uniform re-tessellation",
            Family::Adaptive => "adaptive re-tessellation",
            Family::Cube => "warped cube map",
            Family::Panorama => "warped panorama",
        }
    }

    /// Whether it traces rays.
    pub fn is_trace(self) -> bool {
        matches!(self, Family::Trace | Family::FastTrace)
    }

    /// Whether it moves vertices.
    pub fn is_raster(self) -> bool {
        matches!(
            self,
            Family::NoTessellation | Family::Uniform | Family::Adaptive
        )
    }

    /// Whether it warps a picture.
    pub fn is_warp(self) -> bool {
        matches!(self, Family::Cube | Family::Panorama)
    }
}
