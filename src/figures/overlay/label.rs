//! Labels along lines, where a line is nearly straight, and no other label is close and no other line crosses.

use super::Polyline;
use super::style;
use crate::error::Result;
use crate::figures::drawing::{Colour, Text};
use crate::text::{Rect, RichText};

/// Points per em.
const SIZE: f64 = 6.5;
/// Possible positions of a label along a line, the best first.
const PLACES: [f64; 19] = [
    0.5, 0.35, 0.65, 0.42, 0.58, 0.25, 0.75, 0.15, 0.85, 0.46, 0.54, 0.38, 0.62, 0.3, 0.7, 0.2,
    0.8, 0.1, 0.9,
];
/// The least ratio of the chord of a line under a label to its length.
const STRAIGHT: f64 = 0.975;
/// Free space between a line and both sides of its label, points.
const GAP: f64 = 1.5;
/// The least length of a line with a label, in lengths of the label.
const LEAST: f64 = 2.2;

/// The labels of a drawing so far.
#[derive(Debug)]
pub(super) struct Labels {
    /// Points; the label's middle and ends must lie within.
    size: [f64; 2],
    /// Discs that are taken: centre and radius.
    discs: Vec<([f64; 2], f64)>,
    /// All lines of the drawing, and the boxes around them.
    lines: Vec<(Polyline, Rect)>,
    /// Those of labels along lines.
    places: Vec<Place>,
}

/// Where a label is.
#[derive(Debug)]
struct Place {
    middle: [f64; 2],
    /// Unit vector along it.
    along: [f64; 2],
    /// Half its length and half its height.
    half: [f64; 2],
}

impl Labels {
    /// No labels yet on a picture of this size, points.
    pub fn new(size: [f64; 2]) -> Labels {
        Labels {
            size,
            discs: Vec::new(),
            lines: Vec::new(),
            places: Vec::new(),
        }
    }

    /// Keeps labels off a disc, points.
    pub fn keep_off(&mut self, centre: [f64; 2], radius: f64) {
        self.discs.push((centre, radius));
    }

    /// Keeps labels off a line, points, but for those along it.
    pub fn keep_off_line(&mut self, line: Polyline) {
        if let Some(around) = Rect::around(line.iter().copied()) {
            self.lines.push((line, around));
        }
    }

    /// A label with this text along `line`, points, where the fewest lines cross it; `None` if there is no room for it.
    pub fn along(
        &mut self,
        line: &Polyline,
        text: RichText,
        colour: Colour,
    ) -> Result<Option<Text>> {
        let width = text.width(SIZE)?;
        let lengths = lengths(line);
        let whole = lengths.last().copied().unwrap_or(0.0);
        if whole < LEAST * width {
            return Ok(None);
        }
        let mut best: Option<(usize, [[f64; 2]; 3])> = None;
        for place in PLACES {
            // The chord of the line that is as long as the text.
            let [a, m, b] = [-0.5, 0.0, 0.5].map(|k| at(line, &lengths, place * whole + k * width));
            let half = 0.5 * width + GAP;
            let rest = [
                part(line, &lengths, [0.0, place * whole - half]),
                part(line, &lengths, [place * whole + half, whole]),
            ];
            let [x, y] = [b[0] - a[0], b[1] - a[1]];
            let is_straight = x.hypot(y) >= STRAIGHT * width;
            // Three discs cover the text: their centres are half a width apart.
            let discs = [a, m, b].map(|centre| (centre, 0.3 * width + 0.5 * SIZE));
            if !is_straight || !discs.iter().all(|disc| self.is_free(*disc)) {
                continue;
            }
            let crossed = self.crossed(Some(line), [a, b], SIZE) + through(&rest, [a, b], SIZE);
            if best.is_none_or(|(least, _)| crossed < least) {
                best = Some((crossed, [a, m, b]));
            }
            if crossed == 0 {
                break;
            }
        }
        let Some((_, [a, m, b])) = best else {
            return Ok(None);
        };
        self.discs
            .extend([a, m, b].map(|centre| (centre, 0.3 * width + 0.5 * SIZE)));
        // Read from the left, or from below.
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        let (x, y) = if x < 0.0 { (-x, -y) } else { (x, y) };
        let label = style::label(text, m, colour, SIZE);
        self.places.push(Place::between(a, b, SIZE));
        Ok(Some(Text {
            // y runs down.
            angle: libm::atan2(-y, x),
            ..label
        }))
    }

