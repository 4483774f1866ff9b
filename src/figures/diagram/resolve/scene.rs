//! World lines of the scene's camera, objects, lamps and pulses.

use crate::figures::diagram::model::{Reference, Track};
use crate::scene::{CameraMotion, Kinematics, ObjectMotion};
use crate::spacetime::Velocity;
use crate::spacetime::worldline::WorldLine;

/// The world line of the camera or its sensor.
pub(super) fn camera(scene: &Kinematics, name: &str) -> Option<Track> {
    if let Some(camera) = &scene.camera {
        match (name, camera.model.sensor) {
            ("camera" | "pinhole", _) => return Some(camera.line.clone().into()),
            ("sensor", Some(sensor)) => {
                let forward = camera.model.axes[2];
                return Some(Track::sensor(camera.line.clone(), sensor, forward));
            }
            _ => {}
        }
    }
    None
}

/// The world lines of this name: that of the camera or its sensor, or else those of objects, lamps and pulses.
pub(super) fn tracks(scene: &Kinematics, name: &str) -> Vec<Track> {
    if let Some(track) = camera(scene, name) {
        return vec![track];
    }
    let objects = scene.objects.iter().filter(|body| body.name == name);
    let lamps = scene.lamps.iter().filter(|(known, _)| known == name);
    let pulses = scene.pulses.iter().filter(|(known, _)| known == name);
    let lines = lamps.map(|(_, line)| line.clone());
    let rest = pulses.map(|(_, event)| WorldLine::inertial(Velocity::REST, *event));
    let lines = lines.chain(rest).map(Track::from);
    objects.map(object_track).chain(lines).collect()
}

/// The world line of an object.
pub(super) fn object_track(object: &ObjectMotion) -> Track {
    WorldLine::inertial(object.velocity, object.origin).into()
}

/// The frame of the camera at the time of the shot.
pub(super) fn camera_frame(camera: &CameraMotion) -> Option<Reference> {
    let moment = Track::from(camera.line.clone()).at(camera.model.time)?;
    Some(Reference::bare("camera", moment.frame()))
}
