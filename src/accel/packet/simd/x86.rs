//! AVX2 with FMA: 8 lanes. AVX-512: 16 lanes.

use std::arch::x86_64::*;

use glam::DVec3;

use super::{Eight, LOWEST, Simd, Task};
use crate::accel::node::NodeRef;

/// Defines a kernel: its lanes, the processor features that it needs, the operations that are a single intrinsic, and the rest of its
/// operations.
macro_rules! kernel {
    (
        $(#[$doc:meta])*
        $name:ident, $lanes:literal lanes of $vector:ty, needs [$($feature:tt)+];
        splat = $splat:ident; load = $load:ident; store = $store:ident;
        lanewise { $($operation:ident($($x:ident),+) = $intrinsic:ident;)+ }
        $($rest:tt)+
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub(in super::super) struct $name(());

        impl $name {
            /// The kernel, if this processor has its features.
            pub fn detect() -> Option<$name> {
                let has = true $(&& is_x86_feature_detected!($feature))+;
                has.then_some($name(()))
            }

            #[target_feature($(enable = $feature),+)]
            fn compiled<T: Task>(self, task: T) -> T::Output {
                task.run(self)
            }
        }

        impl Simd for $name {
            type F = $vector;
            const LANES: usize = $lanes;

            #[inline(always)]
            fn run<T: Task>(self, task: T) -> T::Output {
                // SAFETY: `self` exists, so `detect` has found the features.
                unsafe { self.compiled(task) }
            }

            #[inline(always)]
            fn splat(self, x: f32) -> $vector {
                // SAFETY: as for `run`.
                unsafe { $splat(x) }
            }

            #[inline(always)]
            fn load(self, from: &[f32]) -> $vector {
                let from = &from[..$lanes];
                // SAFETY: as for `run`; `from` has a number for each lane.
                unsafe { $load(from.as_ptr()) }
            }

            #[inline(always)]
            fn store(self, to: &mut [f32], x: $vector) {
                let to = &mut to[..$lanes];
                // SAFETY: as for `run`; `to` has a number for each lane.
                unsafe { $store(to.as_mut_ptr(), x) }
            }

            $(
                #[inline(always)]
                fn $operation(self, $($x: $vector),+) -> $vector {
                    // SAFETY: as for `run`.
                    unsafe { $intrinsic($($x),+) }
                }
            )+

            $($rest)+
        }
    };
}

kernel! {
    /// 8 lanes.
    Avx2, 8 lanes of __m256, needs ["avx2" "fma" "bmi1" "bmi2" "lzcnt" "popcnt"];
    splat = _mm256_set1_ps;
    load = _mm256_loadu_ps;
    store = _mm256_storeu_ps;
    lanewise {
        add(x, y) = _mm256_add_ps;
        sub(x, y) = _mm256_sub_ps;
        mul(x, y) = _mm256_mul_ps;
        div(x, y) = _mm256_div_ps;
        min(x, y) = _mm256_min_ps;
        max(x, y) = _mm256_max_ps;
        mul_add(x, y, z) = _mm256_fmadd_ps;
        mul_sub(x, y, z) = _mm256_fmsub_ps;
    }

    type Children = Avx2;

    #[inline(always)]
    fn children(self) -> Avx2 {
        self
    }

    #[inline(always)]
    fn store_some(self, to: &mut [f32], mask: u32, x: __m256) {
        let to = &mut to[..8];
        // SAFETY: as for `run`; `to` has 8 numbers.
        unsafe { _mm256_maskstore_ps(to.as_mut_ptr(), self.spread(mask), x) }
    }

    #[inline(always)]
    fn store_index(self, to: &mut [u32], mask: u32, x: u32) {
        let to = to[..8].as_mut_ptr().cast();
        // SAFETY: as for `run`; `to` has 8 numbers.
        unsafe { _mm256_maskstore_epi32(to, self.spread(mask), _mm256_set1_epi32(x as i32)) }
    }

    #[inline(always)]
    fn store_vectors(self, vectors: &[DVec3], scale: f64, [x, y, z]: [&mut [f32]; 3]) {
        let (vectors, x, y, z) = (&vectors[..4], &mut x[..4], &mut y[..4], &mut z[..4]);
        let from: *const f64 = vectors.as_ptr().cast();
        // SAFETY: as for `run`; four vectors are twelve consecutive f64, and x, y and z have four f32 each.
        unsafe {
            let scale = _mm256_set1_pd(scale);
            let a = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_loadu_pd(from), scale));
            let b = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_loadu_pd(from.add(4)), scale));
            let c = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_loadu_pd(from.add(8)), scale));
            // x₀ y₀ z₀ x₁, y₁ z₁ x₂ y₂, z₂ x₃ y₃ z₃: blended by position, then sorted.
            let xs = _mm_blend_ps::<0b0010>(_mm_blend_ps::<0b0100>(a, b), c);
            let ys = _mm_blend_ps::<0b0100>(_mm_blend_ps::<0b1001>(a, b), c);
            let zs = _mm_blend_ps::<0b1001>(_mm_blend_ps::<0b0010>(a, b), c);
            _mm_storeu_ps(x.as_mut_ptr(), _mm_permute_ps::<0b01_10_11_00>(xs));
            _mm_storeu_ps(y.as_mut_ptr(), _mm_permute_ps::<0b10_11_00_01>(ys));
            _mm_storeu_ps(z.as_mut_ptr(), _mm_permute_ps::<0b11_00_01_10>(zs));
        }
    }

    #[inline(always)]
    fn split_vectors(self, vectors: &[DVec3], [x, y, z]: [&mut [f64]; 3]) {
        let (vectors, x, y, z) = (&vectors[..4], &mut x[..4], &mut y[..4], &mut z[..4]);
        let from: *const f64 = vectors.as_ptr().cast();
        // SAFETY: as for `run`; four vectors are twelve consecutive f64, and x, y and z have four each.
        unsafe {
            let a = _mm256_loadu_pd(from);
            let b = _mm256_loadu_pd(from.add(4));
            let c = _mm256_loadu_pd(from.add(8));
            // As in `store_vectors`.
            let xs = _mm256_blend_pd::<0b0010>(_mm256_blend_pd::<0b0100>(a, b), c);
            let ys = _mm256_blend_pd::<0b0100>(_mm256_blend_pd::<0b1001>(a, b), c);
            let zs = _mm256_blend_pd::<0b1001>(_mm256_blend_pd::<0b0010>(a, b), c);
            _mm256_storeu_pd(x.as_mut_ptr(), _mm256_permute4x64_pd::<0b01_10_11_00>(xs));
            _mm256_storeu_pd(y.as_mut_ptr(), _mm256_permute4x64_pd::<0b10_11_00_01>(ys));
            _mm256_storeu_pd(z.as_mut_ptr(), _mm256_permute4x64_pd::<0b11_00_01_10>(zs));
        }
    }

    #[inline(always)]
    fn select(self, mask: u32, x: __m256, y: __m256) -> __m256 {
        // SAFETY: as for `run`.
        unsafe { _mm256_blendv_ps(y, x, _mm256_castsi256_ps(self.spread(mask))) }
    }

    #[inline(always)]
    fn abs(self, x: __m256) -> __m256 {
        // SAFETY: as for `run`.
        unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), x) }
    }

    #[inline(always)]
    fn flip(self, x: __m256, by: __m256) -> __m256 {
        // SAFETY: as for `run`.
        unsafe { _mm256_xor_ps(x, _mm256_and_ps(by, _mm256_set1_ps(-0.0))) }
    }

    #[inline(always)]
    fn le(self, x: __m256, y: __m256) -> u32 {
        // SAFETY: as for `run`.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(x, y)) as u32 }
    }

    #[inline(always)]
    fn not_negative(self, x: __m256, y: __m256, z: __m256) -> u32 {
        // SAFETY: as for `run`.
        unsafe {
            let least = _mm256_min_ps(_mm256_min_ps(x, y), z);
            _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(least, _mm256_setzero_ps())) as u32
        }
    }

    #[inline(always)]
    fn signs(self, x: __m256) -> u32 {
        // SAFETY: as for `run`.
        unsafe { _mm256_movemask_ps(x) as u32 }
    }

    #[inline(always)]
    fn greatest(self, x: __m256) -> f32 {
        // SAFETY: as for `run`.
        unsafe {
            let x = _mm_max_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
            let x = _mm_max_ps(x, _mm_movehl_ps(x, x));
            _mm_cvtss_f32(_mm_max_ss(x, _mm_movehdup_ps(x)))
        }
    }

    #[inline(always)]
    fn smallest(self, x: __m256) -> f32 {
        // SAFETY: as for `run`.
        unsafe {
            let x = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
            let x = _mm_min_ps(x, _mm_movehl_ps(x, x));
            _mm_cvtss_f32(_mm_min_ss(x, _mm_movehdup_ps(x)))
        }
    }
}

