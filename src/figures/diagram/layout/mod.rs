//! The layout of a diagram: data, in the diagram's unit and the view's coordinates.

mod axes;
mod curves;
mod limits;
mod notes;
mod now;
mod solid;
mod types;
mod view;

pub use crate::figures::diagram::model::Kind;
use crate::figures::diagram::model::{Diagram, Segment, SliceKind, Spot};
pub(crate) use axes::tick_step;
pub(crate) use notes::of as notes;
pub use types::{
    Area, Axes, Axis, Bead, Cone, Curve, GridLine, Hyperbola, Interval, Layout, Limits, Nappe,
    Note, Now, Panel, Placed, Plane, Point, Projection, Solid, Tick, WorldLine,
};
pub(crate) use types::{around, number, speed, speed_with_rest};
use view::View;

/// Lays a diagram out, one panel for each of its views.
pub fn layout(diagram: &Diagram) -> Layout {
    let panels: Vec<Panel> = diagram.views.iter().map(|i| panel(diagram, *i)).collect();
    Layout {
        title: diagram.title.clone(),
        notes: notes(diagram, &panels),
        panels,
    }
}

/// The range of a diagram in the coordinates of its frame `index`.
pub(crate) fn limits(diagram: &Diagram, index: usize) -> Limits {
    limits::of(&View::new(diagram, index))
}

/// Positions of the contents of a view in the coordinates of its frame `index`, in the same order for all frames.
pub(crate) fn contents(diagram: &Diagram, index: usize) -> Vec<Point> {
    limits::contents(&View::new(diagram, index))
}

fn panel(diagram: &Diagram, index: usize) -> Panel {
    let view = View::new(diagram, index);
    let limits = limits::of(&view);
    let axes = axes::all(&view, &limits);
    let step = axes::step(&limits);
    let segments = |all: &[Segment]| all.iter().map(|s| s.map(|e| view.point(e))).collect();
    let spots = |all: &[Spot]| all.iter().map(|s| s.map(|e| view.point(e))).collect();
    let world_lines = curves::world_lines(&view, &limits);
    Panel {
        held: None,
        solid: solid::of(&view, &limits, &world_lines, step),
        frame: view.reference.name.clone(),
        grid: axes::grid(&view, &limits),
        world_lines,
        cones: curves::cones(&view, &limits),
        hyperbolae: curves::hyperbolae(&view, &limits),
        curves: curves::drawn(&view),
        areas: curves::areas(&view, &limits),
        slices: slices(&view, &limits),
        planes: solid::planes(&view, &limits),
        signals: segments(&diagram.signals),
        projected: diagram
            .signals
            .iter()
            .map(|s| view.leaves(s.ends))
            .collect(),
        intervals: intervals(&view),
        arrows: segments(&diagram.arrows),
        now: now::of(&view, &limits),
        events: spots(&diagram.events),
        texts: spots(&diagram.texts),
        axes,
        limits,
    }
}

/// Lines of equal time and equal place, clipped.
fn slices(view: &View, limits: &Limits) -> Vec<Segment<Point>> {
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
        let squared = interval.squared / unit / unit;
        let value = number(squared.abs().sqrt());
        let own = match interval.kind {
            Kind::Timelike => format!("Δ*τ* = {value}"),
            Kind::Spacelike => format!("Δ*σ* = {value}"),
            Kind::Null => "Δ*s* = 0".to_string(),
            Kind::Unresolved => format!("|Δ*s*| < {value}"),
        };
        Interval {
            ends: interval.ends.map(|event| view.point(event)),
            squared,
            kind: interval.kind,
            label: interval.label.clone().unwrap_or(own),
            colour: interval.colour,
        }
    });
    intervals.collect()
}
