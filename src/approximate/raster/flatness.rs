//! The flatness test of adaptive tessellation: how far a straight edge may be drawn from where its points are seen.
//!
//! With Δ and δ of [`projection`](crate::approximate::projection), an edge is to have n = ⌈√(E/ε)⌉ parts, or 2 where that is above 3 and E
//! not to be relied on, for an error of at most ε, with
//!
//! ```text
//! E = 4/3 · max |Δ/δ| · |c_A × c_B|² / (8 |c|³_min),
//! ```
//!
//! |c|_min being that of the edge's nearest point and |Δ/δ| that of the end where a metre is more. |c| is
//! convex, its second derivative largest at the nearest point, so that this bounds δ wherever on the edge.
//! Within a triangle whose edges are all at most L, δ is at most 4/3 of what it can be on an edge (Jung: it
//! lies in a circle of radius L/√3). Ends beside the film, or behind the camera, count as if they were in its
//! corner, where a radian has most pixels.

use glam::DVec3;

use super::cull::{Frustum, is_before};
use crate::accel::vectors::VectorLoop;

/// Number of triangles whose edges are looked at together.
pub(super) const LOT: usize = 64;

/// What becomes of a triangle of the first level.
pub(super) struct Kind;

impl Kind {
    /// It is outside of the film.
    pub const UNSEEN: u32 = 0;
    /// It is straight enough, and in front of the camera.
    pub const SEEN: u32 = 1;
    /// It is straight enough, and a part of it may be behind the camera.
    pub const BESIDE: u32 = 2;
    /// It may have to be cut.
    pub const BENT: u32 = 3;
}

/// Triangles of the first level.
pub(super) struct Whole {
    /// By corner: the places c, |c| |Δ/δ|, the film point and z.
    pub c: [[[f64; LOT]; 3]; 3],
    pub scale: [[f64; LOT]; 3],
    pub point: [[[f64; LOT]; 2]; 3],
    pub z: [[f64; LOT]; 3],
    /// What becomes of them, and the part of the film that those which are seen can reach.
    pub kinds: [u32; LOT],
    pub reach: [[f32; LOT]; 4],
}

impl Whole {
    pub const EMPTY: Whole = Whole {
        c: [[[0.0; LOT]; 3]; 3],
        scale: [[0.0; LOT]; 3],
        point: [[[0.0; LOT]; 2]; 3],
        z: [[0.0; LOT]; 3],
        kinds: [0; LOT],
        reach: [[0.0; LOT]; 4],
    };
}

/// The loop over triangles of the first level.
pub(super) struct Straight<'a> {
    pub lot: &'a mut Whole,
    pub pixels: f64,
    pub frustum: &'a Frustum,
}

impl VectorLoop for Straight<'_> {
    #[inline(always)]
    fn run(self) {
        let Whole {
            c,
            scale,
            point,
            z,
            kinds,
            reach,
        } = self.lot;
        let (pixels, frustum) = (self.pixels, self.frustum.edges());
        let mut is_bent = [0; LOT];
        for edge in 0..3 {
            let (from, to) = ((edge + 1) % 3, (edge + 2) % 3);
            for at in 0..LOT {
                let a = DVec3::new(c[from][0][at], c[from][1][at], c[from][2][at]);
                let b = DVec3::new(c[to][0][at], c[to][1][at], c[to][2][at]);
                let is_straight = is_straight(a, b, scale[from][at].max(scale[to][at]), pixels);
                is_bent[at] |= u32::from(!is_straight);
            }
        }
        let [left, top, right, bottom] = reach;
        for at in 0..LOT {
            let least = |axis: usize| {
                let [a, b, c] = [point[0][axis][at], point[1][axis][at], point[2][axis][at]];
                (a.min(b).min(c), a.max(b).max(c))
            };
            let ((x, to_x), (y, to_y)) = (least(0), least(1));
            let [a, b, c] = [z[0][at], z[1][at], z[2][at]];
            let is_beside = !is_before(a, b, c);
            let (is_seen, [l, t, r, b]) = frustum.reach([x, y, to_x, to_y]);
            (left[at], top[at], right[at], bottom[at]) = (l, t, r, b);
            let kind = if is_seen { Kind::SEEN } else { Kind::UNSEEN };
            let kind = if is_beside { Kind::BESIDE } else { kind };
            kinds[at] = if is_bent[at] != 0 { Kind::BENT } else { kind };
        }
    }
}

/// Whether [`bend`] is at most so many pixels by more than rounding, which is a few eps: its terms multiplied out. Not for NaN.
#[inline(always)]
fn is_straight(a: DVec3, b: DVec3, scale: f64, pixels: f64) -> bool {
    const SAFELY: f64 = 1.0 - 1e-12;
    let e = b - a;
    let cross = a.cross(b).length_squared();
    let between = (a.dot(e) < 0.0) & (b.dot(e) > 0.0);
    // |c|² of the nearest point is cross/|e|² between the ends.
    let (square, ends) = (
        e.length_squared(),
        a.length_squared().min(b.length_squared()),
    );
    let error = 4.0 / 3.0 / 8.0 * scale * if between { square * square } else { cross };
    let most = SAFELY * pixels * if between { cross } else { ends * ends };
    error <= most
}

/// The edges of a lot of triangles.
pub(super) struct Edges {
    /// By corner and coordinate, the places c.
    pub c: [[[f64; LOT]; 3]; 3],
    /// By corner, |c| |Δ/δ|.
    pub scale: [[f64; LOT]; 3],
    /// How many parts the edges opposite to each corner need in all, and into how many they are cut now.
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
            let (from, to) = ((edge + 1) % 3, (edge + 2) % 3);
            for at in 0..LOT {
                let a = DVec3::new(c[from][0][at], c[from][1][at], c[from][2][at]);
                let b = DVec3::new(c[to][0][at], c[to][1][at], c[to][2][at]);
                let error = bend(a, b, scale[from][at].max(scale[to][at]));
                squares[at] = error / self.pixels;
                any |= u64::from(squares[at] > 1.0);
            }
        }
        // Most edges are straight enough, and their n² is as good as n.
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

/// A bound on how far points of an edge are drawn from their places, pixels. It is the same from either end.
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

    /// Edges before and beside the camera whose bend is around a tenth of a pixel.
    #[test]
    fn edges_taken_for_straight_are_and_others_by_rounding_alone() {
        let mut state = 1u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut counts = [0; 2];
        for _ in 0..20_000 {
            let [a, b] = [(); 2].map(|()| DVec3::new(random(), random(), random()));
            let error = bend(a, b, 1.0);
            for factor in [
                0.5,
                1.0 - 1e-11,
                1.0 - 1e-14,
                1.0,
                1.0 + 1e-14,
                1.0 + 1e-11,
                2.0,
            ] {
                let pixels = factor * error;
                let is_taken = is_straight(a, b, 1.0, pixels);
                assert!(!is_taken || error / pixels <= 1.0, "{a} {b} {factor}");
                assert!(is_taken || factor < 1.0 + 1e-11, "{a} {b} {factor}");
                counts[usize::from(is_taken)] += 1;
            }
        }
        assert!(counts[0] > 40_000 && counts[1] >= 40_000, "{counts:?}");
        assert!(!is_straight(DVec3::NAN, DVec3::X, 1.0, 1.0));
        assert!(!is_straight(DVec3::X, -DVec3::X, f64::NAN, 1.0));
    }
}
