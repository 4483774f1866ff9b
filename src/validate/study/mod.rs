//! Run time against error: what accuracy costs, by the ray tracer, by rasterizers and by warped pictures.
//!
//! Every [`Subject`] renders one scene with several numbers of samples per pixel. Measured are
//!
//! - *time*: the wall time of one picture from the prepared scene (files loaded, hierarchies built, which is listed separately), and the
//!   part of it until the first tile is done: tessellation, or the picture that is warped. Runs of all methods are interleaved, so that
//!   disturbances affect all of them; the median counts, and the quartiles show its reliability;
//! - *geometric error*: each point that a picture shows at a pixel centre is projected exactly. The result is where the same surface
//!   point should have been; its distance from the pixel centre, in pixels, is the error. It does not depend on the number of samples.
//!   Pixels that show a wrong object are counted;
//! - *emission time error*: |Δct| of pixels that show the right object, metres;
//! - *radiance error*: relRMSE, MRSE and ꟻLIP against a picture of the ray tracer with many samples, by the
//!   definitions of [`crate::validate::compare`];
//! - *memory*: the bytes that hold a picture (the film, and a rasterizer's vertices and triangles or a warp's texels), and, separately,
//!   those that hold what is built once. Buffers of threads, some hundred kilobytes each, are not counted.
//!
//! A result is on the (Pareto) *front* if no other is both faster and more accurate.

mod entry;
mod errors;
mod measure;
mod options;
mod plot;
mod statistics;
mod table;

pub use entry::{Entry, Family, Front, LeftOut, Once, Reference, Study, Timing, Verdict};
pub use errors::{GeometricError, RadianceError, Spread};
pub use measure::study;
pub use options::{METHODS, StudyOptions, Subject, parse_methods, parse_samples};
pub use plot::draw;
pub use table::{csv, table};
