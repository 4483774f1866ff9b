//! `nullray bake` once more: finished objects are kept, and what a killed run left goes.

use nullray::io::npy::load_metadata;
use nullray::render::journal::Journal;

use super::Folder;
use super::bake::{FLASH, LIGHT};

/// Bakes both objects of [`floor_and_chest`].
const BAKE: [&str; 9] = [
    "bake",
    "lit.toml",
    "--object=floor",
    "--object=chest",
    "--bin-width=1 m",
    "--bins=40",
    "--texels=16x16",
    "--spp=4",
    "-o=a.npz",
];

/// A folder with a scene of a floor and a chest, lit.toml.
fn floor_and_chest() -> Folder {
    let folder = Folder::empty();
    let chest = "[[object]]\nname = \"chest\"\nshape = { box = { size = [1, 1, 1] } }\n";
    folder.write("lit.toml", format!("{FLASH}{chest}{LIGHT}"));
    folder
}

#[test]
fn objects_that_are_done_are_not_baked_again_with_the_others() {
    let folder = floor_and_chest();
    // Whose light a run made, and whose it found.
    let run = |more: &[&str]| {
        let said = folder.ok(&[&BAKE[..], more].concat());
        ["floor", "chest"].map(|name| {
            let is_made = said.contains(&format!("wrote a-{name}.npz"));
            let is_found = said.contains(&format!("a-{name}.npz exists already"));
            assert!(is_made != is_found, "{name}: {said}");
            // How a scene reads it is said in any case.
            assert!(
                said.contains(&format!("name = \"light on {name}\"")),
                "{said}"
            );
            is_made
        })
    };
    assert_eq!(run(&[]), [true, true]);
    let files = || ["a-floor.npz", "a-chest.npz"].map(|name| folder.read(name));
    let whole = files();
    std::fs::remove_file(folder.path("a-chest.npz")).unwrap();
    assert_eq!(run(&["--threads=1"]), [false, true]);
    assert!(files() == whole);
    assert_eq!(run(&[]), [false, false]);
    // A damaged file is not complete, and that of another object, scene or precision is not of this work.
    let mut damaged = whole[0].clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    folder.write("a-floor.npz", damaged);
    assert_eq!(run(&[]), [true, false]);
    folder.write("a-floor.npz", &whole[1]);
    assert_eq!(run(&[]), [true, false]);
    assert!(files() == whole);
    assert_eq!(run(&["--half"]), [true, true]);
    assert_eq!(run(&[]), [true, true]);
    assert_eq!(run(&["--set=render.seed=9"]), [true, true]);
    assert_eq!(folder.names(), ["a-chest.npz", "a-floor.npz", "lit.toml"]);
}

#[test]
fn parts_that_a_killed_bake_left_beside_its_finished_file_go_when_that_is_found() {
    let folder = floor_and_chest();
    folder.ok(&BAKE);
    // Its fingerprint is that of the parts, too.
    let metadata = load_metadata(&folder.path("a-floor.npz")).unwrap();
    let digits = metadata["bake_fingerprint"].as_str().unwrap();
    let byte = |k: usize| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).unwrap();
    let of_floor = std::array::from_fn(byte);
    for (name, fingerprint) in [
        ("a-floor.npz.parts", of_floor),
        ("a-chest.npz.parts", [7; 32]),
    ] {
        let journal = Journal::open(&folder.path(name), &fingerprint).unwrap();
        journal.add(0, b"light").unwrap();
    }
    let said = folder.ok(&BAKE);
    assert!(said.contains("a-floor.npz exists already"), "{said}");
    // Parts of other work stay.
    let expected = [
        "a-chest.npz",
        "a-chest.npz.parts",
        "a-floor.npz",
        "lit.toml",
    ];
    assert_eq!(folder.names(), expected);
}
