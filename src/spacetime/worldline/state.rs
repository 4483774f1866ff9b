//! States of a world line, and its crossings with light cones.

use glam::DVec3;

use super::elapsed::Elapsed;
use super::thrust::Thrust;
use crate::spacetime::{CameraFrame, Displacement, Event, InertialFrame, Velocity, World};

/// A world line at one proper time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Proper time, metres.
    pub proper_time: f64,
    /// The event in the world.
    pub event: Event<World>,
    /// Velocity relative to the world.
    pub velocity: Velocity,
    /// Proper acceleration, 1/m, in the axes of the comoving frame, which are the world's boosted without
    /// rotation.
    pub acceleration: DVec3,
    frame: InertialFrame<CameraFrame>,
    pub(super) thrust: Thrust,
    /// The four-velocity.
    pub(super) ahead: Displacement<World>,
    /// The direction of the acceleration, (0, n) in the comoving frame.
    pub(super) aside: Displacement<World>,
}

impl State {
    pub(super) fn new(
        proper_time: f64,
        event: Event<World>,
        velocity: Velocity,
        acceleration: DVec3,
    ) -> Self {
        let frame = InertialFrame::new(velocity, event);
        let thrust = Thrust::new(acceleration);
        let in_world = |t, x| {
            frame
                .world_from_frame()
                .displacement(Displacement::new(t, x))
        };
        State {
            proper_time,
            event,
            velocity,
            acceleration,
            frame,
            thrust,
            ahead: in_world(1.0, DVec3::ZERO),
            aside: in_world(0.0, thrust.n),
        }
    }

    /// The momentarily comoving inertial frame. Its clock and coordinates are zero at this event: add [`State::proper_time`] to get the
    /// reading of a clock on the world line.
    pub fn frame(&self) -> &InertialFrame<CameraFrame> {
        &self.frame
    }
}

/// The crossing of a world line and the past light cone of an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// From the reference event (that of the nearby state, or the light cone's own apex: see the function that returned this) to the
    /// crossing.
    pub displacement: Displacement<World>,
    /// The crossing, rounded to world coordinates.
    pub event: Event<World>,
    elapsed: Elapsed,
}

impl Crossing {
    /// The crossing at `displacement` from `reference`.
    #[inline]
    pub(super) fn new(
        reference: Event<World>,
        displacement: Displacement<World>,
        elapsed: Elapsed,
    ) -> Self {
        Crossing {
            displacement,
            event: reference + displacement,
            elapsed,
        }
    }

    /// Proper time of the world line at the crossing, metres. Costs a logarithm if the line accelerates.
    pub fn proper_time(&self) -> f64 {
        self.elapsed.proper_time()
    }

    /// The same crossing, relative to `reference`, at `displacement`.
    pub(super) fn counted_from(
        self,
        reference: Event<World>,
        displacement: Displacement<World>,
    ) -> Self {
        Crossing::new(reference, displacement, self.elapsed)
    }
}
