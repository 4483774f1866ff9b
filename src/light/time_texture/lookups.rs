//! Many lookups at a time, by texture coordinates: [`TimeTexture::sample_uv`] in loops.
//!
//! Three passes: where each lookup reads and with which weights, eight lookups per vector; the cache lines
//! of those samples are asked for, some lookups ahead of their use; the samples of a group of lookups are
//! brought together, widened and summed. Each operation is that of a single lookup, in its order, so that
//! results are the same bit for bit. Lookups near the ends of the data or beyond them are single ones.

use glam::DVec2;

use super::axis::{Reading, Timeline};
use super::gather::read;
use super::places::{BATCH, Cubic, CubicMeans, Filter, Linear, MOST_BINS, Nearest, Places, place};
use super::texture::{Sampled, TimeTexture};
use super::weights::bins_of;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::io::cube::{Bricks, CubeStore, Held, Runs, Samples, Stored};
use crate::scene::model::TimeFilter;

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
    from_disk: FromDisk,
}

/// What lookups from bricks need.
#[derive(Debug)]
pub(super) struct FromDisk {
    held: Held,
    wanted: Vec<u64>,
    /// The samples of all taps, brought together.
    values: Samples,
}

impl Default for FromDisk {
    fn default() -> Self {
        FromDisk {
            held: Held::default(),
            wanted: Vec::new(),
            values: Samples::F64(Vec::new()),
        }
    }
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
            from_disk: FromDisk::default(),
        }
    }
}

impl Lookups {
    /// Bytes of samples that the `count` lookups have read from `texture`.
    pub fn bytes_read(&self, texture: &TimeTexture, count: usize) -> u64 {
        bytes_of(
            texture,
            self.places.plain[..count].iter().filter(|p| **p).count(),
        )
    }
}

/// Bytes of samples that so many lookups read from `texture`.
pub(super) fn bytes_of(texture: &TimeTexture, lookups: usize) -> u64 {
    let cube = texture.cube();
    (lookups * 4 * bins_of(texture.axis().filter) * cube.shape()[3] * cube.sample_bytes()) as u64
}

impl TimeTexture {
    /// Carries out the first `count` of `lookups`, no more than [`BATCH`].
    pub fn sample_each(&self, lookups: &mut Lookups, count: usize) {
        let count = count.min(BATCH);
        let timeline = self.timeline();
        // One loop for each filter, whose number of bins is then known to the compiler.
        match &timeline.reading {
            Reading::Uniform(TimeFilter::Nearest) => {
                dispatch(Plan::<Nearest, 1>::new(self, lookups, count))
            }
            Reading::Uniform(TimeFilter::Linear) => {
                dispatch(Plan::<Linear, 2>::new(self, lookups, count))
            }
            Reading::Uniform(TimeFilter::Cubic) => {
                dispatch(Plan::<Cubic, 4>::new(self, lookups, count))
            }
            Reading::Uniform(TimeFilter::CubicMeans) => {
                dispatch(Plan::<CubicMeans, 6>::new(self, lookups, count))
            }
            Reading::Irregular(_) => lookups.places.plain[..count].fill(false),
        }
        lookups.others.clear();
        // Lookups near the ends of the data, or in bins of several widths, one by one.
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

/// All that a batch needs.
struct Plan<'a, F, const N: usize> {
    texture: &'a TimeTexture,
    timeline: &'a Timeline,
    lookups: &'a mut Lookups,
    count: usize,
    filter: std::marker::PhantomData<F>,
}

impl<'a, F, const N: usize> Plan<'a, F, N> {
    fn new(texture: &'a TimeTexture, lookups: &'a mut Lookups, count: usize) -> Self {
        Plan {
            texture,
            timeline: texture.timeline(),
            lookups,
            count,
            filter: std::marker::PhantomData,
        }
    }
}

impl<F: Filter<N>, const N: usize> VectorLoop for Plan<'_, F, N> {
    #[inline(always)]
    fn run(self) {
        let Lookups {
            u,
            v,
            t,
            radiance,
            places,
            from_disk,
            ..
        } = self.lookups;
        place::<F, N>(
            self.texture.cube().shape(),
            self.timeline,
            u,
            v,
            t,
            self.count,
            places,
        );
        // The types of samples and the numbers of channels are told apart once for a batch.
        let factor = self.texture.factor();
        let store = self.texture.cube();
        let samples = match store {
            CubeStore::Memory(cube) => &cube.samples,
            CubeStore::Disk(bricks) => {
                let Places { origins, plain, .. } = &mut *places;
                from_disk.bring_together::<N>(bricks, (origins, plain), self.count)
            }
        };
        match (samples, store.shape()[3]) {
            (Samples::F16(s), 3) => read::<_, _, 3, N>(s, places, self.count, factor, radiance),
            (Samples::F16(s), _) => read::<_, _, 1, N>(s, places, self.count, factor, radiance),
            (Samples::F32(s), 3) => read::<_, _, 3, N>(s, places, self.count, factor, radiance),
            (Samples::F32(s), _) => read::<_, _, 1, N>(s, places, self.count, factor, radiance),
            (Samples::F64(s), 3) => read::<_, _, 3, N>(s, places, self.count, factor, radiance),
            (Samples::F64(s), _) => read::<_, _, 1, N>(s, places, self.count, factor, radiance),
        }
    }
}

