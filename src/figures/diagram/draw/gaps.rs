//! Lines that labels interrupt, where a crowded page or a label on its way has no other place for it.

use super::labels::{widened, without};
use crate::figures::drawing::{Item, Path, Stroke};
use crate::figures::text::{Rect, Segment};

/// What is left free around a label, points.
const AIR: f64 = 0.6;
/// Lines of less opacity are seen as ground.
const PALE: u8 = 170;

/// `items` with gaps in lines that go through `labels`.
pub(super) fn interrupted(items: Vec<Item>, labels: &[Rect]) -> Vec<Item> {
    let gaps = |item: Item| match item {
        Item::Clip { path, items } => vec![Item::Clip {
            path,
            items: interrupted(items, labels),
        }],
        Item::Path {
            path,
            fill: None,
            stroke: Some(stroke),
        } if stroke.colour.alpha >= PALE => match straight(&path) {
            Some(points) if points.windows(2).any(|w| is_crossed(w, labels)) => {
                pieces(&points, stroke, labels)
            }
            _ => vec![Item::stroked(path, stroke)],
        },
        other => vec![other],
    };
    items.into_iter().flat_map(gaps).collect()
}

/// The points of a path of one straight line after the other.
fn straight(path: &Path) -> Option<Vec<[f64; 2]>> {
    let point = |(i, segment): (usize, &Segment)| match *segment {
        Segment::Move(point) if i == 0 => Some(point),
        Segment::Line(point) if i > 0 => Some(point),
        _ => None,
    };
    path.0.iter().enumerate().map(point).collect()
}

fn is_crossed(ends: &[[f64; 2]], labels: &[Rect]) -> bool {
    labels
        .iter()
        .any(|label| label.is_crossed(ends[0], ends[1]))
}

/// What is left of a line; its arrowheads stay at its ends.
fn pieces(points: &[[f64; 2]], stroke: Stroke, labels: &[Rect]) -> Vec<Item> {
    let gaps: Vec<Rect> = labels
        .iter()
        .filter(|label| points.windows(2).any(|w| label.is_crossed(w[0], w[1])))
        .map(|label| widened(*label, AIR))
        .collect();
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    for ends in points.windows(2) {
        for [from, to] in without([ends[0], ends[1]], &gaps) {
            match lines.last_mut().filter(|line| line.last() == Some(&from)) {
                Some(line) => line.push(to),
                None => lines.push(vec![from, to]),
            }
        }
    }
    let (first, last) = (points.first(), points.last());
    let piece = |line: Vec<[f64; 2]>| {
        let stroke = Stroke {
            start: stroke.start.filter(|_| line.first() == first),
            end: stroke.end.filter(|_| line.last() == last),
            ..stroke.clone()
        };
        Item::stroked(Path::polyline(&line), stroke)
    };
    lines.into_iter().map(piece).collect()
}
