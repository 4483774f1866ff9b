//! Rectangles, lines and polygons of a page.

use std::collections::HashMap;

use crate::text::Rect;

pub(in crate::figures::diagram::draw) fn widened(rect: Rect, by: f64) -> Rect {
    Rect {
        min: rect.min.map(|v| v - by),
        max: rect.max.map(|v| v + by),
    }
}

pub(super) fn moved(rect: Rect, by: [f64; 2]) -> Rect {
    Rect {
        min: [0, 1].map(|i| rect.min[i] + by[i]),
        max: [0, 1].map(|i| rect.max[i] + by[i]),
    }
}

/// The distance of two rectangles; 0 if they overlap.
pub(super) fn distance(a: Rect, b: Rect) -> f64 {
    let gap = |i: usize| (a.min[i] - b.max[i]).max(b.min[i] - a.max[i]).max(0.0);
    match [gap(0), gap(1)] {
        [x, 0.0] => x,
        [0.0, y] => y,
        [x, y] => x.hypot(y),
    }
}

/// Whether one of two pieces of text follows the other on a line, or is an index above or below it, with at most `space` between them.
pub(super) fn is_next_word(a: Rect, b: Rect, space: f64) -> bool {
    let gap = (a.min[0] - b.max[0]).max(b.min[0] - a.max[0]);
    let beside = a.max[1].min(b.max[1]) - a.min[1].max(b.min[1]);
    gap >= 0.0 && gap < space && beside > 0.0
}

/// Whether two rectangles overlap or touch.
pub(super) fn touch(a: Rect, b: Rect) -> bool {
    (0..2).all(|i| a.min[i] <= b.max[i] && b.min[i] <= a.max[i])
}

/// The rectangle around points.
pub(super) fn around(points: &[[f64; 2]]) -> Rect {
    let far = Rect {
        min: [f64::INFINITY; 2],
        max: [f64::NEG_INFINITY; 2],
    };
    points.iter().fold(far, |rect, p| Rect {
        min: [0, 1].map(|i| rect.min[i].min(p[i])),
        max: [0, 1].map(|i| rect.max[i].max(p[i])),
    })
}

/// The part of the way from `a` to `b` within a rectangle, edges included, in parts of that way (Liang and Barsky).
fn parts_within(clip: Rect, a: [f64; 2], b: [f64; 2]) -> Option<[f64; 2]> {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for i in 0..2 {
        let way = b[i] - a[i];
        if way == 0.0 {
            if !(clip.min[i]..=clip.max[i]).contains(&a[i]) {
                return None;
            }
            continue;
        }
        let (s, t) = ((clip.min[i] - a[i]) / way, (clip.max[i] - a[i]) / way);
        from = from.max(s.min(t));
        to = to.min(s.max(t));
    }
    (from < to).then_some([from, to])
}

/// The point a part of the way from `a` to `b`.
fn between(a: [f64; 2], b: [f64; 2], part: f64) -> [f64; 2] {
    match part {
        0.0 => a,
        1.0 => b,
        part => [0, 1].map(|i| a[i] + part * (b[i] - a[i])),
    }
}

/// The part of the way from `a` to `b` within a rectangle, edges included.
pub(in crate::figures::diagram::draw) fn part_within(
    clip: Rect,
    a: [f64; 2],
    b: [f64; 2],
) -> Option<[[f64; 2]; 2]> {
    Some(parts_within(clip, a, b)?.map(|part| between(a, b, part)))
}

/// The remaining parts of a straight line interrupted at rectangles, from its first end to its last.
pub(in crate::figures::diagram::draw) fn without(
    [a, b]: [[f64; 2]; 2],
    gaps: &[Rect],
) -> Vec<[[f64; 2]; 2]> {
    let mut hidden: Vec<[f64; 2]> = gaps
        .iter()
        .filter_map(|gap| parts_within(*gap, a, b))
        .collect();
    hidden.sort_by(|p, q| p[0].total_cmp(&q[0]));
    let mut left = Vec::new();
    let mut from = 0.0f64;
    for [s, t] in hidden.into_iter().chain([[1.0, 1.0]]) {
        if s > from {
            left.push([from, s].map(|part| between(a, b, part)));
        }
        from = from.max(t);
    }
    left
}

