//! Light paths into the past.
//!
//! A ray leaves the observer's event P against the light: x(s) = P + s (−η, d), with s the world distance in metres. In vacuum (η = 1) it
//! is a null ray. In a medium of refractive index η at rest in the world it is the path of light at speed c/η: η only lengthens the delay
//! (directions at the camera are those of vacuum, as in Jarabo et al. 2015). η = 0 is light without delay: everything is hit where it is
//! "now" in the world.
//!
//! In another frame the same path is P′ + s V′ with V′ = Λ(−η, d), *not* normalised: s stays the
//! world distance, so hits in different rest frames compare directly.

use super::event::{Direction, Displacement, Event, Frame, World};

/// A light path into the past in frame `F`, parametrised by world distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NullRay<F: Frame> {
    /// The observer's event.
    pub origin: Event<F>,
    /// Change of the event per metre of world distance.
    pub tangent: Displacement<F>,
}

impl NullRay<World> {
    /// The path from `origin` along look direction `d` in a medium of index `index`.
    #[inline]
    pub fn new(origin: Event<World>, d: Direction<World>, index: f64) -> Self {
        NullRay {
            origin,
            tangent: Displacement::new(-index, d.unit()),
        }
    }
}

impl<F: Frame> NullRay<F> {
    /// The event at parameter `s`, metres of world distance.
    #[inline]
    pub fn at(&self, s: f64) -> Event<F> {
        self.origin + self.tangent * s
    }
}
