//! The usual bugs of programs that render such scenes, planted one at a time: each is named with its size, and right pictures get no
//! diagnosis.

use std::sync::Arc;

use nullray::io::image::Samples;
use nullray::scene::model::{Scene, SourceKind};
use nullray::scene::{self, Overrides};
use nullray::validate::compare::{
    Breach, CompareOptions, Encoding, Kind, Picture, Tolerance, compare,
};

use crate::compare::planting::{
    LIGHT, SCENE, changed, diagnosed, diagnosed_with, evidence, exact, map, named, only, parsed,
    rasterized, rearranged, shot, taken, unknown, values, with,
};

#[test]
fn of_right_clamped_rounded_and_noisy_pictures_nothing_is_named() {
    let bright = |picture: &Picture| {
        let mut picture = picture.clone();
        LIGHT
            .iter()
            .for_each(|name| map(&mut picture, name, |_, v| 2.5 * v));
        picture
    };
    let reference = bright(&exact());
    let names: Vec<String> = reference
        .layers
        .channels
        .iter()
        .map(|c| c.name.clone())
        .collect();
    let mut clamped = reference.clone();
    LIGHT
        .iter()
        .for_each(|name| map(&mut clamped, name, |_, v| v.min(1.0)));
    let (mut rounded, mut noisy) = (reference.clone(), reference.clone());
    for (k, name) in names.iter().enumerate() {
        if ["object", "primitive"].contains(&name.as_str()) {
            continue;
        }
        map(&mut rounded, name, |_, v| half::f16::from_f64(v).to_f64());
        map(&mut noisy, name, |i, v| {
            v * (1.0 + 0.01 * (((i * 7919 + k * 101) % 101) as f64 / 50.0 - 1.0))
        });
    }
    for (name, candidate) in [
        ("right", &reference),
        ("clamped", &clamped),
        ("rounded to half precision", &rounded),
        ("noisy", &noisy),
    ] {
        for reference in [reference.clone(), unknown(&reference)] {
            assert_eq!(diagnosed(&reference, candidate), [], "{name}");
        }
    }
}

#[test]
fn a_rasterizer_that_is_right_but_for_its_tessellation_is_not_diagnosed() {
    // Corners are right; between them, edges of 1.2 m at 0.4 c are off by a part of a pixel.
    let moving = parsed(SCENE);
    // A cube so far ahead that single triangles have two pixels, at a grazing angle.
    let overrides = Overrides {
        size: Some([160, 120]),
        ..Overrides::default()
    };
    let far = scene::load("scenes/cube/approaching-0.9.toml".as_ref(), &overrides).unwrap();
    for (scene, method) in [
        (moving, "raster:adaptive=0.05"),
        (far, "raster:adaptive=0.1"),
    ] {
        let candidate = rasterized(&scene, method);
        assert_eq!(diagnosed(&shot(&scene), &candidate), [], "{method}");
    }
}

#[test]
fn missing_retardation_is_named_by_times_and_by_places() {
    let instant = with(&[(
        "[[object]]\n    name = \"floor\"",
        "[effects]\n    retardation = false\n    [[object]]\n    name = \"floor\"",
    )]);
    named(
        Kind::RetardationMissing,
        &["time of the shot"],
        &diagnosed(&exact(), &instant),
    );
    let places = only(&instant, &["object", "object_event"]);
    let found = diagnosed(&exact(), &places);
    named(
        Kind::RetardationMissing,
        &["retardation is missing"],
        &found,
    );
    assert!(evidence(&found, "points are displaced by (pixels, rms)") > 1.0);
    // Without the scene, and of objects at rest alone, the times tell.
    let late = changed(&["event.ct"], |_, t| if t.is_nan() { t } else { 0.0 });
    named(
        Kind::RetardationMissing,
        &["all emission times are 0"],
        &diagnosed(&unknown(&exact()), &late),
    );
}

