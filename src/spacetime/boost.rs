//! Rotation-free boosts in light-cone form.
//!
//! Along the unit direction n of motion with rapidity φ, the boost from the moving frame to the
//! world only scales the two light-cone coordinates: with x∥ = n·x,
//!
//! ```text
//! t + x∥ → e^φ (t + x∥),     t − x∥ → e^−φ (t − x∥),     x⊥ → x⊥.
//! ```
//!
//! As increments, which leave a tiny boost or a tiny component its digits:
//!
//! ```text
//! Δt = ½ ((e^φ − 1)(t + x∥) + (e^−φ − 1)(t − x∥)),   Δx = ½ ((e^φ − 1)(t + x∥) − (e^−φ − 1)(t − x∥)) n.
//! ```
//!
//! A look direction d′ is the null vector k = (−1, d′). With c∥ = n·d′, of the two numbers 1 ± c∥
//! the small one is |d⊥|²/(1 + |c∥|), so that nothing cancels:
//!
//! ```text
//! W  = ½ (e^−φ (1 + c∥) + e^φ (1 − c∥)),   W d∥ = ½ (e^−φ (1 + c∥) − e^φ (1 − c∥)),   W d⊥ = d⊥.
//! ```
//!
//! Both terms of W are positive. The textbook form γ(1 − β·d′) loses every digit near the forward
//! direction. Source: the light-cone form of the Lorentz transformation, e.g. Weiskopf, Kraus,
//! Ruder 1999 for aberration and Doppler factor; the arrangement is ours.

use std::marker::PhantomData;

use glam::DVec3;

use super::{Direction, Displacement, Event, Frame, NullRay, Velocity, World};

/// A rotation-free Lorentz boost that takes quantities of frame `From` to frame `To`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Boost<To, From> {
    /// Unit direction of motion of `From` in `To`.
    n: DVec3,
    /// e^φ.
    up: f64,
    /// e^−φ.
    down: f64,
    /// e^φ − 1.
    up_minus_one: f64,
    /// e^−φ − 1.
    down_minus_one: f64,
    frames: PhantomData<(To, From)>,
}

impl<To: Frame, From: Frame> Boost<To, From> {
    /// The boost from a frame that moves with `velocity` relative to `To`.
    pub fn new(velocity: Velocity) -> Self {
        let (n, phi) = velocity.split();
        Boost {
            n,
            up: libm::exp(phi),
            down: libm::exp(-phi),
            up_minus_one: libm::expm1(phi),
            down_minus_one: libm::expm1(-phi),
            frames: PhantomData,
        }
    }

    /// The boost back.
    pub fn inverse(self) -> Boost<From, To> {
        let Boost {
            n,
            up,
            down,
            up_minus_one,
            down_minus_one,
            ..
        } = self;
        Boost {
            n: -n,
            up,
            down,
            up_minus_one,
            down_minus_one,
            frames: PhantomData,
        }
    }

    /// A displacement in the other frame's coordinates.
    pub fn displacement(&self, d: Displacement<From>) -> Displacement<To> {
        let along = self.n.dot(d.x);
        self.light_cone(d, d.ct + along, d.ct - along)
    }

    /// Scales the light-cone coordinates `plus` = t + x∥ and `minus` = t − x∥ of `d`.
    #[inline]
    fn light_cone(&self, d: Displacement<From>, plus: f64, minus: f64) -> Displacement<To> {
        let plus = 0.5 * self.up_minus_one * plus;
        let minus = 0.5 * self.down_minus_one * minus;
        Displacement::new(d.ct + (plus + minus), d.x + self.n * (plus - minus))
    }

    /// The look direction d of `To` for the look direction d′ of `From`, and the ratio ω_To/ω_From
    /// of the frequencies that the two frames see in that light.
    ///
    /// For camera → world the ratio is W = γ(1 − β·d′) = λ′/λ of a world-static source.
    #[inline]
    pub fn direction(&self, d: Direction<From>) -> (Direction<To>, f64) {
        let d = d.unit();
        let along = self.n.dot(d);
        let across = d - self.n * along;
        let (one_plus, one_minus) = one_plus_minus(along, across);
        let back = self.down * one_plus;
        let ahead = self.up * one_minus;
        let ratio = 0.5 * (back + ahead);
        let unit = (across + self.n * (0.5 * (back - ahead))) / ratio;
        (Direction::from_unit(unit), ratio)
    }

    /// The tangent (−η, d) of a light path in `To`, with the same parameter.
    #[inline]
    pub fn tangent(&self, index: f64, d: Direction<From>) -> Displacement<To> {
        let d = d.unit();
        let along = self.n.dot(d);
        let (one_plus, one_minus) = one_plus_minus(along, d - self.n * along);
        // t + x∥ = −η + c∥ and t − x∥ = −η − c∥, from the stable 1 ∓ c∥.
        let slow = 1.0 - index;
        self.light_cone(
            Displacement::new(-index, d),
            slow - one_minus,
            slow - one_plus,
        )
    }
}

/// (1 + c, 1 − c) for the component c of a unit vector along n and its remainder across n.
#[inline]
fn one_plus_minus(along: f64, across: DVec3) -> (f64, f64) {
    let large = 1.0 + along.abs();
    let small = across.length_squared() / large;
    if along > 0.0 {
        (large, small)
    } else {
        (small, large)
    }
}

/// An inertial frame: its velocity, and the world event at which its clock and coordinates are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InertialFrame<F> {
    velocity: Velocity,
    origin: Event<World>,
    world_from_frame: Boost<World, F>,
    frame_from_world: Boost<F, World>,
}

impl<F: Frame> InertialFrame<F> {
    /// The frame that moves with `velocity` and whose origin passes `origin` at its own time 0.
    pub fn new(velocity: Velocity, origin: Event<World>) -> Self {
        let world_from_frame = Boost::new(velocity);
        InertialFrame {
            velocity,
            origin,
            world_from_frame,
            frame_from_world: world_from_frame.inverse(),
        }
    }

    /// Velocity relative to the world.
    pub fn velocity(&self) -> Velocity {
        self.velocity
    }

    /// The world event at which the frame's clock and coordinates are zero.
    pub fn origin(&self) -> Event<World> {
        self.origin
    }

    /// The boost from this frame to the world.
    pub fn world_from_frame(&self) -> &Boost<World, F> {
        &self.world_from_frame
    }

    /// The boost from the world to this frame.
    pub fn frame_from_world(&self) -> &Boost<F, World> {
        &self.frame_from_world
    }

    /// The world coordinates of an event of this frame.
    pub fn event_to_world(&self, event: Event<F>) -> Event<World> {
        self.origin + self.world_from_frame.displacement(event - Event::ORIGIN)
    }

    /// This frame's coordinates of a world event.
    pub fn event_from_world(&self, event: Event<World>) -> Event<F> {
        Event::ORIGIN + self.frame_from_world.displacement(event - self.origin)
    }

    /// The light path from the world event `origin` along look direction `d` in a medium of refractive
    /// index `index`, in this frame's coordinates; the parameter is the world distance in metres.
    pub fn ray_from_world(
        &self,
        origin: Event<World>,
        d: Direction<World>,
        index: f64,
    ) -> NullRay<F> {
        NullRay {
            origin: self.event_from_world(origin),
            tangent: self.frame_from_world.tangent(index, d),
        }
    }
}
