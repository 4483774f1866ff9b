//! What rays can hit: static meshes in their rest frames, as seen from one event.
//!
//! All objects at rest relative to each other share one [`RestFrame`] with one BVH. A world ray is boosted into each frame with its
//! parameter unchanged, so the nearest hit over all frames is the one with the smallest s. For a single frame the boosted rays are kept for
//! shading, and a frame at rest in the world needs no boost; with several frames a ray is boosted again into the one that it hit.

use glam::DVec3;

use super::camera_rays::Rays;
use super::cone::{DirectionBounds, VisibleCone};
use super::hits::HitBuffer;
use super::rest_frame::RestFrame;
use super::stats::{Meter, Stage};
use super::surface_point::SurfacePoint;
use super::tubes::Tubes;
use crate::camera::Shot;
use crate::spacetime::{
    Boost, Direction, Displacement, Event, InertialFrame, NullRay, Rest, World,
};

/// The surfaces of all rest frames, as seen from one event.
#[derive(Debug)]
pub struct Surfaces<'a>(pub(super) Frames<'a>);

#[derive(Debug)]
pub(super) enum Frames<'a> {
    /// One rest frame, at rest in the world: no boosts.
    Still(Frame<'a>),
    /// One moving rest frame: its rays stay in the hit buffer.
    One(Frame<'a>),
    /// Any number of rest frames.
    Many(Many<'a>),
}

/// Several rest frames.
#[derive(Debug)]
pub(super) struct Many<'a> {
    pub frames: Vec<Frame<'a>>,
    /// The directions in which each frame is visible, if known.
    pub cones: Vec<Option<VisibleCone>>,
    /// The region of the world where each frame is.
    pub tubes: Tubes,
}

/// One rest frame.
#[derive(Debug)]
pub(super) struct Frame<'a> {
    pub rest: &'a RestFrame,
    /// The event of the shot in this frame.
    pub shot: Event<Rest>,
    pub index: f64,
}

impl<'a> Surfaces<'a> {
    /// `rests` as seen from the event of `shot` in a medium of index `index`, for rays traced by [`Surfaces::nearest`].
    pub fn new(rests: &'a [RestFrame], shot: &Shot, index: f64) -> Self {
        match rests {
            [rest] if !rest.frame.velocity().is_rest() => Surfaces(Frames::One(Frame {
                rest,
                shot: shot.event_in(&rest.frame),
                index,
            })),
            _ => Surfaces::unbuffered(rests, |frame| shot.event_in(frame), index),
        }
    }

