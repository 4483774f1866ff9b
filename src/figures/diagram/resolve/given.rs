//! Events as a file gives them, and the intervals between them.
//!
//! s² is the difference of (Δct)² and |Δx|². In the world these are up to e^{2w} times as large as in a frame of rapidity w, and from
//! e^{2w} ≈ 10¹⁵ on no digit of s² is left. It is the same in all frames, so that an event keeps its coordinates a in the frame in which
//! they are given, of origin O: (τ, 0) on an inertial clock. Events of the world have a = 0 in a frame of any velocity with O there. Of
//! two events in frames of one velocity
//!
//! ```text
//! Δ = b − a + Λ⁻¹ (O_b − O_a),
//! ```
//!
//! where equal origins leave no error, and different ones up to e^w times theirs. Where Δ is wrong by δ in time and in space, s² is wrong
//! by at most E = 2 δ (|Δct| + |Δx|) + δ². Of this Δ and that of the world, the one of smaller E counts.
//!
//! Events with |s²| ≤ E are joined by light if E is small beside (Δct)² + |Δx|². That has to hold for both of them: in a frame of rapidity
//! w relative to that of Δ, Δ may be e^w times as small, and the interval as long as that.

use glam::DVec3;

use crate::figures::diagram::model::{Kind, Moment, Track};
use crate::spacetime::{Displacement, Event, Frame, InertialFrame, Rest, Velocity, World};

/// The error of coordinates, in parts of them: a generous one, as some were solved for.
const ROUNDING: f64 = 5e-13;
/// The largest E of light, in parts of the square of |Δct| + |Δx|.
const LIGHT: f64 = 1e-6;

/// An event as it is given.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given {
    /// In the world.
    pub event: Event<World>,
    /// Its own frame.
    frame: InertialFrame<Rest>,
    /// Its coordinates there.
    at: Event<Rest>,
}

impl From<Event<World>> for Given {
    /// In the world: by coordinates, or by light that comes from or goes to such an event.
    fn from(event: Event<World>) -> Self {
        Given::new(event, Velocity::REST)
    }
}

/// A candidate for the interval of two events.
struct Candidate {
    squared: f64,
    /// E.
    error: f64,
    /// |Δct| + |Δx| in whichever own frame of the two it may be smallest.
    size: f64,
}

impl Given {
    /// At the origin of a frame of its own.
    fn new(event: Event<World>, velocity: Velocity) -> Self {
        Given {
            event,
            frame: InertialFrame::new(velocity, event),
            at: Event::ORIGIN,
        }
    }

    /// By coordinates in `frame`.
    pub fn within(frame: &InertialFrame<Rest>, at: Event<Rest>) -> Self {
        let event = frame.event_to_world(at);
        match frame.velocity().is_rest() {
            true => event.into(),
            false => Given {
                event,
                frame: *frame,
                at,
            },
        }
    }

    /// By the clock of `track`, at `moment`.
    pub fn by_clock(track: &Track, moment: Moment) -> Self {
        let [first, last] = track.span();
        let start = track.at(0f64.clamp(first, last));
        match start.filter(|_| track.is_straight()) {
            Some(start) => Given {
                event: moment.event,
                frame: start.frame(),
                at: Event::new(moment.proper_time - start.proper_time, DVec3::ZERO),
            },
            None => Given::beside(moment),
        }
    }

    /// On a world line, where it meets something.
    pub fn beside(moment: Moment) -> Self {
        Given::new(moment.event, moment.velocity)
    }

    /// The interval to another event: s² in square metres, and its kind. One that rounding hides is given by what |s²| is surely below.
    pub fn interval(&self, to: &Given) -> (f64, Kind) {
        let world = self.candidate(to, None);
        let own = self.shared_velocity(to);
        let own = own.map(|velocity| self.candidate(to, Some(velocity)));
        let better = own.filter(|own| own.error < world.error).unwrap_or(world);
        let Candidate {
            squared,
            error,
            size,
        } = better;
        match squared {
            s if s > error => (s, Kind::Timelike),
            s if s < -error => (s, Kind::Spacelike),
            s if error <= LIGHT * size * size => (s, Kind::Null),
            s => (s.abs() + error, Kind::Unresolved),
        }
    }

    /// The velocity of frames of which both events have coordinates.
    fn shared_velocity(&self, to: &Given) -> Option<Velocity> {
        let own = [self, to].map(|given| (given.at != Event::ORIGIN).then(|| given.velocity()));
        match own {
            [Some(a), Some(b)] => (a == b).then_some(a),
            [a, b] => a.or(b),
        }
    }

    fn velocity(&self) -> Velocity {
        self.frame.velocity()
    }

    /// The interval by Δ in frames of this velocity, or in the world.
    fn candidate(&self, to: &Given, shared: Option<Velocity>) -> Candidate {
        let velocity = shared.unwrap_or(Velocity::REST);
        let origins = match shared {
            Some(_) => [self.frame.origin(), to.frame.origin()],
            None => [self.event, to.event],
        };
        let (between, error) = difference(origins);
        let frame = InertialFrame::<Rest>::new(velocity, Event::ORIGIN);
        let between = frame.frame_from_world().displacement(between);
        let error = error * libm::exp(velocity.rapidity().length());
        let (step, error) = match shared {
            Some(_) => {
                let (own, own_error) = difference([self.at, to.at]);
                (own + between, own_error + error)
            }
            None => (between, error),
        };
        // What is given in the world looks as it does there.
        let turn = |given: &Given| match given.velocity() {
            own if own.is_rest() => 0.0,
            own => {
                let relative = own.relative_to(velocity);
                relative.map_or(f64::INFINITY, |v| v.rapidity().length())
            }
        };
        let size = step.ct.abs() + step.x.length();
        Candidate {
            squared: step.interval(),
            error: error * (2.0 * size + error),
            size: size * libm::exp(-turn(self).max(turn(to))),
        }
    }
}

/// The displacement between two events, and the error of its components; that of an event from itself has none.
fn difference<F: Frame + PartialEq>([from, to]: [Event<F>; 2]) -> (Displacement<F>, f64) {
    let size = |event: Event<F>| event.ct.abs() + event.x.length();
    let error = match from == to {
        true => 0.0,
        false => ROUNDING * (size(from) + size(to)),
    };
    (to - from, error)
}
