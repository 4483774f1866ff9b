//! Colours as functions of W = λ′/λ, tabulated for rendering.
//!
//! [`Spectrum::colour_at`] and [`Spectrum::reflected_at`] integrate over the observer's range. Here their values are stored in
//! [tables](super::table) with 1024 steps per factor of 2 of W, with linear interpolation: the error is at most 1e-4 of the colour's
//! largest component, or of W⁻⁵ if that is larger. The step is h = 1/1024 at most, and the error of linear interpolation is h²/8 of the
//! second derivative, which is below 400 times the value for the observer's functions and the basis of RGB, and for Gaussians of σ/λ
//! above 0.01 or so; narrower ones get worse. Lines are not tabulated.
//!
//! Beyond the table: spectra with an end (lines, Gaussians, tables, dark continuations) have no colour; a constant continuation continues
//! as W⁻⁵, exactly; a thermal one as a blackbody, whose colours are in the same table from W = 1/4096 to 6 (h²/8 of the second derivative
//! is 7e-5 of the value at W = 6, x² of Planck's x = 24, and less below), which is all that a camera at 0.94 c sees.

use std::array::from_fn;
use std::sync::LazyLock;

use super::blackbodies::BLACKBODIES;
use super::observer::{FIRST, LAST};
use super::rgb_basis::{self, Continuation, WHITE_TEMPERATURE};
use super::rgb_sums::xyz_of_primaries;
use super::sampled::{Wavelengths, per_wavelength_power};
use super::shift_matrix::ShiftMatrix;
use super::spectrum::{Spectrum, SpectrumShape, integrate};
use super::table::{MOST_OCTAVES, MadeOnce, Table, place};
use super::{colour_matching, rgb_from_xyz};

/// M(W) for RGB, by which linear RGB at rest is multiplied.
#[derive(Debug)]
pub struct RgbShift {
    /// The shifted bits of the argument of the first matrix.
    first: u64,
    /// M by step.
    matrices: Vec<ShiftMatrix>,
    continuation: Continuation,
}

impl RgbShift {
    /// The shift of a continuation, made on first use.
    pub fn of(continuation: Continuation) -> &'static RgbShift {
        static ALL: [MadeOnce<RgbShift>; 3] = [
            MadeOnce::new(|| RgbShift::new(Continuation::Dark)),
            MadeOnce::new(|| RgbShift::new(Continuation::Edge)),
            MadeOnce::new(|| RgbShift::new(Continuation::Blackbody)),
        ];
        // Companions are separate channels.
        let own = match continuation {
            Continuation::Dark | Continuation::Companions => 0,
            Continuation::Edge => 1,
            Continuation::Blackbody => 2,
        };
        ALL[own].get()
    }

    fn new(continuation: Continuation) -> RgbShift {
        // Beyond these ratios, the observer sees only the continuation: of a thermal one, a blackbody.
        let ends = [FIRST / LAST, LAST / FIRST];
        let is_thermal = continuation == Continuation::Blackbody;
        let kept = if is_thermal {
            [1.0 / 4096.0, 6.0]
        } else {
            ends
        };
        let table = Table::new(kept, |w| {
            let columns = match is_thermal && !(w > ends[0] && w < ends[1]) {
                true => thermal_shift(w),
                false => rgb_shift(w, continuation),
            };
            from_fn(|k| match k % 4 {
                3 => 0.0,
                row => columns[row][k / 4],
            })
        });
        RgbShift {
            first: table.first,
            matrices: table.entries.windows(2).map(ShiftMatrix::new).collect(),
            continuation,
        }
    }

    /// M(W) · rgb: the linear RGB that an observer sees of a surface with the linear RGB `rgb` at rest.
    #[inline]
    pub fn apply(&self, w: f64, rgb: [f64; 3]) -> [f64; 3] {
        let (at, rest) = self.place(w);
        match ShiftMatrix::of(&self.matrices, at) {
            Some(matrix) => matrix.times(rest, rgb),
            None => self.beyond(w, rgb),
        }
    }

    /// The index of the matrix at or below `w`, out of range if the table has none, and the fraction of the step to the next.
    #[inline(always)]
    pub(crate) fn place(&self, w: f64) -> (u64, f64) {
        place(self.first, w)
    }

    /// M by step.
    #[inline]
    pub(crate) fn matrices(&self) -> &[ShiftMatrix] {
        &self.matrices
    }

    /// M(W), rows of linear RGB.
    pub fn matrix(&self, w: f64) -> [[f64; 3]; 3] {
        let columns = [0, 1, 2].map(|k| self.apply(w, from_fn(|i| f64::from(i == k))));
        from_fn(|j| from_fn(|k| columns[k][j]))
    }

    /// The radiance W⁻⁵ L(λ/W) at each of the observer's `wavelengths`, of a surface with the linear RGB `rgb` at rest.
    #[inline]
    pub(crate) fn at(&self, w: f64, rgb: [f64; 3], wavelengths: Wavelengths) -> [f64; 3] {
        let power = per_wavelength_power(w);
        wavelengths.map(|l| {
            let of = rgb_basis::radiances(l / w, self.continuation);
            power * (of[0] * rgb[0] + of[1] * rgb[1] + of[2] * rgb[2])
        })
    }

    /// For ratios beyond the table, where the observer sees only the continuation.
    #[inline(never)]
    pub(crate) fn beyond(&self, w: f64, rgb: [f64; 3]) -> [f64; 3] {
        // Blueshift shows wavelengths above 830 nm.
        let side = usize::from(w < 1.0);
        if !(w > 0.0 && w.is_finite()) {
            return [0.0; 3];
        }
        match self.continuation {
            Continuation::Dark | Continuation::Companions => [0.0; 3],
            Continuation::Edge => {
                let edge = rgb_basis::radiances([FIRST, LAST][side] * 1e-9, Continuation::Edge);
                let value = (0..3).fold(0.0, |sum, k| sum + edge[k] * rgb[k]);
                let scale = value / (w * w * w * w * w);
                FLAT.map(|c| c * scale)
            }
            Continuation::Blackbody => {
                thermal_shift(w).map(|row| (0..3).fold(0.0, |sum, k| sum + row[k] * rgb[k]))
            }
        }
    }
}

