//! `diagram --pixel`.

use serde_json::Value;

use super::Folder;
use super::refused::refused;

#[test]
fn the_diagram_of_a_pixel_is_written_in_each_format_and_its_numbers_printed() {
    let folder = Folder::new();
    let command = "diagram scene.toml --pixel 16,20 -o a.svg -o b.pdf -o c.png";
    let said = folder.ok(&command.split(' ').collect::<Vec<_>>());
    assert!(said.contains("meets         \"floor\""), "{said}");
    assert!(said.contains("wrote a.svg"), "{said}");
    assert!(folder.read("b.pdf").starts_with(b"%PDF"));
}

#[test]
fn as_json_nothing_else_is_printed() {
    let folder = Folder::new();
    let said = folder.ok(&[
        "diagram",
        "scene.toml",
        "--pixel",
        "16,20",
        "--json",
        "-o",
        "a.svg",
    ]);
    let json: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(json["pixel"], serde_json::json!([16, 20]));
    assert_eq!(json["surface"]["object"], "floor");
    assert_eq!(json["surface"]["lit_by"][0]["source"], "lamp");
}

#[test]
fn time_size_and_changes_are_those_of_the_picture() {
    let folder = Folder::new();
    let run = |extra: &str| {
        let command = format!("diagram scene.toml --pixel 16,20 --json -o a.svg {extra}");
        let said = folder.ok(&command.split_whitespace().collect::<Vec<_>>());
        serde_json::from_str::<Value>(&said).unwrap()
    };
    assert_eq!(run("--time 2m")["reception_proper_time"], 2.0);
    assert_eq!(
        run("--set camera.velocity.beta=[0,0,0]")["camera_beta"][2],
        0.0
    );
    assert_ne!(
        run("--image-size 320x240")["direction"],
        run("")["direction"]
    );
}

#[test]
fn a_pixel_can_be_drawn_in_two_dimensions_of_space_and_in_the_frame_of_the_object() {
    let folder = Folder::new();
    let command = "diagram scene.toml --pixel 16,20 --dimensions 2+1 --frame floor -q -o a.svg";
    assert_eq!(folder.ok(&command.split(' ').collect::<Vec<_>>()), "");
}

#[test]
fn a_panel_is_drawn_as_it_is_rendered() {
    let folder = Folder::new();
    let panels = "[[panel]]\nname = \"late\"\nset = { \"camera.time\" = \"1 m\" }\n";
    let text = String::from_utf8(folder.read("scene.toml")).unwrap() + panels;
    folder.write("scene.toml", text);
    let command = "diagram scene.toml --pixel 16,20 --panel late --json -o a.svg";
    let said = folder.ok(&command.split(' ').collect::<Vec<_>>());
    let json: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(json["reception_proper_time"], 1.0);
    folder.ok(&["diagram", "scene.toml", "--panel", "late", "-o", "b.svg"]);
}

#[test]
fn pixels_that_cannot_be_traced_are_refused() {
    let folder = Folder::new();
    folder.write(
        "figure.toml",
        "[diagram]\nevent = [{ name = \"A\", at = [0, 0] }]\n",
    );
    let cases: &[(&str, &[&str])] = &[
        (
            "scene.toml --pixel 32,0",
            &["pixel 32,0", "32 × 24", "0 to 31"],
        ),
        ("scene.toml --pixel 1.5,0", &["--pixel", "whole numbers"]),
        ("scene.toml --pixel -1,0", &["--pixel", "whole numbers"]),
        ("scene.toml --json", &["--pixel"]),
        ("scene.toml --image-size 3x3", &["--pixel"]),
        (
            "scene.toml --pixel 1,1 --frame moon",
            &["--frame moon", "world", "camera"],
        ),
        ("scene.toml --dimensions 3+1", &["3+1", "2+1"]),
        (
            "scene.toml --pixel 1,1 --panel moon",
            &["--panel moon", "no panels"],
        ),
        ("figure.toml --pixel 1,1", &["camera"]),
    ];
    for (options, parts) in cases {
        let mut arguments = vec!["diagram"];
        arguments.extend(options.split(' '));
        refused(&folder, &arguments, parts);
    }
    assert_eq!(folder.names(), ["figure.toml", "scene.toml"]);
}

#[test]
fn the_origin_at_an_object_is_refused_where_none_is_seen() {
    let folder = Folder::new();
    let command = "diagram scene.toml --pixel 0,0 --origin object -o a.svg";
    let command: Vec<&str> = command.split(' ').collect();
    refused(
        &folder,
        &command,
        &["--origin object", "nothing is visible in pixel 0,0"],
    );
}
