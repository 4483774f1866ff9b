//! The light of lamps on any world line, against brute force and the conservation of energy.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use nullray::light::Received;
use nullray::light::lamp::Lamp;
use nullray::scene::model::LightKind;
use nullray::scene::{self, Overrides};
use nullray::spacetime::{Direction, Event, NullRay, Quantity, World};

/// The lamp of a scene file's `[[light]]`.
fn lamp(keys: &str) -> Lamp {
    let text = format!(
        "camera = {{ eye = [0, 1, 5], look_at = [0, 0, 0] }}\nobject = [{{ shape = {{ plane = {{ size = [1, 1] }} }} }}]\n[[light]]\n{keys}"
    );
    let scene = scene::parse(&text, "test", ".".as_ref(), &Overrides::default()).unwrap();
    let LightKind::Lamp(lamp) = &scene.lights[0].kind else {
        unreachable!()
    };
    let received = Received::Scaled(Quantity::Integrated);
    Lamp::new(lamp, received, true, Event::new(3.0, DVec3::ZERO)).unwrap()
}

/// E at the event (t, x) on a surface at rest that faces the lamp.
fn irradiance(lamp: &Lamp, t: f64, x: DVec3) -> f64 {
    // A ray that has its hit there.
    let d = Direction::<World>::new(DVec3::Z).unwrap();
    let ray = NullRay::new(Event::new(t + 1.0, x - DVec3::Z), d, 1.0);
    let arrival = lamp.arrival(&ray, 1.0, 1.0).unwrap();
    lamp.incident(&arrival, 1.0, 1.0).irradiance[0]
}

/// A grid of directions of equal solid angle.
fn directions(n: usize) -> impl Iterator<Item = DVec3> {
    (0..n * 2 * n).map(move |k| {
        let z = 1.0 - 2.0 * ((k / (2 * n)) as f64 + 0.5) / n as f64;
        let phi = TAU * ((k % (2 * n)) as f64 + 0.5) / (2 * n) as f64;
        let s = (1.0 - z * z).sqrt();
        DVec3::new(s * phi.cos(), s * phi.sin(), z)
    })
}

#[test]
fn a_closed_sphere_receives_all_power_of_a_lamp_at_any_speed() {
    // What leaves within dt′ arrives within (1 − β·n) dt′. Its energy in the world is γ P dτ = P dt′: no momentum is
    // emitted in the lamp's frame. So ∫ E (1 − β·n) R² dω = P = 4π I on a sphere about the event of emission.
    for beta in [0.0, 0.3, 0.8, 0.95] {
        let lamp = lamp(&format!(
            "position = [0, 0, 0]\nvelocity = {{ beta = [0, 0, {beta}] }}"
        ));
        let (n, radius) = (900, 2.5);
        let sum: f64 = directions(n)
            .map(|d| irradiance(&lamp, radius, d * radius) * (1.0 - beta * d.z))
            .sum();
        let power = sum * radius * radius * 4.0 * PI / (2 * n * n) as f64;
        // The midpoint rule of step h = 2/n over (1 − β z)⁻³: h²/24 · 12 β²/(1 − β)² = 9·10⁻⁴ of it where it is largest.
        assert!(
            (power - 4.0 * PI).abs() < 1e-3 * 4.0 * PI,
            "{beta}: {power}"
        );
    }
}

/// E of a lamp of intensity 1 with this path and velocity, found by bisection: W⁻²/r_G², r_G = γ (r − β·R).
fn brute_force(path: impl Fn(f64) -> (DVec3, DVec3), t: f64, x: DVec3) -> f64 {
    let (mut early, mut late) = (t - 1e3, t);
    for _ in 0..200 {
        let middle = 0.5 * (early + late);
        match t - middle > path(middle).0.distance(x) {
            true => early = middle,
            false => late = middle,
        }
    }
    let (from, beta) = path(early);
    let way = x - from;
    let r = way.length();
    let in_lamp = (r - beta.dot(way)) / (1.0 - beta.length_squared()).sqrt();
    let w = in_lamp / r;
    1.0 / (w * w * in_lamp * in_lamp)
}

fn places() -> impl Iterator<Item = (f64, DVec3)> {
    directions(4)
        .enumerate()
        .map(|(k, d)| (0.3 * k as f64 - 4.0, d * 3.0 + DVec3::Y))
}

#[test]
fn a_lamp_on_a_circle_lights_as_its_retarded_place_and_velocity_say() {
    let lamp = lamp(
        "position = [1, 0, 0]\nmotion.circle = { centre = [0, 0, 0], axis = [0, 1, 0], rate = \"0.8 rad/m\" }",
    );
    let path = |t: f64| {
        let (s, c) = (0.8 * t).sin_cos();
        (DVec3::new(c, 0.0, -s), DVec3::new(-s, 0.0, -c) * 0.8)
    };
    for (t, x) in places() {
        let (got, expected) = (irradiance(&lamp, t, x), brute_force(path, t, x));
        assert!(
            (got - expected).abs() < 1e-9 * expected,
            "{t} {x}: {got} {expected}"
        );
    }
}

#[test]
fn an_accelerated_lamp_lights_as_its_retarded_place_and_velocity_say() {
    // x = (√(1 + (gt)²) − 1)/g, β = gt/√(1 + (gt)²).
    let lamp = lamp(
        "position = [0, 0, 0]\nmotion.acceleration = { proper = \"0.5 /m\", direction = [1, 0, 0] }",
    );
    let path = |t: f64| {
        let root = (1.0 + 0.25 * t * t).sqrt();
        (DVec3::X * ((root - 1.0) / 0.5), DVec3::X * (0.5 * t / root))
    };
    for (t, x) in places() {
        // Beyond its horizon at t + x = −1/g no light of it comes.
        if t + x.x < -1.5 {
            continue;
        }
        let (got, expected) = (irradiance(&lamp, t, x), brute_force(path, t, x));
        assert!(
            (got - expected).abs() < 1e-8 * expected,
            "{t} {x}: {got} {expected}"
        );
    }
}

#[test]
fn a_train_is_seen_at_the_rate_of_the_doppler_effect() {
    // Pulses every metre of the lamp's time, which comes at 0.6 c: seen every (1 − 0.6) γ = ½ m.
    let lamp = lamp(
        "position = [0, 0, 0]\nvelocity = { beta = [0.6, 0, 0] }\n\
         emission.train = { sigma = \"2 cm\", period = \"1 m\" }",
    );
    let x = DVec3::X * 100.0;
    let at = |t: f64| {
        let d = Direction::<World>::new(DVec3::Z).unwrap();
        let ray = NullRay::new(Event::new(t + 1.0, x - DVec3::Z), d, 1.0);
        lamp.arrival(&ray, 1.0, 1.0).is_some()
    };
    // At rest with the lamp the pulse of τ = 0 is seen at t = 100, those of k at 100 + k/2.
    for k in -3..=3 {
        assert!(at(100.0 + 0.5 * f64::from(k)), "{k}");
        assert!(!at(100.25 + 0.5 * f64::from(k)), "{k}");
    }
}
