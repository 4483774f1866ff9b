//! Samples of many lookups: prefetched some lookups ahead, gathered, widened, summed.

use half::f16;

use super::places::{BATCH, MOST_BINS, Places};
use super::reader::Sample;
use crate::accel::vectors::prefetch;
use crate::io::cube::CubeSamples;

/// Lookups whose samples are gathered together.
const GROUP: usize = 16;
/// Samples of a group, plus one that may be read without effect.
const ROOM: usize = GROUP * 4 * MOST_BINS * 3 + 1;

/// The positions and weights of lookups: by tap, bin and lookup.
pub(super) trait Reads {
    /// The index of the `k`-th lookup.
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

/// The samples that lookups read.
pub(super) enum Source<'a, S> {
    /// All samples, with absolute origins.
    Whole(&'a [S]),
    /// Samples in pieces: the piece that each tap reads, by tap and lookup, in which its origin counts.
    Pieces(Vec<&'a [S]>, &'a [[u16; BATCH]; 4]),
}

impl<'a, S> Source<'a, S> {
    /// `count` samples from the `first` on; `None` if they do not all exist. Positions of lookups that are not plain may be arbitrary.
    #[inline(always)]
    fn get(&self, (tap, at): (usize, usize), first: usize, count: usize) -> Option<&'a [S]> {
        let samples = match self {
            Source::Whole(samples) => samples,
            Source::Pieces(pieces, which) => pieces.get(usize::from(which[tap][at]))?,
        };
        samples.get(first..first + count)
    }
}

/// Samples of any type.
pub(super) enum AnySource<'a> {
    F16(Source<'a, f16>),
    F32(Source<'a, f32>),
    F64(Source<'a, f64>),
}

impl<'a> AnySource<'a> {
    /// The whole slice of samples.
    pub fn whole(samples: &'a CubeSamples) -> Self {
        match samples {
            CubeSamples::F16(samples) => AnySource::F16(Source::Whole(samples)),
            CubeSamples::F32(samples) => AnySource::F32(Source::Whole(samples)),
            CubeSamples::F64(samples) => AnySource::F64(Source::Whole(samples)),
        }
    }
}

/// Sums the samples of `count` lookups of N bins, for cubes with `C` channels.
#[inline(always)]
pub(super) fn read<R: Reads, const N: usize>(
    (source, channels): (&AnySource, usize),
    places: &R,
    count: usize,
    factor: f64,
    radiance: &mut [[f64; 4]; BATCH],
) {
    match (source, channels) {
        (AnySource::F16(s), 3) => read_as::<_, _, 3, N>(s, places, count, factor, radiance),
        (AnySource::F16(s), _) => read_as::<_, _, 1, N>(s, places, count, factor, radiance),
        (AnySource::F32(s), 3) => read_as::<_, _, 3, N>(s, places, count, factor, radiance),
        (AnySource::F32(s), _) => read_as::<_, _, 1, N>(s, places, count, factor, radiance),
        (AnySource::F64(s), 3) => read_as::<_, _, 3, N>(s, places, count, factor, radiance),
        (AnySource::F64(s), _) => read_as::<_, _, 1, N>(s, places, count, factor, radiance),
    }
}

#[inline(always)]
fn read_as<S: Sample, R: Reads, const C: usize, const N: usize>(
    source: &Source<S>,
    places: &R,
    count: usize,
    factor: f64,
    radiance: &mut [[f64; 4]; BATCH],
) {
    // The samples of the next group are being prefetched while those of this one are summed.
    let mut staged = [S::ZERO; ROOM];
    let mut wide = [S::ZERO.wide(); ROOM];
    prefetch_group::<S, R, C, N>(source, places, 0, count);
    let mut begin = 0;
    while begin < count {
        let end = (begin + GROUP).min(count);
        prefetch_group::<S, R, C, N>(source, places, end, count);
        let mut k = begin;
        while k < end {
            let to = &mut staged[(k - begin) * 4 * N * C..];
            stage::<S, R, C, N>(source, places, places.lookup(k), to);
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
fn prefetch_group<S, R: Reads, const C: usize, const N: usize>(
    source: &Source<S>,
    places: &R,
    begin: usize,
    count: usize,
) {
    let mut k = begin;
    while k < (begin + GROUP).min(count) {
        let at = places.lookup(k);
        let mut tap = 0;
        while tap < 4 {
            if let Some(samples) = source.get((tap, at), places.origin(tap, at), N * C) {
                prefetch(samples, 0);
                prefetch(samples, N * C - 1);
            }
            tap += 1;
        }
        k += 1;
    }
}

/// Copies the samples of one lookup, tap after tap.
#[inline(always)]
fn stage<S: Sample, R: Reads, const C: usize, const N: usize>(
    source: &Source<S>,
    places: &R,
    at: usize,
    to: &mut [S],
) {
    let to = &mut to[..4 * N * C];
    let mut tap = 0;
    while tap < 4 {
        if let Some(from) = source.get((tap, at), places.origin(tap, at), N * C) {
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
    // Four lanes, which fill a vector: with three channels the fourth is meaningless.
    // One number more: with three channels the fourth lane of the last bin reads one past the samples.
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
