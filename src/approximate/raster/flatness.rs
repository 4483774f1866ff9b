//! The flatness test of adaptive tessellation: the error of a straight edge on the film.
//!
//! With Δ and δ of [`projection`](crate::approximate::projection), an edge needs n = ⌈√(E/ε)⌉ parts, or 2 if that is above 3 and E is
//! unreliable, for an error of at most ε, with
//!
//! ```text
//! E = 4/3 · max |Δ/δ| · |c_A × c_B|² / (8 |c|³_min),
//! ```
//!
//! where |c|_min is that of the edge's nearest point and |Δ/δ| that of the end where a metre covers more pixels. |c| is convex, and its
//! second derivative is largest at the nearest point, so this bounds δ everywhere on the edge. Within a triangle whose edges are all at
//! most L, δ is at most 4/3 of its bound on an edge (Jung: it lies in a circle of radius L/√3). Ends outside the film, or behind the
//! camera, are treated as in its corner, where a radian covers the most pixels.

//!
//! *By vertices.* With A the end where a metre covers more pixels, L at least as long as the edges that end there and |c|_min ≥ |c_A| −
//! L, and since |c_A × c_B| is at most the edge's length times the |c| of either end or of the nearest point between them,
//!
//! ```text
//! E ≤ 4/3 · |Δ/δ|_A L² |c_A|/(8 (|c_A| − L)²):
//! ```
//!
//! If that is at most ε at all three corners of a triangle, as for almost all small ones, none of its edges is cut.

use glam::DVec3;

use crate::accel::vectors::VectorLoop;

/// The number of triangles whose edges are examined together.
pub(super) const LOT: usize = 64;

/// Which edges are certainly straight enough, judged from one end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Straight {
    /// ε · 8 · 3/4, minus a margin above rounding: a few eps in total. Infinite if no edge is ever cut, NaN if cuts do not depend on
    /// flatness.
    most: f64,
}

impl Straight {
    /// All edges are straight enough.
    pub const ALWAYS: Straight = Straight {
        most: f64::INFINITY,
    };
    /// No edge is.
    pub const NEVER: Straight = Straight { most: f64::NAN };

    /// Edges with an error of at most this many pixels.
    pub fn within(pixels: f64) -> Self {
        Straight {
            most: (1.0 - 1e-9) * 6.0 * pixels,
        }
    }

    /// Whether all edges that end in a point with this |c| and |c| |Δ/δ| are straight enough, if they have at most this length, and no
    /// larger |c| |Δ/δ| at their other ends; false for NaN.
    #[inline(always)]
    pub fn around(self, length: f64, longest: f64, scale: f64) -> bool {
        let near = length - longest;
        let is_straight = (near > 0.0) & (scale * (longest * longest) <= self.most * (near * near));
        is_straight | (self.most == f64::INFINITY)
    }
}

/// The edges of a lot of triangles.
pub(super) struct Edges {
    /// By corner and coordinate, the places c.
    pub c: [[[f64; LOT]; 3]; 3],
    /// By corner, |c| |Δ/δ|.
    pub scale: [[f64; LOT]; 3],
    /// The total number of parts that the edges opposite to each corner need, and the number into which they are cut now.
    pub needed: [[f64; LOT]; 3],
    pub parts: [[f64; LOT]; 3],
}

impl Edges {
    pub const EMPTY: Edges = Edges {
        c: [[[0.0; LOT]; 3]; 3],
        scale: [[0.0; LOT]; 3],
        needed: [[0.0; LOT]; 3],
        parts: [[0.0; LOT]; 3],
    };
}

/// The loop over edges for a bound on errors in pixels.
pub(super) struct Bend<'a> {
    pub edges: &'a mut Edges,
    pub pixels: f64,
}

