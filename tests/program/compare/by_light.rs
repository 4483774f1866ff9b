//! Bugs planted in pictures that are compared by light only: the candidate has three channels, or both pictures have.

use std::sync::Arc;

use nullray::io::image::Samples;
use nullray::scene::{self, Overrides};
use nullray::validate::compare::{CompareOptions, Diagnosis, Kind, Picture};

use crate::compare::planting::{
    LIGHT, SCENE, diagnosed, diagnosed_with, evidence, exact, map, named, only, parsed, rasterized,
    rearranged, shot, unknown, values, with,
};

fn light(picture: &Picture) -> Picture {
    only(picture, &["radiance"])
}

/// A picture with nothing but light, and no word of its scene.
fn bare(picture: &Picture) -> Picture {
    unknown(&light(picture))
}

/// What is named of the candidate's light alone, beside a reference with all channels.
fn by_light(reference: &Picture, candidate: &Picture) -> Vec<Diagnosis> {
    diagnosed(reference, &light(candidate))
}

/// The same where the scene is known.
fn with_scene(candidate: &Picture) -> Vec<Diagnosis> {
    let options = CompareOptions {
        scene: Some(Arc::new(parsed(SCENE))),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    diagnosed_with(&exact(), &light(candidate), &options)
}

/// Pixels of `size` that are means of squares of n × n pixels of a larger picture, whose first is at `first`.
fn means(whole: &Picture, like: &Picture, n: usize, first: [usize; 2]) -> Picture {
    let [w, h] = [like.layers.width, like.layers.height].map(|n| n as usize);
    let [wide, high] = [whole.layers.width, whole.layers.height].map(|n| n as usize);
    let mut picture = light(like);
    for channel in &mut picture.layers.channels {
        let values = values(whole, &channel.name);
        let mean = |i: usize| {
            let pixels = (0..n * n).map(|k| {
                let x = (2 * (i % w) + first[0] + k % n).min(wide - 1);
                let y = (2 * (i / w) + first[1] + k / n).min(high - 1);
                values[y * wide + x]
            });
            pixels.sum::<f64>() / (n * n) as f64
        };
        channel.samples = Samples::F64((0..w * h).map(mean).collect());
    }
    picture
}

#[test]
fn of_right_clamped_rounded_and_noisy_light_nothing_is_named() {
    let bright = |v: f64| 2.5 * v;
    let mut reference = exact();
    LIGHT
        .iter()
        .for_each(|name| map(&mut reference, name, |_, v| bright(v)));
    let altered = |of: &dyn Fn(usize, f64) -> f64| {
        let mut candidate = reference.clone();
        for (k, name) in LIGHT.iter().enumerate() {
            map(&mut candidate, name, |i, v| of(7 * i + k, v));
        }
        candidate
    };
    let noise = |i: usize| ((i * 7919) % 101) as f64 / 50.0 - 1.0;
    for (name, candidate) in [
        ("right", altered(&|_, v| v)),
        ("clamped", altered(&|_, v| v.min(1.0))),
        (
            "rounded to half precision",
            altered(&|_, v| half::f16::from_f64(v).to_f64()),
        ),
        ("noisy by 1 %", altered(&|i, v| v * (1.0 + 0.01 * noise(i)))),
        ("noisy by 20 %", altered(&|i, v| v * (1.0 + 0.2 * noise(i)))),
    ] {
        for reference in [reference.clone(), unknown(&reference), bare(&reference)] {
            assert_eq!(by_light(&reference, &candidate), [], "{name}");
        }
    }
    // What a rasterizer draws between vertices is off by parts of a pixel, everywhere otherwise.
    let drawn = rasterized(&parsed(SCENE), "raster:adaptive=0.3");
    assert_eq!(by_light(&exact(), &drawn), []);
}

#[test]
fn half_a_pixel_is_named_by_light_alone() {
    let exact = exact();
    let whole = with(&[("[96, 72]", "[192, 144]")]);
    // Single samples, and means of four, half a pixel to the right, and down, too.
    for (n, tolerance) in [(1, 0.2), (2, 0.1)] {
        let reference = means(&whole, &exact, n, [0, 0]);
        for (first, [x, y]) in [([1, 0], [-0.5, 0.0]), ([1, 1], [-0.5, -0.5])] {
            let candidate = means(&whole, &exact, n, first);
            let found = diagnosed(&reference, &candidate);
            named(Kind::FilmShifted, &["half a pixel"], &found);
            let off = [
                evidence(&found, "to the right (pixels)") - x,
                evidence(&found, "down (pixels)") - y,
            ];
            assert!(off.iter().all(|d| d.abs() < tolerance), "{n}: {found:?}");
        }
    }
}

#[test]
fn whole_pixels_and_mirrors_are_named_by_light_alone() {
    let exact = exact();
    let moved = rearranged(&exact, |x, y| [x + 1, y - 2]);
    named(
        Kind::FilmShifted,
        &["(-1, +2) pixels"],
        &by_light(&exact, &moved),
    );
    let mirrored = rearranged(&exact, |x, y| [95 - x, y]);
    named(
        Kind::Mirrored,
        &["left to right"],
        &by_light(&exact, &mirrored),
    );
    let flipped = rearranged(&exact, |x, y| [x, 71 - y]);
    named(
        Kind::Mirrored,
        &["upside down"],
        &by_light(&exact, &flipped),
    );
}

#[test]
fn mirrors_beside_another_exposure_are_named_with_both() {
    let exact = exact();
    let beside = "light is 0.5000 times what it should be beside that";
    for (turn, word) in [
        (([95, -1], [0, 1]), "left to right"),
        (([0, 1], [71, -1]), "upside down"),
    ] {
        let at = |[from, step]: [i64; 2], x: i64| from + step * x;
        let mut turned = rearranged(&exact, |x, y| [at(turn.0, x), at(turn.1, y)]);
        for name in LIGHT {
            map(&mut turned, name, |_, v| 0.5 * v);
        }
        for found in [
            diagnosed(&exact, &turned),
            by_light(&exact, &turned),
            diagnosed(&bare(&exact), &bare(&turned)),
        ] {
            named(Kind::Mirrored, &[word, beside], &found);
        }
        // Light that explains nothing leaves the places.
        for name in LIGHT {
            map(&mut turned, name, |i, _| (i % 7) as f64);
        }
        named(Kind::Mirrored, &[word], &diagnosed(&exact, &turned));
    }
}

#[test]
fn exchanged_colours_are_named_where_all_but_a_little_is_grey() {
    // One pixel in fifty has a colour.
    let mut reference = exact();
    let colour = |i: usize, k: usize| {
        0.1 + 0.01 * (i % 60) as f64
            + if i.is_multiple_of(50) {
                0.3 * k as f64
            } else {
                0.0
            }
    };
    for (k, name) in LIGHT.iter().enumerate() {
        map(&mut reference, name, |i, _| colour(i, k));
    }
    let mut wrong = light(&reference);
    for (k, name) in LIGHT.iter().enumerate() {
        map(&mut wrong, name, |i, _| colour(i, [1, 0, 2][k]));
    }
    named(
        Kind::ColoursExchanged,
        &["GRB"],
        &by_light(&reference, &wrong),
    );
    // Where the same pixels are simply wrong, nothing explains them.
    for (k, name) in LIGHT.iter().enumerate() {
        map(&mut wrong, name, |i, _| {
            colour(i, [1, 0, 2][k]) + 0.1 * f64::from(i.is_multiple_of(50))
        });
    }
    assert_eq!(by_light(&reference, &wrong), []);
}

#[test]
fn another_field_of_view_is_named_by_light_alone() {
    // tan(fov/2) times so much; 4/3 is the horizontal angle taken for the vertical one.
    for (factor, tolerance) in [
        (0.75, 0.005),
        (0.97, 0.005),
        (1.1248, 0.01),
        (4.0 / 3.0, 0.01),
    ] {
        let degrees = 2.0 * libm::atan(factor * libm::tan(30f64.to_radians())).to_degrees();
        let wrong = with(&[("60 deg", &format!("{degrees} deg"))]);
        for reference in [exact(), bare(&exact())] {
            let found = by_light(&reference, &wrong);
            named(Kind::FieldOfView, &["tan(fov/2)"], &found);
            let k = evidence(&found, "tan(fov/2) across over the reference's");
            assert!((k - factor).abs() < tolerance, "{factor}: {found:?}");
        }
    }
}

#[test]
fn another_aspect_is_named_by_light_alone() {
    // 72 rows that are 4/3 pixels apart.
    let tall = with(&[("[96, 72]", "[96, 96]")]);
    let mut squeezed = light(&exact());
    for channel in &mut squeezed.layers.channels {
        let values = values(&tall, &channel.name);
        let at = |i: usize| values[4 * (i / 96) / 3 * 96 + i % 96];
        channel.samples = Samples::F64((0..96 * 72).map(at).collect());
    }
    let found = by_light(&exact(), &squeezed);
    named(Kind::Aspect, &["aspect"], &found);
    let [x, y] = ["across", "down"]
        .map(|axis| evidence(&found, &format!("tan(fov/2) {axis} over the reference's")));
    assert!(
        (x - 1.0).abs() < 0.01 && (y - 4.0 / 3.0).abs() < 0.05,
        "{found:?}"
    );
}

#[test]
fn wrong_aberration_is_named_by_light_alone() {
    let effects = "    [effects]\n    searchlight = false\n    doppler = false\n";
    let floor = "    [[object]]\n    name = \"floor\"";
    let without = |aberration: &str| with(&[(floor, &format!("{effects}{aberration}{floor}"))]);
    // Where light keeps its colour and strength, the reference's own text says where it is seen.
    let found = by_light(&without(""), &without("    aberration = false\n"));
    named(Kind::AberrationMissing, &["aberration is missing"], &found);
    // Elsewhere the scene does.
    let unaberrated = with(&[(
        floor,
        &format!("    [effects]\n    aberration = false\n{floor}"),
    )]);
    let found = with_scene(&unaberrated);
    named(Kind::AberrationMissing, &["aberration is missing"], &found);
    // Of a program that does not state that it is another shot.
    let mut reversed = with(&[("beta = [0.5, 0, 0]", "beta = [-0.5, 0, 0]")]);
    reversed.layers.metadata.clear();
    named(
        Kind::AberrationReversed,
        &["aberration is reversed"],
        &with_scene(&reversed),
    );
}

#[test]
fn missing_aberration_along_the_axis_is_not_another_field_of_view() {
    // Towards what is seen, tan(θ′/2) = √((1 − β)/(1 + β)) tan(θ/2): nearly another focal length.
    let overrides = Overrides {
        size: Some([96, 72]),
        ..Overrides::default()
    };
    let mut scene = scene::load("scenes/capture.toml".as_ref(), &overrides).unwrap();
    let exact = shot(&scene);
    scene.effects.aberration = false;
    let found = by_light(&exact, &shot(&scene));
    named(Kind::AberrationMissing, &["aberration is missing"], &found);
}

#[test]
fn missing_retardation_and_velocities_are_named_by_light_where_the_scene_is_there() {
    let instant = with(&[(
        "[[object]]\n    name = \"floor\"",
        "[effects]\n    retardation = false\n    [[object]]\n    name = \"floor\"",
    )]);
    named(
        Kind::RetardationMissing,
        &["retardation is missing"],
        &with_scene(&instant),
    );
    let resting = with(&[("velocity = { beta = [-0.4, 0, 0] }", "")]);
    named(
        Kind::VelocityMissing,
        &["velocity of object 2 is missing"],
        &with_scene(&resting),
    );
    let reversed = with(&[("beta = [-0.4, 0, 0]", "beta = [0.4, 0, 0]")]);
    named(
        Kind::VelocityWrong,
        &["velocity of object 2 is reversed"],
        &with_scene(&reversed),
    );
    assert_eq!(with_scene(&exact()), []);
}

#[test]
fn mistakes_in_pictures_of_many_tiles_are_named_by_light_as_in_small_ones() {
    // 300 tiles: enough for hypotheses to be rendered on every seventh of them first.
    let larger = ("size = [96, 72]", "size = [320, 240]");
    let options = CompareOptions {
        scene: Some(Arc::new(parsed(&SCENE.replace(larger.0, larger.1)))),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    let reference = with(&[larger]);
    for (right, wrong, kind) in [
        (
            "beta = [0.3, 0, 0]",
            "beta = [0, 0, 0]",
            Kind::VelocityMissing,
        ),
        (
            "beta = [-0.4, 0, 0]",
            "beta = [0.4, 0, 0]",
            Kind::VelocityWrong,
        ),
        ("[-1, 0.6, 0]", "[-1000, 0.6, 0]", Kind::ObjectMissing),
    ] {
        let candidate = light(&with(&[larger, (right, wrong)]));
        let found = diagnosed_with(&reference, &candidate, &options);
        named(kind, &["object "], &found);
    }
    assert_eq!(diagnosed_with(&reference, &light(&reference), &options), []);
}

#[test]
fn colours_gamma_exposure_and_exponents_are_named_by_light_alone() {
    let exact = exact();
    let of = |of: &dyn Fn(usize, usize) -> f64| {
        let mut wrong = light(&exact);
        for (k, name) in LIGHT.iter().enumerate() {
            map(&mut wrong, name, |i, _| of(k, i));
        }
        wrong
    };
    let colours = LIGHT.map(|name| values(&exact, name));
    let found = by_light(&exact, &of(&|k, i| colours[2 - k][i]));
    named(Kind::ColoursExchanged, &["BGR"], &found);
    let found = by_light(&exact, &of(&|k, i| 1.8 * colours[k][i]));
    named(Kind::Exposure, &["1.8000 times"], &found);
    let encode = nullray::colour::srgb_encode;
    let found = by_light(&exact, &of(&|k, i| encode(colours[k][i])));
    named(Kind::Gamma, &["encoded for a display"], &found);
    // The reference's W tells.
    let ratio = values(&exact, "wavelength_ratio");
    let w = |i: usize| if ratio[i].is_nan() { 1.0 } else { ratio[i] };
    let found = by_light(&exact, &of(&|k, i| colours[k][i] * w(i)));
    named(Kind::ExponentWrong, &["W^(+1)"], &found);
    // Two at once: in display range, clipped and encoded, as viewers do; and another exposure beside exchanged channels.
    let beside = "light is 2.0000 times what it should be beside that";
    let found = by_light(&exact, &of(&|k, i| 2.0 * colours[2 - k][i]));
    named(Kind::ColoursExchanged, &["BGR", beside], &found);
    let brightest = colours.iter().flatten().fold(0.0, |a: f64, v| a.max(*v));
    let shown = of(&|k, i| encode((colours[k][i] / (0.9 * brightest)).min(1.0)));
    let factor = format!("{:.4} times", 1.0 / (0.9 * brightest));
    named(
        Kind::Gamma,
        &["encoded for a display", &factor],
        &by_light(&exact, &shown),
    );
}

#[test]
fn a_black_picture_is_said_to_be_one_and_nothing_else() {
    let exact = exact();
    let scaled = |factor: f64| {
        let mut dark = light(&exact);
        for name in LIGHT {
            map(&mut dark, name, |_, v| factor * v);
        }
        dark
    };
    for found in [by_light(&exact, &scaled(0.0)), with_scene(&scaled(0.0))] {
        named(Kind::Exposure, &["the picture is black"], &found);
    }
    let found = by_light(&exact, &scaled(1e-6));
    named(Kind::Exposure, &["1.000e-6 times", "-19.93 stops"], &found);
}

#[test]
fn a_single_moving_object_is_not_a_shifted_film() {
    // Of light without its scene, nothing says which object it is; nothing is said of the film either.
    let wrong = with(&[("velocity = { beta = [-0.4, 0, 0] }", "")]);
    let found = diagnosed(&bare(&exact()), &bare(&wrong));
    assert_eq!(found, []);
    let still = shot(&parsed(SCENE));
    assert_eq!(diagnosed(&bare(&exact()), &bare(&still)), []);
}

#[test]
fn half_a_pixel_of_means_is_not_a_mistake_of_the_light() {
    // Means of 4 × 4: at edges before the dark sky a few pixels are nearly black.
    for floor in ["[0.2, 0.5, 0.8]", "[0.002, 0.005, 0.008]"] {
        let text = SCENE.replace("[0.2, 0.5, 0.8]", floor);
        let exact = shot(&parsed(&text));
        let whole = shot(&parsed(&text.replace("[96, 72]", "[384, 288]")));
        let [reference, candidate] = [[0, 0], [2, 2]].map(|first| boxes(&whole, &exact, 4, first));
        for reference in [reference.clone(), unknown(&reference)] {
            let found = diagnosed(&reference, &candidate);
            named(Kind::FilmShifted, &["half a pixel"], &found);
        }
    }
}

/// Means of squares of n × n pixels of a picture that is n times as large, the first at `first`.
fn boxes(whole: &Picture, like: &Picture, n: usize, first: [usize; 2]) -> Picture {
    let [w, h] = [like.layers.width, like.layers.height].map(|n| n as usize);
    let mut picture = light(like);
    for channel in &mut picture.layers.channels {
        let values = values(whole, &channel.name);
        let mean = |i: usize| {
            let pixels = (0..n * n).map(|k| {
                let x = (n * (i % w) + first[0] + k % n).min(n * w - 1);
                let y = (n * (i / w) + first[1] + k / n).min(n * h - 1);
                values[y * n * w + x]
            });
            pixels.sum::<f64>() / (n * n) as f64
        };
        channel.samples = Samples::F64((0..w * h).map(mean).collect());
    }
    picture
}
