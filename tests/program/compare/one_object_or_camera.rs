//! Right pictures with other samples, cameras with another velocity or time, and bugs in a single object.

use std::path::Path;

use nullray::scene::{self, Overrides};
use nullray::validate::compare::{CompareOptions, Diagnosis, Kind, Picture, compare};

use crate::compare::planting::{
    LIGHT, SCENE, diagnosed, exact, map, named, only, parsed, shot, taken, unknown, values, with,
};

/// The pixels at which a picture shows this object.
fn pixels_of(picture: &Picture, object: f64) -> Vec<bool> {
    let objects = values(picture, "object");
    objects.iter().map(|id| *id == object).collect()
}

/// The exact picture with channels changed where it shows this object.
fn changed_in(object: f64, names: &[&str], of: impl Fn(f64) -> f64) -> Picture {
    let mut picture = exact();
    let is_there = pixels_of(&picture, object);
    for name in names {
        map(
            &mut picture,
            name,
            |i, v| if is_there[i] { of(v) } else { v },
        );
    }
    picture
}

#[test]
fn pixel_centres_and_sixteen_samples_of_moving_objects_get_no_diagnosis() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/ladder/3-moving-objects.toml");
    let overrides = Overrides {
        size: Some([160, 120]),
        ..Overrides::default()
    };
    let mut scene = scene::load(&path, &overrides).unwrap();
    scene.samples_per_pixel = 16;
    let [centres, samples] = [true, false].map(|centres| taken(&scene, centres));
    for (r, c) in [(&centres, &samples), (&samples, &centres)] {
        assert_eq!(diagnosed(r, c), []);
    }
}

#[test]
fn a_slower_camera_is_named_rather_than_a_film_or_object() {
    let slower = with(&[(
        "velocity = { beta = [0.5, 0, 0] } }",
        "velocity = { beta = [0.45, 0, 0] } }",
    )]);
    let words = [
        "the camera moves at another velocity",
        "(0.4500, 0.0000, 0.0000)",
    ];
    let found = diagnosed(&exact(), &unknown_shot(&slower));
    named(Kind::CameraVelocity, &words, &found);
    let places = only(&unknown_shot(&slower), &["object", "event", "radiance"]);
    named(Kind::CameraVelocity, &words, &diagnosed(&exact(), &places));
}

/// The picture without what it says of its shot.
fn unknown_shot(picture: &Picture) -> Picture {
    let mut picture = unknown(picture);
    let metadata = &mut picture.layers.metadata;
    metadata.retain(|(key, _)| !key.starts_with("camera_"));
    picture
}

#[test]
fn another_time_of_the_camera_is_named() {
    let later = with(&[("hfov = \"60 deg\"", "hfov = \"60 deg\", time = \"0.6 m\"")]);
    let words = ["another time", "at 0.6000 m, and should be at 0.0000 m"];
    let found = diagnosed(&exact(), &unknown_shot(&later));
    named(Kind::CameraTime, &words, &found);
}

#[test]
fn metadata_of_another_shot_head_what_follows_from_it() {
    let later = with(&[("hfov = \"60 deg\"", "hfov = \"60 deg\", time = \"0.6 m\"")]);
    let places = only(&later, &["radiance"]);
    let words = [
        "different shots",
        "camera_time is 0.6, and 0 in the reference",
    ];
    named(Kind::ShotsDiffer, &words, &diagnosed(&exact(), &places));
}

#[test]
fn wavelength_ratios_times_a_factor_give_no_velocity() {
    let scaled = changed_in(2.0, &["wavelength_ratio"], |w| 1.02 * w);
    let words = ["by a factor: 1.0200 (object 2)"];
    let found = diagnosed(&exact(), &scaled);
    named(Kind::RatioFactor, &words, &found);
    assert!(!found[0].what.contains("object 0"), "{found:?}");
}

#[test]
fn inverted_ratios_of_one_object_are_named() {
    let inverted = changed_in(2.0, &["wavelength_ratio"], |w| 1.0 / w);
    let words = ["inverted in object 2"];
    named(Kind::RatioInverted, &words, &diagnosed(&exact(), &inverted));
}

/// Two balls, each of 1 % of the picture.
const SMALL: &str = r#"
    camera = { eye = [0, 0.6, 4], look_at = [0, 0.3, 0], hfov = "60 deg", size = [96, 72], velocity = { beta = [0.2, 0, 0] } }
    [[object]]
    shape = { plane = { size = [120, 120] } }
    [[object]]
    shape = { sphere = { radius = 0.2 } }
    origin = { position = [-0.5, 0.3, 0] }
    [[object]]
    shape = { sphere = { radius = 0.2 } }
    origin = { position = [0.5, 0.3, 0] }
"#;

#[test]
fn exchanged_indices_of_small_objects_are_named() {
    let right = shot(&parsed(SMALL));
    let mut wrong = right.clone();
    map(&mut wrong, "object", |_, id| match id {
        1.0 => 2.0,
        2.0 => 1.0,
        id => id,
    });
    let differ = pixels_of(&right, 1.0)
        .iter()
        .chain(&pixels_of(&right, 2.0))
        .filter(|is| **is)
        .count();
    assert!(differ * 20 < 96 * 72, "{differ}");
    named(
        Kind::IdentitiesSwapped,
        &["2 for 1, 1 for 2"],
        &diagnosed(&right, &wrong),
    );
}