    /// The remaining parts of a line, points, outside the labels along lines.
    pub fn beside(&self, line: &Polyline) -> Vec<Polyline> {
        let mut left: Vec<Polyline> = Vec::new();
        for (p, q) in line.iter().zip(line.iter().skip(1)) {
            let hidden = self.places.iter().filter_map(|place| place.hides(*p, *q));
            let mut hidden: Vec<[f64; 2]> = hidden.collect();
            hidden.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let at = |t: f64| [0, 1].map(|i| p[i] + t * (q[i] - p[i]));
            let mut from = 0.0;
            for [start, end] in hidden.into_iter().chain([[1.0, 1.0]]) {
                if start > from {
                    let [a, b] = [from, start].map(at);
                    match left.last_mut().filter(|_| from == 0.0) {
                        Some(line) if line.last() == Some(&a) => line.push(b),
                        _ => left.push(vec![a, b]),
                    }
                }
                from = end.max(from);
            }
        }
        left
    }

    /// The middle of a level label of this width and height, points: the first of `places` on the page that is free of other labels and
    /// that no line crosses, or the one that the fewest lines cross. Lines are interrupted there. `None` if no place is free.
    pub fn level(&mut self, places: &[[f64; 2]], [width, height]: [f64; 2]) -> Option<[f64; 2]> {
        let ends = |[x, y]: [f64; 2]| [[x - 0.5 * width, y], [x + 0.5 * width, y]];
        let discs = |place: [f64; 2]| {
            let [a, b] = ends(place);
            [a, place, b].map(|centre| (centre, 0.3 * width + 0.5 * height))
        };
        let mut best: Option<(usize, [f64; 2])> = None;
        for place in places {
            if !self.is_clear(ends(*place), height) {
                continue;
            }
            let crossed = self.crossed(None, ends(*place), height);
            if best.is_none_or(|(least, _)| crossed < least) {
                best = Some((crossed, *place));
            }
            if crossed == 0 {
                break;
            }
        }
        let (_, best) = best?;
        let [a, b] = ends(best);
        self.discs.extend(discs(best));
        self.places.push(Place::between(a, b, height));
        Some(best)
    }

    /// Whether a level label of this height from `a` to `b` is on the page, and does not overlap anything else.
    fn is_clear(&self, [a, b]: [[f64; 2]; 2], height: f64) -> bool {
        let (low, high) = ([a[0], a[1] - 0.5 * height], [b[0], b[1] + 0.5 * height]);
        let inside = (0..2).all(|i| low[i] >= GAP && high[i] <= self.size[i] - GAP);
        // The distance of the disc's centre from the label.
        let far = |[x, y]: [f64; 2]| {
            let away = |x: f64, low: f64, high: f64| (low - x).max(x - high).max(0.0);
            away(x, low[0], high[0]).hypot(away(y, low[1], high[1]))
        };
        inside
            && self
                .discs
                .iter()
                .all(|(centre, radius)| far(*centre) >= *radius)
    }

    /// The number of lines other than `own` that cross a label of this height from `a` to `b`.
    fn crossed(&self, own: Option<&Polyline>, [a, b]: [[f64; 2]; 2], height: f64) -> usize {
        // Its corners are no farther from its middle than this.
        let far = 0.5 * ((b[0] - a[0]).hypot(b[1] - a[1]) + height);
        let middle = [0, 1].map(|i| 0.5 * (a[i] + b[i]));
        let near = |around: &Rect| {
            (0..2).all(|i| (around.min[i] - far..=around.max[i] + far).contains(&middle[i]))
        };
        let others = self.lines.iter().filter(|(_, around)| near(around));
        let others = others.map(|(line, _)| line);
        through(others.filter(|line| Some(*line) != own), [a, b], height)
    }

