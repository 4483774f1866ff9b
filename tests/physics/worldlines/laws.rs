//! Laws of every world line: |u| = 1, u·a = 0, u = dx/dτ, du/dτ = a; crossings are null, in the past, and on the line.

use glam::DVec3;
use nullray::spacetime::worldline::{State, WorldLine};
use nullray::spacetime::{CameraFrame, Displacement, World};

use crate::common::worst::{EPS, Worst};
use crate::worldlines::lines::{Sequence, apart, every_kind, four_velocity, largest, length, size};

/// Proper times of a line, those of corners among them, but not its ends.
fn times(range: [f64; 2]) -> impl Iterator<Item = f64> {
    let [from, to] = range;
    (1..60).map(move |i| from + (to - from) * f64::from(i) / 60.0)
}

/// Proper times of a line, away from its corners.
fn smooth_times(range: [f64; 2]) -> impl Iterator<Item = f64> {
    let shift = (range[1] - range[0]) / 200.0;
    times(range).map(move |tau| tau - shift)
}

/// f′ at `t` by Richardson's extrapolation of central differences, with step `h`.
fn derivative(f: impl Fn(f64) -> DVec3, t: f64, h: f64) -> DVec3 {
    let central = |h: f64| (f(t + h) - f(t - h)) / (2.0 * h);
    (central(h) * 4.0 - central(2.0 * h)) / 3.0
}

fn at(line: &WorldLine, tau: f64) -> State {
    line.state(tau).unwrap()
}

#[test]
fn the_four_velocity_is_the_derivative_of_the_event() {
    // Steps of 1e-3: errors of h⁴ ≈ 1e-12 times the fifth derivative, and of eps/h ≈ 1e-13 of the position.
    for (name, line, range) in every_kind() {
        for tau in smooth_times(range) {
            let (gamma, proper) = four_velocity(&at(&line, tau));
            let u = derivative(|t| at(&line, t).event.x, tau, 1e-3);
            let rate = derivative(|t| DVec3::X * at(&line, t).event.ct, tau, 1e-3).x;
            assert!(
                (u - proper).length() < 1e-8 * gamma,
                "{name} at {tau}: {u} {proper}"
            );
            assert!(
                (rate - gamma).abs() < 1e-8 * gamma,
                "{name} at {tau}: {rate} {gamma}"
            );
        }
    }
}

#[test]
fn the_proper_acceleration_is_the_derivative_of_the_four_velocity() {
    // In the comoving axes (0, a), in the world's (U·a, a + (U·a) U/(1 + γ)).
    for (name, line, range) in every_kind() {
        for tau in smooth_times(range) {
            let state = at(&line, tau);
            let (gamma, proper) = four_velocity(&state);
            let power = proper.dot(state.acceleration);
            let expected = state.acceleration + proper * (power / (1.0 + gamma));
            let got = derivative(|t| four_velocity(&at(&line, t)).1, tau, 1e-4);
            let rate = derivative(|t| DVec3::X * four_velocity(&at(&line, t)).0, tau, 1e-4).x;
            let allowed = 1e-6 * gamma;
            assert!(
                (got - expected).length() < allowed,
                "{name} at {tau}: {got} {expected}"
            );
            assert!(
                (rate - power).abs() < allowed,
                "{name} at {tau}: {rate} {power}"
            );
        }
    }
}

#[test]
fn four_velocities_have_unit_length_and_proper_accelerations_are_across_them() {
    for (name, line, range) in every_kind() {
        for tau in times(range) {
            let state = at(&line, tau);
            let boost = state.frame().world_from_frame();
            let u = boost.displacement(Displacement::<CameraFrame>::new(1.0, DVec3::ZERO));
            let a = boost.displacement(Displacement::<CameraFrame>::new(0.0, state.acceleration));
            let scale = u.ct * u.ct;
            assert!(
                (u.interval() - 1.0).abs() < 16.0 * EPS * scale,
                "{name} at {tau}"
            );
            let product = u.ct * a.ct - u.x.dot(a.x);
            assert!(
                product.abs() < 16.0 * EPS * scale * a.x.length().max(1e-9),
                "{name} at {tau}"
            );
            let (gamma, proper) = four_velocity(&state);
            assert!(
                (u.x - proper).length() < 16.0 * EPS * gamma,
                "{name} at {tau}"
            );
            assert_eq!(state.frame().origin(), state.event);
        }
    }
}

/// Events about a state, near and far.
fn offsets(sequence: &mut Sequence) -> Displacement<World> {
    let x = sequence.unit() * sequence.scale(1e-6, 2.0);
    Displacement::new((2.0 * sequence.next() - 1.0) * x.length(), x)
}

