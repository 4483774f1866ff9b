//! Motion at constant speed around an axis.
//!
//! With the vector r from the axis to the position, the axis a and the phase θ = Ω Δct,
//!
//! ```text
//! x(ct) − x(0) = r (cos θ − 1) + (a × r) sin θ,    v = Ω a × r,    γ² = 1/((1 − ΩR)(1 + ΩR)),    τ = ct/γ.
//! ```
//!
//! The proper acceleration −γ²Ω² r is perpendicular to the velocity, and the same in comoving axes. The displacement between two events
//! of the line depends only on the phase of the first and on the difference, so that it keeps its digits; cos θ − 1 = −2 sin²(θ/2).

use std::f64::consts::TAU;

use glam::DVec3;

use super::cone::past_cone;
use super::elapsed::Elapsed;
use super::error::WorldLineError;
use super::horizon;
use super::root;
use super::rounding::product;
use super::series::delay_left;
use super::state::{Crossing, State};
use crate::spacetime::event::unit_and_length;
use crate::spacetime::{Displacement, Event, Velocity, World};

/// A helix in space-time.
#[derive(Debug, Clone)]
pub(super) struct Circular {
    zero: Event<World>,
    axis: DVec3,
    /// From the axis to the position at proper time 0.
    radial: DVec3,
    /// Ω, radians per metre of world time.
    rate: f64,
    /// |ΩR|.
    speed: f64,
    gamma: f64,
}

impl Circular {
    pub fn new(
        zero: Event<World>,
        centre: DVec3,
        axis: DVec3,
        rate: f64,
    ) -> Result<Self, WorldLineError> {
        if !(centre.is_finite() && axis.is_finite()) {
            return Err(WorldLineError::NotFinite("centre and axis"));
        }
        if !rate.is_finite() {
            return Err(WorldLineError::NotFinite("a rate of rotation"));
        }
        let (axis, _) = unit_and_length(axis).ok_or(WorldLineError::NoAxis)?;
        let arm = zero.x - centre;
        let radial = arm - axis * axis.dot(arm);
        // The rounding error of an arm along the axis is not a radius.
        let noise = 8.0 * f64::EPSILON * (zero.x.abs() + centre.abs()).max_element();
        let radius = radial.length();
        if radius <= noise {
            return Err(WorldLineError::OnAxis);
        }
        let speed = (rate * radius).abs();
        if speed >= 1.0 || speed.is_nan() {
            return Err(WorldLineError::RimTooFast { speed });
        }
        // A product for γ: 1 − v² would lose digits near the speed of light.
        Ok(Circular {
            zero,
            axis,
            radial,
            rate,
            speed,
            gamma: 1.0 / ((1.0 - speed) * (1.0 + speed)).sqrt(),
        })
    }

    /// The proper time of a revolution; `None` at rest.
    pub fn period(&self) -> Option<f64> {
        let period = TAU / (self.rate.abs() * self.gamma);
        period.is_finite().then_some(period)
    }

    pub fn state(&self, proper_time: f64) -> Option<State> {
        let elapsed = self.gamma * proper_time;
        let radial = self.radial_at(elapsed);
        let moved = Displacement::new(elapsed, self.chord(self.radial, self.phase(elapsed)));
        let velocity = self.axis.cross(radial) * self.rate;
        let velocity = match self.speed {
            0.0 => Velocity::REST,
            speed => Velocity::from_rapidity_along(libm::atanh(speed), velocity).ok()?,
        };
        // −γ²Ω² r.
        let pull = self.gamma * self.rate;
        let acceleration = radial * (-pull * pull);
        let event = self.zero + moved;
        Some(State::new(proper_time, event, velocity, acceleration))
    }

