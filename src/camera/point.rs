//! Point cameras at one moment: all rays leave one event.

use super::{Look, Pinhole, Shot, Together, View};
use crate::spacetime::{Boost, Camera, Direction, World};

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
    type From = Together;
    const EXPOSED: bool = false;

    #[inline(always)]
    fn look(&self, x: f64, y: f64, _: f64) -> Look<Together> {
        Look {
            d: Direction::from_unit(self.0.direction(x, y).unit()),
            ratio: 1.0,
            from: Together,
        }
    }
}

impl View for Moving {
    type From = Together;
    const EXPOSED: bool = false;

    #[inline(always)]
    fn look(&self, x: f64, y: f64, _: f64) -> Look<Together> {
        let seen = self.pinhole.direction(x, y);
        let (d, ratio) = self.world_from_camera.direction(seen);
        Look {
            d,
            ratio,
            from: Together,
        }
    }
}

impl View for Unaberrated {
    type From = Together;
    const EXPOSED: bool = false;

    #[inline(always)]
    fn look(&self, x: f64, y: f64, _: f64) -> Look<Together> {
        let seen = self.0.pinhole.direction(x, y);
        let (_, ratio) = self.0.world_from_camera.direction(seen);
        Look {
            d: Direction::from_unit(seen.unit()),
            ratio,
            from: Together,
        }
    }
}

/// Any of them, told apart at each look: for work that is not worth compiling three times.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs)]
pub enum Point<'a> {
    Still(&'a Still),
    Moving(&'a Moving),
    Unaberrated(&'a Unaberrated),
}

impl View for Point<'_> {
    type From = Together;
    const EXPOSED: bool = false;

    #[inline]
    fn look(&self, x: f64, y: f64, moment: f64) -> Look<Together> {
        match self {
            Point::Still(view) => view.look(x, y, moment),
            Point::Moving(view) => view.look(x, y, moment),
            Point::Unaberrated(view) => view.look(x, y, moment),
        }
    }
}