impl FromDisk {
    /// Reads the bricks of those of the first `count` lookups that are plain, each once; brings their samples together, as they are
    /// stored, and has the origins of their taps tell where they are now.
    pub fn bring_together<const N: usize>(
        &mut self,
        bricks: &Bricks,
        (origins, plain): (&mut [[u64; BATCH]; 4], &[bool; BATCH]),
        count: usize,
    ) -> &Samples {
        bricks.set_type(&mut self.values);
        let (held, wanted) = (&mut self.held, &mut self.wanted);
        let taps = (&*origins, plain, count);
        match (&mut self.values, bricks.shape()[3]) {
            (Samples::F64(values), _) if bricks.is_mended() => {
                collect_mended::<N>(bricks, taps, (held, wanted), values);
            }
            (Samples::F16(to), 3) => collect::<_, 3, N>(bricks, taps, (held, wanted), to),
            (Samples::F16(to), _) => collect::<_, 1, N>(bricks, taps, (held, wanted), to),
            (Samples::F32(to), 3) => collect::<_, 3, N>(bricks, taps, (held, wanted), to),
            (Samples::F32(to), _) => collect::<_, 1, N>(bricks, taps, (held, wanted), to),
            (Samples::F64(to), 3) => collect::<_, 3, N>(bricks, taps, (held, wanted), to),
            (Samples::F64(to), _) => collect::<_, 1, N>(bricks, taps, (held, wanted), to),
        }
        // Origins now count in the copies.
        let each = N * bricks.shape()[3];
        for (tap, origins) in origins.iter_mut().enumerate() {
            for (at, origin) in origins[..count].iter_mut().enumerate() {
                *origin = ((at * 4 + tap) * each) as u64;
            }
        }
        &self.values
    }
}

/// The origins of taps, which lookups are plain, and how many there are.
type Taps<'a> = (&'a [[u64; BATCH]; 4], &'a [bool; BATCH], usize);

/// How many lookups ahead of their use samples in bricks are asked for.
const AHEAD: usize = 16;

/// Copies the samples of plain lookups from bricks: four taps of N bins each.
#[inline(never)]
fn collect<T: Stored, const C: usize, const N: usize>(
    bricks: &Bricks,
    (origins, plain, count): Taps,
    (held, wanted): (&mut Held, &mut Vec<u64>),
    values: &mut Vec<T>,
) {
    // All bricks of the batch are named first, so that each is read once.
    let mut runs = Runs::<T>::new(bricks, held);
    for at in (0..count).filter(|at| plain[*at]) {
        for (tap, origins) in origins.iter().enumerate() {
            runs.want(tap / 2, origins[at], N * C, wanted);
        }
    }
    if !wanted.is_empty() {
        bricks.bring(held, wanted);
    }
    values.resize(count * 4 * N * C, T::NONE);
    // What is read some lookups later is asked for.
    let mut later = Runs::<T>::new(bricks, held);
    let mut runs = Runs::<T>::new(bricks, held);
    let mut ask = |at: usize| {
        if at < count && plain[at] {
            for (tap, origins) in origins.iter().enumerate() {
                later.ask(tap / 2, origins[at], N * C);
            }
        }
    };
    (0..AHEAD).for_each(&mut ask);
    for (at, values) in values.chunks_exact_mut(4 * N * C).enumerate() {
        ask(at + AHEAD);
        if !plain[at] {
            continue;
        }
        for (tap, values) in values.chunks_exact_mut(N * C).enumerate() {
            runs.read(tap / 2, origins[tap][at], values);
        }
    }
}

/// The same where some bins are mended.
#[cold]
fn collect_mended<const N: usize>(
    bricks: &Bricks,
    (origins, plain, count): Taps,
    (held, wanted): (&mut Held, &mut Vec<u64>),
    values: &mut Vec<f64>,
) {
    let each = N * bricks.shape()[3];
    let plain = || (0..count).filter(|at| plain[*at]);
    for at in plain() {
        for tap in origins {
            bricks.want_from(held, tap[at], each, wanted);
        }
    }
    bricks.bring(held, wanted);
    values.resize(count * 4 * each, 0.0);
    for at in plain() {
        for (tap, origins) in origins.iter().enumerate() {
            let values = &mut values[(at * 4 + tap) * each..][..each];
            bricks.samples_from(held, origins[at], values);
        }
    }
}

fn rgb_and_nothing([r, g, b]: [f64; 3]) -> [f64; 4] {
    [r, g, b, 0.0]
}
