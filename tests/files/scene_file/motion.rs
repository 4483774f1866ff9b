//! The camera's motion in scene files.

use std::path::Path;

use glam::DVec3;
use nullray::scene::model::*;
use nullray::scene::{Overrides, parse};
use nullray::spacetime::worldline::{Axes, Segment};
use nullray::spacetime::{Event, Velocity};

pub fn camera(keys: &str) -> CameraModel {
    let text = format!(
        "speed_of_light = '1e9 m/s'\n[camera]\n{keys}\n[[object]]\nshape.sphere.radius = 1\n"
    );
    let scene = parse(&text, "test", Path::new(""), &Overrides::default());
    scene.unwrap().camera
}

fn moving(motion: &str) -> CameraModel {
    camera(&format!(
        "eye = [3, 0, 4]\nlook_at = [0, 0, 0]\nclock_zero = '7 m'\nmotion = {{ {motion} }}"
    ))
}

fn refused(motion: &str) -> String {
    let text = format!(
        "[camera]\neye = [3, 0, 4]\nlook_at = [0, 0, 0]\nmotion = {{ {motion} }}\n[[object]]\nshape.sphere.radius = 1\n"
    );
    let scene = parse(&text, "test", Path::new(""), &Overrides::default());
    scene.unwrap_err().to_string()
}

fn span(camera: &CameraModel) -> [f64; 2] {
    camera.world_line().unwrap().span()
}

#[test]
fn without_a_motion_a_camera_does_not_accelerate() {
    let camera = camera("eye = [0, 0, 5]\nlook_at = [0, 0, 0]\nframe_interval = '2 ns'");
    assert_eq!(camera.motion, Motion::Inertial);
    assert_eq!(camera.frame_interval, Some(2.0));
    assert_eq!(span(&camera), [f64::NEG_INFINITY, f64::INFINITY]);
}

#[test]
fn an_acceleration_has_a_magnitude_and_a_direction() {
    for (said, expected) in [
        ("{ proper = '0.5 /m', direction = [0, 0, -3] }", -0.5),
        ("{ proper = '0.5 1/m', direction = [0, 0, -3] }", -0.5),
        ("{ proper = '-0.25 c/ns', direction = [0, 0, -1] }", 0.25),
        ("{ proper = '1e18 m/s²', direction = [0, 0, 2] }", 1.0),
    ] {
        let camera = moving(&format!("acceleration = {said}"));
        assert_eq!(
            camera.motion,
            Motion::Accelerated(DVec3::Z * expected),
            "{said}"
        );
    }
}

#[test]
fn an_acceleration_of_zero_is_none() {
    for said in [
        "acceleration = { proper = '0 /m' }",
        "acceleration = { proper = '0 c/s', direction = [0, 0, 0] }",
        "segments = [{ duration = '2 m' }, { acceleration = { proper = '0 /m' } }]",
    ] {
        assert_eq!(moving(said).motion, Motion::Inertial, "{said}");
    }
}

#[test]
fn segments_coast_where_they_say_no_acceleration_and_the_last_may_never_end() {
    let camera = moving(
        "segments = [{ duration = '2 ns', acceleration = { proper = '0.5 /m', direction = [1, 0, 0] } }, \
         { duration = '1 m' }, { acceleration = { proper = '1 /m', direction = [0, -1, 0] } }]",
    );
    let segment = |duration, acceleration| Segment {
        duration,
        acceleration,
    };
    let expected = vec![
        segment(2.0, DVec3::X * 0.5),
        segment(1.0, DVec3::ZERO),
        segment(f64::INFINITY, -DVec3::Y),
    ];
    assert_eq!(camera.motion, Motion::Segments(expected));
}

#[test]
fn a_profile_begins_and_ends_with_its_first_and_last_time() {
    let camera = moving(
        "profile = [{ time = '-1 m', acceleration = { proper = '1 /m', direction = [0, 1, 0] } }, \
         { time = '4 ns' }]",
    );
    let expected = vec![(-1.0, DVec3::Y), (4.0, DVec3::ZERO)];
    let (knots, axes) = (expected, Axes::Gyroscope);
    assert_eq!(camera.motion, Motion::Profile { knots, axes });
    assert_eq!(span(&camera), [-1.0, 4.0]);
    assert_eq!(camera.origin, Event::new(7.0, DVec3::new(3.0, 0.0, 4.0)));
}

#[test]
fn accelerations_are_given_in_axes_of_a_gyroscope_or_of_the_world() {
    let profile = "profile = [{ time = '0 m', acceleration = { proper = '1 /m', direction = [0, 1, 0] } }, \
                   { time = '4 m' }]";
    for (said, expected) in [("world", Axes::World), ("gyroscope", Axes::Gyroscope)] {
        let camera = moving(&format!("axes = '{said}', {profile}"));
        let Motion::Profile { axes, .. } = camera.motion else {
            panic!("{:?}", camera.motion);
        };
        assert_eq!(axes, expected);
    }
    // The camera moves along x at the beginning or rests: the same axes for what is along it.
    moving("axes = 'world', acceleration = { proper = '1 /m', direction = [0, 1, 0] }");
    let turning = "axes = 'world', segments = [\
        { duration = '1 m', acceleration = { proper = '1 /m', direction = [1, 0, 0] } }, \
        { acceleration = { proper = '1 /m', direction = [0, 1, 0] } }]";
    let error = refused(turning);
    assert!(
        error.contains("does not give hyperbolic motion") && error.contains("gyroscope"),
        "{error}"
    );
    let circle =
        "axes = 'world', circle = { centre = [3, 9, 0], axis = [0, 2, 0], period = '60 m' }";
    let error = refused(circle);
    assert!(error.contains("applies to accelerations"), "{error}");
}

