//! Skies, from pictures and alone.

use nullray::io::image::{Channel, Layers, Samples, exr};

use super::Folder;
use super::dark::{floor, planned_and_rendered};
use super::refused::refused;

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
    // Nothing is lit or hit.
    let plan = folder.ok(&["plan", "sky.toml"]);
    assert!(
        !plan.contains("for shadows") && !plan.contains("trees"),
        "{plan}"
    );
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

/// A folder with `grey.exr` and `coloured.exr`, which show the same, and a scene that shows a sky.
fn skies(value: impl Fn(usize) -> f32) -> Folder {
    let folder = Folder::empty();
    let write = |file: &str, names: &[&str]| {
        let channel = |name: &&str| Channel {
            name: (*name).into(),
            samples: Samples::F32((0..32).map(&value).collect()),
        };
        let layers = Layers::new(8, 4, names.iter().map(channel).collect(), vec![]).unwrap();
        exr::write(&folder.path(file), &layers).unwrap();
    };
    write("grey.exr", &["Y"]);
    write("coloured.exr", &["R", "G", "B"]);
    write("many.exr", &["Y", "heat"]);
    folder.write(
        "sky.toml",
        "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nprojection = \"equirectangular\"\nsize = [16, 8]\n\
         [sky]\nimage = { file = \"coloured.exr\" }\n[display]\nwhite = 1\n",
    );
    folder
}

#[test]
fn a_grey_sky_has_three_equal_channels() {
    let folder = skies(|at| at as f32);
    let render = |file: &str| {
        let set = format!("sky.image.file=\"{file}\"");
        folder.ok(&[
            "render",
            "sky.toml",
            "--pixel-centers",
            "--set",
            &set,
            "-o",
            "a.exr",
        ]);
        exr::read(&folder.path("a.exr"), &Default::default())
            .unwrap()
            .radiance()
            .unwrap()
    };
    let grey = render("grey.exr");
    assert!(grey.iter().any(|rgb| rgb[0] > 1.0));
    assert_eq!(grey, render("coloured.exr"));
    refused(
        &folder,
        &["render", "sky.toml", "--set", "sky.image.file=\"many.exr\""],
        &[
            "many.exr",
            "it has no R, G and B, nor a single channel",
            "or Y alone",
        ],
    );
}

#[test]
fn radiances_of_a_sky_below_zero_are_refused_or_zero() {
    let value = |least: f32| move |at: usize| if at == 13 { least } else { at as f32 };
    let pixels = |folder: &Folder, set: &[&str]| {
        folder.ok(&[
            &["render", "sky.toml", "--pixel-centers", "-o", "a.exr"],
            set,
        ]
        .concat());
        exr::read(&folder.path("a.exr"), &Default::default())
            .unwrap()
            .radiance()
            .unwrap()
    };
    let negative = skies(value(-0.5));
    refused(
        &negative,
        &["render", "sky.toml"],
        &[
            "coloured.exr",
            "pixel (5, 1)",
            "a radiance below 0",
            "negative = \"zero\"",
        ],
    );
    let zero = ["--set", "sky.image.negative=\"zero\""];
    assert_eq!(pixels(&negative, &zero), pixels(&skies(value(0.0)), &[]));
    refused(
        &skies(value(f32::NAN)),
        &[&["render", "sky.toml"][..], &zero].concat(),
        &["pixel (5, 1)", "infinite or not a number"],
    );
    refused(
        &negative,
        &["render", "sky.toml", "--set", "sky.image.negative=\"keep\""],
        &["sky.image.negative", "refuse, zero"],
    );
}

#[test]
fn a_sky_whose_image_is_black_is_the_reason_why_a_picture_is() {
    let folder = Folder::empty();
    let write = |value: f32| {
        let channel = |name: &str| Channel {
            name: name.into(),
            samples: Samples::F32(vec![value; 32]),
        };
        let channels = ["R", "G", "B"].map(channel).into();
        let layers = Layers::new(8, 4, channels, vec![]).unwrap();
        exr::write(&folder.path("sky.exr"), &layers).unwrap();
    };
    let sky = "[sky]\nimage = { file = \"sky.exr\" }\n";
    folder.write("floor.toml", floor(-0.5, "", sky));
    let render = |options: &[&str]| {
        let said = folder.run(
            &[
                &["render", "floor.toml", "-o", "a.png", "--size", "8x6"],
                options,
            ]
            .concat(),
        );
        assert_eq!(said.code, 0, "{}", said.message());
        said.stdout + &said.stderr
    };
    write(0.0);
    for (options, why) in [
        (
            &[][..],
            "nothing in view is lit: the image of the sky is black",
        ),
        (
            &["--set", "object.0.velocity.beta=[0.1,0,0]"],
            "the image of the sky is black",
        ),
        (
            &["--set", "camera.look_at=[0,90,0.1]"],
            "only the sky is in view, and its image is black",
        ),
    ] {
        let said = render(options);
        assert!(said.contains(why), "{said}");
    }
    write(0.5);
    assert!(!render(&[]).contains("black"));
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
