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
use super::cull::Reach;
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

/// Number of samples that loops take together: eight f32 are a vector of AVX2.
const LANES: usize = 8;
/// Samples of a pixel fill whole blocks where they are a multiple of this.
pub(super) const WHOLE: usize = LANES;
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
    /// The only sample that it may hold, or [`SEVERAL`].
    only: u16,
}

/// Of a triangle that may hold more than one sample, or of which that has not been asked.
const SEVERAL: u16 = u16::MAX;

/// All pieces, where their vertices are, and the length that depths are measured in, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pieces<'a> {
    /// Of the film, pixels.
    pub size: [u32; 2],
    pub batches: &'a [Batch],
    /// The batches by tile.
    pub by_tile: &'a TileBatches,
    /// By rest frame.
    pub seen: &'a [Vec<Vertex>],
    pub unit: f64,
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
    /// By triangle.
    functions: Vec<Functions>,
    /// Whether the triangles are all that may reach the tile.
    is_complete: bool,
    /// Whether strips have lists of their triangles, and are not the whole tile.
    is_listed: bool,
    lists: StripLists,
    /// Indices of all triangles.
    every: Vec<u32>,
    /// By coordinate, the corners of triangles whose functions are set up together.
    corners: Box<[[[f64; LOT]; 3]; 3]>,
    samples: Box<Samples>,
    pixels: Box<Pixels>,
}

/// The pixels of a strip whose samples fill whole blocks.
#[derive(Debug)]
struct Pixels {
    /// Index of the triangle that all samples of a pixel see.
    nearest: [u32; PIXELS],
    /// Bounds on 1/z of the nearest so far, of all samples.
    least: [f32; PIXELS],
    most: [f32; PIXELS],
    /// Whether samples may see several triangles, which are told one by one.
    is_mixed: [bool; PIXELS],
    /// Which pixels are asked sample by sample.
    is_sampled: [bool; PIXELS],
}

impl Pixels {
    /// Of which nothing is known.
    const EMPTY: Pixels = Pixels {
        nearest: [NOTHING; PIXELS],
        least: [0.0; PIXELS],
        most: [0.0; PIXELS],
        is_mixed: [false; PIXELS],
        is_sampled: [false; PIXELS],
    };
}

/// The most pixels of a strip whose samples fill whole blocks.
pub(super) const PIXELS: usize = BLOCKS;

/// Works out where the samples of a pixel of a strip are, in their places in lists of x and y of all samples.
pub(super) type SamplePixel<'a> = dyn FnMut(usize, &mut [f64], &mut [f64]) + 'a;

/// Triangles that span fewer columns are asked at once about the samples of all their pixels.
const WIDE: usize = 3;

/// Gathers those triangles that may reach `tile` and of which `holds` says what their only sample is, with their reach and their pixels.
#[inline(always)]
fn gather(
    triangles: &mut Vec<Gathered>,
    pieces: &Pieces,
    tile: Tile,
    holds: impl Fn(&Reach, [u8; 4]) -> Option<u16>,
) {
    triangles.clear();
    let last = [0, 1].map(|axis| tile.corner[axis] + tile.size[axis] - 1);
    // What may reach the tile, with the pixels that it may cover there.
    let tile_index = tile.index(pieces.size);
    for &at in pieces.by_tile.of(tile_index) {
        let batch = &pieces.batches[at as usize];
        let own = batch.bins.of(tile_index);
        let begin = triangles.len();
        let nothing = Gathered {
            batch: at,
            piece: 0,
            pixels: [0; 4],
            only: SEVERAL,
        };
        triangles.resize(begin + own.len(), nothing);
        let mut count = begin;
        for &piece in own {
            let reach = &batch.pieces[piece as usize].reach;
            // A tile is less than 256 pixels wide.
            let pixels = reach.pixels(tile.corner, last).map(|p| p as u8);
            let only = holds(reach, pixels);
            // Without a branch, which no processor could predict.
            triangles[count] = Gathered {
                batch: at,
                piece,
                pixels,
                only: only.unwrap_or(SEVERAL),
            };
            count += usize::from(only.is_some());
        }
        triangles.truncate(count);
    }
}

/// Number of triangles that are set up together.
const LOT: usize = 32;

