//! Two channels beside red, green and blue: the emission of a surface outside the visible range at rest.
//!
//! RGB says nothing of wavelengths above 830 and below 360 nm ([`rgb_basis`](super::rgb_basis)). Two more channels do, each the
//! radiance of a band in units of that of the white at the end that it joins:
//!
//! ```text
//! L(λ) = r white b_r + g white b_g + b white b_b      360 to 830 nm
//!      + i white(830 nm)                              830 to 3500 nm, infrared
//!      + u white(360 nm)                              100 to 360 nm, ultraviolet
//! ```
//!
//! and nothing beyond. The bands are flat per wavelength: a channel is the mean radiance of its band over that of the white at its end,
//! which is how a measured band is scaled. If all five are equal, the spectrum continues without a step, and is that of
//! [`Continuation::Edge`] as far as the bands reach.
//!
//! The colour seen at W is the 3 × 5 matrix M(W) times the channels. Its first three columns are those of a dark continuation
//! ([`RgbShift`]); the others are
//!
//! ```text
//! ∫ W⁻⁵ white(end) m(λ) dλ,      from 830 W to 3500 W nm, or from 100 W to 360 W nm.
//! ```
//!
//! As the eye's range is 360 to 830 nm too, the infrared is seen only where W < 1, and the ultraviolet only where W > 1: one column,
//! obtained by one look-up in a table. It is tabulated like M(W) of RGB, to 1e-4 of W⁻⁵. All of the infrared has shifted into view and
//! beyond at W = 360/3500, and all of the ultraviolet at W = 830/100.

use super::observer::{FIRST, LAST};
use super::rgb_basis::{self, Continuation};
use super::sampled::{Wavelengths, per_wavelength_power};
use super::shift::RgbShift;
use super::spectrum::integrate;
use super::table::{MadeOnce, Table};
use super::{colour_matching, rgb_from_xyz};

/// The wavelengths of the infrared channel, metres.
pub const INFRARED: [f64; 2] = [LAST * 1e-9, 3500e-9];

/// The wavelengths of the ultraviolet channel, metres.
pub const ULTRAVIOLET: [f64; 2] = [100e-9, FIRST * 1e-9];

/// M(W) for RGB with infrared and ultraviolet, by which the five channels are multiplied.
#[derive(Debug)]
pub struct CompanionShift {
    /// The first three columns.
    rgb: &'static RgbShift,
    /// The column of the infrared below 1 and of the ultraviolet above, with a fourth number of 0.
    table: Table<4>,
}

impl CompanionShift {
    /// The only instance, made on first use.
    pub fn get() -> &'static CompanionShift {
        static MADE: MadeOnce<CompanionShift> = MadeOnce::new(CompanionShift::new);
        MADE.get()
    }

    fn new() -> CompanionShift {
        // Beyond these ratios nothing of either band is left in view.
        let ends = [ULTRAVIOLET[1] / INFRARED[1], INFRARED[0] / ULTRAVIOLET[0]];
        CompanionShift {
            rgb: RgbShift::of(Continuation::Companions),
            table: Table::new(ends, |w| {
                let [r, g, b] = band_colour(w);
                [r, g, b, 0.0]
            }),
        }
    }

    /// M(W) · (r, g, b, infrared, ultraviolet): the linear RGB that an observer sees of a surface with these channels at rest.
    #[inline(always)]
    pub fn apply(&self, w: f64, rgb: [f64; 3], [infrared, ultraviolet]: [f64; 2]) -> [f64; 3] {
        let seen = self.rgb.apply(w, rgb);
        let band = if w < 1.0 { infrared } else { ultraviolet };
        match self.table.at(w) {
            Some(column) => std::array::from_fn(|j| seen[j] + column[j] * band),
            None => seen,
        }
    }

    /// The radiance W⁻⁵ L(λ/W) at each of `wavelengths` of the observer.
    #[inline]
    pub(crate) fn at(
        &self,
        w: f64,
        rgb: [f64; 3],
        [infrared, ultraviolet]: [f64; 2],
        wavelengths: Wavelengths,
    ) -> [f64; 3] {
        let (mut seen, power) = (self.rgb.at(w, rgb, wavelengths), per_wavelength_power(w));
        let ends = rgb_basis::white_at_ends();
        for (seen, wavelength) in seen.iter_mut().zip(wavelengths) {
            let at_rest = wavelength / w;
            let is_within = |[from, to]: [f64; 2]| from < at_rest && at_rest < to;
            if is_within(INFRARED) {
                *seen += power * infrared * ends[1];
            }
            if is_within(ULTRAVIOLET) {
                *seen += power * ultraviolet * ends[0];
            }
        }
        seen
    }

    /// M(W), rows of linear RGB, columns red, green, blue, infrared, ultraviolet.
    pub fn matrix(&self, w: f64) -> [[f64; 5]; 3] {
        let column = |k: usize| {
            let unit = |i: usize| f64::from(i == k);
            self.apply(w, [unit(0), unit(1), unit(2)], [unit(3), unit(4)])
        };
        let columns = [0, 1, 2, 3, 4].map(column);
        std::array::from_fn(|j| std::array::from_fn(|k| columns[k][j]))
    }
}

/// The colour at W of the infrared band, below 1, or of the ultraviolet one: linear RGB.
fn band_colour(w: f64) -> [f64; 3] {
    let side = usize::from(w < 1.0);
    let [from, to] = [ULTRAVIOLET, INFRARED][side].map(|end| end * w);
    let radiance = rgb_basis::white_at_ends()[side] / (w * w * w * w * w);
    rgb_from_xyz(integrate(&[from, to], |l| {
        let inside = l > from && l < to;
        let radiance = if inside { radiance } else { 0.0 };
        colour_matching(l).map(|m| m * radiance)
    }))
}

#[cfg(test)]
mod tests;
