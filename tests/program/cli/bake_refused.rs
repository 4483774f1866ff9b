//! What `nullray bake` refuses, and what it says then.

use super::Folder;
use super::bake::{FLASH, LIGHT, ball};

#[test]
fn options_that_change_nothing_of_what_is_baked_are_refused() {
    let folder = Folder::empty();
    folder.write("lit.toml", FLASH.to_string() + LIGHT);
    for (options, words) in [
        (["--object=floor", "--size=8x8"], "--texels"),
        (
            ["--object=floor", "--pixel-centers"],
            "does not depend on the camera",
        ),
        (
            ["--object=floor", "--time=1 m"],
            "does not depend on the camera",
        ),
        (["--object=floor", "--white=2"], "no picture"),
        (["--camera", "--white=2"], "no picture"),
        (["--camera", "--exposure=90 %"], "no picture"),
        (["--camera", "--time=1 m"], "light of all times"),
        (["--camera", "--texels=8x8"], "cannot be used with"),
    ] {
        let run = folder.run(&[&["bake", "lit.toml", "--bin-width=1 m"], &options[..]].concat());
        assert_eq!(run.code, 2, "{options:?}");
        let said = run.message();
        assert!(
            said.contains(words) && said.contains(options[1].split('=').next().unwrap()),
            "{said}"
        );
    }
}

#[test]
fn the_help_of_bake_shows_no_option_that_it_refuses() {
    let help = Folder::empty().ok(&["bake", "--help"]);
    for option in ["--exposure", "--white", "--time "] {
        assert!(!help.contains(option), "{option}: {help}");
    }
    assert!(help.contains("--spp"), "{help}");
}

/// A floor, and a chest that moves along it.
fn moving() -> String {
    let chest = "[[object]]\nname = \"chest\"\nshape = { box = { size = [1, 1, 1] } }\nvelocity = { beta = [0.5, 0, 0] }\n";
    format!("{FLASH}{chest}{LIGHT}")
}

#[test]
fn what_cannot_be_baked_is_refused_and_leaves_no_file() {
    let without = "spectrum = { blackbody = \"3000 K\" }\n[radiance]\nquantity = \"rgb\"";
    for (scene, options, words) in [
        (ball(without), &[][..], "it shows its own `spectrum`"),
        (
            ball(without),
            &["--object=floor"],
            "there is nothing to bake",
        ),
        (ball(""), &["--uv=3"], "no texture coordinates of set 3"),
        (ball(""), &["--atlas", "--texels=6x6"], "--texels"),
        (
            FLASH.replace("plane = { size = [4, 4] }", "box = { size = [4, 1, 4] }") + LIGHT,
            &["--uv=0"],
            "charts overlap",
        ),
        (
            FLASH.replace("hfov", "projection = \"fisheye_equidistant\"\nhfov") + LIGHT,
            &["--camera"],
            "through a perspective camera only",
        ),
        (
            ball(""),
            &["--object=floor", "--object=floor"],
            "give each cube a name of its own",
        ),
        // Of a wrong name it does not matter what moves.
        (
            moving(),
            &["--object=nope"],
            "there is no object of this name",
        ),
        (moving(), &["--object=chest"], "it moves relative to"),
    ] {
        let folder = Folder::empty();
        folder.write("lit.toml", scene);
        let bake = ["bake", "lit.toml", "--bin-width=1 m", "-o=a.npz"];
        let run = folder.run(&[&bake[..], options].concat());
        assert_eq!(run.code, 2, "{words}: {}", run.stderr);
        assert!(run.message().contains(words), "{}", run.stderr);
        assert!(!folder.path("a.npz").exists(), "{words}");
        assert!(!folder.path("a.npz.parts").exists(), "{words}");
    }
}

#[test]
fn an_object_that_shines_for_ever_is_refused_in_a_plan_too() {
    let folder = Folder::empty();
    let glow = "[[object]]\nname = \"glow\"\nshape = { sphere = { radius = 0.1 } }\nspectrum = { blackbody = \"3000 K\" }\n";
    let rgb = "[radiance]\nquantity = \"rgb\"\n";
    folder.write("lit.toml", format!("{FLASH}{glow}{LIGHT}{rgb}"));
    for options in [
        &["--camera", "--plan"][..],
        &["--camera"],
        &["--object=floor", "--plan"],
        &["--object=floor"],
    ] {
        let bake = ["bake", "lit.toml", "--bin-width=1 m", "-o=a.npz"];
        let run = folder.run(&[&bake[..], options].concat());
        assert_eq!(run.code, 2, "{options:?}: {}", run.stderr);
        let said = run.message();
        for words in ["\"glow\"", "it never stops shining", "type = \"area\""] {
            assert!(said.contains(words), "{options:?}: {said}");
        }
        assert_eq!(folder.names(), ["lit.toml"], "{options:?}");
    }
}

#[test]
fn a_train_without_an_end_is_told_how_to_have_one() {
    let folder = Folder::empty();
    let train = "gaussian = { sigma = \"30 cm\" }";
    let bake = |count: &str| {
        let endless = format!("train = {{ sigma = \"30 cm\", period = \"2 m\"{count} }}");
        folder.write(
            "lit.toml",
            FLASH.to_owned() + &LIGHT.replace(train, &endless),
        );
        folder.run(&[
            "bake",
            "lit.toml",
            "--bin-width=1 m",
            "--texels=4x4",
            "--spp=1",
        ])
    };
    let said = bake("").message();
    assert!(
        said.contains("it never stops shining")
            && said.contains("give its train a `count` of pulses"),
        "{said}"
    );
    assert_eq!(bake(", count = 2").code, 0);
}

#[test]
fn what_cannot_be_baked_of_one_object_is_refused_before_the_others_are_baked() {
    let folder = Folder::empty();
    let chest = "[[object]]\nname = \"chest\"\nshape = { box = { size = [1, 1, 1] } }\n";
    folder.write("lit.toml", format!("{FLASH}{chest}{LIGHT}"));
    let bake = ["bake", "lit.toml", "--bin-width=1 m", "-o=a.npz"];
    for options in [&["--uv=0"][..], &["--uv=0", "--plan"]] {
        let run = folder.run(&[&bake[..], options].concat());
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.message().contains("\"chest\""), "{}", run.stderr);
        assert!(run.message().contains("charts overlap"), "{}", run.stderr);
        assert!(!folder.path("a-floor.npz").exists());
    }
    // Each object by itself, and both with an atlas.
    folder.ok(&[&bake[..], &["--object=floor"]].concat());
    folder.ok(&[&bake[..], &["--atlas", "--plan"]].concat());
}