#[test]
fn keyframes_say_where_the_camera_is_and_where_it_looks_from() {
    let camera = camera(
        "look_at = [0, 0, 0]\nmotion.keyframes = [{ time = '-2 m', position = [0, 0, 5] }, \
         { time = '3 ns', position = [3, 0, 5] }]",
    );
    let events = vec![
        Event::new(-2.0, DVec3::Z * 5.0),
        Event::new(3.0, DVec3::new(3.0, 0.0, 5.0)),
    ];
    assert_eq!(camera.origin, events[0]);
    assert_eq!(camera.axes[2], DVec3::NEG_Z);
    assert_eq!(camera.motion, Motion::Keyframes(events));
    // A straight line at β = 3/5 for 5 m: 4 m of proper time.
    assert!((camera.velocity.beta() - DVec3::X * 0.6).length() < 1e-12);
    assert!((span(&camera)[1] - 4.0).abs() < 1e-12);
}

#[test]
fn a_circle_gives_the_velocity_across_its_radius() {
    // 4 m from the axis x = 3, at half the speed of light: ω = ⅛ per metre.
    for (speed, sign) in [
        ("rate = '0.125 rad/m'", 1.0),
        ("rate = '-0.125 rad/ns'", -1.0),
        ("period = '50.26548245743669 m'", 1.0),
    ] {
        let circle = format!("circle = {{ centre = [3, 9, 0], axis = [0, 2, 0], {speed} }}");
        let camera = moving(&circle);
        let Motion::Circular { centre, axis, rate } = camera.motion else {
            panic!("{:?}", camera.motion);
        };
        assert_eq!((centre, axis), (DVec3::new(3.0, 9.0, 0.0), DVec3::Y));
        assert!((rate - 0.125 * sign).abs() < 1e-15, "{speed}: {rate}");
        // Right-handed about +y, from +z one goes towards +x.
        let beta = DVec3::X * (0.5 * sign);
        assert!((camera.velocity.beta() - beta).length() < 1e-15, "{speed}");
    }
}

#[test]
fn a_circle_at_the_rate_zero_is_rest() {
    let camera = moving("circle = { centre = [3, 9, 0], axis = [0, 2, 0], rate = '0 rad/m' }");
    assert_eq!(camera.velocity, Velocity::REST);
}

#[test]
fn a_world_line_has_the_cameras_place_and_velocity_when_its_clock_shows_zero() {
    let velocity = "eye = [3, 0, 4]\nlook_at = [0, 0, 0]\nvelocity = { beta = [0.6, 0, 0] }";
    for keys in [
        velocity.to_string(),
        format!("{velocity}\nmotion.acceleration = {{ proper = '1 /m', direction = [0, 1, 0] }}"),
        format!("{velocity}\nmotion.segments = [{{ acceleration = {{ proper = '1 /m', direction = [0, 1, 0] }} }}]"),
        format!("{velocity}\nmotion.profile = [{{ time = '-1 m' }}, {{ time = '1 m', acceleration = {{ proper = '1 /m', direction = [0, 1, 0] }} }}]"),
        "look_at = [0, 0, 0]\nmotion.keyframes = [{ time = '1 m', position = [3, 0, 4] }, { time = '4 m', position = [3, 2, 4] }]".into(),
        "eye = [3, 0, 4]\nlook_at = [0, 0, 0]\nmotion.circle = { centre = [0, 0, 0], axis = [0, 1, 0], rate = '0.1 rad/m' }".into(),
    ] {
        let camera = camera(&keys);
        let state = camera.world_line().unwrap().state(0.0).unwrap();
        assert_eq!(state.velocity, camera.velocity, "{keys}");
        assert!(!camera.velocity.is_rest(), "{keys}");
        assert_eq!(state.event, camera.origin, "{keys}");
        assert_eq!(camera.origin.x, DVec3::new(3.0, 0.0, 4.0));
    }
}

#[test]
fn a_motion_can_be_set_key_by_key() {
    let text =
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n[[object]]\nshape.sphere.radius = 1\n";
    let set = |key: &str, value: &str| (key.to_string(), value.to_string());
    let overrides = Overrides {
        set: vec![
            set("camera.motion.acceleration.proper", "0.5 /m"),
            set("camera.motion.acceleration.direction", "[0, 0, -1]"),
            set("camera.shutter.duration", "2 m"),
        ],
        ..Overrides::default()
    };
    let camera = parse(text, "test", Path::new(""), &overrides)
        .unwrap()
        .camera;
    assert_eq!(camera.motion, Motion::Accelerated(DVec3::Z * -0.5));
    assert_eq!(camera.shutter.map(|s| s.duration), Some(2.0));
}
