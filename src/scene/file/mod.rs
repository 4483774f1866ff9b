//! The scene file as it is written: its tables and keys, with their places kept.
//!
//! The doc comments here are the descriptions in the JSON schema and the help of refusals. Tables are
//! plain structs; which keys exclude each other is told apart in `resolve`.

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
pub(super) use source::{Capture, Crop, Cube, EdgesFile, GivenPose, PoseConvention, Pulse, Source};
pub(super) use spectrum::{Gaussian, SpectralLine, Spectrum};

/// A scene of nullray. Positions are plain numbers in metres; times, angles, wavelengths and speeds are
/// texts with a unit, like "2 ps", "0.6 m", "60 deg".
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a scene")]
#[cfg_attr(feature = "schema", schemars(title = "nullray scene"))]
pub(in crate::scene) struct Scene<D = AnyTable> {
    /// The speed of light, with which times in seconds become metres. Any positive speed, for teaching.
    /// Default: "299792458 m/s".
    #[serde(default = "Scene::speed_of_light")]
    pub speed_of_light: At<Speed>,
    /// Whose equations the picture follows: "exact" (special relativity) or "paper2015" (those of Jarabo
    /// et al. 2015, with their approximations: for comparison with implementations that follow them).
    /// Default: "exact".
    #[serde(default)]
    pub model: At<Equations>,
    /// What to do if a file that the scene names is missing, like the command that makes it: the error quotes it.
    pub if_missing: Option<At<String>>,
    /// What light travels through.
    #[serde(default)]
    pub medium: Medium,
    /// Where the picture is taken from, how and when. Only a file that is a diagram alone has none.
    pub camera: Option<At<Camera>>,
    /// The things of the scene: at least one.
    #[serde(default)]
    pub object: Vec<At<Object>>,
    /// Lights, which surfaces reflect.
    #[serde(default)]
    pub light: Vec<At<Light>>,
    /// Time-resolved radiance on the surfaces of objects.
    #[serde(default)]
    pub source: Vec<At<Source>>,
    /// What shines from afar, in place of `display.background`.
    pub sky: Option<At<Sky>>,
    /// What the radiance of base colours measures, and of sources that give none of their own.
    #[serde(default)]
    pub radiance: At<Radiance>,
    /// The effects of relativity and of light's delay, each of which can be turned off alone.
    #[serde(default)]
    pub effects: Effects,
    /// What stands in for time-resolved data that a source does not have: "black", "hold", or a table
    /// that gives it case by case. Default: "black".
    #[serde(default)]
    pub outside: Outside,
    /// How light is followed.
    #[serde(default)]
    pub render: Render,
    /// How radiance becomes a picture to look at.
    #[serde(default)]
    pub display: At<Display>,
    /// Variants of the scene, each a picture of its own.
    #[serde(default)]
    pub panel: Vec<At<Panel>>,
    /// How the panels are put on one page.
    #[serde(default)]
    pub sheet: Sheet,
    /// A space-time diagram of the scene, or of its own.
    pub diagram: Option<At<D>>,
}

/// A table that rooms above read.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(expecting = "a table")]
pub(in crate::scene) struct AnyTable {}

impl Scene {
    fn speed_of_light() -> At<Speed> {
        At::nowhere(Speed::customary(super::model::SPEED_OF_LIGHT))
    }
}

/// What light travels through.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { index = 1.33 }"
)]
pub(in crate::scene) struct Medium {
    /// Refractive index η ≥ 1 of the medium, which rests in the world. It lengthens the delay of light
    /// (η metres per metre) and does nothing else: no refraction. Default: 1.
    pub index: At<Number>,
}

impl Default for Medium {
    fn default() -> Self {
        Medium {
            index: At::nowhere(Number(1.0)),
        }
    }
}

/// The effects of relativity and of light's delay.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { doppler = false }"
)]
pub(in crate::scene) struct Effects {
    /// Off: a look direction of the camera is taken as the same direction of the world. Default: true.
    pub aberration: bool,
    /// Off: colours are those of the emitted wavelength. Default: true.
    pub doppler: bool,
    /// Off: the observed radiance is the emitted one. Default: true.
    pub searchlight: bool,
    /// Off: light takes no time; everything is seen where, and as bright as, it is at the world time of
    /// the shot. Default: true.
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

/// How light is followed.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { bounces = 4 }"
)]
pub(in crate::scene) struct Render {
    /// How many more times light is reflected after the first surface that it falls on, 0 to 64: 0 is direct light
    /// alone, 1 has light from one surface to the next, and so on. Default: 0.
    pub bounces: At<u32>,
    /// What of light surfaces reflect: "rgb" (red, green and blue, as they come to a surface in its rest frame) or "sampled" (the
    /// spectrum, at three wavelengths of each sample, with noise in colours): for lamps, skies and shining surfaces whose light is no smooth spectrum,
    /// or coloured, on surfaces that move. Needs quantity = "rgb". Default: "rgb".
    pub spectra: At<Spectra>,
    /// Which random numbers are drawn, 0 to 4294967295: pictures of different seeds have the same light and independent noise.
    /// Default: 0.
    pub seed: u32,
    /// Which of several captures of one surface gives it its radiance: "blend" (all that saw the point at that time,
    /// those that saw it finest most) or "first" (the first of them in the scene file). Default: "blend".
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

/// What stands in for data that a source does not have, by case.
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
    /// Not seen by the capture camera: "black", "hold" (what the capture camera saw in that direction)
    /// or { mark = [r, g, b] }. Default: `mark`, or else "black".
    pub occluded: Option<Fill>,
    /// Linear RGB that marks every case for which no other key is given.
    pub mark: Option<Vector>,
}

