//! The output of `nullray info` for files of every kind.

use std::fs;
use std::io::Write;
use std::path::Path;

use nullray::io::budget::Budget;
use nullray::io::image::{Layers, exr, png};
use serde_json::Value;

use super::refused::{TRIANGLE, refused};
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
fn what_is_passed_over_of_a_mesh_is_said_once_however_many_objects_show_it() {
    let folder = Folder::empty();
    let unread = TRIANGLE
        .replace("\"asset\"", "\"extensionsUsed\": [\"FOO_bar\"], \"asset\"")
        .replace("\"images\": [{\"uri\": \"bricks.png\"}],", "");
    folder.write("mesh.gltf", unread);
    let corners: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    folder.write("mesh.bin", corners.map(f32::to_le_bytes).concat());
    let object = "[[object]]\ngltf = \"mesh.gltf\"\n";
    let moved = "velocity = { beta = [0.5, 0, 0] }\n";
    folder.write(
        "scene.toml",
        format!(
            "[camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\nsize = [4, 4]\n{object}{object}{object}{moved}"
        ),
    );
    let words = "mesh.gltf: extensionsUsed: the extension \"FOO_bar\" is not supported";
    let data = said(&folder, "scene.toml", &[words]);
    assert_eq!(data["warnings"], serde_json::json!([words]));
    for command in [
        &["info", "scene.toml"][..],
        &["plan", "scene.toml"],
        &["render", "scene.toml"],
    ] {
        let said = folder.ok(command);
        let lines = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(lines.matches(words).count(), 1, "{command:?}: {said}");
    }
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
        ("two-axes.npy", "is not a cube"),
        ("two-channels.npy", "phasor film"),
        ("structured.npy", "cannot hold radiance"),
        ("sample-nan.npy", "not a finite number"),
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
fn of_arrays_that_are_truncated_only_what_is_missing() {
    let folder = Folder::new();
    archive(&folder.path("a.npz"), &["one".into(), "two".into()]);
    // A header that promises more than the member has.
    let mut bytes = fs::read(folder.path("a.npz")).unwrap();
    let shape = bytes.windows(9).rposition(|w| w == b"(1, 1, 3)").unwrap();
    bytes[shape + 1] = b'9';
    folder.write("a.npz", &bytes);
    let file = repository("tests/data/invalid/truncated.npy");
    for (file, words) in [
        (
            file.as_str(),
            "it is 168 bytes long and should be 169: it is truncated",
        ),
        ("a.npz", "\"two\""),
    ] {
        let run = folder.run(&["info", file]);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{file}");
        let said = run.message();
        assert!(said.contains(words) && said.contains("truncated"), "{said}");
        assert_eq!(said.matches("error:").count(), 1, "{said}");
    }
}

/// An archive of `names` as numpy writes it, each an array of shape (1, 1, 3).
fn archive(path: &Path, names: &[String]) {
    let mut archive = zip::ZipWriter::new(fs::File::create(path).unwrap());
    let options =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 3), }";
    for name in names {
        archive.start_file(format!("{name}.npy"), options).unwrap();
        archive.write_all(b"\x93NUMPY\x01\x00\x76\x00").unwrap();
        archive
            .write_all(format!("{header:<117}\n").as_bytes())
            .unwrap();
        archive.write_all(&[0; 12]).unwrap();
    }
    archive.finish().unwrap();
}

#[test]
fn of_many_arrays_the_first_are_looked_into() {
    let folder = Folder::new();
    let names: Vec<String> = (0..25).map(|i| format!("part{i:02}")).collect();
    archive(&folder.path("many.npz"), &names);
    let text = folder.ok(&["info", "many.npz"]);
    assert_eq!(text.matches("as a cube").count(), 20, "{text}");
    assert!(text.contains("and 5 more arrays"), "{text}");
    let json: Value = serde_json::from_str(&folder.ok(&["info", "many.npz", "--json"])).unwrap();
    let arrays = json["arrays"].as_array().unwrap();
    assert_eq!(arrays.len(), 25);
    let is_read = |array: &&Value| !array["cube"].is_null();
    assert_eq!(arrays.iter().filter(is_read).count(), 20);
}

