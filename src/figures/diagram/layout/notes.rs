//! The lines below a diagram.

use glam::DVec3;

use super::types::{Note, Panel, number};
use crate::figures::diagram::model::{Colour, Diagram, Interval, Kind};
use crate::text::rich::escaped;

/// The most world lines that a note names.
const MOST_NAMES: usize = 3;
/// The largest component across an axis of the world of a direction along it: rounding.
const ROUNDING: f64 = 1e-12;

/// What a reader of `diagram` has to know about it, in the order of importance.
pub(crate) fn of(diagram: &Diagram, panels: &[Panel]) -> Vec<Note> {
    let note = |text: String| Note { text, colour: None };
    let mut notes: Vec<Note> = diagram.notes.iter().cloned().map(note).collect();
    notes.extend(projected_lines(diagram, panels).map(note));
    if panels
        .iter()
        .flat_map(|panel| &panel.projected)
        .any(|is| *is)
    {
        notes.push(Note {
            text: "dashed: light outside the plane of the diagram, its projection".into(),
            colour: Some(Colour::Orange),
        });
    }
    let hidden =
        |interval: &Interval| interval.kind == Kind::Unresolved && interval.label.is_none();
    if diagram.intervals.iter().any(hidden) {
        let text = "|Δ*s*| < …: rounding hides it; events of one frame or inertial clock have their interval";
        notes.push(note(text.into()));
    }
    notes.extend(directions(diagram).map(note));
    notes
}

/// The world lines of which projections are drawn.
fn projected_lines(diagram: &Diagram, panels: &[Panel]) -> Option<String> {
    let is_projected = |i: &usize| {
        let mut lines = panels.iter().filter_map(|panel| panel.world_lines.get(*i));
        lines.any(|line| line.projected)
    };
    let lines = (0..diagram.lines.len()).filter(is_projected);
    let lines: Vec<_> = lines.filter_map(|i| diagram.lines.get(i)).collect();
    let names: Vec<String> = lines
        .iter()
        .map(|line| line.label.clone().unwrap_or_else(|| escaped(&line.name)))
        .collect();
    let subject = match &names[..] {
        [] => return None,
        [name] => format!("the world line of {name} leaves"),
        [first @ .., last] if names.len() <= MOST_NAMES => {
            format!("the world lines of {} and {last} leave", first.join(", "))
        }
        all => format!("{} world lines leave", all.len()),
    };
    let (space, whose) = match (diagram.across.is_some(), names.len()) {
        (true, 1) => ("space", "its projection"),
        (true, _) => ("space", "their projections"),
        (false, 1) => ("plane", "its projection"),
        (false, _) => ("plane", "their projections"),
    };
    Some(format!("{subject} the {space} of the diagram: {whose}"))
}

/// Along which directions of the world x and y are measured, if it is not x along x. The labels of axes that say so otherwise are enough.
fn directions(diagram: &Diagram) -> Option<String> {
    let is_said = diagram.labels.is_some() || diagram.meaning.is_some();
    let is_plain = along(diagram.direction) == along(DVec3::X);
    if is_said || is_plain {
        return None;
    }
    let x = along(diagram.direction);
    Some(match diagram.across {
        None => format!("*x* is measured along {x} of the world"),
        Some(across) => {
            let y = along(across);
            format!("*x* is measured along {x} of the world, *y* along {y}")
        }
    })
}

/// A direction of the world: an axis, or its components.
fn along(direction: DVec3) -> String {
    let axes = [("*x*", DVec3::X), ("*y*", DVec3::Y), ("*z*", DVec3::Z)];
    let axis = axes.into_iter().find(|(_, axis)| {
        let across = direction - *axis * axis.dot(direction);
        across.length() < ROUNDING
    });
    match axis {
        Some((name, axis)) if axis.dot(direction) < 0.0 => format!("−{name}"),
        Some((name, _)) => format!("+{name}"),
        None => {
            let parts = direction.to_array().map(|part| {
                // Parts of a unit vector below this are rounding.
                let part = if part.abs() < ROUNDING { 0.0 } else { part };
                number(part).replace('-', "−")
            });
            format!("({})", parts.join(", "))
        }
    }
}
