//! Outlines of text, and the bounds of their ink.

/// A path to be filled by the non-zero rule.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outline {
    /// The path; every contour begins with a [`Segment::Move`] and ends with a [`Segment::Close`].
    pub segments: Vec<Segment>,
    /// Advance width of the text.
    pub width: f64,
}

/// A piece of a path, with absolute points (x to the right, y down).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// Begins a contour.
    Move([f64; 2]),
    /// A straight line to a point.
    Line([f64; 2]),
    /// A quadratic Bézier curve: control point, end.
    Quadratic([f64; 2], [f64; 2]),
    /// A cubic Bézier curve: two control points, end.
    Cubic([f64; 2], [f64; 2], [f64; 2]),
    /// Closes the contour.
    Close,
}

/// A box with sides along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// The corner of the least x and the least y.
    pub min: [f64; 2],
    /// The corner of the greatest x and the greatest y.
    pub max: [f64; 2],
}

impl Segment {
    /// The segment with every point moved through `map`.
    pub fn map(self, map: impl Fn([f64; 2]) -> [f64; 2]) -> Segment {
        match self {
            Segment::Move(p) => Segment::Move(map(p)),
            Segment::Line(p) => Segment::Line(map(p)),
            Segment::Quadratic(a, p) => Segment::Quadratic(map(a), map(p)),
            Segment::Cubic(a, b, p) => Segment::Cubic(map(a), map(b), map(p)),
            Segment::Close => Segment::Close,
        }
    }

    /// The end of the segment; `None` for [`Segment::Close`].
    pub fn end(self) -> Option<[f64; 2]> {
        match self {
            Segment::Move(p) | Segment::Line(p) => Some(p),
            Segment::Quadratic(_, p) | Segment::Cubic(_, _, p) => Some(p),
            Segment::Close => None,
        }
    }
}

impl Rect {
    /// Width and height.
    pub fn size(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.max[axis] - self.min[axis])
    }

    /// Whether a straight line from `a` to `b` crosses it, including its edges (Liang and Barsky 1984).
    pub(crate) fn is_crossed(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        let (mut from, mut to) = (0f64, 1f64);
        for i in 0..2 {
            let d = b[i] - a[i];
            if d == 0.0 {
                if a[i] < self.min[i] || a[i] > self.max[i] {
                    return false;
                }
                continue;
            }
            let (near, far) = ((self.min[i] - a[i]) / d, (self.max[i] - a[i]) / d);
            from = from.max(near.min(far));
            to = to.min(near.max(far));
        }
        from <= to
    }

    /// The bounding box of points; `None` for no points.
    pub fn around(points: impl IntoIterator<Item = [f64; 2]>) -> Option<Rect> {
        let mut points = points.into_iter();
        let first = points.next()?;
        let whole = Rect {
            min: first,
            max: first,
        };
        Some(points.fold(whole, |rect, p| Rect {
            min: [0, 1].map(|axis| rect.min[axis].min(p[axis])),
            max: [0, 1].map(|axis| rect.max[axis].max(p[axis])),
        }))
    }
}

/// The bounding box of a path, which may be smaller than that of its control points; `None` for an empty path.
pub fn bounds(segments: &[Segment]) -> Option<Rect> {
    let mut points = Vec::with_capacity(segments.len());
    let mut from = [0.0; 2];
    for segment in segments {
        match *segment {
            // A parabola turns once in each coordinate, so that the cubic's formula serves.
            Segment::Quadratic(a, p) => {
                let third = |q: [f64; 2]| [0, 1].map(|i| q[i] + 2.0 / 3.0 * (a[i] - q[i]));
                extremes([from, third(from), third(p), p], &mut points);
            }
            Segment::Cubic(a, b, p) => extremes([from, a, b, p], &mut points),
            Segment::Move(_) | Segment::Line(_) | Segment::Close => {}
        }
        if let Some(end) = segment.end() {
            points.push(end);
            from = end;
        }
    }
    Rect::around(points)
}

/// Adds the points of a cubic Bézier curve where a coordinate has an extremum.
///
/// With B′(t)/3 = a t² + b t + c: a = p₃ − 3p₂ + 3p₁ − p₀, b = 2(p₂ − 2p₁ + p₀), c = p₁ − p₀.
fn extremes(p: [[f64; 2]; 4], points: &mut Vec<[f64; 2]>) {
    for axis in 0..2 {
        let [p0, p1, p2, p3] = p.map(|point| point[axis]);
        let (a, b, c) = (
            p3 - 3.0 * p2 + 3.0 * p1 - p0,
            2.0 * (p2 - 2.0 * p1 + p0),
            p1 - p0,
        );
        // The roots as q/a and c/q, neither of which cancels.
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
        let q = -0.5 * (b + root.copysign(b));
        for t in [q / a, c / q] {
            if t > 0.0 && t < 1.0 {
                points.push(cubic(p, t));
            }
        }
    }
}

/// The point of a cubic Bézier curve at `t`.
fn cubic(p: [[f64; 2]; 4], t: f64) -> [f64; 2] {
    let s = 1.0 - t;
    let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
    [0, 1].map(|axis| (0..4).map(|i| weights[i] * p[i][axis]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_those_of_the_curve_and_not_of_its_control_points() {
        // The arch over (0, 0) and (4, 0) with controls 3 above is 3·3/4 high.
        let arch = [
            Segment::Move([0.0, 0.0]),
            Segment::Cubic([0.0, -3.0], [4.0, -3.0], [4.0, 0.0]),
        ];
        let rect = bounds(&arch).unwrap();
        assert_eq!((rect.min, rect.max), ([0.0, -2.25], [4.0, 0.0]));
        assert_eq!(rect.size(), [4.0, 2.25]);
    }

    #[test]
    fn a_parabola_has_its_vertex_at_half_its_control_point() {
        let arch = [
            Segment::Move([0.0, 0.0]),
            Segment::Quadratic([1.0, 2.0], [2.0, 0.0]),
        ];
        let rect = bounds(&arch).unwrap();
        assert!((rect.max[1] - 1.0).abs() < 1e-15, "{rect:?}");
    }

    #[test]
    fn an_empty_path_has_no_bounds() {
        assert_eq!(bounds(&[Segment::Close]), None);
    }
}
