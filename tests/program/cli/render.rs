//! The output of `nullray render`.

use std::process::Stdio;

use nullray::io::image::{Samples, exr, png};
use sha2::{Digest, Sha256};

use super::{Folder, Run};

#[test]
fn without_o_the_picture_has_the_scenes_name_in_the_current_directory() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("below")).unwrap();
    std::fs::rename(
        folder.path("scene.toml"),
        folder.path("below/approaching-0.9.toml"),
    )
    .unwrap();
    let said = folder.ok(&["render", "below/approaching-0.9.toml"]);
    assert!(
        said.starts_with("wrote approaching-0.9.png (white is radiance"),
        "{said}"
    );
    assert_eq!(folder.names(), ["approaching-0.9.png", "below"]);
}

#[test]
fn one_rendering_is_written_in_all_formats_at_once() {
    let folder = Folder::new();
    let said = folder.ok(&[
        "render",
        "scene.toml",
        "-o",
        "a.png",
        "-o",
        "a.exr",
        "-o",
        "a.npz",
        "--isochrones",
        "times.png",
        "--aovs",
        "all",
    ]);
    for name in ["a.png", "a.exr", "a.npz", "times.png"] {
        assert!(said.contains(&format!("wrote {name}")), "{said}");
    }
    assert_eq!(
        folder.names(),
        ["a.exr", "a.npz", "a.png", "scene.toml", "times.png"]
    );
    assert_eq!(&folder.read("a.npz")[..2], b"PK");
    let picture = png::inspect(&folder.path("a.png")).unwrap();
    assert_eq!([picture.width, picture.height], [32, 24]);
}

#[test]
fn a_scene_from_standard_input_gives_the_picture_of_its_file() {
    let folder = Folder::new();
    let from = |name: &str, arguments: &[&str]| {
        let mut command = folder.command(arguments);
        command.stdin(std::fs::File::open(folder.path(name)).unwrap());
        Run::of(command.output().unwrap())
    };
    folder.ok(&["render", "scene.toml", "-o", "file.exr"]);
    for (name, output) in [("-", "a.exr"), ("/dev/stdin", "b.exr")] {
        let run = from("scene.toml", &["render", name, "-o", output]);
        assert_eq!((run.code, &run.stderr[..]), (0, ""), "{name}");
        let read = |name: &str| exr::read(&folder.path(name), &Default::default()).unwrap();
        assert!(read("file.exr").channels == read(output).channels, "{name}");
    }
    assert_eq!(from("scene.toml", &["plan", "-"]).code, 0);
    assert_eq!(from("scene.toml", &["info", "-"]).code, 0);
    // Outputs without a name are called after it, and messages name it.
    from("scene.toml", &["render", "-", "-q"]);
    assert!(folder.path("stdin.png").is_file());
    folder.write("wrong.toml", "[camera]\neye = 3\n");
    let run = from("wrong.toml", &["render", "-"]);
    assert_eq!(run.code, 2);
    assert!(run.message().contains("<stdin>"), "{}", run.stderr);
    folder.write("long.toml", "#".repeat(5_000_000));
    let run = from("long.toml", &["render", "-"]);
    assert_eq!(run.code, 2, "{}", run.stderr);
}

#[test]
fn exr_channels_are_those_that_were_asked_for() {
    let folder = Folder::new();
    folder.ok(&[
        "render",
        "scene.toml",
        "-o",
        "a.exr",
        "--aovs",
        "coverage,object",
    ]);
    let layers = exr::read(&folder.path("a.exr"), &Default::default()).unwrap();
    let mut names: Vec<_> = layers.channels.iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(
        names,
        [
            "coverage",
            "object",
            "radiance.B",
            "radiance.G",
            "radiance.R"
        ]
    );
    let Samples::I32(objects) = &layers.channel("object").unwrap().samples else {
        panic!("identities are integers");
    };
    // Floor, crate, and sky.
    for id in [-1, 0, 1] {
        assert!(objects.contains(&id), "{id}");
    }
}

