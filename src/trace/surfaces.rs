//! What a ray can meet: static meshes in their rest frames.
//!
//! All objects at rest relative to each other share one [`RestFrame`] with one BVH. A world ray is
//! carried into each frame with its parameter unchanged, so the nearest hit over all frames is the
//! one with the smallest s. Three implementations: one frame at rest in the world, where nothing is
//! boosted; one that moves, without a loop over frames; and any number of them.

use glam::DVec3;

use crate::accel::{Bvh, Hit, Ray};
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
        let after = self.patches.partition_point(|p| p.first <= triangle);
        &self.patches[after.saturating_sub(1)]
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

/// The nearest surfaces along rays that share the camera's event, and occlusion between any events.
pub trait Surfaces: Sync {
    /// Makes `scratch` hold the nearest hit along each of `directions`.
    fn nearest(&self, directions: &[Direction<World>], scratch: &mut Scratch);

    /// The rest frame of index `frame`.
    fn rest(&self, frame: u32) -> &RestFrame;

    /// The ray along `d` in the coordinates of rest frame `frame`, and ω_rest/ω_world of its light.
    fn local(&self, frame: u32, d: Direction<World>) -> (NullRay<Rest>, f64);

    /// Look direction in rest frame `frame`, and ω_rest/ω_world of light from there.
    fn turned(&self, frame: u32, d: Direction<World>) -> (Direction<Rest>, f64);

    /// Whether anything but triangle `skip.1` of frame `skip.0` is met from the point `from.1` metres
    /// along the camera's ray `from.0`, along `d` in a medium of index `index`, within
    /// s < `distance`.
    fn occluded(
        &self,
        from: (Direction<World>, f64),
        d: Direction<World>,
        index: f64,
        distance: f64,
        skip: (u32, u32),
    ) -> bool;
}

/// Buffers of one tile, reused from batch to batch.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Per ray: what it met, and in which rest frame.
    hits: Vec<Option<Hit>>,
    frames: Vec<u32>,
    local: Vec<DVec3>,
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
pub struct Frames<'a>(Vec<Moving<'a>>);

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

impl Surfaces for Still<'_> {
    fn nearest(&self, directions: &[Direction<World>], scratch: &mut Scratch) {
        scratch.start(directions.len());
        scratch.local.extend(directions.iter().map(|d| d.unit()));
        scratch.meet(0, &self.rest.bvh, self.origin.x);
    }

    #[inline]
    fn rest(&self, _: u32) -> &RestFrame {
        self.rest
    }

    #[inline]
    fn local(&self, _: u32, d: Direction<World>) -> (NullRay<Rest>, f64) {
        let local = NullRay {
            origin: self.origin,
            tangent: Displacement::new(-self.index, d.unit()),
        };
        (local, 1.0)
    }

    #[inline]
    fn turned(&self, _: u32, d: Direction<World>) -> (Direction<Rest>, f64) {
        (Direction::from_unit(d.unit()), 1.0)
    }

    fn occluded(
        &self,
        (seen, s): (Direction<World>, f64),
        d: Direction<World>,
        _: f64,
        distance: f64,
        skip: (u32, u32),
    ) -> bool {
        let ray = shadow_ray(self.origin.x, self.local(0, seen).0.at(s).x, d.unit());
        self.rest.bvh.any(&ray, distance, Some(skip.1))
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

    /// Meets `directions` with this frame, which has index `frame`.
    #[inline]
    fn meet(&self, frame: u32, directions: &[Direction<World>], scratch: &mut Scratch) {
        let tangents = directions
            .iter()
            .map(|d| self.boost().tangent(self.index, *d).x);
        scratch.local.clear();
        scratch.local.extend(tangents);
        scratch.meet(frame, &self.rest.bvh, self.origin.x);
    }

    #[inline]
    fn ray(&self, d: Direction<World>) -> (NullRay<Rest>, f64) {
        let (tangent, ratio) = self.boost().tangent_and_ratio(self.index, d);
        let origin = self.origin;
        (NullRay { origin, tangent }, ratio)
    }

    fn shadows(
        &self,
        (seen, s): (Direction<World>, f64),
        d: Direction<World>,
        index: f64,
        distance: f64,
        skip: Option<u32>,
    ) -> bool {
        let from = self.ray(seen).0.at(s).x;
        let direction = self.boost().tangent(index, d).x;
        let ray = shadow_ray(self.origin.x, from, direction);
        self.rest.bvh.any(&ray, distance, skip)
    }
}

