//! Cameras: where they are, what they see, and poses from other programs.

use std::f64::consts::PI;

use glam::DVec3;
use nullray::camera::{Camera, Shot};
use nullray::scene::model::{CameraModel, Mapping, Scene, SourceKind};
use nullray::scene::{Overrides, parse};
use nullray::spacetime::Event;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn scene(text: &str) -> Scene {
    parse(text, "test", ROOT.as_ref(), &Overrides::default()).unwrap()
}

const MOVING: &str = "\
speed_of_light = \"2 m/s\"
[camera]
eye = [1, 0, 0]
look_at = [1, 0, -1]
velocity = { beta = [0.6, 0, 0] }
clock_zero = \"3 m\"
time = \"4 m\"
[[object]]
shape = { sphere = { radius = 1 } }
";

#[test]
fn an_up_of_zero_is_not_called_parallel() {
    let refused = |up: &str| {
        let text = format!(
            "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nup = {up}\n[[object]]\nshape = {{ sphere = {{ radius = 1 }} }}\n"
        );
        let refused = parse(&text, "test", ROOT.as_ref(), &Overrides::default());
        refused.unwrap_err().to_string()
    };
    assert!(refused("[0, 0, 0]").contains("`up` is a zero vector"));
    assert!(refused("[0, 0, 2]").contains("the forward axis is parallel to `up`"));
}

#[test]
fn the_shot_is_on_the_cameras_world_line() {
    let scene = scene(MOVING);
    // γ = 5/4: after 4 m of proper time 5 m of world time and 0.6 · 5 m of path have passed.
    let shot = Shot::new(&scene.camera).unwrap().event;
    assert!((shot.ct - 8.0).abs() < 1e-14);
    assert!((shot.x - DVec3::X * 4.0).length() < 1e-14);
}

#[test]
fn matrices_take_world_points_to_the_camera_and_to_its_picture() {
    let text = "[camera]\neye = [1, 2, 3]\nlook_at = [1, 2, -1]\nhfov = \"90 deg\"\nsize = [200, 100]\n\
                [[object]]\nshape = { sphere = { radius = 1 } }\n";
    let scene = scene(text);
    let [camera, ndc] = Camera::new(&scene).unwrap().matrices().map(Option::unwrap);
    let times = |m: [f32; 16], p: [f32; 3]| -> [f32; 4] {
        let p = [p[0], p[1], p[2], 1.0];
        std::array::from_fn(|column| (0..4).map(|row| p[row] * m[4 * row + column]).sum())
    };
    // 4 m ahead, 2 m to the right and 1 m up: half of the way from the middle to the right, 2/(4 tan 45°), and to the top,
    // 1/(4 · tan of half the height, 1/2).
    let p = [3.0, 3.0, -1.0];
    assert_eq!(times(camera, p), [2.0, 1.0, 4.0, 1.0]);
    let [x, y, z, w] = times(ndc, p);
    assert!(
        (x / w - 0.75).abs() < 1e-6 && (y / w - 0.25).abs() < 1e-6,
        "{x} {y} {w}"
    );
    assert!((w - 4.0).abs() < 1e-6 && (z - 3.99).abs() < 1e-6);
    // The eyes of a stereo pair are beside the same point; its two pictures are not one.
    let pair = text.replace(
        "[[object]]",
        "stereo = { interpupillary_distance = \"64 mm\" }\n[[object]]",
    );
    let camera_of = |text: &str| Camera::new(&self::scene(text)).unwrap();
    assert_eq!(camera_of(&pair).matrices(), [Some(camera), None]);
    // At the distance 1 the window is 2 tan 45° wide; other projections have none.
    assert!((camera_of(text).window_width().unwrap() - 2.0).abs() < 1e-6);
    let globe = text.replace("hfov", "projection = \"fisheye_equisolid\"\nhfov");
    for other in [&pair, &globe] {
        assert_eq!(camera_of(other).window_width(), None);
    }
}

