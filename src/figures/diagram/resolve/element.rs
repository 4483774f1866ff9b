//! Elements drawn between frames, world lines and events.

use std::ops::Range;

use super::event::{at_own_time, found, meeting};
use super::names::Names;
use super::settings::{self, words};
use crate::error::Result;
use crate::figures::diagram::file;
use crate::figures::diagram::model::{
    Cone, Diagram, DrawnCurve, Hyperbola, Interval, Reference, Region, Segment, Side, Slice,
    SliceKind, Spot, Track, Wedge, WorldSheet,
};
use crate::figures::diagram::spot::{OneOrMany, Place};
use crate::scene::{At, Number};
use crate::spacetime::worldline::WorldLine;
use crate::spacetime::{Displacement, Event, InertialFrame, Rest, World};

/// The most signals of one table.
const MOST_SIGNALS: u32 = 1000;

/// Resolves all of `file` into `diagram`, whose names are known.
pub(super) fn resolve_all(
    names: &mut Names,
    file: &file::Diagram,
    diagram: &mut Diagram,
) -> Result<()> {
    diagram.cones = each(&file.light_cone, |at| cone(names, at))?;
    for at in &file.signal {
        diagram.signals.extend(signals(names, at)?);
    }
    let kind = SliceKind::Simultaneity;
    diagram.slices = each(&file.simultaneity, |at| slice(names, at, kind))?;
    let places = each(&file.place, |at| slice(names, at, SliceKind::Place))?;
    diagram.slices.extend(places);
    diagram.intervals = each(&file.interval, |at| interval(names, at))?;
    diagram.hyperbolae = each(&file.hyperbola, |at| hyperbola(names, at))?;
    diagram.curves = each(&file.curve, |at| curve(names, at))?;
    diagram.sheets = each(&file.sheet, |at| sheet(names, at))?;
    diagram.regions = each(&file.region, |at| region(names, at))?;
    diagram.arrows = each(&file.arrow, |at| arrow(names, at))?;
    diagram.wedges = each(&file.wedge, |at| wedge(names, at))?;
    diagram.texts = each(&file.text, |at| text(names, at))?;
    Ok(())
}

fn each<S, T>(all: &[At<S>], resolve: impl FnMut(&At<S>) -> Result<T>) -> Result<Vec<T>> {
    all.iter().map(resolve).collect()
}

fn cone(names: &mut Names, at: &At<file::LightCone>) -> Result<Cone> {
    let cone = &at.value;
    if let (Some(height), None) = (&cone.height, names.across) {
        let what = "in 1+1 dimensions light cones go to the edges";
        let help = "leave `height` out, or write dimensions = \"2+1\" in [diagram]";
        return Err(names.cx.refuse(height, what, help));
    }
    let height = settings::positive(names.cx, &cone.height, "`height`")?;
    Ok(Cone {
        event: names.event(&cone.of)?,
        future: cone.future.unwrap_or(cone.past != Some(true)),
        past: cone.past.unwrap_or(cone.future != Some(true)),
        height: height.map(|height| height * names.unit),
        shade: cone.shade.unwrap_or(false),
    })
}

/// All signals of a table, each from receiver to receiver.
fn signals(names: &mut Names, at: &At<file::Signal>) -> Result<Vec<Segment>> {
    let signal = &at.value;
    let label = words(names.cx, &signal.label)?;
    let receivers = receivers(names, &signal.to)?;
    let emissions = emissions(names, at)?;
    let mut all = Vec::new();
    for &emission in &emissions {
        let mut from = emission;
        for (track, span) in &receivers {
            let received = track.receives_from(from);
            if received.is_none() && emissions.len() > 1 {
                break;
            }
            let never = "light from there never reaches this world line";
            let to = found(names, received, span, never)?.event;
            // Smaller differences are rounding errors of one position.
            if to == from || (to - from).ct < 1e-12 * from.ct.abs() {
                // They meet: there is nothing to send.
                break;
            }
            all.push(Segment {
                ends: [from, to],
                label: label.clone().filter(|_| all.is_empty()),
                colour: signal.colour,
                owner: None,
            });
            from = to;
        }
    }
    if all.is_empty() {
        let what = "no light of these emissions reaches the world line";
        let help = "let it last longer, or bring it nearer";
        return Err(names.cx.refuse(&signal.to, what, help));
    }
    Ok(all)
}

