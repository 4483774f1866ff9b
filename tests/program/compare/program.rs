//! `nullray compare` as its users see it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use nullray::io::image::{Samples, exr, npz, png};
use nullray::validate::compare::{Encoding, Picture};

use crate::compare::pictures::{layers, light};

/// A folder with `exact.*`, and `mine.*`, which is a candidate.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, picture) in ["exact", "mine"].iter().zip(light(61, 47)) {
        let path = |extension: &str| folder.path().join(format!("{name}.{extension}"));
        exr::write(&path("exr"), &picture.layers).unwrap();
        npz::write(&path("npz"), &picture.layers).unwrap();
        let light = picture.layers.radiance().unwrap();
        let codes: Vec<u8> = light
            .iter()
            .flatten()
            .map(|v| (v * 100.0).min(255.0) as u8)
            .collect();
        png::write(&path("png"), 61, 47, &codes, &[]).unwrap();
    }
    folder
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nullray"));
    command
        .arg("compare")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A message as one line, without the frame that is drawn around it.
fn message(output: &Output) -> String {
    let text = text(&output.stderr);
    let words = text.split_whitespace().filter(|word| *word != "|");
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn a_comparison_does_not_depend_on_threads_and_can_be_quiet() {
    let folder = folder();
    let pair = ["exact.exr", "mine.exr"];
    let [one, two, quiet, json] = [
        &["--threads", "1"][..],
        &["--threads", "2"],
        &["-q"],
        &["--quiet", "--json"],
    ]
    .map(|options| run(folder.path(), &[&pair[..], options].concat()));
    assert!(one.stdout == two.stdout && !one.stdout.is_empty());
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
    assert!(text(&json.stdout).starts_with('{'));
    // What is not within a tolerance is said, and by the exit code, too.
    let limit = ["-q", "--tolerance", "rmse=1e-9"];
    let quiet = run(folder.path(), &[&pair[..], &limit].concat());
    assert_eq!(code(&quiet), 1);
    assert!(message(&quiet).contains("not within tolerance"));
    assert!(quiet.stdout.is_empty());
}

#[test]
fn all_formats_are_compared() {
    let folder = folder();
    for extension in ["exr", "npz", "png"] {
        let pair = ["exact", "mine"].map(|name| format!("{name}.{extension}"));
        let output = run(folder.path(), &[&pair[0], &pair[1]]);
        assert_eq!(code(&output), 0, "{}", text(&output.stderr));
        let table = text(&output.stdout);
        assert!(
            table.contains("RMSE") && table.contains("radiance.G") && table.contains("FLIP"),
            "{table}"
        );
    }
}

#[test]
fn formats_of_one_encoding_hold_the_same() {
    let folder = folder();
    let output = run(
        folder.path(),
        &["exact.exr", "exact.npz", "--tolerance", "max=0"],
    );
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
}

#[test]
fn beyond_a_tolerance_the_exit_code_is_1_and_the_metric_is_named() {
    let folder = folder();
    let pair = ["exact.exr", "mine.exr"];
    let with = |limits: &[&str]| {
        let limits = limits.iter().flat_map(|limit| ["--tolerance", limit]);
        run(
            folder.path(),
            &pair.into_iter().chain(limits).collect::<Vec<_>>(),
        )
    };
    assert_eq!(code(&with(&["rmse=1", "psnr=20", "radiance.R:max=10"])), 0);
    let beyond = with(&["rmse=1", "flip=0.01", "ssim=0.9999"]);
    assert_eq!(code(&beyond), 1);
    let message = text(&beyond.stderr);
    assert!(
        message.contains("flip is 0.059") && message.contains("at most 0.01"),
        "{message}"
    );
    assert!(
        message.contains("ssim is") && !message.contains("rmse is"),
        "{message}"
    );
}

#[test]
fn limits_that_limit_nothing_or_cannot_be_met_are_refused() {
    let folder = folder();
    for (limit, words) in [
        ("rmse=inf", "every candidate is within"),
        ("radiance.R:max=inf", "every candidate is within"),
        ("rmse=-1", "no candidate can be within"),
        ("ssim=1.5", "no candidate can be within"),
        ("coverage=1.01", "no candidate can be within"),
    ] {
        let output = run(
            folder.path(),
            &["exact.exr", "mine.exr", "--tolerance", limit],
        );
        assert_eq!(code(&output), 2, "{limit}");
        assert!(message(&output).contains(words), "{}", message(&output));
    }
    // Equal pictures have this signal to noise.
    let equal = ["exact.exr", "exact.npz", "--tolerance", "psnr=inf"];
    assert_eq!(code(&run(folder.path(), &equal)), 0);
}

#[test]
fn bad_input_has_exit_code_2() {
    let folder = folder();
    let unknown = run(
        folder.path(),
        &["exact.exr", "mine.exr", "--tolerance", "wrmse=1"],
    );
    assert_eq!(code(&unknown), 2);
    assert!(message(&unknown).contains("no such metric"));
    // Those of signed values have a bias, too.
    for metric in ["time.mean, time.bias", "w.mean, w.bias"] {
        assert!(message(&unknown).contains(metric), "{metric}");
    }
    let mixed = run(folder.path(), &["exact.exr", "mine.png"]);
    assert_eq!(code(&mixed), 2);
    assert!(message(&mixed).contains("sRGB codes"));
    assert_eq!(code(&run(folder.path(), &["exact.exr", "absent.exr"])), 2);
    assert_eq!(
        code(&run(
            folder.path(),
            &["exact.exr", "mine.exr", "--report", "exact.exr"]
        )),
        2
    );
}

#[test]
fn all_pictures_and_the_report_are_written() {
    let folder = folder();
    let arguments = [
        "exact.exr",
        "mine.exr",
        "--maps",
        "maps.exr",
        "--error-map",
        "map.png",
        "--strip",
        "strip.png",
        "--report",
        "report.html",
    ];
    let output = run(folder.path(), &arguments);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let maps = exr::read(&folder.path().join("maps.exr"), &Default::default()).unwrap();
    let names: Vec<_> = maps.channels.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "difference.radiance.B",
            "difference.radiance.G",
            "difference.radiance.R",
            "flip"
        ]
    );
    for name in ["map.png", "strip.png"] {
        assert!(
            png::read(&folder.path().join(name), &Default::default())
                .unwrap()
                .width
                > 61
        );
    }
    let html = fs::read_to_string(folder.path().join("report.html")).unwrap();
    // Two pictures, a map, and its colour bar.
    assert_eq!(html.matches("data:image/png;base64,").count(), 4);
    assert!(
        html.contains("<svg") && !html.contains("http"),
        "a page that needs no network"
    );
}

