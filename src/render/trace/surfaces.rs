//! What a ray can meet: static meshes in their rest frames.
//!
//! All objects at rest relative to each other share one [`RestFrame`] with one BVH. A world ray is
//! carried into each frame with its parameter unchanged, so the nearest hit over all frames is the
//! one with the smallest s. Three implementations: one frame at rest in the world, where nothing is
//! boosted; one that moves, without a loop over frames; and any number of them.

use glam::DVec3;

use super::Scratch;
use super::occlusion::{Question, Questions, shadow_ray};
use super::reach::{Fan, Reach};
use super::stats::{Meter, Stage};
use crate::accel::{Bvh, Hit, Method, Segment, Tally};
use crate::camera::Departure;
use crate::mesh::Mesh;
use crate::spacetime::{
    Boost, Direction, Displacement, Event, InertialFrame, NullRay, Rest, World,
};

/// Everything at rest in one inertial frame.
#[derive(Debug)]
pub struct RestFrame {
    /// The frame; its origin is that of its first object.
    pub frame: InertialFrame<Rest>,
    /// All triangles, in rest-frame coordinates relative to the frame's origin.
    pub bvh: Bvh,
    /// Runs of triangles that look alike, ascending by first triangle.
    pub patches: Vec<Patch>,
    /// Per object of the frame: triangles and texture coordinates, where something needs them.
    pub meshes: Vec<Mesh>,
}

/// A run of triangles of one object with one emitter.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// First triangle (index in the frame's BVH).
    pub first: u32,
    /// Index of the object in the scene.
    pub object: u32,
    /// Index into [`RestFrame::meshes`].
    pub mesh: u32,
    /// Triangle of the frame's BVH that is triangle 0 of the object.
    pub object_first: u32,
    /// The object's origin event in the frame: subtract it for the object's own coordinates.
    pub object_origin: Event<Rest>,
    /// Index into the emitters.
    pub emitter: u32,
    /// Whether the back face is black.
    pub black_back: bool,
}

impl RestFrame {
    /// The patch that triangle `triangle` belongs to.
    #[inline]
    pub fn patch(&self, triangle: u32) -> &Patch {
        self.patch_and_end(triangle).0
    }

    /// The same, and the first triangle after it.
    #[inline]
    pub(super) fn patch_and_end(&self, triangle: u32) -> (&Patch, u32) {
        let after = self.patches.partition_point(|p| p.first <= triangle);
        let after = after.max(1);
        let end = self.patches.get(after).map_or(u32::MAX, |next| next.first);
        (&self.patches[after - 1], end)
    }
}

/// A hit and the rest frame that it is in.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    /// The hit; its s is the world distance in metres.
    pub hit: Hit,
    /// Index of the rest frame.
    pub frame: u32,
}

/// Rays of one batch: look directions in the world, and where each leaves.
#[derive(Debug, Clone, Copy)]
pub struct Rays<'a, D> {
    /// Look directions, unit vectors of the world.
    pub directions: &'a [DVec3],
    /// Where each leaves, relative to the event of the shot.
    pub from: &'a [D],
    /// How they are traced.
    pub method: Method,
}

/// The nearest surfaces along rays of a camera, and occlusion between any events.
pub trait Surfaces: Sync {
    /// Makes `scratch` hold the nearest hit along each of `rays`.
    fn nearest<D: Departure, M: Meter>(&self, rays: Rays<D>, scratch: &mut Scratch, meter: &mut M);

    /// The rest frame of index `frame`.
    fn rest(&self, frame: u32) -> &RestFrame;

    /// Ray `ray` of `rays`, whose nearest hits are in `scratch`, in the coordinates of rest frame `frame`, in
    /// which it has met something, and ω_rest/ω_world of its light.
    fn local<D: Departure>(
        &self,
        frame: u32,
        ray: usize,
        rays: &Rays<D>,
        scratch: &Scratch,
    ) -> (NullRay<Rest>, f64);

    /// Look direction in rest frame `frame`, and ω_rest/ω_world of light from there.
    fn turned(&self, frame: u32, d: Direction<World>) -> (Direction<Rest>, f64);

    /// Answers `questions`, in which `index` is that of the medium.
    fn occlude(
        &self,
        questions: &mut Questions,
        index: f64,
        method: Method,
        tally: &mut impl Tally,
    );
}

