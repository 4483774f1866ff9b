//! Ctrl-C: a quick end, with exit code 130, and every file as it was.
#![cfg(unix)]

use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use super::{Folder, SMALL};

/// Sends `signal` after `delay` to a rendering; how long it then took to end.
fn stopped(folder: &Folder, arguments: &[&str], signal: &str, delay: Duration) -> Duration {
    let (took, said) = stopped_saying(folder, arguments, signal, delay);
    assert_eq!(said, STOPPED);
    took
}

const STOPPED: &str = "nullray: stopped; no unfinished file is left\n";

/// The same, and what was said.
fn stopped_saying(
    folder: &Folder,
    arguments: &[&str],
    signal: &str,
    delay: Duration,
) -> (Duration, String) {
    let (took, output) = signalled(folder, arguments, signal, || std::thread::sleep(delay));
    assert_eq!(output.stdout, b"");
    (took, String::from_utf8(output.stderr).unwrap())
}

/// Sends `signal` to the program with these arguments once `wait` returns; how long it then took to end with exit code 130, and what it wrote.
fn signalled(
    folder: &Folder,
    arguments: &[&str],
    signal: &str,
    wait: impl FnOnce(),
) -> (Duration, Output) {
    stop(folder.command(arguments), signal, wait)
}

/// The same for a program with an environment of its own.
fn stop(mut program: Command, signal: &str, wait: impl FnOnce()) -> (Duration, Output) {
    let child = program
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait();
    let id = child.id().to_string();
    let kill = Command::new("kill").args([signal, &id]).status();
    assert!(kill.unwrap().success());
    let start = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{signal}: {output:?}");
    (start.elapsed(), output)
}

/// Waits until something is so, which is soon, or for two minutes.
fn until(is_so: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_so() && start.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// A second is the promise; the rest is for machines that run other tests meanwhile.
const SOON: Duration = Duration::from_millis(3000);

#[test]
fn rendering_stops_and_leaves_every_file_as_it_was() {
    let folder = Folder::new();
    folder.write("old.png", "precious");
    for signal in ["-INT", "-TERM"] {
        let arguments = [
            "render",
            "scene.toml",
            "--size",
            "4000x4000",
            "--spp",
            "1000",
            "-o",
            "old.png",
        ];
        let took = stopped(&folder, &arguments, signal, Duration::from_millis(1200));
        assert!(took < SOON, "{signal}: {took:?}");
        assert_eq!(folder.names(), ["old.png", "scene.toml"]);
        assert_eq!(folder.read("old.png"), b"precious");
    }
}

#[test]
fn passes_that_are_stopped_before_anything_is_saved_do_not_say_that_something_is_kept() {
    let folder = Folder::new();
    let arguments = [
        "render",
        "scene.toml",
        "--size=4000x4000",
        "--spp=1000",
        "--passes=8",
        "-o=new.exr",
    ];
    // `stopped` compares all that is said.
    stopped(&folder, &arguments, "-INT", Duration::from_millis(1200));
    assert_eq!(folder.names(), ["scene.toml"]);
}

/// A floor and a flash.
const LIT: &str = r#"
[camera]
eye = [0, 2, 4]
look_at = [0, 0, 0]
size = [16, 16]
[[object]]
name = "floor"
shape = { plane = { size = [4, 4] } }
[[light]]
position = [0.5, 1.5, 0]
emission = { gaussian = { sigma = "30 cm" } }
"#;

#[test]
fn a_bake_that_is_stopped_can_be_resumed_once_a_part_is_kept_and_says_so_then_alone() {
    let folder = Folder::empty();
    folder.write("lit.toml", LIT);
    // A row of texels, or a tile of pixels, takes more than some seconds.
    let bins = ["--bin-width=10 cm", "--bins=100", "-o=a.npz"];
    let bake = [&["bake", "lit.toml"], &bins[..]].concat();
    for options in [
        ["--spp=65536", "--texels=20000x2"],
        ["--spp=65536", "--camera"],
    ] {
        let arguments = [&bake[..], &options].concat();
        let (_, said) = stopped_saying(&folder, &arguments, "-INT", Duration::from_millis(1200));
        let anew =
            format!("{STOPPED}no part was finished; running the command again starts over\n");
        assert_eq!(said, anew);
        assert_eq!(folder.names(), ["lit.toml"]);
    }
    // Rows that are soon done, and very many of them.
    let arguments = [&bake[..], &["--spp=64", "--texels=16x40000"]].concat();
    let kept = || std::fs::metadata(folder.path("a.npz.parts")).map_or(0, |file| file.len());
    // Several parts of 16 texels with 100 bins.
    let several = || until(|| kept() >= 100_000);
    let (_, output) = signalled(&folder, &arguments, "-INT", several);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        said,
        "nullray: stopped; its finished parts are kept: run the same command again to resume\n"
    );
    assert_eq!(folder.names(), ["a.npz.parts", "lit.toml"]);
}

