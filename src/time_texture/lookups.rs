//! Many lookups at a time, by texture coordinates: [`TimeTexture::sample_uv`] in loops.
//!
//! Three passes: where each lookup reads and with which weights, eight lookups per vector; the cache lines
//! of those samples are asked for, some lookups ahead of their use; the samples of a group of lookups are
//! brought together, widened and summed. Each operation is that of a single lookup, in its order, so that
//! results are the same bit for bit. Lookups near the ends of the data or beyond them are single ones.

use glam::DVec2;

use super::axis::{Timeline, catmull_rom, less_curvature};
use super::cube::Samples;
use super::reader::Sample;
use super::{Sampled, TimeTexture};
use crate::scene::model::TimeFilter;
use crate::vectors::{Loop, prefetch, widest};

/// Lookups in one batch, at most.
pub const BATCH: usize = 256;
/// Bins that a filter reads, at most.
const MOST_BINS: usize = 6;
/// Lookups whose samples are brought together.
const GROUP: usize = 16;
/// Samples of a group, and one that may be read without effect.
const ROOM: usize = GROUP * 4 * MOST_BINS * 3 + 1;

/// A batch of lookups: what is asked and, after [`TimeTexture::sample_each`], the answers.
#[derive(Debug)]
pub struct Lookups {
    /// Texture coordinates; NaN is off the texture.
    pub u: [f64; BATCH],
    /// v = 0 is the top edge.
    pub v: [f64; BATCH],
    /// Times, metres of ct.
    pub t: [f64; BATCH],
    /// Radiance where the data hold all of it, and a fourth lane that means nothing.
    pub radiance: [[f64; 4]; BATCH],
    /// Lookups that are not so plain.
    pub others: Vec<(usize, Sampled)>,
    places: Places,
}

/// What lookups read.
#[derive(Debug)]
struct Places {
    /// The first sample of each tap.
    origins: [[u64; BATCH]; 4],
    /// Weights of the taps.
    taps: [[f64; BATCH]; 4],
    /// Weights of the bins.
    bins: [[f64; BATCH]; MOST_BINS],
    /// Whether all of it is there.
    plain: [bool; BATCH],
}

impl Default for Lookups {
    fn default() -> Self {
        Lookups {
            u: [0.0; BATCH],
            v: [0.0; BATCH],
            t: [0.0; BATCH],
            radiance: [[0.0; 4]; BATCH],
            others: Vec::new(),
            places: Places {
                origins: [[0; BATCH]; 4],
                taps: [[0.0; BATCH]; 4],
                bins: [[0.0; BATCH]; MOST_BINS],
                plain: [false; BATCH],
            },
        }
    }
}

impl Lookups {
    /// Bytes of samples that the `count` lookups have read from `texture`.
    pub fn bytes_read(&self, texture: &TimeTexture, count: usize) -> u64 {
        let plain = self.places.plain[..count].iter().filter(|p| **p).count();
        let cube = texture.cube();
        let sample = match &cube.samples {
            Samples::F16(_) => 2,
            Samples::F32(_) => 4,
            Samples::F64(_) => 8,
        };
        (plain * 4 * bins_of(texture.axis().filter) * cube.shape[3] * sample) as u64
    }
}

/// How many bins a filter reads.
fn bins_of(filter: TimeFilter) -> usize {
    match filter {
        TimeFilter::Nearest => 1,
        TimeFilter::Linear => 2,
        TimeFilter::Cubic => 4,
        TimeFilter::CubicMeans => 6,
    }
}

impl TimeTexture {
    /// Carries out the first `count` of `lookups`, no more than [`BATCH`].
    pub fn sample_each(&self, lookups: &mut Lookups, count: usize) {
        let count = count.min(BATCH);
        let timeline = self.timeline();
        match timeline.filter {
            TimeFilter::Nearest => widest(Plan::<Nearest, 1>::new(self, lookups, count)),
            TimeFilter::Linear => widest(Plan::<Linear, 2>::new(self, lookups, count)),
            TimeFilter::Cubic => widest(Plan::<Cubic, 4>::new(self, lookups, count)),
            TimeFilter::CubicMeans => widest(Plan::<CubicMeans, 6>::new(self, lookups, count)),
        }
        lookups.others.clear();
        for at in 0..count {
            if !lookups.places.plain[at] {
                let uv = DVec2::new(lookups.u[at], lookups.v[at]);
                let sampled = self.sample_uv(uv, lookups.t[at]);
                lookups.radiance[at] = rgb_and_nothing(sampled.radiance);
                lookups.others.push((at, sampled));
            }
        }
    }
}

/// A filter along time: N weights from a bin on.
trait Filter<const N: usize> {
    /// The first bin and the weights, for bin coordinate `b`, and the number of bins less one.
    fn weights(b: f64, last: f64) -> (f64, [f64; N]);
}