    /// The same for hits that may come from elsewhere: only the hits are read from the hit buffer. `event_in` is the event from which they
    /// are seen, in the coordinates of a frame.
    pub fn unbuffered(
        rests: &'a [RestFrame],
        event_in: impl Fn(&InertialFrame<Rest>) -> Event<Rest>,
        index: f64,
    ) -> Self {
        let frame = |rest: &'a RestFrame| Frame {
            rest,
            shot: event_in(&rest.frame),
            index,
        };
        // The axes of a frame at rest are the world's.
        if let [rest] = rests
            && rest.frame.velocity().is_rest()
        {
            return Surfaces(Frames::Still(frame(rest)));
        }
        let frames: Vec<_> = rests.iter().map(frame).collect();
        let cone = |frame: &Frame| VisibleCone::of(frame.rest, frame.shot, index);
        let cones = frames.iter().map(cone).collect();
        Surfaces(Frames::Many(Many {
            frames,
            cones,
            tubes: Tubes::of(rests),
        }))
    }

    /// Fills `hits` with the nearest hit along each of `rays`.
    pub fn nearest(&self, rays: &Rays, hits: &mut HitBuffer, meter: &mut Meter) {
        let count = rays.directions.len();
        match &self.0 {
            Frames::Still(frame) => {
                hits.start(count, 1);
                hits.boost_origins(frame.boost(), frame.shot, rays);
                meter.lap(Stage::Boosts);
                let (bvh, directions) = (&frame.rest.bvh, Some(rays.directions));
                hits.intersect(0, bvh, rays, frame.shot.x, directions, meter);
                meter.lap(Stage::Visibility);
            }
            Frames::One(frame) => {
                hits.start(count, 1);
                frame.intersect(0, rays, hits, meter);
            }
            Frames::Many(Many { frames, cones, .. }) => {
                hits.start(count, frames.len());
                // The cones only hold for rays from the event of the shot.
                let bounds = match rays.origins {
                    None if !frames.is_empty() => Some(DirectionBounds::of(rays.directions)),
                    _ => None,
                };
                for (k, (frame, cone)) in frames.iter().zip(cones).enumerate() {
                    match bounds.zip(*cone) {
                        Some((bounds, cone)) if cone.misses(&bounds) => {}
                        Some((_, cone)) => {
                            frame.intersect_within(&cone, k as u32, rays, hits, meter);
                        }
                        None => frame.intersect(k as u32, rays, hits, meter),
                    }
                }
            }
        }
    }

    /// The rest frame with index `frame`.
    #[inline]
    pub fn rest(&self, frame: u32) -> &'a RestFrame {
        match &self.0 {
            Frames::Still(only) | Frames::One(only) => only.rest,
            Frames::Many(many) => many.frames[frame as usize].rest,
        }
    }

    /// Ray `ray` of `rays`, whose nearest hits are in `hits`, in the coordinates of rest frame `frame`, where it has hit something, and
    /// ω_rest/ω_world of its light.
    #[inline(always)]
    pub(super) fn local(
        &self,
        frame: u32,
        ray: usize,
        rays: &Rays,
        hits: &HitBuffer,
    ) -> (NullRay<Rest>, f64) {
        match &self.0 {
            Frames::Still(only) => only.shifted_ray(ray, rays, hits),
            Frames::One(only) => hits.boosted(ray, only.shot),
            Frames::Many(many) => many.frames[frame as usize].boosted_ray(ray, rays),
        }
    }

    /// The only rest frame, if it is at rest in the world.
    #[inline(always)]
    pub(super) fn at_rest(&self) -> Option<&'a RestFrame> {
        match &self.0 {
            Frames::Still(only) => Some(only.rest),
            Frames::One(_) | Frames::Many(_) => None,
        }
    }

    /// The common origin of the rays in the only rest frame, and all their tangents there, if available.
    #[inline(always)]
    pub(super) fn shared_origin<'b>(
        &self,
        rays: &Rays<'b>,
        hits: &'b HitBuffer,
    ) -> Option<(DVec3, &'b [DVec3])> {
        match &self.0 {
            _ if rays.origins.is_some() => None,
            Frames::Still(only) => Some((only.shot.x, rays.directions)),
            Frames::One(only) => Some((only.shot.x, hits.tangents())),
            Frames::Many(_) => None,
        }
    }

    /// ω_rest/ω_world of all rays, if available.
    #[inline(always)]
    pub(super) fn ratios<'b>(&self, hits: &'b HitBuffer) -> Option<&'b [f64]> {
        match &self.0 {
            Frames::One(_) => Some(hits.ratios()),
            Frames::Still(_) | Frames::Many(_) => None,
        }
    }

    /// Calls `each` with the result of [`Surfaces::local`] for each of `members`, all of which have hit `frame`. The kind of surfaces is
    /// matched once.
    #[inline(always)]
    pub(super) fn each_local(
        &self,
        frame: u32,
        members: &[u32],
        rays: &Rays,
        hits: &HitBuffer,
        mut each: impl FnMut(usize, NullRay<Rest>, f64),
    ) {
        let members = members.iter().map(|ray| *ray as usize).enumerate();
        match &self.0 {
            Frames::Still(only) => {
                for (k, ray) in members {
                    let (local, rho) = only.shifted_ray(ray, rays, hits);
                    each(k, local, rho);
                }
            }
            Frames::One(only) => {
                for (k, ray) in members {
                    let (local, rho) = hits.boosted(ray, only.shot);
                    each(k, local, rho);
                }
            }
            Frames::Many(many) => {
                let frame = &many.frames[frame as usize];
                for (k, ray) in members {
                    let (local, rho) = frame.boosted_ray(ray, rays);
                    each(k, local, rho);
                }
            }
        }
    }

    /// The look direction in rest frame `frame`, and ω_rest/ω_world of light from there.
    #[inline]
    pub fn direction(&self, frame: u32, d: Direction<World>) -> (Direction<Rest>, f64) {
        match &self.0 {
            Frames::Still(_) => (Direction::from_unit(d.unit()), 1.0),
            Frames::One(only) => only.boost().direction(d),
            Frames::Many(many) => many.frames[frame as usize].boost().direction(d),
        }
    }

    /// Whether points of frame `own` have the same positions in frame `frame`.
    pub(super) fn shares_places(&self, frame: u32, own: u32) -> bool {
        !matches!(&self.0, Frames::Many(_)) || frame == own
    }

    /// The event of `point` in rest frame `frame`.
    #[inline]
    pub(super) fn event(&self, frame: u32, point: &SurfacePoint) -> Event<Rest> {
        match &self.0 {
            Frames::Many(many) if frame != point.frame => {
                // The same ray in this frame: s does not change.
                let frame = &many.frames[frame as usize];
                let d = Direction::from_unit(point.ray.tangent.x);
                let index = frame.index * point.origin.delay;
                let (tangent, _) = frame.boost().tangent_and_ratio(index, d);
                let origin = frame.origin(Some(point.origin.displacement));
                NullRay { origin, tangent }.at(point.hit.s)
            }
            _ => point.rest_event(),
        }
    }

    /// The event at `displacement` from the event of the shot, in rest frame `frame`.
    pub(super) fn start(&self, frame: u32, displacement: Displacement<World>) -> Event<Rest> {
        match &self.0 {
            Frames::Still(only) | Frames::One(only) => only.origin(Some(displacement)),
            Frames::Many(many) => many.frames[frame as usize].origin(Some(displacement)),
        }
    }

    /// The origin in rest frame `frame` of the ray that has hit `point`.
    pub(super) fn origin(&self, frame: u32, point: &SurfacePoint) -> DVec3 {
        match &self.0 {
            Frames::Many(many) if frame != point.frame => {
                let displacement = Some(point.origin.displacement);
                many.frames[frame as usize].origin(displacement).x
            }
            _ => point.local.origin.x,
        }
    }

    /// Transforms `d` from rest frame `from` to rest frame `to`.
    pub(super) fn displacement(
        &self,
        from: u32,
        to: u32,
        d: Displacement<Rest>,
    ) -> Displacement<Rest> {
        if self.shares_places(to, from) {
            return d;
        }
        let in_world = self.rest(from).frame.world_from_frame().displacement(d);
        self.rest(to)
            .frame
            .frame_from_world()
            .displacement(in_world)
    }

    /// The boost from the world to rest frame `frame`; `None` if it is the identity.
    pub(super) fn boost(&self, frame: u32) -> Option<&'a Boost<Rest, World>> {
        let boost = match &self.0 {
            Frames::Still(_) => return None,
            Frames::One(only) => only.boost(),
            Frames::Many(many) => many.frames[frame as usize].boost(),
        };
        (!boost.is_identity()).then_some(boost)
    }
}

