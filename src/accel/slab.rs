//! The f32 box test of single rays: which boxes a ray certainly misses.
//!
//! **(S1) Tree space.** Boxes are in [`tree_space`](super::tree_space), |y| ≤ 1. A ray o + s d, |d|∞ in [1, 2), is
//! y = o' + τ d there, with τ = k s (k is a power of two: exact).
//!
//! **(S2) Rebasing.** The origin is moved to r = o' + τ₀ d with τ₀ near the entry into the root box (or the ray's start, if later). For
//! |o'| ≤ 2⁸, f64 does that within 2⁻⁵³(|o'| + 2|τ₀ d| + |r|) < 2⁻⁴²; beyond, sum and product carry their rounding errors along, which
//! leaves 2⁻⁵²|r| + 2⁻¹⁰⁰|o'|. Both stay within ρ = 2⁻⁴⁰ + 2⁻⁹⁸|o'|∞ for |r| < 2¹². If τ₀ itself is coarse, because the origin is 2⁴⁰ scene
//! sizes away or farther, |r| may be large; then 2⁻⁵²|r| is within the next term.
//!
//! **(S3) Origin.** r lies within [r₋, r₊], r∓ = f32(r ∓ (|r| 2⁻²⁴(1 + 2⁻²⁰) + ρ)): rounding to nearest changes a value by at most 2⁻²⁴ of
//! it. Lower planes (`lo`) use r₊, upper planes (`hi`) use r₋: that widens the box by exactly the uncertainty of the origin.
//!
//! **(S4) Slope.** t = (plane − r)/d has one rounding in the difference, one in 1/d as f32, one in the product: a relative error below
//! 3.01·2⁻²⁴. 1/|d| is stored twice, times 1 − 2⁻²² for entry planes and times 1 + 2⁻²² for exit planes: no entry is late, no exit early.
//! An axis along which |d| < 2⁻⁶⁰ is traversed as if |d| = 2⁻⁶⁰: within the root box, where |τ − τ₀| < 3 + 2⁻⁵⁰|o'|∞, that displaces by
//! less than ρ.
//!
//! **(S5)** That holds for t ≥ 0. Exits at t < 0 would come early, so τ₀ lies before everything that matters.
//!
//! **(S6) Parameter.** s of a hit has an error below 2⁻⁴⁰ of the corners' distance unless it is moved into the box (see
//! [`triangle`](super::triangle)), so the true position of a hit with s > s_min may be slightly before k s_min: τ₀ ≤ k s_min − 2⁻³⁶(1 + |k
//! s_min|). The computed entry into the root box (itself widened by 2⁻³⁰ for the rounding of o') has a relative error below 8 ε: τ₀ ≤ entry
//! − 2⁻⁴⁹(1 + |entry|).
//!
//! **(S7)** For the same reason boxes are kept that are entered before k s − τ₀ + 2⁻³⁶(1 + |τ₀|), with s the parameter of the nearest hit
//! so far.

use glam::{BVec4A, DVec3, Vec4, Vec4Swizzles};

use super::exact::{two_product, two_sum};
use super::float::{greater, lesser, power_of_two};
use super::node::Node;
use super::tree_space::TreeSpace;
use super::triangle::Line;

/// A ray in the form that the box test uses.
pub(super) struct SlabRay {
    /// Per axis r₊, r₊, −r₋, −r₋: (S3).
    origin: [Vec4; 3],
    /// Per axis 1/|d|, a little less for entries and a little more for exits: (S4).
    inverse: [Vec4; 3],
    /// The axes along which the ray descends.
    pub descends: [bool; 3],
    /// k.
    scale: f64,
    /// τ₀.
    start: f64,
    /// The uncertainty of k s − τ₀: (S7).
    blur: f64,
}