impl VectorLoop for Bend<'_> {
    #[inline(always)]
    fn run(self) {
        let Edges {
            c,
            scale,
            needed,
            parts,
        } = self.edges;
        let mut any = 0;
        for (edge, squares) in needed.iter_mut().enumerate() {
            // The ends of the edge opposite to this corner.
            let (from, to) = ((edge + 1) % 3, (edge + 2) % 3);
            for at in 0..LOT {
                let a = DVec3::new(c[from][0][at], c[from][1][at], c[from][2][at]);
                let b = DVec3::new(c[to][0][at], c[to][1][at], c[to][2][at]);
                let error = bend(a, b, scale[from][at].max(scale[to][at]));
                squares[at] = error / self.pixels;
                any |= u64::from(squares[at] > 1.0);
            }
        }
        // Most edges are straight enough, and for them n² is as good as n.
        if any == 0 {
            return parts.fill([1.0; LOT]);
        }
        for (needed, parts) in needed.iter_mut().zip(parts) {
            for (needed, parts) in needed.iter_mut().zip(parts) {
                // n of the head: above 3 the bound is only good enough to halve the edge.
                let root = needed.sqrt();
                let count = root.ceil();
                *needed = root;
                *parts = if count > 3.0 { 2.0 } else { count };
            }
        }
    }
}

/// A bound on the displacement of points of an edge, pixels. It is the same from either end.
#[inline(always)]
fn bend(a: DVec3, b: DVec3, scale: f64) -> f64 {
    let e = b - a;
    let cross = a.cross(b).length_squared();
    let between = (a.dot(e) < 0.0) & (b.dot(e) > 0.0);
    let nearest = if between {
        cross / e.length_squared()
    } else {
        a.length_squared().min(b.length_squared())
    };
    // E of the module's head: 4/3 (Jung) · |Δ/δ| · |c_A × c_B|² / (8 |c|³), with |c|² of the nearest point
    // squared, as one |c| belongs to the scale.
    4.0 / 3.0 / 8.0 * scale * cross / (nearest * nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::numbers;

    /// Triangles in front of and beside the camera, whose edges bend by around a tenth of a pixel.
    #[test]
    fn edges_between_ends_that_say_so_are_straight_enough() {
        let mut random = numbers(1);
        let mut counts = [0; 2];
        for _ in 0..20_000 {
            let size = 0.5 * (1.0 + random());
            let place = DVec3::new(random(), random(), random());
            let corners = [(); 3].map(|()| {
                let c = place + size * DVec3::new(random(), random(), random());
                (c, 1.5 + random())
            });
            let edges = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b]));
            let longest = edges.map(|((a, _), (b, _))| a.distance(b));
            let longest = longest.into_iter().fold(0.0, f64::max);
            let errors = edges.map(|((a, s), (b, t))| bend(a, b, f64::max(s, t)));
            let most = errors.into_iter().fold(0.0, f64::max);
            for pixels in [0.5, 1.0 - 1e-6, 1.0, 2.0, 10.0].map(|factor| factor * most) {
                let straight = Straight::within(pixels);
                let is_taken = corners
                    .iter()
                    .all(|(c, s)| straight.around(c.length(), longest, *s));
                assert!(!is_taken || most <= pixels, "{corners:?} {pixels}");
                counts[usize::from(is_taken)] += 1;
            }
        }
        assert!(counts[0] > 40_000 && counts[1] > 4_000, "{counts:?}");
    }

    #[test]
    fn nothing_is_known_of_what_is_no_number_and_none_is_cut_where_none_is_asked_for() {
        let straight = Straight::within(1.0);
        assert!(straight.around(2.0, 0.1, 1.0) && Straight::ALWAYS.around(0.0, 1.0, 1.0));
        assert!(!Straight::NEVER.around(2.0, 0.1, 1.0) && !straight.around(0.1, 0.2, 1.0));
        for [length, scale] in [[f64::NAN, 1.0], [2.0, f64::NAN], [2.0, f64::INFINITY]] {
            assert!(!straight.around(length, 0.1, scale));
        }
    }
}
