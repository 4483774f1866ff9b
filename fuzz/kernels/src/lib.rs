//! All modules of nullray with unsafe code, alone, with their tests: built in seconds, for sanitizers and Miri.

#![allow(dead_code, unused_imports)]

#[path = "."]
mod accel {
    #[path = "."]
    pub mod packet {
        #[allow(unsafe_code)]
        #[path = "../../../src/accel/packet/simd/mod.rs"]
        pub mod simd;

        /// Says which kernels their tests have run here.
        #[cfg(all(test, target_arch = "x86_64"))]
        #[test]
        fn kernels_are_said() {
            let [avx2, avx512] = [simd::Avx2::detect().is_some(), simd::Avx512::detect().is_some()];
            println!("kernels: portable, AVX2 {avx2}, AVX-512 {avx512}");
        }
    }
    #[path = "../../../src/accel/node.rs"]
    pub mod node;
    #[allow(unsafe_code)]
    #[path = "../../../src/accel/pages.rs"]
    pub mod pages;
    #[path = "../../../src/accel/rays.rs"]
    pub mod rays;
    #[path = "../../../src/accel/texels.rs"]
    pub mod texels;
    #[path = "../../../src/accel/vectors.rs"]
    pub mod vectors;

    /// Numbers from −1 to 1 that look random, as the tests of nullray's own `accel` have them.
    #[cfg(test)]
    pub(crate) fn numbers(mut state: u64) -> impl FnMut() -> f64 {
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }
}

#[path = "."]
mod colour {
    #[path = "../../../src/colour/shift_matrix.rs"]
    mod shift_matrix;
    pub(crate) use shift_matrix::ShiftMatrix;
}
