//! The scene file as written: its tables and keys, with their places.
//!
//! The doc comments here are the descriptions in the JSON schema and the help of error messages. Tables are plain structs; `resolve`
//! decides which keys exclude each other.

mod camera;
mod light;
mod motion;
mod object;
mod panel;
mod radiance;
mod sensor;
mod sky;
mod source;
mod spectrum;

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer, StrDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::at::At;
use super::model::{BackFaces, CaptureChoice, Equations, Spectra};
use super::values::{Number, Numbers, Vector};
use crate::spacetime::units::{Percentage, Speed, Time, Wavelength};

pub(super) use camera::Camera;
pub(crate) use camera::Velocity;
pub(super) use light::{Emission, EmissionKnot, Light, LightType, PulseTrain};
pub(super) use motion::{
    Animation, Circle, Keyframe, Motion, MotionSegment, ProfileKnot, ProperAcceleration,
};
pub(super) use object::{Lattice, Object, Rotation, Shape, Sphere, Transform};
pub(super) use panel::{Panel, Sheet};
pub(super) use radiance::Radiance;
pub(super) use sensor::{Sensor, SensorRotation};
pub(super) use sky::{Sky, Stars, Sun};
pub(super) use source::{
    Backs, Capture, Crop, Cube, EdgesFile, GivenPose, PoseConvention, Pulse, Source,
};
pub(super) use spectrum::{Gaussian, SpectralLine, Spectrum};

/// A scene of nullray. Positions are plain numbers in metres; times, angles, wavelengths and speeds are texts with a unit, like "2 ps",
/// "0.6 m", "60 deg".
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a scene")]
#[cfg_attr(feature = "schema", schemars(title = "nullray scene"))]
pub(in crate::scene) struct Scene<D = AnyTable> {
    /// The speed of light that converts times in seconds to metres. Any positive speed, for teaching. Default: "299792458 m/s".
    #[serde(default = "Scene::speed_of_light")]
    pub speed_of_light: At<Speed>,
    /// The equations that the picture follows: "exact" (special relativity) or "paper2015" (those of Jarabo et al. 2015, with their
    /// approximations: for comparison with implementations that follow them). Default: "exact".
    #[serde(default)]
    pub model: At<Equations>,
    /// What to do if a file that the scene names is missing, like the command that makes it: error messages quote it.
    pub if_missing: Option<At<String>>,
    /// The medium through which light travels.
    #[serde(default)]
    pub medium: Medium,
    /// The camera: position, view and time. Only a file that contains nothing but a diagram has none.
    pub camera: Option<At<Camera>>,
    /// The objects of the scene: at least one, unless there is a `sky`.
    #[serde(default)]
    pub object: Vec<At<Object>>,
    /// Lights, which surfaces reflect.
    #[serde(default)]
    pub light: Vec<At<Light>>,
    /// Time-resolved radiance on the surfaces of objects.
    #[serde(default)]
    pub source: Vec<At<Source>>,
    /// Light from infinity, in place of `display.background`.
    pub sky: Option<At<Sky>>,
    /// What the radiance of base colours measures, and that of sources without their own `radiance`.
    #[serde(default)]
    pub radiance: At<Radiance>,
    /// The effects of relativity and of the delay of light, each of which can be turned off separately.
    #[serde(default)]
    pub effects: Effects,
    /// What replaces time-resolved data that a source does not have: "black", "hold", or a table with an entry for each case. Default:
    /// "black".
    #[serde(default)]
    pub outside: Outside,
    /// How light is traced.
    #[serde(default)]
    pub render: Render,
    /// How radiance becomes a display picture.
    #[serde(default)]
    pub display: At<Display>,
    /// Variants of the scene, each a picture of its own.
    #[serde(default)]
    pub panel: Vec<At<Panel>>,
    /// How the panels are arranged on one page.
    #[serde(default)]
    pub sheet: Sheet,
    /// A space-time diagram, of the scene or independent of it.
    pub diagram: Option<At<D>>,
}

/// A table that higher modules read.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(expecting = "a table")]
pub(in crate::scene) struct AnyTable {}

impl Scene {
    fn speed_of_light() -> At<Speed> {
        At::nowhere(Speed::customary(crate::spacetime::SPEED_OF_LIGHT))
    }
}

/// The medium through which light travels.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { index = 1.33 }"
)]
pub(in crate::scene) struct Medium {
    /// Refractive index η ≥ 1 of the medium, which rests in the world. It lengthens the delay of light (η metres per metre), and
    /// glass and other dielectrics refract and reflect by `ior`/η. All else is as in vacuum: aberration, Doppler shifts, brightness. In
    /// a medium, lights have to rest, and what moves and reflects light has to be matte. Default: 1.
    pub index: At<Number>,
}

