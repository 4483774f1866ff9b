//! Events of a diagram: by coordinates, or by a relation to a world line.

use std::ops::Range;

use super::given::Given;
use super::names::Names;
use crate::error::{Error, Result};
use crate::figures::diagram::file::DiagramEvent;
use crate::figures::diagram::model::{Moment, Spot, Track};
use crate::scene::At;
use crate::spacetime::{Event, World};

const WHAT: &str = "this event is given twice";
const ONE_WAY: &str = "give it in one way: `at`, `cross`, or `on` a world line with `proper_time`, `light_from`, \
                       `light_to` or `simultaneous_with`";

pub(super) fn resolve(names: &mut Names, at: &At<DiagramEvent>) -> Result<Spot<Given>> {
    let said = &at.value;
    Ok(Spot {
        name: said.name.value.clone(),
        label: names.label(&said.label, &said.name)?,
        at: event(names, at)?,
        dot: said.dot.unwrap_or(true),
        colour: said.colour,
    })
}

fn event(names: &mut Names, at: &At<DiagramEvent>) -> Result<Given> {
    let said = &at.value;
    only_one_way(names, said)?;
    if let Some(spot) = &said.at {
        let (_, frame) = names.frame(&said.frame)?;
        return names.given(spot, &frame);
    }
    if let Some(cross) = &said.cross {
        return crossing(names, cross);
    }
    let Some(on) = &said.on else {
        return Err(names.cx.refuse(at, "this event is nowhere", ONE_WAY));
    };
    let track = names.track(on)?;
    on_track(names, said, &track, on)
}

fn span<T>(at: &Option<At<T>>) -> Option<&Range<usize>> {
    at.as_ref().map(|at| &at.span)
}

fn only_one_way(names: &Names, said: &DiagramEvent) -> Result<()> {
    let ways = [span(&said.at), span(&said.cross), span(&said.on)];
    given_twice(names, ways, WHAT, ONE_WAY)?;
    let on = [
        span(&said.proper_time),
        span(&said.light_from),
        span(&said.light_to),
        span(&said.simultaneous_with),
    ];
    if let (None, Some(here)) = (&said.on, on.iter().flatten().next()) {
        let what = "this needs a world line that the event is `on`";
        return Err(names.cx.report.refuse(here, what, ONE_WAY));
    }
    given_twice(names, on, WHAT, ONE_WAY)
}

/// Refuses `what` if it is given in more than one way.
pub(super) fn given_twice<const N: usize>(
    names: &Names,
    ways: [Option<&Range<usize>>; N],
    what: &str,
    help: &str,
) -> Result<()> {
    let mut ways = ways.into_iter().flatten();
    let (Some(first), Some(second)) = (ways.next(), ways.next()) else {
        return Ok(());
    };
    let report = &names.cx.report;
    Err(report.refuse_two(second, (first, "and here"), what, help))
}

/// An event on a world line: by its clock, by light that reaches or leaves it, or by simultaneity in a frame.
fn on_track(
    names: &mut Names,
    said: &DiagramEvent,
    track: &Track,
    on: &At<String>,
) -> Result<Given> {
    if let Some(time) = &said.proper_time {
        let moment = at_own_time(names, track, time.value.0, &time.span)?;
        return Ok(Given::by_clock(track, moment));
    }
    if let Some(spot) = &said.light_from {
        let event = names.event(spot)?;
        let never = "light from this event never reaches the world line";
        return Ok(found(names, track.receives_from(event), &spot.span, never)?
            .event
            .into());
    }
    if let Some(spot) = &said.light_to {
        let event = names.event(spot)?;
        let never = "no light of the world line reaches this event";
        return Ok(found(names, track.emits_to(event), &spot.span, never)?
            .event
            .into());
    }
    if let Some(spot) = &said.simultaneous_with {
        let event = names.event(spot)?;
        let (_, frame) = names.frame(&said.frame)?;
        let ct = frame.event_from_world(event).ct;
        let never = "the world line is not there at the time of this event";
        let moment = found(names, track.at_time(&frame, ct), &spot.span, never)?;
        return Ok(Given::beside(moment));
    }
    Err(names.cx.refuse(on, "where on this world line?", ONE_WAY))
}

