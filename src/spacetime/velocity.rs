//! Velocities below that of light, held as rapidity vectors.
//!
//! w = artanh(β) β̂. Rapidity stays exact where β rounds to 1: at γ = 10⁸, 1 − β is 5·10⁻¹⁷, below
//! the spacing of f64 at 1. Conversions avoid the subtraction that would lose it:
//! γ − 1 = 2 sinh²(|w|/2); from 1 − β = q, |w| = ½ ln((2 − q)/q); from γ = 1 + t,
//! |w| = ln(1 + t + √(t(t + 2))).

use glam::DVec3;

/// The largest rapidity accepted; γ = 1.2·10¹⁷. Beyond it a metre of one frame is less than the
/// rounding of a metre in the other, and no digit of a boosted event is left.
pub const MAX_RAPIDITY: f64 = 40.0;

/// A velocity slower than light: that of a frame, relative to the world.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Velocity {
    rapidity: DVec3,
}

/// Why something is not a velocity.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum VelocityError {
    /// A component is NaN or infinite.
    #[error("a velocity must be finite")]
    NotFinite,
    /// |β| ≥ 1.
    #[error(
        "|β| = {0} is not below 1: nothing with a rest frame moves at or above the speed of light"
    )]
    NotSlowerThanLight(f64),
    /// γ < 1.
    #[error("γ = {0} is below 1, the value of a body at rest")]
    GammaBelowOne(f64),
    /// 1 − β outside (0, 1].
    #[error("1 − β = {0} is not in (0, 1]")]
    OneMinusBeta(f64),
    /// The direction is the zero vector, and the speed is not zero.
    #[error("the direction of motion is the zero vector")]
    NoDirection,
    /// Beyond [`MAX_RAPIDITY`].
    #[error(
        "rapidity {0} is above {MAX_RAPIDITY} (γ = 1.2e17), beyond which f64 coordinates have no digit left"
    )]
    TooFast(f64),
}

impl Velocity {
    /// At rest in the world.
    pub const REST: Velocity = Velocity {
        rapidity: DVec3::ZERO,
    };

    /// From a rapidity vector w, |w| = artanh β.
    pub fn from_rapidity(rapidity: DVec3) -> Result<Self, VelocityError> {
        if !rapidity.is_finite() {
            return Err(VelocityError::NotFinite);
        }
        let magnitude = rapidity.length();
        if magnitude > MAX_RAPIDITY {
            return Err(VelocityError::TooFast(magnitude));
        }
        Ok(Velocity { rapidity })
    }

    /// From β = v/c, |β| < 1.
    pub fn from_beta(beta: DVec3) -> Result<Self, VelocityError> {
        if !beta.is_finite() {
            return Err(VelocityError::NotFinite);
        }
        let magnitude = length(beta);
        if magnitude >= 1.0 {
            return Err(VelocityError::NotSlowerThanLight(magnitude));
        }
        Self::along(beta, libm::atanh(magnitude))
    }

    /// From γ ≥ 1 and a direction (any length but 0).
    pub fn from_gamma(gamma: f64, direction: DVec3) -> Result<Self, VelocityError> {
        if !gamma.is_finite() {
            return Err(VelocityError::NotFinite);
        }
        if gamma < 1.0 {
            return Err(VelocityError::GammaBelowOne(gamma));
        }
        let t = gamma - 1.0;
        Self::along(direction, libm::log1p(t + (t * (t + 2.0)).sqrt()))
    }

    /// From 1 − β in (0, 1] and a direction (any length but 0).
    pub fn from_one_minus_beta(q: f64, direction: DVec3) -> Result<Self, VelocityError> {
        if !(q > 0.0 && q <= 1.0) {
            return Err(VelocityError::OneMinusBeta(q));
        }
        Self::along(direction, 0.5 * libm::log((2.0 - q) / q))
    }

    /// Rapidity `magnitude` along `direction` (any length but 0).
    pub fn along(direction: DVec3, magnitude: f64) -> Result<Self, VelocityError> {
        if !direction.is_finite() || !magnitude.is_finite() {
            return Err(VelocityError::NotFinite);
        }
        if magnitude == 0.0 {
            return Ok(Self::REST);
        }
        let length = length(direction);
        if length == 0.0 {
            return Err(VelocityError::NoDirection);
        }
        Self::from_rapidity(direction / length * magnitude)
    }

    /// The rapidity vector w.
    pub fn rapidity(self) -> DVec3 {
        self.rapidity
    }

    /// β = tanh|w| ŵ. Rounds to unit length at rapidities above 19.
    pub fn beta(self) -> DVec3 {
        let (n, phi) = self.split();
        n * libm::tanh(phi)
    }

    /// γ = cosh|w|.
    pub fn gamma(self) -> f64 {
        libm::cosh(self.split().1)
    }

    /// γ − 1, without cancellation.
    pub fn gamma_minus_one(self) -> f64 {
        let s = libm::sinh(0.5 * self.split().1);
        2.0 * s * s
    }

    /// Whether this is the world's own rest.
    pub fn is_rest(self) -> bool {
        self.rapidity == DVec3::ZERO
    }

    /// The unit direction of motion (+x at rest) and the rapidity |w|.
    pub(crate) fn split(self) -> (DVec3, f64) {
        let phi = length(self.rapidity);
        if phi == 0.0 {
            (DVec3::X, 0.0)
        } else {
            (self.rapidity / phi, phi)
        }
    }
}

impl std::ops::Neg for Velocity {
    type Output = Velocity;
    fn neg(self) -> Velocity {
        Velocity {
            rapidity: -self.rapidity,
        }
    }
}

/// |v| without underflow of the squares of small components.
fn length(v: DVec3) -> f64 {
    let scale = v.abs().max_element();
    if scale == 0.0 {
        0.0
    } else {
        scale * (v / scale).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_ways_to_say_one_velocity_agree() {
        // β = 3/5: γ = 5/4, rapidity ln 2.
        let w = DVec3::new(0.0, 2f64.ln(), 0.0);
        for v in [
            Velocity::from_beta(DVec3::new(0.0, 0.6, 0.0)),
            Velocity::from_gamma(1.25, DVec3::Y * 7.0),
            Velocity::from_one_minus_beta(0.4, DVec3::Y),
            Velocity::from_rapidity(w),
        ] {
            assert!((v.unwrap().rapidity() - w).length() < 2e-16);
        }
    }

    #[test]
    fn the_speed_of_light_is_refused() {
        assert_eq!(
            Velocity::from_beta(DVec3::X),
            Err(VelocityError::NotSlowerThanLight(1.0))
        );
        assert_eq!(
            Velocity::from_gamma(0.5, DVec3::X),
            Err(VelocityError::GammaBelowOne(0.5))
        );
        assert_eq!(
            Velocity::from_one_minus_beta(0.0, DVec3::X),
            Err(VelocityError::OneMinusBeta(0.0))
        );
        assert_eq!(
            Velocity::from_beta(DVec3::NAN),
            Err(VelocityError::NotFinite)
        );
        assert_eq!(
            Velocity::from_gamma(2.0, DVec3::ZERO),
            Err(VelocityError::NoDirection)
        );
        assert!(Velocity::from_rapidity(DVec3::X * 41.0).is_err());
    }

    #[test]
    fn a_body_at_rest_needs_no_direction() {
        assert_eq!(Velocity::from_gamma(1.0, DVec3::ZERO), Ok(Velocity::REST));
        assert_eq!(Velocity::from_beta(DVec3::ZERO), Ok(Velocity::REST));
    }
}
