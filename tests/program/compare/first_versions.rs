//! Mistakes that first versions of renderers make, in a scene whose camera is at rest: other mistakes explain each of them in part, and none
//! of those may be named.

use nullray::scene::model::Scene;
use nullray::scene::{self, Overrides};
use nullray::validate::compare::{Diagnosis, Kind, Picture};

use crate::compare::planting::{diagnosed, evidence, map, named, only, shot, values};

/// `scenes/dice.toml`, with changes: a floor and a box at rest, and a box that passes at 0.6 c.
fn dice(set: &[(&str, &str)]) -> Scene {
    let overrides = Overrides {
        size: Some([160, 100]),
        set: set
            .iter()
            .map(|(k, v)| (k.to_string(), v.to_string()))
            .collect(),
        ..Overrides::default()
    };
    scene::load("scenes/dice.toml".as_ref(), &overrides).unwrap()
}

fn exact() -> Picture {
    shot(&dice(&[]))
}

/// What is said of a picture of the scene with changes, as another program writes it: without metadata.
fn said_of(set: &[(&str, &str)]) -> Vec<Diagnosis> {
    diagnosed(&exact(), &plain(&shot(&dice(set))))
}

fn plain(picture: &Picture) -> Picture {
    let mut picture = picture.clone();
    picture.layers.metadata.clear();
    picture
}

fn changed(names: &[&str], of: impl Fn(usize, f64) -> f64) -> Picture {
    let mut picture = plain(&exact());
    names.iter().for_each(|name| map(&mut picture, name, &of));
    picture
}

#[test]
fn indices_from_1_are_not_a_camera_elsewhere() {
    let from_one = changed(&["object"], |_, id| if id < 0.0 { id } else { id + 1.0 });
    let words = ["indices of objects count from 1"];
    named(
        Kind::IdentitiesOneBased,
        &words,
        &diagnosed(&exact(), &from_one),
    );
    // All three renamed in a circle.
    let circle = changed(
        &["object"],
        |_, id| if id < 0.0 { id } else { (id + 1.0) % 3.0 },
    );
    let words = ["indices of objects are exchanged"];
    named(
        Kind::IdentitiesSwapped,
        &words,
        &diagnosed(&exact(), &circle),
    );
}

#[test]
fn an_axis_up_that_is_another_is_not_a_velocity_of_the_camera() {
    let exact = exact();
    for groups in [
        &["event", "object_event", "direction", "normal"][..],
        &["direction"],
    ] {
        let mut turned = plain(&exact);
        for group in groups {
            let [y, z] = ["y", "z"].map(|axis| values(&exact, &format!("{group}.{axis}")));
            map(&mut turned, &format!("{group}.y"), |i, _| -z[i]);
            map(&mut turned, &format!("{group}.z"), |i, _| y[i]);
        }
        let found = diagnosed(&exact, &turned);
        assert_eq!(found.len(), groups.len(), "{found:?}");
        for found in found {
            named(Kind::AxesExchanged, &["(x, −z, y)"], &[found]);
        }
    }
}

#[test]
fn one_displaced_object_is_not_another_time_of_the_camera() {
    let found = said_of(&[("object.passes.origin.position", "[1.4, 0.5, 0]")]);
    named(Kind::ObjectDisplaced, &["object 2 is displaced by"], &found);
    // Another time is one for all: that is when the floor is seen, too.
    let found = said_of(&[("camera.time", "\"0.3 m\"")]);
    named(Kind::CameraTime, &["at 0.3000 m"], &found);
}

#[test]
fn a_camera_that_is_turned_and_has_another_field_of_view_is_named_as_both() {
    let turned = [
        ("camera.look_at", "[0.3, 0.4, 0]"),
        ("camera.hfov", "\"40 deg\""),
    ];
    let found = said_of(&turned);
    named(
        Kind::CameraTurned,
        &["is turned by", "; and its tan(fov/2) is 0.85"],
        &found,
    );
    let right = 20f64.to_radians().tan() / 23f64.to_radians().tan();
    for way in ["across", "down"] {
        let name = format!("tan(fov/2) {way} over the reference's");
        assert!((evidence(&found, &name) - right).abs() < 1e-4, "{found:?}");
    }
    // The direction to the point looked at, seen from the eye, is turned by this angle.
    let [to, from] = [[0.3f64, -1.8, -5.5], [0.0, -1.8, -5.5]];
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let dot: f64 = to.iter().zip(from).map(|(a, b)| a * b).sum();
    let angle = (dot / length(to) / length(from)).acos().to_degrees();
    assert!(
        (evidence(&found, "degrees") - angle).abs() < 0.2,
        "{found:?}"
    );
}

