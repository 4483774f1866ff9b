//! The wavelength ratio W = λ′/λ and the powers of it that each quantity carries.
//!
//! With u the four-velocities, W = (k·u_emitter)/(k·u_observer):
//! - an emitter at rest in the world, seen along d′ of a camera with velocity β: γ(1 − β·d′);
//! - an emitter with velocity β, seen along d by a camera at rest: γ(1 + β·d).

use glam::DVec3;
use nullray::render::aov::Aov;
use nullray::scene::model::Scene;
use nullray::spacetime::{Quantity, Velocity};

use crate::pipeline::stage::{self, assert_relative};

/// The camera is inside a large ball of radiance 1.
fn enclosed() -> Scene {
    stage::scene(
        "
[display]
back_faces = \"two_sided\"
[camera]
eye = [0.3, 0.1, -0.2]
look_at = [0.9, 0.5, -1.2]
hfov = \"130 deg\"
size = [24, 18]
[[object]]
shape = { sphere = { radius = 50, subdivisions = 2 } }
colour = [1, 1, 1]
",
    )
}

const QUANTITIES: [(Quantity, i32); 7] = [
    (Quantity::PerWavelength, 5),
    (Quantity::Integrated, 4),
    (Quantity::PhotonsPerWavelength, 4),
    (Quantity::PerFrequency, 3),
    (Quantity::Photons, 3),
    (Quantity::PhotonsPerFrequency, 2),
    // Beyond the visible at any W in use: shown in a grey of one half.
    (Quantity::Line { wavelength: 1.0 }, 4),
];

/// Asserts W by `expected` and the radiance W⁻ᵖ in every pixel, for every quantity.
fn check(scene: &mut Scene, expected: impl Fn(&Scene, DVec3, DVec3) -> f64) {
    for (quantity, p) in QUANTITIES {
        scene.quantity = quantity;
        let film = stage::film(scene);
        assert_eq!(stage::met(&film).len(), stage::pixels(&film));
        for i in 0..stage::pixels(&film) {
            let w = stage::value(&film, Aov::WavelengthRatio, i);
            let (seen, d) = (stage::through(&scene.camera, i), stage::direction(&film, i));
            assert_relative(w, expected(scene, seen, d), 1e-12, "W");
            let grey = if matches!(quantity, Quantity::Line { .. }) {
                0.5
            } else {
                1.0
            };
            assert_relative(film.radiance()[i][0], grey * w.powi(-p), 1e-14, p);
        }
    }
}

#[test]
fn a_uniform_sky_is_seen_by_a_moving_camera_as_w_to_the_minus_p() {
    for beta in [
        DVec3::new(0.0, 0.0, -0.6),
        DVec3::new(0.5, -0.7, 0.3),
        DVec3::new(0.0, 0.95, 0.0),
    ] {
        let mut scene = enclosed();
        scene.camera.velocity = Velocity::from_beta(beta).unwrap();
        let gamma = 1.0 / (1.0 - beta.length_squared()).sqrt();
        check(&mut scene, |_, seen, _| gamma * (1.0 - beta.dot(seen)));
    }
}

#[test]
fn a_uniform_sky_that_moves_past_a_camera_at_rest_is_w_to_the_minus_p() {
    for beta in [DVec3::new(0.0, 0.0, -0.6), DVec3::new(0.5, -0.7, 0.3)] {
        let mut scene = enclosed();
        scene.objects[0].velocity = Velocity::from_beta(beta).unwrap();
        let gamma = 1.0 / (1.0 - beta.length_squared()).sqrt();
        check(&mut scene, |_, _, d| gamma * (1.0 + beta.dot(d)));
    }
}

#[test]
fn a_sky_that_moves_along_with_the_camera_is_not_shifted() {
    let mut scene = enclosed();
    let velocity = Velocity::from_beta(DVec3::new(0.5, -0.7, 0.3)).unwrap();
    scene.objects[0].velocity = velocity;
    scene.camera.velocity = velocity;
    check(&mut scene, |_, _, _| 1.0);
}

#[test]
fn head_on_the_ratio_is_the_exponential_of_the_rapidity() {
    // √((1 − β)/(1 + β)) = e^−φ approaching, e^φ receding; odd sizes have a pixel centre on the axis.
    for phi in [0.01, 0.5, 3.0, 7.0] {
        for (sign, who) in [(1.0, "approaching"), (-1.0, "receding")] {
            let mut scene = enclosed();
            scene.camera.size = [5, 5];
            // The ball is 50 m/γ deep in the world.
            scene.camera.origin.x = DVec3::ZERO;
            let axis = scene.camera.axes[2];
            let moving = Velocity::from_rapidity_along(sign * phi, axis).unwrap();
            scene.camera.velocity = moving;
            let camera = stage::film(&scene);
            scene.camera.velocity = Velocity::REST;
            scene.objects[0].velocity = -moving;
            let emitter = stage::film(&scene);
            for film in [camera, emitter] {
                let w = stage::value(&film, Aov::WavelengthRatio, 12);
                assert_relative(w, (-sign * phi).exp(), 1e-12, who);
            }
        }
    }
}
