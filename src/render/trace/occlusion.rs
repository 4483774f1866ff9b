//! Occlusion between points of surfaces and events in the past, for many points at a time.

use glam::DVec3;

use super::point_columns::Points;
use super::tubes::Bundle;
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch, store};
use crate::accel::{Bvh, Converging, Counts, Ray, Segment, Traversal};
use crate::spacetime::{Boost, Direction, Rest, World};

/// Occlusion queries and their answers: whether a ray from a point of a run along a direction in the world hits anything but the point's
/// own triangle within a distance.
#[derive(Debug, Default)]
pub struct OcclusionQueries {
    /// Index of the point in the run.
    points: Vec<u32>,
    /// Directions.
    d: Columns,
    /// Distances, metres of the world.
    distance: Vec<f64>,
    /// Frame and triangle at which each ray ends; empty if they do not end on triangles.
    ends: Vec<(u32, u32)>,
    /// The answers, in the same order.
    blocked: Vec<bool>,
    /// Queries that are not blocked yet, their points, and their rays in the current frame.
    open: Vec<u32>,
    open_points: Vec<u32>,
    towards: Columns,
    eyes: Columns,
    from: Columns,
    starts: Vec<f64>,
    segments: Vec<Segment>,
    answers: Vec<bool>,
}

/// The surfaces of a frame that may block rays, and how points and directions appear in it.
pub(super) struct Obstacles<'a, S> {
    pub bvh: &'a Bvh,
    /// Index of their frame.
    pub frame: u32,
    /// The boost from the world to the rest frame of the surfaces, and the index of the medium; `None` if they rest in the world.
    pub boost: Option<(&'a Boost<Rest, World>, f64)>,
    /// The positions of the points in that frame.
    pub places: S,
    /// For each point, the triangle of this frame that does not block it.
    pub own: Option<&'a [u32]>,
}

/// Positions of the points of a run in a rest frame.
pub(super) trait Places {
    /// Fills `from` with the positions of `points`, and `eyes` with the origins of the rays that hit them.
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
    /// Clears all queries.
    pub(super) fn clear(&mut self) {
        self.points.clear();
        self.d.clear();
        self.distance.clear();
        self.ends.clear();
        self.blocked.clear();
    }

    /// Replaces the queries by one from each of `points`, along `d`, with these distances.
    pub(super) fn fill(&mut self, points: &[u32], d: &Columns, distance: &[f64]) {
        self.clear();
        self.points.extend_from_slice(points);
        self.d.gather(d, points);
        let distances = points.iter().map(|k| distance[*k as usize]);
        self.distance.extend(distances);
    }

    /// Adds a query from point `point` along `d`.
    #[inline(always)]
    pub(super) fn push(&mut self, point: usize, d: DVec3, distance: f64) {
        self.points.push(point as u32);
        self.d.push(d);
        self.distance.push(distance);
    }

    /// The same for a ray that ends on triangle `end` of a frame, which does not block it. Either all queries have an end or none has.
    #[inline(always)]
    pub(super) fn push_to(&mut self, point: usize, d: DVec3, distance: f64, end: (u32, u32)) {
        self.push(point, d, distance);
        self.ends.push(end);
    }

    /// A box in the world around all query segments, in a medium of index `index`.
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

    /// Whether query `at` is blocked; never, if there were no queries.
    #[inline(always)]
    pub(super) fn is_blocked(&self, at: usize) -> bool {
        self.blocked.get(at) == Some(&true)
    }

    /// Tests the queries that are not blocked yet against `obstacles`.
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
        // The origins of the rays in the frame of the obstacles.
        obstacles
            .places
            .find(&self.open_points, &mut self.eyes, &mut self.from);
        // Directions are boosted without normalisation: the ray parameter stays metres of the world.
        if let Some((boost, index)) = obstacles.boost {
            dispatch(BoostDirections {
                boost,
                index,
                directions: &mut self.towards,
            });
        }
        // Where a ray can hit anything first: where it enters the ball about the obstacles, or never.
        self.starts.resize(self.open.len(), 0.0);
        dispatch(Starts {
            ball: Ball::about(obstacles.bvh),
            eyes: &self.eyes,
            from: &self.from,
            directions: &self.towards,
            starts: &mut self.starts,
        });