#[test]
fn a_film_that_is_moved_is_named_with_its_shift() {
    let exact = exact();
    // Every second pixel of a picture of twice the size, from column 2x on.
    let whole = with(&[("[96, 72]", "[192, 144]")]);
    let from_column = |first: usize| {
        let mut cut = exact.clone();
        for channel in &mut cut.layers.channels {
            let values = values(&whole, &channel.name);
            let at = |i: usize| values[2 * (i / 96) * 192 + 2 * (i % 96) + first];
            channel.samples = Samples::F64((0..96 * 72).map(at).collect());
        }
        cut
    };
    // Samples at the upper left quarter of pixels, and half a pixel (of these) to the right of that.
    let (origin, right) = (from_column(0), from_column(1));
    for reference in [&origin, &unknown(&origin)] {
        let found = diagnosed(reference, &right);
        named(Kind::FilmShifted, &["half a pixel", "(-0.50, "], &found);
    }
    for groups in [
        &["object", "event"][..],
        &["direction"],
        &["object", "object_event"],
    ] {
        let found = diagnosed(&origin, &only(&right, groups));
        named(Kind::FilmShifted, &["half a pixel"], &found);
    }
    let whole = rearranged(&exact, |x, y| [x + 1, y - 2]);
    for groups in [&["object", "event"][..], &["radiance"], &["object"]] {
        let found = diagnosed(&exact, &only(&whole, groups));
        named(Kind::FilmShifted, &["(-1, +2) pixels"], &found);
    }
}

#[test]
fn mirrored_pictures_are_named() {
    let exact = exact();
    for (words, turned) in [
        ("left to right", rearranged(&exact, |x, y| [95 - x, y])),
        ("upside down", rearranged(&exact, |x, y| [x, 71 - y])),
        ("180 degrees", rearranged(&exact, |x, y| [95 - x, 71 - y])),
    ] {
        for groups in [&["object", "event"][..], &["radiance"], &["object"]] {
            named(
                Kind::Mirrored,
                &[words],
                &diagnosed(&exact, &only(&turned, groups)),
            );
        }
    }
}

#[test]
fn another_field_of_view_is_named_with_its_size() {
    // tan 33° / tan 30° = 1.1248.
    let wide = with(&[("60 deg", "66 deg")]);
    for groups in [
        &["object", "event"][..],
        &["direction"],
        &["object", "object_event"],
    ] {
        let found = diagnosed(&exact(), &only(&wide, groups));
        named(Kind::FieldOfView, &["1.1248"], &found);
    }
    named(
        Kind::FieldOfView,
        &["66.000 degrees across for 60.000"],
        &diagnosed(&exact(), &wide),
    );
    // The vertical field of view in place of the horizontal: tan(fov/2) = 4/3 tan 30°.
    let degrees = 2.0 * libm::atan(4.0 / 3.0 * libm::tan(30f64.to_radians())).to_degrees();
    let vertical = with(&[("60 deg", &format!("{degrees} deg"))]);
    named(
        Kind::FieldOfView,
        &["taken for the vertical"],
        &diagnosed(&exact(), &vertical),
    );
}

#[test]
fn another_aspect_is_named() {
    // Of a picture of 96 × 96 pixels, 72 rows that are 4/3 of its pixels apart: what a program makes whose film is as high
    // as it is wide.
    let tall = with(&[("[96, 72]", "[96, 96]")]);
    let mut squeezed = exact();
    for channel in &mut squeezed.layers.channels {
        let values = values(&tall, &channel.name);
        let row = |y: usize| 4 * y / 3;
        channel.samples = Samples::F64(
            (0..96 * 72)
                .map(|i| values[row(i / 96) * 96 + i % 96])
                .collect(),
        );
    }
    let found = diagnosed(&exact(), &squeezed);
    named(Kind::Aspect, &["aspect"], &found);
    assert!((evidence(&found, "tan(fov/2) down over the reference's") - 4.0 / 3.0).abs() < 0.02);
}

#[test]
fn aberration_is_named_by_places_alone() {
    for (camera, kind) in [
        ("-0.5", Kind::AberrationReversed),
        ("0.0", Kind::AberrationMissing),
    ] {
        let wrong = with(&[("beta = [0.5, 0, 0]", &format!("beta = [{camera}, 0, 0]"))]);
        named(kind, &["aberration"], &diagnosed(&exact(), &wrong));
        let places = only(&wrong, &["object", "event"]);
        named(kind, &["aberration"], &diagnosed(&exact(), &places));
    }
}

#[test]
fn the_missing_velocity_of_one_object_is_named_by_ratios_and_by_places() {
    let wrong = with(&[("velocity = { beta = [-0.4, 0, 0] }", "")]);
    for groups in [
        &["object", "object_event"][..],
        &["object", "direction", "wavelength_ratio"],
        &["object", "event", "wavelength_ratio"],
    ] {
        let found = diagnosed(&exact(), &only(&wrong, groups));
        named(Kind::VelocityMissing, &["object 2 is missing"], &found);
    }
}

