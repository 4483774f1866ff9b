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
    #[path = "../../../src/accel/vectors.rs"]
    pub mod vectors;
}
