//! World lines of the scene's camera and objects.

use crate::figures::diagram::model::{Reference, Track};
use crate::scene::{CameraMotion, Kinematics, ObjectMotion};
use crate::spacetime::worldline::WorldLine;

/// The world line of this name.
pub(super) fn track(scene: &Kinematics, name: &str) -> Option<Track> {
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
    let body = scene.objects.iter().find(|body| body.name == name)?;
    Some(object_track(body))
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
