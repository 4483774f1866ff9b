//! Bugs of light beside marks for missing data, bugs that move objects whose indices the candidate holds, bodies that are not contracted,
//! and scenes and cameras that are not the reference's.

use std::sync::Arc;

use nullray::scene::{self, Overrides};
use nullray::validate::compare::{CompareOptions, Diagnosis, Kind, Picture, compare};

use crate::compare::planting::{
    LIGHT, SCENE, diagnosed, diagnosed_with, exact, map, named, only, parsed, rasterized, shot,
    unknown, values, with,
};

fn options(scene: &str) -> CompareOptions {
    CompareOptions {
        scene: Some(Arc::new(parsed(scene))),
        pixels_per_degree: None,
        ..CompareOptions::default()
    }
}

/// What is named of the candidate's light and indices of objects where the scene is known.
fn with_objects(candidate: &Picture) -> Vec<Diagnosis> {
    let candidate = unknown(&only(candidate, &["radiance", "object"]));
    diagnosed_with(&exact(), &candidate, &options(SCENE))
}

/// A colour that marks missing data, and whether a pixel has it: two of seven columns.
const MARK: [f64; 3] = [0.05, 0.0, 0.08];

fn is_marked(i: usize) -> bool {
    i % 96 % 7 < 2
}

fn marked(picture: &Picture) -> Picture {
    let mut picture = picture.clone();
    for (name, mark) in LIGHT.into_iter().zip(MARK) {
        map(
            &mut picture,
            name,
            |i, v| if is_marked(i) { mark } else { v },
        );
    }
    map(
        &mut picture,
        "coverage",
        |i, v| if is_marked(i) { 0.0 } else { v },
    );
    picture
}

#[test]
fn bugs_of_light_are_named_beside_marks_for_missing_data() {
    let reference = marked(&exact());
    let ratio = values(&exact(), "wavelength_ratio");
    let light = LIGHT.map(|name| values(&exact(), name));
    let srgb = |v: f64| match v <= 0.003_130_8 {
        true => 12.92 * v,
        false => 1.055 * v.powf(1.0 / 2.4) - 0.055,
    };
    type Wrong<'a> = &'a dyn Fn(usize, usize) -> f64;
    let bugs: [(Kind, &str, Wrong); 4] = [
        (Kind::ColoursExchanged, "BGR", &|k, i| light[2 - k][i]),
        (Kind::Gamma, "encoded", &|k, i| srgb(light[k][i])),
        (Kind::Exposure, "0.1000 times", &|k, i| 0.1 * light[k][i]),
        (Kind::ExponentWrong, "off by +1", &|k, i| {
            light[k][i] * ratio[i]
        }),
    ];
    // By the channel, and by the marks of the scene alone.
    let scene = format!("{SCENE}[outside]\nmark = [0.05, 0, 0.08]\n");
    let without = |picture: &Picture| {
        let mut picture = unknown(picture);
        picture.layers.channels.retain(|c| c.name != "coverage");
        picture
    };
    for (kind, words, of) in bugs {
        let mut wrong = exact();
        for (k, name) in LIGHT.into_iter().enumerate() {
            map(&mut wrong, name, |i, v| if v > 0.0 { of(k, i) } else { v });
        }
        let wrong = marked(&wrong);
        named(kind, &[words], &diagnosed(&reference, &wrong));
        let found = diagnosed_with(&without(&reference), &without(&wrong), &options(&scene));
        named(kind, &[words], &found);
    }
    assert_eq!(diagnosed(&reference, &reference), []);
}

