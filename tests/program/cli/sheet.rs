//! `nullray sheet`.

use std::fs;

use nullray::figures::contact_sheet::{Layout, Panel, SheetOptions};
use nullray::io::image::{RgbImage, png};

use super::panels::{PANELS, folder};
use super::refused::refused;
use super::{Folder, SMALL};

fn size(folder: &Folder, name: &str) -> [u32; 2] {
    let picture = png::inspect(&folder.path(name)).unwrap();
    [picture.width, picture.height]
}

/// The size that the library gives a page of panels of these sizes.
fn expected(panels: &[([u32; 2], &str)], title: Option<&str>, columns: Option<u32>) -> [u32; 2] {
    let panel = |([width, height], label): &([u32; 2], &str)| Panel {
        picture: RgbImage {
            width: *width,
            height: *height,
            rgb: vec![0; (3 * width * height) as usize],
        },
        label: label.to_string(),
        new_row: false,
    };
    let panels: Vec<_> = panels.iter().map(panel).collect();
    let title = title.map(str::to_string);
    Layout::new(&panels, &SheetOptions { title, columns })
        .unwrap()
        .size
}

#[test]
fn a_sheet_has_all_panels_on_one_page() {
    let folder = folder();
    let said = folder.ok(&["sheet", "figure.toml", "--size", "160x120", "--spp", "1"]);
    assert!(said.contains("wrote figure-sheet.png"), "{said}");
    assert_eq!(folder.names(), ["figure-sheet.png", "figure.toml"]);
    folder.ok(&[
        "render",
        "figure.toml",
        "--size",
        "160x120",
        "--panel",
        "times",
        "-o",
        "times.png",
    ]);
    let times = size(&folder, "times.png");
    let panels = [
        ([160, 120], "β = 0.9"),
        ([160, 120], "later"),
        (times, "times"),
    ];
    let page = expected(&panels, Some("A crate passes by"), Some(2));
    assert_eq!(size(&folder, "figure-sheet.png"), page);
}

#[test]
fn panels_are_kept_if_asked_for_and_are_those_that_render_writes() {
    let folder = folder();
    fs::create_dir(folder.path("out")).unwrap();
    folder.ok(&[
        "sheet",
        "figure.toml",
        "-o",
        "out/page.png",
        "--keep-panels",
    ]);
    let names = [
        "figure-beta-0.9.png",
        "figure-later.png",
        "figure-times.png",
    ];
    folder.ok(&["render", "figure.toml"]);
    for name in names {
        assert!(
            folder.read(name) == folder.read(&format!("out/{name}")),
            "{name}"
        );
    }
    assert_eq!(fs::read_dir(folder.path("out")).unwrap().count(), 4);
}

#[test]
fn several_scenes_make_a_page_each_in_a_directory() {
    let folder = folder();
    folder.write("plain.toml", SMALL);
    folder.ok(&[
        "sheet",
        "figure.toml",
        "plain.toml",
        "--directory",
        "new/pages",
        "--quiet",
    ]);
    let mut names: Vec<_> = fs::read_dir(folder.path("new/pages"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    names.sort();
    assert_eq!(names, ["figure-sheet.png", "plain-sheet.png"]);
}

#[test]
fn a_scene_without_panels_is_one_panel_of_its_name() {
    let folder = Folder::new();
    folder.ok(&["sheet", "scene.toml", "--quiet"]);
    let page = expected(&[([32, 24], "scene")], None, None);
    assert_eq!(size(&folder, "scene-sheet.png"), page);
}

#[test]
fn changes_of_the_command_line_apply_to_every_panel_and_to_the_sheet() {
    let folder = folder();
    let picked = [
        "--set",
        "sheet.columns=3",
        "--set",
        "panel.later.label=rather later",
    ];
    folder.ok(&[&["sheet", "figure.toml", "--size", "400x30"], &picked[..]].concat());
    let text = png::inspect(&folder.path("figure-sheet.png")).unwrap().text;
    let labels = text.iter().find(|(key, _)| key == "panels").unwrap();
    assert_eq!(labels.1, "β = 0.9\nrather later\ntimes");
    let [width, _] = size(&folder, "figure-sheet.png");
    assert!(width > 3 * 400, "{width}");
}

#[test]
fn what_cannot_be_done_is_refused_before_anything_is_rendered() {
    let folder = folder();
    folder.write("other.toml", SMALL);
    fs::create_dir(folder.path("below")).unwrap();
    folder.write("below/other.toml", SMALL);
    folder.write("figure.png", "precious");
    let missing = PANELS.replace("β = 0.9", "slow 光");
    folder.write("glyph.toml", format!("{SMALL}{missing}"));
    let cases: &[(&[&str], &[&str])] = &[
        (&[], &["SCENE"]),
        (
            &["figure.toml", "other.toml", "-o", "a.png"],
            &["-o a.png", "2 scenes", "--directory"],
        ),
        (
            &["figure.toml", "-o", "a.png", "--directory", "d"],
            &["--directory", "cannot be used with"],
        ),
        (&["figure.toml", "-o", "a.exr"], &["-o a.exr", ".png"]),
        (&["figure.toml", "-o", "none/a.png"], &["no directory none"]),
        (&["figure.toml", "-o", "figure.toml"], &["-o figure.toml"]),
        (
            &["other.toml", "below/other.toml"],
            &["other-sheet.png", "two outputs"],
        ),
        (&["glyph.toml"], &["'光' (U+5149)"]),
    ];
    for (options, parts) in cases {
        let long = ["sheet", "--spp", "60000", "--size", "4000x4000"];
        refused(&folder, &[&long[..], options].concat(), parts);
    }
    // Two panels side by side are wider than any page, which is known before the first of them is there.
    let before = folder.names();
    let wide = [
        "sheet",
        "figure.toml",
        "--keep-panels",
        "--spp",
        "1",
        "--size",
        "17000x2",
    ];
    refused(&folder, &wide, &["34", "cannot be drawn"]);
    assert_eq!(folder.names(), before);
}
