//! Triangle setup: eight triangles of a leaf as the rays of a block see them, in f32 with bounds.
//!
//! With the corners a, b, c relative to a point near the rays, e₁ = b − a, e₂ = c − a, e₃ = c − b, n = e₁ × e₂, and for each ray the
//! offset δ from that point to its start and its moment m = δ × d, the edge functions and the determinant of single rays are products of
//! ray terms and triangle terms:
//!
//! ```text
//! U = d·p − m·e₂,  p = e₂ × a;   V = d·q + m·e₁,  q = a × e₁;   W = d·r + m·e₃,  r = b × e₃;
//! Δ = d·n;   s = (n·a − n·δ) / Δ.
//! ```
//!
//! (det(d, a − δ, e) = det(d, a, e) − det(d, δ, e), and d·(e × δ) = e·m.) Rays that share their origin have δ = m = 0, and those terms
//! vanish. If the origin is off the triangle's plane, on the side given by σ, the sign of n·a − n·δ, then a hit with s > 0 has the sign σ
//! in Δ, hence in U, V and W: with all multiplied by σ it is a hit iff none is negative. Lengths are in tree space.
//!
//! Rays of a block may start on both sides of a triangle's plane. Then each has its own σ, the sign of its n·a − n·δ, if that exceeds its
//! bound δᵥ; if σ is the opposite of the block's, U, V, W, Δ and n·a − n·δ change sign, and their bounds stay. If it is within the bound,
//! the ray may start in the plane, and f64 decides; a ray that leaves a triangle cannot hit it again, and is not tested.
//!
//! **Bounds.** Let v = 2⁻²⁴, |d|∞ ≤ D, |m|∞ ≤ M, |δᵢ| ≤ ωᵢ, ω = |ω|₁, η the uncertainty of a corner's position relative to the point, Aₒ
//! the leaf's centre relative to it (rounded: v|Aₒ|), lᵢ = |eᵢ|₁, L = l₁ + l₂ ≥ l₃ and T = |a|₁ + l₁ + |Aₒ|∞. Corners have errors of at
//! most η + v T, edges 2 η + v lᵢ. With |x × y|₁ ≤ |x|₁|y|₁, 2|x|∞|y|₁:
//!
//! - (E1) p, q and r have an error of 6 v lᵢ T + η (4 T + 2 L) (errors of the factors and two roundings of each product);
//! - (E2) rounding the direction adds v; a product with d undergoes at most 4 roundings, or 7 if there is one with m, too; m has an error
//!   of v itself. In total the error of U is below 13 v D lᵢ T + η D (4 T + 2 L), and with moments below
//!   16 v D lᵢ T + 11 v M lᵢ + η (D (4 T + 2 L) + 6 M);
//! - (E3) n has an error of 6 v l₁l₂ + 4 η L, Δ one of D (11 v l₁l₂ + 4 η L);
//! - (E4) n·a − n·δ has an error of 14 v l₁l₂ (T + ω) + η (4 L (T + ω) + l₁l₂).
//!
//! The slacks in the code are these with the next larger factor, which covers the rounding of the slacks themselves, and in addition:
//!
//! - (E5) B₆₄ = 2⁻⁴⁴ max(1, D) L (T + L + F), with F the distance of the rays' farthest origin from the point, is 2⁷ times the bound of
//!   `Line::bound`, and covers the f64 errors in m and in η. For n·a − n·δ it has (T + L + F) in place of D. Underflow adds
//!   less than 2⁻¹²⁰.
//!
//! So U + B ≥ 0 as computed wherever U ≥ 0, and where U ≥ B, likewise V and W, single rays find a hit without exact arithmetic: the sign is
//! certain for f64, too. Single rays compute s from n·a and Δ in f64, or move it between that and the true value; both are within
//!
//! ```text
//! (E6)   (n·a − n·δ − δᵥ)/(Δ + B) < s < (n·a − n·δ + δᵥ)/(Δ − B)     where Δ > B,
//! ```
//!
//! with δᵥ the bound of n·a − n·δ plus 5 v of it: two sums are rounded by v each, and a quotient has an error of 2 v.
//!
//! - (E7) Rays that start near a point, and are treated as starting there ((K5) of [`block`](super::block)), omit e·m and n·δ. With |m|∞ ≤ M' and
//!   |n|∞ ≤ l₁l₂ these are at most M' lᵢ in U, V and W, and ω l₁l₂ in n·a.

