//! Islands: fine geometry in a much larger scene gets its own trees.
//!
//! In tree space boxes are f32, and rays know their position to 2⁻²² of half the geometry's size ((S3) and (S4) of [`slab`](super::slab)).
//! Triangles no larger than that are indistinguishable: a ray that comes near must test them all. A picture of 480 × 300 pixels of two
//! balls of 328,000 triangles each on a planet takes 75 s that way. In trees over the balls alone their triangles are large again: it takes
//! 0.9 s.
//!
//! A set of triangles is *fine* if more than a few of them have an extent below 2⁻¹⁸ of its half size, 16 times the position error of rays.
//! Larger triangles stay. If all fine ones lie within an eighth of the set, they become a new set, which is examined again; otherwise the
//! set is cut at its widest gap along an axis, and both parts are examined. If there is no gap, the set stays whole: triangles that cover a
//! whole set without gaps are not that small, because there are at most 2³⁰.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::float::power_of_two;

/// A triangle below this fraction of a set's half size is fine.
const FINE: f64 = power_of_two(-18);
/// Fewer fine triangles are tested faster without their own tree.
const FEW: usize = 256;
/// A set with its own tree is smaller by at least this factor.
const SMALLER: f64 = 8.0;
/// Each axis is divided into this many intervals in search of gaps, and gaps span at least two of them: 1/512 of the axis.
const INTERVALS: usize = 1024;
const GAP: usize = 2;
/// The maximum number of trees that a ray visits. Further fine geometry stays in its set.
const MOST: usize = 64;

/// Minimum and maximum coordinates, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub lo: DVec3,
    pub hi: DVec3,
}

/// Triangles that have their own tree.
#[derive(Debug)]
pub(super) struct Island {
    /// Their indices, at least one.
    pub ids: Vec<u32>,
    pub bounds: Bounds,
}

impl Bounds {
    fn of(corners: &[DVec3; 3]) -> Bounds {
        let [a, b, c] = *corners;
        Bounds {
            lo: a.min(b).min(c),
            hi: a.max(b).max(c),
        }
    }

    /// The bounds of the triangles `ids`; `None` if there are none.
    pub fn of_all(triangles: &[[DVec3; 3]], ids: &[u32]) -> Option<Bounds> {
        let one = |&id: &u32| Bounds::of(&triangles[id as usize]);
        ids.par_iter().map(one).reduce_with(|x, y| Bounds {
            lo: x.lo.min(y.lo),
            hi: x.hi.max(y.hi),
        })
    }

    /// Half of its longest side. Halved first: coordinates may be so far apart that their difference overflows f64.
    fn half(&self) -> f64 {
        (self.hi * 0.5 - self.lo * 0.5).max_element()
    }
}

/// The sets of `ids` that have a tree each; the spatially largest comes first.
pub(super) fn islands(triangles: &[[DVec3; 3]], ids: Vec<u32>) -> Vec<Island> {
    let island = |ids: Vec<u32>| {
        let bounds = Bounds::of_all(triangles, &ids)?;
        Some(Island { ids, bounds })
    };
    let mut islands = Vec::new();
    let mut pending = Vec::from_iter(island(ids));
    while let Some(set) = pending.pop() {
        let half = set.bounds.half();
        let is_fine = |id: &u32| Bounds::of(&triangles[*id as usize]).half() < FINE * half;
        // Each pending set ends as at least one tree, and so does this one.
        let is_full = islands.len() + pending.len() + 1 >= MOST;
        if is_full || set.ids.par_iter().filter(|id| is_fine(id)).count() < FEW {
            islands.push(set);
            continue;
        }
        // Triangles that are not fine, or for which no separate set is found, stay.
        let (fine, mut rest): (Vec<u32>, Vec<u32>) = set.ids.into_iter().partition(is_fine);
        let mut parts = Vec::from_iter(island(fine));
        while let Some(part) = parts.pop() {
            let is_full = islands.len() + pending.len() + 1 >= MOST;
            if part.ids.len() < FEW || is_full {
                rest.extend(part.ids);
            } else if part.bounds.half() * SMALLER <= half {
                // Small enough for its triangles to be large in its own tree; examine it again.
                pending.push(part);
            } else if let Some(plane) = widest_gap(triangles, &part) {
                let is_below = |id: &u32| plane.has_below(&triangles[*id as usize]);
                let (below, above) = part.ids.into_iter().partition(is_below);
                parts.extend([below, above].into_iter().filter_map(island));
            } else {
                rest.extend(part.ids);
            }
        }
        // In the original order, as if there were no islands.
        rest.sort_unstable();
        islands.extend(island(rest));
    }
    islands
}

/// A plane across an axis.
struct Plane {
    axis: usize,
    at: f64,
}

impl Plane {
    /// Whether a triangle is below it.
    fn has_below(&self, corners: &[DVec3; 3]) -> bool {
        // No triangle reaches into the gap, so any of its corners tells the side.
        corners[0][self.axis] < self.at
    }
}

/// The middle of the widest interval along an axis that is free of these triangles; `None` if they are close together.
fn widest_gap(triangles: &[[DVec3; 3]], island: &Island) -> Option<Plane> {
    // All axes are divided on the scale of the longest, so that gaps compare by width.
    let length = 2.0 * island.bounds.half();
    let mut widest: Option<(Range<usize>, usize)> = None;
    for axis in 0..3 {
        let lo = island.bounds.lo[axis];
        // The intervals that are not empty.
        let mut is_taken = [false; INTERVALS];
        for &id in &island.ids {
            let one = Bounds::of(&triangles[id as usize]);
            let place = |x: f64| ((x - lo) / length * INTERVALS as f64) as usize;
            // The greatest coordinate is at the end of the last interval, and counts as inside it.
            let last = place(one.hi[axis]).min(INTERVALS - 1);
            is_taken[place(one.lo[axis]).min(last)..=last].fill(true);
        }
        // Runs of empty intervals, except after the last triangle.
        let mut first = 0;
        for (at, _) in is_taken.iter().enumerate().filter(|(_, taken)| **taken) {
            // Wider than the widest so far, or at least as wide as a gap must be.
            let known = widest.as_ref().map_or(GAP - 1, |(gap, _)| gap.len());
            if at - first > known {
                widest = Some((first..at, axis));
            }
            first = at + 1;
        }
    }
    let (gap, axis) = widest?;
    let middle = (gap.start + gap.end) as f64 / 2.0 / INTERVALS as f64;
    let at = island.bounds.lo[axis] + length * middle;
    Some(Plane { axis, at })
}

#[cfg(test)]
mod tests;
