//! Pictures that improve: `render --error`, `--budget` and `--passes`.

use nullray::io::budget::Budget;
use nullray::io::image::Samples;
use nullray::validate::compare::{Encoding, Picture};

use super::Folder;

/// A floor in the soft light of a panel.
const SOFT: &str = r#"
[camera]
eye = [0, 2, 4]
look_at = [0, 0, 0]
hfov = "50 deg"
size = [24, 18]
[[object]]
name = "floor"
shape = { plane = { size = [4, 4] } }
[[object]]
name = "panel"
shape = { plane = { size = [1, 1] } }
transform = { translate = [0, 1, 0], rotate = { axis = [1, 0, 0], angle = "180 deg" } }
[[light]]
type = "area"
object = "panel"
radiance = 3
"#;

fn folder() -> Folder {
    let folder = Folder::empty();
    folder.write("soft.toml", SOFT);
    folder
}

const TO_NPZ: [&str; 8] = [
    "render",
    "soft.toml",
    "--spp",
    "2",
    "--aovs",
    "standard_error,samples",
    "-o",
    "a.npz",
];

#[test]
fn an_error_that_is_not_reached_is_taken_up_again_with_the_bits_of_work_that_did_not_stop() {
    let goal = ["--error", "0.01 %", "--passes"];
    let (whole, parts) = (folder(), folder());
    let said = whole.ok(&[&TO_NPZ[..], &goal, &["24"]].concat());
    assert!(said.contains("24 passes, standard error"), "{said}");
    assert!(
        said.contains("have not reached an error of 0.01 %"),
        "{said}"
    );
    // Numbers are said as people write them.
    let tiny = ["--error", "1e-9", "--passes", "2"];
    let said = folder().ok(&[&TO_NPZ[..], &tiny].concat());
    assert!(said.contains("an error of 1e-7 %"), "{said}");
    for passes in ["2", "8", "16", "24"] {
        let said = parts.ok(&[&TO_NPZ[..], &goal, &[passes]].concat());
        assert_eq!(
            said.contains("resuming after pass"),
            passes != "2",
            "{said}"
        );
    }
    assert!(whole.read("a.npz") == parts.read("a.npz"));
    assert!(parts.path("a.npz.passes").exists());
    // The same command again would trace nothing: more passes continue.
    let said = parts.ok(&[&TO_NPZ[..], &goal, &["24"]].concat());
    assert!(
        said.contains("these were all 24 passes; --passes 48 continues from a.npz.passes")
            && !said.contains("run the same command again"),
        "{said}"
    );
    let said = parts.ok(&[&TO_NPZ[..], &goal, &["26", "--budget=0"]].concat());
    assert!(said.contains("resuming after pass 24"), "{said}");
    // Of another scene, the sums are begun anew; of an error that is reached, none stay.
    parts.write("soft.toml", SOFT.replace("radiance = 3", "radiance = 4"));
    let said = parts.ok(&[&TO_NPZ[..], &["--error", "60 %"]].concat());
    assert!(
        !said.contains("resuming") && said.contains("32 passes") && said.contains("starting over"),
        "{said}"
    );
    // What was asked for is said to be reached, for the pixels of each tile.
    let reached = "in each tile of 16 × 16 pixels the standard error of pixels has reached the requested 60 %";
    assert!(said.contains(reached), "{said}");
    assert!(!parts.path("a.npz.passes").exists());
    // A damaged file is refused, and named.
    parts.write("a.npz.passes", "nullray passes 5\n");
    let run = parts.run(&[&TO_NPZ[..], &["--passes", "2"]].concat());
    assert_eq!(run.code, 2);
    assert!(run.message().contains("damaged"), "{}", run.stderr);
}

/// A floor below a lamp that is seen as a hundredth of one pixel, and a sky.
const SPECK: &str = r#"
[camera]
eye = [0, 1, 4]
look_at = [0, 1, 0]
hfov = "50 deg"
size = [16, 16]
[[object]]
name = "floor"
shape = { plane = { size = [4, 4] } }
[[object]]
name = "speck"
shape = { box = { size = [0.023, 0.023, 0.023] } }
transform = { translate = [0.117, 1.117, 0] }
[[light]]
type = "area"
object = "speck"
radiance = 800
[sky]
radiance = 1
lights = false
"#;

