//! Sequences of frames.

use std::fs;

use nullray::io::image::{exr, png};

use super::refused::refused;
use super::{Folder, SMALL};

/// A folder with `scene.toml`, a small one with a fixed white.
pub fn folder() -> Folder {
    let folder = Folder::empty();
    let scene = SMALL.replace("[display]", "[display]\nwhite = 0.5");
    folder.write(
        "scene.toml",
        scene.replace("size = [32, 24]", "size = [12, 9]"),
    );
    folder
}

/// Arguments of `render scene.toml`.
pub fn sequence<'a>(options: &[&'a str]) -> Vec<&'a str> {
    [&["render", "scene.toml"], options].concat()
}

/// The camera time that a PNG states, metres.
fn time(folder: &Folder, name: &str) -> f64 {
    entry(folder, name, "camera_time").parse().unwrap()
}

fn entry(folder: &Folder, name: &str, key: &str) -> String {
    let text = png::inspect(&folder.path(name)).unwrap().text;
    let entry = text.into_iter().find(|(k, _)| k == key);
    entry.unwrap_or_else(|| panic!("{name} has no {key}")).1
}

/// The pictures in the folder, sorted.
pub fn pictures(folder: &Folder) -> Vec<String> {
    let names = folder.names().into_iter();
    names.filter(|name| !name.ends_with(".toml")).collect()
}

/// Four frames.
pub const FOUR: [&str; 4] = ["--frames", "0..4", "--interval", "10 cm"];

#[test]
fn frames_are_numbered_absolutely_and_the_last_is_not_rendered() {
    let folder = folder();
    folder.ok(&sequence(&[
        "--frames",
        "8..11",
        "--interval",
        "10 cm",
        "-o",
        "film.png",
    ]));
    assert_eq!(
        pictures(&folder),
        ["film-0008.png", "film-0009.png", "film-0010.png"]
    );
}

#[test]
fn a_run_of_hashes_or_a_place_as_in_c_becomes_the_number() {
    let folder = folder();
    let options = [
        "-o",
        "a-######.png",
        "-o",
        "#.exr",
        "-o",
        "c-%03d.png",
        "--isochrones",
        "t##.png",
    ];
    folder.ok(&sequence(
        &[&["--frames", "9..11", "--fps", "1e9"], &options[..]].concat(),
    ));
    assert_eq!(
        pictures(&folder),
        [
            "10.exr",
            "9.exr",
            "a-000009.png",
            "a-000010.png",
            "c-009.png",
            "c-010.png",
            "t09.png",
            "t10.png"
        ]
    );
}

#[test]
fn without_o_frames_have_the_scenes_name() {
    let folder = folder();
    folder.ok(&sequence(&["--frames", "0..1", "--interval", "1 m"]));
    assert_eq!(pictures(&folder), ["scene-0000.png"]);
}

#[test]
fn frame_k_is_taken_k_intervals_after_the_time_of_the_scene() {
    let folder = folder();
    let options = [
        "--frames",
        "2..4",
        "--interval",
        "25 cm",
        "--time",
        "-1 m",
        "-o",
        "f.png",
    ];
    folder.ok(&sequence(&options));
    assert_eq!(time(&folder, "f-0002.png"), -0.5);
    assert_eq!(time(&folder, "f-0003.png"), -0.25);
}

#[test]
fn frames_per_second_are_of_the_cameras_clock_and_the_scenes_light() {
    let folder = folder();
    let scene = String::from_utf8(folder.read("scene.toml")).unwrap();
    folder.write(
        "scene.toml",
        format!("speed_of_light = \"10 m/s\"\n{scene}"),
    );
    // Three per second: a third of 10 m each, and the one at 1 s is not rendered.
    folder.ok(&sequence(&[
        "--from", "0 s", "--to", "1 s", "--fps", "3", "-o", "f.png",
    ]));
    assert_eq!(
        pictures(&folder),
        ["f-0000.png", "f-0001.png", "f-0002.png"]
    );
    for (name, k) in [
        ("f-0000.png", 0.0),
        ("f-0001.png", 1.0),
        ("f-0002.png", 2.0),
    ] {
        assert_eq!(time(&folder, name), k / 3.0 * 10.0);
    }
}

#[test]
fn frames_that_are_absurdly_far_apart_are_remarked() {
    let folder = folder();
    let far = ["--frames", "0..2", "--fps", "24", "-o", "f.png"];
    let said = folder.ok(&sequence(&far));
    assert!(
        said.contains("frames are 1.249e7 m of light path apart") && said.contains("--play-fps"),
        "{said}"
    );
    let near = ["--frames", "0..2", "--fps", "1e9", "-o", "f.png"];
    let said = folder.ok(&sequence(&near));
    assert!(!said.contains("light path apart"), "{said}");
}

