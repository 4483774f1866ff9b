//! Outlines of objects, traced to fractions of a pixel.
//!
//! Between two neighbouring pixel centres that show different objects there is an edge. Rays between them bisect the interval
//! [`HALVINGS`] times, so that the point where the first object ends is known to 2⁻¹³ of a pixel:
//!
//! ```text
//! low shows the object of the first centre, high does not;   middle = (low + high)/2 takes the place of the one or the other.
//! ```
//!
//! The outline connects these points by marching squares: in a square of four pixel centres a straight piece joins two of them, and if
//! two objects meet in a checkerboard pattern, a ray through the middle of the square decides which are joined. A piece is the chord of
//! the edge in its square: straight edges have their own slope everywhere, and an edge of radius r deviates from it by at most 1/(4r)
//! pixels. If the edge turns within a square, the straight parts before and after it are extended until they meet, and rays on both sides
//! of that point decide whether a corner is there. Anything that no pixel centre shows has no outline.
//!
//! Where two objects meet, the lines of both are the same: the line belongs to the object with fewer pixels, usually the one in front.

use std::collections::{BTreeMap, BTreeSet};

use super::Polyline;
use crate::error::Result;
use crate::figures::isochrones::chain::polylines;
use crate::figures::isochrones::contour::{Crossing, Piece};

/// The number of bisections between two pixel centres.
const HALVINGS: u32 = 12;

/// Corners turn by more than this, radians: an edge of a radius of 4 pixels turns by less in a square.
const TURN: f64 = 0.26;
/// The largest distance of a corner from the piece that cuts it off, pixels: the tip of one of 45 degrees over a side of a square.
const FARTHEST: f64 = 1.3;
/// Rays pass a corner at this distance, pixels: prolonged arcs of a radius of 4 pixels meet farther outside of them.
const BESIDE: f64 = 0.01;
/// Pieces that cut off less than this are left as they are, pixels.
const NEAREST: f64 = 0.05;
/// Extended parts are longer than this, pixels, so that the direction is known to 2⁻¹¹.
const STRAIGHT: f64 = 0.3;

/// The outline of the visible part of an object.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Outline {
    /// Its index in the scene.
    pub object: usize,
    /// In pixels of the film; closed if the first point is the last.
    pub lines: Vec<Polyline>,
}

/// A box of pixels, the last ones included.
#[derive(Debug, Clone, Copy)]
struct Area {
    object: usize,
    count: usize,
    min: [usize; 2],
    max: [usize; 2],
}

/// The outlines of all objects of a picture of this size, from the identity at the centre of each pixel (−1 for none; row 0 at the top);
/// `look` returns the identities at any points of the film, pixels. Ordered by object; objects without lines are left out.
///
/// # Errors
/// Those of `look`.
pub fn outlines(
    [width, height]: [u32; 2],
    objects: &[f64],
    mut look: impl FnMut(&[[f64; 2]]) -> Result<Vec<f64>>,
) -> Result<Vec<Outline>> {
    let size = [width, height].map(|side| side as usize);
    if objects.len() != size[0] * size[1] {
        return Ok(Vec::new());
    }
    let edges = Edges::find(size, objects, &mut look)?;
    let mut areas = areas(size, objects);
    // Small objects first: an edge is drawn once, as that of the smaller of the two.
    areas.sort_by_key(|area| (area.count, area.object));
    let mut taken = BTreeSet::new();
    let traced = areas.iter().map(|area| Outline {
        object: area.object,
        lines: edges.trace(area, objects, &mut taken),
    });
    let mut outlines: Vec<Outline> = traced.filter(|o| !o.lines.is_empty()).collect();
    outlines.sort_by_key(|outline| outline.object);
    add_corners(&mut outlines, &mut look)?;
    Ok(outlines)
}

/// A corner that a piece of a line may have cut off.
struct Corner {
    outline: usize,
    line: usize,
    /// The index of the line's point that follows it.
    before: usize,
    at: [f64; 2],
    /// Places on the inner and on the outer side of it.
    beside: [[f64; 2]; 2],
}

/// Inserts the corners in place of the pieces that cut them off.
fn add_corners(
    outlines: &mut [Outline],
    look: &mut impl FnMut(&[[f64; 2]]) -> Result<Vec<f64>>,
) -> Result<()> {
    let mut corners = Vec::new();
    for (outline, of) in outlines.iter().enumerate() {
        for (line, points) in of.lines.iter().enumerate() {
            corners.extend(corners_of(points).map(|(before, at, beside)| Corner {
                outline,
                line,
                before,
                at,
                beside,
            }));
        }
    }
    let places: Vec<_> = corners.iter().flat_map(|corner| corner.beside).collect();
    let seen = look(&places)?;
    // Backwards, so that earlier indices stay valid.
    for (corner, seen) in corners.iter().zip(seen.chunks_exact(2)).rev() {
        let outline = &mut outlines[corner.outline];
        let shows = |seen: f64| seen == outline.object as f64;
        if shows(seen[0]) != shows(seen[1]) {
            outline.lines[corner.line].insert(corner.before, corner.at);
        }
    }
    Ok(())
}

