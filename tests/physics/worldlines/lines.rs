//! World lines of every kind, with the properties that the tests need.

use glam::DVec3;
use nullray::spacetime::worldline::{Axes, Segment, State, WorldLine};
use nullray::spacetime::{Displacement, Event, Velocity, World};

pub use crate::common::sequence::Sequence;

impl Sequence {
    pub fn sign(&mut self) -> f64 {
        if self.next() < 0.5 { -1.0 } else { 1.0 }
    }
}

pub fn event(ct: f64, x: f64, y: f64, z: f64) -> Event<World> {
    Event::new(ct, DVec3::new(x, y, z))
}

pub fn rapidity(x: f64, y: f64, z: f64) -> Velocity {
    Velocity::from_rapidity(DVec3::new(x, y, z)).unwrap()
}

pub fn segment(duration: f64, x: f64, y: f64, z: f64) -> Segment {
    Segment {
        duration,
        acceleration: DVec3::new(x, y, z),
    }
}

/// A line of each kind, by name, with proper times at which it may be asked.
pub fn every_kind() -> Vec<(&'static str, WorldLine, [f64; 2])> {
    let zero = event(0.3, 1.0, -2.0, 0.5);
    let (velocity, a) = (rapidity(0.4, -0.7, 0.2), DVec3::new(0.3, 0.5, -0.2));
    let segments = [
        segment(1.5, 0.6, 0.0, 0.3),
        segment(0.7, 0.0, 0.0, 0.0),
        segment(2.0, -0.2, 0.9, 0.0),
        segment(1.0, 0.0, -1.0, 0.4),
    ];
    let knots = [
        (-2.0, DVec3::new(0.4, 0.0, 0.1)),
        (-0.5, DVec3::new(0.0, 0.8, 0.0)),
        (1.0, DVec3::new(-0.6, 0.3, 0.2)),
        (3.0, DVec3::new(0.0, -0.9, 0.7)),
    ];
    vec![
        ("inertial", WorldLine::inertial(velocity, zero), [-3.0, 5.0]),
        (
            "hyperbolic",
            WorldLine::hyperbolic(velocity, zero, a).unwrap(),
            [-3.0, 3.0],
        ),
        (
            "segments",
            WorldLine::segments(velocity, zero, &segments).unwrap(),
            [-2.0, 7.0],
        ),
        (
            "profile",
            WorldLine::profile(velocity, zero, &knots, Axes::World).unwrap(),
            [-2.0, 3.0],
        ),
        ("keyframes", turn(), turn().span()),
        // Such that the times of tests away from corners are away from where its acceleration jumps.
        ("polyline", corners(), [0.0, 5.2887]),
        (
            "circular",
            WorldLine::circular(
                zero,
                DVec3::new(0.2, 0.4, -1.0),
                DVec3::new(1.0, 2.0, -0.5),
                0.3,
            )
            .unwrap(),
            [-20.0, 30.0],
        ),
    ]
}

/// Key events of a curve that bends in all directions.
pub fn keys() -> Vec<Event<World>> {
    vec![
        event(-1.0, 0.0, 0.0, 0.0),
        event(1.0, 1.0, 0.4, 0.0),
        event(2.5, 1.2, 1.3, -0.3),
        event(5.0, -0.3, 1.5, 0.4),
        event(6.0, -0.5, 1.2, 1.0),
    ]
}

pub fn turn() -> WorldLine {
    WorldLine::keyframes(&keys()).unwrap()
}

/// Straight between the same events.
pub fn corners() -> WorldLine {
    WorldLine::polyline(&keys()).unwrap()
}

/// The four-velocity (γ, γβ), as (ct, x).
pub fn four_velocity(state: &State) -> (f64, DVec3) {
    let w = state.velocity.rapidity();
    (w.length().cosh(), w.normalize_or_zero() * w.length().sinh())
}

pub fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// The largest coordinate.
pub fn size(e: Event<World>) -> f64 {
    e.ct.abs().max(largest(e.x))
}

pub fn apart(a: Event<World>, b: Event<World>) -> f64 {
    length(a - b)
}

pub fn length(d: Displacement<World>) -> f64 {
    d.ct.abs().max(largest(d.x))
}
