//! Single rays: the reference for packets, and the fallback for rays that packets leave open.

use glam::DVec3;

use super::bvh::{Bvh, View};
use super::float::{exponent, power_of_two};
use super::node::{NodeRef, Tag};
use super::rays::{Hit, NO_SLOT, Origins, Ray, Segment};
use super::slab::SlabRay;
use super::tally::{Counts, Work};
use super::traverse::{Query, StackEntry, USUAL_DEPTH, traverse};
use super::triangle::{Crossing, Line};

impl Bvh {
    /// The first hit with `ray.s_min` < s < `s_max`.
    pub fn closest(&self, ray: &Ray, s_max: f64) -> Option<Hit> {
        let ray = ScaledRay::new(ray)?;
        let mut nearest: Option<Hit> = None;
        for tree in self.trees() {
            // Including hits at the same distance: among equals the smaller id wins, whichever tree it is in.
            let s_max = nearest.map_or(s_max, |hit| hit.up_to().s);
            let hit = tree.with_stack(|stack| {
                tree.closest_of(&ray, s_max, NO_SLOT, stack, &mut Counts::default())
            });
            nearest = Hit::first(nearest, hit);
        }
        nearest
    }

    /// Whether there is a hit with `ray.s_min` < s < `s_max` on any triangle except `skip`.
    pub fn any(&self, ray: &Ray, s_max: f64, skip: Option<u32>) -> bool {
        let segment = Segment {
            ray: *ray,
            s_max,
            skip,
            end: None,
        };
        self.trees().any(|tree| {
            tree.with_stack(|stack| tree.is_blocked(&segment, stack, &mut Counts::default()))
        })
    }
}

/// Adds a ray to the list of those whose hits were replaced, if one is wanted.
#[inline(always)]
pub(super) fn note(replaced: &mut Option<&mut Vec<usize>>, ray: usize) {
    if let Some(list) = replaced {
        list.push(ray);
    }
}

impl View<'_> {
    /// [`Bvh::closest_by`] for `rays`, one by one.
    pub(super) fn closest_singly(
        self,
        rays: impl Iterator<Item = usize>,
        from: Origins,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        tally: &mut Counts,
        mut replaced: Option<&mut Vec<usize>>,
    ) {
        self.with_stack(|stack| {
            for i in rays {
                tally.add(Work::Singles, 1);
                let ray = Ray {
                    origin: from.of(i),
                    direction: directions[i],
                    s_min: 0.0,
                };
                let entry = &mut hits[i];
                // A known hit, in another tree, limits the ray: only nearer ones replace it.
                let s_max = entry.as_ref().map_or(f64::INFINITY, |hit| hit.s);
                let ray = ScaledRay::new(&ray);
                let left = from.left(i);
                let closest = |ray: ScaledRay| self.closest_of(&ray, s_max, left, stack, tally);
                if let Some(hit) = ray.and_then(closest) {
                    *entry = Some(hit);
                    note(&mut replaced, i);
                }
            }
        })
    }

    /// [`Bvh::any_by`] for these segments, one by one.
    pub(super) fn any_singly<'a>(
        self,
        segments: impl Iterator<Item = (&'a Segment, &'a mut bool)>,
        tally: &mut Counts,
    ) {
        self.with_stack(|stack| {
            for (segment, blocked) in segments {
                tally.add(Work::Singles, 1);
                *blocked = self.is_blocked(segment, stack, tally);
            }
        })
    }

    fn is_blocked(self, segment: &Segment, stack: &mut [StackEntry], tally: &mut Counts) -> bool {
        let Some(ray) = ScaledRay::new(&segment.ray) else {
            return false;
        };
        let blocked = Blocked::none(segment, ray.per_unit);
        self.trace(&ray, stack, blocked, tally).found
    }

    #[inline(always)]
    fn closest_of(
        self,
        ray: &ScaledRay,
        s_max: f64,
        left: u32,
        stack: &mut [StackEntry],
        tally: &mut Counts,
    ) -> Option<Hit> {
        let nearest = Nearest::none([ray.s_min, s_max * ray.per_unit], left);
        self.trace(ray, stack, nearest, tally)
            .hit(self.bvh, ray.unit)
    }

    #[inline(always)]
    fn trace<C: Collector>(
        self,
        ray: &ScaledRay,
        stack: &mut [StackEntry],
        collector: C,
        tally: &mut Counts,
    ) -> C {
        let mut query = LineQuery {
            bvh: self.bvh,
            line: &ray.line,
            collector,
        };
        if !self.is_empty()
            && let Some(slabs) = SlabRay::new(&self.tree.space, &ray.line, ray.s_min)
        {
            traverse(&self.tree.nodes, &slabs, stack, &mut query, tally);
        }
        query.collector
    }

    /// A stack as deep as the tree; on the heap only for unusually deep trees.
    #[inline(always)]
    fn with_stack<T>(self, run: impl FnOnce(&mut [StackEntry]) -> T) -> T {
        const NONE: StackEntry = (NodeRef::ROOT, 0.0);
        if self.tree.depth <= USUAL_DEPTH {
            run(&mut [NONE; USUAL_DEPTH])
        } else {
            run(&mut vec![NONE; self.tree.depth])
        }
    }
}

