//! Buffers of a tile and of the current strip, and the final visibility.

use super::depth::{BLOCKS, Block, LANES, NOTHING, Samples};
use super::gather::{Gathered, Pieces, SEVERAL, StripLists, gather};
use super::setup::{Functions, LOT, NEVER, SIDE, SetUp};
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::render::film::Tile;

/// Buffers that are reused from tile to tile.
#[derive(Debug)]
pub struct TileBuffers {
    pub triangles: Vec<Gathered>,
    /// By triangle.
    pub(super) functions: Vec<Functions>,
    /// Whether the triangles are all those that may reach the tile.
    pub(super) is_complete: bool,
    /// Whether strips are smaller than the tile, and have their own lists of triangles.
    pub(super) is_listed: bool,
    pub(super) lists: StripLists,
    /// Indices of all triangles.
    pub(super) every: Vec<u32>,
    /// The corners of triangles whose functions are set up together, by coordinate.
    corners: Box<[[[f64; LOT]; 3]; 3]>,
    pub(super) samples: Box<Samples>,
    pub(super) pixels: Box<Pixels>,
}

/// The pixels of a strip whose samples fill whole blocks.
#[derive(Debug)]
pub(super) struct Pixels {
    /// Index of the triangle that all samples of a pixel see.
    pub nearest: [u32; PIXELS],
    /// Bounds on 1/z of the nearest triangle so far, over all samples.
    pub least: [f32; PIXELS],
    pub most: [f32; PIXELS],
    /// Whether samples may see different triangles, which are then stored separately.
    pub is_mixed: [bool; PIXELS],
    /// Which pixels are evaluated sample by sample.
    pub is_sampled: [bool; PIXELS],
}

impl Pixels {
    /// Pixels of which nothing is known yet.
    pub const EMPTY: Pixels = Pixels {
        nearest: [NOTHING; PIXELS],
        least: [0.0; PIXELS],
        most: [0.0; PIXELS],
        is_mixed: [false; PIXELS],
        is_sampled: [false; PIXELS],
    };
}

/// The maximum number of pixels of a strip whose samples fill whole blocks.
pub(super) const PIXELS: usize = BLOCKS;

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
    /// Clears the triangles of the last tile.
    pub fn start(&mut self) {
        self.is_complete = false;
        self.triangles.clear();
    }

    /// Gathers and sets up the triangles that may reach `tile`, which has strips of `rows` rows, unless that has been done. Returns whether it was done
    /// now.
    pub fn complete(&mut self, pieces: &Pieces, tile: Tile, rows: u32) -> bool {
        if self.is_complete {
            return false;
        }
        gather(&mut self.triangles, pieces, tile, None);
        self.is_listed = rows < tile.size[1];
        if self.is_listed {
            self.lists.fill(&self.triangles, rows as usize);
        }
        self.set_up(pieces, tile);
        self.is_complete = true;
        true
    }

    /// Sets up the functions of the triangles in lots, by column, with vectors. Triangles whose only candidate sample is outside are
    /// dropped.
    pub(super) fn set_up(&mut self, pieces: &Pieces, tile: Tile) {
        let mut points = [[0.0; LOT]; 2];
        let (x, y) = (self.samples.x.as_flattened(), self.samples.y.as_flattened());
        self.functions.resize(self.triangles.len(), NEVER);
        let corner = tile.corner.map(f64::from);
        let mut count = 0;
        for begin in (0..self.triangles.len()).step_by(LOT) {
            let end = self.triangles.len().min(begin + LOT);
            let mut are_several = [0; LOT];
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
                // If there are several, the first is used in their place.
                let only = usize::from(triangle.only) % (SIDE * SIDE);
                (points[0][at], points[1][at]) = (x[only], y[only]);
                are_several[at] = u32::from(triangle.only == SEVERAL);
            }
            let mut kept = 0;
            dispatch(SetUp {
                origin: corner,
                unit: pieces.unit,
                corners: &self.corners,
                functions: &mut self.functions[count..],
                points: &points,
                are_several: &are_several,
                kept: &mut kept,
            });
            // In place: triangles that are kept move to the front, in order.
            for at in begin..end {
                self.triangles[count] = self.triangles[at];
                count += (kept >> (at - begin) & 1) as usize;
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

    /// Calls `each` for each run of samples with the same nearest triangle, among the first `count`, with the triangle's index and the
    /// length of the run.
    #[inline(always)]
    pub fn each_run(&self, count: usize, mut each: impl FnMut(u32, usize)) {
        let all = &self.samples.nearest.as_flattened()[..count];
        let mut changes = [0; SAMPLES.div_ceil(u32::BITS as usize)];
        dispatch(Changes {
            nearest: &self.samples.nearest,
            changes: &mut changes,
        });
        // Without a comparison per sample, whose outcome no processor could predict.
        let mut begin = 0;
        for (first, mut bits) in (0..).step_by(u32::BITS as usize).zip(changes) {
            while bits != 0 {
                let at = first + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                if at < count {
                    each(all[begin], at - begin);
                    begin = at;
                }
            }
        }
        if begin < count {
            each(all[begin], count - begin);
        }
    }

    /// Sets the triangle that a sample sees.
    pub fn set_nearest(&mut self, sample: usize, triangle: u32) {
        self.samples.nearest[sample / LANES][sample % LANES] = triangle;
    }

    /// The index of the nearest among the triangles for which `is_there` holds, which is called at most once for each. In f64: for samples
    /// whose nearest triangle has a hole.
    #[cold]
    pub fn nearest_of(&self, sample: usize, mut is_there: impl FnMut(u32) -> bool) -> u32 {
        let of_sample = |blocks: &[Block<f32>]| blocks[sample / LANES][sample % LANES];
        let (x, y) = (of_sample(&self.samples.x), of_sample(&self.samples.y));
        let (mut nearest, mut depth) = (NOTHING, 0.0);
        for (index, of) in (0..).zip(&self.functions) {
            // Whether a sample is inside is decided in f32, as for coverage; which triangle is nearer, in f64.
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

/// The loop over samples that finds those whose triangle differs from that of the previous sample, as bits in their order.
struct Changes<'a> {
    nearest: &'a [Block<u32>; BLOCKS],
    changes: &'a mut [u32; SAMPLES.div_ceil(u32::BITS as usize)],
}

/// The maximum number of samples of a strip.
const SAMPLES: usize = BLOCKS * LANES;

impl VectorLoop for Changes<'_> {
    #[inline(always)]
    fn run(self) {
        const WORD: usize = u32::BITS as usize;
        let nearest: &[u32] = self.nearest.as_flattened();
        // The first sample has no predecessor.
        let mut before = nearest[0];
        for (own, bits) in nearest.chunks_exact(WORD).zip(self.changes) {
            // Each sample's predecessor; the first has the last sample of the word before.
            let mut shifted = [before; WORD];
            shifted[1..].copy_from_slice(&own[..WORD - 1]);
            let mut all = 0;
            for i in 0..WORD {
                all |= u32::from(own[i] != shifted[i]) << i;
            }
            before = own[WORD - 1];
            *bits = all;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
