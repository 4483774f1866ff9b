//! Channels with wrong numbers: one number everywhere, rounded times, another measure of the Doppler shift.

use std::sync::Arc;

use nullray::scene::model::{SourceKind, TimeFilter};
use nullray::scene::{self, Overrides};
use nullray::validate::compare::{CompareOptions, Kind, Picture};

use crate::compare::planting::{
    LIGHT, changed, diagnosed, diagnosed_with, evidence, exact, map, named, only, shot, unknown,
    values,
};

#[test]
fn channels_that_hold_one_number_are_named_and_nothing_follows_from_them() {
    let constant = |names: &[&str], number: f64| {
        let everywhere = changed(names, |_, _| number);
        let surfaces = changed(names, |_, v| if v.is_nan() { v } else { number });
        [everywhere, surfaces]
    };
    for (names, number, words) in [
        (
            &["event.x", "event.y", "event.z", "event.ct"][..],
            0.0,
            "channels event.x, event.y, event.z are",
        ),
        (
            &["object_event.x", "object_event.y", "object_event.z"],
            1.0,
            "channels object_event.x, object_event.y, object_event.z are",
        ),
        (
            &["direction.x", "direction.y", "direction.z"],
            0.0,
            "channels direction.x, direction.y, direction.z are",
        ),
        (
            &["distance"],
            0.0,
            "channel distance is the same number, 0,",
        ),
        (
            &["wavelength_ratio"],
            0.7,
            "channel wavelength_ratio is the same number, 0.7,",
        ),
        (
            &["wavelength_ratio"],
            1.0,
            "that of light without a Doppler shift",
        ),
        (&["uv.u", "uv.v"], 0.0, "channels uv.u, uv.v are"),
        (
            &LIGHT,
            0.5,
            "radiance.R, radiance.G, radiance.B are the same number, 0.5,",
        ),
        (
            &["normal.x", "normal.y", "normal.z"],
            0.0,
            "are the same number, 0, at every pixel",
        ),
    ] {
        for wrong in constant(names, number) {
            for reference in [exact(), unknown(&exact())] {
                named(
                    Kind::ConstantChannel,
                    &[words],
                    &diagnosed(&reference, &wrong),
                );
            }
        }
    }
    let [zero, _] = constant(&["object"], 0.0);
    named(
        Kind::ConstantChannel,
        &["channel object"],
        &diagnosed(&exact(), &zero),
    );
}

#[test]
fn what_else_is_wrong_is_named_beside_a_channel_of_one_number() {
    let mut wrong = changed(&["distance"], |_, _| 0.0);
    for name in LIGHT {
        map(&mut wrong, name, |_, v| 2.0 * v);
    }
    let found = diagnosed(&exact(), &wrong);
    let kinds: Vec<Kind> = found.iter().map(|d| d.kind).collect();
    assert_eq!(kinds, [Kind::ConstantChannel, Kind::Exposure], "{found:?}");
}

#[test]
fn a_mistake_of_all_objects_is_said_once() {
    let lost = changed(&["event.x", "event.y"], |_, _| f64::NAN);
    let found = diagnosed(&exact(), &lost);
    named(
        Kind::NotANumber,
        &["there are no numbers in event.x, event.y"],
        &found,
    );
    assert!(!found[0].what.contains("in object"), "{found:?}");
    // Of two objects of three.
    let object = values(&exact(), "object");
    let lost = changed(
        &["event.x"],
        |i, v| if object[i] > 0.0 { f64::NAN } else { v },
    );
    let found = diagnosed(&exact(), &lost);
    named(
        Kind::NotANumber,
        &["in objects 1, 2, there are no numbers"],
        &found,
    );
}

#[test]
fn times_that_are_rounded_to_bins_are_named() {
    for (of, words, shift) in [
        (f64::round as fn(f64) -> f64, "to the nearest", 0.0),
        (f64::floor, "down", -0.5),
        (f64::ceil, "up", 0.5),
    ] {
        let wrong = changed(&["event.ct"], |_, t| 0.05 * of(t / 0.05));
        for wrong in [wrong.clone(), only(&wrong, &["object", "event"])] {
            let found = diagnosed(&exact(), &wrong);
            named(
                Kind::TimesRounded,
                &["whole bins of 0.050000 m", words],
                &found,
            );
            assert_eq!(evidence(&found, "mean shift (steps)"), shift);
        }
    }
    // Of another width than that of the bins.
    let wrong = changed(&["event.ct"], |_, t| 0.02 * (t / 0.02).round());
    named(
        Kind::TimesRounded,
        &["whole steps of 0.020000 m"],
        &diagnosed(&exact(), &wrong),
    );
}

#[test]
fn light_of_whole_bins_is_named_where_the_scene_is_there() {
    let overrides = Overrides {
        size: Some([64, 48]),
        ..Overrides::default()
    };
    let scene = scene::load("scenes/capture.toml".as_ref(), &overrides).unwrap();
    let options = CompareOptions {
        scene: Some(Arc::new(scene.clone())),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    let mut whole = scene.clone();
    for source in &mut whole.sources {
        if let SourceKind::Cube(cube) = &mut source.kind {
            cube.filter = TimeFilter::Nearest;
        }
    }
    let found = diagnosed_with(&shot(&scene), &shot(&whole), &options);
    named(
        Kind::TimesRounded,
        &["whole bins in the lookup of light"],
        &found,
    );
}

#[test]
fn other_numbers_of_the_doppler_shift_are_named() {
    type Form = fn(f64) -> f64;
    let forms: [(Form, &str); 8] = [
        (|w| w - 1.0, "holds W − 1,"),
        (|w| 1.0 / w - 1.0, "holds 1/W − 1,"),
        (f64::ln, "holds ln W,"),
        (|w| -w.ln(), "holds −ln W,"),
        (|w| w * w, "holds W^(+2),"),
        (|w| w.powi(-5), "holds W^(-5),"),
        (f64::sqrt, "holds W^(+0.5),"),
        (|w| w.powi(-3), "holds W^(-3),"),
    ];
    for (of, words) in forms {
        let wrong = changed(&["wavelength_ratio"], |_, w| of(w));
        for wrong in [wrong.clone(), only(&wrong, &["object", "wavelength_ratio"])] {
            for reference in [exact(), unknown(&exact())] {
                named(Kind::RatioForm, &[words], &diagnosed(&reference, &wrong));
            }
        }
    }
}

/// The picture in half precision.
fn halved(picture: &Picture) -> Picture {
    let mut picture = picture.clone();
    let names: Vec<String> = picture
        .layers
        .channels
        .iter()
        .map(|c| c.name.clone())
        .collect();
    for name in names
        .iter()
        .filter(|name| !["object", "primitive"].contains(&name.as_str()))
    {
        map(&mut picture, name, |_, v| half::f16::from_f64(v).to_f64());
    }
    picture
}

#[test]
fn channels_of_right_pictures_in_half_precision_have_no_name() {
    let half = halved(&exact());
    for groups in [
        &["object", "event"][..],
        &["event"],
        &["direction"],
        &["object", "wavelength_ratio"],
        &["object", "object_event", "direction", "wavelength_ratio"],
    ] {
        assert_eq!(diagnosed(&exact(), &only(&half, groups)), [], "{groups:?}");
    }
}
