//! Wavelength ratio and the radiance factors that follow from it.
//!
//! W = λ′/λ = ω_emitter/ω_observer = (k·u_emitter)/(k·u_observer) for light with null vector k.
//! Photon number in a phase-space cell is invariant, so I_ν/ν³ is: with ν′ = ν/W,
//!
//! | the radiance holds | dimension beyond L_ν | observed / emitted |
//! |---|---|---|
//! | energy per frequency, L_ν | | W⁻³ |
//! | energy per wavelength, L_λ = L_ν |dν/dλ|, at λ = λ′/W | ν² | W⁻⁵ |
//! | energy over the spectrum, or of one line, ∫L_ν dν | ν | W⁻⁴ |
//! | photons over the spectrum, ∫L_ν/(hν) dν | | W⁻³ |
//! | photons per wavelength | ν | W⁻⁴ |
//! | photons per frequency | 1/ν | W⁻² |
//!
//! What the emitter emits within dt arrives within dt′ = W dt: the energy received from a whole flash
//! carries one power of W more, W⁻ᵖ⁺¹. The irradiance that falls on a moving surface carries
//! dΩ′ = W² dΩ: two powers more, W⁻ᵖ⁺². Source: Weiskopf, Kraus, Ruder, ACM TOG 18(3), 1999.

use std::fmt;

/// The ratio λ′/λ of the observed to the emitted wavelength; below 1 is a blueshift.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct WavelengthRatio(pub f64);

impl WavelengthRatio {
    /// No shift.
    pub const NONE: WavelengthRatio = WavelengthRatio(1.0);
}

/// What a stored radiance measures. The exponent of W follows from it, and from nothing else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantity {
    /// Energy per area, solid angle and wavelength (the paper's D⁻⁵).
    PerWavelength,
    /// Energy per area, solid angle and frequency.
    PerFrequency,
    /// Energy per area and solid angle, over the whole spectrum (bolometric).
    Integrated,
    /// Energy per area and solid angle of one spectral line.
    Line {
        /// The emitted wavelength λ₀ in the emitter's rest frame, metres.
        wavelength: f64,
    },
    /// Photons per area and solid angle, over the whole spectrum.
    Photons,
    /// Photons per area, solid angle and wavelength.
    PhotonsPerWavelength,
    /// Photons per area, solid angle and frequency.
    PhotonsPerFrequency,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Quantity::PerWavelength => write!(f, "energy per wavelength"),
            Quantity::PerFrequency => write!(f, "energy per frequency"),
            Quantity::Integrated => write!(f, "energy over the whole spectrum"),
            // Nanometres to the picometre: finer than a line's name, coarser than the rounding of metres.
            Quantity::Line { wavelength } => {
                write!(
                    f,
                    "energy of a line at {} nm",
                    (wavelength * 1e12).round() / 1e3
                )
            }
            Quantity::Photons => write!(f, "photons over the whole spectrum"),
            Quantity::PhotonsPerWavelength => write!(f, "photons per wavelength"),
            Quantity::PhotonsPerFrequency => write!(f, "photons per frequency"),
        }
    }
}

impl Quantity {
    /// p in L′ = W⁻ᵖ L.
    pub const fn exponent(self) -> u32 {
        match self {
            Quantity::PerWavelength => 5,
            Quantity::Integrated | Quantity::Line { .. } | Quantity::PhotonsPerWavelength => 4,
            Quantity::PerFrequency | Quantity::Photons => 3,
            Quantity::PhotonsPerFrequency => 2,
        }
    }

    /// Observed radiance for an emitted radiance of 1.
    #[inline]
    pub fn radiance_factor(self, w: WavelengthRatio) -> f64 {
        1.0 / power(w.0, self.exponent())
    }

    /// [`Quantity::radiance_factor`] in place of each wavelength ratio. A plain loop,
    /// to be compiled for wide vectors.
    #[inline(always)]
    pub(crate) fn radiance_factors(self, ratios: &mut [f64]) {
        match self.exponent() {
            5 => factors::<5>(ratios),
            4 => factors::<4>(ratios),
            3 => factors::<3>(ratios),
            _ => factors::<2>(ratios),
        }
    }

    /// Irradiance on a surface in its own frame for an irradiance of 1 (per area across the light)
    /// in the source's, `w` the ratio of wavelengths surface / source.
    #[inline]
    pub fn irradiance_factor(self, w: WavelengthRatio) -> f64 {
        1.0 / power(w.0, self.exponent() - 2)
    }

    /// Energy (or photons) received per exposure for a flash of time integral 1 at the emitter.
    #[inline]
    pub fn exposure_factor(self, w: WavelengthRatio) -> f64 {
        1.0 / power(w.0, self.exponent() - 1)
    }
}

#[inline(always)]
fn factors<const P: u32>(ratios: &mut [f64]) {
    for w in ratios {
        *w = 1.0 / power(*w, P);
    }
}

/// xⁿ by multiplications in a fixed order: the same bits on every machine.
#[inline(always)]
fn power(x: f64, n: u32) -> f64 {
    (1..n).fold(if n == 0 { 1.0 } else { x }, |p, _| p * x)
}
