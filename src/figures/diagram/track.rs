//! World lines in diagrams: physical ones, broken lines, those of a sensor, and parts of these.
//!
//! Along anything slower than light, each of
//!
//! ```text
//! ct − ct_E ± |x − x_E|        (the light cones of E)
//! t′ − t′_E                    (the time of any frame)
//! ```
//!
//! increases, so it is zero at most once; [`Track::where_zero`] finds the zero by bisection.

use glam::DVec3;

use crate::scene::model::{Assembly, Sensor};
use crate::spacetime::worldline::WorldLine;
use crate::spacetime::{Displacement, Event, InertialFrame, Rest, Velocity, World};

/// Halvings after which neighbouring numbers are reached from any bracket of a factor of two.
const HALVINGS: usize = 140;
/// The largest change of rapidity at which light cones are resolved: e^15 times 2⁻⁵³ is 4·10⁻¹⁰.
const MOST_TURN: f64 = 15.0;
/// Doublings from a metre to beyond all lengths that a file can contain.
const DOUBLINGS: i32 = 110;

/// A world line, or a part of one.
#[derive(Debug, Clone)]
pub struct Track {
    course: Course,
    span: [f64; 2],
}

#[derive(Debug, Clone)]
enum Course {
    Line(WorldLine),
    /// Straight from event to event, with the proper time of each.
    Broken(Vec<(f64, Event<World>)>),
    /// An element of a sensor behind the pinhole on `line`.
    Sensor {
        line: WorldLine,
        sensor: Sensor,
        forward: DVec3,
        film: DVec3,
    },
}

/// A world line at one of its proper times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Proper time, metres.
    pub proper_time: f64,
    /// The event.
    pub event: Event<World>,
    /// The velocity in the world.
    pub velocity: Velocity,
}

impl Moment {
    /// The frame that moves along, its origin at this event.
    pub fn frame(&self) -> InertialFrame<Rest> {
        InertialFrame::new(self.velocity, self.event)
    }
}

impl From<WorldLine> for Track {
    fn from(line: WorldLine) -> Self {
        let span = line.span();
        Track {
            course: Course::Line(line),
            span,
        }
    }
}

impl Track {
    /// Straight from event to event; `None` if one is not after its predecessor and within its light cone.
    ///
    /// # Errors
    /// The index of the first event that cannot be reached.
    pub fn broken(events: &[Event<World>]) -> Result<Track, usize> {
        let mut proper_time = 0.0;
        let mut corners = Vec::with_capacity(events.len());
        for (i, &event) in events.iter().enumerate() {
            if let Some(&(_, before)) = corners.last() {
                let step: Displacement<World> = event - before;
                if step.ct <= step.x.length() {
                    return Err(i);
                }
                proper_time += step.interval().sqrt();
            }
            corners.push((proper_time, event));
        }
        Ok(Track {
            course: Course::Broken(corners),
            span: [0.0, proper_time],
        })
    }

    /// The centre of a sensor that looks along `forward` through the pinhole on `line`. Its times are those
    /// of the pinhole's clock.
    pub fn sensor(line: WorldLine, sensor: Sensor, forward: DVec3) -> Track {
        Track::element(line, sensor, forward, forward)
    }

    /// The element of film vector `film` (camera frame, its part along `forward` 1) of such a sensor.
    pub fn element(line: WorldLine, sensor: Sensor, forward: DVec3, film: DVec3) -> Track {
        let span = line.span();
        let course = Course::Sensor {
            line,
            sensor,
            forward,
            film,
        };
        Track { course, span }
    }

    /// The first and the last proper time, metres; infinite if there is no end.
    pub fn span(&self) -> [f64; 2] {
        self.span
    }

    /// The part between two of its proper times.
    pub fn part(mut self, [from, to]: [f64; 2]) -> Track {
        self.span = [self.span[0].max(from), self.span[1].min(to)];
        self
    }

