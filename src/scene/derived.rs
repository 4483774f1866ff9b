//! What follows from a scene: conversions and frames.

use super::model::{CameraModel, Object, Scene};
use crate::spacetime::{Camera, Event, InertialFrame, Rest, World};

impl Scene {
    /// Seconds for a time of `metres` (ct), with the scene's speed of light.
    pub fn seconds_from_metres(&self, metres: f64) -> f64 {
        metres / self.speed_of_light
    }

    /// Metres (ct) for a time of `seconds`, with the scene's speed of light.
    pub fn metres_from_seconds(&self, seconds: f64) -> f64 {
        seconds * self.speed_of_light
    }
}

impl CameraModel {
    /// The camera's rest frame: its origin is the pinhole when the camera's clock shows 0.
    pub fn frame(&self) -> InertialFrame<Camera> {
        InertialFrame::new(self.velocity, self.origin)
    }

    /// The world event of the shot: the pinhole when the camera's clock shows [`CameraModel::time`].
    pub fn shot(&self) -> Event<World> {
        let pinhole = Event::new(self.time, glam::DVec3::ZERO);
        self.frame().event_to_world(pinhole)
    }
}

impl Object {
    /// The object's rest frame, in the coordinates that [`Object::transform`] leads to.
    pub fn frame(&self) -> InertialFrame<Rest> {
        InertialFrame::new(self.velocity, self.origin)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::scene::{Overrides, parse};

    const TEXT: &str = "\
speed_of_light = \"2 m/s\"
[camera]
eye = [1, 0, 0]
look_at = [1, 0, -1]
velocity = { beta = [0.6, 0, 0] }
clock_zero = \"3 m\"
time = \"4 m\"
[[object]]
shape = { sphere = { radius = 1 } }
";

    #[test]
    fn the_shot_is_on_the_cameras_world_line() {
        let scene = parse(TEXT, "test", Path::new(""), &Overrides::default()).unwrap();
        // γ = 5/4: after 4 m of proper time 5 m of world time and 0.6 · 5 m of path have passed.
        let shot = scene.camera.shot();
        assert!((shot.ct - 8.0).abs() < 1e-14);
        assert!((shot.x - glam::DVec3::X * 4.0).length() < 1e-14);
    }

    #[test]
    fn metres_become_seconds_with_the_scenes_own_speed_of_light() {
        let scene = parse(TEXT, "test", Path::new(""), &Overrides::default()).unwrap();
        assert_eq!(scene.seconds_from_metres(3.0), 1.5);
        assert_eq!(scene.metres_from_seconds(1.5), 3.0);
    }
}
