//! Resuming a sequence: which frames are kept, and which are rendered again.

use std::fs;

use super::frames::{FOUR, folder, pictures, sequence};
use super::refused::TRIANGLE;
use crate::cli::Folder;

/// The numbers of the frames that a run skips.
fn skipped(said: &str) -> Vec<u32> {
    let lines = said
        .lines()
        .filter_map(|line| line.strip_suffix(" exists already"));
    lines
        .map(|line| line.strip_prefix("frame ").unwrap().parse().unwrap())
        .collect()
}

const ALL_KINDS: [&str; 8] = [
    "-o",
    "f.png",
    "-o",
    "f.exr",
    "-o",
    "f.npz",
    "--isochrones",
    "t.png",
];

#[test]
fn frames_that_are_there_are_not_rendered_again() {
    let folder = folder();
    let arguments = sequence(&[&FOUR[..], &ALL_KINDS].concat());
    let said = folder.ok(&arguments);
    assert!(said.contains("4 rendered, 0 existed already"), "{said}");
    let said = folder.ok(&[&arguments[..], &["--threads", "1"]].concat());
    assert_eq!(skipped(&said), [0, 1, 2, 3]);
    assert!(said.contains("0 rendered, 4 existed already"), "{said}");
    assert!(!said.contains("wrote"), "{said}");
}

#[test]
fn exactly_the_frames_that_are_missing_broken_or_foreign_are_rendered() {
    let folder = folder();
    let arguments =
        sequence(&[&["--frames", "0..9", "--interval", "10 cm"], &ALL_KINDS[..]].concat());
    folder.ok(&arguments);
    let names = pictures(&folder);
    let first: Vec<_> = names.iter().map(|name| folder.read(name)).collect();
    fs::remove_file(folder.path("t-0001.png")).unwrap();
    for (name, k) in [("f-0002.png", 2), ("f-0003.exr", 3), ("f-0004.npz", 4)] {
        let bytes = folder.read(name);
        folder.write(name, &bytes[..bytes.len() - 9 * k]);
    }
    // What another request made, or another program.
    fs::copy(folder.path("f-0000.png"), folder.path("f-0006.png")).unwrap();
    folder.write("t-0007.png", "not a picture");
    fs::copy(folder.path("f-0008.png"), folder.path("t-0008.png")).unwrap();
    let said = folder.ok(&arguments);
    assert_eq!(skipped(&said), [0, 5], "{said}");
    assert_eq!(pictures(&folder), names);
    for (name, bytes) in names.iter().zip(first) {
        assert!(folder.read(name) == bytes, "{name}");
    }
}

#[test]
fn damage_within_a_file_is_noticed() {
    let folder = folder();
    let options = ["-o", "f.png", "-o", "f.exr", "-o", "f.npz"];
    let arguments =
        sequence(&[&["--frames", "0..3", "--interval", "10 cm"], &options[..]].concat());
    folder.ok(&arguments);
    // In the compressed pixels: of a PNG before the checksums and the end, of an archive in its first array.
    for (name, from_end) in [
        ("f-0000.png", Some(30)),
        ("f-0001.exr", Some(20)),
        ("f-0002.npz", None),
    ] {
        let mut bytes = folder.read(name);
        let at = from_end.map_or(300, |n| bytes.len() - n);
        bytes[at] ^= 0x55;
        folder.write(name, bytes);
    }
    assert_eq!(skipped(&folder.ok(&arguments)), [0; 0]);
    assert_eq!(skipped(&folder.ok(&arguments)), [0, 1, 2]);
}

#[test]
fn another_request_makes_other_frames() {
    let folder = folder();
    let base = [&FOUR[..], &["-o", "f.exr", "--isochrones", "t.png"]].concat();
    let changes: [&[&str]; 7] = [
        &["--spp", "9"],
        &["--aovs", "event"],
        &["--pixel-centers"],
        &["--isochrone-step", "30 cm"],
        &["--set", "display.white=0.25"],
        &["--set", "object.crate.velocity.beta=[0.5,0,0]"],
        &["--time", "1 m"],
    ];
    folder.ok(&sequence(&base));
    for change in changes {
        let said = folder.ok(&sequence(&[&base[..], change].concat()));
        assert_eq!(skipped(&said), [0; 0], "{change:?}");
    }
    // The time of a frame is part of it, however it comes about.
    folder.ok(&sequence(&base));
    let same = [
        "--frames",
        "0..4",
        "--fps",
        "2997924580",
        "-o",
        "f.exr",
        "--isochrones",
        "t.png",
    ];
    assert_eq!(skipped(&folder.ok(&sequence(&same)))[0], 0);
}

#[test]
fn another_scene_text_makes_other_frames() {
    let folder = folder();
    let arguments = sequence(&[&FOUR[..], &["-o", "f.png"]].concat());
    folder.ok(&arguments);
    let scene = String::from_utf8(folder.read("scene.toml")).unwrap();
    folder.write(
        "scene.toml",
        scene.replace("intensity = 100", "intensity = 90"),
    );
    assert_eq!(skipped(&folder.ok(&arguments)), [0; 0]);
}

#[test]
fn other_input_files_make_other_frames() {
    let folder = folder();
    let scene = String::from_utf8(folder.read("scene.toml")).unwrap();
    let mesh = scene.replace(
        "shape = { box = { size = [1, 1, 1] } }",
        "gltf = \"mesh.gltf\"",
    );
    folder.write("scene.toml", mesh);
    folder.write("mesh.gltf", TRIANGLE);
    folder.write("bricks.png", "not looked at");
    let corners = |height: f32| {
        let numbers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, height, 0.0f32];
        numbers.map(f32::to_le_bytes).concat()
    };
    folder.write("mesh.bin", corners(1.0));
    let arguments = sequence(&[&FOUR[..], &["-o", "f.png"]].concat());
    folder.ok(&arguments);
    assert_eq!(skipped(&folder.ok(&arguments)), [0, 1, 2, 3]);
    folder.write("mesh.bin", corners(0.5));
    assert_eq!(skipped(&folder.ok(&arguments)), [0; 0]);
    assert_eq!(skipped(&folder.ok(&arguments)), [0, 1, 2, 3]);
}

#[test]
fn a_long_sequence_names_its_first_and_its_last_file() {
    let folder = Folder::new();
    let run = |frames: &str| {
        let sizes = ["--size", "4x4", "--spp", "1", "--white", "1"];
        let sequence = [
            "render",
            "scene.toml",
            "--frames",
            frames,
            "--interval",
            "1 cm",
            "-o",
            "f-#.png",
        ];
        folder.ok(&[&sequence[..], &sizes].concat())
    };
    let of_files = |said: &str| -> Vec<String> {
        let lines = said
            .lines()
            .filter(|line| line.starts_with("wrote ") || line.contains("exists"));
        lines.map(str::to_owned).collect()
    };
    let said = of_files(&run("0..12"));
    assert!(
        said.len() == 12 && said[11].starts_with("wrote f-11.png ("),
        "{said:?}"
    );
    let said = of_files(&run("0..14"));
    assert_eq!(said, ["wrote f-0.png to f-13.png"]);
    let again = run("0..14");
    assert!(again.contains("0 rendered, 14 existed already"), "{again}");
    assert!(of_files(&again).is_empty(), "{again}");
}
