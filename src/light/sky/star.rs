//! A star: the blackbody and its solid angle.

use glam::DVec3;

use crate::colour::blackbody_colour;

/// A star.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Star {
    /// Unit vector towards it.
    pub direction: DVec3,
    /// Temperature of its spectrum, kelvin.
    pub temperature: f64,
    /// Ω: its irradiance on a perpendicular surface divided by the radiance of a blackbody.
    pub solid_angle: f64,
}

impl Star {
    /// A star with this luminance on a perpendicular surface at rest in the world.
    pub fn new(direction: DVec3, temperature: f64, luminance: f64) -> Star {
        Star {
            direction,
            temperature,
            solid_angle: luminance / self::luminance(temperature),
        }
    }

    /// Linear sRGB of Ω B(λ; T/W).
    #[inline]
    pub fn colour(&self, w: f64) -> [f64; 3] {
        blackbody_colour(self.temperature / w).map(|c| c * self.solid_angle)
    }

    /// Linear sRGB of Ω B at rest, with negative channels clipped to 0.
    #[inline]
    pub fn channels(&self) -> [f64; 3] {
        self.colour(1.0).map(|c| c.max(0.0))
    }

    /// Its luminance on a perpendicular surface at rest.
    pub(super) fn luminance(&self) -> f64 {
        self.solid_angle * luminance(self.temperature)
    }
}

/// Y of the linear sRGB of a blackbody.
pub(super) fn luminance(temperature: f64) -> f64 {
    let [r, g, b] = blackbody_colour(temperature);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
