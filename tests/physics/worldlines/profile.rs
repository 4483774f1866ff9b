//! Motion by a given proper acceleration.

use glam::{DVec3, DVec4};
use nullray::spacetime::worldline::{Axes, WorldLine};
use nullray::spacetime::{Event, Velocity};

use crate::worldlines::lines::{apart, event, four_velocity, rapidity, size};

#[test]
fn constant_acceleration_gives_the_hyperbola() {
    // Collinear with the velocity: boosted axes and axes carried along agree.
    let n = DVec3::new(-1.0, 2.0, 2.0) / 3.0;
    let zero = event(2.0, 1.0, 0.0, -3.0);
    for (start, g) in [(0.0, 1.0), (-2.0, 0.3), (1.5, 7.0), (0.0, 1e-9), (0.4, 0.0)] {
        let velocity = Velocity::from_rapidity_along(start, n).unwrap();
        let knots = [(-1.0, n * g), (0.5, n * g), (2.0, n * g)];
        let line = WorldLine::profile(velocity, zero, &knots, Axes::World).unwrap();
        let hyperbola = WorldLine::hyperbolic(velocity, zero, n * g).unwrap();
        for i in 0..=30 {
            let tau = -1.0 + 0.1 * f64::from(i);
            let (a, b) = (line.state(tau).unwrap(), hyperbola.state(tau).unwrap());
            assert!(
                apart(a.event, b.event) < 1e-14 * size(b.event).max(1.0),
                "g {g} at {tau}"
            );
            let error = (a.velocity.rapidity() - b.velocity.rapidity()).length();
            assert!(
                error < 1e-14 * (1.0 + b.velocity.rapidity().length()),
                "g {g} at {tau}: {error}"
            );
        }
    }
}

#[test]
fn along_a_line_the_rapidity_is_the_integral_of_the_acceleration() {
    // a = 1 − τ/2 from 0 to 4: φ = τ − τ²/4, back to 0; ct = ∫ cosh φ, x = ∫ sinh φ by Simpson's rule.
    let knots = [(0.0, DVec3::Z), (4.0, DVec3::NEG_Z)];
    let line = WorldLine::profile(Velocity::REST, Event::ORIGIN, &knots, Axes::World).unwrap();
    let phi = |tau: f64| tau - tau * tau / 4.0;
    for i in 0..=16 {
        let tau = 0.25 * f64::from(i);
        let state = line.state(tau).unwrap();
        let expected = DVec3::Z * phi(tau);
        assert!(
            (state.velocity.rapidity() - expected).length() < 4e-15,
            "at {tau}"
        );
        assert!((state.acceleration.z - (1.0 - 0.5 * tau)).abs() < 1e-15);
        let ct = simpson(|t| phi(t).cosh(), tau);
        let z = simpson(|t| phi(t).sinh(), tau);
        assert!((state.event.ct - ct).abs() < 1e-14 * (1.0 + ct), "at {tau}");
        assert!(
            (state.event.x - DVec3::Z * z).length() < 1e-14 * (1.0 + ct),
            "at {tau}"
        );
    }
}

