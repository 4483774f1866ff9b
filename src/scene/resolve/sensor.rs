//! The sensor behind the pinhole, its rotation, and its exposure.
//!
//! A sensor of the width w at the focal length d has the field of view 2 arctan(w / 2d). An element at the distance R from the axis of a
//! rotation at the rate Ω moves at |Ω| R < 1 in the camera's frame; in a rigid body whose pinhole has the proper acceleration a, only
//! points p with 1 + a·p > 0 move slower than light (Rindler).

use glam::DVec3;

use super::context::{BELOW, Context};
use crate::error::{Result, number};
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::limits;
use crate::scene::model::{
    Assembly, CameraModel, Elements, Motion, Pivot, ProjectionKind, Rotation, Sensor, Shutter,
};

/// The sensor of the file, if there is one.
pub(super) fn resolve(cx: &Context, camera: &file::Camera) -> Result<Option<Sensor>> {
    let Some(at) = &camera.sensor else {
        return Ok(None);
    };
    Ok(Some(Sensor {
        focal_length: focal_length(cx, &at.value)?,
        assembly: at.value.assembly.value,
    }))
}

fn focal_length(cx: &Context, sensor: &file::Sensor) -> Result<f64> {
    let length = &sensor.focal_length;
    if length.value.metres() < 0.0 {
        let what = format!(
            "a focal length of {} would put the pinhole behind the sensor",
            length.value
        );
        return Err(cx.refuse(length, what, "a focal length is above 0, like \"36 mm\""));
    }
    cx.positive_length(length, "`focal_length`")
}

/// The horizontal field of view for a sensor's width, radians.
pub(super) fn horizontal_fov(cx: &Context, camera: &file::Camera) -> Result<Option<f64>> {
    let Some(sensor) = camera.sensor.as_ref().map(|at| &at.value) else {
        return Ok(None);
    };
    cx.exclusive((&camera.hfov, "hfov"), (&sensor.width, "sensor.width"))?;
    let Some(width) = &sensor.width else {
        return Ok(None);
    };
    let metres = cx.positive_length(width, "`width`")?;
    let radians = 2.0 * libm::atan2(0.5 * metres, focal_length(cx, sensor)?);
    if limits::is_field_of_view(radians, ProjectionKind::Perspective) {
        return Ok(Some(radians));
    }
    let what = format!(
        "a sensor of {} at a focal length of {} has a field of view of {radians:e} rad",
        width.value, sensor.focal_length.value
    );
    let help = "give a width of about the focal length, like \"24 mm\" at \"36 mm\"";
    Err(cx.refuse(width, what, help))
}

/// The rotation of the sensor.
pub(super) fn rotation(cx: &Context, camera: &file::Camera) -> Result<Option<Rotation>> {
    let Some(at) = &camera.rotation else {
        return Ok(None);
    };
    let rotation = &at.value;
    let axis = cx.unit(
        &rotation.axis,
        "the axis of rotation",
        "give an axis like [0, 1, 0]",
    )?;
    if camera.sensor.is_none() {
        without_sensor(cx, rotation)?;
    }
    Ok(Some(Rotation {
        axis,
        rate: cx.angular_rate(&rotation.rate)?,
        through: rotation.through.value,
        elements: rotation.elements.value,
    }))
}

/// Refuses keys that need a sensor apart from the pinhole.
fn without_sensor(cx: &Context, rotation: &file::SensorRotation) -> Result<()> {
    let help = "add [camera.sensor] with a focal_length, or leave this out";
    if rotation.elements.value != Elements::Exact {
        let what = "elements that move with the sensor need a sensor, but this camera is a point";
        return Err(cx.refuse(&rotation.elements, what, help));
    }
    if rotation.through.value == Pivot::Sensor {
        let what = "the axis passes through the sensor, but this camera has none: it is a point";
        return Err(cx.refuse(&rotation.through, what, help));
    }
    Ok(())
}

/// How long the shutter is open.
pub(super) fn shutter(cx: &Context, camera: &file::Camera) -> Result<Option<Shutter>> {
    let Some(at) = &camera.shutter else {
        return Ok(None);
    };
    Ok(Some(Shutter {
        duration: cx.duration(&at.value.duration, "`duration`")?,
        records: at.value.records.value,
        integration: at.value.integration,
    }))
}

/// Refuses sensors with parts that would reach the speed of light.
pub(super) fn refuse_faster_than_light(
    cx: &Context,
    file: &file::Camera,
    model: &CameraModel,
) -> Result<()> {
    if let (Some(at), Some(rotation)) = (&file.rotation, &model.rotation) {
        refuse_rotation(cx, file, at, model, rotation)?;
    }
    match (&file.sensor, &model.sensor) {
        (Some(at), Some(sensor)) if sensor.assembly == Assembly::Rigid => {
            refuse_horizon(cx, file, at, model)
        }
        _ => Ok(()),
    }
}

