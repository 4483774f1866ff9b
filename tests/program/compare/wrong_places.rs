//! Points on the right rays that are not on the right surfaces, and what is not said where places are wrong or unknown.

use std::sync::Arc;

use nullray::io::image::Samples;
use nullray::validate::compare::{CompareOptions, Diagnosis, Kind, Picture, Tolerance, compare};

use crate::compare::planting::{
    LIGHT, SCENE, changed, diagnosed, diagnosed_with, exact, map, named, only, parsed, shot,
    values, with,
};

const OWN: [&str; 3] = ["object_event.x", "object_event.y", "object_event.z"];
const NORMAL: [&str; 3] = ["normal.x", "normal.y", "normal.z"];

/// The picture with the back faces of the left box, of 1.2 m, in place of its front faces. The shot is at (0, 0.6, 4) at ct = 0, and with
/// β = 0.3, in the frame of the box, at q = (γ(1 − 0.3·4), 0, 4). The ray q + t (X − q) leaves the box at the least t > 1 at which a
/// coordinate is ±0.6.
fn inside_out() -> Picture {
    let exact = exact();
    let q = [-0.2 / f64::sqrt(1.0 - 0.09), 0.0, 4.0];
    let object = values(&exact, "object");
    let [own, normal] = [OWN, NORMAL].map(|names| names.map(|name| values(&exact, name)));
    let mut wrong = exact.clone();
    let (mut places, mut normals) = (own.clone(), normal);
    for i in (0..object.len()).filter(|i| object[*i] == 1.0) {
        let x = [0, 1, 2].map(|k| own[k][i]);
        let leaves = |k: usize| {
            let side = 0.6 * (x[k] - q[k]).signum();
            (side - q[k]) / (x[k] - q[k])
        };
        let axis = (0..3)
            .min_by(|a, b| leaves(*a).total_cmp(&leaves(*b)))
            .unwrap();
        for k in 0..3 {
            places[k][i] = q[k] + leaves(axis) * (x[k] - q[k]);
            let outwards = (x[k] - q[k]).signum();
            normals[k][i] = if k == axis { outwards } else { 0.0 };
        }
    }
    for k in 0..3 {
        map(&mut wrong, OWN[k], |i, _| places[k][i]);
        map(&mut wrong, NORMAL[k], |i, _| normals[k][i]);
    }
    wrong
}

fn metric(reference: &Picture, candidate: &Picture, name: &str) -> f64 {
    let found = compare(reference, candidate, &CompareOptions::default());
    found.unwrap().metric(name).unwrap()
}

#[test]
fn back_faces_are_named_and_exceed_limits_on_geometric_errors() {
    let (exact, wrong) = (exact(), inside_out());
    let with_normals = only(&wrong, &["object", "object_event", "normal"]);
    named(
        Kind::BackFaces,
        &["back faces of object 1 are shown"],
        &diagnosed(&exact, &with_normals),
    );
    let without = only(&wrong, &["object", "object_event"]);
    named(
        Kind::BackFaces,
        &["back faces of object 1 may be shown"],
        &diagnosed(&exact, &without),
    );
    let found = compare(&exact, &without, &CompareOptions::default()).unwrap();
    let limit: Tolerance = "geometric.p99=0.1".parse().unwrap();
    assert_eq!(found.breaches(&[limit]).unwrap().len(), 1);
    // In the middle of the front face, of pixels that are far smaller, the back is off by its distance in pixels.
    assert!(found.metric("geometric.max").unwrap() > 10.0);
    assert!(
        metric(
            &exact,
            &only(&exact, &["object", "object_event"]),
            "geometric.max"
        ) < 1e-9
    );
}

