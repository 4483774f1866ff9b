//! The interval test: which children of a wide node a block may hit.
//!
//! **(B1) Interval.** If all directions of a block have the same sign along an axis, 1/d lies in an interval, and hence, for every plane,
//! so does the τ at which rays cross it: between (plane − o)/d at the two ends of the interval. A box can be hit only if the latest of the
//! earliest entries over the axes is not after the earliest of the latest exits (Reshetov, Soupikov, Hurley, SIGGRAPH 2005). Along an axis
//! with both signs a box ahead of or behind the origin has an earliest entry, but no exit.
//!
//! **(B2) Origins.** Rays with their own origins have them in a box: lower planes are taken relative to its upper end, upper planes
//! relative to its lower end, so that entries are the earliest and exits the latest over the box.
//!
//! **(B3) Rounding.** (plane − o)/d is computed as plane·i − o·i: the product o·i, o itself and, without fused operations, plane·i have
//! errors of 2⁻²⁴ of their own sizes, and |plane| ≤ 1; the remaining errors are relative to the result. So lower planes use o + 2⁻²²(1 +
//! |o|), upper planes o − 2⁻²²(1 + |o|), and the interval of 1/d, whose ends are rounded three times, is widened by 2⁻²¹. That also keeps
//! boxes that end up to 2⁻²³ before the origin: hits at s > 0 as computed, whose true s is slightly less, are in them.
//!
//! **(B4) Flat directions.** A direction with |d| < 2⁻⁶⁰ is treated as 2⁻⁶⁰, which displaces it by less than 2⁻⁴⁵ where τ < 2¹⁵ ((K2) of
//! [`block`](super::block)): far less than the widening of (B3).

use super::block::BlockBounds;
use super::simd::Simd;
use crate::accel::float::power_of_two;
use crate::accel::wide::{WIDTH, WideNode};

/// The rays of a block as used for box tests.
pub(super) struct Beam<K: Simd> {
    kernel: K,
    axes: [Axis<K::F>; 3],
}

/// What a block's rays have in common along an axis, in all lanes.
struct Axis<F> {
    /// Which plane is hit first: 1 for the upper one.
    near: usize,
    /// Whether there are directions of both signs.
    straddles: bool,
    /// Ends of the interval of 1/d; if it straddles, its ends above and below.
    inverse: [F; 2],
    /// −o/d for the nearer planes; if it straddles, for those below and those above.
    near_offset: [F; 2],
    /// −o/d for the farther planes.
    far_offset: [F; 2],
}

impl<K: Simd> Beam<K> {
    /// The rays with these `bounds`, for a kernel with as many lanes as nodes have children.
    #[inline(always)]
    pub fn new(k: K, bounds: &BlockBounds) -> Beam<K> {
        Beam {
            kernel: k,
            axes: [
                Axis::new(k, bounds, 0),
                Axis::new(k, bounds, 1),
                Axis::new(k, bounds, 2),
            ],
        }
    }

    /// The children that a ray of the block may hit before `limit`, and the parameters at which they are entered.
    #[inline(always)]
    pub fn intersect(&self, node: &WideNode, limit: f32, entries: &mut [f32; WIDTH]) -> u32 {
        let k = self.kernel;
        let (mut enter, mut leave) = (k.splat(0.0), k.splat(limit));
        let mut axis = 0;
        while axis < 3 {
            let (slab, planes) = (&self.axes[axis], &node.planes[axis]);
            axis += 1;
            let [i, j] = slab.inverse;
            let [a, b] = slab.near_offset;
            let near = k.load(&planes[slab.near]);
            let far = k.load(&planes[1 - slab.near]);
            // The latest of the earliest entries and the earliest of the latest exits: (B1).
            if slab.straddles {
                // Ascending rays may enter through the lower plane, descending ones through the upper. One of the two is behind.
                enter = k.max(enter, k.max(k.mul_add(near, i, a), k.mul_add(far, j, b)));
            } else {
                let [c, d] = slab.far_offset;
                // Either end of the interval of 1/d may be the extreme one, depending on the side of the origin that the plane is on.
                enter = k.max(enter, k.min(k.mul_add(near, i, a), k.mul_add(near, j, b)));
                leave = k.min(leave, k.max(k.mul_add(far, i, c), k.mul_add(far, j, d)));
            }
        }
        k.store(entries, enter);
        k.le(enter, leave)
    }
}

impl<F> Axis<F> {
    #[inline(always)]
    fn new<K: Simd<F = F>>(k: K, bounds: &BlockBounds, axis: usize) -> Axis<F> {
        // 2⁻²¹ wider or narrower, and 2⁻²²(1 + |o|) about the origin's box: (B3), (B2).
        const WIDER: f32 = 1.0 + power_of_two(-21) as f32;
        const NARROWER: f32 = 1.0 - power_of_two(-21) as f32;
        let (origin, [least, greatest]) = (bounds.point[axis], bounds.directions[axis]);
        let offset = f64::from(bounds.offsets[axis]);
        let margin = offset + (1.0 + origin.abs() + offset) * power_of_two(-22);
        // For lower and upper planes.
        let offsets = [-(origin + margin) as f32, -(origin - margin) as f32];
        let straddles = least < 0.0 && greatest > 0.0;
        let descends = !straddles && least < 0.0;
        // The end nearer to 0 is decreased, the other increased: (B3).
        let [i, j] = if straddles {
            [steep(greatest) * NARROWER, -steep(-least) * NARROWER]
        } else if descends {
            [-steep(-least) * NARROWER, -steep(-greatest) * WIDER]
        } else {
            [steep(greatest) * NARROWER, steep(least) * WIDER]
        };
        let near = usize::from(descends);
        let (near_offset, far_offset) = (offsets[near], offsets[1 - near]);
        // With directions of both signs, the second product is for the upper planes.
        let second_offset = if straddles { offsets[1] } else { near_offset };
        Axis {
            near,
            straddles,
            inverse: [k.splat(i), k.splat(j)],
            near_offset: [k.splat(near_offset * i), k.splat(second_offset * j)],
            far_offset: [k.splat(far_offset * i), k.splat(far_offset * j)],
        }
    }
}

/// 1/d, at most 2⁶⁰: (B4).
#[inline(always)]
fn steep(d: f32) -> f32 {
    const FLAT: f32 = power_of_two(-60) as f32;
    1.0 / if d > FLAT { d } else { FLAT }
}
