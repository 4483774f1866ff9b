//! Powers of two, and comparisons without the NaN handling of [`f64::min`], which costs three more instructions.

use glam::DVec3;

/// 2^`exponent` for exponents of normal numbers.
#[inline]
pub(super) const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The exponent e of a positive normal x: 2^e ≤ x < 2^(e+1).
#[inline]
pub(super) fn exponent(x: f64) -> i64 {
    ((x.to_bits() >> 52) & 0x7ff) as i64 - 1023
}

/// x if it is smaller, else y; y also if x is NaN.
#[inline(always)]
pub(super) fn lesser(x: f64, y: f64) -> f64 {
    if x < y { x } else { y }
}

/// x if it is greater, else y; y also if x is NaN.
#[inline(always)]
pub(super) fn greater(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

/// |x| + |y| + |z|.
#[inline(always)]
pub(super) fn norm1(v: DVec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}
