//! From the file's structure to the model: units, names, alternatives, ranges. Nothing is opened here: the files were looked for before.

mod binding;
mod camera;
mod context;
mod equations;
mod gltf_light;
mod kinematics;
mod light;
mod motion;
mod mover;
mod object;
mod panel;
mod path;
mod pose;
mod radiance;
mod sensor;
mod settings;
mod shape;
mod sky;
mod source;
mod spectrum;
mod stereo;
mod transform;
pub(crate) mod velocity;
mod worldline;

use super::at::At;
use super::file;
use super::inputs::Inputs;
use super::limits;
use super::model::Scene;
use super::report::Report;
use super::values::Number;
use crate::error::{Error, Result};
use crate::spacetime::units::quoted;
pub(crate) use context::Context;
pub(super) use context::{GLTF, NUMBERS, SPECTRUM, has_extension};
pub(crate) use kinematics::{CameraMotion, Kinematics, ObjectMotion};
pub(crate) use object::refuse_duplicates;

/// The scene in `file`, which was read from the report's text, with what was found in the files that it names.
pub(super) fn scene(report: Report, inputs: Inputs, mut file: file::Scene) -> Result<Scene> {
    let mut cx = Context::new(report, inputs, &file.speed_of_light)?;
    cx.inputs.if_missing = cx.optional_text(&file.if_missing, "what to do")?;
    gltf_light::fill(&cx, &mut file.light)?;
    let file = &file;
    let medium_index = settings::medium_index(&cx, &file.medium)?;
    let said = file
        .camera
        .as_ref()
        .ok_or_else(|| without_camera(&cx, file))?;
    let camera = camera::resolve(&cx, said)?;
    let continuation = radiance::continuation(&file.radiance, &file.source);
    let quantity = radiance::resolve(&cx, &file.radiance)?;
    let spectral = (quantity, continuation);
    // Objects first, because lights and sources name them.
    let mut objects =
        object::resolve_all(&cx, &file.object, &said.span, file.sky.is_some(), spectral)?;
    let flash_times = settings::isochrones(&cx, &file.display, &camera, &objects)?;
    let around = light::Around {
        objects: &objects,
        index: medium_index,
        quantity,
        continuation,
    };
    let lights = light::resolve_all(&cx, &file.light, &around)?;
    light::give_spectra(&cx, &file.light, &lights, &mut objects, spectral)?;
    let sources = source::resolve_all(&cx, &file.source, &objects, quantity)?;
    light::refuse_those_of_cubes(&cx, &lights, &sources, &objects)?;
    let mut scene = Scene {
        speed_of_light: cx.speed_of_light,
        medium_index,
        flash_times,
        camera,
        lights,
        objects,
        sources,
        quantity,
        continuation,
        equations: file.model.value,
        effects: settings::effects(&file.effects),
        bounces: settings::bounces(&cx, file)?,
        spectra: file.render.spectra.value,
        seed: file.render.seed,
        captures: file.render.captures,
        outside: settings::outside(&file.outside),
        sky: sky::resolve(&cx, &file.sky, spectral)?,
        back_faces: file.display.value.back_faces,
        background: cx.colour(&file.display.value.background)?,
        bits: settings::bits(&cx, &file.display)?,
        false_colour: settings::false_colour(&cx, &file.display)?,
        times: settings::times(&cx, &file.display)?,
        luminances: settings::luminances(&cx, &file.display)?,
        caption: settings::caption(&cx, &file.display)?,
        exposure: settings::exposure(&cx, &file.display)?,
        samples_per_pixel: settings::samples_per_pixel(&cx, &file.display)?,
        passed_over: passed_over(&cx, file)?,
        panels: panel::resolve_all(&cx, &file.panel)?,
        sheet: panel::sheet(&cx, &file.sheet)?,
        text: cx.report.text.edited.to_string(),
        file_text: cx.report.text.file.clone(),
        name: cx.report.name.clone(),
        folder: cx.inputs.reach.clone(),
        read: cx.inputs.read.iter().cloned().collect(),
    };
    scene.passed_over.extend(rough_glass(file, &scene));
    // Checks that need the whole scene.
    refuse_two_backgrounds(&cx, file)?;
    sky::check(&cx, file, &scene)?;
    cx.checked(&file.render.spectra, limits::spectra(&scene))?;
    equations::check(&cx, file, &scene)?;
    Ok(scene)
}

/// Rotations of animated nodes that are not followed: only a camera of a glTF file turns with its node, from picture to picture.
fn passed_over(cx: &Context, file: &file::Scene) -> Result<Vec<String>> {
    let mut sentences = Vec::new();
    let mut look = |thing: &str, motion: &Option<At<file::Motion>>, remedy: &str| -> Result<()> {
        let animation = motion.as_ref().and_then(|at| at.value.animation.as_ref());
        if let Some(file::Animation { gltf, node, .. }) = animation.map(|at| &at.value)
            && cx.gltf_track(gltf)?.turns
        {
            sentences.push(format!(
                "{thing}: node {} also rotates in its animation, but {remedy}",
                quoted(&node.value)
            ));
        }
        Ok(())
    };
    if let Some(camera) = &file.camera {
        let file::Camera { gltf, shutter, .. } = &camera.value;
        let remedy = match (gltf, shutter) {
            (None, _) => {
                Some("only its position is followed: give `gltf` in place of `look_at` to turn too")
            }
            (Some(_), Some(_)) => {
                Some("while the shutter is open the camera looks as when it opened")
            }
            (Some(_), None) => None,
        };
        if let Some(remedy) = remedy {
            look("the camera", &camera.value.motion, remedy)?;
        }
    }
    for light in &file.light {
        // A point light looks the same from all sides.
        if light.value.kind.value == file::LightType::Spot {
            let remedy = "only its position is followed: the spot keeps its direction";
            look("a spot light", &light.value.motion, remedy)?;
        }
    }
    Ok(sentences)
}

/// Roughness that shapes of glass do not show.
fn rough_glass(file: &file::Scene, scene: &Scene) -> Vec<String> {
    let is_above_0 = |at: &Option<At<Number>>| at.as_ref().is_some_and(|at| at.value.0 > 0.0);
    let objects = file.object.iter().map(|at| &at.value).zip(&scene.objects);
    let rough =
        objects.filter(|(said, _)| is_above_0(&said.transmission) && is_above_0(&said.roughness));
    rough
        .map(|(_, object)| {
            format!(
                "object {}: rough glass is taken as smooth",
                quoted(&object.name)
            )
        })
        .collect()
}

/// Refuses a background beside a sky, which replaces it.
fn refuse_two_backgrounds(cx: &Context, file: &file::Scene) -> Result<()> {
    let background = &file.display.value.background;
    match &file.sky {
        Some(sky) if background.is_given() => {
            Err(cx.refuse_both((sky, "sky"), (background, "background")))
        }
        _ => Ok(()),
    }
}

fn without_camera(cx: &Context, file: &file::Scene) -> Error {
    if let Some(diagram) = &file.diagram {
        let what = "this file is a space-time diagram: it has no camera that could take a picture";
        let help = "draw it with `nullray diagram`, or add [camera] and [[object]]";
        return cx.refuse(diagram, what, help);
    }
    cx.report.missing("camera")
}