#[test]
fn a_lens_that_distorts_is_no_camera_that_is_known() {
    let exact = exact();
    let mut bent = plain(&exact);
    let [x, y] = ["direction.x", "direction.y"].map(|name| values(&exact, name));
    // Rays farther from the middle are bent more.
    let off = |i: usize| [x[i], y[i] + 0.3];
    let factor = |i: usize| 1.0 + 0.4 * off(i).iter().map(|v| v * v).sum::<f64>();
    map(&mut bent, "direction.x", |i, x| x * factor(i));
    map(&mut bent, "direction.y", |i, y| y * factor(i));
    let bent = only(&bent, &["direction"]);
    named(
        Kind::ChannelWrong,
        &["look directions are wrong: by "],
        &diagnosed(&exact, &bent),
    );
}

#[test]
fn light_from_the_future_at_a_shot_at_0_is_not_a_sign_of_times() {
    // One that stays in view, and one that passes by: then only times show it, and that it is missing.
    for (speed, time, words) in [
        (0.15, 0.0, "as long after the shot"),
        (0.6, -5.9, "object 2 is out of view as a result"),
    ] {
        let exact = shot(&moving(speed, time));
        // In the mirror image of time the world moves backwards, and light that left later arrives earlier.
        let mut advanced = plain(&shot(&moving(-speed, -time)));
        for time in ["event.ct", "object_event.ct"] {
            map(&mut advanced, time, |_, ct| -ct);
        }
        let channels = ["object", "event", "object_event", "direction", "distance"];
        let found = diagnosed(&exact, &only(&advanced, &channels));
        named(
            Kind::RetardationReversed,
            &["t + r for t − r", words],
            &found,
        );
    }
    let ct = changed(&["event.ct"], |_, ct| -ct);
    let found = diagnosed(&exact(), &ct);
    named(
        Kind::SignOpposite,
        &["event.ct has the opposite sign"],
        &found,
    );
}

/// The scene with the box at another speed, and at its place at this time.
fn moving(beta: f64, time: f64) -> Scene {
    let velocity = format!("{{ beta = [{beta:?}, 0, 0] }}");
    let time = format!("\"{time:?} m\"");
    dice(&[
        ("object.passes.velocity", &velocity),
        ("object.passes.origin.time", &time),
    ])
}

#[test]
fn an_index_that_marks_no_hit_and_is_an_objects_is_named() {
    let started = changed(&["object"], |_, id| id.max(0.0));
    let found = diagnosed(&exact(), &started);
    named(
        Kind::SurfacesInvented,
        &["if 0 marks no hit, write −1"],
        &found,
    );
    // Whatever is shown in the sky.
    let box_in_sky = changed(&["object"], |i, id| {
        if i < 160 * 12 && i % 160 < 80 {
            1.0
        } else {
            id
        }
    });
    let found = diagnosed(&exact(), &box_in_sky);
    named(
        Kind::SurfacesInvented,
        &["shows nothing, most of them of object 1"],
        &found,
    );
}

#[test]
fn distances_of_another_measure_have_no_factor() {
    for (of, what) in [
        ((|d| 1.0 / d) as fn(f64) -> f64, "1/d"),
        (|d| d * d, "d²"),
        (|d| d.sqrt(), "√d"),
    ] {
        let wrong = changed(&["distance"], |_, d| of(d));
        let found = diagnosed(&exact(), &wrong);
        assert!(
            found.iter().all(|found| found.kind != Kind::Units),
            "{what}: {found:?}"
        );
    }
    let double = changed(&["distance"], |_, d| 2.0 * d);
    named(
        Kind::Units,
        &["2.000000 times"],
        &diagnosed(&exact(), &double),
    );
}
