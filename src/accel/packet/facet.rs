//! A triangle as all rays from one origin see it, in f32 with bounds.
//!
//! With the corners a, b, c relative to the origin, e₁ = b − a, e₂ = c − a, n = e₁ × e₂, the quantities
//! of the test of single rays are products of the direction with vectors that don't depend on it:
//!
//! ```text
//! U = d·p,  p = e₂ × a;   V = d·q,  q = a × e₁;   W = d·r,  r = n − p − q;   Δ = n·d,   s = n·a / Δ.
//! ```
//!
//! p, q, r, n and n·a are computed in f64, once per block of rays, and only then rounded. A hit with
//! s > 0 has the sign σ of n·a in Δ, hence in U, V and W: with all multiplied by σ it is a hit iff none
//! is negative. Lengths are in the tree's unit (κ = its scale: factors κ², κ³, powers of two), so that
//! nothing overflows.
//!
//! **Bounds.** Let v = 2⁻²⁴, D ≥ |d|∞. The direction and p are each rounded (2 v; |p|₁ is taken after that, a factor below
//! 1 + v), and a dot product with
//! an addend passes 4 roundings at most, fused or not: from U it deviates by less than
//! 6.1 v D |p|₁ + 4.1 v B, with B the addend; B = 8 v D |p|₁ + B₆₄ is above that, so that U + B ≥ 0 as
//! computed wherever U ≥ 0. B₆₄ = 4 max(1, D) · bound of `Line::bound` covers what f64 does to p (the bound
//! holds for |d|∞ < 2) and leaves U ≥ B certainly beyond the bound at which the f64 test would turn to
//! exact arithmetic. Where U + B ≥ 2 B, likewise V and W, the f64 test finds a hit by its usual way.
//! Δ gets the same bound. n·a is the very number of the f64 test; exact arithmetic could put it
//! off by bound·|a|₁. So s lies within
//!
//! ```text
//! (n·a − δ)/(Δ + B) < s < (n·a + δ)/(Δ − B)     where Δ − B > L²/1024,
//! ```
//!
//! δ including 2⁻²² n·a for the roundings of n·a, of the sums and of the quotient. Nearer to grazing the
//! f64 test moves s into the triangle's box, and nothing is said here about it. Underflow adds less
//! than 2⁻¹²⁰.

use glam::DVec3;

use crate::accel::slab::{Lattice, power_of_two};
use crate::accel::triangle::{GRAZING, Line, norm1};

/// A triangle before an origin. Multiplied by σ.
pub(super) struct Facet {
    /// p, q, r.
    pub edges: [[f32; 3]; 3],
    /// Their B.
    pub slack: [f32; 3],
    /// n.
    pub normal: [f32; 3],
    /// Its B.
    pub normal_slack: f32,
    /// L²/1024.
    pub grazing: f32,
    /// n·a − δ and n·a + δ.
    pub volume: [f32; 2],
    /// Whether σ is certain: whether the origin is certainly off the triangle's plane.
    pub certain: bool,
    /// Whether the origin is before the front.
    pub front: bool,
}

/// What all facets of a block have in common.
#[derive(Clone, Copy)]
pub(super) struct Viewpoint {
    origin: DVec3,
    /// κ² and κ³.
    area: f64,
    volume: f64,
    /// 8 v D.
    relative: f32,
    /// 4 max(1, D).
    absolute: f64,
}

const UNDERFLOW: f64 = power_of_two(-120);

impl Viewpoint {
    /// `reach` is D.
    #[inline(always)]
    pub fn new(origin: DVec3, lattice: &Lattice, reach: f64) -> Viewpoint {
        let area = lattice.scale * lattice.scale;
        Viewpoint {
            origin,
            area,
            volume: area * lattice.scale,
            relative: (power_of_two(-21) * reach) as f32,
            absolute: 4.0 * if reach > 1.0 { reach } else { 1.0 },
        }
    }

    /// B of a product with `v`.
    #[inline(always)]
    fn slack(&self, v: &[f32; 3], fixed: f32) -> f32 {
        (v[0].abs() + v[1].abs() + v[2].abs()) * self.relative + fixed
    }
}

#[inline(always)]
fn rounded(v: DVec3, scale: f64) -> [f32; 3] {
    [
        (v.x * scale) as f32,
        (v.y * scale) as f32,
        (v.z * scale) as f32,
    ]
}

impl Facet {
    /// The triangle with `corners`.
    #[inline(always)]
    pub fn new<const CERTIFIED: bool>(at: &Viewpoint, corners: &[DVec3; 3]) -> Facet {
        let a = corners[0] - at.origin;
        let e1 = corners[1] - corners[0];
        let e2 = corners[2] - corners[0];
        let n = e1.cross(e2);
        let (p, q) = (e2.cross(a), a.cross(e1));
        let r = n - p - q;
        let volume = n.dot(a);
        let sign = if volume < 0.0 { -1.0 } else { 1.0 };
        let area = at.area * sign;
        let mut facet = Facet {
            edges: [rounded(p, area), rounded(q, area), rounded(r, area)],
            slack: [0.0; 3],
            normal: rounded(n, area),
            normal_slack: 0.0,
            grazing: 0.0,
            volume: [(volume.abs() * at.volume) as f32; 2],
            certain: true,
            front: volume < 0.0,
        };
        if CERTIFIED {
            let (distance, length) = (norm1(a), norm1(e1) + norm1(e2));
            let bound = Line::bound(distance, length);
            let fixed = bound * at.absolute * at.area + UNDERFLOW;
            let fixed = fixed as f32;
            let [p, q, r] = &facet.edges;
            facet.slack = [at.slack(p, fixed), at.slack(q, fixed), at.slack(r, fixed)];
            facet.normal_slack = at.slack(&facet.normal, fixed);
            facet.grazing = (length * length * at.area * (GRAZING * 1.001) + UNDERFLOW) as f32;
            let unsure = bound * distance;
            facet.certain = volume.abs() > unsure;
            let (size, unsure) = (volume.abs() * at.volume, unsure * at.volume + UNDERFLOW);
            let margin = size * power_of_two(-22) + unsure;
            facet.volume = [(size - margin) as f32, (size + margin) as f32];
        }
        facet
    }

    /// With the other σ.
    pub fn flipped(&self) -> Facet {
        Facet {
            edges: self.edges.map(|e| e.map(|x| -x)),
            normal: self.normal.map(|x| -x),
            ..*self
        }
    }
}
