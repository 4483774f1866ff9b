//! What `nullray info` says of files of every kind.

use std::fs;

use serde_json::Value;

use super::refused::TRIANGLE;
use super::{Folder, repository};

fn said(folder: &Folder, file: &str, parts: &[&str]) -> Value {
    let text = folder.ok(&["info", file]);
    for part in parts {
        assert!(text.contains(part), "{part:?} in {text}");
    }
    let control = |c: char| c.is_control() && c != '\n';
    assert!(!text.contains(control), "{text:?}");
    serde_json::from_str(&folder.ok(&["info", file, "--json"])).unwrap()
}

#[test]
fn of_a_mesh() {
    let folder = Folder::empty();
    let file = repository("scenes/corner/corner.glb");
    let data = said(
        &folder,
        &file,
        &["glTF 2.0", "triangles   18\n", "uv sets     1\n"],
    );
    assert_eq!(data["triangles"], 18);
    // The same without an extension: by content.
    fs::copy(file, folder.path("mesh")).unwrap();
    assert_eq!(said(&folder, "mesh", &["glTF 2.0"])["triangles"], 18);
}

#[test]
fn of_a_mesh_whose_files_are_missing() {
    let folder = Folder::empty();
    folder.write("mesh.gltf", TRIANGLE.replace("roof", "roof\\u001b[31m"));
    let parts = [
        "triangles   1\n",
        "materials   1: paint",
        "mesh.bin (missing)",
        "(1.0000, 1.0000, 0.0000)",
    ];
    let data = said(&folder, "mesh.gltf", &parts);
    assert_eq!(data["nodes"][0], "roof\u{1b}[31m");
}

#[test]
fn of_arrays_that_can_be_used() {
    let folder = Folder::empty();
    let file = repository("scenes/corner/capture_rgb.npz");
    let data = said(
        &folder,
        &file,
        &[
            "H = 64 rows, W = 64 columns, T = 95 time bins, C = 3",
            "usable      yes",
        ],
    );
    assert_eq!(data["arrays"][0]["cube"]["t"], 95);
    let file = repository("tests/data/valid/cube-f2.npy");
    let data = said(
        &folder,
        &file,
        &["(2, 3, 4)", "<f2 (half precision), C order, 48 B"],
    );
    assert_eq!(data["arrays"][0]["cube"]["c"], 1);
}

#[test]
fn of_arrays_that_cannot_be_used_and_why() {
    let folder = Folder::empty();
    let cases = [
        ("fortran-order.npy", "Fortran"),
        ("two-axes.npy", "is not a cube"),
        ("two-channels.npy", "2 channels"),
        ("integers.npy", "not floating-point"),
        ("truncated.npy", "truncated"),
        ("trailing-bytes.npy", "after the last sample"),
    ];
    for (name, why) in cases {
        let file = repository(&format!("tests/data/invalid/{name}"));
        let data = said(&folder, &file, &["usable      no: ", why, "remedy"]);
        assert!(data["arrays"][0]["cube"].is_null(), "{name}");
        assert!(
            data["arrays"][0]["problem"].as_str().unwrap().contains(why),
            "{name}"
        );
    }
}

#[test]
fn of_pictures_that_the_program_wrote() {
    let folder = Folder::new();
    folder.ok(&[
        "render",
        "scene.toml",
        "--aovs",
        "object",
        "-o",
        "a.exr",
        "-o",
        "a.png",
        "-o",
        "a.npz",
    ]);
    let data = said(
        &folder,
        "a.exr",
        &[
            "32 × 24 pixels",
            "radiance.R",
            "-1 to 1",
            "scene_sha256",
            "nullray ",
        ],
    );
    assert_eq!(data["channels"].as_array().unwrap().len(), 4);
    assert!(
        data["metadata"]["scene_text"]
            .as_str()
            .unwrap()
            .contains("[camera]")
    );
    let data = said(
        &folder,
        "a.png",
        &["32 × 24 pixels", "RGB, 8 bits", "scene_text"],
    );
    assert!(
        data["metadata"]["scene_text"]
            .as_str()
            .unwrap()
            .contains("[camera]")
    );
    said(
        &folder,
        "a.npz",
        &["array       radiance", "(24, 32, 3)", "<f8"],
    );
}

#[test]
fn of_a_scene() {
    let folder = Folder::new();
    let parts = [
        "β = (0, 0, -0.3), γ = 1.048285",
        "crate (box): β = (0.6, 0, 0), γ = 1.25",
        "lamp: pulse",
    ];
    let data = said(&folder, "scene.toml", &parts);
    assert_eq!(data["objects"][1]["velocity"]["gamma"], 1.25);
}

#[test]
fn files_of_other_kinds_and_broken_ones_are_refused() {
    let folder = Folder::empty();
    folder.write("empty", "");
    folder.write("noise", [0, 1, 2, 0xff, 0xfe]);
    folder.write("cut.png", b"\x89PNG\r\n\x1a\n\0\0");
    folder.write("cut.exr", [0x76, 0x2f, 0x31, 0x01, 2, 0]);
    folder.write("cut.npy", b"\x93NUMPY\x01");
    folder.write("cut.glb", b"glTF\x02\0\0\0");
    for name in [
        "empty", "noise", "cut.png", "cut.exr", "cut.npy", "cut.glb", "missing", ".",
    ] {
        let run = folder.run(&["info", name]);
        assert_eq!(run.code, 2, "{name}");
        assert_eq!(run.stdout, "", "{name}");
        assert!(run.message().contains(name), "{name}: {}", run.message());
        assert!(!run.stderr.contains("panicked"), "{name}: {}", run.stderr);
    }
}

#[test]
fn every_invalid_file_of_the_tests_gets_an_answer() {
    let folder = Folder::empty();
    for entry in fs::read_dir(repository("tests/data/invalid")).unwrap() {
        let path = entry.unwrap().path();
        let run = folder.run(&["info", path.to_str().unwrap()]);
        assert!(
            [0, 2].contains(&run.code),
            "{}: {}",
            path.display(),
            run.stderr
        );
        assert!(!run.stderr.contains("bug of nullray"), "{}", run.stderr);
    }
}