#[test]
fn the_help_documents_every_channel_that_all_gives() {
    let folder = Folder::new();
    let help = folder.ok(&["help", "render"]);
    folder.ok(&["render", "scene.toml", "-o", "a.exr", "--aovs", "all"]);
    let layers = exr::read(&folder.path("a.exr"), &Default::default()).unwrap();
    assert!(layers.channels.len() > 20);
    for channel in layers
        .channels
        .iter()
        .filter(|c| !c.name.starts_with("radiance"))
    {
        assert!(
            help.contains(&format!("\n  {} ", channel.name)),
            "{}",
            channel.name
        );
    }
}

#[test]
fn metadata_hold_the_scene_after_its_changes_and_its_hash() {
    let folder = Folder::new();
    let arguments = [
        "render",
        "scene.toml",
        "--spp",
        "9",
        "-o",
        "a.exr",
        "-o",
        "a.png",
    ];
    folder.ok(&arguments);
    let layers = exr::read(&folder.path("a.exr"), &Default::default()).unwrap();
    let picture = png::inspect(&folder.path("a.png")).unwrap();
    for entries in [&layers.metadata, &picture.text] {
        let value = |key: &str| {
            let entry = entries.iter().find(|(k, _)| k == key);
            entry.unwrap_or_else(|| panic!("{key}")).1.as_str()
        };
        let text = value("scene_text");
        assert!(text.contains("samples_per_pixel = 9"), "{text}");
        let hash = Sha256::digest(text.as_bytes());
        let hash: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(value("scene_sha256"), hash);
        assert!(value("software").starts_with("nullray "));
        // atanh 0.3
        let rapidity: Vec<f64> = value("camera_rapidity")
            .split(' ')
            .map(|x| x.parse().unwrap())
            .collect();
        assert!(
            (rapidity[2] + 0.309_519_604_203_111_7).abs() < 1e-15,
            "{rapidity:?}"
        );
    }
    // The text in the metadata is a scene, and the same picture.
    folder.write(
        "again.toml",
        layers
            .metadata
            .iter()
            .find(|e| e.0 == "scene_text")
            .unwrap()
            .1
            .clone(),
    );
    folder.ok(&["render", "again.toml", "-o", "b.exr"]);
    let again = exr::read(&folder.path("b.exr"), &Default::default()).unwrap();
    assert_eq!(again.channels, layers.channels);
}

#[test]
fn the_files_do_not_depend_on_the_number_of_threads() {
    let folder = Folder::new();
    for threads in ["1", "2", "5"] {
        let [png, exr, npz] = ["png", "exr", "npz"].map(|kind| format!("{threads}.{kind}"));
        folder.ok(&[
            "render",
            "scene.toml",
            "--threads",
            threads,
            "--aovs",
            "all",
            "-o",
            &png,
            "-o",
            &exr,
            "-o",
            &npz,
        ]);
    }
    for kind in ["png", "exr", "npz"] {
        let first = folder.read(&format!("1.{kind}"));
        for other in ["2", "5"] {
            assert!(
                first == folder.read(&format!("{other}.{kind}")),
                "{other}.{kind}"
            );
        }
    }
}

#[test]
fn changes_of_the_scene_change_the_picture() {
    let folder = Folder::new();
    let render = |name: &str, options: &[&str]| {
        folder.ok(&[&["render", "scene.toml", "-o", name], options].concat());
        folder.read(name)
    };
    let base = render("base.png", &[]);
    let changed: [&[&str]; 6] = [
        &["--set", "camera.velocity={beta=[0,0,-0.8]}"],
        &["--set", "object.crate.velocity.beta=[0,0,0]"],
        &["--set", "source.lamp.pulse.intensity=[1,0,0]"],
        &["--time", "1 m"],
        &["--exposure", "50 %"],
        &["--white", "0.01"],
    ];
    for options in changed {
        assert!(render("changed.png", options) != base, "{options:?}");
    }
    folder.ok(&["render", "scene.toml", "--size", "5x3", "-o", "size.png"]);
    let picture = png::inspect(&folder.path("size.png")).unwrap();
    assert_eq!([picture.width, picture.height], [5, 3]);
}

