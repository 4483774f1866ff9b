//! Single rays by lane, as traced through the wide tree: as given, in f64, and in f32 for the tests of boxes and leaves.
//!
//! Labels (S1) to (S7) refer to [`slab`](crate::accel::slab), and (W1) and (W2) to [`walk`](super::walk).

use glam::DVec3;

use super::ray_set::RAYS;
use crate::accel::bvh::Bvh;
use crate::accel::float::{greater, lesser, power_of_two};
use crate::accel::rays::Ray;
use crate::accel::slab::{STEEP, SlabStart};
use crate::accel::tree_space::TreeSpace;
use crate::accel::triangle::Line;
use crate::accel::wide::WIDTH;

/// Removes and returns the first of `lanes`.
#[inline(always)]
pub(super) fn next_lane(lanes: &mut u64) -> usize {
    let lane = lanes.trailing_zeros() as usize % RAYS;
    *lanes &= lanes.wrapping_sub(1);
    lane
}

/// Rays as given, by lane.
#[repr(C, align(64))]
pub(super) struct Given {
    pub origins: [[f64; RAYS]; 3],
    pub directions: [[f64; RAYS]; 3],
    pub s_min: [f64; RAYS],
}

impl Given {
    pub const NONE: Given = Given {
        origins: [[0.0; RAYS]; 3],
        directions: [[0.0; RAYS]; 3],
        s_min: [0.0; RAYS],
    };

    #[inline(always)]
    pub fn set(&mut self, lane: usize, ray: &Ray) {
        let (o, d) = (ray.origin, ray.direction);
        let [x, y, z] = &mut self.origins;
        (x[lane], y[lane], z[lane]) = (o.x, o.y, o.z);
        let [x, y, z] = &mut self.directions;
        (x[lane], y[lane], z[lane]) = (d.x, d.y, d.z);
        self.s_min[lane] = ray.s_min;
    }

    #[inline(always)]
    pub fn origin(&self, lane: usize) -> DVec3 {
        let [x, y, z] = &self.origins;
        DVec3::new(x[lane], y[lane], z[lane])
    }

    #[inline(always)]
    pub fn direction(&self, lane: usize) -> DVec3 {
        let [x, y, z] = &self.directions;
        DVec3::new(x[lane], y[lane], z[lane])
    }
}

/// Rays in f64, by lane, for the tests of boxes and leaves.
#[repr(C, align(64))]
pub(super) struct Lines {
    /// The factor that scales |d|∞ to [1, 2), and directions scaled by it.
    pub unit: [f64; RAYS],
    pub directions: [[f64; RAYS]; 3],
    /// [`MISSES`], [`ENTERS`] or [`LEFT`].
    pub fate: [f64; RAYS],
    /// τ₀, and the uncertainty of k s − τ₀.
    pub start: [f64; RAYS],
    pub blur: [f64; RAYS],
    /// r, ρ, and 1/|d| with the sign of d.
    pub base: [[f64; RAYS]; 3],
    pub unsure: [f64; RAYS],
    pub inverse: [[f64; RAYS]; 3],
    /// r along x, y and z of (W1), and the slopes Sx and Sy.
    pub sheared: [[f64; RAYS]; 3],
    pub slopes: [[f64; RAYS]; 2],
    /// z of (W1): 0, 1 or 2.
    pub steepest: [f64; RAYS],
}

/// A ray that certainly misses everything.
pub(super) const MISSES: f64 = 0.0;
/// A ray that is traced through the tree.
pub(super) const ENTERS: f64 = 1.0;
/// A ray that is left to the binary tree.
pub(super) const LEFT: f64 = 2.0;

impl Lines {
    pub const NONE: Lines = Lines {
        unit: [0.0; RAYS],
        directions: [[0.0; RAYS]; 3],
        fate: [0.0; RAYS],
        start: [0.0; RAYS],
        blur: [0.0; RAYS],
        base: [[0.0; RAYS]; 3],
        unsure: [0.0; RAYS],
        inverse: [[0.0; RAYS]; 3],
        sheared: [[0.0; RAYS]; 3],
        slopes: [[0.0; RAYS]; 2],
        steepest: [0.0; RAYS],
    };

