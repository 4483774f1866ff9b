//! Runs: points of one patch that rays of a batch have hit.

use std::ops::Range;

use glam::DVec3;

use super::camera_rays::Rays;
use super::hits::{HitBuffer, SurfaceHit};
use super::rest_frame::{Patch, RestFrame};
use super::surface_point::{EmissionClock, ObservedPoint, SurfacePoint};
use super::surfaces::Surfaces;
use crate::accel::Hit;
use crate::accel::vectors::{BLOCK, VectorLoop, Vectors, dispatch};
use crate::spacetime::{Boost, Direction, Event, NullRay, Rest, WavelengthRatio, World};

/// Rays of a batch with their hits.
#[derive(Debug)]
pub struct TracedRays<'a> {
    /// The surfaces that they may hit.
    pub surfaces: &'a Surfaces<'a>,
    /// The rays.
    pub rays: Rays<'a>,
    /// Their nearest hits.
    pub hits: &'a HitBuffer,
    /// The event of the shot.
    pub event: Event<World>,
    /// The refractive index that delays the rays.
    pub index: f64,
}

/// Points of one patch.
#[derive(Debug)]
pub struct Run<'a> {
    /// The batch.
    pub(super) traced: &'a TracedRays<'a>,
    /// The rays that hit them.
    pub(super) members: &'a [u32],
    /// The patch.
    pub patch: &'a Patch,
    /// Its rest frame.
    pub rest: &'a RestFrame,
    /// The frame's index.
    pub frame: u32,
}

impl<'a> TracedRays<'a> {
    /// The world ray `ray`.
    #[inline(always)]
    pub(super) fn ray(&self, ray: usize) -> NullRay<World> {
        let d = Direction::from_unit(self.rays.directions[ray]);
        match self.rays.origins {
            None => NullRay::new(self.event, d, self.index),
            Some(origins) => {
                let origin = &origins[ray];
                let event = self.event + origin.displacement;
                NullRay::new(event, d, self.index * origin.delay)
            }
        }
    }

    /// The surface point where ray `ray` hit `patch`, and ω_rest/ω_world of its light.
    #[inline(always)]
    fn point(&self, ray: usize, hit: Hit, frame: u32, patch: &'a Patch) -> (SurfacePoint<'a>, f64) {
        let (local, rho) = self.surfaces.local(frame, ray, &self.rays, self.hits);
        let point = SurfacePoint {
            rest: self.surfaces.rest(frame),
            frame,
            patch,
            hit,
            ray: self.ray(ray),
            origin: self.rays.origin(ray),
            local,
        };
        (point, rho)
    }

    /// The point that ray `ray` has hit, if any; `ratio` is its W for sources at rest in the world.
    pub(crate) fn observed(&self, ray: usize, ratio: f64) -> Option<ObservedPoint<'a>> {
        let SurfaceHit { hit, frame } = self.hits.hit(ray)?;
        let patch = self.surfaces.rest(frame).patch(hit.triangle);
        let (point, rho) = self.point(ray, hit, frame, patch);
        let w = WavelengthRatio(ratio * rho);
        Some(ObservedPoint { point, w })
    }
}

