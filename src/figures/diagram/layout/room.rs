//! The parts that a layout of 2+1 dimensions has besides, and what they hide.

use super::types::{Curve, Panel, Point};
use crate::figures::diagram::model::Colour;

/// One half of a light cone in 2+1 dimensions, up to the circle on which its light is at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Nappe {
    /// The apex.
    pub apex: Point,
    /// ct of the rim less that of the apex: below 0 for the past.
    pub height: f64,
    /// The rim, all around, beginning at the first edge: first the side that is nearer to the reader.
    pub near: Vec<Point>,
    /// The rest of the rim, back to the first edge.
    pub far: Vec<Point>,
}

/// Events of one time of a frame, in 2+1 dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// Which of the model's frames.
    pub frame: usize,
    /// The part within the limits.
    pub corners: Vec<Point>,
    /// How much ct rises along x and along y.
    pub rise: [f64; 2],
    /// An event on it.
    pub event: Point,
    /// What stands beside it.
    pub label: Option<String>,
    /// The colour; none for the frame's.
    pub colour: Option<Colour>,
}

/// What 2+1 dimensions have besides.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// The corners of the floor, at the lowest ct: near left, near right, far right, far left.
    pub floor: [Point; 4],
    /// Lines of equal x and of equal y on it.
    pub grid: Vec<[Point; 2]>,
    /// What is straight below world lines, in their order.
    pub shadows: Vec<Curve>,
    /// What is straight below light signals.
    pub light: Vec<[Point; 2]>,
    /// From events down to the floor.
    pub drops: Vec<[Point; 2]>,
}

impl Panel {
    /// The rectangle of the page that it takes: from left to right, and from bottom to top. In 2+1 dimensions
    /// that is no more than what is drawn needs.
    pub fn page(&self) -> [[f64; 2]; 2] {
        let Some(solid) = &self.solid else {
            return [self.limits.x, self.limits.ct];
        };
        let rims = self.cones.iter().flat_map(|cone| &cone.nappes);
        let rims = rims.flat_map(|nappe| nappe.near.iter().chain(&nappe.far));
        let planes = self.planes.iter().flat_map(|plane| &plane.corners);
        let lines = self.world_lines.iter().flat_map(|line| &line.curve.points);
        let signals = self.signals.iter().flat_map(|signal| &signal.ends);
        let axes = self.axes.iter().flat_map(|axes| &axes.time.ends);
        let events = self.events.iter().map(|event| &event.at);
        let all = solid.floor.iter().chain(rims).chain(planes).chain(lines);
        let all = all.chain(signals).chain(axes).chain(events);
        let mut sides = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for p in all.filter(|p| self.limits.contains(**p)) {
            for (side, at) in sides.iter_mut().zip(p.page()) {
                *side = [side[0].min(at), side[1].max(at)];
            }
        }
        // Room for the width of lines.
        let air = 0.01 * (sides[0][1] - sides[0][0] + sides[1][1] - sides[1][0]);
        sides.map(|[from, to]| [from - air, to + air])
    }
}

impl Nappe {
    /// The outline of its mantle: from one edge by way of the apex to the other.
    pub fn outline(&self) -> [Point; 3] {
        let edge = |p: Option<&Point>| p.copied().unwrap_or(self.apex);
        [edge(self.near.first()), self.apex, edge(self.near.last())]
    }

    /// Whether the cone is between the reader and a point, by more than `clearance` units.
    ///
    /// p + t n with n the line of sight is on the cone of apex A where |(x, y)|² = ct² of p + t n − A.
    pub fn hides(&self, p: Point, clearance: f64) -> bool {
        let (v, n) = (p.from(self.apex), Point::TOWARDS);
        let product = |a: Point, b: Point| a.x * b.x + a.y * b.y - a.ct * b.ct;
        let (a, b, c) = (product(n, n), product(v, n), product(v, v));
        let root = (b * b - a * c).max(0.0).sqrt();
        let times = [(-b - root) / a, (-b + root) / a];
        let ends = [self.height.min(0.0), self.height.max(0.0)];
        let is_on = |t: &f64| {
            let ct = v.ct + t * n.ct;
            *t > clearance && (ends[0]..=ends[1]).contains(&ct)
        };
        b * b > a * c && times.iter().any(is_on)
    }
}

impl Plane {
    /// Whether the plane, as far as it is drawn, is between the reader and a point, by more than `clearance`.
    pub fn hides(&self, p: Point, clearance: f64) -> bool {
        let n = Point::TOWARDS;
        let above = |p: Point| p.ct - self.rise[0] * p.x - self.rise[1] * p.y;
        let t = (above(self.event) - above(p)) / above(n);
        t > clearance && self.holds(p.plus(t, n))
    }

    /// Whether a point of the plane is within its corners, seen along ct; they go around counter-clockwise.
    fn holds(&self, p: Point) -> bool {
        let after = self.corners.iter().cycle().skip(1);
        let left = |(a, b): (&Point, &Point)| {
            let (side, way) = (b.from(*a), p.from(*a));
            side.x * way.y - side.y * way.x >= 0.0
        };
        self.corners.iter().zip(after).all(left)
    }
}
