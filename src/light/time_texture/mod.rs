//! Time-resolved textures: radiance on (v, u, t, channel), and the treatment of missing data.
//!
//! A cube holds samples a(i, j, k, c); row i counts from the top, bin k covers
//! `[start + k·w, start + (k+1)·w]` of its clock (metres of ct). A lookup is separable:
//!
//! L(u, v, t) = scale · Σ_taps b(tap; u, v) Σ_k f((t_tap − start)/w − ½ − k) a(tap, k)  [/ w if per bin]
//!
//! - b: bilinear, texel (i, j) centred at u = (j + ½)/W, v = (i + ½)/H. Within half a texel of the
//!   edge the missing taps are the edge texels themselves: all of [0, 1]² is held.
//! - f: nearest, linear or Catmull–Rom (see [`TimeFilter`](crate::scene::model::TimeFilter)) about
//!   bin centres. A stored value is the mean over its bin; all but `CubicMeans` take it as the value at
//!   the centre. Catmull–Rom has negative lobes: beside a step it dips below zero, and is left so.
//! - t_tap: the requested time; for a cube in capture-camera time, that time plus η × the distance
//!   *of that tap's own* surface point from the capture pinhole ([`Capture`]).
//!
//! Missing data are filled as [`Outside`](crate::scene::model::Outside) says and counted in [`Coverage`]; nothing is clamped silently.
//!
//! `survey` checks data for errors; `axis` handles time, `irregular` bins of different widths, `bilinear` texels, `capture` cameras,
//! `capture_points` the projection of many points, and `capture_lookups` the lookups for those; `sharp` inverts the averaging over
//! pixels; only `reader` touches samples; `lookups` carries out many lookups at a time, with `places` for positions and `gather` for
//! samples, and `near` batches the reads of single ones from disk. `axis` returns short runs of bins with weights; `spans` means over
//! time spans of any length, by prefix sums.

mod axis;
mod bilinear;
mod capture;
mod capture_lookups;
mod capture_points;
mod coverage;
mod from_disk;
mod gather;
mod irregular;
mod lookups;
mod near;
mod places;
mod reader;
mod sharp;
mod spans;
pub mod survey;
mod texture;
mod weights;

pub use axis::TimeAxis;
pub use capture::{Capture, CapturePoint, CaptureView, SeenPoint};
pub use capture_lookups::CaptureLookups;
pub use capture_points::CapturePoints;
pub use coverage::Coverage;
pub use lookups::Lookups;
pub use near::Near;
pub use places::BATCH;
pub use texture::{Located, Sampled, TimeTexture};
