//! The labels of a panel, and their possible positions.

use super::labels::{AROUND, Ground, Habits, Request, roomier};
use super::layers::{area_colour, frame_colour, is_inner, line_colour};
use super::page::Map;
use super::solid;
use super::theme::Theme;
use crate::error::Result;
use crate::figures::diagram::layout::{Axis, Panel, Placed, Point, Tick};
use crate::figures::diagram::model::{Colour as Name, Segment, Style};
use crate::figures::drawing::Colour;

/// Size of numbers at ticks, in parts of the type's.
const SMALL: f64 = 0.8;
/// Distances of a label from what it names, points.
const NEAR: [f64; 6] = [4.5, 7.0, 11.0, 20.0, 30.0, 42.0];
/// Directions around an event between the eight.
const BETWEEN: [[f64; 2]; 8] = [
    [0.9, -0.45],
    [0.9, 0.45],
    [-0.9, -0.45],
    [-0.9, 0.45],
    [0.45, -0.9],
    [0.45, 0.9],
    [-0.45, -0.9],
    [-0.45, 0.9],
];
/// The possible positions of the numbers of a time axis, and of a space axis: on the usual side, and on the other.
const BESIDE: [[[f64; 2]; 5]; 2] = [
    [
        [-1.0, 0.0],
        [-1.0, 0.25],
        [-1.0, -0.25],
        [-0.9, 0.5],
        [-0.9, -0.5],
    ],
    [
        [1.0, 0.0],
        [1.0, 0.25],
        [1.0, -0.25],
        [0.9, 0.5],
        [0.9, -0.5],
    ],
];
const UNDER: [[[f64; 2]; 5]; 2] = [
    [
        [0.0, 1.0],
        [-0.25, 1.0],
        [0.25, 1.0],
        [-0.5, 0.9],
        [0.5, 0.9],
    ],
    [
        [0.0, -1.0],
        [-0.25, -1.0],
        [0.25, -1.0],
        [-0.5, -0.9],
        [0.5, -0.9],
    ],
];
/// Beside the upper end of a line first.
const ALONG: [f64; 9] = [0.93, 0.85, 0.97, 0.77, 0.68, 0.58, 0.48, 0.35, 0.2];
/// Beside the middle of a segment first.
const MIDDLE: [f64; 7] = [0.5, 0.42, 0.58, 0.34, 0.66, 0.25, 0.75];

/// The words of a panel.
pub(super) struct Words<'a> {
    panel: &'a Panel,
    map: &'a Map,
    theme: &'a Theme,
    /// The number of the panel; `None` if there is only one.
    number: Option<usize>,
}

impl<'a> Words<'a> {
    pub fn new(panel: &'a Panel, map: &'a Map, theme: &'a Theme, number: Option<usize>) -> Self {
        Words {
            panel,
            map,
            theme,
            number,
        }
    }

    /// The labels of the panel, the most important first.
    pub fn all(&self, style: &Style, ground: &Ground, habits: &mut Habits) -> Result<Vec<Request>> {
        let mut all = self.axes(self.number.is_some());
        all.extend(self.events());
        all.extend(self.readings());
        if style.ticks {
            all.extend(self.ticks(ground, habits)?);
        }
        all.extend(self.texts());
        if !style.legend {
            all.extend(self.world_lines());
        }
        all.extend(self.others());
        Ok(all)
    }

    fn request(&self, text: &str, colour: Colour, anchors: Vec<[f64; 2]>) -> Request {
        Request {
            text: text.to_string(),
            colour,
            size: self.theme.size,
            anchors,
            directions: AROUND.to_vec(),
            distances: NEAR.to_vec(),
            optional: false,
            key: None,
        }
    }

