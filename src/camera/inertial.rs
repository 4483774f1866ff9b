//! Cameras without acceleration that have a sensor, a shutter, or both, or film points that see nothing.
//!
//! In the camera frame sensor and pinhole rest. The element at −f D, exposed at camera time t, gets
//! light that passed the pinhole at t − f|D| and came along D/|D|. The pinhole's event moves along its
//! four-velocity u = (γ, γβ): relative to the shot it is
//!
//! ```text
//! P = (t − t_shot − f |D|) u.
//! ```
//!
//! A focal length f that is fixed in the world is, in the camera's own frame,
//!
//! ```text
//! f′ = f / √(1 − β² cos²α) = γ f / √(1 + γ²β² sin²α),     α the angle between forward axis and motion
//! ```
//!
//! because the component along the motion of a rod f′ on the forward axis is contracted. It is γf along the motion (Jarabo et al. 2015,
//! before Eq. 4) and f across it. Without a sensor f is 0.

use glam::DVec3;

use super::any_projection::AnyProjection;
use super::projection::Projection;
use super::rays::{RayBlock, SimpleRays};
use super::{CameraRay, FilmPoints, RayOrigin, RaySlices, Shot, View};
use crate::accel::vectors::{BLOCK, Block};
use crate::scene::model::{CameraModel, Records};
use crate::spacetime::{Boost, CameraFrame, Direction, Displacement, World};

/// A camera without acceleration that has a sensor, a shutter, or both, or film points that see nothing.
#[derive(Debug)]
pub struct Inertial {
    film: AnyProjection,
    world_from_camera: Boost<World, CameraFrame>,
    /// The pinhole's displacement per metre of camera time.
    four_velocity: Displacement<World>,
    focal_length: f64,
    exposure: ExposureTime,
    aberration: bool,
}

/// The exposure time of a camera, and the weight of its samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct ExposureTime {
    /// Camera time, metres; 0 for an instant.
    pub duration: f64,
    pub weight: f64,
}

impl ExposureTime {
    /// The exposure of `model`.
    pub fn of(model: &CameraModel) -> Self {
        let Some(shutter) = model.shutter else {
            return ExposureTime {
                duration: 0.0,
                weight: 1.0,
            };
        };
        ExposureTime {
            duration: shutter.duration,
            weight: match shutter.records {
                Records::Mean => 1.0,
                // Energy is the mean radiance times the duration.
                Records::Energy => shutter.duration,
            },
        }
    }
}

impl ExposureTime {
    /// The weight of a sample at film point `(x, y)` of `film`: 0 if that sees nothing.
    #[inline(always)]
    pub fn weight_at<P: Projection>(&self, film: &P, x: f64, y: f64) -> f64 {
        if film.sees(x, y) { self.weight } else { 0.0 }
    }
}

impl Inertial {
    /// The view of `model`, whose shutter opens at `shot`.
    pub fn new(model: &CameraModel, shot: &Shot, aberration: bool) -> Self {
        let (film, focal_length) = match model.sensor {
            None => (shot.projection.clone(), 0.0),
            Some(sensor) => {
                let velocity = shot.frame.velocity();
                let own = sensor.own_focal_length(shot.projection.forward(), velocity);
                // The sensor keeps its size, so a longer focal length narrows the view.
                (shot.projection.stretched(own / sensor.focal_length), own)
            }
        };
        let world_from_camera = *shot.frame.world_from_frame();
        Inertial {
            film,
            world_from_camera,
            four_velocity: world_from_camera.displacement(Displacement::new(1.0, DVec3::ZERO)),
            focal_length,
            exposure: ExposureTime::of(model),
            aberration,
        }
    }
}

impl Inertial {
    /// Whether all rays leave one event: with neither a sensor nor a shutter.
    pub(super) fn is_point(&self) -> bool {
        self.focal_length == 0.0 && self.exposure.duration == 0.0
    }

    /// Whether the camera rests in the world.
    pub(super) fn rests(&self) -> bool {
        self.four_velocity.x == DVec3::ZERO
    }

    /// Whether directions are boosted.
    pub(super) fn aberration(&self) -> bool {
        self.aberration
    }
}

impl View for Inertial {
    const SHARED_ORIGIN: bool = false;

    #[inline]
    fn uses_time(&self) -> bool {
        self.exposure.duration > 0.0
    }

    #[inline]
    fn film(&self) -> &AnyProjection {
        &self.film
    }

    #[inline(always)]
    fn ray_through<P: Projection>(&self, film: &P, x: f64, y: f64, moment: f64) -> CameraRay {
        let (seen, length) = film.direction_and_length(x, y);
        let (d, ratio) = self.world_from_camera.direction(seen);
        let d = if self.aberration {
            d
        } else {
            Direction::from_unit(seen.unit())
        };
        // Camera time of the passage through the pinhole, after the shot: t − f |D|.
        let since = moment * self.exposure.duration - self.focal_length * length;
        CameraRay {
            d,
            ratio,
            origin: RayOrigin {
                displacement: self.four_velocity * since,
                delay: 1.0,
                weight: self.exposure.weight_at(film, x, y),
            },
        }
    }

    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, points: &FilmPoints, mut rays: RaySlices) {
        rays.fill_by(self, self, film, points);
    }
}

impl SimpleRays for Inertial {
    #[inline(always)]
    fn rays<P: Projection>(
        &self,
        film: &P,
        [x, y]: [&Block; 2],
        moments: &Block,
        to: &mut RayBlock,
    ) {
        let (duration, focal_length) = (self.exposure.duration, self.focal_length);
        let mut lengths = [0.0; BLOCK];
        film.directions_and_lengths([x, y], to.d.axes_mut(), &mut lengths);
        for k in 0..BLOCK {
            // t − f |D|, kept in `ct` until it multiplies the four-velocity below.
            to.ct[k] = moments[k] * duration - focal_length * lengths[k];
        }
        to.look(&self.world_from_camera, self.aberration);
        let (four_velocity, exposure) = (self.four_velocity, self.exposure);
        for k in 0..BLOCK {
            to.set_place(k, four_velocity * to.ct[k]);
            to.weight[k] = exposure.weight_at(film, x[k], y[k]);
        }
    }
}
