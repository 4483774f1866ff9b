//! Spectra, exposure of series, and what is said of dark pictures.

use nullray::io::image::{Channel, Layers, Samples, exr, png};

use super::frames::{FOUR, folder, sequence};
use super::refused::refused;
use super::{Folder, SMALL};

fn entry(folder: &Folder, name: &str, key: &str) -> Option<String> {
    let text = png::inspect(&folder.path(name)).unwrap().text;
    text.into_iter()
        .find(|(k, _)| k == key)
        .map(|(_, value)| value)
}

#[test]
fn a_sky_alone_is_a_scene() {
    let folder = Folder::new();
    let scene = |sky: &str| {
        format!(
            "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nhfov = \"90 deg\"\nsize = [32, 24]\n\
             velocity = {{ beta = 0.9, direction = [0, 0, -1] }}\n{sky}"
        )
    };
    let sky = "[sky]\ngradient = {}\n[radiance]\nquantity = \"rgb\"\n";
    folder.write("sky.toml", scene(sky));
    folder.ok(&["plan", "sky.toml"]);
    folder.ok(&["render", "sky.toml", "-o", "alone.npz"]);
    // Something small behind the camera changes nothing.
    let behind =
        "[[object]]\nshape = { sphere = { radius = 0.1 } }\norigin = { position = [0, 0, 50] }\n";
    folder.write("behind.toml", scene(&format!("{sky}{behind}")));
    folder.ok(&["render", "behind.toml", "-o", "behind.npz"]);
    let equal = ["compare", "behind.npz", "alone.npz", "--tolerance", "max=0"];
    folder.ok(&equal);
    folder.ok(&["render", "sky.toml", "--aovs", "all", "-o", "all.npz"]);
    folder.ok(&["compare", "all.npz", "all.npz", "--scene", "sky.toml"]);
    refused(
        &folder,
        &["study", "sky.toml", "-o", "study.csv"],
        &["no geometry"],
    );
    // Without one there is nothing at all.
    folder.write("nothing.toml", scene(""));
    refused(
        &folder,
        &["render", "nothing.toml"],
        &["nothing.toml:1:", "no object and no sky", "[sky]"],
    );
}

#[test]
fn a_spectrum_out_of_sight_is_told_and_no_other_time_is_advised() {
    let folder = Folder::new();
    folder.write(
        "line.toml",
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nhfov = \"20 deg\"\nsize = [24, 16]\n\
         velocity = { beta = 0.5, direction = [0, 0, -1] }\n\
         [[object]]\nshape = { sphere = { radius = 1 } }\nspectrum = { line = \"589 nm\" }\n\
         [radiance]\nquantity = \"rgb\"\n",
    );
    let said = folder.ok(&["render", "line.toml", "-o", "line.png"]);
    assert!(
        said.contains("the spectrum of \"sphere\" is seen with 0.57"),
        "{said}"
    );
    assert!(said.contains("nothing of its light is visible"), "{said}");
    assert!(!said.contains("another --time"), "{said}");
}

/// A box whose picture is smaller than a pixel, so that no centre of one meets it: ahead at 0.9 c a line at 589 nm is seen at
/// 0.23 times that.
#[test]
fn a_small_picture_of_a_spectrum_out_of_sight_has_the_same_reason() {
    let folder = Folder::new();
    folder.write(
        "small.toml",
        "[camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\nhfov = \"40 deg\"\nsize = [8, 6]\n\
         velocity = { beta = 0.9, direction = [0, 0, -1] }\n\
         [[object]]\nshape = { box = { size = [1, 1, 1] } }\nspectrum = { line = \"589 nm\" }\n\
         [radiance]\nquantity = \"rgb\"\n",
    );
    for size in ["8x6", "80x60"] {
        let said = folder.ok(&["render", "small.toml", "--size", size, "-o", "small.png"]);
        for part in ["nothing of its light is visible", "in view has 0.2"] {
            assert!(said.contains(part), "{size}: {said}");
        }
        assert!(!said.contains("another --time"), "{size}: {said}");
    }
}

