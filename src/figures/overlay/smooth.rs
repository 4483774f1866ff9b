//! Outlines without the steps of pixels.
//!
//! A line traced on pixels is within half a pixel of the true edge, and goes along slanted edges in steps. The line with the fewest
//! corners that stays within [`TOLERANCE`] of it (Douglas and Peucker 1973) has none of these steps; its corners are then
//! cut twice (Chaikin 1974), by no more than [`CUT`], so that round edges are round and sharp corners stay.

use super::Polyline;

/// How far a smooth line is from the traced one at most, pixels.
const TOLERANCE: f64 = 0.7;
/// The most that a corner is cut from its tip in each round, pixels.
const CUT: f64 = 1.5;
/// Rounds of cutting corners.
const ROUNDS: usize = 2;

/// `line` without steps; closed where it was.
pub(super) fn smooth(line: &Polyline) -> Polyline {
    let closed = line.len() > 3 && line.first() == line.last();
    let mut points = match closed {
        true => {
            // Two halves, from the first point to the one that is farthest from it.
            let first = line[0];
            let far = |p: &[f64; 2]| (p[0] - first[0]).hypot(p[1] - first[1]);
            let middle = (0..line.len()).max_by(|i, j| far(&line[*i]).total_cmp(&far(&line[*j])));
            let middle = middle.unwrap_or(0).clamp(1, line.len() - 2);
            let mut points = simplified(&line[..=middle]);
            points.pop();
            points.extend(simplified(&line[middle..]));
            points
        }
        false => simplified(line),
    };
    for _ in 0..ROUNDS {
        points = cut(&points, closed);
    }
    points
}

/// The points of `line` that are needed to stay within the tolerance; its ends are.
fn simplified(line: &[[f64; 2]]) -> Polyline {
    let mut kept = vec![false; line.len()];
    let last = line.len().saturating_sub(1);
    for end in [0, last] {
        if let Some(kept) = kept.get_mut(end) {
            *kept = true;
        }
    }
    let mut parts = vec![[0, last]];
    while let Some([from, to]) = parts.pop() {
        let inner = (from + 1)..to;
        let off = |i: &usize| distance(line[*i], line[from], line[to]);
        let farthest = inner.max_by(|i, j| off(i).total_cmp(&off(j)));
        if let Some(i) = farthest.filter(|i| off(i) > TOLERANCE) {
            kept[i] = true;
            parts.extend([[from, i], [i, to]]);
        }
    }
    let points = line.iter().zip(kept).filter(|(_, kept)| *kept);
    points.map(|(p, _)| *p).collect()
}

/// Of a point from the straight way between two others.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    let [u, v] = [p[0] - a[0], p[1] - a[1]];
    let squared = x * x + y * y;
    let t = match squared > 0.0 {
        true => ((u * x + v * y) / squared).clamp(0.0, 1.0),
        false => 0.0,
    };
    (u - t * x).hypot(v - t * y)
}

/// Two points for each corner.
fn cut(points: &[[f64; 2]], closed: bool) -> Polyline {
    let count = points.len();
    if count < 3 {
        return points.to_vec();
    }
    // Of a closed line the last point is the first.
    let corners = if closed { 0..count - 1 } else { 1..count - 1 };
    let towards = |p: [f64; 2], q: [f64; 2]| {
        let way = [q[0] - p[0], q[1] - p[1]];
        let part = 0.25f64.min(CUT / way[0].hypot(way[1]).max(f64::MIN_POSITIVE));
        [p[0] + part * way[0], p[1] + part * way[1]]
    };
    let mut all = Vec::with_capacity(2 * count);
    if !closed {
        all.push(points[0]);
    }
    for i in corners {
        let before = points[if i == 0 { count - 2 } else { i - 1 }];
        all.extend([
            towards(points[i], before),
            towards(points[i], points[i + 1]),
        ]);
    }
    match closed {
        true => all.push(all[0]),
        false => all.push(points[count - 1]),
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_a_slanted_edge_become_straight() {
        // y = x/8 in steps of one pixel, each within half a pixel of the edge.
        let line: Polyline = (0..=80)
            .flat_map(|x| {
                let y = (f64::from(x) / 8.0).round();
                [[f64::from(x), y], [f64::from(x) + 0.5, y]]
            })
            .collect();
        let smooth = smooth(&line);
        for pair in smooth.windows(2) {
            let [x, y] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            assert!(x > 0.0 && (y / x - 0.125).abs() < 0.09, "{pair:?}");
        }
        for p in &smooth {
            assert!((p[1] - p[0] / 8.0).abs() <= 0.6 + TOLERANCE, "{p:?}");
        }
    }

    #[test]
    fn corners_stay_and_closed_lines_stay_closed() {
        let square: Polyline = [
            [0.0, 0.0],
            [40.0, 0.0],
            [40.0, 40.0],
            [0.0, 40.0],
            [0.0, 0.0],
        ]
        .into();
        let smooth = smooth(&square);
        assert_eq!(smooth.first(), smooth.last());
        // Cut by 1.5 pixels on each side at most twice: the tip is missed by less than 1.5.
        let miss = smooth
            .iter()
            .map(|p| (p[0] - 40.0).hypot(p[1]))
            .fold(f64::INFINITY, f64::min);
        assert!(miss < 1.5, "{miss}");
    }

    #[test]
    fn short_lines_are_left_as_they_are() {
        for line in [vec![], vec![[1.0, 2.0]], vec![[0.0, 0.0], [3.0, 1.0]]] {
            assert_eq!(smooth(&line), line);
        }
    }
}
