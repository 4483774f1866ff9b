//! Axes and grids of frames.
//!
//! One unit of a moving frame's axes is where the hyperbola of interval 1 about its origin crosses them.

use super::types::Limits;
use super::types::{Axes, Axis, GridLine, Point, Tick, number};
use super::view::View;
use crate::figures::diagram::model::Reference;
use crate::figures::ticks::round_step;

/// The approximate number of ticks along the longer side of a diagram.
const TICKS: f64 = 7.0;
/// How much closer together the ticks of other frames may be.
const CLOSEST: f64 = 2.6;
/// The most ticks of an axis.
const MOST: i64 = 400;

/// The distance of ticks: 1, 2 or 5 times a power of ten.
pub(super) fn step(limits: &Limits) -> f64 {
    let [width, height] = limits.size();
    tick_step(width.max(height) / TICKS)
}

/// The next of 1, 2, 5 times a power of ten that is not below `rough`, or hardly.
pub(crate) fn tick_step(rough: f64) -> f64 {
    round_step(0.999 * rough)
}

/// The tick distance of a frame: its own; or that of all others, if these are equal and not too close for the diagram; or that of the
/// diagram.
fn step_of(view: &View, frame: &Reference, limits: &Limits) -> f64 {
    let unit = view.diagram.unit.metres;
    let mut others = view.diagram.frames.iter().skip(1).filter(|it| it.axes);
    let first = others.next().and_then(|it| it.ticks);
    let common = first.filter(|_| others.all(|it| it.ticks == first));
    let common = common.filter(|ticks| ticks / unit >= step(limits) / CLOSEST);
    let said = frame.ticks.or(common).map(|ticks| ticks / unit);
    said.unwrap_or_else(|| step(limits))
}

/// The axes of the view, and those of all frames that have some.
pub(super) fn all(view: &View, limits: &Limits) -> Vec<Axes> {
    // Those of a view on its way from frame to frame would be nobody's.
    let passing = view.diagram.is_passing(view.index);
    let own = (!passing).then(|| match view.is_solid() {
        true => room_axes(view, limits),
        false => own_axes(view, limits),
    });
    let own = own.into_iter();
    let frames = view.diagram.frames.iter().enumerate();
    // The world's axes have ticks for comparison if others have some.
    let moving = passing || view.diagram.frames.iter().skip(1).any(|frame| frame.axes);
    let others = frames.filter(|(i, frame)| *i != view.index && frame.axes && moving);
    let others = others.filter_map(|(i, frame)| axes(view, limits, i, frame));
    own.chain(others).collect()
}

/// The view's own axes: through its origin, or along the edges if that is out of sight.
fn own_axes(view: &View, limits: &Limits) -> Axes {
    // Through 0 if it is in view.
    let within = |[low, high]: [f64; 2]| if low < 0.0 && high > 0.0 { 0.0 } else { low };
    let origin = Point::new(within(limits.ct), within(limits.x));
    let step = step_of(view, &view.reference, limits);
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
    let [time, space, _] = labels;
    Axes {
        frame: view.index,
        time: axis(Point::new(1.0, 0.0), limits.ct, time),
        space: axis(Point::new(0.0, 1.0), limits.x, space),
        depth: None,
        colour: view.reference.colour,
    }
}

/// The view's own in 2+1 dimensions: ct along the leftmost edge of the room, x along the near edge of its
/// floor, y along the right one.
fn room_axes(view: &View, limits: &Limits) -> Axes {
    let corner = Point::deep(limits.ct[0], limits.x[0], limits.y[0]);
    let right = Point {
        x: limits.x[1],
        ..corner
    };
    let left = Point {
        y: limits.y[1],
        ..corner
    };
    let step = step_of(view, &view.reference, limits);
    let axis = |corner: Point, along: Point, [low, high]: [f64; 2], label: String| {
        let at = |value: f64| corner.plus(value - low, along);
        let tick = |value: f64| Tick {
            at: at(value),
            value,
            along,
            label: Some(number(value)),
        };
        // Those close to the corners are on other edges, too.
        let clear = 0.03 * (high - low);
        let inner = |value: &f64| (low + clear..=high - clear).contains(value);
        Axis {
            ends: [at(low), at(high)],
            label,
            ticks: multiples(step, [low, high])
                .filter(inner)
                .map(tick)
                .collect(),
        }
    };
    let [time, space, depth] = labels(view, &view.reference);
    Axes {
        frame: view.index,
        time: axis(left, Point::new(1.0, 0.0), limits.ct, time),
        space: axis(corner, Point::new(0.0, 1.0), limits.x, space),
        depth: Some(axis(right, Point::deep(0.0, 0.0, 1.0), limits.y, depth)),
        colour: view.reference.colour,
    }
}

