//! States along a line of constant proper acceleration, from one of them: [`super::thrust`] in the frame comoving there, transformed to the
//! world.
//!
//! Source: the rotation of axes (Thomas) as in Jackson, Classical Electrodynamics, 11.8.

use glam::DVec3;

use super::state::State;
use super::thrust::Thrust;
use crate::spacetime::{Displacement, Event, Velocity, World};

/// The state after proper time `elapsed` with the acceleration of `start`, constant in its comoving axes (carried along without rotation);
/// `None` if the rapidity is above [`crate::spacetime::MAX_RAPIDITY`].
pub(super) fn after(start: &State, elapsed: f64) -> Option<State> {
    let (event, velocity) = place_after(start, elapsed)?;
    let acceleration = turned(start, elapsed, start.acceleration);
    let proper_time = start.proper_time + elapsed;
    Some(State::new(proper_time, event, velocity, acceleration))
}

/// Event and velocity of [`after`] only.
pub(super) fn place_after(start: &State, elapsed: f64) -> Option<(Event<World>, Velocity)> {
    let event = start.event + way(start, elapsed);
    if start.thrust.is_none() {
        return Some((event, start.velocity));
    }
    let Thrust { n, .. } = start.thrust;
    let (phi, _) = start.thrust.rapidity(elapsed);
    let gained = Velocity::from_rapidity_along(phi, n).ok()?;
    // In the start's frame the world moves with the opposite velocity.
    let velocity = gained.relative_to(-start.velocity).ok()?;
    Some((event, velocity))
}

/// The displacement from `start` during proper time `elapsed` of its acceleration.
pub(super) fn way(start: &State, elapsed: f64) -> Displacement<World> {
    let own = start.thrust.displacement(elapsed);
    start.frame().world_from_frame().displacement(own)
}

/// A direction carried along without rotation, in comoving axes, after proper time `elapsed` of the acceleration of `start`, where it is
/// `a`.
///
/// Two successive boosts are a boost after a rotation (Thomas, Wigner): with the halves t₀ = tanh(w₀/2) m and t₁ = tanh(φ/2) n it has the
/// Gibbs vector tan(θ/2) r = −t₀ × t₁ / (1 + t₀·t₁).
pub(super) fn turned(start: &State, elapsed: f64, a: DVec3) -> DVec3 {
    let (phi, _) = start.thrust.rapidity(elapsed);
    let (m, w) = start.velocity.split();
    // Rotation by the Gibbs vector b: a + 2 (b × a + b × (b × a))/(1 + b²).
    let first = m * libm::tanh(0.5 * w);
    let second = start.thrust.n * libm::tanh(0.5 * phi);
    let gibbs = -first.cross(second) / (1.0 + first.dot(second));
    let across = gibbs.cross(a);
    a + (across + gibbs.cross(across)) * (2.0 / (1.0 + gibbs.length_squared()))
}
