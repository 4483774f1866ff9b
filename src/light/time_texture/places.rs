//! Positions and weights of lookups, as many at a time as a vector holds.
//!
//! Indices are computed in f64, which represents them exactly, and converted to integers by adding 2⁵²: vectors have addition, but no
//! such conversion.

use super::axis::Timeline;
use super::weights::{catmull_rom, less_curvature};

/// Maximum number of lookups in a batch.
pub const BATCH: usize = 256;

/// Maximum number of bins that a filter reads.
pub(super) const MOST_BINS: usize = 6;

/// The reads of lookups.
#[derive(Debug)]
pub(super) struct Places {
    /// The first sample of each tap.
    pub origins: [[u64; BATCH]; 4],
    /// Weights of the taps.
    pub taps: [[f64; BATCH]; 4],
    /// Weights of the bins.
    pub bins: [[f64; BATCH]; MOST_BINS],
    /// Whether the lookup is entirely within the data.
    pub plain: [bool; BATCH],
}

/// A filter along time: N weights on consecutive bins.
pub(super) trait Filter<const N: usize> {
    /// The first bin and the weights, for bin coordinate `b`, and the number of bins less one.
    fn weights(b: f64, last: f64) -> (f64, [f64; N]);
}

pub(super) struct Nearest;
pub(super) struct Linear;
pub(super) struct Cubic;
pub(super) struct CubicMeans;

impl Filter<1> for Nearest {
    #[inline(always)]
    fn weights(b: f64, last: f64) -> (f64, [f64; 1]) {
        (floor(b.max(0.0).min(last)), [1.0])
    }
}

impl Filter<2> for Linear {
    #[inline(always)]
    fn weights(b: f64, _: f64) -> (f64, [f64; 2]) {
        let k = floor(b - 0.5);
        let f = (b - 0.5) - k;
        (k, [1.0 - f, f])
    }
}

impl Filter<4> for Cubic {
    #[inline(always)]
    fn weights(b: f64, _: f64) -> (f64, [f64; 4]) {
        let k = floor(b - 0.5);
        (k - 1.0, catmull_rom((b - 0.5) - k))
    }
}

impl Filter<6> for CubicMeans {
    #[inline(always)]
    fn weights(b: f64, _: f64) -> (f64, [f64; 6]) {
        let k = floor(b - 0.5);
        (k - 2.0, less_curvature(catmull_rom((b - 0.5) - k)))
    }
}

/// ⌊x⌋ for |x| < 2⁵⁰, by additions, which are vectorized.
#[inline(always)]
fn floor(x: f64) -> f64 {
    // From 2⁵² on f64 holds only integers, so the sum is rounded to one; the factor 1.5 keeps it there for x < 0.
    const INTEGERS: f64 = 1.5 * (1u64 << 52) as f64;
    let nearest = (x + INTEGERS) - INTEGERS;
    nearest - if nearest > x { 1.0 } else { 0.0 }
}

/// Converts an f64 integer in [0, 2⁵²) to an integer type, by an addition.
#[inline(always)]
pub(super) fn integer(x: f64) -> u64 {
    const INTEGERS: f64 = (1u64 << 52) as f64;
    (x + INTEGERS).to_bits() & ((1 << 52) - 1)
}

/// The positions of lookups, and their weights.
#[inline(always)]
pub(super) fn place<F: Filter<N>, const N: usize>(
    [height, width, bins, channels]: [usize; 4],
    timeline: &Timeline,
    u: &[f64; BATCH],
    v: &[f64; BATCH],
    t: &[f64; BATCH],
    count: usize,
    places: &mut Places,
) {
    let (width, height) = (width as f64, height as f64);
    let (bins, channels) = (bins as f64, channels as f64);
    let (start, end, per_metre) = (timeline.start, timeline.end, timeline.bins_per_metre);
    let last = bins - 1.0;
    for i in 0..count.min(BATCH) {
        let (u, v, t) = (u[i], v[i], t[i]);
        // Plain: on the texture, within the data, and with all bins of the filter present.
        let on_texture = (0.0..=1.0).contains(&u) & (0.0..=1.0).contains(&v);
        let there = on_texture & (t >= start) & (t <= end);
        // The four texels around the point, and the bins around the time.
        let (left, right, fx) = neighbours(u * width, width - 1.0);
        let (top, bottom, fy) = neighbours(v * height, height - 1.0);
        let b = ((t - start) * per_metre).max(-3.0).min(last + 4.0);
        let (first, weights) = F::weights(b, last);
        let within = (first >= 0.0) & (first + N as f64 <= bins);
        places.plain[i] = there & within;
        // Index of the first sample of each tap: ((row · W + column) · T + bin) · C.
        let (top, bottom) = (top * width, bottom * width);
        places.origins[0][i] = integer(((top + left) * bins + first) * channels);
        places.origins[1][i] = integer(((top + right) * bins + first) * channels);
        places.origins[2][i] = integer(((bottom + left) * bins + first) * channels);
        places.origins[3][i] = integer(((bottom + right) * bins + first) * channels);
        // Bilinear weights.
        places.taps[0][i] = (1.0 - fx) * (1.0 - fy);
        places.taps[1][i] = fx * (1.0 - fy);
        places.taps[2][i] = (1.0 - fx) * fy;
        places.taps[3][i] = fx * fy;
        let mut k = 0;
        while k < N {
            places.bins[k][i] = weights[k];
            k += 1;
        }
    }
}

/// The two cells whose centres enclose `x`, and the weight of the second; `last` is the index of the last cell.
#[inline(always)]
pub(super) fn neighbours(x: f64, last: f64) -> (f64, f64, f64) {
    let x = (x - 0.5).max(0.0).min(last);
    let first = floor(x);
    (first, (first + 1.0).min(last), x - first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_are_found_below_numbers_of_both_signs() {
        for x in [
            -3.5,
            -3.0,
            -0.1,
            0.0,
            0.4,
            0.5,
            0.6,
            1.0,
            1.5,
            2.5,
            1e9 + 0.7,
        ] {
            assert_eq!(floor(x), f64::floor(x), "{x}");
        }
        assert_eq!(integer(4_503_599_627_370_495.0), 4_503_599_627_370_495);
        assert_eq!(integer(0.0), 0);
    }
}
