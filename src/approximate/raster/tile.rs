//! One tile: which triangle each sample sees.
//!
//! Edge functions and 1/z are linear in the film point. They are set up in f64, relative to the tile's corner, and
//! evaluated in f32, for the samples of one strip of the tile after the other: pixel by pixel, so that even a small triangle
//! fills vectors with the samples of the few pixels that it may cover. With coefficients a, b, c of a tile of n pixels two products and two
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

use super::batch::{Batch, TileBatches};
use super::draw::Strip;
use super::vertices::Vertex;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::render::film::{TILE, Tile};

/// No triangle.
pub(super) const NOTHING: u32 = u32::MAX;
/// Pixels along the side of a tile.
const SIDE: usize = TILE as usize;
/// Bound on the rounding of 1/z, per n |a| + n |b| + |c|.
const ROUNDING: f64 = 4.0 / (1u64 << 24) as f64;

/// So many samples go through the loops together: eight f32 are a vector of AVX2.
const LANES: usize = 8;
/// Blocks of the samples of a strip: as many as a tile has pixels.
const BLOCKS: usize = SIDE * SIDE / LANES;
/// The most samples of a pixel that a strip holds, which is a row of pixels at least.
pub(super) const MOST_TOGETHER: u32 = SIDE as u32;

/// Numbers of samples in a row, pixel by pixel.
type Block<T> = [T; LANES];

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

/// The samples of a strip.
#[derive(Debug)]
struct Samples {
    /// Their places relative to the tile's corner, pixels; NaN after the last.
    x: [Block<f32>; BLOCKS],
    y: [Block<f32>; BLOCKS],
    /// Bounds on 1/z of the nearest so far.
    least: [Block<f32>; BLOCKS],
    most: [Block<f32>; BLOCKS],
    /// Index of its triangle.
    nearest: [Block<u32>; BLOCKS],
}

/// The triangles that may reach each strip of a tile, in compressed rows.
#[derive(Debug, Default)]
struct StripLists {
    /// Rows of pixels of each.
    rows: usize,
    starts: Vec<u32>,
    triangles: Vec<u32>,
    /// Where the next triangle of each goes, while they are filled.
    next: Vec<u32>,
}

impl StripLists {
    /// Sorts `triangles` by the strips of `rows` rows that they may reach, and leaves them in order.
    fn fill(&mut self, triangles: &[Gathered], rows: usize) {
        let strips = |triangle: &Gathered| {
            let [_, top, _, bottom] = triangle.pixels.map(usize::from);
            top / rows..=bottom / rows
        };
        self.rows = rows;
        self.starts.clear();
        self.starts.resize(SIDE.div_ceil(rows) + 1, 0);
        for triangle in triangles {
            for strip in strips(triangle) {
                self.starts[strip + 1] += 1;
            }
        }
        for at in 1..self.starts.len() {
            self.starts[at] += self.starts[at - 1];
        }
        self.next.clone_from(&self.starts);
        let all = self.starts.last().copied().unwrap_or(0);
        self.triangles.resize(all as usize, 0);
        for (index, triangle) in (0..).zip(triangles) {
            for strip in strips(triangle) {
                let place = &mut self.next[strip];
                self.triangles[*place as usize] = index;
                *place += 1;
            }
        }
    }

    /// The triangles that may reach the strip whose first row is `row`.
    fn of(&self, row: usize) -> &[u32] {
        let strip = row / self.rows;
        let [start, end] = [0, 1].map(|k| self.starts[strip + k] as usize);
        &self.triangles[start..end]
    }
}

/// What is reused from tile to tile.
#[derive(Debug)]
pub(super) struct TileBuffers {
    pub triangles: Vec<Gathered>,
    functions: Vec<Functions>,
    lists: StripLists,
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
            lists: StripLists::default(),
            corners: Box::new([[[0.0; LOT]; 3]; 3]),
            samples: Box::new(Samples {
                x: [[f32::NAN; LANES]; BLOCKS],
                y: [[f32::NAN; LANES]; BLOCKS],
                least: [[0.0; LANES]; BLOCKS],
                most: [[0.0; LANES]; BLOCKS],
                nearest: [[NOTHING; LANES]; BLOCKS],
            }),
        }
    }
}

