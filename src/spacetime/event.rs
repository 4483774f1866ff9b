//! Events, displacements and directions, each tagged with the frame whose coordinates it holds.
//!
//! Mixing frames does not compile:
//!
//! ```compile_fail
//! use nullray::spacetime::{Camera, Event, World};
//! let world = Event::<World>::new(0.0, glam::DVec3::ZERO);
//! let camera = Event::<Camera>::new(0.0, glam::DVec3::ZERO);
//! let displacement = world - camera; // two frames
//! ```

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Add, Mul, Sub};

use glam::DVec3;

/// A tag that names a frame of reference.
pub trait Frame: Copy + Send + Sync + 'static {
    /// The frame's name in messages.
    const NAME: &'static str;
}

/// The frame of the scene file, in which the medium rests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct World;

/// The frame in which the camera is at rest at the moment of the shot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Camera;

/// The rest frame of an object (of a group of objects at rest relative to each other).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rest;

impl Frame for World {
    const NAME: &'static str = "world";
}
impl Frame for Camera {
    const NAME: &'static str = "camera";
}
impl Frame for Rest {
    const NAME: &'static str = "rest";
}

/// A point of space-time: `(ct, x)` in frame `F`, metres.
#[derive(Clone, Copy, PartialEq)]
pub struct Event<F> {
    /// Time multiplied by the speed of light, metres.
    pub ct: f64,
    /// Position, metres.
    pub x: DVec3,
    frame: PhantomData<F>,
}

/// The difference of two events: `(Δct, Δx)` in frame `F`, metres.
#[derive(Clone, Copy, PartialEq)]
pub struct Displacement<F> {
    /// Time difference multiplied by the speed of light, metres.
    pub ct: f64,
    /// Spatial difference, metres.
    pub x: DVec3,
    frame: PhantomData<F>,
}

/// A unit look direction in frame `F`: the direction in which an observer sees, opposite to the
/// propagation of the light.
#[derive(Clone, Copy, PartialEq)]
pub struct Direction<F> {
    unit: DVec3,
    frame: PhantomData<F>,
}

impl<F: Frame> Event<F> {
    /// The event at time `ct` and position `x`, metres.
    pub const fn new(ct: f64, x: DVec3) -> Self {
        Event {
            ct,
            x,
            frame: PhantomData,
        }
    }

    /// The frame's origin at its time 0.
    pub const ORIGIN: Self = Event::new(0.0, DVec3::ZERO);
}

impl<F: Frame> Displacement<F> {
    /// The displacement by `ct` in time and `x` in space, metres.
    pub const fn new(ct: f64, x: DVec3) -> Self {
        Displacement {
            ct,
            x,
            frame: PhantomData,
        }
    }

    /// The invariant interval s² = Δct² − |Δx|², square metres: positive where timelike.
    pub fn interval(self) -> f64 {
        // (Δct − |Δx|)(Δct + |Δx|) keeps the digits of a nearly null displacement.
        let r = self.x.length();
        (self.ct - r) * (self.ct + r)
    }
}

impl<F: Frame> Direction<F> {
    /// The direction of `v`, or none where `v` is zero or not finite.
    pub fn new(v: DVec3) -> Option<Self> {
        // Scaled first: squares of very small or very large components leave f64's range.
        let scale = v.abs().max_element();
        (scale > 0.0 && scale.is_finite()).then(|| {
            let v = v / scale;
            Self::from_unit(v / v.length())
        })
    }

    /// A vector that is known to be of unit length.
    pub(crate) const fn from_unit(unit: DVec3) -> Self {
        Direction {
            unit,
            frame: PhantomData,
        }
    }

    /// The unit vector's components in frame `F`.
    pub const fn unit(self) -> DVec3 {
        self.unit
    }
}

impl<F: Frame> Sub for Event<F> {
    type Output = Displacement<F>;
    fn sub(self, other: Self) -> Displacement<F> {
        Displacement::new(self.ct - other.ct, self.x - other.x)
    }
}

impl<F: Frame> Add<Displacement<F>> for Event<F> {
    type Output = Event<F>;
    fn add(self, d: Displacement<F>) -> Event<F> {
        Event::new(self.ct + d.ct, self.x + d.x)
    }
}

impl<F: Frame> Mul<f64> for Displacement<F> {
    type Output = Self;
    fn mul(self, s: f64) -> Self {
        Displacement::new(self.ct * s, self.x * s)
    }
}

impl<F: Frame> fmt::Debug for Event<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} event (ct {}, x {})", F::NAME, self.ct, self.x)
    }
}

impl<F: Frame> fmt::Debug for Displacement<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} displacement (ct {}, x {})", F::NAME, self.ct, self.x)
    }
}

impl<F: Frame> fmt::Debug for Direction<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} direction {}", F::NAME, self.unit)
    }
}