use glam::DVec3;

use super::block::{Block, BlockBounds};
use super::ray_set::RaySet;
use super::simd::{Simd, load_vectors};
use crate::accel::float::power_of_two;
use crate::accel::wide::{WIDTH, WideLeaf};

/// A number per triangle.
type Lane = [f32; WIDTH];

/// The triangles of a leaf, set up for a block. Everything except sizes is multiplied by σ.
#[repr(C, align(64))]
pub(super) struct LeafTriangles {
    /// p, q and r.
    pub edge_normals: [[Lane; 3]; 3],
    /// −e₂, e₁ and e₃, if rays have moments.
    edges: [[Lane; 3]; 3],
    /// The B of U, V and W.
    pub slack: [Lane; 3],
    /// n.
    normal: [Lane; 3],
    /// The B of Δ.
    normal_slack: Lane,
    /// n·a.
    volume: Lane,
    /// δᵥ.
    volume_slack: Lane,
    /// The triangles that rays of the block may hit, as bits.
    pub candidates: u32,
    /// The triangles whose σ is certain for all rays, as bits.
    pub certain: u32,
    /// The triangles in front of which all rays start, if σ is certain, as bits.
    pub front: u32,
    /// For each triangle the quarters of the block in which rays may hit it, as bits.
    pub quarters: [u8; WIDTH],
}

/// The data of a block that the setup needs, in all lanes.
pub(super) struct TriangleSetup<K: Simd> {
    kernel: K,
    origin: DVec3,
    /// The middle and half-width of directions.
    direction: [[K::F; 3]; 2],
    /// The same for moments.
    moment: [[K::F; 3]; 2],
    /// ωᵢ.
    offset: [K::F; 3],
    /// ω.
    spread: f32,
    /// D.
    max_direction: f32,
    /// M.
    max_moment: f32,
    /// M', for rays that share an origin.
    shift_moment: f32,
    /// The position uncertainty of f64.
    blur: f32,
    /// F.
    max_distance: f32,
    /// All bits set if rays are traced from their ends, and thus come from the other side.
    back: u32,
}

/// v.
const V: f32 = power_of_two(-24) as f32;
/// (E5).
const UNDERFLOW: f32 = power_of_two(-120) as f32;

impl<K: Simd> TriangleSetup<K> {
    /// For a block with these `bounds`, and a kernel with as many lanes as leaves have triangles.
    #[inline(always)]
    pub fn new(k: K, bounds: &BlockBounds) -> TriangleSetup<K> {
        TriangleSetup {
            kernel: k,
            origin: bounds.point,
            direction: middle(k, &bounds.directions, bounds.max_direction),
            moment: middle(k, &bounds.moments, bounds.max_moment),
            offset: k.splat3(bounds.offsets),
            spread: bounds.offsets[0] + bounds.offsets[1] + bounds.offsets[2],
            max_direction: bounds.max_direction,
            max_moment: bounds.max_moment,
            blur: ((1.0 + bounds.point.abs().max_element()) * power_of_two(-50)) as f32,
            shift_moment: bounds.shift_moment,
            max_distance: bounds.max_distance,
            back: if bounds.reversed { u32::MAX } else { 0 },
        }
    }