impl Default for Medium {
    fn default() -> Self {
        Medium {
            index: At::nowhere(Number(1.0)),
        }
    }
}

/// The effects of relativity and of the delay of light.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { doppler = false }"
)]
pub(in crate::scene) struct Effects {
    /// Off: a look direction of the camera is used as the same direction in the world. Default: true.
    pub aberration: bool,
    /// Off: colours are those of the emitted wavelength. Default: true.
    pub doppler: bool,
    /// Off: the observed radiance is the emitted one. Default: true.
    pub searchlight: bool,
    /// Off: light takes no time; everything is seen where it is, and as bright as it is, at the world time of the shot. Default: true.
    pub retardation: bool,
}

impl Default for Effects {
    fn default() -> Self {
        Effects {
            aberration: true,
            doppler: true,
            searchlight: true,
            retardation: true,
        }
    }
}

/// How light is traced.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { bounces = 4 }"
)]
pub(in crate::scene) struct Render {
    /// How many further times light is reflected after the first surface that it hits, 0 to 64: 0 is direct light only, 1 includes light
    /// from one surface to the next, and so on. Default: 0.
    pub bounces: At<u32>,
    /// What surfaces reflect: "rgb" (red, green and blue as they reach a surface in its rest frame) or "sampled" (the spectrum, at three
    /// wavelengths per sample, with colour noise), for lamps, skies and shining surfaces with coloured light or light without a smooth
    /// spectrum, on moving surfaces. Needs quantity = "rgb". Default: "rgb".
    pub spectra: At<Spectra>,
    /// Seed of the random numbers, 0 to 4294967295: pictures with different seeds have the same light and independent noise. Default: 0.
    pub seed: u32,
    /// Which of several captures of a surface gives its radiance: "blend" (all that saw the point at that time, weighted towards those
    /// that saw it most finely) or "first" (the first of them in the scene file). Default: "blend".
    pub captures: CaptureChoice,
}

impl Default for Render {
    fn default() -> Self {
        Render {
            bounces: At::nowhere(0),
            spectra: At::nowhere(Spectra::default()),
            seed: 0,
            captures: CaptureChoice::default(),
        }
    }
}

/// What replaces data that a source does not have, by case.
#[derive(Debug, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { before = \"hold\" }"
)]
pub(in crate::scene) struct OutsideTable {
    /// Before the first bin: "black", "hold" (the first bin) or { mark = [r, g, b] }. Default: `mark`,
    /// or else "black".
    pub before: Option<Fill>,
    /// After the last bin: "black", "hold" (the last bin) or { mark = [r, g, b] }. Default: `mark`, or
    /// else "black".
    pub after: Option<Fill>,
    /// Beyond the texture's edge: "black", "hold" (the edge) or { mark = [r, g, b] }. Default: `mark`,
    /// or else "black".
    pub off_texture: Option<Fill>,
    /// Not seen by the capture camera: "black", "hold" (what the capture camera saw in that direction) or { mark = [r, g, b] }. Default:
    /// `mark`, or else "black".
    pub occluded: Option<Fill>,
    /// Linear RGB that marks every case without a key of its own.
    pub mark: Option<Vector>,
}

/// What replaces data that a source does not have: one answer for all cases, or one for each.
#[derive(Debug)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(untagged))]
pub(in crate::scene) enum Outside {
    All(Fill),
    ByCase(Box<OutsideTable>),
}

impl Default for Outside {
    fn default() -> Self {
        Outside::All(Fill::default())
    }
}

impl Serialize for Outside {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Outside::All(fill) => fill.serialize(serializer),
            Outside::ByCase(table) => table.serialize(serializer),
        }
    }
}

struct OutsideVisitor;

// A visitor rather than serde's `untagged`, which loses the place of an error in the table.
impl<'de> Visitor<'de> for OutsideVisitor {
    type Value = Outside;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("\"black\", \"hold\" or a table like { before = \"hold\" }")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Outside, E> {
        // Through serde, so that an unknown word is refused with a list of the known ones.
        Fill::deserialize(StrDeserializer::new(text)).map(Outside::All)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Outside, A::Error> {
        // From the map itself, which knows the places of its keys.
        let table = OutsideTable::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Outside::ByCase(Box::new(table)))
    }
}

impl<'de> Deserialize<'de> for Outside {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OutsideVisitor)
    }
}

/// A substitute for missing data.
#[derive(Debug, Clone, Copy, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", schemars(inline))]
pub(in crate::scene) enum Fill {
    #[default]
    Black,
    Hold,
    /// A conspicuous linear RGB radiance.
    Mark(Vector),
}

