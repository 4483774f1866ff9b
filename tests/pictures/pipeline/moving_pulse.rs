//! A pulse from a source at rest on a moving surface, against photon counting.
//!
//! The world line of a point p of a moving plate crosses the light cone of an emission event (t, S) once, at X(τ): the light left S along n
//! = (X − S)/|X − S|. The photons that fall on dA of the plate are those emitted into the solid angle |∂n/∂u × ∂n/∂v| dA, with u, v the
//! plate's own coordinates: no Doppler factor, no aberration, only where the light reaches the plate. The rendered irradiance of photons,
//! integrated over the plate's own time, must be the same, with emission weighted by the pulse.

use glam::{DVec3, DVec4};
use nullray::render::film::Film;
use nullray::scene::model::Scene;
use nullray::spacetime::{Event, Quantity};

use crate::pipeline::{lorentz, stage};
use stage::assert_relative;

const SIGMA: f64 = 0.3;
const SOURCE: DVec3 = DVec3::new(1.0, 2.5, 0.6);
const BETA: DVec3 = DVec3::new(0.6, -0.3, 0.2);
/// The plate's centre at world time −1 m.
const CENTRE: DVec3 = DVec3::new(0.2, 0.4, -0.5);

/// A plate of albedo 1 with a camera moving along, so that W = 1.
fn scene() -> Scene {
    let mut scene = stage::scene(
        "
[radiance]
quantity = \"photons\"
[camera]
eye = [0, 0, 0]
look_at = [-0.2, -1, -0.3]
hfov = \"40 deg\"
size = [5, 4]
velocity = { beta = [0.6, -0.3, 0.2] }
[[object]]
shape = { plane = { size = [9, 9] } }
colour = [1, 1, 1]
velocity = { beta = [0.6, -0.3, 0.2] }
origin = { position = [0.2, 0.4, -0.5], time = \"-1 m\" }
[[source]]
pulse = { position = [1.0, 2.5, 0.6], sigma = \"0.3 m\" }
",
    );
    let eye = world(0.0, DVec3::new(0.3, 1.5, 0.4));
    scene.camera.origin = Event::new(eye.x, lorentz::space(eye));
    scene
}

/// The world event of the plate's point `p` at its own time `tau`.
fn world(tau: f64, p: DVec3) -> DVec4 {
    lorentz::four(-1.0, CENTRE) + lorentz::boost(lorentz::rapidity(BETA)) * lorentz::four(tau, p)
}

/// The direction in which light emitted at time `t` leaves for the plate's point `p`.
fn leaves(t: f64, p: DVec3) -> DVec3 {
    // Δt − |Δx| grows with τ: bisection.
    let (mut lo, mut hi) = (-100.0, 100.0);
    for _ in 0..100 {
        let tau = 0.5 * (lo + hi);
        let d = world(tau, p) - lorentz::four(t, SOURCE);
        if d.x < lorentz::space(d).length() {
            lo = tau
        } else {
            hi = tau
        }
    }
    (lorentz::space(world(lo, p)) - SOURCE).normalize()
}

/// Photons per area of the plate at `p`, for one photon per solid angle at emission time `t`.
fn photons_per_area(t: f64, p: DVec3) -> f64 {
    let h = 1e-4;
    let slope = |e: DVec3| (leaves(t, p + e * h) - leaves(t, p - e * h)) / (2.0 * h);
    slope(DVec3::X).cross(slope(DVec3::Z)).length()
}

/// The sum over emission times, weighted by the pulse; the trapezoid rule is exact for Gaussians.
fn expected(p: DVec3) -> f64 {
    let step = 0.5;
    let weight = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt() * step;
    let at = |k: i32| f64::from(k) * step;
    (-12..=12)
        .map(|k| weight(at(k)) * photons_per_area(at(k) * SIGMA, p))
        .sum()
}

/// Pictures at the camera's times −4 m, −4 m + step, −4 m + 2 step …
fn pictures(scene: &Scene, step: f64, count: usize) -> Vec<Film> {
    (0..count)
        .map(|k| {
            let mut later = scene.clone();
            later.camera.time = k as f64 * step - 4.0;
            stage::film(&later)
        })
        .collect()
}

#[test]
fn a_moving_plate_reflects_as_many_photons_as_were_sent_its_way() {
    let step = 0.05;
    let films = pictures(&scene(), step, 320);
    // The pulse comes and goes within the pictures.
    for ends in [&films[0], &films[319]] {
        assert!(ends.radiance().iter().all(|c| c[0] == 0.0));
    }
    for i in 0..stage::pixels(&films[0]) {
        let (_, p) = stage::object_event(&films[0], i);
        let sum: f64 = films.iter().map(|f| f.radiance()[i][0]).sum();
        let photons = sum * step * std::f64::consts::PI;
        assert_relative(photons, expected(p), 1e-6, format!("pixel {i} at {p}"));
    }
}

#[test]
fn energy_is_photons_times_the_frequency_at_which_they_arrive() {
    // ω_rest/ω_world of light that travels along n: γ(1 − β·n).
    let mut scene = scene();
    let bright = |scene: &Scene| pictures(scene, 0.4, 40);
    let photons = bright(&scene);
    scene.sources[0].quantity = Quantity::Integrated;
    let energy = bright(&scene);
    let gamma = 1.0 / (1.0 - BETA.length_squared()).sqrt();
    let mut lit = 0;
    for (photons, energy) in photons.iter().zip(&energy) {
        for i in stage::met(photons) {
            let (_, x) = stage::event(photons, i);
            let n = (x - SOURCE).normalize();
            let (few, much) = (photons.radiance()[i][0], energy.radiance()[i][0]);
            if few > 0.0 {
                assert_relative(much / few, gamma * (1.0 - BETA.dot(n)), 1e-12, "frequency");
                lit += 1;
            }
        }
    }
    assert!(lit > 50, "{lit}");
}
