//! Bugs that hide: in one object's channels, in one eye, in panoramas, in places of the camera and of lamps, in small fields of view.

use nullray::io::image::{Channel, Samples};
use nullray::validate::compare::{
    CompareOptions, Diagnosis, Encoding, Kind, NotFinite, Picture, compare,
};

use crate::compare::planting::{
    LIGHT, SCENE, changed, diagnosed, evidence, exact, map, named, only, parsed, rearranged, shot,
    taken, unknown, values, with,
};

fn light(picture: &Picture) -> Picture {
    only(picture, &["radiance"])
}

/// The exact picture with channels of object 2 changed.
fn in_object_2(names: &[&str], of: impl Fn(usize, f64) -> f64) -> Picture {
    let object = values(&exact(), "object");
    changed(names, |i, v| if object[i] == 2.0 { of(i, v) } else { v })
}

#[test]
fn wrong_channels_of_one_object_are_named_with_it() {
    let u = values(&exact(), "barycentric.u");
    let v = values(&exact(), "barycentric.v");
    let normal = ["normal.x", "normal.y", "normal.z"];
    let swapped = {
        let mut swapped = in_object_2(&["barycentric.u"], |i, _| v[i]);
        let object = values(&exact(), "object");
        let of = |i: usize, v: f64| if object[i] == 2.0 { u[i] } else { v };
        map(&mut swapped, "barycentric.v", of);
        swapped
    };
    for (wrong, kind, words) in [
        (
            in_object_2(&["event.x"], |_, x| x + 0.3),
            Kind::ChannelWrong,
            "event.x is wrong: at 100 % of the pixels that show the right points, by 0.3000 m",
        ),
        (
            in_object_2(&["normal.y"], |_, y| y + 0.05),
            Kind::ChannelWrong,
            "normal.y is wrong: at 100 %",
        ),
        (
            in_object_2(&["direction.x"], |_, x| x + 0.02),
            Kind::ChannelWrong,
            "direction.x is wrong: at 100 %",
        ),
        (
            in_object_2(&normal, |_, _| 0.577),
            Kind::ChannelWrong,
            "normal.x, normal.y and normal.z are wrong",
        ),
        (
            in_object_2(&["primitive"], |_, k| (7.0 * k + 3.0) % 12.0),
            Kind::ChannelWrong,
            "indices of triangles are wrong",
        ),
        (swapped, Kind::WeightsExchanged, "barycentric u and v"),
    ] {
        for reference in [exact(), unknown(&exact())] {
            let found = diagnosed(&reference, &wrong);
            named(kind, &["in object 2, ", words], &found);
        }
    }
    let unknown_light = changed(&["coverage"], |_, _| 0.0);
    let found = diagnosed(&exact(), &unknown_light);
    named(Kind::ChannelWrong, &["coverage is wrong: at 100 %"], &found);
    // Half of the indices of all objects do not begin anywhere.
    let halved = changed(&["primitive"], |_, k| (k / 2.0).floor());
    let found = diagnosed(&exact(), &halved);
    named(
        Kind::ChannelWrong,
        &["indices of triangles are wrong"],
        &found,
    );
}

/// Two bodies under a pulse, before a floor.
const PULSE: &str = r#"
    camera = { eye = [0.6, 1.7, 5], look_at = [0, 0.6, 0], hfov = "55 deg", size = [96, 72] }
    [[object]]
    name = "floor"
    shape = { plane = { size = [12, 12] } }
    colour = [0.5, 0.45, 0.4]
    [[object]]
    name = "box"
    shape = { box = { size = [1, 1.4, 0.8] } }
    colour = [0.8, 0.35, 0.1]
    velocity = { beta = [0.6, 0, 0.1] }
    origin = { position = [-1.3, 0.7, 0], time = "-5.5 m" }
    [[object]]
    name = "ball"
    shape = { sphere = { radius = 0.6, subdivisions = 3 } }
    colour = [0.2, 0.4, 0.8]
    velocity = { beta = [-0.4, 0, 0.2] }
    origin = { position = [1.0, 0.6, 0.2], time = "-5.0 m" }
    [[source]]
    name = "lamp"
    pulse = { position = [3, 5, 4], time = "-8 m", sigma = "60 m", intensity = 400 }
"#;

