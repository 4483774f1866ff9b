//! Eight triangles as the rays of a block see them, in f32 with bounds.
//!
//! With the corners a, b, c relative to a point near the rays, e₁ = b − a, e₂ = c − a, e₃ = c − b,
//! n = e₁ × e₂, and for each ray δ from that point to where it starts and its moment m = δ × d, the
//! quantities of the test of single rays are products of what is the ray's and what is the triangle's:
//!
//! ```text
//! U = d·p − m·e₂,  p = e₂ × a;   V = d·q + m·e₁,  q = a × e₁;   W = d·r + m·e₃,  r = b × e₃;
//! Δ = d·n;   s = (n·a − n·δ) / Δ.
//! ```
//!
//! (det(d, a − δ, e) = det(d, a, e) − det(d, δ, e), and d·(e × δ) = e·m.) Rays that share their origin have
//! δ = m = 0, and those terms are not there. Where the origin is off the triangle's plane, on the side that σ, the sign
//! of n·a − n·δ, says, a hit with s > 0 has the sign σ in Δ, hence in U, V and W: with all multiplied by σ it is a
//! hit iff none is negative. Lengths are in the frame of the boxes.
//!
//! **Bounds.** Let v = 2⁻²⁴, |d|∞ ≤ D, |m|∞ ≤ M, |δᵢ| ≤ ωᵢ, ω = |ω|₁, η what is unknown about a corner's place relative to the
//! point, Aₒ the pack's centre relative to it (rounded: v|Aₒ|), lᵢ = |eᵢ|₁, L = l₁ + l₂ ≥ l₃ and
//! T = |a|₁ + l₁ + |Aₒ|∞. Corners are off by η + v T at most, edges by 2 η + v lᵢ. With
//! |x × y|₁ ≤ |x|₁|y|₁, 2|x|∞|y|₁:
//!
//! - p, q and r are off by 6 v lᵢ T + η (4 T + 2 L) (errors of the factors and two roundings of each product);
//! - rounding the direction adds v; a product with d passes at most 4 roundings, with m besides 7; m has
//!   its own v. In all U is off by less than 13 v D lᵢ T + η D (4 T + 2 L), and with moments by
//!   16 v D lᵢ T + 11 v M lᵢ + η (D (4 T + 2 L) + 6 M);
//! - n is off by 6 v l₁l₂ + 4 η L, Δ by D (11 v l₁l₂ + 4 η L), and n·a − n·δ by
//!   14 v l₁l₂ (T + ω) + η (4 L (T + ω) + l₁l₂).
//!
//! The slacks below are above these. B₆₄ = 2⁻⁴⁴ max(1, D) L (T + L + F), F the rays' farthest origin from the point, adds
//! 2⁷ times the bound of `Line::bound`, which covers what f64 does to m and to η. So U + B ≥ 0 as computed wherever
//! U ≥ 0, and where U ≥ B, likewise V and W, single rays find a hit by their usual way: the sign is
//! certain for f64, too. Single rays compute s from n·a and Δ in f64, or move it between that and the truth; both
//! are within
//!
//! ```text
//! (n·a − n·δ − δᵥ)/(Δ + B) < s < (n·a − n·δ + δᵥ)/(Δ − B)     where Δ > B,
//! ```
//!
//! with δᵥ the bound of n·a − n·δ and 2⁻²² of it for the roundings of sums and quotients. Underflow
//! adds less than 2⁻¹²⁰.

use glam::DVec3;

use super::block::View;
use super::simd::Simd;
use crate::accel::pack::Pack;
use crate::accel::slab::power_of_two;
use crate::accel::wide::WIDTH;

/// A number per triangle.
pub(super) type Lane = [f32; WIDTH];

