//! A star: the blackbody and its solid angle.

use glam::DVec3;

use crate::colour::blackbody_colour;
use crate::spacetime::worldline::WorldLine;
use crate::spacetime::{Boost, CameraFrame, World};

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

/// How an observer sees stars.
#[derive(Debug, Clone, Copy)]
pub struct Beaming {
    /// The observer's motion.
    pub motion: Motion,
    /// p − 2, where radiance is scaled with W⁻ᵖ.
    pub power: i32,
    /// Whether stars have channels; otherwise they are blackbodies.
    pub channels: bool,
    /// Whether their wavelengths are shifted.
    pub shifted: bool,
}

impl Beaming {
    /// For an observer at rest, who sees blackbodies.
    pub const REST: Beaming = Beaming {
        motion: Motion::REST,
        power: 0,
        channels: false,
        shifted: true,
    };
}

/// The motion of an observer, towards n with the rapidity φ: 1/W = e^−φ + sinh φ |d + n|²/2 for light from d.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    pub(super) n: DVec3,
    down: f64,
    pub(super) sinh: f64,
    pub(super) gamma: f64,
}

impl Motion {
    /// At rest in the world.
    pub const REST: Motion = Motion {
        n: DVec3::X,
        down: 1.0,
        sinh: 0.0,
        gamma: 1.0,
    };

    /// That of a camera.
    pub fn of(world_from_camera: &Boost<World, CameraFrame>) -> Motion {
        let (n, rapidity) = world_from_camera.motion();
        Motion {
            n,
            down: libm::exp(-rapidity),
            sinh: libm::sinh(rapidity),
            gamma: libm::cosh(rapidity),
        }
    }

    /// 1/W.
    #[inline(always)]
    pub(super) fn inverse_ratio(&self, d: DVec3) -> f64 {
        self.down + self.sinh * (0.5 * (d + self.n).length_squared())
    }

    /// A bound of the relative change of 1/W over a chord of this `size`: with y = 1/W, |∇y|² = 2γy − 1 − y², and ∂²y = γ − y along the
    /// direction of motion.
    #[inline(always)]
    pub(super) fn change(&self, inverse: f64, size: f64) -> f64 {
        let (y, gamma) = (inverse, self.gamma);
        let slope = (2.0 * gamma * y - 1.0 - y * y).max(0.0).sqrt();
        (slope * size + 0.5 * (gamma - y).abs() * size * size) / y
    }
}

/// The motion of a camera that accelerates while its shutter is open.
#[derive(Debug, Clone)]
pub struct Motions {
    /// Its world line.
    pub line: WorldLine,
    /// Proper time when the shutter opens.
    pub time: f64,
    /// Proper time until it closes.
    pub duration: f64,
}

impl Motions {
    /// The motion at this moment of the exposure, 0 to 1; rest where the world line does not extend, and no ray sees anything.
    pub fn at(&self, moment: f64) -> Motion {
        let place = self.line.place(self.time + moment * self.duration);
        place.map_or(Motion::REST, |(_, velocity)| {
            Motion::of(&Boost::new(velocity))
        })
    }
}

/// x to a power.
#[inline(always)]
pub(super) fn raised(x: f64, power: i32) -> f64 {
    let all = (0..power.unsigned_abs()).fold(1.0, |all, _| all * x);
    if power < 0 { 1.0 / all } else { all }
}

/// Y of the linear sRGB of a blackbody.
pub(super) fn luminance(temperature: f64) -> f64 {
    let [r, g, b] = blackbody_colour(temperature);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
