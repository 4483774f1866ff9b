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
mod tests {
    use super::*;
    use crate::accel::numbers;

    /// Checks each operation of `k` against plain f32, lane by lane. Numbers are small multiples of ½, so that sums of products are exact,
    /// whether fused or not.
    struct Check;

    impl Task for Check {
        type Output = ();

        fn run<K: Simd>(self, k: K) {
            for seed in 0..50 {
                let number = |i: usize| ((i * 37 + seed * 101) % 257) as f32 - 128.5;
                let [x, y, z]: [[f32; 16]; 3] =
                    [0, 16, 32].map(|first| std::array::from_fn(|i| number(first + i)));
                check(k, x, y, z, 0x5a5a_c3a5 >> (seed % 13));
            }
        }
    }

    fn check<K: Simd>(k: K, x: [f32; 16], y: [f32; 16], z: [f32; 16], mask: u32) {
        let lanes = |v: K::F, expected: &dyn Fn(usize) -> f32| {
            let mut out = [0.5; 16];
            k.store(&mut out, v);
            for (i, got) in out.iter().enumerate() {
                let expected = if i < K::LANES { expected(i) } else { 0.5 };
                assert_eq!(got.to_bits(), expected.to_bits(), "lane {i}");
            }
        };
        let bits = |m: u32, expected: &dyn Fn(usize) -> bool| {
            assert!((0..32).all(|i| (m >> i & 1 != 0) == (i < K::LANES && expected(i))));
        };
        let has = |i: usize| i < K::LANES && mask >> i & 1 != 0;
        let (a, b, c) = (k.load(&x), k.load(&y), k.load(&z));
        lanes(k.splat(x[3]), &|_| x[3]);
        lanes(k.add(a, b), &|i| x[i] + y[i]);
        lanes(k.sub(a, b), &|i| x[i] - y[i]);
        lanes(k.mul(a, b), &|i| x[i] * y[i]);
        lanes(k.div(a, b), &|i| x[i] / y[i]);
        lanes(k.mul_add(a, b, c), &|i| x[i] * y[i] + z[i]);
        lanes(k.mul_sub(a, b, c), &|i| x[i] * y[i] - z[i]);
        lanes(k.abs(a), &|i| x[i].abs());
        lanes(k.flip(a, b), &|i| if y[i] < 0.0 { -x[i] } else { x[i] });
        lanes(k.min(a, b), &|i| x[i].min(y[i]));
        lanes(k.max(a, b), &|i| x[i].max(y[i]));
        lanes(k.select(mask, a, b), &|i| if has(i) { x[i] } else { y[i] });
        bits(k.le(a, b), &|i| x[i] <= y[i]);
        bits(k.signs(a), &|i| x[i] < 0.0);
        bits(k.signs(k.flip(k.splat(0.0), b)), &|i| y[i] < 0.0);
        bits(k.not_negative(a, b, c), &|i| {
            x[i].min(y[i]).min(z[i]) >= 0.0
        });
        let (mut some, mut index) = ([0.5; 16], [7; 16]);
        k.store_some(&mut some, mask, a);
        k.store_index(&mut index, mask, 9);
        for i in 0..16 {
            assert_eq!(some[i], if has(i) { x[i] } else { 0.5 });
            assert_eq!(index[i], if has(i) { 9 } else { 7 });
        }
        let used = &x[..K::LANES];
        assert_eq!(k.greatest(a), used.iter().copied().fold(f32::MIN, f32::max));
        assert_eq!(k.smallest(a), used.iter().copied().fold(f32::MAX, f32::min));
        let vectors = [0, 1, 2, 3].map(|i| DVec3::new(x[i].into(), y[i].into(), z[i].into()));
        let [mut p, mut q, mut r] = [[0.0f32; 4]; 3];
        k.store_vectors(&vectors, 0.5, [&mut p, &mut q, &mut r]);
        let [mut u, mut v, mut w] = [[0.0f64; 4]; 3];
        k.split_vectors(&vectors, [&mut u, &mut v, &mut w]);
        for i in 0..4 {
            assert_eq!([p[i], q[i], r[i]], [x[i] * 0.5, y[i] * 0.5, z[i] * 0.5]);
            assert_eq!(DVec3::new(u[i], v[i], w[i]), vectors[i]);
        }
    }

    /// Checks the operations of kernels of eight lanes against the portable one.
    struct CheckEight;

    impl Task for CheckEight {
        type Output = ();

        fn run<K: Simd>(self, k: K) {
            let (k, mut next) = (k.children(), numbers(5));
            let nodes: [NodeRef; 8] = std::array::from_fn(NodeRef::inner);
            for round in 0..500 {
                // Some are entered at the same parameter or nearly so, some at 0, and some are missed.
                let mut entry = |_| match next() {
                    x if x < -0.5 => 0.25,
                    x if x < 0.0 => 0.0,
                    x if round % 3 == 0 => 0.25 + (x * 8.0).floor() as f32 * f32::EPSILON,
                    x => x as f32,
                };
                let enter: [f32; 8] = std::array::from_fn(&mut entry);
                let leave: [f32; 8] = std::array::from_fn(&mut entry);
                let (mut entries, mut to) = ([0; 8], [NodeRef::ROOT; 8]);
                let (enters, leaves) = (k.load(&enter), k.load(&leave));
                let count = k.push_hits(enters, leaves, &nodes, &mut entries, &mut to);
                let (mut expected, mut expected_to) = ([0; 8], [NodeRef::ROOT; 8]);
                let (bits, nodes_to) = (&mut expected, &mut expected_to);
                assert_eq!(
                    count,
                    Portable.push_hits(enter, leave, &nodes, bits, nodes_to)
                );
                assert_eq!(entries[..count], expected[..count]);
                assert_eq!(to[..count], expected_to[..count]);
                let rows = [leaves, enters, k.sub(enters, leaves), k.add(leaves, leaves)];
                assert_eq!(k.smallest_of_each(rows), rows.map(|row| k.smallest(row)));
                // The farthest first, and no entry later than the true one.
                for pair in entries[..count].windows(2) {
                    assert!(pair[0] > pair[1]);
                }
                for (bits, node) in entries[..count].iter().zip(&to) {
                    let at = node.index();
                    assert_eq!(bits & LOWEST, at as u32);
                    assert!(f32::from_bits(bits & !LOWEST) <= enter[at] && enter[at] <= leave[at]);
                }
                let hit = (0..8).filter(|&i| enter[i] <= leave[i]).count();
                assert_eq!(count, hit);
                let within = k.within(&expected, leave[0]);
                let near = |i: usize| f32::from_bits(expected[i] & !LOWEST) <= leave[0];
                assert!((0..32).all(|i| (within >> i & 1 != 0) == (i < 8 && near(i))));
            }
        }
    }

    #[test]
    fn every_kernel_computes_what_plain_numbers_do() {
        Portable.run(Check);
        Portable.run(CheckEight);
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(k) = Avx2::detect() {
                k.run(Check);
                k.run(CheckEight);
            }
            if let Some(k) = Avx512::detect() {
                k.run(Check);
                k.run(CheckEight);
            }
        }
    }
}
