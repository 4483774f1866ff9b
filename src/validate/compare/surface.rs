//! Errors in practical units, from auxiliary channels: pixels, bins, percent.
//!
//! | error | from | definition |
//! |---|---|---|
//! | wrong object | `object` | pixels that show another object, or none although the reference shows one |
//! | coverage | `object` | of the reference's pixels with surfaces, those at which the candidate shows the same object: the part over which the errors below are measured |
//! | silhouette, mean | `object` | wrong-object pixels / length of the boundaries between objects in the reference: the area that a boundary sweeps when it moves by d is d times its length. The length is π/4 times the pixel edges that it crosses (Cauchy and Crofton; exact for boundaries of all directions alike) |
//! | silhouette, largest | `object` | Hausdorff distance of the boundary pixels, to a pixel |
//! | geometric | `object_event`, or `event`; `object` | the distance of a surface point from where it should be, see below |
//! | emission time | `event.ct`, or `object_event.ct` | candidate − reference at pixels of the same object |
//! | wavelength ratio | `wavelength_ratio` | candidate / reference − 1, and steps of the coarser of the two precisions (ulp) |
//!
//! A limit on the last three holds only if they are known: it is exceeded if an object that the reference shows at eight pixels or more has
//! no value at any of them, if less than half of the reference's pixels with surfaces have one, or if the candidate has no numbers (NaN) at
//! more than a hundredth of the pixels where both show the same object and the reference has numbers.
//!
//! With several samples per pixel the channels are means, which mix surfaces at silhouettes: compare pictures sampled at pixel centres.
//!
//! # Geometric error
//!
//! If the scene is known (from the metadata of the reference, or because it is given) the map π from points of objects to the film is
//! known, too (`known`), and the candidate's point Y at a pixel where the reference shows X is misplaced by
//!
//! ```text
//! δ = π(Y) − π(X).
//! ```
//!
//! π says nothing of points on one ray: with back faces shown for front faces δ is 0. So a Y with |δ| of 1.5
//! pixels or less, as samples elsewhere in a pixel may cause, is off the surface if |Y − X| is more than ½ + 4 |δ| of the largest steps of X
//! to a pixel around it (of the same object), and counts with that number of steps.
//!
//! The points of a moving object are also those of its events of the world, Y = Λ(β)(E − O), if the candidate has no others; but each such
//! event is seen where it is, whatever Y is. So Y is searched on the surface that the reference shows, as if the scene was unknown;
//! a Y that is off the surface counts with its distance from X, over the largest step to a pixel around it.
//!
//! Otherwise only the reference states which point X(p) of the surface pixel p shows, in coordinates that move with the object. The
//! candidate's Y belongs at p + δ with X(p + δ) = Y, and with the Jacobian J = ∂X/∂p (metres per pixel, 3 × 2) of the reference
//!
//! ```text
//! δ = (JᵀJ)⁻¹ Jᵀ (Y − X(p))          the least squares solution: what is off the surface does not count
//! ```
//!
//! which is Newton's step: if it leads out of the pixel it is repeated from the pixel where it ends, as long as that shows the same
//! connected part of the surface. If Y is not found on the part that the pixel shows, the parts that the surrounding pixels show are
//! searched, because a point near a silhouette may be in front of another part of its object. A Y that is more than half a pixel off the
//! searched surface is not on it. The error is |δ|; the point is seen displaced by −δ.
//!
//! J comes from differences of neighbours on the same part: central ones, exact to second order, if both neighbours lie on the centre's
//! triangle or the two one-sided differences nearly agree; otherwise the one on the centre's triangle, so that creases and one part of an
//! object in front of another do not affect it. Without triangles the shorter difference is used. A pixel without such neighbours has no
//! error unless Y = X(p).

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;

use serde::Serialize;

use super::errors::{Histogram, Sums};
use super::geometry::{self, Field, Search};
use super::options::Region;
use super::picture::Plane;
use super::points::{FEWEST_OF_OBJECT, Points};
use crate::io::image::Layers;
use crate::render::aov::Aov;

