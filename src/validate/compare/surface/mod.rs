//! Errors in the units that matter, from auxiliary channels: pixels, bins, percent.
//!
//! | error | from | definition |
//! |---|---|---|
//! | wrong object | `object` | pixels that show another object, or none where there is one |
//! | silhouette, mean | `object` | wrong-object pixels / length of the boundaries between objects in the reference: the area that a boundary sweeps when it moves by d is d times its length. The length is π/4 times the pixel edges that it crosses (Cauchy and Crofton; exact for boundaries of all directions alike) |
//! | silhouette, largest | `object` | Hausdorff distance of the boundary pixels, to a pixel |
//! | geometric | `object_event`, or `event` | see [`geometry`] |
//! | emission time | `event.ct`, or `object_event.ct` | candidate − reference at pixels of the same object |
//! | wavelength ratio | `wavelength_ratio` | candidate / reference − 1, and steps of the coarser of the two precisions (ulp) |
//!
//! With several samples per pixel the channels are means, which mix surfaces at silhouettes: compare pictures
//! of pixel centres.

mod boundary;
pub mod geometry;
pub(super) mod points;

use serde::Serialize;

use super::errors::{Histogram, Sums};
use super::plane::Plane;
use super::region::Region;
use crate::io::image::Layers;
use points::Points;

/// Errors of what surfaces are seen where. Each is none where a channel that it needs is missing.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct SurfaceErrors {
    /// Pixels whose objects differ.
    pub wrong_object: Option<Share>,
    /// How far boundaries between objects are off.
    pub silhouette: Option<Silhouette>,
    /// Distance in pixels from where a surface point is seen to where it should be.
    pub geometric: Option<Distribution>,
    /// Emission time, metres of light path.
    pub emission_time: Option<Signed>,
    /// The same without its sign in bins, where their width is known.
    pub emission_time_bins: Option<Distribution>,
    /// Observed / emitted wavelength, relative error.
    pub wavelength_ratio: Option<Signed>,
    /// The same in steps of the coarser of the two precisions.
    pub wavelength_ratio_ulp: Option<Distribution>,
}

/// Part of the compared pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Share {
    /// How many.
    pub pixels: u64,
    /// Of how many.
    pub of: u64,
}

/// How far boundaries between objects are off, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Silhouette {
    /// Mean displacement along the boundary.
    pub mean: f64,
    /// Hausdorff distance; none where one of the pictures has no boundary.
    pub largest: Option<f64>,
    /// Length of the reference's boundaries.
    pub length: f64,
}

/// Of values that are not below 0.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Distribution {
    /// How many.
    pub count: u64,
    /// Pixels that have an object in both pictures, and no value.
    pub unmeasured: u64,
    /// Mean.
    pub mean: f64,
    /// Root mean square.
    pub rms: f64,
    /// Half are at most this.
    pub p50: f64,
    /// 90 % are at most this.
    pub p90: f64,
    /// 99 % are at most this.
    pub p99: f64,
    /// The largest.
    pub max: f64,
    /// Column and row of the largest; none where all are 0.
    pub max_at: Option<[u32; 2]>,
    /// Distribution.
    #[serde(skip)]
    pub histogram: Histogram,
}

/// Of values of both signs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Signed {
    /// Mean.
    pub bias: f64,
    /// Of the absolute values.
    #[serde(flatten)]
    pub absolute: Distribution,
}

/// One number per pixel, NaN where there is none.
pub(super) type Map = Vec<f32>;