#[test]
fn json_holds_every_metric() {
    let folder = folder();
    let output = run(
        folder.path(),
        &["exact.npz", "mine.npz", "--json", "--crop", "5,6,20,21"],
    );
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["pixels"], 420);
    assert!(json["radiance"]["p99.9"].is_number() && json["flip"]["mean"].is_number());
    assert_eq!(json["channels"].as_array().unwrap().len(), 3);
}

#[test]
fn png_of_both_depths_and_with_alpha_are_read_as_codes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep.png");
    let file = fs::File::create(&path).unwrap();
    let mut encoder = ::png::Encoder::new(file, 2, 1);
    encoder.set_color(::png::ColorType::GrayscaleAlpha);
    encoder.set_depth(::png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_image_data(&[0x80, 0, 0xff, 0xff, 0, 0, 0, 0])
        .unwrap();
    drop(writer);
    let picture = Picture::read(&path, Encoding::Srgb, &Default::default()).unwrap();
    let names: Vec<_> = picture
        .layers
        .channels
        .iter()
        .map(|c| c.name.as_str())
        .collect();
    assert_eq!(names, ["radiance.R", "radiance.G", "radiance.B", "A"]);
    let code = 32768.0f32 / 65535.0;
    assert_eq!(
        picture.layers.channels[2].samples,
        Samples::F32(vec![code, 0.0])
    );
    assert_eq!(
        picture.layers.channels[3].samples,
        Samples::F32(vec![1.0, 0.0])
    );
}

