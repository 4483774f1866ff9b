//! Occlusion of segments: each is decided like a single ray, and traversal ends when all are blocked.
//!
//! Segments that converge, like those to a lamp, are traced from their ends: d is reversed and s counts back from `s_max`. The line is the
//! same, and so are U, V, W and Δ except for the common sign. A hit that is certainly between the ends and certainly inside the triangle
//! blocks; one that f32 can neither confirm nor rule out is decided in f64.
//!
//! **(A1) Ends.** τ of a segment's ends is rounded to f32, and τ of a hit as computed for single rays has an error of 2⁻³⁶(1 + τ) ((K4) of
//! [`block`](super::block)): both far below r τ + a with r = 2⁻²⁰ and a = 2⁻²⁴. The ends in the block are moved outward by that amount, so
//! hits beyond them in f32 certainly don't block. Moved inward by 4 r τ + 4 a, they are certainly inside the true ends: hits between them
//! in f32 certainly do.
//!
//! **(A2) Common end.** Segments to a lamp or a pinhole end at one point, up to rounding. They are traced from it as rays that share their
//! origin, without moments, which halves the work per triangle. An end o + s d, computed with two roundings, has an error below 2⁻⁵²(|o|∞ +
//! |end|∞). With the extent of the ends, and the same error again for the midpoint between them, each line passes within ρ = extent +
//! 2⁻⁵¹(|o|∞ + |end|∞) of that point. Taking the line through the midpoint instead is equivalent to moving corners by ρ: it is added to η
//! of [`setup`](super::setup). It also changes τ by at most 4 ρ ((K2) of [`block`](super::block)) and boxes by ρ; if ρ is at most 2⁻⁴⁸(1 +
//! |end|∞) in tree space, both are far below (A1) and (B3) of [`beam`](super::beam). Otherwise rays have their own origins.

use glam::DVec3;

use super::beam::Beam;
use super::block::Block;
use super::ray_set::{Blockable, ColumnsToPoint, RAYS, Segments, SegmentsToPoint};
use super::setup::{LeafTriangles, PacketTriangle};
use super::simd::{Simd, Task, load_vectors};
use super::traverse::{BlockQuery, Outcome, StackEntry, traverse};
use crate::accel::bvh::View;
use crate::accel::float::{greater, lesser, norm1, power_of_two};
use crate::accel::rays::{Converging, Segment};
use crate::accel::single::{Blocked, Collector, ScaledRay};
use crate::accel::tally::{Counts, Work};
use crate::accel::tree_space::TreeSpace;
use crate::accel::vectors::{VectorLoop, dispatch};

/// r of (A1).
const RELATIVE: f64 = power_of_two(-20);
/// a of (A1).
const ABSOLUTE: f64 = power_of_two(-24);
const MOST: f64 = f32::MAX as f64;

/// Finds which of the segments in a block are blocked.
pub(super) struct AnyHits<'a, S> {
    pub bvh: View<'a>,
    pub segments: S,
    pub blocked: &'a mut [bool],
    pub block: &'a mut Block,
    /// Space for all entries that can be pending.
    pub stack: &'a mut [StackEntry],
    /// The most leaves and triangles to test.
    pub most: usize,
    pub tally: &'a mut Counts,
}

/// Segments, in any storage.
pub(super) trait SegmentSet: Copy {
    /// Segment `at`.
    fn segment(self, at: usize) -> Segment;

    /// Traces the segments of a block.
    fn trace<K: Simd>(k: K, task: AnyHits<Self>) -> Outcome;
}

impl SegmentSet for &[Segment] {
    #[inline(always)]
    fn segment(self, at: usize) -> Segment {
        self[at]
    }

    #[inline(always)]
    fn trace<K: Simd>(k: K, task: AnyHits<Self>) -> Outcome {
        let segments = task.segments;
        match Way::of(segments, &task.block.order, &task.bvh.tree.space) {
            Way::ToPoint(rays) => task.trace(k, rays),
            Way::Apart(rays) => task.trace(k, rays),
        }
    }
}

impl SegmentSet for ColumnsToPoint<'_> {
    #[inline(always)]
    fn segment(self, at: usize) -> Segment {
        self.segments.segment(at)
    }

    #[inline(always)]
    fn trace<K: Simd>(k: K, task: AnyHits<Self>) -> Outcome {
        let rays = task.segments;
        task.trace(k, rays)
    }
}

impl<S: SegmentSet> Task for AnyHits<'_, S> {
    type Output = Outcome;

    #[inline(always)]
    fn run<K: Simd>(self, k: K) -> Outcome {
        S::trace(k, self)
    }
}