/// Surface errors and, for pictures of them, the map of the geometric error.
pub(super) fn compare(
    pair: [&Layers; 2],
    region: &Region,
    bin_width: Option<f64>,
) -> (Option<SurfaceErrors>, Option<Map>) {
    let points = pair.map(Points::new);
    let size = points[0].size();
    let map = geometry::map(&points);
    let errors = SurfaceErrors {
        wrong_object: boundary::wrong(&points, region),
        silhouette: boundary::silhouette(&points, region),
        geometric: map
            .as_ref()
            .map(|map| distribution(size, region, &points, |_, i| map[i].into())),
        emission_time: time(&points).map(|of| signed(size, region, &points, of)),
        emission_time_bins: time(&points).zip(bin_width).map(|(of, width)| {
            distribution(size, region, &points, move |_, i| of(i).abs() / width)
        }),
        wavelength_ratio: ratio(pair)
            .map(|[r, c]| signed(size, region, &points, move |i| c.at(i) / r.at(i) - 1.0)),
        wavelength_ratio_ulp: ratio(pair)
            .map(|[r, c]| distribution(size, region, &points, move |_, i| steps(&r, &c, i))),
    };
    let some = errors != SurfaceErrors::default();
    (some.then_some(errors), map)
}

fn ratio<'a>(pair: [&'a Layers; 2]) -> Option<[Plane<'a>; 2]> {
    let [r, c] = pair.map(|layers| Plane::find(layers, "wavelength_ratio"));
    Some([r?, c?])
}

/// Candidate − reference time of a pixel.
fn time<'a>(points: &'a [Points<'a>; 2]) -> Option<impl Fn(usize) -> f64 + 'a> {
    let [r, c] = [points[0].time?, points[1].time?];
    Some(move |i| c.at(i) - r.at(i))
}

/// Representable numbers from one value to the other.
fn steps(r: &Plane, c: &Plane, index: usize) -> f64 {
    let (a, b) = (r.at(index), c.at(index));
    if a.is_nan() || b.is_nan() {
        return f64::NAN;
    }
    // The order of bits, with those of numbers below 0 turned around.
    let single = |x: f64| {
        let bits = i64::from((x as f32).to_bits().cast_signed());
        if bits < 0 {
            i64::from(i32::MIN) - bits
        } else {
            bits
        }
    };
    let double = |x: f64| {
        let bits = x.to_bits().cast_signed();
        if bits < 0 {
            i64::MIN.wrapping_sub(bits)
        } else {
            bits
        }
    };
    match r.is_single() || c.is_single() {
        true => single(a).abs_diff(single(b)) as f64,
        false => double(a).abs_diff(double(b)) as f64,
    }
}

fn signed(
    size: [usize; 2],
    region: &Region,
    points: &[Points; 2],
    value: impl Fn(usize) -> f64,
) -> Signed {
    let (mut sum, mut count) = (0.0, 0u64);
    let absolute = distribution(size, region, points, |chosen, i| {
        let value = value(i);
        if chosen && !value.is_nan() {
            sum += value;
            count += 1;
        }
        value.abs()
    });
    Signed {
        bias: sum / count.max(1) as f64,
        absolute,
    }
}

/// The distribution of `value` over the pixels of the region that show the same object.
fn distribution(
    size: [usize; 2],
    region: &Region,
    points: &[Points; 2],
    mut value: impl FnMut(bool, usize) -> f64,
) -> Distribution {
    let [width, height] = size;
    let mut sums = Sums::new();
    let mut unmeasured = 0;
    let zeros = vec![0.0; width];
    let mut row = vec![0.0; width];
    for y in 0..height {
        let mut chosen = region.row(y, width);
        for x in 0..width {
            let i = y * width + x;
            chosen[x] &= points[0].same_object(&points[1], i);
            row[x] = value(chosen[x], i);
            unmeasured += u64::from(chosen[x] && row[x].is_nan());
        }
        sums.add_row(y, &zeros, &row, Some(&chosen));
    }
    let errors = sums.errors(1.0, None);
    Distribution {
        count: errors.count,
        unmeasured,
        mean: errors.mae,
        rms: errors.rmse,
        p50: errors.p50,
        p90: errors.p90,
        p99: errors.p99,
        max: errors.max,
        max_at: errors.max_at,
        histogram: errors.histogram,
    }
}