#[test]
fn black_frames_of_a_clock_are_not_advised_to_change_the_time_of_a_single_picture() {
    let folder = folder();
    let early = ["--from=-9 km", "--to=-8 km", "--interval=1 km", "-o=f.png"];
    let said = folder.ok(&sequence(&early));
    assert!(
        said.contains("the picture is black") && !said.contains("--time"),
        "{said}"
    );
    assert!(said.contains("camera time"), "{said}");
}

#[test]
fn a_range_of_times_is_half_open_in_spite_of_rounding() {
    let folder = folder();
    // In binary 0.1 · 3 is above 0.3.
    folder.ok(&sequence(&[
        "--from",
        "0 m",
        "--to",
        "0.3 m",
        "--interval",
        "0.1 m",
        "-o",
        "f.png",
    ]));
    assert_eq!(
        pictures(&folder),
        ["f-0000.png", "f-0001.png", "f-0002.png"]
    );
    folder.ok(&sequence(&[
        "--from",
        "-1 m",
        "--to",
        "-0.69 m",
        "--interval",
        "0.1 m",
        "-o",
        "g.png",
    ]));
    assert_eq!(pictures(&folder).len(), 3 + 4);
    assert_eq!(time(&folder, "g-0000.png"), -1.0);
}

#[test]
fn a_frame_is_the_picture_that_its_time_gives_alone() {
    let folder = folder();
    let channels = ["--aovs", "object,primitive", "-o"];
    let frames = ["--frames", "0..6", "--interval", "50 cm"];
    folder.ok(&sequence(&[&frames[..], &channels, &["f.exr"]].concat()));
    folder.ok(&sequence(
        &[&["--time", "2.5 m"], &channels[..], &["alone.exr"]].concat(),
    ));
    let read = |name: &str| exr::read(&folder.path(name), &Default::default()).unwrap();
    let (frame, alone) = (read("f-0005.exr"), read("alone.exr"));
    assert!(frame.channels == alone.channels);
    assert!(frame.channels != read("f-0004.exr").channels);
    // Apart from what resuming checks, it says the same of its origin.
    let resuming = ["frame_fingerprint", "file_sha256"];
    let metadata = frame.metadata.into_iter();
    let metadata: Vec<_> = metadata
        .filter(|(k, _)| !resuming.contains(&k.as_str()))
        .collect();
    assert_eq!(metadata, alone.metadata);
}

#[test]
fn parts_of_a_sequence_are_the_whole_byte_by_byte() {
    let folder = folder();
    folder.ok(&sequence(&[&FOUR[..], &["-o", "whole.png"]].concat()));
    for part in ["2..4", "0..2"] {
        let frames = ["--frames", part, "--interval", "10 cm", "--threads", "1"];
        folder.ok(&sequence(&[&frames[..], &["-o", "part.png"]].concat()));
    }
    for k in 0..4 {
        let [whole, part] =
            ["whole", "part"].map(|name| folder.read(&format!("{name}-000{k}.png")));
        assert!(whole == part, "{k}");
    }
}

#[test]
fn one_exposure_of_all_frames_is_said_and_a_fixed_white_is_not() {
    let folder = Folder::new();
    let frames = ["--frames", "0..1", "--interval", "1 m", "--size", "8x6"];
    let said = folder.ok(&sequence(&frames));
    assert_eq!(
        said.matches("one exposure for all frames").count(),
        1,
        "{said}"
    );
    for other in [&["--white", "2"][..], &["-o", "a.exr"], &["--own-exposure"]] {
        let said = folder.ok(&sequence(&[&frames[..], other].concat()));
        assert!(!said.contains("one exposure"), "{said}");
    }
}

#[test]
fn black_frames_are_counted_and_the_first_explained() {
    let folder = folder();
    let away = ["--set", "camera.look_at=[0,9,9]", "-o", "f.png"];
    let said = folder.ok(&sequence(&[&FOUR[..], &away].concat()));
    assert!(
        said.contains("4 frames are black, the first of them:\nframe 0: "),
        "{said}"
    );
    assert_eq!(said.matches("the picture is black").count(), 1, "{said}");
}