    fn axes(&self, named: bool) -> Vec<Request> {
        let mut all = Vec::new();
        for axes in &self.panel.axes {
            let colour = frame_colour(self.panel, self.theme, axes.frame);
            // Ways from the end of the axis, best first; y runs down.
            let up = [
                [-0.9, 0.3],
                [0.9, 0.3],
                [0.0, -1.0],
                [-0.9, -0.4],
                [0.9, -0.4],
                [0.9, 2.0],
            ];
            // The last but one is below the numbers of an axis that ends at the edge of the page.
            let right = [
                [0.3, 1.0],
                [-0.8, 0.8],
                [0.0, 1.0],
                [0.0, -1.0],
                [0.9, 0.0],
                [-0.8, 2.4],
                [-0.8, -0.8],
            ];
            let back = [
                [0.9, -0.3],
                [0.9, 0.3],
                [0.0, -1.0],
                [-0.9, -0.4],
                [0.0, 1.0],
                [-0.9, -2.0],
            ];
            let depth = axes.depth.as_ref().map(|axis| (axis, &back[..]));
            let two = [(&axes.time, &up[..]), (&axes.space, &right[..])];
            for (axis, directions) in two.into_iter().chain(depth) {
                // Long ones may find their place farther back along the axis.
                let [from, to] = axis.ends;
                let back = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
                let anchors = back.map(|part| self.map.at(to.plus(part, from.from(to))));
                all.push(Request {
                    directions: directions.to_vec(),
                    distances: vec![5.0, 8.0, 12.0],
                    ..self.request(&axis.label, colour, anchors.to_vec())
                });
            }
        }
        if named {
            let rect = self.map.rect();
            let at = [
                0.5 * (rect.min[0] + rect.max[0]),
                rect.min[1] - 1.2 * self.theme.size,
            ];
            let frame = &self.panel.frame;
            let name = match frame.trim_end_matches('\'') {
                "world" => "*S*".into(),
                // A letter with its primes.
                letter if letter.len() == 1 => format!("*{frame}*"),
                _ => frame.clone(),
            };
            let place = vec![[0.0, -1.0], [0.9, 0.0], [-0.9, 0.0]];
            all.push(Request {
                directions: place,
                distances: vec![0.0, 30.0],
                ..self.request(&format!("in {name}"), self.theme.ink, vec![at])
            });
        }
        all
    }

    fn ticks(&self, ground: &Ground, habits: &mut Habits) -> Result<Vec<Request>> {
        let mut all = Vec::new();
        for axes in &self.panel.axes {
            let colour = frame_colour(self.panel, self.theme, axes.frame);
            let numbers = |axis: &Axis, sides: &[[f64; 2]]| -> Vec<Request> {
                let ticks = axis.ticks.iter();
                let inner = ticks.filter(|tick| is_inner(self.map, axis, tick));
                inner
                    .filter_map(|tick| self.tick(tick, colour, sides.to_vec()))
                    .collect()
            };
            let two = [("time", &axes.time, BESIDE), ("space", &axes.space, UNDER)];
            for (name, axis, sides) in two {
                // All on one side of their axis: on that with room for more of them.
                let key = format!("{name} {} {}", axes.frame, self.number.unwrap_or(0));
                let [first, second] = sides.map(|side| numbers(axis, &side));
                let is_second = roomier(key, [&first, &second], ground, habits)?;
                all.extend(if is_second { second } else { first });
            }
            if let Some(axis) = &axes.depth {
                all.extend(numbers(axis, &[[0.9, 0.4], [0.9, -0.4], [0.9, 0.0]]));
            }
        }
        // Readings of clocks are to the right of their lines.
        for (i, line) in self.panel.world_lines.iter().enumerate() {
            let colour = line_colour(self.panel, self.theme, i);
            let sides = vec![[1.0, 0.0], [0.9, 0.4], [0.9, -0.4]];
            all.extend(
                line.ticks
                    .iter()
                    .filter_map(|t| self.tick(t, colour, sides.clone())),
            );
        }
        Ok(all)
    }