#[test]
fn crossings_are_null_in_the_past_and_on_the_line() {
    let [mut null, mut on_line] = std::array::from_fn(|_| Worst::default());
    let mut sequence = Sequence(7);
    for (name, line, range) in every_kind() {
        let mut met = 0;
        for tau in times(range).flat_map(|tau| [tau; 20]) {
            let (near, offset) = (at(&line, tau), offsets(&mut sequence));
            let Some(crossing) = line.on_past_light_cone(&near, offset) else {
                continue;
            };
            met += 1;
            let moved = crossing.displacement;
            let path = Displacement::<World>::new(offset.ct - moved.ct, offset.x - moved.x);
            assert!(path.ct >= 0.0, "{name} at {tau}, {offset:?}: {moved:?}");
            let gamma = near.velocity.gamma();
            let scale = length(offset).max(length(moved));
            let label = || format!("{name} at {tau}, {offset:?}");
            null.note(
                path.ct - path.x.length(),
                16.0 * EPS * gamma * gamma * scale,
                label,
            );
            let state = at(&line, crossing.proper_time());
            let scale = size(state.event).max(size(near.event)).max(1.0);
            on_line.note(
                apart(crossing.event, state.event),
                256.0 * EPS * gamma * gamma * scale,
                label,
            );
        }
        assert!(met > 600, "{name}: {met}");
    }
    null.assert_within("interval");
    on_line.assert_within("distance from the line");
}

#[test]
fn the_crossing_does_not_depend_on_the_state_it_is_counted_from() {
    let mut worst = Worst::default();
    let mut sequence = Sequence(8);
    for (name, line, range) in every_kind() {
        for tau in times(range) {
            let near = at(&line, tau);
            let offset = offsets(&mut sequence);
            let apex = near.event + offset;
            let general = line.on_past_light_cone_of(apex);
            for other in times(range).step_by(7) {
                let other = at(&line, other);
                let crossing = line.on_past_light_cone(&other, apex - other.event);
                assert_eq!(crossing.is_some(), general.is_some(), "{name} at {tau}");
                let (Some(a), Some(b)) = (crossing, general) else {
                    continue;
                };
                let scale = size(apex).max(size(a.event)).max(size(other.event));
                let gamma = other.velocity.gamma().max(near.velocity.gamma());
                let label = || format!("{name} at {tau}, {offset:?}, from {}", other.proper_time);
                let allowed = 256.0 * EPS * gamma * gamma * scale;
                worst.note(apart(a.event, b.event), allowed, label);
                worst.note(a.proper_time() - b.proper_time(), allowed, label);
                // From the apex to the crossing.
                worst.note(apart(apex + b.displacement, b.event), allowed, label);
            }
        }
    }
    worst.assert_within("event");
}

#[test]
fn small_offsets_keep_their_digits_on_every_line() {
    // To first order in the offset the line is straight: y = T′ − R′ in the comoving frame.
    let mut sequence = Sequence(9);
    for (name, line, range) in every_kind() {
        for tau in times(range) {
            let near = at(&line, tau);
            let offset = Displacement::new(0.0, sequence.unit() * 1e-9);
            let own = near.frame().frame_from_world().displacement(offset);
            let y = own.ct - own.x.length();
            let crossing = line.on_past_light_cone(&near, offset).unwrap();
            let straight = near
                .frame()
                .world_from_frame()
                .displacement(Displacement::new(y, DVec3::ZERO));
            let error = (crossing.displacement.x - straight.x).length();
            assert!(error < 1e-7 * y.abs(), "{name} at {tau}: {error}");
            // d from the light's path: its digits are those of 1e-9, not of the coordinates.
            let path = offset.x - crossing.displacement.x;
            let null = crossing.displacement.ct + path.length();
            assert!(
                null.abs() < 64.0 * EPS * 1e-9 * near.velocity.gamma(),
                "{name} at {tau}: {null}"
            );
            assert!(largest(crossing.displacement.x) < 1e-7);
        }
    }
}

#[test]
fn nothing_is_seen_of_a_line_before_it_begins_or_after_it_ends() {
    for (name, line, _) in every_kind() {
        let [first, last] = line.span();
        if first.is_infinite() {
            continue;
        }
        let (begin, end) = (at(&line, first), at(&line, last));
        assert!(line.state(first - 1e-9).is_none() && line.state(last + 1e-9).is_none());
        let seen = |event| line.on_past_light_cone_of(event).map(|c| c.proper_time());
        let later = |d: f64| Displacement::new(d, DVec3::ZERO);
        assert_eq!(seen(begin.event + later(-1e-6)), None, "{name}");
        assert_eq!(seen(end.event + later(1e-6)), None, "{name}");
        assert_eq!(
            seen(begin.event + Displacement::new(0.5, DVec3::X)),
            None,
            "{name}"
        );
        assert!(
            seen(begin.event).is_some_and(|tau| (tau - first).abs() < 1e-14),
            "{name}"
        );
        assert!(
            seen(end.event).is_some_and(|tau| (tau - last).abs() < 1e-14),
            "{name}"
        );
        let offset = Displacement::new(-10.0, DVec3::ZERO);
        assert!(line.on_past_light_cone(&end, offset).is_none(), "{name}");
    }
}
