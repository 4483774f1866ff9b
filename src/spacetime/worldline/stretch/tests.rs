use super::super::WorldLine;
use super::*;
use crate::spacetime::Velocity;

/// Events and look directions agree with those of the line's states, for any direction of acceleration.
#[test]
fn a_stretch_has_the_states_of_its_line() {
    let velocities = [
        DVec3::ZERO,
        DVec3::new(0.3, -0.2, 2.0),
        DVec3::new(0.0, 8.0, 0.0),
    ];
    let accelerations = [DVec3::ZERO, DVec3::Y * 0.1, DVec3::new(0.7, 0.1, -1.5)];
    let seen = [DVec3::X, -DVec3::Y, DVec3::new(0.48, -0.6, 0.64)];
    let zero = Event::new(0.5, DVec3::new(3.0, -1.0, 2.0));
    for w in velocities {
        let velocity = Velocity::from_rapidity(w).unwrap();
        for acceleration in accelerations {
            let line = WorldLine::hyperbolic(velocity, zero, acceleration).unwrap();
            let span = [-0.4, 1.9];
            let reference = line.state(-0.4).unwrap().event;
            let stretch = line.stretch(span, reference).unwrap();
            for k in 0..=40 {
                let t = span[0] + (span[1] - span[0]) * f64::from(k) / 40.0;
                let state = line.state(t).unwrap();
                let boost = state.frame().world_from_frame();
                // Rounding errors of states: eps times the largest coordinate, and times γ for directions.
                let gamma = state.velocity.gamma();
                for c in seen {
                    let c = Direction::new(c).unwrap();
                    let (d, ratio) = boost.direction(c);
                    let (moved, own, own_ratio) = stretch.nearest(t).look(t, c);
                    let away = moved - (state.event - reference);
                    let size = 1.0 + state.event.ct.abs() + reference.ct.abs();
                    assert!(
                        away.ct.abs() + away.x.length() < 1e-14 * size,
                        "{t}: {away:?}"
                    );
                    let magnified = 1e-15 * (10.0 + gamma / ratio + 1.0 / ratio);
                    assert!(
                        (own.unit() - d.unit()).length() < magnified,
                        "{t}: {own:?} {d:?}"
                    );
                    assert!(
                        (own_ratio / ratio - 1.0).abs() < 4.0 * magnified,
                        "{t}: {ratio}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_stretch_ends_where_the_acceleration_changes() {
    let segments = [(1.0, DVec3::X), (1.0, -DVec3::X)];
    let segments = segments.map(|(duration, acceleration)| super::super::Segment {
        duration,
        acceleration,
    });
    let line = WorldLine::segments(Velocity::REST, Event::ORIGIN, &segments).unwrap();
    assert!(line.stretch([0.1, 0.9], Event::ORIGIN).is_some());
    assert!(line.stretch([0.1, 1.1], Event::ORIGIN).is_none());
}
