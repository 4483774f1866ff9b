//! Bugs of light beyond exposure and gamma, of lookups at other times, of normals and distances in other terms, and of sizes.

use std::sync::Arc;

use nullray::scene::model::{EmissionProfile, LightKind, Scene, SourceKind};
use nullray::scene::{self, Overrides};
use nullray::validate::compare::{CompareOptions, Diagnosis, Kind, Picture};

use crate::compare::planting::{
    LIGHT, SCENE, changed, diagnosed, diagnosed_with, evidence, exact, map, named, only, parsed,
    shot, unknown, values, with,
};

fn light(picture: &Picture) -> Picture {
    only(picture, &["radiance"])
}

fn bare(picture: &Picture) -> Picture {
    unknown(&light(picture))
}

/// What is named with all channels, with the candidate's light alone, and of two pictures of which nothing else is known.
fn in_three_ways(reference: &Picture, candidate: &Picture) -> [Vec<Diagnosis>; 3] {
    [
        diagnosed(reference, candidate),
        diagnosed(reference, &light(candidate)),
        diagnosed(&bare(reference), &bare(candidate)),
    ]
}

fn vectors(picture: &Picture, name: &str) -> Vec<[f64; 3]> {
    let [x, y, z] = ["x", "y", "z"].map(|axis| values(picture, &format!("{name}.{axis}")));
    let pairs = x.into_iter().zip(y).zip(z);
    pairs.map(|((x, y), z)| [x, y, z]).collect()
}

fn holding(picture: &Picture, name: &str, of: impl Fn(usize) -> [f64; 3]) -> Picture {
    let mut picture = picture.clone();
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        map(&mut picture, &format!("{name}.{axis}"), |i, _| of(i)[k]);
    }
    picture
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    v.map(|x| x / dot(v, v).sqrt())
}

#[test]
fn a_number_added_to_all_light_is_named_with_its_size() {
    let exact = exact();
    for added in [0.05, 0.01, -0.004] {
        let wrong = changed(&LIGHT, |_, v| v + added);
        for found in in_three_ways(&exact, &wrong) {
            named(Kind::Offset, &["added to it"], &found);
            assert!(
                (evidence(&found, "added") - added).abs() < 1e-9,
                "{found:?}"
            );
        }
    }
    // A hundredth of noise beside it.
    let noise = |i: usize| 1.0 + 0.01 * (((i * 7919) % 101) as f64 / 50.0 - 1.0);
    let wrong = changed(&LIGHT, |i, v| v * noise(i) + 0.05);
    for found in in_three_ways(&exact, &wrong) {
        named(Kind::Offset, &["added to it"], &found);
        assert!(
            (evidence(&found, "added") - 0.05).abs() < 0.002,
            "{found:?}"
        );
    }
}

#[test]
fn tone_mapping_is_named_with_its_curve_and_exposure() {
    let exact = exact();
    let colours = LIGHT.map(|name| values(&exact, name));
    let of = |of: &dyn Fn([f64; 3]) -> [f64; 3]| {
        let mut wrong = exact.clone();
        for (k, name) in LIGHT.iter().enumerate() {
            map(&mut wrong, name, |i, _| {
                of([0, 1, 2].map(|k| colours[k][i]))[k]
            });
        }
        wrong
    };
    let reinhard = |v: f64| 3.0 * v / (1.0 + 3.0 * v);
    let by_luminance = |c: [f64; 3]| {
        let y = 2.0 * dot(c, [0.2126, 0.7152, 0.0722]);
        c.map(|v| 2.0 * v / (1.0 + y))
    };
    let film = |v: f64| {
        let x = 1.5 * v;
        x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
    };
    let encode = nullray::colour::srgb_encode;
    type Shown<'a> = &'a dyn Fn([f64; 3]) -> [f64; 3];
    let cases: [(Shown, &str, f64); 6] = [
        (&|c| c.map(reinhard), "Reinhard's, v/(1 + v), of", 3.0),
        (&|c| by_luminance(c), "by luminance", 2.0),
        (&|c| c.map(|v| 1.0 - (-2.5 * v).exp()), "1 − exp(−v)", 2.5),
        (&|c| c.map(film), "Narkowicz", 1.5),
        (
            &|c| c.map(|v| encode(reinhard(v))),
            "encoded for a display",
            3.0,
        ),
        (
            &|c| c.map(|v| encode(film(v))),
            "encoded for a display",
            1.5,
        ),
    ];
    for (shown, words, exposure) in cases {
        for found in in_three_ways(&exact, &of(shown)) {
            named(Kind::ToneMapped, &[words], &found);
            let off = evidence(&found, "exposure") / exposure - 1.0;
            assert!(off.abs() < 0.01, "{found:?}");
        }
    }
    // Any other curve.
    let other = |v: f64| 0.8 * v.powf(0.6) / (0.3 + v.powf(0.6));
    for found in in_three_ways(&exact, &of(&|c| c.map(other))) {
        named(Kind::ToneMapped, &["one curve, of each channel"], &found);
    }
}

