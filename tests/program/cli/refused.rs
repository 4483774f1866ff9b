//! One clear error per mistake: its place, what would be right, exit code 2, nothing written.

use std::fs;

use super::{Folder, SMALL, repository};

/// Runs `nullray` with `arguments`, which it must refuse with a message that has all of `parts`.
pub fn refused(folder: &Folder, arguments: &[&str], parts: &[&str]) {
    let before = folder.names();
    let run = folder.run(arguments);
    let message = run.message();
    assert_eq!(run.code, 2, "{arguments:?}: {message}");
    assert_eq!(run.stdout, "", "{arguments:?}");
    for part in parts {
        assert!(
            message.contains(part),
            "{arguments:?} lacks {part:?}: {message}"
        );
    }
    for word in ["panicked", "RUST_BACKTRACE", "unwrap", "bug"] {
        assert!(!message.contains(word), "{arguments:?}: {message}");
    }
    assert_eq!(folder.names(), before, "{arguments:?}");
}

/// The corner with a copy of a cube of the repository, named `name`.
fn write_corner(folder: &Folder, scene: &str, cube: &str, name: &str) {
    let glb = "scenes/corner/corner.glb";
    fs::copy(repository(glb), folder.path("corner.glb")).unwrap();
    fs::copy(repository(cube), folder.path(name)).unwrap();
    folder.write(
        scene,
        format!(
            r#"
[camera]
eye = [1.6, 1.9, 2.6]
look_at = [1, 1.6, 1.7]
hfov = "60 deg"
size = [32, 24]
[[object]]
gltf = "corner.glb"
[[source]]
[source.cube]
file = "{name}"
bin_width = "0.1 m"
uv = 0
"#
        ),
    );
}

#[test]
fn wrong_values_of_options_are_refused() {
    let folder = Folder::new();
    let cases: &[(&[&str], &[&str])] = &[
        (&["--size", "0x0"], &["--size", "above 0"]),
        (&["--size", "12"], &["--size", "640x480"]),
        (&["--size", "-3x4"], &["--size"]),
        (&["--size", "4294967296x1"], &["--size", "at most 65536"]),
        (&["--spp", "0"], &["--spp", "1..="]),
        (
            &["--time", "banana"],
            &["--time banana", "\"banana\" is not a time", "2 ns"],
        ),
        (&["--time", "3"], &["--time 3", "unit"]),
        (
            &["--aovs", "foo", "-o", "a.exr"],
            &["--aovs", "\"foo\"", "event"],
        ),
        (&["--threads", "0"], &["--threads", "1..="]),
        (&["--threads", "-1"], &["--threads", "1..="]),
        (&["--max-memory", "-1GB"], &["--max-memory", "16GiB"]),
        (&["--max-memory", "5 bananas"], &["--max-memory", "16GiB"]),
        (
            &["--max-memory", "1k"],
            &["memory", "more than the limit", "--max-memory"],
        ),
        (&["--exposure", "150 %"], &["--exposure 150 %", "100"]),
        (
            &["--exposure", "0.99"],
            &["'0.99' for '--exposure", "\"99 %\" or \"0.99 %\""],
        ),
        (&["--exposure", "bright"], &["--exposure", "2.5 %"]),
        (&["--white", "-1"], &["--white -1", "above 0"]),
        (&["--white", "1e-320"], &["--white 1e-320", "above 0"]),
        (
            &["--white", "1", "--exposure", "9 %"],
            &["--white", "--exposure", "cannot be used with"],
        ),
        (
            &["--spp", "4", "--pixel-centers"],
            &["--pixel-centers", "cannot be used with"],
        ),
        (
            &["--white", "2", "--set", "display.exposure=\"50 %\""],
            &["--set display.exposure", "--white 2 says what is white"],
        ),
        (
            &["--exposure", "9 %", "--set", "display={ white = 1 }"],
            &["--set display=", "says what is white"],
        ),
        // What has no effect on any of the files.
        (&["-o", "a.png", "--half"], &["--half", "-o FILE.exr"]),
        (
            &["-o", "a.png", "--play-fps", "10"],
            &["--play-fps", "-o FILE.y4m"],
        ),
        (
            &["-o", "a.exr", "--white", "3"],
            &["--white", "-o FILE.png"],
        ),
        (
            &["-o", "a.npz", "--isochrones", "t.png", "--exposure", "50"],
            &["--exposure", "-o FILE.png"],
        ),
        (
            &["-o", "a.png", "--same-exposure"],
            &["--same-exposure", "a single picture"],
        ),
        (&["--isochrone-step", "1 m"], &["--isochrones"]),
        (
            &["--isochrones", "t.png", "--isochrone-step", "0 m"],
            &["--isochrone-step", "above 0"],
        ),
        (
            &["--isochrones", "t.png", "--isochrone-step", "one"],
            &["--isochrone-step", "2.5 m"],
        ),
        (&["--nonsense"], &["--nonsense"]),
    ];
    for (options, parts) in cases {
        refused(
            &folder,
            &[&["render", "scene.toml"], *options].concat(),
            parts,
        );
    }
}

