//! Rotation-free boosts in light-cone form.
//!
//! Along the unit direction n of motion with rapidity φ, the boost from the moving frame to the
//! world only scales the two light-cone coordinates: with x∥ = n·x,
//!
//! ```text
//! t + x∥ → e^φ (t + x∥),     t − x∥ → e^−φ (t − x∥),     x⊥ → x⊥.
//! ```
//!
//! This preserves the digits of a nearly null displacement, one of whose two coordinates is small. A slow boost (φ < ½) is written as
//! increments instead, which preserve the digits of a tiny boost or component:
//!
//! ```text
//! Δt = (γ − 1) t + sinh φ x∥,     Δx = ((γ − 1) x∥ + sinh φ t) n,     γ − 1 = 2 sinh²(φ/2).
//! ```
//!
//! A look direction d′ is the null vector k = (−1, d′). With c∥ = n·d′, the smaller of the two numbers 1 ± c∥ is |d⊥|²/(1 + |c∥|), and d⊥
//! is computed from the small difference d′ ∓ n, so that nothing cancels:
//!
//! ```text
//! W  = ½ (e^−φ (1 + c∥) + e^φ (1 − c∥)),   W d∥ = ½ (e^−φ (1 + c∥) − e^φ (1 − c∥)),   W d⊥ = d⊥.
//! ```
//!
//! Both terms of W are positive. The textbook form γ(1 − β·d′) loses every digit near the forward direction, and so would increments.
//! With eps = 2⁻⁵³ the remaining errors are the effects of rounding n, φ and d′ themselves: W is accurate to a few eps (1 + φ + sinh φ
//! (|d⊥| + eps)/W), and d to a few eps (1 + φ + 1/W), because aberration magnifies small angles by 1/W; |d| = 1 holds to a few eps (1 +
//! eps/W).
//!
//! The boost of a frame at rest is the identity, bit for bit.
//!
//! Only quantities of the second frame are accepted:
//!
//! ```
//! use nullray::spacetime::{Boost, CameraFrame, Direction, Displacement, Velocity, World};
//! let world_from_camera = Boost::<World, CameraFrame>::new(Velocity::REST);
//! let ahead: Direction<CameraFrame> = Direction::new(glam::DVec3::Z).unwrap();
//! let metre = Displacement::<CameraFrame>::new(0.0, glam::DVec3::Z);
//! let (ahead, _): (Direction<World>, f64) = world_from_camera.direction(ahead);
//! let metre: Displacement<World> = world_from_camera.displacement(metre);
//! ```
//!
//! The displacement of another frame does not compile,
//!
//! ```compile_fail,E0308
//! use nullray::spacetime::{Boost, CameraFrame, Displacement, Rest, Velocity, World};
//! let world_from_camera = Boost::<World, CameraFrame>::new(Velocity::REST);
//! let metre = Displacement::<Rest>::new(0.0, glam::DVec3::Z);
//! world_from_camera.displacement(metre); // not the camera's
//! ```
//!
//! nor does a direction that has been boosted already,
//!
//! ```compile_fail,E0308
//! use nullray::spacetime::{Boost, CameraFrame, Direction, Velocity, World};
//! let world_from_camera = Boost::<World, CameraFrame>::new(Velocity::REST);
//! let ahead: Direction<CameraFrame> = Direction::new(glam::DVec3::Z).unwrap();
//! let (ahead, _) = world_from_camera.direction(ahead);
//! world_from_camera.direction(ahead); // the world's by now
//! ```
//!
//! nor the boost the wrong way round.
//!
//! ```compile_fail,E0308
//! use nullray::spacetime::{Boost, CameraFrame, Direction, Velocity, World};
//! let world_from_camera = Boost::<World, CameraFrame>::new(Velocity::REST);
//! let ahead: Direction<CameraFrame> = Direction::new(glam::DVec3::Z).unwrap();
//! world_from_camera.inverse().direction(ahead); // takes world directions
//! ```
//!
//! Source: the light-cone form of the Lorentz transformation, e.g. Weiskopf, Kraus,
//! Ruder 1999 for aberration and Doppler factor; the arrangement is ours.

use std::marker::PhantomData;

use glam::DVec3;

use super::event::{Direction, Displacement, Event, Frame, Parts, World};
use super::ray::NullRay;
use super::velocity::Velocity;

