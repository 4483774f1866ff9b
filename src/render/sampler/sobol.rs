//! Sobol' points with Owen scrambling, for all random choices beyond a sample's position and time.

use super::random::{hash, unit};
use crate::accel::vectors::{VectorLoop, dispatch};

/// Two numbers in [0, 1) of sample `index` of a pixel, for the choice `dimension`: the first two dimensions of Sobol's sequence, shuffled
/// and Owen-scrambled (1995) by pixel and dimension, so that any 2ᵐ consecutive samples from a multiple of 2ᵐ on fill all elementary
/// intervals of area 2⁻ᵐ once, and dimensions are independent. Scrambling by hashing reversed bits: Laine and Karras 2011; Burley,
/// "Practical hash-based Owen scrambling", JCGT 9(4), 2020.
#[inline(always)]
pub(crate) fn sobol(pixel: u64, index: u32, dimension: u32) -> [f64; 2] {
    let noise = hash(hash(!pixel) ^ u64::from(dimension + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let index = scrambled(index, noise as u32);
    let digits = hash(noise);
    // The first dimension is van der Corput's, with reversed bits.
    let second = second_dimension(index);
    [
        unit(scrambled(index.reverse_bits(), digits as u32)),
        unit(scrambled(second, (digits >> 32) as u32)),
    ]
}

/// [`sobol`] for many pixels, in loops.
pub(crate) fn sobol_of_each(
    pixels: &[u64],
    index: u32,
    dimension: u32,
    [x, y]: &mut [Vec<f64>; 2],
) {
    x.resize(pixels.len(), 0.0);
    y.resize(pixels.len(), 0.0);
    dispatch(SobolOfEach {
        pixels,
        index,
        dimension,
        x,
        y,
    });
}

struct SobolOfEach<'a> {
    pixels: &'a [u64],
    index: u32,
    dimension: u32,
    x: &'a mut [f64],
    y: &'a mut [f64],
}

impl VectorLoop for SobolOfEach<'_> {
    #[inline(always)]
    fn run(self) {
        let count = self.pixels.len();
        let (x, y) = (&mut self.x[..count], &mut self.y[..count]);
        for k in 0..count {
            [x[k], y[k]] = sobol(self.pixels[k], self.index, self.dimension);
        }
    }
}

/// [`sobol_of_each`] with an index for each pixel.
pub(crate) fn sobol_of_each_at(
    pixels: &[u64],
    indices: &[u32],
    dimension: u32,
    [x, y]: &mut [Vec<f64>; 2],
) {
    x.resize(pixels.len(), 0.0);
    y.resize(pixels.len(), 0.0);
    dispatch(SobolOfEachAt {
        pixels,
        indices,
        dimension,
        x,
        y,
    });
}

struct SobolOfEachAt<'a> {
    pixels: &'a [u64],
    indices: &'a [u32],
    dimension: u32,
    x: &'a mut [f64],
    y: &'a mut [f64],
}

impl VectorLoop for SobolOfEachAt<'_> {
    #[inline(always)]
    fn run(self) {
        let count = self.pixels.len();
        let indices = &self.indices[..count];
        let (x, y) = (&mut self.x[..count], &mut self.y[..count]);
        for k in 0..count {
            [x[k], y[k]] = sobol(self.pixels[k], indices[k], self.dimension);
        }
    }
}

/// The same for one of `count` numbers of each pixel, from a sequence that 4 × 4 pixels share: along a Z-order curve through them (Morton
/// 1966) each takes as many consecutive points as fill its own intervals, and those of 2 × 2 and of 4 × 4 pixels fill finer ones. Errors
/// of neighbours then compensate, and noise is fine-grained (Ahmed and Wonka, "Screen-space blue-noise diffusion of Monte Carlo sampling
/// error via hierarchical ordering of pixels", SIGGRAPH Asia 2020).
#[inline]
pub(crate) fn sobol_among(pixel: u64, index: u32, count: u32, dimension: u32) -> [f64; 2] {
    // The lowest two bits of column and row: the position within its 4 × 4 pixels.
    const WITHIN: u64 = 3 | 3 << 32;
    let (x, y) = (pixel as u32 & 3, (pixel >> 32) as u32 & 3);
    let place = x & 1 | (y & 1) << 1 | (x & 2) << 1 | (y & 2) << 2;
    // A power of two for each pixel, so that its own points fill elementary intervals, too.
    let first = place.wrapping_mul(count.next_power_of_two());
    sobol(pixel & !WITHIN, first.wrapping_add(index), dimension)
}

/// The digits of the second dimension of Sobol's sequence. Its direction numbers are (1 + s)ᵏ, where s is a shift by one digit, so with the
/// index as a polynomial f over GF(2) they are f(1 + s): computed block by block, as (1 + s)ᵐ = 1 + sᵐ for powers of two (Ahmed, "An
/// implementation algorithm of 2D Sobol sequence fast, elegant, and compact", EGSR 2024).
#[inline(always)]
fn second_dimension(index: u32) -> u32 {
    let mut digits = index;
    for (m, low) in [
        (16, 0x0000_ffff),
        (8, 0x00ff_00ff),
        (4, 0x0f0f_0f0f),
        (2, 0x3333_3333),
        (1, 0x5555_5555),
    ] {
        digits ^= (digits >> m) & low;
    }
    digits.reverse_bits()
}

/// Owen scrambling of the digits of x, highest first: each is flipped according to a hash of those above it.
#[inline(always)]
fn scrambled(x: u32, seed: u32) -> u32 {
    let mut x = x.reverse_bits();
    // Only products with even numbers and sums: each bit depends only on those below it (Vegdahl 2021).
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

#[cfg(test)]
mod tests;
