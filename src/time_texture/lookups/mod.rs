//! Many lookups at a time, by texture coordinates: [`TimeTexture::sample_uv`] in loops.
//!
//! Three passes: where each lookup reads and with which weights, eight lookups per vector; the cache lines
//! of those samples are asked for, some lookups ahead of their use; the samples of a group of lookups are
//! brought together, widened and summed. Each operation is that of a single lookup, in its order, so that
//! results are the same bit for bit. Lookups near the ends of the data or beyond them are single ones.

mod place;
mod read;

use glam::DVec2;

use super::axis::Timeline;
use super::cube::Samples;
use super::{Sampled, TimeTexture};
use crate::scene::model::TimeFilter;
use crate::vectors::{Loop, widest};
use place::{Cubic, CubicMeans, Filter, Linear, MOST_BINS, Nearest, Places, place};
use read::read;

/// Lookups in one batch, at most.
pub const BATCH: usize = 256;

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
}
