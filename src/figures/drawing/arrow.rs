//! Arrowheads: filled paths whose tips are exactly at the beginning or the end of the path.
//!
//! The back of a head is on the path, so that heads follow curves. The shaft ends inside the head, where the head is wider than the
//! shaft, so that no seam shows between them and the shaft does not protrude beside the tip.

use super::{Arrow, Cap, Path, Stroke};
use crate::text::Segment;

/// Depth of the notch in the back of a head, relative to its length.
const NOTCH: f64 = 0.25;

/// A piece of an open contour.
#[derive(Clone, Copy)]
struct Piece {
    from: [f64; 2],
    /// Anything but [`Segment::Move`] and [`Segment::Close`].
    segment: Segment,
    to: [f64; 2],
}

/// The shaft of a stroke along `path`, and its heads. A path with heads has one contour, and that open.
pub(super) fn with_heads(path: &Path, stroke: &Stroke) -> (Path, Vec<Path>) {
    if stroke.start.is_none() && stroke.end.is_none() {
        return (path.clone(), Vec::new());
    }
    let forth = pieces(&path.0);
    let back = reversed(&forth);
    let mut heads = Vec::with_capacity(2);
    let mut shaft = forth.clone();
    if let Some(arrow) = stroke.end {
        heads.extend(head(&forth, arrow));
        shaft = without_end(&shaft, covered(arrow, stroke));
    }
    if let Some(arrow) = stroke.start {
        heads.extend(head(&back, arrow));
        shaft = reversed(&without_end(&reversed(&shaft), covered(arrow, stroke)));
    }
    (Path(contour_of(&shaft)), heads)
}

/// The distance from the tip where the shaft ends.
fn covered(arrow: Arrow, stroke: &Stroke) -> f64 {
    let notch = (1.0 - NOTCH) * arrow.length;
    // Where the head is as wide as the shaft; or the notch, for heads hardly wider than their shafts.
    let narrow = (arrow.length * stroke.width / arrow.width).min(notch);
    let cap = match stroke.cap {
        Cap::Butt => 0.0,
        Cap::Round | Cap::Square => stroke.width / 2.0,
    };
    // Half way between the two, so that the end of the shaft does not show.
    (narrow + notch) / 2.0 + cap
}

/// The head at the end of `contour`, along the chord from its notch to its tip; `None` for a contour without length.
fn head(contour: &[Piece], arrow: Arrow) -> Option<Path> {
    let (first, tip) = (contour.first()?.from, contour.last()?.to);
    let before = without_end(contour, (1.0 - NOTCH) * arrow.length);
    let back = before.last().map_or(first, |piece| piece.to);
    let [x, y] = [tip[0] - back[0], tip[1] - back[1]];
    let distance = x.hypot(y);
    if distance == 0.0 {
        return None;
    }
    let (u, v) = (x / distance, y / distance);
    // In the arrow's own axes: behind the tip and beside it.
    let at = |behind: f64, beside: f64| {
        [
            tip[0] - behind * u - beside * v,
            tip[1] - behind * v + beside * u,
        ]
    };
    let (length, half) = (arrow.length, arrow.width / 2.0);
    Some(Path::polygon(&[
        tip,
        at(length, half),
        at((1.0 - NOTCH) * length, 0.0),
        at(length, -half),
    ]))
}

/// The contour up to the last point at `distance` from its end.
fn without_end(contour: &[Piece], distance: f64) -> Vec<Piece> {
    let Some(tip) = contour.last().map(|piece| piece.to) else {
        return Vec::new();
    };
    let far = |p: [f64; 2]| (p[0] - tip[0]).hypot(p[1] - tip[1]) >= distance;
    let mut kept = contour.to_vec();
    while let Some(piece) = kept.pop() {
        if let Some(t) = piece.last_parameter(far) {
            kept.push(piece.until(t));
            break;
        }
    }
    kept
}

impl Piece {
    /// The last parameter at which `far` holds; `None` if there is none.
    fn last_parameter(&self, far: impl Fn([f64; 2]) -> bool) -> Option<f64> {
        const STEPS: u32 = 32;
        let at = |i: u32| f64::from(i) / f64::from(STEPS);
        // Curves are not always monotone: the last of 32 steps, then bisection.
        let i = (0..=STEPS).rev().find(|&i| far(self.until(at(i)).to))?;
        let (mut low, mut high) = (at(i), at((i + 1).min(STEPS)));
        while high - low > f64::EPSILON {
            let middle = (low + high) / 2.0;
            if far(self.until(middle).to) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    }

    /// The piece from its start to parameter `t` (de Casteljau).
    fn until(&self, t: f64) -> Piece {
        let mix = |p: [f64; 2], q: [f64; 2]| [0, 1].map(|i| p[i] + t * (q[i] - p[i]));
        let (segment, to) = match self.segment {
            Segment::Quadratic(a, p) => {
                let (ab, bc) = (mix(self.from, a), mix(a, p));
                let to = mix(ab, bc);
                (Segment::Quadratic(ab, to), to)
            }
            Segment::Cubic(a, b, p) => {
                let (ab, bc, cd) = (mix(self.from, a), mix(a, b), mix(b, p));
                let (abc, bcd) = (mix(ab, bc), mix(bc, cd));
                let to = mix(abc, bcd);
                (Segment::Cubic(ab, abc, to), to)
            }
            Segment::Move(_) | Segment::Line(_) | Segment::Close => {
                let to = mix(self.from, self.to);
                (Segment::Line(to), to)
            }
        };
        Piece {
            from: self.from,
            segment,
            to,
        }
    }

    fn reversed(self) -> Piece {
        Piece {
            from: self.to,
            segment: match self.segment {
                Segment::Quadratic(a, _) => Segment::Quadratic(a, self.from),
                Segment::Cubic(a, b, _) => Segment::Cubic(b, a, self.from),
                Segment::Move(_) | Segment::Line(_) | Segment::Close => Segment::Line(self.from),
            },
            to: self.from,
        }
    }
}

fn reversed(contour: &[Piece]) -> Vec<Piece> {
    contour.iter().rev().map(|piece| piece.reversed()).collect()
}

fn pieces(contour: &[Segment]) -> Vec<Piece> {
    let from = contour.iter().filter_map(|s| s.end());
    let to = contour.iter().skip(1).filter_map(|s| Some((*s, s.end()?)));
    let pieces = from
        .zip(to)
        .map(|(from, (segment, to))| Piece { from, segment, to });
    pieces.collect()
}

fn contour_of(pieces: &[Piece]) -> Vec<Segment> {
    let start = pieces.first().map(|piece| Segment::Move(piece.from));
    start
        .into_iter()
        .chain(pieces.iter().map(|piece| piece.segment))
        .collect()
}
