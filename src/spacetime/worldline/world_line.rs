//! World lines of every kind behind one type.

use glam::DVec3;

use super::arcs::{Arcs, Segment};
use super::circular::Circular;
use super::error::WorldLineError;
use super::keyframes::Keyframes;
use super::profile::{Axes, Profile};
use super::state::{Crossing, State};
use super::stretch::Stretch;
use super::vicinity::Vicinity;
use crate::spacetime::{CameraFrame, Displacement, Event, InertialFrame, Velocity, World};

/// The world line of something slower than light.
#[derive(Debug, Clone)]
pub struct WorldLine {
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Arcs(Arcs),
    Profile(Profile),
    Keyframes(Keyframes),
    Circular(Circular),
}

impl WorldLine {
    /// Without acceleration, through the event `zero` at proper time 0.
    pub fn inertial(velocity: Velocity, zero: Event<World>) -> WorldLine {
        Kind::Arcs(Arcs::inertial(velocity, zero)).into()
    }

    /// With constant proper acceleration for ever: a hyperbola in the frame comoving at proper time 0, in whose axes `acceleration` is
    /// given (1/m). Without acceleration it is inertial.
    ///
    /// # Errors
    /// An acceleration that is not finite, or above [`MAX_ACCELERATION`](super::MAX_ACCELERATION).
    pub fn hyperbolic(
        velocity: Velocity,
        zero: Event<World>,
        acceleration: DVec3,
    ) -> Result<WorldLine, WorldLineError> {
        Ok(Kind::Arcs(Arcs::hyperbolic(velocity, zero, acceleration)?).into())
    }

    /// Successive stretches of constant proper acceleration from proper time 0 on; without acceleration before and after them.
    ///
    /// # Errors
    /// More than [`MAX_ENTRIES`](super::MAX_ENTRIES) segments, a segment of zero duration or with an acceleration that
    /// [`hyperbolic`](WorldLine::hyperbolic) refuses, and a segment that exceeds [`MAX_RAPIDITY`](crate::spacetime::MAX_RAPIDITY).
    pub fn segments(
        velocity: Velocity,
        zero: Event<World>,
        segments: &[Segment],
    ) -> Result<WorldLine, WorldLineError> {
        Ok(Kind::Arcs(Arcs::segments(velocity, zero, segments)?).into())
    }

    /// With the proper acceleration given at knots of proper time, as components along `axes`, and linear between them; from the first knot
    /// to the last. `velocity` and `zero` are the state at proper time 0, which must be within these times.
    ///
    /// # Errors
    /// Fewer than two knots or more than [`MAX_ENTRIES`](super::MAX_ENTRIES), times that do not ascend or do not include 0, and accelerations
    /// that [`segments`](WorldLine::segments) refuses.
    pub fn profile(
        velocity: Velocity,
        zero: Event<World>,
        knots: &[(f64, DVec3)],
        axes: Axes,
    ) -> Result<WorldLine, WorldLineError> {
        Ok(Kind::Profile(Profile::new(velocity, zero, knots, axes)?).into())
    }

    /// The natural cubic spline x(ct) through `events`, from the first, at proper time 0, to the last.
    ///
    /// Of all curves through them it has the least ∫|x″|² dct; velocity and acceleration are continuous, and the acceleration is zero at
    /// both ends.
    ///
    /// # Errors
    /// Fewer than two events or more than [`MAX_ENTRIES`](super::MAX_ENTRIES), numbers that are not finite, times that do not ascend, and a curve
    /// that is faster somewhere than [`MAX_KEYFRAME_SPEED`](super::MAX_KEYFRAME_SPEED).
    pub fn keyframes(events: &[Event<World>]) -> Result<WorldLine, WorldLineError> {
        Ok(Kind::Keyframes(Keyframes::smooth(events)?).into())
    }