impl Default for TileBuffers {
    fn default() -> Self {
        TileBuffers {
            triangles: Vec::new(),
            functions: Vec::new(),
            is_complete: false,
            is_listed: false,
            lists: StripLists::default(),
            every: Vec::new(),
            corners: Box::new([[[0.0; LOT]; 3]; 3]),
            samples: Box::new(Samples::NONE),
            pixels: Box::new(Pixels::EMPTY),
        }
    }
}

impl TileBuffers {
    /// Forgets the triangles of the last tile.
    pub fn start(&mut self) {
        self.is_complete = false;
        self.triangles.clear();
    }

    /// Gathers the triangles that may reach `tile`, which has strips of `rows` rows, and sets them up, where that has not been done. Whether it has now.
    pub fn complete(&mut self, pieces: &Pieces, tile: Tile, rows: u32) -> bool {
        if self.is_complete {
            return false;
        }
        gather(&mut self.triangles, pieces, tile, |_, _| Some(SEVERAL));
        self.is_listed = rows < tile.size[1];
        if self.is_listed {
            self.lists.fill(&self.triangles, rows as usize);
        }
        self.set_up(pieces, tile);
        self.is_complete = true;
        true
    }

    /// Finds the nearest triangle at the samples of `tile`, one for each pixel, which are at these points of it: of triangles smaller than a pixel most
    /// hold none, and are not kept.
    pub fn cover_tile(&mut self, pieces: &Pieces, tile: Tile, x: &[f64], y: &[f64]) {
        dispatch(Start {
            points: [x, y],
            samples: &mut self.samples,
        });
        self.is_complete = false;
        self.gather_held(pieces, tile);
        self.set_up(pieces, tile);
        let strip = Strip {
            rows: tile,
            first: 0,
            each: 1,
        };
        dispatch(Cover {
            triangles: &self.triangles,
            functions: &self.functions,
            list: &self.every,
            strip: &strip,
            samples: &mut self.samples,
        });
    }

    /// Gathers the triangles that may hold a sample of `tile`.
    fn gather_held(&mut self, pieces: &Pieces, tile: Tile) {
        let [left, top] = tile.corner.map(|first| first as f32);
        let width = tile.size[0] as usize;
        let (x, y) = (self.samples.x.as_flattened(), self.samples.y.as_flattened());
        gather(&mut self.triangles, pieces, tile, |reach, pixels| {
            let [column, row, last_column, last_row] = pixels.map(usize::from);
            if (last_column - column > 1) | (last_row - row > 1) {
                return Some(SEVERAL);
            }
            let Reach(reach) = reach;
            // Exact: whole numbers from multiples of the last digit of larger ones.
            let [from_x, from_y] = [reach[0] - left, reach[1] - top];
            let [to_x, to_y] = [reach[2] - left, reach[3] - top];
            let holds = |column: usize, row: usize| {
                let (x, y) = (x[row * width + column], y[row * width + column]);
                (x >= from_x) & (x <= to_x) & (y >= from_y) & (y <= to_y)
            };
            // Of four samples, two or one, which are inside.
            let (is_wide, is_high) = (last_column != column, last_row != row);
            let inside = [
                holds(column, row),
                is_wide & holds(last_column, row),
                is_high & holds(column, last_row),
                is_wide & is_high & holds(last_column, last_row),
            ];
            let [_, b, c, d] = inside.map(usize::from);
            // The one that is, where there is one: each step is 1 or none.
            let only = (row + (c | d) * (last_row - row)) * width
                + column
                + (b | d) * (last_column - column);
            let count: usize = inside.map(usize::from).iter().sum();
            match count {
                0 => None,
                1 => Some(only as u16),
                _ => Some(SEVERAL),
            }
        });
    }

    /// Finds the nearest triangle at the samples of `strip`, which are at these points of the tile.
    pub fn cover(&mut self, strip: &Strip, x: &[f64], y: &[f64]) {
        debug_assert!(self.is_complete);
        dispatch(Start {
            points: [x, y],
            samples: &mut self.samples,
        });
        let list = match self.is_listed {
            true => self.lists.of(strip.first as usize),
            false => &self.every,
        };
        dispatch(Cover {
            triangles: &self.triangles,
            functions: &self.functions,
            list,
            strip,
            samples: &mut self.samples,
        });
    }

