//! Data of the points of a run when light is sampled at wavelengths.

use std::f64::consts::FRAC_1_PI;

use crate::accel::vectors::Columns;
use crate::colour::{Line, Wavelengths, basis_at, reflectances};
use crate::light::reflection::Reflection;

/// Data by point; all are empty if channels are red, green and blue.
#[derive(Debug, Default)]
pub(super) struct SpectralPoints {
    /// Wavelengths in the points' rest frame, one for each channel.
    pub wavelengths: Vec<Wavelengths>,
    /// For points that the camera sees: the numbers from which its wavelengths are sampled, and W.
    pub numbers: Vec<f64>,
    pub ratios: Vec<f64>,
    /// Also for these: linear RGB that the camera sees in addition to the samples.
    pub beside: Vec<[f64; 3]>,
    /// The points' reflection in red, green and blue, if there are lines and the points are not matte.
    pub in_rgb: Vec<Reflection>,
    /// Lines of sampled light, by its index in the list of incident light.
    pub arriving: Vec<(usize, Line)>,
    /// Lines in the radiance that leaves points.
    pub leaving: Vec<(usize, Line)>,
}

impl SpectralPoints {
    /// The wavelengths of point `k`, if there are any.
    #[inline]
    pub fn at(&self, k: usize) -> Option<&Wavelengths> {
        self.wavelengths.get(k)
    }

    /// Whether light is sampled at wavelengths.
    #[inline]
    pub fn is_sampled(&self) -> bool {
        !self.wavelengths.is_empty()
    }

    /// Clears the light of the last run.
    pub fn start(&mut self) {
        self.in_rgb.clear();
        self.arriving.clear();
        self.leaving.clear();
    }

    /// Converts linear RGB reflectances to those at the wavelengths of each point.
    pub fn sample(&self, colours: &mut Columns) {
        for (k, wavelengths) in self.wavelengths.iter().enumerate() {
            let basis = basis_at(*wavelengths);
            let colour = reflectances(&basis, colours.get(k).to_array());
            colours.set(k, colour.into());
        }
    }

    /// Reflects irradiance in a line at point `k`, whose colour is in `colours` if it is matte; otherwise `value` is f.
    pub fn reflect(
        &mut self,
        k: usize,
        line: Line,
        colours: &Columns,
        value: impl Fn(&Reflection) -> [f64; 3],
    ) {
        let leaving = match self.in_rgb.get(k) {
            Some(reflection) => {
                // f at the wavelength of the line, which all three channels then have.
                let there = reflection.at(&basis_at([line.wavelength; 3]));
                line.scaled(value(&there)[0])
            }
            None => line.reflected((colours.get(k) * FRAC_1_PI).to_array()),
        };
        self.leaving.push((k, leaving));
    }
}
