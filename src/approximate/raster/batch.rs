//! Triangles at their apparent positions, in batches: one for each run of triangles of a tree, with the tiles of the film that each can
//! reach.

use glam::DVec3;

use super::cull::ScreenBounds;
use super::vertices::Vertex;
use crate::render::film::TILE;

/// A small triangle, one of the tree's or a part of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    /// Its vertices: those of the frame, followed by the batch's own.
    pub corners: [u32; 3],
    /// The slot of the triangle that it is a part of.
    pub slot: u32,
    /// The part of the film that it can reach, and the only tile there, or [`ScreenBounds::SEVERAL`].
    pub reach: ScreenBounds,
    pub tile: u32,
}

/// Pieces of the triangles in some slots of a rest frame, by the tiles that they may reach.
#[derive(Debug)]
pub(super) struct Batch {
    /// Index of the rest frame.
    pub frame: u32,
    /// The number of vertices of the frame.
    pub shared: u32,
    /// Vertices at which triangles were cut, and their places, metres in the rest frame.
    pub cuts: Vec<Vertex>,
    pub places: Vec<DVec3>,
    pub pieces: Vec<Piece>,
    pub bins: Bins,
}

impl Batch {
    /// The bytes of its lists.
    pub fn bytes(&self) -> u64 {
        let lists = size_of_val::<[_]>(&self.cuts)
            + size_of_val::<[_]>(&self.places)
            + size_of_val::<[_]>(&self.pieces)
            + size_of_val::<[_]>(&self.bins.starts)
            + size_of_val::<[_]>(&self.bins.triangles);
        lists as u64
    }

    /// The corners of a piece, where `shared` are the vertices of its frame.
    #[inline(always)]
    pub fn corners<'a>(&'a self, shared: &'a [Vertex], piece: &Piece) -> [&'a Vertex; 3] {
        self.of_corners(shared, &self.cuts, piece)
    }

    /// Their places in the rest frame, where `shared` are those of the frame's vertices.
    #[inline(always)]
    pub fn places(&self, shared: &[DVec3], piece: &Piece) -> [DVec3; 3] {
        self.of_corners(shared, &self.places, piece).map(|x| *x)
    }

    #[inline(always)]
    fn of_corners<'a, T>(&self, shared: &'a [T], own: &'a [T], piece: &Piece) -> [&'a T; 3] {
        let of = |index: u32| match index.checked_sub(self.shared) {
            None => &shared[index as usize],
            Some(cut) => &own[cut as usize],
        };
        let [a, b, c] = piece.corners;
        [of(a), of(b), of(c)]
    }
}

/// Triangles by tile: a list of (tile, triangle) in compressed rows.
#[derive(Debug, Default)]
pub(super) struct Bins {
    /// The first tile with any triangles.
    first: u64,
    /// Where the rows of the tiles from `first` on begin, and where the last one ends.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

/// The film as a grid of tiles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// Columns and rows of pixels.
    pub size: [u32; 2],
}

impl Grid {
    /// The number of tiles in a row.
    fn across(self) -> u32 {
        self.size[0].div_ceil(TILE)
    }

    /// Calls `visit` with each tile that a triangle which reaches several may reach; `film` gives its corners.
    fn tiles(self, piece: &Piece, film: impl Fn(&Piece) -> [DVec3; 3], mut visit: impl FnMut(u32)) {
        let last = self.size.map(|n| n - 1);
        let [left, top, right, bottom] = piece.reach.pixels([0; 2], last).map(|p| p / TILE);
        // With only one or two tiles the edge functions are not worth evaluating.
        let many = (right - left + 1) * (bottom - top + 1) > 2;
        let edges = many.then(|| Edges::of(film(piece)));
        for row in top..=bottom {
            for column in left..=right {
                let corner = [column, row].map(|t| f64::from(t * TILE));
                if edges.as_ref().is_none_or(|e| e.reach(corner)) {
                    visit(row * self.across() + column);
                }
            }
        }
    }
}

/// The edge functions of a triangle, positive inside.
struct Edges([DVec3; 3]);

impl Edges {
    fn of([a, b, c]: [DVec3; 3]) -> Self {
        let e = [b.cross(c), c.cross(a), a.cross(b)];
        // D = h₀·e₀ has the sign of the orientation: with it all functions are positive inside, seen from either side.
        let sign = a.dot(e[0]).signum();
        Edges(e.map(|e| e * sign))
    }

    /// Whether the triangle may reach the tile with this upper left corner: none of the edges has all of
    /// it on its outer side.
    fn reach(&self, corner: [f64; 2]) -> bool {
        let size = f64::from(TILE);
        self.0.iter().all(|e| {
            // The corner of the tile at which the function is greatest.
            let x = corner[0] + if e.x > 0.0 { size } else { 0.0 };
            let y = corner[1] + if e.y > 0.0 { size } else { 0.0 };
            let terms = (e.x * x).abs() + (e.y * y).abs() + e.z.abs();
            // Three products and two sums are off by fewer than 16 eps of their terms (2e-15): 1e-14 is safe.
            e.x * x + e.y * y + e.z >= -1e-14 * terms
        })
    }
}

