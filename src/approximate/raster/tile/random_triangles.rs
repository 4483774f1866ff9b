//! Random triangles for tests of a tile.

use glam::DVec3;

use super::gather::Pieces;
use crate::approximate::raster::batch::{Batch, Bins, Grid, Piece, TileBatches};
use crate::approximate::raster::cull::ScreenBounds;
use crate::approximate::raster::vertices::Vertex;
use crate::render::film::Tile;

/// Numbers in [0, 1).
pub(super) struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = (self.0)
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The size of the film, pixels.
const SIZE: [u32; 2] = [64, 61];
/// A tile that is cut by the film's edge.
pub(super) const TILE_AT: Tile = Tile {
    corner: [32, 48],
    size: [16, 13],
};

/// Triangles that may reach the tile, in one batch.
pub(super) struct RandomTriangles {
    batches: [Batch; 1],
    by_tile: TileBatches,
    seen: [Vec<Vertex>; 1],
}

impl RandomTriangles {
    /// Creates `count` triangles: every `often`-th has a size of `large` pixels, the others of 0.7.
    pub fn new(random: &mut Random, count: u32, often: u32, large: f64) -> Self {
        let (mut seen, mut pieces) = (Vec::new(), Vec::new());
        for k in 0..count {
            let size = if k % often == 0 { large } else { 0.7 };
            let place = [32.0 + 16.0 * random.next(), 48.0 + 13.0 * random.next()];
            let points = [0; 3].map(|_| place.map(|x| x + size * (random.next() - 0.5)));
            let z = [(); 3].map(|()| 1.0 + random.next());
            let of = |axis: usize| points.map(|point| point[axis]);
            let least = |axis| of(axis).into_iter().fold(f64::INFINITY, f64::min) - 2e-5;
            let most = |axis| of(axis).into_iter().fold(0.0, f64::max) + 2e-5;
            let reach =
                ScreenBounds([least(0), least(1), most(0), most(1)].map(|x| x.max(0.0) as f32));
            pieces.push(Piece {
                corners: [0, 1, 2].map(|corner| 3 * k + corner),
                slot: k,
                reach,
                tile: reach.tile(SIZE),
            });
            seen.extend(points.iter().zip(z).map(|([x, y], z)| Vertex {
                film: DVec3::new(x * z, y * z, z),
                scale: 0.0,
            }));
        }
        let film = |piece: &Piece| piece.corners.map(|k| seen[k as usize].film);
        let batches = [Batch {
            frame: 0,
            shared: seen.len() as u32,
            cuts: Vec::new(),
            places: Vec::new(),
            bins: Bins::new(Grid { size: SIZE }, &pieces, film),
            pieces,
        }];
        RandomTriangles {
            by_tile: TileBatches::new(&batches, Tile::count(SIZE)),
            batches,
            seen: [seen],
        }
    }

    pub fn pieces(&self) -> Pieces<'_> {
        Pieces {
            size: SIZE,
            batches: &self.batches,
            by_tile: &self.by_tile,
            seen: &self.seen,
            unit: 2.0,
        }
    }
}