#[test]
fn exposure_and_white_replace_each_other() {
    let folder = Folder::empty();
    folder.write(
        "white.toml",
        super::SMALL.replace("[display]", "[display]\nwhite = 0.5"),
    );
    folder.write(
        "exposed.toml",
        super::SMALL.replace("[display]", "[display]\nexposure = \"90 %\""),
    );
    let white = folder.ok(&["render", "exposed.toml", "--white", "0.25"]);
    assert!(white.contains("white is radiance 0.2500"), "{white}");
    let by_file = folder.ok(&["render", "exposed.toml"]);
    for percent in ["90 %", "90%", "90"] {
        let exposed = folder.ok(&["render", "white.toml", "--exposure", percent]);
        let radiance = |text: &str| {
            text.split_once("(white")
                .map(|(_, t)| t.split_once(')').unwrap().0.to_string())
        };
        assert_eq!(radiance(&exposed), radiance(&by_file), "{percent}");
    }
}

#[test]
fn what_half_precision_does_not_hold_is_counted() {
    let folder = Folder::empty();
    let sky = |radiance: &str| {
        format!(
            "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nhfov = \"50 deg\"\nsize = [8, 6]\n\
             [sky]\nradiance = {radiance}\n"
        )
    };
    folder.write("beyond.toml", sky("[1e6, 1e-9, 1]"));
    let said = folder.ok(&["render", "beyond.toml", "--half", "-o", "a.exr"]);
    let words = "warning: --half: 48 pixels brighter than 65504 were clamped, 48 pixels with values up to 3e-8 were set to 0: without \
                 --half the file holds them in f32\n";
    assert_eq!(said.matches(words).count(), 1, "{said}");
    // Single precision holds both, and a picture is no file in half precision.
    for file in ["b.exr", "b.npz", "b.png"] {
        let said = folder.ok(&["render", "beyond.toml", "-o", file]);
        assert!(!said.contains("--half"), "{said}");
    }
    // Of a sequence it is said once.
    let frames = ["--from", "0 m", "--to", "3 m", "--interval", "1 m"];
    let half = ["render", "beyond.toml", "--half", "-o", "c.exr"];
    let said = folder.ok(&[&half[..], &frames].concat());
    assert_eq!(said.matches("--half").count(), 2, "{said}");
    assert!(said.contains("(and the same for 2 more frames)"), "{said}");
    // What it holds needs no word: 0, its greatest number, and its least.
    folder.write("within.toml", sky("[65504, 0, 6e-8]"));
    let said = folder.ok(&["render", "within.toml", "--half", "-o", "d.exr"]);
    assert!(!said.contains("warning"), "{said}");
}

#[test]
fn what_single_precision_does_not_hold_is_limited_and_said() {
    let folder = Folder::empty();
    // Light from ahead is (γ (1 + β))⁴ = 4e12 times as bright.
    let scene = "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [4, 4]\nhfov = \"0.01 deg\"\n\
                 velocity = { one_minus_beta = 1e-6, direction = [0, 0, -1] }\n[sky]\nradiance = 1e30\n";
    folder.write("hot.toml", scene);
    let said = folder.ok(&["render", "hot.toml", "-o", "a.exr"]);
    let words = "warning: EXR: 16 pixels brighter than 3.4028e38 were clamped";
    assert_eq!(said.matches(words).count(), 1, "{said}");
    let layers = exr::read(&folder.path("a.exr"), &Default::default()).unwrap();
    let red = layers.channels.iter().find(|c| c.name == "radiance.R");
    assert_eq!(red.unwrap().samples, Samples::F32(vec![f32::MAX; 16]));
    let said = folder.ok(&["render", "hot.toml", "-o", "a.npz"]);
    assert!(!said.contains("limited"), "{said}");
}

#[test]
fn quiet_says_nothing() {
    let folder = Folder::new();
    assert_eq!(folder.ok(&["render", "scene.toml", "--quiet"]), "");
    assert_eq!(folder.names(), ["scene.png", "scene.toml"]);
}

#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let folder = Folder::new();
    let mut child = folder
        .command(&["render", "scene.toml", "-o", "a.png", "-o", "b.png"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(output.stderr, b"");
    assert_eq!(folder.names(), ["a.png", "b.png", "scene.toml"]);
}
