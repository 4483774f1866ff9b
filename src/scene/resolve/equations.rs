//! The equations of a picture, and what those of the paper do not cover.
//!
//! Jarabo et al. 2015 treat a static world, cameras without acceleration or with constant proper acceleration, and rotating sensors whose
//! elements are separate inertial cameras (comoving or aberrated).

use glam::DVec3;

use super::context::Context;
use crate::error::Result;
use crate::scene::file;
use crate::scene::model::{CameraModel, Elements, Equations, Motion, Scene};
use crate::spacetime::units::quoted;

const EXACT: &str = "leave this out, or give model = \"exact\"";

/// Refuses scenes that the equations do not cover.
pub(super) fn check(cx: &Context, file: &file::Scene, scene: &Scene) -> Result<()> {
    if scene.equations == Equations::Exact {
        return Ok(());
    }
    static_world(cx, file, scene)?;
    stereo(cx, file)?;
    motion(cx, file, scene)?;
    rotation(cx, file, scene)
}

fn static_world(cx: &Context, file: &file::Scene, scene: &Scene) -> Result<()> {
    let mut objects = file.object.iter().zip(&scene.objects);
    let moving = objects.find(|(_, object)| !object.velocity.is_rest());
    let Some((at, object)) = moving else {
        return Ok(());
    };
    let span = at.value.velocity.as_ref().map_or(&at.span, |v| &v.span);
    let what = format!(
        "the paper's world is static, and {} moves",
        quoted(&object.name)
    );
    let other = (&file.model.span, "this model");
    Err(cx.report.refuse_two(span, other, what, EXACT))
}

fn stereo(cx: &Context, file: &file::Scene) -> Result<()> {
    let Some(stereo) = file.camera.as_ref().and_then(|at| at.value.stereo.as_ref()) else {
        return Ok(());
    };
    let what = "the paper's cameras have one pinhole, but a stereo pair has two";
    let other = (&file.model.span, "this model");
    Err(cx.report.refuse_two(&stereo.span, other, what, EXACT))
}

fn motion(cx: &Context, file: &file::Scene, scene: &Scene) -> Result<()> {
    let Some(motion) = file.camera.as_ref().and_then(|at| at.value.motion.as_ref()) else {
        return Ok(());
    };
    let refuse = |what: &str, help: &str| {
        let other = (&file.model.span, "this model");
        Err(cx.report.refuse_two(&motion.span, other, what, help))
    };
    let camera = &scene.camera;
    let acceleration = match &camera.motion {
        Motion::Inertial => return Ok(()),
        Motion::Accelerated(acceleration) => Some(*acceleration),
        // An acceleration without end: from rest, or from constant speed.
        Motion::Segments(segments) => match segments.as_slice() {
            [only] if only.duration.is_infinite() => Some(only.acceleration),
            _ => None,
        },
        Motion::Profile { .. }
        | Motion::Keyframes(_)
        | Motion::Animation { .. }
        | Motion::Circular { .. } => None,
    };
    match acceleration {
        Some(_) if camera.shutter.is_some() => refuse(
            "the paper's exposures are of cameras at constant speed",
            "leave [camera.shutter] out, or give model = \"exact\"",
        ),
        Some(acceleration) if !speeds_up(camera, acceleration) => refuse(
            "the paper's cameras speed up along their motion, but this one is slowing down or turning when its picture is taken",
            "accelerate along the motion, or give model = \"exact\"",
        ),
        Some(_) => Ok(()),
        None => refuse(
            "the paper's cameras are inertial or have one constant proper acceleration",
            "give `acceleration`, or one segment without a duration, no motion, or model = \"exact\"",
        ),
    }
}

/// Whether `camera`, at its time, rests or moves along its acceleration.
fn speeds_up(camera: &CameraModel, acceleration: DVec3) -> bool {
    let line = camera.world_line().ok();
    let Some(state) = line.and_then(|line| line.state(camera.time)) else {
        return true;
    };
    let w = state.velocity.rapidity();
    // Along it up to the rounding of directions in a file.
    w.dot(acceleration) >= (1.0 - 1e-12) * w.length() * acceleration.length()
}

fn rotation(cx: &Context, file: &file::Scene, scene: &Scene) -> Result<()> {
    let said = file
        .camera
        .as_ref()
        .and_then(|at| at.value.rotation.as_ref());
    let (Some(at), Some(rotation)) = (said, &scene.camera.rotation) else {
        return Ok(());
    };
    if rotation.elements != Elements::Exact {
        return at_rest(cx, file, scene);
    }
    let elements = &at.value.elements;
    let span = if elements.is_given() {
        &elements.span
    } else {
        &at.span
    };
    let what =
        "the paper has no exact rotation: its sensor's elements are separate inertial cameras";
    let help = "give elements = \"comoving\" or \"aberrated\", or model = \"exact\"";
    let other = (&file.model.span, "this model");
    Err(cx.report.refuse_two(span, other, what, help))
}

fn at_rest(cx: &Context, file: &file::Scene, scene: &Scene) -> Result<()> {
    let Some(velocity) = file
        .camera
        .as_ref()
        .and_then(|at| at.value.velocity.as_ref())
    else {
        return Ok(());
    };
    if scene.camera.velocity.is_rest() {
        return Ok(());
    }
    let what = "the paper rotates a camera at rest, but this one moves";
    let other = (&file.model.span, "this model");
    Err(cx.report.refuse_two(&velocity.span, other, what, EXACT))
}
