//! Spectra at three wavelengths per sample: when light is reflected, products of spectra differ from products of colours.
//!
//! A surface of reflectance R(λ) turns light L(λ) into R(λ) L(λ), which a moving observer sees at other wavelengths. Red, green and blue
//! do not determine L in between; so each sample of a pixel instead follows the radiance at three wavelengths λ_k of its observer
//! (Wilkie, Nawaz, Droske, Weidlich, Hanika, "Hero wavelength spectral sampling", EGSR 2014). With a number x in [0, 1) of the sample
//! ```text
//! λ_k = Λ((x + k)/3),   k = 0, 1, 2,      ∫ L′(λ) m(λ) dλ = mean of Σ_k ⅓ Λ′((x + k)/3) L′(λ_k) m(λ_k),
//! ```
//!
//! where Λ is the inverse of a distribution of wavelengths from 360 to 830 nm: n numbers x, one in each n-th part of [0, 1), give 3n
//! wavelengths, one in each 3n-th part of the distribution. Its density is proportional to 1/cosh²(0.0072 (λ − 538)), λ in nm, which is
//! close to the eye's sensitivity (Radziszewski, Boryczko, Alda, "An improved technique for full spectral rendering", Journal of WSCG 17,
//! 2009), in steps of equal probability between which Λ is linear, so that Λ′ is exact.
//!
//! In the rest frame of a surface that the ray hits at W these are λ_k/W, and so on along a path: each frame has its own, and W⁻⁵ applies
//! to each step (derived in the module on paths). There a linear RGB reflectance is Σ c_j b_j(λ) with the weights of
//! [`rgb_basis`](super::rgb_basis), which stay constant beyond 360 and 830 nm, and linear RGB light is the white times that, continued as
//! its continuation says. White light at rest is reflected exactly as by colours: ∫ white Σ c_j b_j m dλ = c.
//!
//! Lines have no density at a sampled wavelength: each is followed from its source with its own wavelength, as a [`Line`].

use std::sync::LazyLock;

use super::observer::{FIRST, LAST};
use super::rgb_basis;
use super::{colour_matching, rgb_from_xyz};

/// Wavelengths in metres, by channel.
pub type Wavelengths = [f64; 3];

/// Steps of the distribution of wavelengths: a multiple of 3, so that each third of it has its own.
const STEPS: usize = 384;

/// Where its density is largest, nm, and how fast it falls off, per nm (Radziszewski et al., above).
const MIDDLE: f64 = 538.0;
const SLOPE: f64 = 0.0072;

/// Λ at k/[`STEPS`], metres.
static EDGES: LazyLock<Vec<f64>> = LazyLock::new(|| {
    // ∫ dλ/cosh² is tanh, up to a factor.
    let [first, last] = [FIRST, LAST].map(|nm| libm::tanh(SLOPE * (nm - MIDDLE)));
    let edge = |k: usize| match k {
        0 => FIRST * 1e-9,
        STEPS => LAST * 1e-9,
        k => {
            let part = first + (last - first) * k as f64 / STEPS as f64;
            (MIDDLE + libm::atanh(part) / SLOPE) * 1e-9
        }
    };
    (0..=STEPS).map(edge).collect()
});

/// λ_k and ⅓ Λ′ there, metres, for a number in [0, 1).
#[inline]
fn drawn(x: f64) -> [[f64; 2]; 3] {
    const THIRD: usize = STEPS / 3;
    let edges: &[f64] = &EDGES;
    let at = x * THIRD as f64;
    let step = (at as usize).min(THIRD - 1);
    let rest = at - step as f64;
    std::array::from_fn(|k| {
        let step = step + k * THIRD;
        let width = edges[step + 1] - edges[step];
        [edges[step] + rest * width, width * THIRD as f64]
    })
}

/// The wavelengths sampled by an observer at rest, for a number in [0, 1).
#[inline]
pub(crate) fn wavelengths_of(x: f64) -> Wavelengths {
    drawn(x).map(|[wavelength, _]| wavelength)
}

/// Linear sRGB, in the mean over x, of the radiances at the wavelengths of x.
#[inline]
pub(crate) fn colour_of_sampled(x: f64, radiance: [f64; 3]) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for ([wavelength, width], radiance) in drawn(x).into_iter().zip(radiance) {
        let seen = colour_matching(wavelength);
        for (sum, seen) in xyz.iter_mut().zip(seen) {
            *sum += seen * (width * radiance);
        }
    }
    rgb_from_xyz(xyz)
}

/// b_r, b_g and b_b at each of `wavelengths`.
#[inline]
pub(crate) fn basis_at(wavelengths: Wavelengths) -> [[f64; 3]; 3] {
    wavelengths.map(rgb_basis::weights)
}

