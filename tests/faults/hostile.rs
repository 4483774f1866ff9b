//! Files with the wrong contents, names with terminal escapes, and options that no machine can satisfy.

use std::os::unix::fs::symlink;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::{Folder, SCENE, check_failure, said};

fn corpus(name: &str) -> String {
    format!("{}/fuzz/corpus/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn pictures_that_claim_more_memory_than_there_is_are_refused() {
    let folder = Folder::new();
    for (name, limit) in [
        ("picture_npz/claims-32-gib.npz", "16GiB"),
        ("picture_exr/claims-much.exr", "16GiB"),
        ("picture_png/wide.png", "1GiB"),
    ] {
        let path = corpus(name);
        let begin = Instant::now();
        let text = folder.fail(&["compare", &path, &path, "--max-memory", limit]);
        assert!(text.contains("memory") || text.contains("claims"), "{text}");
        assert!(begin.elapsed() < Duration::from_secs(20));
    }
}

#[test]
fn an_error_far_to_the_right_is_shown() {
    let folder = Folder::new();
    for name in ["scene/column-65535.toml", "scene/column-65536.toml"] {
        let text = folder.fail(&["plan", &corpus(name)]);
        assert!(text.contains("help:") && text.len() < 5000, "{text}");
    }
}

#[test]
fn integers_beyond_those_of_toml_do_not_make_options_vanish() {
    let folder = Folder::new();
    for number in ["9223372036854775808", "18446744073709551615"] {
        folder.write(
            "a.toml",
            SCENE.replace(
                "look_at = [0, 0, 0]",
                &format!("look_at = [0, 0, -{number}]"),
            ),
        );
        folder.write(
            "b.toml",
            SCENE.replace(
                "look_at = [0, 0, 0]",
                &format!("look_at = [0, 0, {number}]"),
            ),
        );
        for name in ["a.toml", "b.toml"] {
            let output = folder.run(&[
                "plan",
                name,
                "--size",
                "7x5",
                "--set",
                "display.samples_per_pixel=1",
            ]);
            let text = said(&output);
            match output.status.success() {
                true => assert!(text.contains("7 × 5"), "{text}"),
                false => check_failure(&output),
            }
        }
    }
}

#[test]
fn names_in_files_do_not_steer_the_terminal() {
    let folder = Folder::new();
    let name = "a\\u001b[2J\\u009b31m\\u202eb";
    let scene = format!(
        "{SCENE}name = \"{name}\"\n[[source]]\nname = \"{name}\"\npulse = {{ position = [0, 0, 1], sigma = \"1 cm\" }}\n"
    );
    folder.write("a.toml", scene);
    folder.write("b.toml", format!("\"{name}\" = 1\n"));
    for arguments in [
        &["plan", "a.toml"][..],
        &["plan", "a.toml", "--json"],
        &["info", "a.toml"],
        &["info", "a.toml", "--json"],
        &["render", "a.toml", "-o", "a.png"],
        &["plan", "b.toml"],
        &["plan", "\u{1b}[2J.toml"],
    ] {
        let text = said(&folder.run(arguments));
        let harmful = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
        assert!(!text.contains(harmful), "{arguments:?}: {text:?}");
    }
}

#[test]
fn no_line_that_is_said_is_longer_than_a_screen_or_two() {
    let folder = Folder::new();
    let long = "9".repeat(100_000);
    folder.write("a.toml", format!("{SCENE}name = \"{long}\"\n"));
    for arguments in [
        &["plan", "a.toml"][..],
        &["info", "a.toml"],
        &["render", "a.toml", "--size", &long],
        &["render", "a.toml", "--aovs", &long],
        &["render", "a.toml", "--frames", &long],
        &["render", "a.toml", "--set", &long],
        &["render", "a.toml", "--max-memory", &long],
    ] {
        let text = said(&folder.run(arguments));
        let longest = text.lines().map(|line| line.chars().count()).max();
        assert!(
            longest.unwrap() <= 2100,
            "{:?}: {longest:?}",
            &arguments[..2]
        );
    }
}

#[test]
fn no_pipe_is_waited_for() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    for extension in ["png", "exr", "npz", "npy"] {
        let name = format!("pipe.{extension}");
        let made = Command::new("mkfifo").arg(folder.path(&name)).status();
        if !made.is_ok_and(|status| status.success()) {
            crate::common::skipped::skipped("there is no mkfifo");
            return;
        }
        check_not_waited_for(&folder, &["compare", &name, &name]);
    }
    let made = Command::new("mkfifo")
        .arg(folder.path("pipe.toml"))
        .status();
    assert!(made.unwrap().success());
    for command in ["render", "plan", "diagram", "info", "export"] {
        check_not_waited_for(&folder, &[command, "pipe.toml"]);
    }
}