#[test]
fn reversed_and_swapped_velocities_are_named_by_places_alone() {
    let reversed = with(&[("beta = [-0.4, 0, 0]", "beta = [0.4, 0, 0]")]);
    let found = diagnosed(&exact(), &only(&reversed, &["object", "object_event"]));
    named(Kind::VelocityWrong, &["object 2 is reversed"], &found);
    let swapped = with(&[
        ("[-0.4, 0, 0]", "[moving]"),
        ("[0.3, 0, 0]", "[-0.4, 0, 0]"),
        ("[moving]", "[0.3, 0, 0]"),
    ]);
    let found = diagnosed(&exact(), &only(&swapped, &["object", "object_event"]));
    named(Kind::VelocitiesSwapped, &["objects 1 and 2"], &found);
}

#[test]
fn exchanged_axes_are_named_with_their_order() {
    let exact = exact();
    for group in ["event", "object_event", "normal", "direction"] {
        let mut wrong = exact.clone();
        let [y, z] = ["y", "z"].map(|axis| format!("{group}.{axis}"));
        let [vy, vz] = [&y, &z].map(|name| values(&exact, name));
        map(&mut wrong, &y, |i, _| -vz[i]);
        map(&mut wrong, &z, |i, _| vy[i]);
        let found = diagnosed(&exact, &wrong);
        let words = [format!("axes of {group}"), "(x, −z, y)".into()];
        named(
            Kind::AxesExchanged,
            &words.each_ref().map(String::as_str),
            &found,
        );
    }
}

/// The scene with small boxes, so that nearly all pixels show the floor, and with a floor that is nearly grey.
fn mostly_floor() -> Picture {
    with(&[
        ("[1.2, 1.2, 1.2]", "[0.5, 0.5, 0.5]"),
        ("[0.2, 0.5, 0.8]", "[0.5, 0.5, 0.45]"),
    ])
}

#[test]
fn of_orders_that_most_pixels_cannot_tell_apart_the_one_of_all_pixels_is_named() {
    // The floor's normal, (0, 1, 0), is (1, 0, 0) with x and y exchanged, too; and its red is its green.
    let exact = mostly_floor();
    for (group, kind, words) in [
        ("normal", Kind::AxesExchanged, "(x, y, z) holds (y, z, x)"),
        ("radiance", Kind::ColoursExchanged, "hold GBR"),
    ] {
        let axes = match group {
            "normal" => ["x", "y", "z"],
            _ => ["R", "G", "B"],
        };
        let names = axes.map(|axis| format!("{group}.{axis}"));
        let mut wrong = exact.clone();
        for (k, name) in names.iter().enumerate() {
            let next = values(&exact, &names[(k + 1) % 3]);
            map(&mut wrong, name, |i, _| next[i]);
        }
        named(kind, &[words], &diagnosed(&exact, &wrong));
    }
}

#[test]
fn clipped_light_that_is_encoded_with_rounding_is_named_as_encoded() {
    // 1.055 − 0.055 is not 1 in floating point: what was clipped before the encoding is known by being near 1.
    let mut exact = exact();
    LIGHT
        .iter()
        .for_each(|name| map(&mut exact, name, |_, v| 2.5 * v));
    let mut encoded = exact.clone();
    let encode = |v: f64| match v.min(1.0) {
        v if v <= 0.003_130_8 => 12.92 * v,
        v => 1.055 * v.powf(1.0 / 2.4) - 0.055,
    };
    LIGHT
        .iter()
        .for_each(|name| map(&mut encoded, name, |_, v| encode(v)));
    assert!(encode(1.0) < 1.0);
    named(
        Kind::Gamma,
        &["encoded for a display"],
        &diagnosed(&exact, &encoded),
    );
}

#[test]
fn reversed_directions_are_named() {
    let reversed = changed(&["direction.x", "direction.y", "direction.z"], |_, v| -v);
    named(
        Kind::DirectionsReversed,
        &["out of the camera"],
        &diagnosed(&exact(), &reversed),
    );
}

