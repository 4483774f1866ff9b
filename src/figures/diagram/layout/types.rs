//! The parts of a layout.

use crate::figures::diagram::model::{Colour, DrawnCurve, Kind, Segment, Spot};

/// The view of 2+1 dimensions: turned about the ct axis by the angle whose cosine and sine these are, and seen from above, so
/// that circles about that axis are ellipses of this height, in parts of their width. Turned this way, the planes of equal time
/// of what moves along +x are seen from above, and not from their edge.
pub(super) const TURN: [f64; 2] = [0.96, -0.28];
pub(super) const HEIGHT: f64 = 7.0 / 24.0;
/// Of one along ct: √(1 + HEIGHT²), with which the outline of a light cone is at 45 degrees.
pub(super) const RISE: f64 = 25.0 / 24.0;

/// A point of a diagram, in its unit.
///
/// In 1+1 dimensions ct goes up and x to the right. In 2+1 dimensions it is drawn in parallel projection, seen from above and
/// turned about the ct axis, so that this axis and all light cones stand upright on the page:
///
/// ```text
/// right = x cos α + y sin α,     up = s ct + k (y cos α − x sin α),     cos α = 24/25,   sin α = −7/25,   k = 7/24,   s = √(1 + k²).
/// ```
///
/// A cone of height h has its rim at right = h cos ψ, up = s h + k h sin ψ. It is tangent to the line from the apex where
/// s sin ψ = −k, which is at right = h √(1 − k²/s²) = h/s and up = h (s − k²/s) = h/s: 45 degrees, as light in 1+1 dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// Upwards.
    pub ct: f64,
    /// To the right; in 2+1 dimensions a little away from the reader too.
    pub x: f64,
    /// Away from the reader and a little to the left; 0 in 1+1 dimensions.
    pub y: f64,
}

/// How the points of a diagram are drawn on the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Projection {
    /// 1+1 dimensions: as they are.
    Plane,
    /// 2+1 dimensions: upright, seen from above.
    Room,
}

/// A diagram laid out.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Layout {
    /// A line above.
    pub title: Option<String>,
    /// Views side by side.
    pub panels: Vec<Panel>,
    /// Lines below: what is left out, what is a projection, and along which direction of the world x is measured.
    pub notes: Vec<Note>,
}

/// A line below a diagram.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Note {
    /// Markup.
    pub text: String,
    /// The colour; `None` for that of the ink.
    pub colour: Option<Colour>,
}

/// The diagram in one frame's coordinates.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Panel {
    /// The frame's name.
    pub frame: String,
    /// The limits shown.
    pub limits: Limits,
    /// Additional parts of 2+1 dimensions: the floor, and the shadows on it.
    pub solid: Option<Solid>,
    /// The area that the page of a series covers besides this picture, as in [`page`](Panel::page): then nothing moves on the page between
    /// pictures except what moves in the diagram.
    pub held: Option<[[f64; 2]; 2]>,
    /// Axes of frames; the first are the view's own.
    pub axes: Vec<Axes>,
    /// Lines of equal time and place.
    pub grid: Vec<GridLine>,
    /// World lines.
    pub world_lines: Vec<WorldLine>,
    /// Light cones.
    pub cones: Vec<Cone>,
    /// Hyperbolae of constant interval.
    pub hyperbolae: Vec<Hyperbola>,
    /// Curves that are not world lines.
    pub curves: Vec<DrawnCurve<Point>>,
    /// World sheets, regions and wedges, lowest first.
    pub areas: Vec<Area>,
    /// Lines of equal time and equal place; their owners are frames.
    pub slices: Vec<Segment<Point>>,
    /// In 2+1 dimensions, planes of equal time.
    pub planes: Vec<Plane>,
    /// Light signals.
    pub signals: Vec<Segment<Point>>,
    /// Whether each of them leaves the plane (in 2+1 dimensions: the space) of the diagram, so that its projection is drawn, steeper than
    /// light.
    pub projected: Vec<bool>,
    /// Intervals.
    pub intervals: Vec<Interval>,
    /// Arrows; their owners are world lines.
    pub arrows: Vec<Segment<Point>>,
    /// Simultaneous events, with the readings of clocks.
    pub now: Option<Now>,
    /// Events.
    pub events: Vec<Spot<Point>>,
    /// Words.
    pub texts: Vec<Spot<Point>>,
}