    /// As [`super::WorldLine::beyond_horizon`].
    pub fn beyond_horizon(&self, [from, to]: [f64; 2], points: &[DVec3]) -> Option<DVec3> {
        // A revolution at most, in thirds.
        let turned = self.rate * self.gamma * (to - from);
        let third = turned.clamp(-TAU, TAU) / 3.0;
        let (radial, pull) = (self.radial_at(self.gamma * from), self.gamma * self.rate);
        let acceleration = |phase| (radial + self.chord(radial, (phase, 0.0))) * (-pull * pull);
        (0..3).map(f64::from).find_map(|k| {
            let ends = [k * third, (k + 1.0) * third].map(acceleration);
            horizon::beyond_arc(ends, self.axis * self.rate, points)
        })
    }

    pub fn past_cone(&self, near: &State, offset: Displacement<World>) -> Option<Crossing> {
        let guess = past_cone(near, offset).map_or(f64::NAN, |c| c.displacement.ct);
        let radial = self.radial_at(self.gamma * near.proper_time);
        let (s, displacement) = self.crossed(radial, offset, guess);
        let elapsed = Elapsed::known(near.proper_time, s / self.gamma);
        Some(Crossing::new(near.event, displacement, elapsed))
    }

    pub fn past_cone_of(&self, apex: Event<World>) -> Option<Crossing> {
        // Start from the line's position at the apex's own time.
        let elapsed = apex.ct - self.zero.ct;
        let moved = self.chord(self.radial, self.phase(elapsed));
        let offset = Displacement::new(0.0, (apex.x - self.zero.x) - moved);
        let (s, displacement) = self.crossed(self.radial_at(elapsed), offset, f64::NAN);
        let elapsed = Elapsed::known(elapsed / self.gamma, s / self.gamma);
        Some(Crossing::new(apex, displacement - offset, elapsed))
    }

    /// World time and displacement from the point where the line is `radial` from the axis to the point where it crosses the past light
    /// cone of the event at `offset` from there.
    fn crossed(
        &self,
        radial: DVec3,
        offset: Displacement<World>,
        guess: f64,
    ) -> (f64, Displacement<World>) {
        let s = root::decreasing(self.bracket(offset), guess, |s| {
            let (moved, tangent) = self.way(radial, s);
            delay_left(offset, moved, tangent)
        });
        (s, self.way(radial, s).0)
    }

    /// T − R − s changes by at most |ΩR| |s| up to s, and by at most 2R.
    fn bracket(&self, offset: Displacement<World>) -> [f64; 2] {
        let left = offset.ct - offset.x.length();
        // s is between left/(1 ± |ΩR|), and between left ± 2R; widened by the rounding errors.
        let (near, far) = (left / (1.0 + self.speed), left / (1.0 - self.speed));
        let diameter = 2.0 * self.radial.length();
        let slack = 4.0 * f64::EPSILON * (offset.ct.abs() + offset.x.length() + diameter);
        [
            near.min(far).max(left - diameter) - slack,
            near.max(far).min(left + diameter) + slack,
        ]
    }

    /// The displacement from the point where the line is `radial` from the axis, and the tangent per world time at its end.
    fn way(&self, radial: DVec3, s: f64) -> (Displacement<World>, Displacement<World>) {
        let chord = self.chord(radial, self.phase(s));
        let velocity = self.axis.cross(radial + chord) * self.rate;
        (
            Displacement::new(s, chord),
            Displacement::new(1.0, velocity),
        )
    }

    /// The phase after world time `elapsed`, and its rounding error.
    fn phase(&self, elapsed: f64) -> (f64, f64) {
        product(self.rate, elapsed)
    }

    fn radial_at(&self, elapsed: f64) -> DVec3 {
        self.radial + self.chord(self.radial, self.phase(elapsed))
    }

    /// The change of the position at `radial` from the axis when rotated by a phase.
    fn chord(&self, radial: DVec3, (phase, error): (f64, f64)) -> DVec3 {
        let (sin, cos) = libm::sincos(0.5 * phase);
        // To second order: at 10¹⁰ radians the error is 10⁻⁶.
        let half = 0.5 * error;
        let square = 0.5 * half * half;
        let (sin, cos) = (
            sin + (half * cos - square * sin),
            cos - (half * sin + square * cos),
        );
        (self.axis.cross(radial) * cos - radial * sin) * (2.0 * sin)
    }
}
