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
fn vectors_in_a_row_are_taken_apart_in_order_and_whatever_was_there_is_gone() {
    let row = |n: usize| -> Vec<DVec3> {
        let v = |k| DVec3::new(k as f64, 0.5 + k as f64, -(k as f64));
        (0..n).map(v).collect()
    };
    let mut columns = Columns::default();
    for count in [3 * BLOCK + 7, BLOCK, 5, 0] {
        let row = row(count);
        columns.take(&row);
        assert_eq!(columns.len(), count);
        let taken: Vec<_> = (0..count).map(|k| columns.get(k)).collect();
        assert_eq!(taken, row);
    }
}

#[test]
fn rows_are_gathered_word_by_word_and_those_that_are_not_there_are_zeros() {
    // Including words that are NaN as f32.
    let word = |row: u32, k: u32| (row * 8 + k).wrapping_mul(0x9e37_79b9) | 0x7f80_0001;
    let rows: Vec<[u32; 8]> = (0..100)
        .map(|row| std::array::from_fn(|k| word(row, k as u32)))
        .collect();
    let numbers: [u32; BLOCK] = std::array::from_fn(|k| match k % 9 {
        4 => NO_ROW,
        7 => 100,
        _ => (k * 37 % 100) as u32,
    });
    let (mut wide, mut narrow) = ([[1; BLOCK]; 8], [[2; BLOCK]; 8]);
    gather_rows(&rows, &numbers, &mut wide);
    gather_rows_singly(&rows, &numbers, &mut narrow);
    assert_eq!(wide, narrow);
    for (k, number) in numbers.into_iter().enumerate() {
        for (at, column) in wide.iter().enumerate() {
            let is_there = number < 100;
            let expected = if is_there { word(number, at as u32) } else { 0 };
            assert_eq!(column[k], expected);
        }
    }
}

#[test]
fn vectors_are_gathered_axis_by_axis_and_those_that_are_not_there_are_zeros() {
    let vectors: Vec<DVec3> = (0..100)
        .map(|k| DVec3::new(f64::from(k), 0.5 + f64::from(k), -f64::from(k)))
        .collect();
    let factors: Block = std::array::from_fn(|k| if k % 3 == 0 { -1.0 } else { 0.5 });
    // All before the last one; including the last one; and some out of range.
    for end in [99, 100, 103] {
        let numbers: [u32; BLOCK] = std::array::from_fn(|k| (end - 1 - k * 37 % end) as u32);
        assert!(numbers.contains(&(end as u32 - 1)));
        let all = |gather: fn(&[DVec3], &[u32; BLOCK], &Block, [&mut Block; 3])| {
            let mut all = [[7.0; BLOCK]; 3];
            gather(&vectors, &numbers, &factors, all.each_mut());
            all
        };
        let (wide, narrow) = (all(gather_vectors), all(gather_vectors_singly));
        assert_eq!(wide, narrow);
        for (k, number) in numbers.into_iter().enumerate() {
            let v = vectors.get(number as usize).copied().unwrap_or_default();
            assert_eq!(wide.map(|axis| axis[k]), (v * factors[k]).to_array());
        }
    }
}

#[test]
fn colours_are_shifted_alike_in_vectors_and_one_by_one() {
    let number = |n: usize| ((n * 7919) % 1009) as f32 / 1009.0 - 0.3;
    let matrices: Vec<ShiftMatrix> = (0..20)
        .map(|n| ShiftMatrix {
            columns: [0, 1, 2].map(|c| std::array::from_fn(|k| number(n * 24 + c * 8 + k))),
        })
        .collect();
    // Some of the matrices do not exist.
    let at: [u64; BLOCK] = std::array::from_fn(|k| match k % 7 {
        3 => u64::MAX - k as u64,
        5 => 20,
        _ => k as u64 % 20,
    });
    let rests: Block = std::array::from_fn(|k| k as f64 / 64.0);
    let factors: Vec<f64> = (0..50).map(|k| 0.5 + f64::from(k)).collect();
    let start: Vec<[f64; 3]> = (0..50)
        .map(|k| [f64::from(k), 1.0 / f64::from(k + 1), -2.5])
        .collect();
    let (mut wide, mut narrow) = (start.clone(), start.clone());
    shift_each(&matrices, (&at, &rests), (&factors, 0.75), &mut wide);
    shift_singly(&matrices, (&at, &rests), (&factors, 0.75), &mut narrow);
    assert_eq!(wide, narrow);
    for (k, seen) in wide.iter().enumerate() {
        let (at, rest) = (at[k], rests[k]);
        let expected = match at < 20 {
            false => start[k],
            true => [0, 1, 2].map(|row| {
                let column = |c: usize| matrices[at as usize].columns[c];
                let between = |c| f64::from(column(c)[row]) + f64::from(column(c)[row + 4]) * rest;
                (0..3).map(|c| between(c) * start[k][c]).sum::<f64>() * factors[k] * 0.75
            }),
        };
        for (seen, expected) in seen.iter().zip(expected) {
            let error = (seen - expected).abs();
            assert!(error < 1e-12 * (1.0 + expected.abs()), "{k}: {error:e}");
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
        // SAFETY: the processor has these instructions.
        unsafe { x86::avx2(Directions(&x, &mut middle)) };
        assert_eq!(narrow, middle);
    }
}