/// Errors of the surfaces shown, and of their positions. Each is `None` if a channel that it needs is missing.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
#[non_exhaustive]
pub struct SurfaceErrors {
    /// Pixels whose objects differ.
    pub wrong_objects: Option<Share>,
    /// Of the pixels at which the reference shows a surface, those at which the candidate shows the same object.
    pub coverage: Option<Share>,
    /// Errors of boundaries between objects.
    pub silhouette: Option<Silhouette>,
    /// Distance in pixels from where a surface point is seen to where it should be.
    pub geometric: Option<Distribution>,
    /// Error of the emission time, metres of light path.
    pub emission_time: Option<Signed>,
    /// Its absolute value in bins, if their width is known.
    pub emission_time_bins: Option<Distribution>,
    /// Relative error of the ratio of observed to emitted wavelength.
    pub wavelength_ratio: Option<Signed>,
    /// The same in steps of the coarser of the two precisions.
    pub wavelength_ratio_ulp: Option<Distribution>,
}

/// A fraction of the compared pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Share {
    /// Number of pixels.
    pub pixels: u64,
    /// Number of pixels in total.
    pub of: u64,
}

impl Share {
    /// As a number from 0 to 1; `None` if the total is 0.
    pub fn fraction(&self) -> Option<f64> {
        (self.of > 0).then(|| self.pixels as f64 / self.of as f64)
    }
}

/// Errors of boundaries between objects, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Silhouette {
    /// Mean displacement along the boundary.
    pub mean: f64,
    /// Hausdorff distance; `None` if one of the pictures has no boundary.
    pub largest: Option<f64>,
    /// Length of the reference's boundaries.
    pub length: f64,
}

/// A distribution of values that are not below 0.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Distribution {
    /// Number of values.
    pub count: u64,
    /// Pixels with an object in both pictures but without a value.
    pub unmeasured: u64,
    /// Those of them where the reference has numbers and the candidate has none.
    pub lacking: u64,
    /// Pixels where the reference shows a surface, including those that were left out because their light is not finite; 0 if unknown.
    pub surfaces: u64,
    /// Objects that the reference shows at eight pixels or more, without a value at any of them.
    pub unmeasured_objects: Vec<Unmeasured>,
    /// Statistics of the values; `None` if there are none.
    #[serde(flatten)]
    pub summary: Option<Summary>,
    /// Distribution.
    #[serde(skip)]
    pub histogram: Histogram,
}

/// An object without a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Unmeasured {
    /// Its index.
    pub object: u64,
    /// Pixels where the reference shows it.
    pub pixels: u64,
    /// Those of them where the candidate shows it, too.
    pub shown: u64,
}

/// Statistics of values that are not below 0, at least one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Summary {
    /// Mean.
    pub mean: f64,
    /// Root mean square.
    pub rms: f64,
    /// Median.
    pub p50: f64,
    /// 90th percentile.
    pub p90: f64,
    /// 99th percentile.
    pub p99: f64,
    /// The largest value.
    pub max: f64,
    /// Column and row of the largest value; `None` if all are 0.
    pub max_at: Option<[u32; 2]>,
}

/// A distribution of values of both signs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Signed {
    /// Mean; `None` if there are no values.
    pub bias: Option<f64>,
    /// Distribution of the absolute values.
    #[serde(flatten)]
    pub absolute: Distribution,
}

