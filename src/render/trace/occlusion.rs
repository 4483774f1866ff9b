//! Occlusion between points of surfaces and events in the past, for many of them at a time.

use glam::DVec3;

use super::points::Points;
use super::tubes::Bundle;
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch, store};
use crate::accel::{Bvh, Converging, Counts, NoTally, Ray, Segment, Traversal};
use crate::spacetime::{Boost, Direction, Rest, World};

/// Occlusion queries and their answers: whether a ray from a point of a run along a direction of the world hits anything
/// but the triangle of the point itself within a distance.
#[derive(Debug, Default)]
pub struct OcclusionQueries {
    /// The point of the run.
    points: Vec<u32>,
    /// The directions.
    d: Columns,
    /// Metres of the world.
    distance: Vec<f64>,
    /// Frame and triangle at which each ends; none where there are none.
    ends: Vec<(u32, u32)>,
    /// The answers, in the same order.
    blocked: Vec<bool>,
    /// Those that are not blocked yet, and their points: their rays in the frame that is asked.
    open: Vec<u32>,
    open_points: Vec<u32>,
    towards: Columns,
    eyes: Columns,
    from: Columns,
    starts: Vec<f64>,
    segments: Vec<Segment>,
    answers: Vec<bool>,
}

/// Whose surfaces may be in the way, and how points and directions are seen there.
pub(super) struct Obstacles<'a, S> {
    pub bvh: &'a Bvh,
    /// Index of their frame.
    pub frame: u32,
    /// From the world to the frame where they rest, and the index of the medium; none where they rest in the world.
    pub boost: Option<(&'a Boost<Rest, World>, f64)>,
    /// Where the points are in that frame.
    pub places: S,
    /// By point, triangles that are no obstacle: of the frame itself.
    pub own: Option<&'a [u32]>,
}

/// Where points of a run are in a rest frame.
pub(super) trait Places {
    /// Fills `from` with where `points` are, and `eyes` with where the rays leave that saw them.
    fn find(&self, points: &[u32], eyes: &mut Columns, from: &mut Columns);
}

impl Places for &Points {
    fn find(&self, points: &[u32], eyes: &mut Columns, from: &mut Columns) {
        from.gather(&self.positions, points);
        match self.shared_eye() {
            Some(eye) => eyes.fill(points.len(), eye),
            None => {
                eyes.clear();
                points.iter().for_each(|k| eyes.push(self.eye(*k as usize)));
            }
        }
    }
}

impl OcclusionQueries {
    /// Forgets the last ones.
    pub(super) fn clear(&mut self) {
        self.points.clear();
        self.d.clear();
        self.distance.clear();
        self.ends.clear();
        self.blocked.clear();
    }

    /// Asks about the ways from `points` alone, by point along `d` and as far as `distance` says.
    pub(super) fn fill(&mut self, points: &[u32], d: &Columns, distance: &[f64]) {
        self.clear();
        self.points.extend_from_slice(points);
        self.d.gather(d, points);
        let distances = points.iter().map(|k| distance[*k as usize]);
        self.distance.extend(distances);
    }

    /// Asks about the way from point `point` along `d`.
    #[inline(always)]
    pub(super) fn push(&mut self, point: usize, d: DVec3, distance: f64) {
        self.points.push(point as u32);
        self.d.push(d);
        self.distance.push(distance);
    }

    /// The same about the way to triangle `end` of a frame, which is not in the way itself. All queries have an end, or none.
    #[inline(always)]
    pub(super) fn push_to(&mut self, point: usize, d: DVec3, distance: f64, end: (u32, u32)) {
        self.push(point, d, distance);
        self.ends.push(end);
    }

    /// A box of the world about all of them, in a medium of index `index`.
    pub(super) fn bundle(&self, points: &Points, index: f64) -> Bundle {
        let mut bundle = Bundle::NONE;
        for (k, point) in self.points.iter().enumerate() {
            let from = points.event(*point as usize);
            let distance = self.distance[k];
            bundle.add(from.ct, from.x, self.d.get(k) * distance, index * distance);
        }
        bundle.widened()
    }

    /// The answers, in the order of the queries.
    pub(super) fn blocked(&self) -> &[bool] {
        &self.blocked
    }

    /// Whether anything is in the way of query `at`; nothing is where no one was asked.
    #[inline(always)]
    pub(super) fn is_blocked(&self, at: usize) -> bool {
        self.blocked.get(at) == Some(&true)
    }

