//! `[[light]]`.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::camera::Velocity;
use super::motion::Motion;
use super::spectrum::Spectrum;
use crate::scene::at::At;
use crate::scene::values::{Number, NumberOrVector, Vector};
use crate::spacetime::units::{Angle, Time};

/// A light: a lamp on its own world line, or an object that shines. In a scene with lights, or with a sky that lights, the base colours
/// of surfaces are reflectances, not radiances.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { position = [0, 3, 0], intensity = 10 }"
)]
pub(in crate::scene) struct Light {
    /// A unique name, for messages and `--set`. Default: its type, or its `node` or file, with a number if that name is taken.
    pub name: Option<At<String>>,
    /// Takes the type, position, direction, cone and brightness from a light of this glTF file (KHR_lights_punctual), as far as other keys do
    /// not give them. Candela are power per solid angle, and lux power per area, without a factor. The path is relative to the scene file.
    pub gltf: Option<At<String>>,
    /// The node of the glTF file that holds the light. Default: the file's only light.
    pub node: Option<At<String>>,
    /// "point" (the same in all directions), "spot" (a cone), "directional" (parallel light, as from a sun) or "area" (the surface of an
    /// object). With `gltf`, that of its light. Default: "point".
    #[serde(default, rename = "type")]
    pub kind: At<LightType>,
    /// World position of a point or spot light when its clock shows 0, metres.
    pub position: Option<At<Vector>>,
    /// The direction in which a spot or directional light shines, in its own frame, whose axes are the world's axes boosted without
    /// rotation; of any length but 0.
    pub direction: Option<At<Vector>>,
    /// A spot light has its full intensity up to this angle from its direction. Default: "0 deg".
    pub inner: Option<At<Angle>>,
    /// A spot light is dark beyond this angle, which is above `inner` and at most 90 deg. Default: "45 deg".
    pub outer: Option<At<Angle>>,
    /// Radiant intensity of a point or spot light, power per solid angle in its own frame, at least 0: one
    /// number, or linear RGB. Excludes `power`. Default: 1.
    pub intensity: Option<At<NumberOrVector>>,
    /// Total power of a point, spot or area light in its own frame, at least 0: one number, or linear RGB. Excludes `intensity` and
    /// `radiance`.
    pub power: Option<At<NumberOrVector>>,
    /// Irradiance of a directional light on a perpendicular surface, power per area in its own frame, at least 0: one number, or linear
    /// RGB. Default: 1.
    pub irradiance: Option<At<NumberOrVector>>,
    /// Radiance of an area light's surface in its own frame, the same in all directions, at least 0: one number, or linear RGB. Default:
    /// what the materials of its object's model emit; 1 if they emit nothing, or with a `spectrum`.
    pub radiance: Option<At<NumberOrVector>>,
    /// Its spectrum in its rest frame; the key for its brightness is a factor on it, a single number for an area light, which then
    /// reflects nothing. Needs quantity = "rgb" in `radiance`. Default: the spectrum of the RGB of `intensity` and the like, or of an
    /// area light's object.
    pub spectrum: Option<At<Spectrum>>,
    /// The object whose surface is the area light.
    pub object: Option<At<String>>,
    /// World time (ct) at which the light's clock shows 0 and it is at `position`. For a directional light: at which what it sends at its own
    /// time 0 passes the world's origin. Default: "0 m".
    #[serde(default = "Light::clock_zero")]
    pub clock_zero: At<Time>,
    /// Velocity in the world when the light's clock shows 0. Default: at rest.
    pub velocity: Option<At<Velocity>>,
    /// The motion of a point or spot light from there. Default: without acceleration.
    pub motion: Option<At<Motion>>,
    /// Its brightness as a function of its own proper time; for an area light, that of its object; for a directional light,
    /// that of `clock_zero`. Default: steady.
    pub emission: Option<At<Emission>>,
    /// Whether surfaces cast shadows in its light. Default: true.
    #[serde(default = "Light::shadows")]
    pub shadows: bool,
}

impl Light {
    fn clock_zero() -> At<Time> {
        At::nowhere(Time::customary(0.0))
    }

    fn shadows() -> bool {
        true
    }
}

/// The kind of light.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", schemars(inline))]
pub(in crate::scene) enum LightType {
    #[default]
    Point,
    Spot,
    Directional,
    Area,
}

impl LightType {
    /// Its name in a file.
    pub fn name(self) -> &'static str {
        match self {
            LightType::Point => "point",
            LightType::Spot => "spot",
            LightType::Directional => "directional",
            LightType::Area => "area",
        }
    }
}

/// A factor on a light's intensity as a function of its own (proper) time, given in exactly one way.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { gaussian = { sigma = \"5 cm\" } }"
)]
pub(in crate::scene) struct Emission {
    /// A Gaussian pulse, 1 at its centre.
    pub gaussian: Option<At<GaussianPulse>>,
    /// A train of Gaussian pulses.
    pub train: Option<At<PulseTrain>>,
    /// Factors at ascending times, linear between them and 0 before and after; 2 to 100000 entries.
    pub table: Option<At<Vec<At<EmissionKnot>>>>,
}

/// A Gaussian pulse.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { sigma = \"5 cm\" }")]
pub(in crate::scene) struct GaussianPulse {
    /// The light's own time of the centre. Default: "0 m".
    #[serde(default = "Light::clock_zero")]
    pub time: At<Time>,
    /// Standard deviation, above 0.
    pub sigma: At<Time>,
}

/// Gaussian pulses at equal intervals.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { sigma = \"5 cm\", period = \"1 m\" }"
)]
pub(in crate::scene) struct PulseTrain {
    /// The light's own time of the centre of the first. Default: "0 m".
    #[serde(default = "Light::clock_zero")]
    pub time: At<Time>,
    /// Standard deviation of each, above 0.
    pub sigma: At<Time>,
    /// The interval between pulses, at least `sigma`.
    pub period: At<Time>,
    /// Number of pulses, at least 1. Default: infinitely many, also before the first.
    pub count: Option<At<u32>>,
}

/// A factor at a proper time.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { time = \"2 m\", factor = 0.5 }"
)]
pub(in crate::scene) struct EmissionKnot {
    /// The light's own time, above that of the previous entry.
    pub time: At<Time>,
    /// At least 0.
    pub factor: At<Number>,
}
