//! Errors in the units that matter, from auxiliary channels: pixels, bins, percent.
//!
//! | error | from | definition |
//! |---|---|---|
//! | wrong object | `object` | pixels that show another object, or none where there is one |
//! | coverage | `object` | of the reference's pixels with surfaces, those at which the candidate shows the same object: the part over which the errors below are measured |
//! | silhouette, mean | `object` | wrong-object pixels / length of the boundaries between objects in the reference: the area that a boundary sweeps when it moves by d is d times its length. The length is π/4 times the pixel edges that it crosses (Cauchy and Crofton; exact for boundaries of all directions alike) |
//! | silhouette, largest | `object` | Hausdorff distance of the boundary pixels, to a pixel |
//! | geometric | `object_event`, or `event`; `object` | how far a point of a surface is from where it should be, see below |
//! | emission time | `event.ct`, or `object_event.ct` | candidate − reference at pixels of the same object |
//! | wavelength ratio | `wavelength_ratio` | candidate / reference − 1, and steps of the coarser of the two precisions (ulp) |
//!
//! A limit on the last three holds only where they are known: it is exceeded where an object that the reference shows at eight
//! pixels or more has no value at any of them, where less than half of the reference's pixels with surfaces have one, or where the candidate
//! has no numbers (NaN) at more than a hundredth of the pixels at which both show the same object and the reference has some.
//!
//! With several samples per pixel the channels are means, which mix surfaces at silhouettes: compare pictures
//! of pixel centres.
//!
//! # Geometric error
//!
//! Where the scene is known (by the metadata of the reference, or named) the map π from points of objects to the film is
//! known, too (`known`), and the candidate's point Y at a pixel where the reference shows X is misplaced by
//!
//! ```text
//! δ = π(Y) − π(X).
//! ```
//!
//! Otherwise the reference alone says which point X(p) of the surface pixel p shows, in coordinates that move with the
//! object. The candidate's Y belongs at p + δ with X(p + δ) = Y, and with the Jacobian J = ∂X/∂p (metres per pixel,
//! 3 × 2) of the reference
//!
//! ```text
//! δ = (JᵀJ)⁻¹ Jᵀ (Y − X(p))          the least squares solution: what is off the surface does not count
//! ```
//!
//! which is Newton's step: where it leads out of the pixel it is repeated from the pixel it leads to, as
//! long as that shows the same connected part of the surface. Where Y is not found on the part that the pixel shows, the
//! parts that the pixels around it show are searched, for a point near a silhouette may be in front of another part of
//! its object. A Y that is more than half a pixel off the surface that is searched is not on it. The error is |δ|; the
//! point is seen displaced by −δ.
//!
//! J comes from differences of neighbours on the same part: central ones, exact to second order, where both
//! neighbours lie on the centre's triangle or the two one-sided differences nearly agree; otherwise the one on the
//! centre's triangle, so that creases and one part of an object in front of another do not pollute it. Without
//! triangles the shorter difference stands in. A pixel without such neighbours has no error unless Y = X(p).

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;

use serde::Serialize;

use super::errors::{Histogram, Sums};
use super::geometry::{self, Field};
use super::options::Region;
use super::picture::Plane;
use super::points::Points;
use crate::io::image::Layers;
use crate::render::aov::Aov;

/// Errors of what surfaces are seen where. Each is none where a channel that it needs is missing.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
#[non_exhaustive]
pub struct SurfaceErrors {
    /// Pixels whose objects differ.
    pub wrong_objects: Option<Share>,
    /// Of the pixels at which the reference shows a surface, those at which the candidate shows the same object.
    pub coverage: Option<Share>,
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
#[non_exhaustive]
pub struct Share {
    /// How many.
    pub pixels: u64,
    /// Of how many.
    pub of: u64,
}

impl Share {
    /// As a number from 0 to 1; none of no pixels.
    pub fn part(&self) -> Option<f64> {
        (self.of > 0).then(|| self.pixels as f64 / self.of as f64)
    }
}

/// How far boundaries between objects are off, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
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
#[non_exhaustive]
pub struct Distribution {
    /// How many.
    pub count: u64,
    /// Pixels that have an object in both pictures, and no value.
    pub unmeasured: u64,
    /// Those of them at which the reference has numbers, and the candidate has none.
    pub lacking: u64,
    /// Pixels at which the reference shows a surface; 0 where it does not say.
    pub surfaces: u64,
    /// Objects that the reference shows at eight pixels or more, none of which has a value.
    pub unmeasured_objects: Vec<Unmeasured>,
    /// Their size; none where there are no values.
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
    /// Pixels at which the reference shows it.
    pub pixels: u64,
    /// Those of them at which the candidate does, too.
    pub shown: u64,
}

/// An object has to have so many pixels to be missed: of fewer, an error that is allowed may move all.
pub(super) const FEWEST_OF_OBJECT: u64 = 8;

/// The size of values that are not below 0, of which there is one at least.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Summary {
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
}