    /// Nothing is known of the pixels of `strip`.
    fn clear_pixels(&mut self, strip: &Strip) {
        debug_assert!(self.is_complete && strip.each.is_multiple_of(LANES));
        *self.pixels = Pixels::EMPTY;
    }

    /// Finds the nearest triangle at the samples of `strip`, which fill whole blocks of each pixel, and are at these points of the tile: by pixels first.
    pub fn cover_by_pixels(&mut self, strip: &Strip, x: &mut [f64], y: &mut [f64]) {
        self.clear_pixels(strip);
        self.pixels.is_sampled.fill(true);
        self.cover_each(strip, (x, y, false), &mut |_, _, _| {});
    }

    /// Says of which pixels of `strip` the samples are asked for: of those that a triangle may cover in part, and of all that may see one of the batches
    /// that `needs` says. For strips whose samples fill whole blocks of each pixel.
    pub fn begin_pixels(&mut self, strip: &Strip, needs: &[bool]) -> &[bool] {
        self.clear_pixels(strip);
        let list = match self.is_listed {
            true => self.lists.of(strip.first as usize),
            false => &self.every,
        };
        dispatch(Reached {
            strip,
            triangles: &self.triangles,
            functions: &self.functions,
            list,
            needs,
            pixels: &mut self.pixels,
        });
        &self.pixels.is_sampled[..strip.rows.pixels()]
    }

    /// Finds the nearest triangle at the samples of `strip`, which [`TileBuffers::begin_pixels`] has begun: of pixels that it has not asked for, `sample` is
    /// called, if they are asked about after all. `x` and `y` are where samples are in their pixels.
    pub fn cover_pixels(
        &mut self,
        strip: &Strip,
        (x, y): (&mut [f64], &mut [f64]),
        sample: &mut SamplePixel,
    ) {
        self.cover_each(strip, (x, y, true), sample);
    }

    /// The same with points in their pixels, or else of the tile.
    fn cover_each(
        &mut self,
        strip: &Strip,
        (x, y, are_in_pixels): (&mut [f64], &mut [f64], bool),
        sample: &mut SamplePixel,
    ) {
        let list = match self.is_listed {
            true => self.lists.of(strip.first as usize),
            false => &self.every,
        };
        dispatch(CoverPixels {
            triangles: &self.triangles,
            functions: &self.functions,
            list,
            strip,
            samples: &mut self.samples,
            pixels: &mut self.pixels,
            points: [x, y],
            are_in_pixels,
            sample,
        });
    }

    /// Calls `each` with the index of the nearest triangle of samples in a row, and how many they are, after [`TileBuffers::cover_pixels`]. In the order of the samples.
    #[inline(always)]
    pub fn each_run_of_pixels(&self, strip: &Strip, mut each: impl FnMut(u32, usize)) {
        let nearest = self.samples.nearest.as_flattened();
        for pixel in 0..strip.rows.pixels().min(PIXELS) {
            if !self.pixels.is_mixed[pixel] {
                each(self.pixels.nearest[pixel], strip.each);
                continue;
            }
            let own = &nearest[pixel * strip.each..(pixel + 1) * strip.each];
            for alike in own.chunk_by(|a, b| a == b) {
                each(alike[0], alike.len());
            }
        }
    }

    /// Sets up the functions of the triangles: by lots, as columns, in vectors. Those that do not hold their only sample are not kept.
    fn set_up(&mut self, pieces: &Pieces, tile: Tile) {
        let mut lot = [NEVER; LOT];
        let (mut points, mut is_held) = ([[0.0; LOT]; 2], [1; LOT]);
        let (x, y) = (self.samples.x.as_flattened(), self.samples.y.as_flattened());
        self.functions.resize(self.triangles.len(), NEVER);
        let corner = tile.corner.map(f64::from);
        let mut count = 0;
        for begin in (0..self.triangles.len()).step_by(LOT) {
            let end = self.triangles.len().min(begin + LOT);
            for (at, triangle) in self.triangles[begin..end].iter().enumerate() {
                let batch = &pieces.batches[triangle.batch as usize];
                let piece = &batch.pieces[triangle.piece as usize];
                let corners = batch.corners(&pieces.seen[batch.frame as usize], piece);
                for (corner, vertex) in self.corners.iter_mut().zip(corners) {
                    let h = vertex.film;
                    corner[0][at] = h.x;
                    corner[1][at] = h.y;
                    corner[2][at] = h.z;
                }
                // Where there are several, the first stands for them.
                let only = usize::from(triangle.only) % (SIDE * SIDE);
                (points[0][at], points[1][at]) = (x[only], y[only]);
            }
            dispatch(SetUp {
                origin: corner,
                unit: pieces.unit,
                corners: &self.corners,
                functions: &mut lot[..end - begin],
                points: &points,
                is_held: &mut is_held,
            });
            for at in begin..end {
                let triangle = self.triangles[at];
                if triangle.only == SEVERAL || is_held[at - begin] != 0 {
                    self.triangles[count] = triangle;
                    self.functions[count] = lot[at - begin];
                    count += 1;
                }
            }
        }
        self.triangles.truncate(count);
        self.functions.truncate(count);
        self.every.clear();
        self.every.extend(0..count as u32);
    }

