//! Sources of random numbers: keys of pixels, their hashes, and numbers in [0, 1).

/// The key from which a pixel's random numbers are derived.
#[inline(always)]
pub(crate) fn pixel_key(column: u32, row: u32) -> u64 {
    column as u64 | ((row as u64) << 32)
}

/// A number in [0, 1) from 32 random bits.
#[inline(always)]
pub(super) fn unit(bits: u32) -> f64 {
    bits as f64 * UNIT
}

/// 2⁻³²: maps 32 bits to [0, 1), exactly.
pub(super) const UNIT: f64 = 1.0 / 4_294_967_296.0;

/// The lower and the upper 32 bits of `x` as numbers. AVX2 has no vector instruction for this conversion: for an integer below 2⁵² it is
/// the mantissa of 2⁵² plus that integer, exactly.
#[inline(always)]
pub(crate) fn halves(x: u64) -> [f64; 2] {
    const BEFORE: f64 = (1u64 << 52) as f64;
    let [lower, upper] = [x & 0xffff_ffff, x >> 32];
    [
        f64::from_bits(BEFORE.to_bits() | lower) - BEFORE,
        f64::from_bits(BEFORE.to_bits() | upper) - BEFORE,
    ]
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): every bit of the input reaches every bit of the output.
#[inline(always)]
pub(super) fn hash(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_converted_exactly() {
        for x in [
            0,
            1,
            u64::MAX,
            1 << 31,
            1 << 63,
            0xffff_ffff,
            hash(3),
            hash(4),
        ] {
            let expected = [f64::from(x as u32), f64::from((x >> 32) as u32)];
            assert_eq!(halves(x), expected, "{x:x}");
        }
    }
}