impl<S> AnyHits<'_, S> {
    /// Traces the segments as `rays`.
    #[inline(always)]
    fn trace<K: Simd, R: Blockable>(self, k: K, rays: R) -> Outcome {
        let (bvh, block) = (self.bvh, self.block);
        let Some(bounds) = block.load(k, bvh, rays) else {
            return Outcome::Incoherent;
        };
        let Some(limit) = set_limits(k, block, rays) else {
            return Outcome::Incoherent;
        };
        let beam = Beam::new(k.children(), &bounds);
        let mut query = AnyQuery {
            bvh,
            rays,
            blocked: self.blocked,
            // Lanes without a ray are closed from the start.
            open: u64::MAX >> (RAYS - block.count),
            limit,
            block,
            tally: self.tally,
        };
        let (tree, stack, most) = (&bvh.tree.wide, self.stack, self.most);
        match traverse(k, tree, &beam, &bounds, stack, most, &mut query) {
            true => Outcome::Traced,
            false => Outcome::Fine,
        }
    }
}

impl<'a> ColumnsToPoint<'a> {
    /// Segments with a known common end; `None` if they are too far away to be traced from there.
    pub fn new(segments: Converging<'a>, space: &TreeSpace) -> Option<Self> {
        let mut starts = Extent::NONE;
        dispatch(Extents {
            from: segments.from,
            extent: &mut starts,
        });
        // ρ of (A2), metres: the ends coincide, so their extent is 0.
        let end = segments.end;
        let error = power_of_two(-51) * (starts.greatest() + end.abs().max_element());
        let size = 1.0 + space.map(end).abs().max_element();
        // Written so that NaN takes this branch, too.
        (error * space.scale <= power_of_two(-48) * size).then(|| ColumnsToPoint {
            segments,
            error,
            farthest: starts.farthest_from(end),
        })
    }
}

/// The bounding box of many points.
struct Extents<'a> {
    from: [&'a [f64]; 3],
    extent: &'a mut Extent,
}

impl VectorLoop for Extents<'_> {
    #[inline(always)]
    fn run(self) {
        const LANES: usize = 8;
        let mut axis = 0;
        while axis < 3 {
            let (mut lo, mut hi) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
            let eights = self.from[axis].chunks_exact(LANES);
            // The remainder after the last multiple of eight initialises the extents, each number in its own lane.
            for (lane, x) in eights.remainder().iter().enumerate() {
                (lo[lane], hi[lane]) = (*x, *x);
            }
            for eight in eights {
                for lane in 0..LANES {
                    lo[lane] = lesser(eight[lane], lo[lane]);
                    hi[lane] = greater(eight[lane], hi[lane]);
                }
            }
            let (mut least, mut most) = (lo[0], hi[0]);
            for lane in 1..LANES {
                least = lesser(lo[lane], least);
                most = greater(hi[lane], most);
            }
            self.extent.lo[axis] = least;
            self.extent.hi[axis] = most;
            axis += 1;
        }
    }
}

/// The direction in which the segments of a block are traced.
enum Way<'a> {
    /// From the start of each, or from its end.
    Apart(Segments<'a>),
    /// From the point at which all end.
    ToPoint(SegmentsToPoint<'a>),
}

impl<'a> Way<'a> {
    /// Traces from where the segments in `order` are closer together: their starts, or their ends.
    #[inline(always)]
    fn of(segments: &'a [Segment], order: &[u32; RAYS], space: &TreeSpace) -> Way<'a> {
        let apart = |reversed| Way::Apart(Segments { segments, reversed });
        let (mut starts, mut ends) = (Extent::NONE, Extent::NONE);
        // NaN if any end is infinite or NaN: ∞·0 and NaN·0.
        let mut broken = DVec3::ZERO;
        for &ray in order {
            let Segment { ray, s_max, .. } = &segments[ray as usize];
            let end = ray.origin + ray.direction * *s_max;
            starts.add(ray.origin);
            ends.add(end);
            broken += end * 0.0;
        }
        let (spread, extent) = (starts.size(), ends.size());
        // Written so that NaN takes this branch, too: tracing from the starts.
        if !(extent < spread && broken == DVec3::ZERO) {
            return apart(false);
        }
        // ρ of (A2), metres.
        let reach = starts.greatest() + ends.greatest();
        let error = extent + power_of_two(-51) * reach;
        let end = ends.lo * 0.5 + ends.hi * 0.5;
        let size = 1.0 + space.map(end).abs().max_element();
        // The condition in (A2).
        match error * space.scale <= power_of_two(-48) * size {
            true => Way::ToPoint(SegmentsToPoint {
                segments,
                end,
                error,
                farthest: starts.farthest_from(end),
            }),
            false => apart(true),
        }
    }
}

/// The bounding box of points.
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

    /// The largest |x|∞ of the points.
    #[inline(always)]
    fn greatest(&self) -> f64 {
        self.lo.abs().max(self.hi.abs()).max_element()
    }

    /// An upper bound on the distance of its points from `point`, summed over the axes.
    #[inline(always)]
    fn farthest_from(&self, point: DVec3) -> f64 {
        norm1((self.lo - point).abs().max((self.hi - point).abs()))
    }
}

/// Sets the range of τ that matters for each ray of the block, slightly wider than between its ends (A1), and returns the largest; `None`
/// if ends are NaN or before the start.
#[inline(always)]
fn set_limits<K: Simd, R: Blockable>(k: K, block: &mut Block, rays: R) -> Option<f32> {
    let [s_min, s_max] = rays.ends(&block.order, block.in_fours);
    let (reversed, tau_from_s) = (rays.is_reversed(), block.tau_from_s);
    let mut broken = false;
    for lane in 0..RAYS {
        let (s_min, s_max) = (s_min[lane], s_max[lane]);
        let (from, to) = if reversed {
            (0.0, s_max - s_min)
        } else {
            (s_min, s_max)
        };
        // Written so that NaN takes this branch, too.
        let is_usual = (0.0..f64::INFINITY).contains(&s_min) & (s_max > f64::NEG_INFINITY);
        broken |= !is_usual;
        // Within the range of f32: nothing is hit that far away (K2).
        let from = lesser(from * tau_from_s, MOST);
        let to = greater(lesser(to * tau_from_s, MOST), -MOST);
        block.near[lane] = (from * (1.0 - RELATIVE) - ABSOLUTE) as f32;
        let far = lesser(to + to.abs() * RELATIVE + ABSOLUTE, MOST);
        block.far[lane] = far as f32;
    }
    let mut limit = k.splat(0.0);
    for first in (0..RAYS).step_by(K::LANES) {
        limit = k.max(limit, k.load(&block.far[first..]));
    }
    (!broken).then(|| k.greatest(limit))
}

struct AnyQuery<'a, R> {
    bvh: View<'a>,
    rays: R,
    blocked: &'a mut [bool],
    /// Rays that are not blocked so far, as bits.
    open: u64,
    limit: f32,
    block: &'a mut Block,
    tally: &'a mut Counts,
}

