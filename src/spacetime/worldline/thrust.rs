//! A proper acceleration g along n, and hyperbolic motion under it in the frame comoving at its start.
//!
//! With the rapidity φ = gτ,
//!
//! ```text
//! t = sinh(gτ)/g,   x∥ = (cosh(gτ) − 1)/g,   x⊥ = 0.
//! ```
//!
//! The product gτ and the magnitude g carry their rounding errors along, so that states keep all digits up to the largest rapidities.
//!
//! Source: hyperbolic motion as in Misner, Thorne, Wheeler, Gravitation, ch. 6.

use glam::DVec3;

use super::rounding::{length_error, product, quotient};
use crate::spacetime::event::unit_and_length;
use crate::spacetime::{CameraFrame, Displacement};

/// |gτ| below which a few terms of the series are exact to rounding.
pub(super) const SMALL: f64 = 1e-5;

/// A proper acceleration, by magnitude and direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Thrust {
    /// Magnitude g, 1/m.
    pub g: f64,
    /// The rounding error of g.
    g_error: f64,
    /// Unit direction n; +x where g is 0.
    pub n: DVec3,
}

impl Thrust {
    pub fn new(acceleration: DVec3) -> Self {
        let (n, g) = unit_and_length(acceleration).unwrap_or((DVec3::X, 0.0));
        let g_error = length_error(acceleration, g);
        // If there is no error to correct, the plain quotient is as good.
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

    /// gσ rounded, and its rounding error.
    pub fn rapidity(&self, elapsed: f64) -> (f64, f64) {
        let (phi, error) = product(self.g, elapsed);
        (phi, error + self.g_error * elapsed)
    }

    /// The displacement after proper time `elapsed`, in the frame comoving at the start.
    pub fn displacement(&self, elapsed: f64) -> Displacement<CameraFrame> {
        let (phi, error) = self.rapidity(elapsed);
        // sinh φ/g and (cosh φ − 1)/g; by their series, with φ⁴ below rounding, where the quotients lose digits.
        if phi.abs() < SMALL {
            let square = phi * phi;
            let along = 0.5 * elapsed * phi * (1.0 + square / 12.0);
            return Displacement::new(elapsed * (1.0 + square / 6.0), self.n * along);
        }
        let (sinh, rise) = sinh_and_rise(phi, error);
        Displacement::new(sinh / self.g, self.n * (rise / self.g))
    }
}

/// sinh(φ + δ) and cosh(φ + δ) − 1 for a small δ: with E = e^|φ| − 1 they are ±½(E + E/(E + 1)) and ½E²/(E + 1).
fn sinh_and_rise(phi: f64, delta: f64) -> (f64, f64) {
    // E of |φ| + δ, to first order in δ.
    let exp_minus_one = libm::expm1(phi.abs());
    let e = exp_minus_one + delta * phi.signum() * (exp_minus_one + 1.0);
    let ratio = e / (e + 1.0);
    (phi.signum() * 0.5 * (e + ratio), 0.5 * e * ratio)
}
