//! Rays one by one: the reference for packets, and what is left to them.

use super::query::{Any, Closest, Probe};
use super::slab::{Link, Slabs};
use super::traverse::{Query, USUAL_DEPTH, Waiting, traverse};
use super::{Bvh, Hit, NoTally, Origins, Ray, Segment, Tally, Work};
use glam::DVec3;

impl Bvh {
    /// The first hit with `ray.s_min` < s < `s_max`.
    pub fn closest(&self, ray: &Ray, s_max: f64) -> Option<Hit> {
        let probe = Probe::new(ray)?;
        self.with_stack(|stack| self.closest_of(&probe, s_max, stack, &mut NoTally))
    }

    /// Whether there is a hit with `ray.s_min` < s < `s_max` on any triangle but `skip`.
    pub fn any(&self, ray: &Ray, s_max: f64, skip: Option<u32>) -> bool {
        let segment = Segment {
            ray: *ray,
            s_max,
            skip,
        };
        self.with_stack(|stack| self.is_blocked(&segment, stack, &mut NoTally))
    }

    /// [`Bvh::closest_by`] with [`Kernel::Scalar`].
    pub(super) fn closest_singly(
        &self,
        from: Origins,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        tally: &mut impl Tally,
        mut replaced: impl FnMut(usize),
    ) {
        tally.add(Work::Singles, directions.len());
        self.with_stack(|stack| {
            for (i, (&direction, entry)) in directions.iter().zip(hits).enumerate() {
                let ray = Ray {
                    origin: from.of(i),
                    direction,
                    s_min: 0.0,
                };
                let s_max = entry.as_ref().map_or(f64::INFINITY, |hit| hit.s);
                let probe = Probe::new(&ray);
                if let Some(hit) = probe.and_then(|p| self.closest_of(&p, s_max, stack, tally)) {
                    *entry = Some(hit);
                    replaced(i);
                }
            }
        })
    }

    /// [`Bvh::any_by`] with [`Kernel::Scalar`].
    pub(super) fn any_singly(
        &self,
        segments: &[Segment],
        blocked: &mut [bool],
        tally: &mut impl Tally,
    ) {
        tally.add(Work::Singles, segments.len());
        self.with_stack(|stack| {
            for (segment, blocked) in segments.iter().zip(blocked) {
                *blocked = self.is_blocked(segment, stack, tally);
            }
        })
    }

    fn is_blocked(&self, segment: &Segment, stack: &mut [Waiting], tally: &mut impl Tally) -> bool {
        let Some(probe) = Probe::new(&segment.ray) else {
            return false;
        };
        let mut query = Any::new(self, &probe, segment, tally);
        self.run(&probe, stack, &mut query);
        query.found
    }

    #[inline(always)]
    fn closest_of(
        &self,
        probe: &Probe,
        s_max: f64,
        stack: &mut [Waiting],
        tally: &mut impl Tally,
    ) -> Option<Hit> {
        let mut query = Closest {
            bvh: self,
            line: &probe.line,
            s_min: probe.s_min,
            s: s_max * probe.per_unit,
            found: None,
            tally,
        };
        self.run(probe, stack, &mut query);
        let (crossing, slot) = query.found?;
        Some(probe.hit(self, &crossing, slot))
    }

    #[inline(always)]
    fn run(&self, probe: &Probe, stack: &mut [Waiting], query: &mut impl Query) {
        if self.is_empty() {
            return;
        }
        if let Some(slabs) = Slabs::new(&self.lattice, &probe.line, probe.s_min) {
            traverse(&self.nodes, &slabs, stack, query);
        }
    }

    /// A stack as deep as the tree; on the heap only if the tree is deeper than trees are.
    #[inline(always)]
    fn with_stack<T>(&self, run: impl FnOnce(&mut [Waiting]) -> T) -> T {
        const NONE: Waiting = (Link::ROOT, 0.0);
        if self.depth <= USUAL_DEPTH {
            run(&mut [NONE; USUAL_DEPTH])
        } else {
            run(&mut vec![NONE; self.depth])
        }
    }
}
