//! `[radiance]`, and that of a source.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::colour::Continuation;
use crate::scene::at::At;
use crate::spacetime::QuantityKind;
use crate::spacetime::units::Wavelength;

/// What a radiance measures. It determines the power of the wavelength ratio that the searchlight effect applies.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { quantity = \"integrated\" }"
)]
pub(in crate::scene) struct Radiance {
    /// The quantity: "integrated" over the spectrum (or "luminance", another word for the same), "per_wavelength", "per_frequency", "line"
    /// (one spectral line, needs `wavelength`), "photons", "photons_per_wavelength", "photons_per_frequency", or "rgb": the colour of a
    /// smooth spectrum, so that hues shift. All others change only in brightness. Default: "integrated".
    pub quantity: At<QuantityKind>,
    /// The emitted wavelength of the line, like "532 nm", in the emitter's rest frame. Required with
    /// quantity = "line", refused with any other.
    pub wavelength: Option<At<Wavelength>>,
    /// How the spectra of RGB colours continue below 360 and above 830 nm, which are invisible at rest: "blackbody" (as Planck's law at
    /// 6504 K), "edge" (constant), "dark", or "companions": as given by the infrared and ultraviolet `channels` of cubes, and dark
    /// without these. Only in the scene's `radiance`. Default: "companions" if a cube has such channels, otherwise "blackbody".
    pub continuation: Option<At<Continuation>>,
}

impl Default for Radiance {
    fn default() -> Self {
        Radiance {
            quantity: At::nowhere(QuantityKind::Integrated),
            wavelength: None,
            continuation: None,
        }
    }
}
