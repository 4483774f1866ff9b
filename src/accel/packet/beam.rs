//! The rays of a block as boxes see them: intervals.
//!
//! **Interval.** Where all directions of a block have one sign along an axis, 1/d lies in an interval, and
//! with it for every plane the τ at which rays cross: between (plane − o)/d at its two ends. A box can be
//! met only if the latest of the earliest entries over the axes isn't after the earliest of the
//! latest exits (Reshetov, Soupikov, Hurley, SIGGRAPH 2005). Along an axis with both signs a box ahead of
//! or behind the origin has an earliest entry, but no exit.
//!
//! Rays with origins of their own have them in a box: planes below are taken relative to its upper end, planes above
//! relative to its lower end, so that entries are the earliest and exits the latest over the box.
//!
//! **Roundings.** (plane − o)/d is computed as plane·i − o·i: the product o·i, o itself and, without fused
//! operations, plane·i are off by 2⁻²⁴ of their own sizes, and |plane| ≤ 1; what remains is relative to the
//! result. So planes below take o + 2⁻²²(1 + |o|), planes above o − 2⁻²²(1 + |o|), and the interval of 1/d,
//! its ends rounded three times, is widened by 2⁻²¹. That also holds boxes which are left up to 2⁻²³
//! before the origin: hits at s > 0 as computed, whose true s is a little less, are in them. A direction
//! with |d| < 2⁻⁶⁰ goes as if it were that, which displaces it by less than 2⁻⁴⁶ where τ < 2¹⁴.

use super::block::View;
use crate::accel::slab::power_of_two;

/// What a block's rays have in common along an axis.
pub(super) struct Axis {
    /// Which plane is met first: 1 for that above.
    pub near: usize,
    /// Whether there are directions of both signs.
    pub straddles: bool,
    /// Ends of the interval of 1/d; if it straddles, its ends above and below.
    pub inverse: [f32; 2],
    /// −o/d for the nearer planes; if it straddles, for those below and those above.
    pub near_offset: [f32; 2],
    /// −o/d for the farther planes.
    pub far_offset: [f32; 2],
}

/// All axes.
pub(super) struct Beam {
    pub axes: [Axis; 3],
}

impl Beam {
    /// The rays of `view`.
    #[inline(always)]
    pub fn new(view: &View) -> Beam {
        Beam {
            axes: [Axis::of(view, 0), Axis::of(view, 1), Axis::of(view, 2)],
        }
    }
}

impl Axis {
    #[inline(always)]
    fn of(view: &View, axis: usize) -> Axis {
        let offset = f64::from(view.offsets[axis]);
        Axis::new(view.point[axis], offset, view.directions[axis])
    }

    #[inline(always)]
    fn new(origin: f64, offset: f64, [least, greatest]: [f32; 2]) -> Axis {
        const WIDER: f32 = 1.0 + power_of_two(-21) as f32;
        const NARROWER: f32 = 1.0 - power_of_two(-21) as f32;
        let margin = offset + (1.0 + origin.abs() + offset) * power_of_two(-22);
        // For planes below and above.
        let offsets = [-(origin + margin) as f32, -(origin - margin) as f32];
        let straddles = least < 0.0 && greatest > 0.0;
        let descends = !straddles && least < 0.0;
        let [i, j] = if straddles {
            [steep(greatest) * NARROWER, -steep(-least) * NARROWER]
        } else if descends {
            [-steep(-least) * NARROWER, -steep(-greatest) * WIDER]
        } else {
            [steep(greatest) * NARROWER, steep(least) * WIDER]
        };
        let near = usize::from(descends);
        let (near_offset, far_offset) = (offsets[near], offsets[1 - near]);
        let second_offset = if straddles { offsets[1] } else { near_offset };
        Axis {
            near,
            straddles,
            inverse: [i, j],
            near_offset: [near_offset * i, second_offset * j],
            far_offset: [far_offset * i, far_offset * j],
        }
    }
}

/// 1/d, at most 2⁶⁰.
#[inline(always)]
fn steep(d: f32) -> f32 {
    const FLAT: f32 = power_of_two(-60) as f32;
    1.0 / if d > FLAT { d } else { FLAT }
}
