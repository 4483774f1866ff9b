//! What light becomes for an observer in motion relative to its source.
//!
//! A radiance is seen with W⁻ᵖ (p by the declared quantity). Linear RGB as spectra is seen as M(W) times what it is at
//! the source, with M of the power of a radiance. Irradiance has the W² of solid angles more.

use crate::colour::RgbShift;
use crate::spacetime::{Quantity, WavelengthRatio};

/// What is received of light, by W.
#[derive(Debug, Clone, Copy)]
pub enum Received {
    /// All channels with the same power of W.
    Scaled(Quantity),
    /// Channels that are linear RGB of spectra.
    Rgb(&'static RgbShift),
}

impl Received {
    /// The radiance received, where the source has `radiance`.
    #[inline]
    pub fn radiance(&self, w: f64, radiance: [f64; 3]) -> [f64; 3] {
        match self {
            Received::Scaled(quantity) => {
                let factor = quantity.radiance_factor(WavelengthRatio(w));
                radiance.map(|l| l * factor)
            }
            Received::Rgb(shift) => shift.apply(w, radiance),
        }
    }

    /// What is received of an irradiance, times `factor`.
    #[inline]
    pub fn irradiance(&self, w: f64, irradiance: [f64; 3], factor: f64) -> [f64; 3] {
        let factor = self.irradiance_factor(w) * factor;
        self.colour(w, irradiance).map(|e| e * factor)
    }

    /// The factor on an irradiance beside that of [`Received::colour`]: W²⁻ᵖ, or W² where that has W⁻ᵖ in it.
    #[inline]
    pub fn irradiance_factor(&self, w: f64) -> f64 {
        match self {
            Received::Scaled(quantity) => quantity.irradiance_factor(WavelengthRatio(w)),
            Received::Rgb(_) => w * w,
        }
    }

    /// [`Received::irradiance_factor`] in place of each W. A plain loop, to be compiled for wide vectors.
    #[inline(always)]
    pub(crate) fn irradiance_factors(&self, ratios: &mut [f64]) {
        match self {
            Received::Scaled(quantity) => quantity.irradiance_factors(ratios),
            Received::Rgb(_) => {
                for w in ratios {
                    *w *= *w;
                }
            }
        }
    }

    /// The channels as they are seen at W.
    #[inline]
    pub fn colour(&self, w: f64, channels: [f64; 3]) -> [f64; 3] {
        match self {
            Received::Scaled(_) => channels,
            Received::Rgb(shift) => shift.apply(w, channels),
        }
    }

    /// Wavelengths received over those of the source, where the light is of one line; 1 where RGB has it in its colour.
    #[inline]
    pub fn wavelength_scale(&self, w: f64) -> f64 {
        match self {
            Received::Scaled(_) => w,
            Received::Rgb(_) => 1.0,
        }
    }
}
