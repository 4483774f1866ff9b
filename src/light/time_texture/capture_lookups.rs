//! Batched lookups at points that a capture camera saw: [`TimeTexture::sample_located`] if all taps have data.
//!
//! As for lookups by texture coordinates, but each tap is read at its own time, with its own bin weights. The operations are those of a
//! single lookup, in the same order, so that results are the same bit for bit.

use super::axis::{Reading, Timeline};
use super::capture_points::CapturePoints;
use super::from_disk::FromDisk;
use super::gather::{Reads, read};
use super::lookups::bytes_of;
use super::places::{BATCH, Cubic, CubicMeans, Filter, Linear, MOST_BINS, Nearest, integer};
use super::texture::TimeTexture;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::scene::model::TimeFilter;

/// A batch of lookups and, after [`TimeTexture::sample_taps`], the answers.
#[derive(Debug)]
pub struct CaptureLookups {
    /// The number of lookups.
    count: usize,
    /// The first sample of each tap, and the weights of its bins.
    origins: [[u64; BATCH]; 4],
    bins: [[[f64; BATCH]; MOST_BINS]; 4],
    /// Whether the lookup is entirely within the data.
    plain: [bool; BATCH],
    radiance: [[f64; 4]; BATCH],
    /// The sum of its taps' weights.
    held: [f64; BATCH],
    from_disk: FromDisk,
}

impl Default for CaptureLookups {
    fn default() -> Self {
        CaptureLookups {
            count: 0,
            origins: [[0; BATCH]; 4],
            bins: [[[0.0; BATCH]; MOST_BINS]; 4],
            plain: [false; BATCH],
            radiance: [[0.0; 4]; BATCH],
            held: [0.0; BATCH],
            from_disk: FromDisk::default(),
        }
    }
}

impl CaptureLookups {
    /// Bytes of samples that were read from `texture`.
    pub fn bytes_read(&self, texture: &TimeTexture) -> u64 {
        bytes_of(
            texture,
            self.plain[..self.count].iter().filter(|p| **p).count(),
        )
    }

    /// Resets it to a batch of `count` without answers.
    pub fn clear(&mut self, count: usize) {
        self.count = count.min(BATCH);
        self.plain = [false; BATCH];
    }

    /// The radiance of point `at` of the batch and the sum of its taps' weights; `None` if the lookup is not entirely within the data.
    #[inline(always)]
    pub fn answer(&self, at: usize) -> Option<([f64; 3], f64)> {
        let [r, g, b, _] = self.radiance[at];
        self.plain[at].then_some(([r, g, b], self.held[at]))
    }
}

/// The reads of a batch, with their weights.
struct TapReads<'a> {
    weights: [&'a [f64; BATCH]; 4],
    origins: &'a [[u64; BATCH]; 4],
    bins: &'a [[[f64; BATCH]; MOST_BINS]; 4],
    /// The plain lookups of the batch.
    plain: [u8; BATCH],
}

impl Reads for TapReads<'_> {
    #[inline(always)]
    fn lookup(&self, k: usize) -> usize {
        usize::from(self.plain[k])
    }

    #[inline(always)]
    fn origin(&self, tap: usize, at: usize) -> usize {
        self.origins[tap][at] as usize
    }

    #[inline(always)]
    fn weight(&self, tap: usize, at: usize) -> f64 {
        self.weights[tap][at]
    }

    #[inline(always)]
    fn bin_weight(&self, tap: usize, bin: usize, at: usize) -> f64 {
        self.bins[tap][bin][at]
    }
}

impl TimeTexture {
    /// Reads `count` of `points` from `begin` on, at most a batch, whose light left at `times`, a list padded to whole batches. Blocked
    /// points are left out.
    pub fn sample_taps(
        &self,
        (points, begin, count): (&CapturePoints, usize, usize),
        (times, blocked): (&[f64], &[bool]),
        lookups: &mut CaptureLookups,
    ) {
        lookups.clear(count);
        let is_open = points.is_plain()[begin..].iter().zip(&blocked[begin..]);
        for (plain, (is_plain, blocked)) in lookups.plain[..count].iter_mut().zip(is_open) {
            *plain = *is_plain & !blocked;
        }
        let timeline = self.timeline();
        let batch = (points, begin, times);
        match &timeline.reading {
            Reading::Uniform(TimeFilter::Nearest) => {
                dispatch(Plan::<Nearest, 1>::new(self, batch, lookups));
            }
            Reading::Uniform(TimeFilter::Linear) => {
                dispatch(Plan::<Linear, 2>::new(self, batch, lookups));
            }
            Reading::Uniform(TimeFilter::Cubic) => {
                dispatch(Plan::<Cubic, 4>::new(self, batch, lookups));
            }
            Reading::Uniform(TimeFilter::CubicMeans) => {
                dispatch(Plan::<CubicMeans, 6>::new(self, batch, lookups));
            }
            Reading::Irregular(_) => lookups.plain.fill(false),
        }
    }
}

