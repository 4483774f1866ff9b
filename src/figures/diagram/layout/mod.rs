//! What a diagram shows, and where: data, in the diagram's unit and the view's coordinates.

mod axes;
mod curves;
mod limits;
mod now;
mod solid;
mod types;
mod view;

use crate::figures::diagram::model::{Diagram, SliceKind};
pub(crate) use axes::round_step;
pub(crate) use types::number;
pub use types::{
    Area, Axes, Axis, Bead, Cone, Curve, GridLine, Hyperbola, Interval, Kind, Layout, Limits,
    Nappe, Now, Panel, Placed, Plane, Point, Segment, Solid, Spot, Tick, WorldLine,
};
use view::View;

/// Lays a diagram out, one panel for each of its views.
pub fn layout(diagram: &Diagram) -> Layout {
    Layout {
        title: diagram.title.clone(),
        panels: diagram.views.iter().map(|i| panel(diagram, *i)).collect(),
    }
}

/// What a diagram shows in the coordinates of its frame `index`.
pub(crate) fn limits(diagram: &Diagram, index: usize) -> Limits {
    limits::of(&View::new(diagram, index))
}

fn panel(diagram: &Diagram, index: usize) -> Panel {
    let view = View::new(diagram, index);
    let limits = limits::of(&view);
    let axes = axes::all(&view, &limits);
    let step = axes::step(&limits);
    let world_lines = curves::world_lines(&view, &limits);
    Panel {
        solid: solid::of(&view, &limits, &world_lines, step),
        frame: view.reference.name.clone(),
        grid: axes::grid(&view, &limits, step),
        world_lines,
        cones: curves::cones(&view, &limits),
        hyperbolae: curves::hyperbolae(&view, &limits),
        areas: curves::areas(&view, &limits),
        slices: slices(&view, &limits),
        planes: solid::planes(&view, &limits),
        signals: signals(&view),
        intervals: intervals(&view),
        arrows: arrows(&view),
        now: now::of(&view, &limits),
        events: events(&view),
        texts: texts(&view),
        axes,
        limits,
    }
}

fn events(view: &View) -> Vec<Spot> {
    let marks = view.diagram.events.iter();
    let spot = |mark: &crate::figures::diagram::model::Mark| Spot {
        at: view.point(mark.event),
        label: mark.label.clone(),
        dot: mark.dot,
        colour: None,
    };
    marks.map(spot).collect()
}

fn texts(view: &View) -> Vec<Spot> {
    let words = view.diagram.texts.iter().map(|words| Spot {
        at: view.point(words.at),
        label: Some(words.text.clone()),
        dot: false,
        colour: words.colour,
    });
    words.collect()
}

fn signals(view: &View) -> Vec<Segment> {
    let signals = view.diagram.signals.iter().map(|signal| Segment {
        ends: [view.point(signal.from), view.point(signal.to)],
        label: signal.label.clone(),
        colour: signal.colour,
        owner: None,
    });
    signals.collect()
}

fn arrows(view: &View) -> Vec<Segment> {
    let arrows = view.diagram.arrows.iter().map(|arrow| Segment {
        ends: [view.point(arrow.from), view.point(arrow.to)],
        label: arrow.label.clone(),
        colour: arrow.colour,
        owner: arrow.line,
    });
    arrows.collect()
}

/// Lines of equal time and equal place, clipped.
fn slices(view: &View, limits: &Limits) -> Vec<Segment> {
    let frame_colour = |i: usize| view.diagram.frames.get(i).and_then(|frame| frame.colour);
    let lines = view.diagram.slices.iter();
    let slices = lines
        .filter(|slice| !solid::is_plane(view, slice))
        .filter_map(|slice| {
            let at = view.point(slice.event);
            let [time, space] = view.axes_of(slice.frame);
            let along = match slice.kind {
                SliceKind::Simultaneity => space,
                SliceKind::Place => time,
            };
            let ends = match slice.to {
                Some(to) => [at, view.point(to)],
                None => limits.line(at, along)?,
            };
            Some(Segment {
                ends,
                label: slice.label.clone(),
                colour: slice.colour.or(frame_colour(slice.frame)),
                owner: Some(slice.frame),
            })
        });
    slices.collect()
}

fn intervals(view: &View) -> Vec<Interval> {
    let unit = view.diagram.unit.metres;
    let intervals = view.diagram.intervals.iter().map(|interval| {
        let step = interval.to - interval.from;
        let squared = step.interval() / unit / unit;
        // What rounding leaves of a null interval, in parts of what it is the difference of.
        let rounding = 1e-12 * (step.ct.abs() + step.x.length()).powi(2) / unit / unit;
        let kind = match squared {
            s if s.abs() <= rounding => Kind::Null,
            s if s > 0.0 => Kind::Timelike,
            _ => Kind::Spacelike,
        };
        let value = squared.abs().sqrt();
        Interval {
            ends: [view.point(interval.from), view.point(interval.to)],
            squared,
            kind,
            label: interval.label.clone().unwrap_or_else(|| kind.label(value)),
            colour: interval.colour,
        }
    });
    intervals.collect()
}
