//! Comparing pictures: whether a candidate is right, and if not, where, by how much, and why.
//!
//! ```text
//! two pictures → matched → errors per channel, structural similarity, ꟻLIP, errors of surfaces
//!                [matching]  [errors]           [ssim]                 [flip]  [surface, geometry, known]
//!              → diagnoses → tolerances, tables, maps, reports
//!                [diagnose]  [metrics, report]
//! ```
//!
//! The module of each metric starts with its definition. Rows are processed in strips whose results are added in order: the same bits on
//! any number of threads.
//!
//! ```
//! use nullray::validate::compare::{CompareOptions, Picture, compare};
//! use nullray::io::image::{Channel, Layers, Samples};
//! # fn main() -> nullray::Result<()> {
//! let picture = |name: &str, light: f64| {
//!     let channel = |c: &str| Channel { name: format!("radiance.{c}"), samples: Samples::F64(vec![light; 64]) };
//!     let layers = Layers::new(8, 8, ["R", "G", "B"].map(channel).into(), vec![])?;
//!     Ok::<_, nullray::Error>(Picture::linear(name, layers))
//! };
//! let comparison = compare(&picture("exact", 1.0)?, &picture("mine", 1.1)?, &CompareOptions::default())?;
//! let radiance = comparison.radiance.as_ref().unwrap();
//! assert!((radiance.rmse - 0.1).abs() < 1e-12);
//! # Ok(())
//! # }
//! ```

mod comparison;
pub mod diagnose;
mod errors;
pub mod flip;
mod geometry;
mod known;
mod matching;
mod memory;
mod metrics;
mod options;
mod picture;
mod points;
pub mod report;
mod ssim;
pub mod surface;

pub use comparison::{ChannelErrors, Comparison, compare};
pub use diagnose::{Diagnosis, Kind};
pub use errors::{Errors, Histogram};
pub use flip::Flip;
pub use matching::Uncompared;
pub use memory::working_memory;
pub(crate) use memory::working_memory_of_light;
pub use metrics::{Better, Breach, METRICS, Measured, Metric, Tolerance, help};
pub use options::{CompareOptions, NotFinite, Region};
pub use picture::{Alpha, Encoding, Picture};
pub use surface::SurfaceErrors;