/// Triangles before a block. Multiplied by σ, but for what is a size.
#[repr(C, align(64))]
pub(super) struct Facets {
    /// p, q and r.
    pub edges: [[Lane; 3]; 3],
    /// −e₂, e₁ and e₃, where rays have moments.
    pub sides: [[Lane; 3]; 3],
    /// Their B.
    pub slack: [Lane; 3],
    /// n.
    pub normal: [Lane; 3],
    /// Its B.
    pub normal_slack: Lane,
    /// n·a.
    pub volume: Lane,
    /// δᵥ.
    pub volume_slack: Lane,
    /// Whether rays of the block may meet it, as bits.
    pub met: u32,
    /// Whether σ is certain for all rays.
    pub certain: u32,
    /// Whether all rays start before the front, if it is.
    pub front: u32,
}

/// What all facets of a block have in common.
pub(super) struct Viewpoint<K: Simd> {
    kernel: K,
    origin: DVec3,
    /// The middle of directions, and how far they are off it.
    direction: [[K::F; 3]; 2],
    /// The same of moments.
    moment: [[K::F; 3]; 2],
    /// ωᵢ.
    offset: [K::F; 3],
    /// ω.
    spread: f32,
    /// D.
    reach: f32,
    /// M.
    turn: f32,
    /// What f64 leaves unknown about places.
    blur: f32,
    /// F.
    farthest: f32,
    /// All bits, if rays are traced from their ends: they come from the other side.
    back: u32,
}

/// v.
pub(super) const V: f32 = power_of_two(-24) as f32;
const UNDERFLOW: f32 = power_of_two(-120) as f32;

impl<K: Simd> Viewpoint<K> {
    #[inline(always)]
    pub fn new(k: K, view: &View) -> Viewpoint<K> {
        Viewpoint {
            kernel: k,
            origin: view.point,
            direction: middle(k, &view.directions, view.reach),
            moment: middle(k, &view.moments, view.turn),
            offset: k.splat3(view.offsets),
            spread: view.offsets[0] + view.offsets[1] + view.offsets[2],
            reach: view.reach,
            turn: view.turn,
            blur: ((1.0 + view.point.abs().max_element()) * power_of_two(-50)) as f32,
            farthest: view.farthest,
            back: if view.reversed { u32::MAX } else { 0 },
        }
    }

