//! Square cells on the faces of a cube around the observer, and the discs of the sky in them.
//!
//! A direction d goes through the face of its largest coordinate, at u and v, the other two divided by that one, from −1 to 1. On that
//! face, everything within an angle R of d lies between the planes through the v axis that touch the cap around d: they are rotated from
//! that of d by ±δ, with
//!
//! ```text
//! sin δ = sin R / √(1 − d_v²) = sin R √((1 + u² + v²)/(1 + u²)) ≤ sin R √(1 + v²),
//! ```
//!
//! so u ranges from tan(atan u − δ) to tan(atan u + δ), and v likewise.

use glam::DVec3;

/// The cosine of the angle between the axis of a face and its corners, 1/√3.
const CORNER: f64 = 0.577_350_269;
/// Margin of rectangles: 10⁷ times the rounding error, 2⁻⁵³ per step, of the few steps from a direction to its position, from −1 to 1.
const ROUNDING: f64 = 1e-9;

/// The outward axis of a face of the cube, and its sides.
pub(super) fn axes(face: usize) -> (DVec3, DVec3, DVec3) {
    let sign = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    match face / 2 {
        0 => (DVec3::X * sign, DVec3::Y, DVec3::Z),
        1 => (DVec3::Y * sign, DVec3::Z, DVec3::X),
        _ => (DVec3::Z * sign, DVec3::X, DVec3::Y),
    }
}

/// The face of the cube that `d` goes through, and the position there, from −1 to 1 along its sides.
#[inline]
pub(super) fn on_cube(d: DVec3) -> (usize, [f64; 2]) {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        (usize::from(d.x < 0.0), [d.y / a.x, d.z / a.x])
    } else if a.y >= a.z {
        (2 + usize::from(d.y < 0.0), [d.z / a.y, d.x / a.y])
    } else {
        (4 + usize::from(d.z < 0.0), [d.x / a.z, d.y / a.z])
    }
}

/// A rectangle of a face that contains some directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rectangle {
    face: usize,
    /// The smallest and largest position along each side.
    sides: [[f64; 2]; 2],
}

impl Rectangle {
    /// The rectangle of all directions with coordinates from `low` to `high`; `None` if they may go through more than one face.
    #[inline]
    pub fn of(low: [f64; 3], high: [f64; 3]) -> Option<Rectangle> {
        // The smallest and largest absolute value of each coordinate.
        let far: [f64; 3] = std::array::from_fn(|k| high[k].max(-low[k]));
        let near: [f64; 3] = std::array::from_fn(|k| low[k].max(-high[k]));
        let is_longest =
            |k: usize| near[k] > 0.0 && near[k] >= far[(k + 1) % 3] && near[k] >= far[(k + 2) % 3];
        let axis = (0..3).find(|k| is_longest(*k))?;
        let (near, far) = (near[axis], far[axis]);
        // A quotient below 0 is least over the smallest depth, one above 0 over the largest; greatest, the other way round.
        let side = |k: usize| {
            let (low, high) = (low[k % 3], high[k % 3]);
            [
                low / if low < 0.0 { near } else { far },
                high / if high > 0.0 { near } else { far },
            ]
        };
        Some(Rectangle {
            face: 2 * axis + usize::from(low[axis] < 0.0),
            sides: [side(axis + 1), side(axis + 2)],
        })
    }

    /// The rectangle of everything within an angle of this `sine`, at most 35°, of the directions, as derived at the head of this file.
    #[inline]
    pub fn widened(self, sine: f64) -> Rectangle {
        let [u, v] = self.sides;
        let wider = |[low, high]: [f64; 2], [first, last]: [f64; 2]| {
            let across = last.max(-first);
            let square = sine * sine * (1.0 + across * across);
            let tangent = (square / (1.0 - square)).sqrt();
            // tan(atan x + δ); infinite beyond a right angle.
            let moved = |x: f64| match 1.0 - x * tangent {
                rest if rest > 0.0 => (x + tangent) / rest + ROUNDING,
                _ => f64::INFINITY,
            };
            [-moved(-low), moved(high)]
        };
        Rectangle {
            sides: [wider(u, v), wider(v, u)],
            ..self
        }
    }
}

/// Cells on all faces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// Number of cells along an edge of a face.
    pub cells: usize,
}

