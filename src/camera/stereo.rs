//! Stereo pairs: two pinholes side by side, one picture beside the other.
//!
//! The two pinholes rest in the camera frame at ±(d/2) to the right of the middle between them, where d is the interpupillary distance,
//! and take their pictures at the same camera time. With Λ the boost from the camera frame, their events relative to the shot are
//!
//! ```text
//! P = Λ (0, ±(d/2) right),
//! ```
//!
//! simultaneous for the camera but, if it moves along `right`, not for the world. Both have the same, parallel axes. The left half of the
//! film is what the left eye sees.

use glam::DVec3;

use super::any_projection::AnyProjection;
use super::projection::Projection;
use super::rays::{RayBlock, SimpleRays};
use super::{CameraRay, FilmPoints, Inertial, RaySlices, Shot, View};
use crate::accel::vectors::{BLOCK, Block};
use crate::scene::model::CameraModel;
use crate::spacetime::{Displacement, World};

/// A pair of cameras without acceleration, or at a moment at which they do not accelerate apart.
#[derive(Debug)]
pub struct Stereo {
    /// The view of either eye, from the middle between them; its film is half the picture.
    eye: Inertial,
    /// Columns of half the picture.
    half: f64,
    /// From the middle to the right eye's pinhole.
    offset: Displacement<World>,
}

impl Stereo {
    /// The view of `model`, whose pupils are `distance` metres apart; its shutter opens at `shot`.
    pub fn new(model: &CameraModel, distance: f64, shot: &Shot, aberration: bool) -> Self {
        let right = shot.projection.axes()[0];
        // To the right pupil; the left one is at the opposite offset.
        let offset = Displacement::new(0.0, right * (0.5 * distance));
        let world_from_camera = shot.frame.world_from_frame();
        Stereo {
            eye: Inertial::new(model, shot, aberration),
            // The projection is that of one eye, half as wide as the picture.
            half: shot.projection.size()[0],
            offset: match distance > 0.0 {
                true => world_from_camera.displacement(offset),
                false => Displacement::new(0.0, DVec3::ZERO),
            },
        }
    }
}

impl Stereo {
    /// The column of an eye's film that is column `x` of the picture (either half of the picture is an eye's whole film), and the side of
    /// that eye.
    #[inline(always)]
    fn of_eye(&self, x: f64) -> (f64, f64) {
        let is_left = x < self.half;
        (
            if is_left { x } else { x - self.half },
            if is_left { -1.0 } else { 1.0 },
        )
    }
}

impl View for Stereo {
    const SHARED_ORIGIN: bool = false;

    #[inline]
    fn uses_time(&self) -> bool {
        self.eye.uses_time()
    }

    #[inline]
    fn film(&self) -> &AnyProjection {
        self.eye.film()
    }

    #[inline]
    fn ray_through<P: Projection>(&self, film: &P, x: f64, y: f64, moment: f64) -> CameraRay {
        let (x, side) = self.of_eye(x);
        let mut ray = self.eye.ray_through(film, x, y, moment);
        ray.origin.displacement = ray.origin.displacement + self.offset * side;
        ray
    }

    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, points: &FilmPoints, mut rays: RaySlices) {
        rays.fill_by(self, self, film, points);
    }
}

impl SimpleRays for Stereo {
    #[inline(always)]
    fn rays<P: Projection>(
        &self,
        film: &P,
        [x, y]: [&Block; 2],
        moments: &Block,
        to: &mut RayBlock,
    ) {
        let (mut in_half, mut sides) = ([0.0; BLOCK], [0.0; BLOCK]);
        for k in 0..BLOCK {
            (in_half[k], sides[k]) = self.of_eye(x[k]);
        }
        SimpleRays::rays(&self.eye, film, [&in_half, y], moments, to);
        let offset = self.offset;
        for (k, side) in sides.into_iter().enumerate() {
            to.set_place(k, to.place(k) + offset * side);
        }
    }
}
