//! Spectra of light sources.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::colour::Continuation;
use crate::scene::at::At;
use crate::scene::values::{Number, Vector};
use crate::spacetime::units::{Temperature, Wavelength};

/// The distribution of light over wavelengths, in the rest frame of the source: one of `line`, `lines`, `blackbody`, `gaussian`, `table`,
/// `flat` and `rgb`; and its amount: one of `luminance`, `total` and `factor`.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { blackbody = \"5800 K\" }"
)]
pub(in crate::scene) struct Spectrum {
    /// One spectral line, like "589 nm".
    pub line: Option<At<Wavelength>>,
    /// Several spectral lines.
    pub lines: Option<At<Vec<At<SpectralLine>>>>,
    /// Planck's law at this temperature, like "5800 K".
    pub blackbody: Option<At<Temperature>>,
    /// A Gaussian over wavelengths.
    pub gaussian: Option<At<Gaussian>>,
    /// A text file of two columns, wavelength in nm and value per wavelength, relative to the scene file; linear
    /// between its rows, 0 beyond them.
    pub table: Option<At<String>>,
    /// A constant value for all wavelengths from the first to the second, like ["300 nm", "2 um"].
    pub flat: Option<At<[At<Wavelength>; 2]>>,
    /// The smooth spectrum of a linear RGB colour.
    pub rgb: Option<At<Vector>>,
    /// How a spectrum by `rgb` continues below 360 and above 830 nm: "blackbody" (as Planck's law at 6504 K), "edge" (constant) or
    /// "dark". Default: the scene's, in `radiance`.
    pub continuation: Option<At<Continuation>>,
    /// Its luminance at rest, where that of rgb = [1, 1, 1] is 1. Default: 1, unless `rgb`, `total` or `factor` is given.
    pub luminance: Option<At<Number>>,
    /// Its sum over all wavelengths.
    pub total: Option<At<Number>>,
    /// Factor on the values of a `table` (per metre), of `rgb`, or of Planck's law in W m⁻² sr⁻¹ per metre.
    pub factor: Option<At<Number>>,
}

/// A spectral line.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { wavelength = \"589 nm\", energy = 1 }"
)]
pub(in crate::scene) struct SpectralLine {
    /// Its wavelength, like "589 nm".
    pub wavelength: At<Wavelength>,
    /// Its energy relative to the other lines. Default: 1.
    #[serde(default = "SpectralLine::energy")]
    pub energy: At<Number>,
}

impl SpectralLine {
    fn energy() -> At<Number> {
        At::nowhere(Number(1.0))
    }
}

/// A Gaussian over wavelengths.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { centre = \"550 nm\", sigma = \"20 nm\" }"
)]
pub(in crate::scene) struct Gaussian {
    /// The wavelength of its peak.
    pub centre: At<Wavelength>,
    /// Its standard deviation, above 0.
    pub sigma: At<Wavelength>,
}
