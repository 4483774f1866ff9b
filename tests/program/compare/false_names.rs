//! Pairs of pictures that could be mistaken for another bug than the planted one, or that have no bug.

use std::sync::Arc;

use nullray::scene::{self, Overrides};
use nullray::validate::compare::{CompareOptions, Diagnosis, Encoding, Kind, Picture};

use crate::compare::planting::{
    LIGHT, SCENE, changed, diagnosed, diagnosed_with, evidence, exact, map, named, only, parsed,
    rearranged, shot, taken, unknown, values,
};

/// A box in the middle of the picture, seen along the axis of the camera's motion.
const BOX: &str = r#"
    camera = { eye = [0, 0.5, 4], look_at = [0, 0.5, 0], hfov = "50 deg", size = [160, 120], velocity = { beta = [0, 0, -0.5] } }
    [[object]]
    name = "box"
    shape = { box = { size = [1, 1, 1] } }
    colour = [0.6, 0.5, 0.35]
    transform = { translate = [0, 0.5, 0] }
    [[source]]
    pulse = { position = [0, 0.5, 4], time = "-7 m", sigma = "100 m", intensity = 1200 }
"#;

/// One object, which moves.
const ONE: &str = r#"
    camera = { eye = [0.4, 1.3, 4], look_at = [0, 0.5, 0], hfov = "60 deg", size = [96, 72] }
    [[object]]
    name = "box"
    shape = { box = { size = [1, 1.2, 0.8] } }
    colour = [0.8, 0.35, 0.1]
    velocity = { beta = [0.7, 0, 0] }
    origin = { position = [-3.4, 0.5, 0], time = "-9.0 m" }
"#;

fn light(picture: &Picture) -> Picture {
    only(picture, &["radiance"])
}

/// The light of a picture without its metadata.
fn bare(picture: &Picture) -> Picture {
    let mut picture = light(picture);
    picture.layers.metadata.clear();
    picture
}

fn scaled(picture: &Picture, factor: impl Fn(usize) -> f64) -> Picture {
    let mut picture = picture.clone();
    for name in LIGHT {
        map(&mut picture, name, |i, v| factor(i) * v);
    }
    picture
}

#[test]
fn an_outline_of_single_samples_is_not_another_field_of_view() {
    let mut scene = parsed(BOX);
    let single = shot(&scene);
    scene.samples_per_pixel = 16;
    let many = taken(&scene, false);
    for reference in [single.clone(), unknown(&single)] {
        assert_eq!(diagnosed(&bare(&reference), &bare(&many)), []);
        assert_eq!(diagnosed(&reference, &light(&many)), []);
    }
    assert_eq!(diagnosed(&many, &bare(&single)), []);
    // A field of view that is another one is still named.
    let wider = shot(&parsed(&BOX.replace("50 deg", "64 deg")));
    let found = diagnosed(&bare(&single), &bare(&wider));
    named(Kind::FieldOfView, &["field of view"], &found);
}

#[test]
fn one_factor_on_all_light_is_not_a_curve() {
    for factor in [0.003, 0.01, 0.03, 0.1, 1.5] {
        let dark = scaled(&exact(), |_| factor);
        for candidate in [dark.clone(), light(&dark), bare(&dark)] {
            let found = diagnosed(&exact(), &candidate);
            named(Kind::Exposure, &["uniformly"], &found);
            assert!((evidence(&found, "factor") / factor - 1.0).abs() < 1e-6);
        }
    }
    // Too little to be named, of which a curve is not named either.
    for factor in [0.98, 1.02] {
        assert_eq!(diagnosed(&exact(), &scaled(&exact(), |_| factor)), []);
    }
}

#[test]
fn factors_of_any_size_on_dark_light_are_not_gamma() {
    let random = |i: usize| ((i * 7919 + 13) % 1009) as f64 / 1009.0;
    let dark = bare(&scaled(&exact(), |i| 0.04 * random(i)));
    for reference in [exact(), unknown(&exact())] {
        let found = diagnosed(&reference, &dark);
        let kinds: Vec<Kind> = found.iter().map(|d| d.kind).collect();
        assert_eq!(kinds, [], "{found:?}");
    }
}

#[test]
fn millimetres_of_a_moving_camera_are_not_another_time() {
    let names = ["event.x", "event.y", "event.z"];
    let wrong = changed(&names, |_, v| 1e3 * v);
    let found = diagnosed(&exact(), &only(&wrong, &["object", "event"]));
    named(Kind::Units, &["event is in millimetres"], &found);
}

