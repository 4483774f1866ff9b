//! Angles of points of the upper half-plane, in a form that vectorizes.
//!
//! The angle from the x-axis is reduced to arctan t with |t| ≤ tan(π/8) by reflections and a turn by π/4, which need one division in all:
//! arctan(y/x) = π/4 + arctan((y − x)/(y + x)). The polynomial is that of FreeBSD's msun (s_atan.c) for |t| < 7/16.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// arctan t = t − t (A₀ t² + A₁ t⁴ + … + A₁₀ t²²) to 2⁻⁵⁷ t on ±7/16.
const A: [f64; 11] = [
    3.333_333_333_333_293e-1,
    -1.999_999_999_987_648_3e-1,
    1.428_571_427_250_346_6e-1,
    -1.111_111_040_546_235_6e-1,
    9.090_887_133_436_507e-2,
    -7.691_876_205_044_83e-2,
    6.661_073_137_387_531e-2,
    -5.833_570_133_790_573_5e-2,
    4.976_877_994_615_932e-2,
    -3.653_157_274_421_691_6e-2,
    1.628_582_011_536_578_2e-2,
];
/// tan(π/8).
const EIGHTH: f64 = 0.414_213_562_373_095_03;

/// The angle of (x, y) from the x-axis, from 0 to π, for y ≥ 0, accurate to 4 eps. At the origin it is 0.
#[inline(always)]
pub(crate) fn upper_angle(y: f64, x: f64) -> f64 {
    let across = x.abs();
    let (low, high) = if y > across { (across, y) } else { (y, across) };
    let turns = low > EIGHTH * high;
    let (up, down) = if turns {
        (low - high, low + high)
    } else {
        (low, high)
    };
    // Of the two numbers that are 0 at the origin, replace one by 1.
    let down = if down > 0.0 { down } else { 1.0 };
    let t = up / down;
    let (z, start) = (t * t, if turns { FRAC_PI_4 } else { 0.0 });
    let w = z * z;
    let even = z * (A[0] + w * (A[2] + w * (A[4] + w * (A[6] + w * (A[8] + w * A[10])))));
    let odd = w * (A[1] + w * (A[3] + w * (A[5] + w * (A[7] + w * A[9]))));
    let angle = start + (t - t * (even + odd));
    let angle = if y > across { FRAC_PI_2 - angle } else { angle };
    if x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::numbers;

    #[test]
    fn angles_are_those_of_libm() {
        let mut next = numbers(3);
        let check = |y: f64, x: f64| {
            let (seen, expected) = (upper_angle(y, x), libm::atan2(y, x));
            let off = (seen - expected).abs();
            assert!(
                off <= 4.0 * f64::EPSILON * expected,
                "{y:e} {x:e}: {seen:e} {expected:e}"
            );
        };
        for _ in 0..100_000 {
            let (x, y) = (next(), next().abs());
            check(y, x);
            let far = libm::exp(300.0 * next());
            check(y * far, x);
            check(y, x * far);
        }
        for (y, x) in [(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (1.0, -0.0), (0.0, 0.0)] {
            check(y, x);
        }
        for x in [1.0, -1.0] {
            for y in [EIGHTH, 1.0, 1.0 / EIGHTH] {
                check(y, x);
            }
        }
    }
}
