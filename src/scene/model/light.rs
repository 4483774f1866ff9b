//! Lights: lamps on world lines of their own, and objects that shine.

use glam::DVec3;

use super::Motion;
use crate::colour::Spectrum;
use crate::spacetime::worldline::WorldLine;
use crate::spacetime::{Event, Velocity, World};

/// A light.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Light {
    /// Unique name.
    pub name: String,
    /// What shines.
    pub kind: LightKind,
    /// Whether surfaces shadow it.
    pub shadows: bool,
    /// A byte range of the scene text to point at in messages.
    pub span: std::ops::Range<usize>,
}

/// What shines.
#[derive(Debug, Clone)]
pub enum LightKind {
    /// A point, or something far away.
    Lamp(Box<Lamp>),
    /// The surface of an object, with the object's spectrum where it has one.
    Area {
        /// Index of the object.
        object: usize,
        /// How bright it is, by channel; a factor on the spectrum.
        brightness: Brightness,
        /// Factor on the brightness by proper time of the object.
        emission: EmissionProfile,
    },
}

/// How bright a surface is in its rest frame, alike in all directions, by channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Brightness {
    /// Radiance.
    Radiance([f64; 3]),
    /// All power Φ that it sends: the radiance is Φ/(π A), A the area of all sides that shine.
    Power([f64; 3]),
}

/// A light without extent.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Lamp {
    /// Where it shines to, in its own frame.
    pub beam: Beam,
    /// By channel, in its own frame: radiant intensity on the axis, power per solid angle; of parallel light
    /// the irradiance across it, power per area.
    pub intensity: [f64; 3],
    /// The spectrum that the intensity is a factor on; none where it is what the scene's quantity says.
    pub spectrum: Option<Spectrum>,
    /// Factor on the intensity by proper time.
    pub emission: EmissionProfile,
    /// Where it is when its clock shows 0.
    pub origin: Event<World>,
    /// Its velocity then.
    pub velocity: Velocity,
    /// How it moves on.
    pub motion: Motion,
    /// The world line that these give.
    pub line: WorldLine,
}

/// Where a lamp shines to, in its own frame, whose axes are the world's, boosted without rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Beam {
    /// All directions alike.
    Point,
    /// A cone: all of the intensity within `inner`, none beyond `outer`, in between the square of what
    /// is linear in the cosine, as glTF has it (KHR_lights_punctual).
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

/// A factor on the light of a lamp or of a surface at each of its proper times τ, metres.
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
        /// How many; none for all integers k.
        count: Option<u32>,
    },
    /// Linear between these proper times and factors, 0 outside; times ascend.
    Table(Vec<[f64; 2]>),
}
