//! Rectangles, lines and polygons of a page.

use crate::figures::text::Rect;

pub(super) fn widened(rect: Rect, by: f64) -> Rect {
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

/// The distance of two rectangles; 0 where they overlap.
pub(super) fn distance(a: Rect, b: Rect) -> f64 {
    let gap = |i: usize| (a.min[i] - b.max[i]).max(b.min[i] - a.max[i]).max(0.0);
    gap(0).hypot(gap(1))
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

/// Whether a straight line goes through a rectangle (Liang and Barsky).
pub(super) fn crosses(rect: Rect, a: [f64; 2], b: [f64; 2]) -> bool {
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

/// Whether a point is inside a polygon: a ray from it crosses the edge an odd number of times.
pub(super) fn is_inside([x, y]: [f64; 2], edge: &[[f64; 2]]) -> bool {
    let before = edge.iter().cycle().skip(edge.len().saturating_sub(1));
    let crossings = edge.iter().zip(before).filter(|(a, b)| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])
    });
    crossings.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rect = Rect {
        min: [0.0; 2],
        max: [1.0; 2],
    };

    #[test]
    fn rectangles_are_apart_by_their_nearest_points() {
        assert_eq!(distance(UNIT, moved(UNIT, [0.5, 0.5])), 0.0);
        assert_eq!(distance(UNIT, moved(UNIT, [4.0, 5.0])), 5.0);
    }

    #[test]
    fn lines_cross_a_rectangle_or_miss_it() {
        assert!(crosses(UNIT, [-1.0, 0.5], [2.0, 0.6]));
        assert!(!crosses(UNIT, [-1.0, 0.5], [0.4, 2.0]));
        assert!(!crosses(UNIT, [2.0, 0.5], [3.0, 0.5]));
    }

    #[test]
    fn points_are_inside_polygons_that_are_not_convex() {
        let edge = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]];
        assert!(is_inside([0.5, 2.0], &edge));
        assert!(!is_inside([2.0, 2.0], &edge));
        assert!(!is_inside([5.0, 0.5], &edge));
    }
}