struct Nearest;
struct Linear;
struct Cubic;
struct CubicMeans;

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

/// ⌊x⌋ for |x| < 2⁵⁰, by additions that vectors have.
#[inline(always)]
fn floor(x: f64) -> f64 {
    const INTEGERS: f64 = 1.5 * (1u64 << 52) as f64;
    let nearest = (x + INTEGERS) - INTEGERS;
    nearest - if nearest > x { 1.0 } else { 0.0 }
}

/// An integer in [0, 2⁵²) as one, by an addition.
#[inline(always)]
fn integer(x: f64) -> u64 {
    const INTEGERS: f64 = (1u64 << 52) as f64;
    (x + INTEGERS).to_bits() & ((1 << 52) - 1)
}

/// All that a batch needs.
struct Plan<'a, F, const N: usize> {
    texture: &'a TimeTexture,
    timeline: Timeline,
    lookups: &'a mut Lookups,
    count: usize,
    filter: std::marker::PhantomData<F>,
}

impl<'a, F, const N: usize> Plan<'a, F, N> {
    fn new(texture: &'a TimeTexture, lookups: &'a mut Lookups, count: usize) -> Self {
        Plan {
            texture,
            timeline: *texture.timeline(),
            lookups,
            count,
            filter: std::marker::PhantomData,
        }
    }
}

impl<F: Filter<N>, const N: usize> Loop for Plan<'_, F, N> {
    #[inline(always)]
    fn run(self) {
        let Lookups {
            u,
            v,
            t,
            radiance,
            places,
            ..
        } = self.lookups;
        place::<F, N>(
            self.texture.cube().shape,
            &self.timeline,
            u,
            v,
            t,
            self.count,
            places,
        );
        let factor = self.texture.factor();
        match (&self.texture.cube().samples, self.texture.cube().shape[3]) {
            (Samples::F16(s), 3) => read::<_, 3, N>(s, places, self.count, factor, radiance),
            (Samples::F16(s), _) => read::<_, 1, N>(s, places, self.count, factor, radiance),
            (Samples::F32(s), 3) => read::<_, 3, N>(s, places, self.count, factor, radiance),
            (Samples::F32(s), _) => read::<_, 1, N>(s, places, self.count, factor, radiance),
            (Samples::F64(s), 3) => read::<_, 3, N>(s, places, self.count, factor, radiance),
            (Samples::F64(s), _) => read::<_, 1, N>(s, places, self.count, factor, radiance),
        }
    }
}