impl Avx2 {
    /// All bits of a lane set if `mask` has its bit.
    #[inline(always)]
    fn spread(self, mask: u32) -> __m256i {
        // SAFETY: as for `run`.
        unsafe {
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(mask as i32), bits), bits)
        }
    }
}

impl Eight for Avx2 {
    #[inline(always)]
    fn smallest_of_each(self, [a, b, c, d]: [__m256; 4]) -> [f32; 4] {
        // SAFETY: as for `run`.
        unsafe {
            // a and b interleaved, c and d interleaved, and then all four: twice in each half.
            let a_b = _mm256_min_ps(_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let c_d = _mm256_min_ps(_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            let (a_b, c_d) = (_mm256_castps_pd(a_b), _mm256_castps_pd(c_d));
            let all = _mm256_min_ps(
                _mm256_castpd_ps(_mm256_unpacklo_pd(a_b, c_d)),
                _mm256_castpd_ps(_mm256_unpackhi_pd(a_b, c_d)),
            );
            let mut smallest = [0.0; 4];
            _mm_storeu_ps(
                smallest.as_mut_ptr(),
                _mm_min_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps::<1>(all)),
            );
            smallest
        }
    }

    #[inline(always)]
    fn push_hits(
        self,
        enter: __m256,
        leave: __m256,
        nodes: &[NodeRef; 8],
        entries: &mut [u32],
        to: &mut [NodeRef],
    ) -> usize {
        let (entries, to) = (&mut entries[..8], &mut to[..8]);
        // SAFETY: as for `run`; `nodes`, `entries` and `to` have eight elements of 32 bits each.
        unsafe {
            // Nonnegative numbers are ordered like their bits; missed children are −1, and come last.
            let hit = _mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave);
            let bits = _mm256_and_si256(_mm256_castps_si256(enter), _mm256_set1_epi32(0x7fff_fff8));
            let keys = _mm256_or_si256(bits, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
            let missed = _mm256_andnot_si256(_mm256_castps_si256(hit), _mm256_set1_epi32(-1));
            let x = _mm256_or_si256(keys, missed);
            // A sorting network of six rounds: pairs, fours and eights, each merged from two sorted halves, one of them reversed.
            let y = _mm256_shuffle_epi32::<0b10_11_00_01>(x);
            let x =
                _mm256_blend_epi32::<0b1010_1010>(_mm256_max_epi32(x, y), _mm256_min_epi32(x, y));
            let y = _mm256_shuffle_epi32::<0b00_01_10_11>(x);
            let x =
                _mm256_blend_epi32::<0b1100_1100>(_mm256_max_epi32(x, y), _mm256_min_epi32(x, y));
            let y = _mm256_shuffle_epi32::<0b10_11_00_01>(x);
            let x =
                _mm256_blend_epi32::<0b1010_1010>(_mm256_max_epi32(x, y), _mm256_min_epi32(x, y));
            let y = _mm256_permutevar8x32_epi32(x, _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0));
            let x =
                _mm256_blend_epi32::<0b1111_0000>(_mm256_max_epi32(x, y), _mm256_min_epi32(x, y));
            let y = _mm256_shuffle_epi32::<0b01_00_11_10>(x);
            let x =
                _mm256_blend_epi32::<0b1100_1100>(_mm256_max_epi32(x, y), _mm256_min_epi32(x, y));
            let y = _mm256_shuffle_epi32::<0b10_11_00_01>(x);
            let x =
                _mm256_blend_epi32::<0b1010_1010>(_mm256_max_epi32(x, y), _mm256_min_epi32(x, y));
            // The lowest three bits select the nodes.
            let nodes = _mm256_loadu_si256(nodes.as_ptr().cast());
            _mm256_storeu_si256(entries.as_mut_ptr().cast(), x);
            let chosen = _mm256_permutevar8x32_epi32(nodes, x);
            _mm256_storeu_si256(to.as_mut_ptr().cast(), chosen);
            _mm256_movemask_ps(hit).count_ones() as usize
        }
    }

