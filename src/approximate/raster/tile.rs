//! One tile: which triangle each sample sees.
//!
//! Edge functions and 1/z are linear in the film point. They are set up in f64, relative to the tile's corner, and
//! evaluated in f32, a row of the tile at a time. With coefficients a, b, c of a tile of n pixels two products and two
//! sums are off by at most
//!
//! ```text
//! 4 · 2⁻²⁴ (n |a| + n |b| + |c|):
//! ```
//!
//! for an edge that passes through the tile less than 10⁻⁵ pixels, since c is at most n (|a| + |b|) then. Triangles on
//! either side of an edge have the same function with the other sign, bit for bit, so that no sample falls between
//! them. Depths that differ by no more than that bound, of either triangle, are compared in f64.

use glam::DVec3;

use super::batch::Batch;
use super::vertices::Vertex;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::render::film::{TILE, Tile};

/// No triangle.
pub(super) const NOTHING: u32 = u32::MAX;
/// Pixels along the side of a tile.
const SIDE: usize = TILE as usize;
/// Bound on the rounding of 1/z, per n |a| + n |b| + |c|.
const ROUNDING: f64 = 4.0 / (1u64 << 24) as f64;

/// A row of samples of a tile.
type Row<T> = [T; SIDE];

/// A piece of a batch that may reach the tile.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gathered {
    /// Index of the batch, and of the piece in it.
    pub batch: u32,
    pub piece: u32,
    /// Pixels of the tile: first column and row, last column and row.
    pixels: [u8; 4],
}

/// A triangle's functions of a point (x, y) of the tile: x, y and constant coefficients.
#[derive(Debug, Clone, Copy)]
struct Functions {
    /// Positive inside.
    edges: [[f32; 3]; 3],
    /// 1/z.
    depth: [f32; 3],
    /// Bound on its rounding.
    slack: f32,
    /// The same in f64.
    exact: [f64; 3],
}

const NEVER: Functions = Functions {
    edges: [[0.0, 0.0, -1.0]; 3],
    depth: [0.0; 3],
    slack: 0.0,
    exact: [0.0; 3],
};

/// The samples of a tile, one of each pixel; of narrower tiles the columns on the left.
#[derive(Debug)]
struct Samples {
    /// Their places relative to the tile's corner, pixels; NaN beside the tile.
    x: [Row<f32>; SIDE],
    y: [Row<f32>; SIDE],
    /// Bounds on 1/z of the nearest so far.
    least: [Row<f32>; SIDE],
    most: [Row<f32>; SIDE],
    /// Index of its triangle.
    nearest: [Row<u32>; SIDE],
}

/// What is reused from tile to tile.
#[derive(Debug)]
pub(super) struct TileBuffers {
    pub triangles: Vec<Gathered>,
    functions: Vec<Functions>,
    /// By coordinate, the corners of triangles whose functions are set up together.
    corners: Box<[[[f64; LOT]; 3]; 3]>,
    samples: Box<Samples>,
}

/// So many triangles are set up together.
const LOT: usize = 32;

impl Default for TileBuffers {
    fn default() -> Self {
        TileBuffers {
            triangles: Vec::new(),
            functions: Vec::new(),
            corners: Box::new([[[0.0; LOT]; 3]; 3]),
            samples: Box::new(Samples {
                x: [[f32::NAN; SIDE]; SIDE],
                y: [[f32::NAN; SIDE]; SIDE],
                least: [[0.0; SIDE]; SIDE],
                most: [[0.0; SIDE]; SIDE],
                nearest: [[NOTHING; SIDE]; SIDE],
            }),
        }
    }
}