    /// Asks `obstacles` about those that are not blocked yet.
    pub(super) fn ask<S: Places>(
        &mut self,
        obstacles: &Obstacles<S>,
        method: Traversal,
        counts: Option<&mut Counts>,
    ) {
        self.blocked.resize(self.points.len(), false);
        self.open.clear();
        self.open_points.clear();
        for (query, (blocked, point)) in self.blocked.iter().zip(&self.points).enumerate() {
            if !blocked {
                self.open.push(query as u32);
                self.open_points.push(*point);
            }
        }
        self.towards.gather(&self.d, &self.open);
        // Where the rays start, in the frame of the obstacles.
        obstacles
            .places
            .find(&self.open_points, &mut self.eyes, &mut self.from);
        // Directions are boosted as they are, not made unit vectors: along each the parameter stays metres of the world.
        if let Some((boost, index)) = obstacles.boost {
            dispatch(BoostDirections {
                boost,
                index,
                directions: &mut self.towards,
            });
        }
        // From where on a ray can meet anything: where it enters the ball about the obstacles, or never.
        self.starts.resize(self.open.len(), 0.0);
        dispatch(Starts {
            ball: Ball::about(obstacles.bvh),
            eyes: &self.eyes,
            from: &self.from,
            directions: &self.towards,
            starts: &mut self.starts,
        });

        // Those that pass the obstacles by stay open.
        self.segments.clear();
        let mut near = 0;
        for k in 0..self.open.len() {
            if self.starts[k].is_infinite() {
                continue;
            }
            let (query, point) = (self.open[k], self.open_points[k] as usize);
            self.open[near] = query;
            near += 1;
            self.segments.push(Segment {
                ray: Ray {
                    origin: self.from.get(k),
                    direction: self.towards.get(k),
                    s_min: self.starts[k],
                },
                s_max: self.distance[query as usize],
                skip: obstacles.own.map(|triangles| triangles[point]),
                end: match self.ends.get(query as usize) {
                    Some((frame, triangle)) if *frame == obstacles.frame => Some(*triangle),
                    _ => None,
                },
            });
        }
        self.open.truncate(near);
        // Answers come in the order of the segments, which is that of `open` by now.
        any_hit(
            obstacles.bvh,
            method,
            &self.segments,
            &mut self.answers,
            counts,
        );
        for (query, answer) in self.open.iter().zip(&self.answers) {
            self.blocked[*query as usize] = *answer;
        }
    }
}

/// Directions of the world to those of a rest frame, per metre of the world.
struct BoostDirections<'a> {
    boost: &'a Boost<Rest, World>,
    index: f64,
    directions: &'a mut Columns,
}

impl VectorLoop for BoostDirections<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        while begin < self.directions.len() {
            let mut directions = self.directions.load(begin);
            for k in 0..BLOCK {
                let d = Direction::from_unit(directions.get(k));
                directions.set(k, self.boost.tangent(self.index, d).x);
            }
            self.directions.store(&directions, begin);
            begin += BLOCK;
        }
    }
}

/// A ball about obstacles: its centre, and the square of its radius.
#[derive(Debug, Clone, Copy)]
struct Ball(DVec3, f64);

/// What balls are widened by, of their coordinates: 10⁷ times the rounding, 2⁻⁵³ each, of the few sums and products that make them.
const ROUNDING: f64 = 1e-9;

impl Ball {
    /// With room for rounding.
    fn about(bvh: &Bvh) -> Ball {
        let (lo, hi) = bvh.bounds().unwrap_or((DVec3::NAN, DVec3::NAN));
        let size = lo.abs().max(hi.abs()).max_element();
        let radius = (hi - lo).length() * 0.5 + ROUNDING * size;
        Ball((lo + hi) * 0.5, radius * radius)
    }

    /// Whether a ray from `from` along `d` passes it by: with p from the centre, it is nearest to that at p − (p·d) d/d², or
    /// where it begins. Not for NaN.
    #[inline(always)]
    fn is_missed(&self, from: DVec3, d: DVec3) -> bool {
        let Ball(centre, square) = *self;
        let p = from - centre;
        let (along, pp, dd) = (p.dot(d), p.length_squared(), d.length_squared());
        let beyond = pp - ROUNDING * pp - square;
        let leaves = (along >= 0.0) & (beyond > 0.0);
        let passes = beyond * dd > along * along;
        leaves | passes
    }
}

