//! Scenes with panels in `render`, `plan` and `info`.

use nullray::io::image::{exr, png};
use serde_json::Value;

use super::film::WALL;
use super::refused::refused;
use super::{Folder, SMALL, repository};

/// Panels for `SMALL`.
pub const PANELS: &str = r#"
[sheet]
title = "A crate passes by"
columns = 2
[[panel]]
name = "beta-0.9"
label = "β = 0.9"
set = { "camera.velocity.beta" = [0, 0, -0.9] }
[[panel]]
name = "later"
set = { camera.time = "1 m", object.crate.colour = [1, 0, 0] }
[[panel]]
name = "times"
show = "isochrones"
"#;

/// A folder with `figure.toml`.
pub fn folder() -> Folder {
    let folder = Folder::empty();
    folder.write("figure.toml", format!("{SMALL}{PANELS}"));
    folder
}

fn entry(folder: &Folder, name: &str, key: &str) -> String {
    let text = png::inspect(&folder.path(name)).unwrap().text;
    text.into_iter().find(|(k, _)| k == key).unwrap().1
}

#[test]
fn every_panel_is_a_file_of_its_own() {
    let folder = folder();
    folder.ok(&["render", "figure.toml", "-o", "fig.png", "-o", "fig.exr"]);
    assert_eq!(
        folder.names(),
        [
            "fig-beta-0.9.exr",
            "fig-beta-0.9.png",
            "fig-later.exr",
            "fig-later.png",
            "fig-times.exr",
            "fig-times.png",
            "figure.toml"
        ]
    );
    assert_eq!(entry(&folder, "fig-later.png", "camera_time"), "1");
    let rapidity = entry(&folder, "fig-beta-0.9.png", "camera_rapidity");
    // atanh 0.9
    assert!(rapidity.ends_with("-1.4722194895832204"), "{rapidity}");
}

#[test]
fn without_o_panels_have_the_scenes_name_and_their_own() {
    let folder = folder();
    folder.ok(&["render", "figure.toml", "--spp", "1"]);
    let [a, b, c] = ["beta-0.9", "later", "times"].map(|name| format!("figure-{name}.png"));
    assert_eq!(folder.names(), [a, b, c, "figure.toml".into()]);
}

#[test]
fn a_panel_shows_what_its_changes_on_the_command_line_would() {
    let folder = folder();
    folder.write("plain.toml", SMALL);
    folder.ok(&["render", "figure.toml", "-o", "fig.exr", "--aovs", "object"]);
    let set = ["--set", "object.crate.colour=[1,0,0]", "--time", "1 m"];
    let plain = [
        "render",
        "plain.toml",
        "-o",
        "plain.exr",
        "--aovs",
        "object",
    ];
    folder.ok(&[&plain[..], &set].concat());
    let read = |name: &str| {
        exr::read(&folder.path(name), &Default::default())
            .unwrap()
            .channels
    };
    assert!(read("fig-later.exr") == read("plain.exr"));
    assert!(read("fig-beta-0.9.exr") != read("plain.exr"));
}

#[test]
fn the_scene_in_the_metadata_is_that_of_the_panel_alone() {
    let folder = folder();
    folder.ok(&["render", "figure.toml", "--panel", "later", "-o", "a.exr"]);
    let layers = exr::read(&folder.path("a.exr"), &Default::default()).unwrap();
    let text = layers
        .metadata
        .iter()
        .find(|e| e.0 == "scene_text")
        .unwrap();
    assert!(
        !text.1.contains("panel") && !text.1.contains("sheet"),
        "{}",
        text.1
    );
    folder.write("again.toml", &text.1);
    folder.ok(&["render", "again.toml", "-o", "b.exr"]);
    let again = exr::read(&folder.path("b.exr"), &Default::default()).unwrap();
    assert_eq!(again.channels, layers.channels);
}