#[test]
fn what_contradicts_itself_is_refused() {
    let folder = folder();
    let cases: &[(&[&str], &[&str])] = &[
        (
            &["--frames", "0..4"],
            &["--frames", "--interval", "--fps", "camera.frame_interval"],
        ),
        (
            &["--from", "0 m", "--to", "1 m"],
            &["--from", "--interval", "--fps"],
        ),
        (
            &["--frames", "4..4"],
            &["--frames", "4..4 contains no frame"],
        ),
        (&["--frames", "4"], &["--frames", "0..50"]),
        (&["--frames", "-4..4"], &["--frames"]),
        (
            &["--frames", "0..5000000000"],
            &["--frames", "whole numbers"],
        ),
        (
            &["--frames", "0..4", "--from", "0 m", "--to", "1 m"],
            &["--frames", "cannot be used with"],
        ),
        (
            &["--frames", "0..4", "--to", "1 m"],
            &["--to", "cannot be used with"],
        ),
        (&["--from", "0 m", "--fps", "5"], &["--to"]),
        (&["--to", "0 m", "--fps", "5"], &["--from"]),
        (
            &["--from", "0 m", "--to", "1 m", "--time", "1 m"],
            &["--time", "cannot be used with"],
        ),
        (
            &["--time", "1 m", "--to", "2 m"],
            &["--to", "cannot be used with"],
        ),
        (&["--fps", "5"], &["--frames"]),
        (&["--interval", "1 m"], &["--frames"]),
        (
            &["--frames", "0..4", "--fps", "5", "--interval", "1 m"],
            &["--fps", "cannot be used with"],
        ),
        (&["--frames", "0..4", "--fps", "0"], &["--fps", "above 0"]),
        (&["--frames", "0..4", "--fps", "inf"], &["--fps", "above 0"]),
        (
            &["--frames", "0..4", "--interval", "0 m"],
            &["--interval", "above 0"],
        ),
        (
            &["--frames", "0..4", "--interval", "-1 m"],
            &["--interval", "above 0"],
        ),
        (
            &["--frames", "0..4", "--interval", "1"],
            &["--interval", "unit"],
        ),
        (
            &["--from", "1 m", "--to", "1 m", "--interval", "1 m"],
            &["--to", "not after --from"],
        ),
        (
            &["--frames", "0..1000001", "--interval", "1 m"],
            &["1000001", "more than 1000000"],
        ),
        (
            &["--from", "0 m", "--to", "1 km", "--interval", "1 nm"],
            &["more than 1000000"],
        ),
    ];
    for (options, parts) in cases {
        refused(&folder, &sequence(options), parts);
    }
}

#[test]
fn names_that_meet_are_refused_before_any_work() {
    let folder = folder();
    let frames = [
        "--frames",
        "0..100",
        "--interval",
        "1 mm",
        "--spp",
        "60000",
        "-o",
    ];
    let with = |rest: &[&'static str]| sequence(&[&frames[..], rest].concat());
    refused(
        &folder,
        &with(&["a.png", "-o", "a-####.png"]),
        &["two outputs"],
    );
    // Frame 10 of the first and frame 0 of the second.
    refused(
        &folder,
        &with(&["a#.png", "-o", "a1#.png"]),
        &["-o a10.png", "two outputs"],
    );
    refused(&folder, &with(&["none/a.png"]), &["no directory none"]);
    fs::create_dir(folder.path("a-0070.png")).unwrap();
    refused(&folder, &with(&["a.png"]), &["a-0070.png", "not a file"]);
}

#[test]
fn a_name_with_two_places_for_the_number_is_refused() {
    let folder = folder();
    for name in ["e-##-##.png", "e-##-%d.png"] {
        let options = [&FOUR[..], &["-o", name]].concat();
        refused(
            &folder,
            &sequence(&options),
            &[name, "several places", "one run of #"],
        );
    }
}

#[test]
fn frames_beyond_the_motion_are_refused_by_their_number() {
    let folder = folder();
    folder.write(
        "path.toml",
        "[camera]\nlook_at = [0, 0, 0]\nsize = [6, 4]\n[camera.motion]\nkeyframes = [{ time = \"0 m\", position = [0, 0, 5] }, \
         { time = \"5 m\", position = [3, 0, 5] }]\n[[object]]\nshape = { sphere = { radius = 1 } }\n",
    );
    // 0.6 c: 5 m of the world's time are 4 m of the camera's.
    let frames = [
        "render",
        "path.toml",
        "--frames",
        "0..8",
        "--interval",
        "1 m",
        "-o",
        "a-#.png",
    ];
    let parts = ["--frames", "frame 7 is taken at 7 m", "lasts from 0 m to"];
    refused(&folder, &frames, &parts);
}