/// Where rays begin to count; infinite for those that pass the obstacles by.
struct Starts<'a> {
    ball: Ball,
    eyes: &'a Columns,
    from: &'a Columns,
    directions: &'a Columns,
    starts: &'a mut [f64],
}

impl VectorLoop for Starts<'_> {
    #[inline(always)]
    fn run(self) {
        let ball = self.ball;
        let mut begin = 0;
        while begin < self.starts.len() {
            let (eyes, from) = (self.eyes.block(begin), self.from.block(begin));
            let directions = self.directions.block(begin);
            let mut starts = [0.0; BLOCK];
            for (k, start) in starts.iter_mut().enumerate() {
                let (from, d) = (from.get(k), directions.get(k));
                let at = shadow_start(shadow_size(eyes.get(k), from), d);
                let is_missed = ball.is_missed(from, d);
                *start = if is_missed { f64::INFINITY } else { at };
            }
            store(&starts, self.starts, begin);
            begin += BLOCK;
        }
    }
}

/// Puts into `blocked` whether each of `segments` hits anything.
pub(super) fn any_hit(
    bvh: &Bvh,
    method: Traversal,
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

/// The same for ways that all end in one point.
pub(super) fn any_to_point(
    bvh: &Bvh,
    method: Traversal,
    segments: Converging,
    blocked: &mut Vec<bool>,
    counts: Option<&mut Counts>,
) {
    blocked.clear();
    blocked.resize(segments.count(), false);
    match counts {
        None => bvh.any_to_point(method, segments, blocked, &mut NoTally),
        Some(counts) => bvh.any_to_point(method, segments, blocked, counts),
    }
}

/// A ray along `direction` from the point `from` of a surface that was seen from `camera`.
#[inline]
pub(super) fn shadow_ray(camera: DVec3, from: DVec3, direction: DVec3) -> Ray {
    Ray {
        origin: from,
        direction,
        s_min: shadow_start(shadow_size(camera, from), direction),
    }
}

/// Puts into `starts` from where on rays from `points` to one place of their rest frame count, along what lies between.
pub(super) fn shadow_starts(points: &Points, to: DVec3, starts: &mut Vec<f64>) {
    starts.clear();
    starts.resize(points.count(), 0.0);
    dispatch(StartsTowards { points, to, starts });
}

struct StartsTowards<'a> {
    points: &'a Points,
    to: DVec3,
    starts: &'a mut [f64],
}

impl VectorLoop for StartsTowards<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        while begin < self.starts.len() {
            let from = self.points.positions.block(begin);
            let mut starts = [0.0; BLOCK];
            if let Some(eye) = self.points.shared_eye() {
                for (k, start) in starts.iter_mut().enumerate() {
                    let from = from.get(k);
                    *start = shadow_start(shadow_size(eye, from), self.to - from);
                }
            } else {
                let eyes = self.points.load_eyes(begin);
                for (k, start) in starts.iter_mut().enumerate() {
                    let from = from.get(k);
                    *start = shadow_start(shadow_size(eyes.get(k), from), self.to - from);
                }
            }
            store(&starts, self.starts, begin);
            begin += BLOCK;
        }
    }
}

/// From where on a ray along `direction` counts that leaves a surface, by [`shadow_size`].
///
/// The point is rounded to some 2⁻⁵³ of these coordinates, to one side of its surface or the other. On
/// the edge of a triangle the ray could hit the neighbour right there; what is nearer than 2⁻⁴² of the
/// coordinates (10⁻¹² of a metre in a scene of metres) therefore does not count.
#[inline(always)]
pub(super) fn shadow_start(size: f64, direction: DVec3) -> f64 {
    const CLEARANCE: f64 = 1.0 / (1u64 << 42) as f64;
    CLEARANCE * size / direction.length()
}

/// `x`, off its surface as far as rays go on from there: whatever rounding did to it, no triangle of the surface is above that.
#[inline(always)]
pub(super) fn lifted(size: f64, x: DVec3, normal: DVec3) -> DVec3 {
    x + normal * shadow_start(size, normal)
}

/// The coordinates by which the point `from` was rounded that was seen from `camera`.
#[inline(always)]
pub(super) fn shadow_size(camera: DVec3, from: DVec3) -> f64 {
    camera.abs().max_element() + from.abs().max_element()
}
