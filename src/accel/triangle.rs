//! The intersection of a ray with a triangle, decided as exact arithmetic would decide it.
//!
//! With the corners a, b, c relative to the ray's origin o, and e₁ = b − a, e₂ = c − a, n = e₁ × e₂,
//! Cramer's rule for s d = a + u e₁ + v e₂ gives (Möller, Trumbore, JGT 2(1), 1997)
//!
//! ```text
//! Δ = n·d,   U = (a × d)·e₂,   V = −(a × d)·e₁,   s = n·a / Δ,   u = U/Δ,   v = V/Δ.
//! ```
//!
//! U, V and W = Δ − U − V are d·(p × q) for the three edges. The line hits the closed triangle iff no two of them have opposite signs and
//! they are not all zero (then it is parallel).
//!
//! **(T1) Error bound.** Let ε = 2⁻⁵³, |d|∞ < 2 (the direction is scaled by a power of two), A = |a|₁ and L = |e₁|₁ + |e₂|₁. Every triple
//! product in U undergoes at most 7 roundings (two differences, two products, one subtraction, two additions), and the absolute values of
//! the six sum to at most |d|∞ |a|₁ |e₂|₁, so |δU| ≤ 7.1 ε · 2 A |e₂|₁; likewise V, and |δΔ| ≤ 7.1 ε · 2 |e₁|₁ |e₂|₁. W adds two
//! subtractions, each ≤ ε(|Δ| + |U| + |V|) ≤ 2 ε (A + L) L. In total each is within 14.2 ε (A + L) L + 4 ε (A + L) L < B = 20 ε (A + L) L,
//! with a margin for the rounding of B itself. The contribution of underflow is below 2⁻⁷⁰⁰ for coordinates below 2³⁰⁰.
//!
//! **(T2)** Beyond B a sign is certain. Otherwise all three are computed by [`exact`](super::exact), so that rays through a shared edge or
//! corner of closed meshes never fall between their triangles.

use glam::DVec3;

use super::exact;
use super::float::{greater, lesser, norm1, power_of_two};
use super::tally::{Counts, Work};

/// 20 ε: (T1).
const RELATIVE: f64 = 20.0 * (f64::EPSILON / 2.0);
/// Above any contribution of underflow: (T1).
const UNDERFLOW: f64 = power_of_two(-700);
/// Below this Δ/L² the rounding of s can leave the triangle's bounding box; see [`Line::clamped_to_box`].
pub(super) const GRAZING: f64 = 1.0 / 1024.0;

/// The line o + s d, |d|∞ in [1, 2).
pub(super) struct Line {
    pub origin: DVec3,
    pub direction: DVec3,
}

/// A point of a triangle on a line.
pub(super) struct Crossing {
    pub s: f64,
    pub u: f64,
    pub v: f64,
    /// Whether the line hits the side from which the corners run counter-clockwise.
    pub front: bool,
}

impl Line {
    /// The intersection of the line with the triangle; edges and corners belong to it.
    #[inline(always)]
    pub fn intersect(&self, corners: &[DVec3; 3], tally: &mut Counts) -> Option<Crossing> {
        let d = self.direction;
        let a = corners[0] - self.origin;
        let e1 = corners[1] - corners[0];
        let e2 = corners[2] - corners[0];
        let n = e1.cross(e2);
        let r = a.cross(d);
        let delta = n.dot(d);
        let u = r.dot(e2);
        let v = -r.dot(e1);
        let w = delta - u - v;
        // The signs of U, V and W, if they are certain: (T2).
        let length = norm1(e1) + norm1(e2);
        let bound = Line::bound(norm1(a), length);
        let (low, high) = (lesser(lesser(u, v), w), greater(greater(u, v), w));
        if low < -bound && high > bound {
            return None;
        }
        if low > bound || high < -bound {
            // s decides which triangle is nearest, so it is a separate quotient, with one rounding fewer than u and v.
            let inverse = 1.0 / delta;
            let s = n.dot(a) / delta;
            let s = if delta.abs() < GRAZING * (length * length) {
                self.clamped_to_box(s, corners)
            } else {
                s
            };
            return Some(Crossing {
                s,
                u: u * inverse,
                v: v * inverse,
                front: delta < 0.0,
            });
        }
        tally.add(Work::Exact, 1);
        self.intersect_exactly(corners)
    }

    /// B for A = `distance` and L = `length`: (T1).
    #[inline(always)]
    pub fn bound(distance: f64, length: f64) -> f64 {
        RELATIVE * (length * (distance + length)) + UNDERFLOW
    }

    /// [`Line::intersect`] with exact signs, and u, v, s to a few ulp.
    #[cold]
    #[inline(never)]
    fn intersect_exactly(&self, corners: &[DVec3; 3]) -> Option<Crossing> {
        let [a, b, c] = *corners;
        let edge = |p, q| exact::edge(self.origin, self.direction, p, q);
        let (u, v, w) = (edge(c, a), edge(a, b), edge(b, c));
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        // No cancellation: all have the same sign, or the ray misses.
        let delta = u + v + w;
        if !inside || delta == 0.0 {
            return None;
        }
        let s = exact::volume(self.origin, *corners) / delta;
        Some(Crossing {
            s: self.clamped_to_box(s, corners),
            u: u / delta,
            v: v / delta,
            front: delta < 0.0,
        })
    }

    /// `s`, moved into the interval in which the line is in the triangle's bounding box.
    ///
    /// The true s is in it, but the computed s of a grazing ray may not be. Then a box that was skipped because it lies beyond the nearest
    /// hit could have contained a nearer one: which triangle wins would depend on the order of traversal.
    #[inline(never)]
    fn clamped_to_box(&self, s: f64, corners: &[DVec3; 3]) -> f64 {
        let [a, b, c] = *corners;
        let inverse = self.direction.recip();
        let near = (a.min(b).min(c) - self.origin) * inverse;
        let far = (a.max(b).max(c) - self.origin) * inverse;
        // 0·∞ is NaN, which min and max of f64 ignore: a flat axis gives no bound.
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            if self.direction[axis] != 0.0 {
                enter = enter.max(near[axis].min(far[axis]));
                leave = leave.min(near[axis].max(far[axis]));
            }
        }
        s.min(leave).max(enter)
    }
}
