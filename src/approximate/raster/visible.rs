//! The visible triangle of each sample of a tile, and the visible point on it.

use super::draw::{RayBatch, StripSamples, Visibility};
use super::fragments::Fragments;
use super::surfaces::{Surface, SurfaceLots};
use super::tile::{MOST_TOGETHER, NOTHING, TileBuffers, WHOLE};
use super::triangles::Triangles;
use crate::render::film::Tile;
use crate::render::trace::Dependence;

/// Buffers that are reused from tile to tile.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    /// The current tile, and the number of rows of its strips.
    tile: Option<(Tile, u32)>,
    triangles: TileBuffers,
    visible: VisibleSurfaces,
    fragments: Fragments,
}

/// The visible surfaces of a tile, set up when they are first needed.
#[derive(Debug, Default)]
struct VisibleSurfaces {
    /// By triangle of the tile, the index of its surface if it is visible.
    seen_as: Vec<u32>,
    /// By surface, its triangle; and the surfaces that are set up, which are the first of these.
    triangles: Vec<u32>,
    surfaces: SurfaceLots,
}

impl VisibleSurfaces {
    /// Clears the surfaces of the last tile; none of `triangles` has a surface yet.
    fn start(&mut self, triangles: usize) {
        self.seen_as.clear();
        self.seen_as.resize(triangles, NOTHING);
        self.triangles.clear();
        self.surfaces.all.clear();
    }

    /// The index of the surface of triangle `index`; `None` if there is no such triangle.
    #[inline(always)]
    fn of(&mut self, index: u32) -> Option<u32> {
        let known = self.seen_as.get_mut(index as usize)?;
        if *known == NOTHING {
            *known = self.triangles.len() as u32;
            self.triangles.push(index);
        }
        Some(*known)
    }

    /// All surfaces; sets up those requested since the last call. Their triangles are `triangles` of `tile`.
    fn complete(&mut self, all: &Triangles, tile: Tile, triangles: &TileBuffers) -> &[Surface] {
        // Surfaces are set up in the order in which they were requested: the new ones are at the end.
        let known = self.surfaces.all.len();
        let new = &self.triangles[known..];
        (self.surfaces).add(all, tile, &triangles.triangles, new);
        &self.surfaces.all
    }
}

impl Visibility for Triangles<'_> {
    type TileBuffers = Buffers;

    fn has_own_delays(&self) -> bool {
        self.has_interpolated_attributes()
    }

    fn turns_rays(&self) -> bool {
        self.needed > Dependence::Patch
    }

    fn samples_at_once(&self) -> u32 {
        MOST_TOGETHER
    }

    fn begin(&self, tile: Tile, rows: u32, buffers: &mut Buffers) {
        buffers.triangles.start();
        buffers.tile = Some((tile, rows));
    }

    /// Finds the triangle that each sample sees, by depth, and its fragments.
    fn paint(&self, samples: &StripSamples, buffers: &mut Buffers, rays: &mut RayBatch) {
        let Buffers {
            tile,
            triangles,
            visible,
            fragments,
        } = buffers;
        let Some((tile, rows)) = *tile else {
            return;
        };
        fragments.start(samples, self.needed, rays);
        let (x, y) = fragments.points_mut();
        let (pieces, strip) = (self.pieces(), &samples.strip);
        // Any triangle may be visible through a hole.
        if strip.is_all_of(tile) && !self.has_holes {
            triangles.cover_tile(&pieces, tile, x, y);
            visible.start(triangles.triangles.len());
        } else {
            if triangles.complete(&pieces, tile, rows) {
                visible.start(triangles.triangles.len());
            }
            match strip.each.is_multiple_of(WHOLE) && !self.has_holes {
                true => {
                    triangles.cover_by_pixels(strip, x, y);
                    triangles.each_run_of_pixels(strip, |triangle, samples| {
                        fragments.see(visible.of(triangle), samples);
                    });
                    let surfaces = visible.complete(self, tile, triangles);
                    return fragments.finish(self, samples, surfaces, rays);
                }
                false => triangles.cover(strip, x, y),
            }
        }
        // Through a hole the nearest opaque triangle behind it is seen.
        let count = x.len();
        if self.has_holes {
            for (sample, (x, y)) in x.iter().zip(&*y).enumerate() {
                let mut is_opaque = |triangle: u32| {
                    let known = visible.of(triangle);
                    let surfaces = visible.complete(self, tile, triangles);
                    let surface = known.map(|known| &surfaces[known as usize]);
                    surface.is_some_and(|surface| surface.is_opaque(self, *x, *y))
                };
                let nearest = triangles.nearest()[sample];
                if nearest != NOTHING && !is_opaque(nearest) {
                    let behind = triangles.nearest_of(sample, is_opaque);
                    triangles.set_nearest(sample, behind);
                }
            }
        }
        // Consecutive samples that see the same triangle, or none, are one run.
        triangles.each_run(count, |triangle, samples| {
            fragments.see(visible.of(triangle), samples);
        });
        let surfaces = visible.complete(self, tile, triangles);
        fragments.finish(self, samples, surfaces, rays);
    }
}
