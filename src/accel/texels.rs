//! Texture lookups between texel centres, many at a time.
//!
//! Bilinear between four texels of three channels, in one level of a picture or blended between two. [`mixed_each`] loads two texels at a
//! time on processors with AVX2, and gives the same bits as [`mixed`].

#![allow(unsafe_code)]

use super::vectors::BLOCK;
#[cfg(target_arch = "x86_64")]
use super::vectors::x86::has_avx2;

/// Four texels of three channels around a point, and the weights of the right and the lower ones.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Taps {
    /// The indices of the left ones; the right ones are next to them.
    pub upper: u32,
    pub lower: u32,
    pub right: f32,
    pub below: f32,
}

/// [`Taps`] of a block, by component.
pub(crate) struct TapsBlock {
    pub upper: [u32; BLOCK],
    pub lower: [u32; BLOCK],
    pub right: [f32; BLOCK],
    pub below: [f32; BLOCK],
}

impl TapsBlock {
    /// Zeros, to be overwritten.
    pub const ZERO: TapsBlock = TapsBlock {
        upper: [0; BLOCK],
        lower: [0; BLOCK],
        right: [0.0; BLOCK],
        below: [0.0; BLOCK],
    };

    #[inline(always)]
    fn get(&self, k: usize) -> Taps {
        Taps {
            upper: self.upper[k],
            lower: self.lower[k],
            right: self.right[k],
            below: self.below[k],
        }
    }

    /// The largest index in the block.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn last(&self) -> u32 {
        let mut last = 0;
        for k in 0..BLOCK {
            last = last.max(self.upper[k]).max(self.lower[k]);
        }
        last
    }
}

/// Bilinear between the texels at each of two points, the second with weight `weight`, times a factor per channel. Texels that are not
/// followed by two more numbers count as zeros.
#[inline(always)]
pub(crate) fn mixed(
    texels: &[f32],
    [first, second]: [Taps; 2],
    weight: f32,
    scale: [f64; 3],
) -> [f64; 3] {
    let mut mean = bilinear(texels, first);
    if weight > 0.0 {
        mix(&mut mean, &bilinear(texels, second), weight);
    }
    let [r, g, b, _] = mean.map(f64::from);
    [r * scale[0], g * scale[1], b * scale[2]]
}

/// First between rows, for both columns at once, then between columns; the fourth number is meaningless.
#[inline(always)]
fn bilinear(texels: &[f32], taps: Taps) -> [f32; 4] {
    let mut columns = pair(texels, taps.upper);
    mix(&mut columns, &pair(texels, taps.lower), taps.below);
    let [r0, g0, b0, r1, g1, b1, more, _] = columns;
    let mut mean = [r0, g0, b0, r1];
    mix(&mut mean, &[r1, g1, b1, more], taps.right);
    mean
}

/// A texel and the next one, and the two numbers that follow.
#[inline(always)]
fn pair(texels: &[f32], at: u32) -> [f32; 8] {
    let pair = texels.get(3 * at as usize..).and_then(<[f32]>::first_chunk);
    pair.copied().unwrap_or_default()
}

/// Moves `a` towards `b` by `weight`.
#[inline(always)]
fn mix<const N: usize>(a: &mut [f32; N], b: &[f32; N], weight: f32) {
    for c in 0..N {
        a[c] += (b[c] - a[c]) * weight;
    }
}

/// [`mixed`] for as many points of a block as `to` has room for.
#[inline]
pub(crate) fn mixed_each(
    texels: &[f32],
    taps: [&TapsBlock; 2],
    weights: &[f32; BLOCK],
    scale: [f64; 3],
    to: &mut [[f64; 3]],
) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        let last = taps[0].last().max(taps[1].last()) as usize;
        if to.len() <= BLOCK && 3 * last + 8 <= texels.len() {
            // SAFETY: the processor has these instructions, eight numbers follow from each texel on, and `to` has at most the elements of a
            // block.
            return unsafe { x86::mixed_each(texels, taps, weights, scale, to) };
        }
    }
    mixed_singly(texels, taps, weights, scale, to);
}

