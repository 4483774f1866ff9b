use std::f64::consts::FRAC_PI_4;

use super::*;
use crate::accel::numbers;
use crate::accel::vectors::{VectorLoop, dispatch};

/// Sines and cosines of many angles.
struct All<'a>(&'a [Block], &'a mut [[Block; 2]]);

impl VectorLoop for All<'_> {
    #[inline(always)]
    fn run(self) {
        for (angles, [sines, cosines]) in self.0.iter().zip(self.1) {
            sincos_each(angles, sines, cosines);
        }
    }
}

/// Checks that sines and cosines of these angles have the bits of libm's, and that the number of angles per block that are not left to libm is
/// as `usual` requires.
fn check(angles: impl Iterator<Item = f64>, usual: impl Fn(usize) -> bool) {
    let angles: Vec<f64> = angles.collect();
    let (blocks, rest) = angles.as_chunks();
    assert!(rest.is_empty());
    let of_block = |block: &Block| block.iter().all(|x| sincos_usual(*x).2);
    let count = blocks.iter().filter(|block| of_block(block)).count();
    assert!(usual(count), "{count} of {}", blocks.len());
    let mut wide = vec![[[0.0; BLOCK]; 2]; blocks.len()];
    let mut narrow = wide.clone();
    dispatch(All(blocks, &mut wide));
    All(blocks, &mut narrow).run();
    for seen in [wide, narrow] {
        let seen = seen
            .iter()
            .flat_map(|[sines, cosines]| sines.iter().zip(cosines));
        for (x, (sine, cosine)) in angles.iter().zip(seen) {
            let expected = libm::sincos(*x);
            let seen = [*sine, *cosine].map(f64::to_bits);
            assert_eq!(seen, [expected.0, expected.1].map(f64::to_bits), "{x:e}");
        }
    }
}

#[test]
fn sines_and_cosines_have_the_bits_of_libm() {
    let mut next = numbers(5);
    let most = 9.0 * FRAC_PI_4;
    check((0..1 << 20).map(|_| most * next()), |usual| usual > 16000);
    // Of any size.
    let mut next = numbers(6);
    let any = (0..1 << 16).map(|k| f64::from_bits(k << 47) * next());
    check(any.filter(|x| x.is_finite()).take(65024), |usual| {
        usual < 600
    });
    check((0..BLOCK * 100).map(|k| -0.0 * k as f64), |usual| {
        usual == 100
    });
}

#[test]
fn angles_about_multiples_of_eighths_of_a_turn_have_the_bits_of_libm() {
    for eighth in 1..=12 {
        for sign in [1.0, -1.0] {
            let at = (sign * FRAC_PI_4 * f64::from(eighth)).to_bits() as i64;
            let mut next = numbers(eighth as u64);
            // At 2⁰ to 2⁴⁷ floating-point steps away, one block each.
            let near = (0..BLOCK * 48).map(|k| {
                let off = (next() * 2f64.powi((k / BLOCK) as i32)) as i64;
                f64::from_bits((at + off) as u64)
            });
            // Near multiples of π/2, more digits are lost than two parts of π/2 make up for.
            let is_kept = |usual| match eighth {
                1 | 3 | 5 | 7 => usual == 48,
                9 => usual < 48,
                _ => usual < 20,
            };
            check(near, is_kept);
        }
    }
}

#[test]
fn one_angle_that_is_left_to_libm_leaves_the_others_as_they_are() {
    for odd in [1e9, -8.0, f64::from_bits(0x4009_21fb_5444_2d18)] {
        check(
            (0..BLOCK).map(|k| if k == 37 { odd } else { k as f64 / 9.0 }),
            |usual| usual == 0,
        );
    }
    let (mut sines, mut cosines) = ([0.0; BLOCK], [0.0; BLOCK]);
    for odd in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        sincos_each(&[odd; BLOCK], &mut sines, &mut cosines);
        assert!(sines.iter().chain(&cosines).all(|x| x.is_nan()));
    }
}
