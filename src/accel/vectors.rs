//! Plain loops, compiled for the widest vectors that the processor has.
//!
//! A [`Loop`] is ordinary code over arrays. It is compiled several times, with different instructions; which
//! copy runs is decided when it runs. Sums, products, quotients and roots are rounded as IEEE 754 says
//! whatever the width, and nothing is fused that is written apart: results are the same bit for bit.
//!
//! A loop gets those instructions only where it is inlined without fail: what it calls for each element is
//! `#[inline(always)]`, and closures are kept out of it.

#![allow(unsafe_code)]

/// A loop over arrays.
pub(crate) trait Loop {
    /// Does it. Implementations are `#[inline(always)]`.
    fn run(self);
}

/// Runs `work` with the widest vectors.
#[inline]
pub(crate) fn widest(work: impl Loop) {
    #[cfg(target_arch = "x86_64")]
    {
        if x86::has_avx512() {
            // SAFETY: the processor has just been asked for these instructions.
            return unsafe { x86::avx512(work) };
        }
        if x86::has_avx2() {
            // SAFETY: as above.
            return unsafe { x86::avx2(work) };
        }
    }
    work.run();
}

/// Says that element `at` of `slice` will be read soon. Whether it exists does not matter.
#[inline(always)]
pub(crate) fn prefetch<T>(slice: &[T], at: usize) {
    #[cfg(target_arch = "x86_64")]
    if at < slice.len() {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: the element is in the slice, and prefetching reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(slice.as_ptr().add(at).cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, at);
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Loop;

    /// Whether [`avx512`] may be called.
    #[inline]
    pub fn has_avx512() -> bool {
        is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512bw")
            && has_avx2()
    }

    /// Whether [`avx2`] may be called.
    #[inline]
    pub fn has_avx2() -> bool {
        is_x86_feature_detected!("avx2")
    }

    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2")]
    pub fn avx512(work: impl Loop) {
        work.run();
    }

    #[target_feature(enable = "avx2")]
    pub fn avx2(work: impl Loop) {
        work.run();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Directions<'a>(&'a [f64], &'a mut [f64]);

    impl Loop for Directions<'_> {
        #[inline(always)]
        fn run(self) {
            for (x, y) in self.0.iter().zip(self.1) {
                *y = (x * 1.7 + 0.3) / (x * x + 0.1).sqrt();
            }
        }
    }

    #[test]
    fn every_width_of_vectors_gives_the_same_bits() {
        let x: Vec<f64> = (0..1003).map(|i| libm::exp(f64::from(i) * 0.01)).collect();
        let (mut narrow, mut wide) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        Directions(&x, &mut narrow).run();
        widest(Directions(&x, &mut wide));
        assert_eq!(narrow, wide);
        #[cfg(target_arch = "x86_64")]
        if x86::has_avx2() {
            let mut middle = vec![0.0; x.len()];
            // SAFETY: the processor has just been asked for these instructions.
            unsafe { x86::avx2(Directions(&x, &mut middle)) };
            assert_eq!(narrow, middle);
        }
    }
}
