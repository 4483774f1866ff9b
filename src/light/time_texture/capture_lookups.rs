//! Many lookups at a time by a capture camera: [`TimeTexture::locate`] in loops as far as it is arithmetic, and
//! [`TimeTexture::sample_located`] of points all of whose taps hold data.
//!
//! As for lookups by texture coordinates, but each tap is read at its own time, with its own weights of bins. Each
//! operation is that of a single lookup, in its order, so that results are the same bit for bit.

use super::axis::{Reading, Timeline};
use super::capture::{Aim, Capture, SurfacePoint};
use super::gather::{Reads, read};
use super::lookups::{FromDisk, bytes_of};
use super::places::{BATCH, Cubic, CubicMeans, Filter, Linear, MOST_BINS, Nearest, integer};
use super::texture::{Located, TimeTexture};
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, Vectors, dispatch};
use crate::camera::{AnyProjection, Projection};
use crate::io::cube::{CubeStore, Samples};
use crate::scene::model::TimeFilter;

/// A batch of lookups: the taps and times that are asked and, after [`TimeTexture::sample_taps`], the answers.
#[derive(Debug)]
pub struct CaptureLookups {
    /// How many there are, and the point of each.
    count: usize,
    points: [u32; BATCH],
    /// Texels as numbers, their weights, and the times at which they are read, metres of ct.
    texels: [[f64; BATCH]; 4],
    weights: [[f64; BATCH]; 4],
    times: [[f64; BATCH]; 4],
    /// The first sample of each tap, and the weights of its bins.
    origins: [[u64; BATCH]; 4],
    bins: [[[f64; BATCH]; MOST_BINS]; 4],
    /// Whether the data hold all of it.
    plain: [bool; BATCH],
    radiance: [[f64; 4]; BATCH],
    from_disk: FromDisk,
}

impl Default for CaptureLookups {
    fn default() -> Self {
        CaptureLookups {
            count: 0,
            points: [0; BATCH],
            texels: [[0.0; BATCH]; 4],
            weights: [[0.0; BATCH]; 4],
            times: [[0.0; BATCH]; 4],
            origins: [[0; BATCH]; 4],
            bins: [[[0.0; BATCH]; MOST_BINS]; 4],
            plain: [false; BATCH],
            radiance: [[0.0; 4]; BATCH],
            from_disk: FromDisk::default(),
        }
    }
}

impl CaptureLookups {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Whether there is no room for more.
    pub fn is_full(&self) -> bool {
        self.count == BATCH
    }

    /// Adds the lookup of a point that `capture` saw at `located`, whose light left at `t`; there has to be room. False where it
    /// is none for batches.
    #[inline]
    pub fn push(&mut self, point: usize, capture: &Capture, located: &Located, t: f64) -> bool {
        let Some(taps) = located.taps() else {
            return false;
        };
        let times = taps.map(|tap| match capture.is_warped() {
            true => t + capture.delay_of(tap.texel),
            false => t,
        });
        let at = self.count;
        self.points[at] = point as u32;
        for (k, tap) in taps.iter().enumerate() {
            self.texels[k][at] = tap.texel as f64;
            self.weights[k][at] = tap.weight;
            self.times[k][at] = times[k];
        }
        self.count += 1;
        true
    }

    /// Bytes of samples that were read from `texture`.
    pub fn bytes_read(&self, texture: &TimeTexture) -> u64 {
        bytes_of(
            texture,
            self.plain[..self.count].iter().filter(|p| **p).count(),
        )
    }

    /// The points whose taps all hold data, with their radiance and the sum of the taps' weights.
    pub fn answers(&self) -> impl Iterator<Item = (usize, [f64; 3], f64)> + '_ {
        let plain = (0..self.count).filter(|at| self.plain[*at]);
        plain.map(|at| {
            let [r, g, b, _] = self.radiance[at];
            let held = self.weights.iter().fold(0.0, |sum, of| sum + of[at]);
            (self.points[at] as usize, [r, g, b], held)
        })
    }
}

