//! Runs: points of one patch that consecutive rays of a batch have met.

use glam::DVec2;

use super::emission::SurfacePoint;
use super::record::Seen;
use super::scratch::Scratch;
use super::surfaces::{Found, Patch, Rays, RestFrame, Surfaces};
use crate::accel::Hit;
use crate::camera::{Apart, Departure};
use crate::spacetime::{Direction, Event, NullRay, Rest, WavelengthRatio, World};

/// Rays of a batch with what they have met.
#[derive(Debug)]
pub struct Traced<'a, D, S> {
    /// What there is to meet.
    pub surfaces: &'a S,
    /// The rays.
    pub rays: Rays<'a, D>,
    /// What they have met.
    pub scratch: &'a Scratch,
    /// The event of the shot.
    pub event: Event<World>,
    /// Refractive index that delays the rays.
    pub index: f64,
}

/// Points of one patch.
#[derive(Debug)]
pub struct Run<'a, D, S> {
    /// The batch.
    pub traced: &'a Traced<'a, D, S>,
    /// Which of its rays meet them.
    pub members: &'a [u32],
    /// The patch.
    pub patch: &'a Patch,
    /// Its rest frame.
    pub rest: &'a RestFrame,
    /// The frame's index.
    pub frame: u32,
}

impl<'a, D: Departure, S: Surfaces> Traced<'a, D, S> {
    /// The world ray `ray`.
    #[inline(always)]
    pub(super) fn ray(&self, ray: usize) -> NullRay<World> {
        let d = Direction::from_unit(self.rays.directions[ray]);
        if D::TOGETHER {
            return NullRay::new(self.event, d, self.index);
        }
        let Apart {
            displacement,
            delay,
            ..
        } = self.rays.from[ray].into();
        NullRay::new(self.event + displacement, d, self.index * delay)
    }

    /// The surface point that ray `ray` has met on `patch` at `hit`, and ω_rest/ω_world of its light.
    #[inline(always)]
    pub(super) fn point(
        &self,
        ray: usize,
        hit: Hit,
        frame: u32,
        patch: &'a Patch,
    ) -> (SurfacePoint<'a>, f64) {
        let (local, rho) = self.surfaces.local(frame, ray, &self.rays, self.scratch);
        let point = SurfacePoint {
            rest: self.surfaces.rest(frame),
            frame,
            patch,
            hit,
            ray: self.ray(ray),
            from: self.rays.from[ray].into(),
            local,
        };
        (point, rho)
    }
}

impl<'a, D: Departure, S: Surfaces> Traced<'a, D, S> {
    /// What ray `ray` sees, if anything; `ratio` is its W for sources at rest in the world.
    pub(crate) fn seen(&self, ray: usize, ratio: f64) -> Option<Seen<'a>> {
        let Found { hit, frame } = self.scratch.found(ray)?;
        let patch = self.surfaces.rest(frame).patch(hit.triangle);
        let (point, rho) = self.point(ray, hit, frame, patch);
        let w = WavelengthRatio(ratio * rho);
        Some(Seen { point, w })
    }
}

impl<'a, D: Departure, S: Surfaces> Run<'a, D, S> {
    /// The hit of member `k`; all members have met something.
    #[inline(always)]
    pub(super) fn hit(&self, k: usize) -> Option<Hit> {
        self.traced.scratch.hits()[self.members[k] as usize]
    }

    /// The points, in order.
    #[inline(always)]
    pub(super) fn points(&self) -> impl Iterator<Item = SurfacePoint<'a>> + use<'a, D, S> {
        let (traced, frame, patch) = (self.traced, self.frame, self.patch);
        self.members.iter().filter_map(move |&ray| {
            let hit = traced.scratch.hits()[ray as usize]?;
            Some(traced.point(ray as usize, hit, frame, patch).0)
        })
    }

    /// World time of the emission event of member `k`, whose hit is at `s`.
    #[inline(always)]
    pub(super) fn world_time(&self, k: usize, s: f64) -> f64 {
        let ray = self.traced.ray(self.members[k] as usize);
        ray.origin.ct + ray.tangent.ct * s
    }

    /// The object's own time there.
    #[inline(always)]
    pub(super) fn object_time(&self, k: usize, s: f64) -> f64 {
        let local = self.local(k).0;
        (local.origin.ct + local.tangent.ct * s) - self.patch.object_origin.ct
    }

    /// Member `k` in the rest frame, and ω_rest/ω_world of its light.
    #[inline(always)]
    pub(super) fn local(&self, k: usize) -> (NullRay<Rest>, f64) {
        let Traced {
            surfaces,
            rays,
            scratch,
            ..
        } = &self.traced;
        surfaces.local(self.frame, self.members[k] as usize, rays, scratch)
    }

    /// Texture coordinates of set `set` at `hit`; NaN where the object has none.
    #[inline(always)]
    pub(super) fn uv(&self, set: usize, hit: &Hit) -> DVec2 {
        let mesh = self.rest.meshes.get(self.patch.mesh as usize);
        let primitive = hit.triangle - self.patch.object_first;
        let uv = mesh.and_then(|mesh| mesh.uv(set, primitive, [hit.u, hit.v]));
        uv.unwrap_or(DVec2::NAN)
    }
}
