//! `--overlay`.

use super::Folder;
use super::refused::refused;

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
        (
            "--overlay a.svg --frames 0..2",
            &["--overlay", "cannot be used with"],
        ),
    ];
    for (options, parts) in cases {
        let mut arguments = vec!["render", "scene.toml"];
        arguments.extend(options.split(' '));
        refused(&folder, &arguments, parts);
    }
}
