//! The text of a model's scene.
//!
//! *Display.* At the wavelength ratio W, white light of 6504 K looks like a blackbody of 6504 K/W, and colours that keep their hue
//! have W⁻⁴ of their radiance. If this brightness varies by more than a factor of 30 over the model, the display is logarithmic. If
//! parts of the model have W > 5, that is, if they are seen in light emitted below 170 nm with 10⁻⁷ of its brightness, colours keep
//! their hue. Models lit by the sun of this scene are exposed as if they held something half as bright as a white surface, so that black ones
//! look black, and those that are nowhere lit with their own colours.

use std::fmt::Write;

use glam::DVec3;
use toml_edit::Value;

use crate::io::gltf::{GltfLight, GltfLightKind};
use crate::scene::names;
use crate::spacetime::Quantity;
use crate::spacetime::units::{Angle, LARGEST, SMALLEST};

/// The first line of such a scene.
pub(crate) const MADE_FOR_MODEL: &str = "# Made by nullray for a model without a scene.";

/// Keys of the model's object: the rest of a model is shown if a part of it cannot be.
pub(super) const DROPS: &str = "bad_vertices = \"drop\"\nbad_textures = \"drop\"\n";

/// The scene made for a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelScene {
    /// The text without the exposure.
    pub(super) text: String,
    /// White over black for a logarithmic display.
    pub(super) range: Option<f64>,
    /// The white radiance if it is not measured, and the least.
    pub(super) white: f64,
    pub(super) least_white: f64,
    /// Other lines of its display.
    pub(super) display: String,
    /// The light that has to be baked before the scene can be rendered.
    pub(super) flash: Option<FlashLight>,
}

impl ModelScene {
    /// The light that has to be baked before the scene can be rendered.
    pub fn flash(&self) -> Option<&FlashLight> {
        self.flash.as_ref()
    }

    /// The text; a logarithmic display is exposed for a white model in daylight.
    pub fn text(&self) -> String {
        match self.range {
            Some(_) => self.exposed(self.white),
            None => self.displayed(""),
        }
    }

    /// The text, with the radiance `white` displayed as white; exposed by each picture if that is beyond what scene files allow.
    pub fn exposed(&self, white: f64) -> String {
        let short = |radiance: f64| format!("{radiance:.2e}").parse().unwrap_or(radiance);
        let white: f64 = short(white.max(self.least_white));
        let black = self.range.map(|range| short(white / range));
        if white > LARGEST || black.unwrap_or(white) < SMALLEST {
            return self.displayed("");
        }
        self.displayed(&match black {
            Some(black) => format!("logarithmic = [{black:?}, {white:?}]\n"),
            None => format!("white = {white:?}\n"),
        })
    }

    /// The text with this line of its display.
    fn displayed(&self, line: &str) -> String {
        match (line, self.display.as_str()) {
            ("", "") => self.text.clone(),
            (line, others) => format!("{}\n[display]\n{others}{line}", self.text),
        }
    }
}

/// The light of a flash, which is baked before it can be read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FlashLight {
    /// The scene whose objects are to be baked; its camera is always the same.
    pub scene: String,
    /// The start of the first bin, metres.
    pub start: f64,
    /// Width of a bin, metres.
    pub width: f64,
    /// Number of bins.
    pub bins: u32,
    /// Whether what the model's materials emit for ever is left out.
    pub leaves_out_emission: bool,
    /// The same light without bounces, seen by the film's camera; used to choose an exposure.
    pub(super) direct: String,
}

impl FlashLight {
    /// The scene with direct light only, seen by the film's camera.
    pub fn direct(&self) -> &str {
        &self.direct
    }
}

/// The line of a display that shows a room as if the walls between it and the camera were not there.
pub(super) fn backs_of(is_room: bool) -> &'static str {
    match is_room {
        true => "back_faces = \"culled\"\n",
        false => "",
    }
}

/// The brightness of white light at the wavelength ratio W, relative to W = 1.
pub(super) fn brightness(quantity: Quantity, w: f64) -> f64 {
    // hc/(λkT) at 555 nm and 6504 K.
    const X: f64 = 0.014_387_769 / (555e-9 * 6504.0);
    match quantity {
        Quantity::Rgb => libm::expm1(X) / libm::expm1(X * w),
        _ => 1.0 / (w * w * w * w),
    }
}

/// The light of a scene with what its materials emit.
pub(super) const EMISSION: &str = "emission";

/// The names of the file's lights in the scene, all different; "" for those that have none.
pub(super) fn light_names(lights: &[GltfLight]) -> Vec<String> {
    let own = lights.iter().map(|light| (None, light.name.clone()));
    let taken = (Some(EMISSION.into()), String::new());
    let unique = names::unique(std::iter::once(taken).chain(own).collect());
    let named = unique.into_iter().skip(1).zip(lights);
    named
        .map(|(name, light)| match light.name.is_empty() {
            true => String::new(),
            false => name,
        })
        .collect()
}

/// Writes a light of the file as a light of the scene with this name, if it has one.
pub(super) fn write_light(text: &mut String, light: &GltfLight, name: &str) -> std::fmt::Result {
    let direction = vector(light.direction);
    let intensity = vector(DVec3::from_array(light.intensity));
    writeln!(text, "\n[[light]]")?;
    if !name.is_empty() {
        writeln!(text, "name = {}", Value::from(name))?;
    }
    match light.kind {
        GltfLightKind::Directional => {
            writeln!(text, "type = \"directional\"\ndirection = {direction}")?;
            return writeln!(text, "irradiance = {intensity}");
        }
        GltfLightKind::Point => writeln!(text, "type = \"point\"")?,
        GltfLightKind::Spot { inner, outer } => {
            let [inner, outer] = [inner, outer].map(Angle::of_radians);
            writeln!(text, "type = \"spot\"\ndirection = {direction}")?;
            writeln!(text, "inner = \"{inner}\"\nouter = \"{outer}\"")?;
        }
    }
    writeln!(text, "position = {}", vector(light.position))?;
    writeln!(text, "intensity = {intensity}")
}

/// A vector as written in scene files.
pub(super) fn vector(v: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x + 0.0, v.y + 0.0, v.z + 0.0)
}
