//! All triangles of a scene, divided, moved to where they appear and sorted by tiles.

use glam::DVec3;
use rayon::prelude::*;

use super::batch::{Batch, Grid, Piece};
use super::cull::Frustum;
use super::divide::{BatchBuilder, Cuts, Divider, FrameVertices};
use super::draw::{RayBatch, TileSamples, Visibility};
use super::fragments::{Fragments, Surface};
use super::method::{Attributes, Raster, Tessellation};
use super::tile::{NOTHING, TileBuffers};
use super::vertices::{Vertex, transformed};
use crate::accel::Facing;
use crate::approximate::projection::{Observer, Projection};
use crate::error::Result;
use crate::render::film::Tile;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::RestFrame;

/// So many triangles make a batch, in scenes that have enough of them.
const BATCH: u32 = 4096;
/// So many batches a rest frame is divided into, where they are smaller.
const BATCHES: u32 = 16;

/// All triangles of a scene in homogeneous film coordinates.
#[derive(Debug)]
pub(super) struct Triangles<'a> {
    size: [u32; 2],
    pub frames: &'a [RestFrame],
    pub projections: Vec<Projection<'a>>,
    /// By rest frame, the vertices of its triangles.
    pub seen: Vec<Vec<Vertex>>,
    pub batches: Vec<Batch>,
    attributes: Attributes,
    /// What depths are measured in, metres: of the order of the farthest vertex.
    unit: f64,
}

impl<'a> Triangles<'a> {
    /// Whether times and wavelength ratios are interpolated between vertices.
    pub fn has_interpolated_attributes(&self) -> bool {
        self.attributes == Attributes::Vertex
    }

    /// Divides the triangles of `scene` as `raster` says, moves them to their apparent positions and
    /// sorts them by tiles.
    pub fn new(
        scene: &'a Prepared,
        observer: &'a Observer,
        raster: &Raster,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let projections = scene.frames.iter().map(|f| observer.projection(&f.frame));
        let projections = projections.collect::<Result<Vec<_>>>()?;
        let frames = &scene.frames;
        let seen = frames.iter().zip(&projections);
        let seen = seen.map(|(f, p)| transformed(p, &f.shared_vertices().positions));
        let seen: Vec<_> = seen.collect();
        let size = scene.layout.size;
        let cuts = Cuts::within(scene.memory_left);
        let mut batches = Vec::new();
        for (frame, (rest, projection)) in frames.iter().zip(&projections).enumerate() {
            let frustum = Frustum::of(projection);
            let divider = Divider {
                projection,
                frustum: &frustum,
                tessellation: raster.tessellation,
                vertices: FrameVertices {
                    shared: rest.shared_vertices(),
                    seen: &seen[frame],
                },
                cuts: &cuts,
            };
            batches.extend(divided(rest, frame as u32, &divider, size, progress)?);
        }
        if cuts.are_too_many() {
            return Err(cuts.refusal());
        }
        let all = seen.iter().flatten();
        let farthest = all.fold(0.0, |far: f64, vertex| far.max(vertex.film.z.abs()));
        Ok(Triangles {
            size,
            frames,
            projections,
            seen,
            batches,
            attributes: raster.attributes,
            unit: if farthest.is_normal() { farthest } else { 1.0 },
        })
    }
}

/// The batches of rest frame `frame`, in the order of its tree.
fn divided(
    rest: &RestFrame,
    frame: u32,
    divider: &Divider,
    size: [u32; 2],
    progress: &dyn Progress,
) -> Result<Vec<Batch>> {
    let slots = rest.bvh.len() as u32;
    let run = slots.div_ceil(BATCHES).clamp(256, BATCH);
    let begun = |k: u32| {
        progress.check()?;
        let mut batch = BatchBuilder::new(frame, divider);
        for slot in k * run..slots.min((k + 1) * run) {
            // Where the side that the camera is on is there.
            let (_, facing) = rest.bvh.triangle(slot);
            if facing == Facing::TwoSided || is_front(rest.bvh.corners(slot), divider.projection) {
                batch.add(slot);
            }
        }
        Ok(batch)
    };
    let finished = |batch: BatchBuilder| {
        progress.check()?;
        Ok(batch.finish(Grid { size }))
    };
    let batches = (0..slots.div_ceil(run)).into_par_iter().map(begun);
    if divider.tessellation == Tessellation::None {
        return batches.map(|batch| finished(batch?)).collect();
    }
    // What is going to be too much is not begun.
    let batches = batches.map(|batch| {
        let mut batch = batch?;
        batch.begin();
        Ok(batch)
    });
    let batches: Vec<_> = batches.collect::<Result<_>>()?;
    let more = batches.iter().map(BatchBuilder::forecast).sum();
    match divider.cuts.will_be_too_many(more) {
        true => Err(divider.cuts.refusal()),
        false => batches.into_par_iter().map(finished).collect(),
    }
}

/// What so many triangles and their distinct corners take without being cut, bytes: to the end, and until the film is
/// complete. Lists that grow may have twice the room that they need.
pub(super) fn bytes(triangles: u64, vertices: u64) -> [u64; 2] {
    // Places of corners and their indices stay with the rest frame; places are found in a table of as many triangles, whose
    // room is a power of two at most 8/7 full.
    let shared = (2 * 24 * vertices).saturating_add(12 * triangles);
    let table = 75 * triangles;
    // By triangle: its piece, its place in the level, its index in the tiles, and what a tile gathers of it.
    let pieces = 2 * size_of::<Piece>() as u64 + 2 * 16 + 8 + 96;
    let drawn = (size_of::<Vertex>() as u64 * vertices).saturating_add(pieces * triangles);
    [shared, table.max(drawn)]
}

/// Whether the camera is on the side from which the corners run counter-clockwise. Light goes straight in
/// the rest frame, so that this is exact, and the same for the whole triangle.
pub(super) fn is_front([a, b, c]: [DVec3; 3], projection: &Projection) -> bool {
    (b - a).cross(c - a).dot(a - projection.origin()) < 0.0
}

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
