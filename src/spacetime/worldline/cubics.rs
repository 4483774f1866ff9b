//! Paths that are cubics in time between events, with short turns where their velocity jumps.
//!
//! With d the time from one event to the next, Δ the way between them, and v, v′ the velocities at its ends,
//!
//! ```text
//! x(u) = x(0) + d v u + (3Δ − d (2v + v′)) u² + (d (v + v′) − 2Δ) u³,    u from 0 to 1;
//! ```
//!
//! v = v′ = Δ/d is a straight path at constant velocity.
//!
//! A jump in the velocity by more than rounding would be an infinite acceleration. Around each inner event that has one, from w before it to w after it, the path
//! is the cubic with the places and velocities of the two paths at these times; w = 1/16 of the shorter of the two times between events.
//! From one straight path to another the velocity then changes linearly, is never faster than the faster of the two, and passes the event
//! at the distance w |v′ − v|/4, inside the angle between both.

use glam::DVec3;

use super::error::WorldLineError;
use super::series::{Piece, Series};
use super::spline::{Span, check_speed};
use crate::spacetime::{Displacement, Event, World};

/// Fraction of the time between two events within which the velocity changes at each of them.
const TURN: f64 = 1.0 / 16.0;
/// The difference, relative to the way, below which a path with other velocities at its ends is straight: rounding errors.
const STRAIGHT: f64 = 1e-12;
/// The same for jumps of the velocity, relative to it: rounding errors of f32.
const SMOOTH: f64 = 1e-6;

/// Straight paths between `events`, which must ascend in time, with world time as parameter.
pub(super) fn polyline(events: &[Event<World>]) -> Result<Series, WorldLineError> {
    let way = |k: usize| Some(*events.get(k + 1)? - *events.get(k)?);
    let velocity = |k: usize| way(k).map(|way| way.x / way.ct);
    let at = |k: usize| {
        let [before, after] = [k.checked_sub(1).and_then(velocity), velocity(k)];
        [before, after].map(|v| v.or(before).or(after).unwrap_or_default())
    };
    let velocities: Vec<[DVec3; 2]> = (0..events.len()).map(at).collect();
    cubics(events, &velocities)
}

/// The path through `events`, which must ascend in time, with these velocities before and after each, and world time as parameter.
pub(super) fn cubics(
    events: &[Event<World>],
    velocities: &[[DVec3; 2]],
) -> Result<Series, WorldLineError> {
    let is_finite = |v: &[DVec3; 2]| v[0].is_finite() && v[1].is_finite();
    let missing = (0..events.len()).find(|k| !velocities.get(*k).is_some_and(is_finite));
    if let Some(index) = missing {
        return Err(WorldLineError::EntryNotFinite { index });
    }
    let span = |index: usize, start: Event<World>, way: Displacement<World>, ends| Span {
        index,
        start: start.ct,
        time: way.ct,
        coefficients: cubic(way, ends),
    };
    let ends = events.windows(2).zip(velocities.windows(2)).enumerate();
    let mut spans: Vec<Span> = ends
        .map(|(index, (e, v))| span(index, e[0], e[1] - e[0], [v[0][1], v[1][0]]))
        .collect();
    let mut series = Series {
        parameters: vec![events[0].ct],
        events: vec![events[0]],
        ..Series::default()
    };
    let (count, mut from) = (spans.len(), velocities[0][1]);
    for index in 0..count {
        let (end, [before, after]) = (events[index + 1], velocities[index + 1]);
        let own = &spans[index];
        let to = |v: DVec3| (!own.is_straight()).then_some([from, v]);
        let smooth = SMOOTH * (before.length() + after.length());
        if index + 1 == count || (after - before).length() <= smooth {
            add(&mut series, end, to(before));
            from = after;
            continue;
        }
        // From w before the corner to w after it, so that turns of neighbouring corners do not meet.
        let next = &spans[index + 1];
        let w = TURN * own.time.min(next.time);
        // The path before it, backwards from its end.
        let back = Displacement::new(own.time, events[index].x - end.x);
        let (x, v) = at(&cubic(back, [-before, -velocities[index][1]]), own.time, w);
        let leave = end + Displacement::new(-w, x);
        add(&mut series, leave, to(-v));
        let (x, onward) = at(&next.coefficients, next.time, w);
        let enter = end + Displacement::new(w, x);
        add(&mut series, enter, Some([-v, onward]));
        spans.push(span(index, leave, enter - leave, [-v, onward]));
        from = onward;
    }
    check_speed(&spans)?;
    Ok(series)
}

/// c₁, c₂, c₃ of x − x₀ in u = (ct − ct₀)/d, with these velocities at the ends of `way`.
fn cubic(way: Displacement<World>, ends: [DVec3; 2]) -> [DVec3; 3] {
    let [a, b] = ends.map(|v| v * way.ct);
    let bound = STRAIGHT * way.x.length();
    if (a - way.x).length() <= bound && (b - way.x).length() <= bound {
        return [way.x, DVec3::ZERO, DVec3::ZERO];
    }
    [a, way.x * 3.0 - a * 2.0 - b, a + b - way.x * 2.0]
}

/// Way and velocity of the path with these coefficients `since` after its beginning.
fn at([c1, c2, c3]: &[DVec3; 3], time: f64, since: f64) -> (DVec3, DVec3) {
    let u = since / time;
    let way = ((*c3 * u + *c2) * u + *c1) * u;
    (way, ((*c3 * (3.0 * u) + *c2 * 2.0) * u + *c1) / time)
}

/// Adds a piece from the end of the series to `end`, with these velocities at its ends, or a straight one.
fn add(series: &mut Series, end: Event<World>, ends: Option<[DVec3; 2]>) {
    let centre = series.events.len() - 1;
    let way = end - series.events[centre];
    let first = series.coefficients.len();
    // World time is linear in u.
    match ends.map(|ends| cubic(way, ends)) {
        None => series.coefficients.push(way.x.extend(way.ct)),
        Some([c, rest @ ..]) => {
            series.coefficients.push(c.extend(way.ct));
            (series.coefficients).extend(rest.map(|c| c.extend(0.0)));
        }
    }
    series.pieces.push(Piece {
        centre,
        scale: way.ct,
        first,
        count: series.coefficients.len() - first,
    });
    series.parameters.push(end.ct);
    series.events.push(end);
}
