//! Where the camera moves in its own picture.
//!
//! Boosts are rotation-free, and light that comes from straight ahead or behind is not aberrated: the
//! direction n of the velocity has the same components in the world and in the camera frame. In the
//! picture it is at the film point whose vector D is along n (see [`Pinhole`](crate::camera::Pinhole)):
//!
//! ```text
//! x = w/2 (1 + (n·right)/(n·forward t)),    y = h/2 − w/2 (n·up)/(n·forward t),    n·forward > 0.
//! ```

use glam::DVec3;

use crate::camera::{Pinhole, Shot};
use crate::scene::model::{CameraModel, Motion};
use crate::spacetime::Velocity;

/// The camera's velocity in its picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pointer {
    /// Where it points.
    pub target: Target,
    /// In the world.
    pub velocity: Velocity,
}

/// Where a direction is in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// At this film point, pixels: the camera moves towards what is seen there.
    Ahead([f64; 2]),
    /// Its opposite is at this film point, pixels: the camera moves away from what is seen there.
    Behind([f64; 2]),
    /// Both are outside of the picture: it lies that way from the middle. A unit vector, y down.
    Outside([f64; 2]),
}

impl Pointer {
    /// That of a picture of this size and half-width (tangent); none for a camera at rest.
    pub(super) fn of(shot: &Shot, size: [u32; 2], half_width: f64) -> Option<Pointer> {
        let velocity = shot.frame.velocity();
        let n = velocity.rapidity().try_normalize()?;
        let film = Film::new(&shot.pinhole, size.map(f64::from), half_width);
        Some(Pointer {
            target: film.target(n),
            velocity,
        })
    }
}

/// The tangent of half the field of view of a camera at its shot; narrower for a focal length that
/// motion stretches.
pub(super) fn half_width(model: &CameraModel, shot: &Shot) -> f64 {
    let t = libm::tan(0.5 * model.horizontal_fov);
    match model.sensor {
        Some(sensor) if model.motion == Motion::Inertial => {
            let velocity = shot.frame.velocity();
            let own = sensor.own_focal_length(shot.pinhole.forward(), velocity);
            t * sensor.focal_length / own
        }
        _ => t,
    }
}

/// The axes of a film, unit vectors, and what a pixel is.
struct Film {
    axes: [DVec3; 3],
    size: [f64; 2],
    /// The focal length in pixels.
    focal: f64,
}

impl Film {
    fn new(pinhole: &Pinhole, size: [f64; 2], half_width: f64) -> Film {
        let origin = pinhole.vector(0.0, 0.0);
        let step = |x, y| (pinhole.vector(x, y) - origin).normalize_or_zero();
        Film {
            axes: [step(size[0], 0.0), step(0.0, size[1]), pinhole.forward()],
            size,
            focal: 0.5 * size[0] / half_width,
        }
    }

    fn target(&self, n: DVec3) -> Target {
        let [x, y, z] = self.axes.map(|axis| axis.dot(n));
        let at = [
            0.5 * self.size[0] + self.focal * x / z,
            0.5 * self.size[1] + self.focal * y / z,
        ];
        let is_seen = z != 0.0 && (0..2).all(|axis| (0.0..=self.size[axis]).contains(&at[axis]));
        match (is_seen, z > 0.0) {
            (true, true) => Target::Ahead(at),
            (true, false) => Target::Behind(at),
            // Not both 0, as the middle is seen.
            (false, _) => Target::Outside([x / x.hypot(y), y / x.hypot(y)]),
        }
    }
}
