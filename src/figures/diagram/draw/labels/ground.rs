//! The content of the page before the labels.

use super::geometry::{Grid, around, is_inside, part_within, touch, widened};
use crate::figures::diagram::draw::theme::Theme;
use crate::figures::drawing::Colour;
use crate::text::Rect;

const OUTSIDE: f64 = 700.0;
const ON_DOT: f64 = 60.0;
const ON_LINE: f64 = 32.0;
/// On the near or the far side of a cone.
const ON_SIDE: f64 = 5.0;
/// Cost of a line within [`NEAR`] points of the free space of a label.
const NEAR_LINE: f64 = 1.0;
const NEAR: f64 = 2.0;
/// The least weight of a line that may not go through a label.
const STRIKING: f64 = 0.5;
/// The side of cells in which lines and dots are looked up, points: about the height of a label; at least this part of the type's size, so
/// that no label covers many.
const CELL: f64 = 8.0;
const OF_TYPE: f64 = 0.2;
/// The most lines that count.
const MOST_LINES: f64 = 8.0;

/// Lines, dots and areas, in points.
pub(in crate::figures::diagram::draw) struct Ground {
    page: Rect,
    background: Colour,
    /// The side of cells, points.
    cell: f64,
    dots: Vec<Rect>,
    /// Dots that pass by.
    beads: Vec<Rect>,
    lines: Vec<Line>,
    /// Both by their places.
    dots_by_place: Grid,
    lines_by_place: Grid,
    areas: Vec<(Vec<[f64; 2]>, Colour)>,
    /// The sides of cones.
    sides: Vec<Vec<[f64; 2]>>,
    /// Within which lines are seen.
    clip: Rect,
}

struct Line {
    points: Vec<[f64; 2]>,
    /// The box around it.
    bounds: Rect,
    /// How much it disturbs a label; 1 for a black or broad line.
    weight: f64,
}

impl Ground {
    pub fn new(width: f64, height: f64, theme: &Theme) -> Self {
        let cell = CELL.max(OF_TYPE * theme.size).max(theme.width);
        Ground {
            page: Rect {
                // A point of air at the edge.
                min: [1.0; 2],
                max: [width - 1.0, height - 1.0],
            },
            background: theme.background,
            cell,
            dots: Vec::new(),
            beads: Vec::new(),
            lines: Vec::new(),
            dots_by_place: Grid::new(cell),
            lines_by_place: Grid::new(cell),
            areas: Vec::new(),
            sides: Vec::new(),
            clip: Rect {
                min: [0.0; 2],
                max: [width, height],
            },
        }
    }

    /// Width and height of the page, points.
    pub fn size(&self) -> [f64; 2] {
        self.page.size()
    }

    /// The side of cells in which something of this size is looked up, points.
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Has the lines to come be seen within `rect` only.
    pub fn within(&mut self, rect: Rect) {
        self.clip = rect;
    }

    /// A line that labels keep off.
    pub fn line(&mut self, points: Vec<[f64; 2]>, weight: f64) {
        for points in seen(&points, self.clip) {
            self.lines_by_place.insert_line(self.lines.len(), &points);
            self.lines.push(Line {
                bounds: around(&points),
                points,
                weight,
            });
        }
    }

    /// A dot that labels keep off.
    pub fn dot(&mut self, middle: [f64; 2], radius: f64) {
        self.words(square(middle, radius));
    }

    /// A moving dot, which only labels of such dots avoid.
    pub fn bead(&mut self, middle: [f64; 2], radius: f64) {
        self.beads.push(square(middle, radius));
    }

    /// The cost of a label in `rect` on moving dots.
    pub fn passed(&self, rect: Rect) -> f64 {
        let on = self.beads.iter().filter(|bead| touch(rect, **bead));
        ON_DOT * on.count() as f64
    }

    /// Text that is already placed.
    pub fn words(&mut self, rect: Rect) {
        self.dots_by_place.insert(self.dots.len(), rect);
        self.dots.push(rect);
    }

    /// A shaded area, over those before.
    pub fn area(&mut self, edge: Vec<[f64; 2]>, colour: Colour) {
        self.areas.push((edge, colour));
    }

