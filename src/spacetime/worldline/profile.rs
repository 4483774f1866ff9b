//! Motion by a given proper acceleration over proper time: an initial-value problem.
//!
//! The equations and their series are those of [`super::taylor`], stepped from proper time 0 to both ends, with a new step at each knot.
//! The result is a piecewise polynomial in proper time, accurate to a few eps per step of the largest coordinate involved.

use glam::{DVec3, DVec4};

use super::arcs;
use super::cone::past_cone;
use super::elapsed::Elapsed;
use super::error::{WorldLineError, check_ascending, check_count};
use super::horizon::{self, Around};
use super::rounding::sum;
use super::series::{Piece, Series, SeriesCrossing};
use super::state::{Crossing, State};
use super::taylor::{self, Step};
use crate::spacetime::{Displacement, Event, MAX_RAPIDITY, Velocity, World};

/// The maximum number of steps in either direction: at most 120 MB of coefficients.
const MAX_STEPS: usize = 150_000;

/// The axes to which accelerations refer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Axes {
    /// Those of a gyroscope: carried along without rotation from proper time 0 on, where they are the comoving
    /// frame's, so that it makes no difference where a stretch is split.
    #[default]
    Gyroscope,
    /// The world's, boosted without rotation, at each moment: those of the camera's own frame. They are the same as the
    /// gyroscope's as long as the acceleration is along the velocity.
    World,
}

/// Knots and the motion between them, as functions of proper time.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    axes: Axes,
    knots: Vec<(f64, DVec3)>,
    series: Series,
}

impl Profile {
    pub fn new(
        velocity: Velocity,
        zero: Event<World>,
        knots: &[(f64, DVec3)],
        axes: Axes,
    ) -> Result<Self, WorldLineError> {
        check_count(knots.len())?;
        for (index, (time, acceleration)) in knots.iter().enumerate() {
            arcs::check(*acceleration, Some(index))?;
            if !time.is_finite() {
                return Err(WorldLineError::EntryNotFinite { index });
            }
        }
        check_ascending(knots.iter().map(|(time, _)| *time))?;
        let (first, last) = (knots[0].0, knots[knots.len() - 1].0);
        if !(first..=last).contains(&0.0) {
            return Err(WorldLineError::ZeroOutside { first, last });
        }
        let series = integrate(velocity, zero, knots, axes)?;
        Ok(Profile {
            axes,
            knots: knots.to_vec(),
            series,
        })
    }

    pub fn span(&self) -> [f64; 2] {
        self.series.span()
    }

    pub fn state(&self, proper_time: f64) -> Option<State> {
        let (event, tangent) = self.series.at(proper_time);
        let rapidity = libm::asinh(tangent.x.length());
        let velocity = match rapidity {
            0.0 => Velocity::REST,
            _ => Velocity::from_rapidity_along(rapidity, tangent.x).ok()?,
        };
        let acceleration = match self.axes {
            Axes::World => acceleration(&self.knots, proper_time),
            // a = U̇ − U (U·U̇)/(γ(1 + γ)): U̇ with its part along the motion divided by γ.
            Axes::Gyroscope => {
                let (n, _) = velocity.split();
                let change = self.series.second(proper_time);
                change - n * (change.dot(n) * (1.0 - 1.0 / velocity.gamma()))
            }
        };
        Some(State::new(proper_time, event, velocity, acceleration))
    }

    /// As [`super::WorldLine::beyond_horizon`].
    pub fn beyond_horizon(&self, times: [f64; 2], points: &[DVec3]) -> Option<DVec3> {
        let nodes = self.knots.iter().map(|(time, _)| *time);
        if self.axes == Axes::World {
            // Linear between knots, so a·p is least at one of them or at an end.
            let inner = nodes.filter(|time| times[0] < *time && *time < times[1]);
            let mut all = inner
                .chain(times)
                .map(|time| acceleration(&self.knots, time));
            return all.find(|a| horizon::is_reached(*a, points));
        }
        horizon::beyond(times, nodes, points, |middle, half| {
            let state = self.state(middle)?;
            let span = span_at(&self.knots, middle);
            let ((t0, a0), (t1, a1)) = (self.knots[span], self.knots[span + 1]);
            let slope = (a1 - a0).length() / (t1 - t0);
            let (n, phi) = state.velocity.split();
            let precession = state.acceleration.cross(n * libm::tanh(0.5 * phi)).length();
            let most = state.acceleration.length() + slope * half;
            let turning = most.min(precession + (slope + 1.5 * most * most) * half);
            Some(Around {
                acceleration: state.acceleration,
                radius: (slope + most * turning) * half,
            })
        })
    }

    pub fn past_cone(&self, near: &State, offset: Displacement<World>) -> Option<Crossing> {
        let start = near.proper_time;
        // As if the acceleration stayed the same as at `near`.
        let guess = past_cone(near, offset).map_or(f64::NAN, |c| c.proper_time() - start);
        let found = self.series.past_cone(near.event, start, offset, guess)?;
        Some(crossing(near.event, found))
    }

    pub fn past_cone_of(&self, apex: Event<World>) -> Option<Crossing> {
        Some(crossing(apex, self.series.past_cone_of(apex)?))
    }
}

fn crossing(reference: Event<World>, found: SeriesCrossing) -> Crossing {
    let elapsed = Elapsed::known(found.parameter, 0.0);
    Crossing::new(reference, found.displacement, elapsed)
}

