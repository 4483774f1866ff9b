//! What lights take from glTF files.

use super::context::Context;
use super::light::has_place;
use crate::error::{Result, number};
use crate::io::gltf::GltfLightKind;
use crate::scene::at::At;
use crate::scene::file::{Light, LightType, Motion};
use crate::scene::values::{NumberOrVector, Numbers};
use crate::spacetime::units::{Angle, LARGEST};

/// Gives lights with `gltf` the keys that they take from their files, as if they stood in its place in the text; those in the text remain.
pub(super) fn fill(cx: &Context, lights: &mut [At<Light>]) -> Result<()> {
    lights.iter_mut().try_for_each(|at| one(cx, &mut at.value))
}

fn one(cx: &Context, light: &mut Light) -> Result<()> {
    let Some(gltf) = light.gltf.clone() else {
        return match &light.node {
            None => Ok(()),
            Some(node) => {
                let what = "`node` is a node of a glTF file, but no file is given";
                let help = "add gltf = \"file.glb\", or leave `node` out";
                Err(cx.refuse(node, what, help))
            }
        };
    };
    cx.optional_text(&light.node, "the node's name")?;
    let found = cx.gltf_light(&gltf)?;
    let (own, cone) = match found.kind {
        GltfLightKind::Point => (LightType::Point, None),
        GltfLightKind::Spot { inner, outer } => (LightType::Spot, Some([inner, outer])),
        GltfLightKind::Directional => (LightType::Directional, None),
    };
    if !light.kind.is_given() {
        light.kind = here(&gltf, own);
    }
    // The intensity of a lamp is no irradiance.
    let kind = light.kind.value;
    if kind != own && !(has_place(kind) && has_place(own)) {
        let what = format!(
            "the light of the file is of type \"{}\", and cannot be of type \"{}\"",
            own.name(),
            kind.name()
        );
        let help = "leave `type` out; only points and spots can take each other's place";
        return Err(cx.refuse(&light.kind, what, help));
    }
    let position = found.position.to_array();
    if let Some(most) = (position.iter().chain(&found.intensity)).find(|x| x.abs() > LARGEST) {
        let what = format!("its light has {}, beyond {LARGEST:e}", number(*most));
        let help = "scale the model, or the intensity of its light";
        return Err(cx.refuse(&gltf, what, help));
    }
    if has_place(kind) && !follows_events(&light.motion) {
        light.position.get_or_insert(here(&gltf, Numbers(position)));
    }
    if kind != LightType::Point {
        let direction = Numbers(found.direction.to_array());
        light.direction.get_or_insert(here(&gltf, direction));
    }
    if let (LightType::Spot, Some(cone)) = (kind, cone) {
        let [inner, outer] = cone.map(|angle| here(&gltf, Angle::of_radians(angle)));
        light.inner.get_or_insert(inner);
        light.outer.get_or_insert(outer);
    }
    let brightness = here(&gltf, NumberOrVector::Vector(found.intensity));
    if kind == LightType::Directional {
        light.irradiance.get_or_insert(brightness);
    } else if light.power.is_none() {
        light.intensity.get_or_insert(brightness);
    }
    Ok(())
}

/// A value with the place of the file that it was taken from.
fn here<T>(gltf: &At<String>, value: T) -> At<T> {
    At {
        value,
        span: gltf.span.clone(),
    }
}

/// Whether a motion gives the positions itself.
fn follows_events(motion: &Option<At<Motion>>) -> bool {
    let motion = motion.as_ref().map(|at| &at.value);
    motion.is_some_and(|motion| motion.keyframes.is_some() || motion.animation.is_some())
}
