//! A camera by the equations of Jarabo et al. 2015, approximations included.
//!
//! All light passes the pinhole at the camera time t′ of the picture. Directions are those of special relativity, W is its Doppler factor
//! D, and
//!
//! ```text
//! emission time  t = t′/γ − η z′,     z′ = z √(sin²θ + cos²θ/γ²)                    (Eqs. 3, 11)
//! ```
//!
//! for a point at world distance z, where θ is the angle between the light and the motion: a ray whose clock is set to t′/γ when it
//! leaves, with a shortened delay. For an accelerating camera, Eq. 15 gives the world time in place of t′/γ. Field of view: Eq. 4 for a
//! focal length that is fixed in the world; d′ of Eq. 16 for a sensor and a pinhole that accelerate alike. An exposure T′ lasts T′/D in
//! each direction (Eqs. 10, 11) but sums over camera time. Lines scale with D⁻⁵.

use super::any_projection::AnyProjection;
use super::inertial::ExposureTime;
use super::projection::Projection;
use super::{CameraRay, RayOrigin, Shot, View};
use crate::scene::model::{Assembly, CameraModel, Motion};
use crate::spacetime::{Boost, CameraFrame, Direction, Displacement, World, paper2015};
use glam::DVec3;

/// A camera by the equations of Jarabo et al. 2015.
#[derive(Debug)]
pub struct Paper {
    film: AnyProjection,
    world_from_camera: Boost<World, CameraFrame>,
    beta: DVec3,
    gamma: f64,
    /// World time by Eq. 11 minus that of the shot.
    early: f64,
    exposure: ExposureTime,
    aberration: bool,
}

impl Paper {
    /// The view of `model`, taken at `shot`.
    pub fn new(model: &CameraModel, shot: &Shot, aberration: bool) -> Self {
        let velocity = shot.frame.velocity();
        let (beta, gamma) = (velocity.beta(), velocity.gamma());
        let inertial = model.motion == Motion::Inertial;
        Paper {
            film: shot.projection.stretched(stretch(model, shot)),
            world_from_camera: *shot.frame.world_from_frame(),
            beta,
            gamma,
            // Eq. 11 starts the clock at t′/γ; for an accelerating camera, Eq. 15 gives the world time of the shot itself.
            early: match inertial {
                true => model.origin.ct + model.time / gamma - shot.event.ct,
                false => 0.0,
            },
            exposure: ExposureTime::of(model),
            aberration,
        }
    }
}

/// The focal length in the camera's frame over that in the world's.
fn stretch(model: &CameraModel, shot: &Shot) -> f64 {
    let Some(sensor) = model.sensor else {
        return 1.0;
    };
    let (_, rapidity) = shot.frame.velocity().split();
    let (speed, gamma) = (libm::tanh(rapidity), libm::cosh(rapidity));
    let d = sensor.focal_length;
    match (sensor.assembly, acceleration(model)) {
        (Assembly::Rigid, _) => 1.0,
        // Eq. 16, and γd as in Eq. 4 without acceleration.
        (Assembly::Bell, g) if g != 0.0 => paper2015::comoving_separation(g, d, speed) / d,
        (Assembly::WorldLength | Assembly::Bell, _) => gamma,
    }
}

/// The proper acceleration at the model's time, 1/m: constant at all times, or from time 0 on.
fn acceleration(model: &CameraModel) -> f64 {
    match &model.motion {
        Motion::Accelerated(a) => a.length(),
        Motion::Segments(segments) if model.time >= 0.0 => segments
            .first()
            .map_or(0.0, |segment| segment.acceleration.length()),
        Motion::Segments(_)
        | Motion::Inertial
        | Motion::Profile { .. }
        | Motion::Keyframes(_)
        | Motion::Animation { .. }
        | Motion::Circular { .. } => 0.0,
    }
}

impl View for Paper {
    const SHARED_ORIGIN: bool = false;

    #[inline]
    fn uses_time(&self) -> bool {
        self.exposure.duration > 0.0
    }

    #[inline]
    fn film(&self) -> &AnyProjection {
        &self.film
    }

    #[inline]
    fn ray_through<P: Projection>(&self, film: &P, x: f64, y: f64, moment: f64) -> CameraRay {
        let seen = film.direction(x, y);
        let (d, doppler) = self.world_from_camera.direction(seen);
        let along = self.beta.dot(d.unit());
        // Eqs. 10, 11: the interval is T′/D, and dt′ stays.
        let weight = self.exposure.weight_at(film, x, y);
        let (since, weight) = match self.exposure.duration > 0.0 {
            true => (moment * self.exposure.duration / doppler, weight / doppler),
            false => (0.0, weight),
        };
        // The clock at t′/γ; the camera has moved with γβ meanwhile.
        let displacement = Displacement::new(
            self.early + since / self.gamma,
            self.beta * (self.gamma * since),
        );
        CameraRay {
            d: if self.aberration {
                d
            } else {
                Direction::from_unit(seen.unit())
            },
            ratio: doppler,
            origin: RayOrigin {
                displacement,
                // z′/z of Eq. 3: sin²θ + cos²θ/γ² = 1 − β² cos²θ.
                delay: (1.0 - along * along).sqrt(),
                weight,
            },
        }
    }
}
