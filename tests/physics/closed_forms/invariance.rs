//! Only relative motion matters.

use glam::DVec3;
use nullray::spacetime::{Boost, CameraFrame, Direction, Frame, Rest, Velocity, World};
use proptest::prelude::*;

use crate::closed_forms::sample::{config, direction, velocity};

/// The frame in which the world, and all in it, moves.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Onlooker;

impl Frame for Onlooker {
    const NAME: &'static str = "onlooker";
}

/// The direction in which an emitter's own frame looks along the camera's ray, and λ′/λ, by way of the
/// frame `W` in which both velocities are known.
fn look<W: Frame>(
    camera: Velocity,
    emitter: Velocity,
    d: Direction<CameraFrame>,
) -> (Direction<Rest>, f64) {
    let (d, first) = Boost::<W, CameraFrame>::new(camera).direction(d);
    let (d, second) = Boost::<W, Rest>::new(emitter).inverse().direction(d);
    (d, first * second)
}

/// Of two pairs of directions: whether a rotation takes one pair to the other.
fn same_up_to_rotation<F: Frame>(a: [Direction<F>; 2], b: [Direction<F>; 2]) -> bool {
    let apart = |[p, q]: [Direction<F>; 2]| (p.unit() - q.unit()).length();
    (apart(a) - apart(b)).abs() < 1e-12
}

#[test]
fn a_moving_camera_and_a_source_that_moves_the_other_way_see_one_wavelength() {
    let v = Velocity::from_beta(DVec3::new(0.3, -0.5, 0.7)).unwrap();
    let d = Direction::new(DVec3::new(-1.0, 2.0, 0.3)).unwrap();
    let moving_camera = look::<World>(v, Velocity::REST, d);
    let moving_source = look::<World>(Velocity::REST, -v, d);
    assert_eq!(moving_camera, moving_source);
}

#[test]
fn perpendicular_boosts_turn_directions_by_the_wigner_angle() {
    // In SL(2, C), with c = cosh(φ/2) and s = sinh(φ/2), the boost from a camera with φ₁ along x to a
    // body with φ₂ along y is (c₂ − s₂ σ_y)(c₁ + s₁ σ_x) = c₁c₂ + c₂s₁ σ_x − c₁s₂ σ_y + i s₁s₂ σ_z. Its
    // rotation, about z by ε, is the part c₁c₂ + i s₁s₂ σ_z ∝ cos(ε/2) − i sin(ε/2) σ_z:
    // tan(ε/2) = −tanh(φ₁/2) tanh(φ₂/2).
    for (a, b) in [(0.1, 0.2), (1.0, 0.7), (3.0, 2.0)] {
        let camera = Velocity::from_rapidity(DVec3::X * a).unwrap();
        let body = Velocity::from_rapidity(DVec3::Y * b).unwrap();
        let relative = body.relative_to(camera).unwrap();
        let angle = -2.0 * ((0.5f64 * a).tanh() * (0.5f64 * b).tanh()).atan();
        for d in [DVec3::X, DVec3::Y, DVec3::new(-0.6, 0.8, 0.0)] {
            let d = Direction::new(d).unwrap();
            let (steps, _) = look::<World>(camera, body, d);
            let (once, _) = Boost::<CameraFrame, Rest>::new(relative)
                .inverse()
                .direction(d);
            let turned = glam::DQuat::from_rotation_z(angle) * once.unit();
            assert!((steps.unit() - turned).length() < 1e-13, "{a} {b}");
        }
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn the_wavelength_ratio_depends_on_the_relative_velocity_alone(
        camera in velocity(2.0), source in velocity(2.0),
        d1 in direction::<CameraFrame>(), d2 in direction::<CameraFrame>(),
    ) {
        // Λ(−v₂) Λ(v₁) is one boost by the relative velocity, then a rotation (Wigner's), which changes
        // neither frequencies nor angles.
        let relative = source.relative_to(camera).unwrap();
        let steps = [d1, d2].map(|d| look::<World>(camera, source, d));
        let once = [d1, d2].map(|d| look::<World>(Velocity::REST, relative, d));
        for (step, one) in steps.iter().zip(&once) {
            prop_assert!((step.1 / one.1 - 1.0).abs() < 1e-12, "{} {}", step.1, one.1);
        }
        prop_assert!(same_up_to_rotation(steps.map(|(d, _)| d), once.map(|(d, _)| d)));
    }

    #[test]
    fn relative_speed_is_mutual_and_follows_the_law_of_cosines(
        a in velocity(6.0), b in velocity(6.0),
    ) {
        // γ of one in the frame of the other: U₁·U₂ = γ₁γ₂ (1 − β₁·β₂).
        let [ab, ba] = [a.relative_to(b).unwrap(), b.relative_to(a).unwrap()];
        let spatial = a.beta() * a.gamma();
        let expected = a.gamma() * b.gamma() - spatial.dot(b.beta() * b.gamma());
        let allowed = 1e-14 * a.gamma() * b.gamma();
        prop_assert!((ab.gamma() - expected).abs() <= allowed);
        prop_assert!((ba.gamma() - expected).abs() <= allowed);
    }

    #[test]
    fn scene_and_camera_boosted_together_look_the_same(
        camera in velocity(1.5), body in velocity(1.5), boost in velocity(1.5),
        d1 in direction::<CameraFrame>(), d2 in direction::<CameraFrame>(),
    ) {
        // To an onlooker the world itself moves with `boost`. The camera's axes, rotation-free from the
        // onlooker's, are turned against those from the world's: d′ is found again by way of the light.
        let seen = |v: Velocity| v.relative_to(-boost).unwrap();
        let world_from_camera = Boost::<World, CameraFrame>::new(camera);
        let onlooker_from_world = Boost::<Onlooker, World>::new(boost);
        let camera_from_onlooker = Boost::<Onlooker, CameraFrame>::new(seen(camera)).inverse();
        let again = [d1, d2].map(|d| {
            let (d, first) = world_from_camera.direction(d);
            let (d, second) = onlooker_from_world.direction(d);
            let (d, third) = camera_from_onlooker.direction(d);
            (d, first * second * third)
        });
        for (_, frequency) in again {
            prop_assert!((frequency - 1.0).abs() < 1e-12, "{frequency}");
        }
        let turned = again.map(|(d, _)| d);
        prop_assert!(same_up_to_rotation([d1, d2], turned));

        // From there on every pixel meets the body as before.
        let before = [d1, d2].map(|d| look::<World>(camera, body, d));
        let after = turned.map(|d| look::<Onlooker>(seen(camera), seen(body), d));
        for (b, a) in before.iter().zip(&after) {
            prop_assert!((a.1 / b.1 - 1.0).abs() < 1e-12, "{} {}", a.1, b.1);
        }
        prop_assert!(same_up_to_rotation(before.map(|(d, _)| d), after.map(|(d, _)| d)));
    }
}