#[test]
fn a_scene_without_a_command_is_told_which_one_it_needs() {
    let folder = Folder::empty();
    for (arguments, tip) in [
        (&["scene.toml"][..], "tip: nullray render scene.toml"),
        (
            &["model.GLB", "--beta", "0.5"],
            "tip: nullray render model.GLB",
        ),
        (&["a b.gltf"], "tip: nullray render \"a b.gltf\""),
    ] {
        refused(&folder, arguments, &[tip]);
    }
    let run = folder.run(&["scene.txt"]);
    assert!(
        !run.message().contains("nullray render"),
        "{}",
        run.message()
    );
}

#[test]
fn wrong_overrides_are_refused() {
    let folder = Folder::new();
    let cases = [
        ("foo", "KEY=VALUE"),
        ("=3", "KEY=VALUE"),
        ("camera.foo=3", "unknown key `foo`"),
        ("foo.bar=3", "unknown key `foo`"),
        ("camera.velocity.beta=[2,0,0]", "not below 1"),
        ("camera.hfov=60", "has no unit"),
        ("camera.eye=[1,2", "not a TOML value"),
        ("camera..eye=1", "not a dotted key"),
        (
            "camera.hfov=\"1e-300 rad\"",
            "a field of view of 1e-300 rad is",
        ),
        ("camera.hfov=1e-300", "the number 1e-300 has no unit"),
        ("medium.index=2e-20", "a refractive index of 2e-20 is"),
        ("object.9.velocity.beta=0.5", "there is no object"),
    ];
    for (set, part) in cases {
        refused(
            &folder,
            &["render", "scene.toml", "--set", set],
            &["--set", part]
                .into_iter()
                .filter(|p| set != "foo.bar=3" || *p != "--set")
                .collect::<Vec<_>>(),
        );
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_any_work() {
    let folder = Folder::new();
    fs::create_dir(folder.path("made.png")).unwrap();
    // A rendering that would take hours, were it begun.
    let long = [
        "render",
        "scene.toml",
        "--size",
        "4000x4000",
        "--spp",
        "10000",
        // Whatever else the machine does.
        "--max-memory",
        "64GiB",
    ];
    let cases: &[(&[&str], &[&str])] = &[
        (
            &["-o", "x.jpg"],
            &["-o x.jpg", "pictures as .jpg", ".png", ".exr", ".npz"],
        ),
        (&["-o", "x.mp4"], &["-o x.mp4", "ffmpeg -i -"]),
        (&["-o", "x"], &["-o x", "does not say which kind", ".png"]),
        (
            &["-o", "nodir/x.png"],
            &["-o nodir/x.png", "no directory nodir", "make the directory"],
        ),
        (&["-o", "made.png"], &["-o made.png", "not a file"]),
        (&["-o", "a.png/"], &["-o a.png/", "name of a directory"]),
        (&["-o", "a.exr/."], &["-o a.exr/.", "name of a directory"]),
        (
            &["--stats-json", "a.json/"],
            &["a.json/", "name of a directory"],
        ),
        (
            &["-o", "a.png", "-o", "a.png"],
            &["-o a.png", "two outputs"],
        ),
        (
            &["-o", "a.png", "-o", "./a.png"],
            &["-o ./a.png", "two outputs"],
        ),
        (
            &["-o", "a.png", "--isochrones", "a.png"],
            &["--isochrones a.png", "two outputs"],
        ),
        (
            &["-o", "a.png", "--isochrones", "t.exr"],
            &["--isochrones t.exr", ".png"],
        ),
        (&["-o", "a.png", "--aovs", "all"], &["--aovs", ".exr"]),
    ];
    for (options, parts) in cases {
        refused(&folder, &[&long, *options].concat(), parts);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_directory_that_takes_no_files_is_refused_before_any_work() {
    let folder = Folder::new();
    let long = [
        "render",
        "scene.toml",
        "--size",
        "4000x4000",
        "--spp",
        "10000",
        // Whatever else the machine does.
        "--max-memory",
        "64GiB",
    ];
    let parts = ["/proc/x.png", "no file can be written into its directory"];
    refused(
        &folder,
        &[&long[..], &["-o", "/proc/x.png"]].concat(),
        &parts,
    );
}

#[test]
fn what_the_scene_is_made_of_is_not_overwritten() {
    let folder = Folder::empty();
    folder.write("scene.png", SMALL);
    refused(
        &folder,
        &["render", "scene.png"],
        &["-o scene.png", "overwritten"],
    );
    assert_eq!(folder.read("scene.png"), SMALL.as_bytes());

    write_corner(
        &folder,
        "cube.toml",
        "scenes/corner/capture_rgb.npz",
        "data.npz",
    );
    refused(
        &folder,
        &["render", "cube.toml", "-o", "./data.npz"],
        &["data.npz", "overwritten"],
    );
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("data.npz", folder.path("link.npz")).unwrap();
        refused(
            &folder,
            &["render", "cube.toml", "-o", "link.npz"],
            &["link.npz", "overwritten"],
        );
    }
}

#[test]
fn textures_beside_a_mesh_are_not_overwritten() {
    let folder = Folder::empty();
    folder.write("mesh.gltf", TRIANGLE);
    folder.write("bricks.png", "not looked at");
    let scene = "[camera]\neye = [0,0,3]\nlook_at = [0,0,0]\nhfov = \"60 deg\"\nsize = [8,8]\n\
                 [[object]]\ngltf = \"mesh.gltf\"\n";
    folder.write("scene.toml", scene);
    let arguments = ["render", "scene.toml", "-o", "bricks.png"];
    refused(&folder, &arguments, &["bricks.png", "overwritten"]);
}

#[test]
fn diagrams_and_studies_do_not_overwrite_what_their_scene_is_made_of() {
    let folder = Folder::empty();
    let path = folder.path("floor.png");
    nullray::io::image::png::write(&path, 4, 4, &[200; 48], &[]).unwrap();
    let floor = r#"
[camera]
eye = [0, 0, 5]
look_at = [0, 0, 0]
size = [8, 8]
[[object]]
shape = { plane = { size = [2, 2] } }
[[source]]
[source.cube]
file = "floor.png"
transfer = "linear"
capture = { eye = [0, 5, 0], look_at = [0, 0, 0], up = [0, 0, -1], hfov = "40 deg" }
"#;
    folder.write("floor.toml", floor);
    for options in [&["--pixel", "4,4"][..], &[]] {
        let arguments = [&["diagram", "floor.toml", "-o", "floor.png"], options].concat();
        refused(&folder, &arguments, &["-o floor.png", "overwritten"]);
    }
    // The name that a study writes to where none is given.
    folder.write("s-study.csv", "0, 0, -1, 0, 6500\n");
    folder.write(
        "s.toml",
        format!("{SMALL}[sky]\nstars = {{ file = \"s-study.csv\" }}\n"),
    );
    let arguments = ["study", "s.toml", "--methods", "trace", "--samples", "1"];
    refused(&folder, &arguments, &["s-study.csv", "overwritten"]);
}

/// A triangle with its buffer in a file `mesh.bin`, and an image file.
pub const TRIANGLE: &str = r#"{
"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "roof"}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
"materials": [{"name": "paint", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}],
"images": [{"uri": "bricks.png"}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
"bufferViews": [{"buffer": 0, "byteLength": 36}],
"buffers": [{"uri": "mesh.bin", "byteLength": 36}]
}"#;

#[test]
fn scenes_that_cannot_be_read_are_refused() {
    let folder = Folder::new();
    fs::create_dir(folder.path("folder")).unwrap();
    folder.write("binary.toml", [0xff, 0xfe, 0, 1]);
    folder.write("broken.toml", "[camera\n");
    let missing = SMALL.replace(
        "shape = { box = { size = [1, 1, 1] } }",
        "gltf = \"no.glb\"",
    );
    folder.write("missing.toml", missing);
    let cases: &[(&str, &[&str])] = &[
        (
            "nope.toml",
            &["nope.toml", "No such file", "check the path"],
        ),
        ("folder", &["folder", "directory", "name a file"]),
        ("binary.toml", &["binary.toml", "UTF-8"]),
        ("broken.toml", &["broken.toml"]),
        ("missing.toml", &["missing.toml", "no.glb"]),
    ];
    for (scene, parts) in cases {
        for command in ["render", "plan"] {
            refused(&folder, &[command, scene], parts);
        }
    }
}

#[test]
fn a_failure_midway_leaves_an_existing_output_as_it_was() {
    let folder = Folder::empty();
    // A header as it should be, and a sample that is not: found when the data are loaded.
    write_corner(
        &folder,
        "scene.toml",
        "tests/data/invalid/sample-nan.npy",
        "data.npy",
    );
    folder.write("old.png", "precious");
    refused(
        &folder,
        &["render", "scene.toml", "-o", "old.png"],
        &["data.npy", "finite"],
    );
    assert_eq!(folder.read("old.png"), b"precious");
}
