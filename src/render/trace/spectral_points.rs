//! Data of the points of a run when light is sampled at wavelengths.

use std::f64::consts::FRAC_1_PI;

use crate::accel::vectors::Columns;
use crate::colour::{Line, Wavelengths, basis_at, reflectances};
use crate::light::reflection::Reflection;

/// By point; all are empty where channels are red, green and blue.
#[derive(Debug, Default)]
pub(super) struct SpectralPoints {
    /// Wavelengths in the points' rest frame, one for each channel.
    pub wavelengths: Vec<Wavelengths>,
    /// Of points that the camera sees, the numbers that its wavelengths come from, and W.
    pub numbers: Vec<f64>,
    pub ratios: Vec<f64>,
    /// Of these, linear RGB that the camera sees beside what is sampled.
    pub beside: Vec<[f64; 3]>,
    /// How points reflect by red, green and blue, where there are lines and they are not matte.
    pub in_rgb: Vec<Reflection>,
    /// Lines of light that is drawn, by its place in the list of that.
    pub arriving: Vec<(usize, Line)>,
    /// Radiance in lines that leaves points.
    pub leaving: Vec<(usize, Line)>,
}

impl SpectralPoints {
    /// The wavelengths of point `k`, where there are any.
    #[inline]
    pub fn at(&self, k: usize) -> Option<&Wavelengths> {
        self.wavelengths.get(k)
    }

    /// Whether light is sampled.
    #[inline]
    pub fn is_sampled(&self) -> bool {
        !self.wavelengths.is_empty()
    }

    /// Forgets the light of the last run.
    pub fn start(&mut self) {
        self.in_rgb.clear();
        self.arriving.clear();
        self.leaving.clear();
    }

    /// Makes linear RGB reflectances by point those at its wavelengths.
    pub fn sample(&self, colours: &mut Columns) {
        for (k, wavelengths) in self.wavelengths.iter().enumerate() {
            let basis = basis_at(*wavelengths);
            let colour = reflectances(&basis, colours.get(k).to_array());
            colours.set(k, colour.into());
        }
    }

    /// Reflects irradiance in a line that comes to point `k`, whose colour is among `colours` if it is matte; otherwise `value` is f.
    pub fn reflect(
        &mut self,
        k: usize,
        line: Line,
        colours: &Columns,
        value: impl Fn(&Reflection) -> [f64; 3],
    ) {
        let leaving = match self.in_rgb.get(k) {
            Some(reflection) => {
                let there = reflection.at(&basis_at([line.wavelength; 3]));
                line.scaled(value(&there)[0])
            }
            None => line.reflected((colours.get(k) * FRAC_1_PI).to_array()),
        };
        self.leaving.push((k, leaving));
    }
}
