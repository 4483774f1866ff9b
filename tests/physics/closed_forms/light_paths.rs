//! Delay: where a moving object is seen, and at which time.

use glam::DVec3;
use nullray::spacetime::{Direction, Event, InertialFrame, NullRay, Rest, World};
use proptest::prelude::*;

use crate::closed_forms::sample::{EPS, config, direction, unit, velocity};

fn place() -> impl Strategy<Value = DVec3> {
    (unit(), 0.1..10.0f64).prop_map(|(n, r)| n * r)
}

fn event() -> impl Strategy<Value = Event<World>> {
    (-10.0..10.0f64, place()).prop_map(|(ct, x)| Event::new(ct, x))
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn a_moving_point_is_seen_where_the_quadratic_equation_says(
        v in velocity(3.0), origin in event(), camera in event(), rest in place(),
    ) {
        // A point at rest at X in the moving frame is at O_x + X∥/γ + X⊥ + β (t − O_t) in the world: at
        // the camera's time it is r₀ away from the camera. Light that left it τ earlier arrives now if
        // |r₀ − β τ| = τ, that is (1 − β²) τ² + 2 (r₀·β) τ − r₀² = 0:
        // τ = r₀² / (r₀·β + √((r₀·β)² + r₀²/γ²)), or γ² (√… − r₀·β), where that cancels less.
        let (n, beta, gamma) = (v.rapidity().normalize_or(DVec3::X), v.beta(), v.gamma());
        let contracted = rest + n * (n.dot(rest) * (1.0 / gamma - 1.0));
        let now = origin.x + contracted + beta * (camera.ct - origin.ct);
        let r = now - camera.x;
        let root = (r.dot(beta).powi(2) + r.length_squared() / (gamma * gamma)).sqrt();
        let delay = if r.dot(beta) > 0.0 {
            r.length_squared() / (r.dot(beta) + root)
        } else {
            (root - r.dot(beta)) * gamma * gamma
        };
        let seen = r - beta * delay;

        // Rounding moves an event by eps γ size, and a delay by γ² as much.
        let size = 50.0 * gamma;
        let allowed = 16.0 * EPS * gamma.powi(3) * size;

        // In the rest frame nothing moves: the light left when its distance says.
        let frame = InertialFrame::<Rest>::new(v, origin);
        let arrival = frame.event_from_world(camera);
        let emitted = Event::<Rest>::new(arrival.ct - (rest - arrival.x).length(), rest);
        let emission = frame.event_to_world(emitted);
        prop_assert!((camera.ct - emission.ct - delay).abs() <= allowed);
        prop_assert!((emission.x - camera.x - seen).length() <= allowed);

        // The ray of that direction meets the event, in both frames at the same parameter.
        let d = Direction::new(seen).unwrap();
        let hit = NullRay::new(camera, d, 1.0).at(delay) - emission;
        prop_assert!(hit.ct.abs() + hit.x.length() <= allowed);
        let hit = frame.ray_from_world(camera, d, 1.0).at(delay) - emitted;
        prop_assert!(hit.ct.abs() + hit.x.length() <= allowed);
    }

    #[test]
    fn a_light_path_passes_the_same_events_in_every_frame_and_medium(
        v in velocity(6.0), origin in event(), camera in event(),
        d in direction::<World>(), index in 0.0..3.0f64, s in 0.0..100.0f64,
    ) {
        let frame = InertialFrame::<Rest>::new(v, origin);
        let world = NullRay::new(camera, d, index).at(s);
        let path = frame.ray_from_world(camera, d, index).at(s);
        let error = path - frame.event_from_world(world);
        let size = v.gamma() * (50.0 + s * (1.0 + index));
        prop_assert!(error.ct.abs() + error.x.length() <= 256.0 * EPS * size);
        // η metres of time per metre of way, into the past.
        prop_assert!((camera.ct - world.ct - index * s).abs() <= 4.0 * EPS * size);
        prop_assert!(((world.x - camera.x).length() - s).abs() <= 4.0 * EPS * size);
    }
}
