//! Samples of many lookups: asked for some lookups ahead, brought together, widened, summed.

use super::places::{BATCH, MOST_BINS, Places};
use super::reader::Sample;
use crate::accel::vectors::prefetch;

/// Lookups whose samples are brought together.
const GROUP: usize = 16;
/// Samples of a group, and one that may be read without effect.
const ROOM: usize = GROUP * 4 * MOST_BINS * 3 + 1;

/// Where lookups read, and with which weights: by tap, bin and lookup.
pub(super) trait Reads {
    /// Which lookup comes `k`-th.
    #[inline(always)]
    fn lookup(&self, k: usize) -> usize {
        k
    }
    /// The first sample.
    fn origin(&self, tap: usize, at: usize) -> usize;
    /// The weight of a tap.
    fn weight(&self, tap: usize, at: usize) -> f64;
    /// The weight of a bin of a tap.
    fn bin_weight(&self, tap: usize, bin: usize, at: usize) -> f64;
}

impl Reads for Places {
    #[inline(always)]
    fn origin(&self, tap: usize, at: usize) -> usize {
        self.origins[tap][at] as usize
    }

    #[inline(always)]
    fn weight(&self, tap: usize, at: usize) -> f64 {
        self.taps[tap][at]
    }

    #[inline(always)]
    fn bin_weight(&self, _: usize, bin: usize, at: usize) -> f64 {
        self.bins[bin][at]
    }
}

/// Sums the samples of `count` lookups.
#[inline(always)]
pub(super) fn read<S: Sample, R: Reads, const C: usize, const N: usize>(
    samples: &[S],
    places: &R,
    count: usize,
    factor: f64,
    radiance: &mut [[f64; 4]; BATCH],
) {
    // The samples of the next group are on their way while those of this one are summed.
    let mut staged = [S::ZERO; ROOM];
    let mut wide = [S::ZERO.wide(); ROOM];
    ask_for::<S, R, C, N>(samples, places, 0, count);
    let mut begin = 0;
    while begin < count {
        let end = (begin + GROUP).min(count);
        ask_for::<S, R, C, N>(samples, places, end, count);
        let mut k = begin;
        while k < end {
            let to = &mut staged[(k - begin) * 4 * N * C..];
            stage::<S, R, C, N>(samples, places, places.lookup(k), to);
            k += 1;
        }
        let used = (end - begin) * 4 * N * C;
        widen(&staged[..used], &mut wide[..used]);
        let mut k = begin;
        while k < end {
            let at = places.lookup(k);
            let values = &wide[(k - begin) * 4 * N * C..];
            radiance[at] = sum::<S, R, C, N>(values, places, at, factor);
            k += 1;
        }
        begin = end;
    }
}

/// Prefetches the samples of the group that begins at `begin`.
#[inline(always)]
fn ask_for<S, R: Reads, const C: usize, const N: usize>(
    samples: &[S],
    places: &R,
    begin: usize,
    count: usize,
) {
    let mut k = begin;
    while k < (begin + GROUP).min(count) {
        let at = places.lookup(k);
        let mut tap = 0;
        while tap < 4 {
            let first = places.origin(tap, at);
            prefetch(samples, first);
            prefetch(samples, first + N * C - 1);
            tap += 1;
        }
        k += 1;
    }
}

/// Copies the samples of one lookup, tap after tap.
#[inline(always)]
fn stage<S: Sample, R: Reads, const C: usize, const N: usize>(
    samples: &[S],
    places: &R,
    at: usize,
    to: &mut [S],
) {
    let to = &mut to[..4 * N * C];
    let mut tap = 0;
    while tap < 4 {
        let first = places.origin(tap, at);
        // What is not plain may lie anywhere.
        if let Some(from) = samples.get(first..first + N * C) {
            to[tap * N * C..(tap + 1) * N * C].copy_from_slice(from);
        }
        tap += 1;
    }
}

#[inline(always)]
fn widen<S: Sample>(staged: &[S], wide: &mut [S::Wide]) {
    for (wide, sample) in wide.iter_mut().zip(staged) {
        *wide = sample.wide();
    }
}

/// The weighted sum over taps and bins, times `factor`.
#[inline(always)]
fn sum<S: Sample, R: Reads, const C: usize, const N: usize>(
    values: &[S::Wide],
    places: &R,
    at: usize,
    factor: f64,
) -> [f64; 4] {
    // Four lanes, which fill a vector: with three channels the fourth sums what belongs to others.
    let values = &values[..4 * N * C + 1];
    let mut sum = [0.0; 4];
    let mut tap = 0;
    while tap < 4 {
        let mut texel = [0.0; 4];
        let mut bin = 0;
        while bin < N {
            let weight = places.bin_weight(tap, bin, at);
            let first = (tap * N + bin) * C;
            let mut c = 0;
            while c < if C == 3 { 4 } else { 1 } {
                let value: f64 = values[first + c].into();
                texel[c] += weight * value;
                c += 1;
            }
            bin += 1;
        }
        let weight = places.weight(tap, at);
        let mut c = 0;
        while c < 4 {
            sum[c] += weight * texel[c];
            c += 1;
        }
        tap += 1;
    }
    if C != 3 {
        sum = [sum[0]; 4];
    }
    let mut c = 0;
    while c < 4 {
        sum[c] *= factor;
        c += 1;
    }
    sum
}
