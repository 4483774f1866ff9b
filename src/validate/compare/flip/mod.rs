//! ꟻLIP: the differences an observer sees when flipping between two pictures, and HDR-ꟻLIP, the same at several exposures.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for Alternating
//! Images", PACMCGIT 3(2), 2020; Andersson, Nilsson, Shirley, Akenine-Möller, "Visualizing Errors in Rendered High
//! Dynamic Range Images", Eurographics Short Papers 2021.
//!
//! ```text
//! linear RGB → YCxCz → contrast sensitivity filters → CIELAB, Hunt → HyAB → [0, 1]  = colour difference ΔEc
//!              └ Y → edge and point detectors → |Δ|, larger of the two, √            = feature difference ΔEf
//! ꟻLIP = ΔEc^(1 − ΔEf)
//! HDR-ꟻLIP = the largest ꟻLIP over n exposures from log₂(x/Ymax) to log₂(x/Ymedian), tone-mapped (ACES) and
//!            clipped, where x maps to 0.85 and n = max(2, ⌈stop − start⌉)
//! ```
//!
//! Here n is at most 64: if the reference has a wider range of stops, the exposures are more than one stop apart.
//!
//! All filters are separable (the blue-yellow one as a sum of two); the picture's edge pixels are repeated beyond it. If more than half of
//! the reference is black its median luminance gives no exposure: the median of its lit pixels is used. The mean over a region is that of
//! the whole picture's errors.

mod colour;
mod filter;
mod tile;

use rayon::prelude::*;

pub use super::options::PIXELS_PER_DEGREE;

use crate::accel::vectors::dispatch;
use filter::Filters;
pub(super) use tile::Question;
use tile::{Exposing, HEIGHT, Sum, Tile, WIDTH};

/// ꟻLIP of two pictures.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Flip {
    /// Mean error over the region, 0 (none) to 1.
    pub mean: f64,
    /// Largest error of the region.
    pub max: f64,
    /// The exposures in stops; `None` for pictures of display values.
    pub exposures: Option<[f64; 2]>,
    /// Number of exposures: one for each stop, and at most 64.
    pub steps: u32,
    /// Pixels per degree of visual angle.
    pub pixels_per_degree: f64,
    /// The error of each pixel, 0 outside of the region; only if maps were requested.
    #[serde(skip)]
    pub map: Option<Vec<f32>>,
}

impl Flip {
    /// The stops between exposures, if more than the one of the definition.
    pub fn stops_apart(&self) -> Option<f64> {
        let [start, stop] = self.exposures?;
        let apart = (stop - start) / f64::from(self.steps.max(2) - 1);
        (self.steps >= MOST_EXPOSURES as u32 && stop - start > f64::from(MOST_EXPOSURES))
            .then_some(apart)
    }
}

/// Evaluates ꟻLIP, or HDR-ꟻLIP for pictures of high range.
pub(super) fn evaluate(question: &Question) -> Flip {
    let range = question.high_range.then(|| exposures(question)).flatten();
    let exposures = range.map_or(vec![1.0], |range| range.gains());
    let filters = Filters::new(question.pixels_per_degree);
    let [width, height] = question.size;
    let corners: Vec<[usize; 2]> = (0..height)
        .step_by(HEIGHT)
        .flat_map(|top| (0..width).step_by(WIDTH).map(move |left| [left, top]))
        .collect();
    let tone_mapped = range.is_some();
    let tiles = corners.into_par_iter().map(|corner| {
        let mut tile = Tile::new(question, &filters, corner, tone_mapped);
        dispatch(Exposing {
            tile: &mut tile,
            gains: &exposures,
        });
        tile.finish(question.region)
    });
    if !question.map {
        let sums: Vec<Sum> = tiles.map(|tile| tile.sum).collect();
        return flip(question, range, exposures.len(), &sums, None);
    }
    let done: Vec<tile::Done> = tiles.collect();
    let sums: Vec<Sum> = done.iter().map(|tile| tile.sum).collect();
    let mut map = vec![0.0; width * height];
    done.iter().for_each(|tile| tile.place(&mut map, width));
    flip(question, range, exposures.len(), &sums, Some(map))
}

fn flip(
    question: &Question,
    range: Option<Range>,
    steps: usize,
    sums: &[Sum],
    map: Option<Vec<f32>>,
) -> Flip {
    let total = sums.iter().fold(Sum::default(), |all, tile| Sum {
        sum: all.sum + tile.sum,
        count: all.count + tile.count,
        max: all.max.max(tile.max),
    });
    Flip {
        mean: total.sum / total.count.max(1) as f64,
        max: total.max.into(),
        exposures: range.map(|range| [range.start.into(), range.stop.into()]),
        steps: steps as u32,
        pixels_per_degree: question.pixels_per_degree,
        map,
    }
}

/// Exposures in stops.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Range {
    start: f32,
    stop: f32,
}

/// The most exposures: the tail of a pulse may be 250 stops below its peak.
const MOST_EXPOSURES: f32 = 64.0;

impl Range {
    /// The factors by which light is multiplied.
    fn gains(self) -> Vec<f32> {
        let stops = (self.stop - self.start).ceil();
        let steps = stops.clamp(2.0, MOST_EXPOSURES) as u32;
        let step = (self.stop - self.start) / (steps - 1) as f32;
        let exposure = |i: u32| libm::exp2f(self.start + i as f32 * step);
        // Equal exposures give equal errors.
        let steps = if step == 0.0 { 1 } else { steps };
        (0..steps).map(exposure).collect()
    }
}

/// The exposures of the reference; `None` if it is black.
fn exposures(question: &Question) -> Option<Range> {
    let mut luminances = luminances(question);
    let largest = luminances.iter().copied().fold(0.0f32, f32::max);
    let mut middle = median(&mut luminances);
    if middle <= 0.0 {
        luminances.retain(|y| *y > 0.0);
        middle = median(&mut luminances);
    }
    // Exposures start where the brightest light is shown as 0.85, and end where the median is (Andersson et al. 2021).
    let white = colour::inverse_tone_map(0.85);
    // For subnormal f32 numbers the quotient is infinite: exposures are limited to finite f32 factors.
    let stops = |luminance: f32| libm::log2f(white / luminance).clamp(-126.0, 127.0);
    (largest > 0.0 && largest.is_finite()).then(|| Range {
        start: stops(largest),
        stop: stops(middle),
    })
}

fn median(values: &mut [f32]) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// Finite luminances of the reference.
fn luminances(question: &Question) -> Vec<f32> {
    let [width, height] = question.size;
    let mut luminances = Vec::with_capacity(width * height);
    let mut rows = [vec![0.0; width], vec![0.0; width], vec![0.0; width]];
    for y in 0..height {
        for (plane, row) in question.reference.iter().zip(&mut rows) {
            plane.part(y, 0..width, row);
        }
        let [r, g, b] = &rows;
        let row = (0..width).map(|x| 0.2126 * r[x] + 0.7152 * g[x] + 0.0722 * b[x]);
        luminances.extend(row.filter(|y| y.is_finite()));
    }
    luminances
}
