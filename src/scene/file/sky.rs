//! `[sky]`.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::spectrum::Spectrum;
use crate::scene::at::At;
use crate::scene::model::SkyNegative;
use crate::scene::values::{Number, NumberOrVector, Vector};
use crate::spacetime::units::Angle;

/// Light from infinity, at rest in the world: a background of at most one kind, with a sun and stars added to it. Cameras see it
/// aberrated, shifted and beamed, and it lights surfaces.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { gradient = {}, sun = { direction = [1, 2, 1] } }"
)]
pub(in crate::scene) struct Sky {
    /// The same radiance in all directions, at least 0: one number, or linear RGB. Default: 0.
    pub radiance: Option<At<NumberOrVector>>,
    /// The same spectrum in all directions, like the cosmic background's { blackbody = "2.725 K", total = 1 }. Needs quantity = "rgb" in
    /// `radiance`.
    pub spectrum: Option<At<Spectrum>>,
    /// A sky with a gradient from the horizon to the zenith.
    pub gradient: Option<At<Gradient>>,
    /// An equirectangular picture of all directions.
    pub image: Option<At<SkyImage>>,
    /// A disc of uniform radiance.
    pub sun: Option<At<Sun>>,
    /// Stars.
    pub stars: Option<At<Stars>>,
    /// Whether it lights surfaces, which then reflect it; otherwise it is only visible. Default: true.
    #[serde(default = "Sky::on")]
    pub lights: bool,
    /// Whether surfaces cast shadows in its light. Default: true.
    #[serde(default = "Sky::on")]
    pub shadows: bool,
}

impl Sky {
    fn on() -> bool {
        true
    }
}

/// Radiance by elevation: horizon + (zenith − horizon) (1 − (1 − h)⁴) for the sine h of the elevation above the horizon of +Y, and the
/// ground below it.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { zenith = [0.2, 0.4, 0.9] }"
)]
pub(in crate::scene) struct Gradient {
    /// Linear RGB straight up. Default: [0.13, 0.27, 0.62].
    pub zenith: Option<At<Vector>>,
    /// Linear RGB at the horizon. Default: [0.72, 0.83, 0.95].
    pub horizon: Option<At<Vector>>,
    /// Linear RGB below the horizon. Default: [0.16, 0.15, 0.13].
    pub ground: Option<At<Vector>>,
}

/// An equirectangular picture, twice as wide as high: row 0 is +Y, the middle −Z, and to the right of that is +X.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { file = \"sky.exr\" }")]
pub(in crate::scene) struct SkyImage {
    /// An .exr or .hdr file of linear RGB radiance, or with a single channel of grey (EXR), relative to the scene file.
    pub file: At<String>,
    /// Factor on its radiance, at least 0: one number, or linear RGB. Default: 1.
    pub scale: Option<At<NumberOrVector>>,
    /// The angle of rotation about +Y, right-handed. Default: "0 deg".
    pub rotation: Option<At<Angle>>,
    /// What to do with radiances below 0, which filters leave around bright lights: "refuse" or "zero" (they are taken as 0). Default:
    /// "refuse".
    #[serde(default)]
    pub negative: At<SkyNegative>,
}

/// A disc of uniform radiance.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { direction = [1, 2, 1], irradiance = 3 }"
)]
pub(in crate::scene) struct Sun {
    /// The direction towards it, of any length but 0.
    pub direction: At<Vector>,
    /// Its irradiance on a perpendicular surface at rest in the world, at least 0: one number, or linear RGB. Default: [3.2, 3.0, 2.6].
    pub irradiance: Option<At<NumberOrVector>>,
    /// Angular diameter, above 1e-9 rad and at most 90 deg. Default: "0.533 deg".
    pub diameter: Option<At<Angle>>,
}

/// Stars: discs of uniform radiance with the colours of blackbodies; with quantity = "rgb" in `radiance`, with their spectra.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { count = 5000 }")]
pub(in crate::scene) struct Stars {
    /// A CSV table of lines x,y,z,magnitude,temperature (direction of any length but 0, kelvins), relative to
    /// the scene file. Excludes `count`, `seed` and `faintest`.
    pub file: Option<At<String>>,
    /// Number of random stars, at most 1000000: isotropic, with N(<m) ∝ 10^(0.6 m) (a uniformly filled space) and temperatures of 3000 to
    /// 12000 K. Default: 5000.
    pub count: Option<At<u32>>,
    /// Seed of the random numbers. Default: 1.
    pub seed: Option<At<u32>>,
    /// Magnitude of the faintest random star. Default: 6.5.
    pub faintest: Option<At<Number>>,
    /// Irradiance of a star of magnitude 0; each further magnitude is 10^0.4 times fainter. Default: 2e-5.
    pub scale: Option<At<Number>>,
    /// Angular diameter of the discs, above 1e-9 rad and at most 10 deg: about a pixel. Default: "0.08 deg".
    pub diameter: Option<At<Angle>>,
}
