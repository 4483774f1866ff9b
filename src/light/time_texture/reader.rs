//! Reads samples: the only place that depends on their stored type. Monomorphised over type and channels, which are selected once per
//! lookup; nothing is allocated or converted in advance.

use super::axis::Moment;
use super::bilinear::Tap;
use super::near::Near;
use super::weights::BinWeights;
use crate::io::cube::{Bricks, Cube, CubeSamples, CubeStore};

/// A stored number.
pub(super) trait Sample: Copy {
    /// 0.
    const ZERO: Self;
    /// A type that holds it exactly and is faster in arithmetic.
    type Wide: Copy + Into<f64>;
    /// Its value in that type.
    fn wide(self) -> Self::Wide;
    /// Exact in f64.
    #[inline(always)]
    fn value(self) -> f64 {
        self.wide().into()
    }
}

impl Sample for half::f16 {
    const ZERO: Self = half::f16::ZERO;
    type Wide = f32;

    /// For finite numbers, as all samples are: the exponent and mantissa bits give an f32 that is too small by the difference of the
    /// exponent biases, 127 − 15.
    #[inline(always)]
    fn wide(self) -> f32 {
        const BIAS: f32 = f32::from_bits((127 + 127 - 15) << 23);
        let bits = u32::from(self.to_bits());
        let magnitude = f32::from_bits((bits & 0x7fff) << 13) * BIAS;
        f32::from_bits(magnitude.to_bits() | (bits & 0x8000) << 16)
    }
}

impl Sample for f32 {
    const ZERO: Self = 0.0;
    type Wide = f32;

    #[inline(always)]
    fn wide(self) -> f32 {
        self
    }
}

impl Sample for f64 {
    const ZERO: Self = 0.0;
    type Wide = f64;

    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }
}

/// The weighted sum over taps and over the bins of each; a single channel is copied to all three.
#[inline]
pub(super) fn read(
    cube: &CubeStore,
    taps: &[Tap; 4],
    moments: [&Moment; 4],
    near: &Near,
) -> [f64; 3] {
    let cube = match cube {
        CubeStore::Memory(cube) => cube,
        CubeStore::Disk(bricks) => return read_from_disk(bricks, taps, moments, near),
    };
    match &cube.samples {
        CubeSamples::F16(samples) => by_channels(samples, cube.shape, taps, moments),
        CubeSamples::F32(samples) => by_channels(samples, cube.shape, taps, moments),
        CubeSamples::F64(samples) => by_channels(samples, cube.shape, taps, moments),
    }
}

/// The weighted sum over the bins of one texel; a single channel is copied to all three.
pub(super) fn read_texel(cube: &CubeStore, texel: usize, moment: &Moment, near: &Near) -> [f64; 3] {
    match cube {
        CubeStore::Memory(cube) => read_texel_in_memory(cube, texel, moment),
        CubeStore::Disk(bricks) => texel_on_disk(bricks, texel, &moment.bins, near),
    }
}

fn read_texel_in_memory(cube: &Cube, texel: usize, moment: &Moment) -> [f64; 3] {
    fn of<S: Sample>(
        samples: &[S],
        [_, _, bins, channels]: [usize; 4],
        texel: usize,
        moment: &Moment,
    ) -> [f64; 3] {
        if channels == 3 {
            return along_time::<S, 3>(samples, texel * bins, &moment.bins);
        }
        let [grey] = along_time::<S, 1>(samples, texel * bins, &moment.bins);
        [grey; 3]
    }
    match &cube.samples {
        CubeSamples::F16(samples) => of(samples, cube.shape, texel, moment),
        CubeSamples::F32(samples) => of(samples, cube.shape, texel, moment),
        CubeSamples::F64(samples) => of(samples, cube.shape, texel, moment),
    }
}

/// [`read`] from bricks, with the same operations.
#[cold]
fn read_from_disk(
    bricks: &Bricks,
    taps: &[Tap; 4],
    moments: [&Moment; 4],
    near: &Near,
) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (tap, moment) in taps.iter().zip(moments) {
        let texel = texel_on_disk(bricks, tap.texel, &moment.bins, near);
        for (sum, value) in sum.iter_mut().zip(texel) {
            *sum += tap.weight * value;
        }
    }
    sum
}

fn texel_on_disk(bricks: &Bricks, texel: usize, run: &BinWeights, near: &Near) -> [f64; 3] {
    let channels = bricks.shape()[3];
    let mut values = [0.0; 6 * 3];
    let values = &mut values[..run.count * channels];
    near.samples(bricks, texel, run.first, values);
    if channels == 3 {
        return weighted::<f64, 3>(values.as_chunks().0, &run.weights);
    }
    let [grey] = weighted::<f64, 1>(values.as_chunks().0, &run.weights);
    [grey; 3]
}

#[inline]
fn by_channels<S: Sample>(
    samples: &[S],
    [_, _, bins, channels]: [usize; 4],
    taps: &[Tap; 4],
    moments: [&Moment; 4],
) -> [f64; 3] {
    if channels == 3 {
        blend::<S, 3>(samples, bins, taps, moments)
    } else {
        let [grey] = blend::<S, 1>(samples, bins, taps, moments);
        [grey; 3]
    }
}

#[inline]
fn blend<S: Sample, const C: usize>(
    samples: &[S],
    bins: usize,
    taps: &[Tap; 4],
    moments: [&Moment; 4],
) -> [f64; C] {
    let mut sum = [0.0; C];
    for (tap, moment) in taps.iter().zip(moments) {
        let texel = along_time::<S, C>(samples, tap.texel * bins, &moment.bins);
        for (sum, value) in sum.iter_mut().zip(texel) {
            *sum += tap.weight * value;
        }
    }
    sum
}

/// The weighted sum over a run of bins of the texel whose bin 0 has the index `origin` among all bins.
#[inline]
fn along_time<S: Sample, const C: usize>(
    samples: &[S],
    origin: usize,
    run: &BinWeights,
) -> [f64; C] {
    let first = (origin + run.first) * C;
    // Textures are made of checked cubes, so the run always exists.
    let values = samples.get(first..first + run.count * C);
    let (bins, _) = values.unwrap_or_default().as_chunks::<C>();
    // The filter lengths away from the ends, as constants, so that the loop is unrolled.
    match bins.len() {
        2 => weighted::<S, C>(&bins[..2], &run.weights),
        4 => weighted::<S, C>(&bins[..4], &run.weights),
        _ => weighted::<S, C>(bins, &run.weights),
    }
}

#[inline(always)]
fn weighted<S: Sample, const C: usize>(bins: &[[S; C]], weights: &[f64; 6]) -> [f64; C] {
    let mut sum = [0.0; C];
    for (bin, weight) in bins.iter().zip(weights) {
        for (sum, sample) in sum.iter_mut().zip(bin) {
            *sum += weight * sample.value();
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finite_half_is_read_exactly() {
        for bits in 0..=u16::MAX {
            let half = half::f16::from_bits(bits);
            if half.is_finite() {
                assert_eq!(half.value().to_bits(), half.to_f64().to_bits(), "{bits:#x}");
            }
        }
    }
}