#[test]
fn lights_without_a_name_are_set_by_the_names_of_their_types() {
    let folder = Folder::new();
    let light = "[[light]]\nposition = [0, 3, 0]\n";
    folder.write("lamps.toml", format!("{SMALL}{light}{light}"));
    let plan = |intensity: &str| folder.ok(&["plan", "lamps.toml", "--set", intensity]);
    plan("light.point.intensity=3");
    plan("light.point-2.intensity=3");
    let lost = ["plan", "lamps.toml", "--set", "light.lamp.intensity=3"];
    refused(&folder, &lost, &["\"point\", \"point-2\""]);
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
fn light_that_is_shifted_out_of_sight_is_said_to_be() {
    let folder = Folder::empty();
    // Straight away from a wall at γ = 1000: W is near 2γ.
    let scene = "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [8, 6]\n\
                 velocity = { gamma = 1000, direction = [0, 0, 1] }\n[radiance]\nquantity = \"rgb\"\n\
                 continuation = \"dark\"\n[[object]]\nshape = { box = { size = [100, 100, 1] } }\n";
    folder.write("w.toml", scene);
    let said = folder.ok(&["render", "w.toml", "-o", "w.png"]);
    assert!(said.contains("the picture is black"), "{said}");
    assert!(
        said.contains("times the wavelength that it left with"),
        "{said}"
    );
    let said = folder.ok(&[
        "render",
        "w.toml",
        "-o",
        "w.png",
        "--set",
        "effects.doppler=false",
    ]);
    assert!(!said.contains("wavelength that it left with"), "{said}");
}

/// A floor of 2 m seen from 4 m above, and a pulse from 3 m above it at ct = 10 m.
const PULSE: &str = "
[camera]
eye = [0, 4, 0]
look_at = [0, 0, 0]
up = [0, 0, -1]
hfov = \"20 deg\"
size = [9, 9]
[[object]]
shape = { plane = { size = [2, 2] } }
[[source]]
name = \"flash\"
pulse = { position = [0, 3, 0], time = \"10 m\", sigma = \"1 cm\" }
";

#[test]
fn a_dark_picture_says_when_the_light_left_and_when_to_look() {
    let folder = Folder::empty();
    folder.write("pulse.toml", PULSE);
    let said = folder.ok(&["render", "pulse.toml", "-o", "a.png"]);
    // The light that is seen at 0 was on the floor at −4 m and less, and would have left the lamp at −7 m.
    let line = said
        .lines()
        .find(|line| line.starts_with("source \"flash\""))
        .expect(&said);
    assert!(
        line.contains("and -7 m; its data span 9.96 m to 10.04 m"),
        "{line}"
    );
    // At rest, a shot that is later by t sees light that left later by t: from 9.96 + 7 m on.
    assert!(line.contains("try --time \"16.96 m\" to"), "{line}");
    let said = folder.ok(&["render", "pulse.toml", "--time", "17 m", "-o", "b.png"]);
    assert!(!said.contains("black"), "{said}");
}

#[test]
fn spectra_that_cannot_be_are_refused_in_their_place() {
    let folder = Folder::empty();
    let scene = PULSE.split("[[source]]").next().unwrap();
    folder.write("lamp.csv", "400,1\n300,1\n");
    for (spectrum, said) in [
        ("{ blackbody = \"-5 K\" }", "a temperature of -5 K"),
        ("{ blackbody = \"5 nm\" }", "is not a unit of a temperature"),
        ("{ line = \"0 nm\" }", "a wavelength of 0 nm"),
        ("{ line = \"10 um\" }", "nobody at rest sees anything"),
        ("{ lines = [] }", "0 lines"),
        (
            "{ lines = [{ wavelength = \"500 nm\", energy = -1 }] }",
            "below 0",
        ),
        ("{ line = \"500 nm\", blackbody = \"5 K\" }", "given twice"),
        (
            "{ gaussian = { centre = \"500 nm\", sigma = \"0 nm\" } }",
            "wavelength of 0 nm",
        ),
        (
            "{ gaussian = { centre = \"500 nm\", sigma = \"1 um\" } }",
            "a standard deviation of 1 um",
        ),
        (
            "{ flat = [\"500 nm\", \"400 nm\"] }",
            "400 nm is not longer than 500 nm",
        ),
        ("{ rgb = [1, -1, 0] }", "a colour is below 0"),
        (
            "{ rgb = [1, 1, 0], total = 1 }",
            "no sum over all wavelengths",
        ),
        (
            "{ line = \"500 nm\", continuation = \"dark\" }",
            "is continued",
        ),
        (
            "{ line = \"500 nm\", luminance = 1, total = 1 }",
            "given twice",
        ),
        ("{ line = \"500 nm\", luminance = -1 }", "below 0"),
        ("{ table = \"none.csv\" }", "cannot find this file"),
        ("{ table = \"lamp.npy\" }", "neither a .csv nor a .txt file"),
        (
            "{ table = \"lamp.csv\" }",
            "line 2: 300 nm does not come after",
        ),
        ("{ luminance = 1 }", "nothing of its wavelengths"),
    ] {
        let rgb = "[radiance]\nquantity = \"rgb\"\n";
        folder.write("bad.toml", format!("{scene}spectrum = {spectrum}\n{rgb}"));
        refused(&folder, &["render", "bad.toml"], &[said]);
    }
    // As of lights and skies, only where radiance is that of spectra.
    folder.write(
        "bad.toml",
        format!("{scene}spectrum = {{ line = \"589 nm\" }}\n"),
    );
    let said = [
        "an object has a spectrum where",
        "set quantity = \"rgb\" in [radiance], or leave `spectrum` out",
    ];
    refused(&folder, &["render", "bad.toml"], &said);
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
fn a_lamp_inside_a_body_is_said_to_be() {
    let folder = Folder::empty();
    let scene = |more: &str| {
        format!(
            "[camera]\neye = [0, 1, 6]\nlook_at = [0, 0.5, 0]\nsize = [16, 12]\n             [display]\nback_faces = \"two_sided\"\n             [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [20, 20] }} }}\n             [[object]]\nname = \"crate\"\nshape = {{ box = {{ size = [1, 1, 1] }} }}\n             velocity = {{ beta = [0.6, 0, 0] }}\norigin = {{ position = [0, 0.5, 0] }}\n{more}"
        )
    };
    let with_backs = |backs: &str, lamp: &str| {
        folder.write("in.toml", scene(lamp).replace("two_sided", backs));
        folder.ok(&["render", "in.toml", "-o", "in.png", "--white", "1"])
    };
    let said = |lamp: &str| with_backs("two_sided", lamp);
    let inside =
        "[[light]]\nname = \"bulb\"\nposition = [0, 0.5, 0]\nvelocity = { beta = [0.6, 0, 0] }\n";
    let words = "lamp \"bulb\" is inside \"crate\"";
    assert!(said(inside).contains(words));
    assert!(with_backs("culled", inside).contains(words));
    // In front of it; at rest where it has been when its light left; without shadows; and in a room with the camera.
    for lamp in [
        "[[light]]\nname = \"bulb\"\nposition = [0, 0.5, 2]\nvelocity = { beta = [0.6, 0, 0] }\n",
        "[[light]]\nname = \"bulb\"\nposition = [8, 0.5, 0]\n",
        &format!("{inside}shadows = false\n"),
        "[[light]]\nname = \"bulb\"\nposition = [0, 3, 0]\n\
         [[object]]\nname = \"room\"\nshape = { box = { size = [30, 30, 30] } }\n",
    ] {
        for backs in ["two_sided", "culled"] {
            let said = with_backs(backs, lamp);
            assert!(!said.contains("is inside"), "{backs} {lamp}: {said}");
        }
    }
    // A pulse too.
    let pulse = "[[source]]\nname = \"spark\"\npulse = { position = [-3.6, 0.5, 0], time = \"-6 m\", sigma = \"9 m\" }\n";
    assert!(said(pulse).contains("lamp \"spark\" is inside \"crate\""));
}

#[test]
fn an_area_light_on_a_surface_that_shows_a_cube_is_refused() {
    let folder = Folder::empty();
    let unlit = SMALL.split("[[source]]").next().unwrap();
    let light = "[[light]]\ntype = \"area\"\nobject = \"crate\"\n";
    let cube = |objects: &str| {
        format!(
            "[[source]]\nname = \"film\"\nobjects = [{objects}]\n[source.cube]\nfile = \"film.npy\"\nstart = \"0 m\"\n\
             bin_width = \"1 m\"\nuv = 0\n"
        )
    };
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 3), }";
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.resize(bytes.len() + 48, 0);
    folder.write("film.npy", bytes);
    folder.write("floor.toml", format!("{unlit}{light}{}", cube("\"floor\"")));
    folder.ok(&["plan", "floor.toml"]);
    folder.write(
        "crate.toml",
        format!("{unlit}{light}{}", cube("\"floor\", \"crate\"")),
    );
    let parts = [
        "crate.toml",
        "\"crate\" shows a cube",
        "leave out this light",
    ];
    refused(&folder, &["plan", "crate.toml"], &parts);
}

#[test]
fn a_sky_that_is_not_twice_as_wide_as_high_is_refused() {
    let folder = Folder::empty();
    let channel = |name: &str| Channel {
        name: name.into(),
        samples: Samples::F32(vec![1.0; 30 * 12]),
    };
    let channels = ["R", "G", "B"].map(channel).into();
    let layers = Layers::new(30, 12, channels, vec![]).unwrap();
    exr::write(&folder.path("sky.exr"), &layers).unwrap();
    folder.write(
        "sky.toml",
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [8, 6]\n[sky]\nimage = { file = \"sky.exr\" }\n\
         [[object]]\nshape = { box = { size = [1, 1, 1] } }\n",
    );
    refused(
        &folder,
        &["render", "sky.toml"],
        &[
            "sky.exr",
            "30 by 12 pixels are not 2:1",
            "twice as wide as high",
        ],
    );
}

#[test]
fn a_plan_says_when_light_of_pulses_and_lamps_is_in_view() {
    let folder = Folder::empty();
    folder.write("pulse.toml", PULSE);
    let said = folder.ok(&["plan", "pulse.toml"]);
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("and -7 m; its data span 9.96 m to 10.04 m"),
        "{said}"
    );
    assert!(
        words.contains("the camera's time 0 m shows none of it; try --time \"16.96 m\" to"),
        "{said}"
    );
    let said = folder.ok(&["plan", "pulse.toml", "--time", "17 m"]);
    assert!(
        said.split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
            .contains("shows some of it"),
        "{said}"
    );
    // The same by a lamp.
    let lamp = PULSE.replace(
        "[[source]]\nname = \"flash\"\npulse = { position = [0, 3, 0], time = \"10 m\", sigma = \"1 cm\" }",
        "[[light]]\nname = \"flash\"\nposition = [0, 3, 0]\nclock_zero = \"10 m\"\n\
         emission = { gaussian = { sigma = \"1 cm\" } }",
    );
    folder.write("lamp.toml", lamp);
    let said = folder.ok(&["render", "lamp.toml", "-o", "a.png"]);
    let line = said
        .lines()
        .find(|line| line.starts_with("light \"flash\""))
        .expect(&said);
    // At rest its own time is the world's, less 10 m.
    assert!(line.contains("and -17 m; it shines from"), "{line}");
    assert!(line.contains("try --time \"16."), "{line}");
}

#[test]
fn a_sky_alone_and_lines_out_of_sight_have_their_own_reasons() {
    let folder = Folder::empty();
    let camera = "[camera]\neye = [0, 0, 5]\nforward = [0, 0, 1]\nsize = [8, 6]\n";
    let wall =
        "[[object]]\nshape = { box = { size = [100, 100, 1] } }\n[radiance]\nquantity = \"rgb\"\n";
    let sky = "[sky]\nspectrum = { blackbody = \"2.725 K\", total = 1 }\nlights = false\n";
    folder.write("sky.toml", format!("{camera}{wall}{sky}"));
    let said = folder.ok(&["render", "sky.toml", "-o", "a.png"]);
    assert!(said.contains("only the sky is in view"), "{said}");
    assert!(!said.contains("meets an object"), "{said}");
    // A sodium lamp that leaves the wall at 0.9 c: 589 nm come as 2.57 µm.
    let lamp = "[[light]]\nname = \"sodium\"\nposition = [0, 0, 3]\nvelocity = { beta = [0, 0, 0.9] }\n\
                spectrum = { line = \"589 nm\" }\n";
    let scene =
        format!("{camera}{wall}{lamp}").replace("forward = [0, 0, 1]", "look_at = [0, 0, 0]");
    folder.write("lamp.toml", scene);
    let said = folder.ok(&["render", "lamp.toml", "-o", "b.png"]);
    assert!(
        said.contains("the light of \"sodium\" falls on what is in view with"),
        "{said}"
    );
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

/// A wall that shows a steady picture of 9 × 8 pixels and these channels per pixel, all 0.5.
fn channels_scene(folder: &Folder, count: usize, keys: &str) {
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': (9, 8, {count}), }}");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.extend((0..9 * 8 * count).flat_map(|_| 0.5f32.to_le_bytes()));
    std::fs::write(folder.path("picture.npy"), bytes).unwrap();
    let scene = format!(
        "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nsize = [8, 6]\n\
         velocity = {{ beta = 0.6, direction = [0, 0, -1] }}\n\
         [[object]]\nname = \"wall\"\nshape = {{ box = {{ size = [9, 9, 1] }} }}\n\
         [[source]]\n[source.cube]\nfile = \"picture.npy\"\naxes = \"H W C\"\n{keys}\n"
    );
    folder.write("channels.toml", scene);
}

const FIVE: &str = "channels = [\"R\", \"G\", \"B\", \"IR\", \"UV\"]";
const RGB: &str = "[radiance]\nquantity = \"rgb\"";

#[test]
fn channels_of_infrared_and_ultraviolet_are_named_by_info_plan_and_metadata() {
    let folder = Folder::empty();
    channels_scene(&folder, 5, &format!("{FIVE}\n{RGB}"));
    let info = folder.ok(&["info", "channels.toml"]);
    assert!(
        info.contains("1 time bins, channels R, G, B, IR, UV"),
        "{info}"
    );
    assert!(
        info.contains("continued by infrared and ultraviolet channels"),
        "{info}"
    );
    let data: serde_json::Value =
        serde_json::from_str(&folder.ok(&["info", "channels.toml", "--json"])).unwrap();
    assert_eq!(data["sources"][0]["cube"]["channels"][3], "IR");
    let plan = folder.ok(&["plan", "channels.toml"]);
    assert!(
        plan.contains("1 time bins, channels R, G, B, IR, UV"),
        "{plan}"
    );
    assert!(
        plan.contains("UV is its radiance from 100 to 360 nm; it is dark beyond"),
        "{plan}"
    );
    folder.ok(&["render", "channels.toml", "-o", "a.png"]);
    assert_eq!(
        entry(&folder, "a.png", "radiance_continuation").unwrap(),
        "companions"
    );
    assert!(entry(&folder, "a.png", "infrared_channel_m").is_some());
    // At half the wavelengths the infrared is seen alone, which the light that left visible has left.
    let dark = ["--set", "radiance.continuation=dark", "-o", "b.exr"];
    folder.ok(&[&["render", "channels.toml"][..], &dark].concat());
    folder.ok(&["render", "channels.toml", "-o", "c.exr"]);
    let brightness = |name: &str| {
        let layers = exr::read(&folder.path(name), &Default::default()).unwrap();
        layers
            .radiance()
            .unwrap()
            .iter()
            .map(|rgb| rgb[1])
            .sum::<f64>()
    };
    assert!(brightness("c.exr") > 3.0 * brightness("b.exr"));
}

#[test]
fn channels_that_cannot_be_are_refused_in_their_place() {
    let folder = Folder::empty();
    let four = "channels = [\"R\", \"G\", \"B\", \"IR\"]";
    for (count, keys, said) in [
        (
            5,
            RGB.into(),
            &["means 5 channels", "`channels` names them"][..],
        ),
        (
            4,
            format!("{FIVE}\n{RGB}"),
            &["4 channels, and `channels` names 5: R, G, B, IR, UV"],
        ),
        (
            5,
            format!("{four}\n{RGB}"),
            &["5 channels, and `channels` names 4"],
        ),
        (
            3,
            format!("{four}\n{RGB}"),
            &["3 channels, and `channels` names 4"],
        ),
        (
            5,
            FIVE.into(),
            &[
                "IR and UV shift into view where colours are spectra",
                "energy over the whole spectrum",
            ],
        ),
        (
            4,
            format!("{four}\n[radiance]\nquantity = \"line\"\nwavelength = \"532 nm\""),
            &["IR shift"],
        ),
        (
            5,
            format!("channels = [\"R\", \"G\", \"B\", \"IR\", \"IR\"]\n{RGB}"),
            &["IR is named twice"],
        ),
        (
            5,
            format!("channels = [\"R\", \"G\", \"UV\", \"IR\", \"Y\"]\n{RGB}"),
            &["\"Y\" is not the name"],
        ),
        (5, format!("channels = []\n{RGB}"), &["no channel R"]),
        (5, format!("channels = 5\n{RGB}"), &["channels"]),
    ] {
        channels_scene(&folder, count, &keys);
        refused(&folder, &["render", "channels.toml"], said);
    }
    // Channels that the array has, fewer than five.
    channels_scene(&folder, 4, &format!("{four}\n{RGB}"));
    folder.ok(&["render", "channels.toml", "-o", "four.png"]);
    // Neither a colour's own spectrum nor another picture has such channels.
    channels_scene(&folder, 3, RGB);
    let spectrum = "object.wall.spectrum={ rgb = [1, 1, 1], continuation = \"companions\" }";
    refused(
        &folder,
        &["render", "channels.toml", "--set", spectrum],
        &["only the channels of cubes have companions"],
    );
    // Captures of one surface that would be blended.
    let capture =
        "[source.cube.capture]\neye = [0, 0, 4]\nlook_at = [0, 0, 0]\nhfov = \"90 deg\"\n";
    channels_scene(&folder, 5, &format!("{FIVE}\n{capture}"));
    let one = std::fs::read_to_string(folder.path("channels.toml")).unwrap();
    let (_, source) = one.split_once("[[source]]").unwrap();
    let other = source
        .replace(FIVE, "channels = [\"B\", \"G\", \"R\"]")
        .replace("picture.npy", "three.npy");
    channels_scene(&folder, 3, "");
    std::fs::rename(folder.path("picture.npy"), folder.path("three.npy")).unwrap();
    channels_scene(&folder, 5, "");
    folder.write("channels.toml", format!("{one}[[source]]{other}{RGB}\n"));
    refused(
        &folder,
        &["render", "channels.toml"],
        &[
            "other channels of infrared and ultraviolet",
            "continuation = \"dark\"",
        ],
    );
    let dark = [
        "render",
        "channels.toml",
        "--set",
        "radiance.continuation=dark",
        "-o",
        "d.png",
    ];
    folder.ok(&dark);
}

/// A floor that a camera above it sees alone.
fn floor(beta: f64, floor: &str, rest: &str) -> String {
    format!(
        "[camera]\neye = [0, 2, 5]\nlook_at = [0, 0, 0]\nsize = [24, 16]\nvelocity = {{ beta = [0, 0, {beta:?}] }}\n\
         [[object]]\nname = \"floor\"\nshape = {{ plane = {{ size = [2000, 2000] }} }}\n{floor}\n{rest}\n"
    )
}

/// What `plan` and `render` say of a scene.
fn planned_and_rendered(folder: &Folder, scene: &str) -> [String; 2] {
    folder.write("floor.toml", scene);
    let rendered = folder.ok(&["render", "floor.toml", "--spp", "1", "-o", "floor.png"]);
    [folder.ok(&["plan", "floor.toml"]), rendered]
}

#[test]
fn spectra_that_surfaces_in_motion_do_not_reflect_are_named() {
    let folder = Folder::empty();
    let rgb = "[radiance]\nquantity = \"rgb\"\n";
    let lamp = |spectrum: &str| {
        format!(
            "[[light]]\nname = \"sodium\"\nposition = [0, 3, 0]\nspectrum = {{ {spectrum} }}\n{rgb}"
        )
    };
    let line = lamp("line = \"589 nm\"");
    let sky = format!("[sky]\nspectrum = {{ blackbody = \"3000 K\" }}\n{rgb}");
    let along = "velocity = { beta = [0, 0, -0.5] }";
    for (beta, object, light, name) in [
        (-0.5, "", &line, Some("\"sodium\"")),
        (-0.5, "", &sky, Some("the sky")),
        (0.0, along, &line, Some("\"sodium\"")),
        (0.0, "", &line, None),
        (-0.5, along, &line, None),
        (-0.5, "", &lamp("rgb = [1, 0.8, 0.2]"), None),
        (-0.5, "spectrum = { line = \"589 nm\" }", &line, None),
        (
            -0.5,
            "",
            &format!("{line}[effects]\ndoppler = false\n"),
            None,
        ),
    ] {
        for said in planned_and_rendered(&folder, &floor(beta, object, light)) {
            let found = said.contains("as red, green and blue, and not as its spectrum");
            assert_eq!(found, name.is_some(), "{beta} {object} {light}: {said}");
            assert!(said.contains(name.unwrap_or_default()), "{said}");
        }
    }
}

#[test]
fn companions_of_a_picture_of_the_sky_are_said_to_be_unread_and_its_memory_is_planned() {
    let folder = Folder::empty();
    let write = |names: &[&str]| {
        let channels = names.iter().map(|name| Channel {
            name: (*name).into(),
            samples: Samples::F32(vec![0.5; 32]),
        });
        let layers = Layers {
            width: 8,
            height: 4,
            channels: channels.collect(),
            metadata: Vec::new(),
        };
        exr::write(&folder.path("sky.exr"), &layers).unwrap();
    };
    let scene = |continuation: &str| {
        let light = format!(
            "[sky]\nimage = {{ file = \"sky.exr\" }}\n[radiance]\nquantity = \"rgb\"\ncontinuation = \"{continuation}\"\n"
        );
        floor(-0.5, "", &light)
    };
    let unread = "sky.exr: the channels IR and UV of a sky are not read";
    write(&["R", "G", "B", "IR", "UV"]);
    for (continuation, dark) in [("companions", true), ("blackbody", false)] {
        for said in planned_and_rendered(&folder, &scene(continuation)) {
            assert!(said.contains(unread), "{said}");
            let beyond = "the sky is dark beyond what is visible";
            assert_eq!(said.contains(beyond), dark, "{said}");
        }
    }
    write(&["R", "G", "B"]);
    for said in planned_and_rendered(&folder, &scene("companions")) {
        assert!(!said.contains("of a sky are not read"), "{said}");
    }
    let plan = folder.ok(&["plan", "floor.toml", "--json"]);
    let plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    let bytes = nullray::light::sky::Panorama::bytes(8);
    assert!(bytes >= 4 * 3 * 32, "{bytes}");
    // And that of the grid by which it lights surfaces.
    let grid = nullray::light::sky::LightGrid::bytes(8);
    assert_eq!(plan["memory"]["sky"], bytes + grid);
}

#[test]
fn a_dark_picture_of_what_no_time_changes_is_explained_without_a_time() {
    let folder = Folder::empty();
    let lamp = |rest: &str| format!("[[light]]\nposition = [1, 2, 0]\n{rest}\n");
    let below = "[[light]]\nposition = [1, -2, 0]\n".to_owned();
    let late = lamp("emission = { gaussian = { time = \"99 m\", sigma = \"1 cm\" } }");
    for (object, light, part, has_time) in [
        (
            "",
            below,
            "no light reaches what is in view, at any time",
            false,
        ),
        (
            "",
            lamp("intensity = 0"),
            "the intensity, radiance or power of all lights is 0",
            false,
        ),
        (
            "colour = [0, 0, 0]",
            lamp(""),
            "nothing in view reflects any light",
            false,
        ),
        (
            "colour = [0, 0, 0]",
            String::new(),
            "base colours, which are seen where a scene has no light, are 0",
            false,
        ),
        ("", late, "nothing in view is lit at the moment", true),
    ] {
        let [_, said] = planned_and_rendered(&folder, &floor(0.0, object, &light));
        assert!(said.contains(part), "{part}: {said}");
        assert_eq!(said.contains("--time"), has_time, "{said}");
    }
}

#[test]
fn a_picture_without_any_object_says_so_and_advises_nothing_that_is_set() {
    let folder = Folder::empty();
    let sky = "[sky]\ngradient = {}\n";
    let inside = "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nsize = [8, 6]\n\
                  [[object]]\nshape = { box = { size = [1, 1, 1] } }\n[display]\nback_faces = \"culled\"\n";
    let away = inside.replace(
        "eye = [0, 0, 0]\nlook_at = [0, 0, -1]",
        "eye = [0, 0, 9]\nlook_at = [0, 0, 10]",
    );
    let two_sided = away.replace("culled", "two_sided");
    for (scene, part, advice) in [
        (
            format!("{inside}{sky}"),
            "only the sky is in view: no ray meets an object from its front",
            true,
        ),
        (
            format!("{two_sided}{sky}"),
            "only the sky is in view: no ray meets an object:",
            false,
        ),
        (away, "black: no ray meets an object from its front", true),
        (two_sided, "black: no ray meets an object:", false),
    ] {
        let [_, said] = planned_and_rendered(&folder, &scene);
        assert!(said.contains(part), "{part}: {said}");
        assert_eq!(said.contains("two_sided"), advice, "{said}");
    }
}

#[test]
fn shapes_that_reflect_more_than_they_receive_are_named() {
    let folder = Folder::empty();
    let lamp = "[[light]]\nposition = [0, 3, 0]\n";
    for (colour, light, is_said) in [
        ("colour = [0.5, 3, 0.5]", lamp, true),
        ("colour = [0.5, 1, 0.5]", lamp, false),
        ("colour = [0.5, 3, 0.5]", "", false),
    ] {
        for said in planned_and_rendered(&folder, &floor(0.0, colour, light)) {
            let part = "the colour of \"floor\" is above 1";
            assert_eq!(said.contains(part), is_said, "{colour} {light}: {said}");
        }
    }
}

#[test]
fn spectra_of_which_nobody_sees_anything_are_refused_by_what_is_wrong_with_them() {
    let folder = Folder::empty();
    folder.write("um.csv", "0.4,1\n0.7,2\n");
    folder.write("zero.csv", "400,0\n700,0\n");
    for (spectrum, parts) in [
        (
            "table = \"um.csv\"",
            &["\"um.csv\" spans 0.4 to 0.7 nm", "are in nm"][..],
        ),
        (
            "table = \"zero.csv\", factor = 2",
            &["all values of \"zero.csv\" are 0"],
        ),
        (
            "line = \"589 nm\", factor = 3",
            &["`factor` is one on the values of a table", "`total`"],
        ),
        (
            "gaussian = { centre = \"550 nm\", sigma = \"20 nm\" }, factor = 3",
            &["`total`"],
        ),
    ] {
        let light = "[radiance]\nquantity = \"rgb\"\n";
        let object = format!("spectrum = {{ {spectrum} }}");
        folder.write("floor.toml", floor(0.0, &object, light));
        refused(&folder, &["render", "floor.toml"], parts);
    }
}
