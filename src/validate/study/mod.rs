//! Run time against error: what accuracy costs, by the ray tracer, by rasterizers and by warped pictures.
//!
//! Every [`Subject`] makes pictures of one scene with several numbers of samples per pixel. Measured are
//!
//! - *time*: the wall time of one picture from the prepared scene (files loaded, hierarchies built, which is
//!   told apart), and of it the part until the first tile is done: tessellation, or the picture that is
//!   warped. Runs of all methods take turns, so that whatever else the machine does meets all of them; the
//!   median counts, and the quartiles say how far to trust it;
//! - *geometric error*: each point that a picture shows in the middle of a pixel is projected exactly. The
//!   distance of that from the middle of the pixel, in pixels, is where the same surface point should have
//!   been. It does not depend on the number of samples. Pixels that show another object than they should are
//!   counted;
//! - *emission time error*: |Δct| of pixels that show the right object, metres;
//! - *radiance error*: relRMSE, MRSE and ꟻLIP against a picture of the ray tracer with many samples, by the
//!   definitions of [`crate::validate::compare`];
//! - *memory*: by how much the resident memory of the process grew at most during the first run; known on
//!   Linux only, and less than the truth where freed memory was used again.
//!
//! A result is on the *front* (Pareto) where no other is both faster and nearer to the truth.

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
