//! Velocities below that of light, held as rapidity vectors.
//!
//! w = artanh(β) β̂. Rapidity stays exact even if β rounds to 1: at γ = 10⁸, 1 − β is 5·10⁻¹⁷, below the spacing of f64 at 1. Conversions
//! avoid the subtraction that would lose it: γ − 1 = 2 sinh²(|w|/2), both ways; from 1 − β = q, |w| = ½ (ln(2 − q) − ln q), or artanh(1 −
//! q) if q is near 1.

use glam::DVec3;

use super::event::{Displacement, Frame, Parts, unit_and_length};

/// The largest rapidity accepted; γ = 1.2·10¹⁷. Beyond it a metre in one frame is less than the rounding error of a metre in the other, and
/// a boosted event has no digits left.
pub const MAX_RAPIDITY: f64 = 40.0;

/// A velocity slower than light, of a frame relative to the world.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Velocity {
    rapidity: DVec3,
}

/// Why something is not a valid velocity.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
        "rapidity {0} is above {MAX_RAPIDITY} (γ = 1.2e17), beyond which f64 coordinates have no digits left"
    )]
    TooFast(f64),
}

crate::error::value_errors!(VelocityError);

impl Velocity {
    /// At rest in the world.
    pub const REST: Velocity = Velocity {
        rapidity: DVec3::ZERO,
    };

    /// From a rapidity vector w, |w| = artanh β.
    ///
    /// # Errors
    /// A vector that is not finite, or longer than [`MAX_RAPIDITY`].
    pub fn from_rapidity(rapidity: DVec3) -> Result<Self, VelocityError> {
        if !rapidity.is_finite() {
            return Err(VelocityError::NotFinite);
        }
        let magnitude = unit_and_length(rapidity).map_or(0.0, |(_, length)| length);
        if magnitude > MAX_RAPIDITY {
            return Err(VelocityError::TooFast(magnitude));
        }
        Ok(Velocity { rapidity })
    }

    /// From β = v/c, |β| < 1. Near 1, β retains few digits of 1 − β: use γ or 1 − β there.
    ///
    /// # Errors
    /// A vector that is not finite, or not shorter than 1.
    pub fn from_beta(beta: DVec3) -> Result<Self, VelocityError> {
        if !beta.is_finite() {
            return Err(VelocityError::NotFinite);
        }
        let magnitude = unit_and_length(beta).map_or(0.0, |(_, length)| length);
        if magnitude >= 1.0 {
            return Err(VelocityError::NotSlowerThanLight(magnitude));
        }
        Self::from_rapidity_along(libm::atanh(magnitude), beta)
    }

    /// From γ ≥ 1 and a direction (any length but 0).
    ///
    /// # Errors
    /// Numbers that are not finite, γ < 1, a rapidity above [`MAX_RAPIDITY`], or a zero direction unless γ = 1.
    pub fn from_gamma(gamma: f64, direction: DVec3) -> Result<Self, VelocityError> {
        if !gamma.is_finite() {
            return Err(VelocityError::NotFinite);
        }
        if gamma < 1.0 {
            return Err(VelocityError::GammaBelowOne(gamma));
        }
        // γ − 1 = 2 sinh²(φ/2): no digit of a small γ − 1 is lost.
        Self::from_rapidity_along(2.0 * libm::asinh((0.5 * (gamma - 1.0)).sqrt()), direction)
    }

    /// From 1 − β in (0, 1] and a direction (any length but 0).
    ///
    /// # Errors
    /// 1 − β out of range, a rapidity above [`MAX_RAPIDITY`], a direction that is not finite, or a zero direction unless 1 − β = 1.
    pub fn from_one_minus_beta(q: f64, direction: DVec3) -> Result<Self, VelocityError> {
        if !(q > 0.0 && q <= 1.0) {
            return Err(VelocityError::OneMinusBeta(q));
        }
        // artanh(1 − q) = ½ ln((2 − q)/q).
        let magnitude = if q < 0.5 {
            0.5 * (libm::log(2.0 - q) - libm::log(q))
        } else {
            libm::atanh(1.0 - q) // 1 − q is exact here
        };
        Self::from_rapidity_along(magnitude, direction)
    }

    /// From the rapidity artanh β and a direction (any length but 0); a negative rapidity is motion against the direction.
    ///
    /// # Errors
    /// Numbers that are not finite, a rapidity beyond ±[`MAX_RAPIDITY`], or a zero direction unless the rapidity is 0.
    pub fn from_rapidity_along(rapidity: f64, direction: DVec3) -> Result<Self, VelocityError> {
        if !direction.is_finite() || !rapidity.is_finite() {
            return Err(VelocityError::NotFinite);
        }
        if rapidity == 0.0 {
            return Ok(Self::REST);
        }
        if rapidity.abs() > MAX_RAPIDITY {
            return Err(VelocityError::TooFast(rapidity.abs()));
        }
        let (unit, _) = unit_and_length(direction).ok_or(VelocityError::NoDirection)?;
        Ok(Velocity {
            rapidity: unit * rapidity,
        })
    }

    /// This velocity as seen from a frame that moves with `observer`, both relative to the world.
    ///
    /// Components refer to the axes of that frame, which are the world's, boosted without rotation. Collinear rapidities subtract.
    ///
    /// # Errors
    /// A relative rapidity above [`MAX_RAPIDITY`].
    pub fn relative_to(self, observer: Velocity) -> Result<Velocity, VelocityError> {
        if observer.is_rest() {
            return Ok(self);
        }
        let proper = self.proper_from(observer);
        unit_and_length(proper).map_or(Ok(Self::REST), |(unit, length)| {
            Self::from_rapidity_along(libm::asinh(length), unit)
        })
    }

    /// The four-velocity (γ′, γ′β′) as seen from a frame `F` that moves with `observer`, without bounds on its rapidity: (1, 0) if the two
    /// are equal.
    pub(super) fn four_velocity_from<F: Frame>(self, observer: Velocity) -> Displacement<F> {
        let proper = self.proper_from(observer);
        Displacement::new((1.0 + proper.length_squared()).sqrt(), proper)
    }

    /// γ′β′ of this velocity as seen from a frame that moves with `observer`.
    fn proper_from(self, observer: Velocity) -> DVec3 {
        // γ′β′ = Λ⁻¹ (γ, γβ); its component along the observer's motion is computed from sinh(φ ∓ ψ).
        let (n, phi) = self.split();
        let (m, psi) = observer.split();
        let parts = Parts::of(n, m);
        let sinh = libm::sinh(phi);
        // sinh φ cosh ψ c − cosh φ sinh ψ with c = n·m, arranged about the nearer of c = ±1.
        let along = if parts.one_minus < parts.one_plus {
            libm::sinh(phi - psi) - sinh * libm::cosh(psi) * parts.one_minus
        } else {
            sinh * libm::cosh(psi) * parts.one_plus - libm::sinh(phi + psi)
        };
        parts.across * sinh + m * along
    }

    /// The rapidity vector w.
    pub fn rapidity(self) -> DVec3 {
        self.rapidity
    }

    /// β = tanh|w| ŵ. Its length rounds to 1 at rapidities above about 19.
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

    /// Whether this is rest in the world.
    pub fn is_rest(self) -> bool {
        self.rapidity == DVec3::ZERO
    }

    /// The unit direction of motion (+x at rest) and the rapidity |w|.
    pub(crate) fn split(self) -> (DVec3, f64) {
        unit_and_length(self.rapidity).unwrap_or((DVec3::X, 0.0))
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

#[cfg(test)]
mod tests;