#[test]
fn a_box_that_is_turned_in_place_is_not_at_the_right_points() {
    let turned = with(&[(
        "colour = [0.3, 0.7, 0.5]",
        "colour = [0.3, 0.7, 0.5]\ntransform = { rotate = { axis = [0, 1, 0], angle = \"20 deg\" } }",
    )]);
    let turned = only(
        &turned,
        &["object", "object_event", "normal", "uv", "primitive"],
    );
    let found = diagnosed(&exact(), &turned);
    named(Kind::ObjectElsewhere, &["object 2 is "], &found);
    assert!(metric(&exact(), &turned, "geometric.p99") > 0.5);
}

#[test]
fn samples_elsewhere_in_pixels_are_on_the_surface_also_at_silhouettes() {
    // Half a pixel apart, of which every point of a ball is displaced, whatever it is along its ray.
    let text = SCENE.replacen(
        "box = { size = [1.2, 1.2, 1.2] }",
        "sphere = { radius = 0.6, subdivisions = 5 }",
        1,
    );
    let exact = shot(&parsed(&text));
    let whole = shot(&parsed(&text.replace("[96, 72]", "[192, 144]")));
    let from_column = |first: usize| {
        let mut cut = exact.clone();
        for channel in &mut cut.layers.channels {
            let values = values(&whole, &channel.name);
            let at = |i: usize| values[2 * (i / 96) * 192 + 2 * (i % 96) + first];
            channel.samples = Samples::F64((0..96 * 72).map(at).collect());
        }
        cut
    };
    let [left, right] = [0, 1].map(from_column);
    let places = only(&right, &["object", "object_event"]);
    assert!((metric(&left, &places, "geometric.p99") - 0.5).abs() < 1e-3);
}

/// The scene in the light of a pulse, whose shadows are black.
fn lit(text: &str) -> String {
    format!(
        "{text}\n[[source]]\npulse = {{ position = [-3, 3, 1], time = \"-8 m\", sigma = \"40 m\", intensity = 12, shadows = true }}\n"
    )
}

