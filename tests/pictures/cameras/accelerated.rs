//! Cameras that accelerate, against closed forms.

use glam::DVec3;
use nullray::camera::{Camera, ViewKind};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::model::{Assembly, Motion, Records, Scene, Shutter};
use nullray::spacetime::worldline::{Segment, WorldLine};
use nullray::spacetime::{Displacement, Event, Velocity, paper2015};

use super::bench_camera::{looking_along_z, scene, sensor, start};

/// On the axis of a camera that accelerates forwards as a rigid body: with light-cone coordinates about
/// the pinhole's event, t + x = −f stays along the light, and the pinhole's hyperbola has
/// t − x = (t + x)/(1 + g (t + x)) there, so that the light was under way for (f + f/(1 − gf))/2.
#[test]
fn light_takes_longer_to_the_sensor_of_a_rigid_camera_that_accelerates_away_from_it() {
    let (g, f) = (0.7, 0.6);
    for speed in [0.0, 0.9, -0.6] {
        let mut scene = looking_along_z();
        scene.camera.velocity = Velocity::from_beta(DVec3::Z * speed).unwrap();
        scene.camera.motion = Motion::Accelerated(DVec3::Z * g);
        scene.camera.sensor = sensor(f, Assembly::Rigid);
        let camera = Camera::new(&scene).unwrap();
        let from = camera.view.ray(1.0, 1.0, 0.0).origin.displacement;
        let own = camera.shot.frame.frame_from_world().displacement(from);
        let expected = -0.5 * (f + f / (1.0 - g * f));
        // What is left of the sensor's light cone when it meets the pinhole: no way across.
        assert!((own.ct - expected).abs() < 2e-15, "{} {expected}", own.ct);
        assert!((own.x.z - (-expected - f)).abs() < 2e-15);
    }
}

/// The acceleration of a sensor at distance f behind is g/(1 − gf): at gf = 1 it lies on the horizon.
#[test]
fn a_sensor_behind_the_horizon_of_its_pinhole_is_refused() {
    let mut scene = looking_along_z();
    scene.camera.motion = Motion::Accelerated(DVec3::Z);
    scene.camera.sensor = sensor(0.999, Assembly::Rigid);
    assert!(Camera::new(&scene).is_ok());
    scene.camera.sensor = sensor(1.001, Assembly::Rigid);
    let error = Camera::new(&scene).unwrap_err().to_string();
    assert!(error.contains("world line"), "{error}");
}

#[test]
fn bells_ships_drift_apart_by_the_corrected_form_of_equation_16() {
    for (g, d, tau) in [(0.2, 0.5, 1.0), (1.3, 0.1, 2.5), (0.01, 3.0, 40.0)] {
        let accelerating = |at: f64| {
            WorldLine::hyperbolic(Velocity::REST, Event::new(0.0, DVec3::Z * at), DVec3::Z * g)
        };
        let (sensor, pinhole) = (accelerating(0.0).unwrap(), accelerating(d).unwrap());
        let here = sensor.state(tau).unwrap();
        // Where the pinhole is at the sensor's own time: bisection over the pinhole's proper time.
        let there = |t: f64| {
            let event = pinhole.state(t).unwrap().event;
            here.frame().event_from_world(event)
        };
        let (mut low, mut high) = (0.0, 2.0 * tau + 10.0 * d);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if there(middle).ct < 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        let beta = here.velocity.beta().z;
        let corrected = paper2015::comoving_separation(-g, d, beta);
        let apart = there(low).x.z;
        assert!(
            (apart / corrected - 1.0).abs() < 1e-12,
            "{apart} {corrected}"
        );
        // The form with the other sign is that of a sensor ahead of its pinhole.
        let other = paper2015::comoving_separation(g, d, beta);
        assert!((apart - other).abs() > 1e-4 * d);
    }
}

/// A lattice in a pulse, small and dull.
fn lit() -> Scene {
    let text = "\
camera = { eye = [0.3, 0.2, 6], look_at = [0, 0, 0], size = [24, 16], clock_zero = \"12 m\" }
object = [{ shape = { lattice = { cells = [2, 2, 2], spacing = 1, bar = 0.3 } }, transform = { translate = [-1, -1, -1] } }]
source = [{ pulse = { position = [3, 4, 3], sigma = \"2 m\", intensity = 9 } }]
";
    nullray::scene::parse(text, "lit", "".as_ref(), &Default::default()).unwrap()
}

fn picture(scene: &Scene) -> Vec<[f64; 3]> {
    let plan = Plan::new(scene, &Request::default()).unwrap();
    let prepared = Prepared::new(scene, &plan, &Silent).unwrap();
    render(&prepared, &Silent).unwrap().radiance().to_vec()
}

#[test]
fn a_camera_that_brakes_to_rest_sees_the_static_image() {
    let still = lit();
    let expected = picture(&still);
    assert!(expected.iter().any(|rgb| rgb[0] > 0.0));
    // From rapidity −2 along z to rest at g = 0.5 in 4 m of proper time, arriving where the other stands.
    let (g, phi) = (0.5, 2.0f64);
    let mut braking = still.clone();
    let way = DVec3::NEG_Z * ((phi.cosh() - 1.0) / g);
    braking.camera.origin.x -= way;
    braking.camera.origin.ct -= phi.sinh() / g;
    braking.camera.velocity = Velocity::from_rapidity(DVec3::NEG_Z * phi).unwrap();
    braking.camera.motion = Motion::Segments(vec![Segment {
        duration: phi / g,
        acceleration: DVec3::Z * g,
    }]);
    braking.camera.time = phi / g;
    let moving_before = {
        let mut scene = braking.clone();
        scene.camera.time = 0.0;
        picture(&scene)
    };
    assert_ne!(moving_before, expected);
    for (got, expected) in picture(&braking).iter().zip(&expected) {
        for (got, expected) in got.iter().zip(expected) {
            assert!(
                (got - expected).abs() <= 1e-12 * (1.0 + expected),
                "{got} {expected}"
            );
        }
    }
}

#[test]
fn an_exposure_under_acceleration_begins_with_the_instant_and_follows_the_world_line() {
    let mut scene = scene();
    scene.camera.motion = start(DVec3::new(0.1, 0.0, -0.4));
    scene.camera.time = 1.0;
    scene.camera.shutter = Some(Shutter {
        duration: 2.0,
        records: Records::Mean,
        integration: Default::default(),
    });
    let camera = Camera::new(&scene).unwrap();
    assert_eq!(camera.view.kind(), ViewKind::Accelerated);
    let line = scene.camera.world_line().unwrap();
    for moment in [0.0, 0.25, 1.0] {
        let ray = camera.view.ray(0.4, 1.7, moment);
        let mut instant = scene.clone();
        instant.camera.shutter = None;
        instant.camera.time = 1.0 + 2.0 * moment;
        let then = Camera::new(&instant).unwrap();
        let expected = then.view.ray(0.4, 1.7, 0.0);
        assert!((ray.d.unit() - expected.d.unit()).length() < 1e-15);
        assert!((ray.ratio - expected.ratio).abs() < 1e-15);
        let state = line.state(instant.camera.time).unwrap();
        let gone: Displacement<_> = state.event - camera.shot.event;
        // Series from another event of the line: right to a few roundings, and where it begins to the last digit.
        let off = ray.origin.displacement - gone;
        let bound = if moment == 0.0 { 0.0 } else { 1e-15 };
        assert!(off.ct.abs().max(off.x.length()) <= bound, "{off:?}");
    }
}
