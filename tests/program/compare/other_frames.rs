//! Bugs of programs that differ only in the reference of a channel: coordinates of another frame, signs, numberings of triangles and
//! vertices, W of another camera; and misplaced single objects.

use std::sync::Arc;

use nullray::validate::compare::{CompareOptions, Kind, Picture};

use crate::compare::planting::{
    SCENE, changed, diagnosed, diagnosed_with, exact, map, named, only, parsed, unknown, values,
    with,
};

/// The channels of a vector of the exact picture, by pixel.
fn vectors(name: &str) -> Vec<[f64; 3]> {
    let [x, y, z] = ["x", "y", "z"].map(|axis| values(&exact(), &format!("{name}.{axis}")));
    let pairs = x.into_iter().zip(y).zip(z);
    pairs.map(|((x, y), z)| [x, y, z]).collect()
}

/// The exact picture with another vector in these channels.
fn holding(name: &str, vectors: &[[f64; 3]]) -> Picture {
    let mut picture = exact();
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        map(&mut picture, &format!("{name}.{axis}"), |i, _| {
            vectors[i][k]
        });
    }
    picture
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Along right, up and backwards of the camera of the scene, which looks along (1.5, −0.3, −4).
fn view(v: [f64; 3]) -> [f64; 3] {
    let unit = |v: [f64; 3]| v.map(|x| x / dot(v, v).sqrt());
    let forward = unit([1.5, -0.3, -4.0]);
    // forward × (0, 1, 0), and right × forward.
    let right = unit([-forward[2], 0.0, forward[0]]);
    let up = [
        right[1] * forward[2] - right[2] * forward[1],
        right[2] * forward[0] - right[0] * forward[2],
        right[0] * forward[1] - right[1] * forward[0],
    ];
    [dot(v, right), dot(v, up), -dot(v, forward)]
}

#[test]
fn events_and_directions_in_another_frame_are_named() {
    let (event, time) = (vectors("event"), values(&exact(), "event.ct"));
    let check = |name: &str, wrong: &[[f64; 3]], words: &str| {
        let found = diagnosed(&exact(), &holding(name, wrong));
        named(Kind::FrameWrong, &[name, words], &found);
    };
    check("event", &vectors("object_event"), "the objects' own frames");
    // The shot is at (0; 0, 0.6, 4), and the camera moves with β = 0.5 along x.
    let relative: Vec<_> = event
        .iter()
        .map(|e| [e[0], e[1] - 0.6, e[2] - 4.0])
        .collect();
    check("event", &relative, "relative to the event of the shot");
    let gamma = 1.0 / 0.75f64.sqrt();
    let own = |(e, ct): (&[f64; 3], &f64)| [gamma * (e[0] - 0.5 * ct), e[1], e[2]];
    let camera: Vec<_> = relative.iter().zip(&time).map(own).collect();
    check("event", &camera, "the camera's frame");
    let seen: Vec<_> = camera.iter().map(|v| view(*v)).collect();
    check("event", &seen, "right, up, backwards");
    // A look direction is that of the past null vector (−1, d).
    let own = |d: &[f64; 3]| view([gamma * (d[0] + 0.5), d[1], d[2]]);
    let own = vectors("direction").iter().map(own).collect::<Vec<_>>();
    let unit: Vec<_> = own
        .iter()
        .map(|v| v.map(|x| x / dot(*v, *v).sqrt()))
        .collect();
    check("direction", &unit, "right, up, backwards");
}

#[test]
fn times_of_the_opposite_sign_are_named() {
    let wrong = changed(&["event.ct"], |_, t| -t);
    let words = ["event.ct has the opposite sign"];
    named(Kind::SignOpposite, &words, &diagnosed(&exact(), &wrong));
}

#[test]
fn triangles_that_are_counted_through_all_objects_are_named() {
    // A floor of two triangles, and boxes of twelve.
    let object = values(&exact(), "object");
    let first = |id: f64| [0.0, 2.0, 14.0][id.max(0.0) as usize];
    let wrong = changed(&["primitive"], |i, p| p + first(object[i]));
    let words = ["at 2 in object 1, at 14 in object 2"];
    named(
        Kind::IdentitiesShifted,
        &words,
        &diagnosed(&exact(), &wrong),
    );
}

#[test]
fn barycentric_coordinates_of_other_corners_are_named() {
    let [u, v] = ["u", "v"].map(|name| values(&exact(), &format!("barycentric.{name}")));
    let weights = |i: usize| [1.0 - u[i] - v[i], u[i], v[i]];
    for (order, words) in [
        ([2, 1], "the third and the second"),
        ([0, 1], "the first and the second"),
    ] {
        let mut wrong = exact();
        map(&mut wrong, "barycentric.u", |i, _| weights(i)[order[0]]);
        map(&mut wrong, "barycentric.v", |i, _| weights(i)[order[1]]);
        named(
            Kind::WeightsExchanged,
            &[words],
            &diagnosed(&exact(), &wrong),
        );
    }
}

#[test]
fn ratios_of_another_camera_are_named() {
    // W = γ (1 + β·d)/(γc (1 + βc·d)) of objects over the camera.
    let d = vectors("direction");
    let camera = |i: usize, beta: f64| (1.0 + beta * d[i][0]) / (1.0 - beta * beta).sqrt();
    for (beta, words) in [
        (0.0, "of a camera at rest"),
        (-0.5, "the opposite direction"),
    ] {
        let wrong = changed(&["wavelength_ratio"], |i, w| {
            w * camera(i, 0.5) / camera(i, beta)
        });
        for reference in [exact(), unknown(&exact())] {
            named(
                Kind::RatioOfCamera,
                &[words],
                &diagnosed(&reference, &wrong),
            );
        }
    }
}

#[test]
fn an_object_at_rest_at_its_position_at_the_shot_is_named() {
    // At β = 0.3 for 4 m from −1.
    let standing = with(&[
        ("velocity = { beta = [0.3, 0, 0] }", ""),
        ("[-1, 0.6, 0]", "[0.2, 0.6, 0]"),
    ]);
    let standing = only(&standing, &["object", "object_event"]);
    let words = ["object 1 is drawn at rest, at its position at the time of the shot"];
    named(
        Kind::RetardationMissing,
        &words,
        &diagnosed(&exact(), &standing),
    );
}

#[test]
fn an_object_somewhere_else_is_named_where_the_reference_does_not_show_it() {
    let away = with(&[("[-1, 0.6, 0]", "[-1, 2.2, 0]")]);
    let away = only(&away, &["object", "object_event"]);
    let found = diagnosed(&exact(), &away);
    named(Kind::ObjectElsewhere, &["object 1 is elsewhere"], &found);
}

#[test]
fn a_missing_object_is_named_by_light_where_the_scene_is_there() {
    let options = CompareOptions {
        scene: Some(Arc::new(parsed(SCENE))),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    let without = with(&[("[1, 0.6, 0]", "[1, -500, 0]")]);
    let found = diagnosed_with(&exact(), &only(&without, &["radiance"]), &options);
    named(Kind::ObjectMissing, &["object 2 is missing"], &found);
}
