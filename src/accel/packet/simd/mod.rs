//! Lanes of f32: the few operations that packets need, per instruction set.
//!
//! A value of a kernel's type proves that the processor has its instructions: only `detect` creates one. The kernels may round differently
//! (some fuse products and sums); their users make sure that decisions don't depend on it.
//!
//! Code that a kernel runs is compiled for its instructions only if it is certain to be inlined. Closures, and with them `array::map` and
//! the like, are not, so the loops of packets are written out.

use glam::DVec3;

use crate::accel::node::NodeRef;

mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(super) use portable::Portable;
#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx2, Avx512};

/// Code that is run with the instructions of a kernel. `run` must be `#[inline(always)]`, and so must everything it calls where speed
/// matters.
pub(super) trait Task {
    type Output;

    fn run<K: Simd>(self, kernel: K) -> Self::Output;
}

/// `LANES` numbers at a time. Masks are bits, the lowest for lane 0.
pub(super) trait Simd: Copy {
    /// The numbers.
    type F: Copy;
    /// Eight lanes: one per child of a node.
    type Children: Eight;
    /// The number of lanes.
    const LANES: usize;

    /// The kernel for the children of a node.
    fn children(self) -> Self::Children;
    /// Runs `task`, compiled for these instructions.
    fn run<T: Task>(self, task: T) -> T::Output;

    /// `x` in all lanes.
    fn splat(self, x: f32) -> Self::F;
    /// Each of `x` in all lanes.
    #[inline(always)]
    fn splat3(self, x: [f32; 3]) -> [Self::F; 3] {
        [self.splat(x[0]), self.splat(x[1]), self.splat(x[2])]
    }
    /// x·y + z for vectors x and y.
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
    /// Stores to the first lanes of `to`.
    fn store(self, to: &mut [f32], x: Self::F);
    /// Stores the lanes of `mask`.
    fn store_some(self, to: &mut [f32], mask: u32, x: Self::F);
    /// Stores `x` in the lanes of `mask`.
    fn store_index(self, to: &mut [u32], mask: u32, x: u32);
    /// Stores four of `vectors`, times `scale` and rounded, in the first lanes of x, y and z.
    fn store_vectors(self, vectors: &[DVec3], scale: f64, to: [&mut [f32]; 3]);
    /// Stores four of `vectors` in the first places of x, y and z.
    fn split_vectors(self, vectors: &[DVec3], to: [&mut [f64]; 3]);
    /// x in the lanes of `mask`, else y. If all lanes are then stored, loading them again does not stall, as it does after
    /// [`Simd::store_some`].
    fn select(self, mask: u32, x: Self::F, y: Self::F) -> Self::F;

    /// x + y.
    fn add(self, x: Self::F, y: Self::F) -> Self::F;
    /// x − y.
    fn sub(self, x: Self::F, y: Self::F) -> Self::F;
    /// x · y.
    fn mul(self, x: Self::F, y: Self::F) -> Self::F;
    /// x / y.
    fn div(self, x: Self::F, y: Self::F) -> Self::F;
    /// x / y within 2⁻²³ of its value if 1/y is normal; otherwise it may be NaN, infinite or 0.
    #[inline(always)]
    fn quotient(self, x: Self::F, y: Self::F) -> Self::F {
        self.div(x, y)
    }
    /// x · y + z, with one rounding or two.
    fn mul_add(self, x: Self::F, y: Self::F, z: Self::F) -> Self::F;
    /// x · y − z, with one rounding or two.
    fn mul_sub(self, x: Self::F, y: Self::F, z: Self::F) -> Self::F;
    /// |x|.
    fn abs(self, x: Self::F) -> Self::F;
    /// x with its sign flipped in lanes in which `by` has a minus sign.
    fn flip(self, x: Self::F, by: Self::F) -> Self::F;
    /// The smaller, or y if one is NaN.
    fn min(self, x: Self::F, y: Self::F) -> Self::F;
    /// The greater, or y if one is NaN.
    fn max(self, x: Self::F, y: Self::F) -> Self::F;
    /// The lanes in which x ≤ y.
    fn le(self, x: Self::F, y: Self::F) -> u32;
    /// The lanes in which x, y and z are ≥ 0.
    fn not_negative(self, x: Self::F, y: Self::F, z: Self::F) -> u32;
    /// The lanes in which the sign bit is set, including −0.
    fn signs(self, x: Self::F) -> u32;
    /// The greatest lane.
    fn greatest(self, x: Self::F) -> f32;
    /// The smallest lane.
    fn smallest(self, x: Self::F) -> f32;
}

/// The bits that hold the index of one of eight children.
pub(super) const LOWEST: u32 = 7;

/// Kernels of eight lanes.
pub(super) trait Eight: Simd {
    /// Puts those of `nodes` for which enter ≤ leave into the first elements of `to`, the nearest last, and into `entries` the bits of
    /// their entry parameters, whose lowest three bits ([`LOWEST`]) are replaced by the index of the child, so that no two are equal. The
    /// other elements up to the eighth are filled with arbitrary values. Returns the number of children. No child may be entered before 0.
    fn push_hits(
        self,
        enter: Self::F,
        leave: Self::F,
        nodes: &[NodeRef; 8],
        entries: &mut [u32],
        to: &mut [NodeRef],
    ) -> usize;

    /// The smallest lane of each of the four.
    fn smallest_of_each(self, x: [Self::F; 4]) -> [f32; 4];

    /// Stores `first` + i for each bit i of the lowest eight of `bits` that is set, in order, in the first elements of `to`. The other
    /// elements up to the eighth are filled with arbitrary values. Returns the number of bits set.
    fn push_bits(self, bits: u32, first: u32, to: &mut [u32]) -> usize;

    /// Which of the first eight of `entries`, as returned by [`Eight::push_hits`], are entered at or before `limit`, as bits.
    fn within(self, entries: &[u32], limit: f32) -> u32;
}

/// The vectors of a packet: `LANES` of them from `first` on.
#[inline(always)]
pub(super) fn load_vectors<K: Simd, const N: usize>(
    k: K,
    [x, y, z]: &[[f32; N]; 3],
    first: usize,
) -> [K::F; 3] {
    [
        k.load(&x[first..]),
        k.load(&y[first..]),
        k.load(&z[first..]),
    ]
}

#[cfg(test)]
mod tests;