#[test]
fn a_bake_that_is_stopped_at_its_second_object_keeps_the_first() {
    let second = "[[object]]\nname = \"wall\"\nshape = { plane = { size = [4, 4] } }\ntransform = { translate = [0, -1, 0] }\n";
    let folder = Folder::empty();
    folder.write("lit.toml", format!("{LIT}{second}"));
    let bake = ["bake", "lit.toml", "--bin-width=10 cm", "--bins=100"];
    for kind in ["npz", "npy"] {
        let name = |name: &str| format!("a-{name}.{kind}");
        let output = format!("-o=a.{kind}");
        let arguments = [&bake[..], &["--spp=16", "--texels=16x4000", &output]].concat();
        let begun = folder.path(&(name("wall") + ".parts"));
        let (_, output) = signalled(&folder, &arguments, "-INT", || until(|| begun.exists()));
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains(&format!("wrote {}", name("floor"))), "{said}");
        let first = folder.read(&name("floor"));
        let said = folder.ok(&arguments);
        // What a .npy holds is put together again from its parts, and that of an archive is known.
        let words = match kind {
            "npz" => format!("{} exists already", name("floor")),
            _ => format!("resuming {}", name("floor")),
        };
        assert!(said.contains(&words), "{said}");
        assert!(
            said.contains(&format!("resuming {}", name("wall"))),
            "{said}"
        );
        assert!(folder.read(&name("floor")) == first);
        let left = folder.names().into_iter();
        let left: Vec<_> = left.filter(|name| name.ends_with(".parts")).collect();
        assert!(left.is_empty(), "{left:?}");
    }
}