impl TileBuffers {
    /// Gathers the triangles that may reach `tile` of a film of `size` pixels; `seen` are the vertices of each rest
    /// frame, and `unit` the length that depths are measured in, metres.
    pub fn gather(
        &mut self,
        size: [u32; 2],
        tile: Tile,
        batches: &[Batch],
        seen: &[Vec<Vertex>],
        unit: f64,
    ) {
        self.triangles.clear();
        self.functions.clear();
        let [left, top] = tile.corner;
        let [right, bottom] = [left + tile.size[0] - 1, top + tile.size[1] - 1];
        // What may reach the tile, with the pixels that it may cover there.
        for (at, batch) in batches.iter().enumerate() {
            for &index in batch.bins.of(size, tile) {
                let [a, b, c, d] = batch.pieces[index as usize].reach.map(u32::from);
                let pixels = [
                    a.clamp(left, right) - left,
                    b.clamp(top, bottom) - top,
                    c.clamp(left, right) - left,
                    d.clamp(top, bottom) - top,
                ];
                self.triangles.push(Gathered {
                    batch: at as u32,
                    piece: index,
                    // A tile is less than 256 pixels wide.
                    pixels: pixels.map(|p| p as u8),
                });
            }
        }
        // Edge functions by lots, as columns: they are set up in vectors.
        self.functions.resize(self.triangles.len(), NEVER);
        for (triangles, functions) in self
            .triangles
            .chunks(LOT)
            .zip(self.functions.chunks_mut(LOT))
        {
            for (at, triangle) in triangles.iter().enumerate() {
                let batch = &batches[triangle.batch as usize];
                let piece = &batch.pieces[triangle.piece as usize];
                let corners = batch.corners(&seen[batch.frame as usize], piece);
                for (corner, h) in self.corners.iter_mut().zip(corners.map(|v| v.film)) {
                    corner[0][at] = h.x;
                    corner[1][at] = h.y;
                    corner[2][at] = h.z;
                }
            }
            dispatch(SetUp {
                origin: [f64::from(left), f64::from(top)],
                unit,
                corners: &self.corners,
                functions,
            });
        }
    }

    /// Finds the nearest triangle at the samples with these offsets in their pixels.
    pub fn cover(&mut self, tile: Tile, offset: impl Fn(usize) -> [f64; 2]) {
        let [width, height] = tile.size.map(|n| n as usize);
        let samples = &mut *self.samples;
        for row in 0..SIDE {
            samples.least[row] = [0.0; SIDE];
            samples.most[row] = [0.0; SIDE];
            samples.nearest[row] = [NOTHING; SIDE];
            for column in 0..SIDE {
                let inside = row < height && column < width;
                let at = match inside {
                    true => offset(row * width + column),
                    false => [f64::NAN; 2],
                };
                samples.x[row][column] = (column as f64 + at[0]) as f32;
                samples.y[row][column] = (row as f64 + at[1]) as f32;
            }
        }
        dispatch(Cover {
            triangles: &self.triangles,
            functions: &self.functions,
            samples,
        });
    }

    /// The index of the nearest triangle at the sample in this column and row of the tile.
    #[inline(always)]
    pub fn nearest(&self, column: usize, row: usize) -> u32 {
        self.samples.nearest[row][column]
    }

    /// The same of those triangles alone that `is_there` says, each asked at most once. In f64: for samples whose nearest triangle
    /// has a hole.
    #[cold]
    pub fn nearest_of(
        &self,
        column: usize,
        row: usize,
        mut is_there: impl FnMut(u32) -> bool,
    ) -> u32 {
        let (x, y) = (self.samples.x[row][column], self.samples.y[row][column]);
        let (mut nearest, mut depth) = (NOTHING, 0.0);
        for (index, of) in (0..).zip(&self.functions) {
            let is_inside = of.edges.iter().all(|[a, b, c]| a * x + b * y + c >= 0.0);
            let [a, b, c] = of.exact;
            let own = a * f64::from(x) + b * f64::from(y) + c;
            if is_inside && own > depth && is_there(index) {
                (nearest, depth) = (index, own);
            }
        }
        nearest
    }
}

/// The loop over triangles that sets up their functions.
struct SetUp<'a> {
    origin: [f64; 2],
    unit: f64,
    corners: &'a [[[f64; LOT]; 3]; 3],
    functions: &'a mut [Functions],
}