    /// The indices of the nearest triangles at the samples of the strip.
    #[inline(always)]
    pub fn nearest(&self) -> &[u32] {
        self.samples.nearest.as_flattened()
    }

    /// Calls `each` with the index of the nearest triangle of samples in a row, the first `count` in all, and how many they are.
    #[inline(always)]
    pub fn each_run(&self, count: usize, mut each: impl FnMut(u32, usize)) {
        let all = &self.samples.nearest.as_flattened()[..count];
        let mut begin = 0;
        let mut at = 0;
        while begin < count {
            let own = all[begin];
            // By whole blocks while they hold nothing else, then one by one.
            while let Some(block) = all[at..].first_chunk::<LANES>()
                && block.iter().fold(0, |other, index| other | (index ^ own)) == 0
            {
                at += LANES;
            }
            while at < count && all[at] == own {
                at += 1;
            }
            each(own, at - begin);
            begin = at;
        }
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
    /// A point for each, and whether it is inside.
    points: &'a [[f32; LOT]; 2],
    is_held: &'a mut [u32; LOT],
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
        let [x, y] = self.points;
        for at in 0..LOT {
            let mut is_inside = true;
            for [a, b, c] in &edges {
                is_inside &= a[at] * x[at] + b[at] * y[at] + c[at] >= 0.0;
            }
            self.is_held[at] = u32::from(is_inside);
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

/// The loop over samples that takes their points.
struct Start<'a> {
    points: [&'a [f64]; 2],
    samples: &'a mut Samples,
}

impl VectorLoop for Start<'_> {
    #[inline(always)]
    fn run(self) {
        let [x, y] = self.points;
        self.samples.start(x, y);
    }
}

/// The loop over triangles and blocks of samples.
struct Cover<'a> {
    triangles: &'a [Gathered],
    functions: &'a [Functions],
    /// Indices of the triangles that may reach the strip.
    list: &'a [u32],
    strip: &'a Strip,
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
            samples,
        } = self;
        let [first, each] = [strip.first as usize, strip.each];
        let [width, height] = strip.rows.size.map(|n| n as usize);
        for &index in list {
            let of = &functions[index as usize];
            let Gathered { pixels, only, .. } = triangles[index as usize];
            if only != SEVERAL {
                cover_one(functions, index, samples, usize::from(only));
                continue;
            }
            let [left, top, right, bottom] = pixels.map(usize::from);
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

/// A triangle's functions over a row of pixels: whether it reaches each pixel at all, and whether it covers all of it. In f32 the functions are monotonic
/// in x and in y, as sums, products and rounding are: what they are at samples lies between what they are at two corners of the pixel, bit for bit.
#[inline(always)]
fn over_row(of: &Functions, row: usize) -> [[u32; SIDE]; 2] {
    let (mut reached, mut full) = ([1; SIDE], [1; SIDE]);
    for [a, b, c] in of.edges {
        let (low, high) = corners_of_row([a, b, c], row);
        for i in 0..SIDE {
            reached[i] &= u32::from(high[i] >= 0.0);
            full[i] &= u32::from(low[i] >= 0.0);
        }
    }
    [reached, full]
}

/// The least and the greatest value that a function has over each pixel of a row.
#[inline(always)]
fn corners_of_row([a, b, c]: [f32; 3], row: usize) -> ([f32; SIDE], [f32; SIDE]) {
    let [left, right] = if a >= 0.0 { [0.0, 1.0] } else { [1.0, 0.0] };
    let row = row as f32;
    let [top, bottom] = if b >= 0.0 {
        [row, row + 1.0]
    } else {
        [row + 1.0, row]
    };
    let (mut low, mut high) = ([0.0; SIDE], [0.0; SIDE]);
    for i in 0..SIDE {
        let column = i as u32 as f32;
        low[i] = a * (column + left) + b * top + c;
        high[i] = a * (column + right) + b * bottom + c;
    }
    (low, high)
}

/// Bounds on 1/z over a pixel.
#[inline(always)]
fn bounds_over(of: &Functions, column: usize, row: usize) -> [f32; 2] {
    let [a, b, c] = of.depth;
    let (column, row) = (column as f32, row as f32);
    let [left, right] = if a >= 0.0 { [0.0, 1.0] } else { [1.0, 0.0] };
    let [top, bottom] = if b >= 0.0 { [0.0, 1.0] } else { [1.0, 0.0] };
    let low = a * (column + left) + b * (row + top) + c;
    let high = a * (column + right) + b * (row + bottom) + c;
    [low - of.slack, high + of.slack]
}

/// The loop over triangles that notes which pixels have to be sampled.
struct Reached<'a> {
    strip: &'a Strip,
    triangles: &'a [Gathered],
    functions: &'a [Functions],
    list: &'a [u32],
    /// By batch, whether all of its pixels have to be.
    needs: &'a [bool],
    pixels: &'a mut Pixels,
}

impl VectorLoop for Reached<'_> {
    #[inline(always)]
    fn run(self) {
        let first = self.strip.first as usize;
        let [width, height] = self.strip.rows.size.map(|n| n as usize);
        for &index in self.list {
            let triangle = &self.triangles[index as usize];
            let [left, top, right, bottom] = triangle.pixels.map(usize::from);
            for row in top.max(first)..=bottom.min(first + height - 1) {
                let begin = (row - first) * width;
                let of_row = &mut self.pixels.is_sampled[begin + left..=begin + right];
                if right - left + 1 < WIDE {
                    for is_sampled in of_row {
                        *is_sampled = true;
                    }
                    continue;
                }
                let needs = self.needs[triangle.batch as usize];
                let [reached, full] = over_row(&self.functions[index as usize], row);
                let reached = reached[left..=right].iter().zip(&full[left..=right]);
                for (is_sampled, (reached, full)) in of_row.iter_mut().zip(reached) {
                    *is_sampled |= (*reached != 0) & (needs | (*full == 0));
                }
            }
        }
    }
}

