//! Space-time diagrams: layout, drawing, and errors.

mod axes;
mod beyond;
mod classic;
mod labels;
mod lines;
mod notes;
mod palette;
mod refused;
mod series;
mod solid;
mod words;

use std::path::Path;

use nullray::Result;
use nullray::figures::diagram::model::Diagram;
use nullray::figures::diagram::{Layout, Panel, Point};
use nullray::scene::Overrides;

fn parsed(text: &str) -> Result<Diagram> {
    nullray::figures::diagram::parse(text, "test", Path::new(""), &Overrides::default())
}

fn laid_out(body: &str) -> Layout {
    let text = format!("[diagram]\n{body}");
    nullray::figures::diagram::layout(&parsed(&text).unwrap_or_else(|error| panic!("{error}")))
}

fn panel(body: &str) -> Panel {
    laid_out(body).panels.remove(0)
}

/// Where the event of this label is.
fn event(panel: &Panel, name: &str) -> Point {
    let found = panel
        .events
        .iter()
        .find(|e| e.label.as_deref() == Some(name));
    found.unwrap_or_else(|| panic!("no event {name}")).at
}

#[track_caller]
fn near(p: Point, ct: f64, x: f64) {
    let scale = 1f64.max(ct.abs()).max(x.abs());
    let error = (p.ct - ct).abs().max((p.x - x).abs());
    assert!(error <= 1e-12 * scale, "{p:?} is not ({ct}, {x})");
}

#[track_caller]
fn slope(ends: [Point; 2]) -> f64 {
    (ends[1].ct - ends[0].ct) / (ends[1].x - ends[0].x)
}
