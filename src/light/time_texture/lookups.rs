//! Batched lookups by texture coordinates: [`TimeTexture::sample_uv`] in loops.
//!
//! Three passes: the positions and weights of each lookup, eight lookups per vector; prefetches of the cache lines of those samples, some
//! lookups ahead of their use; and gathering, widening and summing the samples of a group of lookups. Each operation is that of a single
//! lookup, in its order, so that results are the same bit for bit. Lookups near the ends of the data or beyond them are done singly.

use glam::DVec2;

use super::axis::{Reading, Timeline};
use super::from_disk::FromDisk;
use super::gather::read;
use super::places::{BATCH, Cubic, CubicMeans, Filter, Linear, MOST_BINS, Nearest, Places, place};
use super::texture::{Sampled, TimeTexture};
use super::weights::bins_of;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::scene::model::TimeFilter;

/// A batch of lookups: the requests and, after [`TimeTexture::sample_each`], the answers.
#[derive(Debug)]
pub struct Lookups {
    /// Texture coordinates; NaN is off the texture.
    pub u: [f64; BATCH],
    /// v = 0 is the top edge.
    pub v: [f64; BATCH],
    /// Times, metres of ct.
    pub t: [f64; BATCH],
    /// Radiance if the lookup is entirely within the data, with a meaningless fourth lane.
    pub radiance: [[f64; 4]; BATCH],
    /// Lookups that are not plain.
    pub others: Vec<(usize, Sampled)>,
    places: Places,
    from_disk: FromDisk,
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

/// Bytes of samples that `count` lookups read from `texture`.
pub(super) fn bytes_of(texture: &TimeTexture, lookups: usize) -> u64 {
    let cube = texture.cube();
    (lookups * 4 * bins_of(texture.axis().filter) * cube.shape()[3] * cube.sample_bytes()) as u64
}

impl TimeTexture {
    /// Performs the first `count` of `lookups`, at most [`BATCH`].
    pub fn sample_each(&self, lookups: &mut Lookups, count: usize) {
        let count = count.min(BATCH);
        let timeline = self.timeline();
        // One loop per filter, so that the compiler knows its number of bins.
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
        // Lookups near the ends of the data, or in bins of different widths, are done one by one.
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

/// The inputs of a batch.
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
        let store = self.texture.cube();
        let Places { origins, plain, .. } = &mut *places;
        let source = from_disk.source::<N>(store, (origins, plain), self.count);
        let read_of = (&source, store.shape()[3]);
        read::<_, N>(
            read_of,
            &*places,
            self.count,
            self.texture.factor(),
            radiance,
        );
    }
}

fn rgb_and_nothing([r, g, b]: [f64; 3]) -> [f64; 4] {
    [r, g, b, 0.0]
}
