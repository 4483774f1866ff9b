//! Cameras with another velocity or orientation, or whose boost lacks γ: each is named with its numbers, whichever channels show it.

use nullray::scene::model::Scene;
use nullray::validate::compare::{Diagnosis, Kind, Picture};

use crate::compare::planting::{
    SCENE, changed, diagnosed, evidence, exact, map, named, only, parsed, shot, taken, unknown,
    values, with,
};

/// The picture without what it says of its shot.
fn bare(picture: &Picture) -> Picture {
    let mut picture = picture.clone();
    picture.layers.metadata.clear();
    picture
}

/// The channels that say how the camera moves, each by themselves.
const CHANNELS: [&[&str]; 4] = [
    &["direction"],
    &["object", "event"],
    &["object", "object_event"],
    &["direction", "wavelength_ratio", "object", "radiance"],
];

#[test]
fn cameras_of_another_velocity_are_named_with_it() {
    // Another speed; turned by 10 degrees; in another direction; a little slower.
    for (beta, words) in [
        ("0.6, 0, 0", "(0.6000, 0.0000, 0.0000)"),
        ("0.4924, 0.0868, 0", "(0.4924, 0.0868, 0.0000)"),
        ("0, 0, -0.5", "(0.0000, 0.0000, -0.5000)"),
        ("0.49, 0, 0", "(0.4900, 0.0000, 0.0000)"),
    ] {
        let wrong = bare(&with(&[(
            "beta = [0.5, 0, 0]",
            &format!("beta = [{beta}]"),
        )]));
        let words = [
            "the camera moves at another velocity",
            words,
            "(0.5000, 0.0000, 0.0000)",
        ];
        named(Kind::CameraVelocity, &words, &diagnosed(&exact(), &wrong));
        for channels in CHANNELS {
            let found = diagnosed(&exact(), &only(&wrong, channels));
            named(Kind::CameraVelocity, &words, &found);
        }
        // Where the scene is not known, directions tell.
        let found = diagnosed(&unknown(&exact()), &wrong);
        named(Kind::CameraVelocity, &words, &found);
    }
}

/// In a picture of so many pixels, changes that do not explain some of them are not tried at all of them.
#[test]
fn cameras_of_another_velocity_are_named_in_large_pictures_too() {
    let size = ("size = [96, 72]", "size = [160, 120]");
    let right = with(&[size]);
    let velocity = ("beta = [0.5, 0, 0]", "beta = [0.6, 0, 0]");
    for channels in [&["object", "event"][..], &["object", "object_event"]] {
        let wrong = only(&bare(&with(&[size, velocity])), channels);
        let words = [
            "the camera moves at another velocity",
            "(0.6000, 0.0000, 0.0000)",
        ];
        named(Kind::CameraVelocity, &words, &diagnosed(&right, &wrong));
    }
}

#[test]
fn a_camera_that_moves_and_should_rest_is_named() {
    let still = shot(&parsed(
        &SCENE.replace("beta = [0.5, 0, 0]", "beta = [0, 0, 0]"),
    ));
    let wrong = bare(&exact());
    let words = [
        "β = (0.5000, 0.0000, 0.0000), and should be",
        "(0.0000, 0.0000, 0.0000)",
    ];
    for channels in CHANNELS {
        let found = diagnosed(&still, &only(&wrong, channels));
        named(Kind::CameraVelocity, &words, &found);
    }
}

#[test]
fn cameras_of_another_velocity_at_a_later_time_are_named_with_it() {
    // The pinhole is then elsewhere, too, so that its events are not those of the shot.
    let at = |beta: &str| {
        let time = ("hfov = \"60 deg\"", "hfov = \"60 deg\", time = \"0.6 m\"");
        with(&[time, ("beta = [0.5, 0, 0]", &format!("beta = [{beta}]"))])
    };
    let (right, wrong) = (at("0.5, 0, 0"), bare(&at("0.55, 0.05, 0")));
    let words = ["another velocity", "(0.5500, 0.0500, 0.0000)"];
    named(Kind::CameraVelocity, &words, &diagnosed(&right, &wrong));
    for channels in [&["direction"][..], &["object", "object_event"]] {
        let found = diagnosed(&right, &only(&wrong, channels));
        named(Kind::CameraVelocity, &words, &found);
    }
}

