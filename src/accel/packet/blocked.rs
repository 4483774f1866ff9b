//! What blocks segments: each is decided as a single ray would be, and all end when all are blocked.
//!
//! Segments that converge, as those to a lamp do, are traced from where they end: d turns round and s counts
//! from `s_max` back. The line is the same, and so are U, V, W and Δ but for the sign of all. A hit that is
//! certainly between the ends and certainly inside the triangle blocks; one that isn't certainly not is
//! left to f64.

use glam::DVec3;

use super::Workspace;
use super::beam::Beam;
use super::block::{Block, RAYS};
use super::bundle::{Bundle, Segments};
use super::facet::Facet;
use super::facets::Facets;
use super::nearest::vectors;
use super::simd::{Simd, Task};
use super::slabs::Slabs;
use super::walk::{Outcome, Quest, Waiting, descend};
use crate::accel::query::{Any, Probe};
use crate::accel::slab::power_of_two;
use crate::accel::triangle::{greater, lesser};
use crate::accel::{Bvh, Segment, Tally, Work};

/// What f64 and the frame leave unknown about τ of a hit is far below 2⁻²⁰ of it and 2⁻²⁴: single rays are off by
/// 2⁻⁴⁰ of a triangle's distance, which is below 2¹².
const RELATIVE: f64 = power_of_two(-20);
const ABSOLUTE: f64 = power_of_two(-24);
const MOST: f64 = f32::MAX as f64;

/// A block of segments to lead through the tree.
pub(super) struct Blocked<'a, T> {
    pub bvh: &'a Bvh,
    pub segments: &'a [Segment],
    pub blocked: &'a mut [bool],
    pub space: &'a mut Workspace,
    /// As many entries as can wait.
    pub stack: &'a mut [Waiting],
    pub tally: &'a mut T,
}

impl<T: Tally> Task for Blocked<'_, T> {
    #[inline(always)]
    fn run<K: Simd>(self, k: K) {
        let block = &mut self.space.block;
        self.space.outcome = Outcome::Apart;
        let rays = directed(self.segments, &block.order);
        let Some(view) = block.aim(k, &self.bvh.lattice, rays) else {
            return;
        };
        let Some(limit) = set_limits(block, rays) else {
            return;
        };
        self.space.outcome = Outcome::Met;
        let slabs = Slabs::new(k.children(), &Beam::new(&view));
        let mut quest = Shade {
            bvh: self.bvh,
            rays,
            blocked: self.blocked,
            open: u64::MAX >> (RAYS - block.count),
            limit,
            space: self.space,
            tally: self.tally,
        };
        descend(k, &self.bvh.wide, &slabs, &view, self.stack, &mut quest);
    }
}

/// The segments from where they are nearer to one another: their starts, or their ends.
#[inline(always)]
fn directed<'a>(segments: &'a [Segment], order: &[u32; RAYS]) -> Segments<'a> {
    let forward = Segments {
        segments,
        reversed: false,
    };
    let backward = Segments {
        segments,
        reversed: true,
    };
    let (mut starts, mut ends) = (Extent::NONE, Extent::NONE);
    for &ray in order {
        starts.add(forward.start(ray as usize));
        ends.add(backward.start(ray as usize));
    }
    let (starts, ends) = (starts.size(), ends.size());
    // Not where ends are at infinity, or not numbers.
    if ends >= 0.0 && ends < starts {
        backward
    } else {
        forward
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
}

/// Sets between which τ each ray of the block is of interest, a little more than between its ends, and
/// returns the greatest; none where ends are not numbers or before the start.
#[inline(always)]
fn set_limits(block: &mut Block, rays: Segments) -> Option<f32> {
    let (mut limit, mut broken) = (0.0, false);
    for (lane, &ray) in block.order.iter().enumerate() {
        let Segment { ray, s_max, .. } = &rays.segments[ray as usize];
        let (from, to) = if rays.reversed {
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

struct Shade<'a, T> {
    bvh: &'a Bvh,
    rays: Segments<'a>,
    blocked: &'a mut [bool],
    /// Rays that nothing blocks so far, as bits.
    open: u64,
    limit: f32,
    space: &'a mut Workspace,
    tally: &'a mut T,
}

impl<K: Simd, T: Tally> Quest<K> for Shade<'_, T> {
    const OWN: bool = true;
    const CERTIFIED: bool = true;
    type Tally = T;

    #[inline(always)]
    fn meet(&mut self, k: K, facets: &Facets, at: usize, slot: u32) -> bool {
        if facets.certain >> at & 1 != 0 {
            self.meet_facing(k, facets, at, slot);
        } else {
            self.meet_facing(k, facets, at, slot);
            self.meet_facing(k, &facets.turned(at), at, slot);
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

impl<T: Tally> Shade<'_, T> {
    #[inline(always)]
    fn meet_facing<K: Simd>(&mut self, k: K, facets: &Facets, at: usize, slot: u32) {
        let facet = Facet::of::<true>(k, facets, at);
        let mut first = 0;
        while first < RAYS {
            let open = (self.open >> first) as u32 & (u32::MAX >> (32 - K::LANES));
            if open != 0 {
                let d = vectors(k, &self.space.block.directions, first);
                let m = vectors(k, &self.space.block.moments, first);
                let weights = facet.weigh::<true>(&d, &m);
                let [u, v, w] = weights;
                let inside = k.not_negative(u, v, w) & open;
                if inside != 0 {
                    let sure = facet.is_inside(&weights);
                    self.stop(k, &facet, slot, first, [inside, sure], d);
                }
            }
            first += K::LANES;
        }
    }

    /// Of the rays in `candidates` those that the triangle blocks are so from now on; where `sure` says so they
    /// are inside it.
    #[inline(always)]
    fn stop<K: Simd>(
        &mut self,
        k: K,
        facet: &Facet<K>,
        slot: u32,
        first: usize,
        [candidates, sure]: [u32; 2],
        d: [K::F; 3],
    ) {
        let block = &self.space.block;
        let volume = facet.volume::<true>(&vectors(k, &block.offsets, first));
        let (slope, slack) = (facet.slope(&d), facet.slope_slack());
        let unsure = facet.volume_slack(volume);
        let least = k.sub(slope, slack);
        let near = k.div(k.sub(volume, unsure), k.add(slope, slack));
        let far = k.div(k.add(volume, unsure), least);
        let (from, to) = (k.load(&block.near[first..]), k.load(&block.far[first..]));
        let steep = k.le(k.splat(f32::MIN_POSITIVE), least);
        let beyond = k.le(to, near) | (k.le(far, from) & steep);
        let (shrunk, margin) = (4.0 * RELATIVE as f32, k.splat(4.0 * ABSOLUTE as f32));
        let from = k.mul_add(from, k.splat(1.0 + shrunk), margin);
        let to = k.mul_sub(to, k.splat(1.0 - shrunk), margin);
        let between = k.le(from, near) & k.le(far, to) & steep;
        let certain = if facet.is_certain() {
            sure & between
        } else {
            0
        };
        // Where σ isn't certain, neither is the sign of n·a − n·δ.
        let mut left = match facet.is_certain() {
            true => candidates & !beyond,
            false => candidates,
        };
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
        let ray = self.space.block.order[lane] as usize;
        let segment = &self.rays.segments[ray];
        if segment.skip == Some(tag.id()) {
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
        let Some(probe) = Probe::new(&segment.ray) else {
            return false;
        };
        let mut query = Any::new(self.bvh, &probe, segment, self.tally);
        query.meet(slot as usize)
    }
}
