//! Paths, and the curves that diagrams need.

use crate::text::{Rect, Segment, bounds};

/// Contours in page coordinates, points; each begins with [`Segment::Move`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Path(pub Vec<Segment>);

/// A point of a curve, with the curve's derivative there by its parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// The parameter; greater than that of the node before.
    pub parameter: f64,
    /// The point.
    pub at: [f64; 2],
    /// Its derivative by the parameter.
    pub derivative: [f64; 2],
}

/// The distance of the control points of a quarter circle from its ends, in radii: such that its middle is on the circle, 4(√2 − 1)/3. The
/// radius is then accurate to 2.8e-4 of itself.
const QUARTER: f64 = 0.552_284_749_830_793_4;

impl Path {
    /// A straight line.
    pub fn line(from: [f64; 2], to: [f64; 2]) -> Path {
        Path::polyline(&[from, to])
    }

    /// Straight lines from point to point; empty for no points.
    pub fn polyline(points: &[[f64; 2]]) -> Path {
        let segments = points.iter().enumerate().map(|(i, p)| match i {
            0 => Segment::Move(*p),
            _ => Segment::Line(*p),
        });
        Path(segments.collect())
    }

    /// Straight lines from point to point and back to the first.
    pub fn polygon(points: &[[f64; 2]]) -> Path {
        Path::polyline(points).closed()
    }

    /// A rectangle from its corners of least and greatest coordinates.
    pub fn rect(rect: Rect) -> Path {
        let ([x0, y0], [x1, y1]) = (rect.min, rect.max);
        Path::polygon(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    }

    /// A circle of four cubic arcs.
    pub fn circle([x, y]: [f64; 2], radius: f64) -> Path {
        let at = |u: f64, v: f64| [x + radius * u, y + radius * v];
        let k = QUARTER;
        Path(vec![
            Segment::Move(at(1.0, 0.0)),
            Segment::Cubic(at(1.0, k), at(k, 1.0), at(0.0, 1.0)),
            Segment::Cubic(at(-k, 1.0), at(-1.0, k), at(-1.0, 0.0)),
            Segment::Cubic(at(-1.0, -k), at(-k, -1.0), at(0.0, -1.0)),
            Segment::Cubic(at(k, -1.0), at(1.0, -k), at(1.0, 0.0)),
            Segment::Close,
        ])
    }

    /// A smooth curve through the nodes with their derivatives (cubic Hermite): of fourth order in their
    /// distance, the choice where velocities are known.
    pub fn hermite(nodes: &[Node]) -> Path {
        let mut segments = Vec::with_capacity(nodes.len());
        segments.extend(nodes.first().map(|node| Segment::Move(node.at)));
        for pair in nodes.windows(2) {
            let third = (pair[1].parameter - pair[0].parameter) / 3.0;
            let control =
                |node: &Node, by: f64| [0, 1].map(|i| node.at[i] + by * node.derivative[i]);
            let controls = (control(&pair[0], third), control(&pair[1], -third));
            segments.push(Segment::Cubic(controls.0, controls.1, pair[1].at));
        }
        Path(segments)
    }

    /// A smooth curve through points, none of whose coordinates overshoots its values at the two ends of a piece. Repeated points are
    /// skipped.
    ///
    /// The curve is parametrised by chord length; the derivative of each coordinate is the weighted harmonic mean of the slopes on both
    /// sides, and 0 if they differ in sign (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984).
    pub fn smooth(points: &[[f64; 2]]) -> Path {
        let mut points = points.to_vec();
        points.dedup();
        let mut nodes: Vec<Node> = Vec::with_capacity(points.len());
        for &at in &points {
            let parameter = nodes.last().map_or(0.0, |last| {
                let [x, y] = [at[0] - last.at[0], at[1] - last.at[1]];
                last.parameter + x.hypot(y)
            });
            nodes.push(Node {
                parameter,
                at,
                derivative: [0.0; 2],
            });
        }
        for axis in 0..2 {
            for (node, slope) in monotone_slopes(&nodes, axis).into_iter().enumerate() {
                nodes[node].derivative[axis] = slope;
            }
        }
        Path::hermite(&nodes)
    }

    /// The path with its last contour closed.
    pub fn closed(mut self) -> Path {
        if !self.0.is_empty() {
            self.0.push(Segment::Close);
        }
        self
    }

    /// The path followed by the contours of another.
    pub fn and(mut self, other: Path) -> Path {
        self.0.extend(other.0);
        self
    }

    /// The path with every point moved through `map`, which should be affine: curves go through their
    /// control points.
    pub fn map(&self, map: impl Fn([f64; 2]) -> [f64; 2]) -> Path {
        Path(self.0.iter().map(|segment| segment.map(&map)).collect())
    }

    /// The bounding box of the path, without the width of its stroke; `None` for an empty path.
    pub fn bounds(&self) -> Option<Rect> {
        bounds(&self.0)
    }
}

/// The derivatives of one coordinate at the nodes.
fn monotone_slopes(nodes: &[Node], axis: usize) -> Vec<f64> {
    let steps: Vec<f64> = nodes
        .windows(2)
        .map(|w| w[1].parameter - w[0].parameter)
        .collect();
    let slope = |i: usize| (nodes[i + 1].at[axis] - nodes[i].at[axis]) / steps[i];
    match steps.len() {
        0 => vec![0.0; nodes.len()],
        1 => vec![slope(0); 2],
        n => (0..=n)
            .map(|i| match i {
                0 => end_slope([steps[0], steps[1]], [slope(0), slope(1)]),
                i if i == n => {
                    end_slope([steps[n - 1], steps[n - 2]], [slope(n - 1), slope(n - 2)])
                }
                i => inner_slope([steps[i - 1], steps[i]], [slope(i - 1), slope(i)]),
            })
            .collect(),
    }
}

/// The weighted harmonic mean of the slopes on both sides.
fn inner_slope([h0, h1]: [f64; 2], [d0, d1]: [f64; 2]) -> f64 {
    if d0 * d1 <= 0.0 {
        // A turning point: any other slope would overshoot it.
        return 0.0;
    }
    // The slope of the shorter step counts for more.
    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
    (w0 + w1) / (w0 / d0 + w1 / d1)
}

/// The slope at an end of the parabola through the three last points, kept from overshooting.
fn end_slope([h0, h1]: [f64; 2], [d0, d1]: [f64; 2]) -> f64 {
    let slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if slope * d0 <= 0.0 {
        0.0
    } else if d0 * d1 <= 0.0 && slope.abs() > 3.0 * d0.abs() {
        // Three times the chord's slope is the most that a monotone cubic may have (Fritsch and Carlson 1980).
        3.0 * d0
    } else {
        slope
    }
}