/// The start of a ray in the form that the box test uses: branch-free, for loops.
pub(super) struct SlabStart {
    /// Per axis 1/|d|.
    pub inverse: [f64; 3],
    /// τ₀.
    pub start: f64,
    /// The uncertainty of k s − τ₀: (S7).
    pub blur: f64,
    /// r, if the start is near.
    pub base: DVec3,
    /// ρ: (S2).
    pub unsure: f64,
    /// Whether it certainly misses everything.
    pub misses: bool,
    /// Whether its values are within the limits.
    pub is_valid: bool,
    /// Whether the origin is moved in f64: (S2).
    pub is_near: bool,
}

/// 1/|d| beyond which an axis is traversed as if it were this: (S4).
pub(super) const STEEP: f64 = power_of_two(60);
/// |d| below which the ray stays between the planes of an axis for all distances that matter.
const FLAT: f64 = power_of_two(-500);
/// Origins farther than this many scene sizes hit nothing.
const FAR: f64 = power_of_two(100);
/// Beyond this, rebasing needs more than f64: (S2).
const NEAR: f64 = power_of_two(8);

impl SlabStart {
    /// For a ray from `origin` in tree space.
    #[inline(always)]
    pub fn of(space: &TreeSpace, origin: DVec3, d: DVec3, s_min: f64) -> SlabStart {
        let inverse = [
            1.0 / greater(d.x.abs(), FLAT),
            1.0 / greater(d.y.abs(), FLAT),
            1.0 / greater(d.z.abs(), FLAT),
        ];
        let distance = greater(greater(origin.x.abs(), origin.y.abs()), origin.z.abs());
        // τ₀ (S6), and whether the ray leaves the root box before it.
        let (enter, leave) = root_interval(space, origin, d, inverse);
        let first = s_min * space.scale;
        let start = greater(enter - margin(enter, -49), first - margin(first, -36));
        let blur = margin(start, -36);
        SlabStart {
            inverse,
            start,
            blur,
            base: origin + d * start,
            unsure: power_of_two(-40) + power_of_two(-98) * distance,
            misses: leave < start - blur,
            // Written so that NaN takes this branch, too.
            is_valid: (distance <= FAR) & (blur < f64::INFINITY),
            is_near: (distance <= NEAR) & (start <= NEAR),
        }
    }
}

impl SlabRay {
    /// The ray from parameter `s_min` on; `None` if it misses everything.
    #[inline(always)]
    pub fn new(space: &TreeSpace, line: &Line, s_min: f64) -> Option<SlabRay> {
        let d = line.direction;
        let start = SlabStart::of(space, space.map(line.origin), d, s_min);
        if start.misses || !start.is_valid {
            return None;
        }
        // r (S2).
        let base = match start.is_near {
            true => start.base,
            false => rebase(line, space, start.start),
        };
        let inverse = start.inverse;
        Some(SlabRay {
            origin: base.to_array().map(|r| origin_lanes(r, start.unsure)),
            inverse: inverse.map(inverse_lanes),
            descends: [d.x < 0.0, d.y < 0.0, d.z < 0.0],
            scale: space.scale,
            start: start.start,
            blur: start.blur,
        })
    }

    /// The range for clipping while hits up to parameter `s` matter: (S7), and (S4) for t itself.
    #[inline(always)]
    pub fn range(&self, s: f64) -> Vec4 {
        let far = far_of(s * self.scale - self.start, self.blur);
        // Boxes are entered at t ≥ 0 and left at `far` at most; exits are negated.
        Vec4::new(0.0, 0.0, -far, -far)
    }

    /// For both children of `node`: the entry parameters (lanes 0, 1) and the negated exit parameters (2, 3), bounded by `range`. The type
    /// parameters say along which axes the ray descends.
    #[inline(always)]
    pub fn clip<const X: bool, const Y: bool, const Z: bool>(
        &self,
        node: &Node,
        range: Vec4,
    ) -> Vec4 {
        let x = distances::<X>(node.planes[0], self.origin[0], self.inverse[0]);
        let y = distances::<Y>(node.planes[1], self.origin[1], self.inverse[1]);
        let z = distances::<Z>(node.planes[2], self.origin[2], self.inverse[2]);
        // One maximum for both: the latest entry, and the negated earliest exit.
        x.max(y).max(z.max(range))
    }
}

