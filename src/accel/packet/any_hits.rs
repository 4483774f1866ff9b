//! What blocks segments: each is decided as a single ray would be, and all end when all are blocked.
//!
//! Segments that converge, as those to a lamp do, are traced from where they end: d turns round and s counts
//! from `s_max` back. The line is the same, and so are U, V, W and Δ but for the sign of all. A hit that is
//! certainly between the ends and certainly inside the triangle blocks; one that isn't certainly not is
//! left to f64.
//!
//! **(A1) Ends.** τ of a segment's ends is rounded to f32, and τ of a hit as single rays compute it is off by
//! 2⁻³⁶(1 + τ) ((K4) of [`block`](super::block)): both far below r τ + a with r = 2⁻²⁰ and a = 2⁻²⁴. The ends in the block
//! are moved outward by that, so that what is beyond them in f32 certainly doesn't block. Moved inward by 4 r τ + 4 a,
//! they are certainly inside the true ends: what is between them in f32 certainly does.
//!
//! **(A2) One end.** Segments to a lamp or a pinhole end in one point, but for roundings. They are traced from it as rays that share
//! their origin, without moments, which halves the work per triangle. An end o + s d, computed with two roundings, is off by less than
//! 2⁻⁵²(|o|∞ + |end|∞). With the extent of the ends and as much again for the middle between them, each line passes within
//! ρ = extent + 2⁻⁵¹(|o|∞ + |end|∞) of that. To take it through the middle is to move corners by ρ: it is added to η of
//! [`setup`](super::setup). It also moves τ by 4 ρ at most ((K2) of [`block`](super::block)) and boxes by ρ; where it is no more than
//! 2⁻⁴⁸(1 + |end|∞) in tree space, both are far below (A1) and (B3) of [`beam`](super::beam). Otherwise rays have their own origins.

use std::marker::PhantomData;

use glam::DVec3;

use super::beam::Beam;
use super::block::{Block, RAYS};
use super::ray_set::{RaySet, Segments, SegmentsToPoint};
use super::setup::{LeafTriangles, PacketTriangle};
use super::simd::{Simd, Task, load_vectors};
use super::traverse::{BlockQuery, Outcome, StackEntry, traverse};
use crate::accel::bvh::Bvh;
use crate::accel::float::{greater, lesser, norm1, power_of_two};
use crate::accel::rays::Segment;
use crate::accel::single::{AnyHit, ScaledRay};
use crate::accel::tally::{Tally, Work};
use crate::accel::tree_space::TreeSpace;

/// r of (A1).
const RELATIVE: f64 = power_of_two(-20);
/// a of (A1).
const ABSOLUTE: f64 = power_of_two(-24);
const MOST: f64 = f32::MAX as f64;

/// Finds which of the segments in a block's order are blocked.
pub(super) struct AnyHits<'a, T> {
    pub bvh: &'a Bvh,
    pub segments: &'a [Segment],
    pub blocked: &'a mut [bool],
    pub block: &'a mut Block,
    /// As many entries as can wait.
    pub stack: &'a mut [StackEntry],
    pub tally: &'a mut T,
}

impl<T: Tally> Task for AnyHits<'_, T> {
    type Output = Outcome;

    #[inline(always)]
    fn run<K: Simd>(self, k: K) -> Outcome {
        match Way::of(self.segments, &self.block.order, &self.bvh.space) {
            Way::ToPoint(rays) => self.trace(k, rays),
            Way::FromStart => self.trace_from(k, false),
            Way::FromEnd => self.trace_from(k, true),
        }
    }
}