#[test]
fn tiles_that_miss_the_requested_error_are_counted_with_the_largest_error() {
    let folder = Folder::empty();
    folder.write("speck.toml", SPECK);
    let goal = ["render", "speck.toml", "--spp", "4", "--error", "20 %"];
    let (mut missed, mut reached) = (0, 0);
    for seed in 0..12 {
        let seed = format!("render.seed={seed}");
        let files = ["--set", &seed, "--aovs", "standard_error", "-o", "a.npz"];
        let said = folder.ok(&[&goal[..], &files].concat());
        // The root mean square over the only tile, relative to its mean, from the arrays of the file.
        let budget = Budget::new(1 << 26);
        let picture = Picture::read(&folder.path("a.npz"), Encoding::Srgb, &budget).unwrap();
        let layers = &picture.layers;
        let radiance: Vec<f64> = layers.radiance().unwrap().into_iter().flatten().collect();
        let mut channels = layers.channels.iter();
        let errors = channels.find(|channel| channel.name == "standard_error");
        let Samples::F64(errors) = &errors.unwrap().samples else {
            panic!("not f64");
        };
        let square = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        let mean = radiance.iter().sum::<f64>() / radiance.len() as f64;
        let error = 100.0 * square.sqrt() / mean;
        match error > 20.0 {
            true => {
                missed += 1;
                let words = format!(
                    "in 1 tile of 16 × 16 pixels the standard error of pixels is beyond the requested 20 % of the tile's radiance or of the picture's, with up to {error:.3} %"
                );
                assert!(
                    said.contains(&words) && said.contains("--spp"),
                    "{words}: {said}"
                );
            }
            false => {
                reached += 1;
                assert!(
                    said.contains("the standard error of pixels has reached"),
                    "{error}: {said}"
                );
            }
        }
    }
    assert!(missed > 0 && reached > 0, "{missed} {reached}");
}

#[test]
fn a_budget_ends_after_whole_passes_whose_number_gives_the_bits() {
    let folder = folder();
    let said = folder.ok(&[&TO_NPZ[..], &["--budget", "0.3 s"]].concat());
    let passes = said
        .lines()
        .find_map(|line| line.split_once(" passes, standard error"));
    let passes = passes.unwrap().0.to_string();
    // As `info` says.
    let info = folder.ok(&["info", "a.npz"]);
    let is_said = |line: &str| line.split_whitespace().eq(["passes", &passes]);
    assert!(info.lines().any(is_said), "{passes}: {info}");
    let first = folder.read("a.npz");
    folder.ok(&[&TO_NPZ[..], &["--passes", &passes]].concat());
    assert!(first == folder.read("a.npz"), "{passes} passes");
    // Seconds without their unit, here none: the fewest passes.
    let said = folder.ok(&[&TO_NPZ[..], &["--budget", "0"]].concat());
    assert!(said.contains("2 passes, standard error"), "{said}");
    assert!(!folder.path("a.npz.passes").exists());
}

#[test]
fn a_study_has_a_budget_as_a_render_has() {
    let folder = folder();
    let study = [
        "study",
        "soft.toml",
        "--size=8x6",
        "--methods=trace",
        "--samples=1",
        "--runs=1",
    ];
    for budget in ["5 s", "5", "1 min"] {
        let more = ["--reference-spp=1", "--budget", budget, "-o", "a.csv"];
        folder.ok(&[&study[..], &more].concat());
    }
    let run = folder.run(&["study", "soft.toml", "--budget", "5 cm"]);
    assert_eq!(run.code, 2);
    assert!(run.message().contains("a time like"), "{}", run.stderr);
}