        // Queries that miss the ball stay open.
        self.segments.clear();
        let mut near = 0;
        for k in 0..self.open.len() {
            if self.starts[k].is_infinite() {
                continue;
            }
            let (query, point) = (self.open[k], self.open_points[k] as usize);
            // Compacted in place: near ≤ k.
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
        // Answers come in the order of the segments, which is now also that of `open`.
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

/// The loop that transforms directions from the world to a rest frame, per metre of the world.
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

/// Relative enlargement of balls: 10⁷ times the rounding error, 2⁻⁵³ each, of the few sums and products that compute them.
const ROUNDING: f64 = 1e-9;

impl Ball {
    /// The ball about `bvh`, with a margin for rounding.
    fn about(bvh: &Bvh) -> Ball {
        let (lo, hi) = bvh.bounds().unwrap_or((DVec3::NAN, DVec3::NAN));
        let size = lo.abs().max(hi.abs()).max_element();
        let radius = (hi - lo).length() * 0.5 + ROUNDING * size;
        Ball((lo + hi) * 0.5, radius * radius)
    }

    /// Whether a ray from `from` along `d` misses the ball: with p the origin relative to the centre, the nearest point is p − (p·d) d/d²,
    /// or p itself. False for NaN.
    #[inline(always)]
    fn is_missed(&self, from: DVec3, d: DVec3) -> bool {
        let Ball(centre, square) = *self;
        let p = from - centre;
        let (along, pp, dd) = (p.dot(d), p.length_squared(), d.length_squared());
        let beyond = pp - ROUNDING * pp - square;
        // The origin is outside and the ray leads away, or p² − (p·d)²/d² > R² at the nearest point.
        let leaves = (along >= 0.0) & (beyond > 0.0);
        let passes = beyond * dd > along * along;
        leaves | passes
    }
}

/// The loop that computes start parameters of rays; infinite for those that miss the obstacles.
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

/// Sets `blocked` to whether each of `segments` hits anything.
pub(super) fn any_hit(
    bvh: &Bvh,
    method: Traversal,
    segments: &[Segment],
    blocked: &mut Vec<bool>,
    counts: Option<&mut Counts>,
) {
    blocked.clear();
    blocked.resize(segments.len(), false);
    bvh.any_by(method, segments, blocked, counts);
}

/// The same for segments that all end at one point.
pub(super) fn any_to_point(
    bvh: &Bvh,
    method: Traversal,
    segments: Converging,
    blocked: &mut Vec<bool>,
    counts: Option<&mut Counts>,
) {
    blocked.clear();
    blocked.resize(segments.count(), false);
    bvh.any_to_point(method, segments, blocked, counts);
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

/// Sets `starts` to the start parameters of rays from `points` to one place of their rest frame.
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

/// How far from its surface a ray starts, relative to the coordinates: its point is rounded by about 2⁻⁵³ of them, to one side of the
/// surface or the other. On the edge of a triangle the ray could hit the neighbour right there; hits nearer than 2⁻⁴² of the coordinates
/// (10⁻¹² m in a scene of metres) are therefore ignored.
pub(super) const CLEARANCE: f64 = 1.0 / (1u64 << 42) as f64;

/// The parameter at which a ray along `direction` starts when it leaves a surface; `size` is given by [`shadow_size`].
#[inline(always)]
pub(super) fn shadow_start(size: f64, direction: DVec3) -> f64 {
    CLEARANCE * size / direction.length()
}

/// The distance at which a ray ends that leaves a surface for a point of a triangle, `distance` away and seen at this `cosine` to the
/// triangle's normal. The triangle itself does not block it, but a neighbour across an edge or another surface in the same plane could, if
/// its hit came out nearer than the end; so hits within e of the plane of the triangle do not count, e/cosine along the ray.
///
/// e bounds how far the ray passes from the point. Its direction is that from the [`lifted`] start, 2⁻⁴² of `size` beside its own. The place is
/// rounded by about 2⁻⁵³ of its coordinates, which are at most those of the start and the distance. And the direction is rounded by 2⁻⁵³ in
/// the world: the boost to the frame of the triangle multiplies that by up to γ, along a way that is up to γ(1 + β) times as long in the
/// world, together about `stretch` = 2γ² − 1, which is 1 at rest.
#[inline(always)]
pub(super) fn shadow_end([distance, cosine]: [f64; 2], [size, stretch]: [f64; 2]) -> f64 {
    distance - CLEARANCE * stretch * (size + distance) / cosine
}

/// `x`, lifted off its surface by as much as rays are that leave it: beyond any rounding error, so that no triangle of the surface is above
/// it.
#[inline(always)]
pub(super) fn lifted(size: f64, x: DVec3, normal: DVec3) -> DVec3 {
    x + normal * shadow_start(size, normal)
}

/// The magnitude of the coordinates that determine the rounding error of point `from`, seen from `camera`.
#[inline(always)]
pub(super) fn shadow_size(camera: DVec3, from: DVec3) -> f64 {
    camera.abs().max_element() + from.abs().max_element()
}