fn receivers(names: &mut Names, to: &At<OneOrMany>) -> Result<Vec<(Track, Range<usize>)>> {
    match &to.value {
        OneOrMany::One(name) => {
            let at = At {
                value: name.clone(),
                span: to.span.clone(),
            };
            Ok(vec![(names.track(&at)?, to.span.clone())])
        }
        OneOrMany::Many(all) => {
            let receiver = |at: &At<String>| Ok((names.track(at)?, at.span.clone()));
            all.iter().map(receiver).collect()
        }
    }
}

/// The events at which a signal is sent: one, or at regular intervals of the emitter's proper time.
fn emissions(names: &mut Names, at: &At<file::Signal>) -> Result<Vec<Event<World>>> {
    let signal = &at.value;
    let cx = names.cx;
    let Some(emitter) = names.emitter(&signal.from)? else {
        if let Some(time) = signal.proper_time.as_ref().or(signal.every.as_ref()) {
            let what = "an event has no clock: this needs a world line in `from`";
            return Err(cx.refuse(time, what, "name the world line that emits the light"));
        }
        return Ok(vec![names.event(&signal.from)?]);
    };
    cx.exclusive(
        (&signal.proper_time, "proper_time"),
        (&signal.every, "every"),
    )?;
    if let Some(time) = &signal.proper_time {
        return Ok(vec![
            at_own_time(names, &emitter, time.value.0, &time.span)?.event,
        ]);
    }
    let Some(every) = settings::positive(cx, &signal.every, "`every`")? else {
        let help = "add proper_time = 1, or every = 1";
        return Err(cx.refuse(&signal.from, "when does this world line emit light?", help));
    };
    let count = count(names, at, &emitter, every * names.unit)?;
    let [first, _] = emitter.span();
    let start = if first.is_finite() { first } else { 0.0 };
    let times = (1..=count).map(|k| start + f64::from(k) * every * names.unit);
    Ok(times
        .filter_map(|time| Some(emitter.at(time)?.event))
        .collect())
}

/// The number of signals: `count`, or as many as fit into the emitter's life.
fn count(names: &Names, at: &At<file::Signal>, emitter: &Track, every: f64) -> Result<u32> {
    let [first, last] = emitter.span();
    // Rounding of the quotient does not lose the last one.
    let alive = ((last - first) / every * (1.0 + 1e-12)).floor();
    let count = match &at.value.count {
        Some(count) => f64::from(count.value).min(alive),
        None => alive,
    };
    if (1.0..=f64::from(MOST_SIGNALS)).contains(&count) {
        return Ok(count as u32);
    }
    let what = match alive.is_finite() {
        true => format!("these are {count} signals"),
        false => "this world line has no end, and would emit light for ever".to_string(),
    };
    let help = format!("give `count`, 1 to {MOST_SIGNALS}");
    Err(names.cx.refuse(at, what, help))
}

fn slice(names: &mut Names, at: &At<file::Slice>, kind: SliceKind) -> Result<Slice> {
    let slice = &at.value;
    let (index, frame) = names.frame(&slice.frame)?;
    let event = names.event(&slice.event)?;
    let to = match &slice.to {
        None => None,
        Some(name) => Some(slice_end(names, name, kind, &frame, event)?),
    };
    Ok(Slice {
        frame: index,
        kind,
        event,
        to,
        label: words(names.cx, &slice.label)?,
        colour: slice.colour,
    })
}

