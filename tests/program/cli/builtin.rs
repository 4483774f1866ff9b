//! The program without arguments: the first minute of a new user.

use std::time::{Duration, Instant};

use super::Folder;

/// The words of a command line, with "…" around those that have spaces or brackets.
fn words(line: &str) -> Vec<String> {
    let parts = line.split('"').enumerate();
    let words = parts.flat_map(|(i, part)| match i % 2 {
        0 => part.split_whitespace().map(String::from).collect(),
        _ => vec![part.to_string()],
    });
    words.collect()
}

#[test]
fn without_arguments_it_renders_and_each_command_that_it_names_works() {
    let folder = Folder::empty();
    let start = Instant::now();
    let said = folder.ok(&[]);
    assert!(
        start.elapsed() < Duration::from_secs(60),
        "{:?}",
        start.elapsed()
    );
    let written = said.lines().filter_map(|line| line.strip_prefix("wrote "));
    let written: Vec<_> = written
        .map(|line| line.split(" (").next().unwrap())
        .collect();
    assert!(written.len() >= 5, "{said}");
    for name in written {
        assert!(name.starts_with("nullray-out/"), "{name}");
        assert!(!folder.read(name).is_empty(), "{name}");
    }
    assert_eq!(folder.names(), ["nullray-out"]);

    let (_, next) = said.split_once("What to try next:\n").unwrap();
    let commands: Vec<_> = next.lines().map(words).collect();
    assert_eq!(commands.len(), 3, "{next}");
    for command in commands {
        assert_eq!(command[0], env!("CARGO_BIN_EXE_nullray"));
        let mut arguments: Vec<_> = command[1..].iter().map(String::as_str).collect();
        if arguments[0] == "render" {
            arguments.extend(["--size", "32x24", "--spp", "1"]);
        }
        let said = folder.ok(&arguments);
        assert_ne!(said, "", "{arguments:?}");
        assert!(!said.contains("is black"), "{arguments:?}: {said}");
    }
    assert_eq!(folder.names(), ["nullray-out", "slower.png"]);

    // What its owner changed stays.
    folder.write("nullray-out/corner.toml", "# mine");
    folder.ok(&[]);
    assert_eq!(folder.read("nullray-out/corner.toml"), b"# mine");
}

#[test]
fn the_built_in_scene_is_the_default_of_render_and_plan() {
    let folder = Folder::empty();
    folder.ok(&["render", "--size", "32x24", "--spp", "1"]);
    assert_eq!(folder.names(), ["nullray.png"]);
    assert!(folder.ok(&["plan"]).starts_with("built-in scene\n"));
}

#[test]
fn a_black_picture_is_explained() {
    let folder = Folder::empty();
    let small = ["render", "--size", "32x24", "--spp", "1"];
    let said = |more: &[&str]| folder.ok(&[&small, more].concat());
    let away = said(&[
        "--set",
        "camera.look_at=[5, 2.3, 9]",
        "--set",
        "camera.velocity={beta=[0,0,0]}",
    ]);
    assert!(
        away.contains("black: no object's front is in view"),
        "{away}"
    );
    let early = said(&["--set", "camera.clock_zero=\"3 m\""]);
    assert!(early.contains("try a later --time"), "{early}");
    let late = said(&["--set", "camera.clock_zero=\"30 m\""]);
    assert!(late.contains("try an earlier --time"), "{late}");
    assert!(!said(&[]).contains("black"));
}