/// Surface errors and, if maps are requested, the map of the geometric error, for the pixels that count of those that were asked for.
pub(super) fn compare(
    pair: [&Layers; 2],
    points: &[Points; 2],
    field: Option<&Field>,
    otherwise: Option<&Search>,
    [asked, region]: [&Region; 2],
    bin_width: Option<f64>,
) -> (Option<SurfaceErrors>, Option<Vec<f32>>) {
    let size = points[0].size();
    let map = field.map(|field| geometry::map(field, otherwise));
    // Where the reference has numbers of each kind and the candidate has none.
    let lacks = |planes: &[[Plane; 2]], i: usize| {
        let has = |which: usize| planes.iter().all(|pair| pair[which].at(i).is_finite());
        has(0) && !has(1)
    };
    let of_places = Points::places(points).map(|[r, c]| [0, 1, 2].map(|k| [r[k], c[k]]));
    let places = |i| of_places.is_some_and(|planes| lacks(&planes, i));
    let of_times = points[0].time.zip(points[1].time);
    let times = |i| of_times.is_some_and(|(r, c)| lacks(&[[r, c]], i));
    let of_ratios = ratio(pair);
    let ratios = |i| of_ratios.is_some_and(|planes| lacks(&[planes], i));
    let shown = (size, [asked, region], points);
    // Independent passes over all pixels: on all threads.
    let ((outlines, geometric), (in_time, in_ratio)) = rayon::join(
        || {
            let outlines = || {
                let wrong = wrong_objects(points, region);
                (wrong, coverage(points, region), silhouette(points, region))
            };
            let geometric = || {
                let map = map.as_ref()?;
                Some(distribution(shown, &places, |_, i| map[i].into()))
            };
            rayon::join(outlines, geometric)
        },
        || {
            let in_time = || {
                let of = time(points)?;
                let in_bins = |width| distribution(shown, &times, |_, i| of(i).abs() / width);
                Some((signed(shown, &times, &of), bin_width.map(in_bins)))
            };
            let in_ratio = || {
                let [r, c] = of_ratios?;
                let relative = || signed(shown, &ratios, |i| c.at(i) / r.at(i) - 1.0);
                let in_steps = || distribution(shown, &ratios, |_, i| steps(&r, &c, i));
                Some(rayon::join(relative, in_steps))
            };
            rayon::join(in_time, in_ratio)
        },
    );
    let (wrong_objects, coverage, silhouette) = outlines;
    let (emission_time, emission_time_bins) = in_time.unzip();
    let (wavelength_ratio, wavelength_ratio_ulp) = in_ratio.unzip();
    let errors = SurfaceErrors {
        wrong_objects,
        coverage,
        silhouette,
        geometric,
        emission_time,
        emission_time_bins: emission_time_bins.flatten(),
        wavelength_ratio,
        wavelength_ratio_ulp,
    };
    let some = errors != SurfaceErrors::default();
    (some.then_some(errors), map)
}

fn ratio<'a>(pair: [&'a Layers; 2]) -> Option<[Plane<'a>; 2]> {
    let [r, c] = pair.map(|layers| Plane::aov(layers, Aov::WavelengthRatio));
    Some([r?, c?])
}

/// The difference of emission times at a pixel, candidate − reference.
fn time<'a>(points: &'a [Points<'a>; 2]) -> Option<impl Fn(usize) -> f64 + 'a> {
    let [r, c] = [points[0].time?, points[1].time?];
    Some(move |i| c.at(i) - r.at(i))
}

/// Number of representable values from one value to the other.
fn steps(r: &Plane, c: &Plane, index: usize) -> f64 {
    let (a, b) = (r.at(index), c.at(index));
    if a.is_nan() || b.is_nan() {
        return f64::NAN;
    }
    // Bit patterns as ordered integers, with those of negative numbers reversed.
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

/// The compared pictures: their width and height, the pixels that were asked for and those of them that count, and the points that they
/// show.
type Shown<'a> = ([usize; 2], [&'a Region; 2], &'a [Points<'a>; 2]);

fn signed(
    shown: Shown,
    lacks: &(dyn Fn(usize) -> bool + Sync),
    value: impl Fn(usize) -> f64,
) -> Signed {
    let (mut sum, mut count) = (0.0, 0u64);
    let absolute = distribution(shown, lacks, |chosen, i| {
        let value = value(i);
        if chosen && value.is_finite() {
            sum += value;
            count += 1;
        }
        value.abs()
    });
    Signed {
        bias: (count > 0).then(|| sum / count as f64),
        absolute,
    }
}