/// The directory says of the second member that it is where the first one is.
#[test]
fn of_arrays_that_share_their_bytes_nothing() {
    let folder = Folder::new();
    archive(&folder.path("a.npz"), &["one".into(), "two".into()]);
    let mut bytes = fs::read(folder.path("a.npz")).unwrap();
    let entry = |n: usize| {
        let at = bytes
            .windows(4)
            .enumerate()
            .filter(|(_, w)| w == b"PK\x01\x02");
        at.map(|(at, _)| at).nth(n).unwrap()
    };
    // Where a member begins stands 42 bytes after the start of its entry.
    let second = entry(1) + 42;
    bytes[second..second + 4].fill(0);
    folder.write("a.npz", &bytes);
    refused(&folder, &["info", "a.npz"], &["two members overlap"]);
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
    let data = said(
        &folder,
        "a.npz",
        &["array       radiance", "(24, 32, 3)", "<f8", "scene_sha256"],
    );
    assert!(
        data["metadata"]["scene_text"]
            .as_str()
            .unwrap()
            .contains("[camera]")
    );
}

/// A picture of another program, which writes channels and no metadata, is one as well.
#[test]
fn of_pictures_that_other_programs_wrote() {
    let folder = Folder::empty();
    let mut archive = zip::ZipWriter::new(fs::File::create(folder.path("mine.npz")).unwrap());
    for (name, descr, shape, size) in [
        ("object", "<i8", "(2, 3)", 48),
        ("event", "<f4", "(2, 3, 4)", 96),
        ("wavelength_ratio", "<f4", "(2, 3)", 24),
    ] {
        let header =
            format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.bytes());
        bytes.extend(vec![0; size]);
        archive
            .start_file(
                format!("{name}.npy"),
                zip::write::SimpleFileOptions::default(),
            )
            .unwrap();
        archive.write_all(&bytes).unwrap();
    }
    archive.finish().unwrap();
    let parts = ["picture of 3 arrays", "usable      yes: `nullray compare`"];
    said(&folder, "mine.npz", &parts);
    assert!(!folder.ok(&["info", "mine.npz"]).contains("not a cube"));
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
fn of_a_scene_what_of_its_cubes_was_read_and_what_is_assumed() {
    let folder = Folder::empty();
    let data = said(
        &folder,
        &repository("scenes/capture.toml"),
        &[
            "read      ",
            "64 rows, 64 columns, 95 time bins, red, green, blue",
            "energy per bin, arrival at the capture camera",
            "assumed",
        ],
    );
    let cube = &data["sources"][0]["cube"];
    assert_eq!(cube["shape"], serde_json::json!([64, 64, 95, 3]));
    assert_eq!(cube["bin_width"], 0.1);
    let assumed = cube["assumed"].as_array().unwrap();
    assert_eq!(assumed.len(), 3, "{assumed:?}");
    assert_eq!(assumed[0], "axes = \"H W T C\"");
    assert_eq!(assumed[1], "reconstruction = \"bilinear\"");
    assert_eq!(assumed[2], "capture.near_clip = 0");
}

#[test]
fn of_a_transient_image_its_bins_and_its_corners() {
    let parts = [
        "bins of 0.5 m, the first about 2.25 m",
        "top left (-1.5, 2, 0)",
        "yes: as the file of a [source.cube]",
    ];
    said(
        &Folder::empty(),
        &repository("tests/data/bonn/wall.ti"),
        &parts,
    );
}