/// M(W) of a thermal continuation where the observer sees nothing else, rows of linear RGB: the colour of the white's blackbody, times
/// the factors of red, green and blue on it.
fn thermal_shift(w: f64) -> [[f64; 3]; 3] {
    let factors = rgb_basis::thermal()[usize::from(w < 1.0)];
    let colour = BLACKBODIES.get().colour(WHITE_TEMPERATURE / w);
    colour.map(|c| factors.map(|factor| c * factor))
}

/// The colour of a radiance of 1 per metre at all wavelengths.
static FLAT: LazyLock<[f64; 3]> = LazyLock::new(|| rgb_from_xyz(integrate(&[], colour_matching)));

/// M(W) by integration, rows of linear RGB.
fn rgb_shift(w: f64, continuation: Continuation) -> [[f64; 3]; 3] {
    let columns = xyz_of_primaries(w, continuation).map(rgb_from_xyz);
    let m = from_fn(|j| from_fn(|k| columns[k][j]));
    match w == 1.0 {
        // It is the unit matrix by construction of the basis, here without rounding.
        true => m.map(|row: [f64; 3]| row.map(f64::round)),
        false => m,
    }
}

/// The colour of a spectrum as a function of W.
#[derive(Debug, Clone)]
pub struct ColourTable {
    kind: Kind,
    spectrum: Spectrum,
}

#[derive(Debug, Clone)]
enum Kind {
    /// Linear RGB and its continuation.
    Rgb([f64; 3], &'static RgbShift),
    /// A temperature in kelvin, and a factor.
    Blackbody(f64, f64),
    /// Any other shape.
    Own(Reach<4>),
}

impl ColourTable {
    /// The table of `spectrum`.
    pub fn new(spectrum: &Spectrum) -> ColourTable {
        let factor = spectrum.factor();
        let kind = match spectrum.shape() {
            SpectrumShape::Rgb(rgb, continuation) => {
                Kind::Rgb(rgb.map(|c| c * factor), RgbShift::of(*continuation))
            }
            SpectrumShape::Blackbody(t) => Kind::Blackbody(*t, factor),
            _ => Kind::Own(Reach::new(spectrum, |spectrum, w| {
                let [r, g, b] = spectrum.colour_at(w);
                [r, g, b, 0.0]
            })),
        };
        ColourTable {
            kind,
            spectrum: spectrum.clone(),
        }
    }

