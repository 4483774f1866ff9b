//! Captures as mitransient writes them (tests/data/mitransient/README.md): crop, field of view and near plane.
//!
//! The rays of its cameras start on the near plane, so that a warped capture lacks the path to it; one that it has unwarped itself holds
//! times of arrival at the surface, and needs no correction. Both are of one scene under one pulse, and must give the same picture. relRMSE
//! = √(Σ(a−b)²/Σb²).

use std::path::Path;

use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{self, Overrides};

const UNWARPED: &str = "file = \"tests/data/mitransient/unwarped.npz\"\nstart = \"1 m\"";
const WARPED: &str =
    "file = \"tests/data/mitransient/near_clip.npz\"\nstart = \"4 m\"\nclock = \"capture\"";
const FILM: &str =
    "fov = \"40 deg\"\nfov_axis = \"y\"\ncrop = { film = [48, 40], offset = [5, 3] }";

/// The corner as a moving camera sees it, the whole of it lit; and what was remarked on the data.
fn picture(cube: &str, capture: &str) -> (Vec<f64>, Vec<String>) {
    let text = format!(
        "outside = \"black\"
[display]
back_faces = \"black\"
samples_per_pixel = 4
[camera]
eye = [2.9, 2.8, 4.4]
look_at = [-0.3, 1.0, -0.5]
hfov = \"30 deg\"
size = [48, 40]
velocity = {{ beta = [0.1, 0, 0.2] }}
clock_zero = \"10 m\"
[effects]
searchlight = false
[[object]]
name = \"corner\"
gltf = \"scenes/corner/corner.glb\"
[[source]]
name = \"light\"
[source.cube]
bin_width = \"0.1 m\"
filter = \"cubic\"
{cube}
[source.cube.capture]
eye = [3.2, 3.0, 4.6]
look_at = [-0.4, 1.0, -0.6]
{capture}"
    );
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scene = scene::parse(&text, "test scene", root, &Overrides::default()).unwrap();
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let film = render(&prepared, &Silent).unwrap();
    let grey = film.radiance().iter().map(|rgb| rgb[0]).collect();
    let mut remarks = prepared.warnings;
    remarks.retain(|remark| remark.starts_with("source"));
    (grey, remarks)
}

fn score(got: &[f64], truth: &[f64]) -> f64 {
    let error: f64 = got.iter().zip(truth).map(|(a, b)| (a - b).powi(2)).sum();
    let norm: f64 = truth.iter().map(|b| b * b).sum();
    (error / norm).sqrt()
}

#[test]
fn a_warped_capture_with_its_near_plane_gives_the_picture_of_the_unwarped_one() {
    let (truth, remarks) = picture(UNWARPED, FILM);
    assert!(truth.iter().filter(|value| **value > 0.0).count() > 1000);
    assert_eq!(remarks, [""; 0]);
    let (got, remarks) = picture(WARPED, &format!("{FILM}\nnear_clip = 2"));
    // 0.034: two estimates with noise of their own, and bins that begin at other times.
    let apart = score(&got, &truth);
    assert!(apart < 0.05, "relRMSE {apart}");
    assert_eq!(remarks, [""; 0]);
    // Each of the keys left out gives another picture altogether.
    for wrong in [
        FILM.to_owned(),
        format!("{FILM}\nnear_clip = 2").replace("\"y\"", "\"x\""),
        format!("{FILM}\nnear_clip = 2").replace("[5, 3]", "[0, 0]"),
    ] {
        let apart = score(&picture(WARPED, &wrong).0, &truth);
        assert!(apart > 0.2, "{wrong}: relRMSE {apart}");
    }
}

/// Near planes from Mitsuba's default to three metres, each with the time at which its bins begin: all give one picture.
#[test]
fn captures_with_several_near_planes_give_one_picture() {
    let (truth, _) = picture(UNWARPED, FILM);
    for (name, start, near) in [
        ("near_clip_default", 6, "0.01"),
        ("near_clip", 4, "2"),
        ("near_clip_3", 3, "3"),
    ] {
        let cube = format!(
            "file = \"tests/data/mitransient/{name}.npz\"\nstart = \"{start} m\"\nclock = \"capture\""
        );
        let (got, remarks) = picture(&cube, &format!("{FILM}\nnear_clip = {near}"));
        let apart = score(&got, &truth);
        assert!(apart < 0.05, "{name}: relRMSE {apart}");
        assert_eq!(remarks, [""; 0], "{name}");
        // Without its near plane: another picture, and a remark that says which depth would fit, to two bins of 0.1 m.
        let (plain, remarks) = picture(&cube, FILM);
        let near: f64 = near.parse().unwrap();
        if near < 0.1 {
            assert_eq!(remarks, [""; 0], "{name}");
            continue;
        }
        let apart = score(&plain, &truth);
        assert!(
            apart > 0.2,
            "{name}: relRMSE {apart} without its near plane"
        );
        assert_eq!(remarks.len(), 1, "{name}: {remarks:?}");
        let said = remarks[0].split("capture.near_clip = ").nth(1).unwrap();
        let said: f64 = said.split(' ').next().unwrap().parse().unwrap();
        assert!((said - near).abs() < 0.21, "{name}: {remarks:?}");
    }
}

#[test]
fn light_that_left_before_its_lamp_flashed_is_remarked_on() {
    // Times of the world declared as those of the capture camera, 4.4 m or more later.
    let (_, remarks) = picture(&format!("{UNWARPED}\nclock = \"capture\""), FILM);
    assert!(
        remarks
            .iter()
            .any(|r| r.contains("source \"light\"") && r.contains("before time 0")),
        "{remarks:?}"
    );
}
