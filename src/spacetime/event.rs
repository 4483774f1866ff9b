//! Events, displacements and directions, each tagged with the frame whose coordinates it holds.
//!
//! Mixing frames does not compile:
//!
//! ```compile_fail
//! use nullray::spacetime::{CameraFrame, Event, World};
//! let world = Event::<World>::new(0.0, glam::DVec3::ZERO);
//! let camera = Event::<CameraFrame>::new(0.0, glam::DVec3::ZERO);
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
pub struct CameraFrame;

/// The rest frame of an object (of a group of objects at rest relative to each other).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rest;

impl Frame for World {
    const NAME: &'static str = "world";
}
impl Frame for CameraFrame {
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

    /// (ct, x, y, z), metres.
    pub fn to_array(self) -> [f64; 4] {
        [self.ct, self.x.x, self.x.y, self.x.z]
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

    /// The invariant interval s² = Δct² − |Δx|², square metres: positive if timelike.
    pub fn interval(self) -> f64 {
        // (Δct − |Δx|)(Δct + |Δx|) keeps the digits of a nearly null displacement.
        let r = self.x.length();
        (self.ct - r) * (self.ct + r)
    }

    /// Whether it leads to the causal future, which includes the light cone.
    pub(super) fn is_causal(self) -> bool {
        self.ct >= self.x.length()
    }
}

impl<F: Frame> Direction<F> {
    /// The direction of `v`; `None` if `v` is zero or not finite.
    pub fn new(v: DVec3) -> Option<Self> {
        unit_and_length(v).map(|(unit, _)| Self::from_unit(unit))
    }

    /// The direction of a vector that is known to have unit length.
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

/// The unit vector along `v` and |v|; `None` if `v` is zero or not finite.
pub(super) fn unit_and_length(v: DVec3) -> Option<(DVec3, f64)> {
    let (unit, length) = unit_and_length_or_nan(v);
    (!unit.x.is_nan()).then_some((unit, length))
}

/// The same without a branch, for loops: NaN if `v` is zero or not finite.
#[inline(always)]
pub(crate) fn unit_and_length_or_nan(v: DVec3) -> (DVec3, f64) {
    let (v, back) = with_squares(v);
    let length = v.length();
    (v / length, length * back)
}

/// `v` times a power of two for which its squares are within f64's range, and the factor that restores its length; NaN for ∞. 0/0 is NaN.
#[inline(always)]
fn with_squares(v: DVec3) -> (DVec3, f64) {
    /// 2⁶⁰⁰ and its inverse.
    const UP: f64 = f64::from_bits((1023 + 600) << 52);
    const DOWN: f64 = f64::from_bits((1023 - 600) << 52);
    let largest = v.abs().max_element();
    // Squares of numbers in between are normal, and so is the sum of three.
    let (scale, back) = if largest < 1e-140 {
        (UP, DOWN)
    } else {
        (1.0, 1.0)
    };
    let (scale, back) = if largest > 1e140 {
        (DOWN, UP)
    } else {
        (scale, back)
    };
    let scale = if largest < f64::INFINITY {
        scale
    } else {
        f64::NAN
    };
    (v * scale, back)
}

/// A unit vector d relative to a unit vector n, with c = n·d.
pub(super) struct Parts {
    /// d⊥ = d − c n.
    pub across: DVec3,
    /// 1 + c.
    pub one_plus: f64,
    /// 1 − c.
    pub one_minus: f64,
}

impl Parts {
    /// The parts of `d`, none of them computed as the difference of nearly equal numbers.
    #[inline(always)]
    pub fn of(d: DVec3, n: DVec3) -> Self {
        Parts::of_length(d, 1.0, n)
    }

    /// The same for a vector `d` of this length; all parts are multiplied by the length.
    #[inline(always)]
    pub fn of_length(d: DVec3, length: f64, n: DVec3) -> Self {
        let along = n.dot(d);
        // d − n and d + n have the same d⊥ as d; the shorter of them has the smaller component along n to subtract.
        let to_end = n * length;
        let near = if along > 0.0 { d - to_end } else { d + to_end };
        let across = near - n * n.dot(near);
        let large = length + along.abs();
        // length² − along² = |d⊥|²: the small factor from the large one, without a difference.
        let small = across.length_squared() / large;
        let (one_plus, one_minus) = if along > 0.0 {
            (large, small)
        } else {
            (small, large)
        };
        Parts {
            across,
            one_plus,
            one_minus,
        }
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

impl<F: Frame> Add for Displacement<F> {
    type Output = Displacement<F>;
    fn add(self, other: Self) -> Self {
        Displacement::new(self.ct + other.ct, self.x + other.x)
    }
}

impl<F: Frame> Sub for Displacement<F> {
    type Output = Displacement<F>;
    fn sub(self, other: Self) -> Self {
        Displacement::new(self.ct - other.ct, self.x - other.x)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_is_unit_at_every_scale_of_its_vector() {
        for scale in [5e-324, 1e-300, 1e-5, 1.0, 1e200, 1.2e308] {
            let d = Direction::<World>::new(DVec3::new(1.0, 1.0, -1.0) * scale);
            let unit = d.map(Direction::unit);
            let expected = DVec3::new(1.0, 1.0, -1.0) / 3f64.sqrt();
            assert!(
                unit.is_some_and(|u| (u - expected).length() < 3e-16),
                "{scale}"
            );
        }
    }

    #[test]
    fn zero_infinity_and_nan_in_any_component_are_no_direction() {
        assert_eq!(Direction::<World>::new(DVec3::ZERO), None);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let v = DVec3::select(axis.cmpgt(DVec3::ZERO), DVec3::splat(bad), DVec3::ONE);
                assert_eq!(Direction::<World>::new(v), None, "{v}");
            }
        }
    }
}