impl Reads for CaptureLookups {
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
    /// Carries out `lookups`.
    pub fn sample_taps(&self, lookups: &mut CaptureLookups) {
        let timeline = self.timeline();
        match &timeline.reading {
            Reading::Uniform(TimeFilter::Nearest) => {
                dispatch(Plan::<Nearest, 1>::new(self, lookups))
            }
            Reading::Uniform(TimeFilter::Linear) => dispatch(Plan::<Linear, 2>::new(self, lookups)),
            Reading::Uniform(TimeFilter::Cubic) => dispatch(Plan::<Cubic, 4>::new(self, lookups)),
            Reading::Uniform(TimeFilter::CubicMeans) => {
                dispatch(Plan::<CubicMeans, 6>::new(self, lookups));
            }
            Reading::Irregular(_) => lookups.plain.fill(false),
        }
    }

    /// [`TimeTexture::locate`] of points at `positions` with `normals`, in their order.
    pub(crate) fn locate_each(
        &self,
        capture: &Capture,
        positions: &Columns,
        normals: &Columns,
        mut each: impl FnMut(usize, Located),
    ) {
        let mut begin = 0;
        while begin < positions.len() {
            let mut seen = Projected::EMPTY;
            let (positions_of, normals_of) = (positions.load(begin), normals.load(begin));
            // The usual projection has a loop compiled for it; the others share one.
            match capture.projection() {
                AnyProjection::Perspective(film) => dispatch(Project {
                    capture,
                    film,
                    positions: &positions_of,
                    normals: &normals_of,
                    to: &mut seen,
                }),
                _ => dispatch(Project {
                    capture,
                    film: capture.projection(),
                    positions: &positions_of,
                    normals: &normals_of,
                    to: &mut seen,
                }),
            }
            for k in 0..(positions.len() - begin).min(BLOCK) {
                let place = seen.is_before[k].then_some([seen.place[0][k], seen.place[1][k]]);
                let aim = seen.faces[k].then(|| Aim {
                    position: seen.p.get(k),
                    normal: seen.n.get(k),
                    footprint: seen.footprint[k],
                });
                each(begin + k, self.located(capture, place, aim));
            }
            begin += BLOCK;
        }
    }
}

/// How the capture camera sees a block of points.
struct Projected {
    /// Film points, and whether they are before the pinhole.
    place: [[f64; BLOCK]; 2],
    is_before: [bool; BLOCK],
    /// Positions and normals by the camera's axes, and whether the points face it.
    p: Vectors,
    n: Vectors,
    faces: [bool; BLOCK],
    /// Width of a pixel there.
    footprint: [f64; BLOCK],
}

impl Projected {
    const EMPTY: Projected = Projected {
        place: [[0.0; BLOCK]; 2],
        is_before: [false; BLOCK],
        p: Vectors::ZERO,
        n: Vectors::ZERO,
        faces: [false; BLOCK],
        footprint: [0.0; BLOCK],
    };
}

/// The loop over points.
struct Project<'a, P> {
    capture: &'a Capture,
    film: &'a P,
    positions: &'a Vectors,
    normals: &'a Vectors,
    to: &'a mut Projected,
}

impl<P: Projection> VectorLoop for Project<'_, P> {
    #[inline(always)]
    fn run(self) {
        let (positions, normals) = (*self.positions, *self.normals);
        let mut to = Projected::EMPTY;
        for k in 0..BLOCK {
            let point = SurfacePoint {
                position: positions.get(k),
                normal: normals.get(k),
            };
            let (place, aim) = self.capture.look_at(self.film, &point);
            let (is_before, [x, y]) = match place {
                Some(place) => (true, place),
                None => (false, [0.0; 2]),
            };
            to.is_before[k] = is_before;
            to.place[0][k] = x;
            to.place[1][k] = y;
            to.p.set(k, aim.position);
            to.n.set(k, aim.normal);
            to.footprint[k] = aim.footprint;
            to.faces[k] = is_before & aim.faces();
        }
        *self.to = to;
    }
}