#[test]
fn units_are_named() {
    let lengths = ["event.x", "event.y", "event.z"];
    for (names, factor, words) in [
        (&lengths[..], 1e3, "event is in millimetres"),
        (
            &["object_event.x", "object_event.y", "object_event.z"],
            1e2,
            "object_event is in centimetres",
        ),
        (&["distance"], 1e3, "distance is in millimetres"),
        (
            &["event.ct"],
            1e9 / 299_792_458.0,
            "event.ct is in nanoseconds",
        ),
    ] {
        let wrong = changed(names, |_, v| factor * v);
        named(Kind::Units, &[words], &diagnosed(&exact(), &wrong));
    }
}

#[test]
fn indices_that_are_exchanged_or_count_from_1_are_named() {
    for nothing in [-1.0, 0.0] {
        let one_based = changed(
            &["object"],
            |_, id| if id < 0.0 { nothing } else { id + 1.0 },
        );
        named(
            Kind::IdentitiesOneBased,
            &["objects count from 1"],
            &diagnosed(&exact(), &one_based),
        );
    }
    let triangles = changed(&["primitive"], |_, id| if id < 0.0 { id } else { id + 1.0 });
    named(
        Kind::IdentitiesOneBased,
        &["triangles count from 1"],
        &diagnosed(&exact(), &triangles),
    );
    let swapped = changed(&["object"], |_, id| match id {
        1.0 => 2.0,
        2.0 => 1.0,
        id => id,
    });
    named(
        Kind::IdentitiesSwapped,
        &["2 for 1, 1 for 2"],
        &diagnosed(&exact(), &swapped),
    );
}

#[test]
fn flipped_texture_coordinates_are_named() {
    let flipped = changed(&["uv.v"], |_, v| 1.0 - v);
    named(
        Kind::TextureFlipped,
        &["v is flipped"],
        &diagnosed(&exact(), &flipped),
    );
}

#[test]
fn inverse_ratios_and_missing_gammas_are_named() {
    let inverse = changed(&["wavelength_ratio"], |_, w| 1.0 / w);
    named(
        Kind::RatioInverted,
        &["inverted"],
        &diagnosed(&exact(), &inverse),
    );
    // γ = 1/√(1 − 0.25) = 1.1547: W = (κ·u)/(κ·u_camera) without the camera's γ is larger by it.
    let gamma = 1.0 / 0.75f64.sqrt();
    let wrong = changed(&["wavelength_ratio"], |_, w| gamma * w);
    for reference in [exact(), unknown(&exact())] {
        let found = diagnosed(&reference, &wrong);
        named(
            Kind::RatioFactor,
            &["γ times what they should be, γ = 1.1547 the camera's"],
            &found,
        );
        assert!((evidence(&found, "factor on W") - gamma).abs() < 1e-9);
    }
    let object = values(&exact(), "object");
    let of = |id: f64| [0.0f64, 0.3, 0.4][id.max(0.0) as usize];
    let wrong = changed(&["wavelength_ratio"], |i, w| {
        w * (1.0 - of(object[i]) * of(object[i])).sqrt()
    });
    named(
        Kind::RatioFactor,
        &["lack the objects' γ"],
        &diagnosed(&exact(), &wrong),
    );
}

#[test]
fn shifts_by_half_a_bin_and_by_one_are_named() {
    for (bins, words) in [
        (0.5, "late by half a bin"),
        (-1.0, "early by one bin"),
        (0.3, "late by 0.300 bins"),
    ] {
        let wrong = changed(&["event.ct"], |_, t| t + 0.05 * bins);
        let found = diagnosed(&exact(), &wrong);
        named(Kind::TimeShifted, &[words], &found);
        assert!((evidence(&found, "shift (bins)") - bins).abs() < 1e-6);
    }
}

