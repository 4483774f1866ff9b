//! Motion through key events.

use glam::DVec3;
use nullray::spacetime::worldline::{State, WorldLine, WorldLineError};
use nullray::spacetime::{Displacement, Event, Velocity, World};

use crate::worldlines::lines::{Sequence, apart, event, keys, length, turn};

/// The proper time at which `line` is at world time `ct`, by bisection.
fn when(line: &WorldLine, ct: f64) -> f64 {
    let [mut low, mut high] = line.rests().unwrap_or(line.span());
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if line.state(middle).unwrap().event.ct < ct {
            low = middle
        } else {
            high = middle
        }
    }
    high
}

fn at_time(line: &WorldLine, ct: f64) -> State {
    line.state(when(line, ct)).unwrap()
}

/// dv/dct from the state: the inverse of a = γ² w + γ⁴/(1 + γ) (v·w) v.
fn coordinate_acceleration(state: &State) -> DVec3 {
    let (v, a) = (state.velocity.beta(), state.acceleration);
    let gamma = state.velocity.gamma();
    (a - v * (gamma / (1.0 + gamma) * v.dot(a))) / (gamma * gamma)
}

#[test]
fn the_curve_passes_through_its_events_from_proper_time_zero_on() {
    let line = turn();
    assert_eq!(line.span()[0], 0.0);
    assert_eq!(line.state(0.0).unwrap().event, keys()[0]);
    let end = line.state(line.span()[1]).unwrap();
    assert!(apart(end.event, keys()[4]) < 4e-15);
    for key in keys() {
        assert!(apart(at_time(&line, key.ct).event, key) < 2e-15, "{key:?}");
    }
}

#[test]
fn the_clock_of_a_line_is_the_same_however_late_the_line_begins() {
    // Times and places whose sums with 2⁴⁰ are exact.
    let keys = |begin: f64| -> Vec<Event<World>> {
        let key = |(ct, x, y): (f64, f64, f64)| Event::new(begin + ct, DVec3::new(x, y, 0.5));
        [
            (0.0, 0.0, 0.0),
            (2.0, 0.75, 0.125),
            (3.0, 0.5, 0.25),
            (5.0, 1.0, -0.25),
        ]
        .map(key)
        .to_vec()
    };
    let end = |begin: f64| {
        let line = WorldLine::keyframes(&keys(begin)).unwrap();
        (
            line.span()[1],
            WorldLine::polyline(&keys(begin)).unwrap().span()[1],
        )
    };
    assert!(end(0.0).0 < 4.9);
    assert_eq!(end(0.0), end(2f64.powi(40)));
}

#[test]
fn velocity_and_acceleration_are_continuous_at_the_events_and_the_latter_ends_at_zero() {
    let line = turn();
    for key in &keys()[1..4] {
        let tau = when(&line, key.ct);
        let (before, after) = (
            line.state(tau - 1e-9).unwrap(),
            line.state(tau + 1e-9).unwrap(),
        );
        let jump = (before.velocity.beta() - after.velocity.beta()).length();
        assert!(jump < 1e-8, "{key:?}: {jump}");
        let jump = (before.acceleration - after.acceleration).length();
        assert!(jump < 2e-8, "{key:?}: {jump}");
        assert!(before.acceleration.length() > 0.05);
    }
    for tau in line.span() {
        assert!(line.state(tau).unwrap().acceleration.length() < 1e-14);
    }
}

#[test]
fn between_events_the_position_is_a_cubic_of_world_time() {
    // Natural spline through (0, 0), (1, 1/4), (2, 0): 4 M₁ = 6 (−1/4 − 1/4) = −3, M₁ = −3/4.
    let events = [(0.0, 0.0), (1.0, 0.25), (2.0, 0.0)].map(|(ct, x)| event(ct, x, 0.0, 0.0));
    let line = WorldLine::keyframes(&events).unwrap();
    // x = t/4 + t/8 − t³/8 on the first span.
    for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let state = at_time(&line, t);
        assert!(
            (state.event.x.x - (3.0 * t - t * t * t) / 8.0).abs() < 1e-15,
            "at {t}"
        );
        assert!(
            (state.velocity.beta().x - (3.0 - 3.0 * t * t) / 8.0).abs() < 1e-15,
            "at {t}"
        );
        assert!(
            (coordinate_acceleration(&state).x + 0.75 * t).abs() < 1e-14,
            "at {t}"
        );
    }
    // The second is its mirror image.
    assert!(
        (at_time(&line, 1.5).velocity.beta().x + at_time(&line, 0.5).velocity.beta().x).abs()
            < 1e-15
    );
}

