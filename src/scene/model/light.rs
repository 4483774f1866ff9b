//! Lights: lamps on their own world lines, and objects that shine.

use std::path::PathBuf;

use glam::DVec3;

use super::Motion;
use crate::colour::Spectrum;
use crate::spacetime::{Event, Velocity, World};

/// A light.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Light {
    /// Unique name.
    pub name: String,
    /// The kind of light.
    pub kind: LightKind,
    /// The glTF file that it was taken from, if it was; relative paths already resolved against the scene file.
    pub gltf: Option<PathBuf>,
    /// Whether surfaces cast shadows in its light.
    pub shadows: bool,
    /// A byte range of the scene text to point at in messages.
    pub span: std::ops::Range<usize>,
}

/// The kind of light.
#[derive(Debug, Clone)]
pub enum LightKind {
    /// A point, or a light at infinity.
    Lamp(Box<Lamp>),
    /// The surface of an object, with the object's spectrum if it has one.
    Area {
        /// Index of the object.
        object: usize,
        /// Its brightness, by channel; a factor on the spectrum.
        brightness: Brightness,
        /// Factor on the brightness by proper time of the object.
        emission: EmissionProfile,
    },
}

/// The brightness of a surface in its rest frame, the same in all directions, by channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Brightness {
    /// Radiance.
    Radiance([f64; 3]),
    /// The emission of the object's materials; a radiance of 1 where none of them emits.
    Materials,
    /// The total emitted power Φ: the radiance is Φ/(π A), where A is the area of all sides that shine.
    Power([f64; 3]),
}

/// A light without extent.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Lamp {
    /// The directions in which it shines, in its own frame.
    pub beam: Beam,
    /// By channel, in its own frame: radiant intensity on the axis, power per solid angle; for parallel light the irradiance on a
    /// perpendicular surface, power per area.
    pub intensity: [f64; 3],
    /// The spectrum that the intensity multiplies; `None` if the scene's quantity determines it.
    pub spectrum: Option<Spectrum>,
    /// Factor on the intensity by proper time.
    pub emission: EmissionProfile,
    /// Its position when its clock shows 0.
    pub origin: Event<World>,
    /// Its velocity then.
    pub velocity: Velocity,
    /// Its motion from there.
    pub motion: Motion,
}

/// The directions in which a lamp shines, in its own frame, whose axes are the world's, boosted without rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Beam {
    /// The same in all directions.
    Point,
    /// A cone: full intensity within `inner`, none beyond `outer`, and in between the square of a linear function of the cosine, as in
    /// glTF (KHR_lights_punctual).
    Spot {
        /// Unit vector.
        axis: DVec3,
        /// Radians.
        inner: f64,
        /// Radians, above `inner`.
        outer: f64,
    },
    /// Parallel light along this unit vector.
    Parallel(DVec3),
}

/// A factor on the light of a lamp or of a surface as a function of its proper time τ, metres.
#[derive(Debug, Clone, PartialEq)]
pub enum EmissionProfile {
    /// 1.
    Steady,
    /// exp(−½ ((τ − centre)/σ)²).
    Gaussian {
        /// Proper time of the peak.
        centre: f64,
        /// Standard deviation, above 0.
        sigma: f64,
    },
    /// Such pulses at `centre` + k `period`.
    Train {
        /// Proper time of the first peak, k = 0.
        centre: f64,
        /// Standard deviation, above 0.
        sigma: f64,
        /// At least σ.
        period: f64,
        /// Number of pulses; `None` for all integers k.
        count: Option<u32>,
    },
    /// Linear between these proper times and factors, 0 outside; times ascend.
    Table(Vec<[f64; 2]>),
}
