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
        let mut query = AnyHit::new(self.bvh, &ray, segment);
        self.trace(&ray, stack, &mut query, tally);
        query.found
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
        let mut query = ClosestHit::new(self.bvh, ray, s_max, left);
        self.trace(ray, stack, &mut query, tally);
        query.into_hit(ray)
    }

    #[inline(always)]
    fn trace(
        self,
        ray: &ScaledRay,
        stack: &mut [StackEntry],
        query: &mut impl Query,
        tally: &mut Counts,
    ) {
        if self.is_empty() {
            return;
        }
        if let Some(slabs) = SlabRay::new(&self.tree.space, &ray.line, ray.s_min) {
            traverse(&self.tree.nodes, &slabs, stack, query, tally);
        }
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

    /// The hit with the triangle in `slot`, if it is nearer than `rival`.
    pub fn nearer(
        &self,
        bvh: &Bvh,
        rival: Option<(Crossing, u32)>,
        slot: u32,
        left: u32,
        tally: &mut Counts,
    ) -> Option<(Crossing, u32)> {
        // A separate query, so that the two are compared by the rule of the whole tree.
        let mut query = ClosestHit {
            bvh,
            line: &self.line,
            s_min: self.s_min,
            s: rival.as_ref().map_or(f64::INFINITY, |r| r.0.s),
            left,
            found: rival,
        };
        let at = slot as usize;
        let found = query.consider(slot, &bvh.corners[at], bvh.tags[at], tally);
        if found { query.found } else { None }
    }
}

/// The nearest hit so far.
pub(super) struct ClosestHit<'a> {
    bvh: &'a Bvh,
    line: &'a Line,
    s_min: f64,
    s: f64,
    /// The slot of the triangle that the ray leaves.
    left: u32,
    found: Option<(Crossing, u32)>,
}

impl<'a> ClosestHit<'a> {
    /// For hits of `ray` before `s_max` of the ray as given, with any triangle except the one in slot `left`.
    #[inline(always)]
    pub fn new(bvh: &'a Bvh, ray: &'a ScaledRay, s_max: f64, left: u32) -> Self {
        ClosestHit {
            bvh,
            line: &ray.line,
            s_min: ray.s_min,
            s: s_max * ray.per_unit,
            left,
            found: None,
        }
    }

    /// The hit found, for the ray as given.
    #[inline(always)]
    pub fn into_hit(self, ray: &ScaledRay) -> Option<Hit> {
        let (crossing, slot) = self.found?;
        Some(ray.hit(self.bvh, &crossing, slot))
    }

    /// Accepts the triangle in `slot` if it is first: nearer, or as near with a smaller id.
    #[inline(always)]
    fn consider(&mut self, slot: u32, corners: &[DVec3; 3], tag: Tag, tally: &mut Counts) -> bool {
        // Ties go to the smaller id, so that the result does not depend on the tree's order.
        if slot != self.left
            && let Some(crossing) = self.line.intersect(corners, tally)
            && crossing.s > self.s_min
            && (crossing.s < self.s || (crossing.s == self.s && self.wins_tie(tag)))
            && tag.shows(crossing.front)
            && self.bvh.is_met(slot, [crossing.u, crossing.v])
        {
            self.s = crossing.s;
            self.found = Some((crossing, slot));
            return true;
        }
        false
    }

    #[cold]
    fn wins_tie(&self, tag: Tag) -> bool {
        let rival = self.found.as_ref().map(|f| self.bvh.tags[f.1 as usize]);
        rival.is_some_and(|rival| tag.id() < rival.id())
    }
}

impl Query for ClosestHit<'_> {
    #[inline(always)]
    fn leaf(&mut self, slot: usize, tally: &mut Counts) -> bool {
        let triangles = self.bvh.corners[slot..].iter().zip(&self.bvh.tags[slot..]);
        for (i, (corners, &tag)) in triangles.enumerate() {
            tally.add(Work::Triangles, 1);
            self.consider((slot + i) as u32, corners, tag, tally);
            if tag.is_last() {
                break;
            }
        }
        false
    }

    #[inline(always)]
    fn triangle(&mut self, slot: usize, tally: &mut Counts) -> bool {
        tally.add(Work::Triangles, 1);
        let (corners, tag) = (&self.bvh.corners[slot], self.bvh.tags[slot]);
        self.consider(slot as u32, corners, tag, tally);
        false
    }

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.s
    }
}

/// Whether there is a hit at all.
pub(super) struct AnyHit<'a> {
    bvh: &'a Bvh,
    line: &'a Line,
    s_min: f64,
    s_max: f64,
    /// Triangles that are ignored.
    own: [Option<u32>; 2],
    found: bool,
}

impl<'a> AnyHit<'a> {
    /// Whether anything blocks `segment`; `ray` is its ray.
    #[inline(always)]
    pub fn new(bvh: &'a Bvh, ray: &'a ScaledRay, segment: &Segment) -> Self {
        AnyHit {
            bvh,
            line: &ray.line,
            s_min: ray.s_min,
            s_max: segment.s_max * ray.per_unit,
            own: [segment.skip, segment.end],
            found: false,
        }
    }

    /// Whether a tested triangle blocks it.
    #[inline(always)]
    pub fn is_found(&self) -> bool {
        self.found
    }

    /// Whether the triangle in `slot` blocks it.
    #[inline(always)]
    pub fn test(&mut self, slot: usize, tally: &mut Counts) -> bool {
        let tag = self.bvh.tags[slot];
        if let Some(crossing) = self.line.intersect(&self.bvh.corners[slot], tally)
            && crossing.s > self.s_min
            && crossing.s < self.s_max
            && tag.shows(crossing.front)
            && !self.own.contains(&Some(tag.id()))
            && self.bvh.is_met(slot as u32, [crossing.u, crossing.v])
        {
            self.found = true;
        }
        self.found
    }
}

impl Query for AnyHit<'_> {
    #[inline(always)]
    fn leaf(&mut self, slot: usize, tally: &mut Counts) -> bool {
        for at in slot..self.bvh.tags.len() {
            tally.add(Work::Triangles, 1);
            if self.test(at, tally) {
                return true;
            }
            if self.bvh.tags[at].is_last() {
                break;
            }
        }
        false
    }

    #[inline(always)]
    fn triangle(&mut self, slot: usize, tally: &mut Counts) -> bool {
        tally.add(Work::Triangles, 1);
        self.test(slot, tally)
    }

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.s_max
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