#[test]
fn proper_time_is_the_integral_of_the_rate_of_the_clock() {
    // The same curve: dτ/dct = √(1 − v²) with v = (3 − 3t²)/8, by Simpson's rule (to
    // 1e-14); twice by symmetry.
    let events = [(0.0, 0.0), (1.0, 0.25), (2.0, 0.0)].map(|(ct, x)| event(ct, x, 0.0, 0.0));
    let line = WorldLine::keyframes(&events).unwrap();
    let rate = |t: f64| (1.0 - ((3.0 - 3.0 * t * t) / 8.0).powi(2)).sqrt();
    let weight = |i: u32| match i {
        0 | 1000 => 1.0,
        _ => f64::from(2 + 2 * (i % 2)),
    };
    let sum: f64 = (0..=1000)
        .map(|i| weight(i) * rate(f64::from(i) / 1000.0))
        .sum();
    let half = sum / 3000.0;
    assert!((line.span()[1] - 2.0 * half).abs() < 4e-14);
    assert!((when(&line, 1.0) - half).abs() < 2e-14);
}

#[test]
fn events_on_a_straight_line_at_constant_speed_give_inertial_motion() {
    let v = DVec3::new(0.3, -0.5, 0.6);
    let start = event(1.0, 2.0, -1.0, 0.5);
    let times = [0.0, 0.5, 2.0, 2.25, 7.0];
    let events: Vec<Event<World>> = times
        .iter()
        .map(|t| Event::new(start.ct + t, start.x + v * *t))
        .collect();
    let line = WorldLine::keyframes(&events).unwrap();
    let straight = WorldLine::inertial(Velocity::from_beta(v).unwrap(), start);
    let gamma = 1.0 / (1.0 - v.length_squared()).sqrt();
    assert!((line.span()[1] - 7.0 / gamma).abs() < 4e-15);
    for i in 0..=20 {
        let tau = line.span()[1] * f64::from(i) / 20.0;
        let (a, b) = (line.state(tau).unwrap(), straight.state(tau).unwrap());
        assert!(apart(a.event, b.event) < 4e-15 * 8.0, "at {tau}");
        assert!(
            (a.velocity.rapidity() - b.velocity.rapidity()).length() < 1e-14,
            "at {tau}"
        );
        assert!(a.acceleration.length() < 1e-13, "at {tau}");
    }
}

#[test]
fn a_curve_that_is_barely_slower_than_light_keeps_its_proper_time() {
    // 1 − v = 1e-9: τ/ct = √((1 − v)(1 + v)).
    let v = 1.0 - 1e-9;
    let events = [0.0, 1.0, 3.0].map(|t| event(t, v * t, 0.0, 0.0));
    let line = WorldLine::keyframes(&events).unwrap();
    let expected = 3.0 * (1e-9 * (1.0 + v)).sqrt();
    assert!(
        (line.span()[1] / expected - 1.0).abs() < 1e-6,
        "{}",
        line.span()[1]
    );
}

fn refusal(events: &[Event<World>]) -> WorldLineError {
    WorldLine::keyframes(events).unwrap_err()
}

#[test]
fn a_span_faster_than_light_is_refused_with_its_place() {
    let mut events = keys();
    events[3].x.x = 4.4;
    events[4].x.x = 4.6;
    let error = refusal(&events);
    assert_eq!(error.index(), Some(2), "{error}");
    let WorldLineError::Superluminal { ct, speed, .. } = error else {
        panic!("{error}")
    };
    assert!((2.5..5.0).contains(&ct) && speed > 1.2, "{error}");
    assert!(
        error.to_string().contains("between events 3 and 4"),
        "{error}"
    );
}