    /// Sets up the first `count` of the `given` rays.
    #[inline(always)]
    pub fn set_up(&mut self, space: &TreeSpace, given: &Given, count: usize) {
        let space = *space;
        for lane in 0..whole_eights(count) {
            // As in `ScaledRay::new`.
            let (origin, direction) = (given.origin(lane), given.direction(lane));
            let size = greatest(direction);
            // 0 times NaN or ∞ is NaN, which compares unequal to everything.
            let finite = (direction.x + direction.y + direction.z) * 0.0
                + (origin.x + origin.y + origin.z) * 0.0
                == 0.0;
            let usual = finite
                & (size >= power_of_two(-500))
                & (size < power_of_two(500))
                & (greatest(origin) <= Bvh::MAX_COORDINATE);
            // 2^−e and 2^e, from the exponent's bits: 2046 is twice the bias.
            let exponent = size.to_bits() >> 52;
            let unit = f64::from_bits((2046u64.wrapping_sub(exponent)) << 52);
            let per_unit = f64::from_bits(exponent << 52);
            let d = direction * unit;
            let start = SlabStart::of(&space, space.map(origin), d, given.s_min[lane] * per_unit);
            let missed = usual & start.is_valid & start.misses;
            let entered = usual & start.is_valid & start.is_near & !start.misses;
            let fate = if missed { MISSES } else { LEFT };
            self.fate[lane] = if entered { ENTERS } else { fate };
            self.unit[lane] = unit;
            self.directions[0][lane] = d.x;
            self.directions[1][lane] = d.y;
            self.directions[2][lane] = d.z;
            self.start[lane] = start.start;
            self.blur[lane] = start.blur;
            self.unsure[lane] = start.unsure;
            let base = start.base;
            (self.base[0][lane], self.base[1][lane], self.base[2][lane]) = (base.x, base.y, base.z);
            let inverse = [
                start.inverse[0].copysign(d.x),
                start.inverse[1].copysign(d.y),
                start.inverse[2].copysign(d.z),
            ];
            self.inverse[0][lane] = inverse[0];
            self.inverse[1][lane] = inverse[1];
            self.inverse[2][lane] = inverse[2];
            // (W1): z, and x and y, which follow it cyclically.
            let (ax, ay, az) = (d.x.abs(), d.y.abs(), d.z.abs());
            let by_x = (ax >= ay) & (ax >= az);
            let by_y = !by_x & (ay >= az);
            let by = [by_x, by_y];
            let sheared = turned(by, [base.x, base.y, base.z]);
            let [x, y, _] = turned(by, [d.x, d.y, d.z]);
            let [_, _, per_z] = turned(by, inverse);
            self.sheared[0][lane] = sheared[0];
            self.sheared[1][lane] = sheared[1];
            self.sheared[2][lane] = sheared[2];
            self.slopes[0][lane] = x * per_z;
            self.slopes[1][lane] = y * per_z;
            self.steepest[lane] = if by_x {
                0.0
            } else if by_y {
                1.0
            } else {
                2.0
            };
        }
    }

    /// The rays among the first `count` that are traced through the tree, and those left to the binary one, as bits.
    #[inline(always)]
    pub fn fates(&self, count: usize) -> [u64; 2] {
        let (mut entering, mut left) = (0, 0);
        for (lane, &fate) in self.fate.iter().enumerate().take(count) {
            entering |= u64::from(fate == ENTERS) << lane;
            left |= u64::from(fate == LEFT) << lane;
        }
        [entering, left]
    }

    /// The line of a ray, with |d|∞ in [1, 2).
    #[inline(always)]
    pub fn line(&self, given: &Given, lane: usize) -> Line {
        let [x, y, z] = &self.directions;
        Line {
            origin: given.origin(lane),
            direction: DVec3::new(x[lane], y[lane], z[lane]),
        }
    }

    /// The inverse of `unit`, exactly: it is a power of two.
    #[inline(always)]
    pub fn per_unit(&self, lane: usize) -> f64 {
        f64::from_bits((2046 << 52) - self.unit[lane].to_bits())
    }
}