    /// A side of a cone, which labels would rather be beside.
    pub fn side(&mut self, edge: Vec<[f64; 2]>) {
        self.sides.push(edge);
    }

    /// The cost of a label whose ink is in `rect`, and whose free space is `airy`.
    pub fn cost(&self, rect: Rect, airy: Rect) -> f64 {
        let near = self.dots_by_place.near(airy).into_iter();
        let dots = near.filter(|dot| touch(airy, self.dots[*dot]));
        let (on, near) = (self.crossed(airy), self.crossed(widened(airy, NEAR)));
        // Not forbidden: it is better than no label.
        let outside = if self.holds(rect) { 0.0 } else { OUTSIDE };
        let middle = [0, 1].map(|i| 0.5 * (rect.min[i] + rect.max[i]));
        let sides = self.sides.iter().filter(|edge| is_inside(middle, edge));
        let on_sides = ON_SIDE * sides.count() as f64;
        // Crossed lines do not count as near, too.
        ON_DOT * dots.count() as f64 + ON_LINE * on + NEAR_LINE * (near - on) + on_sides + outside
    }

    /// Whether a rectangle is on the page.
    pub fn holds(&self, rect: Rect) -> bool {
        (0..2).all(|i| rect.min[i] >= self.page.min[i] && rect.max[i] <= self.page.max[i])
    }

    /// How much lines disturb anything in a rectangle. No more lines are examined than can count.
    fn crossed(&self, rect: Rect) -> f64 {
        let mut lines = 0.0;
        for line in self.crossing(rect) {
            lines += line.weight;
            if lines >= MOST_LINES {
                break;
            }
        }
        lines.min(MOST_LINES)
    }

    /// Whether a line that would make a label hard to read crosses a rectangle.
    pub fn is_struck(&self, rect: Rect) -> bool {
        self.crossing(rect).any(|line| line.weight >= STRIKING)
    }

    /// Whether a line crosses a rectangle.
    pub fn is_crossed(&self, rect: Rect) -> bool {
        self.crossing(rect).next().is_some()
    }

    fn crossing(&self, rect: Rect) -> impl Iterator<Item = &Line> {
        let near = move |line: &&Line| touch(line.bounds, rect);
        let through = move |line: &&Line| {
            let pairs = line.points.iter().zip(line.points.iter().skip(1));
            pairs.into_iter().any(|(a, b)| rect.is_crossed(*a, *b))
        };
        let found = self.lines_by_place.near(rect).into_iter();
        let found = found.filter_map(|line| self.lines.get(line));
        found.filter(near).filter(through)
    }

    /// The colour of the ground under the middle of a rectangle.
    pub fn colour(&self, rect: Rect) -> Colour {
        let middle = [0, 1].map(|i| 0.5 * (rect.min[i] + rect.max[i]));
        let under = self
            .areas
            .iter()
            .filter(|(edge, _)| is_inside(middle, edge));
        under.fold(self.background, |ground, (_, colour)| over(*colour, ground))
    }
}

fn square([x, y]: [f64; 2], half: f64) -> Rect {
    Rect {
        min: [x - half, y - half],
        max: [x + half, y + half],
    }
}

/// The parts of a line within a rectangle.
fn seen(points: &[[f64; 2]], clip: Rect) -> Vec<Vec<[f64; 2]>> {
    let mut parts: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut end = None;
    for (a, b) in points.iter().zip(points.iter().skip(1)) {
        let Some([from, to]) = part_within(clip, *a, *b) else {
            end = None;
            continue;
        };
        // A step that the edge has cut ends a part: the next begins elsewhere.
        match parts.last_mut().filter(|_| end == Some(from)) {
            Some(part) => part.push(to),
            None => parts.push(vec![from, to]),
        }
        end = Some(to);
    }
    parts
}

/// The colour of `ground` seen through `colour`.
fn over(colour: Colour, ground: Colour) -> Colour {
    let alpha = f64::from(colour.alpha) / 255.0;
    let mix = |i: usize| {
        let [a, b] = [colour.rgb[i], ground.rgb[i]].map(f64::from);
        (alpha * a + (1.0 - alpha) * b).round() as u8
    };
    Colour::rgb(mix(0), mix(1), mix(2))
}
