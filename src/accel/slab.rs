//! The f32 filter: which boxes a ray certainly misses.
//!
//! **Frame.** Boxes are stored as y = (x − c)·k with c the centre of the geometry and k a power of
//! two for which |y| ≤ 1 ([`Lattice`]). A ray o + s d, |d|∞ in [1, 2), is y = o' + τ d with τ = k s
//! (power of two: exact). So nothing here depends on the scale of the scene, nor on its place.
//!
//! **Rebasing.** The origin is moved to r = o' + τ₀ d with τ₀ near the entry into the root box (or
//! the ray's start, if later). For |o'| ≤ 2⁸ f64 does that within 2⁻⁵³(|o'| + 2|τ₀ d| + |r|) < 2⁻⁴²;
//! beyond, sum and product carry their rounding errors along, which leaves 2⁻⁵²|r| + 2⁻¹⁰⁰|o'|.
//! Both stay within ρ = 2⁻⁴⁰ + 2⁻⁹⁸|o'|∞ for |r| < 2¹². Where τ₀ itself is coarse, because the
//! origin is 2⁴⁰ scene sizes away or farther, |r| may be large; then 2⁻⁵²|r| is within the next term.
//!
//! **Origin.** r lies within [r₋, r₊], r∓ = f32(r ∓ (|r| 2⁻²⁴(1 + 2⁻²⁰) + ρ)): rounding to nearest
//! moves by at most 2⁻²⁴ of the value. Planes below (`lo`) take r₊, planes above (`hi`) take r₋:
//! that widens the box by exactly what is unknown about the origin.
//!
//! **Slope.** t = (plane − r)/d has one rounding in the difference, one in 1/d as f32, one in the
//! product: a relative error below 3.01·2⁻²⁴. 1/|d| is stored twice, times 1 − 2⁻²² for the planes
//! where the ray enters and times 1 + 2⁻²² for those where it leaves: no entry is late, no exit early.
//! An axis along which |d| < 2⁻⁶⁰ is traversed as if |d| = 2⁻⁶⁰: within the root box, where
//! |τ − τ₀| < 3 + 2⁻⁵⁰|o'|∞, that displaces by less than ρ.
//!
//! That holds for t ≥ 0. Exits at t < 0 would come early, hence τ₀ lies before all that is of interest.
//!
//! **Parameter.** s of a hit has an error below 2⁻⁴⁰ of the corners' distance where it isn't moved
//! into the box (see [`triangle`](super::triangle)), so a hit with s > s_min may truly lie a little before
//! k s_min: τ₀ ≤ k s_min − 2⁻³⁶(1 + |k s_min|). The computed entry into the root box (itself widened by
//! 2⁻³⁰ against the rounding of o') has a relative error below 8 ε: τ₀ ≤ entry − 2⁻⁴⁹(1 + |entry|).
//! For the same reason boxes are kept that are entered before k s − τ₀ + 2⁻³⁶(1 + |τ₀|), s the
//! parameter of the nearest hit so far.

use glam::{BVec4A, DVec3, Vec4, Vec4Swizzles};

use super::exact::{two_product, two_sum};
use super::triangle::Line;
use super::wide::Child;

/// Two child boxes, and where the children are. 64 bytes: a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Per axis: lo of child 0, lo of child 1, −hi of child 0, −hi of child 1.
    planes: [Vec4; 3],
    /// What the children are.
    pub links: [Link; 2],
    /// The line's end.
    _pad: [u32; 2],
}

/// The index of a node, or of a leaf's first slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub(super) struct Link(u32);

impl Link {
    const LEAF: u32 = 1 << 31;
    pub const ROOT: Link = Link(0);

    pub fn inner(node: usize) -> Link {
        Link(node as u32)
    }

    pub fn leaf(slot: usize) -> Link {
        Link(slot as u32 | Self::LEAF)
    }

    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// The node or the slot.
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }
}

impl Node {
    /// Two children that no ray meets.
    pub const NOTHING: Node = Node {
        planes: [Vec4::INFINITY; 3],
        links: [Link::ROOT; 2],
        _pad: [0; 2],
    };

