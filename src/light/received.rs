//! Light as received by an observer in motion relative to its source.
//!
//! A radiance is received with the factor W⁻ᵖ (p by the declared quantity). Linear RGB as spectra is received as M(W) times its value at
//! the source, with the power of a radiance included in M. Irradiance has an additional factor W² for solid angles.

use crate::colour::{RgbShift, Wavelengths};
use crate::spacetime::{Quantity, WavelengthRatio};

/// The received light as a function of W.
#[derive(Debug, Clone, Copy)]
pub enum Received {
    /// All channels with the same power of W.
    Scaled(Quantity),
    /// Channels that are linear RGB of spectra.
    Rgb(&'static RgbShift),
}

impl Received {
    /// The received radiance for the source's `radiance`.
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

    /// The received irradiance, times `factor`.
    #[inline]
    pub fn irradiance(&self, w: f64, irradiance: [f64; 3], factor: f64) -> [f64; 3] {
        let factor = self.irradiance_factor(w) * factor;
        self.colour(w, irradiance).map(|e| e * factor)
    }

    /// The factor on an irradiance in addition to [`Received::colour`]: W²⁻ᵖ, or W² if that includes W⁻ᵖ.
    #[inline]
    pub fn irradiance_factor(&self, w: f64) -> f64 {
        match self {
            Received::Scaled(quantity) => quantity.irradiance_factor(WavelengthRatio(w)),
            Received::Rgb(_) => w * w,
        }
    }

    /// `irradiance` times [`Received::irradiance_factor`], by W and its inverse.
    #[inline(always)]
    pub(crate) fn irradiance_at(&self, [w, inverse]: [f64; 2], irradiance: f64) -> f64 {
        match self {
            Received::Scaled(quantity) => irradiance * quantity.irradiance_power(inverse),
            Received::Rgb(_) => irradiance * (w * w),
        }
    }

    /// The same for each of `irradiances` that is above 0, and 0 for all others, including NaN. A plain loop, compiled for wide vectors.
    #[inline(always)]
    pub(crate) fn irradiances_at<const N: usize>(
        &self,
        [ratios, inverses]: [&[f64; N]; 2],
        irradiances: &[f64; N],
        to: &mut [f64; N],
    ) {
        match self {
            Received::Scaled(quantity) => quantity.irradiance_powers(inverses, to),
            Received::Rgb(_) => {
                for (to, w) in to.iter_mut().zip(ratios) {
                    *to = w * w;
                }
            }
        }
        for (to, irradiance) in to.iter_mut().zip(irradiances) {
            // A product and a select: NaN, of points without light, is not above 0 either.
            let all = irradiance * *to;
            *to = if *irradiance > 0.0 { all } else { 0.0 };
        }
    }

    /// The channels as seen at W.
    #[inline]
    pub fn colour(&self, w: f64, channels: [f64; 3]) -> [f64; 3] {
        match self {
            Received::Scaled(_) => channels,
            Received::Rgb(shift) => shift.apply(w, channels),
        }
    }

    /// The radiance at each of these wavelengths of the receiver, for the source's linear RGB `channels`; if that is not RGB of spectra,
    /// [`Received::radiance`].
    #[inline]
    pub(crate) fn at(&self, w: f64, channels: [f64; 3], wavelengths: Wavelengths) -> [f64; 3] {
        match self {
            Received::Scaled(_) => self.radiance(w, channels),
            Received::Rgb(shift) => shift.at(w, channels, wavelengths),
        }
    }

    /// Received wavelengths over the source's, for light of one line; 1 if RGB includes the shift in its colour.
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
    fn irradiance_by_the_inverse_of_w_is_that_by_w_in_loops_as_one_by_one() {
        let of = |quantity| Received::Scaled(quantity);
        let all = [
            of(Quantity::PerWavelength),
            of(Quantity::Integrated),
            of(Quantity::PerFrequency),
            of(Quantity::PhotonsPerFrequency),
            Received::Rgb(RgbShift::of(Continuation::Blackbody)),
        ];
        for received in all {
            let ratios: [f64; 200] = std::array::from_fn(|k| 0.017 * (k + 1) as f64);
            let inverses = ratios.map(|w| 1.0 / w);
            let start: [f64; 200] = std::array::from_fn(|k| match k % 10 {
                7 => -1.0,
                8 => f64::NAN,
                _ => 3.0 - 0.013 * k as f64,
            });
            let mut loops = [7.0; 200];
            received.irradiances_at([&ratios, &inverses], &start, &mut loops);
            for k in 0..200 {
                let w = ratios[k];
                let one = received.irradiance_at([w, inverses[k]], start[k]);
                let is_lit = !matches!(k % 10, 7 | 8);
                assert_eq!(loops[k], if is_lit { one } else { 0.0 });
                if !is_lit {
                    continue;
                }
                // Six products and quotients of either way are rounded, and three inverses.
                let expected = received.irradiance_factor(w) * start[k];
                assert!(
                    (one - expected).abs() <= 8.0 * f64::EPSILON * expected,
                    "{w}"
                );
            }
        }
    }
}
