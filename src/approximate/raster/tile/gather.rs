//! The triangles that may reach a tile, and those of them that may reach each of its strips.

use super::setup::SIDE;
use crate::approximate::raster::batch::{Batch, TileBatches};
use crate::approximate::raster::cull::Reach;
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
    /// The only sample that it may hold, or [`SEVERAL`].
    pub(super) only: u16,
}

/// Of a triangle that may hold more than one sample, or of which that has not been asked.
pub(super) const SEVERAL: u16 = u16::MAX;

/// All pieces, where their vertices are, and the length that depths are measured in, metres.
#[derive(Debug, Clone, Copy)]
pub struct Pieces<'a> {
    /// Of the film, pixels.
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
    /// Rows of pixels of each.
    rows: usize,
    starts: Vec<u32>,
    triangles: Vec<u32>,
    /// Where the next triangle of each goes, while they are filled.
    next: Vec<u32>,
}

impl StripLists {
    /// Sorts `triangles` by the strips of `rows` rows that they may reach, and leaves them in order.
    pub fn fill(&mut self, triangles: &[Gathered], rows: usize) {
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
    pub fn of(&self, row: usize) -> &[u32] {
        let strip = row / self.rows;
        let [start, end] = [0, 1].map(|k| self.starts[strip + k] as usize);
        &self.triangles[start..end]
    }
}

/// Gathers those triangles that may reach `tile` and of which `holds` says what their only sample is, with their reach and their pixels.
#[inline(always)]
pub(super) fn gather(
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