impl TileBuffers {
    /// Gathers the triangles that may reach `tile`, which has strips of `rows` rows, of a film of `size` pixels; `seen` are
    /// the vertices of each rest frame, and `unit` the length that depths are measured in, metres.
    pub fn gather(
        &mut self,
        size: [u32; 2],
        (tile, rows): (Tile, u32),
        (batches, by_tile): (&[Batch], &TileBatches),
        seen: &[Vec<Vertex>],
        unit: f64,
    ) {
        self.triangles.clear();
        let [left, top] = tile.corner;
        let [right, bottom] = [left + tile.size[0] - 1, top + tile.size[1] - 1];
        // What may reach the tile, with the pixels that it may cover there.
        let tile_index = tile.index(size);
        // A tile is less than 256 pixels wide.
        let column = |x: u16| (u32::from(x).clamp(left, right) - left) as u8;
        let row = |y: u16| (u32::from(y).clamp(top, bottom) - top) as u8;
        for &at in by_tile.of(tile_index) {
            let batch = &batches[at as usize];
            let pieces = batch.bins.of(tile_index).iter();
            self.triangles.extend(pieces.map(|&index| {
                let [a, b, c, d] = batch.pieces[index as usize].reach;
                Gathered {
                    batch: at,
                    piece: index,
                    pixels: [column(a), row(b), column(c), row(d)],
                }
            }));
        }
        self.lists.fill(&self.triangles, rows as usize);
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
                for (corner, vertex) in self.corners.iter_mut().zip(corners) {
                    let h = vertex.film;
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

    /// Finds the nearest triangle at the samples of `strip`, which are at these points of the tile.
    pub fn cover(&mut self, strip: &Strip, x: &[f64], y: &[f64]) {
        dispatch(Cover {
            triangles: &self.triangles,
            functions: &self.functions,
            list: self.lists.of(strip.first as usize),
            strip,
            points: [x, y],
            samples: &mut self.samples,
        });
    }

    /// The indices of the nearest triangles at the samples of the strip.
    #[inline(always)]
    pub fn nearest(&self) -> &[u32] {
        self.samples.nearest.as_flattened()
    }

    /// Says which triangle a sample sees.
    pub fn set_nearest(&mut self, sample: usize, triangle: u32) {
        self.samples.nearest[sample / LANES][sample % LANES] = triangle;
    }

    /// The index of the nearest of those triangles alone that `is_there` says, each asked at most once. In f64: for samples whose
    /// nearest triangle has a hole.
    #[cold]
    pub fn nearest_of(&self, sample: usize, mut is_there: impl FnMut(u32) -> bool) -> u32 {
        let of_sample = |blocks: &[Block<f32>]| blocks[sample / LANES][sample % LANES];
        let (x, y) = (of_sample(&self.samples.x), of_sample(&self.samples.y));
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

/// The loop over triangles and blocks of samples.
struct Cover<'a> {
    triangles: &'a [Gathered],
    functions: &'a [Functions],
    /// Indices of the triangles that may reach the strip.
    list: &'a [u32],
    strip: &'a Strip,
    points: [&'a [f64]; 2],
    samples: &'a mut Samples,
}

impl VectorLoop for Cover<'_> {
    #[inline(always)]
    fn run(self) {
        let Cover {
            triangles,
            functions,
            list,
            strip,
            points: [x, y],
            samples,
        } = self;
        samples.start(x, y);
        let [first, each] = [strip.first as usize, strip.each];
        let [width, height] = strip.rows.size.map(|n| n as usize);
        for &index in list {
            let of = &functions[index as usize];
            let pixels = triangles[index as usize].pixels.map(usize::from);
            let [left, top, right, bottom] = pixels;
            for row in top.max(first)..=bottom.min(first + height - 1) {
                // Whole blocks: samples beside the triangle are outside of it wherever they are.
                let begin = (row - first) * width * each;
                let blocks =
                    (begin + left * each) / LANES..=(begin + right * each + each - 1) / LANES;
                for block in blocks {
                    if block < BLOCKS && cover_block(of, index, samples, block) {
                        resolve(functions, index, samples, block);
                    }
                }
            }
        }
    }
}

impl Samples {
    /// Takes the points of all samples, none of which sees anything yet.
    #[inline(always)]
    fn start(&mut self, x: &[f64], y: &[f64]) {
        let count = x.len().min(y.len()).min(BLOCKS * LANES);
        let blocks = count.div_ceil(LANES);
        self.x[..blocks].fill([f32::NAN; LANES]);
        self.y[..blocks].fill([f32::NAN; LANES]);
        self.least[..blocks].fill([0.0; LANES]);
        self.most[..blocks].fill([0.0; LANES]);
        self.nearest[..blocks].fill([NOTHING; LANES]);
        let (to_x, to_y) = (self.x.as_flattened_mut(), self.y.as_flattened_mut());
        for (to, from) in to_x[..count].iter_mut().zip(&x[..count]) {
            *to = *from as f32;
        }
        for (to, from) in to_y[..count].iter_mut().zip(&y[..count]) {
            *to = *from as f32;
        }
    }
}

/// Replaces what lies behind a triangle in a block. Whether a depth is too close to another to tell.
#[inline(always)]
fn cover_block(of: &Functions, index: u32, samples: &mut Samples, block: usize) -> bool {
    let [a, b, c] = of.edges;
    let [dx, dy, dz] = of.depth;
    let (x, y) = (&samples.x[block], &samples.y[block]);
    let (least, most) = (&mut samples.least[block], &mut samples.most[block]);
    let nearest = &mut samples.nearest[block];
    let mut close = 0;
    for i in 0..LANES {
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

/// Decides in f64 where [`cover_block`] could not.
#[cold]
fn resolve(functions: &[Functions], index: u32, samples: &mut Samples, block: usize) {
    let of = &functions[index as usize];
    for i in 0..LANES {
        let (x, y) = (samples.x[block][i], samples.y[block][i]);
        let at = |[a, b, c]: [f32; 3]| a * x + b * y + c;
        let (low, high) = (at(of.depth) - of.slack, at(of.depth) + of.slack);
        let (least, most) = (&mut samples.least[block][i], &mut samples.most[block][i]);
        let nearest = &mut samples.nearest[block][i];
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_list_the_triangles_that_reach_their_rows_in_order() {
        let rows = |[top, bottom]: [u8; 2]| Gathered {
            batch: 0,
            piece: 0,
            pixels: [3, top, 7, bottom],
        };
        let spans = [[0, 15], [4, 4], [15, 15], [0, 0], [3, 5], [14, 15], [7, 8]];
        let triangles = spans.map(rows);
        for height in [1, 2, 3, 5, 8, 16] {
            let mut lists = StripLists::default();
            // A second filling forgets the first.
            lists.fill(&triangles[..2], 1);
            lists.fill(&triangles, height);
            for first in (0..SIDE).step_by(height) {
                let reaches = |[top, bottom]: [u8; 2]| {
                    usize::from(top) < first + height && usize::from(bottom) >= first
                };
                let expected = (0..).zip(spans).filter(|(_, span)| reaches(*span));
                let expected: Vec<u32> = expected.map(|(index, _)| index).collect();
                assert_eq!(lists.of(first), expected, "{height} rows from {first}");
            }
        }
    }
}
