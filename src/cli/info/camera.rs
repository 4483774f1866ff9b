//! The camera of a scene file.

use glam::DVec3;
use nullray::camera::Camera;
use nullray::render::metadata;
use nullray::render::plan::motion;
use nullray::scene::model::{
    Assembly, CameraModel, Elements, Integration, Motion, Pivot, ProjectionKind, Records, Rotation,
    Scene, Shutter,
};
use nullray::spacetime::{Event, Velocity, World};
use serde_json::{Value, json};

use super::Info;

/// Adds the rows about the camera; lines without a label continue the one above.
pub fn rows(info: &mut Info, scene: &Scene) {
    let camera = &scene.camera;
    let [width, height] = camera.size;
    let (eye, forward) = (camera.origin.x, camera.axes[2]);
    info.row(
        "camera",
        format!(
            "{width} × {height} pixels, {} samples each, {:.2}° wide{}",
            scene.samples_per_pixel,
            horizontal_fov(scene).to_degrees(),
            projection(camera)
        ),
    );
    info.row("", at_zero(camera));
    info.row(
        "",
        format!(
            "at ({}, {}, {}) m when its clock shows 0, at world time {} m",
            eye.x, eye.y, eye.z, camera.origin.ct
        ),
    );
    info.row(
        "",
        format!(
            "looks along ({:.4}, {:.4}, {:.4}) in its own frame",
            forward.x, forward.y, forward.z
        ),
    );
    info.row("", exposure(camera));
    let more = [
        motion_text(&camera.motion),
        sensor(camera),
        camera.rotation.as_ref().map(rotation),
    ];
    let interval = camera.frame_interval;
    let interval = interval.map(|t| format!("frames are {t} m of its own time apart"));
    more.into_iter()
        .chain([interval])
        .flatten()
        .for_each(|text| info.row("", text));
}

/// The horizontal field of view in the camera's own frame at the shot; as in the scene if no picture can be taken then.
fn horizontal_fov(scene: &Scene) -> f64 {
    let model = &scene.camera;
    Camera::new(scene).map_or(model.horizontal_fov, |camera| camera.horizontal_fov(model))
}

/// The text for a camera that is not a single pinhole in front of a plane.
fn projection(camera: &CameraModel) -> String {
    let kind = match camera.projection {
        ProjectionKind::Perspective => "",
        ProjectionKind::FisheyeEquidistant => ", an equidistant fisheye",
        ProjectionKind::FisheyeEquisolid => ", an equisolid fisheye",
        ProjectionKind::FisheyeOrthographic => ", an orthographic fisheye",
        ProjectionKind::Equirectangular => ", an equirectangular panorama",
    };
    match camera.stereo {
        None => kind.into(),
        Some(stereo) => {
            let distance = stereo.interpupillary_distance;
            format!("{kind}, a stereo pair with pupils {distance} m apart")
        }
    }
}

fn at_zero(camera: &CameraModel) -> String {
    let velocity = moving(camera.velocity);
    match camera.motion {
        Motion::Inertial => velocity,
        _ => format!("{velocity} when its clock shows 0"),
    }
}

fn exposure(camera: &CameraModel) -> String {
    let time = camera.time;
    let Some(Shutter {
        duration,
        records,
        integration,
    }) = camera.shutter
    else {
        return format!("the shot is at {time} m of its own time");
    };
    let records = match records {
        Records::Mean => "the mean",
        Records::Energy => "the integral",
    };
    let integration = match integration {
        Integration::Moments => "",
        Integration::Means => ", of cubes by means over the parts of the exposure",
    };
    let end = time + duration;
    format!(
        "the shutter is open from {time} m to {end} m of its own time; records {records}{integration}"
    )
}

/// How the camera moves later; `None` without acceleration.
fn motion_text(motion: &Motion) -> Option<String> {
    Some(match motion {
        Motion::Inertial => return None,
        Motion::Accelerated(a) => format!(
            "accelerates for ever at ({}, {}, {}) /m, as felt on board",
            a.x, a.y, a.z
        ),
        Motion::Segments(segments) => {
            let end: f64 = segments.iter().map(|s| s.duration).sum();
            // A last segment without a duration never ends: it is infinite.
            let last = match end.is_finite() {
                true => format!("to {end} m, and coasts then"),
                false => "on, for ever".into(),
            };
            format!(
                "accelerates in {} segments from 0 m of its own time {last}",
                segments.len()
            )
        }
        Motion::Profile { knots, .. } => {
            let time = |knot: Option<&(f64, DVec3)>| knot.map_or(0.0, |(time, _)| *time);
            let (first, last) = (time(knots.first()), time(knots.last()));
            let count = knots.len();
            format!(
                "accelerates by a profile of {count} times, from {first} m to {last} m of its own"
            )
        }
        Motion::Keyframes(events) | Motion::Animation { events, .. } => {
            let time = |event: Option<&Event<World>>| event.map_or(0.0, |event| event.ct);
            let (first, last) = (time(events.first()), time(events.last()));
            let rests = match motion {
                Motion::Animation { .. } => "; it rests before and after",
                _ => "",
            };
            format!(
                "goes through {} keyframes, from {first} m to {last} m of world time{rests}",
                events.len()
            )
        }
        Motion::Circular { centre, axis, rate } => format!(
            "circles ({}, {}, {}) m about the axis ({}, {}, {}) at {rate} rad per metre of world time",
            centre.x, centre.y, centre.z, axis.x, axis.y, axis.z
        ),
    })
}

