//! Lines of simultaneity in a frame, and the clocks there.

use super::types::Limits;
use super::types::{Bead, Now};
use super::view::View;
use crate::figures::diagram::model;
use crate::spacetime::Event;

pub(super) fn of(view: &View, limits: &Limits) -> Option<Now> {
    let now = view.diagram.now?;
    let frame = View::new(view.diagram, now.frame).reference.frame;
    let at = view.point(frame.event_to_world(Event::new(now.ct, glam::DVec3::ZERO)));
    let [_, along] = view.axes_of(now.frame);
    let lines = view.diagram.lines.iter().enumerate();
    let beads = lines.filter_map(|(i, line)| {
        let moment = line.track.at_time(&frame, now.ct)?;
        let proper_time = moment.proper_time / view.diagram.unit.metres;
        Some(Bead {
            line: i,
            at: view.point(moment.event),
            proper_time,
            label: line.ticks.map(|_| reading(&now, proper_time)),
        })
    });
    Some(Now {
        frame: now.frame,
        ends: limits.line(at, along)?,
        beads: beads.filter(|bead| limits.contains(bead.at)).collect(),
        colour: now.colour,
    })
}

/// With as many decimals as all readings of a series.
fn reading(now: &model::Now, proper_time: f64) -> String {
    let decimals = now.decimals;
    let text = format!("{proper_time:.decimals$}");
    match text
        .trim_start_matches('-')
        .bytes()
        .all(|c| b"0.".contains(&c))
    {
        true => text.trim_start_matches('-').into(),
        false => text,
    }
}
