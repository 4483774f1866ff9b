//! Light at the wavelengths of each sample, in place of red, green and blue: [`Wavelengths`] in the frame of each point of a path, and
//! lines.
//!
//! The camera's wavelengths of a sample (derived, with their weights, in `colour/sampled.rs`) are divided by W at each surface of a path.
//! Everything with three channels then refers to these wavelengths: albedos are Σ c_j b_j(λ), incident light is W⁻⁵ L(λ/W), and all loops stay
//! the same. At the camera the radiances are weighted by the eye's response, with W⁻⁵. What needs no product of spectra is exact as before:
//! emission seen directly by the camera has M(W).
//!
//! A line at λ₀ coincides with none of the wavelengths. From a lamp at w it arrives at a surface at λ₀ w with w⁻⁴ of its radiance, is multiplied by
//! the albedo there, and so on from surface to surface back to the camera: it is not widened, and has no noise but that of paths. This costs one
//! product for each surface before, for each lamp, line and surface. Along paths f is taken as linear in the base colour, which it is except for F (1
//! − m) c with a metalness m between 0 and 1.

use super::emitted::Eye;
use super::run::Run;
use super::spectral_points::SpectralPoints;
use crate::colour::{Line, RgbShift, basis_at, wavelengths_of};
use crate::light::reflection::Reflection;

/// The purpose of random numbers at the first surface, in addition to those of [`area_lights`](super::area_lights),
/// [`sky_light`](super::sky_light) and [`paths`](super::paths).
const WAVELENGTH: u32 = 7;

/// How light is sampled at wavelengths.
#[derive(Debug, Clone, Copy)]
pub struct SampledSpectra {
    /// The camera's eye.
    pub eye: Eye,
    /// The shift of spectra given as linear RGB.
    pub shift: &'static RgbShift,
    /// Whether any light has lines.
    pub has_lines: bool,
}

impl SampledSpectra {
    /// Samples the wavelengths of points that the camera sees.
    pub(super) fn begin(&self, run: &Run, to: &mut SpectralPoints) {
        run.ratios(run.traced.rays.ratios, &mut to.ratios);
        to.numbers.clear();
        to.wavelengths.clear();
        for (k, w) in to.ratios.iter().enumerate() {
            let [x, _] = run.one_random_of(k, WAVELENGTH, 0, 1);
            to.numbers.push(x);
            let seen = wavelengths_of(x);
            // Light that the camera sees at λ has left the surface at λ/W.
            to.wavelengths.push(seen.map(|l| self.eye.seen_as(l) / w));
        }
        to.beside.clear();
        to.beside.resize(run.count(), [0.0; 3]);
    }

    /// Computes the wavelengths of points that rays of a path have hit, whose W are `ratios`.
    pub(super) fn go_on(&self, run: &Run, ratios: &[f64], to: &mut SpectralPoints) {
        to.wavelengths.clear();
        let before = run.traced.rays.wavelengths;
        for (ray, w) in run.members.iter().zip(ratios) {
            to.wavelengths.push(before[*ray as usize].map(|l| l / w));
        }
    }

    /// Converts `reflections` of points to their wavelengths, and keeps the originals in red, green and blue for lines.
    pub(super) fn reflect(&self, reflections: &mut [Reflection], points: &mut SpectralPoints) {
        if self.has_lines {
            points.in_rgb.extend_from_slice(reflections);
        }
        for (reflection, wavelengths) in reflections.iter_mut().zip(&points.wavelengths) {
            *reflection = reflection.at(&basis_at(*wavelengths));
        }
    }

    /// The linear RGB `radiance` of point `k` at the sampled wavelengths.
    pub(super) fn of_rgb(&self, k: usize, radiance: [f64; 3], points: &SpectralPoints) -> [f64; 3] {
        match points.at(k) {
            Some(wavelengths) => self.shift.at(1.0, radiance, *wavelengths),
            None => radiance,
        }
    }

    /// Adds the linear RGB `radiance` of point `k` to what the camera sees.
    pub(super) fn see_rgb(&self, k: usize, radiance: [f64; 3], points: &mut SpectralPoints) {
        let w = self.eye.ratio(points.ratios[k]);
        let seen = self.shift.apply(w, radiance).map(|c| c * self.eye.gain());
        add(&mut points.beside[k], seen);
    }

    /// Adds the lines that leave points to what the camera sees.
    pub(super) fn see_lines(&self, points: &mut SpectralPoints) {
        for (k, line) in points.leaving.drain(..) {
            let seen = line.received(points.ratios[k]);
            let wavelength = self.eye.wavelength(seen.wavelength);
            let colour = Line { wavelength, ..seen }.colour();
            add(&mut points.beside[k], colour);
        }
    }
}

fn add(sum: &mut [f64; 3], colour: [f64; 3]) {
    for (sum, c) in sum.iter_mut().zip(colour) {
        *sum += c;
    }
}
