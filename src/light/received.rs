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

    /// By [`Received::irradiance_factor`] times `above` over `below`, with one division.
    #[inline]
    pub(crate) fn irradiance_over(&self, w: f64, above: f64, below: f64) -> f64 {
        let mut all = [w];
        self.irradiances_over(&mut all, &[above], &[below]);
        let [all] = all;
        all
    }

    /// The same in place of each W. A plain loop, to be compiled for wide vectors.
    #[inline(always)]
    pub(crate) fn irradiances_over<const N: usize>(
        &self,
        ratios: &mut [f64; N],
        above: &[f64; N],
        below: &[f64; N],
    ) {
        match self {
            Received::Scaled(quantity) => quantity.irradiances_over(ratios, above, below),
            Received::Rgb(_) => {
                for (k, w) in ratios.iter_mut().enumerate() {
                    *w = *w * *w * above[k] / below[k];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Continuation;

    #[test]
    fn irradiance_with_one_division_is_the_factor_times_the_quotient() {
        // Six products and quotients of either way are rounded.
        let of = |quantity| Received::Scaled(quantity);
        let all = [
            of(Quantity::PerWavelength),
            of(Quantity::Integrated),
            of(Quantity::PerFrequency),
            of(Quantity::PhotonsPerFrequency),
            Received::Rgb(RgbShift::of(Continuation::Blackbody)),
        ];
        for received in all {
            for k in 1..200 {
                let (w, above) = (0.017 * f64::from(k), 3.0 - 0.013 * f64::from(k));
                let below = 0.3 + 0.7 * f64::from(k * 7 % 11);
                let expected = received.irradiance_factor(w) * above / below;
                let one = received.irradiance_over(w, above, below);
                assert!(
                    (one - expected).abs() <= 8.0 * f64::EPSILON * expected,
                    "{w}"
                );
            }
        }
    }
}