#[test]
fn passes_of_what_does_not_improve_are_refused() {
    let folder = folder();
    for (arguments, message) in [
        (&["--passes", "3"][..], "in pairs"),
        (&["--error", "0 %"], "above 0 %"),
        (&["--error", "1"], "write \"1 %\" or 0.01"),
        (&["--error", "2.5"], "write \"2.5 %\" or 0.025"),
        (&["--error", "200"], "at most 100 %"),
        (&["--budget", "60 m"], "a time like \"60 s\""),
        (
            &["--error", "1 %", "--frames", "0..3", "--interval", "1 m"],
            "render each picture with a --time of its own",
        ),
        (&["--error", "1 %", "--method", "raster:none"], "ray tracer"),
        (&["--error", "1 %", "--stats"], "statistics"),
    ] {
        let run = folder.run(&[&TO_NPZ[..], arguments].concat());
        assert_eq!(run.code, 2, "{arguments:?}");
        assert!(
            run.stderr.contains(message),
            "{arguments:?}: {}",
            run.stderr
        );
    }
    std::fs::create_dir(folder.path("a.npz.passes")).unwrap();
    let run = folder.run(&[&TO_NPZ[..], &["--passes", "2"]].concat());
    assert_eq!(run.code, 2, "{}", run.stderr);
}

#[test]
fn an_error_that_is_reached_says_again_that_light_is_missing() {
    let folder = folder();
    // A mirror and a lamp without extent.
    let mirror = "[[object]]\nname = \"pane\"\nshape = { box = { size = [0.1, 1, 1] } }\nmetallic = 1\nroughness = 0\n";
    let lamp = "[[light]]\nname = \"bulb\"\nposition = [1, 1, 0]\n";
    let bounces = "[render]\nbounces = 1\n";
    let words = "this leaves out the light that cannot be sampled";
    for (more, is_said) in [(lamp, true), ("", false)] {
        folder.write("soft.toml", format!("{SOFT}{mirror}{more}{bounces}"));
        let said = folder.ok(&[
            "render",
            "soft.toml",
            "--error",
            "50 %",
            "--size",
            "8x6",
            "-o",
            "a.png",
        ]);
        assert!(said.contains("has reached the requested 50 %"), "{said}");
        assert_eq!(said.contains(words), is_said, "{said}");
    }
}

#[test]
fn sums_are_taken_up_again_however_their_picture_is_shown_and_whatever_is_written_beside_it() {
    let (whole, parts) = (folder(), folder());
    let goal = ["--error", "0.01 %", "--passes"];
    whole.ok(&[&TO_NPZ[..], &goal, &["12"]].concat());
    let run =
        |passes: &str, more: &[&str]| parts.ok(&[&TO_NPZ[..], &goal, &[passes], more].concat());
    run("2", &[]);
    let resumes = |passes: u32, more: &[&str]| {
        let said = run(&passes.to_string(), more);
        let words = format!("resuming after pass {}\n", passes - 2);
        assert!(said.contains(&words), "{more:?}: {said}");
    };
    resumes(4, &["--isochrones", "t.png"]);
    resumes(6, &["--white", "2", "-o", "b.png"]);
    resumes(
        8,
        &["-o", "b.exr", "--half", "-o", "b.png", "--caption", "soft"],
    );
    parts.write(
        "soft.toml",
        format!("# A remark\n{SOFT}[display]\nwhite = 3\nbits = 16\n"),
    );
    resumes(10, &[]);
    parts.write("soft.toml", SOFT);
    resumes(12, &[]);
    assert!(whole.read("a.npz") == parts.read("a.npz"));
    // Of other channels or samples there are none.
    for more in [
        &["--aovs", "samples"][..],
        &["--spp", "3"],
        &["--set", "camera.size=[24, 17]"],
        &["--set", "display.background=[1, 1, 1]"],
    ] {
        let replaced = |words: &[&str]| -> Vec<String> {
            let words = words.chunks(2).filter(|pair| pair[0] != more[0]);
            words.flatten().map(|word| word.to_string()).collect()
        };
        let arguments = replaced(&[&TO_NPZ[2..], &goal, &["2"]].concat());
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let said = parts.ok(&[&TO_NPZ[..2], &arguments[..], more].concat());
        assert!(said.contains("starting over"), "{more:?}: {said}");
    }
}

#[test]
fn the_memory_of_passes_is_said_at_once() {
    let folder = folder();
    let needed = |limit: &str| {
        let size = ["--size=2000x2000", "--passes=2", "--max-memory", limit];
        let run = folder.run(&[&TO_NPZ[..], &size].concat());
        assert_eq!(run.code, 2);
        let (_, said) = run.stderr.split_once("needs about ").unwrap();
        said.split_once(',').unwrap().0.to_owned()
    };
    // Neither holds the sums of the passes; the first not even the picture.
    assert_eq!(needed("200MiB"), needed("600MiB"));
}