/// A shipped scene, small.
fn shipped(name: &str, size: [u32; 2]) -> Scene {
    let overrides = Overrides {
        size: Some(size),
        ..Overrides::default()
    };
    scene::load(format!("scenes/{name}.toml").as_ref(), &overrides).unwrap()
}

/// The scene with all its light `delay` earlier, which is then looked up late.
fn late(scene: &Scene, delay: f64) -> Scene {
    let mut late = scene.clone();
    for source in &mut late.sources {
        match &mut source.kind {
            SourceKind::Pulse(pulse) => pulse.origin.ct -= delay,
            SourceKind::Cube(cube) => cube.bins = cube.bins.shifted(-delay),
        }
    }
    for light in &mut late.lights {
        if let LightKind::Lamp(lamp) = &mut light.kind
            && let EmissionProfile::Gaussian { centre, .. } = &mut lamp.emission
        {
            *centre -= delay;
        }
    }
    late
}

#[test]
fn pulses_that_are_looked_up_late_by_any_time_are_named() {
    let scene = shipped("ladder/4-time-resolved", [96, 72]);
    let exact = shot(&scene);
    for delay in [0.05, 0.3, -0.12, 0.8] {
        let wrong = shot(&late(&scene, delay));
        let words = match delay > 0.0 {
            true => "m too late",
            false => "m too early",
        };
        // The reference's own text says of which scene it is.
        for candidate in [&wrong, &light(&wrong)] {
            let found = diagnosed(&exact, candidate);
            named(
                Kind::LookupShifted,
                &["pulses are looked up", words],
                &found,
            );
            assert!(
                (evidence(&found, "shift (m)") - delay).abs() < 0.002,
                "{found:?}"
            );
        }
    }
    // Of two pictures alone, nothing says so; nothing else is said for certain either.
    for delay in [0.05, 0.2, 0.3, 0.5, 0.8, -0.12, -0.4] {
        let wrong = shot(&late(&scene, delay));
        let found = diagnosed(&bare(&exact), &bare(&wrong));
        let is_doubted = |found: &Diagnosis| found.what.contains("where a pulse spreads");
        assert!(found.iter().all(is_doubted), "{delay}: {found:?}");
    }
}

#[test]
fn cubes_that_are_looked_up_late_by_a_part_of_a_bin_are_named() {
    let scene = shipped("capture", [64, 48]);
    let exact = shot(&scene);
    let options = CompareOptions {
        scene: Some(Arc::new(scene.clone())),
        pixels_per_degree: None,
        ..CompareOptions::default()
    };
    for bins in [0.3, -1.7] {
        let wrong = shot(&late(&scene, 0.1 * bins));
        let found = diagnosed_with(&exact, &light(&wrong), &options);
        named(Kind::LookupShifted, &["bins too"], &found);
        assert!(
            (evidence(&found, "shift (bins)") - bins).abs() < 0.02,
            "{found:?}"
        );
    }
}

/// A ball that moves at 0.6 c along x, and one that is turned, over a floor, at rest.
const BALLS: &str = r#"
    camera = { eye = [0, 0.6, 4], look_at = [0.3, 0.3, 0], hfov = "60 deg", size = [96, 72], velocity = { beta = [0.3, 0, -0.4] } }
    [[object]]
    name = "floor"
    shape = { plane = { size = [12, 12] } }
    [[object]]
    name = "ball"
    shape = { sphere = { radius = 0.8, subdivisions = 3 } }
    velocity = { beta = [0.6, 0, 0] }
    origin = { position = [-3.2, 0.8, 0], time = "-8 m" }
"#;

#[test]
fn normals_of_another_frame_are_named() {
    let exact = shot(&parsed(BALLS));
    let (n, d, object) = (
        vectors(&exact, "normal"),
        vectors(&exact, "direction"),
        values(&exact, "object"),
    );
    // ∇F of F(x⊥, γ(x∥ − βt)): at one time, and with t = −|x|, whose gradient is −d.
    let (beta, gamma) = (0.6, 1.25);
    let world = |i: usize, slid: f64| match object[i] == 1.0 {
        true => {
            let part = gamma * n[i][0];
            unit([
                part * (1.0 + beta * slid * d[i][0]),
                n[i][1] + part * beta * slid * d[i][1],
                n[i][2] + part * beta * slid * d[i][2],
            ])
        }
        false => n[i],
    };
    for (slid, words) in [(0.0, "contracted"), (1.0, "as it is seen")] {
        let wrong = holding(&exact, "normal", |i| world(i, slid));
        let found = diagnosed(&exact, &wrong);
        named(
            Kind::FrameWrong,
            &[
                "normal is in the world's frame",
                words,
                "objects' own frames",
            ],
            &found,
        );
    }
    // The camera's axes: it looks along (0.3, −0.3, −4).
    let forward = unit([0.3, -0.3, -4.0]);
    let right = unit([-forward[2], 0.0, forward[0]]);
    let up = [
        right[1] * forward[2] - right[2] * forward[1],
        right[2] * forward[0] - right[0] * forward[2],
        right[0] * forward[1] - right[1] * forward[0],
    ];
    let wrong = holding(&exact, "normal", |i| {
        [dot(n[i], right), dot(n[i], up), -dot(n[i], forward)]
    });
    let found = diagnosed(&exact, &wrong);
    named(
        Kind::FrameWrong,
        &["normal is in coordinates along the camera's own axes"],
        &found,
    );
    let wrong = holding(&exact, "normal", |i| n[i].map(|v| -v));
    let found = diagnosed(&exact, &wrong);
    named(Kind::AxesExchanged, &["normals are reversed"], &found);
}

