//! `[radiance]`, and that of a source.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::at::At;
use crate::spacetime::QuantityKind;
use crate::spacetime::units::Wavelength;

/// What a radiance measures. The power of the wavelength ratio that the searchlight effect applies
/// follows from it.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { quantity = \"integrated\" }"
)]
pub(in crate::scene) struct Radiance {
    /// The quantity: "integrated" over the spectrum, "per_wavelength", "per_frequency", "line" (one
    /// spectral line, needs `wavelength`), "photons", "photons_per_wavelength" or
    /// "photons_per_frequency". Default: "integrated".
    pub quantity: At<QuantityKind>,
    /// The emitted wavelength of the line, like "532 nm", in the emitter's rest frame. Required with
    /// quantity = "line", refused with any other.
    pub wavelength: Option<At<Wavelength>>,
}

impl Default for Radiance {
    fn default() -> Self {
        Radiance {
            quantity: At::nowhere(QuantityKind::Integrated),
            wavelength: None,
        }
    }
}