    /// Whether it is straight.
    pub fn is_straight(&self) -> bool {
        match &self.course {
            Course::Line(line) | Course::Sensor { line, .. } => line.frame().is_some(),
            Course::Broken(corners) => corners.len() == 2,
        }
    }

    /// The proper time of a revolution, if it goes round a circle for ever.
    pub fn period(&self) -> Option<f64> {
        match &self.course {
            Course::Line(line) | Course::Sensor { line, .. } => line.period(),
            Course::Broken(_) => None,
        }
    }

    /// Whether it bends between its corners.
    pub fn bends(&self) -> bool {
        match &self.course {
            Course::Line(_) | Course::Sensor { .. } => !self.is_straight(),
            Course::Broken(_) => false,
        }
    }

    /// The proper times of its corners, where its velocity jumps, without the ends.
    pub fn corners(&self) -> Vec<f64> {
        let [first, last] = self.span;
        match &self.course {
            Course::Broken(corners) => {
                let times = corners.iter().map(|(time, _)| *time);
                times.filter(|t| *t > first && *t < last).collect()
            }
            Course::Line(line) | Course::Sensor { line, .. } => {
                let times = line.rests().into_iter().flatten();
                times.filter(|t| *t > first && *t < last).collect()
            }
        }
    }

    /// The line at a proper time; `None` outside its span, and where f64 runs out of digits.
    pub fn at(&self, proper_time: f64) -> Option<Moment> {
        let [first, last] = self.span;
        if !(first..=last).contains(&proper_time) {
            return None;
        }
        let (event, velocity) = match &self.course {
            Course::Line(line) => {
                let state = line.state(proper_time)?;
                (state.event, state.velocity)
            }
            Course::Broken(corners) => on_broken(corners, proper_time)?,
            Course::Sensor {
                line,
                sensor,
                forward,
                film,
            } => on_sensor(line, sensor, [*forward, *film], proper_time)?,
        };
        Some(Moment {
            proper_time,
            event,
            velocity,
        })
    }

    /// The line at a proper time, if the differences between its coordinates and those of the same light ray have digits left: a line that
    /// accelerates for ever gets closer to its horizon than that.
    fn with_digits(&self, time: f64) -> Option<Moment> {
        let moment = self.at(time)?;
        if self.is_straight() {
            return Some(moment);
        }
        let start = self.at(0f64.clamp(self.span[0], self.span[1]))?;
        let change = moment.velocity.rapidity() - start.velocity.rapidity();
        (change.length() <= MOST_TURN).then_some(moment)
    }

    /// The moment at which `rising`, which increases along the line, is zero.
    pub fn where_zero(&self, rising: impl Fn(Event<World>) -> f64) -> Option<Moment> {
        let value = |time: f64| self.with_digits(time).map(|m| rising(m.event));
        // Halved until the two are neighbouring numbers, of which the one with the smaller value counts.
        let [mut low, mut high] = self.bracket(&value)?;
        for _ in 0..HALVINGS {
            let middle = low + 0.5 * (high - low);
            if middle <= low || middle >= high {
                break;
            }
            match value(middle)? {
                v if v < 0.0 => low = middle,
                _ => high = middle,
            }
        }
        let nearer = match (value(low)?, value(high)?) {
            (a, b) if -a < b => low,
            _ => high,
        };
        self.at(nearer)
    }

    /// Two times: `value` is not positive at the first, and not negative at the second.
    fn bracket(&self, value: &impl Fn(f64) -> Option<f64>) -> Option<[f64; 2]> {
        let start = 0f64.clamp(self.span[0], self.span[1]);
        let sign = value(start)?;
        let towards = if sign < 0.0 { 1.0 } else { -1.0 };
        let mut near = start;
        // From a thousandth of a metre on.
        for doubling in -10..DOUBLINGS {
            let far = self.reach(start, towards * 2f64.powi(doubling));
            if value(far)? * towards >= 0.0 {
                return Some([near.min(far), near.max(far)]);
            }
            if far == near {
                return None;
            }
            near = far;
        }
        None
    }

