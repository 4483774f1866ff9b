//! Which triangle each sample of a tile sees, and what it sees of it.

use super::draw::{RayBatch, TileSamples, Visibility};
use super::fragments::{Fragments, Surface};
use super::tile::{NOTHING, TileBuffers};
use super::triangles::Triangles;
use crate::render::film::Tile;

/// What is reused from tile to tile.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    tile: TileBuffers,
    seen: SeenSurfaces,
    fragments: Fragments,
}

/// The surfaces of a tile that samples see, set up once they are first asked for.
#[derive(Debug, Default)]
struct SeenSurfaces {
    /// By triangle of the tile, the index of its surface among `surfaces`, where it has been seen.
    seen_as: Vec<u32>,
    surfaces: Vec<Surface>,
}

impl SeenSurfaces {
    /// Forgets those of the last tile, and has none yet of `triangles`.
    fn start(&mut self, triangles: usize) {
        self.seen_as.clear();
        self.seen_as.resize(triangles, NOTHING);
        self.surfaces.clear();
    }

    /// That of triangle `index` of `triangles`, which are those of `tile`; none for no triangle.
    #[inline(always)]
    fn of(
        &mut self,
        all: &Triangles,
        tile: Tile,
        triangles: &TileBuffers,
        index: u32,
    ) -> Option<&Surface> {
        let known = self.seen_as.get_mut(index as usize)?;
        if *known == NOTHING {
            *known = self.surfaces.len() as u32;
            let triangle = &triangles.triangles[index as usize];
            self.surfaces.push(Surface::of(all, triangle, tile));
        }
        self.surfaces.get(*known as usize)
    }
}

impl Visibility for Triangles<'_> {
    type TileBuffers = Buffers;

    fn has_own_delays(&self) -> bool {
        self.has_interpolated_attributes()
    }

    fn begin(&self, tile: Tile, buffers: &mut Buffers) {
        let (batches, seen) = (&self.batches, &self.seen);
        buffers
            .tile
            .gather(self.size, tile, batches, seen, self.unit);
        buffers.seen.start(buffers.tile.triangles.len());
    }

    /// Which triangle each sample of the tile shows, by depth, and the fragments of these.
    fn paint(&self, samples: &TileSamples, tile: Tile, buffers: &mut Buffers, rays: &mut RayBatch) {
        let Buffers {
            tile: triangles,
            seen,
            fragments,
        } = buffers;
        triangles.cover(tile, |pixel| samples.camera_rays.offset(pixel));
        fragments.start();
        let [width, height] = tile.size.map(|n| n as usize);
        for row in 0..height {
            for column in 0..width {
                let [x, y] = samples.camera_rays.offset(row * width + column);
                let (x, y) = (column as f64 + x, row as f64 + y);
                let mut nearest = triangles.nearest(column, row);
                if self.has_holes {
                    let mut is_opaque = |triangle: u32| {
                        let surface = seen.of(self, tile, triangles, triangle);
                        surface.is_some_and(|surface| surface.is_opaque(self, x, y))
                    };
                    if nearest != NOTHING && !is_opaque(nearest) {
                        nearest = triangles.nearest_of(column, row, is_opaque);
                    }
                }
                let surface = seen.of(self, tile, triangles, nearest);
                fragments.add(surface, x, y, &mut rays.hits);
            }
        }
        fragments.finish(self, samples, rays);
    }
}
