//! AVX-512: 16 lanes.

use std::arch::x86_64::*;

use glam::DVec3;

use super::{Avx2, Simd, Task};

/// 16 lanes.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Avx512(());

impl Avx512 {
    /// The kernel, if this processor has its instructions.
    pub fn detect() -> Option<Avx512> {
        let has = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        has.then_some(Avx512(()))
    }
}

#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn compiled(kernel: Avx512, task: impl Task) {
    task.run(kernel);
}

impl Simd for Avx512 {
    type F = __m512;
    type Children = Avx2;
    const LANES: usize = 16;

    #[inline(always)]
    fn children(self) -> Avx2 {
        Avx2::of(self)
    }

    #[inline(always)]
    fn run(self, task: impl Task) {
        // SAFETY: `self` exists, so `detect` has found the instructions.
        unsafe { compiled(self, task) }
    }

    #[inline(always)]
    fn prefetch<T>(self, what: &T) {
        let first: *const i8 = std::ptr::from_ref(what).cast();
        let mut at = 0;
        while at < size_of::<T>() {
            // SAFETY: prefetching reads nothing, and `at` is within `what`.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.add(at)) };
            at += 64;
        }
    }

    #[inline(always)]
    fn splat(self, x: f32) -> __m512 {
        // SAFETY: `self` exists, so `detect` has found the instructions.
        unsafe { _mm512_set1_ps(x) }
    }

    #[inline(always)]
    fn load(self, from: &[f32]) -> __m512 {
        let from = &from[..16];
        // SAFETY: as `splat`; `from` holds 16 numbers.
        unsafe { _mm512_loadu_ps(from.as_ptr()) }
    }

    #[inline(always)]
    fn store_vectors(
        self,
        vectors: &[DVec3],
        scale: f64,
        x: &mut [f32],
        y: &mut [f32],
        z: &mut [f32],
    ) {
        Avx2::of(self).store_vectors(vectors, scale, x, y, z);
    }

    #[inline(always)]
    fn store(self, to: &mut [f32], x: __m512) {
        let to = &mut to[..16];
        // SAFETY: as `splat`; `to` holds 16 numbers.
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), x) }
    }

    #[inline(always)]
    fn store_some(self, to: &mut [f32], mask: u32, x: __m512) {
        let to = &mut to[..16];
        // SAFETY: as `splat`; `to` holds 16 numbers.
        unsafe { _mm512_mask_storeu_ps(to.as_mut_ptr(), mask as u16, x) }
    }

    #[inline(always)]
    fn select(self, mask: u32, x: __m512, y: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_mask_blend_ps(mask as u16, y, x) }
    }

    #[inline(always)]
    fn store_index(self, to: &mut [u32], mask: u32, x: u32) {
        let to = &mut to[..16];
        // SAFETY: as `splat`; `to` holds 16 numbers.
        unsafe {
            _mm512_mask_storeu_epi32(
                to.as_mut_ptr().cast(),
                mask as u16,
                _mm512_set1_epi32(x as i32),
            )
        }
    }

    #[inline(always)]
    fn add(self, x: __m512, y: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_add_ps(x, y) }
    }

    #[inline(always)]
    fn sub(self, x: __m512, y: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_sub_ps(x, y) }
    }

    #[inline(always)]
    fn mul(self, x: __m512, y: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_mul_ps(x, y) }
    }

    #[inline(always)]
    fn div(self, x: __m512, y: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_div_ps(x, y) }
    }

    #[inline(always)]
    fn min(self, x: __m512, y: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_min_ps(x, y) }
    }

    #[inline(always)]
    fn max(self, x: __m512, y: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_max_ps(x, y) }
    }

    #[inline(always)]
    fn mul_add(self, x: __m512, y: __m512, z: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_fmadd_ps(x, y, z) }
    }

    #[inline(always)]
    fn mul_sub(self, x: __m512, y: __m512, z: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_fmsub_ps(x, y, z) }
    }

    #[inline(always)]
    fn abs(self, x: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_abs_ps(x) }
    }

    #[inline(always)]
    fn flip(self, x: __m512, by: __m512) -> __m512 {
        // SAFETY: as `splat`.
        unsafe { _mm512_xor_ps(x, _mm512_and_ps(by, _mm512_set1_ps(-0.0))) }
    }

    #[inline(always)]
    fn le(self, x: __m512, y: __m512) -> u32 {
        // SAFETY: as `splat`.
        unsafe { u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(x, y)) }
    }

    #[inline(always)]
    fn not_negative(self, x: __m512, y: __m512, z: __m512) -> u32 {
        // SAFETY: as `splat`.
        unsafe {
            {
                let zero = _mm512_setzero_ps();
                let least = _mm512_min_ps(_mm512_min_ps(x, y), z);
                u32::from(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(least, zero))
            }
        }
    }

    #[inline(always)]
    fn greatest(self, x: __m512) -> f32 {
        // SAFETY: as `splat`.
        unsafe { _mm512_reduce_max_ps(x) }
    }

    #[inline(always)]
    fn smallest(self, x: __m512) -> f32 {
        // SAFETY: as `splat`.
        unsafe { _mm512_reduce_min_ps(x) }
    }
}