/// The axes of a frame.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Axes {
    /// Which of the model's frames.
    pub frame: usize,
    /// Its time axis.
    pub time: Axis,
    /// Its space axis, where its time is 0.
    pub space: Axis,
    /// The y axis, in 2+1 dimensions.
    pub depth: Option<Axis>,
    /// The colour; `None` for the next of the palette.
    pub colour: Option<Colour>,
}

/// An axis, from lower to higher values.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Axis {
    /// Its ends.
    pub ends: [Point; 2],
    /// The label at its upper end.
    pub label: String,
    /// Its ticks; that of 0 is left out.
    pub ticks: Vec<Tick>,
}

/// A tick on an axis or a world line.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Tick {
    /// Where.
    pub at: Point,
    /// The value there, in the diagram's unit.
    pub value: f64,
    /// The direction of the line that it is on.
    pub along: Point,
    /// Its label.
    pub label: Option<String>,
}

/// A line of equal time or place of a frame.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GridLine {
    /// Which of the model's frames.
    pub frame: usize,
    /// Its ends.
    pub ends: [Point; 2],
}

/// A drawn curve.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Curve {
    /// Points, close enough to each other to be joined by straight lines.
    pub points: Vec<Point>,
}

/// A world line.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WorldLine {
    /// Its name.
    pub name: String,
    /// Its curve, upwards.
    pub curve: Curve,
    /// Ticks of its own clock.
    pub ticks: Vec<Tick>,
    /// Its label.
    pub label: Option<String>,
    /// Whether it leaves the plane (in 2+1 dimensions: the space) of the diagram, so that its projection is drawn, steeper than it is.
    pub projected: bool,
    /// The colour; `None` for the next of the palette.
    pub colour: Option<Colour>,
}

/// A light cone.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Cone {
    /// Its apex.
    pub apex: Point,
    /// Its rays, from the apex to the limits.
    pub rays: Vec<[Point; 2]>,
    /// Its interior, if that is shaded.
    pub inside: Vec<Vec<Point>>,
    /// Its halves, in 2+1 dimensions.
    pub nappes: Vec<Nappe>,
}

/// Events of one interval from an event.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Hyperbola {
    /// Its curve.
    pub curve: Curve,
    /// Its label.
    pub label: Option<String>,
    /// The colour.
    pub colour: Option<Colour>,
}

/// A shaded area.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Area {
    /// Its edge.
    pub edge: Vec<Point>,
    /// Light rays that bound it.
    pub horizons: Vec<[Point; 2]>,
    /// The world line whose colour it has.
    pub owner: Option<usize>,
    /// The label on it.
    pub label: Option<Placed>,
    /// The colour.
    pub colour: Option<Colour>,
}

/// Words within an area.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Placed {
    /// The words.
    pub text: String,
    /// Possible positions of their middle, the best first.
    pub places: Vec<Point>,
}

/// The interval between two events.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Interval {
    /// The events.
    pub ends: [Point; 2],
    /// (Δct)² − |Δx|², in the diagram's unit, squared; below this in size if its kind is [`Kind::Unresolved`].
    pub squared: f64,
    /// Its kind.
    pub kind: Kind,
    /// Its label.
    pub label: String,
    /// The colour.
    pub colour: Option<Colour>,
}

/// A line of simultaneity, and where it crosses the world lines.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Now {
    /// Which of the model's frames.
    pub frame: usize,
    /// Its ends.
    pub ends: [Point; 2],
    /// Where world lines are.
    pub beads: Vec<Bead>,
    /// The colour; `None` for the frame's.
    pub colour: Option<Colour>,
}

/// A clock on its world line.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Bead {
    /// Which of the panel's world lines.
    pub line: usize,
    /// Its position.
    pub at: Point,
    /// Its reading, in the diagram's unit.
    pub proper_time: f64,
    /// Its label: the reading, if the world line has ticks.
    pub label: Option<String>,
}

