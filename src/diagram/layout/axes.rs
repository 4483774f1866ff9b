//! Axes and grids of frames.
//!
//! One unit of a moving frame's axes is where the hyperbola of interval 1 about its origin crosses them.

use super::limits::Limits;
use super::types::{Axes, Axis, GridLine, Point, Tick, number};
use super::view::View;
use crate::scene::model::diagram::Reference;

/// About how many ticks the longer side of a diagram has.
const TICKS: f64 = 7.0;
/// The most ticks of an axis.
const MOST: i64 = 400;

/// The distance of ticks: 1, 2 or 5 times a power of ten.
pub(super) fn step(limits: &Limits) -> f64 {
    let [width, height] = limits.size();
    let rough = width.max(height) / TICKS;
    let power = libm::pow(10.0, libm::floor(libm::log10(rough)));
    let factors = [1.0, 2.0, 5.0, 10.0].into_iter();
    let steps = factors.map(|factor| factor * power);
    steps
        .clone()
        .find(|step| *step >= 0.999 * rough)
        .unwrap_or(power)
}

/// The axes of the view, and those of all frames that have some.
pub(super) fn all(view: &View, limits: &Limits) -> Vec<Axes> {
    // Those of a view on its way from frame to frame would be nobody's.
    let passing = view.diagram.is_passing(view.index);
    let own = (!passing).then(|| own_axes(view, limits)).into_iter();
    let frames = view.diagram.frames.iter().enumerate();
    // Of the world's axes there is something to compare with where others have some.
    let moving = passing || view.diagram.frames.iter().skip(1).any(|frame| frame.axes);
    let others = frames.filter(|(i, frame)| *i != view.index && frame.axes && moving);
    let others = others.filter_map(|(i, frame)| axes(view, limits, i, frame));
    own.chain(others).collect()
}

/// The view's own: through its origin, or along the edges where that is out of sight.
fn own_axes(view: &View, limits: &Limits) -> Axes {
    let within = |[low, high]: [f64; 2]| if low < 0.0 && high > 0.0 { 0.0 } else { low };
    let origin = Point::new(within(limits.ct), within(limits.x));
    let step = view
        .reference
        .ticks
        .map(|ticks| ticks / view.diagram.unit.metres);
    let step = step.unwrap_or_else(|| self::step(limits));
    let labels = labels(view, &view.reference);
    let axis = |along: Point, range: [f64; 2], label: String| {
        let at = |value: f64| match along.ct == 1.0 {
            true => Point::new(value, origin.x),
            false => Point::new(origin.ct, value),
        };
        let ticks = multiples(step, range).filter(|value| *value != 0.0);
        let tick = |value: f64| Tick {
            at: at(value),
            value,
            along,
            label: Some(number(value)),
        };
        Axis {
            ends: range.map(at),
            label,
            ticks: ticks.map(tick).collect(),
        }
    };
    let [time, space] = labels;
    Axes {
        frame: view.index,
        time: axis(Point::new(1.0, 0.0), limits.ct, time),
        space: axis(Point::new(0.0, 1.0), limits.x, space),
        colour: view.reference.colour,
    }
}

fn axes(view: &View, limits: &Limits, index: usize, frame: &Reference) -> Option<Axes> {
    let origin = view.origin_of(index);
    let ticks = frame.ticks.map(|ticks| ticks / view.diagram.unit.metres);
    let step = ticks.unwrap_or_else(|| self::step(limits));
    let [time, space] = view.axes_of(index);
    let axis = |along: Point, label: String| {
        let ends = limits.line(origin, along)?;
        let value = |end: Point| {
            let way = end.from(origin);
            let larger = along.ct.abs() > along.x.abs();
            if larger {
                way.ct / along.ct
            } else {
                way.x / along.x
            }
        };
        let ticks = multiples(step, ends.map(value)).filter(|value| *value != 0.0);
        let tick = |value: f64| Tick {
            at: origin.plus(value, along),
            value,
            along,
            label: ticks_labelled(frame).then(|| number(value)),
        };
        Some(Axis {
            ends,
            label,
            ticks: ticks.map(tick).collect(),
        })
    };
    let [time_label, space_label] = labels(view, frame);
    Some(Axes {
        frame: index,
        time: axis(time, time_label)?,
        space: axis(space, space_label)?,
        colour: frame.colour,
    })
}

/// Whether the ticks of a moving frame have numbers: where it says how far apart they are.
fn ticks_labelled(frame: &Reference) -> bool {
    frame.ticks.is_some()
}

/// Multiples of `step` within a range.
fn multiples(step: f64, [low, high]: [f64; 2]) -> impl Iterator<Item = f64> {
    let rounding = 1e-9;
    let first = libm::ceil(low / step - rounding);
    let last = libm::floor(high / step + rounding);
    let count = if last - first < MOST as f64 {
        (last - first) as i64
    } else {
        -1
    };
    (0..=count).map(move |k| (first + k as f64) * step)
}

/// What stands at the two axes of a frame: a prime for each of its name, or else the name below.
fn labels(view: &View, frame: &Reference) -> [String; 2] {
    let name = frame.name.as_str();
    let bare = name.trim_end_matches(['\'', '′']);
    let below = match (name, bare) {
        ("world", _) => String::new(),
        (_, bare) if bare.len() < name.len() => {
            "'".repeat(name.chars().count() - bare.chars().count())
        }
        _ => format!("_{{{name}}}"),
    };
    let unit = view.diagram.unit;
    let time = if unit.is_time { "*t*" } else { "*ct*" };
    let own = frame.name == view.reference.name || view.diagram.is_passing(view.index);
    let units = match (unit.names, own) {
        (Some(names), true) => names.map(|name| format!(" ({name})")),
        _ => [String::new(), String::new()],
    };
    let [time_unit, space_unit] = units;
    [
        format!("{time}{below}{time_unit}"),
        format!("*x*{below}{space_unit}"),
    ]
}

/// The lines of equal time and place of frames with a grid, and of the view where the style has one.
pub(super) fn grid(view: &View, limits: &Limits, step: f64) -> Vec<GridLine> {
    let mut lines = Vec::new();
    for (i, frame) in view.diagram.frames.iter().enumerate() {
        let own = i == view.index;
        if frame.grid || own && view.diagram.style.grid {
            let ticks = frame.ticks.map(|ticks| ticks / view.diagram.unit.metres);
            lines.extend(grid_of(view, limits, i, ticks.unwrap_or(step)));
        }
    }
    lines
}

fn grid_of(view: &View, limits: &Limits, index: usize, step: f64) -> Vec<GridLine> {
    let origin = view.origin_of(index);
    let [time, space] = view.axes_of(index);
    // All of its lines that meet the rectangle cross one of its axes no farther away than this.
    let far = limits.beyond(origin) / (1.0 - (space.ct / space.x).abs()).max(1e-3);
    let most = (MOST / 4) as f64;
    let count = (far / step).min(most) as i64;
    let mut lines = Vec::new();
    for (across, along) in [(time, space), (space, time)] {
        let ends = (-count..=count).filter_map(|k| {
            let at = origin.plus(k as f64 * step, across);
            limits.line(at, along)
        });
        lines.extend(ends.map(|ends| GridLine { frame: index, ends }));
    }
    lines
}
