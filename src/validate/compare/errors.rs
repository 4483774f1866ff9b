//! Errors of one channel, or of several combined.
//!
//! With r the reference, c the candidate, e = c − r, over the n samples of the region that are numbers in both pictures (if there are no
//! such samples there are no errors at all, rather than errors of 0):
//!
//! | metric | definition | also known as |
//! |---|---|---|
//! | bias | Σe / n | |
//! | mae | Σ\|e\| / n | `oiiotool --diff` "Mean error", `imgtool diff --metric MAE` |
//! | rmse | √(Σe² / n) | `oiiotool --diff` "RMS error"; its square is `imgtool`'s MSE |
//! | relrmse | √(Σe² / Σr²); 0 where both sums are 0, none where only Σr² is | |
//! | mrse | Σ e²/(\|r\| + 0.01)² / n: the floor 0.01 keeps it finite where r is near 0, or below | `imgtool diff --metric MRSE` of pbrt-v4 where r ≥ 0 |
//! | max | the largest \|e\|, and where (first in reading order) | `oiiotool --diff` "Max error" |
//! | psnr | 20 log₁₀(range / rmse), dB; infinite where rmse is 0 | `skimage.metrics.peak_signal_noise_ratio` |
//! | p50 … p99.9 | nearest-rank percentiles of \|e\| | |
//!
//! `range` is 1 for pictures of display codes, otherwise the largest \|r\| of the region. Percentiles come from a histogram of \|e\| in
//! single precision with bins of relative width 2⁻¹⁰, so that memory does not grow with the picture: they are the upper end of the bin, at
//! most 0.1 % too large, and never above max. Sums are taken within rows and then over rows, in f64, in a fixed order.

use serde::Serialize;

/// Low bits of a single-precision number that the histogram ignores: 2¹⁰ bins per octave.
const DROPPED: u32 = 13;
/// Bins for all single-precision numbers ≥ 0.
const BINS: usize = (0x7f80_0000 >> DROPPED) + 1;
/// Floor that mrse adds to |r| so that it stays finite.
const MRSE_FLOOR: f64 = 0.01;

/// Errors, in the unit of the channel unless they are ratios.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Errors {
    /// Number of samples that were compared.
    pub count: u64,
    /// Mean of candidate − reference.
    pub bias: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// Root mean square error.
    pub rmse: f64,
    /// Root mean square error relative to the reference's root mean square.
    pub relrmse: Option<f64>,
    /// Mean relative square error.
    pub mrse: f64,
    /// Largest absolute error.
    pub max: f64,
    /// Column and row of the largest error; `None` if there is no error.
    pub max_at: Option<[u32; 2]>,
    /// The range on which psnr and ssim are based.
    pub range: f64,
    /// Peak signal-to-noise ratio, decibels; `None` if the pictures are identical.
    pub psnr: Option<f64>,
    /// Median of the absolute errors.
    pub p50: f64,
    /// Their 90th percentile.
    pub p90: f64,
    /// Their 99th percentile.
    pub p99: f64,
    /// Their 99.9th percentile.
    #[serde(rename = "p99.9")]
    pub p99_9: f64,
    /// Mean structural similarity; `None` for fewer than 7 × 7 pixels.
    pub ssim: Option<f64>,
    /// Distribution of the absolute errors.
    #[serde(skip)]
    pub histogram: Histogram,
}

/// Number of absolute errors in each quarter of an octave.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Histogram {
    /// Errors that are exactly 0.
    pub zeros: u64,
    /// Lower ends of bins, ascending, and their counts; a bin extends to the next one.
    pub bins: Vec<(f64, u64)>,
}

/// Running sums of errors, to which rows are added in order.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    count: u64,
    error: f64,
    absolute: f64,
    square: f64,
    reference: f64,
    relative: f64,
    max: f64,
    max_at: Option<[u32; 2]>,
    largest: f64,
    bins: Vec<u64>,
}

impl Sums {
    pub fn new() -> Self {
        Sums {
            count: 0,
            error: 0.0,
            absolute: 0.0,
            square: 0.0,
            reference: 0.0,
            relative: 0.0,
            max: 0.0,
            max_at: None,
            largest: 0.0,
            bins: vec![0; BINS],
        }
    }