/// One half of a light cone in 2+1 dimensions, up to the circle on which its light is at one time.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
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
#[non_exhaustive]
pub struct Plane {
    /// Which of the model's frames.
    pub frame: usize,
    /// The part within the limits.
    pub corners: Vec<Point>,
    /// The slope of ct along x and along y.
    pub rise: [f64; 2],
    /// An event on it.
    pub event: Point,
    /// Its label.
    pub label: Option<String>,
    /// The colour; `None` for the frame's.
    pub colour: Option<Colour>,
}

/// Additional parts of 2+1 dimensions.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Solid {
    /// The corners of the floor, at the lowest ct: near left, near right, far right, far left.
    pub floor: [Point; 4],
    /// Lines of equal x and of equal y on it.
    pub grid: Vec<[Point; 2]>,
    /// The shadows of world lines, in their order.
    pub shadows: Vec<Curve>,
    /// The shadows of light signals.
    pub light: Vec<[Point; 2]>,
    /// From events down to the floor.
    pub drops: Vec<[Point; 2]>,
}

/// A rectangle of a diagram, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// From left to right.
    pub x: [f64; 2],
    /// From bottom to top.
    pub ct: [f64; 2],
    /// From the front to the back; [0, 0] in 1+1 dimensions.
    pub y: [f64; 2],
}

impl Limits {
    /// Width (along x) and height.
    pub fn size(&self) -> [f64; 2] {
        [self.x[1] - self.x[0], self.ct[1] - self.ct[0]]
    }

    /// Whether a point is within, edges included.
    pub fn contains(&self, p: Point) -> bool {
        let sides = [(p.x, self.x), (p.ct, self.ct), (p.y, self.y)];
        sides.iter().all(|(p, [from, to])| (from..=to).contains(&p))
    }

    /// The part within of the line through `p` along `d`.
    pub fn line(&self, p: Point, d: Point) -> Option<[Point; 2]> {
        self.part(p, d, [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// The part within of the ray from `p` along `d`.
    pub fn ray(&self, p: Point, d: Point) -> Option<[Point; 2]> {
        self.part(p, d, [0.0, f64::INFINITY])
    }

    /// The part within of the way from `a` to `b`.
    pub fn segment(&self, a: Point, b: Point) -> Option<[Point; 2]> {
        self.part(a, b.from(a), [0.0, 1.0])
    }

    /// The part within of p + t d for t between two values (Liang and Barsky).
    fn part(&self, p: Point, d: Point, [mut from, mut to]: [f64; 2]) -> Option<[Point; 2]> {
        // The range of t within the limits of the three directions.
        for (p, d, [low, high]) in [
            (p.x, d.x, self.x),
            (p.ct, d.ct, self.ct),
            (p.y, d.y, self.y),
        ] {
            if d == 0.0 {
                if !(low..=high).contains(&p) {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - p) / d, (high - p) / d);
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        }
        (from < to).then(|| [p.plus(from, d), p.plus(to, d)])
    }

    /// A length beyond all of it.
    pub fn beyond(&self, p: Point) -> f64 {
        let [width, height] = self.size();
        let way = |low: f64, high: f64, p: f64| (p - low).abs().max((high - p).abs());
        let [x, ct] = [
            way(self.x[0], self.x[1], p.x),
            way(self.ct[0], self.ct[1], p.ct),
        ];
        2.0 * (width + height) + x + ct
    }
}

impl Point {
    /// A point of 1+1 dimensions.
    pub fn new(ct: f64, x: f64) -> Point {
        Point { ct, x, y: 0.0 }
    }

    /// A point of 2+1 dimensions.
    pub fn deep(ct: f64, x: f64, y: f64) -> Point {
        Point { ct, x, y }
    }

    /// Its position on the page, to the right and upwards, in the diagram's unit.
    pub fn page(self, projection: Projection) -> [f64; 2] {
        let [cos, sin] = TURN;
        match projection {
            Projection::Plane => [self.x, self.ct],
            Projection::Room => [
                self.x * cos + self.y * sin,
                RISE * self.ct + HEIGHT * (self.y * cos - self.x * sin),
            ],
        }
    }

    /// The line of sight of 2+1 dimensions, towards the reader: a point and this one farther are at one place of the page.
    pub const TOWARDS: Point = Point {
        ct: HEIGHT / RISE,
        x: TURN[1],
        y: -TURN[0],
    };

    /// This and `t` times `direction`.
    pub fn plus(self, t: f64, direction: Point) -> Point {
        Point {
            ct: self.ct + t * direction.ct,
            x: self.x + t * direction.x,
            y: self.y + t * direction.y,
        }
    }

    /// The displacement from `other` to this point.
    pub fn from(self, other: Point) -> Point {
        self.plus(-1.0, other)
    }
}

impl Panel {
    /// The projection of its points.
    pub fn projection(&self) -> Projection {
        match self.solid {
            Some(_) => Projection::Room,
            None => Projection::Plane,
        }
    }

    /// The rectangle that it covers on the page: from left to right, and from bottom to top. In 2+1 dimensions that is the extent of what
    /// is drawn.
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
            for (side, at) in sides.iter_mut().zip(p.page(Projection::Room)) {
                *side = [side[0].min(at), side[1].max(at)];
            }
        }
        // Room for the width of lines.
        let air = 0.01 * (sides[0][1] - sides[0][0] + sides[1][1] - sides[1][0]);
        let own = sides.map(|[from, to]| [from - air, to + air]);
        match self.held {
            Some(held) => around(own, held),
            None => own,
        }
    }
}

/// The rectangle around two.
pub(crate) fn around(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|i| [a[i][0].min(b[i][0]), a[i][1].max(b[i][1])])
}