#[test]
fn another_exponent_of_the_light_of_a_cube_is_named_by_light_alone() {
    let picture = |text: &str| {
        let base = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/");
        let scene = scene::parse(text, "capture", base.as_ref(), &Overrides::default()).unwrap();
        (shot(&scene), scene)
    };
    let text = include_str!("../../../scenes/capture.toml")
        .replace("[640, 480]", "[96, 72]")
        .replace("samples_per_pixel = 16", "samples_per_pixel = 4");
    let (reference, scene) = picture(&text);
    let (wrong, _) = picture(&format!("[radiance]\nquantity = \"photons\"\n{text}"));
    let options = CompareOptions {
        scene: Some(Arc::new(scene)),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    let mut light = only(&wrong, &["radiance"]);
    light.layers.metadata.clear();
    let mut bare = only(&reference, &["radiance"]);
    bare.layers.metadata.retain(|(key, _)| key != "scene_text");
    let found = diagnosed_with(&bare, &light, &options);
    named(
        Kind::ExponentWrong,
        &["p of W is 3 and should be 4"],
        &found,
    );
}

#[test]
fn what_moves_objects_is_named_by_light_where_the_candidate_holds_their_indices_too() {
    for (effect, kind) in [
        ("retardation", Kind::RetardationMissing),
        ("aberration", Kind::AberrationMissing),
    ] {
        let text = format!("effects = {{ {effect} = false }}\n{SCENE}");
        let wrong = shot(&parsed(&text));
        named(kind, &[], &with_objects(&wrong));
    }
    let reversed = with(&[("beta = [-0.4, 0, 0]", "beta = [0.4, 0, 0]")]);
    named(Kind::VelocityWrong, &["object 2"], &with_objects(&reversed));
}

#[test]
fn light_of_objects_elsewhere_is_no_tone_mapping() {
    // Without aberration, but with the W that the direction d has: γ(1 + β·d)/(γc(1 + βc·d)), βc = 0.5 along x.
    let text = format!("effects = {{ aberration = false }}\n{SCENE}");
    let mut wrong = shot(&parsed(&text));
    let [x, ratio] = ["direction.x", "wavelength_ratio"].map(|name| values(&wrong, name));
    let object = values(&wrong, "object");
    let own = |i: usize| {
        let doppler = |beta: f64| (1.0 + beta * x[i]) / (1.0 - beta * beta).sqrt();
        let beta = [0.0, 0.3, -0.4].get(object[i] as usize).copied();
        doppler(beta.unwrap_or(0.0)) / doppler(0.5)
    };
    // As the page of a bundle says, its own W is W₀ (κ·u_k), with W₀ = γc(1 − βc·d′) and d′ = d.
    for i in (0..object.len()).filter(|i| object[*i] >= 0.0) {
        let exact = own(i) * (1.0 + 0.5 * x[i]) * (1.0 - 0.5 * x[i]) / 0.75;
        assert!((ratio[i] / exact - 1.0).abs() < 1e-12, "{i}");
    }
    for name in LIGHT {
        map(&mut wrong, name, |i, v| match object[i] < 0.0 {
            true => v,
            false => v * (ratio[i] / own(i)).powi(5),
        });
    }
    let found = with_objects(&wrong);
    assert!(
        found.iter().all(|d| d.kind != Kind::ToneMapped),
        "{found:?}"
    );
}

#[test]
fn a_scene_in_which_one_object_moves_differently_is_not_that_of_the_reference() {
    let reference = exact();
    let other = SCENE.replace("beta = [-0.4, 0, 0]", "beta = [0.4, 0, 0]");
    let error = compare(&reference, &reference, &options(&other)).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("not a picture of"), "{message}");
    assert!(message.contains("object 2"), "{message}");
    assert_eq!(diagnosed_with(&reference, &reference, &options(SCENE)), []);
}

/// Bodies as long as at rest: in their rest frames they are γ times as long along x, and the same points are γ times as far.
fn uncontracted() -> Picture {
    let gammas = [0.3, -0.4].map(|beta: f64| 1.0 / (1.0 - beta * beta).sqrt());
    let mut parts = SCENE.split("size = [1.2, 1.2, 1.2]");
    let mut text: String = parts.next().unwrap().into();
    for (gamma, part) in gammas.into_iter().zip(parts) {
        text += &format!("size = [{}, 1.2, 1.2]{part}", 1.2 * gamma);
    }
    let mut picture = shot(&parsed(&text));
    let object = values(&picture, "object");
    let gamma = |i: usize| match object[i] {
        1.0 => gammas[0],
        2.0 => gammas[1],
        _ => 1.0,
    };
    map(&mut picture, "object_event.x", |i, v| v / gamma(i));
    // Four-velocities (1, β), too.
    map(&mut picture, "wavelength_ratio", |i, v| v / gamma(i));
    unknown(&picture)
}