#[test]
fn building_stops_too() {
    let folder = Folder::empty();
    // Many spheres of 1.3 million triangles: minutes of work on trees, none of which looks at the flag.
    let mut scene = SMALL.split("[[object]]").next().unwrap().to_string();
    for i in 0..24 {
        scene += &format!(
            "[[object]]\nshape = {{ sphere = {{ radius = 1, subdivisions = 8 }} }}\n\
             origin = {{ position = [{i}, 0, 0], time = \"0 m\" }}\n"
        );
    }
    folder.write("scene.toml", scene);
    let took = stopped(
        &folder,
        &["render", "scene.toml"],
        "-INT",
        Duration::from_millis(900),
    );
    assert!(took < SOON, "{took:?}");
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn writing_stops_and_clears_its_temporary_file_away() {
    let folder = Folder::new();
    let arguments = [
        "render",
        "scene.toml",
        "--size",
        "1500x1500",
        "--spp",
        "1",
        "--aovs",
        "all",
        "-o",
        "big.npz",
    ];
    // The temporary file shows that writing has begun.
    let begun = || folder.names().iter().any(|n| n.ends_with(".part"));
    let (took, _) = signalled(&folder, &arguments, "-INT", || {
        until(begun);
        assert!(begun(), "{:?}", folder.names());
    });
    assert!(took < SOON, "{took:?}");
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn a_sequence_stops_with_whole_frames_and_says_how_to_go_on() {
    let folder = Folder::new();
    let arguments = [
        "render",
        "scene.toml",
        "--frames",
        "0..10000",
        "--interval",
        "1 mm",
        "-o",
        "f.png",
        "--white",
        "1",
    ];
    let several = || until(|| folder.names().len() >= 4);
    let (_, output) = signalled(&folder, &arguments, "-INT", several);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("run the same command again"), "{said}");
    let names = folder.names();
    let frames: Vec<_> = names.iter().filter(|n| *n != "scene.toml").collect();
    assert!(frames.len() >= 3, "{names:?}");
    // All that is there is taken as it is when the command is given again.
    let whole = format!("0..{}", frames.len());
    let again = arguments.map(|word| if word == "0..10000" { &whole } else { word });
    let said = folder.ok(&again);
    let all = format!("0 rendered, {} existed already", frames.len());
    assert!(said.contains(&all), "{said}");
}

#[test]
fn the_self_test_stops_in_the_midst_of_its_rays() {
    let arguments = ["selftest", "--thorough", "--json"];
    let took = stopped(
        &Folder::empty(),
        &arguments,
        "-INT",
        Duration::from_millis(1500),
    );
    assert!(took < SOON, "{took:?}");
}

#[test]
fn a_film_for_a_pipe_does_not_say_that_it_can_be_resumed_and_leaves_no_picture() {
    // The first picture is larger than what a pipe holds, and nobody reads it.
    let frames = "render scene.toml --frames 0..10000 --interval 1mm --white 1 --size 300x200 -o -";
    let arguments: Vec<_> = frames.split(' ').collect();
    let (folder, pictures) = (Folder::new(), Folder::empty());
    let mut program = folder.command(&arguments);
    program.env("TMPDIR", pictures.path("."));
    let wait = || std::thread::sleep(Duration::from_millis(1500));
    let (took, output) = stop(program, "-INT", wait);
    assert_eq!(String::from_utf8(output.stderr).unwrap(), STOPPED);
    assert!(took < SOON, "{took:?}");
    assert!(pictures.names().is_empty());
}

#[test]
fn panels_that_passes_have_finished_are_kept_and_nothing_is_said_to_be_kept_of_one_without_a_save()
{
    let folder = Folder::empty();
    let panels = "[[panel]]\nname = \"one\"\n[[panel]]\nname = \"two\"\nset = { camera.size = [400, 400], display.samples_per_pixel = 65536 }\n";
    folder.write("p.toml", format!("{SMALL}{panels}"));
    let error = ["--error", "60 %"];
    let one = ["render", "p.toml", "--panel", "one", "-o", "x-one.npz"];
    let one = [&one[..], &error].concat();
    folder.ok(&[&one[..], &["--passes", "2"]].concat());
    // The first panel resumes, and is done; the first pass of the second takes hours.
    let sums = folder.path("x-one.npz.passes");
    assert!(sums.exists());
    let both = [&["render", "p.toml", "-o", "x.npz"][..], &error].concat();
    let (_, output) = signalled(&folder, &both, "-TERM", || until(|| !sums.exists()));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("resuming after pass 2"), "{said}");
    let said = String::from_utf8(output.stderr).unwrap();
    let words = "nullray: stopped; finished panels are kept: run the same command again to render the others\n";
    assert!(said.ends_with(words), "{said}");
    assert_eq!(folder.names(), ["p.toml", "x-one.npz"]);
    let first = folder.read("x-one.npz");
    let said = folder.ok(&one);
    assert!(said.ends_with("x-one.npz exists already\n"), "{said}");
    assert!(folder.read("x-one.npz") == first);
    // Of another error or scene it is rendered.
    for more in [["--passes", "40"], ["--set", "render.seed=3"]] {
        let said = folder.ok(&[&one[..], &more].concat());
        assert!(said.contains("wrote x-one.npz"), "{said}");
    }
}
