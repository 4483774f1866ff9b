//! Processes killed at any instant.

use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::{BAKE, Folder, Numbers, SCENE, SEQUENCE, cube, files, instants, lit_scene, said};

/// Starts the program and kills it after `after`; whether it was still at work.
fn killed(folder: &Folder, arguments: &[&str], after: Duration) -> bool {
    let mut command = folder.program(arguments);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    sleep(after);
    let was_at_work = child.try_wait().unwrap().is_none();
    child.kill().unwrap();
    child.wait().unwrap();
    was_at_work
}

/// Starts a sequence, and waits for its first frame.
fn started(folder: &Folder, sequence: &[&str]) -> Child {
    let mut command = folder.program(sequence);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    while !folder.path("f-00.png").exists() {
        sleep(Duration::from_millis(1));
    }
    child
}

#[test]
fn a_killed_sequence_has_whole_frames_and_is_completed_to_the_same_bits() {
    let reference = Folder::new();
    reference.write("a.toml", SCENE);
    let begin = Instant::now();
    reference.succeed(&SEQUENCE);
    let whole = begin.elapsed();
    let expected = reference.files(&[]);
    let (mut numbers, mut at_work) = (Numbers(1), 0);
    for _ in 0..instants() {
        let folder = Folder::new();
        folder.write("a.toml", SCENE);
        for _ in 0..2 {
            let after = Duration::from_micros(numbers.below(whole.as_micros() as u64));
            at_work += u64::from(killed(&folder, &SEQUENCE, after));
            for (name, content) in folder.files(&[".nullray-"]) {
                assert!(expected.get(&name) == Some(&content), "{name} is not whole");
            }
        }
        folder.age_left_overs();
        // Left-overs are cleared by the next run that has something to write.
        let _ = std::fs::remove_file(folder.path("f-05.png"));
        folder.succeed(&SEQUENCE);
        assert!(
            folder.files(&[]) == expected,
            "files or bits differ: {:?}",
            folder.files(&[]).keys()
        );
    }
    assert!(at_work > 0);
}

#[test]
fn a_killed_export_is_there_whole_or_not_at_all() {
    let reference = Folder::new();
    reference.write("a.toml", SCENE);
    let begin = Instant::now();
    let export = ["export", "a.toml", "-o", "bundle", "--overwrite"];
    reference.succeed(&export);
    let whole = begin.elapsed();
    let expected = files(&reference.path("bundle"), &[]);
    let mut numbers = Numbers(2);
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    for _ in 0..instants() {
        let after = Duration::from_micros(numbers.below(whole.as_micros() as u64));
        killed(&folder, &export, after);
        // From the second time on there is an old one, which stays until the new one is complete.
        if folder.path("bundle").exists() {
            assert!(files(&folder.path("bundle"), &[]) == expected);
        }
        if numbers.below(3) == 0 {
            folder.succeed(&export);
        }
    }
    folder.age_left_overs();
    folder.succeed(&export);
    assert!(files(&folder.path("bundle"), &[]) == expected);
    let left: Vec<_> = folder.files(&["bundle"]).into_keys().collect();
    assert_eq!(left, ["a.toml"]);
}

/// Kills a command at random instants, time and again: each file is whole, or the one that was there before, or absent, and the next run gives
/// the same bits and clears what was left.
fn killed_at_random(input: (&str, Vec<u8>), arguments: &[&str], seed: u64) {
    let begun = || {
        let folder = Folder::new();
        folder.write(input.0, &input.1);
        folder
    };
    let reference = begun();
    reference.succeed(arguments);
    // Beside other work the first of several may take much longer than the others.
    let time = |_| {
        let (folder, begin) = (begun(), Instant::now());
        folder.succeed(arguments);
        begin.elapsed()
    };
    let whole = (0..3).map(time).min().unwrap_or_default();
    let expected = reference.files(&[]);
    let (mut numbers, mut at_work) = (Numbers(seed), 0);
    for _ in 0..instants() {
        let folder = begun();
        let after = Duration::from_micros(numbers.below(whole.as_micros() as u64));
        at_work += u64::from(killed(&folder, arguments, after));
        // Finished parts of a bake are kept to be gone on from, and go when it is finished.
        let left = folder.files(&[".nullray-"]).into_iter();
        for (name, content) in left.filter(|(name, _)| !name.ends_with(".parts")) {
            assert!(expected.get(&name) == Some(&content), "{name} is not whole");
        }
        folder.age_left_overs();
        for name in expected.keys().filter(|name| *name != input.0) {
            let _ = std::fs::remove_file(folder.path(name));
        }
        let _ = std::fs::remove_dir(folder.path("frames"));
        folder.succeed(arguments);
        let after = folder.files(&[]);
        assert!(
            after == expected,
            "files or bits differ: {:?}",
            after.keys()
        );
    }
    assert!(at_work > 0);
}

#[test]
fn a_killed_bake_is_there_whole_or_not_at_all() {
    killed_at_random(lit_scene(), &BAKE, 4);
}

