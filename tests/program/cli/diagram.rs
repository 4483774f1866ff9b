//! `nullray diagram`.

use super::refused::refused;
use super::{Folder, repository};

const TWINS: &str = r#"
[diagram]
title = "Twins"
frame = [{ name = "out", velocity = 0.8, axes = false }]
worldline = [
    { name = "Alice", through = ["A", "B"] },
    { name = "Bob", through = ["A", "T", "B"], ticks = 1 },
]
event = [
    { name = "A", at = [0, 0] },
    { name = "T", at = [5, 4] },
    { name = "B", at = [10, 0] },
]
"#;

/// With a table that says what moves.
fn moving() -> String {
    format!("{TWINS}[diagram.animation]\nframes = 4\nnow = {{ from = 0, to = 9 }}\n")
}

fn folder(text: &str) -> Folder {
    let folder = Folder::empty();
    folder.write("d.toml", text);
    folder
}

fn words(command: &str) -> Vec<&str> {
    command.split(' ').collect()
}

/// Frames of an animated PNG: the number in its `acTL` chunk.
fn frame_count(file: &[u8]) -> u32 {
    let at = file.windows(4).position(|w| w == b"acTL").unwrap() + 4;
    u32::from_be_bytes(file[at..at + 4].try_into().unwrap())
}

#[test]
fn a_diagram_is_written_in_each_format_that_is_asked_for() {
    let folder = folder(TWINS);
    let said = folder.ok(&words("diagram d.toml -o a.svg -o b.pdf -o c.png"));
    assert_eq!(folder.names(), ["a.svg", "b.pdf", "c.png", "d.toml"]);
    assert!(folder.read("a.svg").starts_with(b"<svg"));
    assert!(folder.read("b.pdf").starts_with(b"%PDF"));
    assert!(folder.read("c.png").starts_with(b"\x89PNG"));
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines.len(), 3, "{said}");
    for (line, name) in lines.iter().zip(["a.svg", "b.pdf", "c.png"]) {
        assert!(line.starts_with(&format!("wrote {name} (340 × ")), "{line}");
        assert!(line.ends_with(" points)"), "{line}");
    }
}

#[test]
fn without_a_name_it_is_an_svg_named_after_the_file() {
    let folder = folder(TWINS);
    folder.ok(&["diagram", "d.toml"]);
    assert_eq!(folder.names(), ["d.svg", "d.toml"]);
}

#[test]
fn quiet_is_quiet() {
    assert_eq!(folder(TWINS).ok(&words("diagram d.toml -q -o a.svg")), "");
}

#[test]
fn files_say_what_they_were_made_of() {
    let folder = folder(TWINS);
    folder.ok(&words("diagram d.toml -o a.svg -o b.pdf -o c.png"));
    for name in ["a.svg", "b.pdf", "c.png"] {
        let file = folder.read(name);
        // PDF holds texts of several lines in hexadecimal digits.
        let text = if name == "b.pdf" {
            "scene_text"
        } else {
            "worldline = ["
        };
        for part in ["nullray ", "scene_sha256", text] {
            let found = file.windows(part.len()).any(|w| w == part.as_bytes());
            assert!(found, "{name}: {part}");
        }
    }
}

#[test]
fn a_frame_of_the_command_line_is_that_of_the_view() {
    let folder = folder(TWINS);
    folder.ok(&words("diagram d.toml -q -o a.svg --frame out"));
    folder.ok(&words(
        "diagram d.toml -q -o b.svg --set diagram.view=\"out\"",
    ));
    folder.ok(&words("diagram d.toml -q -o c.svg"));
    // But for the text that they name as their own.
    let body = |name: &str| {
        let text = String::from_utf8(folder.read(name)).unwrap();
        text.split_once("</metadata>").unwrap().1.to_string()
    };
    assert_eq!(body("a.svg"), body("b.svg"));
    assert_ne!(body("a.svg"), body("c.svg"));
}

#[test]
fn a_scene_is_drawn_in_the_frame_of_its_camera() {
    let folder = Folder::new();
    folder.ok(&words("diagram scene.toml -q -o world.svg"));
    folder.ok(&words("diagram scene.toml -q -o camera.svg --frame camera"));
    assert_ne!(folder.read("world.svg"), folder.read("camera.svg"));
}