#[test]
fn depths_in_place_of_distances_are_named() {
    // A camera at rest, so that depths of the two frames are the same; and one that moves.
    let still = with(&[("beta = [0.5, 0, 0]", "beta = [0, 0, 0]")]);
    let moving = exact();
    let forward = unit([1.5, -0.3, -4.0]);
    let gamma = 1.0 / 0.75f64.sqrt();
    for (exact, beta, gamma) in [(&still, 0.0, 1.0), (&moving, 0.5, gamma)] {
        let d = vectors(exact, "direction");
        let of = |of: &dyn Fn(usize, f64) -> f64| {
            let mut wrong = exact.clone();
            map(&mut wrong, "distance", of);
            wrong
        };
        let depth = |i: usize, s: f64| s * dot(d[i], forward);
        // The way (−s, s d) in the camera's frame.
        let own = |i: usize, s: f64| {
            let way = [gamma * s * (d[i][0] + beta), s * d[i][1], s * d[i][2]];
            dot(way, forward)
        };
        let found = diagnosed(exact, &of(&own));
        named(
            Kind::DepthForDistance,
            &["distance is the depth", "own frame"],
            &found,
        );
        let found = diagnosed(exact, &of(&|i, s| -own(i, s)));
        named(Kind::DepthForDistance, &["minus the depth"], &found);
        if beta != 0.0 {
            let found = diagnosed(exact, &of(&depth));
            named(
                Kind::DepthForDistance,
                &["the depth", "world's coordinates"],
                &found,
            );
        }
        // Between planes at 0.1 and 100: 1.001 − 0.1001/z.
        let (near, far) = (0.1, 100.0);
        let buffer = |z: f64| (far - far * near / z) / (far - near);
        let found = diagnosed(exact, &of(&|i, s| buffer(own(i, s))));
        named(Kind::DepthForDistance, &["depth buffer"], &found);
        assert!(
            (evidence(&found, "near plane") - near).abs() < 1e-6,
            "{found:?}"
        );
        assert!(
            (evidence(&found, "far plane") - far).abs() < 1e-2,
            "{found:?}"
        );
        // The reverse: a reference that holds depths, and a candidate that is right.
        let found = diagnosed(&of(&depth), exact);
        named(
            Kind::DepthForDistance,
            &["one of the two is a depth"],
            &found,
        );
        // Light that is delayed by the depth.
        let mut wrong = exact.clone();
        map(&mut wrong, "event.ct", |i, t| -own(i, -t));
        let found = diagnosed(exact, &wrong);
        named(
            Kind::DepthForDistance,
            &["emission times", "the depth"],
            &found,
        );
    }
    // Of a scene that is not known: 60 degrees across.
    let d = vectors(&still, "direction");
    let mut wrong = still.clone();
    map(&mut wrong, "distance", |i, s| s * dot(d[i], forward));
    let found = diagnosed(&unknown(&still), &wrong);
    named(
        Kind::DepthForDistance,
        &["the depth along the camera's axis", "60.00 degrees"],
        &found,
    );
    let found = diagnosed(&wrong, &unknown(&still));
    named(
        Kind::DepthForDistance,
        &["one of the two is a depth"],
        &found,
    );
}

/// The scene with its first box of another size.
fn boxes(factor: f64) -> Picture {
    let side = 1.2 * factor;
    let text = SCENE.replacen(
        "size = [1.2, 1.2, 1.2]",
        &format!("size = [{side}, {side}, {side}]"),
        1,
    );
    shot(&parsed(&text))
}

#[test]
fn a_body_of_another_size_is_named_with_its_factor() {
    let balls = |factor: f64| {
        let radius = format!("radius = {}", 0.8 * factor);
        shot(&parsed(&BALLS.replace("radius = 0.8", &radius)))
    };
    type Make<'a> = &'a dyn Fn(f64) -> Picture;
    for make in [&balls as Make, &boxes] {
        for factor in [1.05, 0.97] {
            let (exact, wrong) = (make(1.0), make(factor));
            let pairs = [
                (exact.clone(), wrong.clone()),
                (exact.clone(), only(&wrong, &["object", "object_event"])),
                (exact.clone(), only(&wrong, &["object", "event"])),
                (unknown(&exact), only(&wrong, &["object", "object_event"])),
            ];
            for (reference, candidate) in pairs {
                let found = diagnosed(&reference, &candidate);
                named(Kind::SizeWrong, &["object 1 is", "times as large"], &found);
                let off = evidence(&found, "factor") - factor;
                assert!(off.abs() < 0.003, "{factor}: {found:?}");
            }
        }
    }
}
