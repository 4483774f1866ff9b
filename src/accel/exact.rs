//! Determinants without rounding, for the few rays that floating point cannot decide.
//!
//! A sum of products of three f64 is stored as an *expansion*: f64 components of increasing size whose exact sum is the value, with no two
//! adjacent (Shewchuk, Discrete Comput. Geom. 18, 1997: Two-Sum, Two-Product, Grow-Expansion). Each component outweighs the sum of all
//! smaller ones, so the sum from the small end has the sign of the value, and zero means exactly zero. Exact if no partial product leaves
//! the range of f64, which holds for coordinates below 2³⁰⁰ in size whose products of three stay above 2⁻⁹⁰⁰.
//!
//! The `robust` crate only decides signs of differences of representable points. Here corners are relative to a ray origin, a difference
//! that is usually not representable, so the determinant is expanded instead: det(d, p − o, q − o) = det(d, p, q) − det(d, o, q) − det(d,
//! p, o).

use glam::DVec3;

/// Four determinants of six products of four components each.
const CAPACITY: usize = 96;

/// d · ((p − o) × (q − o)), correct in sign and to an ulp or two.
#[cold]
pub(super) fn edge(o: DVec3, d: DVec3, p: DVec3, q: DVec3) -> f64 {
    // det(d, p − o, q − o) is multilinear in its rows; the terms with o twice vanish.
    let mut sum = Expansion::ZERO;
    sum.add_determinant(d, p, q);
    sum.add_determinant(-d, o, q);
    sum.add_determinant(-d, p, o);
    sum.value()
}

/// (a − o) · ((b − o) × (c − o)), correct in sign and to an ulp or two.
#[cold]
pub(super) fn volume(o: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    // The same for det(a − o, b − o, c − o).
    let mut sum = Expansion::ZERO;
    sum.add_determinant(a, b, c);
    sum.add_determinant(-o, b, c);
    sum.add_determinant(a, -o, c);
    sum.add_determinant(a, b, -o);
    sum.value()
}

struct Expansion {
    parts: [f64; CAPACITY],
    len: usize,
}

impl Expansion {
    const ZERO: Expansion = Expansion {
        parts: [0.0; CAPACITY],
        len: 0,
    };

    /// Adds x · (y × z).
    fn add_determinant(&mut self, x: DVec3, y: DVec3, z: DVec3) {
        self.add_product(x.x, y.y, z.z);
        self.add_product(-x.x, y.z, z.y);
        self.add_product(x.y, y.z, z.x);
        self.add_product(-x.y, y.x, z.z);
        self.add_product(x.z, y.x, z.y);
        self.add_product(-x.z, y.y, z.x);
    }

    fn add_product(&mut self, x: f64, y: f64, z: f64) {
        let (high, low) = two_product(x, y);
        // (x y) z is four terms: both parts of x y, and the rounding errors of their products with z.
        for part in [low, high] {
            let (high, low) = two_product(part, z);
            self.add(low);
            self.add(high);
        }
    }

    /// Grow-Expansion, without zeros.
    fn add(&mut self, term: f64) {
        // Carry the sum up through the parts, leaving the rounding error at each.
        let (mut carry, mut kept) = (term, 0);
        for i in 0..self.len {
            let (sum, rest) = two_sum(carry, self.parts[i]);
            carry = sum;
            if rest != 0.0 {
                self.parts[kept] = rest;
                kept += 1;
            }
        }
        if carry != 0.0 {
            self.parts[kept] = carry;
            kept += 1;
        }
        self.len = kept;
    }

    fn value(&self) -> f64 {
        // From the small end: the large parts would absorb the small ones.
        self.parts[..self.len]
            .iter()
            .fold(0.0, |sum, part| sum + part)
    }
}

/// x + y as the rounded sum and the rounding error.
pub(super) fn two_sum(x: f64, y: f64) -> (f64, f64) {
    // Knuth's form, which needs no comparison of magnitudes.
    let sum = x + y;
    let y_part = sum - x;
    let x_part = sum - y_part;
    (sum, (x - x_part) + (y - y_part))
}

/// x·y as the rounded product and the rounding error (Dekker, Veltkamp).
pub(super) fn two_product(x: f64, y: f64) -> (f64, f64) {
    let product = x * y;
    let ((xh, xl), (yh, yl)) = (split(x), split(y));
    // Exact in this order (Dekker): each difference cancels what the rounded product already contains.
    let rest = ((xh * yh - product) + xh * yl + xl * yh) + xl * yl;
    (product, rest)
}

/// x as a sum of two numbers of at most 26 bits.
fn split(x: f64) -> (f64, f64) {
    let c = 134_217_729.0 * x; // 2²⁷ + 1
    let high = c - (c - x);
    (high, x - high)
}

#[cfg(test)]
mod tests;
