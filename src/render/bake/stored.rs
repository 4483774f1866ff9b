//! The number formats of a cube in progress: f32, or the bits of f16, which take half the memory.

use half::f16;
use half::vec::HalfBitsVecExt;

use super::CubePrecision;
use crate::error::{Error, Result, Setting};
use crate::io::cube::CubeSamples;
use crate::io::npy::Dtype;
use crate::scene::model::Scene;

/// A number of a cube. A vector of default values, zeros, takes no memory until it is written to.
pub(super) trait Stored: Copy + Default + Send + Sync {
    const PRECISION: CubePrecision;
    fn of(number: f32) -> Self;
    fn number(self) -> f32;
    fn samples(values: Vec<Self>) -> CubeSamples;

    /// The energy (mean of R, G, B) in numbers that are too small for the format.
    fn faint(_: &[f32]) -> f64 {
        0.0
    }

    /// Refuses finite numbers that overflow the format.
    fn check(_: &[Self], _: &Scene) -> Result<()> {
        Ok(())
    }
}

impl Stored for f32 {
    const PRECISION: CubePrecision = CubePrecision::Single;

    fn of(number: f32) -> Self {
        number
    }

    fn number(self) -> f32 {
        self
    }

    fn samples(values: Vec<f32>) -> CubeSamples {
        CubeSamples::F32(values)
    }
}

impl Stored for u16 {
    const PRECISION: CubePrecision = CubePrecision::Half;

    fn of(number: f32) -> Self {
        f16::from_f32(number).to_bits()
    }

    fn number(self) -> f32 {
        f16::from_bits(self).to_f32()
    }

    fn samples(values: Vec<u16>) -> CubeSamples {
        CubeSamples::F16(values.reinterpret_into())
    }

    fn faint(values: &[f32]) -> f64 {
        let values = values.iter().map(|value| f64::from(*value));
        let faint = values.filter(|value| Dtype::F16.blurs(*value));
        faint.sum::<f64>() / 3.0
    }

    fn check(values: &[u16], scene: &Scene) -> Result<()> {
        match values.iter().all(|bits| f16::from_bits(*bits).is_finite()) {
            true => Ok(()),
            false => Err(Error::unsupported(
                &scene.name,
                "light",
                format!("energies beyond {} do not fit half precision", f16::MAX),
                Setting::SinglePrecision,
            )),
        }
    }
}
