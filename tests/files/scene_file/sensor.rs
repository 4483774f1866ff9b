//! The camera's sensor, rotation, shutter and equations in scene files.

use std::f64::consts::PI;
use std::path::Path;

use glam::DVec3;
use nullray::scene::model::*;
use nullray::scene::{Overrides, parse};
use nullray::spacetime::Velocity;

use crate::scene_file::motion::camera;

const POSE: &str = "eye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [40, 30]\n";

fn seen(keys: &str) -> CameraModel {
    camera(&format!("{POSE}{keys}"))
}

#[test]
fn a_camera_is_a_point_with_an_instant_unless_the_file_says_otherwise() {
    let camera = seen("");
    assert_eq!(camera.sensor, None);
    assert_eq!(camera.rotation, None);
    assert_eq!(camera.shutter, None);
    assert_eq!(camera.frame_interval, None);
    assert_eq!(camera.sensor_corners(), None);
}

#[test]
fn the_width_of_a_sensor_gives_the_field_of_view() {
    let camera = seen("sensor = { focal_length = '36 mm', width = '72 mm' }");
    assert!((camera.horizontal_fov - PI / 2.0).abs() < 1e-15);
    let rigid = Sensor {
        focal_length: 0.036,
        assembly: Assembly::Rigid,
    };
    assert_eq!(camera.sensor, Some(rigid));
    let [width, height] = camera.sensor_half_size().unwrap();
    assert!((width - 0.036).abs() < 1e-16 && (height - 0.027).abs() < 1e-16);
}

#[test]
fn a_field_of_view_gives_the_width_of_the_sensor() {
    let camera = seen("hfov = '90 deg'\nsensor = { focal_length = '2 m' }");
    let [top_left, _, bottom_right, _] = camera.sensor_corners().unwrap();
    // 2 m behind a pinhole that looks along −z, 4 m wide and 3 m high.
    assert!((top_left - DVec3::new(-2.0, 1.5, 2.0)).length() < 1e-15);
    assert!((bottom_right - DVec3::new(2.0, -1.5, 2.0)).length() < 1e-15);
}

#[test]
fn every_assembly_is_read() {
    for (said, expected) in [
        ("rigid", Assembly::Rigid),
        ("world_length", Assembly::WorldLength),
        ("bell", Assembly::Bell),
    ] {
        let camera = seen(&format!(
            "sensor = {{ focal_length = '1 m', assembly = '{said}' }}"
        ));
        assert_eq!(camera.sensor.map(|s| s.assembly), Some(expected));
    }
}

#[test]
fn a_focal_length_measured_in_the_world_is_contracted_along_the_motion_only() {
    // β = 3/5, γ = 5/4. At 45°: d′ = d/√(1 − β²/2) = d/√0.82.
    let velocity = Velocity::from_beta(DVec3::X * 0.6).unwrap();
    let own = |assembly, forward: DVec3| {
        let sensor = Sensor {
            focal_length: 2.0,
            assembly,
        };
        sensor.own_focal_length(forward.normalize(), velocity)
    };
    for assembly in [Assembly::WorldLength, Assembly::Bell] {
        assert!((own(assembly, -DVec3::X) - 2.5).abs() < 1e-15);
        assert!((own(assembly, DVec3::Y) - 2.0).abs() < 1e-15);
        let oblique = own(assembly, DVec3::new(1.0, 0.0, 1.0));
        assert!((oblique - 2.0 / 0.82f64.sqrt()).abs() < 1e-15);
    }
    assert_eq!(own(Assembly::Rigid, DVec3::X), 2.0);
}

#[test]
fn a_rotation_has_an_axis_a_rate_a_pivot_and_elements() {
    let sensor = "sensor.focal_length = '1 cm'\n";
    let camera = seen(&format!(
        "{sensor}rotation = {{ axis = [0, 2, 0], rate = '-0.5 rad/ns', through = 'sensor', elements = 'aberrated' }}"
    ));
    let expected = Rotation {
        axis: DVec3::Y,
        rate: -0.5,
        through: Pivot::Sensor,
        elements: Elements::Aberrated,
    };
    assert_eq!(camera.rotation, Some(expected));
    let plain = seen("rotation = { axis = [0, 2, 0], rate = '180 deg/m' }");
    let expected = Rotation {
        axis: DVec3::Y,
        rate: PI,
        through: Pivot::Pinhole,
        elements: Elements::Exact,
    };
    assert_eq!(plain.rotation, Some(expected));
    let own = seen(&format!(
        "{sensor}rotation = {{ axis = [0, 2, 0], rate = '1 rad/m', elements = 'comoving' }}"
    ));
    let elements = own.rotation.map(|r| r.elements);
    assert_eq!(elements, Some(Elements::Comoving));
}

#[test]
fn every_part_of_a_sensor_may_turn_at_almost_the_speed_of_light() {
    // A sensor of 8 m by 6 m, 12 m behind the pinhole: its corners are 5 m from the axis of view, and
    // √(12² + 4²) m from a vertical axis through the pinhole.
    let turning = |axis: &str, rate: f64| {
        seen(&format!(
            "sensor = {{ focal_length = '12 m', width = '8 m' }}\nrotation = {{ axis = {axis}, rate = '{rate} rad/m' }}"
        ))
    };
    assert!(turning("[0, 0, 1]", 0.1999).rotation.is_some());
    assert!(
        turning("[0, 1, 0]", 0.999 / 160f64.sqrt())
            .rotation
            .is_some()
    );
    // A point camera has no corners.
    let point = seen("rotation = { axis = [0, 1, 0], rate = '1e6 rad/m' }");
    assert!(point.rotation.is_some());
}

#[test]
fn a_camera_that_says_an_acceleration_of_zero_may_turn() {
    let camera = seen(
        "motion.acceleration.proper = '0 /m'\nrotation = { axis = [0, 1, 0], rate = '1 rad/m' }",
    );
    assert!(camera.rotation.is_some());
}

#[test]
fn a_rigid_sensor_may_lead_its_pinhole_at_any_acceleration() {
    // It brakes: the sensor behind the pinhole is on the side of the acceleration.
    let camera = seen(
        "sensor.focal_length = '9 m'\nhfov = '1 deg'\nmotion.acceleration = { proper = '0.5 /m', direction = [0, 0, 1] }",
    );
    assert!(camera.sensor.is_some());
}

#[test]
fn a_shutter_records_the_mean_or_the_energy() {
    let camera = seen("shutter.duration = '3 ns'");
    let mean = Shutter {
        duration: 3.0,
        records: Records::Mean,
        integration: Default::default(),
    };
    assert_eq!(camera.shutter, Some(mean));
    let camera = seen("shutter = { duration = '1 mm', records = 'energy' }");
    let energy = Shutter {
        duration: 1e-3,
        records: Records::Energy,
        integration: Default::default(),
    };
    assert_eq!(camera.shutter, Some(energy));
}

#[test]
fn a_scene_is_exact_unless_it_asks_for_the_papers_equations() {
    for (said, expected) in [
        ("", Equations::Exact),
        ("model = 'exact'", Equations::Exact),
        ("model = 'paper2015'", Equations::Paper2015),
    ] {
        let text = format!(
            "{said}\n[camera]\n{POSE}sensor.focal_length = '1 cm'\n\
             rotation = {{ axis = [0, 1, 0], rate = '1 rad/m', elements = 'comoving' }}\n\
             [[object]]\nshape.sphere.radius = 1\n"
        );
        let scene = parse(&text, "test", Path::new(""), &Overrides::default()).unwrap();
        assert_eq!(scene.equations, expected);
    }
}
