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
    /// By triangle of the tile, the index of its surface among `surfaces`, where it has been seen.
    seen_as: Vec<u32>,
    surfaces: Vec<Surface>,
    fragments: Fragments,
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
        buffers.seen_as.clear();
        let triangles = buffers.tile.triangles.len();
        buffers.seen_as.resize(triangles, NOTHING);
        buffers.surfaces.clear();
    }

    /// Which triangle each sample of the tile shows, by depth, and the fragments of these.
    fn paint(&self, samples: &TileSamples, tile: Tile, buffers: &mut Buffers, rays: &mut RayBatch) {
        let Buffers {
            tile: triangles,
            seen_as,
            surfaces,
            fragments,
        } = buffers;
        triangles.cover(tile, |pixel| samples.camera_rays.offset(pixel));
        fragments.start();
        let [width, height] = tile.size.map(|n| n as usize);
        for row in 0..height {
            for column in 0..width {
                let nearest = triangles.nearest(column, row);
                let known = match seen_as.get_mut(nearest as usize) {
                    None => None,
                    Some(known) => {
                        // Its first visible sample sets a triangle up; hidden ones never are.
                        if *known == NOTHING {
                            *known = surfaces.len() as u32;
                            let triangle = &triangles.triangles[nearest as usize];
                            surfaces.push(Surface::of(self, triangle, tile));
                        }
                        Some(*known)
                    }
                };
                let surface = known.map(|known| &surfaces[known as usize]);
                let [x, y] = samples.camera_rays.offset(row * width + column);
                let (x, y) = (column as f64 + x, row as f64 + y);
                fragments.add(surface, x, y, &mut rays.hits);
            }
        }
        fragments.finish(self, samples, rays);
    }
}