impl<T: Tally> AnyHits<'_, T> {
    #[inline(always)]
    fn trace_from<K: Simd>(self, k: K, reversed: bool) -> Outcome {
        let segments = self.segments;
        self.trace(k, Segments { segments, reversed })
    }

    /// Traces the segments as `rays`.
    #[inline(always)]
    fn trace<K: Simd, R: RaySet>(self, k: K, rays: R) -> Outcome {
        let (bvh, block) = (self.bvh, self.block);
        let Some(bounds) = block.load(k, bvh, rays) else {
            return Outcome::Incoherent;
        };
        let Some(limit) = set_limits(block, self.segments, rays.is_reversed()) else {
            return Outcome::Incoherent;
        };
        let beam = Beam::new(k.children(), &bounds);
        let mut query = AnyQuery {
            bvh,
            segments: self.segments,
            rays: PhantomData::<R>,
            blocked: self.blocked,
            open: u64::MAX >> (RAYS - block.count),
            limit,
            block,
            tally: self.tally,
        };
        traverse(k, &bvh.wide, &beam, &bounds, self.stack, &mut query);
        Outcome::Traced
    }
}

/// How the segments of a block are traced.
enum Way<'a> {
    FromStart,
    FromEnd,
    /// From the point in which all end.
    ToPoint(SegmentsToPoint<'a>),
}

impl<'a> Way<'a> {
    /// From where the segments in `order` are nearer to one another: their starts, or their ends.
    #[inline(always)]
    fn of(segments: &'a [Segment], order: &[u32; RAYS], space: &TreeSpace) -> Way<'a> {
        let (mut starts, mut ends) = (Extent::NONE, Extent::NONE);
        // NaN, if any end is infinite or not a number: ∞·0 and NaN·0.
        let mut broken = DVec3::ZERO;
        for &ray in order {
            let Segment { ray, s_max, .. } = &segments[ray as usize];
            let end = ray.origin + ray.direction * *s_max;
            starts.add(ray.origin);
            ends.add(end);
            broken += end * 0.0;
        }
        let (apart, extent) = (starts.size(), ends.size());
        if !(extent < apart && broken == DVec3::ZERO) {
            return Way::FromStart;
        }
        // ρ of (A2), metres.
        let reach = starts.greatest() + ends.greatest();
        let error = extent + power_of_two(-51) * reach;
        let end = ends.lo * 0.5 + ends.hi * 0.5;
        let size = 1.0 + space.map(end).abs().max_element();
        match error * space.scale <= power_of_two(-48) * size {
            true => Way::ToPoint(SegmentsToPoint {
                segments,
                end,
                error,
                farthest: starts.farthest_from(end),
            }),
            false => Way::FromEnd,
        }
    }
}

/// A box of points.
struct Extent {
    lo: DVec3,
    hi: DVec3,
}

impl Extent {
    const NONE: Extent = Extent {
        lo: DVec3::INFINITY,
        hi: DVec3::NEG_INFINITY,
    };

    #[inline(always)]
    fn add(&mut self, point: DVec3) {
        self.lo = self.lo.min(point);
        self.hi = self.hi.max(point);
    }

    #[inline(always)]
    fn size(&self) -> f64 {
        (self.hi - self.lo).max_element()
    }

    /// |x|∞ of its points at most.
    #[inline(always)]
    fn greatest(&self) -> f64 {
        self.lo.abs().max(self.hi.abs()).max_element()
    }

    /// How far any of its points is from `point` at most, in sum over the axes.
    #[inline(always)]
    fn farthest_from(&self, point: DVec3) -> f64 {
        norm1((self.lo - point).abs().max((self.hi - point).abs()))
    }
}

/// Sets between which τ each ray of the block is of interest, a little more than between its ends (A1), and
/// returns the greatest; none where ends are not numbers or before the start.
#[inline(always)]
fn set_limits(block: &mut Block, segments: &[Segment], reversed: bool) -> Option<f32> {
    let (mut limit, mut broken) = (0.0, false);
    for (lane, &ray) in block.order.iter().enumerate() {
        let Segment { ray, s_max, .. } = &segments[ray as usize];
        let (from, to) = if reversed {
            (0.0, s_max - ray.s_min)
        } else {
            (ray.s_min, *s_max)
        };
        // In this form also for NaN.
        let is_usual = ray.s_min >= 0.0 && ray.s_min < f64::INFINITY && *s_max > f64::NEG_INFINITY;
        broken |= !is_usual;
        let from = lesser(from * block.tau_from_s, MOST);
        let to = greater(lesser(to * block.tau_from_s, MOST), -MOST);
        block.near[lane] = (from * (1.0 - RELATIVE) - ABSOLUTE) as f32;
        let far = lesser(to + to.abs() * RELATIVE + ABSOLUTE, MOST);
        block.far[lane] = far as f32;
        limit = greater(limit, far);
    }
    (!broken).then_some(limit as f32)
}

struct AnyQuery<'a, R, T> {
    bvh: &'a Bvh,
    segments: &'a [Segment],
    /// As what they are traced.
    rays: PhantomData<R>,
    blocked: &'a mut [bool],
    /// Rays that nothing blocks so far, as bits.
    open: u64,
    limit: f32,
    block: &'a mut Block,
    tally: &'a mut T,
}

