//! Agreement of different kinds of world lines, and limits.

use glam::DVec3;
use nullray::spacetime::worldline::{Segment, WorldLine};
use nullray::spacetime::{Displacement, Event, Velocity, World};

use crate::common::exact::{exact, rounded};
use crate::worldlines::lines::{apart, event, rapidity, segment, size};

fn offset() -> Displacement<World> {
    Displacement::new(0.2, DVec3::new(-0.7, 0.5, 0.3))
}

/// Asserts equal events, velocities and crossings, relative to the coordinates.
fn assert_equal(a: &WorldLine, b: &WorldLine, tau: f64, tolerance: f64) {
    let (p, q) = (a.state(tau).unwrap(), b.state(tau).unwrap());
    let scale = size(p.event).max(1.0);
    assert!(
        apart(p.event, q.event) <= tolerance * scale,
        "{:?} {:?}",
        p.event,
        q.event
    );
    let turned = (p.velocity.rapidity() - q.velocity.rapidity()).length();
    assert!(
        turned <= 2.0 * tolerance * (1.0 + tau.abs()),
        "at {tau}: {turned}"
    );
    let (p, q) = (
        a.on_past_light_cone(&p, offset()),
        b.on_past_light_cone(&q, offset()),
    );
    assert_eq!(p.is_some(), q.is_some(), "at {tau}");
    if let (Some(p), Some(q)) = (p, q) {
        assert!(
            apart(p.event, q.event) <= 64.0 * tolerance * scale,
            "{:?} {:?}",
            p.event,
            q.event
        );
        assert!((p.proper_time() - q.proper_time()).abs() <= 64.0 * tolerance * (1.0 + tau.abs()));
    }
}

#[test]
fn a_hyperbola_becomes_a_straight_line_as_the_acceleration_vanishes() {
    let (velocity, zero) = (rapidity(0.6, -0.3, 0.8), event(1.0, 2.0, 3.0, 4.0));
    let straight = WorldLine::inertial(velocity, zero);
    for g in [1e-300, 1e-100, 1e-17, 1e-12, 1e-8, 0.0] {
        let a = DVec3::new(g, -0.5 * g, 2.0 * g);
        let line = WorldLine::hyperbolic(velocity, zero, a).unwrap();
        for tau in [-3.0, -1e-9, 0.0, 0.7, 2.0] {
            // ½ g τ² and less.
            assert_equal(&line, &straight, tau, 40.0 * g + 2e-15);
        }
        assert_eq!(line.frame().is_some(), g == 0.0);
    }
    assert_eq!(straight.frame().unwrap().origin(), zero);
    assert_eq!(straight.frame().unwrap().velocity(), velocity);
}

#[test]
fn a_circle_becomes_a_straight_line_as_its_radius_grows() {
    // Speed 0.6 along −y at radius R: it bends by t²v²/2R.
    let zero = Event::new(0.5, DVec3::new(1.0, 2.0, 0.0));
    let velocity = Velocity::from_beta(DVec3::new(0.0, -0.6, 0.0)).unwrap();
    let straight = WorldLine::inertial(velocity, zero);
    for radius in [1e6, 1e9, 1e12] {
        let centre = zero.x - DVec3::X * radius;
        let circle = WorldLine::circular(zero, centre, DVec3::Z * 3.0, -0.6 / radius).unwrap();
        for tau in [-4.0, 0.0, 3.0] {
            assert_equal(&circle, &straight, tau, 10.0 / radius + 1e-14);
        }
    }
}

#[test]
fn a_circle_turns_by_its_rate_in_world_time_right_handed() {
    // A quarter turn about z from (R, 0) leads to (0, R), with velocity along −x.
    let (radius, rate) = (2.0, 0.3);
    let line = WorldLine::circular(
        Event::new(0.0, DVec3::X * radius),
        DVec3::ZERO,
        DVec3::Z,
        rate,
    )
    .unwrap();
    let gamma = 1.0 / (1.0 - 0.36f64).sqrt();
    let quarter = std::f64::consts::FRAC_PI_2 / rate;
    let state = line.state(quarter / gamma).unwrap();
    assert!((state.event.x - DVec3::Y * radius).length() < 1e-14);
    assert!((state.event.ct - quarter).abs() < 1e-14);
    assert!((state.velocity.beta() - DVec3::NEG_X * 0.6).length() < 1e-15);
    // γ²v²/R towards the centre.
    assert!((state.acceleration - DVec3::NEG_Y * (gamma * gamma * 0.36 / radius)).length() < 1e-14);
}

/// Ω ct modulo 2π, the product and π to 320 and 160 bits.
fn exact_phase(rate: f64, ct: f64) -> f64 {
    let pi = exact(std::f64::consts::PI)
        + exact(1.224_646_799_147_353_2e-16)
        + exact(-2.994_769_809_718_339_7e-33);
    let phase = exact(rate) * exact(ct);
    let turns = (rounded(&phase) / std::f64::consts::TAU).round();
    rounded(&(phase - exact(2.0 * turns) * pi))
}

#[test]
fn a_circle_keeps_its_phase_for_a_billion_turns() {
    let rate = 0.3;
    let line = WorldLine::circular(Event::ORIGIN + right(), DVec3::ZERO, DVec3::Z, rate).unwrap();
    for tau in [1e3, 1.234e7, -2e10, 3.3e10] {
        let state = line.state(tau).unwrap();
        let (sin, cos) = exact_phase(rate, state.event.ct).sin_cos();
        let error = (state.event.x - DVec3::new(cos, sin, 0.0)).length();
        assert!(error < 2e-15, "{tau}: {error}");
        // From the centre the delay is the radius.
        let centre = Displacement::new(0.0, -state.event.x);
        let light = line.on_past_light_cone(&state, centre).unwrap();
        assert!((light.displacement.ct + 1.0).abs() < 2e-15, "{tau}");
    }
}

