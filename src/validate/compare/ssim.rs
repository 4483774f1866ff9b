//! Structural similarity (Wang, Bovik, Sheikh, Simoncelli, IEEE TIP 13(4), 2004), as scikit-image computes it by default: uniform 7 × 7
//! windows, sample covariances, K₁ = 0.01, K₂ = 0.03.
//!
//! ```text
//!         (2 μr μc + C₁)(2 σrc + C₂)
//! SSIM = ─────────────────────────────      C₁ = (K₁ range)², C₂ = (K₂ range)²
//!        (μr² + μc² + C₁)(σr² + σc² + C₂)
//! ```
//!
//! The mean is over pixels of the region whose window lies in the picture and contains numbers only. Windows slide: sums over columns of
//! seven rows are updated by the row that enters and the one that leaves, and restarted in each strip, so that the result does not depend
//! on how strips are distributed.

use rayon::prelude::*;

use super::options::Region;
use super::picture::Plane;
use crate::accel::vectors::{VectorLoop, dispatch};

/// Pixels from a window's centre to its edge.
const RADIUS: usize = 3;
/// Pixels across a window.
const SIZE: usize = 2 * RADIUS + 1;
/// Rows of a strip.
const STRIP: usize = 64;

/// Mean similarity of two planes; `None` if no pixel has a window.
pub(super) fn mean(pair: [Plane; 2], size: [usize; 2], region: &Region, range: f64) -> Option<f64> {
    let [width, height] = size;
    if width < SIZE || height < SIZE {
        return None;
    }
    let inner = RADIUS..height - RADIUS;
    let strips: Vec<usize> = inner.clone().step_by(STRIP).collect();
    let parts: Vec<(f64, u64)> = (strips.into_par_iter())
        .map(|top| {
            let rows = top..(top + STRIP).min(inner.end);
            let mut strip = Strip::new(pair, width, range);
            let mut total = (0.0, 0);
            dispatch(Summing {
                strip: &mut strip,
                rows,
                region,
                total: &mut total,
            });
            total
        })
        .collect();
    let (sum, count) = (parts.iter()).fold((0.0, 0), |(s, n), (sum, count)| (s + sum, n + count));
    (count > 0).then(|| sum / count as f64)
}

/// The sums over a window: of r, c, r², c², rc, and of samples that are not numbers.
const SUMS: usize = 6;

struct Strip<'a> {
    pair: [Plane<'a>; 2],
    width: usize,
    c1: f64,
    c2: f64,
    /// Sums over seven rows, column by column.
    columns: [Vec<f64>; SUMS],
    rows: [Vec<f64>; 2],
    windows: [Vec<f64>; SUMS],
}

/// The similarities in rows of a strip.
struct Summing<'t, 'a> {
    strip: &'t mut Strip<'a>,
    rows: std::ops::Range<usize>,
    region: &'t Region,
    /// Their sum and their number.
    total: &'t mut (f64, u64),
}

impl VectorLoop for Summing<'_, '_> {
    #[inline(always)]
    fn run(self) {
        *self.total = self.strip.sum(self.rows, self.region);
    }
}

impl<'a> Strip<'a> {
    fn new(pair: [Plane<'a>; 2], width: usize, range: f64) -> Self {
        let zeros = || std::array::from_fn(|_| vec![0.0; width]);
        Strip {
            pair,
            width,
            c1: (0.01 * range) * (0.01 * range),
            c2: (0.03 * range) * (0.03 * range),
            columns: zeros(),
            rows: [Vec::new(), Vec::new()],
            windows: zeros(),
        }
    }

    /// The sum of the similarities in these rows, and their number.
    #[inline(always)]
    fn sum(&mut self, rows: std::ops::Range<usize>, region: &Region) -> (f64, u64) {
        let (mut sum, mut count) = (0.0, 0);
        for y in rows.start - RADIUS..rows.start + RADIUS {
            self.slide(y, 1.0);
        }
        for y in rows {
            self.slide(y + RADIUS, 1.0);
            let (row, n) = self.similarities(y, region);
            (sum, count) = (sum + row, count + n);
            self.slide(y - RADIUS, -1.0);
        }
        (sum, count)
    }

    /// Adds row `y` to the sums over columns, or subtracts it.
    #[inline(always)]
    fn slide(&mut self, y: usize, sign: f64) {
        for (plane, row) in self.pair.iter().zip(&mut self.rows) {
            plane.row(y, row);
        }
        // Slices of equal length: without bounds checks the loop vectorizes.
        let width = self.width;
        let [r, c] = self.rows.each_ref().map(|row| &row[..width]);
        let [sr, sc, srr, scc, src, bad] = self.columns.each_mut().map(|sums| &mut sums[..width]);
        for x in 0..width {
            let usable = (r[x] - c[x]).is_finite();
            let (r, c) = if usable { (r[x], c[x]) } else { (0.0, 0.0) };
            sr[x] += sign * r;
            sc[x] += sign * c;
            srr[x] += sign * (r * r);
            scc[x] += sign * (c * c);
            src[x] += sign * (r * c);
            bad[x] += if usable { 0.0 } else { sign };
        }
    }

    /// The similarities of row `y`, for the window whose sums the columns hold.
    #[inline(always)]
    fn similarities(&mut self, y: usize, region: &Region) -> (f64, u64) {
        for (window, column) in self.windows.iter_mut().zip(&self.columns) {
            across(column, window);
        }
        let n = (SIZE * SIZE) as f64;
        let (mean, sample) = (1.0 / n, n / (n - 1.0));
        let inner = self.width - 2 * RADIUS;
        let [sr, sc, srr, scc, src, bad] = self.windows.each_mut().map(|sums| &mut sums[..inner]);
        // Means and sample covariances of the window, then the fraction of the definition.
        for x in 0..inner {
            let (r, c) = (sr[x] * mean, sc[x] * mean);
            let vr = sample * (srr[x] * mean - r * r);
            let vc = sample * (scc[x] * mean - c * c);
            let vrc = sample * (src[x] * mean - r * c);
            let over = (2.0 * r * c + self.c1) * (2.0 * vrc + self.c2);
            let under = (r * r + c * c + self.c1) * (vr + vc + self.c2);
            // Rounding of values far beyond the range may exceed the bounds of the definition.
            sr[x] = (over / under).clamp(-1.0, 1.0);
        }
        let chosen = (!region.is_all()).then(|| region.row(y, self.width));
        let (mut sum, mut count) = (0.0, 0);
        for x in 0..inner {
            let is_chosen = chosen.as_ref().is_none_or(|chosen| chosen[x + RADIUS]);
            // Black on black has no range: the pictures are equal there. Squares that overflow carry no information.
            let similarity = if sr[x].is_nan() { 1.0 } else { sr[x] };
            if is_chosen && bad[x] == 0.0 && (srr[x] + scc[x]).is_finite() {
                sum += similarity;
                count += 1;
            }
        }
        (sum, count)
    }
}

/// Sums of seven neighbours, starting at the index of the sum.
#[inline(always)]
fn across(column: &[f64], window: &mut [f64]) {
    let inner = column.len() - 2 * RADIUS;
    for (x, sum) in window[..inner].iter_mut().enumerate() {
        let c = &column[x..x + SIZE];
        *sum = ((c[0] + c[1]) + (c[2] + c[3])) + ((c[4] + c[5]) + c[6]);
    }
}
