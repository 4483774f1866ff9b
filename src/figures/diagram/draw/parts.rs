//! Lines of which only parts are drawn.

use crate::figures::drawing::{Item, Path, Stroke};
use crate::text::Segment;

/// The points of one contour of straight lines.
pub(super) fn straight(contour: &[Segment]) -> Option<Vec<[f64; 2]>> {
    let point = |(i, segment): (usize, &Segment)| match *segment {
        Segment::Move(point) if i == 0 => Some(point),
        Segment::Line(point) if i > 0 => Some(point),
        Segment::Move(_)
        | Segment::Line(_)
        | Segment::Quadratic(..)
        | Segment::Cubic(..)
        | Segment::Close => None,
    };
    contour.iter().enumerate().map(point).collect()
}

/// The `parts` of a line through `points`, in order; its arrowheads stay at its ends.
pub(super) fn pieces(
    points: &[[f64; 2]],
    parts: impl Iterator<Item = [[f64; 2]; 2]>,
    stroke: &Stroke,
) -> Vec<Item> {
    // Parts that touch remain one line, so that dashes and joins continue.
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    for [from, to] in parts {
        match lines.last_mut().filter(|line| line.last() == Some(&from)) {
            Some(line) => line.push(to),
            None => lines.push(vec![from, to]),
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
