//! World lines of a diagram.

use std::ops::Range;

use glam::DVec3;

use super::event::{found, given_twice, meeting};
use super::names::Names;
use super::settings;
use crate::error::{Error, Result};
use crate::figures::diagram::file::{DiagramLine, LineCircle, LineSegment};
use crate::figures::diagram::model::{NamedLine, Track};
use crate::figures::diagram::spot::Place;
use crate::scene::At;
use crate::scene::Numbers;
use crate::spacetime::worldline::{Axes, Segment, WorldLine, WorldLineError};
use crate::spacetime::{Event, World};

const WHAT: &str = "this world line is given twice";
const ONE_WAY: &str = "give it in one way: `of`, `through`, `keyframes`, or `at` with `velocity` and \
                       `acceleration`, `segments` or `profile`, or with `circle`";

pub(super) fn resolve(names: &mut Names, at: &At<DiagramLine>) -> Result<NamedLine> {
    let line = &at.value;
    only_one_way(names, line)?;
    let track = track(names, at)?;
    let ticks = settings::positive(names.cx, &line.ticks, "`ticks`")?;
    Ok(NamedLine {
        name: line.name.value.clone(),
        label: names.label(&line.label, &line.name)?,
        track: ended(names, line, track)?,
        ticks: ticks.map(|ticks| ticks * names.unit),
        numbers: line.numbers.unwrap_or(false),
        colour: line.colour,
    })
}

fn span<T>(at: &Option<At<T>>) -> Option<&Range<usize>> {
    at.as_ref().map(|at| &at.span)
}

/// Refuses two ways at once; `at` and `velocity` belong to those that start at an event.
fn only_one_way(names: &Names, line: &DiagramLine) -> Result<()> {
    let moves = [
        span(&line.acceleration),
        span(&line.segments),
        span(&line.profile),
        span(&line.circle),
    ];
    let start = [span(&line.at), span(&line.velocity)];
    let start = moves.into_iter().chain(start).flatten().next();
    let ways = [
        span(&line.of),
        span(&line.through),
        span(&line.keyframes),
        start,
    ];
    given_twice(names, ways, WHAT, ONE_WAY)?;
    given_twice(names, moves, WHAT, ONE_WAY)?;
    names
        .cx
        .exclusive((&line.circle, "circle"), (&line.velocity, "velocity"))
}

fn track(names: &mut Names, at: &At<DiagramLine>) -> Result<Track> {
    let line = &at.value;
    if let Some(of) = &line.of {
        return of_scene(names, of);
    }
    if let Some(through) = &line.through {
        let events = events(names, through)?;
        return Track::broken(&events).map_err(|i| too_fast(names, through, i));
    }
    if let Some(keyframes) = &line.keyframes {
        let events = events(names, keyframes)?;
        let track = WorldLine::keyframes(&events).map(Track::from);
        return track.map_err(|error| refusal(names, keyframes, &error));
    }
    from_event(names, at)
}

fn of_scene(names: &Names, of: &At<String>) -> Result<Track> {
    names.of_scene(&of.value, &of.span)?.ok_or_else(|| {
        let known = names.scene.names().join(", ");
        let what = format!(
            "the scene has no world line of {}",
            crate::spacetime::units::quoted(&of.value)
        );
        let help = match known.is_empty() {
            true => "this file has no scene: give `at`, `through` or `keyframes`".to_string(),
            false => format!("it has those of: {known}"),
        };
        names.cx.refuse(of, what, help)
    })
}

fn events(names: &mut Names, at: &At<Vec<At<Place>>>) -> Result<Vec<Event<World>>> {
    if at.value.len() < 2 {
        let help = "give at least two events, like [\"A\", \"B\"]";
        return Err(names.cx.refuse(at, "a world line needs two events", help));
    }
    at.value.iter().map(|spot| names.event(spot)).collect()
}

/// The refusal of an event that nothing slower than light reaches from the one before.
fn too_fast(names: &Names, at: &At<Vec<At<Place>>>, i: usize) -> Error {
    let spans = at.value.iter().map(|spot| &spot.span);
    let here = spans.clone().nth(i).unwrap_or(&at.span);
    let before = spans.clone().nth(i.wrapping_sub(1)).unwrap_or(&at.span);
    let what = "this event is not within the future light cone of the one before";
    let help = "a world line is slower than light: give more time or less distance between the two";
    names
        .cx
        .report
        .refuse_two(here, (before, "the one before"), what, help)
}