#[cfg(feature = "hdf5")]
#[test]
fn of_a_capture_with_times_at_its_sensor_how_to_use_it() {
    let info = |file: &str, usable: &str| {
        let file = repository(&format!("tests/data/hdf5/{file}"));
        said(&Folder::empty(), &file, &[usable]);
    };
    info(
        "tal_1_both.hdf5",
        "after `nullray convert FILE --unwarp FILE",
    );
    info(
        "zaragoza_5.hdf5",
        "after `nullray convert FILE --unwarp FILE",
    );
    info("tal_1.hdf5", "yes: as the file of a [source.cube]");
}

/// `SMALL` with more said of its camera.
fn with_camera(folder: &Folder, keys: &str) {
    let text = super::SMALL.replacen("[camera]", &format!("[camera]\n{keys}"), 1);
    folder.write("scene.toml", text);
}

const MOVING: &str = "motion.acceleration = { proper = '0.5 /m', direction = [0, 0, -1] }
sensor = { focal_length = '2 cm', assembly = 'bell' }
shutter = { duration = '3 m', records = 'energy' }
frame_interval = '0.5 m'
";

#[test]
fn of_a_camera_that_accelerates_and_exposes_for_a_while() {
    let folder = Folder::empty();
    with_camera(&folder, MOVING);
    let parts = [
        "γ = 1.048285 when its clock shows 0",
        "accelerates for ever at (0, 0, -0.5) /m",
        "0.02 m behind the pinhole in the world, accelerating like it (Bell)",
        "the shutter is open from 0 m to 3 m of its own time; records the integral",
        "frames are 0.5 m of its own time apart",
    ];
    let data = said(&folder, "scene.toml", &parts);
    let camera = &data["camera"];
    assert_eq!(camera["motion"]["kind"], "acceleration");
    assert_eq!(camera["motion"]["proper_per_m"][2], -0.5);
    assert_eq!(camera["sensor"]["assembly"], "bell");
    assert_eq!(camera["shutter"]["records"], "energy");
    assert_eq!(camera["frame_interval"], 0.5);
}

#[test]
fn of_a_camera_that_turns_in_the_papers_equations() {
    let folder = Folder::empty();
    with_camera(
        &folder,
        "sensor.focal_length = '2 cm'\nrotation = { axis = [0, 2, 0], rate = '0.5 rad/m', elements = 'comoving' }",
    );
    let text = fs::read_to_string(folder.path("scene.toml")).unwrap();
    let still = text
        .replacen("velocity = { beta = [0.6, 0, 0] }", "", 1)
        .replacen("velocity = { beta = [0, 0, -0.3] }", "", 1);
    folder.write("scene.toml", format!("model = 'paper2015'\n{still}"));
    let parts = [
        "model       the equations of Jarabo et al. 2015",
        "turns at 0.5 rad per metre of its own time about (0.0000, 1.0000, 0.0000) through the pinhole",
    ];
    let data = said(&folder, "scene.toml", &parts);
    assert_eq!(data["model"], "paper2015");
    assert_eq!(data["camera"]["rotation"]["elements"], "comoving");
}

#[test]
fn of_cameras_on_paths() {
    let folder = Folder::empty();
    let velocity = "velocity = { beta = [0, 0, -0.3] }";
    let pose = "eye = [0, 1, 4]\nlook_at = [0, 0.5, 0]";
    for (pose_said, motion, part, kind) in [
        (
            pose,
            "segments = [{ duration = '2 m' }, { acceleration = { proper = '1 /m', direction = [1, 0, 0] } }]",
            "accelerates in 2 segments from 0 m of its own time on, for ever",
            "segments",
        ),
        (
            pose,
            "profile = [{ time = '0 m' }, { time = '2 m' }]",
            "by a profile of 2 times, from 0 m to 2 m of its own",
            "profile",
        ),
        (
            "look_at = [0, 0.5, 0]",
            "keyframes = [{ time = '1 m', position = [0, 1, 4] }, { time = '3 m', position = [1, 1, 4] }]",
            "through 2 keyframes, from 1 m to 3 m of world time",
            "keyframes",
        ),
        (
            pose,
            "circle = { centre = [0, 0, 0], axis = [0, 1, 0], rate = '0.125 rad/m' }",
            "circles (0, 0, 0) m about the axis (0, 1, 0) at 0.125 rad per metre of world time",
            "circle",
        ),
    ] {
        let scene = super::SMALL.replacen(velocity, "", 1);
        let said_now = format!("{pose_said}\nmotion = {{ {motion} }}");
        folder.write("scene.toml", scene.replacen(pose, &said_now, 1));
        let data = said(&folder, "scene.toml", &[part]);
        assert_eq!(data["camera"]["motion"]["kind"], kind);
    }
}