#[test]
fn a_curve_is_refused_where_only_its_middle_is_too_fast() {
    // (−3, −a), (−2, −a), (2, a), (3, a): 10 M₁ + 4 M₂ = 3a and M₂ = −M₁ give M₁ = a/2, the speed a/6 at −2, and
    // a/6 + a/2 = 2a/3 at 0, where the mean is a/2.
    let events =
        |a: f64| [(-3.0, -a), (-2.0, -a), (2.0, a), (3.0, a)].map(|(t, x)| event(t, x, 0.0, 0.0));
    assert!(WorldLine::keyframes(&events(1.49)).is_ok());
    let error = refusal(&events(1.6));
    let WorldLineError::Superluminal { ct, speed, index } = error else {
        panic!("{error}")
    };
    assert!(index == 1 && ct.abs() < 1e-6, "{error}");
    assert!((speed - 3.2 / 3.0).abs() < 1e-14, "{speed}");
}

#[test]
fn the_speed_of_light_itself_is_refused() {
    let events = [0.0, 1.0].map(|t| event(t, t, 0.0, 0.0));
    assert!(matches!(
        refusal(&events),
        WorldLineError::Superluminal { index: 0, .. }
    ));
}

/// The rate of the clock is a difference of rounded numbers there, and known to five digits only.
#[test]
fn keys_just_below_the_speed_of_light_are_followed_as_far_as_their_rate_is_known() {
    let key = |i: i32| Event::new(f64::from(i), DVec3::X * (f64::from(i) * (1.0 - 3e-12)));
    let keys: Vec<Event<World>> = (0..1000).map(key).collect();
    let line = WorldLine::keyframes(&keys).unwrap();
    let expected = 999.0 * 6e-12f64.sqrt();
    assert!((line.span()[1] / expected - 1.0).abs() < 1e-4);
}

/// Along the sides of a square, 4 m of light each: β = 1/4, and turns from 1/4 m before the corners to 1/4 m after them. There the
/// velocity goes linearly from one side to the next, and the way passes the corner at w |v′ − v|/4.
#[test]
fn between_events_of_a_polyline_the_way_is_straight_and_turns_are_short() {
    let events = [
        event(0.0, 0.0, 0.0, 0.0),
        event(4.0, 1.0, 0.0, 0.0),
        event(8.0, 1.0, 1.0, 0.0),
        event(12.0, 0.0, 1.0, 0.0),
    ];
    let line = WorldLine::polyline(&events).unwrap();
    let (w, jump) = (0.25, 2f64.sqrt() / 4.0);
    for (ct, x, v) in [
        (1.0, DVec3::new(0.25, 0.0, 0.0), DVec3::X),
        (3.74, DVec3::new(0.935, 0.0, 0.0), DVec3::X),
        (4.26, DVec3::new(1.0, 0.065, 0.0), DVec3::Y),
        (6.0, DVec3::new(1.0, 0.5, 0.0), DVec3::Y),
        (11.0, DVec3::new(0.25, 1.0, 0.0), -DVec3::X),
    ] {
        let state = at_time(&line, ct);
        assert!(apart(state.event, Event::new(ct, x)) < 4e-15, "{state:?}");
        assert!((state.velocity.beta() - v / 4.0).length() < 1e-15);
        assert!(state.acceleration.length() < 1e-14);
    }
    // In the middle of a turn the velocity is the mean of both, and its rate their difference over 2w.
    let corner = at_time(&line, 4.0);
    let [off, mean] = [DVec3::new(-1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)];
    let expected = events[1].x + off.normalize() * (w * jump / 4.0);
    assert!((corner.event.x - expected).length() < 4e-15, "{corner:?}");
    assert!((corner.velocity.beta() - mean / 8.0).length() < 1e-15);
    let bent = coordinate_acceleration(&corner);
    assert!((bent - off / (4.0 * 2.0 * w)).length() < 1e-14, "{bent}");
    // Half of a square's diagonal is a fifth slower than its side: 11 m go straight, and 1 m in both turns, where
    // |v|² = (1 + u²)/32 with u from -1 to 1; the next term of the root's series is 5e-6.
    let turns = 1.0 - (4.0 / 3.0) / 64.0 - (1.0 + 2.0 / 3.0 + 0.2) / (8.0 * 1024.0);
    let expected = 11.0 * (15.0f64 / 16.0).sqrt() + turns;
    assert!(
        (line.span()[1] - expected).abs() < 1e-5,
        "{}",
        line.span()[1]
    );
}