    /// The triangles of `pack`, as far as rays may meet them before `limit`.
    #[inline(always)]
    pub fn see<const OWN: bool, const CERTIFIED: bool>(
        &self,
        pack: &Pack,
        limit: f32,
        facets: &mut Facets,
    ) {
        let k = self.kernel;
        let [x, y, z] = pack.centre;
        let centre = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) - self.origin;
        let centre = [centre.x as f32, centre.y as f32, centre.z as f32];
        let zero = k.splat(0.0);
        let (mut a, mut b) = ([zero; 3], [zero; 3]);
        let (mut e1, mut e2, mut e3) = ([zero; 3], [zero; 3], [zero; 3]);
        let mut axis = 0;
        while axis < 3 {
            let place = k.splat(centre[axis]);
            let w0 = k.load(&pack.corners[0][axis]);
            let w1 = k.load(&pack.corners[1][axis]);
            let w2 = k.load(&pack.corners[2][axis]);
            a[axis] = k.add(place, w0);
            b[axis] = k.add(place, w1);
            e1[axis] = k.sub(w1, w0);
            e2[axis] = k.sub(w2, w0);
            e3[axis] = k.sub(w2, w1);
            axis += 1;
        }
        let n = cross(k, &e1, &e2);
        let volume = k.dot(&n, &a, zero);
        let edges = [cross(k, &e2, &a), cross(k, &a, &e1), cross(k, &b, &e3)];
        let e2 = [k.sub(zero, e2[0]), k.sub(zero, e2[1]), k.sub(zero, e2[2])];
        let sides = [e2, e1, e3];
        let lengths = [norm1(k, &e2), norm1(k, &e1), norm1(k, &e3)];
        let size = greatest(&centre);
        let slacks = if CERTIFIED {
            let far = k.add(k.add(norm1(k, &a), lengths[1]), k.splat(size));
            self.slacks::<OWN>(&lengths, far, pack.error + self.blur)
        } else {
            Slacks {
                edges: [zero; 3],
                normal: zero,
                volume: zero,
            }
        };
        // σ
        let ambiguous = if OWN {
            k.dot(&self.offset, &absolute(k, &n), slacks.volume)
        } else {
            slacks.volume
        };
        let distance = k.abs(volume);
        facets.certain = k.le(ambiguous, distance);
        if !CERTIFIED && !OWN {
            facets.certain = u32::MAX;
        }
        facets.front = k.le(volume, zero) ^ self.back;
        k.store(&mut facets.volume, distance);
        k.store(&mut facets.volume_slack, slacks.volume);
        k.store(&mut facets.normal_slack, slacks.normal);
        let mut met = pack.present;
        let mut edge = 0;
        while edge < 3 {
            let p = flipped(k, &edges[edge], volume);
            let mut most = k.dot(&self.direction[0], &p, slacks.edges[edge]);
            most = k.dot(&self.direction[1], &absolute(k, &p), most);
            store3(k, &mut facets.edges[edge], &p);
            if OWN {
                let side = flipped(k, &sides[edge], volume);
                most = k.dot(&self.moment[0], &side, most);
                most = k.dot(&self.moment[1], &absolute(k, &side), most);
                store3(k, &mut facets.sides[edge], &side);
            }
            k.store(&mut facets.slack[edge], slacks.edges[edge]);
            met &= k.le(zero, most);
            edge += 1;
        }
        let normal = flipped(k, &n, volume);
        store3(k, &mut facets.normal, &normal);
        let mut most = k.dot(&self.direction[0], &normal, slacks.normal);
        most = k.dot(&self.direction[1], &absolute(k, &normal), most);
        let least = k.sub(k.mul(distance, k.splat(1.0 - 4.0 * V)), ambiguous);
        met &= k.le(least, k.mul(most, k.splat(limit)));
        let hidden = pack.front_only & !facets.front;
        facets.met = (met & !hidden & facets.certain) | (pack.present & !facets.certain);
    }

    /// For edges of these lengths (of U, V and W), T = `far` and η = `error`.
    #[inline(always)]
    fn slacks<const OWN: bool>(
        &self,
        [l2, l1, l3]: &[K::F; 3],
        far: K::F,
        error: f32,
    ) -> Slacks<K::F> {
        let k = self.kernel;
        let roundings = if OWN { 17.0 } else { 14.0 };
        let length = k.add(*l1, *l2);
        let (both, area) = (k.add(far, length), k.mul(*l1, *l2));
        let beyond = k.add(both, k.splat(self.farthest));
        let double = k.mul(k.splat(power_of_two(-44) as f32), k.mul(length, beyond));
        let reach = if self.reach > 1.0 { self.reach } else { 1.0 };
        let floor = k.mul_add(double, k.splat(reach), k.splat(UNDERFLOW));
        let mut common = k.mul_add(both, k.splat(4.1 * self.reach * error), floor);
        let mut each = k.mul(far, k.splat(roundings * V * self.reach));
        if OWN {
            common = k.add(common, k.splat(6.1 * error * self.turn));
            each = k.add(each, k.splat(12.0 * V * self.turn));
        }
        let along = k.mul_add(length, k.splat(4.1 * error), k.mul(area, k.splat(12.0 * V)));
        let out = k.add(far, k.splat(self.spread));
        let volume = k.mul_add(k.mul(area, k.splat(15.0 * V)), out, k.splat(UNDERFLOW));
        let volume = k.mul_add(k.mul(length, k.splat(4.1 * error)), out, volume);
        let volume = k.mul_add(area, k.splat(1.1 * error), volume);
        Slacks {
            edges: [
                k.mul_add(*l2, each, common),
                k.mul_add(*l1, each, common),
                k.mul_add(*l3, each, common),
            ],
            normal: k.mul_add(along, k.splat(self.reach), floor),
            volume: k.mul_add(double, beyond, volume),
        }
    }
}

