//! Whether anything stands between points of surfaces and events in the past, for many of them at a time.

use glam::DVec3;

use super::point::SurfacePoint;
use crate::accel::{Bvh, Counts, Hit, Method, NoTally, Ray, Segment};
use crate::camera::RayOrigin;
use crate::spacetime::{Direction, NullRay, Rest, World};

/// Occlusion queries and their answers.
#[derive(Debug, Default)]
pub struct OcclusionQueries {
    /// The queries.
    pub(super) queries: Vec<OcclusionQuery>,
    /// The answers, in the same order.
    pub(super) blocked: Vec<bool>,
    segments: Vec<Segment>,
    open: Vec<usize>,
    answers: Vec<bool>,
}

/// Whether a ray from a point along `d` hits anything but the triangle of the point itself within s < `distance`.
#[derive(Debug, Clone, Copy)]
pub(super) struct OcclusionQuery {
    /// The point's rest frame.
    pub frame: u32,
    /// Its hit.
    pub hit: Hit,
    /// The ray that hit the point, in the world.
    pub ray: NullRay<World>,
    /// The same in the rest frame.
    pub local: NullRay<Rest>,
    /// Where that ray leaves.
    pub origin: RayOrigin,
    /// The direction from the point.
    pub d: Direction<World>,
    /// Metres of the world.
    pub distance: f64,
}

impl OcclusionQuery {
    /// From `point` along `d`.
    #[inline]
    pub fn new(point: &SurfacePoint, d: Direction<World>, distance: f64) -> Self {
        OcclusionQuery {
            frame: point.frame,
            hit: point.hit,
            ray: point.ray,
            local: point.local,
            origin: point.origin,
            d,
            distance,
        }
    }
}

impl OcclusionQueries {
    /// Forgets the last ones.
    pub(super) fn clear(&mut self) {
        self.queries.clear();
        self.blocked.clear();
    }

    /// Answers those that are not blocked yet with `bvh`, by the segments that `segment` makes of them.
    pub(super) fn answer(
        &mut self,
        bvh: &Bvh,
        method: Method,
        counts: Option<&mut Counts>,
        segment: impl Fn(&OcclusionQuery) -> Segment,
    ) {
        self.blocked.resize(self.queries.len(), false);
        self.segments.clear();
        self.open.clear();
        for (k, query) in self.queries.iter().enumerate() {
            if !self.blocked[k] {
                self.open.push(k);
                self.segments.push(segment(query));
            }
        }
        any_hit(bvh, method, &self.segments, &mut self.answers, counts);
        for (k, answer) in self.open.iter().zip(&self.answers) {
            self.blocked[*k] = *answer;
        }
    }
}

/// Puts into `blocked` whether each of `segments` hits anything.
pub(super) fn any_hit(
    bvh: &Bvh,
    method: Method,
    segments: &[Segment],
    blocked: &mut Vec<bool>,
    counts: Option<&mut Counts>,
) {
    blocked.clear();
    blocked.resize(segments.len(), false);
    match counts {
        None => bvh.any_by(method, segments, blocked, &mut NoTally),
        Some(counts) => bvh.any_by(method, segments, blocked, counts),
    }
}

/// A ray along `direction` from the point `from` of a surface that was seen from `camera`.
///
/// The point is rounded to some 2⁻⁵³ of these coordinates, to one side of its surface or the other. On
/// the edge of a triangle the ray could hit the neighbour right there; what is nearer than 2⁻⁴² of the
/// coordinates (10⁻¹² of a metre in a scene of metres) therefore does not count.
#[inline]
pub(super) fn shadow_ray(camera: DVec3, from: DVec3, direction: DVec3) -> Ray {
    const CLEARANCE: f64 = 1.0 / (1u64 << 42) as f64;
    let size = camera.abs().max_element() + from.abs().max_element();
    Ray {
        origin: from,
        direction,
        s_min: CLEARANCE * size / direction.length(),
    }
}