/// Where a line of equal time or place through `event` crosses the world line `name`.
fn slice_end(
    names: &mut Names,
    name: &At<String>,
    kind: SliceKind,
    frame: &InertialFrame<Rest>,
    event: Event<World>,
) -> Result<Event<World>> {
    let track = names.track(name)?;
    let ct = frame.event_from_world(event).ct;
    let moment = match kind {
        SliceKind::Simultaneity => track.at_time(frame, ct),
        SliceKind::Place => {
            let stays = WorldLine::inertial(frame.velocity(), event).into();
            meeting(names, &track, &stays)
        }
    };
    let never = match kind {
        SliceKind::Simultaneity => "the world line is not there at that time of the frame",
        SliceKind::Place => "the world line is never at that place of the frame",
    };
    Ok(found(names, moment, &name.span, never)?.event)
}

fn interval(names: &mut Names, at: &At<file::Interval>) -> Result<Interval> {
    let interval = &at.value;
    // An empty text is an empty label; `None` means the value.
    let label = match &interval.label {
        Some(label) => Some(settings::settable(names.cx, label, &label.value)?),
        None => None,
    };
    let world = Reference::world().frame;
    let from = names.given(&interval.from, &world)?;
    let to = names.given(&interval.to, &world)?;
    let (squared, kind) = from.interval(&to);
    Ok(Interval {
        ends: [from.event, to.event],
        squared,
        kind,
        label,
        colour: interval.colour,
    })
}

/// The hyperbola of one interval about an event, by an event on it, by a proper time or by a proper length.
fn hyperbola(names: &mut Names, at: &At<file::Hyperbola>) -> Result<Hyperbola> {
    let said = &at.value;
    let cx = names.cx;
    cx.exclusive(
        (&said.through, "through"),
        (&said.proper_time, "proper_time"),
    )?;
    cx.exclusive(
        (&said.through, "through"),
        (&said.proper_length, "proper_length"),
    )?;
    let (time, length) = (&said.proper_time, &said.proper_length);
    cx.exclusive((time, "proper_time"), (length, "proper_length"))?;
    let about = match &said.about {
        Some(spot) => names.event(spot)?,
        None => Event::ORIGIN,
    };
    let n = names.direction;
    let to_vertex = match (&said.through, time, length) {
        (Some(spot), ..) => to_vertex(names, about, spot)?,
        (_, Some(time), _) => Displacement::new(nonzero(names, time)?, n * 0.0),
        (.., Some(length)) => Displacement::new(0.0, n * nonzero(names, length)?),
        _ => {
            let help = "add through = \"A\", proper_time = 1 or proper_length = 1";
            return Err(cx.refuse(at, "this hyperbola has no interval", help));
        }
    };
    Ok(Hyperbola {
        about,
        vertex: about + to_vertex,
        label: words(cx, &said.label)?,
        colour: said.colour,
    })
}

/// From `about` to the vertex of the hyperbola through `spot`: of the same interval, along an axis.
fn to_vertex(
    names: &mut Names,
    about: Event<World>,
    spot: &At<Place>,
) -> Result<Displacement<World>> {
    let n = names.direction;
    let step = names.event(spot)? - about;
    let x = n.dot(step.x);
    // As a product, which does not cancel near the light cone.
    let squared = (step.ct - x) * (step.ct + x);
    if squared > 0.0 {
        return Ok(Displacement::new(squared.sqrt().copysign(step.ct), n * 0.0));
    }
    if squared < 0.0 {
        return Ok(Displacement::new(0.0, n * (-squared).sqrt().copysign(x)));
    }
    let what =
        "this event is on the light cone: its interval is 0, and no hyperbola goes through it";
    Err(names.cx.refuse(spot, what, "name another event"))
}