/// Inertial or accelerated from an event on.
fn from_event(names: &mut Names, at: &At<DiagramLine>) -> Result<Track> {
    let line = &at.value;
    let zero = match &line.at {
        Some(spot) => names.event(spot)?,
        None => Event::ORIGIN,
    };
    let velocity = names.velocity(&line.velocity, &line.relative_to)?;
    if let Some(acceleration) = &line.acceleration {
        let a = names.direction * names.per_metre(&acceleration.value);
        let track = WorldLine::hyperbolic(velocity, zero, a).map(Track::from);
        return track.map_err(|error| names.cx.refuse(acceleration, error.to_string(), ""));
    }
    if let Some(segments) = &line.segments {
        let stretches: Vec<Segment> = segments_of(names, segments)?;
        let track = WorldLine::segments(velocity, zero, &stretches).map(Track::from);
        return track.map_err(|error| refusal(names, segments, &error));
    }
    if let Some(profile) = &line.profile {
        let knots: Vec<(f64, DVec3)> = knots(names, profile);
        let track = WorldLine::profile(velocity, zero, &knots, Axes::Gyroscope).map(Track::from);
        return track.map_err(|error| refusal(names, profile, &error));
    }
    if let Some(circle) = &line.circle {
        return self::circle(names, circle, zero);
    }
    Ok(WorldLine::inertial(velocity, zero).into())
}

fn knots(names: &Names, at: &At<Vec<At<Numbers<2>>>>) -> Vec<(f64, DVec3)> {
    let knots = at.value.iter().map(|knot| knot.value.0);
    // With c = 1 an acceleration is per length.
    let n = names.direction / names.unit;
    knots
        .map(|[time, acceleration]| (time * names.unit, n * acceleration))
        .collect()
}

fn circle(names: &Names, at: &At<LineCircle>, zero: Event<World>) -> Result<Track> {
    let LineCircle { radius, period } = &at.value;
    let metres = |at, name| {
        names
            .cx
            .positive(at, name)
            .map(|number| number * names.unit)
    };
    let (radius, time) = (metres(radius, "`radius`")?, metres(period, "`period`")?);
    let n = names.direction;
    // At `zero` it is farthest along n, so its centre is a radius back; any plane that holds n looks the same from the side.
    let rate = std::f64::consts::TAU / time;
    let track = WorldLine::circular(zero, zero.x - n * radius, n.any_orthogonal_vector(), rate);
    let help = "a world line is slower than light: give a longer period";
    let track = track.map_err(|error| names.cx.refuse(period, error.to_string(), help));
    Ok(track?.into())
}

fn segments_of(names: &Names, at: &At<Vec<At<LineSegment>>>) -> Result<Vec<Segment>> {
    let segment = |segment: &At<LineSegment>| {
        let a = segment.value.acceleration.as_ref();
        let a = a.map_or(0.0, |at| names.per_metre(&at.value));
        let duration = settings::positive(names.cx, &segment.value.duration, "`duration`")?;
        Ok(Segment {
            duration: duration.map_or(f64::INFINITY, |d| d * names.unit),
            acceleration: names.direction * a,
        })
    };
    at.value.iter().map(segment).collect()
}

/// The refusal of a list that gives no world line, at the entry that is to blame.
fn refusal<T>(names: &Names, at: &At<Vec<At<T>>>, error: &WorldLineError) -> Error {
    let entry = error.index().and_then(|i| at.value.get(i));
    let here = entry.map_or(&at.span, |entry| &entry.span);
    let help = "a world line is slower than light, and its times ascend";
    names.cx.report.refuse(here, error.to_string(), help)
}

/// The part from the world time of one event to that of another.
fn ended(names: &mut Names, line: &DiagramLine, track: Track) -> Result<Track> {
    let from = end(names, &line.from, &track)?.unwrap_or(f64::NEG_INFINITY);
    names
        .cx
        .exclusive((&line.to, "to"), (&line.until, "until"))?;
    let to = match &line.until {
        Some(other) => meets(names, other, &track.clone().part([from, f64::INFINITY]))?,
        None => end(names, &line.to, &track)?.unwrap_or(f64::INFINITY),
    };
    if from < to {
        return Ok(track.part([from, to]));
    }
    let what = "this world line ends before it begins";
    let help = "let `from` be before `to`";
    Err(match (&line.to, &line.from) {
        (Some(at), _) | (None, Some(at)) => names.cx.refuse(at, what, help),
        (None, None) => names.cx.refuse(&line.name, what, help),
    })
}

/// The proper time at which `track` crosses the world line `other`.
fn meets(names: &mut Names, other: &At<String>, track: &Track) -> Result<f64> {
    let line = names.track(other)?;
    let moment = meeting(names, track, &line);
    let never = "the two world lines do not meet";
    Ok(found(names, moment, &other.span, never)?.proper_time)
}

fn end(names: &mut Names, spot: &Option<At<Place>>, track: &Track) -> Result<Option<f64>> {
    let Some(at) = spot else { return Ok(None) };
    let event = names.event(at)?;
    let moment = track.where_zero(|e| e.ct - event.ct);
    let moment = moment.ok_or_else(|| {
        let what = "the world line is not there at the time of this event";
        names
            .cx
            .refuse(at, what, "give an event that is between its ends")
    })?;
    Ok(Some(moment.proper_time))
}
