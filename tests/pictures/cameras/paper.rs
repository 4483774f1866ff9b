//! A camera with the equations of Jarabo et al. 2015 follows these equations.

use glam::DVec3;
use nullray::camera::{Camera, ViewKind};
use nullray::scene::model::{
    Assembly, Elements, Equations, Motion, Pivot, Records, Rotation, Scene, Shutter,
};
use nullray::spacetime::{Event, Velocity, paper2015};

use super::bench_camera::{looking_along_z, sensor};

const BETAS: [f64; 5] = [-0.99, -0.3, 0.1, 0.6, 0.97];

fn moving(beta: f64) -> Scene {
    let mut scene = looking_along_z();
    scene.equations = Equations::Paper2015;
    scene.camera.velocity = Velocity::from_beta(DVec3::Z * beta).unwrap();
    scene.camera.time = 1.7;
    scene.camera.origin = Event::new(-0.4, DVec3::new(0.1, 0.2, 0.3));
    scene
}

/// The angle of propagation to +z.
fn propagation(look: DVec3) -> f64 {
    (-look.z).clamp(-1.0, 1.0).acos()
}

#[test]
fn light_left_at_the_time_of_equation_11_with_the_distance_of_equation_3() {
    for beta in BETAS {
        let scene = moving(beta);
        let camera = Camera::new(&scene).unwrap();
        assert_eq!(camera.view.kind(), ViewKind::Paper);
        for [x, y] in [[1.3, 0.8], [0.2, 1.9], [2.0, 2.0]] {
            let ray = camera.view.ray(x, y, 0.0);
            let leaves = camera.shot.event + ray.origin.displacement;
            for (distance, index) in [(2.5, 1.0), (0.3, 1.4)] {
                let z = paper2015::contracted_distance(beta, propagation(ray.d.unit()), distance);
                let expected = -0.4 + paper2015::emission_time(beta, 1.7, z, index);
                let got = leaves.ct - index * ray.origin.delay * distance;
                assert!((got - expected).abs() < 1e-14, "{beta}: {got} {expected}");
            }
            // It is where the camera really is.
            assert_eq!(leaves.x, camera.shot.event.x);
        }
    }
}

#[test]
fn directions_and_doppler_factors_are_those_of_equation_2() {
    for beta in BETAS {
        let camera = Camera::new(&moving(beta)).unwrap();
        for x in [1.0, 1.3, 2.0, 0.1] {
            // Half the film is one focal length, and a positive x is seen towards −x.
            let camera_angle = std::f64::consts::PI - (x - 1.0f64).atan();
            let ray = camera.view.ray(x, 1.0, 0.0);
            let world_angle = paper2015::world_angle(beta, camera_angle);
            let d = paper2015::doppler_factor(beta, camera_angle);
            assert!((ray.ratio / d - 1.0).abs() < 1e-12, "{beta} {x}");
            let across = ray.d.unit().truncate().length();
            assert!((across - world_angle.sin().abs()).abs() < 1e-12 * (1.0 + 1.0 / d));
        }
    }
}

#[test]
fn the_field_of_view_is_that_of_equation_4_for_a_focal_length_fixed_in_the_world() {
    for beta in BETAS {
        let mut scene = moving(beta);
        scene.effects.aberration = false;
        scene.camera.sensor = sensor(0.05, Assembly::WorldLength);
        let edge = Camera::new(&scene)
            .unwrap()
            .view
            .ray(2.0, 1.0, 0.0)
            .d
            .unit();
        let half = 0.5 * paper2015::field_of_view(beta, std::f64::consts::FRAC_PI_2);
        assert!((edge.x.abs() / edge.z - half.tan()).abs() < 1e-14, "{beta}");
    }
}

#[test]
fn an_accelerating_camera_has_the_separation_of_equation_16_and_the_time_of_equation_15() {
    let (g, d, time) = (0.8, 0.4, 1.7);
    let mut scene = moving(0.0);
    scene.effects.aberration = false;
    scene.camera.motion = Motion::Accelerated(DVec3::Z * g);
    scene.camera.sensor = sensor(d, Assembly::Bell);
    let camera = Camera::new(&scene).unwrap();
    let ray = camera.view.ray(2.0, 1.0, 0.0);
    let world_time = paper2015::world_time(g, time);
    assert!((camera.shot.event.ct + 0.4 - world_time).abs() < 1e-14);
    assert_eq!(ray.origin.displacement.ct, 0.0);
    let speed = paper2015::speed_after(g, world_time);
    let separation = paper2015::comoving_separation(g, d, speed);
    let edge = ray.d.unit();
    assert!((edge.x.abs() / edge.z - d / separation).abs() < 1e-14);
}

