//! What a file of baked light says of itself, and a scene that reads it.

use serde_json::json;

use super::Folder;
use super::bake::{FLASH, LIGHT, assert_as_bright};

/// The source that a bake of `FLASH` in `LIGHT` for a camera prints.
fn baked_for_camera(folder: &Folder, more: &[&str]) -> String {
    folder.write("lit.toml", FLASH.to_string() + LIGHT);
    let bake = [
        "bake",
        "lit.toml",
        "--camera",
        "--spp=4",
        "--start=2 m",
        "--bin-width=10 cm",
        "--bins=100",
        "-o=cube.npz",
    ];
    let said = folder.ok(&[&bake[..], more].concat());
    said[said.find("[[source]]").unwrap()..].to_string()
}

#[test]
fn a_scene_takes_times_and_clock_from_a_file_that_bake_has_written() {
    let folder = Folder::empty();
    let source = baked_for_camera(&folder, &[]);
    folder.write("all.toml", FLASH.to_string() + &source);
    let keys = [
        "start = \"2 m\", ",
        "bin_width = \"0.1 m\", ",
        "clock = \"capture\", ",
    ];
    let none = keys.iter().fold(source.clone(), |text, key| {
        assert!(text.contains(key), "{text}");
        text.replace(key, "")
    });
    folder.write("none.toml", FLASH.to_string() + &none);
    let info = |scene: &str| -> serde_json::Value {
        serde_json::from_str(&folder.ok(&["info", scene, "--json"])).unwrap()
    };
    let data = info("none.toml");
    let cube = &data["sources"][0]["cube"];
    assert_eq!(cube["start"], 2.0);
    assert_eq!(cube["bin_width"], 0.1);
    assert_eq!(cube["clock"], "capture");
    let read = [
        "bin_width = \"0.1 m\"",
        "start = \"2 m\"",
        "clock = \"capture\"",
    ];
    assert_eq!(cube["read"], json!(read));
    for scene in ["all.toml", "none.toml"] {
        assert_eq!(info(scene)["warnings"], json!([]), "{scene}");
    }
    assert_as_bright(&folder, "all.toml", "none.toml");
    // Times of arrival mean nothing without the camera at which light arrives.
    let at = none.find(", capture = {").unwrap();
    folder.write("flat.toml", FLASH.to_string() + &none[..at] + " }\n");
    let run = folder.run(&["info", "flat.toml"]);
    assert_eq!(run.code, 2);
    let said = run.message();
    assert!(
        said.contains("arrival at the camera") && said.contains("clock = \"world\""),
        "{said}"
    );
}

#[test]
fn where_a_scene_and_a_baked_file_differ_a_warning_names_both() {
    let folder = Folder::empty();
    let photons = [
        "--set",
        "radiance.quantity=\"photons\"",
        "--set",
        "medium.index=1.5",
    ];
    let source = baked_for_camera(&folder, &photons);
    let radiance = "radiance = { quantity = \"photons\" }\n";
    assert!(source.ends_with(radiance), "{source}");
    let said = folder.ok(&["info", "cube.npz"]);
    assert!(said.contains("photons over the whole spectrum"), "{said}");
    assert!(said.contains("refractive index 1.5"), "{said}");
    let medium = "[medium]\nindex = 1.5\n";
    folder.write("right.toml", FLASH.to_string() + medium + &source);
    let wrong = (source.replace(radiance, ""))
        .replace("bin_width = \"0.1 m\"", "bin_width = \"0.2 m\"")
        .replace("start = \"2 m\"", "start = \"0 m\"");
    folder.write("wrong.toml", FLASH.to_string() + &wrong);
    let warnings = [
        "cube.npz says start = \"2 m\", bin_width = \"0.1 m\", but the scene start = \"0 m\", bin_width = \"0.2 m\"",
        "holds radiance as photons over the whole spectrum, but the scene reads it as energy over the whole spectrum",
        "refractive index 1.5, but the scene's index is 1 ",
    ];
    for command in [&["info"][..], &["plan"], &["render", "-o=a.png"]] {
        let run = |scene: &str| {
            let said = folder.ok(&[command, &[scene]].concat());
            // Rows of `info` and `plan` are wrapped.
            said.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        let said = run("wrong.toml");
        for warning in warnings {
            assert!(
                said.contains(warning.trim()),
                "{command:?} {warning}: {said}"
            );
        }
        let said = run("right.toml");
        assert!(!said.contains(", but the scene"), "{command:?}: {said}");
    }
}
