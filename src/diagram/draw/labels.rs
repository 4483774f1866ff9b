//! Labels beside what they name, without overlaps.
//!
//! Greedy: each label in turn tries its places, and takes that of the least cost: labels, dots and lines
//! under it cost most to least, and so does the distance from what it names. (The problem of the best
//! places for all is NP-hard; the order of importance does well enough: Christensen, Marks, Shieber 1995.)

use crate::drawing::{Anchor, AnchorX, AnchorY, Colour, Item, Path, Stroke, Text};
use crate::error::Result;
use crate::text::{Rect, RichText};

const ON_LABEL: f64 = 1000.0;
const OUTSIDE: f64 = 300.0;
const ON_DOT: f64 = 60.0;
const ON_LINE: f64 = 6.0;
/// Of a place farther down its list, and of a point of distance.
const LATER: f64 = 0.35;
const FARTHER: f64 = 0.45;
/// The distance from which on a line leads to the label, points.
const LEADER: f64 = 14.0;
/// What is kept free around a label, points.
const AIR: f64 = 1.0;

/// What is to be labelled.
pub(super) struct Request {
    /// Markup.
    pub text: String,
    pub colour: Colour,
    pub size: f64,
    /// Points that it may stand beside, the best first.
    pub anchors: Vec<[f64; 2]>,
    /// Directions from there, (x, y) with y down, the best first; none to stand upon the point.
    pub directions: Vec<[f64; 2]>,
    /// Distances from there, points.
    pub distances: Vec<f64>,
    /// Whether it is left out where it would be on a label or a dot.
    pub optional: bool,
}

/// The eight directions around an event, the best first.
pub(super) const AROUND: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [0.8, -0.8],
    [0.8, 0.8],
    [-1.0, 0.0],
    [-0.8, -0.8],
    [-0.8, 0.8],
    [0.0, -1.0],
    [0.0, 1.0],
];

/// What is on the page already.
pub(super) struct Placement {
    page: Rect,
    labels: Vec<Rect>,
    dots: Vec<Rect>,
    lines: Vec<[[f64; 2]; 2]>,
    pub items: Vec<Item>,
    background: Colour,
}

impl Placement {
    pub fn new(width: f64, height: f64, background: Colour) -> Self {
        Placement {
            page: Rect {
                min: [1.0; 2],
                max: [width - 1.0, height - 1.0],
            },
            labels: Vec::new(),
            dots: Vec::new(),
            lines: Vec::new(),
            items: Vec::new(),
            background,
        }
    }

    /// A line that labels keep off.
    pub fn line(&mut self, points: &[[f64; 2]]) {
        let pairs = points.windows(2).filter_map(|pair| match pair {
            [a, b] => Some([*a, *b]),
            _ => None,
        });
        self.lines.extend(pairs);
    }

    /// A dot that labels keep off.
    pub fn dot(&mut self, [x, y]: [f64; 2], radius: f64) {
        self.dots.push(Rect {
            min: [x - radius, y - radius],
            max: [x + radius, y + radius],
        });
    }

    /// Puts a label in its best place.
    pub fn place(&mut self, request: &Request) -> Result<()> {
        let rich = RichText::parse(&request.text)?;
        let mut best: Option<(f64, Text, Rect, [f64; 2], f64)> = None;
        let mut order = 0.0;
        for &distance in &request.distances {
            for &anchor in &request.anchors {
                for &direction in &request.directions {
                    let text = beside(&rich, request, anchor, direction, distance);
                    let rect = text.bounds()?;
                    let cost = LATER * order + FARTHER * distance + self.cost(rect);
                    order += 1.0;
                    if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                        best = Some((cost, text, rect, anchor, distance));
                    }
                }
            }
        }
        let best = best.filter(|(cost, ..)| !request.optional || *cost < ON_DOT);
        if let Some((_, text, rect, anchor, distance)) = best {
            if distance >= LEADER {
                self.lead(rect, anchor, request.colour);
            }
            self.labels.push(rect);
            self.items.push(Item::Text(Text {
                halo: Some((self.background, 1.6)),
                ..text
            }));
        }
        Ok(())
    }

    /// A line from a point to the nearest point of a label.
    fn lead(&mut self, rect: Rect, anchor: [f64; 2], colour: Colour) {
        let near = [0, 1].map(|i| anchor[i].clamp(rect.min[i] - AIR, rect.max[i] + AIR));
        let path = Path::line(anchor, near);
        let stroke = Stroke::new(colour.with_alpha(150), 0.4);
        self.items.push(Item::stroked(path, stroke));
    }

    fn cost(&self, rect: Rect) -> f64 {
        let airy = Rect {
            min: rect.min.map(|v| v - AIR),
            max: rect.max.map(|v| v + AIR),
        };
        let count = |rects: &[Rect]| rects.iter().filter(|r| overlap(airy, **r)).count() as f64;
        let lines = self.lines.iter().filter(|line| crosses(airy, **line));
        let inside =
            (0..2).all(|i| rect.min[i] >= self.page.min[i] && rect.max[i] <= self.page.max[i]);
        let outside = if inside { 0.0 } else { OUTSIDE };
        ON_LABEL * count(&self.labels)
            + ON_DOT * count(&self.dots)
            + ON_LINE * lines.count().min(8) as f64
            + outside
    }
}

/// The text beside `anchor` in a direction.
fn beside(
    rich: &RichText,
    request: &Request,
    anchor: [f64; 2],
    direction: [f64; 2],
    distance: f64,
) -> Text {
    let [x, y] = direction;
    let side = match x {
        x if x > 0.3 => AnchorX::Start,
        x if x < -0.3 => AnchorX::End,
        _ => AnchorX::Middle,
    };
    let height = match y {
        y if y > 0.3 => AnchorY::Top,
        y if y < -0.3 => AnchorY::Baseline,
        _ => AnchorY::Middle,
    };
    let at = [anchor[0] + x * distance, anchor[1] + y * distance];
    Text {
        anchor: Anchor { x: side, y: height },
        colour: request.colour,
        ..Text::new(rich.clone(), at, request.size)
    }
}

fn overlap(a: Rect, b: Rect) -> bool {
    (0..2).all(|i| a.min[i] < b.max[i] && b.min[i] < a.max[i])
}

/// Whether a straight line goes through a rectangle (Liang and Barsky).
fn crosses(rect: Rect, [a, b]: [[f64; 2]; 2]) -> bool {
    let (mut from, mut to) = (0f64, 1f64);
    for i in 0..2 {
        let d = b[i] - a[i];
        if d == 0.0 {
            if a[i] < rect.min[i] || a[i] > rect.max[i] {
                return false;
            }
            continue;
        }
        let (near, far) = ((rect.min[i] - a[i]) / d, (rect.max[i] - a[i]) / d);
        from = from.max(near.min(far));
        to = to.min(near.max(far));
    }
    from <= to
}