/// Whether a point is inside a polygon: a ray from it crosses the edge an odd number of times.
pub(in crate::figures::diagram::draw) fn is_inside([x, y]: [f64; 2], edge: &[[f64; 2]]) -> bool {
    let before = edge.iter().cycle().skip(edge.len().saturating_sub(1));
    let crossings = edge.iter().zip(before).filter(|(a, b)| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])
    });
    crossings.count() % 2 == 1
}

/// Rectangles and lines by their position on the page, so that those near a position are found without scanning all of them.
pub(super) struct Grid {
    /// The side of a cell, points.
    side: f64,
    /// Indices by cell, in their order and each once.
    cells: HashMap<[i32; 2], Vec<u32>>,
}

impl Grid {
    /// The limit of positions, in cells: anything farther out counts as here, since pages are smaller.
    const FARTHEST: i32 = 2048;
    /// The most entries that a search looks at. A place with that many neighbours is as bad as any, and thousands of
    /// labels on a page then take time in proportion to their number rather than to its square.
    const MOST_FOUND: usize = 96;

    /// An empty one of cells with this side, points.
    pub fn new(side: f64) -> Self {
        Grid {
            side,
            cells: HashMap::new(),
        }
    }

    /// Adds line `index` to the cells that it crosses, row by row.
    pub fn insert_line(&mut self, index: usize, points: &[[f64; 2]]) {
        // More than rounding, so that no cell is missed.
        const MORE: f64 = 1e-3;
        for (&[ax, ay], &[bx, by]) in points.iter().zip(points.iter().skip(1)) {
            for row in self.cell(ay.min(by))..=self.cell(ay.max(by)) {
                let at = |y: f64| match by == ay || row.abs() == Self::FARTHEST {
                    true => None,
                    false => Some(ax + ((y - ay) / (by - ay)).clamp(0.0, 1.0) * (bx - ax)),
                };
                let from = at(f64::from(row) * self.side - MORE).unwrap_or(ax);
                let to = at(f64::from(row + 1) * self.side + MORE).unwrap_or(bx);
                let columns = self.cell(from.min(to) - MORE)..=self.cell(from.max(to) + MORE);
                for column in columns {
                    self.hold([column, row], index as u32);
                }
            }
        }
    }

    /// Puts rectangle `index` in.
    pub fn insert(&mut self, index: usize, rect: Rect) {
        for cell in self.cells(rect) {
            self.hold(cell, index as u32);
        }
    }

    fn hold(&mut self, cell: [i32; 2], index: u32) {
        let held = self.cells.entry(cell).or_default();
        if let Err(place) = held.binary_search(&index) {
            held.insert(place, index);
        }
    }

    /// Takes rectangle `index` out.
    pub fn remove(&mut self, index: usize, rect: Rect) {
        for cell in self.cells(rect) {
            if let Some(held) = self.cells.get_mut(&cell)
                && let Ok(place) = held.binary_search(&(index as u32))
            {
                held.remove(place);
            }
        }
    }

    /// The indices of rectangles and lines that may touch `rect`, each once, in order: all of them, except in crowded places, where the
    /// first few of each cell stand for the rest.
    pub fn near(&self, rect: Rect) -> Vec<usize> {
        let count = self.cells(rect).count().max(1);
        let share = (Self::MOST_FOUND / count).max(8);
        let held = self.cells(rect).filter_map(|cell| self.cells.get(&cell));
        let held = held.flat_map(|held| held.iter().take(share));
        let mut found: Vec<usize> = held.map(|index| *index as usize).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
    /// The column or row of cells of a place.
    fn cell(&self, x: f64) -> i32 {
        let far = f64::from(Self::FARTHEST);
        (x / self.side).floor().clamp(-far, far) as i32
    }

    fn cells(&self, rect: Rect) -> impl Iterator<Item = [i32; 2]> + use<> {
        let [columns, rows] = [0, 1].map(|i| self.cell(rect.min[i])..=self.cell(rect.max[i]));
        rows.flat_map(move |row| columns.clone().map(move |column| [column, row]))
    }
}

#[cfg(test)]
mod tests;
