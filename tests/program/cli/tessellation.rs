//! `nullray tessellation`.

use super::refused::refused;
use super::{Folder, repository};

#[test]
fn it_says_for_each_object_how_long_edges_may_be_and_where_that_matters() {
    let folder = Folder::new();
    let said = folder.ok(&["tessellation", "scene.toml", "--pixels", "0.1", "-q"]);
    let lines: Vec<_> = said.lines().collect();
    assert!(lines[0].contains("at most 0.1 pixels"), "{said}");
    assert!(
        lines[2].contains("floor") && lines[2].contains("triangle"),
        "{said}"
    );
    assert!(
        lines[3].contains("crate") && lines[3].contains("pixel ("),
        "{said}"
    );
    assert!(lines[4].contains("--method raster:uniform="), "{said}");
    let length = lines[4].rsplit('=').next().unwrap();
    assert!(length.parse::<f64>().unwrap() > 0.0, "{said}");
}

#[test]
fn its_json_holds_the_same() {
    let folder = Folder::new();
    let said = folder.ok(&["tessellation", "scene.toml", "--json", "-q"]);
    let data: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(data["pixels"], 0.5);
    let objects = data["objects"].as_array().unwrap();
    assert_eq!(objects.len(), 2);
    for (object, name) in objects.iter().zip(["floor", "crate"]) {
        assert_eq!(object["name"], name);
        assert!(object["edge_length"].as_f64().unwrap() > 0.0);
        assert!(object["worst"]["pixel"].as_array().unwrap().len() == 2);
    }
}

#[test]
fn a_picture_without_objects_is_said_to_be_one() {
    let folder = Folder::new();
    let away = [
        "tessellation",
        "scene.toml",
        "-q",
        "--set",
        "camera.look_at=[0, 9, 9]",
    ];
    assert!(folder.ok(&away).contains("the picture shows no object"));
}

#[test]
fn it_does_not_depend_on_threads() {
    let folder = Folder::empty();
    let scene = repository("scenes/several-velocities.toml");
    let on = |threads: &str| {
        folder.ok(&[
            "tessellation",
            &scene,
            "--size",
            "80x50",
            "--json",
            "-q",
            "--threads",
            threads,
        ])
    };
    assert_eq!(on("1"), on("3"));
}

#[test]
fn wrong_pixels_and_cameras_are_refused() {
    let folder = Folder::new();
    let cases: &[(&[&str], &[&str])] = &[
        (&["--pixels", "0"], &["--pixels", "1e-6"]),
        (&["--pixels", "-1"], &["--pixels", "1e-6"]),
        (&["--pixels", "nan"], &["--pixels", "like 0.5"]),
        (&["--panel", "left"], &["left"]),
        (
            &["--set", "camera.shutter={duration=\"1 m\"}"],
            &["rays all leave one event"],
        ),
    ];
    for (arguments, parts) in cases {
        refused(
            &folder,
            &[&["tessellation", "scene.toml"], *arguments].concat(),
            parts,
        );
    }
}