impl<'a> Frame<'a> {
    #[inline]
    pub(super) fn boost(&self) -> &'a Boost<Rest, World> {
        self.rest.frame.frame_from_world()
    }

    /// Intersects `rays` with this frame, whose index is `frame`.
    fn intersect(&self, frame: u32, rays: &Rays, hits: &mut HitBuffer, meter: &mut Meter) {
        hits.boost_tangents(self.boost(), self.index, rays);
        hits.boost_origins(self.boost(), self.shot, rays);
        meter.lap(Stage::Boosts);
        hits.intersect(frame, &self.rest.bvh, rays, self.shot.x, None, meter);
        meter.lap(Stage::Visibility);
    }

    /// The same for rays from the event of the shot; those outside `cone` hit nothing in this frame.
    fn intersect_within(
        &self,
        cone: &VisibleCone,
        frame: u32,
        rays: &Rays,
        hits: &mut HitBuffer,
        meter: &mut Meter,
    ) {
        let chosen = hits.choose(cone, rays.directions);
        // If most rays are within the cone, leaving out the others saves less than gathering costs.
        if chosen > rays.directions.len() / 2 {
            return self.intersect(frame, rays, hits, meter);
        }
        hits.boost_chosen(self.boost(), self.index, rays);
        meter.lap(Stage::Boosts);
        hits.intersect_chosen(frame, &self.rest.bvh, rays, self.shot.x, meter);
        meter.lap(Stage::Visibility);
    }

    /// Ray `ray` in this frame, which is at rest in the world.
    #[inline(always)]
    fn shifted_ray(&self, ray: usize, rays: &Rays, hits: &HitBuffer) -> (NullRay<Rest>, f64) {
        let local = NullRay {
            origin: hits.origin(ray, self.shot),
            tangent: Displacement::new(-rays.index(self.index, ray), rays.directions[ray]),
        };
        (local, 1.0)
    }

    /// Ray `ray`, boosted into this frame.
    #[inline(always)]
    pub(super) fn boosted_ray(&self, ray: usize, rays: &Rays) -> (NullRay<Rest>, f64) {
        let d = Direction::from_unit(rays.directions[ray]);
        let index = rays.index(self.index, ray);
        let (tangent, rho) = self.boost().tangent_and_ratio(index, d);
        let origin = self.origin(rays.origins.map(|all| all[ray].displacement));
        (NullRay { origin, tangent }, rho)
    }

    /// The event at `displacement` from the event of the shot; bit-identical to the shot if there is none.
    #[inline(always)]
    fn origin(&self, displacement: Option<Displacement<World>>) -> Event<Rest> {
        match displacement {
            None => self.shot,
            Some(displacement) => self.shot + self.boost().displacement(displacement),
        }
    }
}
