//! Sums and products with their rounding errors.
//!
//! sinh(gτ) from the rounded product loses gτ/2 units in the last place: 15 at gτ = 30. Near a horizon 1 + g(t + x) is a small difference
//! of rounded numbers. Both keep all digits if the errors are carried along.

use glam::DVec3;

/// a + b rounded, and the exact rounding error.
#[inline]
pub(super) fn sum(a: f64, b: f64) -> (f64, f64) {
    // Two-Sum (Knuth), for any order of sizes.
    let s = a + b;
    let of_b = s - a;
    (s, (a - (s - of_b)) + (b - of_b))
}

/// a b rounded, and the exact rounding error (except for underflow).
#[inline]
pub(super) fn product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    // The fused product is rounded once, after p is subtracted: what is left is the error.
    (p, a.mul_add(b, -p))
}

/// 1 + g (a + b), to one or two rounding errors of the result.
#[inline]
pub(super) fn one_plus(g: f64, a: f64, b: f64) -> f64 {
    let (length, length_error) = sum(a, b);
    let (scaled, scaled_error) = product(g, length);
    let (total, total_error) = sum(1.0, scaled);
    total + (total_error + (scaled_error + g * length_error))
}

/// |v| − `length`, where `length` is |v| rounded; 0 if the squares exceed f64's range.
pub(super) fn length_error(v: DVec3, length: f64) -> f64 {
    // Within these, the square of the length and its rounding error are normal numbers.
    if !(1e-140..1e140).contains(&length) {
        return 0.0;
    }
    // |v|² − length² = (|v| − length) (|v| + length)
    let (square, error) = product(length, length);
    let (mut rest, mut errors) = (-square, -error);
    for component in v.to_array() {
        let (square, error) = product(component, component);
        let (total, left_out) = sum(rest, square);
        rest = total;
        errors += error + left_out;
    }
    // |v| + length is 2 length, up to terms of second order.
    (rest + errors) / (2.0 * length)
}

/// v divided by `length` + `error`, each component to half a unit in the last place.
pub(super) fn quotient(v: DVec3, length: f64, error: f64) -> DVec3 {
    let component = |a: f64| {
        let q = a / length;
        // The remainder of a after q (length + error).
        q + ((-q).mul_add(length, a) - q * error) / length
    };
    DVec3::from_array(v.to_array().map(component))
}