/// e^φ below which displacements are boosted by increments: φ < ½.
const SLOW: f64 = 1.65;

/// A rotation-free Lorentz boost that takes quantities of frame `From` to frame `To`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Boost<To, From> {
    /// Unit direction of motion of `From` in `To`.
    n: DVec3,
    /// e^φ.
    up: f64,
    /// e^−φ.
    down: f64,
    /// sinh φ = γβ.
    sinh: f64,
    /// γ − 1.
    gamma_minus_one: f64,
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
            sinh: libm::sinh(phi),
            gamma_minus_one: velocity.gamma_minus_one(),
            frames: PhantomData,
        }
    }

    /// The inverse boost.
    pub fn inverse(self) -> Boost<From, To> {
        Boost {
            n: -self.n,
            up: self.up,
            down: self.down,
            sinh: self.sinh,
            gamma_minus_one: self.gamma_minus_one,
            frames: PhantomData,
        }
    }

    /// The unit direction in which `From` moves in `To`, and its rapidity.
    pub(crate) fn motion(&self) -> (DVec3, f64) {
        (self.n, libm::log(self.up))
    }

    /// Whether the frames are at rest relative to each other.
    #[inline(always)]
    pub(crate) fn is_identity(&self) -> bool {
        self.sinh == 0.0
    }

    /// A displacement in the other frame's coordinates.
    ///
    /// Each component is accurate to a few eps (1 + φ) times the sum of its terms' absolute values, at most γ (|Δct| + |Δx|).
    #[inline(always)]
    pub fn displacement(&self, d: Displacement<From>) -> Displacement<To> {
        if self.is_identity() {
            return Displacement::new(d.ct, d.x);
        }
        // Slow: increments γ − 1 and sinh φ. Fast: t ± x∥ scale by e^(±φ), and nothing cancels.
        match self.is_slow() {
            true => self.displacement_of_slow(d),
            false => self.displacement_of_fast(d),
        }
    }

    /// Whether displacements are boosted by increments.
    #[inline(always)]
    pub(crate) fn is_slow(&self) -> bool {
        self.up < SLOW
    }

    /// [`Boost::displacement`] if [`Boost::is_slow`] is true and [`Boost::is_identity`] false: a loop that tests this beforehand
    /// vectorizes.
    #[inline(always)]
    pub(crate) fn displacement_of_slow(&self, d: Displacement<From>) -> Displacement<To> {
        let along = self.n.dot(d.x);
        Displacement::new(
            d.ct + (self.gamma_minus_one * d.ct + self.sinh * along),
            d.x + self.n * (self.gamma_minus_one * along + self.sinh * d.ct),
        )
    }

    /// The same if both are false.
    #[inline(always)]
    pub(crate) fn displacement_of_fast(&self, d: Displacement<From>) -> Displacement<To> {
        let along = self.n.dot(d.x);
        let across = d.x - self.n * along;
        self.light_cone(d.ct + along, d.ct - along, across)
    }

    /// The boosted displacement with `plus` = t + x∥, `minus` = t − x∥ and `across` = x⊥.
    #[inline(always)]
    fn light_cone(&self, plus: f64, minus: f64, across: DVec3) -> Displacement<To> {
        let plus = 0.5 * self.up * plus;
        let minus = 0.5 * self.down * minus;
        Displacement::new(plus + minus, across + self.n * (plus - minus))
    }

    /// The look direction d in `To` for the look direction d′ in `From`, and the ratio ω_To/ω_From of the light's frequencies in the two
    /// frames.
    ///
    /// For camera → world the ratio is W = γ(1 − β·d′) = λ′/λ of a world-static source.
    #[inline(always)]
    pub fn direction(&self, d: Direction<From>) -> (Direction<To>, f64) {
        if self.is_identity() {
            return (Direction::from_unit(d.unit()), 1.0);
        }
        self.direction_of_moving(d)
    }

    /// The same, together with the reciprocal of the ratio.
    #[inline(always)]
    pub(crate) fn direction_and_inverse(&self, d: Direction<From>) -> (Direction<To>, [f64; 2]) {
        if self.is_identity() {
            return (Direction::from_unit(d.unit()), [1.0; 2]);
        }
        self.direction_and_inverse_of_moving(d)
    }

    /// [`Boost::direction`] if [`Boost::is_identity`] is false: a loop that tests this beforehand vectorizes.
    #[inline(always)]
    pub(crate) fn direction_of_moving(&self, d: Direction<From>) -> (Direction<To>, f64) {
        let (d, [ratio, _]) = self.direction_and_inverse_of_moving(d);
        (d, ratio)
    }

    /// The same, together with the reciprocal of the ratio.
    #[inline(always)]
    pub(crate) fn direction_and_inverse_of_moving(
        &self,
        d: Direction<From>,
    ) -> (Direction<To>, [f64; 2]) {
        let Boost { n, up, down, .. } = *self;
        // W = ½ (e^(−φ)(1 + c∥) + e^φ (1 − c∥)): both terms positive.
        let parts = Parts::of(d.unit(), n);
        let back = down * parts.one_plus;
        let ahead = up * parts.one_minus;
        let ratio = 0.5 * (back + ahead);
        // One division for the three components: half an eps more in their common length.
        let inverse = 1.0 / ratio;
        let unit = (parts.across + n * (0.5 * (back - ahead))) * inverse;
        (Direction::from_unit(unit), [ratio, inverse])
    }

    /// The parts r′ d′ and r′, in `To`, of the null vector (−r, r d) with `length` = r and `v` = r d: [`Boost::direction`] without a
    /// division. If [`Boost::is_slow`] is true, r′ is not a small difference.
    #[inline(always)]
    pub(crate) fn null_of_slow(&self, v: DVec3, length: f64) -> (DVec3, f64) {
        let null = self.displacement_of_slow(Displacement::new(-length, v));
        (null.x, -null.ct)
    }

    /// The same if it is false.
    #[inline(always)]
    pub(crate) fn null_of_fast(&self, v: DVec3, length: f64) -> (DVec3, f64) {
        let parts = Parts::of_length(v, length, self.n);
        let back = self.down * parts.one_plus;
        let ahead = self.up * parts.one_minus;
        let along = 0.5 * (back - ahead);
        (parts.across + self.n * along, 0.5 * (back + ahead))
    }

    /// The tangent (−η, d) of a light path in `To`, with the same parameter.
    ///
    /// In vacuum (η = 1) it is ω (−1, d) with d and the ratio ω of [`Boost::direction`], to the same digits.
    #[inline(always)]
    pub fn tangent(&self, index: f64, d: Direction<From>) -> Displacement<To> {
        self.tangent_and_ratio(index, d).0
    }

    /// [`Boost::tangent`] and the ratio of [`Boost::direction`].
    #[inline(always)]
    pub fn tangent_and_ratio(&self, index: f64, d: Direction<From>) -> (Displacement<To>, f64) {
        if self.is_identity() {
            return (Displacement::new(-index, d.unit()), 1.0);
        }
        self.tangent_of_moving(index, d)
    }

    /// [`Boost::tangent_and_ratio`] if [`Boost::is_identity`] is false.
    #[inline(always)]
    fn tangent_of_moving(&self, index: f64, d: Direction<From>) -> (Displacement<To>, f64) {
        let Boost { n, up, down, .. } = *self;
        let parts = Parts::of(d.unit(), n);
        let ratio = 0.5 * (down * parts.one_plus + up * parts.one_minus);
        // t + x∥ = −η + c∥ and t − x∥ = −η − c∥, from the stable 1 ∓ c∥. For η ≥ 1 no sign differs.
        let slow = 1.0 - index;
        let (plus, minus) = (slow - parts.one_minus, slow - parts.one_plus);
        (self.light_cone(plus, minus, parts.across), ratio)
    }
}