#[test]
fn mistakes_of_one_object_alone_are_named_with_it() {
    type Mistake = (&'static [&'static str], fn(f64) -> f64);
    let cases: [(Mistake, Kind, &str); 6] = [
        (
            (&["event.x", "event.y", "event.z"], |v| 1e3 * v),
            Kind::Units,
            "millimetres",
        ),
        (
            (&["event.x", "event.y"], |_| f64::NAN),
            Kind::NotANumber,
            "no numbers in event.x, event.y",
        ),
        (
            (&["uv.v"], |v| 1.0 - v),
            Kind::TextureFlipped,
            "v is flipped",
        ),
        (
            (&["normal.x", "normal.y", "normal.z"], |v| -v),
            Kind::AxesExchanged,
            "normals are reversed",
        ),
        (
            (&["event.ct"], |t| t + 0.025),
            Kind::TimeShifted,
            "half a bin",
        ),
        (
            (&LIGHT, |v| 0.5 * v),
            Kind::Exposure,
            "light is 0.5000 times",
        ),
    ];
    for ((names, of), kind, words) in cases {
        let found = diagnosed(&exact(), &changed_in(2.0, names, of));
        named(kind, &["in object 2, ", words], &found);
    }
}

#[test]
fn light_is_diagnosed_beside_a_channel() {
    let mut both = exact();
    for name in ["direction.x", "direction.y", "direction.z"] {
        map(&mut both, name, |_, v| -v);
    }
    for name in LIGHT {
        map(&mut both, name, |_, v| 2.0 * v);
    }
    let kinds: Vec<Kind> = diagnosed(&exact(), &both).iter().map(|d| d.kind).collect();
    assert_eq!(kinds, [Kind::DirectionsReversed, Kind::Exposure]);
}

#[test]
fn zeros_are_not_a_mirrored_picture() {
    let mut zeros = only(&exact(), &["object", "event"]);
    let names: Vec<String> = zeros
        .layers
        .channels
        .iter()
        .map(|c| c.name.clone())
        .collect();
    for name in names {
        map(&mut zeros, &name, |_, _| 0.0);
    }
    let found = diagnosed(&exact(), &zeros);
    assert!(found.iter().all(|d| d.kind != Kind::Mirrored), "{found:?}");
}

#[test]
fn one_index_for_all_triangles_is_named() {
    let mut wrong = exact();
    map(&mut wrong, "primitive", |_, id| id.min(0.0));
    let words = ["indices of triangles are 0 everywhere"];
    named(
        Kind::IdentitiesShifted,
        &words,
        &diagnosed(&exact(), &wrong),
    );
}

#[test]
fn huge_exposures_are_exposures_in_few_digits_and_similar_within_bounds() {
    let mut bright = exact();
    for name in LIGHT {
        map(&mut bright, name, |_, v| 1e25 * v);
    }
    let comparison = compare(&exact(), &bright, &CompareOptions::default()).unwrap();
    named(Kind::Exposure, &["1.000e25 times"], &comparison.diagnoses);
    let similarity = comparison.radiance.unwrap().ssim.unwrap();
    assert!(similarity.abs() <= 1.0, "{similarity}");
}

#[test]
fn missing_shadows_are_named_rather_than_a_missing_object() {
    let pulse = |shadows: bool| {
        let source = |x: f64| {
            format!(
                "[[source]]\npulse = {{ position = [{x}, 3, 1], time = \"-8 m\", sigma = \"40 m\", intensity = 12, shadows = {shadows} }}\n"
            )
        };
        let text = format!("{SCENE}\n{}{}", source(-3.0), source(2.0));
        shot(&parsed(&text))
    };
    let [right, wrong] = [true, false].map(pulse);
    let wrong = only(&unknown_shot(&wrong), &["radiance"]);
    named(
        Kind::ShadowsMissing,
        &["shadows are missing"],
        &diagnosed(&right, &wrong),
    );
}

#[test]
fn missing_shadows_are_named_where_they_are_black() {
    // One lamp: what it does not reach has no light at all.
    let pulse = |shadows: bool| {
        let text = format!(
            "{SCENE}\n[[source]]\npulse = {{ position = [-3, 3, 1], time = \"-8 m\", sigma = \"40 m\", intensity = 12, shadows = {shadows} }}\n"
        );
        shot(&parsed(&text))
    };
    let [right, wrong] = [true, false].map(pulse);
    let wrong = unknown_shot(&wrong);
    let bare = only(&wrong, &["radiance"]);
    for wrong in [wrong, bare] {
        let found = diagnosed(&right, &wrong);
        named(Kind::ShadowsMissing, &["shadows are missing"], &found);
    }
}

