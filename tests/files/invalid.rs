//! Every file of tests/data/invalid is refused as its README.md says: with the file, the place in
//! it, what is wrong and what would be right.

use crate::common::png::decode;
use std::collections::BTreeSet;
use std::path::Path;

use crate::ALL;
use nullray::io::cube::{self, Wanted};
use nullray::io::gltf::{self, Want};
use nullray::io::npy;
use nullray::{Error, Result};

const DIRECTORY: &str = "tests/data/invalid";

/// A row of the README's table.
struct Case {
    file: String,
    kind: String,
    place: String,
    what: String,
    help: String,
}

fn cases() -> Vec<Case> {
    let readme = std::fs::read_to_string(format!("{DIRECTORY}/README.md")).unwrap();
    let rows = readme.lines().filter(|line| line.starts_with("| `"));
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [file, kind, place, what, help] = cells[..] else {
            panic!("five cells in {row}");
        };
        let [file, kind, place, what, help] = [file, kind, place, what, help].map(str::to_owned);
        let file = file.trim_matches('`').to_owned();
        Case {
            file,
            kind,
            place,
            what,
            help,
        }
    })
    .collect()
}

/// Imports the file in the way that its case is about.
fn import(file: &str) -> Result<()> {
    let path = Path::new(DIRECTORY).join(file);
    match file.rsplit_once('.').unwrap().1 {
        "npy" | "npz" => cube::load(&path, Wanted::default()).map(drop),
        _ if file.starts_with("camera-") => gltf::camera(&path, None).map(drop),
        _ => gltf::load(&path, None, ALL).map(drop),
    }
}

#[test]
fn every_invalid_file_is_refused_with_its_place_and_a_remedy() {
    let cases = cases();
    assert!(cases.len() > 100, "the table of README.md was read");
    for case in cases {
        let error = import(&case.file).expect_err(&case.file);
        let (kind, problem) = match &error {
            Error::Invalid(problem) => ("invalid", problem),
            Error::Unsupported(problem) => ("unsupported", problem),
            other => panic!("{}: {other}", case.file),
        };
        let help = error.help();
        assert_eq!(kind, case.kind, "{}", case.file);
        assert_eq!(problem.place, case.place, "{}", case.file);
        assert!(problem.file.ends_with(&case.file), "{}", problem.file);
        assert!(
            problem.what.contains(&case.what),
            "{}: {}",
            case.file,
            problem.what
        );
        assert!(help.contains(&*case.help), "{}: {help}", case.file);
        assert!(case.help.len() > 5, "{}: a remedy", case.file);
    }
}

#[test]
fn every_invalid_file_stands_in_the_table() {
    let told: BTreeSet<String> = cases().into_iter().map(|case| case.file).collect();
    let files = std::fs::read_dir(DIRECTORY).unwrap();
    for file in files.map(|file| file.unwrap().file_name().into_string().unwrap()) {
        let elsewhere = file == "README.md" || file == "image-png-truncated.glb";
        assert!(elsewhere || told.contains(&file), "{file}");
    }
}

/// Images are handed on as they are: their decoder finds what is wrong, and knows the place.
#[test]
fn a_truncated_png_is_handed_on_with_its_place_and_does_not_decode() {
    let path = Path::new(DIRECTORY).join("image-png-truncated.glb");
    let imported = gltf::load(&path, None, ALL).unwrap();
    assert_eq!(imported.images[0].place, "image 0 \"bricks\"");
    assert!(decode(&imported.images[0].bytes).is_err());
}

/// Headers tell of everything that is wrong with headers, without any data.
#[test]
fn inspecting_finds_what_is_wrong_with_headers() {
    let needs_data = |file: &str| {
        let data = [
            "index-",
            "vertex-",
            "uv-nan",
            "buffer-",
            "sparse-not",
            "sparse-out",
            "image-",
        ];
        data.iter().any(|start| file.starts_with(start)) && !file.starts_with("buffer-view")
    };
    for case in cases() {
        let path = Path::new(DIRECTORY).join(&case.file);
        let is_gltf = case.file.ends_with(".glb") || case.file.ends_with(".gltf");
        if is_gltf && !case.file.starts_with("camera-") && !needs_data(&case.file) {
            let error = gltf::inspect(&path, None).expect_err(&case.file);
            assert!(error.to_string().contains(&case.what), "{error}");
        }
    }
}

#[test]
fn a_missing_file_is_an_io_error_and_a_directory_is_refused() {
    let missing = Path::new("tests/data/nowhere.glb");
    for error in [
        gltf::load(missing, None, ALL).map(drop).unwrap_err(),
        gltf::inspect(missing, None).map(drop).unwrap_err(),
        cube::load(missing, Wanted::default())
            .map(drop)
            .unwrap_err(),
        npy::inspect(missing, None).map(drop).unwrap_err(),
    ] {
        assert!(
            matches!(&error, Error::Io { path, .. } if path == missing),
            "{error}"
        );
    }
    let folder = Path::new(DIRECTORY);
    let error = gltf::load(folder, None, ALL).map(drop).unwrap_err();
    assert!(error.to_string().contains("not a regular file"), "{error}");
    // A folder may be a sequence of pictures.
    let error = cube::load(folder, Wanted::default()).unwrap_err();
    assert!(
        error.to_string().contains("no numbered pictures"),
        "{error}"
    );
}

#[test]
fn what_is_not_wanted_is_not_read() {
    let load = |file: &str, uvs, textures| {
        gltf::load(
            &Path::new(DIRECTORY).join(file),
            None,
            Want {
                uvs,
                textures,
                ..ALL
            },
        )
    };
    let plain = load("uv-nan.glb", false, false).unwrap();
    assert!(plain.mesh.uvs.is_empty());
    assert!(load("uv-nan.glb", true, false).is_err());
    let plain = load("image-view-missing.glb", true, false).unwrap();
    assert!(plain.images.is_empty() && plain.mesh.materials[0].base_colour_texture.is_none());
    assert!(load("image-view-missing.glb", true, true).is_err());
    let plain = load("texture-without-image.glb", false, false).unwrap();
    assert!(plain.mesh.materials[0].base_colour_texture.is_none());
}
