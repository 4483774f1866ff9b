//! Plain loops over arrays, compiled for the widest vectors that the processor has.
//!
//! A [`VectorLoop`] is ordinary Rust. [`dispatch`] holds a copy of it for each instruction set and picks one at run
//! time. IEEE 754 rounds sums, products, quotients and roots the same at every width, and the compiler fuses nothing
//! that is written apart: results are the same bit for bit.
//!
//! A loop gets the wide instructions only where all of it is inlined: whatever it calls per element is
//! `#[inline(always)]`, and it contains no closures.

#![allow(unsafe_code)]

use glam::DVec3;

/// A loop over arrays, with what it reads and writes.
pub(crate) trait VectorLoop {
    /// Runs the loop. Implementations are `#[inline(always)]`.
    fn run(self);
}

/// Runs `work` with the widest vectors that this processor has.
#[inline]
pub(crate) fn dispatch(work: impl VectorLoop) {
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

/// Vectors by component, for loops over many of them.
#[derive(Debug, Default, Clone)]
pub(crate) struct Columns {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

/// [`Columns`] to be read: all of one length that loops know.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ColumnsRef<'a> {
    x: &'a [f64],
    y: &'a [f64],
    z: &'a [f64],
}

/// [`Columns`] to be written.
#[derive(Debug)]
pub(crate) struct ColumnsMut<'a> {
    x: &'a mut [f64],
    y: &'a mut [f64],
    z: &'a mut [f64],
}

impl Columns {
    /// Makes room for `count` vectors; what they are is to be written.
    pub fn resize(&mut self, count: usize) {
        for column in [&mut self.x, &mut self.y, &mut self.z] {
            column.resize(count, 0.0);
        }
    }

    /// Forgets all vectors.
    pub fn clear(&mut self) {
        self.resize(0);
    }

    /// Adds one more.
    #[inline(always)]
    pub fn push(&mut self, v: DVec3) {
        self.x.push(v.x);
        self.y.push(v.y);
        self.z.push(v.z);
    }

    /// Vector `k`.
    #[inline(always)]
    pub fn get(&self, k: usize) -> DVec3 {
        DVec3::new(self.x[k], self.y[k], self.z[k])
    }

    /// The first `count` vectors.
    #[inline(always)]
    pub fn first(&self, count: usize) -> ColumnsRef<'_> {
        ColumnsRef {
            x: &self.x[..count],
            y: &self.y[..count],
            z: &self.z[..count],
        }
    }

    /// The first `count` vectors, to be written.
    #[inline(always)]
    pub fn first_mut(&mut self, count: usize) -> ColumnsMut<'_> {
        ColumnsMut {
            x: &mut self.x[..count],
            y: &mut self.y[..count],
            z: &mut self.z[..count],
        }
    }
}

impl ColumnsRef<'_> {
    /// How many vectors.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Vector `k`.
    #[inline(always)]
    pub fn get(&self, k: usize) -> DVec3 {
        DVec3::new(self.x[k], self.y[k], self.z[k])
    }
}

impl ColumnsMut<'_> {
    /// How many vectors.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Vector `k`.
    #[inline(always)]
    pub fn get(&self, k: usize) -> DVec3 {
        DVec3::new(self.x[k], self.y[k], self.z[k])
    }

    /// Writes vector `k`.
    #[inline(always)]
    pub fn set(&mut self, k: usize, v: DVec3) {
        [self.x[k], self.y[k], self.z[k]] = v.to_array();
    }
}

/// Loads element `at` of `slice` into the cache, to be read soon. Does nothing if `at` is out of bounds.
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

/// Loads all of `what` into the cache, to be read soon.
#[inline(always)]
pub(crate) fn prefetch_all<T>(what: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first: *const i8 = std::ptr::from_ref(what).cast();
        let mut at = 0;
        while at < size_of::<T>() {
            // SAFETY: prefetching reads nothing, and `at` is within `what`.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.add(at)) };
            at += 64;
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = what;
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::VectorLoop;

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
    pub fn avx512(work: impl VectorLoop) {
        work.run();
    }

    #[target_feature(enable = "avx2")]
    pub fn avx2(work: impl VectorLoop) {
        work.run();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Directions<'a>(&'a [f64], &'a mut [f64]);

    impl VectorLoop for Directions<'_> {
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
        dispatch(Directions(&x, &mut wide));
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