#[test]
fn a_box_elsewhere_is_not_taken_for_missing_shadows() {
    let reference = shot(&parsed(&lit(SCENE)));
    let moved = SCENE.replace("position = [1, 0.6, 0]", "position = [1, 2.3, 0]");
    let moved = shot(&parsed(&lit(&moved)));
    let found = diagnosed(&reference, &moved);
    named(Kind::ObjectElsewhere, &["object 2 is elsewhere"], &found);
    let options = CompareOptions {
        scene: Some(Arc::new(parsed(&lit(SCENE)))),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    let by_light = diagnosed_with(&reference, &only(&moved, &["object", "radiance"]), &options);
    let is_shadow = |found: &Diagnosis| found.kind == Kind::ShadowsMissing;
    assert!(!by_light.iter().any(is_shadow), "{by_light:?}");
}

#[test]
fn light_of_another_exponent_from_surfaces_and_on_them_is_named_once() {
    let with = |quantity: &str| {
        shot(&parsed(&lit(&format!(
            "radiance = {{ quantity = {quantity:?} }}\n{SCENE}"
        ))))
    };
    let mut wrong = with("per_frequency");
    wrong.layers.metadata.clear();
    let found = diagnosed(&with("integrated"), &wrong);
    named(
        Kind::ExponentWrong,
        &["p of W is 3 and should be 4"],
        &found,
    );
}

#[test]
fn what_a_candidate_does_not_say_of_its_points_is_not_said_of_them() {
    let exact = exact();
    let object = values(&exact, "object");
    let mut wrong = only(&exact, &["direction", "wavelength_ratio"]);
    let noise = |i: usize| 1.0 + 0.3 * ((i * 7919 % 101) as f64 / 100.0);
    map(&mut wrong, "wavelength_ratio", |i, w| {
        if object[i] == 2.0 { w * noise(i) } else { w }
    });
    let found = diagnosed(&exact, &wrong);
    let words = [
        "where the reference shows object 2, wavelength_ratio is wrong",
        " % of the pixels, by",
    ];
    named(Kind::ChannelWrong, &words, &found);
}

#[test]
fn what_may_hide_a_missing_object_is_named() {
    // The left box, where the right one should be.
    let moved = changed(&["object"], |_, id| match id {
        1.0 => 0.0,
        2.0 => 1.0,
        id => id,
    });
    let found = diagnosed(&exact(), &only(&moved, &["object"]));
    let missing = found
        .iter()
        .find(|d| d.kind == Kind::ObjectMissing)
        .unwrap();
    for words in ["object 2 is missing", "object 1 is shown at most of these"] {
        assert!(missing.what.contains(words), "{}", missing.what);
    }
}

#[test]
fn a_camera_that_is_turned_is_not_called_another_film_by_light_without_a_doubt() {
    for look_at in ["[1.5, 0.35, 0]", "[1.5, 0.25, 0]", "[1.55, 0.3, 0]"] {
        let turned = with(&[("look_at = [1.5, 0.3, 0]", &format!("look_at = {look_at}"))]);
        for found in diagnosed(&exact(), &only(&turned, &["radiance"])) {
            let is_film =
                [Kind::FilmShifted, Kind::Aspect, Kind::FieldOfView].contains(&found.kind);
            let is_doubted = found
                .what
                .contains("the camera may also be elsewhere, or turned")
                || found.what.contains("that may be half a pixel");
            assert!(!is_film || is_doubted, "{}", found.what);
        }
    }
}

#[test]
fn one_object_has_no_exposure_of_its_own_beside_unexplained_light() {
    let exact = exact();
    let object = values(&exact, "object");
    let mut wrong = only(&exact, &["object", "radiance"]);
    for (k, name) in LIGHT.iter().enumerate() {
        map(&mut wrong, name, |i, v| match object[i] {
            1.0 => 0.9 * v,
            _ => v * (0.7 + 0.6 * (((i + 31 * k) * 7919 % 101) as f64 / 100.0)),
        });
    }
    let found = diagnosed(&exact, &wrong);
    assert!(found.iter().all(|d| d.kind != Kind::Exposure), "{found:?}");
}

#[test]
fn other_primaries_are_named() {
    // ITU-R BT.2087, and the usual matrix of Display P3, to four decimals.
    for (name, matrix) in [
        (
            "Rec. 2020",
            [
                [0.6274, 0.3293, 0.0433],
                [0.0691, 0.9195, 0.0114],
                [0.0164, 0.0880, 0.8956],
            ],
        ),
        (
            "Display P3",
            [
                [0.8225, 0.1774, 0.0],
                [0.0332, 0.9669, 0.0],
                [0.0171, 0.0724, 0.9108],
            ],
        ),
    ] {
        let exact = exact();
        let light = LIGHT.map(|name| values(&exact, name));
        let mut wrong = only(&exact, &["radiance"]);
        for (k, row) in matrix.into_iter().enumerate() {
            map(&mut wrong, LIGHT[k], |i, _| {
                (0..3).map(|j| row[j] * light[j][i]).sum()
            });
        }
        let words = format!("in the primaries of {name}");
        named(Kind::Primaries, &[&words], &diagnosed(&exact, &wrong));
    }
}

#[test]
fn a_channel_z_is_said_not_to_be_compared_with_distances() {
    let exact = exact();
    let mut named_z = exact.clone();
    let channel = named_z
        .layers
        .channels
        .iter_mut()
        .find(|c| c.name == "distance");
    channel.unwrap().name = "Z".into();
    let found = compare(&exact, &named_z, &CompareOptions::default()).unwrap();
    assert!(
        found
            .notes
            .iter()
            .any(|note| note.contains("name it distance")),
        "{:?}",
        found.notes
    );
    let right = compare(&exact, &exact, &CompareOptions::default()).unwrap();
    assert!(
        !right
            .notes
            .iter()
            .any(|note| note.contains("name it distance"))
    );
}