/// The reflectance Σ c_j b_j with the basis at some wavelengths.
#[inline]
pub(crate) fn reflectances(basis: &[[f64; 3]; 3], [r, g, b]: [f64; 3]) -> [f64; 3] {
    basis.map(|of| of[0] * r + of[1] * g + of[2] * b)
}

/// W⁻⁵.
#[inline]
pub(crate) fn per_wavelength_power(w: f64) -> f64 {
    let square = w * w;
    1.0 / (square * square * w)
}

/// A spectral line of some light: its wavelength, metres, and its radiance or irradiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    pub wavelength: f64,
    pub energy: f64,
}

impl Line {
    /// The same radiance for an observer with wavelengths times `w`.
    #[inline]
    pub fn received(self, w: f64) -> Line {
        let square = w * w;
        Line {
            wavelength: self.wavelength * w,
            energy: self.energy / (square * square),
        }
    }

    /// The same, `factor` times as bright.
    #[inline]
    pub fn scaled(self, factor: f64) -> Line {
        Line {
            energy: self.energy * factor,
            ..self
        }
    }

    /// The line reflected by a surface with these values for red, green and blue.
    #[inline]
    pub fn reflected(self, rgb: [f64; 3]) -> Line {
        self.scaled(rgb_basis::reflectance(self.wavelength, rgb))
    }

    /// Linear sRGB, as an observer at rest sees it; below 0 outside the gamut.
    #[inline]
    pub fn colour(self) -> [f64; 3] {
        rgb_from_xyz(colour_matching(self.wavelength).map(|seen| seen * self.energy))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_third_of_the_numbers_covers_a_third_of_the_wavelengths_without_a_gap() {
        let first = wavelengths_of(0.0);
        let last = wavelengths_of(1.0 - f64::EPSILON);
        assert!((first[0] - 360e-9).abs() < 1e-20);
        for k in 0..2 {
            assert!((last[k] - first[k + 1]).abs() < 1e-20, "{last:?} {first:?}");
        }
        assert!((last[2] - 830e-9).abs() < 1e-20);
        let mut before = first;
        for k in 1..1000 {
            let at = wavelengths_of(f64::from(k) / 1000.0);
            assert!((0..3).all(|k| at[k] > before[k]), "{k}");
            before = at;
        }
    }

    #[test]
    fn the_mean_over_numbers_is_the_integral() {
        // A radiance that rises by wavelength, against a sum over 0.05 nm with the CIE's own numbers.
        let radiance = |l: f64| 1.0 + (l * 1e9 - 500.0) / 200.0;
        // Whole numbers of them in each step.
        let count = 160 * (STEPS / 3) as u32;
        let mut mean = [0.0; 3];
        for k in 0..count {
            let x = (f64::from(k) + 0.5) / f64::from(count);
            let seen = colour_of_sampled(x, wavelengths_of(x).map(radiance));
            (0..3).for_each(|j| mean[j] += seen[j] / f64::from(count));
        }
        let mut xyz = [0.0; 3];
        for pair in crate::colour::observer::numbers().windows(2) {
            for k in 0..20 {
                let part = (f64::from(k) + 0.5) / 20.0;
                let value = radiance((pair[0][0] + part) * 1e-9) * 0.05e-9;
                (0..3).for_each(|j| {
                    xyz[j] += value * (pair[0][j + 1] + part * (pair[1][j + 1] - pair[0][j + 1]));
                });
            }
        }
        let expected = rgb_from_xyz(xyz);
        for (mean, expected) in mean.into_iter().zip(expected) {
            assert!((mean / expected - 1.0).abs() < 1e-6, "{mean} {expected}");
        }
    }

    #[test]
    fn few_numbers_are_enough_for_colours_in_white_light() {
        // 16 samples, each in its own stratum: 1 % of the colour, whatever it is.
        let colour = [0.7, 0.3, 0.1];
        for shift in [0.03, 0.5, 0.91] {
            let mut mean = [0.0; 3];
            for k in 0..16 {
                let x = (f64::from(k) + shift) / 16.0;
                let light = wavelengths_of(x).map(|l| {
                    let of = rgb_basis::radiances(l, rgb_basis::Continuation::Dark);
                    (0..3).map(|j| colour[j] * of[j]).sum()
                });
                let seen = colour_of_sampled(x, light);
                (0..3).for_each(|j| mean[j] += seen[j] / 16.0);
            }
            for (mean, expected) in mean.into_iter().zip(colour) {
                assert!((mean - expected).abs() < 0.01, "{mean} {expected}");
            }
        }
    }
}