/// The command ends with exit code 2 in seconds.
fn check_not_waited_for(folder: &Folder, arguments: &[&str]) {
    let mut child = folder
        .program(arguments)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begin = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begin.elapsed() > Duration::from_secs(20) {
            child.kill().unwrap();
            panic!("{arguments:?} waits");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(child.wait().unwrap().code(), Some(2), "{arguments:?}");
}

#[test]
fn an_output_that_is_a_link_to_nothing_is_refused_before_anything_is_rendered() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    for [option, name] in [
        ["-o", "l.png"],
        ["--isochrones", "l.png"],
        ["--overlay", "l.svg"],
        ["--stats-json", "l.json"],
    ] {
        symlink("elsewhere/a", folder.path(name)).unwrap();
        let mut render = vec!["render", "a.toml", option, name];
        if option != "-o" {
            render.extend(["-o", "a.png"]);
        }
        let text = folder.fail(&render);
        assert!(text.contains("a link to elsewhere/a"), "{option}: {text}");
        assert!(folder.path(name).symlink_metadata().unwrap().is_symlink());
        // Nothing that comes before it was written.
        assert!(!folder.path("a.png").exists(), "{option}");
        std::fs::remove_file(folder.path(name)).unwrap();
    }
    symlink("elsewhere", folder.path("page")).unwrap();
    let text = folder.fail(&["page", "a.toml", "-o", "page"]);
    assert!(
        text.contains("-o page: this is a link to elsewhere"),
        "{text}"
    );
}

#[test]
fn a_study_overwrites_no_file_of_its_scene() {
    let folder = Folder::new();
    let lamp = "spectrum = { table = \"lamp.csv\" }\n[radiance]\nquantity = \"rgb\"\n";
    folder.write("a.toml", format!("{SCENE}{lamp}"));
    folder.write("lamp.csv", "400,1\n700,1\n");
    let text = folder.fail(&["study", "a.toml", "-o", "lamp.csv"]);
    assert!(text.contains("overwritten"), "{text}");
    assert_eq!(folder.files(&["a.toml"])["lamp.csv"], b"400,1\n700,1\n");
}

#[test]
fn words_and_grids_that_no_page_has_room_for_are_refused_at_once() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    let words = "a".repeat(100_000);
    let text = folder.fail(&["render", "a.toml", "-o", "a.png", "--caption", &words]);
    assert!(text.contains("100000 characters"), "{text}");
    // A product of 2³².
    let text = folder.fail(&["page", "a.toml", "-o", "page", "--grid", "65536x65536"]);
    assert!(text.contains("more than 400 pixels"), "{text}");
}

/// A triangle whose buffer is the file at `uri`.
fn triangle(uri: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "buffers": [{{"uri": "{uri}", "byteLength": 36}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}]}}"#
    )
}

