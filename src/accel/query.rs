//! What a traversal carries: the ray in usual size, and what is asked of the triangles it meets.

use super::slab::{exponent, power_of_two};
use super::traverse::Query;
use super::triangle::{Crossing, Line};
use super::{Bvh, Facing, Hit, Ray, Segment, Tally, Work};
use glam::DVec3;

/// A ray with a direction of usual size: s of the ray is `unit` times s of the line.
pub(super) struct Probe {
    pub line: Line,
    pub s_min: f64,
    pub unit: f64,
    /// 1 / unit, exactly.
    pub per_unit: f64,
}

impl Probe {
    /// None for NaN, for a direction without length and for numbers beyond the module's limits.
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Option<Probe> {
        let size = ray.direction.abs().max_element();
        let far = ray.origin.abs().max_element();
        let finite = (ray.direction * 0.0 + ray.origin * 0.0) == DVec3::ZERO;
        let usual = power_of_two(-500)..power_of_two(500);
        if !finite || !usual.contains(&size) || far > power_of_two(300) {
            return None;
        }
        // Powers of two: s, u, v and all decisions are as for the direction given.
        let unit = power_of_two(-exponent(size));
        let per_unit = power_of_two(exponent(size));
        let line = Line {
            origin: ray.origin,
            direction: ray.direction * unit,
        };
        Some(Probe {
            line,
            s_min: ray.s_min * per_unit,
            unit,
            per_unit,
        })
    }

    /// What the ray has met.
    #[inline(always)]
    pub(super) fn hit(&self, bvh: &Bvh, crossing: &Crossing, slot: u32) -> Hit {
        Hit {
            s: crossing.s * self.unit,
            u: crossing.u,
            v: crossing.v,
            triangle: bvh.tags[slot as usize].id(),
            slot,
            front: crossing.front,
        }
    }

    /// The hit with the triangle in `slot`, if it comes before `rival`.
    pub(super) fn nearer(
        &self,
        bvh: &Bvh,
        rival: Option<(Crossing, u32)>,
        slot: u32,
        tally: &mut impl Tally,
    ) -> Option<(Crossing, u32)> {
        let mut query = Closest {
            bvh,
            line: &self.line,
            s_min: self.s_min,
            s: rival.as_ref().map_or(f64::INFINITY, |r| r.0.s),
            found: rival,
            tally,
        };
        let at = slot as usize;
        let found = query.consider(slot, &bvh.corners[at], bvh.tags[at]);
        if found { query.found } else { None }
    }
}

/// A triangle's id, its facing and whether it is the last of its leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tag(u32);

impl Tag {
    const FRONT_ONLY: u32 = 1 << 31;
    const LAST: u32 = 1 << 30;

    pub(super) fn new(id: u32, facing: Facing) -> Tag {
        match facing {
            Facing::TwoSided => Tag(id),
            Facing::FrontOnly => Tag(id | Self::FRONT_ONLY),
        }
    }

    pub(super) fn end_leaf(&mut self) {
        self.0 |= Self::LAST;
    }

    #[inline(always)]
    pub(super) fn id(self) -> u32 {
        self.0 & !(Self::FRONT_ONLY | Self::LAST)
    }

    #[inline(always)]
    pub(super) fn is_last(self) -> bool {
        self.0 & Self::LAST != 0
    }

    /// Whether a ray that meets this side sees the triangle.
    #[inline(always)]
    pub(super) fn shows(self, front: bool) -> bool {
        front || self.0 & Self::FRONT_ONLY == 0
    }
}

/// The nearest hit so far.
pub(super) struct Closest<'a, T> {
    pub bvh: &'a Bvh,
    pub line: &'a Line,
    pub s_min: f64,
    pub s: f64,
    pub found: Option<(Crossing, u32)>,
    pub tally: &'a mut T,
}

impl<T: Tally> Closest<'_, T> {
    /// Nearer, or as near with a smaller id.
    #[inline(always)]
    fn improves(&self, s: f64, tag: Tag) -> bool {
        s < self.s || (s == self.s && self.beats_tie(tag))
    }

    /// Takes over the triangle in `slot` if it comes first.
    #[inline(always)]
    fn consider(&mut self, slot: u32, corners: &[DVec3; 3], tag: Tag) -> bool {
        if let Some(crossing) = self.line.meet(corners, self.tally)
            && crossing.s > self.s_min
            && self.improves(crossing.s, tag)
            && tag.shows(crossing.front)
        {
            self.s = crossing.s;
            self.found = Some((crossing, slot));
            return true;
        }
        false
    }

    #[cold]
    fn beats_tie(&self, tag: Tag) -> bool {
        let rival = self.found.as_ref().map(|f| self.bvh.tags[f.1 as usize]);
        rival.is_some_and(|rival| tag.id() < rival.id())
    }
}

impl<T: Tally> Query for Closest<'_, T> {
    #[inline(always)]
    fn leaf(&mut self, slot: usize) -> bool {
        let triangles = self.bvh.corners[slot..].iter().zip(&self.bvh.tags[slot..]);
        for (i, (corners, &tag)) in triangles.enumerate() {
            self.tally.add(Work::Triangles, 1);
            self.consider((slot + i) as u32, corners, tag);
            if tag.is_last() {
                break;
            }
        }
        false
    }

    #[inline(always)]
    fn node(&mut self) {
        self.tally.add(Work::Nodes, 1);
    }

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.s
    }
}

/// Whether there is a hit at all.
pub(super) struct Any<'a, T> {
    bvh: &'a Bvh,
    line: &'a Line,
    s_min: f64,
    s_max: f64,
    skip: Option<u32>,
    pub found: bool,
    tally: &'a mut T,
}

impl<'a, T: Tally> Any<'a, T> {
    /// Whether anything blocks `segment`, of which `probe` is made.
    #[inline(always)]
    pub fn new(bvh: &'a Bvh, probe: &'a Probe, segment: &Segment, tally: &'a mut T) -> Self {
        Any {
            bvh,
            line: &probe.line,
            s_min: probe.s_min,
            s_max: segment.s_max * probe.per_unit,
            skip: segment.skip,
            found: false,
            tally,
        }
    }

    /// Whether the triangle in `slot` does.
    #[inline(always)]
    pub fn meet(&mut self, slot: usize) -> bool {
        let tag = self.bvh.tags[slot];
        if let Some(crossing) = self.line.meet(&self.bvh.corners[slot], self.tally)
            && crossing.s > self.s_min
            && crossing.s < self.s_max
            && tag.shows(crossing.front)
            && Some(tag.id()) != self.skip
        {
            self.found = true;
        }
        self.found
    }
}

impl<T: Tally> Query for Any<'_, T> {
    #[inline(always)]
    fn leaf(&mut self, slot: usize) -> bool {
        for at in slot..self.bvh.tags.len() {
            self.tally.add(Work::Triangles, 1);
            if self.meet(at) {
                return true;
            }
            if self.bvh.tags[at].is_last() {
                break;
            }
        }
        false
    }

    #[inline(always)]
    fn node(&mut self) {
        self.tally.add(Work::Nodes, 1);
    }

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.s_max
    }
}