/// The span of the knots that contains a proper time, the later one at a knot.
fn span_at(knots: &[(f64, DVec3)], proper_time: f64) -> usize {
    knots[1..knots.len() - 1].partition_point(|(time, _)| *time <= proper_time)
}

/// The acceleration at a proper time, linear between the knots.
fn acceleration(knots: &[(f64, DVec3)], proper_time: f64) -> DVec3 {
    let index = span_at(knots, proper_time);
    let ((t0, a0), (t1, a1)) = (knots[index], knots[index + 1]);
    let u = (proper_time - t0) / (t1 - t0);
    a0 * (1.0 - u) + a1 * u
}

fn integrate(
    velocity: Velocity,
    zero: Event<World>,
    knots: &[(f64, DVec3)],
    axes: Axes,
) -> Result<Series, WorldLineError> {
    let (n, phi) = velocity.split();
    let start = n * libm::sinh(phi);
    // From proper time 0 to the first knot, and to the last.
    let middle = span_at(knots, 0.0);
    let mut before = Walk::new(zero, start, axes);
    for index in (0..=middle).rev() {
        before.along(knots, index, knots[index].0)?;
    }
    let mut after = Walk::new(zero, start, axes);
    for index in middle..knots.len() - 1 {
        after.along(knots, index, knots[index + 1].0)?;
    }
    Ok(joined(before, after))
}

/// A sum of many terms, and its accumulated rounding error.
struct Sum {
    value: DVec4,
    rest: DVec4,
}

impl Sum {
    fn new(value: DVec4) -> Self {
        Sum {
            value,
            rest: DVec4::ZERO,
        }
    }

    fn add(&mut self, term: DVec4) {
        for i in 0..4 {
            let (value, rest) = sum(self.value[i], term[i] + self.rest[i]);
            (self.value[i], self.rest[i]) = (value, rest);
        }
    }
}

/// The steps from proper time 0 on, in one direction.
struct Walk {
    /// Proper time and event before the first step, and after each one.
    nodes: Vec<(f64, Event<World>)>,
    steps: Vec<Step>,
    /// (x, y, z, ct) after the last step.
    position: Sum,
    /// U after the last step.
    u: Sum,
    /// The axes of the accelerations there, and whether they are carried along.
    axes: [DVec3; 3],
    carried: bool,
}

impl Walk {
    fn new(zero: Event<World>, u: DVec3, axes: Axes) -> Self {
        Walk {
            nodes: vec![(0.0, zero)],
            steps: Vec::new(),
            position: Sum::new(zero.x.extend(zero.ct)),
            u: Sum::new(u.extend(0.0)),
            axes: DVec3::AXES,
            carried: axes == Axes::Gyroscope,
        }
    }

    /// Steps to proper time `target` within span `index` of the knots.
    fn along(
        &mut self,
        knots: &[(f64, DVec3)],
        index: usize,
        target: f64,
    ) -> Result<(), WorldLineError> {
        let ((t0, a0), (t1, a1)) = (knots[index], knots[index + 1]);
        let slope = (a1 - a0) / (t1 - t0);
        let mut time = self.nodes[self.nodes.len() - 1].0;
        while time != target {
            let a = acceleration(&knots[index..=index + 1], time);
            // One step of the series, cut at the knot.
            let u = self.u.value.truncate();
            let step = taylor::step(u, (self.axes, self.carried), a, slope, target - time);
            // The last step ends at the knot itself, not at a rounded sum of steps.
            let whole = step.length == target - time;
            let next = if whole { target } else { time + step.length };
            if next == time || self.steps.len() == MAX_STEPS {
                return Err(WorldLineError::TooLong {
                    index,
                    proper_time: time,
                });
            }
            self.take(step, next);
            let u = self.u.value.truncate();
            // |U| = sinh φ.
            if u.length() > libm::sinh(MAX_RAPIDITY) || !u.is_finite() {
                return Err(WorldLineError::TooFast {
                    index,
                    proper_time: next,
                });
            }
            time = next;
        }
        Ok(())
    }

    fn take(&mut self, step: Step, time: f64) {
        // Small terms first.
        self.position.add(step.coefficients.iter().rev().sum());
        self.u.add(step.gained.extend(0.0));
        self.axes = step.axes;
        let Sum { value, .. } = self.position;
        self.nodes
            .push((time, Event::new(value.w, value.truncate())));
        self.steps.push(step);
    }
}

/// The walk to the beginning, reversed, followed by that to the end.
fn joined(before: Walk, after: Walk) -> Series {
    // Both walks begin with the event at proper time 0: use it once.
    let nodes = before.nodes.iter().skip(1).rev().chain(&after.nodes);
    let (parameters, events) = nodes.copied().unzip();
    let mut series = Series {
        parameters,
        events,
        ..Series::default()
    };
    // A piece in the past has its centre at its end.
    for (number, step) in before.steps.iter().rev().enumerate() {
        push(&mut series, number + 1, step);
    }
    for (number, step) in after.steps.iter().enumerate() {
        push(&mut series, before.steps.len() + number, step);
    }
    series
}

fn push(series: &mut Series, centre: usize, step: &Step) {
    series.pieces.push(Piece {
        centre,
        scale: step.length,
        first: series.coefficients.len(),
        count: step.coefficients.len(),
    });
    series.coefficients.extend_from_slice(&step.coefficients);
}