/// One rest frame, at rest in the world.
#[derive(Debug)]
pub struct Still<'a> {
    rest: &'a RestFrame,
    origin: Event<Rest>,
    index: f64,
}

/// One rest frame, which moves.
#[derive(Debug)]
pub struct Moving<'a> {
    rest: &'a RestFrame,
    /// The camera's event in it.
    origin: Event<Rest>,
    index: f64,
}

/// Any number of rest frames.
#[derive(Debug)]
pub struct Frames<'a> {
    frames: Vec<Moving<'a>>,
    /// Where each is seen, as far as that is known.
    reaches: Vec<Option<Reach>>,
}

impl<'a> Still<'a> {
    /// `rest` seen from `camera` in a medium of index `index`.
    pub fn new(rest: &'a RestFrame, camera: Event<World>, index: f64) -> Self {
        Still {
            rest,
            origin: shifted(rest, camera),
            index,
        }
    }
}

/// Rest coordinates of a world event, for a frame at rest in the world.
fn shifted(rest: &RestFrame, event: Event<World>) -> Event<Rest> {
    let d = event - rest.frame.origin();
    Event::new(d.ct, d.x)
}

/// `origin` moved by where a ray leaves; bit for bit the same where all leave together.
#[inline(always)]
fn leaving<D: Departure>(
    origin: Event<Rest>,
    from: D,
    displacement: impl FnOnce(Displacement<World>) -> Displacement<Rest>,
) -> Event<Rest> {
    match D::TOGETHER {
        true => origin,
        false => origin + displacement(from.into().displacement),
    }
}

/// The index of the medium along a ray.
#[inline(always)]
pub(super) fn index_along<D: Departure>(index: f64, from: D) -> f64 {
    match D::TOGETHER {
        true => index,
        false => index * from.into().delay,
    }
}

impl Surfaces for Still<'_> {
    fn nearest<D: Departure, M: Meter>(&self, rays: Rays<D>, scratch: &mut Scratch, meter: &mut M) {
        let Still { rest, origin, .. } = self;
        scratch.start(rays.directions.len(), 1);
        scratch.leave(rest.frame.frame_from_world(), *origin, rays.from);
        meter.lap(Stage::Boosts);
        let directions = Some(rays.directions);
        scratch.meet(
            0,
            &rest.bvh,
            &rays,
            origin.x,
            directions,
            meter.visibility(),
        );
        meter.lap(Stage::Visibility);
    }

    #[inline]
    fn rest(&self, _: u32) -> &RestFrame {
        self.rest
    }

    #[inline(always)]
    fn local<D: Departure>(
        &self,
        _: u32,
        ray: usize,
        rays: &Rays<D>,
        scratch: &Scratch,
    ) -> (NullRay<Rest>, f64) {
        let index = index_along(self.index, rays.from[ray]);
        let local = NullRay {
            origin: scratch.left(ray, self.origin),
            tangent: Displacement::new(-index, rays.directions[ray]),
        };
        (local, 1.0)
    }

    #[inline]
    fn turned(&self, _: u32, d: Direction<World>) -> (Direction<Rest>, f64) {
        (Direction::from_unit(d.unit()), 1.0)
    }

    fn occlude(&self, questions: &mut Questions, _: f64, method: Method, tally: &mut impl Tally) {
        questions.ask(&self.rest.bvh, method, tally, |q| Segment {
            ray: shadow_ray(q.local.origin.x, q.local.at(q.hit.s).x, q.d.unit()),
            s_max: q.distance,
            skip: Some(q.hit.triangle),
        });
    }
}

impl<'a> Moving<'a> {
    /// `rest` seen from `camera` in a medium of index `index`.
    pub fn new(rest: &'a RestFrame, camera: Event<World>, index: f64) -> Self {
        Moving {
            rest,
            origin: rest.frame.event_from_world(camera),
            index,
        }
    }

    fn boost(&self) -> &Boost<Rest, World> {
        self.rest.frame.frame_from_world()
    }

    /// Meets `rays` with this frame, which has index `frame`.
    fn meet<D: Departure, M: Meter>(
        &self,
        frame: u32,
        rays: Rays<D>,
        scratch: &mut Scratch,
        meter: &mut M,
    ) {
        scratch.carry(self.boost(), self.index, rays);
        scratch.leave(self.boost(), self.origin, rays.from);
        meter.lap(Stage::Boosts);
        let (bvh, origin) = (&self.rest.bvh, self.origin.x);
        scratch.meet(frame, bvh, &rays, origin, None, meter.visibility());
        meter.lap(Stage::Visibility);
    }

