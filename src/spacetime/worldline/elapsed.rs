//! Proper time in the form that light cones give, converted to a number only on demand.

use super::thrust::SMALL;

/// Proper time since a start, in the closed form's terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Elapsed {
    /// Proper time at the start.
    pub start: f64,
    /// (e^(gτ) − 1)/g.
    pub y: f64,
    /// e^(gτ).
    pub z: f64,
    /// Proper acceleration.
    pub g: f64,
}

impl Elapsed {
    /// Proper time `start` + `elapsed`.
    pub fn known(start: f64, elapsed: f64) -> Self {
        Elapsed {
            start,
            y: elapsed,
            z: 1.0,
            g: 0.0,
        }
    }

    pub fn proper_time(&self) -> f64 {
        let Elapsed { start, y, z, g } = *self;
        // ln(1 + u)/g: by its series for small u, otherwise from y or z, whichever has the digits.
        let u = g * y;
        start
            + if u.abs() < SMALL {
                // The next term is u⁴/5, below 10⁻²⁰.
                y * (1.0 - u * (1.0 / 2.0 - u * (1.0 / 3.0 - u / 4.0)))
            } else if is_near(z) {
                libm::log1p(u) / g
            } else {
                libm::log(z) / g
            }
    }
}

/// Whether z = e^(gτ) is computed from y, rather than y from z.
#[inline]
pub(super) fn is_near(z: f64) -> bool {
    (0.5..2.0).contains(&z)
}
