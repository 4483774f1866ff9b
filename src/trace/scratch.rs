//! What the rays of a batch have met so far.

use glam::DVec3;

use super::surfaces::{Found, leaving};
use crate::accel::{Bvh, Hit};
use crate::camera::Departure;
use crate::spacetime::{Displacement, Event, Rest, World};

/// Buffers of one tile, reused from batch to batch.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Per ray: what it met, and in which rest frame.
    hits: Vec<Option<Hit>>,
    frames: Vec<u32>,
    pub(super) local: Vec<DVec3>,
    /// Where each ray leaves; empty where all leave together.
    origins: Vec<DVec3>,
}

impl Scratch {
    pub(super) fn start(&mut self, rays: usize) {
        self.local.clear();
        self.hits.clear();
        self.hits.resize(rays, None);
        self.frames.clear();
        self.frames.resize(rays, 0);
    }

    /// Takes over what the rays along `local` meet in `frame`, where it is nearer.
    pub(super) fn meet(&mut self, frame: u32, bvh: &Bvh, origin: DVec3) {
        let (hits, frames) = (&mut self.hits, &mut self.frames);
        let replaced = |ray: usize| frames[ray] = frame;
        match self.origins.as_slice() {
            [] => bvh.closest_each(origin, &self.local, hits, replaced),
            origins => bvh.closest_from_each(origins, &self.local, hits, replaced),
        }
    }

    /// Takes over where rays leave, which is about `origin`.
    #[inline]
    pub(super) fn leave<D: Departure>(
        &mut self,
        origin: Event<Rest>,
        from: &[D],
        displacement: impl Fn(Displacement<World>) -> Displacement<Rest>,
    ) {
        self.origins.clear();
        if !D::TOGETHER {
            let origins = from
                .iter()
                .map(|from| leaving(origin, *from, &displacement).x);
            self.origins.extend(origins);
        }
    }

    /// What ray `ray` of the batch met.
    #[inline]
    pub fn found(&self, ray: usize) -> Option<Found> {
        self.hits[ray].map(|hit| Found {
            hit,
            frame: self.frames[ray],
        })
    }
}