impl<'a> Run<'a> {
    /// The number of points.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.members.len()
    }

    /// The hit of member `k`; all members have hit something.
    #[inline(always)]
    pub(super) fn hit(&self, k: usize) -> Option<Hit> {
        self.traced.hits.hits()[self.members[k] as usize]
    }

    /// Point `k`.
    pub(super) fn point(&self, k: usize) -> Option<SurfacePoint<'a>> {
        let ray = self.members[k] as usize;
        let hit = self.traced.hits.hits()[ray]?;
        Some(self.traced.point(ray, hit, self.frame, self.patch).0)
    }

    /// The points, in order.
    #[inline(always)]
    pub fn points(&self) -> impl Iterator<Item = SurfacePoint<'a>> + use<'a> {
        let (traced, frame, patch) = (self.traced, self.frame, self.patch);
        self.members.iter().filter_map(move |&ray| {
            let hit = traced.hits.hits()[ray as usize]?;
            Some(traced.point(ray as usize, hit, frame, patch).0)
        })
    }

    /// The emission times of members from `begin` on.
    pub(super) fn times(&self, clock: EmissionClock, begin: usize, times: &mut [f64]) {
        match clock {
            EmissionClock::World => self.world_times(begin, times),
            EmissionClock::Object => self.object_times(begin, times),
        }
    }

    /// World times of the emission events of members from `begin` on.
    #[inline(always)]
    fn world_times(&self, begin: usize, times: &mut [f64]) {
        for (k, time) in (begin..).zip(times) {
            if let Some(hit) = self.hit(k) {
                let ray = self.traced.ray(self.members[k] as usize);
                *time = ray.origin.ct + ray.tangent.ct * hit.s;
            }
        }
    }

    /// Proper times of the object at these events.
    #[inline(always)]
    fn object_times(&self, begin: usize, times: &mut [f64]) {
        let zero = self.patch.object_origin.ct;
        let members = &self.members[begin..begin + times.len()];
        self.each_local(members, |k, local, _| {
            if let Some(hit) = self.hit(begin + k) {
                times[k] = (local.origin.ct + local.tangent.ct * hit.s) - zero;
            }
        });
    }

    /// W of all members; `world` is W for sources at rest in the world, by ray.
    #[inline(always)]
    pub(super) fn ratios(&self, world: &[f64], ratios: &mut Vec<f64>) {
        ratios.clear();
        let members = || self.members.iter().map(|ray| *ray as usize);
        let TracedRays { surfaces, hits, .. } = self.traced;
        if let Some(known) = surfaces.ratios(hits) {
            return ratios.extend(members().map(|ray| world[ray] * known[ray]));
        }
        // At rest in the world there is no second factor.
        if surfaces.at_rest().is_some() {
            return match in_a_row(self.members).and_then(|rays| world.get(rays)) {
                Some(row) => ratios.extend_from_slice(row),
                None => ratios.extend(members().map(|ray| world[ray])),
            };
        }
        // The ratio of a tangent is that of its direction.
        let boost = self.rest.frame.frame_from_world();
        ratios.extend(members().map(|ray| world[ray]));
        if boost.is_identity() {
            return;
        }
        dispatch(Ratios {
            boost,
            directions: self.traced.rays.directions,
            members: self.members,
            ratios,
        });
    }

    /// Fills `spans` with the start and end of each member's part of the exposure, relative to its emission time, by `clock`. Returns
    /// whether there is such an exposure.
    ///
    /// The point that a member hits stands for the whole part: light that it emits in its proper time dτ arrives at the camera within W dτ.
    /// In the world dt = γ dτ.
    pub(super) fn spans(&self, clock: EmissionClock, spans: &mut Vec<[f64; 2]>) -> bool {
        let Some(exposure) = &self.traced.rays.samples.exposure else {
            return false;
        };
        let gamma = match clock {
            EmissionClock::World => self.rest.frame.velocity().gamma(),
            EmissionClock::Object => 1.0,
        };
        spans.clear();
        self.each_local(self.members, |k, _, rho| {
            let ray = self.members[k] as usize;
            // 1/W by its two factors, camera over world and world over rest frame.
            let per_camera_time = gamma / (exposure.ratios[ray] * rho);
            spans.push(exposure.part(ray).map(|after| after * per_camera_time));
        });
        true
    }

    #[inline(always)]
    pub(super) fn each_local(&self, members: &[u32], each: impl FnMut(usize, NullRay<Rest>, f64)) {
        let TracedRays {
            surfaces,
            rays,
            hits,
            ..
        } = self.traced;
        surfaces.each_local(self.frame, members, rays, hits, each);
    }

    /// Two numbers in [0, 1) of member `k` for purpose `dimension`.
    #[inline]
    pub(super) fn random(&self, k: usize, dimension: u32) -> [f64; 2] {
        self.one_random_of(k, dimension, 0, 1)
    }

    /// Fills `numbers` with two numbers in [0, 1) of each member for purpose `dimension` at this surface of its path; `keys` and `indices` are
    /// buffers.
    pub(super) fn each_on_path(
        &self,
        dimension: u32,
        (keys, indices): (&mut Vec<u64>, &mut Vec<u32>),
        numbers: &mut [Vec<f64>; 2],
    ) {
        let samples = &self.traced.rays.samples;
        keys.clear();
        keys.extend(self.members.iter().map(|ray| samples.pixel(*ray as usize)));
        indices.clear();
        if !samples.indices.is_empty() {
            indices.extend(self.members.iter().map(|ray| samples.index(*ray as usize)));
        }
        samples.each_on_path((keys, indices), dimension, numbers);
    }

    /// The same as [`Run::random`], for number `number` of `count` per sample.
    #[inline]
    pub(super) fn one_random_of(
        &self,
        k: usize,
        dimension: u32,
        number: u32,
        count: u32,
    ) -> [f64; 2] {
        let ray = self.members[k] as usize;
        let samples = &self.traced.rays.samples;
        samples.one_of(ray, dimension, number, count)
    }
}

/// The loop over members that multiplies their ratios by those of the rest frame.
struct Ratios<'a> {
    boost: &'a Boost<Rest, World>,
    directions: &'a [DVec3],
    members: &'a [u32],
    ratios: &'a mut [f64],
}

impl VectorLoop for Ratios<'_> {
    #[inline(always)]
    fn run(self) {
        let boost = *self.boost;
        let mut d = Vectors::ZERO;
        let mut rhos = [0.0; BLOCK];
        for (members, ratios) in (self.members.chunks(BLOCK)).zip(self.ratios.chunks_mut(BLOCK)) {
            for (k, ray) in members.iter().enumerate() {
                d.set(k, self.directions[*ray as usize]);
            }
            for (k, rho) in rhos.iter_mut().enumerate() {
                *rho = boost.direction_of_moving(Direction::from_unit(d.get(k))).1;
            }
            for (ratio, rho) in ratios.iter_mut().zip(&rhos) {
                *ratio *= rho;
            }
        }
    }
}

/// The range of rays that `members` are, if they are consecutive: for example, if all rays of a batch hit one patch.
pub(super) fn in_a_row(members: &[u32]) -> Option<Range<usize>> {
    let first = *members.first()?;
    // Without early exit, so that the loop is vectorised.
    let numbers = members.iter().zip(first..);
    let are_others = numbers.fold(false, |others, (ray, n)| others | (*ray != n));
    (!are_others).then(|| first as usize..first as usize + members.len())
}

#[cfg(test)]
mod tests {
    use super::in_a_row;

    #[test]
    fn rays_in_a_row_are_told_from_others() {
        assert_eq!(in_a_row(&[3, 4, 5]), Some(3..6));
        assert_eq!(in_a_row(&[7]), Some(7..8));
        for others in [
            &[][..],
            &[3, 5, 6],
            &[3, 4, 6],
            &[3, 3],
            &[4, 3],
            &[0, 2, 1, 3],
        ] {
            assert_eq!(in_a_row(others), None, "{others:?}");
        }
    }
}