fn right() -> Displacement<World> {
    Displacement::new(0.0, DVec3::X)
}

#[test]
fn segments_of_equal_acceleration_are_one_hyperbola() {
    let n = DVec3::new(2.0, -1.0, 2.0) / 3.0;
    // Collinear with the velocity, so that no axes turn, and oblique to it.
    for velocity in [
        Velocity::from_rapidity_along(-0.8, n).unwrap(),
        rapidity(0.9, 0.8, -0.3),
    ] {
        check_pieces(n, velocity);
    }
}

fn check_pieces(n: DVec3, velocity: Velocity) {
    let zero = event(0.4, 1.0, 2.0, -1.0);
    let whole = WorldLine::hyperbolic(velocity, zero, n * 0.7).unwrap();
    let piece = |duration| Segment {
        duration,
        acceleration: n * 0.7,
    };
    let pieces = [piece(0.5), piece(1.25), piece(0.25), piece(f64::INFINITY)];
    let pieces = WorldLine::segments(velocity, zero, &pieces).unwrap();
    for tau in [0.0, 0.3, 0.5, 1.0, 1.9, 2.0, 5.0, 12.0] {
        let (a, b) = (whole.state(tau).unwrap(), pieces.state(tau).unwrap());
        assert!(
            apart(a.event, b.event) < 4e-15 * size(a.event).max(1.0),
            "at {tau}"
        );
        assert!((a.acceleration - b.acceleration).length() < 4e-15);
    }
    for tau in [3.0, 5.0, 12.0] {
        assert_equal(&whole, &pieces, tau, 4e-15);
    }
}

#[test]
fn segments_coast_before_between_and_after() {
    let zero = event(0.0, 0.0, 0.0, 0.0);
    let parts = [
        segment(1.0, 1.0, 0.0, 0.0),
        segment(2.0, 0.0, 0.0, 0.0),
        segment(1.0, -1.0, 0.0, 0.0),
    ];
    let line = WorldLine::segments(Velocity::REST, zero, &parts).unwrap();
    assert_eq!(line.state(-5.0).unwrap().event, event(-5.0, 0.0, 0.0, 0.0));
    // Rapidity 1 at 1 to 3, and rest from 4 on: twice cosh 1 − 1 and 2 sinh 1 between.
    assert!((line.state(2.5).unwrap().velocity.rapidity() - DVec3::X).length() < 1e-15);
    let end = line.state(9.0).unwrap();
    assert!(end.velocity.rapidity().length() < 1e-15);
    let distance = 2.0 * (1f64.cosh() - 1.0) + 2.0 * 1f64.sinh();
    assert!((end.event.x - DVec3::X * distance).length() < 2e-15);
    assert!(
        (end.event.ct - (4.0 * 1f64.sinh() - 2.0 * 1f64.sinh() + 2.0 * 1f64.cosh() + 5.0)).abs()
            < 4e-15
    );
    assert!(line.frame().is_none());
    assert_eq!(line.state(2.5).unwrap().acceleration, DVec3::ZERO);
}

#[test]
fn a_segment_accelerates_in_axes_that_are_carried_along() {
    // After rapidity 1 along x, acceleration along y, which has not turned: in the frame of that moment the velocity is along y, in
    // the world γ_y (γ_x β_x …): U = (sinh 1 cosh φ, sinh φ).
    let parts = [segment(1.0, 1.0, 0.0, 0.0), segment(2.0, 0.0, 0.5, 0.0)];
    let line = WorldLine::segments(Velocity::REST, Event::ORIGIN, &parts).unwrap();
    let (_, proper) = crate::worldlines::lines::four_velocity(&line.state(2.5).unwrap());
    let expected = DVec3::new(1f64.sinh() * 0.75f64.cosh(), 0.75f64.sinh(), 0.0);
    assert!((proper - expected).length() < 1e-15, "{proper}");
}

#[test]
fn a_hyperbola_is_unseen_beyond_its_horizon_only() {
    // Along x with g = 2, at rest at the origin: the horizon is ct + x = −1/2.
    let line = WorldLine::hyperbolic(Velocity::REST, Event::ORIGIN, DVec3::X * 2.0).unwrap();
    let seen = |ct, x| line.on_past_light_cone_of(event(ct, x, 0.3, 0.0));
    for (ct, x) in [(-0.5, 0.0), (0.0, -0.5), (-3.0, 1.0), (10.0, -10.6)] {
        assert!(seen(ct, x).is_none(), "({ct}, {x})");
    }
    for (ct, x) in [
        (-0.4999, 0.0),
        (0.0, -0.4999),
        (-3.0, 2.5001),
        (10.0, -10.4),
    ] {
        assert!(seen(ct, x).is_some(), "({ct}, {x})");
    }
    // Just within it, the light is of long ago.
    let tau = seen(-0.5 + 1e-12, 0.0).unwrap().proper_time();
    assert!(tau < -13.0, "{tau}");
}

#[test]
fn what_is_beyond_representable_speeds_has_no_state() {
    let line = WorldLine::hyperbolic(Velocity::REST, Event::ORIGIN, DVec3::X).unwrap();
    assert!(line.state(39.9).is_some() && line.state(-39.9).is_some());
    for tau in [40.1, -1e3, 1e300, f64::INFINITY, f64::NAN] {
        assert!(line.state(tau).is_none(), "{tau}");
    }
}