impl Surfaces for Moving<'_> {
    fn nearest(&self, directions: &[Direction<World>], scratch: &mut Scratch) {
        scratch.start(directions.len());
        self.meet(0, directions, scratch);
    }

    #[inline]
    fn rest(&self, _: u32) -> &RestFrame {
        self.rest
    }

    #[inline]
    fn local(&self, _: u32, d: Direction<World>) -> (NullRay<Rest>, f64) {
        self.ray(d)
    }

    #[inline]
    fn turned(&self, _: u32, d: Direction<World>) -> (Direction<Rest>, f64) {
        self.boost().direction(d)
    }

    fn occluded(
        &self,
        from: (Direction<World>, f64),
        d: Direction<World>,
        index: f64,
        distance: f64,
        skip: (u32, u32),
    ) -> bool {
        self.shadows(from, d, index, distance, Some(skip.1))
    }
}

impl<'a> Frames<'a> {
    /// `rests` seen from `camera` in a medium of index `index`.
    pub fn new(rests: &'a [RestFrame], camera: Event<World>, index: f64) -> Self {
        Frames(
            rests
                .iter()
                .map(|rest| Moving::new(rest, camera, index))
                .collect(),
        )
    }
}

impl Surfaces for Frames<'_> {
    fn nearest(&self, directions: &[Direction<World>], scratch: &mut Scratch) {
        scratch.start(directions.len());
        for (k, frame) in self.0.iter().enumerate() {
            frame.meet(k as u32, directions, scratch);
        }
    }

    #[inline]
    fn rest(&self, frame: u32) -> &RestFrame {
        self.0[frame as usize].rest
    }

    #[inline]
    fn local(&self, frame: u32, d: Direction<World>) -> (NullRay<Rest>, f64) {
        self.0[frame as usize].ray(d)
    }

    #[inline]
    fn turned(&self, frame: u32, d: Direction<World>) -> (Direction<Rest>, f64) {
        self.0[frame as usize].boost().direction(d)
    }

    fn occluded(
        &self,
        from: (Direction<World>, f64),
        d: Direction<World>,
        index: f64,
        distance: f64,
        skip: (u32, u32),
    ) -> bool {
        self.0.iter().enumerate().any(|(k, frame)| {
            let skip = (k as u32 == skip.0).then_some(skip.1);
            frame.shadows(from, d, index, distance, skip)
        })
    }
}

/// A ray along `direction` from the point `from` of a surface that was seen from `camera`.
///
/// The point is rounded to some 2⁻⁵³ of these coordinates, to one side of its surface or the other. On
/// the edge of a triangle the ray could meet the neighbour right there; what is nearer than 2⁻⁴² of the
/// coordinates (10⁻¹² of a metre in a scene of metres) therefore does not count.
pub(super) fn shadow_ray(camera: DVec3, from: DVec3, direction: DVec3) -> Ray {
    const CLEARANCE: f64 = 1.0 / (1u64 << 42) as f64;
    let size = camera.abs().max_element() + from.abs().max_element();
    Ray {
        origin: from,
        direction,
        s_min: CLEARANCE * size / direction.length(),
    }
}

impl Scratch {
    fn start(&mut self, rays: usize) {
        self.local.clear();
        self.hits.clear();
        self.hits.resize(rays, None);
        self.frames.clear();
        self.frames.resize(rays, 0);
    }

    /// Takes over what the rays along `local` meet in `frame`, where it is nearer.
    fn meet(&mut self, frame: u32, bvh: &Bvh, origin: DVec3) {
        let (hits, frames) = (&mut self.hits, &mut self.frames);
        bvh.closest_each(origin, &self.local, hits, |ray| frames[ray] = frame);
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
