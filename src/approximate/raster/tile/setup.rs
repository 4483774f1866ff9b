//! Triangle setup: edge functions and 1/z of a triangle over a tile.
//!
//! Both are linear in the film point. They are set up in f64, relative to the tile's corner, and evaluated in f32. With coefficients a, b, c and
//! a tile of n pixels, the rounding error of two products and two sums is at most
//!
//! ```text
//! 4 · 2⁻²⁴ (n |a| + n |b| + |c|):
//! ```
//!
//! for an edge that passes through the tile less than 10⁻⁵ pixels, because c is then at most n (|a| + |b|). Triangles on either side of
//! an edge have the same function with opposite sign, bit for bit, so that no sample falls between them.

use glam::DVec3;

use crate::accel::vectors::VectorLoop;
use crate::render::film::TILE;

/// Pixels along the side of a tile.
pub(super) const SIDE: usize = TILE as usize;
/// The bound above, for 1/z: per n |a| + n |b| + |c|.
const ROUNDING: f64 = 4.0 / (1u64 << 24) as f64;

/// The number of triangles that are set up together.
pub(super) const LOT: usize = 32;

/// A triangle's functions of a point (x, y) of the tile: x, y and constant coefficients.
#[derive(Debug, Clone, Copy)]
pub(super) struct Functions {
    /// Positive inside.
    pub edges: [[f32; 3]; 3],
    /// 1/z.
    pub depth: [f32; 3],
    /// Bound on its rounding.
    pub slack: f32,
    /// The same in f64.
    pub exact: [f64; 3],
}

pub(super) const NEVER: Functions = Functions {
    edges: [[0.0, 0.0, -1.0]; 3],
    depth: [0.0; 3],
    slack: 0.0,
    exact: [0.0; 3],
};

/// The loop over triangles that sets up their functions.
pub(super) struct SetUp<'a> {
    pub origin: [f64; 2],
    pub unit: f64,
    pub corners: &'a [[[f64; LOT]; 3]; 3],
    /// The functions of the triangles that are kept, from the first element on.
    pub functions: &'a mut [Functions],
    /// A point for each triangle: it is kept if the point is inside, or if there are several.
    pub points: &'a [[f32; LOT]; 2],
    pub are_several: &'a [u32; LOT],
    /// Bits of the triangles that are kept.
    pub kept: &'a mut u32,
}

impl SetUp<'_> {
    /// A corner relative to the tile's.
    #[inline(always)]
    fn corner(&self, k: usize, at: usize) -> DVec3 {
        let [x, y, z] = &self.corners[k];
        let ([x, y, z], [left, top]) = ([x[at], y[at], z[at]], self.origin);
        // In homogeneous coordinates (xz, yz, z) a shift of the origin is linear.
        DVec3::new(x - left * z, y - top * z, z)
    }
}

impl VectorLoop for SetUp<'_> {
    #[inline(always)]
    fn run(self) {
        let mut edges = [[[0.0f32; LOT]; 3]; 3];
        let mut depth = [[0.0f64; LOT]; 3];
        let mut slack = [0.0f32; LOT];
        for at in 0..LOT {
            let (a, b, c) = (self.corner(0, at), self.corner(1, at), self.corner(2, at));
            let e = [b.cross(c), c.cross(a), a.cross(b)];
            let determinant = a.dot(e[0]);
            // The sign of the orientation makes all three functions positive inside, seen from either side.
            let sign = 1f64.copysign(determinant);
            // 1/z = Σ eᵢ·p/D, with z in units of the scene's depth.
            let near = (e[0] + e[1] + e[2]) * (self.unit / determinant);
            // The largest rounding error of 1/z in f32 anywhere in the tile.
            let bound = ROUNDING * (SIDE as f64 * (near.x.abs() + near.y.abs()) + near.z.abs());
            // False for triangles seen edge-on, and for NaN.
            let is_seen = (determinant.abs() > 0.0) & (bound < f64::INFINITY);
            for k in 0..3 {
                let e = e[k];
                // The power of two is the same on both sides of an edge, so that its two functions remain each other's negatives.
                let largest = e.x.abs().max(e.y.abs()).max(e.z.abs());
                let scale = sign * reciprocal_power_of_two(largest);
                // Edge-on triangles become (0, 0, −1): no point is inside.
                let seen = if is_seen { scale } else { 0.0 };
                edges[k][0][at] = (e.x * seen) as f32;
                edges[k][1][at] = (e.y * seen) as f32;
                edges[k][2][at] = if is_seen { (e.z * scale) as f32 } else { -1.0 };
            }
            depth[0][at] = if is_seen { near.x } else { 0.0 };
            depth[1][at] = if is_seen { near.y } else { 0.0 };
            depth[2][at] = if is_seen { near.z } else { 0.0 };
            slack[at] = if is_seen { bound as f32 } else { 0.0 };
        }
        // One bit of `kept` for each triangle.
        const { assert!(LOT == u32::BITS as usize) };
        let [x, y] = self.points;
        let mut kept = 0;
        for at in 0..LOT {
            let mut is_inside = true;
            for [a, b, c] in &edges {
                is_inside &= a[at] * x[at] + b[at] * y[at] + c[at] >= 0.0;
            }
            kept |= (u32::from(is_inside) | self.are_several[at]) << at;
        }
        *self.kept = kept;
        for function in self.functions.iter_mut().take(LOT) {
            if kept == 0 {
                break;
            }
            let at = kept.trailing_zeros() as usize % LOT;
            kept &= kept - 1;
            // One by one: mapping the arrays would copy all of them for each triangle.
            let mut of = NEVER;
            for (to, from) in of.edges.iter_mut().zip(&edges) {
                for (to, from) in to.iter_mut().zip(from) {
                    *to = from[at];
                }
            }
            for ((to, exact), from) in of.depth.iter_mut().zip(&mut of.exact).zip(&depth) {
                (*to, *exact) = (from[at] as f32, from[at]);
            }
            of.slack = slack[at];
            *function = of;
        }
    }
}

/// A power of two that scales `x` to [1, 2).
#[inline(always)]
fn reciprocal_power_of_two(x: f64) -> f64 {
    let exponent = x.to_bits() >> 52;
    // From the bits: 2046 is twice the exponent bias. 0 and subnormals get the largest power of two.
    f64::from_bits(2046u64.saturating_sub(exponent) << 52)
}