#[test]
fn every_difference_between_two_cameras_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    let shot = [("camera_forward", "0 0 -1")];
    let cameras = [
        ("plain", vec![]),
        (
            "fisheye",
            vec![("camera_projection", "fisheye_equidistant")],
        ),
        ("stereo", vec![("camera_interpupillary_distance", "0.06")]),
        (
            "rocket",
            vec![
                ("camera_motion", "acceleration"),
                ("camera_proper_acceleration_per_m", "1 0 0"),
            ],
        ),
        (
            "turning",
            vec![("rotation_axis", "0 1 0"), ("rotation_rate_rad_per_m", "1")],
        ),
        (
            "exposed",
            vec![("sensor_focal_length", "0.1"), ("shutter_duration", "0.5")],
        ),
    ];
    for (name, keys) in &cameras {
        let [mut picture, _] = light(16, 16);
        let metadata = shot.iter().chain(keys);
        let metadata = metadata.map(|(key, value)| (key.to_string(), value.to_string()));
        picture.layers.metadata = metadata.collect();
        exr::write(&folder.path().join(format!("{name}.exr")), &picture.layers).unwrap();
    }
    for (candidate, key) in [
        ("fisheye.exr", "camera_projection"),
        ("stereo.exr", "camera_interpupillary_distance"),
        (
            "rocket.exr",
            "camera_motion, camera_proper_acceleration_per_m",
        ),
        ("turning.exr", "rotation_axis, rotation_rate_rad_per_m"),
        ("exposed.exr", "sensor_focal_length, shutter_duration"),
    ] {
        let output = run(folder.path(), &["plain.exr", candidate]);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert!(
            said.contains(&format!("the shots differ in {key}")),
            "{said}"
        );
    }
}

#[test]
fn the_mask_is_not_overwritten() {
    let folder = folder();
    let pair = [
        "exact.exr",
        "mine.exr",
        "--mask",
        "exact.png",
        "--strip",
        "exact.png",
    ];
    let output = run(folder.path(), &pair);
    assert_ne!(code(&output), 0);
    assert!(message(&output).contains("would be overwritten"));
}

#[test]
fn what_the_named_scene_is_made_of_is_not_overwritten() {
    let folder = folder();
    let sky = folder.path().join("sky.exr");
    fs::copy(folder.path().join("exact.exr"), &sky).unwrap();
    let scene = "[camera]\neye = [0, 1, 5]\nlook_at = [0, 0, 0]\nhfov = \"60 deg\"\nsize = [61, 47]\n\
                 [[object]]\nshape = { box = { size = [1, 1, 1] } }\n[sky]\nimage = { file = \"sky.exr\" }\n";
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let before = fs::read(&sky).unwrap();
    let options = ["--scene", "scene.toml", "--maps", "sky.exr"];
    let output = run(
        folder.path(),
        &[&["exact.exr", "mine.exr"], &options[..]].concat(),
    );
    assert_eq!(code(&output), 2, "{}", message(&output));
    assert!(message(&output).contains("would be overwritten"));
    assert_eq!(fs::read(&sky).unwrap(), before);
}

#[test]
fn a_limit_of_flip_without_flip_says_why_it_is_not_met() {
    let folder = folder();
    let pair = [
        "exact.exr",
        "mine.exr",
        "--no-flip",
        "--tolerance",
        "flip=0.1",
    ];
    let output = run(folder.path(), &pair);
    assert_eq!(code(&output), 1);
    assert!(message(&output).contains("FLIP was not computed (--no-flip)"));
}

