//! The numbers of a probe, for people and for programs.

use std::fmt;

use glam::DVec3;
use serde::{Serialize, Serializer};

use super::{Probe, ProbeHit};
use crate::spacetime::units::quoted;
use crate::spacetime::{self, Direction, Event, InertialFrame, Velocity, World};

pub(super) fn event<S: Serializer>(event: &Event<World>, s: S) -> Result<S::Ok, S::Error> {
    event.to_array().serialize(s)
}

pub(super) fn maybe_event<S: Serializer>(
    event: &Option<Event<World>>,
    s: S,
) -> Result<S::Ok, S::Error> {
    event.map(Event::to_array).serialize(s)
}

pub(super) fn vector<S: Serializer>(vector: &DVec3, s: S) -> Result<S::Ok, S::Error> {
    vector.to_array().serialize(s)
}

pub(super) fn direction<S: Serializer>(
    direction: &Direction<World>,
    s: S,
) -> Result<S::Ok, S::Error> {
    vector(&direction.unit(), s)
}

/// β, and the rapidity: β rounds to 1 from γ ≈ 10⁸ on.
pub(super) fn velocity<S: Serializer>(velocity: &Velocity, s: S) -> Result<S::Ok, S::Error> {
    let [beta, rapidity] = [velocity.beta(), velocity.rapidity()].map(|v| v.to_array());
    s.collect_map([("beta", beta), ("rapidity", rapidity)])
}

pub(super) fn frame<S: Serializer>(
    frame: &InertialFrame<spacetime::CameraFrame>,
    s: S,
) -> Result<S::Ok, S::Error> {
    let velocity = frame.velocity();
    let [beta, rapidity] = [velocity.beta(), velocity.rapidity()].map(|v| v.to_array());
    s.collect_map([("camera_beta", beta), ("camera_rapidity", rapidity)])
}

/// The power of ten of a number that has seven digits.
fn exponent(number: f64) -> i32 {
    let text = format!("{number:.6e}");
    let power = text
        .split_once('e')
        .and_then(|(_, power)| power.parse().ok());
    power.unwrap_or(0)
}

/// A number with seven digits.
fn digits(number: f64) -> String {
    match exponent(number) {
        power @ -4..=6 => format!("{number:.0$}", (6 - power) as usize),
        _ => format!("{number:.6e}"),
    }
}

/// Numbers in brackets, all to the last of seven digits of the largest.
fn tuple<const N: usize>(numbers: [f64; N]) -> String {
    let largest = numbers.iter().fold(0.0, |most: f64, n| most.max(n.abs()));
    let power = exponent(largest);
    let (scale, places, times) = match power {
        -4..=6 => (1.0, (6 - power) as usize, String::new()),
        _ => (
            libm::pow(10.0, f64::from(power)),
            6,
            format!(" × 1e{power}"),
        ),
    };
    let numbers = numbers.map(|number| format!("{:.places$}", number / scale));
    format!("({}){times}", numbers.join(", "))
}

/// A line about what moves: β alone does not tell great speeds apart.
fn moves(f: &mut fmt::Formatter<'_>, what: &str, velocity: Velocity) -> fmt::Result {
    if velocity.is_rest() {
        return Ok(());
    }
    let (beta, gamma) = (tuple(velocity.beta().to_array()), digits(velocity.gamma()));
    writeln!(f, "  {what:<14}β {beta}, γ = {gamma}")
}

impl fmt::Display for Probe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [column, row] = self.pixel;
        writeln!(
            f,
            "pixel {column},{row}: events (ct, x, y, z) in the world, metres"
        )?;
        let arrival = &self.reception;
        let mut passed = |what: &str, event: &Event<World>, clock: f64| {
            let event = tuple(event.to_array());
            writeln!(f, "  {what:<14}{event}, camera's clock {}", digits(clock))
        };
        passed("reception", &arrival.event, arrival.time)?;
        if arrival.pinhole != arrival.event {
            passed("pinhole", &arrival.pinhole, arrival.pinhole_time)?;
        }
        moves(f, "camera moves", arrival.frame.velocity())?;
        let along = tuple(self.direction.unit().to_array());
        writeln!(f, "  looks along   {along}")?;
        if self.index != 1.0 {
            writeln!(f, "  light takes   {} m of ct per metre", self.index)?;
        }
        match &self.hit {
            Some(hit) => hit.fmt(f),
            None => writeln!(f, "  meets nothing"),
        }
    }
}

impl fmt::Display for ProbeHit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, emission) = (quoted(&self.name), tuple(self.emission.to_array()));
        writeln!(f, "  meets         {name}, triangle {}", self.triangle)?;
        writeln!(
            f,
            "  emission      {emission}, object's clock {}",
            digits(self.time)
        )?;
        moves(f, "object moves", self.velocity)?;
        writeln!(f, "  distance      {}", digits(self.distance))?;
        writeln!(f, "  W = λ′/λ      {}", digits(self.ratio))?;
        let nows = [
            ("now, camera ", &self.now),
            ("now, world  ", &self.now_in_world),
        ];
        for (what, event) in nows {
            if let Some(event) = event {
                writeln!(f, "  {what}  {}", tuple(event.to_array()))?;
            }
        }
        for pulse in &self.pulses {
            let (name, left) = (quoted(&pulse.name), tuple(pulse.left.to_array()));
            let (share, after) = (100.0 * pulse.share, pulse.deviations);
            writeln!(
                f,
                "  lit by        {name} to {share:.1} %: left {left}, {after:+.2} σ from the pulse's centre"
            )?;
        }
        Ok(())
    }
}