fn sensor(camera: &CameraModel) -> Option<String> {
    let (sensor, [x, y]) = (camera.sensor?, camera.sensor_half_size()?);
    let how = match sensor.assembly {
        Assembly::Rigid => "in its own frame (rigid)",
        Assembly::WorldLength => "as measured in the world",
        Assembly::Bell => "in the world, accelerating like it (Bell)",
    };
    let (width, height, length) = (2.0 * x, 2.0 * y, sensor.focal_length);
    Some(format!(
        "sensor of {width:.6} × {height:.6} m, {length} m behind the pinhole {how}"
    ))
}

fn rotation(rotation: &Rotation) -> String {
    let Rotation { axis, rate, .. } = rotation;
    let through = match rotation.through {
        Pivot::Pinhole => "the pinhole",
        Pivot::Sensor => "the sensor's centre",
    };
    let elements = match rotation.elements {
        Elements::Exact => "",
        Elements::Comoving => "; elements with pinholes of their own (comoving)",
        Elements::Aberrated => "; elements with pinholes of their own (aberrated)",
    };
    format!(
        "turns at {rate} rad per metre of its own time about ({:.4}, {:.4}, {:.4}) through {through}{elements}",
        axis.x, axis.y, axis.z
    )
}

pub fn moving(velocity: Velocity) -> String {
    motion(velocity.beta().to_array(), velocity.gamma())
}

/// A velocity as data.
pub fn velocity(velocity: Velocity) -> Value {
    json!({ "beta": velocity.beta().to_array(), "gamma": velocity.gamma() })
}

/// The camera as data: times in metres, in its own time unless the name says otherwise.
pub fn data(scene: &Scene) -> Value {
    let camera = &scene.camera;
    json!({
        "size": camera.size,
        "projection": camera.projection.name(),
        "interpupillary_distance": camera.stereo.map(|stereo| stereo.interpupillary_distance),
        "horizontal_fov_rad": horizontal_fov(scene),
        "velocity": velocity(camera.velocity),
        "eye": camera.origin.x.to_array(),
        "clock_zero": camera.origin.ct,
        "time": camera.time,
        "motion": motion_data(&camera.motion),
        "sensor": camera.sensor.zip(camera.sensor_half_size()).map(|(sensor, [x, y])| json!({
            "focal_length": sensor.focal_length,
            "size": [2.0 * x, 2.0 * y],
            "assembly": metadata::assembly(sensor.assembly),
        })),
        "rotation": camera.rotation.map(|rotation| json!({
            "axis": rotation.axis.to_array(),
            "rate_rad_per_m": rotation.rate,
            "through": metadata::pivot(rotation.through),
            "elements": metadata::elements(rotation.elements),
        })),
        "shutter": camera.shutter.map(|shutter| json!({
            "duration": shutter.duration,
            "records": metadata::records(shutter.records),
            "integration": metadata::integration(shutter.integration),
        })),
        "frame_interval": camera.frame_interval,
    })
}

/// The motion as data; an endless duration is null.
fn motion_data(motion: &Motion) -> Value {
    let kind = metadata::motion(motion);
    match motion {
        Motion::Inertial => json!({ "kind": kind }),
        Motion::Accelerated(a) => json!({ "kind": kind, "proper_per_m": a.to_array() }),
        Motion::Segments(segments) => {
            let entries = segments.iter().map(
                |s| json!({ "duration": s.duration, "proper_per_m": s.acceleration.to_array() }),
            );
            json!({ "kind": kind, "segments": entries.collect::<Vec<_>>() })
        }
        Motion::Profile { knots, axes } => {
            let entries = knots
                .iter()
                .map(|(time, a)| json!({ "time": time, "proper_per_m": a.to_array() }));
            json!({ "kind": kind, "axes": axes, "knots": entries.collect::<Vec<_>>() })
        }
        Motion::Keyframes(events) | Motion::Animation { events, .. } => {
            let entries = events
                .iter()
                .map(|e| json!({ "world_time": e.ct, "position": e.x.to_array() }));
            json!({ "kind": kind, "keyframes": entries.collect::<Vec<_>>() })
        }
        Motion::Circular { centre, axis, rate } => json!({
            "kind": kind,
            "centre": centre.to_array(),
            "axis": axis.to_array(),
            "rate_rad_per_m_of_world_time": rate,
        }),
    }
}