/// Where a smooth curve would have to be faster than light, a turn back on the same way need not be.
#[test]
fn a_polyline_is_as_fast_as_its_fastest_way() {
    let events =
        |x: f64| [(0.0, 0.0), (1.0, x), (2.0, 0.0), (3.0, x)].map(|(t, x)| event(t, x, 0.0, 0.0));
    assert!(WorldLine::keyframes(&events(0.95)).is_err());
    let line = WorldLine::polyline(&events(0.95)).unwrap();
    for i in 0..=1000 {
        let speed = line.state(line.span()[1] * f64::from(i) / 1000.0);
        assert!(speed.unwrap().velocity.beta().length() < 0.95 + 1e-12);
    }
    let mut too_fast = events(0.5);
    too_fast[3].x.x = 1.25;
    let error = WorldLine::polyline(&too_fast).unwrap_err();
    assert!(matches!(
        error,
        WorldLineError::Superluminal {
            index: 2,
            speed: 1.25,
            ..
        }
    ));
}

/// Between its events the line of an animation is the other line; before and after, at rest, its clock runs as fast as
/// the world's. Wherever the cone's apex is, the crossing is the one event of the line from which light gets there.
#[test]
fn an_animation_rests_before_its_first_event_and_after_its_last() {
    let keys = keys();
    let mut numbers = Sequence(14);
    for is_straight in [false, true] {
        // A natural spline is the cubics with its own velocities; those of straight paths jump at inner events.
        let between = match is_straight {
            true => WorldLine::polyline(&keys).unwrap(),
            false => WorldLine::keyframes(&keys).unwrap(),
        };
        let velocities: Vec<[DVec3; 2]> = match is_straight {
            true => {
                let ways = keys.windows(2).map(|pair| pair[1] - pair[0]);
                let ways: Vec<DVec3> = ways.map(|way| way.x / way.ct).collect();
                let at = |k: usize| [ways[k.max(1) - 1], ways[k.min(ways.len() - 1)]];
                (0..keys.len()).map(at).collect()
            }
            false => {
                let velocity = |key: &Event<World>| at_time(&between, key.ct).velocity.beta();
                keys.iter().map(|key| [velocity(key); 2]).collect()
            }
        };
        let line = WorldLine::animation(&keys, &velocities).unwrap();
        let [first, last] = line.rests().unwrap();
        let [begin, end] = between.span();
        assert!(first == begin && (last - end).abs() < 1e-13, "{last} {end}");
        assert_eq!(line.span(), [f64::NEG_INFINITY, f64::INFINITY]);
        for part in 0..=64 {
            let time = first + (last - first) * f64::from(part) / 64.0;
            let time = time.min(end);
            let [a, b] = [&line, &between].map(|line| line.state(time).unwrap());
            assert!(apart(a.event, b.event) < 1e-13, "{time}: {a:?} {b:?}");
            let slower = a.velocity.beta() - b.velocity.beta();
            assert!(slower.length() < 1e-12, "{time}: {slower}");
        }
        for (time, event) in [(first - 3.5, keys[0]), (last + 2.25, keys[4])] {
            let state = line.state(time).unwrap();
            let since = if time < first { -3.5 } else { 2.25 };
            assert!((state.event.ct - event.ct - since).abs() < 4e-15);
            assert_eq!((state.event.x, state.velocity), (event.x, Velocity::REST));
            assert_eq!(state.acceleration, DVec3::ZERO);
            assert!(between.state(time).is_none());
        }
        // From states of all parts to apexes all over: what is seen is on the line, and by light.
        let mut seen = [0; 3];
        for _ in 0..3000 {
            let mut within = |reach: f64| reach * (2.0 * numbers.next() - 1.0);
            let near = line.state(3.0 + within(12.0)).unwrap();
            let x = DVec3::new(within(4.0), within(4.0), within(4.0));
            let offset = Displacement::new(within(12.0), x);
            let apex = near.event + offset;
            let crossing = line.on_past_light_cone(&near, offset).unwrap();
            let other = line.on_past_light_cone_of(apex).unwrap();
            assert!(apart(crossing.event, other.event) < 1e-13, "{crossing:?}");
            let light = apex - crossing.event;
            assert!((light.ct - light.x.length()).abs() < 1e-13, "{light:?}");
            let time = crossing.proper_time();
            assert!((time - other.proper_time()).abs() < 1e-12);
            let there = line.state(time).unwrap();
            assert!(apart(there.event, crossing.event) < 1e-13, "{there:?}");
            assert!(length(near.event + crossing.displacement - crossing.event) < 1e-14);
            seen[usize::from(time >= first) + usize::from(time > last)] += 1;
        }
        assert!(seen.iter().all(|count| *count > 300), "{seen:?}");
    }
}

