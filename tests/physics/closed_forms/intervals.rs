//! The group of boosts and its invariants.

use glam::DVec3;
use nullray::spacetime::{
    Boost, CameraFrame, Direction, Displacement, Event, Frame, InertialFrame, MAX_RAPIDITY, Rest,
    Velocity, World,
};
use proptest::prelude::*;

use crate::closed_forms::sample::{EPS, config, direction, unit, velocity};

/// |Δct| + |Δx|: a component of the boosted displacement is right to 32 eps (1 + φ) γ times it.
fn size<F: Frame>(d: Displacement<F>) -> f64 {
    d.ct.abs() + d.x.length()
}

fn rapidity(v: Velocity) -> f64 {
    v.rapidity().length()
}

fn displacement() -> impl Strategy<Value = Displacement<CameraFrame>> {
    (-1.0..1.0f64, unit(), 0.0..1.0f64, -6.0..6.0f64)
        .prop_map(|(t, n, r, scale)| Displacement::new(t, n * r) * 10f64.powf(scale))
}

#[test]
fn the_boost_of_a_frame_at_rest_is_the_identity_bit_for_bit() {
    let boost = Boost::<World, CameraFrame>::new(Velocity::REST);
    let d = Direction::new(DVec3::new(0.1, -0.7, 0.3)).unwrap();
    let (same, ratio) = boost.direction(d);
    assert_eq!((same.unit(), ratio), (d.unit(), 1.0));
    let tangent = boost.tangent(1.3, d);
    assert_eq!((tangent.ct, tangent.x), (-1.3, d.unit()));
    let x = DVec3::new(-0.0, 1e-300, 1e300);
    let same = boost.displacement(Displacement::new(-0.0, x));
    let bits = |v: DVec3| v.to_array().map(f64::to_bits);
    assert_eq!(
        (same.ct.to_bits(), bits(same.x)),
        ((-0f64).to_bits(), bits(x))
    );
}

#[test]
fn the_largest_rapidity_boosts_every_direction_to_finite_numbers() {
    for axis in [DVec3::X, DVec3::ONE, DVec3::new(-3.0, 0.1, 1e-9)] {
        let velocity = Velocity::from_rapidity_along(MAX_RAPIDITY, axis).unwrap();
        let boost = Boost::<World, CameraFrame>::new(velocity);
        let n = velocity.rapidity().normalize();
        for d in [
            n,
            -n,
            DVec3::X,
            DVec3::Y,
            n + DVec3::Z * 1e-16,
            n + DVec3::Z * 1e-8,
        ] {
            let d = Direction::new(d).unwrap();
            let (world, ratio) = boost.direction(d);
            assert!((world.unit().length() - 1.0).abs() < 1e-12);
            // No wavelength changes by more than e^±φ.
            assert!(ratio.ln().abs() <= MAX_RAPIDITY * (1.0 + 1e-14), "{ratio}");
        }
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn boosts_keep_the_interval(v in velocity(6.0), d in displacement()) {
        // s² = (t − r)(t + r): an error e of t or r moves it by 2 e max(t, r), and both are below 2γ size.
        let boosted = Boost::<World, CameraFrame>::new(v).displacement(d);
        let grown = 2.0 * v.gamma() * size(d);
        let allowed = 64.0 * EPS * (1.0 + rapidity(v)) * grown * grown;
        prop_assert!((boosted.interval() - d.interval()).abs() <= allowed);
    }

    #[test]
    fn light_stays_light(v in velocity(MAX_RAPIDITY), d in direction::<CameraFrame>(), r in 1e-9..1e9f64) {
        let light = Displacement::new(-r, d.unit() * r);
        let boosted = Boost::<World, CameraFrame>::new(v).displacement(light);
        let allowed = 64.0 * EPS * (1.0 + rapidity(v)) * v.gamma() * size(light);
        prop_assert!((boosted.x.length() - boosted.ct.abs()).abs() <= allowed);
        prop_assert!(boosted.ct < allowed, "light from the past comes from the past");
    }

    #[test]
    fn a_boost_and_its_inverse_cancel(v in velocity(12.0), d in displacement(), look in direction::<CameraFrame>()) {
        let there = Boost::<World, CameraFrame>::new(v);
        for back in [there.inverse(), Boost::<CameraFrame, World>::new(-v)] {
            // The first error, 32 eps (1 + φ) γ size, grows by another 2γ.
            let same = back.displacement(there.displacement(d));
            let error = (same.ct - d.ct).abs() + (same.x - d.x).length();
            let allowed = 256.0 * EPS * (1.0 + rapidity(v)) * v.gamma().powi(2) * size(d);
            prop_assert!(error <= allowed);
            // Aberration magnifies by 1/W there and by W back, rounding in between by W:
            // 16 eps ((1 + φ + 1/W) W + 1 + φ + W).
            let (world, w) = there.direction(look);
            let (seen, inverse) = back.direction(world);
            let allowed = 16.0 * EPS * (2.0 + rapidity(v)) * (1.0 + 2.0 * w);
            prop_assert!((seen.unit() - look.unit()).length() <= allowed);
            // The ratio changes by sinh φ sin θ per radian, at most e^φ.
            let slope = (1.0 / w + w) * rapidity(v).exp();
            prop_assert!((w * inverse - 1.0).abs() <= 32.0 * EPS * (1.0 + rapidity(v) + slope));
        }
    }

    #[test]
    fn rapidities_of_collinear_boosts_add(
        n in unit(), a in -6.0..6.0f64, b in -6.0..6.0f64, d in displacement(),
    ) {
        let along = |phi| Velocity::from_rapidity_along(phi, n).unwrap();
        let first = Boost::<World, CameraFrame>::new(along(a));
        let second = Boost::<Rest, World>::new(along(b));
        let both = Boost::<Rest, CameraFrame>::new(along(a + b));
        let steps = second.displacement(first.displacement(d));
        let once = both.displacement(d);
        let phi = a.abs() + b.abs();
        let error = (steps.ct - once.ct).abs() + (steps.x - once.x).length();
        prop_assert!(error <= 256.0 * EPS * (1.0 + phi) * phi.exp() * size(d));
    }

    #[test]
    fn events_return_from_a_moving_frame(
        v in velocity(12.0), event in displacement(), origin in displacement(),
    ) {
        let origin = Event::<World>::new(origin.ct, origin.x);
        let frame = InertialFrame::<CameraFrame>::new(v, origin);
        prop_assert_eq!(frame.event_to_world(Event::ORIGIN), origin);
        prop_assert_eq!(frame.event_from_world(origin), Event::ORIGIN);
        let start = Event::ORIGIN + event;
        let same = frame.event_from_world(frame.event_to_world(start));
        let shift = Displacement::<World>::new(origin.ct, origin.x);
        // Adding the origin rounds by eps times its size, which the way back multiplies by 2γ.
        let scale = v.gamma() * size(event) + size(shift);
        let allowed = 256.0 * EPS * (1.0 + rapidity(v)) * v.gamma() * scale;
        let error = same - start;
        prop_assert!(size(error) <= allowed);
    }
}
