//! The lines of a hatch.
//!
//! With u = (cos α, −sin α) along the lines (y runs down) and n = (sin α, cos α) across them, line k is
//! n·p = k s. The lines that touch an area are those with k s within half a line's width of the range of
//! n·p over it.

use super::{Hatch, Path};
use crate::text::{Rect, Segment};

/// The most lines in one area.
pub(super) const MOST_LINES: f64 = 10_000.0;

/// The lines that cover the visible part of `area` on the page.
pub(super) fn lines(hatch: &Hatch, area: Rect, page: Rect) -> Path {
    let (sin, cos) = libm::sincos(hatch.angle);
    let seen = meet(area, page);
    let across = range(seen, [sin, cos], hatch.width / 2.0);
    let along = range(seen, [cos, -sin], hatch.width);
    let first = (across[0] / hatch.spacing).ceil();
    let last = (across[1] / hatch.spacing).floor();
    // At most MOST_LINES, as ensured by `check`.
    let count = (last - first + 1.0).clamp(0.0, MOST_LINES) as u32;
    let mut segments = Vec::with_capacity(2 * count as usize);
    for k in 0..count {
        let d = (first + f64::from(k)) * hatch.spacing;
        // Along the lines is (cos, −sin), across them (sin, cos).
        let at = |u: f64| [u * cos + d * sin, d * cos - u * sin];
        segments.extend([Segment::Move(at(along[0])), Segment::Line(at(along[1]))]);
    }
    Path(segments)
}

/// The range of `direction`·p over a box, wider by `margin` on both sides.
fn range(rect: Rect, direction: [f64; 2], margin: f64) -> [f64; 2] {
    let ends = [0, 1].map(|axis| {
        let (a, b) = (
            rect.min[axis] * direction[axis],
            rect.max[axis] * direction[axis],
        );
        [a.min(b), a.max(b)]
    });
    [
        ends[0][0] + ends[1][0] - margin,
        ends[0][1] + ends[1][1] + margin,
    ]
}

fn meet(a: Rect, b: Rect) -> Rect {
    let min = [0, 1].map(|i| a.min[i].max(b.min[i]));
    Rect {
        min,
        max: [0, 1].map(|i| a.max[i].min(b.max[i]).max(min[i])),
    }
}