    #[inline]
    fn ray<D: Departure>(&self, d: Direction<World>, from: D) -> (NullRay<Rest>, f64) {
        let index = index_along(self.index, from);
        let (tangent, ratio) = self.boost().tangent_and_ratio(index, d);
        let origin = leaving(self.origin, from, |d| self.boost().displacement(d));
        (NullRay { origin, tangent }, ratio)
    }

    /// `question` about a point seen along `seen` in this frame.
    fn segment(
        &self,
        question: &Question,
        seen: &NullRay<Rest>,
        index: f64,
        skip: Option<u32>,
    ) -> Segment {
        let direction = self.boost().tangent(index, question.d).x;
        Segment {
            ray: shadow_ray(seen.origin.x, seen.at(question.hit.s).x, direction),
            s_max: question.distance,
            skip,
        }
    }
}

impl Surfaces for Moving<'_> {
    fn nearest<D: Departure, M: Meter>(&self, rays: Rays<D>, scratch: &mut Scratch, meter: &mut M) {
        scratch.start(rays.directions.len(), 1);
        self.meet(0, rays, scratch, meter);
    }

    #[inline]
    fn rest(&self, _: u32) -> &RestFrame {
        self.rest
    }

    #[inline(always)]
    fn local<D: Departure>(
        &self,
        _: u32,
        ray: usize,
        _: &Rays<D>,
        scratch: &Scratch,
    ) -> (NullRay<Rest>, f64) {
        scratch.carried(ray, self.origin)
    }

    #[inline]
    fn turned(&self, _: u32, d: Direction<World>) -> (Direction<Rest>, f64) {
        self.boost().direction(d)
    }

    fn occlude(
        &self,
        questions: &mut Questions,
        index: f64,
        method: Method,
        tally: &mut impl Tally,
    ) {
        questions.ask(&self.rest.bvh, method, tally, |q| {
            self.segment(q, &q.local, index, Some(q.hit.triangle))
        });
    }
}

impl<'a> Frames<'a> {
    /// `rests` seen from `camera` in a medium of index `index`.
    pub fn new(rests: &'a [RestFrame], camera: Event<World>, index: f64) -> Self {
        let frame = |rest| Moving::new(rest, camera, index);
        let frames: Vec<_> = rests.iter().map(frame).collect();
        let reach = |frame: &Moving| Reach::of(frame.rest, frame.origin, index);
        Frames {
            reaches: frames.iter().map(reach).collect(),
            frames,
        }
    }
}

impl Surfaces for Frames<'_> {
    fn nearest<D: Departure, M: Meter>(&self, rays: Rays<D>, scratch: &mut Scratch, meter: &mut M) {
        scratch.start(rays.directions.len(), self.frames.len());
        let fan = D::TOGETHER.then(|| Fan::of(rays.directions));
        for (k, (frame, reach)) in self.frames.iter().zip(&self.reaches).enumerate() {
            let missed = fan
                .zip(*reach)
                .is_some_and(|(fan, reach)| reach.misses(&fan));
            if !missed {
                frame.meet(k as u32, rays, scratch, meter);
            }
        }
    }

    #[inline]
    fn rest(&self, frame: u32) -> &RestFrame {
        self.frames[frame as usize].rest
    }

    #[inline]
    fn local<D: Departure>(
        &self,
        frame: u32,
        ray: usize,
        rays: &Rays<D>,
        _: &Scratch,
    ) -> (NullRay<Rest>, f64) {
        let d = Direction::from_unit(rays.directions[ray]);
        self.frames[frame as usize].ray(d, rays.from[ray])
    }

    #[inline]
    fn turned(&self, frame: u32, d: Direction<World>) -> (Direction<Rest>, f64) {
        self.frames[frame as usize].boost().direction(d)
    }

    fn occlude(
        &self,
        questions: &mut Questions,
        index: f64,
        method: Method,
        tally: &mut impl Tally,
    ) {
        for (k, frame) in self.frames.iter().enumerate() {
            questions.ask(&frame.rest.bvh, method, tally, |q| {
                let skip = (k as u32 == q.frame).then_some(q.hit.triangle);
                let d = Direction::from_unit(q.seen.tangent.x);
                let (seen, _) = frame.ray(d, q.from);
                frame.segment(q, &seen, index, skip)
            });
        }
    }
}