#[test]
fn a_lookup_that_is_off_by_half_a_bin_is_named_where_the_scene_is_there() {
    let overrides = Overrides {
        size: Some([64, 48]),
        ..Overrides::default()
    };
    let scene = scene::load("scenes/capture.toml".as_ref(), &overrides).unwrap();
    let exact = shot(&scene);
    let options = CompareOptions {
        scene: Some(Arc::new(scene.clone())),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    for (bins, words) in [
        (0.5, "half a bin too late"),
        (-0.5, "half a bin too early"),
        (1.0, "one bin too late"),
    ] {
        let mut shifted = scene.clone();
        for source in &mut shifted.sources {
            if let SourceKind::Cube(cube) = &mut source.kind {
                cube.bins = cube.bins.shifted(-bins * cube.bins.width());
            }
        }
        let found = diagnosed_with(&exact, &shot(&shifted), &options);
        named(Kind::LookupShifted, &[words], &found);
    }
    assert_eq!(diagnosed_with(&exact, &exact, &options), []);
}

#[test]
fn exchanged_colours_gamma_exposure_and_exponents_are_named() {
    let exact = exact();
    let mut wrong = exact.clone();
    let blue = values(&exact, "radiance.B");
    let red = values(&exact, "radiance.R");
    map(&mut wrong, "radiance.R", |i, _| blue[i]);
    map(&mut wrong, "radiance.B", |i, _| red[i]);
    named(Kind::ColoursExchanged, &["BGR"], &diagnosed(&exact, &wrong));

    // Codes of a display, encoded and decoded once more.
    let mut codes = exact.clone();
    codes.encoding = Encoding::Srgb;
    LIGHT
        .iter()
        .for_each(|name| map(&mut codes, name, |_, v| (0.3 * v).min(1.0)));
    type Curve = fn(f64) -> f64;
    let curves: [(Curve, &str); 3] = [
        (nullray::colour::srgb_encode, "applied twice"),
        (nullray::colour::srgb_decode, "not applied"),
        (|v| v.powf(1.0 / 2.2), "applied twice"),
    ];
    for (curve, words) in curves {
        let mut wrong = codes.clone();
        LIGHT
            .iter()
            .for_each(|name| map(&mut wrong, name, |_, v| curve(v)));
        named(Kind::Gamma, &[words], &diagnosed(&codes, &wrong));
    }

    let brighter = changed(&LIGHT, |_, v| 1.8 * v);
    let found = diagnosed(&exact, &brighter);
    named(Kind::Exposure, &["1.8000 times", "+0.85 stops"], &found);

    // An exponent that is off by one, with an exposure beside it.
    let ratio = values(&exact, "wavelength_ratio");
    let wrong = changed(&LIGHT, |i, v| {
        if ratio[i].is_nan() {
            v
        } else {
            1.3 * v * ratio[i]
        }
    });
    let found = diagnosed(&exact, &wrong);
    named(Kind::ExponentWrong, &["W^(+1)", "1.3000 times"], &found);
}

#[test]
fn events_alone_measure_moving_objects_and_name_lost_velocities() {
    let exact = exact();
    let options = CompareOptions {
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    let limit: Tolerance = "geometric.max=0.1".parse().unwrap();
    let breaches = |candidate: &Picture| {
        let found = compare(&exact, candidate, &options).unwrap();
        let breaches = found.breaches(std::slice::from_ref(&limit)).unwrap();
        breaches.iter().map(Breach::to_string).collect::<String>()
    };
    assert_eq!(breaches(&only(&exact, &["object", "object_event"])), "");

    let groups = ["object", "event"];
    let right = only(&exact, &groups);
    assert_eq!(breaches(&right), "");
    assert_eq!(diagnosed(&exact, &right), []);
    // Without times, events do not say which point is shown.
    let places = only(&exact, &["object", "event.x", "event.y", "event.z"]);
    let words = "of objects 1, 2, which the reference shows at";
    assert!(breaches(&places).contains(words), "{}", breaches(&places));
    assert!(breaches(&places).contains("object_event says which point"));

    for (replaced, kind, words) in [
        (
            "beta = [0, 0, 0]",
            Kind::VelocityMissing,
            "object 2 is missing",
        ),
        (
            "beta = [0.4, 0, 0]",
            Kind::VelocityWrong,
            "object 2 is reversed",
        ),
    ] {
        let wrong = only(&with(&[("beta = [-0.4, 0, 0]", replaced)]), &groups);
        assert!(!breaches(&wrong).is_empty(), "{words}");
        named(kind, &[words], &diagnosed(&exact, &wrong));
    }
}

#[test]
fn a_missing_object_is_named_and_exceeds_limits_on_the_others() {
    let exact = exact();
    let start = SCENE.find("    [[object]]\n    name = \"right\"").unwrap();
    let gone = shot(&parsed(&SCENE[..start]));
    for groups in [
        &["object", "event"][..],
        &["object", "object_event"],
        &["object", "event", "wavelength_ratio"],
    ] {
        let candidate = only(&gone, groups);
        let found = compare(&exact, &candidate, &CompareOptions::default()).unwrap();
        named(
            Kind::ObjectMissing,
            &["object 2 is missing", "nowhere"],
            &found.diagnoses,
        );
        for limit in ["geometric.max=1e9", "geometric.mean=1e9"] {
            // Events say nothing of the other moving object either.
            let breaches = found.breaches(&[limit.parse().unwrap()]).unwrap();
            let words = breaches.iter().map(Breach::to_string).collect::<String>();
            assert!(
                words.contains("of object") && words.contains("no pixel has a value"),
                "{words}"
            );
        }
        let kept = ["geometric.count=100", "coverage=0.5"].map(|limit| limit.parse().unwrap());
        assert_eq!(found.breaches(&kept).unwrap(), []);
    }
}

#[test]
fn events_in_another_order_are_not_a_mirrored_picture() {
    let exact = exact();
    let [ct, x, y, z] =
        ["event.ct", "event.x", "event.y", "event.z"].map(|name| values(&exact, name));
    for groups in [&["object", "event"][..], &["event", "radiance"]] {
        let mut wrong = only(&exact, groups);
        let moved = [
            ("event.ct", &x),
            ("event.x", &y),
            ("event.y", &z),
            ("event.z", &ct),
        ];
        for (name, from) in moved {
            map(&mut wrong, name, |i, _| from[i]);
        }
        let found = diagnosed(&exact, &wrong);
        named(
            Kind::AxesExchanged,
            &["(ct, x, y, z) holds (x, y, z, ct)"],
            &found,
        );
    }
}

#[test]
fn wrong_events_are_named_where_the_points_of_objects_are_right() {
    let places = ["event.x", "event.y", "event.z"];
    let turned = changed(&places, |i, v| v + 0.5 * f64::from(i as u32 % 7));
    let moved = changed(&places[..1], |_, v| v + 0.5);
    for (wrong, words) in [
        (turned, "event.x, event.y and event.z are wrong"),
        (moved, "event.x is wrong: at 100 %"),
    ] {
        let found = diagnosed(&exact(), &wrong);
        named(Kind::ChannelWrong, &[words], &found);
    }
}

#[test]
fn limits_are_exceeded_where_the_candidate_has_no_numbers() {
    let exact = exact();
    let lacking = |part: usize| {
        let mut wrong = exact.clone();
        for name in ["event.x", "object_event.x", "wavelength_ratio", "event.ct"] {
            map(
                &mut wrong,
                name,
                |i, v| {
                    if i % 100 < part { f64::NAN } else { v }
                },
            );
        }
        compare(&exact, &wrong, &CompareOptions::default()).unwrap()
    };
    let limits = ["geometric.max=0.1", "time.max=0.1", "w.max=0.1"];
    for limit in limits.map(|limit| [limit.parse().unwrap()]) {
        let words = |part| {
            let breaches = lacking(part).breaches(&limit).unwrap();
            breaches.iter().map(Breach::to_string).collect::<String>()
        };
        assert!(
            words(30).contains("no numbers (NaN, or infinite)"),
            "{}",
            words(30)
        );
        assert_eq!(words(0), "");
    }
}

#[test]
fn an_object_off_its_surface_is_named_where_nothing_explains_it() {
    // Events of the box, a tenth of a metre towards the camera.
    let exact = exact();
    let object = values(&exact, "object");
    let mut wrong = only(&exact, &["object", "event"]);
    map(&mut wrong, "event.z", |i, z| {
        if object[i] == 1.0 { z + 0.1 } else { z }
    });
    map(&mut wrong, "event.y", |i, y| {
        if object[i] == 1.0 { y + 0.1 } else { y }
    });
    map(&mut wrong, "event.x", |i, x| {
        if object[i] == 1.0 { x + 0.1 } else { x }
    });
    let found = diagnosed(&exact, &wrong);
    named(Kind::ObjectElsewhere, &["object 1 is elsewhere"], &found);
}

/// A shipped scene of 160 × 120 pixels.
fn shipped(name: &str) -> Scene {
    let overrides = Overrides {
        size: Some([160, 120]),
        ..Overrides::default()
    };
    scene::load(format!("scenes/{name}.toml").as_ref(), &overrides).unwrap()
}

#[test]
fn of_right_pictures_with_other_samples_nothing_is_named() {
    for name in [
        "several-velocities",
        "lamps",
        "dice",
        "cube/receding-0.9",
        "gallery/street",
    ] {
        let mut scene = shipped(name);
        // Objects and events are compared: pictures need no light.
        (scene.bounces, scene.lights) = (0, Vec::new());
        if let Some(sky) = &mut scene.sky {
            sky.lights = false;
        }
        let mut of = |samples: u32| {
            scene.samples_per_pixel = samples;
            taken(&scene, false)
        };
        let [one, many] = [1, 64].map(&mut of);
        let centres = shot(&scene);
        let pairs = [
            ("1 for 64", &many, &one),
            ("64 for 1", &one, &many),
            ("64 for centres", &centres, &many),
        ];
        for (samples, reference, candidate) in pairs {
            let candidate = only(candidate, &["object", "event"]);
            for reference in [reference.clone(), unknown(reference)] {
                let found = diagnosed(&reference, &candidate);
                assert_eq!(found, [], "{name}, {samples}");
            }
        }
    }
}

#[test]
fn a_wall_behind_a_box_that_is_elsewhere_is_not_named() {
    let text = |place: &str| {
        format!(
            r#"
            camera = {{ eye = [0, 0, 5], forward = [0, 0, -1], hfov = "60 deg", size = [96, 72] }}
            [[object]]
            name = "wall"
            shape = {{ box = {{ size = [20, 20, 0.1] }} }}
            [[object]]
            name = "near"
            shape = {{ box = {{ size = [2, 2, 0.1] }} }}
            origin = {{ position = [{place}, 1], time = "0 m" }}
        "#
        )
    };
    let [right, moved, nearer] =
        ["0, 0", "1.2, 0.6", "0.2, 0.1"].map(|place| shot(&parsed(&text(place))));
    let candidate = |picture: &Picture| only(picture, &["object", "event"]);
    for reference in [right.clone(), unknown(&right)] {
        let found = diagnosed(&reference, &candidate(&moved));
        named(Kind::ObjectElsewhere, &["object 1 is elsewhere"], &found);
        let found = diagnosed(&reference, &candidate(&nearer));
        assert!(
            found.iter().all(|d| !d.what.contains("object 0")),
            "{found:?}"
        );
        assert_eq!(diagnosed(&reference, &candidate(&right)), []);
    }
}

#[test]
fn wrong_times_of_several_moving_objects_are_named_by_events_alone() {
    let scene = shipped("several-velocities");
    let exact = shot(&scene);
    let groups = ["object", "event"];
    let mut instant = scene.clone();
    instant.effects.retardation = false;
    let found = diagnosed(&exact, &only(&shot(&instant), &groups));
    named(
        Kind::RetardationMissing,
        &["retardation is missing"],
        &found,
    );
    let mut late = only(&exact, &groups);
    map(&mut late, "event.ct", |_, t| t + 0.025);
    let found = diagnosed(&exact, &late);
    named(Kind::TimeShifted, &["too late by half a bin"], &found);
}

#[test]
fn exchanged_indices_of_an_object_that_fills_the_picture_do_not_count_from_1() {
    // Of the boxes, a few pixels alone.
    let mut exact = exact();
    map(&mut exact, "object", |i, id| match id {
        1.0 if i % 16 == 0 => 1.0,
        id => id.min(0.0),
    });
    let mut swapped = exact.clone();
    // Nearly all pixels show object 0, which is then 1 as it would be if indices counted from 1.
    map(&mut swapped, "object", |_, id| match id {
        0.0 => 1.0,
        1.0 => 0.0,
        id => id,
    });
    let ids = values(&exact, "object");
    let count = |is: fn(f64) -> bool| ids.iter().filter(|id| is(**id)).count() as f64;
    assert!(count(|id| id == 0.0) >= 0.95 * count(|id| id >= 0.0));
    let words = ["1 for 0, 0 for 1"];
    named(
        Kind::IdentitiesSwapped,
        &words,
        &diagnosed(&exact, &swapped),
    );
}

#[test]
fn light_in_whole_numbers_is_named_as_codes() {
    let exact = exact();
    for encode in [|v: f64| v, nullray::colour::srgb_encode] {
        let mut codes = exact.clone();
        for name in LIGHT {
            map(&mut codes, name, |_, v| {
                (255.0 * encode(v.min(1.0))).round()
            });
        }
        let found = diagnosed(&exact, &codes);
        named(Kind::Gamma, &["whole numbers", "8-bit codes"], &found);
    }
}