#[test]
fn the_command_line_comes_after_the_panel() {
    let folder = folder();
    folder.ok(&[
        "render",
        "figure.toml",
        "--panel",
        "later",
        "--time",
        "2 m",
        "-o",
        "a.png",
    ]);
    assert_eq!(entry(&folder, "a.png", "camera_time"), "2");
    // Not even a contradiction with the scene: --white takes the place of what the panel says.
    let exposed = PANELS.replace("camera.time = \"1 m\"", "display.exposure = \"50 %\"");
    folder.write("figure.toml", format!("{SMALL}{exposed}"));
    let said = folder.ok(&[
        "render",
        "figure.toml",
        "--panel",
        "later",
        "--white",
        "2",
        "-o",
        "a.png",
    ]);
    assert!(said.contains("white is radiance 2.0000"), "{said}");
}

#[test]
fn panels_can_be_picked_and_one_has_the_name_that_is_given() {
    let folder = folder();
    folder.ok(&["render", "figure.toml", "--panel", "later", "-o", "a.png"]);
    assert_eq!(folder.names(), ["a.png", "figure.toml"]);
    folder.ok(&["render", "figure.toml", "--panel", "later"]);
    assert_eq!(folder.names(), ["a.png", "figure-later.png", "figure.toml"]);
    let two = ["--panel", "times", "--panel", "later", "-o", "b.png"];
    folder.ok(&[&["render", "figure.toml"], &two[..]].concat());
    assert_eq!(
        folder.names(),
        [
            "a.png",
            "b-later.png",
            "b-times.png",
            "figure-later.png",
            "figure.toml"
        ]
    );
}

#[test]
fn a_panel_of_isochrones_is_the_picture_of_retarded_times() {
    let folder = folder();
    folder.ok(&["render", "figure.toml", "--panel", "times", "-o", "a.png"]);
    folder.write("plain.toml", SMALL);
    folder.ok(&[
        "render",
        "plain.toml",
        "-o",
        "plain.png",
        "--isochrones",
        "b.png",
    ]);
    let size = |name: &str| {
        let picture = png::inspect(&folder.path(name)).unwrap();
        [picture.width, picture.height]
    };
    assert_eq!(size("a.png"), size("b.png"));
    assert_ne!(size("a.png"), [32, 24]);
}

#[test]
fn names_of_panels_that_do_not_exist_are_refused() {
    let folder = folder();
    folder.write("plain.toml", SMALL);
    for command in ["render", "plan"] {
        let parts = ["--panel late", "beta-0.9, later, times"];
        refused(
            &folder,
            &[command, "figure.toml", "--panel", "late"],
            &parts,
        );
        let parts = ["--panel later", "has no panels"];
        refused(
            &folder,
            &[command, "plain.toml", "--panel", "later"],
            &parts,
        );
    }
}

#[test]
fn panels_and_frames_are_refused_together() {
    let folder = folder();
    let frames = [
        "render",
        "figure.toml",
        "--frames",
        "0..2",
        "--interval",
        "1 m",
    ];
    refused(&folder, &frames, &["--frames", "has panels"]);
    refused(
        &folder,
        &[&frames[..], &["--panel", "later"]].concat(),
        &["has panels"],
    );
}

#[test]
fn files_of_panels_that_meet_are_refused() {
    let folder = folder();
    let scene = SMALL.to_string() + "[[panel]]\nname = \"b\"\n[[panel]]\nname = \"a-b\"\n";
    folder.write("figure.toml", scene);
    let arguments = ["render", "figure.toml", "-o", "x.png", "-o", "x-a.png"];
    refused(&folder, &arguments, &["x-a-b.png", "two outputs"]);
}