    /// Sets a child and its box.
    pub fn set_child(&mut self, side: usize, link: Link, lo: [f32; 3], hi: [f32; 3]) {
        for axis in 0..3 {
            self.planes[axis][side] = lo[axis];
            self.planes[axis][side + 2] = -hi[axis];
        }
        self.links[side] = link;
    }

    /// The children that there are.
    pub fn children(&self) -> impl Iterator<Item = Child> + use<> {
        let node = *self;
        [0, 1].into_iter().filter_map(move |side| {
            let child = Child {
                link: node.links[side],
                lo: node.planes.map(|p| p[side]),
                hi: node.planes.map(|p| -p[side + 2]),
            };
            (child.lo[0] <= child.hi[0]).then_some(child)
        })
    }

    /// For both children: where the ray enters (lanes 0, 1) and minus where it leaves (2, 3), bounded
    /// by `range`. The type parameters say along which axes the ray descends.
    #[inline(always)]
    pub fn clip<const X: bool, const Y: bool, const Z: bool>(
        &self,
        ray: &Slabs,
        range: Vec4,
    ) -> Vec4 {
        let x = axis::<X>(self.planes[0], ray.origin[0], ray.inverse[0]);
        let y = axis::<Y>(self.planes[1], ray.origin[1], ray.inverse[1]);
        let z = axis::<Z>(self.planes[2], ray.origin[2], ray.inverse[2]);
        x.max(y).max(z.max(range))
    }
}

/// Lanes 0 and 1 of the result of [`Node::clip`] whose interval is not empty.
#[inline(always)]
pub(super) fn met(clip: Vec4) -> u32 {
    let length: BVec4A = (clip + clip.zwxy()).cmple(Vec4::ZERO);
    length.bitmask() & 3
}

#[inline(always)]
fn axis<const DESCENDS: bool>(planes: Vec4, origin: Vec4, inverse: Vec4) -> Vec4 {
    let distance = planes - origin;
    if DESCENDS {
        distance.zwxy() * inverse
    } else {
        distance * inverse
    }
}

/// The frame of the boxes: y = (x − c)·k.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lattice {
    pub centre: DVec3,
    pub scale: f64,
    /// The box of everything, widened by 2⁻³⁰.
    lo: DVec3,
    hi: DVec3,
}

/// 2^`exponent` for exponents of normal numbers.
pub(super) const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The exponent e of a positive normal x: 2^e ≤ x < 2^(e+1).
pub(super) fn exponent(x: f64) -> i64 {
    ((x.to_bits() >> 52) & 0x7ff) as i64 - 1023
}

impl Lattice {
    /// The frame for geometry within `lo` and `hi`, |coordinates| ≤ 2³⁰⁰.
    pub fn new(lo: DVec3, hi: DVec3) -> Lattice {
        let centre = lo * 0.5 + hi * 0.5;
        let half = (hi - centre).max(centre - lo).max_element();
        let scale = power_of_two(-(exponent(half).clamp(-400, 400) + 1));
        let margin = DVec3::splat(power_of_two(-30));
        Lattice {
            centre,
            scale,
            lo: (lo - centre) * scale - margin,
            hi: (hi - centre) * scale + margin,
        }
    }

    /// Where `point` is in the frame.
    #[inline(always)]
    pub fn place(&self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }

    /// The f32 box around `corners`: each bound moves outward by at least half an f32 ulp more than
    /// conversion to the nearest can move it inward, which covers the roundings of f64 before.
    pub fn bounds(&self, [a, b, c]: &[DVec3; 3]) -> ([f32; 3], [f32; 3]) {
        let lo = (a.min(*b).min(*c) - self.centre) * self.scale;
        let hi = (a.max(*b).max(*c) - self.centre) * self.scale;
        (
            lo.to_array().map(|y| (y as f32).next_down()),
            hi.to_array().map(|y| (y as f32).next_up()),
        )
    }
}

/// A ray as the boxes' filter sees it.
pub(super) struct Slabs {
    /// Per axis r₊, r₊, −r₋, −r₋.
    origin: [Vec4; 3],
    /// Per axis 1/|d|, a little less for entries and a little more for exits.
    inverse: [Vec4; 3],
    /// Along which axes the ray descends.
    pub descends: [bool; 3],
    /// k.
    scale: f64,
    /// τ₀.
    start: f64,
    /// What is unknown about k s − τ₀.
    blur: f64,
}

