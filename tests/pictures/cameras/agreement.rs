//! Cases in which different cameras must agree.

use glam::DVec3;
use nullray::camera::{AnyView, Camera, ViewKind};
use nullray::scene::model::{
    Assembly, Elements, Equations, Motion, Pivot, Records, Rotation, Scene, Shutter,
};
use nullray::spacetime::Velocity;

use super::bench_camera::{scene, sensor, start};

const FILM: [[f64; 2]; 6] = [
    [1.0, 1.0],
    [0.0, 0.0],
    [2.0, 0.3],
    [0.7, 1.9],
    [1.3, 0.2],
    [0.0, 2.0],
];

/// The largest difference of look directions and of W over the film.
fn difference(a: &AnyView, b: &AnyView) -> f64 {
    let differ = |[x, y]: [f64; 2]| {
        let (a, b) = (a.ray(x, y, 0.5), b.ray(x, y, 0.5));
        (a.d.unit() - b.d.unit())
            .length()
            .max((a.ratio / b.ratio - 1.0).abs())
    };
    FILM.into_iter().map(differ).fold(0.0, f64::max)
}

fn view(scene: &Scene) -> AnyView {
    Camera::new(scene).unwrap().view
}

fn turning(elements: Elements) -> Rotation {
    Rotation {
        axis: DVec3::Y,
        rate: 0.0,
        through: Pivot::Sensor,
        elements,
    }
}

#[test]
fn at_rest_every_camera_is_the_plain_pinhole() {
    let plain = view(&scene());
    assert_eq!(plain.kind(), ViewKind::Still);
    let mut kinds = Vec::new();
    for assembly in [Assembly::Rigid, Assembly::WorldLength, Assembly::Bell] {
        for motion in [Motion::Inertial, start(DVec3::NEG_Z * 0.3)] {
            for rotation in [
                None,
                Some(Elements::Exact),
                Some(Elements::Comoving),
                Some(Elements::Aberrated),
            ] {
                for equations in [Equations::Exact, Equations::Paper2015] {
                    let mut scene = scene();
                    scene.camera.sensor = sensor(0.036, assembly);
                    scene.camera.motion = motion.clone();
                    scene.camera.rotation = rotation.map(turning);
                    scene.equations = equations;
                    let view = view(&scene);
                    assert!(difference(&view, &plain) < 1e-14, "{view:?}");
                    kinds.push(view.kind());
                }
            }
        }
    }
    for kind in [
        ViewKind::Inertial,
        ViewKind::Accelerated,
        ViewKind::Turning,
        ViewKind::Paper,
    ] {
        assert!(kinds.contains(&kind), "{kind:?}");
    }
}

#[test]
fn a_shutter_that_is_open_for_no_time_shows_the_instant() {
    let mut scene = scene();
    scene.camera.velocity = Velocity::from_beta(DVec3::new(0.3, -0.2, 0.5)).unwrap();
    let instant = view(&scene);
    scene.camera.shutter = Some(Shutter {
        duration: 1e-30,
        records: Records::Mean,
        integration: Default::default(),
    });
    let exposed = view(&scene);
    assert_eq!(difference(&exposed, &instant), 0.0);
    let from = exposed.ray(0.2, 0.3, 1.0).origin;
    assert!(from.displacement.ct < 2e-30 && from.displacement.ct > 1e-30);
}

#[test]
fn without_acceleration_a_camera_on_a_world_line_is_inertial() {
    for assembly in [Assembly::Rigid, Assembly::WorldLength, Assembly::Bell] {
        let mut scene = scene();
        scene.camera.velocity = Velocity::from_beta(DVec3::new(0.5, 0.1, -0.6)).unwrap();
        scene.camera.sensor = sensor(0.2, assembly);
        scene.camera.time = 3.0;
        let inertial = view(&scene);
        scene.camera.motion = start(DVec3::new(1e-17, 0.0, 0.0));
        let accelerated = view(&scene);
        assert_eq!(accelerated.kind(), ViewKind::Accelerated);
        assert!(difference(&accelerated, &inertial) < 1e-14, "{assembly:?}");
        for [x, y] in FILM {
            let (a, b) = (accelerated.ray(x, y, 0.0), inertial.ray(x, y, 0.0));
            let (a, b) = (a.origin.displacement, b.origin.displacement);
            assert!((a.ct - b.ct).abs() < 1e-14 && (a.x - b.x).length() < 1e-14);
        }
    }
}

#[test]
fn a_sensor_that_does_not_turn_sees_what_one_without_a_rotation_does() {
    for assembly in [Assembly::Rigid, Assembly::WorldLength] {
        let mut scene = scene();
        scene.camera.velocity = Velocity::from_beta(DVec3::new(0.5, 0.0, -0.6)).unwrap();
        scene.camera.sensor = sensor(0.2, assembly);
        let plain = view(&scene);
        scene.camera.rotation = Some(turning(Elements::Exact));
        assert!(difference(&view(&scene), &plain) < 1e-14, "{assembly:?}");
    }
}

#[test]
fn a_rigid_camera_keeps_its_digits_at_any_speed() {
    let mut scene = scene();
    scene.camera.sensor = sensor(0.2, Assembly::Rigid);
    for rapidity in [3.0, 10.0, 17.0] {
        scene.camera.velocity = Velocity::from_rapidity(DVec3::NEG_Z * rapidity).unwrap();
        scene.camera.motion = Motion::Inertial;
        let inertial = view(&scene);
        scene.camera.motion = Motion::Accelerated(DVec3::X * 1e-18);
        let accelerated = view(&scene);
        assert_eq!(accelerated.kind(), ViewKind::Accelerated);
        // Aberration magnifies the rounding of a direction by 1/W, at most e^w.
        let allowed = 4e-16 * f64::exp(rapidity);
        assert!(difference(&accelerated, &inertial) < allowed, "{rapidity}");
    }
}

#[test]
fn a_focal_length_fixed_in_the_world_is_gamma_times_longer_along_the_motion_only() {
    let half_angle_tangent = |beta: DVec3| {
        let mut scene = scene();
        scene.effects.aberration = false;
        scene.camera.velocity = Velocity::from_beta(beta).unwrap();
        scene.camera.sensor = sensor(0.05, Assembly::WorldLength);
        let d = view(&scene).ray(2.0, 1.0, 0.0).d.unit();
        d.x / -d.z
    };
    // γ = 5/4 at β = 0.6. At 45° the world sees √(½ + ½/γ²) of the rod.
    assert!((half_angle_tangent(DVec3::NEG_Z * 0.6) - 0.8).abs() < 1e-15);
    assert!((half_angle_tangent(DVec3::X * 0.6) - 1.0).abs() < 1e-15);
    let oblique = DVec3::new(0.0, 0.6, 0.6) * 0.5f64.sqrt();
    assert!((half_angle_tangent(oblique) - 0.82f64.sqrt()).abs() < 1e-15);
}
