//! Colours: sRGB, spectra, and how a moving observer sees them.
//!
//! RGB is linear, with the primaries and the white point (D65) of sRGB, unless stated to be 8-bit.

mod blackbodies;
mod companions;
mod line;
mod observer;
mod planck;
mod rgb_basis;
mod rgb_sums;
mod sampled;
mod shift;
mod shift_matrix;
mod spectrum;
mod srgb;
mod table;

pub(crate) use blackbodies::blackbody_colour;
pub use companions::{CompanionShift, INFRARED, ULTRAVIOLET};
pub use line::{OUTSIDE_GREY, VISIBLE, line_colour};
pub use observer::{OBSERVED_NM, colour_matching};
pub use planck::planck;
pub use rgb_basis::Continuation;
pub(crate) use rgb_basis::RGB_BASIS;
pub use sampled::Wavelengths;
pub(crate) use sampled::{
    Line, basis_at, colour_of_sampled, per_wavelength_power, reflectances, wavelengths_of,
};
pub use shift::{ColourTable, ReflectionTable, RgbShift};
pub(crate) use shift_matrix::ShiftMatrix;
pub use spectrum::{Scale, Spectrum, SpectrumShape};
pub use srgb::{rgb_from_xyz, srgb_decode, srgb_encode};
pub(crate) use srgb::{srgb_encode_8, srgb_encode_16};