/// A camera at (1, 2, 5) that looks along −x with +z up has right = f × up = (−1, 0, 0) × (0, 0, 1) = (0, 1, 0). Its
/// matrices, by the definition of each convention, and COLMAP's, the inverse of OpenCV's.
#[test]
fn the_conventions_of_other_programs_give_the_same_pose() {
    let posed = |pose: &str| {
        let text = format!(
            "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nhfov = \"40 deg\"\n[[object]]\nname = \"a\"\nshape = {{ sphere = {{ radius = 1 }} }}\n\
             [[source]]\nobjects = [\"a\"]\n[source.cube]\nfile = \"tests/data/mitransient/near_clip.npz\"\nbin_width = \"1 m\"\n\
             capture = {{ pose = {{ {pose} }}, hfov = \"40 deg\" }}\n"
        );
        parse(&text, "a.toml", ROOT.as_ref(), &Overrides::default())
    };
    let expected = [DVec3::Y, DVec3::Z, DVec3::NEG_X];
    for pose in [
        // Columns: right, up, backward.
        "matrix = [[0, 0, 1, 1], [1, 0, 0, 2], [0, 1, 0, 5], [0, 0, 0, 1]], convention = \"opengl\"",
        // Right, down, forward.
        "matrix = [[0, 0, -1, 1], [1, 0, 0, 2], [0, -1, 0, 5], [0, 0, 0, 1]], convention = \"opencv\"",
        // Left, up, forward.
        "matrix = [[0, 0, -1, 1], [-1, 0, 0, 2], [0, 1, 0, 5], [0, 0, 0, 1]], convention = \"mitsuba\"",
        // Rᵀ of OpenCV's, and −Rᵀ (1, 2, 5) = (−2, 5, 1).
        "matrix = [[0, 1, 0, -2], [0, 0, -1, 5], [-1, 0, 0, 1], [0, 0, 0, 1]], convention = \"colmap\"",
        // That rotation is by 120° about (1, 1, −1)/√3: (0.5, 0.5, 0.5, −0.5).
        "quaternion = [0.5, 0.5, 0.5, -0.5], translation = [-2, 5, 1], convention = \"colmap\"",
    ] {
        let scene = posed(pose).unwrap_or_else(|e| panic!("{pose}: {}", e.report(false)));
        let SourceKind::Cube(cube) = &scene.sources[0].kind else {
            panic!("no cube");
        };
        let Mapping::Capture(camera) = &cube.mapping else {
            panic!("no capture");
        };
        assert!(
            camera.eye.distance(DVec3::new(1.0, 2.0, 5.0)) < 1e-12,
            "{pose}"
        );
        for (axis, expected) in camera.axes.iter().zip(expected) {
            assert!(axis.distance(expected) < 1e-12, "{pose}: {:?}", camera.axes);
        }
    }
    for (pose, wrong) in [
        (
            "matrix = [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], convention = \"opengl\"",
            "not a pose",
        ),
        (
            "matrix = [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], convention = \"opengl\"",
            "not a pose",
        ),
        (
            "matrix = [[nan, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], convention = \"opengl\"",
            "not a pose",
        ),
        (
            "quaternion = [1, 1, 0, 0], translation = [0, 0, 0], convention = \"colmap\"",
            "not a rotation",
        ),
        (
            "quaternion = [1, 0, 0, 0], convention = \"colmap\"",
            "`translation`",
        ),
    ] {
        let error = posed(pose).unwrap_err().report(false);
        assert!(error.contains(wrong), "{error}");
    }
}

/// A scene's camera at the node of a glTF file that is at (1, 2, 3), looks along −z, and sees 90 degrees vertically in any aspect ratio.
fn from_gltf(keys: &str) -> CameraModel {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"{
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": "cam", "camera": 0, "translation": [1, 2, 3] }],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 1.5707963, "znear": 0.1 } }]
    }"#;
    std::fs::write(folder.path().join("a.gltf"), text).unwrap();
    let text = format!(
        "[camera]\ngltf = 'a.gltf'\nnode = 'cam'\n{keys}\n[[object]]\nshape = {{ sphere = {{ radius = 1 }} }}\n"
    );
    let scene = parse(&text, "test", folder.path(), &Overrides::default());
    scene
        .unwrap_or_else(|e| panic!("{}", e.report(false)))
        .camera
}