#[test]
fn an_exposure_is_shortened_by_the_doppler_factor_and_sums_over_camera_time() {
    for beta in BETAS {
        let mut scene = moving(beta);
        let instant = Camera::new(&scene).unwrap().view.ray(1.4, 0.9, 0.0);
        scene.camera.shutter = Some(Shutter {
            duration: 0.8,
            records: Records::Energy,
            integration: Default::default(),
        });
        let ray = Camera::new(&scene).unwrap().view.ray(1.4, 0.9, 0.5);
        let d = instant.ratio;
        assert!((ray.origin.weight - 0.8 / d).abs() < 1e-14);
        let later = ray.origin.displacement.ct - instant.origin.displacement.ct;
        let gamma = paper2015::lorentz_factor(beta);
        assert!((later - 0.4 / d / gamma).abs() < 1e-14);
    }
}

fn turning(rate: f64, elements: Elements, equations: Equations) -> Scene {
    let mut scene = looking_along_z();
    scene.equations = equations;
    scene.camera.sensor = sensor(0.5, Assembly::Rigid);
    scene.camera.rotation = Some(Rotation {
        axis: DVec3::Y,
        rate,
        through: Pivot::Sensor,
        elements,
    });
    scene
}

#[test]
fn an_element_with_a_pinhole_of_its_own_looks_aberrated_by_its_own_velocity() {
    // Elements right and left of the axis move along ∓z at Ω|x|.
    for (x, forward) in [(0.0, 1.0), (2.0, -1.0)] {
        let scene = turning(1.2, Elements::Comoving, Equations::Exact);
        let ray = Camera::new(&scene).unwrap().view.ray(x, 1.0, 0.0);
        let speed = forward * 1.2 * 0.5;
        let camera_angle = std::f64::consts::PI * 0.75;
        let expected = paper2015::world_angle(speed, camera_angle);
        assert!((propagation(ray.d.unit()) - expected).abs() < 1e-14, "{x}");
        let d = paper2015::doppler_factor(speed, camera_angle);
        assert!((ray.ratio / d - 1.0).abs() < 1e-14, "{x}");
    }
}

/// An element that runs back finds the pinhole behind its own plane once its speed along the normal is
/// the sine of the pinhole's elevation: it flees faster than light approaches. Nothing stands between
/// one that runs forward and its pinhole. Eq. 17's sums are the relative velocities in a mirror.
#[test]
fn an_element_that_flees_from_its_pinhole_sees_nothing() {
    let sees = |rate: f64, x: f64, equations| {
        let scene = turning(rate, Elements::Aberrated, equations);
        let camera = Camera::new(&scene).unwrap();
        camera.view.ray(x, 1.0, 0.0).origin.sees()
    };
    // The sensor is as wide as its focal length on either side: the pinhole is 45° above the edge, which
    // moves at Ω/2.
    let limit = 2.0 * 0.5f64.sqrt();
    for (rate, visible) in [(0.999 * limit, true), (1.001 * limit, false)] {
        assert_eq!(sees(rate, 2.0, Equations::Exact), visible, "running back");
        assert!(sees(rate, 0.0, Equations::Exact), "running forward");
        assert_eq!(
            sees(rate, 0.0, Equations::Paper2015),
            visible,
            "running forward"
        );
        assert!(sees(rate, 2.0, Equations::Paper2015), "running back");
        assert!(sees(rate, 1.0, Equations::Exact), "in the middle");
    }
    assert!(sees(1.99, 0.0, Equations::Exact));
}

#[test]
fn aberration_of_the_pinhole_there_and_back_leaves_the_exact_direction() {
    for x in [0.3, 1.1, 1.8] {
        let ray = |elements| {
            let scene = turning(0.9, elements, Equations::Exact);
            Camera::new(&scene).unwrap().view.ray(x, 0.6, 0.0)
        };
        let (exact, aberrated) = (ray(Elements::Exact), ray(Elements::Aberrated));
        assert_eq!((exact.d, exact.ratio), (aberrated.d, aberrated.ratio));
    }
}
