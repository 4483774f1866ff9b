//! Point cameras at one moment: all rays leave one event.

use super::any_projection::AnyProjection;
use super::projection::Projection;
use super::{CameraRay, FilmPoints, RayOrigin, RaySlices, Shot, View};
use crate::spacetime::{Boost, CameraFrame, Direction, World};

/// A camera at rest in the world: no boost.
#[derive(Debug)]
pub struct Still(pub AnyProjection);

/// A moving camera.
#[derive(Debug)]
pub struct Moving {
    film: AnyProjection,
    world_from_camera: Boost<World, CameraFrame>,
}

/// A moving camera without aberration: directions of the camera frame are used as the world's; W is that of the true direction.
#[derive(Debug)]
pub struct Unaberrated(pub Moving);

impl Moving {
    /// The view of a moving shot.
    pub fn new(shot: &Shot) -> Self {
        Moving {
            film: shot.projection.clone(),
            world_from_camera: *shot.frame.world_from_frame(),
        }
    }
}

impl View for Still {
    const SHARED_ORIGIN: bool = true;

    #[inline]
    fn uses_time(&self) -> bool {
        false
    }

    #[inline]
    fn film(&self) -> &AnyProjection {
        &self.0
    }

    #[inline(always)]
    fn ray_through<P: Projection>(&self, film: &P, x: f64, y: f64, _: f64) -> CameraRay {
        CameraRay {
            d: Direction::from_unit(film.direction(x, y).unit()),
            ratio: 1.0,
            origin: RayOrigin::AT_SHOT,
        }
    }

    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, points: &FilmPoints, mut rays: RaySlices) {
        rays.fill_from_point(film, points, None);
    }
}

impl View for Moving {
    const SHARED_ORIGIN: bool = true;

    #[inline]
    fn uses_time(&self) -> bool {
        false
    }

    #[inline]
    fn film(&self) -> &AnyProjection {
        &self.film
    }

    #[inline(always)]
    fn ray_through<P: Projection>(&self, film: &P, x: f64, y: f64, _: f64) -> CameraRay {
        let seen = film.direction(x, y);
        let (d, ratio) = self.world_from_camera.direction(seen);
        CameraRay {
            d,
            ratio,
            origin: RayOrigin::AT_SHOT,
        }
    }

    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, points: &FilmPoints, mut rays: RaySlices) {
        rays.fill_from_point(film, points, Some(&self.world_from_camera));
    }
}

impl View for Unaberrated {
    const SHARED_ORIGIN: bool = true;

    #[inline]
    fn uses_time(&self) -> bool {
        false
    }

    #[inline]
    fn film(&self) -> &AnyProjection {
        &self.0.film
    }

    #[inline(always)]
    fn ray_through<P: Projection>(&self, film: &P, x: f64, y: f64, _: f64) -> CameraRay {
        let seen = film.direction(x, y);
        let (_, ratio) = self.0.world_from_camera.direction(seen);
        CameraRay {
            d: Direction::from_unit(seen.unit()),
            ratio,
            origin: RayOrigin::AT_SHOT,
        }
    }
}

/// Any point view, matched at each ray: for code that is not worth compiling three times.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs)]
pub enum Point<'a> {
    Still(&'a Still),
    Moving(&'a Moving),
    Unaberrated(&'a Unaberrated),
}

impl View for Point<'_> {
    const SHARED_ORIGIN: bool = true;

    #[inline]
    fn uses_time(&self) -> bool {
        false
    }

    #[inline]
    fn film(&self) -> &AnyProjection {
        match self {
            Point::Still(view) => view.film(),
            Point::Moving(view) => view.film(),
            Point::Unaberrated(view) => view.film(),
        }
    }

    #[inline]
    fn ray_through<P: Projection>(&self, film: &P, x: f64, y: f64, moment: f64) -> CameraRay {
        match self {
            Point::Still(view) => view.ray_through(film, x, y, moment),
            Point::Moving(view) => view.ray_through(film, x, y, moment),
            Point::Unaberrated(view) => view.ray_through(film, x, y, moment),
        }
    }
}
