//! What the rays of a batch have met so far.

use glam::DVec3;

use super::surfaces::{Found, Rays, index_along};
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::accel::{Bvh, Hit, Origins, Tally};
use crate::camera::Departure;
use crate::spacetime::{Boost, Displacement, Event, NullRay, Rest, Tangents, World};

/// Buffers of one tile, reused from batch to batch.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Per ray: what it met.
    hits: Vec<Option<Hit>>,
    /// In which rest frame; empty where there is one.
    frames: Vec<u32>,
    /// Index of the medium along each ray.
    indices: Vec<f64>,
    /// Tangents in the frame that was met last, and ω_rest/ω_world.
    local: Vec<DVec3>,
    times: Vec<f64>,
    ratios: Vec<f64>,
    /// Where each ray leaves, in the frame that was met last; empty where all leave together.
    origins: Vec<DVec3>,
    origin_times: Vec<f64>,
}

impl Scratch {
    /// Makes room for `rays` rays that meet `frames` rest frames.
    pub(super) fn start(&mut self, rays: usize, frames: usize) {
        self.hits.clear();
        self.hits.resize(rays, None);
        self.frames.clear();
        if frames > 1 {
            self.frames.resize(rays, 0);
        }
    }

    /// Holds what rays of several rest frames have met elsewhere than in [`Surfaces::nearest`](super::Surfaces).
    pub(crate) fn hold(&mut self, found: &[Option<Found>]) {
        self.hits.clear();
        self.hits.extend(found.iter().map(|f| f.map(|f| f.hit)));
        self.frames.clear();
        self.frames
            .extend(found.iter().map(|f| f.map_or(0, |f| f.frame)));
    }

    /// Carries `rays` into a frame.
    pub(super) fn carry<D: Departure>(
        &mut self,
        boost: &Boost<Rest, World>,
        index: f64,
        rays: Rays<D>,
    ) {
        let count = rays.directions.len();
        self.indices.clear();
        let indices = rays.from.iter().map(|from| index_along(index, *from));
        self.indices.extend(indices);
        self.local.resize(count, DVec3::ZERO);
        self.times.resize(count, 0.0);
        self.ratios.resize(count, 0.0);
        dispatch(Carry {
            boost,
            indices: &self.indices,
            directions: rays.directions,
            tangents: Tangents {
                space: &mut self.local,
                time: &mut self.times,
                ratio: &mut self.ratios,
            },
        });
    }

    /// Takes over where rays leave, which is about `origin`.
    pub(super) fn leave<D: Departure>(
        &mut self,
        boost: &Boost<Rest, World>,
        origin: Event<Rest>,
        from: &[D],
    ) {
        if D::TOGETHER {
            return;
        }
        self.origins.resize(from.len(), DVec3::ZERO);
        self.origin_times.resize(from.len(), 0.0);
        dispatch(Leave {
            boost,
            origin,
            from,
            places: &mut self.origins,
            times: &mut self.origin_times,
        });
    }

    /// Takes over what `rays` meet in `frame`, where it is nearer: along `directions`, or as they were carried.
    pub(super) fn meet<D>(
        &mut self,
        frame: u32,
        bvh: &Bvh,
        rays: &Rays<D>,
        origin: DVec3,
        directions: Option<&[DVec3]>,
        tally: &mut impl Tally,
    ) {
        let (hits, frames) = (&mut self.hits, &mut self.frames);
        let replaced = |ray: usize| {
            if let Some(known) = frames.get_mut(ray) {
                *known = frame;
            }
        };
        let origins = match self.origins.as_slice() {
            [] => Origins::Shared(origin),
            origins => Origins::Each(origins),
        };
        let directions = directions.unwrap_or(&self.local);
        bvh.closest_by(rays.method, origins, directions, hits, tally, replaced);
    }

    /// Ray `ray` as it was carried into the frame that was met last, and ω_rest/ω_world of its light.
    #[inline(always)]
    pub(super) fn carried(&self, ray: usize, origin: Event<Rest>) -> (NullRay<Rest>, f64) {
        let ray_in_frame = NullRay {
            origin: self.left(ray, origin),
            tangent: Displacement::new(self.times[ray], self.local[ray]),
        };
        (ray_in_frame, self.ratios[ray])
    }

    /// Where ray `ray` leaves in the frame that was met last, if not at `origin`.
    #[inline(always)]
    pub(super) fn left(&self, ray: usize, origin: Event<Rest>) -> Event<Rest> {
        match self.origins.get(ray) {
            Some(place) => Event::new(self.origin_times[ray], *place),
            None => origin,
        }
    }

    /// What each ray of the batch met.
    #[inline]
    pub fn hits(&self) -> &[Option<Hit>] {
        &self.hits
    }

    /// What ray `ray` of the batch met.
    #[inline]
    pub fn found(&self, ray: usize) -> Option<Found> {
        self.hits[ray].map(|hit| Found {
            hit,
            frame: self.frame(ray),
        })
    }

    /// The rest frame in which ray `ray` met something.
    #[inline(always)]
    pub(super) fn frame(&self, ray: usize) -> u32 {
        self.frames.get(ray).copied().unwrap_or(0)
    }
}

/// The loop over directions.
struct Carry<'a> {
    boost: &'a Boost<Rest, World>,
    indices: &'a [f64],
    directions: &'a [DVec3],
    tangents: Tangents<'a>,
}

impl VectorLoop for Carry<'_> {
    #[inline(always)]
    fn run(self) {
        self.boost
            .tangents(self.indices, self.directions, self.tangents);
    }
}

/// The loop over departures.
struct Leave<'a, D> {
    boost: &'a Boost<Rest, World>,
    origin: Event<Rest>,
    from: &'a [D],
    places: &'a mut [DVec3],
    times: &'a mut [f64],
}

impl<D: Departure> VectorLoop for Leave<'_, D> {
    #[inline(always)]
    fn run(self) {
        leave(self.boost, self.origin, self.from, self.places, self.times);
    }
}

#[inline(always)]
fn leave<D: Departure>(
    boost: &Boost<Rest, World>,
    origin: Event<Rest>,
    from: &[D],
    places: &mut [DVec3],
    times: &mut [f64],
) {
    let count = from.len();
    let (places, times) = (&mut places[..count], &mut times[..count]);
    for k in 0..count {
        let event = origin + boost.displacement(from[k].into().displacement);
        places[k] = event.x;
        times[k] = event.ct;
    }
}