/// All that a batch needs.
struct Plan<'a, F, const N: usize> {
    texture: &'a TimeTexture,
    timeline: &'a Timeline,
    lookups: &'a mut CaptureLookups,
    filter: std::marker::PhantomData<F>,
}

impl<'a, F, const N: usize> Plan<'a, F, N> {
    fn new(texture: &'a TimeTexture, lookups: &'a mut CaptureLookups) -> Self {
        Plan {
            texture,
            timeline: texture.timeline(),
            lookups,
            filter: std::marker::PhantomData,
        }
    }
}

impl<F: Filter<N>, const N: usize> VectorLoop for Plan<'_, F, N> {
    #[inline(always)]
    fn run(self) {
        let store = self.texture.cube();
        place::<F, N>(store.shape(), self.timeline, self.lookups);
        let (count, factor) = (self.lookups.count, self.texture.factor());
        // Where the samples go, apart from what they are read by.
        let mut radiance = [[0.0; 4]; BATCH];
        let to = &mut radiance;
        let cube = match store {
            CubeStore::Memory(cube) => cube,
            CubeStore::Disk(bricks) => {
                let CaptureLookups {
                    from_disk,
                    origins,
                    plain,
                    ..
                } = &mut *self.lookups;
                from_disk.bring_together::<N>(bricks, (origins, plain), count);
                let lookups = &*self.lookups;
                let values = &lookups.from_disk.values[..];
                match bricks.shape()[3] {
                    3 => read::<_, _, 3, N>(values, lookups, count, factor, to),
                    _ => read::<_, _, 1, N>(values, lookups, count, factor, to),
                }
                self.lookups.radiance = radiance;
                return;
            }
        };
        let lookups = &*self.lookups;
        match (&cube.samples, cube.shape[3]) {
            (Samples::F16(s), 3) => read::<_, _, 3, N>(s, lookups, count, factor, to),
            (Samples::F16(s), _) => read::<_, _, 1, N>(s, lookups, count, factor, to),
            (Samples::F32(s), 3) => read::<_, _, 3, N>(s, lookups, count, factor, to),
            (Samples::F32(s), _) => read::<_, _, 1, N>(s, lookups, count, factor, to),
            (Samples::F64(s), 3) => read::<_, _, 3, N>(s, lookups, count, factor, to),
            (Samples::F64(s), _) => read::<_, _, 1, N>(s, lookups, count, factor, to),
        }
        self.lookups.radiance = radiance;
    }
}

/// Where the taps of lookups read, and with which weights of bins.
#[inline(always)]
fn place<F: Filter<N>, const N: usize>(
    [_, _, bins, channels]: [usize; 4],
    timeline: &Timeline,
    lookups: &mut CaptureLookups,
) {
    let (bins, channels) = (bins as f64, channels as f64);
    let (start, end, per_metre) = (timeline.start, timeline.end, timeline.bins_per_metre);
    let last = bins - 1.0;
    let mut plain = [true; BATCH];
    let mut tap = 0;
    while tap < 4 {
        let (texels, times) = (lookups.texels[tap], lookups.times[tap]);
        let mut origins = [0; BATCH];
        let mut weights = [[0.0; BATCH]; MOST_BINS];
        for i in 0..BATCH {
            let t = times[i];
            let there = (t >= start) & (t <= end);
            // Limited so that bins far away fit an integer; such lookups are not plain.
            let b = ((t - start) * per_metre).max(-3.0).min(last + 4.0);
            let (first, of_bins) = F::weights(b, last);
            let within = (first >= 0.0) & (first + N as f64 <= bins);
            plain[i] &= there & within;
            // Index of the first sample: (texel · T + bin) · C.
            origins[i] = integer((texels[i] * bins + first) * channels);
            let mut k = 0;
            while k < N {
                weights[k][i] = of_bins[k];
                k += 1;
            }
        }
        lookups.origins[tap] = origins;
        lookups.bins[tap] = weights;
        tap += 1;
    }
    lookups.plain = plain;
}
