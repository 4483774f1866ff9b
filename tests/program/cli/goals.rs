//! `nullray bake --error` and `--budget`: how many samples are chosen.

use super::Folder;

/// A floor in front of a wall, and a flash.
const LIT: &str = r#"
render = { bounces = 1 }
[camera]
eye = [0, 2, 4]
look_at = [0, 0, 0]
size = [32, 32]
[[object]]
name = "floor"
shape = { plane = { size = [4, 4] } }
[[object]]
name = "wall"
shape = { box = { size = [4, 3, 0.1] } }
origin = { position = [0, 1.5, -1] }
[[light]]
position = [0.5, 1.5, 0.5]
intensity = 5
emission = { gaussian = { sigma = "30 cm" } }
"#;

/// What bakes the floor.
const FLOOR: [&str; 6] = [
    "bake",
    "lit.toml",
    "--object=floor",
    "--bin-width=30 cm",
    "--bins=40",
    "--texels=16x16",
];

fn folder() -> Folder {
    let folder = Folder::empty();
    folder.write("lit.toml", LIT);
    folder
}

/// The number of samples that were chosen, and the error of the result in per cent.
fn chosen(said: &str) -> (u32, f64) {
    let before = |text: &str| {
        let (before, _) = said.split_once(text).unwrap_or_else(|| panic!("{said}"));
        before.rsplit(' ').next().unwrap().parse::<f64>().unwrap()
    };
    let samples = before(" samples per");
    (samples as u32, before(" % of the root mean square of all"))
}

/// The numbers of a bake.
fn radiance(folder: &Folder, file: &str) -> Vec<u8> {
    let bytes = std::fs::read(folder.path(file)).unwrap();
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).unwrap();
    let mut numbers = Vec::new();
    let mut array = archive.by_name("radiance.npy").unwrap();
    std::io::Read::read_to_end(&mut array, &mut numbers).unwrap();
    numbers
}

#[test]
fn a_bake_for_an_error_has_it_and_the_bits_of_as_many_samples() {
    let folder = folder();
    for way in [
        &FLOOR[..],
        &[
            "bake",
            "lit.toml",
            "--camera",
            "--bin-width=30 cm",
            "--start=3 m",
        ],
    ] {
        let bake = |more: &[&str]| folder.ok(&[way, more].concat());
        let mut last = 16;
        for wanted in [8.0, 2.0] {
            let error = format!("--error={wanted} %");
            let (samples, error) = chosen(&bake(&[&error, "-o", "a.npz"]));
            assert!(error > 0.0 && error <= wanted, "{error} {wanted}");
            assert!(samples > last && samples.is_power_of_two(), "{samples}");
            last = samples;
            // What it says of itself makes it again.
            let info = folder.ok(&["info", "a.npz"]);
            assert!(
                info.contains(&format!("({samples} samples each)")),
                "{info}"
            );
            bake(&["-o", "b.npz", "--spp", &samples.to_string()]);
            assert!(radiance(&folder, "a.npz") == radiance(&folder, "b.npz"));
        }
    }
}

#[test]
fn a_bake_without_time_takes_the_fewest_samples_and_says_what_it_lacks() {
    let folder = folder();
    let run = folder.run(&[&FLOOR[..], &["--budget=0 s", "--error=1 %", "-o", "a.npz"]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (samples, error) = chosen(&run.stdout);
    assert!(samples == 2 && error > 1.0, "{samples} {error}");
    let lacking = "more than the 1 % asked for: --spp 4 takes twice as long";
    assert!(
        run.stderr.contains(lacking) && run.stderr.contains("a.npz: its error is"),
        "{}",
        run.stderr
    );
    // With time, the error decides.
    let said = folder.ok(&[&FLOOR[..], &["--budget=1 h", "--error=8 %", "-o", "b.npz"]].concat());
    assert!(chosen(&said).1 <= 8.0, "{said}");
    // Samples that are given are not chosen.
    for also in ["--spp=4", "--pixel-centers"] {
        let refused = folder.run(&[&FLOOR[..], &["--error=5 %", also]].concat());
        assert_eq!(refused.code, 2);
        assert!(
            refused.stderr.contains("cannot be used with"),
            "{}",
            refused.stderr
        );
    }
    assert!(!folder.path("lit-light.npz").exists());
}

#[test]
fn a_bake_that_was_stopped_is_resumed_with_the_samples_that_were_chosen() {
    let folder = folder();
    // Energies too large for half precision are refused at the end, and parts are kept.
    let bright = LIT.replace("intensity = 5", "intensity = 1e9");
    folder.write("lit.toml", &bright);
    let bake = [&FLOOR[..], &["--error=5 %", "-o", "a.npz"]].concat();
    let stopped = folder.run(&[&bake[..], &["--half"]].concat());
    assert_eq!(stopped.code, 2, "{}", stopped.stderr);
    assert!(stopped.stdout.contains("a trial of"), "{}", stopped.stdout);
    let resumed = folder.ok(&bake);
    assert!(resumed.contains("resuming a.npz"), "{resumed}");
    assert!(!resumed.contains("a trial of"), "{resumed}");
    let fresh = folder.ok(&[&FLOOR[..], &["--error=5 %", "-o", "b.npz"]].concat());
    assert!(fresh.contains("a trial of"), "{fresh}");
    assert!(radiance(&folder, "a.npz") == radiance(&folder, "b.npz"));
}