    fn is_free(&self, (centre, radius): ([f64; 2], f64)) -> bool {
        let margin = 0.6 * SIZE;
        let inside = (0..2).all(|i| (margin..=self.size[i] - margin).contains(&centre[i]));
        let apart = |disc: &([f64; 2], f64)| {
            (disc.0[0] - centre[0]).hypot(disc.0[1] - centre[1]) >= disc.1 + radius
        };
        inside && self.discs.iter().all(apart)
    }
}

impl Place {
    /// The place of a label of this height from `a` to `b`.
    fn between(a: [f64; 2], b: [f64; 2], height: f64) -> Place {
        let way = [0, 1].map(|i| b[i] - a[i]);
        let length = way[0].hypot(way[1]).max(f64::MIN_POSITIVE);
        Place {
            middle: [0, 1].map(|i| 0.5 * (a[i] + b[i])),
            along: way.map(|w| w / length),
            half: [0.5 * length + GAP, 0.5 * height],
        }
    }

    /// The part of the way from `p` to `q` that is under the label (Liang and Barsky).
    fn hides(&self, p: [f64; 2], q: [f64; 2]) -> Option<[f64; 2]> {
        let turned = |p: [f64; 2]| {
            let [x, y] = [0, 1].map(|i| p[i] - self.middle[i]);
            let [u, v] = self.along;
            [u * x + v * y, u * y - v * x]
        };
        let (p, q) = (turned(p), turned(q));
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for i in 0..2 {
            let way = q[i] - p[i];
            if way == 0.0 {
                if p[i].abs() > self.half[i] {
                    return None;
                }
                continue;
            }
            let (s, t) = ((-self.half[i] - p[i]) / way, (self.half[i] - p[i]) / way);
            from = from.max(s.min(t));
            to = to.min(s.max(t));
        }
        (from < to).then_some([from, to])
    }
}

/// The number of `lines` that cross a label of this height from `a` to `b`.
fn through<'a>(
    lines: impl IntoIterator<Item = &'a Polyline>,
    [a, b]: [[f64; 2]; 2],
    height: f64,
) -> usize {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    let length = x.hypot(y).max(f64::MIN_POSITIVE);
    let [x, y] = [x / length, y / length];
    // In coordinates along the label and across it.
    let turned = |p: &[f64; 2]| {
        let [u, v] = [p[0] - a[0], p[1] - a[1]];
        [u * x + v * y, v * x - u * y]
    };
    let label = Rect {
        min: [0.0, -0.5 * height],
        max: [length, 0.5 * height],
    };
    let crossing = lines.into_iter().filter(|line| {
        let mut pairs = line.iter().zip(line.iter().skip(1));
        pairs.any(|(p, q)| label.is_crossed(turned(p), turned(q)))
    });
    crossing.count()
}

/// The part of the line between two lengths.
fn part(line: &Polyline, lengths: &[f64], [from, to]: [f64; 2]) -> Polyline {
    if from >= to {
        return Vec::new();
    }
    let within = line.iter().zip(lengths);
    let within = within.filter(|(_, length)| (from..=to).contains(length));
    let mut points = vec![at(line, lengths, from)];
    points.extend(within.map(|(point, _)| *point));
    points.push(at(line, lengths, to));
    points.dedup();
    points
}

/// The length of the line up to each of its points.
fn lengths(line: &Polyline) -> Vec<f64> {
    let mut sum = 0.0;
    let mut lengths = Vec::with_capacity(line.len());
    for (i, p) in line.iter().enumerate() {
        let before = line[i.saturating_sub(1)];
        sum += (p[0] - before[0]).hypot(p[1] - before[1]);
        lengths.push(sum);
    }
    lengths
}

/// The point of the line after this length.
fn at(line: &Polyline, lengths: &[f64], length: f64) -> [f64; 2] {
    let last = line.len() - 1;
    let i = lengths.partition_point(|l| *l < length).clamp(1, last);
    let step = lengths[i] - lengths[i - 1];
    let t = if step > 0.0 {
        (length - lengths[i - 1]) / step
    } else {
        0.0
    };
    [0, 1].map(|k| line[i - 1][k] + t.clamp(0.0, 1.0) * (line[i][k] - line[i - 1][k]))
}

#[cfg(test)]
mod tests;