    #[inline(always)]
    fn push_bits(self, bits: u32, first: u32, to: &mut [u32]) -> usize {
        let to = &mut to[..8];
        // SAFETY: as for `run`; `to` has eight elements of 32 bits each.
        unsafe {
            // A byte of ones for each bit that is set; the bytes 0 to 7 at these places, closed up.
            let bytes = _pdep_u64(u64::from(bits), 0x0101_0101_0101_0101) * 0xff;
            let places = _pext_u64(0x0706_0504_0302_0100, bytes);
            let places = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(places as i64));
            let numbers = _mm256_add_epi32(places, _mm256_set1_epi32(first as i32));
            _mm256_storeu_si256(to.as_mut_ptr().cast(), numbers);
        }
        (bits & 0xff).count_ones() as usize
    }

    #[inline(always)]
    fn within(self, entries: &[u32], limit: f32) -> u32 {
        let entries = &entries[..8];
        // SAFETY: as for `run`; `entries` has eight elements.
        unsafe {
            let bits = _mm256_loadu_si256(entries.as_ptr().cast());
            let lowest = _mm256_set1_epi32(LOWEST as i32);
            let entry = _mm256_castsi256_ps(_mm256_andnot_si256(lowest, bits));
            let near = _mm256_cmp_ps::<_CMP_LE_OQ>(entry, _mm256_set1_ps(limit));
            _mm256_movemask_ps(near) as u32
        }
    }
}