/// The same without vectors.
fn mixed_singly(
    texels: &[f32],
    [first, second]: [&TapsBlock; 2],
    weights: &[f32; BLOCK],
    scale: [f64; 3],
    to: &mut [[f64; 3]],
) {
    for (k, (to, weight)) in to.iter_mut().zip(weights).enumerate() {
        *to = mixed(texels, [first.get(k), second.get(k)], *weight, scale);
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m128, __m256, _CMP_GT_OQ, _mm256_add_ps, _mm256_blend_pd, _mm256_blendv_ps,
        _mm256_castps256_ps128, _mm256_cmp_ps, _mm256_cvtps_pd, _mm256_extractf128_ps,
        _mm256_loadu_ps, _mm256_movemask_ps, _mm256_mul_pd, _mm256_mul_ps, _mm256_permute2f128_pd,
        _mm256_permute2f128_ps, _mm256_set1_pd, _mm256_set1_ps, _mm256_setzero_ps,
        _mm256_shuffle_pd, _mm256_shuffle_ps, _mm256_storeu_pd, _mm256_sub_ps, _mm256_unpackhi_pd,
        _mm256_unpackhi_ps, _mm256_unpacklo_pd, _mm256_unpacklo_ps,
    };

    use super::{BLOCK, TapsBlock, mixed};

    /// Eight points at a time: for each, the channels are interpolated between rows in one vector; then those of all eight are transposed
    /// to one vector per channel.
    ///
    /// # Safety
    ///
    /// Eight numbers of `texels` are read from each texel of `taps` on, and `to` has at most [`BLOCK`] elements.
    #[target_feature(enable = "avx2")]
    pub unsafe fn mixed_each(
        texels: &[f32],
        [first, second]: [&TapsBlock; 2],
        weights: &[f32; BLOCK],
        scale: [f64; 3],
        to: &mut [[f64; 3]],
    ) {
        let whole = to.len() / 8;
        let mut eights = to.chunks_exact_mut(8);
        for (group, to) in eights.by_ref().enumerate() {
            // SAFETY: the caller guarantees it for the texels, and a block has that many groups of eight.
            let (mut mean, weight) = unsafe {
                let mean = bilinear(texels, first, 8 * group);
                (mean, load(weights, 8 * group))
            };
            let counts = _mm256_cmp_ps::<_CMP_GT_OQ>(weight, _mm256_setzero_ps());
            if _mm256_movemask_ps(counts) != 0 {
                // SAFETY: as above.
                let other = unsafe { bilinear(texels, second, 8 * group) };
                for (mean, other) in mean.iter_mut().zip(other) {
                    // If the second point does not count, the first is kept bit for bit, as in `mixed`.
                    *mean = _mm256_blendv_ps(*mean, mix(*mean, other, weight), counts);
                }
            }
            let (left, right) = to.split_at_mut(4);
            put(mean.map(|c| _mm256_castps256_ps128(c)), scale, left);
            put(mean.map(|c| _mm256_extractf128_ps::<1>(c)), scale, right);
        }
        // The remainder, fewer than eight, one by one.
        let begin = 8 * whole;
        for (k, to) in (begin..).zip(eights.into_remainder()) {
            *to = mixed(texels, [first.get(k), second.get(k)], weights[k], scale);
        }
    }

    /// Interpolates from `a` to `b` by `weight`.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn mix(a: __m256, b: __m256, weight: __m256) -> __m256 {
        _mm256_add_ps(a, _mm256_mul_ps(_mm256_sub_ps(b, a), weight))
    }

    /// The eight numbers from `begin` on.
    ///
    /// # Safety
    ///
    /// There must be as many.
    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn load(numbers: &[f32; BLOCK], begin: usize) -> __m256 {
        // SAFETY: guaranteed by the caller; no alignment is needed.
        unsafe { _mm256_loadu_ps(numbers.as_ptr().add(begin)) }
    }

    /// Interpolates between the texels at eight positions from `begin` on, by channel.
    ///
    /// # Safety
    ///
    /// There must be as many positions, and eight numbers of `texels` from each of their texels on.
    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn bilinear(texels: &[f32], taps: &TapsBlock, begin: usize) -> [__m256; 3] {
        let texels = texels.as_ptr();
        // Between rows: a texel, the next one, and two numbers that do not matter.
        let columns = |k: usize| {
            let k = begin + k;
            let pair = |at: u32| {
                // SAFETY: guaranteed by the caller; no alignment is needed.
                unsafe { _mm256_loadu_ps(texels.add(3 * at as usize)) }
            };
            let below = _mm256_set1_ps(taps.below[k]);
            mix(pair(taps.upper[k]), pair(taps.lower[k]), below)
        };
        let mut c = [_mm256_setzero_ps(); 8];
        for (k, c) in c.iter_mut().enumerate() {
            *c = columns(k);
        }
        // For two positions the numbers 0 1 and 4 5, and 2 3; then for four positions 0 and 4, 1 and 5, 2, 3.
        let low = [
            _mm256_unpacklo_ps(c[0], c[1]),
            _mm256_unpacklo_ps(c[2], c[3]),
            _mm256_unpacklo_ps(c[4], c[5]),
            _mm256_unpacklo_ps(c[6], c[7]),
        ];
        let high = [
            _mm256_unpackhi_ps(c[0], c[1]),
            _mm256_unpackhi_ps(c[2], c[3]),
            _mm256_unpackhi_ps(c[4], c[5]),
            _mm256_unpackhi_ps(c[6], c[7]),
        ];
        let (r0g1, r0g1_last) = (
            _mm256_shuffle_ps::<0x44>(low[0], low[1]),
            _mm256_shuffle_ps::<0x44>(low[2], low[3]),
        );
        let (g0b1, g0b1_last) = (
            _mm256_shuffle_ps::<0xee>(low[0], low[1]),
            _mm256_shuffle_ps::<0xee>(low[2], low[3]),
        );
        let (b0, b0_last) = (
            _mm256_shuffle_ps::<0x44>(high[0], high[1]),
            _mm256_shuffle_ps::<0x44>(high[2], high[3]),
        );
        let (r1, r1_last) = (
            _mm256_shuffle_ps::<0xee>(high[0], high[1]),
            _mm256_shuffle_ps::<0xee>(high[2], high[3]),
        );
        let left = [
            _mm256_permute2f128_ps::<0x20>(r0g1, r0g1_last),
            _mm256_permute2f128_ps::<0x20>(g0b1, g0b1_last),
            _mm256_permute2f128_ps::<0x20>(b0, b0_last),
        ];
        let right = [
            _mm256_permute2f128_ps::<0x20>(r1, r1_last),
            _mm256_permute2f128_ps::<0x31>(r0g1, r0g1_last),
            _mm256_permute2f128_ps::<0x31>(g0b1, g0b1_last),
        ];
        // Between columns.
        // SAFETY: as above.
        let weight = unsafe { load(&taps.right, begin) };
        let [r, g, b] = left;
        let [r1, g1, b1] = right;
        [mix(r, r1, weight), mix(g, g1, weight), mix(b, b1, weight)]
    }

    /// Stores four points, given by channel, times `scale`, one after the other in `to`.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn put(channels: [__m128; 3], scale: [f64; 3], to: &mut [[f64; 3]]) {
        let times =
            |c: usize| _mm256_mul_pd(_mm256_cvtps_pd(channels[c]), _mm256_set1_pd(scale[c]));
        let (r, g, b) = (times(0), times(1), times(2));
        // r0 g0 r2 g2, b0 r1 b2 r3 and g1 b1 g3 b3.
        let rg = _mm256_unpacklo_pd(r, g);
        let br = _mm256_shuffle_pd::<0b1010>(b, r);
        let gb = _mm256_unpackhi_pd(g, b);
        let rows = [
            _mm256_permute2f128_pd::<0x20>(rg, br),
            _mm256_blend_pd::<0b1100>(gb, rg),
            _mm256_permute2f128_pd::<0x31>(br, gb),
        ];
        for (to, row) in to.as_flattened_mut().chunks_exact_mut(4).zip(rows) {
            // SAFETY: the slice has as many numbers as are stored, which needs no alignment.
            unsafe { _mm256_storeu_pd(to.as_mut_ptr(), row) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_between_texels_are_looked_up_alike_in_vectors_and_one_by_one() {
        let number = |n: usize| ((n * 7919) % 1009) as f32 / 1009.0 - 0.3;
        let texels: Vec<f32> = (0..300).map(number).collect();
        let part = |k: usize, n: usize| (k * n % 67) as f32 / 67.0;
        // Some texels are the last ones from which eight numbers follow.
        let taps = |n: usize| TapsBlock {
            upper: std::array::from_fn(|k| (k * n % 97) as u32),
            lower: std::array::from_fn(|k| if k % 9 == 4 { 97 } else { k as u32 }),
            right: std::array::from_fn(|k| part(k, n + 2)),
            below: std::array::from_fn(|k| part(k, n + 5)),
        };
        let (fine, mut coarse) = (taps(7), taps(11));
        let weights: [f32; BLOCK] = std::array::from_fn(|k| part(k, 3) * (k % 3) as f32 / 2.0);
        let scale = [1.0, 2.5, 0.3];
        for is_beyond in [false, true] {
            if is_beyond {
                // At one position there are too few numbers.
                coarse.lower[5] = 98;
            }
            let (mut wide, mut narrow) = ([[7.0; 3]; 50], [[8.0; 3]; 50]);
            mixed_each(&texels, [&fine, &coarse], &weights, scale, &mut wide);
            mixed_singly(&texels, [&fine, &coarse], &weights, scale, &mut narrow);
            assert_eq!(wide, narrow);
            for (k, seen) in wide.iter().enumerate() {
                for (c, seen) in seen.iter().enumerate() {
                    let at = |first: u32, more: usize| match first {
                        98 => 0.0,
                        _ => f64::from(texels[3 * first as usize + more + c]),
                    };
                    let mix = |a: f64, b: f64, weight: f32| a + (b - a) * f64::from(weight);
                    let bilinear = |taps: &TapsBlock| {
                        let column = |more| {
                            let (above, under) = (at(taps.upper[k], more), at(taps.lower[k], more));
                            mix(above, under, taps.below[k])
                        };
                        mix(column(0), column(3), taps.right[k])
                    };
                    let mean = mix(bilinear(&fine), bilinear(&coarse), weights[k]);
                    assert!((seen - mean * scale[c]).abs() < 1e-6, "{k} {c}");
                }
            }
        }
    }
}