impl Bins {
    /// Sorts `triangles` by the tiles of `grid`; `film` gives their corners.
    pub fn new(grid: Grid, triangles: &[Piece], film: impl Fn(&Piece) -> [DVec3; 3]) -> Self {
        // For triangles that reach several tiles, those tiles with the triangle's index.
        let mut pairs = Vec::new();
        let (mut first, mut last) = (u32::MAX, 0);
        for (index, piece) in (0u32..).zip(triangles) {
            if piece.tile == ScreenBounds::SEVERAL {
                grid.tiles(piece, &film, |tile| {
                    first = first.min(tile);
                    last = last.max(tile);
                    pairs.push((tile, index));
                });
            } else {
                first = first.min(piece.tile);
                last = last.max(piece.tile);
            }
        }
        if first > last {
            return Bins::default();
        }
        // A counting sort, which keeps the order within a tile.
        let mut starts = vec![0; (last - first + 2) as usize];
        let only = triangles.iter().map(|piece| piece.tile);
        let only = only.filter(|tile| *tile != ScreenBounds::SEVERAL);
        for tile in only.chain(pairs.iter().map(|(tile, _)| *tile)) {
            starts[(tile - first + 1) as usize] += 1;
        }
        for at in 1..starts.len() {
            starts[at] += starts[at - 1];
        }
        let mut next = starts.clone();
        let mut sorted = vec![0; starts.last().map_or(0, |all| *all as usize)];
        let mut put = |tile: u32, index: u32| {
            let place = &mut next[(tile - first) as usize];
            sorted[*place as usize] = index;
            *place += 1;
        };
        // These are in the order of the pieces, like the others.
        let mut pairs = pairs.into_iter().peekable();
        for (index, piece) in (0..).zip(triangles) {
            if piece.tile != ScreenBounds::SEVERAL {
                put(piece.tile, index);
                continue;
            }
            while let Some((tile, _)) = pairs.next_if(|(_, own)| *own == index) {
                put(tile, index);
            }
        }
        Bins {
            first: first.into(),
            starts,
            triangles: sorted,
        }
    }

    /// The triangles that may reach the tile of this index.
    pub fn of(&self, tile: u64) -> &[u32] {
        let row = tile.checked_sub(self.first);
        let bounds = row.and_then(|row| self.starts.get(row as usize..row as usize + 2));
        let Some(&[start, end]) = bounds else {
            return &[];
        };
        &self.triangles[start as usize..end as usize]
    }
}

/// By tile, the batches with triangles that may reach it, in compressed rows.
#[derive(Debug, Default)]
pub(super) struct TileBatches {
    starts: Vec<u32>,
    batches: Vec<u32>,
}

impl TileBatches {
    /// Sorts `batches` by the tiles of an image with `tiles` tiles.
    pub fn new(batches: &[Batch], tiles: u64) -> Self {
        let mut starts = vec![0; tiles as usize + 1];
        for (_, tile) in reached(batches) {
            starts[tile as usize + 1] += 1;
        }
        for at in 1..starts.len() {
            starts[at] += starts[at - 1];
        }
        let mut next = starts.clone();
        let mut sorted = vec![0; starts.last().map_or(0, |all| *all as usize)];
        // As for triangles: by counting, so that the batches of a tile stay in order.
        for (batch, tile) in reached(batches) {
            let place = &mut next[tile as usize];
            sorted[*place as usize] = batch;
            *place += 1;
        }
        TileBatches {
            starts,
            batches: sorted,
        }
    }

    /// The bytes of its lists.
    pub fn bytes(&self) -> u64 {
        (size_of_val::<[_]>(&self.starts) + size_of_val::<[_]>(&self.batches)) as u64
    }

    /// The batches for the tile of this index, in order.
    pub fn of(&self, tile: u64) -> &[u32] {
        let [start, end] = [0, 1].map(|k| self.starts[tile as usize + k] as usize);
        &self.batches[start..end]
    }
}

/// All batches with the tiles that their triangles may reach.
fn reached(batches: &[Batch]) -> impl Iterator<Item = (u32, u64)> {
    (0..).zip(batches).flat_map(|(index, batch)| {
        let Bins { first, starts, .. } = &batch.bins;
        let rows = (*first..).zip(starts.windows(2));
        let full = rows.filter(|(_, row)| row[0] < row[1]);
        full.map(move |(tile, _)| (index, tile))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_know_the_batches_that_reach_them() {
        let batch = |first: u64, starts: &[u32]| Batch {
            frame: 0,
            shared: 0,
            cuts: Vec::new(),
            places: Vec::new(),
            pieces: Vec::new(),
            bins: Bins {
                first,
                starts: starts.to_vec(),
                triangles: vec![0; starts.last().map_or(0, |n| *n as usize)],
            },
        };
        // Tile 2 has no triangle; the second batch has none at all; the third only reaches tile 3.
        let batches = [batch(1, &[0, 2, 2, 5]), batch(0, &[]), batch(3, &[0, 1])];
        let by_tile = TileBatches::new(&batches, 5);
        let expected: [&[u32]; 5] = [&[], &[0], &[], &[0, 2], &[]];
        for (tile, expected) in (0..).zip(expected) {
            assert_eq!(by_tile.of(tile), expected, "tile {tile}");
        }
    }
}