#[test]
fn a_killed_conversion_is_there_whole_or_not_at_all() {
    for (k, name) in ["b.npy", "b.npz", "frames"].into_iter().enumerate() {
        let (name_of_input, _) = cube();
        killed_at_random(
            cube(),
            &["convert", name_of_input, "-o", name],
            5 + k as u64,
        );
    }
}

/// Eight frames, slow enough for a file of theirs to be edited meanwhile.
const SLOW_SEQUENCE: [&str; 10] = [
    "render",
    "a.toml",
    "--frames",
    "0..8",
    "--interval",
    "1 cm",
    "-o",
    "f-##.png",
    "--spp",
    "9",
];

#[test]
fn a_scene_that_is_edited_during_its_sequence_is_rendered_as_it_was_and_that_is_said() {
    // Slow enough to be edited while it is rendered.
    let scene = SCENE.replace("[48, 32]", "[320, 240]");
    let edited = scene.replace("size = [1, 1, 1]", "size = [1, 2, 1]");
    let reference = |text: &str| {
        let folder = Folder::new();
        folder.write("a.toml", text);
        folder.succeed(&SLOW_SEQUENCE);
        folder.files(&["a.toml"])
    };
    let (before, after) = (reference(&scene), reference(&edited));
    assert!(before != after);
    let folder = Folder::new();
    folder.write("a.toml", &scene);
    let child = started(&folder, &SLOW_SEQUENCE);
    folder.write("a.toml", &edited);
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    assert!(folder.files(&["a.toml"]) == before);
    let text = said(&output);
    assert!(text.contains("a.toml has changed since"), "{text}");
    // Begun again, nothing of the old geometry is taken for the new.
    folder.succeed(&SLOW_SEQUENCE);
    assert!(folder.files(&["a.toml"]) == after);
}

#[test]
fn a_table_that_is_edited_during_a_sequence_is_taken_as_it_was_and_that_is_said() {
    let scene = SCENE.replace("[48, 32]", "[320, 240]")
        + "spectrum = { table = \"lamp.csv\" }\n[radiance]\nquantity = \"rgb\"\n";
    let [before, after] = ["400,1\n700,1\n", "400,1\n500,0\n"];
    let reference = Folder::new();
    reference.write("a.toml", &scene).write("lamp.csv", before);
    reference.succeed(&SLOW_SEQUENCE);
    let folder = Folder::new();
    folder.write("a.toml", &scene).write("lamp.csv", before);
    let child = started(&folder, &SLOW_SEQUENCE);
    folder.write("lamp.csv", after);
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    assert!(folder.files(&["lamp.csv"]) == reference.files(&["lamp.csv"]));
    let text = said(&output);
    assert!(text.contains("lamp.csv has changed since"), "{text}");
}

#[test]
fn a_damaged_frame_is_rendered_again() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    folder.succeed(&SEQUENCE);
    let expected = folder.files(&[]);
    let mut numbers = Numbers(3);
    for _ in 0..instants() {
        let names: Vec<_> = expected.keys().filter(|name| *name != "a.toml").collect();
        let name = names[numbers.below(names.len() as u64) as usize];
        let mut content = expected[name].clone();
        let at = numbers.below(content.len() as u64) as usize;
        content[at] ^= 1 << numbers.below(8);
        folder.write(name, content);
        folder.succeed(&SEQUENCE);
        // Dates and attributes in the headers of an EXR file or an archive say nothing of the picture, which is whole.
        let same = folder.files(&[])[name] == expected[name];
        if !same {
            assert!(!name.ends_with(".png"), "{name}, byte {at}");
            let extension = name.rsplit('.').next().unwrap();
            let reference = format!("reference.{extension}");
            folder.write(&reference, &expected[name]);
            let limits = ["max=0", "event.ct:max=0", "event.x:max=0"];
            let mut compare = vec!["compare", &reference, name, "--no-flip"];
            compare.extend(limits.iter().flat_map(|limit| ["--tolerance", limit]));
            folder.succeed(&compare);
            std::fs::remove_file(folder.path(&reference)).unwrap();
        }
        folder.write(name, &expected[name]);
    }
}

#[test]
fn inputs_that_vanish_once_they_are_read_are_not_missed() {
    let folder = Folder::new();
    let glb = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/valid/hierarchy.glb"
    );
    std::fs::copy(glb, folder.path("a.glb")).unwrap();
    let scene = SCENE
        .replace("shape = { box = { size = [1, 1, 1] } }", "gltf = \"a.glb\"")
        .replace("[48, 32]", "[320, 240]");
    folder.write("a.toml", scene);
    let sequence = [
        "render",
        "a.toml",
        "--frames",
        "0..6",
        "--interval",
        "1 cm",
        "-o",
        "f-##.png",
        "--spp",
        "9",
    ];
    let child = started(&folder, &sequence);
    std::fs::remove_file(folder.path("a.glb")).unwrap();
    std::fs::remove_file(folder.path("a.toml")).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(folder.files(&[]).len(), 6);
}