/// The loop over triangles and the pixels that they may cover.
struct CoverPixels<'a> {
    triangles: &'a [Gathered],
    functions: &'a [Functions],
    list: &'a [u32],
    strip: &'a Strip,
    samples: &'a mut Samples,
    pixels: &'a mut Pixels,
    points: [&'a mut [f64]; 2],
    /// Whether points are counted from the corners of their pixels, and not from that of the tile.
    are_in_pixels: bool,
    sample: &'a mut SamplePixel<'a>,
}

impl VectorLoop for CoverPixels<'_> {
    #[inline(always)]
    fn run(mut self) {
        let first = self.strip.first as usize;
        let [width, height] = self.strip.rows.size.map(|n| n as usize);
        for &index in self.list {
            let of = &self.functions[index as usize];
            let [left, top, right, bottom] = self.triangles[index as usize].pixels.map(usize::from);
            for row in top.max(first)..=bottom.min(first + height - 1) {
                let begin = (row - first) * width;
                if right - left + 1 < WIDE {
                    for column in left..=right {
                        let bounds = bounds_over(of, column, row);
                        self.cover_some(index, (begin + column, row), bounds);
                    }
                    continue;
                }
                let [reached, full] = over_row(of, row);
                let (low, high) = corners_of_row(of.depth, row);
                for column in left..=right.min(SIDE - 1) {
                    if reached[column] != 0 {
                        let bounds = [low[column] - of.slack, high[column] + of.slack];
                        let is_full = full[column] != 0;
                        self.cover(index, (begin + column, row), bounds, is_full);
                    }
                }
            }
        }
    }
}