/// What stands in for data that a source does not have: one answer for all, or by case.
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

// A visitor rather than serde's `untagged`, which loses where in the table an error is.
impl<'de> Visitor<'de> for OutsideVisitor {
    type Value = Outside;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("\"black\", \"hold\" or a table like { before = \"hold\" }")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Outside, E> {
        // By serde, so that a word that is none of them is refused with all that there are.
        Fill::deserialize(StrDeserializer::new(text)).map(Outside::All)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Outside, A::Error> {
        // From the map as it is, which knows where in the text its keys stand.
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
    /// A linear RGB radiance to stand out.
    Mark(Vector),
}

/// Isochrones of the light of one flash, of bodies at rest in the world: when it lights them, or when that is seen. Nothing is in
/// its way.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { flash = [0, 3, 0] }")]
pub(in crate::scene) struct Isochrones {
    /// World position of the flash, metres.
    pub flash: At<Vector>,
    /// World time (ct) of the flash. Default: "0 m".
    pub time: Option<At<Time>>,
    /// On whose clock: "world", when the light comes to the surface; "camera", when it comes from there to this camera, which rests;
    /// or [x, y, z], when it comes from there to a capture camera that rests at this place, on a clock that shows the world's time.
    /// Default: "world".
    pub clock: Option<At<Receiver>>,
}

/// Where light is received, in one of two ways.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(untagged)]
pub(in crate::scene) enum Receiver {
    Named(NamedReceiver),
    At(Vector),
}

/// Where light is received, by a word.
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

/// How radiance becomes a picture to look at.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { exposure = \"99 %\" }"
)]
pub(in crate::scene) struct Display {
    /// The percentile of the lit pixels' brightest channel, as the display shows it, that becomes white, in (0, 100] %. Excludes
    /// `white` and `logarithmic`. Default: "99 %".
    pub exposure: Option<At<Percentage>>,
    /// The radiance that becomes white, above 0. Excludes `exposure` and `logarithmic`.
    pub white: Option<At<Number>>,
    /// The radiances that become black and white, both above 0, the lower first, like [1e-8, 1e4]: between them brightness goes by
    /// the logarithm of the brightest channel, and colours keep their hue. One scale for all pictures of a series, however
    /// far apart they are. Excludes `exposure` and `white`.
    pub logarithmic: Option<At<Numbers<2>>>,
    /// Words beneath pictures (.png), with the camera's time and, where it moves, its speed (β and γ); "" for these alone.
    /// Default: nothing stands beneath them.
    pub caption: Option<At<String>>,
    /// Which light isochrones show. Default: the light that makes the picture, by the time at which it left.
    pub isochrones: Option<At<Isochrones>>,
    /// The observed wavelength that is shown as the eye sees 555 nm, like "10 um", with all others in proportion: false
    /// colours of what is invisible. Of lines, spectra and quantity = "rgb". Default: colours as they are seen.
    pub false_colour: Option<At<Wavelength>>,
    /// What the colours of isochrones span, earliest time first, like ["0 m", "12 m"]: one scale for all pictures of a
    /// series. Default: what each picture has.
    pub times: Option<At<[At<Time>; 2]>>,
    /// What the colours of a picture of luminance span, both above 0, the lower first, like [1e-4, 1e2]: one scale for all
    /// pictures of a series. Default: what each picture has.
    pub luminances: Option<At<Numbers<2>>>,
    /// Bits per sample of a .png file: 8 or 16. Default: 8.
    pub bits: At<u32>,
    /// Linear RGB radiance of rays that hit nothing, as observed. Excludes `sky`. Default: [0, 0, 0].
    pub background: At<Vector>,
    /// Which faces of a triangle are seen: "as_file" (glTF's doubleSided, or else culled),
    /// "two_sided", "black" (back faces are black and hide what is behind them) or "culled".
    /// Default: "as_file".
    pub back_faces: BackFaces,
    /// Samples per pixel, 1 to 65536; powers of 4 are spread most evenly. Default: 4.
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
