//! The triangles that may reach a tile, and those that may reach each of its strips.

use super::setup::SIDE;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::approximate::raster::batch::{Batch, TileBatches};
use crate::approximate::raster::cull::{ScreenBounds, whole};
use crate::approximate::raster::vertices::Vertex;
use crate::render::film::Tile;

/// A piece of a batch that may reach the tile.
#[derive(Debug, Clone, Copy)]
pub struct Gathered {
    /// Index of the batch, and of the piece in it.
    pub batch: u32,
    pub piece: u32,
    /// Pixels of the tile: first column and row, last column and row.
    pub(super) pixels: [u8; 4],
    /// The only sample that it may contain, or [`SEVERAL`].
    pub(super) only: u16,
}

/// For a triangle that may contain more than one sample, or that has not been tested.
pub(super) const SEVERAL: u16 = u16::MAX;

/// All pieces, their vertices, and the unit of depths, metres.
#[derive(Debug, Clone, Copy)]
pub struct Pieces<'a> {
    /// The size of the film, pixels.
    pub size: [u32; 2],
    pub batches: &'a [Batch],
    /// The batches by tile.
    pub by_tile: &'a TileBatches,
    /// By rest frame.
    pub seen: &'a [Vec<Vertex>],
    pub unit: f64,
}

/// The triangles that may reach each strip of a tile, in compressed rows.
#[derive(Debug, Default)]
pub(super) struct StripLists {
    /// The number of pixel rows of each strip.
    rows: usize,
    starts: Vec<u32>,
    triangles: Vec<u32>,
    /// The index for the next triangle of each strip while the lists are filled.
    next: Vec<u32>,
}

impl StripLists {
    /// Sorts `triangles` by the strips of `rows` rows that they may reach; keeps their order within a strip.
    pub fn fill(&mut self, triangles: &[Gathered], rows: usize) {
        let strips = |triangle: &Gathered| {
            let [_, top, _, bottom] = triangle.pixels.map(usize::from);
            top / rows..=bottom / rows
        };
        self.rows = rows;
        // By counting: the length of each list, where it begins, then the triangles in their order.
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
    pub fn of(&self, row: usize) -> &[u32] {
        let strip = row / self.rows;
        let [start, end] = [0, 1].map(|k| self.starts[strip + k] as usize);
        &self.triangles[start..end]
    }
}

/// The number of triangles that are tested together.
const LOT: usize = 32;

/// Triangles that may reach a tile.
struct Asked {
    /// The part of the film that they reach: left, top, right, bottom.
    reach: [[f32; LOT]; 4],
    /// First column and row, last column and row in the tile.
    pixels: [[u32; LOT]; 4],
    /// The only sample that they may contain, [`SEVERAL`] or [`NONE`].
    only: [u32; LOT],
}

/// For a triangle that contains no sample.
const NONE: u16 = SEVERAL - 1;

/// The loop over triangles that finds their pixels, and the samples that they may contain.
struct Ask<'a> {
    lot: &'a mut Asked,
    tile: Tile,
    /// The position of the only sample of each pixel, pixels from the corner of the tile.
    samples: Option<[&'a [f32; SIDE * SIDE]; 2]>,
}

impl VectorLoop for Ask<'_> {
    #[inline(always)]
    fn run(self) {
        let Asked {
            reach,
            pixels,
            only,
        } = self.lot;
        let Tile { corner, size } = self.tile;
        // Exact: whole numbers are subtracted from multiples of the last digit of larger numbers.
        for (k, (reach, pixels)) in reach.iter_mut().zip(&mut *pixels).enumerate() {
            let (first, last) = (corner[k % 2] as f32, (size[k % 2] - 1) as f32);
            for at in 0..LOT {
                reach[at] -= first;
                pixels[at] = whole(reach[at].max(0.0).min(last));
            }
        }
        let Some([x, y]) = self.samples else {
            return only.fill(SEVERAL.into());
        };
        let ([from_x, from_y, to_x, to_y], width) = (&*reach, size[0]);
        let [columns, rows, last_columns, last_rows] = &*pixels;
        // Not written directly to a slice that might alias an input, which would keep the loop from vectorizing.
        let mut found = [0; LOT];
        for at in 0..LOT {
            let (column, row) = (columns[at], rows[at]);
            let (wide, high) = (last_columns[at] - column, last_rows[at] - row);
            let first = row * width + column;
            let bounds = [from_x[at], from_y[at], to_x[at], to_y[at]];
            // Which of up to four samples are inside.
            let (is_wide, is_high) = (wide != 0, high != 0);
            let a = u32::from(holds([x, y], first, bounds));
            let b = u32::from(is_wide & holds([x, y], first + 1, bounds));
            let c = u32::from(is_high & holds([x, y], first + width, bounds));
            let d = u32::from(is_wide & is_high & holds([x, y], first + width + 1, bounds));
            // The one that is inside, if there is exactly one.
            let one = first + (b | d) + (c | d) * width;
            let count = a + b + c + d;
            let of_few = if count == 0 { NONE.into() } else { one };
            let is_several = (count > 1) | (wide > 1) | (high > 1);
            found[at] = if is_several { SEVERAL.into() } else { of_few };
        }
        *only = found;
    }
}

/// Whether the sample of a pixel is within these bounds.
#[inline(always)]
fn holds(
    [x, y]: [&[f32; SIDE * SIDE]; 2],
    pixel: u32,
    [from_x, from_y, to_x, to_y]: [f32; 4],
) -> bool {
    // All pixels that are requested exist.
    let pixel = pixel as usize % (SIDE * SIDE);
    let (x, y) = (x[pixel], y[pixel]);
    (x >= from_x) & (x <= to_x) & (y >= from_y) & (y <= to_y)
}

/// Gathers the triangles that may reach `tile`; with one sample per pixel, only those that may contain one of these `samples`.
pub(super) fn gather(
    triangles: &mut Vec<Gathered>,
    pieces: &Pieces,
    tile: Tile,
    samples: Option<[&[f32; SIDE * SIDE]; 2]>,
) {
    triangles.clear();
    let mut lot = Asked {
        reach: [[0.0; LOT]; 4],
        pixels: [[0; LOT]; 4],
        only: [0; LOT],
    };
    // The triangles that may reach the tile, with the pixels that they may cover in it.
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
        for own in own.chunks(LOT) {
            for (at, piece) in own.iter().enumerate() {
                let ScreenBounds(reach) = batch.pieces[*piece as usize].reach;
                for (to, bound) in lot.reach.iter_mut().zip(reach) {
                    to[at] = bound;
                }
            }
            dispatch(Ask {
                lot: &mut lot,
                tile,
                samples,
            });
            for (k, &piece) in own.iter().enumerate() {
                let only = lot.only[k] as u16;
                // Without a branch, which no processor could predict. A tile is less than 256 pixels wide.
                triangles[count] = Gathered {
                    batch: at,
                    piece,
                    pixels: lot.pixels.each_ref().map(|pixels| pixels[k] as u8),
                    only,
                };
                count += usize::from(only != NONE);
            }
        }
        triangles.truncate(count);
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
            only: SEVERAL,
        };
        let spans = [[0, 15], [4, 4], [15, 15], [0, 0], [3, 5], [14, 15], [7, 8]];
        let triangles = spans.map(rows);
        for height in [1, 2, 3, 5, 8, 16] {
            let mut lists = StripLists::default();
            // Filling again clears the previous lists.
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