#[test]
fn gltf_files_reach_no_file_outside_unless_that_is_allowed() {
    let folder = Folder::new();
    for name in ["scene", "scene/models", "outside"] {
        std::fs::create_dir(folder.path(name)).unwrap();
    }
    let corners: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let buffer: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    for name in ["outside/a.bin", "scene/a.bin", "scene/models/a.bin"] {
        folder.write(name, &buffer);
    }
    symlink("../../outside/a.bin", folder.path("scene/models/link.bin")).unwrap();
    let scene = SCENE.replace(
        "shape = { box = { size = [1, 1, 1] } }",
        "gltf = \"models/a.gltf\"",
    );
    folder.write("scene/a.toml", scene);
    let render = ["render", "scene/a.toml", "-o", "a.png"];
    for uri in ["a.bin", "../a.bin", "./../models/a.bin"] {
        folder.write("scene/models/a.gltf", triangle(uri));
        folder.succeed(&render);
    }
    for uri in [
        "../../outside/a.bin",
        "link.bin",
        "%2e%2e/%2e%2e/outside/a.bin",
    ] {
        folder.write("scene/models/a.gltf", triangle(uri));
        let text = folder.fail(&render);
        assert!(
            text.contains("outside its folder") && text.contains("--allow-outside"),
            "{text}"
        );
        folder.succeed(&[&render[..], &["--allow-outside"]].concat());
    }
    // A model without a scene has no folder but its own, wherever the program is called.
    let model = [
        "render",
        "scene/models/a.gltf",
        "--size",
        "8x6",
        "-o",
        "a.png",
    ];
    for uri in ["../a.bin", "link.bin"] {
        folder.write("scene/models/a.gltf", triangle(uri));
        assert!(folder.fail(&model).contains("outside its folder"), "{uri}");
        folder.succeed(&[&model[..], &["--allow-outside"]].concat());
    }
    folder.write("scene/models/a.gltf", triangle("a.bin"));
    folder.succeed(&model);
    // A scene that names a model elsewhere has its files, too.
    std::fs::write(folder.path("outside/b.gltf"), triangle("a.bin")).unwrap();
    folder.write(
        "scene/b.toml",
        SCENE.replace(
            "shape = { box = { size = [1, 1, 1] } }",
            "gltf = \"../outside/b.gltf\"",
        ),
    );
    folder.succeed(&["render", "scene/b.toml", "-o", "a.png"]);
}

#[test]
fn more_frames_than_anyone_wants_are_refused_at_once() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    for command in [
        &[
            "diagram",
            "a.toml",
            "--frames",
            "0..4294967295",
            "-o",
            "a-#.svg",
        ][..],
        &[
            "render",
            "a.toml",
            "--frames",
            "0..4294967295",
            "-o",
            "a-#.png",
        ],
    ] {
        let begin = Instant::now();
        let output = folder.run(command);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            said(&output).contains("more than 1000000"),
            "{}",
            said(&output)
        );
        assert!(begin.elapsed() < Duration::from_secs(5));
    }
}

#[test]
fn diagrams_of_thousands_of_events_are_drawn_soon_and_more_are_refused() {
    let folder = Folder::new();
    let events = |count: usize| -> String {
        let event = |i: usize| {
            format!(
                "[[diagram.event]]\nname = \"E{i}\"\nat = [{}, {}]\nlabel = \"E{i}\"\n",
                i % 53,
                i % 47
            )
        };
        (0..count).map(event).collect()
    };
    folder.write("a.toml", events(1500));
    let seconds = processor_seconds(&folder, &["diagram", "a.toml", "-o", "a.svg"]);
    assert!(seconds < 20.0, "{seconds} s");
    folder.write("a.toml", events(5001));
    let text = folder.fail(&["diagram", "a.toml", "-o", "a.svg"]);
    assert!(text.contains("5000"), "{text}");
}

/// How long processors work on a command that succeeds, whatever else they do: as the shell says of its children, user and system time.
fn processor_seconds(folder: &Folder, arguments: &[&str]) -> f64 {
    let output = Command::new("sh")
        .args(["-c", "\"$0\" \"$@\" >/dev/null && times"])
        .arg(env!("CARGO_BIN_EXE_nullray"))
        .args(arguments)
        .current_dir(folder.path("."))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    let children = text.lines().nth(1).unwrap();
    let seconds = |time: &str| -> f64 {
        let (minutes, seconds) = time.trim_end_matches('s').split_once('m').unwrap();
        60.0 * minutes.parse::<f64>().unwrap() + seconds.parse::<f64>().unwrap()
    };
    children.split_whitespace().map(seconds).sum()
}