    fn tick(&self, tick: &Tick, colour: Colour, directions: Vec<[f64; 2]>) -> Option<Request> {
        Some(Request {
            size: SMALL * self.theme.size,
            directions,
            distances: vec![4.5, 7.5, 11.0],
            optional: true,
            ..self.request(tick.label.as_deref()?, colour, vec![self.map.at(tick.at)])
        })
    }

    fn events(&self) -> Vec<Request> {
        let seen = self
            .panel
            .events
            .iter()
            .filter(|e| self.panel.limits.contains(e.at));
        let requests = seen.filter_map(|event| {
            let at = vec![self.map.at(event.at)];
            let colour = self.theme.colour(event.colour.unwrap_or(Name::Black));
            // Long text avoids nearby lines better if it is higher, lower or farther off.
            let directions = AROUND.iter().chain(&BETWEEN).copied().collect();
            Some(Request {
                directions,
                distances: NEAR.into_iter().chain([54.0]).collect(),
                ..self.request(event.label.as_deref()?, colour, at)
            })
        });
        requests.collect()
    }

    /// The readings of moving clocks.
    fn readings(&self) -> Vec<Request> {
        let beads = self.panel.now.iter().flat_map(|now| &now.beads);
        let requests = beads.filter_map(|bead| {
            let colour = line_colour(self.panel, self.theme, bead.line);
            let at = vec![self.map.at(bead.at)];
            Some(Request {
                distances: NEAR.map(|distance| distance + 2.0).to_vec(),
                key: Some(format!("reading {}", bead.line)),
                ..self.request(bead.label.as_deref()?, colour, at)
            })
        });
        requests.collect()
    }

    /// Words at given places.
    fn texts(&self) -> Vec<Request> {
        let texts = self.panel.texts.iter().filter_map(|words| {
            let colour = self.theme.colour(words.colour.unwrap_or(Name::Black));
            let text = words.label.as_deref()?;
            Some(self.upon(text, colour, &[words.at]))
        });
        texts.collect()
    }

    fn upon(&self, text: &str, colour: Colour, places: &[Point]) -> Request {
        Request {
            directions: vec![[0.0, 0.0], [0.0, -0.3], [0.0, 0.3], [-0.3, 0.0], [0.3, 0.0]],
            distances: vec![0.0, 12.0, 24.0, 40.0],
            ..self.request(text, colour, self.map.points(places))
        }
    }

    /// Beside the upper parts of the lines.
    fn world_lines(&self) -> Vec<Request> {
        let mut all = Vec::new();
        for (i, line) in self.panel.world_lines.iter().enumerate() {
            let Some(label) = &line.label else { continue };
            let colour = line_colour(self.panel, self.theme, i);
            let points = self.within(&line.curve.points);
            let anchors = ALONG.iter().filter_map(|part| along(&points, *part));
            let sides = [
                [1.0, 0.0],
                [-1.0, 0.0],
                [0.9, 0.5],
                [-0.9, 0.5],
                [0.9, -0.5],
                [-0.9, -0.5],
            ];
            all.push(Request {
                directions: sides.to_vec(),
                ..self.request(label, colour, anchors.collect())
            });
        }
        all
    }

