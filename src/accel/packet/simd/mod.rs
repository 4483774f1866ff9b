//! Lanes of f32: the few operations that packets need, per instruction set.
//!
//! A value of a kernel's type is the proof that the processor has its instructions: only `detect` makes
//! one. The kernels may round differently (one fuses products and sums, another doesn't); whoever uses
//! them takes care that decisions don't depend on it.
//!
//! What a kernel runs is compiled with its instructions only where it is inlined without fail. Closures, and
//! with them `array::map` and the like, are not: the loops of packets are written out.

use glam::DVec3;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

pub(super) use portable::Portable;
#[cfg(target_arch = "x86_64")]
pub(super) use {avx2::Avx2, avx512::Avx512};

/// What is run with the instructions of a kernel. `run` must be `#[inline(always)]`, and all that it
/// calls where speed matters.
pub(super) trait Task {
    /// Does it.
    fn run<K: Simd>(self, kernel: K);
}

/// `LANES` numbers at a time. Masks are bits, the lowest for lane 0.
pub(super) trait Simd: Copy {
    /// The numbers.
    type F: Copy;
    /// Eight lanes: one per child of a node.
    type Children: Simd;
    /// How many numbers.
    const LANES: usize;

    /// The kernel for the children of a node.
    fn children(self) -> Self::Children;
    /// Runs `task`, compiled for these instructions.
    fn run(self, task: impl Task);

    /// Says that this will be read soon.
    fn prefetch<T>(self, what: &T);
    /// `x` in all lanes.
    fn splat(self, x: f32) -> Self::F;
    /// Each of `x` in all lanes.
    #[inline(always)]
    fn splat3(self, x: [f32; 3]) -> [Self::F; 3] {
        [self.splat(x[0]), self.splat(x[1]), self.splat(x[2])]
    }
    /// x·y + z.
    #[inline(always)]
    fn dot(self, x: &[Self::F; 3], y: &[Self::F; 3], z: Self::F) -> Self::F {
        self.mul_add(
            x[0],
            y[0],
            self.mul_add(x[1], y[1], self.mul_add(x[2], y[2], z)),
        )
    }
    /// The first lanes of `from`.
    fn load(self, from: &[f32]) -> Self::F;
    /// Stores four of `vectors`, times `scale` and rounded, in the first lanes of x, y and z.
    fn store_vectors(
        self,
        vectors: &[DVec3],
        scale: f64,
        x: &mut [f32],
        y: &mut [f32],
        z: &mut [f32],
    );
    /// Stores to the first lanes of `to`.
    fn store(self, to: &mut [f32], x: Self::F);
    /// Stores the lanes of `mask`.
    fn store_some(self, to: &mut [f32], mask: u32, x: Self::F);
    /// x in the lanes of `mask`, else y. Stored and loaded again in whole, this doesn't wait, as after
    /// [`Simd::store_some`].
    fn select(self, mask: u32, x: Self::F, y: Self::F) -> Self::F;
    /// Stores `x` in the lanes of `mask`.
    fn store_index(self, to: &mut [u32], mask: u32, x: u32);

    /// x + y.
    fn add(self, x: Self::F, y: Self::F) -> Self::F;
    /// x − y.
    fn sub(self, x: Self::F, y: Self::F) -> Self::F;
    /// x · y.
    fn mul(self, x: Self::F, y: Self::F) -> Self::F;
    /// x / y.
    fn div(self, x: Self::F, y: Self::F) -> Self::F;
    /// x · y + z, with one rounding or two.
    fn mul_add(self, x: Self::F, y: Self::F, z: Self::F) -> Self::F;
    /// x · y − z, with one rounding or two.
    fn mul_sub(self, x: Self::F, y: Self::F, z: Self::F) -> Self::F;
    /// |x|.
    fn abs(self, x: Self::F) -> Self::F;
    /// x, with the other sign where `by` has a minus.
    fn flip(self, x: Self::F, by: Self::F) -> Self::F;
    /// The smaller, or y where one is NaN.
    fn min(self, x: Self::F, y: Self::F) -> Self::F;
    /// The greater, or y where one is NaN.
    fn max(self, x: Self::F, y: Self::F) -> Self::F;
    /// Where x ≤ y.
    fn le(self, x: Self::F, y: Self::F) -> u32;
    /// Where x, y and z are ≥ 0.
    fn not_negative(self, x: Self::F, y: Self::F, z: Self::F) -> u32;
    /// The greatest lane.
    fn greatest(self, x: Self::F) -> f32;
    /// The smallest lane.
    fn smallest(self, x: Self::F) -> f32;
}