#[test]
fn a_broken_file_of_a_later_panel_is_found_before_the_first_is_rendered() {
    let folder = folder();
    // A number of a corner is none.
    let whole = std::fs::read(repository("scenes/gallery/die.glb")).unwrap();
    let json = u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    let mut broken = whole.clone();
    let numbers = 20 + json + 8;
    broken[numbers..numbers + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    folder.write("whole.glb", whole);
    folder.write("broken.glb", broken);
    let model = "\n[[object]]\nname = \"die\"\ngltf = \"whole.glb\"\n";
    let panels = "[[panel]]\nname = \"a\"\n[[panel]]\nname = \"b\"\nset = { object.die.gltf = \"broken.glb\" }\n";
    folder.write("figure.toml", format!("{SMALL}{model}{panels}"));
    let before = folder.names();
    refused(&folder, &["render", "figure.toml"], &["broken.glb"]);
    assert_eq!(folder.names(), before);
    // A page of both neither.
    refused(&folder, &["sheet", "figure.toml"], &["broken.glb"]);
    assert_eq!(folder.names(), before);
}

#[test]
fn what_is_wrong_with_a_panel_is_refused_at_its_place_before_any_is_rendered() {
    let folder = folder();
    let cases = [
        (
            "camera.time = \"1 m\"",
            "camera.tim = \"1 m\"",
            "panel[1].set: panel \"later\": `camera.tim`: unknown key",
            "`time`",
        ),
        (
            "camera.time = \"1 m\"",
            "camera.time = 1",
            "panel[1].set: panel \"later\": `camera.time`: the number 1 has no unit",
            "",
        ),
        (
            "object.crate.colour",
            "object.cart.colour",
            "panel[1].set: panel \"later\": there is no object \"cart\"",
            "\"crate\"",
        ),
        (
            "[0, 0, -0.9]",
            "[0, 0, -1.9]",
            "panel[0].set: panel \"beta-0.9\": `camera.velocity.beta`",
            "below 1",
        ),
        (
            "camera.time = \"1 m\"",
            "sheet.columns = 3",
            "panel[1].set: \"sheet.columns\" is not part",
            "",
        ),
        (
            "\"later\"",
            "\"la/ter\"",
            "panel[1].name: \"la/ter\" cannot be part of a file's name",
            "",
        ),
        (
            "\"later\"",
            "\"Beta-0.9\"",
            "panel[1].name: another panel is also named \"Beta-0.9\"",
            "",
        ),
        ("\"later\"", "\"\"", "panel[1].name: the name is empty", ""),
        (
            "\"isochrones\"",
            "\"isochrone\"",
            "panel[2].show: isochrone is not one of",
            "did you mean \"isochrones\"?",
        ),
        (
            "columns = 2",
            "columns = 0",
            "sheet.columns: 0 panels side by side",
            "",
        ),
        (
            "columns = 2",
            "rows = 2",
            "sheet.rows: unknown key",
            "columns",
        ),
        (
            "label = ",
            "lable = ",
            "panel[0].lable: unknown key",
            "`label`",
        ),
        (
            "set = { camera.time = \"1 m\"",
            "set = 3 #",
            "panel[1].set: invalid type",
            "dotted keys",
        ),
    ];
    for (good, bad, what, help) in cases {
        assert!(PANELS.contains(good), "{good}");
        folder.write(
            "figure.toml",
            format!("{SMALL}{}", PANELS.replace(good, bad)),
        );
        for command in ["render", "sheet"] {
            refused(
                &folder,
                &[command, "figure.toml"],
                &["figure.toml", what, help],
            );
        }
    }
}

#[test]
fn what_is_wrong_on_the_command_line_is_not_blamed_on_a_panel() {
    let folder = folder();
    let arguments = [
        "render",
        "figure.toml",
        "--set",
        "object.crate.velocity.beta=[2,0,0]",
    ];
    refused(&folder, &arguments, &["object[1].velocity.beta", "--set"]);
}

#[test]
fn the_plan_is_that_of_the_scene_or_of_a_panel() {
    let folder = folder();
    let plan = |options: &[&str]| -> Value {
        let text = folder.ok(&[&["plan", "figure.toml", "--json"], options].concat());
        serde_json::from_str(&text).unwrap()
    };
    assert_eq!(plan(&[])["view"], "moving");
    let still = PANELS.replace("[0, 0, -0.9]", "[0, 0, 0]");
    folder.write("figure.toml", format!("{SMALL}{still}"));
    assert_eq!(plan(&["--panel", "beta-0.9"])["view"], "still");
    assert_eq!(plan(&[])["view"], "moving");
}

#[test]
fn info_lists_the_panels() {
    let folder = folder();
    let text = folder.ok(&["info", "figure.toml"]);
    assert!(
        text.contains("panels      3: beta-0.9, later, times\n"),
        "{text}"
    );
    let json: Value = serde_json::from_str(&folder.ok(&["info", "figure.toml", "--json"])).unwrap();
    assert_eq!(json["panels"][1], "later");
}

#[test]
fn a_panel_that_cannot_be_made_is_refused_before_any_is_rendered() {
    let folder = Folder::empty();
    let two = |set: &str| {
        format!("{SMALL}[[panel]]\nname = \"a\"\n[[panel]]\nname = \"b\"\nset = {{ {set} }}\n")
    };
    for (set, options, words) in [
        ("display.caption = \"\\u4e00\"", &[][..], "no character"),
        (
            "display.caption = \"\\u4e00\"",
            &["--passes", "2"],
            "no character",
        ),
        // Of rasterizers: a shutter that is open for a while.
        (
            "camera.shutter = { duration = \"1 m\" }",
            &["--method", "raster:none"],
            "shutter",
        ),
        (
            "camera.size = [4000, 4000]",
            &["--max-memory", "1100MiB", "--passes", "2"],
            "memory",
        ),
    ] {
        folder.write("figure.toml", two(set));
        let arguments = [&["render", "figure.toml", "-o", "f.png"], options].concat();
        refused(&folder, &arguments, &[words]);
        assert_eq!(folder.names(), ["figure.toml"], "{set}");
    }
}

#[test]
fn a_panel_has_a_caption_of_its_own() {
    let folder = Folder::empty();
    let panels = "[[panel]]\nname = \"a\"\n[[panel]]\nname = \"b\"\nset = { display.caption = \"its own words\" }\n";
    folder.write("figure.toml", format!("{SMALL}{panels}"));
    folder.ok(&["render", "figure.toml", "-o", "f.png"]);
    let of_panel = folder.read("f-b.png");
    let set = ["--set", "display.caption=\"its own words\""];
    let alone = [
        &["render", "figure.toml", "--panel", "a", "-o", "g.png"],
        &set[..],
    ]
    .concat();
    folder.ok(&alone);
    let height = |bytes: &[u8]| u32::from_be_bytes(bytes[20..24].try_into().unwrap());
    assert_eq!(height(&of_panel), height(&folder.read("g.png")));
    assert!(height(&of_panel) > height(&folder.read("f-a.png")));
}

#[test]
fn panels_share_one_exposure_but_for_those_that_set_their_own() {
    let folder = Folder::empty();
    // D⁴ = 1 and 16: white is 8.
    let speed = |beta: f64| format!("\"camera.velocity.beta\" = [0, 0, -{beta}]");
    let panel =
        |name: &str, set: &str| format!("[[panel]]\nname = \"{name}\"\nset = {{ {set} }}\n");
    let fast = speed(0.6) + ", \"display.white\" = 3.0";
    let text = [
        WALL,
        &panel("rest", &speed(0.0)),
        &panel("fast", &speed(0.6)),
        &panel("own", &fast),
    ];
    folder.write("wall.toml", text.concat());
    let whites = |more: &[&str]| {
        let render = ["render", "wall.toml", "--pixel-centers", "-o", "a.png"];
        folder.ok(&[&render[..], more].concat());
        ["rest", "fast", "own"].map(|name| {
            let white = entry(&folder, &format!("a-{name}.png"), "white");
            white.parse::<f64>().unwrap()
        })
    };
    let near = |found: [f64; 3], expected: [f64; 3]| {
        let mut both = found.iter().zip(expected);
        assert!(both.all(|(a, b)| (a / b - 1.0).abs() < 0.01), "{found:?}");
    };
    near(whites(&[]), [8.0, 8.0, 3.0]);
    near(whites(&["--own-exposure"]), [0.5, 8.0, 3.0]);
    // Over 30 apart, they share a logarithmic scale.
    folder.write("wall.toml", text.concat().replace("-0.6", "-0.9"));
    folder.ok(&["render", "wall.toml", "-o", "b.png"]);
    let [rest, fast] = ["b-rest.png", "b-fast.png"].map(|name| entry(&folder, name, "logarithmic"));
    assert_eq!(rest, fast);
    let ends: Vec<f64> = rest.split(' ').map(|end| end.parse().unwrap()).collect();
    assert!(
        (ends[0] / 0.005 - 1.0).abs() < 0.01 && (ends[1] / 180.5 - 1.0).abs() < 0.01,
        "{rest}"
    );
}