/// Isochrones of the light of one flash, for bodies at rest in the world: when it reaches them, or when that is seen. Obstacles are
/// ignored.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { flash = [0, 3, 0] }")]
pub(in crate::scene) struct Isochrones {
    /// World position of the flash, metres.
    pub flash: At<Vector>,
    /// World time (ct) of the flash. Default: "0 m".
    pub time: Option<At<Time>>,
    /// The clock: "world", when the light reaches the surface; "camera", when it arrives from there at this camera, which must be at
    /// rest; or [x, y, z], when it arrives from there at a capture camera at rest at this position, on a clock that shows the world's
    /// time. Default: "world".
    pub clock: Option<At<Receiver>>,
}

/// Where light is received, given in one of two ways.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub(in crate::scene) enum Receiver {
    Named(NamedReceiver),
    At(Vector),
}

/// Where light is received, as a word.
#[derive(Debug, Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", schemars(inline))]
pub(in crate::scene) enum NamedReceiver {
    World,
    Camera,
}

struct ReceiverVisitor;

// As above: serde's `untagged` would lose the place of an error.
impl<'de> Visitor<'de> for ReceiverVisitor {
    type Value = Receiver;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("\"world\", \"camera\" or a place [x, y, z]")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Receiver, E> {
        NamedReceiver::deserialize(StrDeserializer::new(text)).map(Receiver::Named)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Receiver, A::Error> {
        Vector::deserialize(SeqAccessDeserializer::new(seq)).map(Receiver::At)
    }
}

impl<'de> Deserialize<'de> for Receiver {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ReceiverVisitor)
    }
}

/// How radiance becomes a display picture.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { exposure = \"99 %\" }"
)]
pub(in crate::scene) struct Display {
    /// The percentile of the lit pixels' brightest channel, as displayed, that becomes white, in (0, 100] %. Excludes `white` and
    /// `logarithmic`. Default: "99 %".
    pub exposure: Option<At<Percentage>>,
    /// The radiance that becomes white, above 0. Excludes `exposure` and `logarithmic`.
    pub white: Option<At<Number>>,
    /// The radiances that become black and white, both above 0, the lower first, like [1e-8, 1e4]: between them brightness follows the
    /// logarithm of the brightest channel, and colours keep their hue. One scale for all pictures of a series, whatever their range.
    /// Excludes `exposure` and `white`.
    pub logarithmic: Option<At<Numbers<2>>>,
    /// Text below pictures (.png), with the camera's time and, if it moves, its speed (β and γ); "" for time and speed alone. Default: no
    /// text.
    pub caption: Option<At<String>>,
    /// The light whose isochrones are shown. Default: the light that makes the picture, by its time of emission.
    pub isochrones: Option<At<Isochrones>>,
    /// The observed wavelength that is shown as the eye sees 555 nm, like "10 um", with all others in proportion: false colours for
    /// invisible light. For lines, spectra and quantity = "rgb". Default: true colours.
    pub false_colour: Option<At<Wavelength>>,
    /// The range of times that the colours of isochrones span, earliest first, like ["0 m", "12 m"]: one scale for all pictures of a
    /// series. Default: the range in each picture.
    pub times: Option<At<[At<Time>; 2]>>,
    /// The range of luminances that the colours of a luminance picture span, both above 0, the lower first, like [1e-4, 1e2]: one scale
    /// for all pictures of a series. Default: the range in each picture.
    pub luminances: Option<At<Numbers<2>>>,
    /// Bits per sample of a .png file: 8 or 16. Default: 8.
    pub bits: At<u32>,
    /// Linear RGB radiance of rays that hit nothing, as observed. Excludes `sky`. Default: [0, 0, 0].
    pub background: At<Vector>,
    /// Which faces of a triangle are visible: "as_file" (by glTF's doubleSided, otherwise culled), "two_sided", "black" (back faces are
    /// black and hide what is behind them) or "culled". Default: "as_file".
    pub back_faces: BackFaces,
    /// Samples per pixel, 1 to 65536; powers of 4 are distributed most evenly. Default: 4.
    pub samples_per_pixel: At<u32>,
}

impl Default for Display {
    fn default() -> Self {
        Display {
            exposure: None,
            white: None,
            logarithmic: None,
            caption: None,
            isochrones: None,
            false_colour: None,
            times: None,
            luminances: None,
            bits: At::nowhere(8),
            background: At::nowhere(super::values::Numbers([0.0; 3])),
            back_faces: BackFaces::AsFile,
            samples_per_pixel: At::nowhere(4),
        }
    }
}
