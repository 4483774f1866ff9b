//! Whether anything stands between points of surfaces and events in the past: asked for many at a time.

use glam::DVec3;

use super::SurfacePoint;
use crate::accel::{Bvh, Hit, Method, Ray, Segment, Tally};
use crate::camera::Apart;
use crate::spacetime::{Direction, NullRay, Rest, World};

/// Whether anything stands between points of surfaces and events in the past, for many of them.
#[derive(Debug, Default)]
pub struct Questions {
    /// What is asked.
    pub asked: Vec<Question>,
    /// The answers, in the same order.
    pub blocked: Vec<bool>,
    segments: Vec<Segment>,
    open: Vec<usize>,
    answers: Vec<bool>,
}

/// Whether anything but the triangle of a point itself is met from there along `d`, within s < `distance`.
#[derive(Debug, Clone, Copy)]
pub struct Question {
    /// The point's rest frame.
    pub frame: u32,
    /// Its hit.
    pub hit: Hit,
    /// The ray that shows the point, in the world and in its rest frame.
    pub seen: NullRay<World>,
    /// The same in the rest frame.
    pub local: NullRay<Rest>,
    /// Where that ray leaves.
    pub from: Apart,
    /// The direction to look for what stands in between.
    pub d: Direction<World>,
    /// Metres of the world.
    pub distance: f64,
}

impl Question {
    /// From `point` along `d`.
    pub(super) fn new(point: &SurfacePoint, d: Direction<World>, distance: f64) -> Self {
        Question {
            frame: point.frame,
            hit: point.hit,
            seen: point.ray,
            local: point.local,
            from: point.from,
            d,
            distance,
        }
    }
}

impl Questions {
    /// Forgets the last ones.
    pub(super) fn clear(&mut self) {
        self.asked.clear();
        self.blocked.clear();
    }

    /// Asks `bvh` for those that are not blocked yet, by the segments that `segment` makes of them.
    pub(super) fn ask(
        &mut self,
        bvh: &Bvh,
        method: Method,
        tally: &mut impl Tally,
        segment: impl Fn(&Question) -> Segment,
    ) {
        self.blocked.resize(self.asked.len(), false);
        self.segments.clear();
        self.open.clear();
        for (k, question) in self.asked.iter().enumerate() {
            if !self.blocked[k] {
                self.open.push(k);
                self.segments.push(segment(question));
            }
        }
        self.answers.clear();
        self.answers.resize(self.open.len(), false);
        bvh.any_by(method, &self.segments, &mut self.answers, tally);
        for (k, answer) in self.open.iter().zip(&self.answers) {
            self.blocked[*k] = *answer;
        }
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
