//! COLMAP poses, from both forms of its files.

use std::path::Path;

use glam::DVec3;
use nullray::io::colmap::pose;
use nullray::scene::model::{Mapping, SourceKind};

/// The camera of `pose`'s tests: at (1, 2, 5), looking along −x, +z up, by the rotation (0.5, 0.5, 0.5, −0.5) and the
/// translation (−2, 5, 1), the second of two images; 640 × 480 pixels, f = 320 pixels: 90° across.
fn texts(folder: &Path) {
    let images = "# Image list\n1 1 0 0 0 0 0 0 1 first one.png\n1 2 3\n7 0.5 0.5 0.5 -0.5 -2 5 1 2 the second.png\n\n";
    std::fs::write(folder.join("images.txt"), images).unwrap();
    let cameras = "# Camera list\n1 SIMPLE_RADIAL 640 480 300 320 240 0.1\n2 PINHOLE 640 480 320 320 320 240\n";
    std::fs::write(folder.join("cameras.txt"), cameras).unwrap();
}

fn binaries(folder: &Path) {
    let mut images = 2u64.to_le_bytes().to_vec();
    for (id, pose, camera, name, points) in [
        (
            1u32,
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            1u32,
            "first one.png",
            2u64,
        ),
        (
            7,
            [0.5, 0.5, 0.5, -0.5, -2.0, 5.0, 1.0],
            2,
            "the second.png",
            0,
        ),
    ] {
        images.extend(id.to_le_bytes());
        images.extend(pose.iter().flat_map(|x: &f64| x.to_le_bytes()));
        images.extend(camera.to_le_bytes());
        images.extend(name.bytes().chain([0]));
        images.extend(points.to_le_bytes());
        images.resize(images.len() + 24 * points as usize, 9);
    }
    std::fs::write(folder.join("images.bin"), images).unwrap();
    let mut cameras = 2u64.to_le_bytes().to_vec();
    for (id, model, numbers) in [
        (1u32, 2u32, &[300.0, 320.0, 240.0, 0.1][..]),
        (2, 1, &[320.0, 320.0, 320.0, 240.0]),
    ] {
        cameras.extend([id.to_le_bytes(), model.to_le_bytes()].concat());
        cameras.extend([640u64.to_le_bytes(), 480u64.to_le_bytes()].concat());
        cameras.extend(numbers.iter().flat_map(|x: &f64| x.to_le_bytes()));
    }
    std::fs::write(folder.join("cameras.bin"), cameras).unwrap();
}

#[test]
fn poses_are_read_from_texts_and_from_binary_files() {
    for write in [texts, binaries] {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path());
        let found = pose(folder.path(), "the second.png").unwrap();
        assert!(found.eye.distance(DVec3::new(1.0, 2.0, 5.0)) < 1e-12);
        let expected = [DVec3::Y, DVec3::Z, DVec3::NEG_X];
        for (axis, expected) in found.axes.iter().zip(expected) {
            assert!(axis.distance(expected) < 1e-12, "{:?}", found.axes);
        }
        assert!((found.fov[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((found.fov[1] - 2.0 * 0.75f64.atan()).abs() < 1e-12);

        let said = |image| {
            let error = pose(folder.path(), image).unwrap_err();
            format!("{error}; {}", error.help())
        };
        assert!(said("third.png").contains("\"first one.png\""));
        let refused = said("first one.png");
        assert!(refused.contains("SIMPLE_RADIAL distorts") && refused.contains("undistorter"));
    }
    let empty = tempfile::tempdir().unwrap();
    let error = pose(empty.path(), "a").unwrap_err().to_string();
    assert!(error.contains("no images.bin and no images.txt"), "{error}");
}

#[test]
fn broken_files_are_refused_wherever_they_end() {
    let folder = tempfile::tempdir().unwrap();
    binaries(folder.path());
    for name in ["images.bin", "cameras.bin"] {
        let whole = std::fs::read(folder.path().join(name)).unwrap();
        for length in 0..whole.len() - 8 {
            std::fs::write(folder.path().join(name), &whole[..length]).unwrap();
            assert!(
                pose(folder.path(), "the second.png").is_err(),
                "{name} {length}"
            );
        }
        std::fs::write(folder.path().join(name), whole).unwrap();
    }
    for name in ["images.bin", "cameras.bin"] {
        std::fs::remove_file(folder.path().join(name)).unwrap();
    }
    texts(folder.path());
    for (name, text) in [
        ("images.txt", "1 0 0 0 x 0 0 0 1 a\n"),
        ("images.txt", "1 9 0 0 0 0 0 0 2 the second.png\n\n"),
        ("cameras.txt", "2 PINHOLE 640 480 320\n"),
        ("cameras.txt", "2 PINHOLE 640 480 320 100 320 240\n"),
        ("cameras.txt", "2 PINHOLE 640 480 320 320 100 240\n"),
        ("cameras.txt", "2 LENS 640 480 320 320 100 240\n"),
    ] {
        texts(folder.path());
        std::fs::write(folder.path().join(name), text).unwrap();
        assert!(pose(folder.path(), "the second.png").is_err(), "{text}");
    }
}

#[test]
fn captures_take_pose_and_field_of_view_of_an_image() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("sparse")).unwrap();
    texts(&folder.path().join("sparse"));
    let cube = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/mitransient/near_clip.npz");
    std::fs::copy(cube, folder.path().join("a.npz")).unwrap();
    let scene = |capture: &str| {
        let text = format!(
            "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n[[object]]\nname = \"a\"\nshape = {{ sphere = {{ radius = 1 }} }}\n\
             [[source]]\nobjects = [\"a\"]\n[source.cube]\nfile = \"a.npz\"\nbin_width = \"1 m\"\ncapture = {{ {capture} }}\n"
        );
        nullray::scene::parse(&text, "a.toml", folder.path(), &Default::default())
    };
    let camera = |capture: &str| {
        let scene = scene(capture).unwrap_or_else(|e| panic!("{capture}: {e} {}", e.help()));
        let SourceKind::Cube(cube) = scene.sources[0].kind.clone() else {
            panic!("no cube");
        };
        match cube.mapping {
            Mapping::Capture(camera) => camera,
            other => panic!("{other:?}"),
        }
    };
    let found = camera("pose = { colmap = \"sparse\", image = \"the second.png\" }");
    assert!(found.eye.distance(DVec3::new(1.0, 2.0, 5.0)) < 1e-12);
    assert!(found.axes[2].distance(DVec3::NEG_X) < 1e-12);
    assert!((found.fov - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    let own =
        camera("pose = { colmap = \"sparse\", image = \"the second.png\" }, hfov = \"40 deg\"");
    assert!((own.fov - 40f64.to_radians()).abs() < 1e-12);
    for (capture, wrong) in [
        (
            "pose = { colmap = \"sparse\" }",
            "name of the image is missing",
        ),
        ("pose = { colmap = \"sparse\", image = \"x\" }", "no image"),
        (
            "pose = { colmap = \"dense\", image = \"x\" }",
            "no images.bin",
        ),
        (
            "pose = { colmap = \"sparse\", image = \"x\", convention = \"colmap\" }",
            "given twice",
        ),
        (
            "pose = { quaternion = [1, 0, 0, 0], translation = [0, 0, 0] }, hfov = \"40 deg\"",
            "the convention of the pose is missing",
        ),
    ] {
        let error = scene(capture).unwrap_err().to_string();
        assert!(error.contains(wrong), "{capture}: {error}");
    }
}
