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
//! Linear RGB represents a spectrum per wavelength ([`colour`](crate::colour)): it becomes M(W) RGB, which includes the W⁻⁵. If only its
//! brightness is needed, it counts as energy over the spectrum: W⁻⁴.
//!
//! What the emitter emits within dt arrives within dt′ = W dt: the energy received from a whole flash
//! carries one power of W more, W⁻ᵖ⁺¹. The irradiance that falls on a moving surface carries
//! dΩ′ = W² dΩ: two powers more, W⁻ᵖ⁺². Source: Weiskopf, Kraus, Ruder, ACM TOG 18(3), 1999.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The ratio λ′/λ of the observed to the emitted wavelength; below 1 is a blueshift.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct WavelengthRatio(pub f64);

impl WavelengthRatio {
    /// No shift.
    pub const NONE: WavelengthRatio = WavelengthRatio(1.0);
}

/// The first expression, or if there is none the second.
macro_rules! one_or {
    (, $or:expr) => {
        $or
    };
    ($one:expr, $or:expr) => {
        $one
    };
}

/// What a shift of wavelengths does to the colours of a radiance, beside its brightness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hue {
    /// Nothing: they hold no spectrum.
    Stays,
    /// They are those of one wavelength, which shifts.
    OfLine,
    /// They are those of a spectrum, which shifts.
    OfSpectrum,
}

/// Defines the quantities from a table: their meaning, their names in scene files, what a shift does to their colours, p in L′ = W⁻ᵖ L, and
/// the quantity as which Jarabo et al. 2015 scale it, if another.
macro_rules! quantities {
    ($($variant:ident $({ $wavelength:ident })?, $name:literal $(or $alias:literal)?, $meaning:literal, $hue:ident, $exponent:literal $(, as $scaled:ident)?;)*) => {
        /// What a stored radiance measures. It alone determines the exponent of W.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Quantity {
            $(
                #[doc = concat!("Radiance as ", $meaning, ".")]
                $variant $({
                    /// The emitted wavelength λ₀ in the emitter's rest frame, metres.
                    $wavelength: f64,
                })?,
            )*
        }

        /// What a radiance measures.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[cfg_attr(feature = "schema", schemars(inline, extend("enum" = [$($name, $($alias,)?)*])))]
        pub(crate) enum QuantityKind {
            $(#[serde(rename = $name $(, alias = $alias)?)] $variant,)*
        }

        impl QuantityKind {
            /// Its name in files.
            pub fn name(self) -> &'static str {
                match self {
                    $(QuantityKind::$variant => $name,)*
                }
            }

            /// The quantity, with the wavelength of its line if it has one.
            pub fn at(self, line: f64) -> Quantity {
                match self {
                    $(QuantityKind::$variant => Quantity::$variant $({ $wavelength: line })?,)*
                }
            }

            fn meaning(self) -> &'static str {
                match self {
                    $(QuantityKind::$variant => $meaning,)*
                }
            }

            const fn exponent(self) -> u32 {
                match self {
                    $(QuantityKind::$variant => $exponent,)*
                }
            }
        }

        impl Quantity {
            pub(crate) const fn kind(self) -> QuantityKind {
                match self {
                    $(Quantity::$variant $({ $wavelength: _ })? => QuantityKind::$variant,)*
                }
            }

            /// What a shift does to its colours.
            pub(crate) const fn hue(self) -> Hue {
                match self {
                    $(Quantity::$variant $({ $wavelength: _ })? => Hue::$hue,)*
                }
            }

            /// The emitted wavelength of a spectral line, metres.
            pub(crate) const fn line(self) -> Option<f64> {
                match self {
                    $(Quantity::$variant $({ $wavelength })? => one_or!($(Some($wavelength))?, None),)*
                }
            }

            /// The quantity as which the equations of Jarabo et al. 2015 scale it.
            pub(crate) const fn as_in_2015(self) -> Quantity {
                match self {
                    $(Quantity::$variant $({ $wavelength: _ })? => one_or!($(Quantity::$scaled)?, self),)*
                }
            }
        }

        // Irradiance has two powers less.
        const _: () = {
            $(assert!($exponent >= 2);)*
        };
    };
}