#[test]
fn notes_name_options_in_tables_in_json_and_on_pages() {
    let folder = tempfile::tempdir().unwrap();
    // A surface in the lower half, and −1 or 99 above it.
    for (name, nothing) in [("a.npz", -1.0), ("b.npz", 99.0)] {
        let objects = (0..72).map(|i| if i < 36 { nothing } else { 0.0 });
        let channels = [("object", objects.collect()), ("value", vec![1.0; 72])];
        let layers = layers(8, 9, &channels);
        npz::write(&folder.path().join(name), &layers).unwrap();
    }
    let said = "99 marks no hit in b.npz: --no-hit 99 says so";
    for more in [&["--json"][..], &["--report", "page.html"]] {
        let output = run(folder.path(), &[&["a.npz", "b.npz"], more].concat());
        assert!(
            text(&output.stdout).contains(said),
            "{}",
            text(&output.stdout)
        );
    }
    let page = fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(page.contains(said), "{page}");
}

#[test]
fn pictures_of_indices_alone_have_reports_and_maps() {
    let folder = tempfile::tempdir().unwrap();
    let layers = layers(8, 9, &[("object", vec![0.0; 72])]);
    npz::write(&folder.path().join("a.npz"), &layers).unwrap();
    for (option, name) in [
        ("--report", "page.html"),
        ("--error-map", "map.png"),
        ("--strip", "strip.png"),
    ] {
        let output = run(folder.path(), &["a.npz", "a.npz", option, name]);
        assert_eq!(code(&output), 0, "{option}: {}", text(&output.stderr));
        assert!(folder.path().join(name).exists(), "{option}");
    }
}

#[test]
fn a_picture_beside_itself_has_one_exposure_in_the_singular() {
    let folder = folder();
    let output = run(folder.path(), &["exact.npz", "exact.npz"]);
    let said = String::from_utf8(output.stdout).unwrap();
    let line = said.lines().find(|line| line.starts_with("FLIP")).unwrap();
    let count = line.split("HDR, ").nth(1).unwrap();
    let words: Vec<_> = count.split(' ').take(2).collect();
    assert_eq!(words[1] == "exposure", words[0] == "1", "{line}");
}

#[test]
fn help_says_what_a_memory_limit_does() {
    for (command, said) in [
        ("compare", "pictures that take more are refused"),
        ("selftest", "checks that take more are refused"),
        (
            "render",
            "cubes that do not fit are read from disk in parts",
        ),
    ] {
        let mut help = Command::new(env!("CARGO_BIN_EXE_nullray"));
        let output = help.args([command, "--help"]).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let limits = text.matches("Memory limit, also --memory").count();
        assert!(limits == 1 && text.contains(said), "{command}");
    }
}

#[test]
fn options_without_effect_on_these_pictures_are_refused() {
    let folder = folder();
    for options in [
        &["--transfer", "linear"][..],
        &["--bin-width", "5 mm"],
        &["--no-hit", "99"],
    ] {
        let output = run(
            folder.path(),
            &[&["exact.npz", "mine.npz"], options].concat(),
        );
        assert_eq!(code(&output), 2, "{options:?}");
        assert!(message(&output).contains(options[0]), "{output:?}");
        assert!(message(&output).contains("leave it out"), "{output:?}");
    }
    let pngs = ["exact.png", "mine.png", "--transfer", "linear"];
    assert_eq!(code(&run(folder.path(), &pngs)), 0);
}

#[test]
fn the_check_of_folders_says_why_it_fails() {
    let folder = folder();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/ci/pictures.sh");
    let check = |references: &str, candidates: &str| {
        let mut command = Command::new("bash");
        command.args([script, references, candidates]);
        command.env("NULLRAY", env!("CARGO_BIN_EXE_nullray"));
        command.current_dir(folder.path()).output().unwrap()
    };
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let missing = check("nosuch", "empty");
    assert_eq!(code(&missing), 2);
    assert!(text(&missing.stderr).contains("nosuch is not a folder"));
    let empty = check("empty", "empty");
    assert_eq!(code(&empty), 1);
    assert!(text(&empty.stderr).contains("empty holds no .exr"));
}