/// x = 4h t(1 − t), a cubic with the slopes ±4h at its ends: its place and velocity are known at all times, and so is where it is fastest.
#[test]
fn between_its_events_an_animation_is_the_cubic_with_their_velocities() {
    let events = [event(0.0, 0.0, 0.0, 7.0), event(1.0, 0.0, 0.0, 7.0)];
    let line = |slope: f64| {
        let [up, down] = [DVec3::X * slope, DVec3::X * -slope];
        WorldLine::animation(&events, &[[up; 2], [down; 2]])
    };
    let slow = line(0.6).unwrap();
    let end = slow.rests().unwrap()[1];
    for part in 0..=32 {
        let state = slow.state(end * f64::from(part) / 32.0).unwrap();
        let ct = state.event.ct;
        let expected = Event::new(ct, DVec3::new(0.6 * ct * (1.0 - ct), 0.0, 7.0));
        assert!(apart(state.event, expected) < 1e-15, "{state:?}");
        let velocity = DVec3::X * (0.6 * (1.0 - 2.0 * ct));
        assert!((state.velocity.beta() - velocity).length() < 1e-14);
        let bend = coordinate_acceleration(&state) + DVec3::X * 1.2;
        assert!(bend.length() < 1e-13, "{bend}");
    }
    let error = line(1.04).unwrap_err();
    let is_meant = |ct: f64, speed: f64| (ct == 0.0 || ct == 1.0) && (speed - 1.04).abs() < 1e-15;
    assert!(
        matches!(error, WorldLineError::Superluminal { index: 0, ct, speed } if is_meant(ct, speed)),
        "{error:?}"
    );
    // Velocities are as many as events, and finite.
    assert!(WorldLine::animation(&events, &[[DVec3::ZERO; 2]]).is_err());
    assert!(WorldLine::animation(&events, &[[DVec3::NAN; 2]; 2]).is_err());
}

/// Two parabolas with a corner between them: each is followed up to a sixteenth of its time from the corner, and the velocity goes from
/// one to the other without a jump.
#[test]
fn where_the_velocity_of_an_animation_jumps_it_turns_within_a_sixteenth_of_the_time() {
    let events = [0.0, 1.0, 3.0].map(|ct| event(ct, 0.0, 0.0, 0.0));
    let slopes = [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]];
    let velocities = slopes.map(|both| both.map(|v| DVec3::Y * v));
    let line = WorldLine::animation(&events, &velocities).unwrap();
    let way = |ct: f64| match ct < 1.0 {
        true => 0.5 * ct * (1.0 - ct),
        false => 0.25 * (ct - 1.0) * (3.0 - ct),
    };
    for ct in [0.2, 0.9, 0.937, 1.063, 1.1, 2.5] {
        let place = at_time(&line, ct).event.x;
        assert!(
            (place - DVec3::Y * way(ct)).length() < 1e-14,
            "{ct}: {place}"
        );
    }
    let mut before = at_time(&line, 0.93).velocity.beta().y;
    for step in 0..=1400 {
        let velocity = at_time(&line, 0.93 + 1e-4 * f64::from(step)).velocity;
        let v = velocity.beta().y;
        assert!(
            (v - before).abs() < 2e-3 && v.abs() < 0.5,
            "{step}: {before} {v}"
        );
        before = v;
    }
}
