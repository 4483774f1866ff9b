//! COLMAP poses, from both forms of its files.

use std::path::Path;

use glam::DVec3;
use nullray::io::colmap::pose;
use nullray::io::cube::{Cube, CubeSamples};
use nullray::io::image::npz;
use nullray::render::plan::{Plan, Request};
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
        let fov = found.picture.fov(found.picture.size);
        assert!((fov[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((fov[1] - 2.0 * 0.75f64.atan()).abs() < 1e-12);

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
        ("cameras.txt", "2 PINHOLE 640 480 -320 -320 320 240\n"),
        ("cameras.txt", "2 PINHOLE 640 480 320 320 1e9 240\n"),
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
    // COLMAP's unit is arbitrary.
    let scaled = camera("pose = { colmap = \"sparse\", image = \"the second.png\", scale = 0.25 }");
    assert!(scaled.eye.distance(DVec3::new(0.25, 0.5, 1.25)) < 1e-12);
    assert_eq!(scaled.fov, found.fov);
    for (capture, wrong) in [
        (
            "pose = { colmap = \"sparse\", image = \"the second.png\", scale = 0 }",
            "a unit of 0 m",
        ),
        (
            "pose = { quaternion = [1, 0, 0, 0], translation = [0, 0, 0], convention = \"colmap\", scale = 2 }, hfov = \"40 deg\"",
            "but there is none",
        ),
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

/// A scene in `folder` whose cube of this many rows and columns is a capture of the camera `numbers` (columns, rows, f, f, and the
/// principal point), with more keys of `capture`.
fn capture_of(
    folder: &Path,
    numbers: &str,
    [rows, columns]: [usize; 2],
    keys: &str,
) -> nullray::Result<nullray::scene::model::CaptureCamera> {
    texts(folder);
    let camera = format!("2 PINHOLE {numbers}\n");
    std::fs::write(folder.join("cameras.txt"), camera).unwrap();
    let samples = CubeSamples::F32(vec![1.0; rows * columns * 8]);
    let cube = Cube::new([rows, columns, 8, 1], samples).unwrap();
    npz::write_cube(&folder.join("a.npy"), &cube).unwrap();
    let text = format!(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n[[object]]\nname = \"a\"\nshape = {{ sphere = {{ radius = 1 }} }}\n\
         [[source]]\ncube = {{ file = \"a.npy\", bin_width = \"1 m\", capture = {{ pose = {{ colmap = \".\", image = \"the second.png\" }}{keys} }} }}\n"
    );
    let scene = nullray::scene::parse(&text, "a.toml", folder, &Default::default())?;
    Plan::new(&scene, &Request::default())?;
    match &scene.sources[0].kind {
        SourceKind::Cube(cube) => match &cube.mapping {
            Mapping::Capture(camera) => Ok(camera.clone()),
            other => panic!("{other:?}"),
        },
        SourceKind::Pulse(_) => panic!("no cube"),
    }
}

#[test]
fn a_cube_of_another_shape_than_the_pictures_of_its_camera_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let capture = |size, keys| capture_of(folder.path(), "16 10 20 20 8 5", size, keys);
    // The whole picture, at half and at three times its resolution, and a part of it.
    for size in [[10, 16], [5, 8], [30, 48]] {
        assert!(capture(size, "").is_ok(), "{size:?}");
    }
    let part = ", crop = { film = [16, 10], offset = [3, 2] }";
    assert!(capture([4, 4], part).is_ok());
    assert!(capture([20, 12], ", hfov = \"40 deg\"").is_ok());
    for size in [[20, 12], [16, 10], [10, 10]] {
        let error = capture(size, "").unwrap_err();
        let [rows, columns] = size;
        let what = format!("{columns} × {rows} pixels of a camera whose pictures have 16 × 10");
        assert!(error.to_string().contains(&what), "{error}");
        assert!(error.help().to_string().contains("film = [16, 10]"));
    }
}

#[test]
fn an_off_centre_principal_point_needs_the_crop_that_its_error_names() {
    let folder = tempfile::tempdir().unwrap();
    // On a film of 36 × 24 pixels with the picture at (4, 0), its middle is at 18 − 4 = 14 and 12 of the picture.
    let numbers = "32 20 20 20 14 12";
    let capture = |keys: &str| capture_of(folder.path(), numbers, [20, 32], keys);
    let error = capture("").unwrap_err();
    let help = error.help().to_string();
    let crop = "crop = { film = [36, 24], offset = [4, 0] }";
    assert!(help.contains(crop), "{help}");
    let camera = capture(&format!(", {crop}")).unwrap();
    // 20 pixels to the film as 18 to its edge.
    assert!((camera.fov - 2.0 * (18.0f64 / 20.0).atan()).abs() < 1e-12);
    // Other places are refused, unless the scene gives the field of view of the film, too.
    let other = ", crop = { film = [36, 24], offset = [0, 0] }";
    let error = capture(other).unwrap_err();
    assert!(
        error.to_string().contains("[18.0, 12.0] of its picture"),
        "{error}"
    );
    assert!(error.help().to_string().contains(crop));
    assert!(capture(&format!("{other}, hfov = \"84 deg\"")).is_ok());
    let error = capture_of(folder.path(), numbers, [10, 16], &format!(", {crop}")).unwrap_err();
    assert!(
        error.to_string().contains("16 × 10 pixels of a camera"),
        "{error}"
    );
}