    /// Sets up the triangles of `leaf` that rays may hit before `limit`.
    #[inline(always)]
    pub fn set_up<R: RaySet, const CERTIFIED: bool>(
        &self,
        leaf: &WideLeaf,
        limit: f32,
        triangles: &mut LeafTriangles,
    ) {
        let k = self.kernel;
        // Corners relative to the point, and edges.
        let [x, y, z] = leaf.centre;
        let centre = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) - self.origin;
        let centre = [centre.x as f32, centre.y as f32, centre.z as f32];
        let zero = k.splat(0.0);
        let (mut a, mut b) = ([zero; 3], [zero; 3]);
        let (mut e1, mut e2, mut e3) = ([zero; 3], [zero; 3], [zero; 3]);
        let mut axis = 0;
        while axis < 3 {
            let place = k.splat(centre[axis]);
            let w0 = k.load(&leaf.corners[0][axis]);
            let w1 = k.load(&leaf.corners[1][axis]);
            let w2 = k.load(&leaf.corners[2][axis]);
            a[axis] = k.add(place, w0);
            b[axis] = k.add(place, w1);
            e1[axis] = k.sub(w1, w0);
            e2[axis] = k.sub(w2, w0);
            e3[axis] = k.sub(w2, w1);
            axis += 1;
        }
        // n, n·a, and p, q, r with the edges that belong to them.
        let n = cross(k, &e1, &e2);
        let volume = k.dot(&n, &a, zero);
        let edge_normals = [cross(k, &e2, &a), cross(k, &a, &e1), cross(k, &b, &e3)];
        let e2 = [k.sub(zero, e2[0]), k.sub(zero, e2[1]), k.sub(zero, e2[2])];
        let edges = [e2, e1, e3];
        let lengths = [norm1(k, &e2), norm1(k, &e1), norm1(k, &e3)];
        let size = greatest(&centre);
        let slacks = if CERTIFIED {
            // T; and η: the rounding of the leaf's corners, plus the uncertainty of f64.
            let far = k.add(k.add(norm1(k, &a), lengths[1]), k.splat(size));
            self.slacks::<R>(&lengths, far, leaf.error + self.blur)
        } else {
            Slacks {
                edges: [zero; 3],
                normal: zero,
                volume: zero,
            }
        };
        // σ is certain if |n·a| exceeds the bound of n·a and |n·δ|.
        let ambiguous = if R::OWN_ORIGINS {
            k.dot(&self.offset, &absolute(k, &n), slacks.volume)
        } else {
            slacks.volume
        };
        let distance = k.abs(volume);
        triangles.certain = k.le(ambiguous, distance);
        // Without bounds, a single origin uses the computed σ.
        if !CERTIFIED && !R::OWN_ORIGINS {
            triangles.certain = u32::MAX;
        }
        // From the sign bit, like σ, even if n·a is zero.
        triangles.front = k.signs(volume) ^ self.back;
        k.store(&mut triangles.volume, distance);
        k.store(&mut triangles.volume_slack, slacks.volume);
        k.store(&mut triangles.normal_slack, slacks.normal);
        // Triangles that some ray may be inside of: the maximum of d·p + m·e + B over the block is not negative.
        let mut candidates = leaf.present;
        let mut edge = 0;
        while edge < 3 {
            let p = flipped(k, &edge_normals[edge], volume);
            let mut most = k.dot(&self.direction[0], &p, slacks.edges[edge]);
            most = k.dot(&self.direction[1], &absolute(k, &p), most);
            store3(k, &mut triangles.edge_normals[edge], &p);
            if R::OWN_ORIGINS {
                let side = flipped(k, &edges[edge], volume);
                most = k.dot(&self.moment[0], &side, most);
                most = k.dot(&self.moment[1], &absolute(k, &side), most);
                store3(k, &mut triangles.edges[edge], &side);
            }
            k.store(&mut triangles.slack[edge], slacks.edges[edge]);
            candidates &= k.le(zero, most);
            edge += 1;
        }
        // And that some ray may reach before the limit: s ≤ limit in (E6).
        let normal = flipped(k, &n, volume);
        store3(k, &mut triangles.normal, &normal);
        let mut most = k.dot(&self.direction[0], &normal, slacks.normal);
        most = k.dot(&self.direction[1], &absolute(k, &normal), most);
        // 4 v for the rounding of the two products and of the subtrahend.
        let least = k.sub(k.mul(distance, k.splat(1.0 - 4.0 * V)), ambiguous);
        candidates &= k.le(least, k.mul(most, k.splat(limit)));
        // Triangles whose σ is uncertain are always candidates.
        let hidden = leaf.front_only & !triangles.front;
        triangles.candidates =
            (candidates & !hidden & triangles.certain) | (leaf.present & !triangles.certain);
    }

    /// The slacks for edges with these lengths (of U, V and W), T = `far` and η = `error`.
    #[inline(always)]
    fn slacks<R: RaySet>(&self, [l2, l1, l3]: &[K::F; 3], far: K::F, error: f32) -> Slacks<K::F> {
        let k = self.kernel;
        // (E2): 14 for 13, 17 for 16.
        let roundings = if R::OWN_ORIGINS { 17.0 } else { 14.0 };
        let length = k.add(*l1, *l2);
        let (both, area) = (k.add(far, length), k.mul(*l1, *l2));
        let beyond = k.add(both, k.splat(self.max_distance));
        // B₆₄: (E5).
        let double = k.mul(k.splat(power_of_two(-44) as f32), k.mul(length, beyond));
        let reach = if self.max_direction > 1.0 {
            self.max_direction
        } else {
            1.0
        };
        let floor = k.mul_add(double, k.splat(reach), k.splat(UNDERFLOW));
        // U, V and W: (E2) with 4.1 (T + L) for 4 T + 2 L, 6.1 for 6 and 12 for 11; for a shared origin (E7) with 1.1 for 1.
        let mut common = k.mul_add(both, k.splat(4.1 * self.max_direction * error), floor);
        let mut moment = 1.1 * self.shift_moment;
        if R::OWN_ORIGINS {
            common = k.add(common, k.splat(6.1 * error * self.max_moment));
            moment = 12.0 * V * self.max_moment;
        }
        let rounding = k.splat(roundings * V * self.max_direction);
        let each = k.mul_add(far, rounding, k.splat(moment));
        // Δ: (E3) with 4.1 for 4 and 12 for 11.
        let along = k.mul_add(length, k.splat(4.1 * error), k.mul(area, k.splat(12.0 * V)));
        // n·a − n·δ: (E4) with 15 for 14, 4.1 for 4 and 1.1 for 1, and (E7) with the same.
        let out = k.add(far, k.splat(self.spread));
        let volume = k.mul_add(k.mul(area, k.splat(15.0 * V)), out, k.splat(UNDERFLOW));
        let volume = k.mul_add(k.mul(length, k.splat(4.1 * error)), out, volume);
        let left_out = if R::OWN_ORIGINS { 0.0 } else { self.spread };
        let volume = k.mul_add(area, k.splat(1.1 * (error + left_out)), volume);
        Slacks {
            edges: [
                k.mul_add(*l2, each, common),
                k.mul_add(*l1, each, common),
                k.mul_add(*l3, each, common),
            ],
            normal: k.mul_add(along, k.splat(self.max_direction), floor),
            volume: k.mul_add(double, beyond, volume),
        }
    }
}