/// 1/|d| beyond which an axis is traversed as if it were this.
const STEEP: f64 = power_of_two(60);
/// |d| below which the ray stays between the planes of an axis for all distances that matter.
const FLAT: f64 = power_of_two(-500);
/// Origins farther than this many scene sizes meet nothing.
const FAR: f64 = power_of_two(100);
/// Beyond this, rebasing needs more than f64.
const NEAR: f64 = power_of_two(8);

impl Slabs {
    /// The ray from parameter `s_min` on, or none where it misses everything.
    #[inline(always)]
    pub fn new(lattice: &Lattice, line: &Line, s_min: f64) -> Option<Slabs> {
        let d = line.direction;
        let origin = lattice.place(line.origin);
        let inverse = [d.x, d.y, d.z].map(|d| 1.0 / greater(d.abs(), FLAT));
        let distance = greater(greater(origin.x.abs(), origin.y.abs()), origin.z.abs());
        let (enter, leave) = root_interval(lattice, origin, d, inverse);
        let first = s_min * lattice.scale;
        let start = greater(enter - before(enter, -49), first - before(first, -36));
        let blur = before(start, -36);
        let certain_miss = leave < start - blur;
        // In this form also for NaN.
        if certain_miss || !(distance <= FAR && blur < f64::INFINITY) {
            return None;
        }
        let base = if distance <= NEAR && start <= NEAR {
            origin + d * start
        } else {
            rebase(line, lattice, start)
        };
        let unsure = power_of_two(-40) + power_of_two(-98) * distance;
        Some(Slabs {
            origin: base.to_array().map(|r| origin_lanes(r, unsure)),
            inverse: inverse.map(inverse_lanes),
            descends: [d.x < 0.0, d.y < 0.0, d.z < 0.0],
            scale: lattice.scale,
            start,
            blur,
        })
    }

    /// The range to clip to while hits up to parameter `s` are of interest.
    #[inline(always)]
    pub fn range(&self, s: f64) -> Vec4 {
        let t = s * self.scale - self.start;
        let far = (t + t.abs() * power_of_two(-22) + self.blur) as f32;
        Vec4::new(0.0, 0.0, -far, -far)
    }
}

/// 2^`exponent` (1 + |τ|).
#[inline(always)]
fn before(tau: f64, exponent: i64) -> f64 {
    power_of_two(exponent) * (1.0 + tau.abs())
}

/// Where the line enters and leaves the root box, as τ.
#[inline(always)]
fn root_interval(lattice: &Lattice, origin: DVec3, d: DVec3, inverse: [f64; 3]) -> (f64, f64) {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let below = lattice.lo[axis] - origin[axis];
        let above = lattice.hi[axis] - origin[axis];
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

/// o' + τ d with the roundings of the difference and of the product carried along.
#[cold]
#[inline(never)]
fn rebase(line: &Line, lattice: &Lattice, start: f64) -> DVec3 {
    let coordinate = |axis: usize| {
        let (high, low) = two_sum(line.origin[axis], -lattice.centre[axis]);
        let (high, low) = (high * lattice.scale, low * lattice.scale);
        let (step, step_low) = two_product(start, line.direction[axis]);
        let (sum, rest) = two_sum(high, step);
        sum + (rest + (low + step_low))
    };
    DVec3::new(coordinate(0), coordinate(1), coordinate(2))
}

#[inline(always)]
fn origin_lanes(r: f64, unsure: f64) -> Vec4 {
    const ROUNDING: f64 = power_of_two(-24) + power_of_two(-44);
    let margin = r.abs() * ROUNDING + unsure;
    let (above, below) = ((r + margin) as f32, (r - margin) as f32);
    Vec4::new(above, above, -below, -below)
}

#[inline(always)]
fn inverse_lanes(inverse: f64) -> Vec4 {
    let inverse = lesser(inverse, STEEP);
    let enter = (inverse * (1.0 - power_of_two(-22))) as f32;
    let leave = (inverse * (1.0 + power_of_two(-22))) as f32;
    Vec4::new(enter, enter, leave, leave)
}

/// x if it is greater, else y: also where x is NaN.
#[inline(always)]
fn greater(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

#[inline(always)]
fn lesser(x: f64, y: f64) -> f64 {
    if x < y { x } else { y }
}
