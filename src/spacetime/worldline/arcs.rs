//! World lines made of stretches of constant proper acceleration.
//!
//! An inertial line is one straight arc, a hyperbola one curved arc, both infinite. Segments are a straight arc before proper time 0, one
//! arc each, and a straight arc after the last. Each arc is given by the states at its ends (or at proper time 0), and everything else
//! about it has a closed form.
//!
//! A light cone crosses the last arc whose beginning lies in the causal past of its apex.

use glam::DVec3;

use super::cone::past_cone;
use super::error::{MAX_ACCELERATION, MAX_ENTRIES, WorldLineError};
use super::horizon;
use super::hyperbola;
use super::state::{Crossing, State};
use super::stretch::Stretch;
use super::taylor::combined;
use super::vicinity::Vicinity;
use crate::spacetime::{CameraFrame, Displacement, Event, InertialFrame, Velocity, World};

/// A stretch of constant proper acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Its proper time, metres; infinite for the last.
    pub duration: f64,
    /// Proper acceleration, 1/m, in axes that are carried along without rotation from proper time 0 on, where they are
    /// the comoving frame's; zero is coasting.
    pub acceleration: DVec3,
}

/// Arcs in the order of proper time; together they cover all proper times.
#[derive(Debug, Clone)]
pub(super) struct Arcs {
    arcs: Vec<Arc>,
}

/// A stretch of constant proper acceleration.
#[derive(Debug, Clone)]
struct Arc {
    /// The state at its beginning; at proper time 0 if it has no beginning.
    begin: State,
    /// The state at its end, still accelerating; the same as `begin` if it has no end.
    end: State,
}

impl Arc {
    /// An arc without beginning and end, from one of its states.
    fn eternal(state: State) -> Self {
        Arc {
            begin: state,
            end: state,
        }
    }
}

impl Arcs {
    /// One straight arc.
    pub fn inertial(velocity: Velocity, zero: Event<World>) -> Self {
        Arcs {
            arcs: vec![Arc::eternal(State::new(0.0, zero, velocity, DVec3::ZERO))],
        }
    }

    /// One arc of constant proper acceleration, straight if the acceleration is zero.
    pub fn hyperbolic(
        velocity: Velocity,
        zero: Event<World>,
        acceleration: DVec3,
    ) -> Result<Self, WorldLineError> {
        check(acceleration, None)?;
        Ok(Arcs {
            arcs: vec![Arc::eternal(State::new(0.0, zero, velocity, acceleration))],
        })
    }

    /// A straight arc before proper time 0, the segments, and a straight arc after them.
    pub fn segments(
        velocity: Velocity,
        zero: Event<World>,
        segments: &[Segment],
    ) -> Result<Self, WorldLineError> {
        if segments.len() > MAX_ENTRIES {
            return Err(WorldLineError::TooMany(segments.len()));
        }
        let mut state = State::new(0.0, zero, velocity, DVec3::ZERO);
        // The gyroscope's axes, in components of the comoving frame's axes.
        let mut axes = DVec3::AXES;
        let mut arcs = vec![Arc::eternal(state)];
        for (index, segment) in segments.iter().enumerate() {
            check(segment.acceleration, Some(index))?;
            check_duration(segments, index)?;
            let begin = accelerating(&state, combined(axes, segment.acceleration));
            if segment.duration.is_infinite() {
                arcs.push(Arc::eternal(begin));
                break;
            }
            state = end(&begin, segment.duration, index)?;
            // During the segment, the gyroscope rotates relative to axes that are boosted without rotation.
            axes = axes.map(|axis| hyperbola::turned(&begin, segment.duration, axis));
            arcs.push(Arc { begin, end: state });
            if index + 1 == segments.len() {
                arcs.push(Arc::eternal(accelerating(&state, DVec3::ZERO)));
            }
        }
        Ok(Arcs { arcs })
    }

    /// The state at a proper time; `None` if it is too fast for [`Velocity`].
    pub fn state(&self, proper_time: f64) -> Option<State> {
        let begin = &self.arcs[self.index(proper_time)].begin;
        let elapsed = proper_time - begin.proper_time;
        if elapsed == 0.0 {
            return Some(*begin);
        }
        hyperbola::after(begin, elapsed)
    }

    /// Event and velocity of the state at a proper time.
    pub fn place(&self, proper_time: f64) -> Option<(Event<World>, Velocity)> {
        let begin = &self.arcs[self.index(proper_time)].begin;
        let elapsed = proper_time - begin.proper_time;
        if elapsed == 0.0 {
            return Some((begin.event, begin.velocity));
        }
        hyperbola::place_after(begin, elapsed)
    }

    /// The frame in which the line rests for ever, if there is one.
    pub fn frame(&self) -> Option<InertialFrame<CameraFrame>> {
        let inertial = self.arcs.iter().all(|arc| arc.begin.thrust.is_none());
        inertial.then(|| *self.arcs[0].begin.frame())
    }

    /// The arc that contains a proper time, the later one where two join.
    fn index(&self, proper_time: f64) -> usize {
        self.arcs[1..].partition_point(|arc| arc.begin.proper_time <= proper_time)
    }

