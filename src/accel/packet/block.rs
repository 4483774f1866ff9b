//! Blocks: up to 64 rays with one origin that go nearly the same way.
//!
//! **Parameter.** Directions of a block are scaled by one power of two, that of its first ray, so that
//! |d|∞ is about 1; τ is measured in them and in the tree's unit.
//!
//! **Interval.** Where all directions of a block have one sign along an axis, 1/d lies in an interval, and
//! with it for every plane the τ at which rays cross: between (plane − o)/d at its two ends. A box can be
//! met only if the latest of the earliest entries over the axes isn't after the earliest of the
//! latest exits (Reshetov, Soupikov, Hurley, SIGGRAPH 2005). Along an axis with both signs a box ahead of
//! or behind the origin has an earliest entry, but no exit.
//!
//! **Roundings.** (plane − o)/d is computed as plane·i − o·i: the product o·i, o itself and, without fused
//! operations, plane·i are off by 2⁻²⁴ of their own sizes, and |plane| ≤ 1; what remains is relative to the
//! result. So planes below take o + 2⁻²²(1 + |o|), planes above o − 2⁻²²(1 + |o|), and the interval of 1/d,
//! its ends rounded three times, is widened by 2⁻²¹. That also holds boxes which are left up to 2⁻²³
//! before the origin: hits at s > 0 as computed, whose true s is a little less, are in them. A direction
//! with |d| < 2⁻⁶⁰ goes as if it were that, which displaces it by less than 2⁻⁴⁶ where τ < 2¹⁴.

use glam::DVec3;

use super::simd::Simd;
use crate::accel::slab::{Lattice, exponent, power_of_two};

/// Rays of a block.
pub(super) const RAYS: usize = 64;
/// No triangle.
pub(super) const NONE: u32 = u32::MAX;
/// Within a block |d|∞ differs by no more than this factor.
const SPREAD: f32 = 4.0;
/// Directions of a block differ by no more than this along any axis.
const COHERENT: f32 = 0.75;

/// Rays, and the nearest hits so far.
#[repr(C, align(64))]
pub(super) struct Block {
    /// Directions, axis by axis.
    pub directions: [[f32; RAYS]; 3],
    /// Bounds of τ of the nearest hit.
    pub near: [f32; RAYS],
    pub far: [f32; RAYS],
    /// Barycentrics of the nearest hit, if nobody is to certify it.
    pub weights: [[f32; RAYS]; 2],
    /// The slot of the nearest hit.
    pub slots: [u32; RAYS],
    /// The ray's place in the batch.
    pub order: [u32; RAYS],
    /// How many rays there are; the rest repeat the first, and don't count.
    pub count: usize,
    /// s of a ray is so many τ.
    pub tau_from_s: f64,
}

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

/// The axes, and D.
pub(super) struct Beam {
    pub axes: [Axis; 3],
    pub reach: f64,
}

impl Block {
    pub const EMPTY: Block = Block {
        directions: [[0.0; RAYS]; 3],
        near: [0.0; RAYS],
        far: [0.0; RAYS],
        weights: [[0.0; RAYS]; 2],
        slots: [NONE; RAYS],
        order: [0; RAYS],
        count: 0,
        tau_from_s: 1.0,
    };

    /// Takes the directions of the rays in `order`; false if they don't go together.
    #[inline(always)]
    pub fn aim<K: Simd>(
        &mut self,
        k: K,
        lattice: &Lattice,
        directions: &[DVec3],
    ) -> Option<[[f32; 2]; 3]> {
        let first = directions[self.order[0] as usize].abs().max_element();
        if !(power_of_two(-500)..power_of_two(500)).contains(&first) {
            return None;
        }
        let unit = power_of_two(-exponent(first));
        self.tau_from_s = lattice.scale * power_of_two(exponent(first));
        let [xs, ys, zs] = &mut self.directions;
        for (((index, x), y), z) in self.order.iter().zip(xs).zip(ys).zip(zs) {
            let d = directions[*index as usize];
            *x = (d.x * unit) as f32;
            *y = (d.y * unit) as f32;
            *z = (d.z * unit) as f32;
        }
        self.extent(k)
    }