impl CoverPixels<'_> {
    /// Covers a pixel, or some of its samples, with 1/z within these bounds.
    #[inline(always)]
    fn cover(
        &mut self,
        index: u32,
        (pixel, row): (usize, usize),
        [low, high]: [f32; 2],
        is_full: bool,
    ) {
        if pixel >= PIXELS {
            return;
        }
        let pixels = &mut *self.pixels;
        // Before or behind all that is there, for all samples.
        if is_full && low > pixels.most[pixel] {
            pixels.nearest[pixel] = index;
            (pixels.least[pixel], pixels.most[pixel]) = (low, high);
            pixels.is_mixed[pixel] = false;
        } else if high >= pixels.least[pixel] {
            self.cover_some(index, (pixel, row), [low, high]);
        }
    }

    /// Covers samples of a pixel.
    #[inline(always)]
    fn cover_some(&mut self, index: u32, (pixel, row): (usize, usize), [low, high]: [f32; 2]) {
        if pixel >= PIXELS {
            return;
        }
        if !self.pixels.is_mixed[pixel] {
            self.mix(pixel, row);
        }
        let Pixels { least, most, .. } = &mut *self.pixels;
        least[pixel] = least[pixel].min(low);
        most[pixel] = most[pixel].max(high);
        let (each, of) = (self.strip.each, &self.functions[index as usize]);
        for block in pixel * each / LANES..(pixel + 1) * each / LANES {
            if block < BLOCKS && cover_block(of, index, self.samples, block) {
                resolve(self.functions, index, self.samples, block);
            }
        }
    }

    /// Gives the samples of a pixel what it has.
    #[inline(always)]
    fn mix(&mut self, pixel: usize, row: usize) {
        let each = self.strip.each;
        let [x, y] = &mut self.points;
        if !self.pixels.is_sampled[pixel] {
            (self.sample)(pixel, x, y);
            self.pixels.is_sampled[pixel] = true;
        }
        self.pixels.is_mixed[pixel] = true;
        let nearest = self.pixels.nearest[pixel];
        let of = self.functions.get(nearest as usize);
        let column = pixel % self.strip.rows.size[0] as usize;
        let (column, row) = match self.are_in_pixels {
            true => (column as f64, row as f64),
            false => (0.0, 0.0),
        };
        for block in pixel * each / LANES..(pixel + 1) * each / LANES {
            let samples = &mut *self.samples;
            let own = block * LANES..(block + 1) * LANES;
            let (Some(in_x), Some(in_y)) = (
                x[own.clone()].first_chunk::<LANES>(),
                y[own].first_chunk::<LANES>(),
            ) else {
                return;
            };
            let (to_x, to_y) = (&mut samples.x[block], &mut samples.y[block]);
            for i in 0..LANES {
                to_x[i] = (column + in_x[i]) as f32;
                to_y[i] = (row + in_y[i]) as f32;
            }
            samples.nearest[block] = [nearest; LANES];
            let (least, most) = (&mut samples.least[block], &mut samples.most[block]);
            match of {
                None => (*least, *most) = ([0.0; LANES], [0.0; LANES]),
                Some(of) => {
                    let [a, b, c] = of.depth;
                    for i in 0..LANES {
                        let near = a * to_x[i] + b * to_y[i] + c;
                        (least[i], most[i]) = (near - of.slack, near + of.slack);
                    }
                }
            }
        }
    }
}

impl Samples {
    /// None.
    const NONE: Samples = Samples {
        x: [[f32::NAN; LANES]; BLOCKS],
        y: [[f32::NAN; LANES]; BLOCKS],
        least: [[0.0; LANES]; BLOCKS],
        most: [[0.0; LANES]; BLOCKS],
        nearest: [[NOTHING; LANES]; BLOCKS],
    };

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
    let mut any = 0;
    for i in 0..LANES {
        let ea = a[0] * x[i] + a[1] * y[i] + a[2];
        let eb = b[0] * x[i] + b[1] * y[i] + b[2];
        let ec = c[0] * x[i] + c[1] * y[i] + c[2];
        any |= u32::from((ea >= 0.0) & (eb >= 0.0) & (ec >= 0.0));
    }
    // Few of the blocks that a small triangle may reach have samples in it.
    if any == 0 {
        return false;
    }
    // Copies, written as a whole: parts of vectors are slow to write.
    let (mut least, mut most) = (samples.least[block], samples.most[block]);
    let mut nearest = samples.nearest[block];
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
    samples.least[block] = least;
    samples.most[block] = most;
    samples.nearest[block] = nearest;
    close != 0
}