impl Grid {
    /// The cell along an edge that contains a position, or the first or last cell for positions outside.
    #[inline]
    fn along(self, x: f64) -> usize {
        // The conversion saturates negative numbers to 0.
        ((0.5 * (x + 1.0) * self.cells as f64) as usize).min(self.cells - 1)
    }

    /// The index of a cell.
    fn number(self, face: usize, [u, v]: [f64; 2]) -> usize {
        (face * self.cells + self.along(v)) * self.cells + self.along(u)
    }

    /// The index of the cell that contains a direction.
    pub fn cell(self, d: DVec3) -> usize {
        let (face, place) = on_cube(d);
        self.number(face, place)
    }

    /// Calls `each` with one cell of each face that a disc around `d` touches: that of its centre, or the one nearest to it. The radius of
    /// the disc has this sine, and is at most 35°.
    fn each_face(self, d: DVec3, sine: f64, mut each: impl FnMut(usize)) {
        let cosine = (1.0 - sine * sine).sqrt();
        // The cosine of the sum of the angle from a face's axis to its corners and the radius.
        let (corner, across) = (CORNER, (1.0 - CORNER * CORNER).sqrt());
        let least = corner * cosine - across * sine - ROUNDING;
        for face in 0..6 {
            let (axis, u, v) = axes(face);
            let depth = d.dot(axis);
            if depth < least {
                continue;
            }
            // Whether part of the face lies between the planes through the other side that touch the disc. There are no such planes if the
            // disc contains the other side.
            let reaches = |side: DVec3| {
                let along = d.dot(side);
                let rest = (depth * depth + along * along - sine * sine)
                    .max(0.0)
                    .sqrt();
                let (low, high) = (depth * rest + along * sine, depth * rest - along * sine);
                let tangent = |x: f64, depth: f64, beyond: f64| match depth > 0.0 {
                    true => x / depth,
                    false => beyond,
                };
                let first = tangent(along * rest - depth * sine, low, -2.0) - ROUNDING;
                let last = tangent(along * rest + depth * sine, high, 2.0) + ROUNDING;
                first <= 1.0 && last >= -1.0
            };
            if reaches(u) && reaches(v) {
                each(self.number(face, [d.dot(u) / depth, d.dot(v) / depth]));
            }
        }
    }
}

/// What is known of discs, by the cells of their centres, on each face that they touch.
#[derive(Debug)]
pub(super) struct Index<T> {
    grid: Grid,
    /// Where each cell begins in the list, and the discs, cell by cell and row by row.
    begins: Vec<u32>,
    list: Vec<T>,
}

impl<T: Copy> Index<T> {
    /// The index of discs around directions, with radii of these sines.
    pub fn new(grid: Grid, discs: impl Iterator<Item = (T, DVec3, f64)> + Clone) -> Index<T> {
        // Where cells begin, from counts; filled disc by disc, so that each cell lists them in order.
        let mut begins = vec![0; 6 * grid.cells * grid.cells + 1];
        for (_, d, sine) in discs.clone() {
            grid.each_face(d, sine, |cell| begins[cell] += 1);
        }
        let mut sum = 0;
        for begin in &mut begins {
            let count = *begin;
            *begin = sum;
            sum += count;
        }
        let mut ends = begins.clone();
        let any = discs.clone().next().map(|(disc, _, _)| disc);
        let mut list = any.map_or(Vec::new(), |any| vec![any; sum as usize]);
        for (disc, d, sine) in discs {
            grid.each_face(d, sine, |cell| {
                list[ends[cell] as usize] = disc;
                ends[cell] += 1;
            });
        }
        Index { grid, begins, list }
    }

    /// Its bytes.
    #[cfg(test)]
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.begins.as_slice()) + size_of_val(self.list.as_slice())) as u64
    }

    /// All discs with centres in the cells of a rectangle, row by row; `None` if there are more than `most` cells. The order
    /// of those near a direction is the same for any rectangle.
    #[inline]
    pub fn rows(&self, near: Rectangle, most: usize) -> Option<impl Iterator<Item = &[T]>> {
        let [[left, right], [top, bottom]] =
            near.sides.map(|side| side.map(|x| self.grid.along(x)));
        if (right - left + 1) * (bottom - top + 1) > most {
            return None;
        }
        Some((top..=bottom).map(move |row| {
            let row = (near.face * self.grid.cells + row) * self.grid.cells;
            &self.list[self.begins[row + left] as usize..self.begins[row + right + 1] as usize]
        }))
    }
}

#[cfg(test)]
mod tests;