    /// Least and greatest direction along each axis; none if they don't go together.
    #[inline(always)]
    fn extent<K: Simd>(&self, k: K) -> Option<[[f32; 2]; 3]> {
        let d = |axis: usize, at: usize| k.load(&self.directions[axis][at..]);
        let zero = k.splat(0.0);
        let mut least = [0, 1, 2].map(|axis| d(axis, 0));
        let mut greatest = least;
        // NaN, if there is one: ∞·0 and NaN·0.
        let mut broken = zero;
        let mut smallest_size = k.splat(f32::INFINITY);
        for at in (0..RAYS).step_by(K::LANES) {
            let mut size = zero;
            for axis in 0..3 {
                let d = d(axis, at);
                least[axis] = k.min(least[axis], d);
                greatest[axis] = k.max(greatest[axis], d);
                broken = k.mul_add(d, zero, broken);
                size = k.max(size, k.max(d, k.sub(zero, d)));
            }
            smallest_size = k.min(smallest_size, size);
        }
        let extent: [[f32; 2]; 3] =
            std::array::from_fn(|axis| [k.smallest(least[axis]), k.greatest(greatest[axis])]);
        let all = u32::MAX >> (32 - K::LANES);
        let together = extent
            .iter()
            .all(|[lo, hi]| hi - lo <= COHERENT && hi.abs().max(lo.abs()) < SPREAD)
            && k.smallest(smallest_size) > 1.0 / SPREAD
            && k.le(broken, zero) == all;
        together.then_some(extent)
    }

    /// Forgets all hits; of interest is what is nearer than `limit` says for each place in the batch.
    #[inline(always)]
    pub fn start(&mut self, limit: impl Fn(usize) -> Option<f64>) {
        self.near = [f32::INFINITY; RAYS];
        self.far = [f32::INFINITY; RAYS];
        self.slots = [NONE; RAYS];
        for lane in 0..self.count {
            if let Some(s) = limit(self.order[lane] as usize) {
                self.far[lane] = upper(s * self.tau_from_s);
            }
        }
        for lane in self.count..RAYS {
            (self.near[lane], self.far[lane]) = (-1.0, -1.0);
        }
    }

    /// Replaces the nearest hit of a lane by one at `s` of the ray.
    pub fn set(&mut self, lane: usize, slot: u32, s: f64) {
        let tau = s * self.tau_from_s;
        self.near[lane] = (tau * (1.0 - power_of_two(-22))) as f32;
        self.far[lane] = upper(tau);
        self.slots[lane] = slot;
    }

    /// The τ beyond which no ray has an interest. Computed parameters may be off by 2⁻⁴⁰ of a
    /// triangle's distance, which is below 2¹¹.
    #[inline(always)]
    pub fn limit<K: Simd>(&self, k: K) -> f32 {
        let mut far = k.load(&self.far);
        for at in (K::LANES..RAYS).step_by(K::LANES) {
            far = k.max(far, k.load(&self.far[at..]));
        }
        let far = k.greatest(far);
        let limit = far * (1.0 + power_of_two(-21) as f32) + power_of_two(-26) as f32;
        if limit < f32::MAX { limit } else { f32::MAX }
    }
}

/// f32 above a parameter.
#[inline(always)]
fn upper(tau: f64) -> f32 {
    (tau * (1.0 + power_of_two(-22))) as f32
}

impl Beam {
    /// Rays from `origin` (in the tree's frame) with directions within `extent`.
    #[inline(always)]
    pub fn new(origin: DVec3, extent: &[[f32; 2]; 3]) -> Beam {
        let reach = extent
            .as_flattened()
            .iter()
            .fold(0.0f32, |g, d| if d.abs() > g { d.abs() } else { g });
        Beam {
            axes: std::array::from_fn(|axis| Axis::new(origin[axis], extent[axis])),
            reach: f64::from(reach) * 1.001,
        }
    }
}

impl Axis {
    #[inline(always)]
    fn new(origin: f64, [least, greatest]: [f32; 2]) -> Axis {
        const WIDER: f64 = 1.0 + power_of_two(-21);
        const NARROWER: f64 = 1.0 - power_of_two(-21);
        let margin = (1.0 + origin.abs()) * power_of_two(-22);
        // For planes below and above.
        let offsets = [-(origin + margin), -(origin - margin)];
        let straddles = least < 0.0 && greatest > 0.0;
        let descends = !straddles && least < 0.0;
        let near = usize::from(descends);
        let inverse = if straddles {
            [
                steep(f64::from(greatest)) * NARROWER,
                -steep(f64::from(-least)) * NARROWER,
            ]
        } else if descends {
            [
                -steep(f64::from(-least)) * NARROWER,
                -steep(f64::from(-greatest)) * WIDER,
            ]
        } else {
            [
                steep(f64::from(greatest)) * NARROWER,
                steep(f64::from(least)) * WIDER,
            ]
        };
        let near_planes = if straddles { [0, 1] } else { [near; 2] };
        Axis {
            near,
            straddles,
            inverse: inverse.map(|i| i as f32),
            near_offset: [0, 1].map(|end| (offsets[near_planes[end]] * inverse[end]) as f32),
            far_offset: inverse.map(|i| (offsets[1 - near] * i) as f32),
        }
    }
}

/// 1/d, at most 2⁶⁰.
#[inline(always)]
fn steep(d: f64) -> f64 {
    1.0 / if d > power_of_two(-60) {
        d
    } else {
        power_of_two(-60)
    }
}