/// A ray whose direction has |d|∞ in [1, 2): s of the ray is `unit` times s of the line.
pub(super) struct ScaledRay {
    pub line: Line,
    pub s_min: f64,
    pub unit: f64,
    /// 1 / unit, exactly.
    pub per_unit: f64,
}

impl ScaledRay {
    /// `None` for NaN, for a direction of length 0 and for values outside the module's limits.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Option<ScaledRay> {
        let size = ray.direction.abs().max_element();
        let far = ray.origin.abs().max_element();
        // 0 times a number is 0, times NaN or ∞ it is NaN.
        let finite = (ray.direction * 0.0 + ray.origin * 0.0) == DVec3::ZERO;
        // The limits in the documentation of `accel`.
        let usual = power_of_two(-500)..power_of_two(500);
        if !finite || !usual.contains(&size) || far > Bvh::MAX_COORDINATE {
            return None;
        }
        // Powers of two: s, u, v and all decisions are the same as for the given direction.
        let unit = power_of_two(-exponent(size));
        let per_unit = power_of_two(exponent(size));
        let line = Line {
            origin: ray.origin,
            direction: ray.direction * unit,
        };
        Some(ScaledRay {
            line,
            s_min: ray.s_min * per_unit,
            unit,
            per_unit,
        })
    }

    /// The hit of the ray as given.
    #[inline(always)]
    pub fn hit(&self, bvh: &Bvh, crossing: &Crossing, slot: u32) -> Hit {
        Hit {
            s: crossing.s * self.unit,
            u: crossing.u,
            v: crossing.v,
            triangle: bvh.tags[slot as usize].id(),
            slot,
            front: crossing.front,
        }
    }

    /// s of the line at its crossing with the triangle in `slot`, if it is nearer than `rival`, the crossing of another.
    pub fn nearer(
        &self,
        bvh: &Bvh,
        rival: Option<(Crossing, u32)>,
        slot: u32,
        left: u32,
        tally: &mut Counts,
    ) -> Option<f64> {
        // A separate query, so that the two are compared by the rule of the whole tree.
        let mut nearest = Nearest::none([self.s_min, f64::INFINITY], left);
        if let Some((crossing, rival)) = rival {
            nearest.set(rival, crossing);
        }
        nearest.test(bvh, &self.line, slot, tally);
        (nearest.slot == slot).then_some(nearest.s)
    }
}

/// The nearest hit so far of a line.
#[derive(Clone, Copy)]
pub(super) struct Nearest {
    s_min: f64,
    /// The parameter of the hit, or the one up to which hits count.
    s: f64,
    /// The slot of the triangle that the ray leaves.
    left: u32,
    /// The slot of the hit, or [`NO_SLOT`].
    slot: u32,
    u: f64,
    v: f64,
    front: bool,
}

impl Nearest {
    /// No hit yet; hits count from `s_min` to `s_max` of the line, with any triangle except the one in slot `left`.
    #[inline(always)]
    pub fn none([s_min, s_max]: [f64; 2], left: u32) -> Nearest {
        Nearest {
            s_min,
            s: s_max,
            left,
            slot: NO_SLOT,
            u: 0.0,
            v: 0.0,
            front: false,
        }
    }

    #[inline(always)]
    fn set(&mut self, slot: u32, Crossing { s, u, v, front }: Crossing) {
        (self.s, self.u, self.v) = (s, u, v);
        (self.slot, self.front) = (slot, front);
    }

    /// The hit found, for the ray as given: s of it is `unit` times s of the line.
    #[inline(always)]
    pub fn hit(&self, bvh: &Bvh, unit: f64) -> Option<Hit> {
        (self.slot != NO_SLOT).then(|| Hit {
            s: self.s * unit,
            u: self.u,
            v: self.v,
            triangle: bvh.tags[self.slot as usize].id(),
            slot: self.slot,
            front: self.front,
        })
    }

    #[cold]
    fn wins_tie(&self, bvh: &Bvh, tag: Tag) -> bool {
        self.slot != NO_SLOT && tag.id() < bvh.tags[self.slot as usize].id()
    }
}

/// What a line's crossings of triangles are collected for.
pub(super) trait Collector {
    /// Whether crossings of the triangle in `slot` do not count.
    fn ignores(&self, slot: u32) -> bool;