    /// Straight at constant velocity from each of `events` to the next, from the first, at proper time 0, to the last.
    ///
    /// Around each inner event, the velocity changes at a constant rate in world time, from before to after the event by 1/16 of the
    /// shorter of the two adjacent times.
    ///
    /// # Errors
    /// As for [`keyframes`](WorldLine::keyframes).
    pub fn polyline(events: &[Event<World>]) -> Result<WorldLine, WorldLineError> {
        Ok(Kind::Keyframes(Keyframes::straight(events)?).into())
    }

    /// The line of an animation: through `events` by cubics in world time that have `velocities` before and after each (dx/dct, as many as
    /// events), and at rest before the first event and after the last one. The velocity jumps at both; proper time is 0 at the first. Where
    /// it would jump at an inner event, it changes within a short time as in a [`WorldLine::polyline`].
    ///
    /// # Errors
    /// As for [`keyframes`](WorldLine::keyframes).
    pub fn animation(
        events: &[Event<World>],
        velocities: &[[DVec3; 2]],
    ) -> Result<WorldLine, WorldLineError> {
        Ok(Kind::Keyframes(Keyframes::cubic(events, velocities)?.resting()).into())
    }

    /// At constant speed around the axis through the point `centre` along `axis` (of any length but 0), at `rate` radians per metre of
    /// world time, right-handed about it; at `zero` at proper time 0.
    ///
    /// # Errors
    /// Numbers that are not finite, a zero axis, `zero` on the axis, and a speed that is not below that of light.
    pub fn circular(
        zero: Event<World>,
        centre: DVec3,
        axis: DVec3,
        rate: f64,
    ) -> Result<WorldLine, WorldLineError> {
        Ok(Kind::Circular(Circular::new(zero, centre, axis, rate)?).into())
    }

    /// The first and the last proper time, metres; infinite if the line has no end.
    pub fn span(&self) -> [f64; 2] {
        match &self.kind {
            Kind::Arcs(_) | Kind::Circular(_) => [f64::NEG_INFINITY, f64::INFINITY],
            Kind::Profile(line) => line.span(),
            Kind::Keyframes(line) => line.span(),
        }
    }

    /// The proper times before and after which the line rests, if it follows an animation: its velocity jumps there.
    pub fn rests(&self) -> Option<[f64; 2]> {
        match &self.kind {
            Kind::Keyframes(line) => line.rests(),
            Kind::Arcs(_) | Kind::Profile(_) | Kind::Circular(_) => None,
        }
    }

    /// The proper time of a revolution, if the line is a circle.
    pub fn period(&self) -> Option<f64> {
        match &self.kind {
            Kind::Circular(line) => line.period(),
            Kind::Arcs(_) | Kind::Profile(_) | Kind::Keyframes(_) => None,
        }
    }

    /// The state at a proper time, metres. `None` outside [`WorldLine::span`], if coordinates exceed f64's range, or if the rapidity is
    /// above [`MAX_RAPIDITY`](crate::spacetime::MAX_RAPIDITY).
    pub fn state(&self, proper_time: f64) -> Option<State> {
        let [first, last] = self.span();
        // NaN is neither below nor above anything, so it is tested separately.
        if !proper_time.is_finite() || proper_time < first || proper_time > last {
            return None;
        }
        let state = match &self.kind {
            Kind::Arcs(line) => line.state(proper_time),
            Kind::Profile(line) => line.state(proper_time),
            Kind::Keyframes(line) => line.state(proper_time),
            Kind::Circular(line) => line.state(proper_time),
        };
        state.filter(|s| s.event.ct.is_finite() && s.event.x.is_finite())
    }

    /// Event and velocity of [`WorldLine::state`] at a proper time, `None` if that is `None`: cheaper if nothing else is needed.
    pub fn place(&self, proper_time: f64) -> Option<(Event<World>, Velocity)> {
        let Kind::Arcs(line) = &self.kind else {
            let state = self.state(proper_time)?;
            return Some((state.event, state.velocity));
        };
        // Arcs have no ends, so only a time that is not finite is outside their span.
        let place = line.place(proper_time).filter(|_| proper_time.is_finite());
        place.filter(|(event, _)| event.ct.is_finite() && event.x.is_finite())
    }

