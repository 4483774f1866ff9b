//! RGB as spectra: white · (r b_r + g b_g + b b_b), per metre of wavelength.
//!
//! The white is CIE daylight of the chromaticity of sRGB's white, with a luminance of 1. The weights are not below
//! 0, add up to 1 at every wavelength, and give back linear RGB exactly:
//!
//! ```text
//! ∫ white(λ) b_i(λ) m_j(λ) dλ = 1 if i = j, else 0,      m = linear sRGB of (x̄, ȳ, z̄).
//! ```
//!
//! Of all such weights they are the smoothest: Mallett, Yuksel, "Spectral Primary Decomposition for Rendering with sRGB Reflectance",
//! EGSR 2019. The table, from 360 to 830 nm, is made by `rgb_basis.py` beside it. It covers the observer's whole range, so the
//! [`Continuation`] of a spectrum outside it changes nothing at rest.
//!
//! Outside this range, the weights keep their values at 360 or 830 nm.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::observer::{FIRST, LAST};
use super::planck::planck;

/// An RGB spectrum outside the range that an observer at rest sees, below 360 and above 830 nm.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Continuation {
    /// Nothing.
    Dark,
    /// Constant: its value (per wavelength) at 360 or 830 nm.
    Edge,
    /// Falling off as Planck's law at 6504 K, from its value at 360 or 830 nm: like things in daylight.
    #[default]
    Blackbody,
    /// The infrared and ultraviolet channels ([`CompanionShift`](super::CompanionShift)), if there are any; otherwise nothing.
    Companions,
}

impl Continuation {
    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Continuation::Dark => "dark",
            Continuation::Edge => "edge",
            Continuation::Blackbody => "blackbody",
            Continuation::Companions => "companions",
        }
    }
}

/// Wavelengths in nm, the white per metre, and the weights of red, green and blue.
pub(crate) const RGB_BASIS: &str = include_str!("rgb_basis.csv");

/// Nanometres between two rows.
pub(super) const STEP: f64 = 5.0;

/// Temperature of the white's continuation: the correlated colour temperature of D65.
pub(super) const WHITE_TEMPERATURE: f64 = 6504.0;

/// Rows white, red, green, blue.
static ROWS: LazyLock<Vec<[f64; 4]>> =
    LazyLock::new(|| RGB_BASIS.lines().skip(1).filter_map(row).collect());

/// The result of [`thermal`], which tables of colours need about a million times.
static THERMAL: LazyLock<[[f64; 3]; 2]> = LazyLock::new(|| {
    [FIRST, LAST].map(|nm| {
        let [white, r, g, b] = row_at(nm * 1e-9);
        let factor = white / planck(nm * 1e-9, WHITE_TEMPERATURE);
        [r, g, b].map(|b| factor * b)
    })
});

fn row(line: &str) -> Option<[f64; 4]> {
    let mut numbers = line.split(',').skip(1).map(|n| n.parse().ok());
    let mut next = || numbers.next()?;
    Some([next()?, next()?, next()?, next()?])
}

/// White, and the reflectances of linear red, green and blue, from [`FIRST`] to [`LAST`] at every [`STEP`].
pub(super) fn rows() -> &'static [[f64; 4]] {
    &ROWS
}

/// Wavelengths of the rows, metres.
pub(super) fn knots() -> impl Iterator<Item = f64> {
    (0..ROWS.len()).map(|k| (FIRST + STEP * k as f64) * 1e-9)
}

/// The row at a wavelength in metres, linear between two; that of the end beyond it.
fn row_at(wavelength: f64) -> [f64; 4] {
    let last = ROWS.len() - 1;
    let position = (wavelength * 1e9 - FIRST) / STEP;
    // max first: it turns NaN into a number.
    let position = position.max(0.0).min(last as f64);
    let first = (position as usize).min(last - 1);
    let weight = position - first as f64;
    let (a, b) = (ROWS[first], ROWS[first + 1]);
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * weight)
}

