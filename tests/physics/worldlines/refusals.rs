//! Invalid world lines are refused, with the position of the error.

use glam::DVec3;
use nullray::spacetime::worldline::{Axes, MAX_ENTRIES, Segment, WorldLine, WorldLineError};
use nullray::spacetime::{Event, Velocity, World};

use crate::worldlines::lines::{event, segment};

fn segments(list: &[Segment]) -> WorldLineError {
    WorldLine::segments(Velocity::REST, Event::ORIGIN, list).unwrap_err()
}

fn profile(knots: &[(f64, DVec3)]) -> WorldLineError {
    WorldLine::profile(Velocity::REST, Event::ORIGIN, knots, Axes::World).unwrap_err()
}

fn keyframes(events: &[Event<World>]) -> WorldLineError {
    WorldLine::keyframes(events).unwrap_err()
}

fn circular(centre: DVec3, axis: DVec3, rate: f64) -> WorldLineError {
    WorldLine::circular(event(0.0, 1.0, 0.0, 0.0), centre, axis, rate).unwrap_err()
}

#[test]
fn accelerations_that_are_not_finite_or_too_strong_are_refused() {
    for (bad, message) in [(f64::NAN, "must be finite"), (1e200, "above 1e100")] {
        let error = WorldLine::hyperbolic(Velocity::REST, Event::ORIGIN, DVec3::Y * bad);
        let error = error.unwrap_err();
        assert!(
            error.to_string().contains(message) && error.index().is_none(),
            "{error}"
        );
        let good = segment(1.0, 0.1, 0.0, 0.0);
        let error = segments(&[good, segment(1.0, 0.0, bad, 0.0)]);
        assert!(error.to_string().contains("finite") || error.to_string().contains("1e100"));
        assert_eq!(error.index(), Some(1));
        assert_eq!(
            profile(&[(0.0, DVec3::X), (1.0, DVec3::X * bad)]).index(),
            Some(1)
        );
    }
}

#[test]
fn durations_must_be_above_zero_and_end_before_the_next() {
    let good = segment(1.0, 0.1, 0.0, 0.0);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = segments(&[good, segment(bad, 0.1, 0.0, 0.0), good]);
        assert!(
            matches!(error, WorldLineError::Duration { index: 1, .. }),
            "{error}"
        );
        assert!(error.to_string().contains("segment 2"));
    }
}

#[test]
fn too_fast_a_segment_is_refused_with_its_number() {
    let error = segments(&[segment(1.0, 3.0, 0.0, 0.0), segment(1.0, 50.0, 0.0, 0.0)]);
    assert!(
        matches!(error, WorldLineError::TooFast { index: 1, .. }),
        "{error}"
    );
    assert!(error.to_string().contains("rapidity 40"), "{error}");
}

#[test]
fn a_hostile_profile_is_refused_at_once() {
    let strong = |g: f64| {
        vec![
            (0.0, DVec3::X),
            (1.0, DVec3::Y),
            (2.0, DVec3::Z * g),
            (3.0, DVec3::NEG_Z * g),
        ]
    };
    for g in [1e3, 1e30, 1e100] {
        let error = profile(&strong(g));
        assert_eq!(error.index(), Some(1), "{error}");
    }
    // Faster and faster to and fro, within the rounding of proper time.
    let knots = [
        (0.0, DVec3::ZERO),
        (1e9, DVec3::ZERO),
        (1e9 + 1e-6, DVec3::X * 1e9),
    ];
    assert_eq!(profile(&knots).index(), Some(1));
    let knots = [
        (0.0, DVec3::X),
        (f64::MIN_POSITIVE, DVec3::Y * 1e100),
        (1.0, DVec3::ZERO),
    ];
    assert!(profile(&knots).index().is_some());
}

#[test]
fn times_must_ascend_and_be_finite() {
    let knot = |t| (t, DVec3::X);
    let error = profile(&[knot(0.0), knot(1.0), knot(1.0)]);
    assert!(
        matches!(error, WorldLineError::NotAscending { index: 2, .. }),
        "{error}"
    );
    assert!(error.to_string().contains("entry 3"), "{error}");
    assert_eq!(profile(&[knot(0.0), knot(f64::NAN)]).index(), Some(1));
    let key = |t| event(t, 0.0, 0.0, 0.0);
    let error = keyframes(&[key(0.0), key(2.0), key(1.0)]);
    assert!(
        matches!(error, WorldLineError::NotAscending { index: 2, .. }),
        "{error}"
    );
    let error = keyframes(&[key(0.0), event(1.0, f64::INFINITY, 0.0, 0.0)]);
    assert_eq!(error, WorldLineError::EntryNotFinite { index: 1 });
}

#[test]
fn a_profile_must_hold_proper_time_zero() {
    for [first, last] in [[1.0, 2.0], [-2.0, -1.0]] {
        let error = profile(&[(first, DVec3::X), (last, DVec3::X)]);
        assert_eq!(error, WorldLineError::ZeroOutside { first, last });
    }
}

#[test]
fn lists_have_two_entries_at_least_and_a_hundred_thousand_at_most() {
    assert_eq!(profile(&[(0.0, DVec3::X)]), WorldLineError::TooFew(1));
    assert_eq!(keyframes(&[]), WorldLineError::TooFew(0));
    let count = MAX_ENTRIES + 1;
    assert_eq!(
        keyframes(&vec![event(0.0, 0.0, 0.0, 0.0); count]),
        WorldLineError::TooMany(count)
    );
    assert_eq!(
        segments(&vec![segment(1.0, 0.0, 0.0, 0.0); count]),
        WorldLineError::TooMany(count)
    );
    let still = WorldLine::segments(Velocity::REST, Event::ORIGIN, &[]).unwrap();
    assert!(still.frame().is_some());
}

#[test]
fn circles_need_an_axis_a_radius_and_a_rim_slower_than_light() {
    assert_eq!(
        circular(DVec3::ZERO, DVec3::ZERO, 0.1),
        WorldLineError::NoAxis
    );
    assert_eq!(circular(DVec3::X, DVec3::Z, 0.1), WorldLineError::OnAxis);
    assert_eq!(
        circular(DVec3::new(0.1, 0.0, 0.0), DVec3::X, 0.1),
        WorldLineError::OnAxis
    );
    assert_eq!(
        circular(DVec3::ZERO, DVec3::Z, -1.0),
        WorldLineError::RimTooFast { speed: 1.0 }
    );
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(matches!(
            circular(DVec3::ZERO, DVec3::Z, bad),
            WorldLineError::NotFinite(_)
        ));
        assert!(matches!(
            circular(DVec3::Z * bad, DVec3::Z, 0.1),
            WorldLineError::NotFinite(_)
        ));
    }
}