    /// The spectrum of these colours.
    pub fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// Linear sRGB of the spectrum seen with wavelengths times `w`.
    #[inline]
    pub fn colour(&self, w: f64) -> [f64; 3] {
        match &self.kind {
            Kind::Rgb(rgb, shift) => shift.apply(w, *rgb),
            Kind::Blackbody(t, factor) => BLACKBODIES.get().colour(t / w).map(|c| c * factor),
            Kind::Own(reach) => {
                let [r, g, b, _] = reach.at(w);
                [r, g, b]
            }
        }
    }
}

/// The reflected light of a spectrum as a function of W: R(W) of [`Spectrum::reflected_at`].
#[derive(Debug, Clone)]
pub struct ReflectionTable(Reach<12>);

impl ReflectionTable {
    /// The table for the light of `spectrum`.
    pub fn new(spectrum: &Spectrum) -> ReflectionTable {
        ReflectionTable(Reach::new(spectrum, |spectrum, w| {
            let matrix = spectrum.reflected_at(w);
            from_fn(|k| match k % 4 {
                3 => 0.0,
                row => matrix[row][k / 4],
            })
        }))
    }

    /// R(W) · albedo: linear sRGB of a surface with the reflectance of the linear RGB `albedo`, in its rest frame, under the light with
    /// wavelengths times `w`.
    #[inline]
    pub fn reflected(&self, w: f64, [r, g, b]: [f64; 3]) -> [f64; 3] {
        let m = self.0.at(w);
        from_fn(|j| m[j] * r + m[4 + j] * g + m[8 + j] * b)
    }
}

/// The table over the ratios at which something is visible.
#[derive(Debug, Clone)]
struct Reach<const N: usize> {
    table: Table<N>,
    /// The divisor of all entries, by which they fit f32.
    scale: f64,
    /// For ratios beyond the table, if something is visible there.
    beyond: Option<Box<Exact<N>>>,
}

/// A spectrum, and the function of it that is tabulated.
type Exact<const N: usize> = (Spectrum, fn(&Spectrum, f64) -> [f64; N]);

impl<const N: usize> Reach<N> {
    fn new(spectrum: &Spectrum, f: fn(&Spectrum, f64) -> [f64; N]) -> Self {
        // A few products, and no integral: as fast as a table, and exact.
        if let SpectrumShape::Lines(_) = spectrum.shape() {
            return Reach {
                table: Table::empty(),
                scale: 1.0,
                beyond: Some(Box::new((spectrum.clone(), f))),
            };
        }
        let ratios = reach(spectrum);
        // Spectra without an end are tabulated for W from 1/8 to 8 (0.97 c); beyond, each W is integrated anew.
        let kept = ratios.unwrap_or([1.0 / 8.0, 8.0]);
        let is_whole = ratios.is_some() && kept[1] <= kept[0] * f64::from(1 << (MOST_OCTAVES - 2));
        let scale = peak(spectrum, kept);
        Reach {
            table: Table::new(kept, |w| f(spectrum, w).map(|x| x / scale)),
            scale,
            beyond: (!is_whole).then(|| Box::new((spectrum.clone(), f))),
        }
    }

    #[inline(always)]
    fn at(&self, w: f64) -> [f64; N] {
        match self.table.at(w) {
            Some(values) => values.map(|x| x * self.scale),
            None => self.beyond(w),
        }
    }

    #[cold]
    fn beyond(&self, w: f64) -> [f64; N] {
        match self.beyond.as_deref() {
            Some((spectrum, f)) => f(spectrum, w),
            None => [0.0; N],
        }
    }
}

/// The ratios at which an observer sees something of a spectrum; `None` if it has no end.
fn reach(spectrum: &Spectrum) -> Option<[f64; 2]> {
    // Filters end nowhere.
    let (from, to) = match spectrum.shape().unfiltered() {
        // At 8 σ e⁻³² = 1e-14 of the peak is left; 9 keeps the shorter end above 0.
        SpectrumShape::Gaussian { centre, sigma } if *centre > 9.0 * sigma => {
            (centre - 8.0 * sigma, centre + 8.0 * sigma)
        }
        SpectrumShape::Table(rows) => (rows.first()?[0], rows.last()?[0]),
        SpectrumShape::Rgb(_, Continuation::Dark | Continuation::Companions) => {
            (FIRST * 1e-9, LAST * 1e-9)
        }
        _ => return None,
    };
    Some([FIRST * 1e-9 / to, LAST * 1e-9 / from])
}

/// The largest colour over a few ratios, so that tabulated values are about 1.
fn peak(spectrum: &Spectrum, [from, to]: [f64; 2]) -> f64 {
    let at = |k: u32| {
        let part = f64::from(k) / 16.0;
        let w = libm::pow(from, 1.0 - part) * libm::pow(to, part);
        let colour = spectrum.colour_at(w).into_iter();
        colour.fold(0.0, |a: f64, c| a.max(c.abs()))
    };
    let largest = (0..=16).map(at).fold(0.0, f64::max);
    match largest > 0.0 && largest.is_finite() {
        true => largest,
        false => 1.0,
    }
}

#[cfg(test)]
mod tests;