    /// Takes a crossing of the triangle in `slot`, which is not ignored; true if no other crossing matters.
    fn take(&mut self, bvh: &Bvh, slot: u32, crossing: Crossing) -> bool;

    /// The parameter beyond which crossings do not matter.
    fn limit(&self) -> f64;

    /// Tests the triangle in `slot`; true if no other matters.
    #[inline(always)]
    fn test(&mut self, bvh: &Bvh, line: &Line, slot: u32, tally: &mut Counts) -> bool {
        if !self.ignores(slot)
            && let Some(crossing) = line.intersect(&bvh.corners[slot as usize], tally)
        {
            return self.take(bvh, slot, crossing);
        }
        false
    }
}

impl Collector for Nearest {
    #[inline(always)]
    fn ignores(&self, slot: u32) -> bool {
        slot == self.left
    }

    /// Accepts the crossing if it is first: nearer, or as near with a smaller id.
    #[inline(always)]
    fn take(&mut self, bvh: &Bvh, slot: u32, crossing: Crossing) -> bool {
        let tag = || bvh.tags[slot as usize];
        // Ties go to the smaller id, so that the result does not depend on the tree's order.
        if crossing.s > self.s_min
            && (crossing.s < self.s || (crossing.s == self.s && self.wins_tie(bvh, tag())))
            && (crossing.front || tag().shows(false))
            && bvh.is_met(slot, [crossing.u, crossing.v])
        {
            self.set(slot, crossing);
        }
        false
    }

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.s
    }
}

/// Whether anything blocks a segment of a line.
#[derive(Clone, Copy)]
pub(super) struct Blocked {
    s_min: f64,
    s_max: f64,
    /// Ids of triangles that do not block it.
    own: [u32; 2],
    found: bool,
}

impl Blocked {
    /// A segment that nothing blocks.
    pub const NONE: Blocked = Blocked {
        s_min: 0.0,
        s_max: 0.0,
        own: [u32::MAX; 2],
        found: false,
    };

    /// Not yet; `segment` lies on a line with 1 / `unit` = `per_unit`.
    #[inline(always)]
    pub fn none(segment: &Segment, per_unit: f64) -> Blocked {
        Blocked {
            s_min: segment.ray.s_min * per_unit,
            s_max: segment.s_max * per_unit,
            // No triangle has this id.
            own: [segment.skip, segment.end].map(|id| id.unwrap_or(u32::MAX)),
            found: false,
        }
    }

    /// Whether a tested triangle blocks it.
    #[inline(always)]
    pub fn is_found(&self) -> bool {
        self.found
    }
}

impl Collector for Blocked {
    #[inline(always)]
    fn ignores(&self, _: u32) -> bool {
        false
    }

    #[inline(always)]
    fn take(&mut self, bvh: &Bvh, slot: u32, crossing: Crossing) -> bool {
        let tag = bvh.tags[slot as usize];
        if crossing.s > self.s_min
            && crossing.s < self.s_max
            && tag.shows(crossing.front)
            && !self.own.contains(&tag.id())
            && bvh.is_met(slot, [crossing.u, crossing.v])
        {
            self.found = true;
        }
        self.found
    }

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.s_max
    }
}

/// A line on its way through the binary tree.
struct LineQuery<'a, C> {
    bvh: &'a Bvh,
    line: &'a Line,
    collector: C,
}

impl<C: Collector> Query for LineQuery<'_, C> {
    #[inline(always)]
    fn leaf(&mut self, slot: usize, tally: &mut Counts) -> bool {
        for at in slot..self.bvh.tags.len() {
            tally.add(Work::Triangles, 1);
            if self.collector.test(self.bvh, self.line, at as u32, tally) {
                return true;
            }
            if self.bvh.tags[at].is_last() {
                break;
            }
        }
        false
    }

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.collector.limit()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::rays::Facing;

    #[test]
    fn a_tree_deeper_than_the_usual_stack_is_walked_with_a_longer_one() {
        let strip = |i: u32| {
            let x = f64::from(i);
            [DVec3::X * x, DVec3::X * x + DVec3::Y, DVec3::X * (x + 1.0)]
        };
        let mut bvh = Bvh::build((0..100).map(strip).collect(), |_| Facing::TwoSided);
        let ray = |x: f64| Ray {
            origin: DVec3::new(x + 0.25, 0.25, 1.0),
            direction: -DVec3::Z,
            s_min: 0.0,
        };
        bvh.tree.depth = 10 * USUAL_DEPTH;
        for i in 0..100 {
            let hit = bvh.closest(&ray(f64::from(i)), f64::INFINITY);
            assert_eq!(hit.map(|h| h.triangle), Some(i));
        }
    }
}
