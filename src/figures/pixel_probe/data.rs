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

pub(super) fn velocity<S: Serializer>(velocity: &Velocity, s: S) -> Result<S::Ok, S::Error> {
    vector(&velocity.beta(), s)
}

pub(super) fn frame<S: Serializer>(
    frame: &InertialFrame<spacetime::CameraFrame>,
    s: S,
) -> Result<S::Ok, S::Error> {
    velocity(&frame.velocity(), s)
}

/// Numbers to six digits after the point, in brackets.
fn tuple<const N: usize>(numbers: [f64; N]) -> String {
    let numbers = numbers.map(|number| format!("{number:.6}"));
    format!("({})", numbers.join(", "))
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
            writeln!(f, "  {what:<14}{event}, camera's clock {clock:.6}")
        };
        passed("reception", &arrival.event, arrival.time)?;
        if arrival.pinhole != arrival.event {
            passed("pinhole", &arrival.pinhole, arrival.pinhole_time)?;
        }
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
            "  emission      {emission}, object's clock {:.6}",
            self.time
        )?;
        writeln!(f, "  distance      {:.6}", self.distance)?;
        writeln!(f, "  W = λ′/λ      {:.6}", self.ratio)?;
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