/// The scene with its camera turned about an axis of its frame.
fn turned(axis: [f64; 3], degrees: f64) -> Scene {
    let mut scene = parsed(SCENE);
    let (sin, cos) = degrees.to_radians().sin_cos();
    scene.camera.axes = scene.camera.axes.map(|v| {
        // Rodrigues: v cos + a × v sin + a (a·v)(1 − cos).
        let a = axis;
        let dot = a[0] * v.x + a[1] * v.y + a[2] * v.z;
        let cross = [
            a[1] * v.z - a[2] * v.y,
            a[2] * v.x - a[0] * v.z,
            a[0] * v.y - a[1] * v.x,
        ];
        let part = |k: usize| v[k] * cos + cross[k] * sin + a[k] * dot * (1.0 - cos);
        [part(0), part(1), part(2)].into()
    });
    scene
}

#[test]
fn a_camera_that_is_turned_is_named_with_angle_and_axis() {
    for (axis, degrees, words) in [
        ([0.0, 1.0, 0.0], 0.1, "(0.0000, 1.0000, 0.0000)"),
        ([0.0, 1.0, 0.0], 0.7, "(0.0000, 1.0000, 0.0000)"),
        ([0.6, 0.0, 0.8], 1.0, "(0.6000, 0.0000, 0.8000)"),
        ([0.0, 0.6, -0.8], 5.0, "(0.0000, 0.6000, -0.8000)"),
    ] {
        let wrong = bare(&shot(&turned(axis, degrees)));
        let angle = format!("turned by {degrees:.4} degrees");
        let words = [angle.as_str(), words];
        let check = |found: &[Diagnosis]| {
            named(Kind::CameraTurned, &words, found);
            assert!((evidence(found, "degrees") - degrees).abs() < 1e-3 * degrees);
        };
        check(&diagnosed(&exact(), &wrong));
        for channels in CHANNELS {
            check(&diagnosed(&exact(), &only(&wrong, channels)));
        }
        check(&diagnosed(&unknown(&exact()), &wrong));
    }
}

#[test]
fn a_turn_to_the_left_and_up_is_said_so() {
    // About up, (0, 1, 0), of a camera that looks level, counterclockwise from above.
    let level = SCENE.replace("look_at = [1.5, 0.3, 0]", "look_at = [0, 0.6, 0]");
    let mut scene = parsed(&level);
    let right = shot(&scene);
    let [to_right, up, forward] = scene.camera.axes;
    let (sin, cos) = 1f64.to_radians().sin_cos();
    scene.camera.axes = [
        to_right * cos + forward * sin,
        up,
        forward * cos - to_right * sin,
    ];
    let found = diagnosed(&right, &bare(&shot(&scene)));
    named(Kind::CameraTurned, &["yaw +1.0000 (left)"], &found);
    scene.camera.axes = [to_right, up * cos - forward * sin, forward * cos + up * sin];
    let found = diagnosed(&right, &bare(&shot(&scene)));
    named(Kind::CameraTurned, &["pitch +1.0000 (up)"], &found);
}

#[test]
fn a_boost_that_lacks_gamma_is_named() {
    // The camera's own look direction is along d + β, and as far from β as it should be.
    let mut scene = parsed(SCENE);
    scene.camera.velocity = nullray::spacetime::Velocity::REST;
    let names = ["x", "y", "z"].map(|axis| format!("direction.{axis}"));
    let own = shot(&scene);
    let own = names.each_ref().map(|name| values(&own, name));
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x / length)
    };
    // From the world to the camera, and from the camera to the world.
    let from_world = |e: [f64; 3]| {
        let along = 0.5 * e[0];
        let s = along + (along * along + 0.75).sqrt();
        [s * e[0] - 0.5, s * e[1], s * e[2]]
    };
    let to_world = |e: [f64; 3]| unit([e[0] - 0.5, e[1], e[2]]);
    type Map<'a> = &'a dyn Fn([f64; 3]) -> [f64; 3];
    let maps: [(Map, &str); 2] = [(&from_world, "along d + β"), (&to_world, "along d′ − β")];
    for (of, words) in maps {
        let mut wrong = exact();
        for (k, name) in names.iter().enumerate() {
            map(&mut wrong, name, |i, _| {
                of([own[0][i], own[1][i], own[2][i]])[k]
            });
        }
        let words = ["aberration lacks γ", words];
        for wrong in [wrong.clone(), only(&wrong, &["direction"])] {
            let found = diagnosed(&exact(), &wrong);
            named(Kind::AberrationWithoutGamma, &words, &found);
        }
    }
}

