//! Which triangle each sample of a tile sees, and what it sees of it.

use super::draw::{RayBatch, StripSamples, Visibility};
use super::fragments::{Fragments, Surface};
use super::tile::{MOST_TOGETHER, NOTHING, TileBuffers, WHOLE};
use super::triangles::Triangles;
use crate::render::film::Tile;

/// What is reused from tile to tile.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    /// The tile that was begun last, and how many rows its strips have.
    tile: Option<(Tile, u32)>,
    triangles: TileBuffers,
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

    /// The index of that of triangle `index` of `triangles`, which are those of `tile`; none for no triangle.
    #[inline(always)]
    fn of(
        &mut self,
        all: &Triangles,
        tile: Tile,
        triangles: &TileBuffers,
        index: u32,
    ) -> Option<u32> {
        let known = self.seen_as.get_mut(index as usize)?;
        if *known == NOTHING {
            *known = self.surfaces.len() as u32;
            let triangle = &triangles.triangles[index as usize];
            self.surfaces.push(Surface::of(all, triangle, tile));
        }
        Some(*known)
    }
}

impl Visibility for Triangles<'_> {
    type TileBuffers = Buffers;

    fn has_own_delays(&self) -> bool {
        self.has_interpolated_attributes()
    }

    fn samples_at_once(&self) -> u32 {
        MOST_TOGETHER
    }

    fn begin(&self, tile: Tile, rows: u32, buffers: &mut Buffers) {
        buffers.triangles.start();
        buffers.tile = Some((tile, rows));
    }

    /// Which triangle each sample shows, by depth, and the fragments of these.
    fn paint(&self, samples: &StripSamples, buffers: &mut Buffers, rays: &mut RayBatch) {
        let Buffers {
            tile,
            triangles,
            seen,
            fragments,
        } = buffers;
        let Some((tile, rows)) = *tile else {
            return;
        };
        fragments.start(samples, self.needed, rays);
        let (x, y) = fragments.points_mut();
        let (pieces, strip) = (self.pieces(), &samples.strip);
        // Behind a hole any triangle may be seen.
        if strip.is_all_of(tile) && !self.has_holes {
            triangles.cover_tile(&pieces, tile, x, y);
            seen.start(triangles.triangles.len());
        } else {
            if triangles.complete(&pieces, tile, rows) {
                seen.start(triangles.triangles.len());
            }
            match strip.each.is_multiple_of(WHOLE) && !self.has_holes {
                true => {
                    triangles.cover_by_pixels(strip, x, y);
                    triangles.each_run_of_pixels(strip, |triangle, samples| {
                        let surface = seen.of(self, tile, triangles, triangle);
                        fragments.see(surface, samples);
                    });
                    return fragments.finish(self, samples, &seen.surfaces, rays);
                }
                false => triangles.cover(strip, x, y),
            }
        }
        let count = x.len();
        if self.has_holes {
            for (sample, (x, y)) in x.iter().zip(&*y).enumerate() {
                let mut is_opaque = |triangle: u32| {
                    let surface = seen.of(self, tile, triangles, triangle);
                    let surface = surface.map(|known| &seen.surfaces[known as usize]);
                    surface.is_some_and(|surface| surface.is_opaque(self, *x, *y))
                };
                let nearest = triangles.nearest()[sample];
                if nearest != NOTHING && !is_opaque(nearest) {
                    let behind = triangles.nearest_of(sample, is_opaque);
                    triangles.set_nearest(sample, behind);
                }
            }
        }
        // Samples in a row that see one triangle, or none, are one run.
        triangles.each_run(count, |triangle, samples| {
            let surface = seen.of(self, tile, triangles, triangle);
            fragments.see(surface, samples);
        });
        fragments.finish(self, samples, &seen.surfaces, rays);
    }
}