/// The number of lanes that vector loops process for `count` rays.
#[inline(always)]
pub(super) fn whole_eights(count: usize) -> usize {
    (count.div_ceil(8) * 8).min(RAYS)
}

/// |v|∞.
#[inline(always)]
pub(super) fn greatest(v: DVec3) -> f64 {
    greater(greater(v.x.abs(), v.y.abs()), v.z.abs())
}

/// Rays in f32, by lane.
#[repr(C, align(64))]
pub(super) struct Boxes {
    /// Per axis 1/d, and r/d for entry planes and for exit planes: (W3).
    pub inverses: [[f32; RAYS]; 3],
    pub offsets: [[[f32; RAYS]; 2]; 3],
    /// Per axis the offset of the entry planes in a node: those of the lower planes, or of the upper ones.
    pub near: [[u32; RAYS]; 3],
    /// x, y and z of (W1), −Sx and −Sy.
    pub axes: [[u32; RAYS]; 3],
    pub slopes: [[f32; RAYS]; 2],
    /// 2ρ + 2⁻⁴⁶(2 + |r|).
    pub off: [f32; RAYS],
    /// The t beyond which no box matters.
    pub far: [f32; RAYS],
}

impl Boxes {
    pub const NONE: Boxes = Boxes {
        inverses: [[0.0; RAYS]; 3],
        offsets: [[[0.0; RAYS]; 2]; 3],
        near: [[0; RAYS]; 3],
        axes: [[0; RAYS]; 3],
        slopes: [[0.0; RAYS]; 2],
        off: [0.0; RAYS],
        far: [0.0; RAYS],
    };

    #[inline(always)]
    pub fn set_up(&mut self, lines: &Lines, count: usize) {
        let count = whole_eights(count);
        let mut axis = 0;
        while axis < 3 {
            for lane in 0..count {
                let (r, inverse) = (lines.base[axis][lane], lines.inverse[axis][lane]);
                let steepness = lesser(inverse.abs(), STEEP);
                let descends = inverse < 0.0;
                // (W3): m.
                let off = power_of_two(-24) * (2.1 + 1.1 * r.abs()) + lines.unsure[lane];
                let inverse = if descends { -steepness } else { steepness };
                let offset = r * inverse;
                self.inverses[axis][lane] = inverse as f32;
                self.offsets[axis][0][lane] = (offset + steepness * off) as f32;
                self.offsets[axis][1][lane] = (offset - steepness * off) as f32;
                self.near[axis][lane] = if descends { WIDTH as u32 } else { 0 };
            }
            axis += 1;
        }
        for lane in 0..count {
            let base = DVec3::new(
                lines.base[0][lane],
                lines.base[1][lane],
                lines.base[2][lane],
            );
            // The ray's part of e of (W1), rounded upward.
            let off = 2.0 * lines.unsure[lane] + power_of_two(-46) * (2.0 + greatest(base));
            self.off[lane] = off as f32 * (1.0 + f32::EPSILON);
            self.slopes[0][lane] = -lines.slopes[0][lane] as f32;
            self.slopes[1][lane] = -lines.slopes[1][lane] as f32;
            let z = lines.steepest[lane] as i32 as u32;
            // x and y follow z cyclically, as in `turned`.
            self.axes[0][lane] = if z == 2 { 0 } else { z + 1 };
            self.axes[1][lane] = if z == 0 { 2 } else { z - 1 };
            self.axes[2][lane] = z;
        }
    }
}

/// Permutes `v` to the axes x, y and z of (W1), where z is the steepest.
#[inline(always)]
pub(super) fn turned([by_x, by_y]: [bool; 2], v: [f64; 3]) -> [f64; 3] {
    [
        if by_x {
            v[1]
        } else if by_y {
            v[2]
        } else {
            v[0]
        },
        if by_x {
            v[2]
        } else if by_y {
            v[0]
        } else {
            v[1]
        },
        if by_x {
            v[0]
        } else if by_y {
            v[1]
        } else {
            v[2]
        },
    ]
}