/// The positions where the parts of a line before and after each of its pieces would meet in a corner: the index of the following point,
/// the position, and positions beside it, on the piece's side and beyond.
fn corners_of(points: &[[f64; 2]]) -> impl Iterator<Item = (usize, [f64; 2], [[f64; 2]; 2])> {
    let is_closed = points.len() > 3 && points.first() == points.last();
    // Of a closed line the last point is the first again.
    let count = if is_closed {
        points.len() - 1
    } else {
        points.len()
    };
    let point = move |k: isize| match is_closed {
        true => Some(points[k.rem_euclid(count as isize) as usize]),
        false => usize::try_from(k).ok().and_then(|k| points.get(k).copied()),
    };
    let pieces = if is_closed {
        count
    } else {
        count.saturating_sub(1)
    };
    (0..pieces).filter_map(move |k| {
        let (first, second) = (k as isize, k as isize + 1);
        let (a, b) = (point(first)?, point(second)?);
        let before = direction(a, [1, 2, 3].map(|n| point(first - n)))?;
        let after = direction(b, [1, 2, 3].map(|n| point(second + n)))?;
        // Both point to the corner: a + s before = b + t after.
        let turn = before[0] * after[1] - before[1] * after[0];
        let along = -(before[0] * after[0] + before[1] * after[1]);
        if libm::atan2(turn.abs(), along) < TURN {
            return None;
        }
        let way = [b[0] - a[0], b[1] - a[1]];
        let s = (way[0] * after[1] - way[1] * after[0]) / turn;
        let t = (way[0] * before[1] - way[1] * before[0]) / turn;
        let at = [a[0] + s * before[0], a[1] + s * before[1]];
        let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let out = [at[0] - middle[0], at[1] - middle[1]];
        let far = libm::hypot(out[0], out[1]);
        if !(s > 0.0 && t > 0.0 && far > NEAREST && far < FARTHEST) {
            return None;
        }
        let beside = |way: f64| [0, 1].map(|i| at[i] + way / far * out[i]);
        Some((k + 1, at, [beside(-BESIDE), beside(BESIDE)]))
    })
}

/// The unit vector to `end` from the first of `others` that is far enough from it.
fn direction(end: [f64; 2], others: [Option<[f64; 2]>; 3]) -> Option<[f64; 2]> {
    others.into_iter().flatten().find_map(|other| {
        let way = [end[0] - other[0], end[1] - other[1]];
        let length = libm::hypot(way[0], way[1]);
        (length > STRAIGHT).then(|| way.map(|x| x / length))
    })
}

/// Where each object is seen.
fn areas([width, _]: [usize; 2], objects: &[f64]) -> Vec<Area> {
    let mut areas: BTreeMap<usize, Area> = BTreeMap::new();
    for (i, &object) in objects.iter().enumerate().filter(|(_, id)| **id >= 0.0) {
        let (at, object) = ([i % width, i / width], object as usize);
        let area = areas.entry(object).or_insert(Area {
            object,
            count: 0,
            min: at,
            max: at,
        });
        area.count += 1;
        area.min = [0, 1].map(|axis| area.min[axis].min(at[axis]));
        area.max = [0, 1].map(|axis| area.max[axis].max(at[axis]));
    }
    areas.into_values().collect()
}

/// The edges where the visible object changes between pixels.
struct Edges {
    size: [usize; 2],
    /// Where, by the number of a pair of neighbouring pixels.
    points: BTreeMap<usize, [f64; 2]>,
    /// The identity in the middle of four pixels in a checkerboard pattern, by the first of them.
    middles: BTreeMap<usize, f64>,
}

/// Two neighbouring pixels with different objects.
struct Change {
    /// The number of the pair.
    edge: usize,
    /// The centre of the first.
    from: [f64; 2],
    /// Whether the other is below it; otherwise it is to the right.
    down: bool,
    /// The identity at the first one.
    object: f64,
    /// The fractions of the way up to which that is known to be visible, and from which something else is.
    between: [f64; 2],
}

impl Change {
    fn at(&self, part: f64) -> [f64; 2] {
        let [x, y] = self.from;
        match self.down {
            true => [x, y + part],
            false => [x + part, y],
        }
    }

    fn middle(&self) -> [f64; 2] {
        self.at(0.5 * (self.between[0] + self.between[1]))
    }
}