    /// Adds row `y`; samples that are not finite in either row, and those outside of `chosen`, are skipped. Returns the number of samples
    /// added.
    pub fn add_row(&mut self, y: usize, r: &[f64], c: &[f64], chosen: Option<&[bool]>) -> u64 {
        let before = self.count;
        // Sums of this row alone, added to the total at its end, so that the order does not depend on the strips.
        let mut row = [0.0f64; 5];
        for x in 0..r.len().min(c.len()) {
            let (r, c) = (r[x], c[x]);
            let e = c - r;
            if !e.is_finite() || chosen.is_some_and(|chosen| !chosen[x]) {
                continue;
            }
            let absolute = e.abs();
            let relative = e / (r.abs() + MRSE_FLOOR);
            self.count += 1;
            row[0] += e;
            row[1] += absolute;
            row[2] += e * e;
            row[3] += r * r;
            row[4] += relative * relative;
            self.largest = self.largest.max(r.abs());
            if absolute > self.max {
                self.max = absolute;
                self.max_at = Some([x as u32, y as u32]);
            }
            self.bins[bin(absolute)] += 1;
        }
        self.error += row[0];
        self.absolute += row[1];
        self.square += row[2];
        self.reference += row[3];
        self.relative += row[4];
        self.count - before
    }

    /// Adds sums of another channel over the same rows.
    pub fn add(&mut self, other: &Sums) {
        self.count += other.count;
        self.error += other.error;
        self.absolute += other.absolute;
        self.square += other.square;
        self.reference += other.reference;
        self.relative += other.relative;
        self.largest = self.largest.max(other.largest);
        if other.max > self.max {
            (self.max, self.max_at) = (other.max, other.max_at);
        }
        for (bin, other) in self.bins.iter_mut().zip(&other.bins) {
            *bin += other;
        }
    }

    /// The largest |r|.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// The errors, with psnr relative to `range`; `None` if no sample was compared.
    pub fn errors(&self, range: f64, ssim: Option<f64>) -> Option<Errors> {
        (self.count > 0).then(|| self.of_samples(range, ssim))
    }

    /// Errors from sums over pixels. Quotients with a divisor of 0 are `None`; identical pictures have no finite PSNR.
    fn of_samples(&self, range: f64, ssim: Option<f64>) -> Errors {
        let n = self.count as f64;
        let rmse = (self.square / n).sqrt();
        let percentile = |p| self.percentile(p);
        Errors {
            count: self.count,
            bias: self.error / n,
            mae: self.absolute / n,
            rmse,
            relrmse: match (self.square, self.reference) {
                (0.0, _) => Some(0.0),
                (_, 0.0) => None,
                (square, reference) => Some((square / reference).sqrt()),
            },
            mrse: self.relative / n,
            max: self.max,
            max_at: self.max_at,
            range,
            psnr: (rmse > 0.0).then(|| 20.0 * libm::log10(range / rmse)),
            p50: percentile(50.0),
            p90: percentile(90.0),
            p99: percentile(99.0),
            p99_9: percentile(99.9),
            ssim,
            histogram: self.histogram(),
        }
    }

    fn percentile(&self, p: f64) -> f64 {
        // Rounding of p must not push the rank up by one.
        let rank = (p / 100.0 * self.count as f64 * (1.0 - 1e-12)).ceil() as u64;
        let mut seen = 0;
        for (bin, count) in self.bins.iter().enumerate() {
            seen += count;
            if seen >= rank.max(1) {
                return if bin == 0 {
                    0.0
                } else {
                    lower(bin + 1).min(self.max)
                };
            }
        }
        self.max
    }

    fn histogram(&self) -> Histogram {
        const QUARTER: usize = 1 << (21 - DROPPED);
        let filled = |bins: &[u64]| bins.iter().position(|&n| n > 0);
        let Some(first) = filled(&self.bins[1..]) else {
            return Histogram {
                zeros: self.bins[0],
                bins: Vec::new(),
            };
        };
        let last = self.bins.iter().rposition(|&n| n > 0).unwrap_or(0);
        let quarters = (first + 1) / QUARTER..=last / QUARTER;
        let count = |quarter: usize| {
            let span = (quarter * QUARTER).max(1)..((quarter + 1) * QUARTER).min(BINS);
            (lower(quarter * QUARTER), self.bins[span].iter().sum())
        };
        Histogram {
            zeros: self.bins[0],
            bins: quarters.map(count).collect(),
        }
    }
}

/// The bin of an absolute error; the first holds errors that are 0 in single precision.
#[inline]
fn bin(absolute: f64) -> usize {
    let bits = (absolute as f32).to_bits();
    ((bits >> DROPPED) as usize + usize::from(bits > 0)).min(BINS - 1)
}

/// The lower end of a bin.
fn lower(bin: usize) -> f64 {
    match bin {
        0 => 0.0,
        bin => f32::from_bits(((bin - 1) as u32) << DROPPED).into(),
    }
}
