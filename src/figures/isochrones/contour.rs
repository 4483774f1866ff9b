//! Marching squares between pixel centres.
//!
//! A cell has four neighbouring pixel centres as corners. A line of value L crosses the edges between a corner below L and one at or
//! above it, at the point where linear interpolation gives L. In a cell with four crossings the mean of the corners decides which pairs
//! are joined.
//!
//! Where one surface hides another the time jumps, and no line is drawn: an edge is a jump if its difference is more than [`JUMP`] times
//! those of the edges before and after it in its row or column. (At a fold of a surface the difference changes too, but is similar on one
//! side.)

use super::range::Range;

/// How much larger a jump is than the adjacent differences.
const JUMP: f64 = 4.0;

/// A point of a line, and the edge between two pixel centres on which it lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// Unique per edge of the grid.
    pub edge: usize,
    /// Pixels; the centre of the first pixel is (½, ½).
    pub at: [f64; 2],
}

/// A line's piece in one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    /// Where the line enters and leaves.
    pub ends: [Crossing; 2],
    /// Number of lines per pixel.
    pub density: f64,
}

/// The grid of times.
pub(crate) struct Grid<'a> {
    pub width: usize,
    pub height: usize,
    pub ct: &'a [f64],
}

/// The pieces of every line: list i holds those of line `range.lines().start() + i`.
pub(crate) fn pieces(grid: &Grid, range: &Range) -> Vec<Vec<Piece>> {
    let lines = range.lines();
    let (first, last) = (*lines.start(), *lines.end());
    let mut pieces = vec![Vec::new(); lines.count()];
    for y in 0..grid.height.saturating_sub(1) {
        for x in 0..grid.width.saturating_sub(1) {
            let Some((low, high)) = grid.cell_range(x, y) else {
                continue;
            };
            // A line at the cell's lowest value has no corner below it.
            let from = ((low / range.step).floor() as i64).saturating_add(1);
            let to = (high / range.step).floor() as i64;
            let density = (high - low) / range.step;
            for line in from.max(first)..=to.min(last) {
                let found = grid.cell_pieces(x, y, line as f64 * range.step);
                if let Some(list) = pieces.get_mut((line - first) as usize) {
                    list.extend(found.map(|ends| Piece { ends, density }));
                }
            }
        }
    }
    pieces
}

impl Grid<'_> {
    fn value(&self, x: usize, y: usize) -> f64 {
        self.ct[y * self.width + x]
    }

    /// The corners of the cell, clockwise from the upper left.
    fn corners(&self, x: usize, y: usize) -> [f64; 4] {
        [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| self.value(x, y))
    }

    /// The earliest and the latest time in a cell; `None` if it spans several surfaces.
    fn cell_range(&self, x: usize, y: usize) -> Option<(f64, f64)> {
        let corners = self.corners(x, y);
        if !corners.iter().all(|c| c.is_finite()) || self.has_jump(x, y) {
            return None;
        }
        let low = corners.into_iter().fold(f64::INFINITY, f64::min);
        let high = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Some((low, high))
    }

    /// Whether one of the cell's four edges is a jump.
    fn has_jump(&self, x: usize, y: usize) -> bool {
        let row = |x: isize, y: usize| self.at(x, y as isize);
        let column = |y: isize, x: usize| self.at(x as isize, y);
        [y, y + 1]
            .into_iter()
            .any(|y| is_jump(|i| row(x as isize + i, y)))
            || [x, x + 1]
                .into_iter()
                .any(|x| is_jump(|i| column(y as isize + i, x)))
    }

    /// The time at a pixel, NaN outside.
    fn at(&self, x: isize, y: isize) -> f64 {
        let inside =
            (0..self.width as isize).contains(&x) && (0..self.height as isize).contains(&y);
        if inside {
            self.value(x as usize, y as usize)
        } else {
            f64::NAN
        }
    }

    /// The pieces of the line at `level` in a cell.
    fn cell_pieces(&self, x: usize, y: usize, level: f64) -> impl Iterator<Item = [Crossing; 2]> {
        let corners = self.corners(x, y);
        let crossings: Vec<Crossing> = (0..4)
            .filter_map(|side| self.crossing(x, y, side, corners, level))
            .collect();
        let mean = corners.iter().map(|c| c / 4.0).sum::<f64>();
        let pairs = match crossings[..] {
            [a, b] => [Some([a, b]), None],
            // The sides in order are top, right, bottom, left. If the middle is on the side of the upper left corner, the lines cut off the
            // other two.
            [top, right, bottom, left] if (mean >= level) == (corners[0] >= level) => {
                [Some([top, right]), Some([bottom, left])]
            }
            [top, right, bottom, left] => [Some([left, top]), Some([right, bottom])],
            _ => [None, None],
        };
        pairs.into_iter().flatten()
    }

    /// The point where the line crosses a side (0 top, 1 right, 2 bottom, 3 left) of a cell.
    fn crossing(
        &self,
        x: usize,
        y: usize,
        side: usize,
        corners: [f64; 4],
        level: f64,
    ) -> Option<Crossing> {
        let (a, b) = (corners[side], corners[(side + 1) % 4]);
        if (a >= level) == (b >= level) {
            return None;
        }
        let (x0, y0) = (x as f64 + 0.5, y as f64 + 0.5);
        // From the left or upper end, so that both cells of an edge find the same point.
        let between = |a: f64, b: f64| ((level - a) / (b - a)).clamp(0.0, 1.0);
        let (column, row, at) = match side {
            0 => (x, y, [x0 + between(a, b), y0]),
            1 => (x + 1, y, [x0 + 1.0, y0 + between(a, b)]),
            2 => (x, y + 1, [x0 + between(b, a), y0 + 1.0]),
            _ => (x, y, [x0, y0 + between(b, a)]),
        };
        // Horizontal edges are even, vertical ones odd.
        let vertical = side % 2;
        let edge = 2 * (row * self.width + column) + vertical;
        Some(Crossing { edge, at })
    }
}

/// Whether the difference between values 0 and 1 is out of line with those before and after.
fn is_jump(value: impl Fn(isize) -> f64) -> bool {
    let difference = |i: isize| (value(i + 1) - value(i)).abs();
    // f64::max ignores NaN, which marks the lack of a neighbour on that surface.
    let usual = difference(-1).max(difference(1));
    difference(0) > JUMP * usual
}