#[test]
fn reversed_aberration_along_the_axis_is_not_an_inverted_ratio() {
    let mut wrong = shot(&parsed(&BOX.replace("[0, 0, -0.5]", "[0, 0, 0.5]")));
    wrong.layers.metadata.clear();
    let found = diagnosed(&shot(&parsed(BOX)), &wrong);
    named(Kind::AberrationReversed, &["−β for β"], &found);
}

/// A box and a ball that move to and fro before a moving camera.
const THREE: &str = r#"
    camera = { eye = [0.4, 1.3, 4], look_at = [0, 0.5, 0], hfov = "60 deg", size = [160, 120], velocity = { beta = [0.3, 0, -0.6] } }
    [[object]]
    name = "floor"
    shape = { plane = { size = [8, 8] } }
    colour = [0.5, 0.5, 0.45]
    [[object]]
    name = "box"
    shape = { box = { size = [1, 1, 1] } }
    colour = [0.8, 0.35, 0.1]
    velocity = { beta = [0.7, 0, 0] }
    origin = { position = [-3.8, 0.5, 0], time = "-8.6 m" }
    [[object]]
    name = "ball"
    shape = { sphere = { radius = 0.5, subdivisions = 3 } }
    colour = [0.2, 0.4, 0.8]
    velocity = { beta = [-0.5, 0, 0.2] }
    origin = { position = [3, 0.5, -0.6], time = "-8.6 m" }
"#;

/// The scene with two velocities exchanged.
fn exchanged(text: &str, a: &str, b: &str) -> Picture {
    let text = text.replace(a, "[moving]").replace(b, a);
    let mut picture = shot(&parsed(&text.replace("[moving]", b)));
    picture.layers.metadata.clear();
    picture
}

#[test]
fn exchanged_velocities_of_which_one_leads_out_of_view_are_named() {
    let reference = shot(&parsed(THREE));
    let wrong = exchanged(THREE, "[0.7, 0, 0]", "[-0.5, 0, 0.2]");
    let shown = |picture: &Picture, k: f64| values(picture, "object").contains(&k);
    assert!(shown(&reference, 1.0) && shown(&reference, 2.0));
    assert_ne!(shown(&wrong, 1.0), shown(&wrong, 2.0), "one is out of view");
    let found = diagnosed(&reference, &only(&wrong, &["object", "object_event"]));
    named(
        Kind::VelocitiesSwapped,
        &["objects 1 and 2 are swapped"],
        &found,
    );
}

#[test]
fn exchanged_velocities_are_named_by_events_alone() {
    let events = |picture: &Picture| only(picture, &["object", "event"]);
    let wrong = events(&exchanged(SCENE, "[0.3, 0, 0]", "[-0.4, 0, 0]"));
    let words = ["objects 1 and 2 are swapped"];
    named(
        Kind::VelocitiesSwapped,
        &words,
        &diagnosed(&exact(), &wrong),
    );
    // One of them leads out of view; and two of which both are seen.
    let wrong = events(&exchanged(THREE, "[0.7, 0, 0]", "[-0.5, 0, 0.2]"));
    let found = diagnosed(&shot(&parsed(THREE)), &wrong);
    named(Kind::VelocitiesSwapped, &words, &found);
    // Of all samples, and of velocities that are each other's opposites.
    let opposite = SCENE.replace("[-0.4, 0, 0]", "[-0.3, 0, 0]");
    let wrong = events(&exchanged(&opposite, "[0.3, 0, 0]", "[-0.3, 0, 0]"));
    let found = diagnosed(&shot(&parsed(&opposite)), &wrong);
    named(Kind::VelocitiesSwapped, &words, &found);
}