impl Edges {
    fn find(
        size: [usize; 2],
        objects: &[f64],
        look: &mut impl FnMut(&[[f64; 2]]) -> Result<Vec<f64>>,
    ) -> Result<Edges> {
        let mut changes = changes(size, objects);
        for _ in 0..HALVINGS {
            let middles: Vec<_> = changes.iter().map(Change::middle).collect();
            let seen = look(&middles)?;
            for (change, seen) in changes.iter_mut().zip(seen) {
                // The half in which the object changes.
                let middle = 0.5 * (change.between[0] + change.between[1]);
                change.between[usize::from(seen != change.object)] = middle;
            }
        }
        let crossed = chessboards(size, objects);
        let seen = look(&crossed.iter().map(|(_, at)| *at).collect::<Vec<_>>())?;
        Ok(Edges {
            size,
            points: changes.iter().map(|c| (c.edge, c.middle())).collect(),
            middles: crossed.iter().map(|(first, _)| *first).zip(seen).collect(),
        })
    }

    /// The lines of one object, without those that others have `taken`.
    fn trace(&self, area: &Area, objects: &[f64], taken: &mut BTreeSet<usize>) -> Vec<Polyline> {
        // Squares lie between pixel centres: one more to the left and above.
        let min = area.min.map(|side| side.saturating_sub(1));
        let last = [0, 1].map(|axis| area.max[axis].min(self.size[axis].saturating_sub(2)));
        let object = area.object as f64;
        let rows = min[1]..=last[1];
        let squares = rows.flat_map(|y| (min[0]..=last[0]).map(move |x| [x, y]));
        let mut found: Vec<Piece> = squares
            .flat_map(|square| self.pieces(square, object, objects))
            .collect();
        let edges = |piece: &Piece| piece.ends.map(|end| end.edge);
        found.retain(|piece| !edges(piece).iter().all(|edge| taken.contains(edge)));
        taken.extend(found.iter().flat_map(edges));
        let lines = polylines(&found).into_iter();
        lines.map(|line| line.points).collect()
    }

    /// The pieces of an object's line in the square of four pixel centres with `[x, y]` at the upper left.
    fn pieces(&self, [x, y]: [usize; 2], object: f64, objects: &[f64]) -> Vec<Piece> {
        let width = self.size[0];
        let first = y * width + x;
        let corners = [first, first + 1, first + width + 1, first + width];
        let Some(inside) = corners
            .map(|i| objects.get(i).map(|seen| *seen == object))
            .into_iter()
            .collect::<Option<Vec<bool>>>()
        else {
            return Vec::new();
        };
        // Top, right, bottom, left; pairs of pixels are numbered by their first one.
        let edges = [
            // As `changes` numbers them: 2i to the right of pixel i, 2i + 1 below it.
            2 * first,
            2 * (first + 1) + 1,
            2 * (first + width),
            2 * first + 1,
        ];
        let crossing = |side: usize| {
            let crosses = inside[side] != inside[(side + 1) % 4];
            let at = self.points.get(&edges[side]).filter(|_| crosses)?;
            let edge = edges[side];
            Some(Crossing { edge, at: *at })
        };
        let crossings: Vec<Crossing> = (0..4).filter_map(crossing).collect();
        let piece = |a: Crossing, b: Crossing| Piece {
            ends: [a, b],
            density: 0.0,
        };
        match crossings[..] {
            [a, b] => vec![piece(a, b)],
            // If the middle is like the upper left corner, the lines cut off the other two.
            [top, right, bottom, left] => {
                let middle = self.middles.get(&first).is_some_and(|seen| *seen == object);
                match middle == inside[0] {
                    true => vec![piece(top, right), piece(bottom, left)],
                    false => vec![piece(left, top), piece(right, bottom)],
                }
            }
            _ => Vec::new(),
        }
    }
}

/// All pairs of adjacent pixels that show different objects.
fn changes([width, height]: [usize; 2], objects: &[f64]) -> Vec<Change> {
    let mut changes = Vec::new();
    for (i, &object) in objects.iter().enumerate() {
        let [x, y] = [i % width, i / width];
        let pairs = [(x + 1 < width, i + 1), (y + 1 < height, i + width)];
        for (k, (is_there, other)) in pairs.into_iter().enumerate() {
            if is_there && objects[other] != object {
                changes.push(Change {
                    edge: 2 * i + k,
                    from: [x as f64 + 0.5, y as f64 + 0.5],
                    down: k == 1,
                    object,
                    between: [0.0, 1.0],
                });
            }
        }
    }
    changes
}

/// The squares of four pixels with an object at two opposite corners and not at the other two: the first pixel and the middle of each.
fn chessboards([width, height]: [usize; 2], objects: &[f64]) -> Vec<(usize, [f64; 2])> {
    let mut found = Vec::new();
    for y in 1..height {
        for x in 1..width {
            let first = (y - 1) * width + x - 1;
            let [a, b, c, d] =
                [first, first + 1, first + width + 1, first + width].map(|pixel| objects[pixel]);
            if (a == c || b == d) && a != b && b != c && c != d && d != a {
                found.push((first, [x as f64, y as f64]));
            }
        }
    }
    found
}