#[test]
fn the_metadata_of_a_picture_say_how_its_camera_moved() {
    let folder = Folder::empty();
    with_camera(&folder, MOVING);
    folder.ok(&["render", "scene.toml", "-o", "a.exr"]);
    let data: Value = serde_json::from_str(&folder.ok(&["info", "a.exr", "--json"])).unwrap();
    for (key, value) in [
        ("camera_motion", "acceleration"),
        ("camera_proper_acceleration_per_m", "0 0 -0.5"),
        ("sensor_focal_length", "0.02"),
        ("sensor_assembly", "bell"),
        ("shutter_duration", "3"),
        ("shutter_records", "energy"),
        ("frame_interval", "0.5"),
    ] {
        assert_eq!(data["metadata"][key], value, "{key}");
    }
}

#[test]
fn channels_in_half_precision_are_said_to_be() {
    let folder = Folder::new();
    let render = [
        "render",
        "scene.toml",
        "--half",
        "--aovs",
        "distance",
        "-o",
        "a.exr",
    ];
    folder.ok(&render);
    let data: Value = serde_json::from_str(&folder.ok(&["info", "a.exr", "--json"])).unwrap();
    for (name, of_type) in [("radiance.R", "f16"), ("distance", "f32")] {
        let channels = data["channels"].as_array().unwrap();
        let channel = channels.iter().find(|channel| channel["name"] == name);
        assert_eq!(channel.unwrap()["type"], of_type, "{name}");
    }
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
fn of_png_files_that_lack_pixels_what_is_missing() {
    let folder = Folder::empty();
    let rgb: Vec<u8> = (0..3 * 64 * 64).map(|k| (k * k / 7) as u8).collect();
    png::write(&folder.path("whole.png"), 64, 64, &rgb, &[]).unwrap();
    let whole = folder.read("whole.png");
    folder.ok(&["info", "whole.png"]);
    for length in (60..whole.len()).step_by(whole.len() / 20) {
        folder.write("cut.png", &whole[..length]);
        let parts = ["cut.png", "copy or write"];
        refused(&folder, &["info", "cut.png"], &parts);
    }
    // A header of 65535 × 65535 pixels, with the checksum of CRC-32, and the data of 64 × 64.
    let mut large = whole.clone();
    large[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
    let sum = large[12..29].iter().fold(u32::MAX, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| {
            sum >> 1 ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 }
        })
    });
    large[29..33].copy_from_slice(&(!sum).to_be_bytes());
    folder.write("large.png", &large);
    let parts = ["4294836225 pixels", "truncated or damaged"];
    refused(&folder, &["info", "large.png"], &parts);
}