#[test]
fn exchanged_velocities_are_named_by_light_where_the_scene_is_there() {
    let wrong = exchanged(SCENE, "[0.3, 0, 0]", "[-0.4, 0, 0]");
    let options = CompareOptions {
        scene: Some(Arc::new(
            scene::parse(SCENE, "scene", ".".as_ref(), &Overrides::default()).unwrap(),
        )),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    let found = diagnosed_with(&exact(), &light(&wrong), &options);
    named(
        Kind::VelocitiesSwapped,
        &["objects 1 and 2 are swapped", "light only"],
        &found,
    );
}

#[test]
fn films_of_a_moving_object_are_named_by_events_alone() {
    let reference = shot(&parsed(ONE));
    let events = |picture: &Picture| only(picture, &["object", "event"]);
    assert_eq!(diagnosed(&reference, &events(&reference)), []);
    let wider = shot(&parsed(&ONE.replace("60 deg", "64 deg")));
    let mut wider = events(&wider);
    wider.layers.metadata.clear();
    let found = diagnosed(&reference, &wider);
    named(Kind::FieldOfView, &["field of view"], &found);
    let right = (32f64.to_radians().tan() / 30f64.to_radians().tan(), 1e-3);
    let factor = evidence(&found, "tan(fov/2) across over the reference's");
    assert!((factor - right.0).abs() < right.1, "{factor}");
}

#[test]
fn exposures_of_pictures_of_codes_are_those_of_linear_light() {
    let encode = |picture: &Picture, factor: f64| {
        let mut picture = bare(&scaled(picture, |_| factor));
        picture.encoding = Encoding::Srgb;
        for name in LIGHT {
            let code = |v: f64| match v {
                v if v <= 0.0031308 => 12.92 * v,
                v => 1.055 * v.powf(1.0 / 2.4) - 0.055,
            };
            map(&mut picture, name, |_, v| {
                (255.0 * code(v).clamp(0.0, 1.0)).round() / 255.0
            });
        }
        picture
    };
    let reference = encode(&exact(), 0.3);
    for factor in [0.5, 1.5] {
        let found = diagnosed(&reference, &encode(&exact(), 0.3 * factor));
        named(Kind::Exposure, &["uniformly"], &found);
        let measured = evidence(&found, "factor");
        assert!(
            (measured / factor - 1.0).abs() < 0.02,
            "{measured} for {factor}"
        );
    }
}

#[test]
fn an_object_in_millimetres_is_not_a_larger_one() {
    let object = values(&exact(), "object");
    let names = ["event.x", "event.y", "event.z"];
    let wrong = changed(&names, |i, v| if object[i] == 2.0 { 1e3 * v } else { v });
    let found = diagnosed(&exact(), &only(&wrong, &["object", "event"]));
    named(
        Kind::Units,
        &["in object 2, event is in millimetres"],
        &found,
    );
}

#[test]
fn a_turn_is_named_beside_indices_from_1_and_millimetres() {
    let height = i64::from(exact().layers.height);
    let turned = rearranged(&exact(), |x, y| [x, height - 1 - y]);
    let is_turn = |found: Vec<Diagnosis>| named(Kind::Mirrored, &["upside down"], &found);
    let mut counted = turned.clone();
    map(
        &mut counted,
        "object",
        |_, v| if v >= 0.0 { v + 1.0 } else { v },
    );
    is_turn(diagnosed(&exact(), &counted));
    let groups: &[&str] = &["object", "event"];
    is_turn(diagnosed(&exact(), &only(&counted, groups)));
    let mut larger = turned;
    for name in ["event.x", "event.y", "event.z"] {
        map(&mut larger, name, |_, v| 1e3 * v);
    }
    is_turn(diagnosed(&exact(), &only(&larger, groups)));
}

#[test]
fn times_of_the_opposite_sign_that_hardly_vary_are_not_late() {
    let reference = shot(&parsed(BOX));
    let mut wrong = only(&reference, &["object", "event"]);
    map(&mut wrong, "event.ct", |_, v| -v);
    let found = diagnosed(&reference, &wrong);
    named(Kind::SignOpposite, &["opposite sign"], &found);
}

#[test]
fn what_puts_the_only_object_out_of_view_is_said_beside_its_loss() {
    let reference = shot(&parsed(ONE));
    let at_rest = ONE.replace("beta = [0.7, 0, 0]", "beta = [0, 0, 0]");
    let mut wrong = shot(&parsed(&at_rest));
    wrong.layers.metadata.clear();
    let is_shown = values(&wrong, "object").iter().any(|k| *k >= 0.0);
    assert!(!is_shown, "it is seen at rest");
    let found = diagnosed(&reference, &wrong);
    named(
        Kind::ObjectMissing,
        &["object 0 is missing", "a velocity that is missing"],
        &found,
    );
}

/// Thin bars far before the camera: nearly all of their pixels show the floor as well, far behind them.
const BARS: &str = r#"
    camera = { eye = [0, 3.4, 400], look_at = [0, 3.3, 0], hfov = "4.2 deg", size = [120, 40] }
    [[object]]
    shape = { plane = { size = [60000, 60000] } }
    colour = [0.16, 0.27, 0.08]
    [[object]]
    shape = { box = { size = [20, 0.4, 0.4] } }
    colour = [0.8, 0.35, 0.1]
    transform = { translate = [0, 1.6, 0] }
    [[object]]
    shape = { box = { size = [20, 0.4, 0.4] } }
    colour = [0.8, 0.35, 0.1]
    transform = { translate = [0, 5, 0] }
    velocity = { beta = [0.3, 0, 0] }
"#;

#[test]
fn means_of_points_that_are_far_apart_are_no_mistake() {
    let places = |picture: &Picture| only(picture, &["object", "event", "object_event"]);
    let thinner = BARS.replace("[20, 0.4, 0.4]", "[20, 0.25, 0.3]");
    for text in [BARS, &thinner] {
        let mut scene = parsed(text);
        let centres = places(&shot(&scene));
        let [few, many] = [4, 16].map(|samples| {
            scene.samples_per_pixel = samples;
            places(&taken(&scene, false))
        });
        for [reference, candidate] in [[&many, &centres], [&few, &centres], [&centres, &many]] {
            assert_eq!(diagnosed(reference, candidate), []);
        }
    }
}

/// Single samples at edges look like a shift by a third of a pixel, in some places.
#[test]
fn other_samples_of_moving_bodies_are_no_shift() {
    let mut scene = parsed(&THREE.replace("size = [160, 120]", "size = [120, 90]"));
    let single = shot(&scene);
    scene.samples_per_pixel = 9;
    assert_eq!(diagnosed(&single, &bare(&taken(&scene, false))), []);
}

#[test]
fn other_samples_of_thin_bars_before_a_floor_are_no_late_times() {
    let text = r#"
        camera = { eye = [0, 3.4, 400], look_at = [0, 3.3, 0], hfov = "4.2 deg", size = [120, 40], time = "391.5 m", velocity = { beta = [0.8,0,0] } }
        [[object]]
        shape = { plane = { size = [60000, 60000] } }
        colour = [0.16, 0.27, 0.08]
        [[object]]
        shape = { box = { size = [20, 0.3, 0.3] } }
        colour = [0.8, 0.35, 0.1]
        transform = { translate = [0, 1.6, 0] }
        [[object]]
        shape = { box = { size = [20, 0.3, 0.3] } }
        colour = [0.8, 0.35, 0.1]
        transform = { translate = [0, 5, 0] }
        velocity = { beta = [0.3,0,0]}
    "#;
    let mut scene = parsed(text);
    let mut with = |samples: u32| {
        scene.samples_per_pixel = samples;
        taken(&scene, false)
    };
    let (few, many) = (with(1), with(4));
    assert_eq!(diagnosed(&few, &many), []);
}

#[test]
fn the_other_side_of_a_reversed_ball_is_not_one_at_rest() {
    let text = r#"
        camera = { eye = [0, 2.2, 7.5], look_at = [0, 0.9, 0], hfov = "62 deg", size = [120, 90] }
        [[object]]
        shape = { plane = { size = [40, 40] } }
        [[object]]
        shape = { sphere = { radius = 0.7, subdivisions = 6 } }
        velocity = { beta = [0.5, 0, 0] }
        origin = { position = [-0.6, 0.7, -1.6], time = "-9.5 m" }
    "#;
    let reversed = shot(&parsed(&text.replace("[0.5, 0, 0]", "[-0.5, 0, 0]")));
    let found = diagnosed(&shot(&parsed(text)), &only(&reversed, &["object", "event"]));
    named(Kind::VelocityWrong, &["object 1 is reversed"], &found);
}

#[test]
fn an_eye_elsewhere_is_not_an_object_elsewhere_where_samples_differ() {
    let text = SCENE.replace("eye = [0, 0.6, 4]", "eye = [0.03, 0.6, 4]");
    let mut scene = parsed(&text.replace("look_at = [1.5, 0.3, 0]", "forward = [1.5, -0.3, -4]"));
    scene.samples_per_pixel = 1;
    let candidate = only(&taken(&scene, false), &["object", "object_event"]);
    let found = diagnosed(&exact(), &candidate);
    named(Kind::CameraElsewhere, &["its eye is at (0.0"], &found);
}

#[test]
fn the_shadow_of_a_missing_object_is_not_said_to_be_missing() {
    let text = r#"
        camera = { eye = [0, 1.3, 4], look_at = [0, 0.5, 0], hfov = "60 deg", size = [80, 60] }
        [[object]]
        shape = { plane = { size = [8, 8] } }
        [[object]]
        shape = { box = { size = [0.6, 0.6, 0.6] } }
        origin = { position = [0, 0.3, 0] }
        [[source]]
        pulse = { position = [1.5, 2.4, 1.4], time = "-7 m", sigma = "3 m", intensity = 12 }
    "#;
    let without = shot(&parsed(&text.replace("[0, 0.3, 0]", "[900, 900, 900]")));
    let found = diagnosed(&shot(&parsed(text)), &without);
    named(Kind::ObjectMissing, &["object 1 is missing"], &found);
}
