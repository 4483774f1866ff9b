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
            // Bits beyond the eighth do not count.
            let before = (0..8).filter(|&i| enter[i] <= 0.25).map(|i| 1 << i);
            let bits = before.sum::<u32>() | 0x100;
            let (mut numbers, mut expected_numbers) = ([0; 8], [0; 8]);
            let set = k.push_bits(bits, 1000, &mut numbers);
            assert_eq!(set, Portable.push_bits(bits, 1000, &mut expected_numbers));
            assert_eq!(numbers[..set], expected_numbers[..set]);
            let is_set = (0..8).filter(|i| bits >> i & 1 != 0).map(|i| 1000 + i);
            assert!(is_set.eq(numbers[..set].iter().copied()));
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