impl<K: Simd, R: Blockable> BlockQuery<K> for AnyQuery<'_, R> {
    type Rays = R;
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
        // Boxes are entered at 0 or later, so a negative limit ends the traversal.
        if self.open == 0 { -1.0 } else { self.limit }
    }

    #[inline(always)]
    fn tally(&mut self) -> &mut Counts {
        self.tally
    }
}

impl<R: Blockable> AnyQuery<'_, R> {
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
                // Inside, or too close to an edge to decide in f32: none of U + B, V + B and W + B is negative.
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

    /// Tests triangle `at` with a separate σ for each ray, from the sign of n·a − n·δ; f64 decides if that is within its bound.
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
        // For all rays or none: whether the visible side exists, for σ and for its opposite.
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
                    // Rays that certainly start on one side, with the edge functions of that side.
                    let inside_of_own = (inside & ahead) | (other_inside & behind);
                    if inside_of_own != 0 {
                        let edge_functions = [
                            k.select(behind, other[0], u),
                            k.select(behind, other[1], v),
                            k.select(behind, other[2], w),
                        ];
                        // If n·a − n·δ is negative, Δ changes sign too, since their quotient does not.
                        let delta = k.flip(triangle.determinant(&d), volume);
                        let numbers = (edge_functions, delta, k.abs(volume));
                        self.block_rays(k, &triangle, slot, (first, inside_of_own), numbers);
                    }
                    // Rays that may start in its plane, except those that leave it.
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

    /// Rays from `first` on that are not blocked so far, as bits.
    #[inline(always)]
    fn open_from<K: Simd>(&self, first: usize) -> u32 {
        (self.open >> first) as u32 & (u32::MAX >> (32 - K::LANES))
    }

    /// Closes the candidate rays that the triangle blocks; candidates may be inside it and certainly start on the side of their σ.
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
        let near = k.quotient(k.sub(volume, unsure), k.add(delta, slack));
        let far = k.quotient(k.add(volume, unsure), least);
        // Certainly beyond the ends, and certainly between them: (A1).
        let from = k.load(&self.block.near[first..]);
        let to = k.load(&self.block.far[first..]);
        // If Δ − B is not positive, `far` is not a bound.
        let steep = k.le(k.splat(f32::MIN_POSITIVE), least);
        let beyond = k.le(to, near) | (k.le(far, from) & steep);
        // Inward by 4 r τ + 4 a: (A1).
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

    /// Whether the triangle in `slot` blocks ray `lane`; if `certain`, it does unless the ray leaves that triangle.
    #[inline(always)]
    fn decide(&mut self, lane: usize, slot: u32, certain: bool) {
        let tag = self.bvh.tags[slot as usize];
        let ray = self.block.order[lane] as usize;
        if self.rays.passes(ray, tag.id()) {
            return;
        }
        if certain || self.is_blocked_by(&self.rays.segment(ray), slot) {
            self.blocked[ray] = true;
            self.open &= !(1 << lane);
        }
    }

    /// The decision as for single rays.
    #[cold]
    #[inline(never)]
    fn is_blocked_by(&mut self, segment: &Segment, slot: u32) -> bool {
        self.tally.add(Work::Doubts, 1);
        let Some(ray) = ScaledRay::new(&segment.ray) else {
            return false;
        };
        let mut blocked = Blocked::none(segment, ray.per_unit);
        blocked.test(self.bvh.bvh, &ray.line, slot, self.tally)
    }
}

#[cfg(test)]
mod tests;
