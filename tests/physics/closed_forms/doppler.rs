//! Doppler effect, aberration, and their effect on the light incident on a surface.

use glam::{DMat4, DVec3, DVec4};
use nullray::spacetime::{
    Boost, CameraFrame, Direction, Displacement, Quantity, Rest, Velocity, WavelengthRatio, World,
};
use proptest::prelude::*;

use crate::closed_forms::sample::{EPS, config, direction, perpendicular, unit, velocity};

const BETAS: [f64; 6] = [0.1, 0.3, 0.6, 0.9, 0.99, 0.9999];

/// λ′/λ of a source at rest in the world, for a camera that moves at β along n, by the camera's angle.
fn ratio_by_camera_angle(beta: f64, n: DVec3, d: DVec3) -> f64 {
    let velocity = Velocity::from_beta(n * beta).unwrap();
    let d = Direction::new(d).unwrap();
    Boost::<World, CameraFrame>::new(velocity).direction(d).1
}

/// The same by the world's angle.
fn ratio_by_world_angle(beta: f64, n: DVec3, d: DVec3) -> f64 {
    let velocity = Velocity::from_beta(n * beta).unwrap();
    let d = Direction::new(d).unwrap();
    1.0 / Boost::<CameraFrame, World>::new(-velocity).direction(d).1
}

fn assert_close(got: f64, expected: f64, relative: f64) {
    assert!(
        (got / expected - 1.0).abs() <= relative,
        "{got} for {expected}"
    );
}

#[test]
fn the_longitudinal_doppler_effect_is_the_root_of_one_minus_beta_over_one_plus_beta() {
    // Flying towards the source, the camera counts crests emitted dt apart at dt′ = dt √((1−β)/(1+β)).
    // Along the motion the angle is the same in both frames.
    let n = DVec3::new(2.0, -3.0, 6.0) / 7.0;
    for beta in BETAS {
        let blue = ((1.0 - beta) / (1.0 + beta)).sqrt();
        // What β's rounding leaves of 1 − β.
        let relative = 16.0 * EPS / (1.0 - beta);
        assert_close(ratio_by_camera_angle(beta, n, n), blue, relative);
        assert_close(ratio_by_camera_angle(beta, n, -n), 1.0 / blue, relative);
        assert_close(ratio_by_world_angle(beta, n, n), blue, relative);
        assert_close(ratio_by_world_angle(beta, n, -n), 1.0 / blue, relative);
    }
}

#[test]
fn the_transverse_doppler_effect_depends_on_whose_right_angle_it_is() {
    // W = γ(1 − β cos θ′) = 1/(γ(1 + β cos θ)). At θ′ = 90° in the camera's frame the source's clock is
    // seen slow: W = γ. At θ = 90° in the world the camera's own clock is slow: W = 1/γ.
    let n = DVec3::new(2.0, -3.0, 6.0) / 7.0;
    let across = DVec3::new(3.0, 2.0, 0.0);
    for beta in BETAS {
        let gamma = 1.0 / ((1.0 - beta) * (1.0 + beta)).sqrt();
        let relative = 16.0 * EPS * gamma * gamma;
        assert_close(ratio_by_camera_angle(beta, n, across), gamma, relative);
        assert_close(ratio_by_world_angle(beta, n, across), 1.0 / gamma, relative);
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn things_are_seen_nearer_to_the_direction_of_motion_by_the_aberration_formula(
        n in unit(), beta in 0.0..0.999f64, d in direction::<World>(),
    ) {
        // Of the null vector (−1, d) the camera has (−γ(1 + β cos θ), γ(cos θ + β)) in time and along the
        // motion, and the one over the other is cos θ′ = (cos θ + β)/(1 + β cos θ).
        let velocity = Velocity::from_beta(n * beta).unwrap();
        let (seen, _) = Boost::<World, CameraFrame>::new(velocity).inverse().direction(d);
        let cos = n.dot(d.unit());
        let expected = (cos + beta) / (1.0 + beta * cos);
        let allowed = 16.0 * EPS * velocity.gamma().powi(2);
        prop_assert!((n.dot(seen.unit()) - expected).abs() <= allowed);
        prop_assert!(n.dot(seen.unit()) >= cos - allowed);
    }

    #[test]
    fn half_the_angle_s_tangent_scales_by_e_to_the_rapidity_and_the_azimuth_stays(
        v in velocity(19.0), d in direction::<CameraFrame>(),
    ) {
        // tan²(θ/2) = (1 − cos θ)/(1 + cos θ); in the aberration formula the two factors scale by
        // (1 ± β): tan(θ/2) = e^φ tan(θ′/2).
        let (phi, n) = (v.rapidity().length(), v.rapidity().normalize_or(DVec3::X));
        let (world, w) = Boost::<World, CameraFrame>::new(v).direction(d);
        let angle = |d: DVec3| n.cross(d).length().atan2(n.dot(d));
        let camera_half = (0.5 * angle(d.unit())).tan();
        let expected = 2.0 * (phi.exp() * camera_half).atan();
        let allowed = 32.0 * EPS * (1.0 + phi + 1.0 / w);
        prop_assert!((angle(world.unit()) - expected).abs() <= allowed);
        let triple = n.dot(d.unit().cross(world.unit()));
        prop_assert!(triple.abs() <= allowed);
    }

    #[test]
    fn a_moving_surface_receives_the_photons_that_its_world_volume_meets(
        v in velocity(2.0), d in direction::<World>(), normal in unit(),
    ) {
        // World: one photon per volume, all flying along −d: four-current J = (1, −d). A unit square
        // with edges a, b, at rest in a moving frame, sweeps in a unit of its own time the volume spanned
        // by the four-vectors A, B, U; the number of photons that cross it is |det(J, A, B, U)|. In the
        // square's frame that is the photon irradiance across the light times |cos| of incidence.
        let a = perpendicular(normal);
        let b = normal.cross(a);
        let world_from_rest = Boost::<World, Rest>::new(v);
        let column = |ct, x| {
            let four = world_from_rest.displacement(Displacement::new(ct, x));
            DVec4::new(four.ct, four.x.x, four.x.y, four.x.z)
        };
        let current = (-d.unit()).extend(1.0);
        let current = DVec4::new(current.w, current.x, current.y, current.z);
        let counted = DMat4::from_cols(
            current, column(0.0, a), column(0.0, b), column(1.0, DVec3::ZERO),
        ).determinant().abs();

        let (seen, frequency) = world_from_rest.inverse().direction(d);
        let w = WavelengthRatio(1.0 / frequency);
        let cosine = seen.unit().dot(normal).abs();
        let photons = Quantity::Photons.irradiance_factor(w);
        let allowed = 64.0 * EPS * v.gamma().powi(3);
        prop_assert!((counted - photons * cosine).abs() <= allowed, "{counted}");

        // Each photon carries ω′/ω = 1/W of its energy.
        let energy = Quantity::Integrated.irradiance_factor(w);
        prop_assert!((energy / (photons * frequency) - 1.0).abs() < 8.0 * EPS);
    }
}