/// The children that are hit, as bits: those for which [`SlabRay::clip`] leaves an interval.
#[inline(always)]
pub(super) fn hit_children(clip: Vec4) -> u32 {
    // Entry ≤ exit, computed as the sum of the entry and the negated exit.
    let length: BVec4A = (clip + clip.zwxy()).cmple(Vec4::ZERO);
    length.bitmask() & 3
}

/// Along one axis: entries into both children, and negated exits.
#[inline(always)]
fn distances<const DESCENDS: bool>(planes: Vec4, origin: Vec4, inverse: Vec4) -> Vec4 {
    let distance = planes - origin;
    if DESCENDS {
        // A descending ray crosses the upper planes first. Their difference is already negated.
        distance.zwxy() * inverse
    } else {
        distance * inverse
    }
}

/// 2^`exponent` (1 + |τ|).
#[inline(always)]
fn margin(tau: f64, exponent: i64) -> f64 {
    power_of_two(exponent) * (1.0 + tau.abs())
}

/// The parameters τ at which the line enters and leaves the root box.
#[inline(always)]
fn root_interval(space: &TreeSpace, origin: DVec3, d: DVec3, inverse: [f64; 3]) -> (f64, f64) {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let below = space.lo[axis] - origin[axis];
        let above = space.hi[axis] - origin[axis];
        let (near, far) = if d[axis] < 0.0 {
            (-above, -below)
        } else {
            (below, above)
        };
        enter = greater(near * inverse[axis], enter);
        leave = lesser(far * inverse[axis], leave);
    }
    (enter, leave)
}

/// o' + τ d with the rounding errors of the difference and of the product carried along: (S2).
#[cold]
#[inline(never)]
fn rebase(line: &Line, space: &TreeSpace, start: f64) -> DVec3 {
    let coordinate = |axis: usize| {
        let (high, low) = two_sum(line.origin[axis], -space.centre[axis]);
        let (high, low) = (high * space.scale, low * space.scale);
        let (step, step_low) = two_product(start, line.direction[axis]);
        let (sum, rest) = two_sum(high, step);
        sum + (rest + (low + step_low))
    };
    DVec3::new(coordinate(0), coordinate(1), coordinate(2))
}

/// The t beyond which no box matters while hits up to t as k s − τ₀ do: (S7), and (S4) for t itself.
#[inline(always)]
pub(super) fn far_of(t: f64, blur: f64) -> f32 {
    (t + t.abs() * power_of_two(-22) + blur) as f32
}

/// Along an axis r₊, for lower planes, and r₋, for upper planes: (S3).
#[inline(always)]
fn origins_of(r: f64, unsure: f64) -> [f32; 2] {
    const ROUNDING: f64 = power_of_two(-24) + power_of_two(-44);
    let margin = r.abs() * ROUNDING + unsure;
    [(r + margin) as f32, (r - margin) as f32]
}

/// Along an axis 1/|d| for entries and for exits: (S4).
#[inline(always)]
fn inverses_of(inverse: f64) -> [f32; 2] {
    let inverse = lesser(inverse, STEEP);
    let enter = (inverse * (1.0 - power_of_two(-22))) as f32;
    let leave = (inverse * (1.0 + power_of_two(-22))) as f32;
    [enter, leave]
}

#[inline(always)]
fn origin_lanes(r: f64, unsure: f64) -> Vec4 {
    let [above, below] = origins_of(r, unsure);
    Vec4::new(above, above, -below, -below)
}

#[inline(always)]
fn inverse_lanes(inverse: f64) -> Vec4 {
    let [enter, leave] = inverses_of(inverse);
    Vec4::new(enter, enter, leave, leave)
}
