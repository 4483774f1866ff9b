//! Triangles as seen from a point: their solid angle, and uniform sampling in solid angle.
//!
//! # Solid angle
//!
//! With A, B, C from the point to the corners, r their lengths and a, b, c unit vectors,
//!
//! ```text
//! tan Ω/2 = |det(A, B, C)| / (r_A r_B r_C + A·B r_C + B·C r_A + C·A r_B),                            (1)
//! ```
//!
//! (van Oosterom and Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30, 1983), where det(A, B, C) is −A·N with the normal N
//! of length twice the area: no difference of nearly equal numbers, however far the triangle is.
//!
//! # Sampling
//!
//! The method of Arvo ("Stratified sampling of spherical triangles", SIGGRAPH 1995): find a point c′ on the arc from a to c for which the triangle (a, b,
//! c′) has the fraction ξ of the whole area, and on the arc from b to c′ a point uniform in the cosine from b. The first step does not need his angles:
//! let c′ = a cos φ + u sin φ, where u is the unit vector of c⊥ = c − (a·c) a, and τ = tan φ/2. In (1) all four terms of the denominator are linear in c′,
//! so that it is (1 + cos φ)(1 + a·b) + sin φ b·u, and the determinant is sin φ det(a, b, u). Hence, with T = tan ξΩ/2,
//!
//! ```text
//! T = τ det(a, b, u)/(1 + a·b + τ b·u),    τ = T (1 + a·b)/(det(a, b, u) − T b·u),
//! ```
//!
//! and, with p = cos(ξΩ/2) det(a, b, c) − sin(ξΩ/2) b·c⊥ and q = sin(ξΩ/2)(1 + a·b), c′ = ((p² − q² c⊥²) a + 2 p q c⊥)/(p² + q² c⊥²): one
//! sine, one cosine and one arctangent per sample (compare Peters, "BRDF importance sampling for polygonal lights", ACM TOG 40(4), 2021).

use glam::DVec3;

use crate::accel::arctan::upper_angle;
use crate::spacetime::unit_and_length_or_nan;

/// A triangle appears wide if its ball is nearer than this many of its radii, squared. Beyond that, the solid angle per area, proportional to
/// 1/r³ in a plane, differs from that in the middle by less than 3/32, and sampling by area is as good.
const WIDE: f64 = 32.0 * 32.0;

/// A triangle in its rest frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    /// A corner, and the edges from it.
    pub corner: DVec3,
    pub edges: [DVec3; 2],
    /// The normal with a length of twice the area, and that length.
    pub normal: DVec3,
    pub twice: f64,
}

impl Triangle {
    pub fn new([a, b, c]: [DVec3; 3]) -> Triangle {
        let normal = (b - a).cross(c - a);
        Triangle {
            corner: a,
            edges: [b - a, c - a],
            normal,
            twice: normal.length(),
        }
    }

    #[inline(always)]
    pub fn area(&self) -> f64 {
        0.5 * self.twice
    }

    pub fn corners(&self) -> [DVec3; 3] {
        let [e1, e2] = self.edges;
        [self.corner, self.corner + e1, self.corner + e2]
    }

    /// The point with these barycentrics.
    #[inline(always)]
    pub fn at(&self, (u, v): (f64, f64)) -> DVec3 {
        self.corner + self.edges[0] * u + self.edges[1] * v
    }

    /// Half of the solid angle that the triangle subtends at `x`; 0 from behind, unless it `is_two_sided`, which is 1 or 0.
    #[inline(always)]
    pub fn half_angle(&self, x: DVec3, is_two_sided: f64) -> f64 {
        let a = self.corner - x;
        let (b, c) = (a + self.edges[0], a + self.edges[1]);
        let (ra, rb, rc) = (a.length(), b.length(), c.length());
        let sum = ra * rb * rc + a.dot(b) * rc + b.dot(c) * ra + c.dot(a) * rb;
        // det(A, B, C) of (1), above 0 in front of the triangle.
        let front = -self.normal.dot(a);
        let back = -front * is_two_sided;
        let seen = if front > back { front } else { back };
        upper_angle(above_zero(seen), sum)
    }

    /// Barycentrics of a point sampled uniformly in area with two numbers in [0, 1).
    #[inline(always)]
    pub fn draw_by_area([x, y]: [f64; 2]) -> (f64, f64) {
        // The area up to a line across grows with the square of its distance from the corner, so that distance is √x.
        let root = x.sqrt();
        (root * (1.0 - y), root * y)
    }

    /// Barycentrics of a point sampled uniformly in the solid angle at `x`, half of which is h: with the sine and the cosine of ξ h and another
    /// number in [0, 1).
    #[inline(always)]
    pub fn draw_by_angle(&self, x: DVec3, (sine, cosine): (f64, f64), number: f64) -> (f64, f64) {
        let to_a = self.corner - x;
        let (to_b, to_c) = (to_a + self.edges[0], to_a + self.edges[1]);
        let (a, ra) = unit_and_length_or_nan(to_a);
        let (b, rb) = unit_and_length_or_nan(to_b);
        let (c, rc) = unit_and_length_or_nan(to_c);
        // c′ on the arc from a to c. Components across a are computed from differences, which are small if the triangle is.
        let (ab, ac) = (b - a, c - a);
        let (b_across, c_across) = (ab - a * a.dot(ab), ac - a * a.dot(ac));
        let determinant = self.normal.dot(to_a).abs() / (ra * rb * rc);
        let p = cosine * determinant - sine * b_across.dot(c_across);
        let q = sine * (1.0 + a.dot(b));
        let (p2, q2) = (p * p, q * q * c_across.dot(c_across));
        let on_arc = (a * (p2 - q2) + c_across * (2.0 * p * q)) / (p2 + q2);
        // From b towards c′, uniform in 1 − cos.
        let towards = on_arc - b;
        let less = number * 0.5 * towards.dot(towards);
        let across = towards - b * b.dot(towards);
        let sine = (less * (2.0 - less)).sqrt();
        let (along, _) = unit_and_length_or_nan(across);
        let d = b * (1.0 - less) + along * sine;
        // d as a combination of A, B and C: coefficients are below 0 only by rounding; NaN, if x is in the plane, becomes a corner.
        let side = if self.normal.dot(to_a) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let d = d * side;
        let of_a = above_zero(d.dot(to_b.cross(to_c)));
        let of_b = above_zero(d.dot(to_c.cross(to_a)));
        let of_c = above_zero(d.dot(to_a.cross(to_b)));
        let sum = of_a + of_b + of_c;
        let sum = if sum > 0.0 { sum } else { 1.0 };
        (of_b / sum, of_c / sum)
    }
}

/// x, or 0 if x is negative or NaN.
#[inline(always)]
pub(super) fn above_zero(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}

/// Whether a ball of radius √`radius2` appears wide from the distance √`distance2` of its centre.
#[inline(always)]
pub(super) fn is_wide(radius2: f64, distance2: f64) -> bool {
    distance2 < WIDE * radius2
}

#[cfg(test)]
mod tests;
