//! Where a panel is on its page.

use crate::diagram::layout::{Limits, Panel, Point};
use crate::drawing::Path;
use crate::scene::model::diagram::Style;
use crate::text::Rect;

/// Width of a view, points: 120 mm.
const WIDTH: f64 = 340.0;
/// The highest view, in parts of its width.
const HIGHEST: f64 = 1.3;

/// The page, in points.
pub(super) struct Page {
    pub width: f64,
    pub height: f64,
    pub frames: Vec<Map>,
}

/// The place of a panel: page coordinates from the diagram's.
pub(super) struct Map {
    limits: Limits,
    left: f64,
    top: f64,
    /// Points of a unit, the same for ct and x.
    pub scale: f64,
}

impl Page {
    /// A page for `panels`, with `head` points above and `foot` below them.
    pub fn new(panels: &[Panel], style: &Style, head: f64, foot: f64) -> Page {
        let count = panels.len().max(1) as f64;
        let em = style.font_size;
        // Views side by side are named above.
        let names = if panels.len() > 1 { 1.1 * em } else { 0.0 };
        let [side, above, below] = [1.8 * em, 1.1 * em + names, 1.2 * em];
        let width = style.width.unwrap_or(WIDTH * count);
        let cell = width / count;
        let room = (cell - 2.0 * side).max(1.0);
        let highest = match style.height {
            Some(height) => (height - head - foot - above - below).max(1.0),
            None => HIGHEST * room,
        };
        let scale = |panel: &Panel| {
            let [w, h] = panel.limits.size();
            (room / w).min(highest / h)
        };
        let heights = panels
            .iter()
            .map(|panel| panel.limits.size()[1] * scale(panel));
        let tallest = heights.fold(0.0, f64::max);
        let frames = panels.iter().enumerate().map(|(i, panel)| {
            let w = panel.limits.size()[0] * scale(panel);
            Map {
                limits: panel.limits,
                left: cell * (i as f64 + 0.5) - 0.5 * w,
                top: head + above,
                scale: scale(panel),
            }
        });
        Page {
            frames: frames.collect(),
            width,
            height: style
                .height
                .unwrap_or(head + above + tallest + below + foot),
        }
    }
}

impl Map {
    pub fn at(&self, p: Point) -> [f64; 2] {
        [
            self.left + (p.x - self.limits.x[0]) * self.scale,
            self.top + (self.limits.ct[1] - p.ct) * self.scale,
        ]
    }

    /// The panel's rectangle.
    pub fn rect(&self) -> Rect {
        let Limits { x, ct } = self.limits;
        Rect {
            min: self.at(Point::new(ct[1], x[0])),
            max: self.at(Point::new(ct[0], x[1])),
        }
    }

    pub fn points(&self, points: &[Point]) -> Vec<[f64; 2]> {
        points.iter().map(|p| self.at(*p)).collect()
    }

    pub fn polyline(&self, points: &[Point]) -> Path {
        Path::polyline(&self.points(points))
    }
}