struct Slacks<F> {
    edges: [F; 3],
    normal: F,
    volume: F,
}

/// The midpoint of intervals, and half their lengths plus 2⁻²⁰ of `greatest` for the rounding of products with them.
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
pub(super) fn absolute<K: Simd>(k: K, x: &[K::F; 3]) -> [K::F; 3] {
    [k.abs(x[0]), k.abs(x[1]), k.abs(x[2])]
}

#[inline(always)]
fn norm1<K: Simd>(k: K, x: &[K::F; 3]) -> K::F {
    k.add(k.add(k.abs(x[0]), k.abs(x[1])), k.abs(x[2]))
}

/// `x` with its sign flipped where `by` is negative.
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

impl LeafTriangles {
    /// No triangles.
    pub const NONE: LeafTriangles = LeafTriangles {
        edge_normals: [[[0.0; WIDTH]; 3]; 3],
        edges: [[[0.0; WIDTH]; 3]; 3],
        slack: [[0.0; WIDTH]; 3],
        normal: [[0.0; WIDTH]; 3],
        normal_slack: [0.0; WIDTH],
        volume: [0.0; WIDTH],
        volume_slack: [0.0; WIDTH],
        candidates: 0,
        certain: 0,
        front: 0,
        quarters: [0; WIDTH],
    };

    /// The same with the opposite σ for triangle `at`.
    #[cold]
    pub fn with_other_side(&self, at: usize) -> LeafTriangles {
        let mut triangles = LeafTriangles { ..*self };
        let vectors = [&mut triangles.edge_normals, &mut triangles.edges];
        for lane in vectors.into_iter().flatten().flatten() {
            lane[at] = -lane[at];
        }
        for lane in &mut triangles.normal {
            lane[at] = -lane[at];
        }
        triangles.volume[at] = -triangles.volume[at];
        triangles.front ^= 1 << at;
        triangles
    }
}

/// A triangle of [`LeafTriangles`], in all lanes of a packet of rays.
pub(super) struct PacketTriangle<'a, K: Simd> {
    kernel: K,
    triangles: &'a LeafTriangles,
    at: usize,
    edge_normals: [[K::F; 3]; 3],
    edges: [[K::F; 3]; 3],
    slack: [K::F; 3],
}