/// The moment at which the clock of `track` shows `time`, in the diagram's unit.
pub(super) fn at_own_time(
    names: &Names,
    track: &Track,
    time: f64,
    span: &Range<usize>,
) -> Result<Moment> {
    track.at(time * names.unit).ok_or_else(|| {
        let [first, last] = track.span().map(|end| end / names.unit);
        let what = "the world line does not have this time";
        let help = format!("its own clock shows {first} to {last}");
        names.cx.report.refuse(span, what, help)
    })
}

/// The error for a light cone that a world line does not cross.
pub(super) fn found(
    names: &Names,
    moment: Option<Moment>,
    span: &Range<usize>,
    never: &str,
) -> Result<Moment> {
    moment.ok_or_else(|| {
        let help = "the world line has ended, has not begun, or is behind a horizon";
        names.cx.report.refuse(span, never, help)
    })
}

/// Where two world lines cross: their distance along x, at equal world time, changes its sign.
fn crossing(names: &mut Names, cross: &At<[At<String>; 2]>) -> Result<Given> {
    let [first, second] = &cross.value;
    let (a, b) = (names.track(first)?, names.track(second)?);
    let moment = meeting(names, &a, &b);
    moment.map(Given::beside).ok_or_else(|| never(names, cross))
}

/// The moment of `a` at which it crosses `b`.
pub(super) fn meeting(names: &Names, a: &Track, b: &Track) -> Option<Moment> {
    let n = names.direction;
    let ahead = |time: f64| {
        let event = a.at(time)?.event;
        let other = b.where_zero(|e| e.ct - event.ct)?;
        Some(n.dot(event.x - other.event.x))
    };
    let bracket = bracket(&ahead, a, names.unit)?;
    let moment = a.at(bisect(&ahead, bracket))?;
    // In 2+1 dimensions lines that cross in x may pass each other.
    let aside = |event: Event<World>| {
        let other = b.where_zero(|e| e.ct - event.ct)?;
        Some(names.across?.dot(event.x - other.event.x).abs())
    };
    // Lines that cross are this close, except for rounding.
    aside(moment.event)
        .is_none_or(|y| y <= 1e-9 * names.unit)
        .then_some(moment)
}

fn never(names: &Names, cross: &At<[At<String>; 2]>) -> Error {
    let what = "these world lines do not cross";
    let help = "name two that meet, between their ends";
    names.cx.refuse(cross, what, help)
}

/// Proper times of the first track between which the lines cross: the first after 0, or else the last before. Steps grow from a hundredth
/// of a unit, so that near crossings are distinguished and far ones are found.
fn bracket(ahead: &impl Fn(f64) -> Option<f64>, a: &Track, unit: f64) -> Option<[f64; 2]> {
    const STEPS: i32 = 700;
    let [first, last] = a.span();
    let start = 0f64.clamp(first, last);
    let there = || (ahead(start)? == 0.0).then_some([start, start]);
    let found = [1.0, -1.0].into_iter().find_map(|towards| {
        // Lines that begin together cross where they meet again.
        let mut near: Option<(f64, f64)> = None;
        for step in 0..STEPS {
            // The sum of steps that grow by 2 % each: 0.01 · (1.02ᵏ − 1)/0.02, up to 5·10⁵ units.
            let grown = 0.01 * unit * (1.02f64.powi(step) - 1.0) / 0.02;
            let time = (start + towards * grown).clamp(first, last);
            let Some(value) = ahead(time) else { continue };
            if let Some((before, sign)) = near
                && before != time
                && (value == 0.0 || (value < 0.0) != (sign < 0.0))
            {
                return Some([before, time]);
            }
            if value != 0.0 || step > 0 {
                near = Some((time, value));
            }
            if step > 0 && (time == first || time == last) {
                return (value == 0.0).then_some([time, time]);
            }
        }
        None
    });
    found.or_else(there)
}

fn bisect(ahead: &impl Fn(f64) -> Option<f64>, [mut a, mut b]: [f64; 2]) -> f64 {
    let Some(sign) = ahead(a) else { return b };
    // It ends sooner, where no double lies between.
    for _ in 0..140 {
        let middle = a + 0.5 * (b - a);
        if middle == a || middle == b {
            break;
        }
        match ahead(middle) {
            Some(value) if value != 0.0 && (value < 0.0) == (sign < 0.0) => a = middle,
            _ => b = middle,
        }
    }
    b
}