    /// The time `start + step`, or the last time on the way there within the line's span.
    fn reach(&self, start: f64, step: f64) -> f64 {
        let far = (start + step).clamp(self.span[0], self.span[1]);
        if self.with_digits(far).is_some() {
            return far;
        }
        let [mut good, mut bad] = [start, far];
        for _ in 0..HALVINGS {
            let middle = good + 0.5 * (bad - good);
            if middle == good || middle == bad {
                break;
            }
            match self.with_digits(middle) {
                Some(_) => good = middle,
                None => bad = middle,
            }
        }
        good
    }

    /// The first time found, after `start` or before it, at which its rapidity has changed by `turn`; `None` for a line that stays
    /// inertial.
    pub fn turned(&self, start: f64, towards: f64, turn: f64) -> Option<f64> {
        let before = self.at(start)?.velocity.rapidity();
        if self.is_straight() {
            return None;
        }
        // Four per doubling, from a thousandth of a metre on.
        let times = (-40..4 * DOUBLINGS).map(|k| start + towards * libm::exp2(0.25 * f64::from(k)));
        times.map_while(|time| self.at(time)).find_map(|moment| {
            let change = (moment.velocity.rapidity() - before).length();
            (change >= turn).then_some(moment.proper_time)
        })
    }

    /// The proper times at which it enters and leaves the time range `window` of a frame, or its ends if it begins later or ends earlier.
    pub fn during<F: crate::spacetime::Frame>(
        &self,
        frame: &InertialFrame<F>,
        window: [f64; 2],
    ) -> [f64; 2] {
        let start = 0f64.clamp(self.span[0], self.span[1]);
        let end = |ct: f64, towards: f64| {
            let moment = self.at_time(frame, ct);
            let end = || self.reach(start, towards * 2f64.powi(DOUBLINGS));
            moment.map_or_else(end, |moment| moment.proper_time)
        };
        [end(window[0], -1.0), end(window[1], 1.0)]
    }

    /// Its moment at a time of a frame.
    pub fn at_time<F: crate::spacetime::Frame>(
        &self,
        frame: &InertialFrame<F>,
        ct: f64,
    ) -> Option<Moment> {
        self.where_zero(|event| frame.event_from_world(event).ct - ct)
    }

    /// Where it crosses the future light cone of `event`: where light from there reaches it.
    pub fn receives_from(&self, event: Event<World>) -> Option<Moment> {
        self.where_zero(|e| (e.ct - event.ct) - (e.x - event.x).length())
    }

    /// Where it crosses the past light cone of `event`: where light left it to get there.
    pub fn emits_to(&self, event: Event<World>) -> Option<Moment> {
        self.where_zero(|e| (e.ct - event.ct) + (e.x - event.x).length())
    }
}

fn on_broken(corners: &[(f64, Event<World>)], time: f64) -> Option<(Event<World>, Velocity)> {
    let after = corners.partition_point(|(corner, _)| *corner <= time);
    let after = after.clamp(1, corners.len().checked_sub(1)?);
    let (&(start, a), &(end, b)) = (corners.get(after - 1)?, corners.get(after)?);
    let step = b - a;
    let velocity = Velocity::from_beta(step.x / step.ct).ok()?;
    Some((a + step * ((time - start) / (end - start)), velocity))
}

fn on_sensor(
    line: &WorldLine,
    sensor: &Sensor,
    [forward, film]: [DVec3; 2],
    time: f64,
) -> Option<(Event<World>, Velocity)> {
    let state = line.state(time)?;
    let element = film * -sensor.focal_length;
    let behind = match sensor.assembly {
        Assembly::Bell => Displacement::new(0.0, element),
        // The focal length is stretched, the sensor is not.
        Assembly::Rigid | Assembly::WorldLength => {
            let own = sensor.own_focal_length(forward, state.velocity);
            let offset = Displacement::new(0.0, element - forward * (own - sensor.focal_length));
            state.frame().world_from_frame().displacement(offset)
        }
    };
    Some((state.event + behind, state.velocity))
}
