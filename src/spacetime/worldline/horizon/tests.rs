use super::*;
use crate::spacetime::worldline::{Axes, Segment, WorldLine};
use crate::spacetime::{Event, Velocity};

fn lines() -> Vec<(WorldLine, f64)> {
    let event = |ct: f64, x: f64, y: f64, z: f64| Event::new(ct, DVec3::new(x, y, z));
    let events = [
        event(0.0, 0.0, 0.0, 0.0),
        event(1.0, 0.3, -0.4, 0.5),
        event(1.7, 0.1, 0.0, 0.7),
        event(3.0, -0.4, 0.6, 0.2),
    ];
    let ways = events.windows(2).map(|e| e[1] - e[0]);
    let ways: Vec<DVec3> = ways.map(|way| way.x / way.ct).collect();
    let at = |k: usize| [ways[k.max(1) - 1], ways[k.min(ways.len() - 1)]];
    let velocities: Vec<_> = (0..events.len()).map(at).collect();
    let velocity = Velocity::from_beta(DVec3::new(0.4, -0.3, 0.6)).unwrap();
    let zero = event(0.5, 1.0, 0.0, 0.0);
    let (a, b) = (DVec3::new(0.9, 0.2, -0.5), DVec3::new(-0.3, 1.4, 0.8));
    let segment = |duration, acceleration| Segment {
        duration,
        acceleration,
    };
    let segments = [segment(1.0, a), segment(1.5, b)];
    let knots = [(0.0, a), (1.0, b), (3.0, a)];
    let profile = |axes| WorldLine::profile(velocity, zero, &knots, axes).unwrap();
    let circle = WorldLine::circular(zero, DVec3::new(0.2, 0.1, 0.0), DVec3::Z, -0.9);
    vec![
        (WorldLine::keyframes(&events).unwrap(), 1.5),
        (WorldLine::animation(&events, &velocities).unwrap(), 4.0),
        (WorldLine::segments(velocity, zero, &segments).unwrap(), 3.0),
        (profile(Axes::Gyroscope), 2.9),
        (profile(Axes::World), 2.9),
        (circle.clone().unwrap(), 5.0),
        (circle.unwrap(), 1.0),
    ]
}

/// However near to the horizon, and however long.
#[test]
fn the_horizon_of_circles_and_of_constant_acceleration_is_found_from_closed_forms() {
    let circle = WorldLine::circular(Event::new(0.0, DVec3::X * 0.5), DVec3::ZERO, DVec3::Z, 1.0);
    // γ² Ω² R = ½/(1 − ¼); in all directions of the plane, and not across it.
    let circle = circle.unwrap();
    for (angle, up) in [(0.1, 0.0), (2.0, 1e9), (4.0, -3.0)] {
        let found = |reach: f64| {
            let (sin, cos) = libm::sincos(angle);
            let point = DVec3::new(reach * cos, reach * sin, up);
            circle.beyond_horizon([7.0, 3e9], &[point]).is_some()
        };
        assert!(!found(1.5 - 1e-12) && found(1.5 + 1e-12), "{angle}");
    }
    let segment = Segment {
        duration: 20.0,
        acceleration: DVec3::Z * 0.5,
    };
    let zero = Event::new(0.0, DVec3::ZERO);
    let line = WorldLine::segments(Velocity::REST, zero, &[segment]).unwrap();
    let found = |reach: f64| line.beyond_horizon([-9.0, 10.0], &[DVec3::NEG_Z * reach]);
    assert_eq!(
        [found(2.0 - 1e-12), found(2.0)],
        [None, Some(DVec3::Z * 0.5)]
    );
}

#[test]
fn what_is_not_settled_within_a_bounded_effort_counts_as_beyond_the_horizon() {
    let count = std::cell::Cell::new(0);
    let near = DVec3::Z * (1.0 - 1e-9);
    let around = |_, half| {
        count.set(count.get() + 1);
        let (acceleration, radius) = (near, half);
        Some(Around {
            acceleration,
            radius,
        })
    };
    let found = |reach: f64| {
        let points = [DVec3::NEG_Z * reach];
        beyond([0.0, 1.0], [0.3, 0.7].into_iter(), &points, around)
    };
    assert_eq!([found(0.999), found(1.0)], [None, Some(near)]);
    assert!(count.get() < 2 * MOST_HALVES, "{}", count.get());
}

/// At the reciprocal of the strongest pull in a direction, found among many states, the horizon is just not reached or just reached.
#[test]
fn the_horizon_is_found_at_the_strongest_pull_of_a_dense_sample() {
    let directions = [
        DVec3::X,
        DVec3::new(-0.6, 0.0, 0.8),
        DVec3::new(0.48, -0.6, -0.64),
        DVec3::NEG_Y,
    ];
    for (which, (line, end)) in lines().into_iter().enumerate() {
        // Fine enough for the ends of an animation's corners, which take a fiftieth of a metre.
        let count = 400_000;
        let state = |i: i32| line.state(end * f64::from(i) / f64::from(count)).unwrap();
        let accelerations: Vec<DVec3> = (0..=count).map(|i| state(i).acceleration).collect();
        for n in directions {
            let pulls = accelerations.iter().map(|a| a.dot(-n));
            let strongest = pulls.fold(0.0, f64::max);
            if strongest == 0.0 {
                continue;
            }
            let found = |reach: f64| {
                let points = [n * (reach / strongest), n * (0.5 * reach / strongest)];
                line.beyond_horizon([0.0, end], &points)
            };
            assert_eq!(found(0.999), None, "line {which}, {n}");
            let a = found(1.001).unwrap();
            assert!(a.dot(-n) >= 0.998 * strongest, "line {which}, {n}");
        }
    }
}
