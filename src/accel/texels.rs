//! Places between texels of pictures, many at a time.
//!
//! Bilinear between four texels of three channels, in one size of a picture or mixed of two. [`mixed_each`] loads two texels at a time where
//! the processor has AVX2, and gives the same bits as [`mixed`].

#![allow(unsafe_code)]

use super::vectors::BLOCK;
#[cfg(target_arch = "x86_64")]
use super::vectors::x86::has_avx2;

/// Four texels of three channels around a place, and the weights of those to the right and below.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Taps {
    /// The numbers of the left ones; the right ones follow.
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
    /// To be written.
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

    /// The last one's number.
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

/// Bilinear between the texels at each of two places, of which the second counts with `weight`, times a factor by channel. Texels without two
/// more numbers after them are zeros.
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

/// Between rows, for both columns at once, then between columns; and a fourth number that does not count.
#[inline(always)]
fn bilinear(texels: &[f32], taps: Taps) -> [f32; 4] {
    let mut columns = pair(texels, taps.upper);
    mix(&mut columns, &pair(texels, taps.lower), taps.below);
    let [r0, g0, b0, r1, g1, b1, more, _] = columns;
    let mut mean = [r0, g0, b0, r1];
    mix(&mut mean, &[r1, g1, b1, more], taps.right);
    mean
}

/// A texel and the next one, and two numbers more.
#[inline(always)]
fn pair(texels: &[f32], at: u32) -> [f32; 8] {
    let pair = texels.get(3 * at as usize..).and_then(<[f32]>::first_chunk);
    pair.copied().unwrap_or_default()
}

/// Takes `a` to `b` as far as `weight` says.
#[inline(always)]
fn mix<const N: usize>(a: &mut [f32; N], b: &[f32; N], weight: f32) {
    for c in 0..N {
        a[c] += (b[c] - a[c]) * weight;
    }
}

/// [`mixed`] for as many places of a block as `to` has room for.
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
            // SAFETY: the processor has just been asked for these instructions; eight numbers follow from each texel on, and there are
            // as many places as are asked for.
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
    use super::{BLOCK, TapsBlock};

    /// Two texels are loaded at a time, in a vector.
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
        use std::arch::x86_64::{
            __m128, _mm_add_ps, _mm_alignr_epi8, _mm_castps_si128, _mm_castsi128_ps, _mm_mul_ps,
            _mm_set1_ps, _mm_store_sd, _mm_storeu_pd, _mm_sub_ps, _mm256_add_ps,
            _mm256_castpd256_pd128, _mm256_castps256_ps128, _mm256_cvtps_pd, _mm256_extractf128_pd,
            _mm256_extractf128_ps, _mm256_loadu_ps, _mm256_mul_pd, _mm256_mul_ps, _mm256_set_pd,
            _mm256_set1_ps, _mm256_sub_ps,
        };
        let texels = texels.as_ptr();
        let pair = |at: u32| {
            // SAFETY: the caller has said so; they need no alignment.
            unsafe { _mm256_loadu_ps(texels.add(3 * at as usize)) }
        };
        let mix = |a: __m128, b: __m128, weight: f32| {
            _mm_add_ps(a, _mm_mul_ps(_mm_sub_ps(b, a), _mm_set1_ps(weight)))
        };
        // Between rows, for both columns at once, then between columns.
        let bilinear = |taps: &TapsBlock, k: usize| {
            let (upper, lower) = (pair(taps.upper[k]), pair(taps.lower[k]));
            let more = _mm256_mul_ps(_mm256_sub_ps(lower, upper), _mm256_set1_ps(taps.below[k]));
            let columns = _mm256_add_ps(upper, more);
            let left = _mm256_castps256_ps128(columns);
            let rest = _mm_castps_si128(_mm256_extractf128_ps::<1>(columns));
            let right = _mm_alignr_epi8::<12>(rest, _mm_castps_si128(left));
            mix(left, _mm_castsi128_ps(right), taps.right[k])
        };
        let scale = _mm256_set_pd(0.0, scale[2], scale[1], scale[0]);
        for (k, (to, weight)) in to.iter_mut().zip(weights).enumerate() {
            let mut mean = bilinear(first, k);
            if *weight > 0.0 {
                mean = mix(mean, bilinear(second, k), *weight);
            }
            let scaled = _mm256_mul_pd(_mm256_cvtps_pd(mean), scale);
            let to = to.as_mut_ptr();
            // SAFETY: two numbers and one are stored to three, which needs no alignment.
            unsafe {
                _mm_storeu_pd(to, _mm256_castpd256_pd128(scaled));
                _mm_store_sd(to.add(2), _mm256_extractf128_pd::<1>(scaled));
            }
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
        // Some texels are the last ones that eight numbers follow from.
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
                // Of one place there are too few numbers.
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
