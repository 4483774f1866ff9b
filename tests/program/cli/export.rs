//! `nullray export`.

use super::refused::refused;
use super::{Folder, repository};

#[test]
fn a_scene_is_exported_and_what_was_written_is_said() {
    let folder = Folder::new();
    let run = folder.run(&["export", "scene.toml", "-o", "bundle"]);
    assert_eq!(run.code, 0, "{}", run.message());
    assert_eq!(folder.names(), ["bundle", "scene.toml"]);
    assert!(
        run.stdout
            .contains("wrote bundle: 2 objects (14 triangles), 1 source,")
    );
    assert!(folder.path("bundle/bundle.json").exists());
}

#[test]
fn a_fisheye_with_dark_corners_is_exported_as_the_point_that_it_is() {
    let folder = Folder::new();
    let fisheye = "camera.projection=fisheye_equisolid";
    let arguments = ["export", "scene.toml", "--no-reference", "-o", "b"];
    let set = ["--set", fisheye, "--set", "camera.hfov=360 deg"];
    folder.ok(&[&arguments[..], &set].concat());
    let bundle: serde_json::Value = serde_json::from_slice(&folder.read("b/bundle.json")).unwrap();
    assert_eq!(bundle["camera"]["is_point"], true);
    assert_eq!(bundle["camera"]["kind"], "moving");
}

#[test]
fn what_a_scene_has_no_use_for_in_its_models_is_not_remarked() {
    let folder = Folder::empty();
    let capture = repository("scenes/capture.toml");
    let run = folder.run(&["export", &capture, "--size", "8x6", "-o", "b"]);
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
}

#[test]
fn the_built_in_scene_can_be_exported_without_reference_pictures() {
    let folder = Folder::empty();
    let run = folder.run(&[
        "export",
        "--no-reference",
        "--cubes",
        "reference",
        "-o",
        "b",
    ]);
    assert_eq!(run.code, 0, "{}", run.message());
    assert!(folder.path("b/sources/000.npz").exists());
    assert!(!folder.path("b/reference").exists());
}

#[test]
fn a_second_export_of_the_name_is_refused_unless_it_is_to_replace_the_first() {
    let folder = Folder::new();
    let arguments = ["export", "scene.toml", "-q", "-o", "bundle"];
    assert_eq!(folder.run(&arguments).code, 0);
    let again = folder.run(&arguments);
    assert_eq!(again.code, 2);
    assert!(
        again.message().contains("--overwrite"),
        "{}",
        again.message()
    );
    let mut overwrite = arguments.to_vec();
    overwrite.push("--overwrite");
    assert_eq!(folder.run(&overwrite).code, 0);
}

#[test]
fn a_directory_that_the_scene_is_in_is_not_replaced() {
    let folder = Folder::new();
    folder.run(&["export", "scene.toml", "-q", "-o", "bundle"]);
    let arguments = ["export", "bundle/scene.toml", "--overwrite", "-o", "bundle"];
    refused(&folder, &arguments, &["bundle/scene.toml", "another name"]);
}
