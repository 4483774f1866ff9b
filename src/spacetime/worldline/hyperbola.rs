//! Constant proper acceleration in closed form, in the frame comoving at the start.
//!
//! With proper acceleration g along the unit vector n, rapidity φ = gτ,
//!
//! ```text
//! t = sinh(gτ)/g,   x∥ = (cosh(gτ) − 1)/g,   x⊥ = 0.
//! ```
//!
//! The product gτ and the magnitude g carry their rounding errors along, so that states keep all digits up to
//! the largest rapidities.
//!
//! Source: hyperbolic motion as in Misner, Thorne, Wheeler, Gravitation, ch. 6; the turning of axes
//! (Thomas) as in Jackson, Classical Electrodynamics, 11.8.

use glam::DVec3;

use super::rounding::{length_error, product, quotient};
use super::state::State;
use crate::spacetime::event::unit_and_length;
use crate::spacetime::{Camera, Displacement, Event, Velocity, World};

/// |gτ| below which a few terms of the series are exact to rounding.
pub(super) const SMALL: f64 = 1e-5;

/// A proper acceleration, by magnitude and direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Thrust {
    /// Magnitude g, 1/m.
    pub g: f64,
    /// What rounding left out of g.
    g_error: f64,
    /// Unit direction n; +x where g is 0.
    pub n: DVec3,
}

impl Thrust {
    pub fn new(acceleration: DVec3) -> Self {
        let (n, g) = unit_and_length(acceleration).unwrap_or((DVec3::X, 0.0));
        let g_error = length_error(acceleration, g);
        let exact = g_error != 0.0;
        Thrust {
            g,
            g_error,
            n: if exact {
                quotient(acceleration, g, g_error)
            } else {
                n
            },
        }
    }

    /// Whether there is no acceleration.
    pub fn is_none(&self) -> bool {
        self.g == 0.0
    }

    /// gσ rounded, and what rounding left out.
    fn rapidity(&self, elapsed: f64) -> (f64, f64) {
        let (phi, error) = product(self.g, elapsed);
        (phi, error + self.g_error * elapsed)
    }

    /// The displacement after proper time `elapsed`, in the frame comoving at the start.
    fn displacement(&self, elapsed: f64) -> Displacement<Camera> {
        let (phi, error) = self.rapidity(elapsed);
        if phi.abs() < SMALL {
            let square = phi * phi;
            let along = 0.5 * elapsed * phi * (1.0 + square / 12.0);
            return Displacement::new(elapsed * (1.0 + square / 6.0), self.n * along);
        }
        let (sinh, rise) = sinh_and_rise(phi, error);
        Displacement::new(sinh / self.g, self.n * (rise / self.g))
    }
}

/// sinh(φ + δ) and cosh(φ + δ) − 1 for a small δ: with E = e^|φ| − 1 they are ±½(E + E/(E + 1)) and
/// ½E²/(E + 1).
fn sinh_and_rise(phi: f64, delta: f64) -> (f64, f64) {
    let exp_minus_one = libm::expm1(phi.abs());
    let e = exp_minus_one + delta * phi.signum() * (exp_minus_one + 1.0);
    let ratio = e / (e + 1.0);
    (phi.signum() * 0.5 * (e + ratio), 0.5 * e * ratio)
}

/// The state after proper time `elapsed` of the acceleration of `start`, constant in its comoving axes
/// (carried along without rotation); none where the rapidity is above [`crate::spacetime::MAX_RAPIDITY`].
pub(super) fn after(start: &State, elapsed: f64) -> Option<State> {
    let (event, velocity) = place_after(start, elapsed)?;
    let (phi, _) = start.thrust.rapidity(elapsed);
    let acceleration = turned(start, phi);
    let proper_time = start.proper_time + elapsed;
    Some(State::new(proper_time, event, velocity, acceleration))
}

/// Event and velocity of [`after`] alone.
pub(super) fn place_after(start: &State, elapsed: f64) -> Option<(Event<World>, Velocity)> {
    let Thrust { n, .. } = start.thrust;
    let (phi, _) = start.thrust.rapidity(elapsed);
    let gained = Velocity::along(n, phi).ok()?;
    // In the start's frame the world moves with the opposite velocity.
    let velocity = gained.relative_to(-start.velocity).ok()?;
    Some((start.event + way(start, elapsed), velocity))
}

/// The way from `start` during proper time `elapsed` of its acceleration.
pub(super) fn way(start: &State, elapsed: f64) -> Displacement<World> {
    let own = start.thrust.displacement(elapsed);
    start.frame().world_from_frame().displacement(own)
}

/// The acceleration of `start` in the comoving axes at rapidity `phi` further on.
///
/// Two boosts in a row are a boost after a rotation (Thomas, Wigner): with the halves
/// t₀ = tanh(w₀/2) m and t₁ = tanh(φ/2) n it has the Gibbs vector tan(θ/2) r = −t₀ × t₁ / (1 + t₀·t₁).
fn turned(start: &State, phi: f64) -> DVec3 {
    let (m, w) = start.velocity.split();
    let first = m * libm::tanh(0.5 * w);
    let second = start.thrust.n * libm::tanh(0.5 * phi);
    let gibbs = -first.cross(second) / (1.0 + first.dot(second));
    let a = start.acceleration;
    let across = gibbs.cross(a);
    a + (across + gibbs.cross(across)) * (2.0 / (1.0 + gibbs.length_squared()))
}