/// Tangents of many light paths, in arrays: the results of [`Boost::tangent_and_ratio`].
#[derive(Debug)]
pub(crate) struct Tangents<'a> {
    /// Spatial parts.
    pub space: &'a mut [DVec3],
    /// Temporal parts.
    pub time: &'a mut [f64],
    /// ω_To/ω_From of light from there.
    pub ratio: &'a mut [f64],
}

impl<To: Frame, From: Frame> Boost<To, From> {
    /// Boosts light paths along the unit vectors `directions` in media with these indices; all slices must have the same length. A plain
    /// loop, to be compiled for wide vectors.
    #[inline(always)]
    pub(crate) fn tangents(&self, index: &[f64], directions: &[DVec3], to: Tangents) {
        let count = directions.len();
        let (index, space) = (&index[..count], &mut to.space[..count]);
        let (time, ratio) = (&mut to.time[..count], &mut to.ratio[..count]);
        // Test once: a branch for each direction would prevent vectorization.
        if self.is_identity() {
            space.copy_from_slice(directions);
            for i in 0..count {
                (time[i], ratio[i]) = (-index[i], 1.0);
            }
            return;
        }
        for i in 0..count {
            let d = Direction::<From>::from_unit(directions[i]);
            let (tangent, ratio_of_one) = self.tangent_of_moving(index[i], d);
            space[i] = tangent.x;
            time[i] = tangent.ct;
            ratio[i] = ratio_of_one;
        }
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

    /// The event at which the clock at the origin of `other` shows `time`, in this frame's coordinates.
    ///
    /// In the world that event is X₀ + τu, far from everything if γτ is large, and rounded; here it is Λ(X₀ − O) + τ Λu, where Λu follows
    /// from both velocities without cancellation. Frames of one velocity stay at the same distance for ever, to the last bit.
    pub fn event_of_clock<G: Frame>(&self, other: &InertialFrame<G>, time: f64) -> Event<F> {
        let four_velocity = other.velocity.four_velocity_from(self.velocity);
        self.event_from_world(other.origin) + four_velocity * time
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spacetime::Rest;

    /// Rapidities subtract: in the frame that moves at ψ, a clock that moves at φ along the same line shows τ at τ (cosh, sinh)(φ − ψ)
    /// from where both clocks showed 0.
    #[test]
    fn the_clock_of_another_frame_is_where_their_relative_velocity_takes_it() {
        let n = DVec3::Z;
        let frame = |rapidity, x| {
            let velocity = Velocity::from_rapidity_along(rapidity, n).unwrap();
            InertialFrame::<Rest>::new(velocity, Event::new(0.0, DVec3::X * x))
        };
        for (phi, psi, time) in [(19.0, 18.5, 1e6), (30.0, 30.0, 3e14), (9.0, -0.5, -7.0)] {
            let seen = frame(psi, 1.0).event_of_clock(&frame(phi, 3.0), time);
            let along = n * (time * libm::sinh(phi - psi));
            let expected = Event::new(time * libm::cosh(phi - psi), DVec3::X * 2.0 + along);
            let bound = 64.0 * f64::EPSILON * expected.ct.abs();
            assert!((seen - expected).x.length() <= bound, "{seen:?}");
            assert!((seen.ct - expected.ct).abs() <= bound, "{seen:?}");
            assert!(phi != psi || seen == expected, "{seen:?}");
        }
    }

    #[test]
    fn tangents_of_many_paths_are_those_of_each_bit_for_bit() {
        let directions: Vec<DVec3> = (0..37)
            .map(|k| DVec3::new(f64::from(k) - 18.0, 3.0, f64::from(k % 5)).normalize())
            .collect();
        let index: Vec<f64> = (0..37).map(|k| 1.0 + 0.01 * f64::from(k)).collect();
        for rapidity in [
            DVec3::ZERO,
            DVec3::new(1e-9, 0.0, 0.0),
            DVec3::new(1.0, -3.0, 0.5),
        ] {
            let boost = Boost::<Rest, World>::new(Velocity::from_rapidity(rapidity).unwrap());
            let (mut space, mut time, mut ratio) =
                (vec![DVec3::NAN; 37], vec![0.0; 37], vec![0.0; 37]);
            let to = Tangents {
                space: &mut space,
                time: &mut time,
                ratio: &mut ratio,
            };
            boost.tangents(&index, &directions, to);
            for k in 0..37 {
                let d = Direction::from_unit(directions[k]);
                let (tangent, of_one) = boost.tangent_and_ratio(index[k], d);
                let bits = |x: DVec3, t: f64, w: f64| [x.x, x.y, x.z, t, w].map(f64::to_bits);
                let alone = bits(tangent.x, tangent.ct, of_one);
                assert_eq!(bits(space[k], time[k], ratio[k]), alone, "{rapidity} {k}");
            }
        }
    }
}
