//! The closed form around a state agrees with the general one.

use glam::DVec3;
use nullray::spacetime::worldline::{Segment, WorldLine};
use nullray::spacetime::{Displacement, Event, Velocity};

/// Numbers in [−1, 1).
fn random(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1);
    (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn vector(state: &mut u64) -> DVec3 {
    DVec3::new(random(state), random(state), random(state))
}

#[test]
fn around_a_state_the_crossing_is_that_of_the_whole_line() {
    let mut seed = 7;
    let mut met = 0;
    for i in 0..2000 {
        let velocity = Velocity::from_rapidity(vector(&mut seed) * 1.5).unwrap();
        let acceleration = vector(&mut seed) * 10f64.powi(i % 9 - 8);
        let zero = Event::new(random(&mut seed), vector(&mut seed));
        let line = WorldLine::hyperbolic(velocity, zero, acceleration).unwrap();
        let near = line.state(random(&mut seed)).unwrap();
        let vicinity = line.vicinity(&near).unwrap();
        // At the state's own time, and at the world's.
        let x = vector(&mut seed) * 10f64.powi(i % 5 - 2);
        for offset in [
            near.frame()
                .world_from_frame()
                .displacement(Displacement::new(0.0, x)),
            Displacement::new(0.0, x),
        ] {
            let apex = near.frame().frame_from_world().displacement(offset);
            let near_by = vicinity.crossing(apex, x.length_squared());
            let general = line.on_past_light_cone(&near, offset);
            assert_eq!(near_by.is_some(), general.is_some());
            let (Some(near_by), Some(general)) = (near_by, general) else {
                continue;
            };
            let got = vicinity.in_world(near_by);
            let scale = general.displacement.ct.abs() + x.length();
            assert!(
                (got.ct - general.displacement.ct).abs() < 1e-12 * scale,
                "{i}"
            );
            assert!(
                (got.x - general.displacement.x).length() < 1e-12 * scale,
                "{i}"
            );
            met += 1;
        }
    }
    assert!(met > 3000, "{met}");
}

#[test]
fn before_the_acceleration_changed_nothing_is_claimed() {
    let segment = Segment {
        duration: 2.0,
        acceleration: DVec3::X,
    };
    let line = WorldLine::segments(Velocity::REST, Event::ORIGIN, &[segment]).unwrap();
    let near = line.state(0.5).unwrap();
    let vicinity = line.vicinity(&near).unwrap();
    let crossing = |x: f64| vicinity.crossing(Displacement::new(0.0, DVec3::Y * x), x * x);
    // The world line was at rest until (0, 0); the light cone from the side reaches back that far.
    assert!(crossing(0.4).is_some());
    assert!(crossing(0.6).is_none());
}