#[test]
fn a_json_that_is_no_gltf_is_told_what_it_lacks() {
    let folder = Folder::empty();
    for (name, text) in [
        ("a.json", "{\"a\": 1}"),
        ("b.gltf", "{}"),
        ("c.json", "{\"asset\": {\"generator\": \"none\"}}"),
    ] {
        folder.write(name, text);
        let run = folder.run(&["info", name]);
        assert_eq!(run.code, 2, "{name}");
        for words in [
            name,
            "not glTF: it has no `asset` with its glTF version",
            "\"asset\": {\"version\": \"2.0\"}",
        ] {
            assert!(run.message().contains(words), "{words}: {}", run.stderr);
        }
    }
    // Of what is glTF and broken, and of what is no JSON, that is said.
    for (name, text, words) in [
        (
            "d.json",
            "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": 3}",
            "expected a sequence",
        ),
        ("e.json", "{\"a\":", "EOF while parsing"),
        ("f.json", "[1]", "neither a GLB file"),
    ] {
        folder.write(name, text);
        let run = folder.run(&["info", name]);
        assert_eq!(run.code, 2, "{name}");
        assert!(run.message().contains(words), "{words}: {}", run.stderr);
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
        assert!(!run.stderr.contains("bug in nullray"), "{}", run.stderr);
    }
}

#[test]
fn tables_and_pictures_of_the_sky_are_named_by_what_they_are_of_use_for() {
    let folder = Folder::empty();
    folder.write("lamp.csv", "nm,W\n400,1\n550,2.5\n700,0\n");
    folder.write("stars.csv", "x,y,z,mag,T\n1,0,0,2,5000\n0,1,0,3,9000\n");
    folder.write("other.csv", "speed,error\n0.5,a\n");
    let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n".to_vec();
    hdr.extend([128; 4 * 8]);
    folder.write("sky.hdr", &hdr);
    let info = |name: &str| folder.ok(&["info", name]);
    let lamp = info("lamp.csv");
    for part in ["3", "400 to 700 nm", "spectrum = { table = \"lamp.csv\" }"] {
        assert!(lamp.contains(part), "{part}: {lamp}");
    }
    let stars = info("stars.csv");
    for part in ["2", "stars = { file = \"stars.csv\" }"] {
        assert!(stars.contains(part), "{part}: {stars}");
    }
    assert!(info("sky.hdr").contains("as the image of a [sky]"));
    // Of pictures of scenes only whole panoramas are skies.
    folder.write(
        "stars.toml",
        "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nsize = [8, 4]\n[sky]\ngradient = {}\n",
    );
    for (hfov, projection, is_sky) in [
        ("60 deg", "perspective", false),
        ("180 deg", "equirectangular", false),
        ("360 deg", "equirectangular", true),
    ] {
        let [hfov, projection] = [("hfov", hfov), ("projection", projection)]
            .map(|(key, value)| format!("camera.{key}=\"{value}\""));
        let set = ["--set", &hfov, "--set", &projection];
        folder.ok(&[&["render", "stars.toml", "-o", "sky.exr"][..], &set].concat());
        assert_eq!(
            info("sky.exr").contains("as the image of a [sky]"),
            is_sky,
            "{projection}"
        );
    }
    let exr = exr::read(&folder.path("sky.exr"), &Budget::new(1 << 20)).unwrap();
    let bare = Layers::new(exr.width, exr.height, exr.channels, vec![]).unwrap();
    exr::write(&folder.path("sky.exr"), &bare).unwrap();
    assert!(info("sky.exr").contains("as the image of a [sky]"));
    let run = folder.run(&["info", "other.csv"]);
    assert_eq!(run.code, 2);
    let said = "neither the table of a spectrum nor one of stars";
    assert!(run.message().contains(said), "{}", run.message());
    // By the number of columns it is clear which of them a table with a fault is meant to be.
    for (text, said) in [
        ("nm,power\n400,1\n500,-1\n", "line 3: a value of -1"),
        ("500,1\n400,1\n", "400 nm does not come after"),
        ("0,0,0,1,5800\n", "line 1: its direction has no length"),
    ] {
        folder.write("fault.csv", text);
        let run = folder.run(&["info", "fault.csv"]);
        assert_eq!(run.code, 2);
        assert!(run.message().contains(said), "{said}: {}", run.message());
    }
    folder.write("dark.csv", "400,0\n500,0\n");
    assert!(info("dark.csv").contains("all values are 0"));
}