#[test]
fn ratios_of_a_camera_of_another_velocity_are_named_with_it() {
    let d = ["x", "y", "z"].map(|axis| values(&exact(), &format!("direction.{axis}")));
    let gamma = |b: [f64; 3]| 1.0 / (1.0 - b.iter().map(|x| x * x).sum::<f64>()).sqrt();
    let ratio =
        |i: usize, b: [f64; 3]| gamma(b) * (1.0 + b[0] * d[0][i] + b[1] * d[1][i] + b[2] * d[2][i]);
    for (beta, words) in [
        ([0.6, 0.0, 0.0], "with β = (0.6000, 0.0000, 0.0000)"),
        ([0.3, 0.2, -0.1], "with β = (0.3000, 0.2000, -0.1000)"),
    ] {
        let wrong = changed(&["wavelength_ratio"], |i, w| {
            w * ratio(i, [0.5, 0.0, 0.0]) / ratio(i, beta)
        });
        for reference in [exact(), unknown(&exact())] {
            let found = diagnosed(&reference, &wrong);
            named(
                Kind::RatioOfCamera,
                &[words, "(0.5000, 0.0000, 0.0000)"],
                &found,
            );
        }
    }
}

#[test]
fn ratios_alone_name_the_camera_of_another_velocity() {
    let at_rest = SCENE
        .replace("velocity = { beta = [0.3, 0, 0] }", "")
        .replace("velocity = { beta = [-0.4, 0, 0] }", "");
    let moving_alike = SCENE.replace("beta = [-0.4, 0, 0]", "beta = [0.3, 0, 0]");
    let floor = [
        "name = \"floor\"",
        "name = \"floor\"\nvelocity = { beta = [0.3, 0, 0] }",
    ];
    let moving_alike = moving_alike.replace(floor[0], floor[1]);
    // Where velocities differ, `object` must say which pixels are whose.
    for (scene, channels) in [
        (at_rest.as_str(), &["wavelength_ratio"][..]),
        (&moving_alike, &["wavelength_ratio"]),
        (SCENE, &["wavelength_ratio", "object"]),
    ] {
        let right = shot(&parsed(scene));
        for (beta, words) in [
            ("0.55, 0, 0", "with β = (0.5500, 0.0000, 0.0000)"),
            ("0.4, 0.1, 0", "with β = (0.4000, 0.1000, 0.0000)"),
            ("0.3, 0.2, -0.4", "with β = (0.3000, 0.2000, -0.4000)"),
        ] {
            let other = scene.replace("beta = [0.5, 0, 0]", &format!("beta = [{beta}]"));
            let wrong = only(&bare(&shot(&parsed(&other))), channels);
            let words = [words, "(0.5000, 0.0000, 0.0000)"];
            named(Kind::RatioOfCamera, &words, &diagnosed(&right, &wrong));
        }
        assert_eq!(diagnosed(&right, &only(&bare(&right), channels)), []);
    }
}

#[test]
fn light_alone_names_the_camera_of_another_speed() {
    for (beta, words) in [("0.55, 0, 0", "β = (0.55"), ("0.45, 0, 0", "β = (0.45")] {
        let wrong = with(&[("beta = [0.5, 0, 0]", &format!("beta = [{beta}]"))]);
        let found = diagnosed(&exact(), &only(&bare(&wrong), &["radiance"]));
        let words = [words, "(0.5000, 0.0000, 0.0000)", "judged by light only"];
        named(Kind::CameraVelocity, &words, &found);
    }
}

#[test]
fn films_are_not_turned_cameras_and_right_pictures_have_none() {
    // Of a narrow view, another film and a camera that is turned or moves otherwise are nearly alike.
    let narrow = |fov: &str| shot(&parsed(&SCENE.replace("60 deg", fov)));
    let right = narrow("8 deg");
    for channels in CHANNELS {
        let found = diagnosed(&right, &only(&bare(&narrow("8.4 deg")), channels));
        named(Kind::FieldOfView, &["field of view"], &found);
    }
    let mut scene = parsed(&SCENE.replace("60 deg", "8 deg"));
    scene.samples_per_pixel = 16;
    let many = bare(&taken(&scene, false));
    for channels in CHANNELS {
        assert_eq!(diagnosed(&right, &only(&many, channels)), []);
    }
}

#[test]
fn a_camera_at_another_time_is_named_by_means_of_samples_too() {
    let at = |time: &str| {
        let mut scene = parsed(&SCENE.replace("hfov", &format!("time = \"{time}\", hfov")));
        scene.samples_per_pixel = 4;
        bare(&taken(&scene, false))
    };
    let mut reference = parsed(SCENE);
    reference.samples_per_pixel = 4;
    let reference = taken(&reference, false);
    for (time, words) in [("0.06 m", "0.0600 m"), ("0.3 m", "0.3000 m")] {
        let found = diagnosed(&reference, &at(time));
        named(Kind::CameraTime, &["another time", words], &found);
    }
}
