//! AVX2 with FMA: 8 lanes.

use std::arch::x86_64::*;

use glam::DVec3;

use super::{Simd, Task};

/// 8 lanes.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Avx2(());

impl Avx2 {
    /// The kernel, if this processor has its instructions.
    pub fn detect() -> Option<Avx2> {
        let has = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        has.then_some(Avx2(()))
    }

    /// All bits of a lane where `mask` has its bit.
    #[inline(always)]
    fn spread(self, mask: u32) -> __m256i {
        // SAFETY: as `splat`.
        unsafe {
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(mask as i32), bits), bits)
        }
    }

    /// The same instructions as those of a wider kernel.
    #[inline(always)]
    pub(super) fn of(_: super::Avx512) -> Avx2 {
        // AVX-512 as it is detected includes AVX2 and FMA.
        Avx2(())
    }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn compiled(kernel: Avx2, task: impl Task) {
    task.run(kernel);
}

impl Simd for Avx2 {
    type F = __m256;
    type Children = Avx2;
    const LANES: usize = 8;

    #[inline(always)]
    fn children(self) -> Avx2 {
        self
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
    fn splat(self, x: f32) -> __m256 {
        // SAFETY: `self` exists, so `detect` has found the instructions.
        unsafe { _mm256_set1_ps(x) }
    }

    #[inline(always)]
    fn load(self, from: &[f32]) -> __m256 {
        let from = &from[..8];
        // SAFETY: as `splat`; `from` holds 8 numbers.
        unsafe { _mm256_loadu_ps(from.as_ptr()) }
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
        let (vectors, x, y, z) = (&vectors[..4], &mut x[..4], &mut y[..4], &mut z[..4]);
        let from: *const f64 = vectors.as_ptr().cast();
        // SAFETY: as `splat`; four vectors are twelve f64 in a row, and x, y and z hold four f32 each.
        unsafe {
            let scale = _mm256_set1_pd(scale);
            let a = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_loadu_pd(from), scale));
            let b = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_loadu_pd(from.add(4)), scale));
            let c = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_loadu_pd(from.add(8)), scale));
            // x₀ y₀ z₀ x₁, y₁ z₁ x₂ y₂, z₂ x₃ y₃ z₃: by place, then in order.
            let xs = _mm_blend_ps::<0b0010>(_mm_blend_ps::<0b0100>(a, b), c);
            let ys = _mm_blend_ps::<0b0100>(_mm_blend_ps::<0b1001>(a, b), c);
            let zs = _mm_blend_ps::<0b1001>(_mm_blend_ps::<0b0010>(a, b), c);
            _mm_storeu_ps(x.as_mut_ptr(), _mm_permute_ps::<0b01_10_11_00>(xs));
            _mm_storeu_ps(y.as_mut_ptr(), _mm_permute_ps::<0b10_11_00_01>(ys));
            _mm_storeu_ps(z.as_mut_ptr(), _mm_permute_ps::<0b11_00_01_10>(zs));
        }
    }

    #[inline(always)]
    fn store(self, to: &mut [f32], x: __m256) {
        let to = &mut to[..8];
        // SAFETY: as `splat`; `to` holds 8 numbers.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), x) }
    }

    #[inline(always)]
    fn store_some(self, to: &mut [f32], mask: u32, x: __m256) {
        let to = &mut to[..8];
        // SAFETY: as `splat`; `to` holds 8 numbers.
        unsafe { _mm256_maskstore_ps(to.as_mut_ptr(), self.spread(mask), x) }
    }

    #[inline(always)]
    fn select(self, mask: u32, x: __m256, y: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_blendv_ps(y, x, _mm256_castsi256_ps(self.spread(mask))) }
    }

    #[inline(always)]
    fn store_index(self, to: &mut [u32], mask: u32, x: u32) {
        let to = &mut to[..8];
        // SAFETY: as `splat`; `to` holds 8 numbers.
        unsafe {
            _mm256_maskstore_epi32(
                to.as_mut_ptr().cast(),
                self.spread(mask),
                _mm256_set1_epi32(x as i32),
            )
        }
    }

    #[inline(always)]
    fn add(self, x: __m256, y: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_add_ps(x, y) }
    }

    #[inline(always)]
    fn sub(self, x: __m256, y: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_sub_ps(x, y) }
    }

    #[inline(always)]
    fn mul(self, x: __m256, y: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_mul_ps(x, y) }
    }

    #[inline(always)]
    fn div(self, x: __m256, y: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_div_ps(x, y) }
    }

    #[inline(always)]
    fn min(self, x: __m256, y: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_min_ps(x, y) }
    }

    #[inline(always)]
    fn max(self, x: __m256, y: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_max_ps(x, y) }
    }

    #[inline(always)]
    fn mul_add(self, x: __m256, y: __m256, z: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_fmadd_ps(x, y, z) }
    }

    #[inline(always)]
    fn mul_sub(self, x: __m256, y: __m256, z: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_fmsub_ps(x, y, z) }
    }

    #[inline(always)]
    fn abs(self, x: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), x) }
    }

    #[inline(always)]
    fn flip(self, x: __m256, by: __m256) -> __m256 {
        // SAFETY: as `splat`.
        unsafe { _mm256_xor_ps(x, _mm256_and_ps(by, _mm256_set1_ps(-0.0))) }
    }

    #[inline(always)]
    fn le(self, x: __m256, y: __m256) -> u32 {
        // SAFETY: as `splat`.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(x, y)) as u32 }
    }

    #[inline(always)]
    fn not_negative(self, x: __m256, y: __m256, z: __m256) -> u32 {
        // SAFETY: as `splat`.
        unsafe {
            {
                let zero = _mm256_setzero_ps();
                let least = _mm256_min_ps(_mm256_min_ps(x, y), z);
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(least, zero)) as u32
            }
        }
    }

    #[inline(always)]
    fn greatest(self, x: __m256) -> f32 {
        // SAFETY: as `splat`.
        unsafe {
            let x = _mm_max_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
            let x = _mm_max_ps(x, _mm_movehl_ps(x, x));
            _mm_cvtss_f32(_mm_max_ss(x, _mm_movehdup_ps(x)))
        }
    }

    #[inline(always)]
    fn smallest(self, x: __m256) -> f32 {
        // SAFETY: as `splat`.
        unsafe {
            let x = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
            let x = _mm_min_ps(x, _mm_movehl_ps(x, x));
            _mm_cvtss_f32(_mm_min_ss(x, _mm_movehdup_ps(x)))
        }
    }
}