#[test]
fn a_gltf_camera_gives_pose_and_field_of_view() {
    let camera = from_gltf("size = [200, 100]");
    assert_eq!(camera.origin.x, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(camera.axes, [DVec3::X, DVec3::Y, DVec3::NEG_Z]);
    // tan 45° = 1 vertically, 2 horizontally; glTF has numbers of seven digits.
    assert!((libm::tan(camera.horizontal_fov / 2.0) - 2.0).abs() < 1e-6);
}

#[test]
fn a_fisheye_at_a_gltf_camera_has_its_own_field_of_view() {
    let camera = from_gltf("projection = 'fisheye_equisolid'");
    assert_eq!(camera.horizontal_fov, PI);
    assert_eq!(camera.axes[2], DVec3::NEG_Z);
}

#[test]
fn a_field_of_view_in_the_scene_goes_before_that_of_the_gltf_camera() {
    let camera = from_gltf("hfov = \"1 rad\"");
    assert_eq!(camera.horizontal_fov, 1.0);
}

#[test]
fn keyframes_take_the_place_of_where_a_gltf_camera_is() {
    let camera = from_gltf(
        "motion.keyframes = [{ time = '1 m', position = [0, 0, 7] }, \
         { time = '3 m', position = [1, 0, 7] }]",
    );
    assert_eq!(camera.origin, Event::new(1.0, DVec3::Z * 7.0));
    assert_eq!(camera.axes[2], DVec3::NEG_Z);
}

#[test]
fn roughness_that_a_shape_of_glass_does_not_show_is_told() {
    let told = |keys: &str| {
        let text = format!(
            "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n[[object]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = 1 }} }}\n{keys}\n"
        );
        scene(&text).passed_over
    };
    let rough = ["object \"ball\": rough glass is taken as smooth"];
    assert_eq!(told("transmission = 1\nroughness = 0.5"), rough);
    assert_eq!(told("transmission = 0.5\nroughness = 1"), rough);
    for smooth in [
        "transmission = 1",
        "transmission = 1\nroughness = 0",
        "roughness = 0.5",
    ] {
        assert!(told(smooth).is_empty(), "{smooth}");
    }
}

/// p M for a point p.
fn times(m: [f32; 16], p: [f64; 3]) -> [f64; 4] {
    let p = [p[0], p[1], p[2], 1.0];
    std::array::from_fn(|k| (0..4).map(|row| p[row] * f64::from(m[4 * row + k])).sum())
}

const BALL: &str = "[[object]]\nshape = { sphere = { radius = 1 } }\n";

#[test]
fn the_matrices_of_a_camera_that_moves_or_turns_are_those_at_its_shot() {
    let close = |m: [f32; 16], p: [f64; 3], expected: [f64; 3]| {
        let got = times(m, p);
        let apart = (0..3).map(|k| (got[k] - expected[k]).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-6, "{got:?} {expected:?}");
    };
    let matrix = |camera: &str| {
        let text = format!("[camera]\nhfov = \"90 deg\"\nforward = [0, 0, -1]\n{camera}{BALL}");
        Camera::new(&scene(&text)).unwrap().matrices()[0].unwrap()
    };
    // From rest at a = 1 /m along x, it has gone cosh 2 − 1 after 2 m of its time.
    let rocket = "eye = [1, 2, 3]\ntime = \"2 m\"\n[camera.motion]\nacceleration = { proper = \"1 /m\", direction = [1, 0, 0] }\n";
    close(matrix(rocket), [0.0, 0.0, 0.0], [-2_f64.cosh(), -2.0, 3.0]);
    // From (0, 0, 5) through (3, 0, 5) at 0.6 c: after 4 m of its time, 5 m of the world's.
    let path = "time = \"4 m\"\n[camera.motion]\nkeyframes = [{ time = \"1 m\", position = [0, 0, 5] }, { time = \"11 m\", position = [6, 0, 5] }]\n";
    close(matrix(path), [0.0, 0.0, 0.0], [-3.0, 0.0, 5.0]);
    // A quarter turn about y takes −z to −x, and x to −z.
    let turning = "eye = [0, 0, 0]\ntime = \"2 m\"\n[camera.rotation]\naxis = [0, 1, 0]\nrate = \"45 deg/m\"\n";
    close(matrix(turning), [-7.0, 2.0, -3.0], [3.0, 2.0, 7.0]);
}

#[test]
fn the_field_of_view_is_that_of_the_sensor_in_the_cameras_own_frame() {
    // tan(hfov/2) = 1 at the focal length of the scene; γ = 5/4.
    let camera = |assembly: &str, beta: &str| {
        let text = format!(
            "[camera]\neye = [0, 0, 0]\nforward = [0, 0, -1]\nsize = [200, 100]\nvelocity = {{ beta = {beta} }}\n[camera.sensor]\n\
             focal_length = \"1 m\"\nwidth = \"2 m\"\nassembly = \"{assembly}\"\n{BALL}"
        );
        let scene = scene(&text);
        let camera = Camera::new(&scene).unwrap();
        let fov = camera.horizontal_fov(&scene.camera);
        (camera, (0.5 * fov).tan())
    };
    let [ahead, right] = ["[0, 0, -0.6]", "[0.6, 0, 0]"];
    let (longer, half) = camera("world_length", ahead);
    assert!((half - 0.8).abs() < 1e-12, "{half}");
    let [x, y] = longer.tan_half_fov().unwrap();
    assert!(
        (x - 0.8).abs() < 1e-12 && (y - 0.4).abs() < 1e-12,
        "{x} {y}"
    );
    assert!((longer.window_width().unwrap() - 1.6).abs() < 1e-6);
    // 4 m ahead and 2 m to the right: 2/(4 · 0.8) of the way to the edge.
    let [x, .., w] = times(longer.matrices()[1].unwrap(), [2.0, 0.0, -4.0]);
    assert!((x / w - (0.5 + 0.5 * 2.0 / 3.2)).abs() < 1e-6, "{x} {w}");
    // Across the motion it keeps its length.
    assert!((camera("world_length", right).1 - 1.0).abs() < 1e-12);
    assert!((camera("rigid", ahead).1 - 1.0).abs() < 1e-12);
    // All of Bell's sensor is longer along the motion: its distance, or its width.
    for (beta, expected) in [(ahead, 0.8), (right, 1.25)] {
        let (bell, half) = camera("bell", beta);
        assert!((half - expected).abs() < 1e-12, "{beta}: {half}");
        assert_eq!(bell.tan_half_fov(), None);
        assert!(bell.matrices()[1].is_none() && bell.window_width().is_none());
    }
    assert!(camera("bell", "[0, 0, 0]").0.tan_half_fov().is_some());
}

#[test]
fn the_cameras_of_the_guide_are_accepted() {
    let guide = std::fs::read_to_string(format!("{ROOT}/src/camera/guide.md")).unwrap();
    let parts: Vec<_> = guide.split("```toml\n").skip(1).collect();
    assert!(!parts.is_empty());
    for part in parts {
        let (camera, _) = part.split_once("```").unwrap();
        scene(&format!("{camera}{BALL}"));
    }
}