struct Slacks<F> {
    edges: [F; 3],
    normal: F,
    volume: F,
}

/// The middle of intervals, and half their lengths with 2⁻²⁰ of `greatest` for the roundings of products with them.
#[inline(always)]
fn middle<K: Simd>(k: K, intervals: &[[f32; 2]; 3], greatest: f32) -> [[K::F; 3]; 2] {
    let (mut middle, mut half) = ([0.0; 3], [0.0; 3]);
    let mut axis = 0;
    while axis < 3 {
        let [lo, hi] = intervals[axis];
        middle[axis] = lo * 0.5 + hi * 0.5;
        half[axis] = (hi * 0.5 - lo * 0.5) + power_of_two(-20) as f32 * greatest;
        axis += 1;
    }
    [k.splat3(middle), k.splat3(half)]
}

#[inline(always)]
fn cross<K: Simd>(k: K, x: &[K::F; 3], y: &[K::F; 3]) -> [K::F; 3] {
    [
        k.mul_sub(x[1], y[2], k.mul(x[2], y[1])),
        k.mul_sub(x[2], y[0], k.mul(x[0], y[2])),
        k.mul_sub(x[0], y[1], k.mul(x[1], y[0])),
    ]
}

#[inline(always)]
fn absolute<K: Simd>(k: K, x: &[K::F; 3]) -> [K::F; 3] {
    [k.abs(x[0]), k.abs(x[1]), k.abs(x[2])]
}

#[inline(always)]
fn norm1<K: Simd>(k: K, x: &[K::F; 3]) -> K::F {
    k.add(k.add(k.abs(x[0]), k.abs(x[1])), k.abs(x[2]))
}

/// `x`, with the other sign where `by` is negative.
#[inline(always)]
fn flipped<K: Simd>(k: K, x: &[K::F; 3], by: K::F) -> [K::F; 3] {
    [k.flip(x[0], by), k.flip(x[1], by), k.flip(x[2], by)]
}

#[inline(always)]
fn store3<K: Simd>(k: K, to: &mut [Lane; 3], x: &[K::F; 3]) {
    k.store(&mut to[0], x[0]);
    k.store(&mut to[1], x[1]);
    k.store(&mut to[2], x[2]);
}

/// |x|∞.
#[inline(always)]
fn greatest(x: &[f32; 3]) -> f32 {
    let mut most = 0.0;
    let mut axis = 0;
    while axis < 3 {
        most = if x[axis].abs() > most {
            x[axis].abs()
        } else {
            most
        };
        axis += 1;
    }
    most
}

impl Facets {
    /// No triangles.
    pub const NONE: Facets = Facets {
        edges: [[[0.0; WIDTH]; 3]; 3],
        sides: [[[0.0; WIDTH]; 3]; 3],
        slack: [[0.0; WIDTH]; 3],
        normal: [[0.0; WIDTH]; 3],
        normal_slack: [0.0; WIDTH],
        volume: [0.0; WIDTH],
        volume_slack: [0.0; WIDTH],
        met: 0,
        certain: 0,
        front: 0,
    };

    /// The same, with the other σ for triangle `at`.
    #[cold]
    pub fn turned(&self, at: usize) -> Facets {
        let mut facets = Facets { ..*self };
        let vectors = [&mut facets.edges, &mut facets.sides];
        for lane in vectors.into_iter().flatten().flatten() {
            lane[at] = -lane[at];
        }
        for lane in &mut facets.normal {
            lane[at] = -lane[at];
        }
        facets.volume[at] = -facets.volume[at];
        facets.front ^= 1 << at;
        facets
    }
}