impl SetUp<'_> {
    /// A corner relative to the tile's.
    #[inline(always)]
    fn corner(&self, k: usize, at: usize) -> DVec3 {
        let [x, y, z] = &self.corners[k];
        let ([x, y, z], [left, top]) = ([x[at], y[at], z[at]], self.origin);
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
            let sign = 1f64.copysign(determinant);
            let near = (e[0] + e[1] + e[2]) * (self.unit / determinant);
            let bound = ROUNDING * (SIDE as f64 * (near.x.abs() + near.y.abs()) + near.z.abs());
            // Not where the triangle is edge-on, and not for NaN.
            let is_seen = (determinant.abs() > 0.0) & (bound < f64::INFINITY);
            for k in 0..3 {
                let e = e[k];
                // Equal powers of two on either side of an edge: its two functions stay each other's negatives.
                let largest = e.x.abs().max(e.y.abs()).max(e.z.abs());
                let scale = sign * reciprocal_power_of_two(largest);
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
        for (at, function) in self.functions.iter_mut().enumerate().take(LOT) {
            // One by one: to map the arrays would copy all of them for each triangle.
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

/// A power of two whose product with `x` is in [1, 2).
#[inline(always)]
fn reciprocal_power_of_two(x: f64) -> f64 {
    let exponent = x.to_bits() >> 52;
    f64::from_bits(2046u64.saturating_sub(exponent) << 52)
}

/// The loop over triangles and rows of samples.
struct Cover<'a> {
    triangles: &'a [Gathered],
    functions: &'a [Functions],
    samples: &'a mut Samples,
}

impl VectorLoop for Cover<'_> {
    #[inline(always)]
    fn run(self) {
        let Cover {
            triangles,
            functions,
            samples,
        } = self;
        for (index, (triangle, of)) in triangles.iter().zip(functions).enumerate() {
            let [_, top, _, bottom] = triangle.pixels.map(usize::from);
            for row in top..=bottom.min(SIDE - 1) {
                if cover_row(of, index as u32, samples, row) {
                    resolve(functions, index as u32, samples, row);
                }
            }
        }
    }
}

/// Replaces what lies behind a triangle in a row. Whether a depth is too close to another to tell.
#[inline(always)]
fn cover_row(of: &Functions, index: u32, samples: &mut Samples, row: usize) -> bool {
    let [a, b, c] = of.edges;
    let [dx, dy, dz] = of.depth;
    let (x, y) = (&samples.x[row], &samples.y[row]);
    let (least, most) = (&mut samples.least[row], &mut samples.most[row]);
    let nearest = &mut samples.nearest[row];
    let mut close = 0;
    for i in 0..SIDE {
        let ea = a[0] * x[i] + a[1] * y[i] + a[2];
        let eb = b[0] * x[i] + b[1] * y[i] + b[2];
        let ec = c[0] * x[i] + c[1] * y[i] + c[2];
        let near = dx * x[i] + dy * y[i] + dz;
        let inside = (ea >= 0.0) & (eb >= 0.0) & (ec >= 0.0);
        let (low, high) = (near - of.slack, near + of.slack);
        let seen = inside & (low > most[i]);
        close |= u32::from(inside & (low <= most[i]) & (high >= least[i]));
        least[i] = if seen { low } else { least[i] };
        most[i] = if seen { high } else { most[i] };
        nearest[i] = if seen { index } else { nearest[i] };
    }
    close != 0
}

/// Decides in f64 where [`cover_row`] could not.
#[cold]
fn resolve(functions: &[Functions], index: u32, samples: &mut Samples, row: usize) {
    let of = &functions[index as usize];
    for i in 0..SIDE {
        let (x, y) = (samples.x[row][i], samples.y[row][i]);
        let at = |[a, b, c]: [f32; 3]| a * x + b * y + c;
        let (low, high) = (at(of.depth) - of.slack, at(of.depth) + of.slack);
        let (least, most) = (&mut samples.least[row][i], &mut samples.most[row][i]);
        let nearest = &mut samples.nearest[row][i];
        let is_inside = of.edges.iter().all(|edge| at(*edge) >= 0.0);
        let is_close = low <= *most && high >= *least;
        if !is_inside || !is_close || *nearest == index {
            continue;
        }
        let exactly = |index: u32| {
            let [a, b, c] = functions.get(index as usize).map_or([0.0; 3], |f| f.exact);
            a * f64::from(x) + b * f64::from(y) + c
        };
        // Of equals the first stays.
        if exactly(index) > exactly(*nearest) {
            (*least, *most, *nearest) = (low, high, index);
        }
    }
}