/// Refuses a sensor whose rim would reach the speed of light, and cameras for which rotation is not defined.
fn refuse_rotation(
    cx: &Context,
    file: &file::Camera,
    at: &At<file::SensorRotation>,
    model: &CameraModel,
    rotation: &Rotation,
) -> Result<()> {
    if let (Some(motion), false) = (&file.motion, model.motion == Motion::Inertial) {
        let what =
            "a sensor can rotate only in a camera without acceleration, but this one accelerates";
        let help = "leave out [camera.rotation] or [camera.motion]";
        let other = (&motion.span, "the acceleration");
        return Err(cx.report.refuse_two(&at.span, other, what, help));
    }
    if model.sensor.is_some_and(|s| s.assembly == Assembly::Bell) {
        let what =
            "a sensor and a pinhole that accelerate alike on separate world lines cannot rotate";
        let help = "give assembly = \"rigid\" or \"world_length\", or leave out [camera.rotation]";
        return Err(cx.refuse(at, what, help));
    }
    let radius = swept_radius(model, rotation);
    let speed = rotation.rate.abs() * radius;
    if speed < 1.0 {
        return Ok(());
    }
    let rate = &at.value.rate;
    let what = format!(
        "the farthest corner of the sensor, {} m from the axis, would move at |ΩR| = {}, not \
         below the speed of light",
        number(radius),
        number(speed)
    );
    let largest = rate.value.scaled(BELOW / speed);
    Err(cx.refuse(rate, what, format!("the largest rate is {largest}")))
}

/// From the axis to the farthest corner of the sensor, metres; 0 for a point camera.
fn swept_radius(model: &CameraModel, rotation: &Rotation) -> f64 {
    let Some(corners) = model.sensor_corners() else {
        return 0.0;
    };
    let pivot = match rotation.through {
        Pivot::Pinhole => DVec3::ZERO,
        // About its middle, the mean of the four corners.
        Pivot::Sensor => corners.iter().sum::<DVec3>() * 0.25,
    };
    let radius = |&corner: &DVec3| (corner - pivot).cross(rotation.axis).length();
    corners.iter().map(radius).fold(0.0, f64::max)
}

/// A proper acceleration during the exposure beyond whose horizon one of `corners` lies.
fn exposed(model: &CameraModel, corners: &[DVec3]) -> Option<DVec3> {
    let end = model.time + model.shutter.map_or(0.0, |s| s.duration);
    let line = model.world_line().ok()?;
    line.beyond_horizon([model.time, end], corners)
}

/// Refuses a rigid sensor that reaches the horizon of its pinhole's acceleration.
fn refuse_horizon(
    cx: &Context,
    file: &file::Camera,
    at: &At<file::Sensor>,
    model: &CameraModel,
) -> Result<()> {
    // Those in the file, and those during the exposure, which other motions have as well.
    let accelerations = match &model.motion {
        Motion::Accelerated(a) => vec![*a],
        Motion::Segments(segments) => segments.iter().map(|s| s.acceleration).collect(),
        Motion::Profile { knots, .. } => knots.iter().map(|(_, a)| *a).collect(),
        Motion::Inertial
        | Motion::Keyframes(_)
        | Motion::Animation { .. }
        | Motion::Circular { .. } => Vec::new(),
    };
    let (Some(corners), Some(motion)) = (model.sensor_corners(), &file.motion) else {
        return Ok(());
    };
    // 1 + a·p is linear in p, so its minimum on a flat sensor is at a corner.
    let reaches = |a: &&DVec3| corners.iter().any(|&p| 1.0 + a.dot(p) <= 0.0);
    let in_file = accelerations.iter().find(reaches).copied();
    let Some(a) = in_file.or_else(|| exposed(model, &corners)) else {
        return Ok(());
    };
    let reach = match reaches(&&a) {
        true => "reaches farther",
        false => {
            "comes so near to that that it may reach farther at another moment of the exposure"
        }
    };
    let (a, length) = (a.length(), &at.value.focal_length);
    let what = format!(
        "at a proper acceleration of {} /m a rigid body ends {} m behind its pinhole, and this sensor \
         {reach}",
        number(a),
        number(1.0 / a)
    );
    let help = "give a shorter focal length, a weaker acceleration, or assembly = \"bell\"";
    let other = (&motion.span, "the acceleration");
    Err(cx.report.refuse_two(&length.span, other, what, help))
}