/// ∫ f from 0 to `end` by Simpson's rule, 4,000 intervals: an error of 1e-15.
fn simpson(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    let count = 4000;
    let weight = |i| match i {
        0 => 1.0,
        _ if i == count => 1.0,
        _ if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let h = end / f64::from(count);
    (0..=count)
        .map(|i| weight(i) * f(h * f64::from(i)))
        .sum::<f64>()
        * h
        / 3.0
}

/// (U, x, ct) and its derivative with the acceleration `a`, as the world line's equations say.
type Motion = [f64; 7];

fn derivative(m: &Motion, a: DVec3) -> Motion {
    let u = DVec3::new(m[0], m[1], m[2]);
    let gamma = (1.0 + u.length_squared()).sqrt();
    let du = a + u * (u.dot(a) / (1.0 + gamma));
    [du.x, du.y, du.z, u.x, u.y, u.z, gamma]
}

/// Runge and Kutta's fourth order, `steps` steps from 0 to `end`, extrapolated from half as many.
fn runge_kutta(start: Motion, a: impl Fn(f64) -> DVec3, end: f64, steps: u32) -> Motion {
    let add =
        |m: &Motion, d: &Motion, h: f64| -> Motion { std::array::from_fn(|i| m[i] + h * d[i]) };
    let run = |steps: u32| {
        let h = end / f64::from(steps);
        let mut m = start;
        for step in 0..steps {
            let t = h * f64::from(step);
            let k1 = derivative(&m, a(t));
            let k2 = derivative(&add(&m, &k1, 0.5 * h), a(t + 0.5 * h));
            let k3 = derivative(&add(&m, &k2, 0.5 * h), a(t + 0.5 * h));
            let k4 = derivative(&add(&m, &k3, h), a(t + h));
            m = std::array::from_fn(|i| {
                m[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
            });
        }
        m
    };
    let (fine, coarse) = (run(steps), run(steps / 2));
    std::array::from_fn(|i| fine[i] + (fine[i] - coarse[i]) / 15.0)
}

#[test]
fn a_turning_acceleration_agrees_with_an_independent_integration_both_ways() {
    let (velocity, zero) = (rapidity(0.5, 1.0, -0.3), event(0.1, 0.2, 0.3, 0.4));
    let (a0, a1) = (DVec3::new(1.0, -2.0, 0.5), DVec3::new(-1.5, 0.5, 2.0));
    let knots = [(-1.0, a0 - (a1 - a0) / 2.0), (0.0, a0), (2.0, a1)];
    let line = WorldLine::profile(velocity, zero, &knots, Axes::World).unwrap();
    let (gamma, u) = (velocity.gamma(), velocity.beta() * velocity.gamma());
    assert!(gamma > 1.5);
    let start = [u.x, u.y, u.z, zero.x.x, zero.x.y, zero.x.z, zero.ct];
    for tau in [-1.0, -0.4, 0.7, 2.0] {
        let m = runge_kutta(start, |t| a0 + (a1 - a0) * (0.5 * t), tau, 4000);
        let state = line.state(tau).unwrap();
        let (gamma, proper) = four_velocity(&state);
        let error = (proper - DVec3::new(m[0], m[1], m[2])).length();
        assert!(error < 1e-12 * gamma, "at {tau}: {error}");
        let reached = event(m[6], m[3], m[4], m[5]);
        assert!(
            apart(state.event, reached) < 1e-12 * size(reached).max(1.0),
            "at {tau}"
        );
    }
}

#[test]
fn events_and_velocities_are_continuous_across_knots_and_steps() {
    // Strong enough for many steps between knots.
    let knots: Vec<(f64, DVec3)> = (0..9)
        .map(|i| {
            (
                f64::from(i),
                DVec3::new(9.0, 5.0, -6.0) * if i % 2 == 0 { 1.0 } else { -1.0 },
            )
        })
        .collect();
    let line = WorldLine::profile(Velocity::REST, Event::ORIGIN, &knots, Axes::World).unwrap();
    let mut before = line.state(0.0).unwrap();
    for i in 1..=80_000 {
        let tau = 1e-4 * f64::from(i);
        let state = line.state(tau.min(8.0)).unwrap();
        let (gamma, u) = four_velocity(&before);
        let moved = state.event - before.event;
        // To second order: |a| h²/2 γ.
        let allowed = 1e-8 * 15.0 * gamma;
        assert!((moved.x - u * 1e-4).length() < allowed, "at {tau}");
        assert!((moved.ct - gamma * 1e-4).abs() < allowed, "at {tau}");
        before = state;
    }
}

#[test]
fn proper_time_zero_has_the_given_state_wherever_it_is_among_the_knots() {
    let (velocity, zero) = (rapidity(0.1, 0.2, -0.9), event(5.0, 6.0, 7.0, 8.0));
    for shift in [0.0, 0.3, 1.0, 1.7, 2.0] {
        let knots = [0.0, 1.0, 2.0].map(|t| (t - shift, DVec3::new(0.3, t, 0.2)));
        let line = WorldLine::profile(velocity, zero, &knots, Axes::World).unwrap();
        let state = line.state(0.0).unwrap();
        assert_eq!(state.event, zero, "{shift}");
        assert!((state.velocity.rapidity() - velocity.rapidity()).length() < 1e-15);
        assert!((state.acceleration - DVec3::new(0.3, shift, 0.2)).length() < 1e-15);
        assert_eq!(line.span(), [-shift, 2.0 - shift]);
    }
}

#[test]
fn a_hundred_thousand_knots_are_followed_without_loss() {
    // Back and forth by 1e-3 each time, from rest: at rest again after every second pair.
    let knots: Vec<(f64, DVec3)> = (0..100_000)
        .map(|i| {
            (
                f64::from(i) * 1e-3,
                DVec3::X * if i % 2 == 0 { 1.0 } else { -1.0 },
            )
        })
        .collect();
    let line = WorldLine::profile(Velocity::REST, Event::ORIGIN, &knots, Axes::World).unwrap();
    let state = line.state(99.998).unwrap();
    assert!(state.velocity.rapidity().length() < 1e-12);
    // Rapidity ≤ 2.5e-4 between: ct − τ = ½ ∫φ², φ = 1e-3 (u − u²) over a span, u from 0 to 1: ½ 1e-6/30.
    assert!(
        (state.event.ct - 99.998 - 99.998 * 0.5e-6 / 30.0).abs() < 1e-10,
        "{}",
        state.event.ct
    );
}

#[test]
fn constant_acceleration_oblique_to_the_velocity_gives_the_hyperbola_in_the_axes_of_a_gyroscope() {
    let a = DVec3::new(-0.4, 1.1, 0.6);
    let (velocity, zero) = (rapidity(0.9, 0.2, -0.7), event(2.0, 1.0, 0.0, -3.0));
    let knots = [(-1.0, a), (0.5, a), (2.0, a)];
    let line = WorldLine::profile(velocity, zero, &knots, Axes::Gyroscope).unwrap();
    let hyperbola = WorldLine::hyperbolic(velocity, zero, a).unwrap();
    for i in 0..=30 {
        let tau = -1.0 + 0.1 * f64::from(i);
        let (a, b) = (line.state(tau).unwrap(), hyperbola.state(tau).unwrap());
        let allowed = 4e-14 * size(b.event).max(1.0);
        let error = apart(a.event, b.event);
        assert!(error < allowed, "at {tau}: {error}");
        let error = (a.velocity.rapidity() - b.velocity.rapidity()).length();
        assert!(
            error < 4e-14 * (1.0 + b.velocity.rapidity().length()),
            "at {tau}: {error}"
        );
        // The second derivative of a series of order 24 loses two digits.
        let error = (a.acceleration - b.acceleration).length();
        assert!(error < 1e-12, "at {tau}: {error}");
    }
}

/// The four-velocity and three axes at right angles to it, (x, y, z, ct) each, after carrying them by `steps` equal boosts
/// within their own frame, by a(τ) dτ each: Λ ← Λ exp(K a dτ), to second order by the midpoint.
fn carried(u: DVec3, a: impl Fn(f64) -> DVec3, end: f64, steps: u32) -> [DVec4; 4] {
    let gamma = (1.0 + u.length_squared()).sqrt();
    // The boosted axes: eᵢ + U Uᵢ/(1 + γ), and time component Uᵢ.
    let axis = |i: usize| (DVec3::AXES[i] + u * (u[i] / (1.0 + gamma))).extend(u[i]);
    let mut tetrad = [u.extend(gamma), axis(0), axis(1), axis(2)];
    let h = end / f64::from(steps);
    for step in 0..steps {
        let w = a(h * (f64::from(step) + 0.5)) * h;
        let (n, phi) = (w.normalize(), w.length());
        let [time, x, y, z] = tetrad;
        let along = x * n.x + y * n.y + z * n.z;
        // The boost in the plane of the four-velocity and the acceleration.
        let (rise, sinh) = (phi.cosh() - 1.0, phi.sinh());
        let moved = |e: DVec4, component: f64| e + (along * rise + time * sinh) * component;
        tetrad = [
            time + time * rise + along * sinh,
            moved(x, n.x),
            moved(y, n.y),
            moved(z, n.z),
        ];
    }
    tetrad
}

#[test]
fn a_turning_acceleration_in_the_axes_of_a_gyroscope_agrees_with_boosts_in_a_row() {
    let velocity = rapidity(0.5, 1.0, -0.3);
    let (a0, a1) = (DVec3::new(1.0, -2.0, 0.5), DVec3::new(-1.5, 0.5, 2.0));
    // A knot on the way, so that the axes are handed on.
    let a = |t: f64| a0 + (a1 - a0) * (0.5 * t);
    let knots = [-1.0, 0.0, 0.8, 2.0].map(|t| (t, a(t)));
    let line = WorldLine::profile(velocity, Event::ORIGIN, &knots, Axes::Gyroscope).unwrap();
    let u = velocity.beta() * velocity.gamma();
    for tau in [-1.0, 0.7, 2.0] {
        // Extrapolated from half as many steps: an error of h⁴.
        let (fine, coarse) = (carried(u, a, tau, 8000), carried(u, a, tau, 4000));
        let tetrad: [DVec4; 4] = std::array::from_fn(|i| fine[i] + (fine[i] - coarse[i]) / 3.0);
        let state = line.state(tau).unwrap();
        let (gamma, proper) = four_velocity(&state);
        let error = (proper.extend(gamma) - tetrad[0]).length();
        assert!(error < 1e-11 * gamma, "at {tau}: {error}");
        // The proper acceleration as a four-vector: Σ aᵢ eᵢ, and that of the state in the boosted axes.
        let own = a(tau);
        let expected = tetrad[1] * own.x + tetrad[2] * own.y + tetrad[3] * own.z;
        let time = state.acceleration.dot(proper);
        let got = (state.acceleration + proper * (time / (1.0 + gamma))).extend(time);
        let error = (got - expected).length();
        assert!(error < 1e-10 * gamma, "at {tau}: {error}");
    }
}