impl Nappe {
    /// The outline of its mantle: from one edge through the apex to the other.
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
        // a t² + 2b t + c = 0.
        let (a, b, c) = (product(n, n), product(v, n), product(v, v));
        let root = (b * b - a * c).max(0.0).sqrt();
        let times = [(-b - root) / a, (-b + root) / a];
        let ends = [self.height.min(0.0), self.height.max(0.0)];
        let is_on = |t: &f64| {
            let ct = v.ct + t * n.ct;
            *t > clearance && (ends[0]..=ends[1]).contains(&ct)
        };
        // Without a root the line of sight misses the cone.
        b * b > a * c && times.iter().any(is_on)
    }
}

impl Plane {
    /// Whether the drawn part of the plane is between the viewer and a point, by more than `clearance`.
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

/// The most decimals of a speed: f64 holds no more near 1.
const MOST_DECIMALS: i32 = 15;

/// The β = tanh w of a rapidity.
pub(crate) fn speed(rapidity: f64) -> String {
    // 1 − tanh w = 2/(e^{2w} + 1), which does not cancel.
    let rest = 2.0 / (libm::exp(2.0 * rapidity.abs()) + 1.0);
    speed_with_rest(libm::tanh(rapidity), rest)
}

/// β as [`number`], but with as many digits as two digits of `rest` = 1 − |β| take, so that no speed reads as that of light.
pub(crate) fn speed_with_rest(beta: f64, rest: f64) -> String {
    if rest.is_nan() || rest <= 0.0 {
        return number(beta);
    }
    match 1 - libm::floor(libm::log10(rest)) as i32 {
        ..=4 => number(beta),
        decimals @ ..=MOST_DECIMALS => {
            let text = format!("{beta:.0$}", decimals as usize);
            text.trim_end_matches('0').to_string()
        }
        _ if beta < 0.0 => format!("−(1 − {})", number(rest)),
        _ => format!("1 − {}", number(rest)),
    }
}

/// A number with four digits, as short as possible.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    // Number of the four digits after the decimal point.
    let digits = 3 - libm::floor(libm::log10(value.abs())) as i32;
    if !(-3..=6).contains(&digits) {
        let exponent = 3 - digits;
        let mantissa = number(value / libm::pow(10.0, f64::from(exponent)));
        return format!("{mantissa}·10^{{{exponent}}}");
    }
    let places = digits.max(0) as usize;
    let text = format!("{value:.places$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}