/// Where lookups read, and with which weights.
#[inline(always)]
fn place<F: Filter<N>, const N: usize>(
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
        let there = (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (v <= 1.0) & (t >= start) & (t <= end);
        let (left, right, fx) = neighbours(u * width, width - 1.0);
        let (top, bottom, fy) = neighbours(v * height, height - 1.0);
        let b = ((t - start) * per_metre).max(-3.0).min(last + 4.0);
        let (first, weights) = F::weights(b, last);
        let within = (first >= 0.0) & (first + N as f64 <= bins);
        places.plain[i] = there & within;
        let (top, bottom) = (top * width, bottom * width);
        places.origins[0][i] = integer(((top + left) * bins + first) * channels);
        places.origins[1][i] = integer(((top + right) * bins + first) * channels);
        places.origins[2][i] = integer(((bottom + left) * bins + first) * channels);
        places.origins[3][i] = integer(((bottom + right) * bins + first) * channels);
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

/// The two cells whose centres embrace `x`, and the weight of the second; `last` is that of the last cell.
#[inline(always)]
fn neighbours(x: f64, last: f64) -> (f64, f64, f64) {
    let x = (x - 0.5).max(0.0).min(last);
    let first = floor(x);
    (first, (first + 1.0).min(last), x - first)
}

/// Sums the samples of plain lookups.
#[inline(always)]
fn read<S: Sample, const C: usize, const N: usize>(
    samples: &[S],
    places: &Places,
    count: usize,
    factor: f64,
    radiance: &mut [[f64; 4]; BATCH],
) {
    let mut staged = [S::ZERO; ROOM];
    let mut wide = [S::ZERO.wide(); ROOM];
    ask_for::<S, C, N>(samples, places, 0, count);
    let mut begin = 0;
    while begin < count {
        let end = (begin + GROUP).min(count);
        ask_for::<S, C, N>(samples, places, end, count);
        let mut at = begin;
        while at < end {
            stage::<S, C, N>(samples, places, at, &mut staged[(at - begin) * 4 * N * C..]);
            at += 1;
        }
        let used = (end - begin) * 4 * N * C;
        widen(&staged[..used], &mut wide[..used]);
        let mut at = begin;
        while at < end {
            let values = &wide[(at - begin) * 4 * N * C..];
            radiance[at] = sum::<S, C, N>(values, places, at, factor);
            at += 1;
        }
        begin = end;
    }
}

/// Prefetches the samples of the group that begins at `begin`.
#[inline(always)]
fn ask_for<S, const C: usize, const N: usize>(
    samples: &[S],
    places: &Places,
    begin: usize,
    count: usize,
) {
    let mut at = begin;
    while at < (begin + GROUP).min(count) {
        let mut tap = 0;
        while tap < 4 {
            let first = places.origins[tap][at] as usize;
            prefetch(samples, first);
            prefetch(samples, first + N * C - 1);
            tap += 1;
        }
        at += 1;
    }
}

/// Copies the samples of one lookup, tap after tap.
#[inline(always)]
fn stage<S: Sample, const C: usize, const N: usize>(
    samples: &[S],
    places: &Places,
    at: usize,
    to: &mut [S],
) {
    let to = &mut to[..4 * N * C];
    let mut tap = 0;
    while tap < 4 {
        let first = places.origins[tap][at] as usize;
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
fn sum<S: Sample, const C: usize, const N: usize>(
    values: &[S::Wide],
    places: &Places,
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
            let weight = places.bins[bin][at];
            let first = (tap * N + bin) * C;
            let mut c = 0;
            while c < if C == 3 { 4 } else { 1 } {
                let value: f64 = values[first + c].into();
                texel[c] += weight * value;
                c += 1;
            }
            bin += 1;
        }
        let weight = places.taps[tap][at];
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

fn rgb_and_nothing([r, g, b]: [f64; 3]) -> [f64; 4] {
    [r, g, b, 0.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::model::{BinValues, Fill, Outside};
    use crate::time_texture::{Cube, TimeAxis};

    /// A texture of 3 × 5 texels and 9 bins.
    fn texture(samples: Samples, filter: TimeFilter) -> TimeTexture {
        let channels = samples.len() / (3 * 5 * 9);
        let cube = Cube::new([3, 5, 9, channels], samples).unwrap();
        let axis = TimeAxis {
            start: -0.3,
            bin_width: 0.21,
            values: BinValues::PerBin,
            filter,
            scale: 1.7,
        };
        let outside = Outside {
            before: Fill::Hold,
            after: Fill::Black,
            off_texture: Fill::Mark([1.0, 0.0, 1.0]),
            occluded: Fill::Black,
        };
        TimeTexture::new(cube, axis, outside).unwrap()
    }

    /// Values with many digits, of both signs.
    fn values(count: usize) -> Vec<f64> {
        let value = |i: usize| libm::sin(i as f64 * 1.234) * 3.0;
        (0..count).map(value).collect()
    }

    fn cubes() -> Vec<Samples> {
        let sizes = [3 * 5 * 9, 3 * 5 * 9 * 3];
        let half = |x: &f64| half::f16::from_f64(*x);
        let cubes = sizes.map(|n| {
            let values = values(n);
            [
                Samples::F16(values.iter().map(half).collect()),
                Samples::F32(values.iter().map(|x| *x as f32).collect()),
                Samples::F64(values),
            ]
        });
        cubes.into_iter().flatten().collect()
    }

    #[test]
    fn a_batch_of_lookups_is_as_many_single_ones_bit_for_bit() {
        let filters = [
            TimeFilter::Nearest,
            TimeFilter::Linear,
            TimeFilter::Cubic,
            TimeFilter::CubicMeans,
        ];
        for (filter, samples) in filters
            .into_iter()
            .flat_map(|f| cubes().into_iter().map(move |c| (f, c)))
        {
            let texture = texture(samples, filter);
            let mut lookups = Lookups::default();
            for i in 0..BATCH {
                let x = i as f64;
                lookups.u[i] = 0.5 + 0.53 * libm::sin(x);
                lookups.v[i] = if i == 77 {
                    f64::NAN
                } else {
                    0.5 + 0.51 * libm::cos(1.7 * x)
                };
                lookups.t[i] = 0.645 + libm::sin(2.9 * x);
            }
            texture.sample_each(&mut lookups, BATCH);
            for i in 0..BATCH {
                let uv = DVec2::new(lookups.u[i], lookups.v[i]);
                let single = texture.sample_uv(uv, lookups.t[i]);
                let other = lookups.others.iter().find(|(at, _)| *at == i);
                let bits = |rgb: [f64; 3]| rgb.map(f64::to_bits);
                let [r, g, b, _] = lookups.radiance[i];
                assert_eq!(bits([r, g, b]), bits(single.radiance), "{filter:?} {i}");
                match other {
                    Some((_, sampled)) => assert_eq!(*sampled, single),
                    None => assert_eq!(single.coverage, crate::time_texture::Coverage::HELD),
                }
            }
            let plain = BATCH - lookups.others.len();
            assert!(
                (40..200).contains(&plain),
                "{filter:?}: {plain} plain lookups"
            );
        }
    }

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
