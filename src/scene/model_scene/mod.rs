//! The scene for a model that comes without one: a camera that frames it, a sky, and its own lights or a sun; or a flash of light on it.

mod flash;
mod flyby;
mod framing;
mod fronts;
mod motion;
mod subject;
#[cfg(test)]
mod tests;
mod text;
mod view;

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

use glam::{DQuat, DVec3};
use toml_edit::Value;

use self::flash::{Model, flashing};
use self::flyby::passing;
use self::framing::framing;
use self::motion::Motion;
use self::subject::Subject;
pub(crate) use self::text::MADE_FOR_MODEL;
use self::text::{DROPS, backs_of, brightness, light_names, vector, write_light};
pub use self::text::{FlashLight, ModelScene};
use self::view::VIEWPOINT;
pub use self::view::{Flash, Heading, ModelView};
use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::gltf::{self, BadTextures};
use crate::mesh::Factors;
use crate::scene::model::Exposure;
use crate::spacetime::Quantity;

/// The least radiance that is displayed as white, relative to that of a white surface in the sun: dark models look dark.
const LEAST_WHITE: f64 = 0.5;
/// Bounces for a model with glass: enough to see through two hollow bodies of four surfaces each.
const GLASS_BOUNCES: u32 = 8;
/// Samples per pixel of a model of metal: each is one direction of what it mirrors.
const METAL_SAMPLES: u32 = 16;
/// The default picture size.
const SIZE: [u32; 2] = [640, 480];
/// The direction of the sun for a model without its own lights, seen from [`VIEWPOINT`]: above the viewer's right shoulder.
const SUN: DVec3 = DVec3::new(1.0, 1.4, 0.9);

/// The scene for the glTF file at `path`, viewed according to `view`. The path is written into the scene as given, so the scene file belongs
/// in the folder to which `path` is relative. The model is loaded only for framing.
///
/// # Errors
/// As [`gltf::load`]; a model that refers to files outside its folder without permission, or takes more than `budget` has; a path that is not
/// UTF-8; a model without extent; a speed of c or more; a direction of length 0.
pub fn model_scene(path: &Path, view: &ModelView, budget: &Budget) -> Result<ModelScene> {
    let name = path.to_str().ok_or_else(|| {
        let help = "rename the file, so that a scene file can name it";
        Error::unsupported(path, "path", "its name is not UTF-8 text", help)
    })?;
    if !view.allow_outside {
        gltf::refuse_outside(path)?;
    }
    let held = gltf::inspect_for(path, None, BadTextures::Drop)?;
    let subject = Subject::of(path, &held, view.flash.is_some(), budget)?;
    let motion = Motion::new(path, view)?;
    let size = view.size.unwrap_or(SIZE);
    if let Some(flash) = &view.flash {
        let model = Model {
            path,
            name,
            held: &held,
        };
        return flashing(&model, &subject, motion, size, flash);
    }
    let camera = match (view.flyby, motion) {
        (true, Some(motion)) => passing(&subject.ball, motion),
        (_, motion) => framing(&subject, motion, size, None),
    };
    let mut text = format!("{MADE_FOR_MODEL}\n");
    // Writing to a string cannot fail.
    let _ = camera.write(&mut text, size);
    let _ = write!(
        text,
        "\n[[object]]\ngltf = {}\n{DROPS}\n[radiance]\n",
        Value::from(name).to_string().trim()
    );
    let quantity = camera.quantity();
    let _ = match quantity {
        Quantity::Rgb => writeln!(text, "quantity = \"rgb\""),
        _ => writeln!(
            text,
            "# Hues stay, as W up to {:.3} would shift all light out of sight.\nquantity = \"luminance\"",
            camera.ratios[1]
        ),
    };
    if held.factors.iter().any(Factors::is_glass) {
        let _ = write!(text, "\n[render]\nbounces = {GLASS_BOUNCES}\n");
    }
    let lights = gltf::lights(path)?;
    let _ = writeln!(text, "\n[sky]\ngradient = {{}}");
    let is_sunlit = lights.is_empty() && subject.inside.is_none();
    if is_sunlit {
        let sun = over_shoulder(camera.eye - subject.ball.centre);
        let _ = writeln!(text, "sun = {{ direction = {} }}", vector(sun));
    }
    if let (Some(inside), true) = (subject.inside, lights.is_empty()) {
        let _ = write!(text, "{}", room_lamp(inside, subject.ball.radius));
    }
    for (light, name) in lights.iter().zip(light_names(&lights)) {
        let _ = write_light(&mut text, light, &name);
    }
    let [white, dark] = camera.ratios.map(|w| brightness(quantity, w));
    // Of the stills, a linear display has room for W from 0.67 to 1.48.
    let range = Exposure::white_over_black(white / dark);
    // The brightness of a white surface in the middle.
    let middle = brightness(quantity, (camera.ratios[0] * camera.ratios[1]).sqrt());
    let is_unlit = held.unlit.len() == held.materials.len();
    let least_white = match range.is_none() {
        true if is_unlit => middle,
        true if is_sunlit => LEAST_WHITE * middle,
        _ => 0.0,
    };
    let mut display = backs_of(subject.inside.is_some()).to_owned();
    let is_metal = |factors: &Factors| factors.metallic > 0.5;
    if held.factors.iter().all(is_metal) && !held.has_gloss_textures {
        let _ = writeln!(display, "samples_per_pixel = {METAL_SAMPLES}");
    }
    Ok(ModelScene {
        text,
        range,
        white,
        least_white,
        display,
        flash: None,
    })
}

/// The direction of the sun for a viewer in this direction from the model.
fn over_shoulder(away: DVec3) -> DVec3 {
    let azimuth = |v: DVec3| libm::atan2(v.x, v.z);
    let turn = azimuth(away) - azimuth(VIEWPOINT);
    // Of a viewer who has not turned, to the last digit.
    match turn.abs() < 1e-9 {
        true => SUN,
        false => DQuat::from_rotation_y(turn) * SUN,
    }
}

/// The lamp of a room without lights, at `place`, which makes a white wall at the distance of its corners, `radius`, as bright as the sun would.
fn room_lamp(place: DVec3, radius: f64) -> String {
    let intensity = PI * radius * radius;
    format!(
        "lights = false\n\n[[light]]\nname = \"lamp\"\ntype = \"point\"\nposition = {}\nintensity = {intensity:?}\n",
        vector(place)
    )
}
