//! `nullray render --method`.

use nullray::io::image::{Samples, exr};

use super::refused::refused;
use super::{Folder, repository};

fn method_of(folder: &Folder, name: &str) -> Option<String> {
    let layers = exr::read(&folder.path(name), &Default::default()).unwrap();
    let mut metadata = layers.metadata.into_iter();
    metadata
        .find(|(key, _)| key == "method")
        .map(|(_, value)| value)
}

#[test]
fn pictures_say_by_which_method_they_were_made() {
    let folder = Folder::new();
    folder.ok(&["render", "scene.toml", "-o", "traced.exr"]);
    assert_eq!(method_of(&folder, "traced.exr").as_deref(), Some("trace"));
    let method = "raster:uniform=0.25,attributes=vertex";
    folder.ok(&[
        "render",
        "scene.toml",
        "--method",
        method,
        "-o",
        "drawn.exr",
    ]);
    assert_eq!(method_of(&folder, "drawn.exr").as_deref(), Some(method));
}

/// One object that moves, and a lamp straight above it, so that rays of both look for the way out of bodies.
const ONE_MOVING: &str = "[camera]\neye = [0, 0.2, 4]\nlook_at = [0, 0, 0]\nsize = [32, 24]\n
[[object]]\nname = \"ball\"\nshape = { sphere = { radius = 1 } }\nvelocity = { beta = [0.1, 0, 0] }\n
[[light]]\nposition = [0, 4, 0]\n";

#[test]
fn one_object_that_moves_alone_is_rendered_and_measured() {
    let folder = Folder::empty();
    std::fs::write(folder.path("one.toml"), ONE_MOVING).unwrap();
    for method in ["trace", "raster:none", "raster:adaptive=0.1"] {
        folder.ok(&["render", "one.toml", "--method", method, "-o", "one.png"]);
    }
    folder.ok(&["sheet", "one.toml", "-o", "sheet.png"]);
    folder.ok(&["tessellation", "one.toml"]);
}

#[test]
fn all_methods_write_the_same_channels() {
    let folder = Folder::empty();
    let scene = repository("scenes/cube/approaching-0.6.toml");
    let channels = |method: &str| {
        let arguments = [
            "render", &scene, "--size", "24x18", "--aovs", "all", "-o", "a.exr", "--method", method,
        ];
        folder.ok(&arguments);
        let layers = exr::read(&folder.path("a.exr"), &Default::default()).unwrap();
        let kind = |samples: &Samples| std::mem::discriminant(samples);
        let channels = layers
            .channels
            .iter()
            .map(|c| (c.name.clone(), kind(&c.samples)));
        channels.collect::<Vec<_>>()
    };
    let traced = channels("trace");
    assert_eq!(traced.len(), 37);
    for method in [
        "raster:none",
        "raster:adaptive=1",
        "warp:cube=32",
        "warp:panorama=64x32,lookup=nearest",
    ] {
        assert_eq!(channels(method), traced, "{method}");
    }
}

#[test]
fn a_frame_made_by_another_method_is_rendered_again() {
    let folder = Folder::new();
    let frames = |method: &str| {
        folder.ok(&[
            "render",
            "scene.toml",
            "--frames",
            "0..1",
            "--interval",
            "1 cm",
            "--white",
            "1",
            "-o",
            "f-#.png",
            "--method",
            method,
        ])
    };
    assert!(frames("trace").contains("1 rendered, 0 existed already"));
    assert!(frames("raster:none").contains("1 rendered, 0 existed already"));
    assert!(frames("raster:none").contains("0 rendered, 1 existed already"));
}

#[test]
fn what_is_no_method_or_cannot_be_done_by_it_is_refused() {
    let folder = Folder::new();
    let cases: &[(&[&str], &[&str])] = &[
        (
            &["--method", "magic"],
            &[
                "--method",
                "\"magic\" is not a method",
                "raster:uniform=0.05",
            ],
        ),
        (
            &["--method", "raster:uniform=0"],
            &["edge length in metres"],
        ),
        (&["--method", "warp:cube=100000"], &["cube=1024"]),
        (
            &["--method", "warp:cube=64"],
            &[
                "scene.toml, object.velocity",
                "object \"crate\" moves",
                "--method trace",
            ],
        ),
        (
            &[
                "--method",
                "raster:none",
                "--set",
                "camera.sensor={focal_length=\"0.1 m\"}",
            ],
            &[
                "rays all leave one event",
                "sensor or a shutter",
                "--method trace",
            ],
        ),
        (
            &[
                "--method",
                "raster:none",
                "--set",
                "camera.stereo={interpupillary_distance=\"6 cm\"}",
            ],
            &["a stereo pair leave two eyes", "remove `stereo`"],
        ),
        (
            &[
                "--method",
                "warp:cube=16",
                "--set",
                "camera.projection=fisheye_equisolid",
                "--set",
                "camera.hfov=360 deg",
            ],
            &[
                "rasterizers need a film that sees something everywhere",
                "corners of a fisheye",
                "or set a size or an hfov",
            ],
        ),
        (
            &["--method", "raster:uniform=0.00001"],
            &["16777216 points", "longer edge"],
        ),
    ];
    for (arguments, parts) in cases {
        let all = [&["render", "scene.toml", "-o", "a.png"], *arguments].concat();
        refused(&folder, &all, parts);
    }
}