/// The distribution of `value` over the pixels of the region that show the same object; `lacks` returns whether the candidate lacks numbers
/// for it.
fn distribution(
    ([width, height], [asked, region], points): Shown,
    lacks: &(dyn Fn(usize) -> bool + Sync),
    mut value: impl FnMut(bool, usize) -> f64,
) -> Distribution {
    let mut sums = Sums::new();
    let (mut unmeasured, mut lacking, mut objects) = (0, 0, Objects::default());
    let zeros = vec![0.0; width];
    let mut row = vec![0.0; width];
    for y in 0..height {
        let (all, mut chosen) = (asked.row(y, width), region.row(y, width));
        for x in 0..width {
            let i = y * width + x;
            let object = points[0].object_at(i).filter(|_| all[x]);
            // A displacement is measured along one object: there is none where another is shown.
            chosen[x] &= points[0].same_object(&points[1], i);
            row[x] = Some(value(chosen[x], i))
                .filter(|v| v.is_finite())
                .unwrap_or(f64::NAN);
            let is_measured = chosen[x] && !row[x].is_nan();
            unmeasured += u64::from(chosen[x] && !is_measured);
            lacking += u64::from(chosen[x] && !is_measured && lacks(i));
            if let Some(object) = object.filter(|object| *object >= 0.0) {
                objects.add(object as u64, [chosen[x], is_measured]);
            }
        }
        sums.add_row(y, &zeros, &row, Some(&chosen));
    }
    let errors = sums.errors(1.0, None);
    Distribution {
        count: errors.as_ref().map_or(0, |e| e.count),
        unmeasured,
        lacking,
        surfaces: objects.counts.values().map(|[pixels, ..]| pixels).sum(),
        unmeasured_objects: objects.unmeasured(),
        summary: errors.as_ref().map(|e| Summary {
            mean: e.mae,
            rms: e.rmse,
            p50: e.p50,
            p90: e.p90,
            p99: e.p99,
            max: e.max,
            max_at: e.max_at,
        }),
        histogram: errors.map(|e| e.histogram).unwrap_or_default(),
    }
}

/// Pixels of the reference by object: all, those where the candidate shows the same object, those with a value.
#[derive(Debug, Default)]
struct Objects {
    counts: BTreeMap<u64, [u64; 3]>,
}

impl Objects {
    fn add(&mut self, object: u64, [shown, measured]: [bool; 2]) {
        let counts = self.counts.entry(object).or_default();
        let more = [true, shown, measured].map(u64::from);
        counts
            .iter_mut()
            .zip(more)
            .for_each(|(count, more)| *count += more);
    }

    fn unmeasured(&self) -> Vec<Unmeasured> {
        let missed = self.counts.iter();
        let missed =
            missed.filter(|(_, [all, _, measured])| *all >= FEWEST_OF_OBJECT && *measured == 0);
        let named = |(&object, &[pixels, shown, _]): (&u64, &[u64; 3])| Unmeasured {
            object,
            pixels,
            shown,
        };
        missed.map(named).collect()
    }
}

/// Larger than any distance of pixels.
const FAR: u32 = u32::MAX / 2;

/// Pixels of the region that show another object.
fn wrong_objects(pair: &[Points; 2], region: &Region) -> Option<Share> {
    let [r, c] = pair;
    (r.object.is_some() && c.object.is_some()).then_some(())?;
    let mut share = Share { pixels: 0, of: 0 };
    for i in region.pixels(r.size()) {
        share.of += 1;
        share.pixels += u64::from(r.object_at(i) != c.object_at(i));
    }
    Some(share)
}

/// Surfaces of the reference that the candidate also shows.
fn coverage(pair: &[Points; 2], region: &Region) -> Option<Share> {
    let [r, c] = pair;
    (r.object.is_some() && c.object.is_some()).then_some(())?;
    let mut share = Share { pixels: 0, of: 0 };
    for i in region.pixels(r.size()) {
        share.of += u64::from(r.object_at(i).is_some_and(|object| object >= 0.0));
        share.pixels += u64::from(r.same_object(c, i));
    }
    Some(share)
}

