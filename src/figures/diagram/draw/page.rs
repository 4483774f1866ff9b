//! The position of a panel on its page.

use crate::figures::diagram::layout::{Panel, Point, Projection};
use crate::figures::diagram::model::Style;
use crate::figures::drawing::Path;
use crate::text::Rect;

/// Width of a view, points: 120 mm.
pub(in crate::figures::diagram) const WIDTH: f64 = 340.0;
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
    projection: Projection,
    /// The rectangle, in the diagram's unit: from left to right, and from bottom to top.
    page: [[f64; 2]; 2],
    left: f64,
    top: f64,
    /// Points of a unit, the same for ct and x.
    pub scale: f64,
}

impl Page {
    /// A page for `panels`, with `head` points above and `foot` below them.
    pub fn new(panels: &[Panel], style: &Style, head: f64, foot: f64) -> Page {
        let columns = columns(panels.len(), style);
        let rows = panels.len().max(1).div_ceil(columns) as f64;
        let em = style.font_size;
        // The axes of a room are along its edges, and their labels beyond.
        let room = panels.iter().any(|panel| panel.solid.is_some());
        let below = if room { 2.6 * em } else { 1.2 * em };
        let side = if room { 2.8 * em } else { 1.8 * em };
        // Several views are named above.
        let names = if panels.len() > 1 { 1.1 * em } else { 0.0 };
        let above = 1.1 * em + names;
        let width = width(panels.len(), style);
        let cell = width / columns as f64;
        let width_left = (cell - 2.0 * side).max(1.0);
        let highest = match style.height {
            Some(height) => ((height - head - foot) / rows - above - below).max(1.0),
            None => HIGHEST * width_left,
        };
        // Lengths of several views can be compared: they have one scale.
        let scales = panels.iter().map(|panel| {
            let [w, h] = extent(panel);
            (width_left / w).min(highest / h)
        });
        let scale = scales.fold(f64::INFINITY, f64::min);
        let heights = panels.iter().map(|panel| extent(panel)[1] * scale);
        let tallest = heights.fold(0.0, f64::max);
        let line = above + tallest + below;
        let frames = panels.iter().enumerate().map(|(i, panel)| {
            let [w, h] = extent(panel).map(|side| side * scale);
            let (row, column) = (i / columns, i % columns);
            Map {
                projection: panel.projection(),
                page: panel.page(),
                left: cell * (column as f64 + 0.5) - 0.5 * w,
                top: head + row as f64 * line + above + tallest - h,
                scale,
            }
        });
        Page {
            frames: frames.collect(),
            width,
            height: style.height.unwrap_or(head + rows * line + foot),
        }
    }
}

/// How many of `panels` views stand side by side.
fn columns(panels: usize, style: &Style) -> usize {
    let columns = style.columns.map_or(usize::MAX, |columns| columns as usize);
    columns.clamp(1, panels.max(1))
}

/// Width of a page for `panels` views, points.
pub(super) fn width(panels: usize, style: &Style) -> f64 {
    let default = WIDTH * columns(panels, style) as f64;
    style.width.unwrap_or(default)
}

/// Width and height on the page, in the diagram's unit.
fn extent(panel: &Panel) -> [f64; 2] {
    panel.page().map(|[from, to]| to - from)
}

impl Map {
    /// The direction of a vector on the page, to the right and upwards.
    pub fn direction(&self, along: Point) -> [f64; 2] {
        let [right, up] = along.page(self.projection);
        let length = right.hypot(up).max(f64::MIN_POSITIVE);
        [right / length, up / length]
    }

    pub fn at(&self, p: Point) -> [f64; 2] {
        let [right, up] = p.page(self.projection);
        let [[left, _], [_, top]] = self.page;
        [
            self.left + (right - left) * self.scale,
            self.top + (top - up) * self.scale,
        ]
    }

    /// The panel's rectangle.
    pub fn rect(&self) -> Rect {
        let [width, height] = self.page.map(|[from, to]| (to - from) * self.scale);
        Rect {
            min: [self.left, self.top],
            max: [self.left + width, self.top + height],
        }
    }

    pub fn points(&self, points: &[Point]) -> Vec<[f64; 2]> {
        points.iter().map(|p| self.at(*p)).collect()
    }

    pub fn polyline(&self, points: &[Point]) -> Path {
        Path::polyline(&self.points(points))
    }
}
