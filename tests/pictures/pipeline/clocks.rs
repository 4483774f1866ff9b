//! Cubes on moving objects: the clock that they show, and captures made in an object's rest frame.
//!
//! A cube whose density is a + b t at its bins' centres is a + b t between them, by linear reconstruction, so each pixel shows the time at
//! which it was looked up.

use std::path::Path;

use glam::DVec3;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::scene::model::{Clock, Mapping, Scene, SourceKind};
use nullray::spacetime::Velocity;

use crate::pipeline::{files, lorentz, stage};
use stage::assert_relative;

/// Two boxes at rest in one moving frame, with clocks of their own, and a floor at rest.
const TEXT: &str = "
[camera]
eye = [0.4, 1.5, 6.0]
look_at = [0.0, 0.4, 0.0]
size = [32, 24]
clock_zero = \"3 m\"
[[object]]
name = \"box\"
shape = { box = { size = [1.1, 0.9, 1.3] } }
velocity = { beta = [0.6, 0.1, -0.3] }
origin = { position = [0.5, 0.5, 0.3], time = \"-4 m\" }
[[object]]
name = \"second box\"
shape = { box = { size = [0.5, 1.5, 0.5] } }
velocity = { beta = [0.6, 0.1, -0.3] }
origin = { position = [-2.0, 0.5, 0.0], time = \"-5 m\" }
[[object]]
name = \"floor\"
shape = { plane = { size = [9, 9] } }
origin = { position = [0.0, -1.0, 0.0], time = \"1 m\" }
[[source]]
name = \"light\"
cube = { file = \"cube.npy\", start = \"-50 m\", bin_width = \"5 m\", clock = \"CLOCK\", values = \"density\" }
";

/// The density at bin centres: 100 + 2 t.
fn density(t: f64) -> f64 {
    100.0 + 2.0 * t
}

fn scene(folder: &Path, clock: &str) -> Scene {
    let bins = (0..20).map(|k| density(-50.0 + 5.0 * (f64::from(k) + 0.5)));
    files::npy(&folder.join("cube.npy"), &[1, 1, 20], bins);
    stage::scene_in(folder, &TEXT.replace("CLOCK", clock))
}

/// Asserts that every pixel shows W⁻⁴ × the density at the time that `clock` tells of it.
fn check(clock: &str, time: impl Fn(&Film, usize) -> f64) {
    let folder = tempfile::tempdir().unwrap();
    let film = stage::film(&scene(folder.path(), clock));
    let mut seen = [0; 3];
    for i in stage::met(&film) {
        seen[stage::value(&film, Aov::Object, i) as usize] += 1;
        let w = stage::value(&film, Aov::WavelengthRatio, i);
        let expected = density(time(&film, i)) / w.powi(4);
        assert_relative(
            film.radiance()[i][0],
            expected,
            1e-13,
            format!("{clock}, pixel {i}"),
        );
    }
    assert!(seen.iter().all(|n| *n > 10), "{seen:?}");
}

#[test]
fn on_the_objects_clock_each_object_shows_its_own_time() {
    check("object", |film, i| stage::object_event(film, i).0);
}

#[test]
fn on_the_worlds_clock_moving_objects_show_the_time_of_the_world() {
    check("world", |film, i| stage::event(film, i).0);
}

#[test]
fn an_objects_time_and_the_worlds_are_related_by_the_textbook() {
    // τ = γ (Δt − β·Δx) from the event of the object's time 0.
    let folder = tempfile::tempdir().unwrap();
    let scene = scene(folder.path(), "world");
    let film = stage::film(&scene);
    let beta = DVec3::new(0.6, 0.1, -0.3);
    let gamma = 1.0 / (1.0 - beta.length_squared()).sqrt();
    for i in stage::met(&film) {
        let object = &scene.objects[stage::value(&film, Aov::Object, i) as usize];
        let ((t, x), (tau, _)) = (stage::event(&film, i), stage::object_event(&film, i));
        let (dt, dx) = (t - object.origin.ct, x - object.origin.x);
        let expected = match object.velocity.is_rest() {
            true => dt,
            false => gamma * (dt - beta.dot(dx)),
        };
        assert!((tau - expected).abs() < 1e-13, "{tau} {expected}");
    }
}

/// A box on a floor, both with their origins at the world's, captured by a camera in their frame.
const CAPTURED: &str = "
outside = { before = \"black\", after = \"hold\", off_texture = { mark = [1, 0, 0] }, occluded = { mark = [0, 0, 1] } }
[camera]
eye = [0.4, 1.5, 6.0]
look_at = [0.0, 0.4, 0.0]
size = [32, 24]
clock_zero = \"8 m\"
[[object]]
name = \"box\"
shape = { box = { size = [1.1, 0.9, 1.3] } }
[[object]]
name = \"floor\"
shape = { plane = { size = [6, 6] } }
transform = { translate = [0, -0.45, 0] }
[[source]]
name = \"light\"
objects = [\"box\", \"floor\"]
[source.cube]
file = \"cube.npy\"
start = \"-20 m\"
bin_width = \"4 m\"
clock = \"CLOCK\"
values = \"density\"
capture = { eye = [3, 4, 5], look_at = [0, 0, 0], hfov = \"50 deg\" }
";

/// That the capture of moving objects, made in their frame, is that of objects at rest seen by a camera
/// that moves along: no velocity is special.
fn captures_move_along(clock: Clock) {
    let folder = tempfile::tempdir().unwrap();
    let values = (0..16 * 16 * 20).map(|k| f64::from(k * k % 101));
    files::npy(&folder.path().join("cube.npy"), &[16, 16, 20], values);
    let name = if clock == Clock::Capture {
        "capture"
    } else {
        "world"
    };
    let rest = stage::scene_in(folder.path(), &CAPTURED.replace("CLOCK", name));
    let mut moving = lorentz::boosted(&rest, lorentz::rapidity(DVec3::new(0.5, -0.6, 0.3)));
    if let SourceKind::Cube(cube) = &mut moving.sources[0].kind {
        cube.clock = clock;
        assert!(matches!(cube.mapping, Mapping::Capture(_)));
    }
    let (a, b) = (stage::film(&rest), stage::film(&moving));
    let mut held = 0;
    for i in 0..stage::pixels(&a) {
        let coverage = stage::value(&a, Aov::Coverage, i);
        assert!(
            (coverage - stage::value(&b, Aov::Coverage, i)).abs() < 1e-9,
            "pixel {i}"
        );
        held += usize::from(coverage == 1.0);
        for (x, y) in a.radiance()[i].into_iter().zip(b.radiance()[i]) {
            assert!(
                (x - y).abs() <= 1e-9 * x.abs().max(1.0),
                "pixel {i}: {x} {y}"
            );
        }
    }
    assert!(held > 100 && held < stage::pixels(&a), "{held}");
}

#[test]
fn a_capture_of_moving_objects_in_its_own_time_is_that_of_their_rest_frame() {
    captures_move_along(Clock::Capture);
}

#[test]
fn a_capture_of_moving_objects_in_their_time_is_that_of_their_rest_frame() {
    captures_move_along(Clock::Object);
}

#[test]
fn in_a_medium_the_lookup_is_later_by_the_index() {
    // At rest, t = T − η s.
    let folder = tempfile::tempdir().unwrap();
    let mut scene = scene(folder.path(), "world");
    scene.medium_index = 1.5;
    for object in &mut scene.objects {
        object.velocity = Velocity::REST;
    }
    let film = stage::film(&scene);
    for i in stage::met(&film) {
        let t = 3.0 - 1.5 * stage::value(&film, Aov::Distance, i);
        assert_relative(film.radiance()[i][0], density(t), 1e-13, i);
    }
}