// All are per area and solid angle; the first is the default of scene files.
quantities! {
    Integrated, "integrated" or "luminance", "energy over the whole spectrum", Stays, 4, as PerWavelength;
    PerWavelength, "per_wavelength", "energy per wavelength", Stays, 5;
    PerFrequency, "per_frequency", "energy per frequency", Stays, 3;
    Line { wavelength }, "line", "energy of a line", OfLine, 4, as PerWavelength;
    Photons, "photons", "photons over the whole spectrum", Stays, 3;
    PhotonsPerWavelength, "photons_per_wavelength", "photons per wavelength", Stays, 4;
    PhotonsPerFrequency, "photons_per_frequency", "photons per frequency", Stays, 2;
    Rgb, "rgb", "linear RGB of a spectrum", OfSpectrum, 4;
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind().meaning())?;
        match self.line() {
            // Nanometres to the picometre: finer than a line's name, coarser than the rounding of metres.
            Some(wavelength) => write!(f, " at {} nm", (wavelength * 1e12).round() / 1e3),
            None => Ok(()),
        }
    }
}

impl Quantity {
    /// p in L′ = W⁻ᵖ L.
    pub const fn exponent(self) -> u32 {
        self.kind().exponent()
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
            2 => factors::<2>(ratios),
            // Not unrolled, and therefore slower.
            p => ratios.iter_mut().for_each(|w| *w = 1.0 / power(*w, p)),
        }
    }

    /// Irradiance on a surface in its own frame for an irradiance of 1 (per area across the light)
    /// in the source's, `w` the ratio of wavelengths surface / source.
    #[inline]
    pub fn irradiance_factor(self, w: WavelengthRatio) -> f64 {
        // dΩ′ = W² dΩ compensates two of the powers.
        1.0 / power(w.0, self.exponent() - 2)
    }

    /// [`Quantity::irradiance_factor`], computed from the inverse of the wavelength ratio.
    #[inline(always)]
    pub(crate) fn irradiance_power(self, inverse: f64) -> f64 {
        power(inverse, self.exponent() - 2)
    }

    /// [`Quantity::irradiance_power`] for each of `inverses`. A plain loop, to be compiled for wide vectors.
    #[inline(always)]
    pub(crate) fn irradiance_powers<const N: usize>(self, inverses: &[f64; N], to: &mut [f64; N]) {
        // Without the two powers that belong to the solid angle.
        match self.exponent() - 2 {
            3 => powers::<3, N>(inverses, to),
            2 => powers::<2, N>(inverses, to),
            1 => powers::<1, N>(inverses, to),
            p => {
                for (to, inverse) in to.iter_mut().zip(inverses) {
                    *to = power(*inverse, p);
                }
            }
        }
    }

    /// Energy (or photons) received per exposure for a flash of time integral 1 at the emitter.
    #[inline]
    pub fn exposure_factor(self, w: WavelengthRatio) -> f64 {
        // dt′ = W dt compensates one of the powers.
        1.0 / power(w.0, self.exponent() - 1)
    }
}

#[inline(always)]
fn factors<const P: u32>(ratios: &mut [f64]) {
    for w in ratios {
        *w = 1.0 / power(*w, P);
    }
}

#[inline(always)]
fn powers<const P: u32, const N: usize>(inverses: &[f64; N], to: &mut [f64; N]) {
    for (to, inverse) in to.iter_mut().zip(inverses) {
        *to = power(*inverse, P);
    }
}

/// xⁿ by multiplications in a fixed order: the same bits on every machine.
#[inline(always)]
fn power(x: f64, n: u32) -> f64 {
    (1..n).fold(if n == 0 { 1.0 } else { x }, |p, _| p * x)
}