kernel! {
    /// 16 lanes. The features include those of [`Avx2`].
    Avx512, 16 lanes of __m512,
    needs ["avx512f" "avx512vl" "avx512dq" "avx512bw" "avx2" "fma" "bmi1" "bmi2" "lzcnt" "popcnt"];
    splat = _mm512_set1_ps;
    load = _mm512_loadu_ps;
    store = _mm512_storeu_ps;
    lanewise {
        add(x, y) = _mm512_add_ps;
        sub(x, y) = _mm512_sub_ps;
        mul(x, y) = _mm512_mul_ps;
        div(x, y) = _mm512_div_ps;
        min(x, y) = _mm512_min_ps;
        max(x, y) = _mm512_max_ps;
        mul_add(x, y, z) = _mm512_fmadd_ps;
        mul_sub(x, y, z) = _mm512_fmsub_ps;
        abs(x) = _mm512_abs_ps;
    }

    type Children = Avx2;

    #[inline(always)]
    fn children(self) -> Avx2 {
        Avx2(())
    }

    /// A Newton step from an estimate within 2⁻¹⁴: the result is within 2⁻²⁴ + 2⁻²⁸ of 1/y, and the product rounds by 2⁻²⁴. A division of
    /// sixteen numbers takes as long as sixteen of these operations.
    #[inline(always)]
    fn quotient(self, x: __m512, y: __m512) -> __m512 {
        // SAFETY: as for `run`.
        unsafe {
            let estimate = _mm512_rcp14_ps(y);
            let error = _mm512_fnmadd_ps(y, estimate, _mm512_set1_ps(1.0));
            _mm512_mul_ps(x, _mm512_fmadd_ps(estimate, error, estimate))
        }
    }

    #[inline(always)]
    fn store_some(self, to: &mut [f32], mask: u32, x: __m512) {
        let to = &mut to[..16];
        // SAFETY: as for `run`; `to` has 16 numbers.
        unsafe { _mm512_mask_storeu_ps(to.as_mut_ptr(), mask as u16, x) }
    }

    #[inline(always)]
    fn store_index(self, to: &mut [u32], mask: u32, x: u32) {
        let to = to[..16].as_mut_ptr().cast();
        // SAFETY: as for `run`; `to` has 16 numbers.
        unsafe { _mm512_mask_storeu_epi32(to, mask as u16, _mm512_set1_epi32(x as i32)) }
    }

    #[inline(always)]
    fn store_vectors(self, vectors: &[DVec3], scale: f64, to: [&mut [f32]; 3]) {
        self.children().store_vectors(vectors, scale, to);
    }

    #[inline(always)]
    fn split_vectors(self, vectors: &[DVec3], to: [&mut [f64]; 3]) {
        self.children().split_vectors(vectors, to);
    }

    #[inline(always)]
    fn select(self, mask: u32, x: __m512, y: __m512) -> __m512 {
        // SAFETY: as for `run`.
        unsafe { _mm512_mask_blend_ps(mask as u16, y, x) }
    }

    #[inline(always)]
    fn flip(self, x: __m512, by: __m512) -> __m512 {
        // SAFETY: as for `run`.
        unsafe { _mm512_xor_ps(x, _mm512_and_ps(by, _mm512_set1_ps(-0.0))) }
    }

    #[inline(always)]
    fn le(self, x: __m512, y: __m512) -> u32 {
        // SAFETY: as for `run`.
        unsafe { u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(x, y)) }
    }

    #[inline(always)]
    fn not_negative(self, x: __m512, y: __m512, z: __m512) -> u32 {
        // SAFETY: as for `run`.
        unsafe {
            let least = _mm512_min_ps(_mm512_min_ps(x, y), z);
            u32::from(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(least, _mm512_setzero_ps()))
        }
    }

    #[inline(always)]
    fn signs(self, x: __m512) -> u32 {
        // SAFETY: as for `run`; compares the lanes' bits as integers, for which the sign bit means less than zero.
        unsafe {
            u32::from(_mm512_cmplt_epi32_mask(
                _mm512_castps_si512(x),
                _mm512_setzero_si512(),
            ))
        }
    }

    #[inline(always)]
    fn greatest(self, x: __m512) -> f32 {
        // SAFETY: as for `run`.
        unsafe { _mm512_reduce_max_ps(x) }
    }

    #[inline(always)]
    fn smallest(self, x: __m512) -> f32 {
        // SAFETY: as for `run`.
        unsafe { _mm512_reduce_min_ps(x) }
    }
}
