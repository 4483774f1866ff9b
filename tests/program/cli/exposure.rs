//! The brightness of pictures: exposure of series, scales and captions.

use nullray::io::image::{exr, png};

use super::frames::{FOUR, folder, sequence};
use super::refused::refused;
use super::{Folder, SMALL};

/// What a PNG picture says of itself under `key`.
pub(super) fn entry(folder: &Folder, name: &str, key: &str) -> Option<String> {
    let text = png::inspect(&folder.path(name)).unwrap().text;
    text.into_iter()
        .find(|(k, _)| k == key)
        .map(|(_, value)| value)
}

#[test]
fn frames_can_have_one_exposure() {
    let folder = folder();
    let options = [
        "--same-exposure",
        "--set",
        "display.white=0.5",
        "-o",
        "a.png",
    ];
    let fixed = [&FOUR[..], &options].concat();
    // What the scene says itself holds.
    folder.ok(&sequence(&fixed));
    assert_eq!(entry(&folder, "a-0000.png", "white").unwrap(), "0.5");
    folder.write("auto.toml", SMALL);
    let auto = [&["render", "auto.toml"], &FOUR[..], &["-o", "b.png"]].concat();
    let said = folder.ok(&auto);
    assert!(
        said.contains("one exposure for all frames: white is radiance "),
        "{said}"
    );
    let whites =
        ["b-0000.png", "b-0001.png", "b-0003.png"].map(|name| entry(&folder, name, "white"));
    assert!(whites[0].is_some() && whites[0] == whites[1] && whites[1] == whites[2]);
    // The same again: all frames are there.
    assert!(folder.ok(&auto).contains("0 rendered, 4 existed already"));
    // One that is missing is rendered with the same exposure, bit for bit.
    let whole = std::fs::read(folder.path("b-0002.png")).unwrap();
    std::fs::remove_file(folder.path("b-0002.png")).unwrap();
    folder.ok(&auto);
    assert!(std::fs::read(folder.path("b-0002.png")).unwrap() == whole);
    // Each its own, on request.
    let own = [
        &["render", "auto.toml"],
        &FOUR[..],
        &["--own-exposure", "-o", "c.png"],
    ]
    .concat();
    assert!(!folder.ok(&own).contains("one exposure"));
    let both = [
        "render",
        "auto.toml",
        "--own-exposure",
        "--same-exposure",
        "-o",
        "d.png",
    ];
    refused(&folder, &both, &["cannot be used with"]);
}

#[test]
fn a_png_can_have_16_bits() {
    let folder = folder();
    folder.ok(&[
        "render",
        "scene.toml",
        "--set",
        "display.bits=16",
        "-o",
        "deep.png",
        "-o",
        "deep.exr",
    ]);
    let info = png::inspect(&folder.path("deep.png")).unwrap();
    assert_eq!(info.bits, 16);
    // Codes are those of the radiance over white, to half a step of 65535.
    let codes = png::read(&folder.path("deep.png"), &Default::default())
        .unwrap()
        .radiance()
        .unwrap();
    let light = exr::read(&folder.path("deep.exr"), &Default::default())
        .unwrap()
        .radiance()
        .unwrap();
    for (codes, light) in codes.into_iter().zip(light) {
        for (code, light) in codes.into_iter().zip(light) {
            let linear = light / 0.5;
            let expected = match linear {
                l if l <= 0.0031308 => 12.92 * l,
                l => 1.055 * l.powf(1.0 / 2.4) - 0.055,
            };
            assert!(
                linear > 1.0 || (code - expected).abs() < 0.6 / 65535.0,
                "{code} {expected}"
            );
        }
    }
    refused(
        &folder,
        &["render", "scene.toml", "--set", "display.bits=12"],
        &["12 bits"],
    );
}

#[test]
fn luminance_is_drawn_with_a_legend() {
    let folder = folder();
    folder.ok(&[
        "render",
        "scene.toml",
        "--luminance",
        "map.png",
        "-o",
        "a.png",
    ]);
    let info = png::inspect(&folder.path("map.png")).unwrap();
    assert!(info.width > 12 && info.height > 9);
    let arguments = ["render", "scene.toml", "--luminance", "map.exr"];
    refused(&folder, &arguments, &["end its name in .png"]);
}

