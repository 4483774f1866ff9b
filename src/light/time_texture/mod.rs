//! Time-resolved textures: radiance on (v, u, t, channel), with what they do not hold.
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
//! - t_tap: the time asked for; for a cube in capture-camera time, that time plus η × the distance
//!   *of that tap's own* surface point from the capture pinhole ([`Capture`]).
//!
//! What the data do not hold is filled as [`Outside`](crate::scene::model::Outside) says and is
//! counted in [`Coverage`]; nothing is clamped silently.
//!
//! `survey` looks for what is wrong with data; `axis` knows time, `irregular` bins of different widths, `bilinear` texels, `capture` cameras, `capture_points` many
//! points as they see them, and `capture_lookups` what they recorded of those; `sharp` undoes the means of pixels; `reader` alone touches samples; `lookups` carries out many
//! lookups at a time, with `places` for where they read and `gather` for what, and `near` brings together what single ones read from disk. `axis` gives out short runs of bins with
//! weights; `spans` means over spans of time, of any length, by prefix sums.

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