    /// The frame whose clock shows proper time, if the line is inertial for ever.
    pub fn frame(&self) -> Option<InertialFrame<CameraFrame>> {
        match &self.kind {
            Kind::Arcs(line) => line.frame(),
            Kind::Profile(_) | Kind::Keyframes(_) | Kind::Circular(_) => None,
        }
    }

    /// The crossing of the line and the past light cone of the event at `offset` from that of `near`, a state of this line: the event at
    /// which it is seen from there. The displacement of the crossing is relative to `near.event`, and keeps the digits of a small `offset`.
    ///
    /// `None` if there is no crossing: beyond the horizon of a line that accelerates for ever, before the line begins or after it ends.
    #[inline]
    pub fn on_past_light_cone(
        &self,
        near: &State,
        offset: Displacement<World>,
    ) -> Option<Crossing> {
        match &self.kind {
            Kind::Arcs(line) => line.past_cone(near, offset),
            Kind::Profile(line) => line.past_cone(near, offset),
            Kind::Keyframes(line) => line.past_cone(near, offset),
            Kind::Circular(line) => line.past_cone(near, offset),
        }
    }

    /// The part of the line around `near`, a state of this line, along which its proper acceleration is constant, if there is one.
    pub fn vicinity(&self, near: &State) -> Option<Vicinity> {
        match &self.kind {
            Kind::Arcs(line) => Some(line.vicinity(near)),
            Kind::Profile(_) | Kind::Keyframes(_) | Kind::Circular(_) => None,
        }
    }

    /// The stretch between two proper times, if the proper acceleration is constant from one to the other; its events are relative to
    /// `reference`. `None` otherwise, and if [`WorldLine::state`] is `None` there.
    pub fn stretch(&self, times: [f64; 2], reference: Event<World>) -> Option<Stretch> {
        match &self.kind {
            Kind::Arcs(line) => line.stretch(times, reference),
            Kind::Profile(_) | Kind::Keyframes(_) | Kind::Circular(_) => None,
        }
    }

    /// A proper acceleration from one proper time to another beyond whose horizon one of `points` lies: where a rigid body with
    /// constant places in the comoving frame, whose axes are the world's boosted without rotation, cannot exist, 1 + a·p ≤ 0.
    /// `None` if the line has no such acceleration then, also between any two moments at which one would look. Where that is not settled with
    /// a bounded effort, because a point comes very near to the horizon during a long and varied motion, it is an acceleration near whose
    /// horizon the point lies: 1 + a·p > 0 for all of them.
    pub fn beyond_horizon(&self, times: [f64; 2], points: &[DVec3]) -> Option<DVec3> {
        match &self.kind {
            Kind::Arcs(line) => line.beyond_horizon(times, points),
            Kind::Profile(line) => line.beyond_horizon(times, points),
            Kind::Keyframes(line) => line.beyond_horizon(times, points),
            Kind::Circular(line) => line.beyond_horizon(times, points),
        }
    }

    /// The crossing of the line and the past light cone of `apex`, like [`WorldLine::on_past_light_cone`]. The displacement of the crossing
    /// is relative to `apex` itself: a null vector into the past.
    pub fn on_past_light_cone_of(&self, apex: Event<World>) -> Option<Crossing> {
        match &self.kind {
            Kind::Arcs(line) => line.past_cone_of(apex),
            Kind::Profile(line) => line.past_cone_of(apex),
            Kind::Keyframes(line) => line.past_cone_of(apex),
            Kind::Circular(line) => line.past_cone_of(apex),
        }
    }
}

impl From<Kind> for WorldLine {
    fn from(kind: Kind) -> Self {
        WorldLine { kind }
    }
}