#[test]
fn bodies_that_are_not_contracted_are_named() {
    let wrong = uncontracted();
    for channels in [
        &["object", "event", "object_event"][..],
        &["object", "event", "object_event", "wavelength_ratio"],
        &["object", "object_event"],
    ] {
        let found = diagnosed(&exact(), &only(&wrong, channels));
        named(Kind::ContractionMissing, &["not contracted", "γ"], &found);
    }
}

#[test]
fn an_eye_elsewhere_is_named_by_the_events_of_a_moving_camera() {
    let resting = |text: &str| {
        text.replace("velocity = { beta = [0.3, 0, 0] }\n", "")
            .replace("velocity = { beta = [-0.4, 0, 0] }\n", "")
    };
    let scene = resting(SCENE);
    let reference = shot(&parsed(&scene));
    for (eye, look_at) in [
        ("0, 0.65, 4", "1.5, 0.35, 0"),
        ("0, 0.6, 4.1", "1.5, 0.3, 0.1"),
        ("0.1, 0.6, 3.9", "1.6, 0.3, -0.1"),
    ] {
        let text = scene
            .replace("eye = [0, 0.6, 4]", &format!("eye = [{eye}]"))
            .replace("look_at = [1.5, 0.3, 0]", &format!("look_at = [{look_at}]"));
        let wrong = unknown(&shot(&parsed(&text)));
        for channels in [
            &["object", "event"][..],
            &["object", "event", "object_event"],
        ] {
            let found = diagnosed_with(&reference, &only(&wrong, channels), &options(&scene));
            let [x, y, z]: [f64; 3] =
                std::array::from_fn(|k| eye.split(", ").nth(k).unwrap().parse().unwrap());
            let words = format!("its eye is at ({x:.4}, {y:.4}, {z:.4}) m");
            named(Kind::CameraElsewhere, &[&words], &found);
        }
    }
}

#[test]
fn coarse_triangles_are_not_clipped_by_a_plane() {
    let text = SCENE.replace("beta = [0.5, 0, 0]", "beta = [0, 0, -0.99]");
    let scene = parsed(&text);
    let found = diagnosed(&shot(&scene), &rasterized(&scene, "raster:none"));
    let is_plane = |d: &Diagnosis| d.kind == Kind::SurfacesClipped;
    assert!(
        !found.is_empty() && !found.iter().any(is_plane),
        "{found:?}"
    );
}

#[test]
fn events_in_another_unit_are_named_once() {
    let mut wrong = exact();
    for axis in ["ct", "x", "y", "z"] {
        map(&mut wrong, &format!("event.{axis}"), |_, v| 1e3 * v);
        map(&mut wrong, &format!("object_event.{axis}"), |_, v| 1e3 * v);
    }
    let found = diagnosed(&exact(), &wrong);
    let what: Vec<&str> = found.iter().map(|d| &*d.what).collect();
    assert!(
        what.len() == 2
            && what[0].starts_with("event is in millimetres")
            && what[1].starts_with("object_event is in millimetres"),
        "{what:?}"
    );
}

#[test]
fn a_candidate_without_indices_of_objects_is_told_that_they_are_missing() {
    let wrong = unknown(&only(&exact(), &["event"]));
    let found = compare(&exact(), &wrong, &options(SCENE)).unwrap();
    let limit = "geometric.max=1".parse().unwrap();
    let breaches = found.breaches(&[limit]).unwrap();
    let words = breaches[0].to_string();
    assert!(words.contains("lacks the channel object"), "{words}");
}
