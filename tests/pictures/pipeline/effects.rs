//! Turning off a single effect changes that effect, and nothing else.

use glam::DVec3;
use nullray::camera::Shot;
use nullray::colour::line_colour;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::scene::model::Scene;

use crate::pipeline::stage::{self, assert_relative};

const GREEN: f64 = 532e-9;

/// A box that moves at 0.8 c and a floor at rest, before a camera that moves at 0.6 c.
fn moving() -> Scene {
    stage::scene(
        "
[display]
back_faces = \"two_sided\"
[radiance]
quantity = \"line\"
wavelength = \"532 nm\"
[camera]
eye = [0.4, 1.5, 6.0]
look_at = [0.0, 0.4, 0.0]
hfov = \"70 deg\"
size = [40, 30]
velocity = { beta = [0.1, 0.0, -0.6] }
[[object]]
name = \"box\"
shape = { box = { size = [2.0, 1.6, 1.2] } }
colour = [0.9, 0.6, 0.3]
velocity = { beta = [0.8, 0.0, 0.0] }
origin = { position = [-4.0, 0.8, 0.3], time = \"-6 m\" }
[[object]]
name = \"floor\"
shape = { plane = { size = [9, 9] } }
colour = [0.9, 0.6, 0.3]
",
    )
}

/// W of a world-static source, γ(1 − β·d′).
fn static_ratio(scene: &Scene, i: usize) -> f64 {
    let velocity = scene.camera.velocity;
    let d = stage::through(&scene.camera, i);
    velocity.gamma() * (1.0 - velocity.beta().dot(d))
}

fn counted(film: &Film) -> Vec<usize> {
    let met = stage::met(film);
    assert!(met.len() > 200, "only {} pixels see anything", met.len());
    met
}

#[test]
fn without_aberration_directions_are_the_pinholes_and_w_is_as_before() {
    let mut scene = moving();
    scene.effects.aberration = false;
    let film = stage::film(&scene);
    for i in 0..stage::pixels(&film) {
        let d = stage::through(&scene.camera, i);
        assert!(stage::direction(&film, i).distance(d) < 1e-14);
        if stage::value(&film, Aov::Object, i) == 1.0 {
            let w = stage::value(&film, Aov::WavelengthRatio, i);
            assert_relative(w, static_ratio(&scene, i), 1e-13, "W");
        }
    }
    counted(&film);
}

#[test]
fn with_aberration_directions_follow_the_textbook() {
    // d = [d′/γ … ]: along the motion cos θ = (cos θ′ − β)/(1 − β cos θ′), across it sin θ′/γ(1 − β cos θ′),
    // with look directions opposite to the light's, so that objects ahead of a moving camera draw together.
    let scene = moving();
    let film = stage::film(&scene);
    let (n, beta) = (
        scene.camera.velocity.beta().normalize(),
        scene.camera.velocity.beta().length(),
    );
    for i in 0..stage::pixels(&film) {
        let d = stage::through(&scene.camera, i);
        let cosine = (n.dot(d) - beta) / (1.0 - beta * n.dot(d));
        assert!((n.dot(stage::direction(&film, i)) - cosine).abs() < 1e-14);
    }
}

#[test]
fn without_doppler_a_line_keeps_its_colour_and_its_radiance_factor() {
    let mut scene = moving();
    for doppler in [true, false] {
        scene.effects.doppler = doppler;
        let film = stage::film(&scene);
        for i in counted(&film) {
            let w = stage::value(&film, Aov::WavelengthRatio, i);
            let shown = if doppler { GREEN * w } else { GREEN };
            // The line's radiance is the mean of the channels, 0.6; p = 4.
            let factor = 0.6 / (w * w * w * w);
            for (got, hue) in film.radiance()[i].into_iter().zip(line_colour(shown)) {
                assert!((got - factor * hue).abs() <= 1e-6 * factor, "W = {w}");
            }
        }
    }
}

#[test]
fn without_searchlight_the_radiance_is_the_emitted_one() {
    let mut scene = moving();
    scene.quantity = nullray::spacetime::Quantity::Integrated;
    scene.effects.searchlight = false;
    let film = stage::film(&scene);
    let emitted = [0.9f32, 0.6, 0.3].map(f64::from);
    for i in counted(&film) {
        assert_eq!(film.radiance()[i], emitted);
    }
}

#[test]
fn without_retardation_everything_is_seen_at_the_time_of_the_shot_and_contracted() {
    // At one world time a box of length L along its motion is L/γ long: x∥ = γ (x − vT) in [−L/2, L/2].
    let mut scene = moving();
    scene.effects.retardation = false;
    scene.camera.size = [200, 150];
    let film = stage::film(&scene);
    let shot = Shot::new(&scene.camera).unwrap().event;
    let (gamma, beta) = (1.0 / 0.6, 0.8);
    let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
    for i in counted(&film) {
        let (ct, x) = stage::event(&film, i);
        assert_eq!(ct, shot.ct);
        if stage::value(&film, Aov::Object, i) == 0.0 {
            let from_origin = x - DVec3::new(-4.0, 0.8, 0.3);
            let along = from_origin.x - beta * (ct + 6.0);
            extent = [extent[0].min(along), extent[1].max(along)];
            let half = DVec3::new(1.0, 0.8, 0.6);
            let on_box = DVec3::new(gamma * along, from_origin.y, from_origin.z) / half;
            assert!((on_box.abs().max_element() - 1.0).abs() < 1e-13, "{on_box}");
        }
    }
    // Its whole length is in sight, to the pixels' size.
    let length = 2.0 / gamma;
    assert!(extent[1] - extent[0] > 0.9 * length, "{extent:?}");
}

#[test]
fn without_retardation_a_moving_ball_is_an_ellipsoid() {
    // x∥²γ² + x⊥² = R², but for the facets: an icosahedron split n times has edges of about 1.1/2ⁿ R,
    // and its faces' centres lie edge²/6 R inside.
    let mut scene = stage::scene(
        "
[effects]
retardation = false
[camera]
eye = [0, 0, 6]
look_at = [0, 0, 0]
hfov = \"30 deg\"
size = [60, 60]
[[object]]
shape = { sphere = { radius = 1, subdivisions = 5 } }
velocity = { gamma = 3, direction = [1, 1, 0] }
",
    );
    let film = stage::film(&scene);
    let n = DVec3::new(1.0, 1.0, 0.0).normalize();
    for i in stage::met(&film) {
        let (_, x) = stage::event(&film, i);
        let along = n.dot(x);
        let radius = ((x - n * along).length_squared() + 9.0 * along * along).sqrt();
        assert!(radius <= 1.0 + 1e-13 && radius > 1.0 - 5e-4, "{radius}");
    }
    // The outline's area is that of the ellipse, π R · R/γ, seen from afar: fewer than half the pixels of
    // the ball at rest.
    let ellipse = stage::met(&film).len() as f64;
    scene.objects[0].velocity = nullray::spacetime::Velocity::REST;
    let circle = stage::met(&stage::film(&scene)).len() as f64;
    assert!(
        (ellipse / circle - 1.0 / 3.0).abs() < 0.02,
        "{}",
        ellipse / circle
    );
}
