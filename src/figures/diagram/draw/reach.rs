//! Cuts what lies far beyond the page, which no format has numbers for.

use super::labels::{part_within, widened};
use super::page::Page;
use crate::figures::drawing::{Item, Path, Stroke};
use crate::figures::text::{Rect, Segment};

/// How far from the page anything is drawn, points: beyond the width of any line, and within the largest length of TeX on pages of paper.
const REACH: f64 = 10_000.0;

/// What may be drawn on: the page, and far around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach(Rect);

impl Reach {
    pub fn of(page: &Page) -> Reach {
        let page = Rect {
            min: [0.0; 2],
            max: [page.width, page.height],
        };
        Reach(widened(page, REACH))
    }

    pub fn holds(&self, p: [f64; 2]) -> bool {
        (0..2).all(|i| (self.0.min[i]..=self.0.max[i]).contains(&p[i]))
    }

    /// `items` without what is beyond; those that are within are unchanged.
    pub fn cut(&self, items: Vec<Item>) -> Vec<Item> {
        items.into_iter().flat_map(|item| self.part(item)).collect()
    }

    fn part(&self, item: Item) -> Vec<Item> {
        match item {
            Item::Clip { path, items } => vec![Item::Clip {
                path,
                items: self.cut(items),
            }],
            Item::Path { path, fill, stroke } if !self.holds_all(&path) => {
                let Some(corners) = corners(&path) else {
                    // Curves are small: dots.
                    return Vec::new();
                };
                match (fill, stroke) {
                    (None, Some(stroke)) if path.0.last() != Some(&Segment::Close) => {
                        self.pieces(&corners, &stroke)
                    }
                    (fill, stroke) => {
                        let path = Path::polygon(&self.polygon(corners));
                        let is_left = !path.0.is_empty();
                        is_left
                            .then_some(Item::Path { path, fill, stroke })
                            .into_iter()
                            .collect()
                    }
                }
            }
            item => vec![item],
        }
    }

    fn holds_all(&self, path: &Path) -> bool {
        path.0.iter().all(|segment| match *segment {
            Segment::Move(p) | Segment::Line(p) => self.holds(p),
            Segment::Quadratic(a, p) => self.holds(a) && self.holds(p),
            Segment::Cubic(a, b, p) => self.holds(a) && self.holds(b) && self.holds(p),
            Segment::Close => true,
        })
    }

    /// The parts of a line; its arrowheads stay at its ends.
    fn pieces(&self, points: &[[f64; 2]], stroke: &Stroke) -> Vec<Item> {
        let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
        for ends in points.windows(2) {
            let finite = ends.iter().flatten().all(|v| v.is_finite());
            let part = part_within(self.0, ends[0], ends[1]).filter(|_| finite);
            // Rounding of a far end may leave the part a little outside.
            let Some([from, to]) = part.map(|part| part.map(|p| self.clamped(p))) else {
                continue;
            };
            match lines.last_mut().filter(|line| line.last() == Some(&from)) {
                Some(line) => line.push(to),
                None if from != to => lines.push(vec![from, to]),
                None => {}
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

    fn clamped(&self, p: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| p[i].clamp(self.0.min[i], self.0.max[i]))
    }

    /// The part of a polygon, cut at one side after the other (Sutherland and Hodgman 1974).
    fn polygon(&self, mut corners: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        corners.retain(|p| p.iter().all(|v| v.is_finite()));
        for (axis, side, sign) in [
            (0, self.0.min[0], 1.0),
            (0, self.0.max[0], -1.0),
            (1, self.0.min[1], 1.0),
            (1, self.0.max[1], -1.0),
        ] {
            let inside = |p: &[f64; 2]| sign * (p[axis] - side);
            let mut kept = Vec::with_capacity(corners.len() + 1);
            for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                let (at_a, at_b) = (inside(a), inside(b));
                if at_a >= 0.0 {
                    kept.push(*a);
                }
                if (at_a >= 0.0) != (at_b >= 0.0) {
                    let part = at_a / (at_a - at_b);
                    let mut p = [0, 1].map(|i| a[i] + part * (b[i] - a[i]));
                    p[axis] = side;
                    kept.push(p);
                }
            }
            corners = kept;
        }
        // What is left of corners as far as numbers go may not be finite.
        corners.retain(|p| self.holds(*p));
        corners
    }
}

/// The corners of a path of one contour of straight lines.
fn corners(path: &Path) -> Option<Vec<[f64; 2]>> {
    let corner = |(i, segment): (usize, &Segment)| match *segment {
        Segment::Move(p) if i == 0 => Some(p),
        Segment::Line(p) if i > 0 => Some(p),
        _ => None,
    };
    let open = match path.0.split_last() {
        Some((Segment::Close, open)) => open,
        _ => &path.0[..],
    };
    open.iter().enumerate().map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::drawing::{Arrow, Colour};

    const REACH: Reach = Reach(Rect {
        min: [-10.0; 2],
        max: [20.0; 2],
    });

    fn line(points: &[[f64; 2]]) -> Item {
        let stroke = Stroke::new(Colour::BLACK, 1.0).ending(Arrow::of_line(1.0));
        Item::stroked(Path::polyline(points), stroke)
    }

    #[test]
    fn lines_end_at_the_reach_and_keep_the_head_of_an_end_that_is_left() {
        let within = vec![line(&[[0.0, 0.0], [20.0, 5.0]])];
        assert_eq!(REACH.cut(within.clone()), within);
        for (points, left, head) in [
            (
                [[0.0, 5.0], [1e200, 5.0]],
                Some([[0.0, 5.0], [20.0, 5.0]]),
                false,
            ),
            (
                [[-1e9, 5.0], [3.0, 5.0]],
                Some([[-10.0, 5.0], [3.0, 5.0]]),
                true,
            ),
            ([[0.0, 1e9], [5.0, 1e9]], None, false),
            ([[0.0, 0.0], [f64::INFINITY, 0.0]], None, false),
            ([[f64::NAN, 0.0], [5.0, 0.0]], None, false),
        ] {
            let cut = REACH.cut(vec![line(&points)]);
            let Some(left) = left else {
                assert!(cut.is_empty(), "{cut:?}");
                continue;
            };
            let [
                Item::Path {
                    path,
                    stroke: Some(stroke),
                    ..
                },
            ] = &cut[..]
            else {
                panic!("{cut:?}");
            };
            assert_eq!(*path, Path::polyline(&left));
            assert_eq!(stroke.end.is_some(), head);
        }
    }

    #[test]
    fn areas_are_cut_at_the_reach_and_dots_beyond_are_left_out() {
        let area = |points: &[[f64; 2]]| Item::filled(Path::polygon(points), Colour::BLACK);
        let cut = REACH.cut(vec![area(&[[0.0, 0.0], [40.0, 0.0], [0.0, 10.0]])]);
        let left = area(&[[0.0, 0.0], [20.0, 0.0], [20.0, 5.0], [0.0, 10.0]]);
        assert_eq!(cut, [left]);
        let far = [
            area(&[[1e9, 0.0], [2e9, 0.0], [1e9, 1.0]]),
            area(&[[f64::NAN; 2]; 3]),
            Item::filled(Path::circle([1e9, 0.0], 2.0), Colour::BLACK),
        ];
        assert!(REACH.cut(far.to_vec()).is_empty());
    }
}
