//! Cameras: from a point on the film to an event and a null ray of the world.
//!
//! A rigid pinhole camera whose rays all leave one event. In the camera frame the film point (x, y),
//! in pixels from the top left corner, looks along
//!
//! ```text
//! d′ ∝ forward + (2x/width − 1) t right + (1 − 2y/height) t (height/width) up,   t = tan(fov/2),
//! ```
//!
//! which the boost turns into the world's look direction d and the wavelength ratio W of a source at
//! rest in the world. What a camera does not need is not in its type: a camera at rest has no boost.

use glam::DVec3;

use crate::scene::model::CameraModel;
use crate::spacetime::{Boost, Camera, Direction, Event, InertialFrame, World};

/// The film of a pinhole camera in the camera frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinhole {
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    size: [f64; 2],
    /// 1 / size.
    pixel: [f64; 2],
}

impl Pinhole {
    /// The pinhole of `model`: axes scaled so that film coordinates in pixels address them.
    pub fn new(model: &CameraModel) -> Self {
        let [right, up, forward] = model.axes;
        let [width, height] = model.size.map(f64::from);
        let t = libm::tan(0.5 * model.horizontal_fov);
        Pinhole {
            forward,
            right: right * t,
            up: up * (t * height / width),
            size: [width, height],
            pixel: [1.0 / width, 1.0 / height],
        }
    }

    /// The camera-frame look direction at film point `(x, y)`, pixels.
    #[inline(always)]
    pub fn direction(&self, x: f64, y: f64) -> Direction<Camera> {
        let [width, height] = self.size;
        let d = self.forward
            + self.right * ((2.0 * x - width) * self.pixel[0])
            + self.up * ((height - 2.0 * y) * self.pixel[1]);
        // Divisions are what this costs: one does for three components.
        Direction::from_unit(d * (1.0 / d.length()))
    }
}

/// A camera at the moment of its shot.
#[derive(Debug, Clone)]
pub struct Shot {
    /// The film.
    pub pinhole: Pinhole,
    /// The camera's inertial frame.
    pub frame: InertialFrame<Camera>,
    /// The event from which every ray leaves, into the past.
    pub event: Event<World>,
}

impl Shot {
    /// The shot that `model` takes at its proper time `model.time`.
    pub fn new(model: &CameraModel) -> Self {
        let frame = InertialFrame::new(model.velocity, model.origin);
        let event = frame.event_to_world(Event::new(model.time, DVec3::ZERO));
        Shot {
            pinhole: Pinhole::new(model),
            frame,
            event,
        }
    }
}

/// What one film point sees along: the look direction in the world and W for a source at rest there.
pub trait View: Sync {
    /// The world look direction and the wavelength ratio at film point `(x, y)`, pixels.
    fn look(&self, x: f64, y: f64) -> (Direction<World>, f64);

    /// The look direction in the camera frame at film point `(x, y)`.
    fn pinhole(&self) -> &Pinhole;
}

/// A camera at rest in the world: no boost.
#[derive(Debug)]
pub struct Still(pub Pinhole);

/// A moving camera.
#[derive(Debug)]
pub struct Moving {
    pinhole: Pinhole,
    world_from_camera: Boost<World, Camera>,
}

/// A moving camera with aberration turned off: directions of the camera frame are taken as the
/// world's; W is that of the true direction.
#[derive(Debug)]
pub struct Unaberrated(pub Moving);

impl Moving {
    /// The view of a moving shot.
    pub fn new(shot: &Shot) -> Self {
        Moving {
            pinhole: shot.pinhole.clone(),
            world_from_camera: *shot.frame.world_from_frame(),
        }
    }
}

impl View for Still {
    #[inline(always)]
    fn look(&self, x: f64, y: f64) -> (Direction<World>, f64) {
        (Direction::from_unit(self.0.direction(x, y).unit()), 1.0)
    }

    fn pinhole(&self) -> &Pinhole {
        &self.0
    }
}

impl View for Moving {
    #[inline(always)]
    fn look(&self, x: f64, y: f64) -> (Direction<World>, f64) {
        self.world_from_camera
            .direction(self.pinhole.direction(x, y))
    }

    fn pinhole(&self) -> &Pinhole {
        &self.pinhole
    }
}

impl View for Unaberrated {
    #[inline(always)]
    fn look(&self, x: f64, y: f64) -> (Direction<World>, f64) {
        let seen = self.0.pinhole.direction(x, y);
        let (_, ratio) = self.0.world_from_camera.direction(seen);
        (Direction::from_unit(seen.unit()), ratio)
    }

    fn pinhole(&self) -> &Pinhole {
        &self.0.pinhole
    }
}
