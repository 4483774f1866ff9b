//! A camera on the bench: the parts of a scene that a test sets up by hand.

use std::path::Path;

use glam::DVec3;
use nullray::camera::{Camera, CameraRay};
use nullray::scene::model::{Assembly, Motion, Scene, Sensor};
use nullray::scene::{self, Overrides};
use nullray::spacetime::worldline::Segment;

/// A scene whose film is 2 × 2 pixels wide and 90° across: half the film is one focal length.
pub fn scene() -> Scene {
    let text = "\
camera = { eye = [0, 0, 0], look_at = [0, 0, -1], size = [2, 2], hfov = \"90 deg\" }
object = [{ shape = { sphere = { radius = 1 } } }]
";
    scene::parse(text, "bench", Path::new(""), &Overrides::default()).unwrap()
}

/// The same with a camera that looks along +z, with +y up.
pub fn looking_along_z() -> Scene {
    let mut scene = scene();
    scene.camera.axes = [DVec3::NEG_X, DVec3::Y, DVec3::Z];
    scene
}

pub fn sensor(focal_length: f64, assembly: Assembly) -> Option<Sensor> {
    Some(Sensor {
        focal_length,
        assembly,
    })
}

/// At rest before the clock shows 0, then accelerating for ever.
pub fn start(acceleration: DVec3) -> Motion {
    Motion::Segments(vec![Segment {
        duration: f64::INFINITY,
        acceleration,
    }])
}

/// What the sensor element at (px, py) across sees, seen from behind a camera that looks along +z.
pub fn element(scene: &Scene, px: f64, py: f64) -> (Camera, CameraRay) {
    let f = scene.camera.sensor.unwrap().focal_length;
    let camera = Camera::new(scene).unwrap();
    let ray = camera.view.ray(1.0 + px / f, 1.0 + py / f, 0.0);
    (camera, ray)
}
