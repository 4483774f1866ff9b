//! Cuts what lies far beyond the page, which no format has numbers for.

use super::labels::{part_within, widened};
use super::page::Page;
use super::parts::{pieces, straight};
use crate::figures::drawing::{Item, Path};
use crate::text::{Rect, Segment};

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
                        let parts = corners.windows(2).filter_map(|ends| self.part_of(ends));
                        pieces(&corners, parts, &stroke)
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

    /// The part of a line between two points.
    fn part_of(&self, ends: &[[f64; 2]]) -> Option<[[f64; 2]; 2]> {
        let is_finite = ends.iter().flatten().all(|v| v.is_finite());
        let part = part_within(self.0, ends[0], ends[1]).filter(|_| is_finite)?;
        // Rounding of a far end may leave the part a little outside.
        let [from, to] = part.map(|p| self.clamped(p));
        (from != to).then_some([from, to])
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

/// The corners of a path of one contour of straight lines, which may be closed.
fn corners(path: &Path) -> Option<Vec<[f64; 2]>> {
    match path.0.split_last() {
        Some((Segment::Close, open)) => straight(open),
        _ => straight(&path.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::drawing::{Arrow, Colour, Stroke};

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