#[test]
fn no_mesh_and_no_cube_is_read() {
    let folder = Folder::empty();
    folder.write(
        "scene.toml",
        r#"
camera = { eye = [0, 0, 5], look_at = [0, 0, 0], velocity = { beta = [0, 0, -0.5] } }
[[object]]
name = "missing"
gltf = "nowhere/missing.glb"
[[source]]
objects = ["missing"]
cube = { file = "nowhere/missing.npz", start = "0 m", bin_width = "1 m", clock = "world", uv = 0 }
"#,
    );
    folder.ok(&words("diagram scene.toml -q -o a.svg"));
    let text = String::from_utf8(folder.read("a.svg")).unwrap();
    assert!(text.contains("missing"));
}

#[test]
fn frames_are_numbered_pictures() {
    let folder = folder(&moving());
    let said = folder.ok(&words(
        "diagram d.toml -o a-##.svg -o b.png --scale 1 --frames 1..3",
    ));
    let names = ["a-01.svg", "a-02.svg", "b-0001.png", "b-0002.png", "d.toml"];
    assert_eq!(folder.names(), names);
    assert_eq!(said.lines().count(), 4, "{said}");
    assert_ne!(folder.read("a-01.svg"), folder.read("a-02.svg"));
}

#[test]
fn a_picture_does_not_depend_on_which_others_are_asked_for() {
    let folder = folder(&moving());
    folder.ok(&words("diagram d.toml -q -o a.svg --frames 0..4"));
    folder.ok(&words("diagram d.toml -q -o b.svg --frames 2..3"));
    assert_eq!(folder.read("a-0002.svg"), folder.read("b-0002.svg"));
}

#[test]
fn an_animated_file_has_all_pictures_or_those_asked_for() {
    let folder = folder(&moving());
    let said = folder.ok(&words("diagram d.toml -o a.apng -o still.svg --scale 0.5"));
    assert!(said.contains("wrote a.apng (340 × "), "{said}");
    assert!(said.contains(" points, 4 pictures)"), "{said}");
    assert_eq!(folder.names(), ["a.apng", "d.toml", "still.svg"]);
    assert_eq!(frame_count(&folder.read("a.apng")), 4);
    folder.ok(&words(
        "diagram d.toml -q -o b.apng --scale 0.5 --frames 1..3",
    ));
    assert_eq!(frame_count(&folder.read("b.apng")), 2);
}

#[test]
fn a_boost_of_the_command_line_needs_no_table() {
    let folder = folder(TWINS);
    folder.ok(&words(
        "diagram d.toml -q -o a.svg --boost-to out --frames 0..49",
    ));
    assert_eq!(folder.names().len(), 50);
}

#[test]
fn what_is_asked_for_wrongly_is_refused() {
    let folder = folder(TWINS);
    folder.write("moving.toml", moving());
    let cases: &[(&str, &[&str])] = &[
        (
            "d.toml -o a.jpg",
            &["-o a.jpg", "drawings as .jpg", ".svg, .pdf, .png"],
        ),
        ("d.toml -o a.svg -o a.svg", &["-o a.svg", "two outputs"]),
        ("d.toml -o nowhere/a.svg", &["nowhere"]),
        (
            "moving.toml --fps 5 -o a.svg",
            &["--play-fps", "none of these files is one"],
        ),
        ("d.toml --frame there", &["no frame \"there\"", "\"out\""]),
        (
            "d.toml --boost-to there -o a.apng",
            &["no frame \"there\"", "\"out\""],
        ),
        (
            "d.toml --frames 0..2",
            &["--frames 0..2", "no animation", "--boost-to"],
        ),
        (
            "d.toml --boost-to out -o a.svg",
            &[
                "--boost-to out",
                "a single picture",
                "FILE.apng",
                "--frames",
            ],
        ),
        (
            "d.toml --boost-to there -o a.apng",
            &["Set by `--boost-to there`"],
        ),
        (
            "d.toml --frame nobody",
            &[
                "no frame \"nobody\"",
                "Set by `--frame nobody` on the command line",
            ],
        ),
        (
            "d.toml -o a.apng",
            &["FILE.apng", "no animation", "--boost-to"],
        ),
        (
            "moving.toml --frames 3..5",
            &["--frames 3..5", "4 pictures", "0..4"],
        ),
        ("d.toml --scale 0 -o a.png", &["--scale", "0.1 to 100"]),
        ("d.toml --size 0x3", &["--size", "above 0"]),
        ("missing.toml", &["missing.toml"]),
    ];
    for (options, parts) in cases {
        let mut arguments = vec!["diagram"];
        arguments.extend(options.split(' '));
        refused(&folder, &arguments, parts);
    }
}