fn axes(view: &View, limits: &Limits, index: usize, frame: &Reference) -> Option<Axes> {
    let origin = view.origin_of(index);
    let step = step_of(view, frame, limits);
    let [time, space] = view.axes_of(index);
    // A moving frame's ticks have numbers if their distance is given, or if there is room for them.
    let moving = view.diagram.frames.iter().enumerate();
    let mut moving = moving.filter(|(i, other)| *i != view.index && other.axes);
    let numbered = match index {
        0 => {
            let passing = view.diagram.is_passing(view.index);
            passing || moving.all(|(i, other)| i == 0 || other.ticks.is_some())
        }
        _ => frame.ticks.is_some() || moving.filter(|(i, _)| *i > 0).count() == 1,
    };
    let axis = |along: Point, label: String| {
        let ends = limits.line(origin, along)?;
        let value = |end: Point| {
            let way = end.from(origin);
            let parts = [(way.ct, along.ct), (way.x, along.x), (way.y, along.y)];
            let longest = |a: &(f64, f64), b: &(f64, f64)| a.1.abs().total_cmp(&b.1.abs());
            let (way, along) = parts.into_iter().max_by(longest).unwrap_or((0.0, 1.0));
            way / along
        };
        let ticks = multiples(step, ends.map(value)).filter(|value| *value != 0.0);
        let tick = |value: f64| Tick {
            at: origin.plus(value, along),
            value,
            along,
            label: numbered.then(|| number(value)),
        };
        Some(Axis {
            ends,
            label,
            ticks: ticks.map(tick).collect(),
        })
    };
    let [time_label, space_label, depth_label] = labels(view, frame);
    let depth = view.depth_of(index);
    Some(Axes {
        frame: index,
        time: axis(time, time_label)?,
        space: axis(space, space_label)?,
        depth: depth.and_then(|depth| axis(depth, depth_label)),
        colour: frame.colour,
    })
}

/// Multiples of `step` within a range.
pub(super) fn multiples(step: f64, [low, high]: [f64; 2]) -> impl Iterator<Item = f64> {
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

/// The labels at the axes of a frame, time first: a prime for each in its name, or else the name as an index; and the meaning of x at the
/// view's own.
fn labels(view: &View, frame: &Reference) -> [String; 3] {
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
    if let (Some([time, space]), true) = (&view.diagram.labels, own) {
        return [time.clone(), space.clone(), format!("*y*{below}")];
    }
    let [time_unit, space_unit] = units;
    let meaning = match &view.diagram.meaning {
        Some(words) if own => format!(", {words}"),
        _ => String::new(),
    };
    [
        format!("{time}{below}{time_unit}"),
        format!("*x*{below}{space_unit}{meaning}"),
        format!("*y*{below}{space_unit}"),
    ]
}

/// The lines of equal time and position of frames with a grid, and of the view if the style has one.
pub(super) fn grid(view: &View, limits: &Limits) -> Vec<GridLine> {
    let mut lines = Vec::new();
    for (i, frame) in view.diagram.frames.iter().enumerate() {
        let own = i == view.index;
        if frame.grid || own && view.diagram.style.grid {
            let step = step_of(view, frame, limits);
            lines.extend(grid_of(view, limits, i, step));
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
        // Where its axes are drawn, there is no grid line.
        let axes = view.index == index || view.diagram.frames.get(index).is_some_and(|f| f.axes);
        let all = (-count..=count).filter(|k| *k != 0 || !axes);
        let ends = all.filter_map(|k| {
            let at = origin.plus(k as f64 * step, across);
            limits.line(at, along)
        });
        lines.extend(ends.map(|ends| GridLine { frame: index, ends }));
    }
    lines
}
