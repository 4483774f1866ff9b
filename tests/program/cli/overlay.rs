//! `--overlay`.

use super::Folder;
use super::refused::refused;
use crate::common::png::decode;

#[test]
fn an_overlay_is_written_in_each_format() {
    let folder = Folder::new();
    let command = "render scene.toml -o a.png --overlay b.png --overlay c.svg --overlay d.pdf";
    let run = folder.run(&command.split(' ').collect::<Vec<_>>());
    assert_eq!(run.code, 0, "{}", run.message());
    assert_eq!(
        folder.names(),
        ["a.png", "b.png", "c.svg", "d.pdf", "scene.toml"]
    );
    assert!(folder.read("b.png").starts_with(b"\x89PNG"));
    assert!(folder.read("c.svg").starts_with(b"<svg"));
    assert!(folder.read("d.pdf").starts_with(b"%PDF"));
    assert!(run.stdout.contains("wrote c.svg (overlay)"));
}

#[test]
fn the_picture_does_not_depend_on_its_overlay() {
    let folder = Folder::new();
    folder.run(&["render", "scene.toml", "-o", "a.png"]);
    folder.run(&["render", "scene.toml", "-o", "b.png", "--overlay", "c.svg"]);
    assert_eq!(folder.read("a.png"), folder.read("b.png"));
}

#[test]
fn overlays_that_cannot_be_drawn_are_refused() {
    let folder = Folder::new();
    let cases: &[(&str, &[&str])] = &[
        ("--overlay a.exr", &["--overlay a.exr", ".svg"]),
        ("--overlay scene.png -o scene.png", &["two outputs"]),
        (
            "--overlay a.svg --overlay-parts outlines,moon",
            &["--overlay-parts", "\"moon\"", "isochrones, outlines"],
        ),
        ("--overlay-parts beta", &["--overlay"]),
    ];
    for (options, parts) in cases {
        let mut arguments = vec!["render", "scene.toml"];
        arguments.extend(options.split(' '));
        refused(&folder, &arguments, parts);
    }
}

#[test]
fn an_overlay_says_where_it_is_from() {
    let folder = Folder::new();
    let command = "render scene.toml -q -o a.png --overlay b.png --overlay c.svg --overlay d.pdf";
    folder.ok(&command.split(' ').collect::<Vec<_>>());
    for name in ["b.png", "c.svg", "d.pdf"] {
        let file = folder.read(name);
        for key in ["scene_sha256", "scene_text", "camera_rapidity"] {
            let found = file.windows(key.len()).any(|w| w == key.as_bytes());
            assert!(found, "{name}: {key}");
        }
    }
}

#[test]
fn overlays_of_a_sequence_are_numbered_and_not_drawn_again() {
    let folder = Folder::new();
    let command = "render scene.toml --white 1 -o a.png --overlay b-##.svg --overlay c.png --overlay d.pdf \
                   --frames 0..2 --interval 1m";
    let command: Vec<&str> = command.split_whitespace().collect();
    folder.ok(&command);
    let names = [
        "a-0000.png",
        "a-0001.png",
        "b-00.svg",
        "b-01.svg",
        "c-0000.png",
        "c-0001.png",
        "d-0000.pdf",
        "d-0001.pdf",
        "scene.toml",
    ];
    assert_eq!(folder.names(), names);
    assert_ne!(folder.read("b-00.svg"), folder.read("b-01.svg"));
    assert!(
        folder
            .ok(&command)
            .contains("0 rendered, 2 existed already")
    );
    folder.write("b-01.svg", "<svg>");
    let again = folder.ok(&command);
    assert!(again.contains("1 rendered, 1 existed already"), "{again}");
}

#[test]
fn the_overlay_of_a_frame_is_that_of_its_moment() {
    let folder = Folder::new();
    let frames =
        "render scene.toml -q --white 1 -o a.png --overlay b.png --frames 1..2 --interval 1m";
    folder.ok(&frames.split(' ').collect::<Vec<_>>());
    let one = "render scene.toml -q --white 1 --time 1m -o a.png --overlay c.png";
    folder.ok(&one.split(' ').collect::<Vec<_>>());
    let pixels = |name| {
        let picture = decode(&std::fs::read(folder.path(name)).unwrap()).unwrap();
        (picture.width, picture.height, picture.rgba)
    };
    assert_eq!(pixels("b-0001.png"), pixels("c.png"));
}
