//! The camera.

use std::sync::Arc;

use glam::DVec3;

use super::context::Context;
use super::motion::{self, Moving};
use super::mover::{Mover, only_one_way};
use super::{path, pose, sensor, stereo, worldline};
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file::Camera;
use crate::scene::inputs::Pose;
use crate::scene::limits;
use crate::scene::model::{CameraModel, ProjectionKind, Turning};

/// The camera: its parts are resolved separately and then checked against each other.
pub(super) fn resolve(cx: &Context, at: &At<Camera>) -> Result<CameraModel> {
    let camera = &at.value;
    let size = camera.size.value;
    cx.checked(&camera.size, limits::image_size(size))?;
    let mover = Mover::from(camera);
    only_one_way(cx, &mover)?;
    let pose = pose(cx, at)?;
    let Moving {
        origin,
        velocity,
        motion,
        line,
    } = motion::resolve(cx, &mover, pose.eye)?;
    let interval = camera.frame_interval.as_ref();
    let interval = interval.map(|interval| cx.duration(interval, "`frame_interval`"));
    let model = CameraModel {
        origin,
        axes: pose.axes,
        turning: turning(cx, camera, pose.axes)?,
        projection: camera.projection.value,
        horizontal_fov: horizontal_fov(cx, camera, &pose, size)?,
        size,
        velocity,
        motion,
        sensor: sensor::resolve(cx, camera)?,
        rotation: sensor::rotation(cx, camera)?,
        stereo: stereo::resolve(cx, camera, size)?,
        time: cx.time(&camera.time)?,
        shutter: sensor::shutter(cx, camera)?,
        frame_interval: interval.transpose()?,
    };
    stereo::refuse_sensor_without_plane(cx, camera)?;
    sensor::refuse_faster_than_light(cx, camera, &model)?;
    worldline::refuse_outside(cx, camera, &model, &line)?;
    Ok(model.at(model.time))
}

/// How a camera of a glTF file that follows an animation turns with its node.
fn turning(cx: &Context, camera: &Camera, axes: [DVec3; 3]) -> Result<Option<Turning>> {
    let motion = camera.motion.as_ref().map(|at| &at.value);
    let animation = motion.and_then(|motion| motion.animation.as_ref());
    let (Some(animation), Some(_)) = (animation, &camera.gltf) else {
        return Ok(None);
    };
    let track = cx.gltf_track(&animation.value.gltf)?;
    Ok(Some(Turning {
        axes,
        track: Arc::new(track),
        speed_of_light: cx.speed_of_light,
    }))
}

/// The pose when the camera's clock shows 0.
fn pose(cx: &Context, at: &At<Camera>) -> Result<Pose> {
    let camera = &at.value;
    let mut keys = pose::Keys::from(camera);
    let mover = Mover::from(camera);
    let start = path::start(cx, &mover)?;
    if camera.gltf.is_none() && start.is_some() {
        keys.eye = &start;
    }
    pose::resolve(cx, at, &keys)
}

/// From the sensor's width, or the file, or the glTF camera, or the default.
fn horizontal_fov(
    cx: &Context,
    camera: &Camera,
    pose: &Pose,
    [width, height]: [u32; 2],
) -> Result<f64> {
    if let Some(horizontal) = sensor::horizontal_fov(cx, camera)? {
        return Ok(horizontal);
    }
    let projection = camera.projection.value;
    if let Some(hfov) = &camera.hfov {
        return pose::fov(cx, hfov, projection);
    }
    if projection != ProjectionKind::Perspective {
        return Ok(Camera::hfov(projection).radians());
    }
    // Each eye has half of the columns.
    let eyes = if camera.stereo.is_some() { 2.0 } else { 1.0 };
    let aspect = f64::from(width) / (eyes * f64::from(height));
    Ok(match pose.gltf_fov {
        Some((Some(horizontal), _)) => horizontal,
        // tan(h/2) = aspect · tan(v/2): the film is a plane.
        Some((None, vertical)) => 2.0 * libm::atan(aspect * libm::tan(0.5 * vertical)),
        None => Camera::hfov(projection).radians(),
    })
}
