//! Straight paths at constant velocity from event to event, with short turns.
//!
//! A jump in the velocity would be an infinite acceleration. Around each inner event, from w before it to w after it, the velocity changes
//! linearly from v before it to v′ after it:
//!
//! ```text
//! x(u) = x(0) + 2w v u + w (v′ − v) u²,    u from 0 to 1;    w = 1/16 of the shorter of the two times between events.
//! ```
//!
//! The path is then never faster than the faster of the two, and passes the event at the distance w |v′ − v|/4, inside the angle between
//! both paths.

use super::error::{MAX_KEYFRAME_SPEED, WorldLineError};
use super::series::{Piece, Series};
use crate::spacetime::{Displacement, Event, World};

/// Fraction of the time between two events within which the velocity changes at each of them.
const TURN: f64 = 1.0 / 16.0;

/// The paths between `events`, which must ascend in time, with world time as parameter.
pub(super) fn polyline(events: &[Event<World>]) -> Result<Series, WorldLineError> {
    let ways: Vec<Displacement<World>> = events.windows(2).map(|e| e[1] - e[0]).collect();
    check_speed(events, &ways)?;
    let mut series = Series {
        parameters: vec![events[0].ct],
        events: vec![events[0]],
        ..Series::default()
    };
    for (i, pair) in ways.windows(2).enumerate() {
        let [before, after] = [pair[0].x / pair[0].ct, pair[1].x / pair[1].ct];
        // From w before the corner to w after it, so that turns of neighbouring corners do not meet.
        let w = TURN * pair[0].ct.min(pair[1].ct);
        let turn = events[i + 1];
        add(&mut series, turn + Displacement::new(-w, before * -w), &[]);
        // At u in [0, 1] it has moved by 2w·before·u + w·(after − before)·u²: the velocity changes linearly.
        let bend = (after - before) * w;
        let end = turn + Displacement::new(w, after * w);
        add(&mut series, end, &[before * (2.0 * w), bend]);
    }
    add(&mut series, events[events.len() - 1], &[]);
    Ok(series)
}

/// Adds a piece from the end of the series to `end`, with these coefficients of its position, or a straight one.
fn add(series: &mut Series, end: Event<World>, coefficients: &[glam::DVec3]) {
    let centre = series.events.len() - 1;
    let way = end - series.events[centre];
    let first = series.coefficients.len();
    match coefficients {
        [] => series.coefficients.push(way.x.extend(way.ct)),
        [c, rest @ ..] => {
            series.coefficients.push(c.extend(way.ct));
            series
                .coefficients
                .extend(rest.iter().map(|c| c.extend(0.0)));
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

/// Refuses paths that are not slower than light, reporting the fastest.
fn check_speed(
    events: &[Event<World>],
    ways: &[Displacement<World>],
) -> Result<(), WorldLineError> {
    let speeds = ways.iter().map(|way| way.x.length() / way.ct).enumerate();
    match speeds.reduce(|a, b| if b.1 > a.1 { b } else { a }) {
        Some((index, speed)) if speed > MAX_KEYFRAME_SPEED => Err(WorldLineError::Superluminal {
            index,
            ct: events[index].ct,
            speed,
        }),
        _ => Ok(()),
    }
}