/// Three objects of as many velocities above a floor, some of which hide parts of others.
const SEVERAL: &str = r#"
    camera = { eye = [2.1, 1.9, 3.7], look_at = [0.2, 0.5, -0.4], up = [0.2, 1, 0.1], hfov = "75 deg", size = [180, 110], velocity = { beta = [-0.35, 0.1, -0.4] }, clock_zero = "3 m", time = "0.7 m" }
    [[object]]
    shape = { plane = { size = [14, 10] } }
    [[object]]
    shape = { box = { size = [1, 0.8, 1.3] } }
    transform = { rotate = { axis = [0, 1, 0], angle = "25 deg" } }
    velocity = { beta = [0.6, 0, 0.3] }
    origin = { position = [-0.6, 0.5, 0], time = "0 m" }
    [[object]]
    shape = { sphere = { radius = 0.6, subdivisions = 3 } }
    velocity = { beta = [-0.4, 0.2, -0.5] }
    origin = { position = [1.2, 0.6, -1], time = "0.5 m" }
    [[object]]
    shape = { box = { size = [0.3, 2, 0.3] } }
    velocity = { beta = [0, 0, -0.7] }
    origin = { position = [0.4, 1, 0.3], time = "-1 m" }
"#;

/// That scene with replacements, as its pixels' objects and events alone say.
fn several(replaced: &[(&str, &str)], pixel_centers: bool) -> Picture {
    let text = replaced
        .iter()
        .fold(SEVERAL.to_string(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        });
    let mut scene = parsed(&text);
    scene.samples_per_pixel = 16;
    only(
        &unknown_shot(&taken(&scene, pixel_centers)),
        &["object", "event"],
    )
}

#[test]
fn missing_and_reversed_velocities_are_named_by_events_where_objects_show_other_sides() {
    let right = shot(&parsed(SEVERAL));
    for (object, [beta, reversed], words) in [
        (
            1,
            ["[0.6, 0, 0.3]", "[-0.6, 0, -0.3]"],
            "(0.6000, 0.0000, 0.3000)",
        ),
        (
            2,
            ["[-0.4, 0.2, -0.5]", "[0.4, -0.2, 0.5]"],
            "(-0.4000, 0.2000, -0.5000)",
        ),
        (
            3,
            ["[0, 0, -0.7]", "[0, 0, 0.7]"],
            "(0.0000, 0.0000, -0.7000)",
        ),
    ] {
        for centres in [true, false] {
            let at_rest = several(&[(beta, "[0, 0, 0]")], centres);
            let missing = format!("the velocity of object {object} is missing");
            let should_be = format!("should be those of β = {words}");
            let found = diagnosed(&right, &at_rest);
            named(Kind::VelocityMissing, &[&missing, &should_be], &found);
        }
        let backwards = several(&[(beta, reversed)], true);
        let words = format!("the velocity of object {object} is reversed");
        named(
            Kind::VelocityWrong,
            &[&words],
            &diagnosed(&right, &backwards),
        );
    }
}

/// A box whose points stay on its surface, nearly, as its sides move along themselves.
#[test]
fn missing_velocities_are_named_by_events_of_sides_that_move_along_themselves() {
    let text = r#"
        camera = { eye = [0, 6, 9], look_at = [0, 0, 0], hfov = "50 deg", size = [160, 120], velocity = { beta = [0.1, -0.2, 0.15] } }
        [[object]]
        shape = { plane = { size = [30, 30] } }
        [[object]]
        shape = { box = { size = [0.9, 0.9, 0.9] } }
        velocity = { beta = [0.499, 0, -0.265] }
        origin = { position = [0.7, 0.5, -1], time = "-11 m" }
    "#;
    let right = shot(&parsed(text));
    let mut scene = parsed(&text.replace("[0.499, 0, -0.265]", "[0, 0, 0]"));
    scene.samples_per_pixel = 16;
    for centres in [true, false] {
        let at_rest = unknown_shot(&taken(&scene, centres));
        let found = diagnosed(&right, &only(&at_rest, &["object", "event"]));
        let words = [
            "the velocity of object 1 is missing",
            "β = (0.4990, 0.0000, -0.2650)",
        ];
        named(Kind::VelocityMissing, &words, &found);
    }
}

#[test]
fn events_of_right_pictures_and_of_displaced_objects_are_not_missing_velocities() {
    let right = shot(&parsed(SEVERAL));
    assert_eq!(diagnosed(&right, &several(&[], false)), []);
    // Half of a velocity is none of those that are named.
    let slower = several(&[("[0.6, 0, 0.3]", "[0.3, 0, 0.15]")], true);
    let is_velocity =
        |d: &Diagnosis| [Kind::VelocityMissing, Kind::VelocityWrong].contains(&d.kind);
    assert!(!diagnosed(&right, &slower).iter().any(is_velocity));
    for (place, moved) in [
        ("[-0.6, 0.5, 0]", "[-0.6, 0.9, 0.4]"),
        ("[1.2, 0.6, -1]", "[0.9, 1.1, -1]"),
    ] {
        let kinds = |found: Vec<Diagnosis>| found.iter().map(|d| d.kind).collect::<Vec<_>>();
        let found = kinds(diagnosed(&right, &several(&[(place, moved)], true)));
        assert_eq!(found, [Kind::ObjectElsewhere], "{place}");
    }
}