/// b_r, b_g and b_b: the reflectances of linear red, green and blue at a wavelength in metres.
pub(super) fn weights(wavelength: f64) -> [f64; 3] {
    let [_, r, g, b] = row_at(wavelength);
    [r, g, b]
}

/// Σ c_j b_j: the reflectance, or transmittance, of these linear red, green and blue at a wavelength in metres.
#[inline]
pub(super) fn reflectance(wavelength: f64, [r, g, b]: [f64; 3]) -> f64 {
    let of = weights(wavelength);
    of[0] * r + of[1] * g + of[2] * b
}

/// The factors on Planck's law at [`WHITE_TEMPERATURE`] that give the radiances of red, green and blue below 360 nm (the first) and above
/// 830 nm.
pub(super) fn thermal() -> [[f64; 3]; 2] {
    *THERMAL
}

/// The radiances per metre of red, green and blue at the first and at the last wavelength.
pub(super) fn edges() -> [[f64; 3]; 2] {
    [FIRST, LAST].map(|nm| {
        let [white, r, g, b] = row_at(nm * 1e-9);
        [white * r, white * g, white * b]
    })
}

/// The white's radiances per metre at the first and at the last wavelength.
pub(super) fn white_at_ends() -> [f64; 2] {
    [FIRST, LAST].map(|nm| row_at(nm * 1e-9)[0])
}

/// The radiances per metre of red, green and blue at a wavelength in metres.
pub(super) fn radiances(wavelength: f64, continuation: Continuation) -> [f64; 3] {
    let [white, r, g, b] = row_at(wavelength);
    let edge = [white * r, white * g, white * b];
    let nanometres = wavelength * 1e9;
    let side = match nanometres {
        n if n < FIRST => 0,
        n if n > LAST => 1,
        _ => return edge,
    };
    match continuation {
        Continuation::Dark | Continuation::Companions => [0.0; 3],
        Continuation::Edge => edge,
        Continuation::Blackbody => {
            let radiance = planck(wavelength, WHITE_TEMPERATURE);
            thermal()[side].map(|factor| factor * radiance)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_covers_what_the_observer_sees() {
        assert_eq!(ROWS.len(), 95);
        let knots: Vec<_> = knots().collect();
        assert!((knots[0] - 360e-9).abs() < 1e-20 && (knots[94] - 830e-9).abs() < 1e-20);
    }

    #[test]
    fn the_weights_are_reflectances_that_add_up_to_one() {
        for nanometres in 300..900 {
            let weights = weights(f64::from(nanometres) * 1e-9);
            assert!(
                weights.iter().all(|w| (0.0..=1.0).contains(w)),
                "{weights:?}"
            );
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_white_is_d65() {
        // CIE 015:2018, table 5: D65 relative to 100 at 560 nm.
        let at = |nm: f64| row_at(nm * 1e-9)[0] / row_at(560e-9)[0] * 100.0;
        for (nm, value) in [
            (400.0, 82.7549),
            (450.0, 117.008),
            (600.0, 90.0062),
            (700.0, 71.6091),
        ] {
            assert!((at(nm) - value).abs() < 0.2, "{nm} nm: {}", at(nm));
        }
    }

    #[test]
    fn all_continuations_join_at_the_ends() {
        for end in [360e-9, 830e-9] {
            let outwards = if end < 5e-7 { 1.0 - 1e-9 } else { 1.0 + 1e-9 };
            let inside = radiances(end, Continuation::Dark);
            for continuation in [Continuation::Edge, Continuation::Blackbody] {
                let outside = radiances(end * outwards, continuation);
                for (a, b) in inside.into_iter().zip(outside) {
                    assert!((a - b).abs() <= 1e-6 * a.abs(), "{continuation:?}: {a} {b}");
                }
            }
            assert_eq!(radiances(end * outwards, Continuation::Dark), [0.0; 3]);
        }
    }
}