    /// The part of a curve that is in sight, on the page.
    fn within(&self, points: &[Point]) -> Vec<[f64; 2]> {
        let limits = &self.panel.limits;
        let mut seen = Vec::new();
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let d = b.from(a);
            let steps = (0..=16).map(|k| a.plus(f64::from(k) / 16.0, d));
            seen.extend(
                steps
                    .filter(|p| limits.contains(*p))
                    .map(|p| self.map.at(p)),
            );
        }
        seen.dedup();
        seen
    }

    fn others(&self) -> Vec<Request> {
        let (panel, theme) = (self.panel, self.theme);
        let mut all = Vec::new();
        for slice in &panel.slices {
            let own = frame_colour(panel, theme, slice.owner.unwrap_or(0));
            let places = if slice.label.is_some() {
                &ALONG[..]
            } else {
                &[]
            };
            all.extend(self.segment(slice, own, places));
        }
        for (text, colour, anchors) in solid::plane_labels(panel, self.map, theme) {
            all.push(self.request(text, colour, anchors));
        }
        for signal in &panel.signals {
            all.extend(self.segment(signal, theme.colour(Name::Orange), &MIDDLE));
        }
        for arrow in &panel.arrows {
            let own = arrow
                .owner
                .map_or(theme.ink, |i| line_colour(panel, theme, i));
            all.extend(self.segment(arrow, own, &[1.0, 0.9, 0.7, 0.5]));
        }
        for interval in panel.intervals.iter().filter(|i| !i.label.is_empty()) {
            let colour = theme.colour(interval.colour.unwrap_or(Name::Black));
            all.push(self.beside_segment(&interval.label, colour, interval.ends, &MIDDLE));
        }
        for curve in &panel.curves {
            let colour = theme.colour(curve.colour.unwrap_or(Name::Black));
            all.extend(self.beside_curve(&curve.label, colour, &curve.points));
        }
        for hyperbola in &panel.hyperbolae {
            let colour = theme.colour(hyperbola.colour.unwrap_or(Name::Grey));
            all.extend(self.beside_curve(&hyperbola.label, colour, &hyperbola.curve.points));
        }
        for area in &panel.areas {
            let colour = area_colour(panel, theme, area);
            all.extend(
                area.label
                    .iter()
                    .map(|Placed { text, places }| self.upon(text, colour, places)),
            );
        }
        all
    }

    fn beside_curve(
        &self,
        label: &Option<String>,
        colour: Colour,
        points: &[Point],
    ) -> Option<Request> {
        let text = label.as_deref()?;
        let points = self.within(points);
        let anchors = ALONG.iter().filter_map(|part| along(&points, *part));
        Some(self.request(text, colour, anchors.collect()))
    }

    fn segment(&self, segment: &Segment<Point>, own: Colour, places: &[f64]) -> Option<Request> {
        let colour = segment.colour.map_or(own, |name| self.theme.colour(name));
        Some(self.beside_segment(segment.label.as_deref()?, colour, segment.ends, places))
    }

    /// Across a straight line first.
    fn beside_segment(
        &self,
        text: &str,
        colour: Colour,
        ends: [Point; 2],
        places: &[f64],
    ) -> Request {
        let [a, b] = ends.map(|end| self.map.at(end));
        let mut directions = normals(a, b).to_vec();
        directions.extend(AROUND);
        Request {
            directions,
            ..self.request(text, colour, self.beside(ends, places))
        }
    }

    fn beside(&self, [from, to]: [Point; 2], places: &[f64]) -> Vec<[f64; 2]> {
        let points = places.iter().map(|part| from.plus(*part, to.from(from)));
        let seen = points.filter(|p| self.panel.limits.contains(*p));
        seen.map(|p| self.map.at(p)).collect()
    }
}

/// Unit vectors across a line, the upper one first.
fn normals(a: [f64; 2], b: [f64; 2]) -> [[f64; 2]; 2] {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    let length = x.hypot(y).max(f64::MIN_POSITIVE);
    // y runs down: the first points upwards.
    let up = if x < 0.0 { 1.0 } else { -1.0 };
    let normal = [-up * y / length, up * x / length];
    [normal, normal.map(|v| -v)]
}

/// The point at a part of the way along points.
fn along(points: &[[f64; 2]], part: f64) -> Option<[f64; 2]> {
    let step = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
    let total: f64 = points.windows(2).map(step).sum();
    let mut left = part * total;
    for pair in points.windows(2) {
        let length = step(pair);
        if length >= left && length > 0.0 {
            let t = left / length;
            return Some([0, 1].map(|i| pair[0][i] + t * (pair[1][i] - pair[0][i])));
        }
        left -= length;
    }
    points.last().copied()
}
