//! The world line of a camera's pinhole.

use super::model::{CameraModel, Motion};
use crate::spacetime::worldline::{WorldLine, WorldLineError};
use crate::spacetime::{Event, Velocity, World};

impl CameraModel {
    /// The world line of the pinhole, whose proper time the camera's clock shows.
    ///
    /// # Errors
    /// Where nothing slower than light moves like that; never of a camera that a scene file gave.
    pub fn world_line(&self) -> Result<WorldLine, WorldLineError> {
        self.motion.world_line(self.velocity, self.origin)
    }
}

impl Motion {
    /// The world line with this motion that has `velocity` at `zero`, where its clock shows 0. Paths in
    /// the world (keyframes, circles) have their own velocity, and keyframes their own beginning.
    ///
    /// # Errors
    /// Where nothing slower than light moves like that.
    pub fn world_line(
        &self,
        velocity: Velocity,
        zero: Event<World>,
    ) -> Result<WorldLine, WorldLineError> {
        match self {
            Motion::Inertial => Ok(WorldLine::inertial(velocity, zero)),
            Motion::Accelerated(a) => WorldLine::hyperbolic(velocity, zero, *a),
            Motion::Segments(segments) => WorldLine::segments(velocity, zero, segments),
            Motion::Profile(knots) => WorldLine::profile(velocity, zero, knots),
            Motion::Keyframes(events) => WorldLine::keyframes(events),
            Motion::Circular { centre, axis, rate } => {
                WorldLine::circular(zero, *centre, *axis, *rate)
            }
        }
    }
}