/// The inputs of a batch.
struct Plan<'a, F, const N: usize> {
    texture: &'a TimeTexture,
    timeline: &'a Timeline,
    /// The points, the first of the batch, and the times.
    batch: (&'a CapturePoints, usize, &'a [f64]),
    lookups: &'a mut CaptureLookups,
    filter: std::marker::PhantomData<F>,
}

impl<'a, F, const N: usize> Plan<'a, F, N> {
    fn new(
        texture: &'a TimeTexture,
        batch: (&'a CapturePoints, usize, &'a [f64]),
        lookups: &'a mut CaptureLookups,
    ) -> Self {
        Plan {
            texture,
            timeline: texture.timeline(),
            batch,
            lookups,
            filter: std::marker::PhantomData,
        }
    }
}

impl<F: Filter<N>, const N: usize> VectorLoop for Plan<'_, F, N> {
    #[inline(always)]
    fn run(self) {
        let store = self.texture.cube();
        let (points, begin, times) = self.batch;
        let weights = points.weights.each_ref().map(|all| part(all, begin));
        let CaptureLookups {
            count,
            origins,
            bins,
            plain,
            radiance,
            held,
            from_disk,
        } = self.lookups;
        let (count, factor) = (*count, self.texture.factor());
        let mut tap = 0;
        while tap < 4 {
            let tapped = TapTimes {
                texels: part(&points.texels[tap], begin),
                delays: part(&points.delays[tap], begin),
                times: part(times, begin),
            };
            let (origins, bins) = (&mut origins[tap], &mut bins[tap]);
            place::<F, N>(store.shape(), self.timeline, tapped, origins, bins, plain);
            tap += 1;
        }
        for at in 0..BATCH {
            held[at] = 0.0 + weights[0][at] + weights[1][at] + weights[2][at] + weights[3][at];
        }
        let source = from_disk.source::<N>(store, (origins, plain), count);
        // Only plain lookups are read.
        let (mut which, mut open) = ([0; BATCH], 0);
        for (at, is_plain) in plain.iter().enumerate().take(count) {
            which[open % BATCH] = at as u8;
            open += usize::from(*is_plain);
        }
        let reads = TapReads {
            weights,
            origins,
            bins,
            plain: which,
        };
        read::<_, N>((&source, store.shape()[3]), &reads, open, factor, radiance);
    }
}

/// One of the four taps of a batch: texel indices, the times at which the light of the points left, and each texel's recording delay.
#[derive(Clone, Copy)]
struct TapTimes<'a> {
    texels: &'a [f64; BATCH],
    delays: &'a [f64; BATCH],
    times: &'a [f64; BATCH],
}

/// Lookups of a batch that are skipped together.
const PART: usize = 64;

/// The reads of that tap of the lookups, and their bin weights, if any is plain.
#[inline(always)]
fn place<F: Filter<N>, const N: usize>(
    [_, _, bins, channels]: [usize; 4],
    timeline: &Timeline,
    tap: TapTimes,
    origins: &mut [u64; BATCH],
    weights: &mut [[f64; BATCH]; MOST_BINS],
    plain: &mut [bool; BATCH],
) {
    let (bins, channels) = (bins as f64, channels as f64);
    let (start, end, per_metre) = (timeline.start, timeline.end, timeline.bins_per_metre);
    let last = bins - 1.0;
    let mut begin = 0;
    while begin < BATCH {
        // If no lookup of a group is plain, nothing is read.
        let mut any = false;
        for is_plain in &plain[begin..begin + PART] {
            any |= *is_plain;
        }
        if any {
            for i in begin..begin + PART {
                let t = tap.times[i] + tap.delays[i];
                let there = (t >= start) & (t <= end);
                // Limited so that far-away bins fit into an integer; such lookups are not plain.
                let b = ((t - start) * per_metre).max(-3.0).min(last + 4.0);
                let (first, of_bins) = F::weights(b, last);
                let within = (first >= 0.0) & (first + N as f64 <= bins);
                plain[i] &= there & within;
                // Index of the first sample: (texel · T + bin) · C.
                origins[i] = integer((tap.texels[i] * bins + first) * channels);
                let mut k = 0;
                while k < N {
                    weights[k][i] = of_bins[k];
                    k += 1;
                }
            }
        }
        begin += PART;
    }
}

/// The numbers of a whole batch starting at `begin`.
#[inline(always)]
fn part(from: &[f64], begin: usize) -> &[f64; BATCH] {
    const NONE: &[f64; BATCH] = &[0.0; BATCH];
    let from = from.get(begin..).unwrap_or_default();
    from.first_chunk().unwrap_or(NONE)
}