#[test]
fn mistakes_are_shown_at_their_place_and_nothing_is_written() {
    let folder = Folder::empty();
    let cases: &[(&str, &[&str])] = &[
        (
            "interval = [{ from = \"A\", to = \"B\" }]",
            &["d.toml", "diagram.interval[0].from", "no event \"A\""],
        ),
        (
            "event = [{ name = \"A\", at = [0, 0], label = \"\\u5149\" }]",
            &["diagram.event[0].label", "'光' (U+5149)"],
        ),
        (
            "title = \"\\u5149\"\nevent = [{ name = \"A\", at = [0, 0] }]",
            &["diagram.title", "'光' (U+5149)"],
        ),
        (
            "worldline = [{ name = \"\\u5149\" }]",
            &["diagram.worldline[0].name", "'光' (U+5149)"],
        ),
        (
            "worldline = [{ name = \"w\", through = [[0, 0], [1, 2]] }]",
            &["diagram.worldline[0].through[1]", "light cone"],
        ),
        (
            "x = [50, 60]\nevent = [{ name = \"A\", at = [0, 0] }]",
            &["diagram.x", "nothing"],
        ),
    ];
    for (body, parts) in cases {
        folder.write("d.toml", format!("[diagram]\n{body}\n"));
        refused(
            &folder,
            &words("diagram d.toml -o a.svg -o b.pdf -o c.png"),
            parts,
        );
    }
}

#[test]
fn a_directory_in_the_way_of_the_last_file_is_no_panic() {
    let folder = folder(TWINS);
    std::fs::create_dir(folder.path("b.svg")).unwrap();
    let run = folder.run(&words("diagram d.toml -o b.svg"));
    assert_eq!(run.code, 2, "{}", run.message());
    assert_eq!(folder.names(), ["b.svg", "d.toml"]);
}

#[test]
fn every_scene_of_the_repository_has_a_diagram() {
    let folder = Folder::empty();
    let scenes = [
        "capture.toml",
        "corner.toml",
        "several-velocities.toml",
        "cube/approaching-0.6.toml",
        "effects/all.toml",
        "paper/figure-02.toml",
        "paper/figure-03.toml",
        "paper/figure-05.toml",
        "paper/figure-06.toml",
        "paper/figure-08.toml",
        "paper/figure-09.toml",
        "paper/figure-11.toml",
        "reference.toml",
    ];
    for scene in scenes {
        let path = repository(&format!("scenes/{scene}"));
        folder.ok(&["diagram", &path, "-q", "-o", "a.svg"]);
        folder.ok(&["diagram", &path, "-q", "-o", "a.svg", "--frame", "camera"]);
    }
}

#[test]
fn the_examples_of_help_run_as_they_are_printed() {
    let folder = Folder::new();
    for classic in ["twin-paradox.toml", "length-contraction.toml"] {
        let file = repository(&format!("scenes/diagrams/{classic}"));
        std::fs::copy(file, folder.path(classic)).unwrap();
    }
    folder.write(
        "scene.toml",
        r#"
camera = { eye = [0, 0, 5], look_at = [0, 0, 0], velocity = { beta = [0, 0, -0.5] }, size = [640, 480] }
[[object]]
name = "ball"
shape = { sphere = { radius = 2.0 } }
"#,
    );
    let help = folder.ok(&["help", "diagram"]);
    let examples = help
        .lines()
        .filter_map(|line| line.trim().strip_prefix("nullray diagram "));
    let mut count = 0;
    for example in examples.filter(|example| !example.starts_with('[')) {
        // A shell takes the quotes off, and pipes into other programs.
        let words: Vec<String> = example
            .split(' ')
            .take_while(|word| *word != "|")
            .map(|word| word.replace('"', ""))
            .collect();
        let mut command = vec!["diagram"];
        command.extend(words.iter().map(String::as_str));
        match words.last().is_some_and(|word| word == "-") {
            // Video goes to the other program.
            true => {
                let output = folder.command(&command).output().unwrap();
                assert!(output.status.success() && output.stdout.starts_with(b"YUV4MPEG2 "));
                // Which takes even sizes alone: the page is drawn on 1020 × 1021 pixels.
                assert!(output.stdout.starts_with(b"YUV4MPEG2 W1020 H1022 "));
            }
            false => drop(folder.ok(&command)),
        }
        count += 1;
    }
    assert!(count >= 7, "{count} examples in\n{help}");
    let tikz = String::from_utf8(folder.read("twins.tex")).unwrap();
    assert!(tikz.contains("\\begin{tikzpicture}") && tikz.contains("Alice"));
}
