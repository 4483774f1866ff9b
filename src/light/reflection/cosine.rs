//! Directions about a normal with a cosine density, as diffuse surfaces reflect.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch, load};

/// A direction about `n` from two numbers in [0, 1), with a cosine density.
#[inline(always)]
pub(in crate::light) fn by_cosine(n: DVec3, [x, y]: [f64; 2]) -> DVec3 {
    let (tangent, bitangent) = n.any_orthonormal_pair();
    let (sine, cosine) = sine_and_cosine_of_turn(y);
    // Uniform in the unit disc, then lifted to the sphere (Malley): the height is √(1 − x).
    let (radius, rest) = (x.sqrt(), 1.0 - x);
    let height = if rest > 0.0 { rest } else { 0.0 };
    tangent * (radius * cosine) + bitangent * (radius * sine) + n * height.sqrt()
}

/// [`by_cosine`] for many normals and pairs of numbers, in a loop.
pub(crate) fn each_by_cosine(normals: &Columns, numbers: &[Vec<f64>; 2], l: &mut Columns) {
    l.resize(normals.len());
    dispatch(EachByCosine {
        normals,
        numbers,
        l,
    });
}

struct EachByCosine<'a> {
    normals: &'a Columns,
    numbers: &'a [Vec<f64>; 2],
    l: &'a mut Columns,
}

impl VectorLoop for EachByCosine<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        while begin < self.normals.len() {
            let mut normals = self.normals.load(begin);
            let x = load(&self.numbers[0], begin);
            let y = load(&self.numbers[1], begin);
            for k in 0..BLOCK {
                normals.set(k, by_cosine(normals.get(k), [x[k], y[k]]));
            }
            self.l.store(&normals, begin);
            begin += BLOCK;
        }
    }
}

/// 1/(2k(2k + 1)) and 1/((2k − 1) 2k) for k from 1 on.
const SINE: [f64; TERMS] = reciprocals(2, 3);
const COSINE: [f64; TERMS] = reciprocals(1, 2);
const TERMS: usize = 8;

const fn reciprocals(first: usize, second: usize) -> [f64; TERMS] {
    let mut terms = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        terms[k] = 1.0 / ((first + 2 * k) * (second + 2 * k)) as f64;
        k += 1;
    }
    terms
}

/// sin 2πy and cos 2πy for y from 0 to 1, branch-free, for loops over many.
///
/// With q the nearest quarter turn, a = 2π(y − q/4) is within π/4, where Taylor's series up to a¹⁷ and a¹⁶ have errors below (π/4)¹⁸/18!
/// < 2⁻⁵⁸; then q quarter turns are added.
#[inline(always)]
fn sine_and_cosine_of_turn(y: f64) -> (f64, f64) {
    let quarter = (4.0 * y + 0.5).floor();
    let a = TAU * (y - 0.25 * quarter);
    let b = a * a;
    let (mut sine, mut cosine) = (1.0, 1.0);
    // From the last term on: 1 − b/(2k(2k + 1)) (…) and 1 − b/((2k − 1) 2k) (…).
    let mut k = TERMS;
    while k > 0 {
        k -= 1;
        sine = 1.0 - b * SINE[k] * sine;
        cosine = 1.0 - b * COSINE[k] * cosine;
    }
    let sine = a * sine;
    // Odd quarters swap the two; quarters 1 and 2 change the sign of the cosine, 2 and 3 that of the sine.
    let odd = quarter == 1.0 || quarter == 3.0;
    let (s, c) = if odd { (cosine, sine) } else { (sine, cosine) };
    let s = if quarter == 2.0 || quarter == 3.0 {
        -s
    } else {
        s
    };
    let c = if quarter == 1.0 || quarter == 2.0 {
        -c
    } else {
        c
    };
    (s, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_and_cosines_of_turns_are_those_of_the_library() {
        for k in 0..=4096 {
            for y in [
                f64::from(k) / 4096.0,
                (f64::from(k) / 4096.0).next_down().abs(),
            ] {
                let (sine, cosine) = sine_and_cosine_of_turn(y);
                // The product 2πy in the reference is rounded, too.
                let (s, c) = libm::sincos(TAU * y);
                assert!(
                    (sine - s).abs() < 1e-15 && (cosine - c).abs() < 1e-15,
                    "{y}"
                );
            }
        }
        assert_eq!(sine_and_cosine_of_turn(0.0), (0.0, 1.0));
        assert_eq!(sine_and_cosine_of_turn(0.75), (-1.0, 0.0));
    }
}