    /// The arc that a past light cone crosses; `from` is the displacement from an event to the cone's apex.
    fn crossed(&self, from: impl Fn(Event<World>) -> Displacement<World>) -> usize {
        self.arcs[1..].partition_point(|arc| from(arc.begin.event).is_causal())
    }

    /// As [`super::WorldLine::beyond_horizon`].
    pub fn beyond_horizon(&self, [from, to]: [f64; 2], points: &[DVec3]) -> Option<DVec3> {
        let [first, last] = [from, to].map(|time| self.index(time));
        (first..=last).find_map(|index| {
            // The part of the exposure on this arc, up to the beginning of the next.
            let begin = &self.arcs[index].begin;
            let next = self.arcs.get(index + 1).filter(|_| index < last);
            let start = if index > first {
                begin.proper_time
            } else {
                from
            };
            let end = next.map_or(to, |next| next.begin.proper_time);
            let start = hyperbola::after(begin, start - begin.proper_time)?;
            let end = hyperbola::after(&start, end - start.proper_time)?;
            let axis = start.acceleration.cross(start.velocity.split().0);
            horizon::beyond_arc([start.acceleration, end.acceleration], axis, points)
        })
    }

    /// The arc around `near`, a state of this line.
    pub fn vicinity(&self, near: &State) -> Vicinity {
        let since = match self.index(near.proper_time) {
            0 => f64::NEG_INFINITY,
            index => self.arcs[index].begin.proper_time - near.proper_time,
        };
        Vicinity::new(*near, since)
    }

    /// The stretch between two proper times, within one arc; its events are relative to `reference`.
    pub fn stretch(&self, times: [f64; 2], reference: Event<World>) -> Option<Stretch> {
        let [first, last] = times.map(|time| self.index(time));
        let g = self.arcs[first].begin.thrust.g;
        let stretch = || Stretch::new(times, g, reference, |time| self.state(time));
        (first == last).then(stretch).flatten()
    }

    /// The crossing, with its displacement relative to `near`, a state of this line.
    #[inline]
    pub fn past_cone(&self, near: &State, offset: Displacement<World>) -> Option<Crossing> {
        if self.arcs.len() == 1 {
            return past_cone(near, offset);
        }
        self.past_cone_among(near, offset)
    }

    fn past_cone_among(&self, near: &State, offset: Displacement<World>) -> Option<Crossing> {
        // Usually the light cone crosses the arc of `near` itself.
        let from = |event| (near.event - event) + offset;
        let seen = |arc: &Arc| from(arc.begin.event).is_causal();
        let own = self.index(near.proper_time);
        let begun = own == 0 || seen(&self.arcs[own]);
        let ended = self.arcs.get(own + 1).is_some_and(seen);
        if begun && !ended {
            return past_cone(near, offset);
        }
        // Along this arc to its nearer end, from there to the nearer end of the target arc, and on: each displacement keeps the digits of a
        // short one.
        let target = self.crossed(from);
        let (leave, enter) = if target < own {
            (&self.arcs[own].begin, &self.arcs[target].end)
        } else {
            (&self.arcs[own].end, &self.arcs[target].begin)
        };
        let way = hyperbola::way(near, leave.proper_time - near.proper_time);
        let way = way + (enter.event - leave.event);
        let crossing = past_cone(enter, offset - way)?;
        Some(crossing.counted_from(near.event, crossing.displacement + way))
    }

    /// The crossing, with its displacement relative to `apex` itself.
    pub fn past_cone_of(&self, apex: Event<World>) -> Option<Crossing> {
        let begin = &self.arcs[self.crossed(|event| apex - event)].begin;
        let offset = apex - begin.event;
        let crossing = past_cone(begin, offset)?;
        Some(crossing.counted_from(apex, crossing.displacement - offset))
    }
}

/// The same state with another acceleration.
fn accelerating(state: &State, acceleration: DVec3) -> State {
    State::new(state.proper_time, state.event, state.velocity, acceleration)
}

/// The state at the end of a segment.
fn end(begin: &State, duration: f64, index: usize) -> Result<State, WorldLineError> {
    let proper_time = begin.proper_time + duration;
    hyperbola::after(begin, duration)
        .filter(|s| s.event.ct.is_finite() && s.event.x.is_finite())
        .ok_or(WorldLineError::TooFast { index, proper_time })
}

fn check_duration(segments: &[Segment], index: usize) -> Result<(), WorldLineError> {
    let duration = segments[index].duration;
    let last = index + 1 == segments.len();
    if duration > 0.0 && (last || duration.is_finite()) {
        return Ok(());
    }
    Err(WorldLineError::Duration { index, duration })
}

/// Refuses an acceleration that is not finite or too strong.
pub(super) fn check(acceleration: DVec3, index: Option<usize>) -> Result<(), WorldLineError> {
    if !acceleration.is_finite() {
        return Err(match index {
            Some(index) => WorldLineError::EntryNotFinite { index },
            None => WorldLineError::NotFinite("a proper acceleration"),
        });
    }
    let largest = acceleration.abs().max_element();
    if largest > MAX_ACCELERATION {
        return Err(WorldLineError::TooStrong {
            index,
            acceleration: largest,
        });
    }
    Ok(())
}