impl<K: Simd, R: RaySet, T: Tally> BlockQuery<K> for AnyQuery<'_, R, T> {
    type Rays = R;
    type Tally = T;
    const CERTIFIED: bool = true;

    #[inline(always)]
    fn intersect(&mut self, k: K, triangles: &LeafTriangles, at: usize, slot: u32) -> bool {
        match triangles.certain >> at & 1 != 0 {
            true => self.intersect_certain(k, triangles, at, slot),
            false => self.intersect_either_side(k, triangles, at, slot),
        }
        self.open == 0
    }

    #[inline(always)]
    fn limit(&self, _: K) -> f32 {
        if self.open == 0 { -1.0 } else { self.limit }
    }

    #[inline(always)]
    fn tally(&mut self) -> &mut T {
        self.tally
    }
}

impl<R: RaySet, T: Tally> AnyQuery<'_, R, T> {
    /// Tests triangle `at`, whose σ is certain.
    #[inline(always)]
    fn intersect_certain<K: Simd>(
        &mut self,
        k: K,
        triangles: &LeafTriangles,
        at: usize,
        slot: u32,
    ) {
        let triangle = PacketTriangle::new::<R>(k, triangles, at);
        let mut first = 0;
        while first < RAYS {
            let open = self.open_from::<K>(first);
            if open != 0 {
                let d = load_vectors(k, &self.block.directions, first);
                let edge_functions = triangle.edge_functions::<R>(&d, self.block, first);
                let [u, v, w] = edge_functions;
                let inside = k.not_negative(u, v, w) & open;
                if inside != 0 {
                    let volume = triangle.volume::<R>(self.block, first);
                    let numbers = (edge_functions, triangle.determinant(&d), volume);
                    self.block_rays(k, &triangle, slot, (first, inside), numbers);
                }
            }
            first += K::LANES;
        }
    }

    /// Tests triangle `at` with a σ of each ray, as its n·a − n·δ says; f64 decides where that is within its bound.
    #[inline(always)]
    fn intersect_either_side<K: Simd>(
        &mut self,
        k: K,
        triangles: &LeafTriangles,
        at: usize,
        slot: u32,
    ) {
        let triangle = PacketTriangle::new::<R>(k, triangles, at);
        let (tag, front) = (self.bvh.tags[slot as usize], triangles.front >> at & 1 != 0);
        let shown = if tag.shows(front) { u32::MAX } else { 0 };
        let other_shown = if tag.shows(!front) { u32::MAX } else { 0 };
        let mut first = 0;
        while first < RAYS {
            let open = self.open_from::<K>(first);
            if open != 0 {
                let d = load_vectors(k, &self.block.directions, first);
                let seen = triangle.edge_functions::<R>(&d, self.block, first);
                let other = triangle.of_other_side(&seen);
                let [u, v, w] = seen;
                let inside = k.not_negative(u, v, w) & shown & open;
                let other_inside =
                    k.not_negative(other[0], other[1], other[2]) & other_shown & open;
                if inside | other_inside != 0 {
                    let volume = triangle.volume::<R>(self.block, first);
                    let unsure = triangle.volume_slack(volume);
                    let ahead = k.le(unsure, volume);
                    let behind = k.le(unsure, k.sub(k.splat(0.0), volume));
                    let inside_of_own = (inside & ahead) | (other_inside & behind);
                    if inside_of_own != 0 {
                        let edge_functions = [
                            k.select(behind, other[0], u),
                            k.select(behind, other[1], v),
                            k.select(behind, other[2], w),
                        ];
                        let delta = k.flip(triangle.determinant(&d), volume);
                        let numbers = (edge_functions, delta, k.abs(volume));
                        self.block_rays(k, &triangle, slot, (first, inside_of_own), numbers);
                    }
                    // Those that may start in its plane, but for those that leave it.
                    let mut doubtful = (inside | other_inside) & !(ahead | behind);
                    if doubtful != 0 {
                        doubtful &= !self.block.leaving::<K>(first, tag.id());
                    }
                    while doubtful != 0 {
                        let lane = doubtful.trailing_zeros() as usize;
                        doubtful &= doubtful - 1;
                        self.decide(first + lane, slot, false);
                    }
                }
            }
            first += K::LANES;
        }
    }

    /// Rays from `first` on that nothing blocks so far, as bits.
    #[inline(always)]
    fn open_from<K: Simd>(&self, first: usize) -> u32 {
        (self.open >> first) as u32 & (u32::MAX >> (32 - K::LANES))
    }

    /// Closes the rays of `candidates` that the triangle blocks, which may be inside it and certainly start on the side of their σ.
    #[inline(always)]
    fn block_rays<K: Simd>(
        &mut self,
        k: K,
        triangle: &PacketTriangle<K>,
        slot: u32,
        (first, candidates): (usize, u32),
        (edge_functions, delta, volume): ([K::F; 3], K::F, K::F),
    ) {
        // Bounds of τ: (E6) of `setup`.
        let slack = triangle.determinant_slack();
        let unsure = triangle.volume_slack(volume);
        let least = k.sub(delta, slack);
        let near = k.div(k.sub(volume, unsure), k.add(delta, slack));
        let far = k.div(k.add(volume, unsure), least);
        // Certainly beyond the ends, and certainly between them: (A1).
        let from = k.load(&self.block.near[first..]);
        let to = k.load(&self.block.far[first..]);
        let steep = k.le(k.splat(f32::MIN_POSITIVE), least);
        let beyond = k.le(to, near) | (k.le(far, from) & steep);
        let (shrunk, margin) = (4.0 * RELATIVE as f32, k.splat(4.0 * ABSOLUTE as f32));
        let from = k.mul_add(from, k.splat(1.0 + shrunk), margin);
        let to = k.mul_sub(to, k.splat(1.0 - shrunk), margin);
        let between = k.le(from, near) & k.le(far, to) & steep;
        let certain = triangle.is_certainly_inside(&edge_functions) & between;
        let mut left = candidates & !beyond;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            self.decide(first + lane, slot, certain >> lane & 1 != 0);
        }
    }

    /// Whether the triangle in `slot` blocks ray `lane`, which it does where that is `certain` unless the
    /// ray leaves it.
    #[inline(always)]
    fn decide(&mut self, lane: usize, slot: u32, certain: bool) {
        let tag = self.bvh.tags[slot as usize];
        let ray = self.block.order[lane] as usize;
        let segment = &self.segments[ray];
        if [segment.skip, segment.end].contains(&Some(tag.id())) {
            return;
        }
        if certain || self.is_blocked_by(segment, slot) {
            self.blocked[ray] = true;
            self.open &= !(1 << lane);
        }
    }

    /// As single rays decide it.
    #[cold]
    #[inline(never)]
    fn is_blocked_by(&mut self, segment: &Segment, slot: u32) -> bool {
        self.tally.add(Work::Doubts, 1);
        let Some(ray) = ScaledRay::new(&segment.ray) else {
            return false;
        };
        let mut query = AnyHit::new(self.bvh, &ray, segment, self.tally);
        query.test(slot as usize)
    }
}
