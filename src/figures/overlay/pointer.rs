//! The direction of the camera's motion in its own picture.
//!
//! Boosts are rotation-free, and light from straight ahead or behind is not aberrated: the direction n of the velocity has the same
//! components in the world and in the camera frame. In the picture it is at the film point whose vector D is along n
//! ([`Projection::film_point`]).

use glam::DVec3;

use crate::camera::{AnyProjection, Projection, Shot};
use crate::spacetime::Velocity;

/// The camera's velocity in its picture.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Pointer {
    /// Its target.
    pub target: Target,
    /// In the world.
    pub velocity: Velocity,
}

/// Where a direction is in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Target {
    /// At this film point, pixels: the camera moves towards what is visible there.
    Ahead([f64; 2]),
    /// The opposite direction is at this film point, pixels: the camera moves away from what is visible there.
    Behind([f64; 2]),
    /// Both are outside of the picture: it lies that way from the middle. A unit vector, y down.
    Outside([f64; 2]),
}

impl Pointer {
    /// The pointer for the image of `projection` at `shot`; `None` for a camera at rest.
    pub(super) fn of(shot: &Shot, projection: &AnyProjection) -> Option<Pointer> {
        let velocity = shot.frame.velocity();
        let n = velocity.rapidity().try_normalize()?;
        let n = DVec3::from_array(projection.film_axes().map(|axis| axis.dot(n)));
        Some(Pointer {
            target: target(projection, n),
            velocity,
        })
    }
}

/// The image of the direction with components `n` along the axes of `projection`.
fn target(projection: &AnyProjection, n: DVec3) -> Target {
    let size = projection.size();
    let on_film = |at: &[f64; 2]| (0..2).all(|axis| (0.0..=size[axis]).contains(&at[axis]));
    let seen = |n| projection.film_point(n).filter(on_film);
    match (seen(n), seen(-n)) {
        (Some(at), _) => Target::Ahead(at),
        (None, Some(at)) => Target::Behind(at),
        // Not both 0, as the middle is seen.
        (None, None) => Target::Outside([n.x / n.x.hypot(n.y), -n.y / n.x.hypot(n.y)]),
    }
}
