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
use crate::accel::Hit;
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
    /// Whether every four rays in `order` follow each other in the batch.
    pub in_fours: bool,
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
        in_fours: false,
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
        if self.in_fours {
            let mut first = 0;
            while first < RAYS {
                let ray = self.order[first] as usize;
                let (x, y, z) = (&mut xs[first..], &mut ys[first..], &mut zs[first..]);
                k.store_vectors(&directions[ray..ray + 4], unit, x, y, z);
                first += 4;
            }
        } else {
            for (lane, &ray) in self.order.iter().enumerate() {
                let d = directions[ray as usize] * unit;
                (xs[lane], ys[lane], zs[lane]) = (d.x as f32, d.y as f32, d.z as f32);
            }
        }
        self.extent(k)
    }

    /// Least and greatest direction along each axis; none if they don't go together.
    #[inline(always)]
    fn extent<K: Simd>(&self, k: K) -> Option<[[f32; 2]; 3]> {
        let zero = k.splat(0.0);
        let (mut size, mut broken) = (k.splat(f32::INFINITY), zero);
        let mut least = [k.splat(f32::INFINITY); 3];
        let mut greatest = [k.splat(f32::NEG_INFINITY); 3];
        let mut first = 0;
        while first < RAYS {
            let mut length = zero;
            let mut axis = 0;
            while axis < 3 {
                let d = k.load(&self.directions[axis][first..]);
                least[axis] = k.min(least[axis], d);
                greatest[axis] = k.max(greatest[axis], d);
                // NaN, if there is one: ∞·0 and NaN·0.
                broken = k.mul_add(d, zero, broken);
                length = k.max(length, k.max(d, k.sub(zero, d)));
                axis += 1;
            }
            size = k.min(size, length);
            first += K::LANES;
        }
        let mut extent = [[0.0; 2]; 3];
        let mut together = k.smallest(size) > 1.0 / SPREAD;
        let mut axis = 0;
        while axis < 3 {
            let (lo, hi) = (k.smallest(least[axis]), k.greatest(greatest[axis]));
            together &= hi - lo <= COHERENT && hi < SPREAD && lo > -SPREAD;
            extent[axis] = [lo, hi];
            axis += 1;
        }
        together &= k.le(broken, zero) == u32::MAX >> (32 - K::LANES);
        if together { Some(extent) } else { None }
    }

    /// Forgets all hits; of interest is what is nearer than those in `hits`, which are of the batch.
    #[inline(always)]
    pub fn start(&mut self, hits: &[Option<Hit>]) {
        self.near = [f32::INFINITY; RAYS];
        self.far = [f32::INFINITY; RAYS];
        self.slots = [NONE; RAYS];
        let mut known = false;
        for &ray in &self.order {
            known |= hits[ray as usize].is_some();
        }
        if known {
            self.limit_to(hits);
        }
        for lane in self.count..RAYS {
            (self.near[lane], self.far[lane]) = (-1.0, -1.0);
        }
    }

    fn limit_to(&mut self, hits: &[Option<Hit>]) {
        for (lane, &ray) in self.order.iter().enumerate() {
            if let Some(hit) = &hits[ray as usize] {
                self.far[lane] = upper(hit.s * self.tau_from_s);
            }
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
        let mut reach = 0.0f32;
        for d in extent.as_flattened() {
            reach = if d.abs() > reach { d.abs() } else { reach };
        }
        Beam {
            axes: [
                Axis::new(origin.x, extent[0]),
                Axis::new(origin.y, extent[1]),
                Axis::new(origin.z, extent[2]),
            ],
            reach: f64::from(reach) * 1.001,
        }
    }
}

impl Axis {
    #[inline(always)]
    fn new(origin: f64, [least, greatest]: [f32; 2]) -> Axis {
        const WIDER: f32 = 1.0 + power_of_two(-21) as f32;
        const NARROWER: f32 = 1.0 - power_of_two(-21) as f32;
        let margin = (1.0 + origin.abs()) * power_of_two(-22);
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