/// Of values of both signs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Signed {
    /// Mean; none where there are no values.
    pub bias: Option<f64>,
    /// Of the absolute values.
    #[serde(flatten)]
    pub absolute: Distribution,
}

/// Surface errors and, for pictures of them, the map of the geometric error.
pub(super) fn compare(
    pair: [&Layers; 2],
    points: &[Points; 2],
    field: Option<&Field>,
    region: &Region,
    bin_width: Option<f64>,
) -> (Option<SurfaceErrors>, Option<Vec<f32>>) {
    let size = points[0].size();
    let map = field.map(geometry::map);
    // Where the reference has numbers of each kind and the candidate has none.
    let lacks = |planes: &[[Plane; 2]], i: usize| {
        let has = |which: usize| planes.iter().all(|pair| !pair[which].at(i).is_nan());
        has(0) && !has(1)
    };
    let of_places = Points::places(points).map(|[r, c]| [0, 1, 2].map(|k| [r[k], c[k]]));
    let places = |i| of_places.is_some_and(|planes| lacks(&planes, i));
    let of_times = points[0].time.zip(points[1].time);
    let times = |i| of_times.is_some_and(|(r, c)| lacks(&[[r, c]], i));
    let of_ratios = ratio(pair);
    let ratios = |i| of_ratios.is_some_and(|planes| lacks(&[planes], i));
    let shown = (size, region, points);
    let errors = SurfaceErrors {
        wrong_objects: wrong_objects(points, region),
        coverage: coverage(points, region),
        silhouette: silhouette(points, region),
        geometric: map
            .as_ref()
            .map(|map| distribution(shown, &places, |_, i| map[i].into())),
        emission_time: time(points).map(|of| signed(shown, &times, of)),
        emission_time_bins: time(points)
            .zip(bin_width)
            .map(|(of, width)| distribution(shown, &times, move |_, i| of(i).abs() / width)),
        wavelength_ratio: ratio(pair)
            .map(|[r, c]| signed(shown, &ratios, move |i| c.at(i) / r.at(i) - 1.0)),
        wavelength_ratio_ulp: ratio(pair)
            .map(|[r, c]| distribution(shown, &ratios, move |_, i| steps(&r, &c, i))),
    };
    let some = errors != SurfaceErrors::default();
    (some.then_some(errors), map)
}

fn ratio<'a>(pair: [&'a Layers; 2]) -> Option<[Plane<'a>; 2]> {
    let [r, c] = pair.map(|layers| Plane::aov(layers, Aov::WavelengthRatio));
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

/// The pixels of the compared pictures: how many in a row and in a column, which are compared, and what they show.
type Shown<'a> = ([usize; 2], &'a Region, &'a [Points<'a>; 2]);

fn signed(shown: Shown, lacks: &dyn Fn(usize) -> bool, value: impl Fn(usize) -> f64) -> Signed {
    let (mut sum, mut count) = (0.0, 0u64);
    let absolute = distribution(shown, lacks, |chosen, i| {
        let value = value(i);
        if chosen && !value.is_nan() {
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

/// The distribution of `value` over the pixels of the region that show the same object; `lacks` says where the candidate has no numbers for it.
fn distribution(
    ([width, height], region, points): Shown,
    lacks: &dyn Fn(usize) -> bool,
    mut value: impl FnMut(bool, usize) -> f64,
) -> Distribution {
    let mut sums = Sums::new();
    let (mut unmeasured, mut lacking, mut objects) = (0, 0, Objects::default());
    let zeros = vec![0.0; width];
    let mut row = vec![0.0; width];
    for y in 0..height {
        let mut chosen = region.row(y, width);
        for x in 0..width {
            let i = y * width + x;
            let object = points[0].object_at(i).filter(|_| chosen[x]);
            // A displacement is measured along one object: where another is shown there is none.
            chosen[x] &= points[0].same_object(&points[1], i);
            row[x] = value(chosen[x], i);
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

/// Pixels of the reference by its objects: all, those at which the candidate shows the same, those with a value.
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

/// Farther than any pixel.
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

/// Surfaces of the reference that the candidate shows, too.
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

/// How far the boundaries between objects are off.
fn silhouette(pair: &[Points; 2], region: &Region) -> Option<Silhouette> {
    let wrong = wrong_objects(pair, region)?;
    // Over all directions a line crosses 4/π edges of pixels per pixel of its length (Crofton).
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

/// Neighbours of which one lies across a boundary.
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

/// Pixels of the region that have a neighbour of another object, beside or beneath or above.
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

/// The largest distance from a marked pixel to the nearest one marked in `other`; none where either has none.
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
    // Down, then up: the nearest mark above, then the nearest at all.
    for i in width..width * height {
        distances[i] = distances[i].min(distances[i - width] + 1);
    }
    for i in (0..width * (height - 1)).rev() {
        distances[i] = distances[i].min(distances[i + width] + 1);
    }
    distances
}

/// The least squared distance from column `x` to a mark, given the vertical distances of its row. Columns are
/// visited outwards, and no farther than the nearest mark found so far.
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