fn nonzero(names: &Names, at: &At<Number>) -> Result<f64> {
    match at.value.0 {
        0.0 => {
            let what = "an interval of 0 is the light cone, which is not a hyperbola";
            Err(names.cx.refuse(at, what, "give another number"))
        }
        number => Ok(number * names.unit),
    }
}

fn curve(names: &mut Names, at: &At<file::DrawnCurve>) -> Result<DrawnCurve> {
    let through = &at.value.through;
    if through.value.len() < 2 {
        let what = "a curve goes through at least two events";
        return Err(names.cx.refuse(through, what, "name more events"));
    }
    Ok(DrawnCurve {
        points: each(&through.value, |spot| names.event(spot))?,
        dashed: at.value.dashed.unwrap_or(false),
        label: words(names.cx, &at.value.label)?,
        colour: at.value.colour,
    })
}

fn sheet(names: &mut Names, at: &At<file::Sheet>) -> Result<WorldSheet> {
    let [a, b] = &at.value.between.value;
    Ok(WorldSheet {
        between: [names.line_named(a)?, names.line_named(b)?],
        label: words(names.cx, &at.value.label)?,
        colour: at.value.colour,
    })
}

fn region(names: &mut Names, at: &At<file::Region>) -> Result<Region> {
    let corners = &at.value.corners;
    if corners.value.len() < 3 {
        let what = "a region has at least three corners";
        return Err(names.cx.refuse(corners, what, "name more events"));
    }
    Ok(Region {
        corners: each(&corners.value, |spot| names.event(spot))?,
        label: words(names.cx, &at.value.label)?,
        colour: at.value.colour,
    })
}

/// An arrow between two events, or the four-velocity of a world line at one of its times.
fn arrow(names: &mut Names, at: &At<file::Arrow>) -> Result<Segment> {
    let arrow = &at.value;
    let cx = names.cx;
    cx.exclusive((&arrow.of, "of"), (&arrow.from, "from"))?;
    let (from, to, line) = match (&arrow.of, &arrow.from, &arrow.to) {
        (Some(of), ..) => {
            let track = names.track(of)?;
            let time = arrow.proper_time.as_ref();
            let span = time.map_or(&of.span, |at| &at.span);
            let moment = at_own_time(names, &track, time.map_or(0.0, |at| at.value.0), span)?;
            let length = settings::positive(cx, &arrow.length, "`length`")?.unwrap_or(1.0);
            let frame = moment.frame();
            let ahead = Displacement::new(length * names.unit, glam::DVec3::ZERO);
            let to = moment.event + frame.world_from_frame().displacement(ahead);
            (moment.event, to, names.line_named(of).ok())
        }
        (None, Some(from), Some(to)) => {
            let (start, end) = (names.event(from)?, names.event(to)?);
            if start == end {
                let what = "this arrow ends where it begins, and has no direction";
                return Err(cx.refuse(to, what, "name another event"));
            }
            (start, end, None)
        }
        _ => {
            let help = "give `of`, or `from` and `to`";
            return Err(cx.refuse(at, "this arrow goes nowhere", help));
        }
    };
    Ok(Segment {
        ends: [from, to],
        label: words(cx, &arrow.label)?,
        colour: arrow.colour,
        owner: line,
    })
}

fn wedge(names: &mut Names, at: &At<file::Wedge>) -> Result<Wedge> {
    let side = at.value.side.as_ref().map(|at| at.value);
    Ok(Wedge {
        event: names.event(&at.value.of)?,
        side: side.unwrap_or(Side::Right),
        label: words(names.cx, &at.value.label)?,
        colour: at.value.colour,
    })
}

fn text(names: &mut Names, at: &At<file::Text>) -> Result<Spot> {
    let text = &at.value.text;
    let label = settings::settable(names.cx, text, names.cx.text(text, "the text")?)?;
    Ok(Spot {
        name: String::new(),
        at: names.event(&at.value.at)?,
        label: Some(label),
        dot: false,
        colour: at.value.colour,
    })
}