/// Errors of the boundaries between objects.
fn silhouette(pair: &[Points; 2], region: &Region) -> Option<Silhouette> {
    let wrong = wrong_objects(pair, region)?;
    // Over all directions a line crosses 4/π pixel edges per pixel of its length (Crofton).
    let length = FRAC_PI_4 * crossings(&pair[0], region) as f64;
    let mean = match (wrong.pixels, length) {
        (0, _) => 0.0,
        (_, 0.0) => f64::INFINITY,
        (pixels, length) => pixels as f64 / length,
    };
    let [r, c] = pair.each_ref().map(|points| boundary(points, region));
    let size = pair[0].size();
    let largest = match wrong.pixels {
        0 => Some(0.0),
        _ => farthest(&r, &c, size)
            .zip(farthest(&c, &r, size))
            .map(|(a, b)| a.max(b)),
    };
    Some(Silhouette {
        mean,
        largest,
        length,
    })
}

/// Number of pairs of neighbours on different sides of a boundary.
fn crossings(points: &Points, region: &Region) -> u64 {
    let [width, height] = points.size();
    let mut count = 0;
    for i in region.pixels([width, height]) {
        let (x, y) = (i % width, i / width);
        let differs = |j: usize| points.object_at(i) != points.object_at(j);
        count += u64::from(x + 1 < width && differs(i + 1));
        count += u64::from(y + 1 < height && differs(i + width));
    }
    count
}

/// Pixels of the region that have a neighbour of another object, on either side, above or below.
fn boundary(points: &Points, region: &Region) -> Vec<bool> {
    let [width, height] = points.size();
    let mut marks = vec![false; width * height];
    for i in region.pixels([width, height]) {
        let (x, y) = (i % width, i / width);
        let differs = |j: usize| points.object_at(i) != points.object_at(j);
        marks[i] = (x + 1 < width && differs(i + 1))
            || (x > 0 && differs(i - 1))
            || (y + 1 < height && differs(i + width))
            || (y > 0 && differs(i - width));
    }
    marks
}

/// The largest distance from a marked pixel to the nearest one marked in `other`; `None` if either has no marks.
fn farthest(marks: &[bool], other: &[bool], [width, height]: [usize; 2]) -> Option<f64> {
    (marks.contains(&true) && other.contains(&true)).then_some(())?;
    let columns = vertical(other, [width, height]);
    let mut most = 0u64;
    for y in 0..height {
        let row = &columns[y * width..(y + 1) * width];
        for x in (0..width).filter(|x| marks[y * width + x]) {
            most = most.max(nearest(row, x));
        }
    }
    Some((most as f64).sqrt())
}

/// The distance of each pixel to the nearest mark in its column.
fn vertical(marks: &[bool], [width, height]: [usize; 2]) -> Vec<u32> {
    let mut distances: Vec<u32> = marks.iter().map(|m| if *m { 0 } else { FAR }).collect();
    // Down, then up: the nearest mark above, then the nearest of both.
    for i in width..width * height {
        distances[i] = distances[i].min(distances[i - width] + 1);
    }
    for i in (0..width * (height - 1)).rev() {
        distances[i] = distances[i].min(distances[i + width] + 1);
    }
    distances
}

/// The smallest squared distance from column `x` to a mark, given the vertical distances of its row. Columns are visited outwards, no
/// farther than the nearest mark found so far.
fn nearest(row: &[u32], x: usize) -> u64 {
    let square = |n: u64| n * n;
    let mut best = square(row[x].into());
    let mut reach = 1u64;
    while square(reach) < best && reach < row.len() as u64 {
        let step = reach as usize;
        for side in [x.checked_sub(step), Some(x + step)].into_iter().flatten() {
            if let Some(distance) = row.get(side) {
                best = best.min(square(reach) + square((*distance).into()));
            }
        }
        reach += 1;
    }
    best
}