#[test]
fn models_of_other_kinds_are_said_to_be_unread() {
    let folder = Folder::empty();
    folder.write("m.obj", "v 0 0 0\n");
    for command in ["render", "info", "plan"] {
        let run = folder.run(&[command, "m.obj"]);
        assert_eq!(run.code, 2);
        for part in [
            "this is a model (.obj); glTF is the only format of models that can be read",
            ".glb",
        ] {
            assert!(run.message().contains(part), "{}", run.message());
        }
    }
}

#[test]
fn archives_that_are_cut_short_are_called_that() {
    let folder = Folder::empty();
    let whole = std::fs::read(super::repository("scenes/corner/capture_rgb.npz")).unwrap();
    folder.write("cut.npz", &whole[..whole.len() - 100]);
    let scene = super::SMALL.split("[[source]]").next().unwrap().to_string()
        + "[[source]]\ncube = { file = \"cut.npz\", start = \"0 m\", bin_width = \"1 m\" }\n";
    folder.write("scene.toml", scene);
    for arguments in [
        "info cut.npz",
        "convert cut.npz -o a.npy",
        "render scene.toml",
    ] {
        let run = folder.run(&arguments.split(' ').collect::<Vec<_>>());
        let said = run.message() + &run.stdout;
        assert!(said.contains("it is cut short"), "{arguments:?}: {said}");
        assert!(said.contains("cut.npz") && !said.contains("EOCD"), "{said}");
    }
}

#[test]
fn a_model_without_a_scene_says_that_its_cameras_are_not_used() {
    let folder = Folder::empty();
    folder.write(
        "cameras.glb",
        std::fs::read(repository("tests/data/valid/cameras.glb")).unwrap(),
    );
    let told = "the file's cameras are used only if a scene names them";
    for arguments in [
        &["plan", "cameras.glb"][..],
        &["render", "cameras.glb", "--size", "8x6", "-o", "out.png"],
    ] {
        let said = folder.ok(arguments);
        assert_eq!(said.matches(told).count(), 1, "{said}");
    }
    let scene = "[camera]\ngltf = \"cameras.glb\"\nnode = \"main\"\nsize = [8, 6]\n[[object]]\ngltf = \"cameras.glb\"\n";
    folder.write("scene.toml", scene);
    let said = folder.ok(&["plan", "scene.toml"]);
    assert!(!said.contains(told), "{said}");
}

#[test]
fn samples_that_are_not_floating_point_are_named() {
    let folder = Folder::empty();
    for (descr, size, said) in [
        ("<i4", 4, "<i4 (32-bit integers)"),
        ("|u1", 1, "|u1 (8-bit integers from 0)"),
        ("|b1", 1, "|b1 (true or false)"),
        ("<U31", 124, "<U31 (text)"),
    ] {
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (2,), }}\n");
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((header.len() as u16).to_le_bytes());
        file.extend(header.bytes());
        file.resize(file.len() + 2 * size, 0);
        folder.write("a.npy", file);
        let text = folder.ok(&["info", "a.npy"]);
        assert!(text.contains(said), "{text}");
    }
}

#[test]
fn channels_of_a_picture_are_in_the_order_of_their_table() {
    let folder = Folder::new();
    folder.ok(&[
        "render",
        "scene.toml",
        "-o",
        "a.exr",
        "--aovs",
        "event,alpha,object",
    ]);
    let json: Value = serde_json::from_str(&folder.ok(&["info", "a.exr", "--json"])).unwrap();
    let channels = json["channels"].as_array().unwrap().iter();
    let names: Vec<_> = channels
        .map(|channel| channel["name"].as_str().unwrap())
        .collect();
    assert_eq!(names[..3], ["radiance.R", "radiance.G", "radiance.B"]);
    let table = nullray::render::aov::Aov::ALL.iter().map(|aov| aov.name());
    let known: Vec<_> = table.filter(|name| names.contains(name)).collect();
    assert_eq!(names[3..3 + known.len()], known);
}