/// A picture of that scene with replacements, with samples all over pixels.
fn lit(replaced: &[(&str, &str)]) -> Picture {
    let mut text = PULSE.to_string();
    for (from, to) in replaced {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let mut scene = parsed(&text);
    scene.samples_per_pixel = 4;
    taken(&scene, false)
}

#[test]
fn another_place_of_the_camera_or_of_a_pulse_is_named_by_light_alone() {
    let reference = lit(&[]);
    let near = |found: &[Diagnosis], right: f64| {
        let size = evidence(found, "displaced by (m)");
        assert!((size / right - 1.0).abs() < 0.1, "{size}");
    };
    let moved = lit(&[("eye = [0.6, 1.7, 5]", "eye = [0.65, 1.7, 5]")]);
    let moved = diagnosed(&reference, &light(&moved));
    // The direction of view turned with it, to look at the same point.
    assert!(
        moved.iter().all(|found| found.kind != Kind::LightElsewhere),
        "{moved:?}"
    );
    let ahead = ("look_at = [0, 0.6, 0]", "forward = [-0.6, -1.1, -5]");
    let eye = lit(&[("eye = [0.6, 1.7, 5]", "eye = [0.65, 1.7, 5]"), ahead]);
    let found = diagnosed(&lit(&[ahead]), &light(&eye));
    named(Kind::CameraElsewhere, &["by light"], &found);
    near(&found, 0.05);
    let lamp = lit(&[("position = [3, 5, 4]", "position = [3.1, 5, 4]")]);
    let found = diagnosed(&reference, &light(&lamp));
    named(
        Kind::LightElsewhere,
        &[
            "the pulse \"lamp\" is elsewhere",
            "(3.0000, 5.0000, 4.0000)",
        ],
        &found,
    );
    near(&found, 0.1);
}

#[test]
fn objects_at_rest_are_named_by_light_alone() {
    let rest = lit(&[
        ("beta = [0.6, 0, 0.1]", "beta = [0, 0, 0]"),
        ("beta = [-0.4, 0, 0.2]", "beta = [0, 0, 0]"),
    ]);
    let found = diagnosed(&lit(&[]), &light(&rest));
    let words = "the velocities of all objects are missing";
    named(Kind::VelocityMissing, &[words], &found);
}

/// Dice whose rounded corners have triangles smaller than a pixel.
#[test]
fn other_samples_of_small_triangles_are_not_wrong_indices() {
    let mut dice = parsed(
        r#"
        camera = { eye = [2.6, 1.9, 3], look_at = [0, 0, 0], hfov = "40 deg", size = [96, 72] }
        [[object]]
        gltf = "scenes/gallery/die.glb"
        velocity = { beta = [0.3, 0, 0] }
        "#,
    );
    let few = {
        dice.samples_per_pixel = 4;
        taken(&dice, false)
    };
    dice.samples_per_pixel = 16;
    assert_eq!(diagnosed(&few, &taken(&dice, false)), []);
    assert_eq!(diagnosed(&shot(&dice), &few), []);
}

#[test]
fn a_higher_eye_is_not_a_factor_on_distances() {
    let ahead = ("look_at = [1.5, 0.3, 0]", "forward = [1.5, -0.3, -4]");
    let reference = with(&[ahead]);
    let higher = with(&[ahead, ("eye = [0, 0.6, 4]", "eye = [0, 0.69, 4]")]);
    let found = diagnosed(&reference, &higher);
    named(Kind::CameraElsewhere, &["(0.0000, 0.6900, 4.0000)"], &found);
}

#[test]
fn another_place_of_the_camera_is_named_by_points() {
    let ahead = ("look_at = [1.5, 0.3, 0]", "forward = [1.5, -0.3, -4]");
    let reference = with(&[ahead]);
    let moved = with(&[ahead, ("eye = [0, 0.6, 4]", "eye = [0, 0.65, 4]")]);
    let found = diagnosed(&reference, &only(&moved, &["object", "object_event"]));
    let words = ["the camera is elsewhere", "(0.0000, 0.6500, 4.0000)"];
    named(Kind::CameraElsewhere, &words, &found);
}

/// Panoramas with the other half in the middle, and with mirrored halves.
#[test]
fn panoramas_moved_around_their_edge_are_named() {
    let fov = (
        "hfov = \"55 deg\", size = [96, 72]",
        "projection = \"equirectangular\", size = [128, 64]",
    );
    let reference = lit(&[fov]);
    let half = rearranged(&reference, |x, y| [(x + 64) % 128, y]);
    let quarter = rearranged(&reference, |x, y| [(x + 96) % 128, y]);
    let mirrored = rearranged(&reference, |x, y| [(191 - x) % 128, y]);
    for groups in [&["radiance"][..], &["object", "event"]] {
        let found = |picture: &Picture| diagnosed(&reference, &only(picture, groups));
        named(
            Kind::FilmShifted,
            &["around its edge by 180"],
            &found(&half),
        );
        named(
            Kind::FilmShifted,
            &["by 90 degrees to the right"],
            &found(&quarter),
        );
        named(
            Kind::Mirrored,
            &["left to right", "by 180"],
            &found(&mirrored),
        );
    }
}

/// A panorama of that scene, with `samples` per pixel.
fn panorama(samples: u32) -> Picture {
    let fov = "hfov = \"55 deg\", size = [96, 72]";
    let text = PULSE.replace(fov, "projection = \"equirectangular\", size = [128, 64]");
    let mut scene = parsed(&text);
    scene.samples_per_pixel = samples;
    taken(&scene, false)
}

/// All pixels at edges differ between the two, whichever way the film is turned.
#[test]
fn turned_and_clipped_light_is_named_where_samples_differ_too() {
    let [reference, other] = [panorama(16), panorama(2)];
    let moved = rearranged(&other, |x, y| [(x + 96) % 128, y]);
    for candidate in [light(&moved), moved] {
        let words = ["around its edge by 90 degrees to the right"];
        let found = diagnosed(&reference, &candidate);
        named(Kind::FilmShifted, &words, &found);
    }
    let brightest = LIGHT.iter().flat_map(|name| values(&reference, name));
    let bound = 0.4 * brightest.fold(0.0, f64::max);
    let mut clipped = other;
    for name in LIGHT {
        map(&mut clipped, name, |_, v| v.min(bound));
    }
    let words = format!("light is clipped at {bound:.4}");
    let found = diagnosed(&reference, &light(&clipped));
    named(Kind::Clipped, &[&words], &found);
}

#[test]
fn light_clipped_elsewhere_than_at_1_is_named_with_the_bound() {
    let brightest = LIGHT.iter().flat_map(|name| values(&exact(), name));
    let bound = 0.6 * brightest.fold(0.0, f64::max);
    let clipped = changed(&LIGHT, |_, v| v.min(bound));
    for candidate in [clipped.clone(), light(&clipped)] {
        let words = format!("light is clipped at {bound:.4}");
        named(Kind::Clipped, &[&words], &diagnosed(&exact(), &candidate));
    }
}

#[test]
fn small_exposures_of_codes_are_named() {
    let encode = |factor: f64| {
        let mut picture = only(&exact(), &["radiance"]);
        picture.layers.metadata.clear();
        picture.encoding = Encoding::Srgb;
        for name in LIGHT {
            map(&mut picture, name, |_, v| {
                let v = 0.3 * factor * v;
                let code = match v <= 0.003_130_8 {
                    true => 12.92 * v,
                    false => 1.055 * v.powf(1.0 / 2.4) - 0.055,
                };
                (255.0 * code.clamp(0.0, 1.0)).round() / 255.0
            });
        }
        picture
    };
    for factor in [0.9, 1.1] {
        let found = diagnosed(&encode(1.0), &encode(factor));
        named(Kind::Exposure, &["uniformly"], &found);
        assert!((evidence(&found, "factor") / factor - 1.0).abs() < 0.01);
    }
    assert_eq!(diagnosed(&encode(1.0), &encode(1.01)), []);
}

#[test]
fn a_slightly_wider_field_of_view_is_not_another_velocity() {
    let wider = 2.0 * (1.001 * 30f64.to_radians().tan()).atan().to_degrees();
    let wider = with(&[("60 deg", &format!("{wider} deg"))]);
    let found = diagnosed(&exact(), &wider);
    named(Kind::FieldOfView, &["1.0010 times"], &found);
}

/// A stereo pair of that scene with a moving camera.
fn pair(replaced: &[(&str, &str)]) -> Picture {
    let stereo = (
        "size = [96, 72]",
        "size = [192, 72], stereo = { interpupillary_distance = \"0.4 m\" }",
    );
    with(&[&[stereo], replaced].concat())
}

#[test]
fn mistakes_of_stereo_pairs_are_named_by_eye() {
    let reference = pair(&[]);
    assert_eq!(diagnosed(&reference, &reference), []);
    let exchanged = rearranged(&reference, |x, y| [(x + 96) % 192, y]);
    let found = diagnosed(&reference, &exchanged);
    named(Kind::EyesExchanged, &["left and the right eye"], &found);
    // One eye's picture for both, as it is and by light alone.
    for (shift, name) in [(0, "left"), (96, "right")] {
        let once = rearranged(&reference, |x, y| [x % 96 + shift, y]);
        for candidate in [light(&once), once] {
            let words = ["both eyes have the same picture", name];
            named(Kind::EyesAlike, &words, &diagnosed(&reference, &candidate));
        }
    }
    // What both eyes share is a mistake of the pair.
    let found = diagnosed(&reference, &pair(&[("60 deg", "66 deg")]));
    named(Kind::FieldOfView, &["the field of view"], &found);
    assert!(!found[0].what.contains("eye"), "{}", found[0].what);
    // Pupils twice as far apart are 0.2 m off on each side.
    let wide = diagnosed(&reference, &pair(&[("0.4 m", "0.8 m")]));
    for eye in ["left", "right"] {
        let side = if eye == "left" { "-" } else { "+" };
        let words = format!(
            "in the {eye} eye, the camera is displaced in its own frame: by {side}0.2000 m"
        );
        assert!(
            wide.iter().any(|found| found.what.contains(&words)),
            "{wide:?}"
        );
    }
    // One eye's colours.
    let mut red = reference.clone();
    for (name, from) in [("radiance.R", "radiance.B"), ("radiance.B", "radiance.R")] {
        let from = values(&reference, from);
        map(
            &mut red,
            name,
            |i, v| if i % 192 < 96 { v } else { from[i] },
        );
    }
    let found = diagnosed(&reference, &red);
    let words = ["in the right eye, colours are exchanged"];
    named(Kind::ColoursExchanged, &words, &found);
}

/// A candidate's fourth channel of light is the reference's `alpha`.
#[test]
fn transparent_light_is_compared_with_the_channel_alpha() {
    let reference = shot(&parsed(&SCENE.replace("12, 12", "3, 3")));
    let alpha = reference.layers.channel("alpha").unwrap().clone();
    let mut candidate = light(&reference);
    candidate.layers.channels.push(Channel {
        name: "A".into(),
        ..alpha
    });
    let compared = compare(&reference, &candidate, &CompareOptions::default()).unwrap();
    assert_eq!(compared.metric("alpha:max"), Some(0.0));
    assert_eq!(compared.uncompared.only_candidate, Vec::<String>::new());
    map(&mut candidate, "A", |_, v| 0.5 * v);
    let compared = compare(&reference, &candidate, &CompareOptions::default()).unwrap();
    assert_eq!(compared.metric("alpha:max"), Some(0.5));
}

#[test]
fn pixels_left_out_for_their_light_count_as_not_measured() {
    let object = values(&exact(), "object");
    let dark = |_: usize, v: f64| v;
    let mut wrong = changed(&["event.x"], dark);
    for name in LIGHT {
        map(
            &mut wrong,
            name,
            |i, v| if object[i] > 0.0 { f64::NAN } else { v },
        );
    }
    let options = CompareOptions {
        not_finite: NotFinite::Ignore,
        ..CompareOptions::default()
    };
    let compared = compare(&exact(), &wrong, &options).unwrap();
    let limit = ["geometric.max=0.1".parse().unwrap()];
    let breaches = compared.breaches(&limit).unwrap();
    assert!(
        breaches[0].to_string().contains("of objects 1, 2"),
        "{breaches:?}"
    );
}

#[test]
fn infinite_events_are_not_measured_and_bins_have_a_width() {
    let mut wrong = exact();
    map(&mut wrong, "event.ct", |_, t| {
        if t.is_nan() { t } else { f64::INFINITY }
    });
    let compared = compare(&exact(), &wrong, &CompareOptions::default()).unwrap();
    let limit = ["time.max=0.1".parse().unwrap()];
    let breaches = compared.breaches(&limit).unwrap();
    assert!(
        breaches[0].to_string().contains("could not be computed"),
        "{breaches:?}"
    );
    for width in [0.0, -0.05, f64::NAN] {
        let options = CompareOptions {
            bin_width: Some(width),
            ..CompareOptions::default()
        };
        let error = compare(&exact(), &exact(), &options).unwrap_err();
        assert!(error.to_string().contains("bins of"), "{error}");
    }
}

#[test]
fn pictures_without_objects_say_that_none_is_shown() {
    let mut empty = only(&exact(), &["object"]);
    map(&mut empty, "object", |_, _| -1.0);
    empty.layers.channels[0].samples = Samples::I32(vec![-1; 96 * 72]);
    let compared = compare(&empty, &empty, &CompareOptions::default()).unwrap();
    let limit = ["coverage=0.99".parse().unwrap()];
    let breaches = compared.breaches(&limit).unwrap();
    assert!(
        breaches[0].to_string().contains("shows no object"),
        "{breaches:?}"
    );
}

/// Where nearly all edges have one direction, nothing fixes a shift along it.
#[test]
fn other_samples_of_a_single_edge_are_no_shift_along_it() {
    let text = r#"
        camera = { eye = [0.4, 1.3, 4], look_at = [0, 0.5, 0], hfov = "3 deg", size = [120, 90] }
        [[object]]
        shape = { box = { size = [1, 1, 1] } }
        colour = [0.8, 0.35, 0.1]
        velocity = { beta = [0.7, 0, 0] }
        origin = { position = [-3.8, 0.5, 0], time = "-8.6 m" }
        [[object]]
        shape = { sphere = { radius = 0.5, subdivisions = 5 } }
        colour = [0.2, 0.4, 0.8]
        velocity = { beta = [-0.5, 0, 0.2] }
        origin = { position = [3, 0.5, -0.6], time = "-8.6 m" }
        [[source]]
        pulse = { position = [0.5, 2.4, 1.4], time = "-7 m", sigma = "30 m", intensity = 12 }
    "#;
    let mut scene = parsed(text);
    let right = shot(&scene);
    for samples in [4, 16, 64] {
        scene.samples_per_pixel = samples;
        let candidate = light(&taken(&scene, false));
        for reference in [right.clone(), unknown(&right)] {
            assert_eq!(diagnosed(&reference, &candidate), [], "{samples}");
        }
    }
    // Across the edge it is seen.
    let moved = light(&rearranged(&right, |x, y| [x - 1, y - 1]));
    assert_ne!(diagnosed(&right, &moved), []);
}

/// Where light would arrive from as much later as it left earlier: the bodies move at −β through their places at the time of the shot.
const ADVANCED: [(&str, &str); 4] = [
    ("beta = [0.3, 0, 0]", "beta = [-0.3, 0, 0]"),
    (
        "position = [-1, 0.6, 0], time = \"-4 m\"",
        "position = [0.2, 0.6, 0], time = \"0 m\"",
    ),
    ("beta = [-0.4, 0, 0]", "beta = [0.4, 0, 0]"),
    (
        "position = [1, 0.6, 0], time = \"-4 m\"",
        "position = [-0.6, 0.6, 0], time = \"0 m\"",
    ),
];

#[test]
fn retardation_of_the_opposite_sign_is_named() {
    let advanced = with(&ADVANCED);
    for groups in [&["object", "object_event"][..], &["radiance"]] {
        let found = diagnosed(&exact(), &only(&advanced, groups));
        named(Kind::RetardationReversed, &["t + r for t − r"], &found);
    }
}

#[test]
fn velocities_that_are_all_reversed_are_named_by_light_alone() {
    let reversed = light(&with(&[ADVANCED[0], ADVANCED[2]]));
    let words = ["of all objects are reversed"];
    named(Kind::VelocityWrong, &words, &diagnosed(&exact(), &reversed));
}

/// The exact picture without the surfaces at the pixels that are lost.
fn clipped(is_lost: impl Fn(usize) -> bool) -> Picture {
    let mut clipped = exact();
    let names: Vec<String> = clipped
        .layers
        .channels
        .iter()
        .map(|c| c.name.clone())
        .collect();
    for name in names.iter().filter(|name| !name.starts_with("direction")) {
        let nothing = match name.as_str() {
            "object" | "primitive" => -1.0,
            name if name.starts_with("radiance") => 0.0,
            _ => f64::NAN,
        };
        map(
            &mut clipped,
            name,
            |i, v| if is_lost(i) { nothing } else { v },
        );
    }
    clipped
}

#[test]
fn planes_that_clip_surfaces_are_named_with_their_distance() {
    let distance = values(&exact(), "distance");
    let near = clipped(|i| distance[i] < 2.5);
    let far = clipped(|i| distance[i] > 4.0);
    let groups: [&[&str]; 3] = [
        &["object", "event"],
        &["object", "object_event"],
        &["radiance"],
    ];
    for groups in groups {
        let found = diagnosed(&exact(), &only(&near, groups));
        named(Kind::SurfacesClipped, &["surfaces nearer than 2."], &found);
        let found = diagnosed(&exact(), &only(&far, groups));
        named(Kind::SurfacesClipped, &["surfaces farther than "], &found);
    }
    // A part of the floor that no plane cuts off.
    let floor = values(&exact(), "object");
    let culled = clipped(|i| floor[i] == 0.0 && i % 96 < 30);
    let found = diagnosed(&exact(), &only(&culled, &["object", "event"]));
    named(Kind::SurfacesMissing, &["surfaces are missing"], &found);
}

#[test]
fn another_distance_of_the_eyes_is_named_by_light_alone() {
    let wide = light(&pair(&[("0.4 m", "0.6 m")]));
    let found = diagnosed(&pair(&[]), &wide);
    assert!(!found.is_empty());
    for eye in &found {
        assert!(eye.what.contains("the eyes are 0.6"), "{found:?}");
    }
}
