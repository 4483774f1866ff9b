//! Sines and cosines of many angles, bit-identical to [`libm::sincos`].
//!
//! The reduction by multiples of π/2 in two parts (Cody and Waite, "Software Manual for the Elementary Functions", 1980) and the
//! polynomials on ±π/4 are those of FreeBSD's msun, which libm uses, in libm's order of operations but without branches. Blocks with an
//! angle beyond 9π/4, or so close to a multiple of π/2 that libm uses more parts, are left to libm.

use super::vectors::{BLOCK, Block};

/// π/2 in two parts: its first 33 bits, and the rest.
const QUARTER: [f64; 2] = bits([0x3ff9_21fb_5440_0000, 0x3dd0_b461_1a62_6331]);
/// sin x = x + S₁ x³ + … + S₆ x¹³ to 2⁻⁵⁸ x on ±π/4.
const S: [f64; 6] = bits([
    0xbfc5_5555_5555_5549,
    0x3f81_1111_1110_f8a6,
    0xbf2a_01a0_19c1_61d5,
    0x3ec7_1de3_57b1_fe7d,
    0xbe5a_e5e6_8a2b_9ceb,
    0x3de5_d93a_5acf_d57c,
]);
/// cos x = 1 − x²/2 + C₁ x⁴ + … + C₆ x¹⁴ to 2⁻⁵⁸ on ±π/4.
const C: [f64; 6] = bits([
    0x3fa5_5555_5555_554c,
    0xbf56_c16c_16c1_5177,
    0x3efa_01a0_19cb_1590,
    0xbe92_7e4f_809c_52ad,
    0x3e21_ee9e_bdb4_b1c4,
    0xbda8_fae9_be88_38d4,
]);
/// The thresholds from which on 1, 2, 3 and 4 times π/2 are subtracted, and the limit: π/4, 3π/4, … 9π/4 in libm's 32-bit form.
const FROM: [f64; 5] = bits([
    0x3fe9_21fc << 32,
    0x4002_d97d << 32,
    0x400f_6a7b << 32,
    0x4015_fdbd << 32,
    0x401c_463c << 32,
]);
/// The smallest ratio of the reduced angle to the angle, 2⁻¹⁵: if libm uses more parts of π/2, the ratio is less than half of that.
const LEFT: f64 = 1.0 / 32768.0;
/// Adding 1.5·2⁵² leaves a whole number in the last bits.
const WHOLE: f64 = 6_755_399_441_055_744.0;

const fn bits<const N: usize>(bits: [u64; N]) -> [f64; N] {
    let mut numbers = [0.0; N];
    let mut k = 0;
    while k < N {
        numbers[k] = f64::from_bits(bits[k]);
        k += 1;
    }
    numbers
}

/// Sets `sines` and `cosines` to those of `angles`.
#[inline(always)]
pub(crate) fn sincos_each(angles: &Block, sines: &mut Block, cosines: &mut Block) {
    let mut are_usual = true;
    for k in 0..BLOCK {
        let is_usual;
        (sines[k], cosines[k], is_usual) = sincos_usual(angles[k]);
        are_usual &= is_usual;
    }
    if !are_usual {
        singly(angles, sines, cosines);
    }
}

#[cold]
#[inline(never)]
fn singly(angles: &Block, sines: &mut Block, cosines: &mut Block) {
    for k in 0..BLOCK {
        (sines[k], cosines[k]) = libm::sincos(angles[k]);
    }
}

/// The sine and cosine of `x`, and whether they are valid.
#[inline(always)]
fn sincos_usual(x: f64) -> (f64, f64, bool) {
    // The number of quarter turns that are subtracted, and the remainder: r, and its rounding error.
    let size = x.abs();
    let mut quarters = 0.0;
    for from in &FROM[..4] {
        quarters += if size >= *from { 1.0 } else { 0.0 };
    }
    let quarters = f64::copysign(quarters, x);
    let [first, rest] = QUARTER;
    let (before, off) = (x - quarters * first, quarters * rest);
    let r = before - off;
    let lost = (before - r) - off;
    let is_usual = (size < FROM[4]) & (r.abs() >= size * LEFT);

    // Polynomials; that of the sine in libm's two forms: with and without the rounding error.
    let z = r * r;
    let (w, v) = (z * z, z * r);
    let sum = S[1] + z * (S[2] + z * S[3]) + z * w * (S[4] + z * S[5]);
    let near = r + v * (S[0] + z * sum);
    let far = r - ((z * (0.5 * lost - v * sum) - lost) - v * S[0]);
    let sine = if size < FROM[0] { near } else { far };
    // The sine of −0 is −0.
    let sine = if size > 0.0 { sine } else { x };
    let sum = z * (C[0] + z * (C[1] + z * C[2])) + w * w * (C[3] + z * (C[4] + z * C[5]));
    let half = 0.5 * z;
    let most = 1.0 - half;
    let cosine = most + (((1.0 - most) - half) + (z * sum - r * lost));

    // In odd quarters sine and cosine are swapped; signs change every half turn.
    let turns = (quarters + WHOLE).to_bits();
    let is_odd = turns & 1 == 1;
    let (a, b) = if is_odd {
        (cosine, sine)
    } else {
        (sine, cosine)
    };
    let sign = |turns: u64| (turns & 2) << 62;
    let (a, b) = (a.to_bits() ^ sign(turns), b.to_bits() ^ sign(turns + 1));
    (f64::from_bits(a), f64::from_bits(b), is_usual)
}

#[cfg(test)]
mod tests;