#[test]
fn a_picture_can_have_a_caption_with_time_and_speed() {
    let folder = folder();
    let size = |name: &str| {
        let info = png::inspect(&folder.path(name)).unwrap();
        [info.width, info.height]
    };
    folder.ok(&["render", "scene.toml", "-o", "plain.png", "-o", "plain.exr"]);
    let caption = ["--caption", "a crate", "-o", "words.png", "-o", "words.exr"];
    folder.ok(&[&["render", "scene.toml"][..], &caption].concat());
    let ([w, h], [wide, high]) = (size("plain.png"), size("words.png"));
    // Small pictures are enlarged to 240 pixels; words beneath.
    assert!(wide > w && high > h && wide >= 240, "{wide} {high}");
    let data = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert_eq!(data("plain.exr"), data("words.exr"));
    // The scene can say it, and 16 bits hold it.
    let set = ["--set", "display.caption=a crate", "-o", "said.png"];
    folder.ok(&[&["render", "scene.toml"][..], &set].concat());
    assert_eq!(size("said.png"), [wide, high]);
    let deep = [
        "--set",
        "display.bits=16",
        "--caption",
        "a crate",
        "-o",
        "deep.png",
    ];
    folder.ok(&[&["render", "scene.toml"][..], &deep].concat());
    assert_eq!(size("deep.png"), [wide, high]);
    let light = |name: &str| {
        let read = png::read(&folder.path(name), &Default::default()).unwrap();
        read.radiance().unwrap()
    };
    for (a, b) in light("words.png").into_iter().zip(light("deep.png")) {
        for (a, b) in a.into_iter().zip(b) {
            assert!((a - b).abs() < 0.51 / 255.0, "{a} {b}");
        }
    }
    // Another speed has other words, another text too.
    let other = [
        "--caption",
        "a crate",
        "--set",
        "camera.velocity.beta=[0,0,-0.2]",
    ];
    folder.ok(&[&["render", "scene.toml", "-o", "other.png"][..], &other].concat());
    assert_ne!(data("words.png"), data("other.png"));
    refused(
        &folder,
        &["render", "scene.toml", "--caption", "\u{1F600}"],
        &["\u{1F600}"],
    );
}

#[test]
fn one_logarithmic_scale_holds_pictures_of_any_brightness() {
    let folder = folder();
    let render = |name: &str, intensity: &str, more: &[&str]| {
        let set = format!("source.lamp.pulse.intensity={intensity}");
        let scale = "display={logarithmic=[1e-6,1e6]}";
        let first = [
            "render",
            "scene.toml",
            "--set",
            scale,
            "--set",
            &set,
            "-o",
            name,
        ];
        folder.ok(&[&first[..], more].concat())
    };
    let said = render("dark.png", "0.01", &[]);
    assert!(
        said.contains("by the logarithm of radiance, from 1.0000e-6 to 1000000"),
        "{said}"
    );
    render("bright.png", "100", &[]);
    let codes = |name: &str| {
        let read = png::read(&folder.path(name), &Default::default()).unwrap();
        read.radiance().unwrap()
    };
    // Four of twelve decades are 85 of 255 codes.
    let mut lit = 0;
    for (a, b) in codes("dark.png").into_iter().zip(codes("bright.png")) {
        let [a, b] = [a, b].map(|rgb| rgb.into_iter().fold(0.0, f64::max) * 255.0);
        if a > 20.0 {
            lit += 1;
            assert!((b - a - 85.0).abs() <= 1.0, "{a} {b}");
        }
    }
    assert!(lit > 5, "{lit}");
    assert_eq!(
        entry(&folder, "dark.png", "logarithmic").unwrap(),
        "0.000001 1000000"
    );
    assert_eq!(entry(&folder, "dark.png", "white"), None);
    // An exposure on the command line takes its place.
    render("white.png", "100", &["--white", "0.5"]);
    assert_eq!(entry(&folder, "white.png", "white").unwrap(), "0.5");
}

#[test]
fn the_old_word_for_brightness_alone_is_known() {
    let folder = Folder::empty();
    folder.write(
        "a.toml",
        SMALL.to_owned() + "[radiance]\nquantity = \"integrated\"\n",
    );
    folder.write(
        "b.toml",
        SMALL.to_owned() + "[radiance]\nquantity = \"luminance\"\n",
    );
    for name in ["a", "b"] {
        folder.ok(&[
            "render",
            &format!("{name}.toml"),
            "-o",
            &format!("{name}.png"),
        ]);
    }
    let read = |name: &str| {
        let read = png::read(&folder.path(name), &Default::default()).unwrap();
        read.radiance().unwrap()
    };
    assert_eq!(read("a.png"), read("b.png"));
}