impl<'a, K: Simd> PacketTriangle<'a, K> {
    /// The triangle in lane `at`.
    #[inline(always)]
    pub fn new<R: RaySet>(k: K, triangles: &'a LeafTriangles, at: usize) -> PacketTriangle<'a, K> {
        let at = at % WIDTH;
        let zero = [k.splat(0.0); 3];
        let mut triangle = PacketTriangle {
            kernel: k,
            triangles,
            at,
            edge_normals: [zero; 3],
            edges: [zero; 3],
            slack: zero,
        };
        let mut edge = 0;
        while edge < 3 {
            triangle.edge_normals[edge] = lane3(k, &triangles.edge_normals[edge], at);
            if R::OWN_ORIGINS {
                triangle.edges[edge] = lane3(k, &triangles.edges[edge], at);
            }
            triangle.slack[edge] = k.splat(triangles.slack[edge][at]);
            edge += 1;
        }
        triangle
    }

    /// U + B, V + B and W + B for the rays of `block` from `first` on, whose directions are `d`.
    #[inline(always)]
    pub fn edge_functions<R: RaySet>(
        &self,
        d: &[K::F; 3],
        block: &Block,
        first: usize,
    ) -> [K::F; 3] {
        let k = self.kernel;
        let m = match R::OWN_ORIGINS {
            true => load_vectors(k, &block.moments, first),
            false => *d,
        };
        let mut sums = self.slack;
        let mut edge = 0;
        while edge < 3 {
            if R::OWN_ORIGINS {
                sums[edge] = k.dot(&m, &self.edges[edge], sums[edge]);
            }
            sums[edge] = k.dot(d, &self.edge_normals[edge], sums[edge]);
            edge += 1;
        }
        sums
    }

    /// The same for rays that start on the other side, whose σ is the opposite: B − U, B − V and B − W.
    #[inline(always)]
    pub fn of_other_side(&self, edge_functions: &[K::F; 3]) -> [K::F; 3] {
        let (k, [b, c, e]) = (self.kernel, &self.slack);
        let [u, v, w] = edge_functions;
        [
            k.sub(*b, k.sub(*u, *b)),
            k.sub(*c, k.sub(*v, *c)),
            k.sub(*e, k.sub(*w, *e)),
        ]
    }

    /// The lanes in which U, V and W are certainly positive.
    #[inline(always)]
    pub fn is_certainly_inside(&self, edge_functions: &[K::F; 3]) -> u32 {
        let k = self.kernel;
        let [b, c, e] = &self.slack;
        let [u, v, w] = edge_functions;
        k.not_negative(
            k.sub(k.sub(*u, *b), *b),
            k.sub(k.sub(*v, *c), *c),
            k.sub(k.sub(*w, *e), *e),
        )
    }

    /// Δ.
    #[inline(always)]
    pub fn determinant(&self, d: &[K::F; 3]) -> K::F {
        let k = self.kernel;
        let normal = lane3(k, &self.triangles.normal, self.at);
        k.dot(d, &normal, k.splat(0.0))
    }

    /// The B of Δ.
    #[inline(always)]
    pub fn determinant_slack(&self) -> K::F {
        self.kernel.splat(self.triangles.normal_slack[self.at])
    }

    /// n·a − n·δ for the rays of `block` from `first` on.
    #[inline(always)]
    pub fn volume<R: RaySet>(&self, block: &Block, first: usize) -> K::F {
        let k = self.kernel;
        let volume = k.splat(self.triangles.volume[self.at]);
        if !R::OWN_ORIGINS {
            return volume;
        }
        let normal = lane3(k, &self.triangles.normal, self.at);
        let offsets = load_vectors(k, &block.offsets, first);
        k.sub(volume, k.dot(&offsets, &normal, k.splat(0.0)))
    }

    /// δᵥ for n·a − n·δ = `volume`, including 5 v of it: (E6).
    #[inline(always)]
    pub fn volume_slack(&self, volume: K::F) -> K::F {
        let k = self.kernel;
        let slack = k.splat(self.triangles.volume_slack[self.at]);
        k.mul_add(k.abs(volume), k.splat(5.0 * V), slack)
    }
}

#[inline(always)]
pub(super) fn lane3<K: Simd, const N: usize>(k: K, from: &[[f32; N]; 3], at: usize) -> [K::F; 3] {
    [
        k.splat(from[0][at]),
        k.splat(from[1][at]),
        k.splat(from[2][at]),
    ]
}