/// Replaces what lies behind a triangle at a sample that it holds.
#[inline(always)]
fn cover_one(functions: &[Functions], index: u32, samples: &mut Samples, sample: usize) {
    let (of, block, i) = (&functions[index as usize], sample / LANES, sample % LANES);
    let [a, b, c] = of.depth;
    let near = a * samples.x[block][i] + b * samples.y[block][i] + c;
    let (low, high) = (near - of.slack, near + of.slack);
    if low > samples.most[block][i] {
        samples.least[block][i] = low;
        samples.most[block][i] = high;
        samples.nearest[block][i] = index;
    } else if high >= samples.least[block][i] {
        resolve(functions, index, samples, block);
    }
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
    use super::super::batch::{Bins, Grid, Piece};
    use super::*;

    #[test]
    fn strips_list_the_triangles_that_reach_their_rows_in_order() {
        let rows = |[top, bottom]: [u8; 2]| Gathered {
            batch: 0,
            piece: 0,
            pixels: [3, top, 7, bottom],
            only: SEVERAL,
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

    #[test]
    fn samples_in_a_row_that_see_one_triangle_are_one_run() {
        let mut buffers = TileBuffers::default();
        let lengths = [1, 7, 8, 9, 16, 17, 1, 1, 40, 3, 23];
        for (k, length) in (0..).zip(lengths) {
            let begin: usize = lengths[..k as usize].iter().sum();
            for sample in begin..begin + length {
                buffers.set_nearest(sample, if k % 3 == 0 { NOTHING } else { k });
            }
        }
        let count = lengths.iter().sum::<usize>() - 2;
        let mut found = Vec::new();
        buffers.each_run(count, |_, length| found.push(length));
        assert_eq!(found, [1, 7, 8, 9, 16, 17, 1, 1, 40, 3, 21]);
        buffers.each_run(0, |_, _| panic!("there are no samples"));
    }

    /// Numbers in [0, 1).
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = (self.0)
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    const SIZE: [u32; 2] = [64, 61];
    const TILE_AT: Tile = Tile {
        corner: [32, 48],
        size: [16, 13],
    };

    /// So many triangles that may reach the tile, in a batch: every `often`-th is `large` pixels large, the others 0.7.
    fn triangles(random: &mut Random, count: u32, often: u32, large: f64) -> (Batch, Vec<Vertex>) {
        let (mut seen, mut pieces) = (Vec::new(), Vec::new());
        for k in 0..count {
            let size = if k % often == 0 { large } else { 0.7 };
            let place = [32.0 + 16.0 * random.next(), 48.0 + 13.0 * random.next()];
            let points = [0; 3].map(|_| place.map(|x| x + size * (random.next() - 0.5)));
            let z = [(); 3].map(|()| 1.0 + random.next());
            let of = |axis: usize| points.map(|point| point[axis]);
            let least = |axis| of(axis).into_iter().fold(f64::INFINITY, f64::min) - 2e-5;
            let most = |axis| of(axis).into_iter().fold(0.0, f64::max) + 2e-5;
            let reach = Reach([least(0), least(1), most(0), most(1)].map(|x| x.max(0.0) as f32));
            pieces.push(Piece {
                corners: [0, 1, 2].map(|corner| 3 * k + corner),
                slot: k,
                reach,
            });
            seen.extend(points.iter().zip(z).map(|([x, y], z)| Vertex {
                c: DVec3::ZERO,
                film: DVec3::new(x * z, y * z, z),
                point: [*x, *y],
                scale: 0.0,
            }));
        }
        let film = |piece: &Piece| piece.corners.map(|k| seen[k as usize].film);
        let batch = Batch {
            frame: 0,
            shared: seen.len() as u32,
            cuts: Vec::new(),
            places: Vec::new(),
            bins: Bins::new(Grid { size: SIZE }, &pieces, film),
            pieces,
        };
        (batch, seen)
    }

    /// Triangles of half a pixel and less, and some larger ones: those that are not kept hold no sample.
    #[test]
    fn triangles_that_are_not_kept_hold_no_sample() {
        let mut random = Random(1);
        let (batch, seen) = triangles(&mut random, 3000, 50, 6.0);
        let (batches, all) = ([batch], [seen]);
        let by_tile = TileBatches::new(&batches, Tile::count(SIZE));
        let pieces = Pieces {
            size: SIZE,
            batches: &batches,
            by_tile: &by_tile,
            seen: &all,
            unit: 2.0,
        };
        let pixels = || (0..TILE_AT.pixels()).map(|k| [k % 16, k / 16].map(|n| n as f64));
        let x: Vec<f64> = pixels().map(|[x, _]| x + random.next()).collect();
        let y: Vec<f64> = pixels().map(|[_, y]| y + random.next()).collect();
        let strip = Strip {
            rows: TILE_AT,
            first: 0,
            each: 1,
        };
        let mut buffers = TileBuffers::default();
        let mut nearest = [false, true].map(|is_complete| {
            match is_complete {
                true => {
                    buffers.complete(&pieces, TILE_AT, 16);
                    buffers.cover(&strip, &x, &y);
                }
                false => buffers.cover_tile(&pieces, TILE_AT, &x, &y),
            }
            let piece = |k: &u32| buffers.triangles.get(*k as usize).map(|one| one.piece);
            let seen: Vec<_> = buffers.nearest()[..x.len()].iter().map(piece).collect();
            (buffers.triangles.len(), seen)
        });
        assert_eq!(nearest[0].1, nearest[1].1);
        let count = nearest[1].0;
        assert!(count > 2900 && nearest[0].0 < count / 2, "{}", nearest[0].0);
        // Small ones are seen, and not large ones alone.
        let (_, seen) = &mut nearest[0];
        seen.retain(|piece| piece.is_some_and(|piece| piece % 50 != 0));
        assert!(seen.len() > 20, "{}", seen.len());
    }

    /// Triangles that cover whole pixels and parts of them, behind, before and through each other.
    #[test]
    fn pixels_that_are_covered_as_a_whole_see_what_their_samples_do() {
        let mut random = Random(2);
        let (mut whole, mut mixed) = (0, 0);
        for (count, often, large) in [
            (3000, 50, 12.0),
            (40, 1, 30.0),
            (12, 1, 60.0),
            (300, 10, 4.0),
        ] {
            let (batch, seen) = triangles(&mut random, count, often, large);
            let (batches, all) = ([batch], [seen]);
            let by_tile = TileBatches::new(&batches, Tile::count(SIZE));
            let pieces = Pieces {
                size: SIZE,
                batches: &batches,
                by_tile: &by_tile,
                seen: &all,
                unit: 2.0,
            };
            for each in [8, 16] {
                let rows = 16 / each as u32;
                let mut buffers = TileBuffers::default();
                buffers.complete(&pieces, TILE_AT, rows);
                for strip in Strip::of(TILE_AT, rows, each) {
                    let pixels = (0..strip.samples()).map(|k| k / each);
                    let mut inside = |n: usize| n as f64 + random.next();
                    let at =
                        pixels.map(|k| [inside(k % 16), inside(strip.first as usize + k / 16)]);
                    let (mut x, mut y): (Vec<f64>, Vec<f64>) = at.map(|[x, y]| (x, y)).unzip();
                    buffers.cover(&strip, &x, &y);
                    let expected = buffers.nearest()[..x.len()].to_vec();
                    buffers.cover_by_pixels(&strip, &mut x, &mut y);
                    let mut seen = Vec::new();
                    buffers.each_run_of_pixels(&strip, |triangle, samples| {
                        seen.extend(std::iter::repeat_n(triangle, samples));
                    });
                    assert_eq!(seen, expected, "{large} {each} {}", strip.first);
                    let are_mixed = &buffers.pixels.is_mixed[..strip.rows.pixels()];
                    mixed += are_mixed.iter().filter(|is_mixed| **is_mixed).count();
                    let nearest = &buffers.pixels.nearest[..are_mixed.len()];
                    let full = are_mixed.iter().zip(nearest);
                    whole += full
                        .filter(|(mixed, one)| !**mixed && **one != NOTHING)
                        .count();
                }
            }
        }
        assert!(whole > 200 && mixed > 200, "{whole} {mixed}");
    }
}
