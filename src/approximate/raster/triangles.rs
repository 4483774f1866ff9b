//! All triangles of a scene, divided, moved to their apparent positions and sorted by tiles.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::batch::{Batch, Grid, TileBatches};
use super::cull::{Frustum, SoleSamples};
use super::cuts::{Cuts, Outlook};
use super::divide::{BatchBuilder, Divider, FrameVertices};
use super::flatness::Straight;
use super::method::{Attributes, Raster, Tessellation};
use super::ratios::CameraRatios;
use super::tile::Pieces;
use super::vertices::{Vertex, transformed};
use crate::accel::Facing;
use crate::approximate::projection::{ApparentProjection, Observer, apart};
use crate::error::Result;
use crate::render::film::Tile;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::{Dependence, RestFrame};

/// The number of triangles of a batch in large scenes.
const BATCH: u32 = 4096;
/// The number of batches that a smaller rest frame is divided into.
const BATCHES: u32 = 16;
/// The minimum number of triangles of a batch, in rest frames that have that many.
const LEAST: u32 = 1024;

/// All triangles of a scene in homogeneous film coordinates.
#[derive(Debug)]
pub(super) struct Triangles<'a> {
    pub size: [u32; 2],
    pub frames: &'a [RestFrame],
    pub projections: Vec<ApparentProjection<'a>>,
    /// By rest frame, the vertices of its triangles.
    pub seen: Vec<Vec<Vertex>>,
    pub batches: Vec<Batch>,
    /// The batches by tile.
    pub by_tile: TileBatches,
    attributes: Attributes,
    /// W of samples.
    pub ratios: CameraRatios<'a>,
    /// The unit of depths, metres: about the distance of the farthest vertex.
    pub unit: f64,
    /// Whether some triangles have holes.
    pub has_holes: bool,
    /// What radiance, or a channel, depends on.
    pub needed: Dependence,
}

impl<'a> Triangles<'a> {
    /// Whether times and wavelength ratios are interpolated between vertices.
    pub fn has_interpolated_attributes(&self) -> bool {
        self.attributes == Attributes::Vertex
    }

    /// The bytes of its vertices and of its triangles, by tiles.
    pub fn bytes(&self) -> u64 {
        let seen = self.seen.iter().map(|seen| size_of_val::<[_]>(seen) as u64);
        let batches = self.batches.iter().map(Batch::bytes);
        seen.chain(batches).sum::<u64>() + self.by_tile.bytes()
    }

    /// The data from which tiles are painted.
    pub fn pieces(&self) -> Pieces<'_> {
        Pieces {
            size: self.size,
            batches: &self.batches,
            by_tile: &self.by_tile,
            seen: &self.seen,
            unit: self.unit,
        }
    }

    /// Divides the triangles of `scene` according to `raster`, moves them to their apparent positions and sorts them by tiles.
    pub fn new(
        scene: &'a Prepared,
        observer: &'a Observer,
        raster: &Raster,
        progress: &dyn Progress,
    ) -> Result<Self> {
        // First the apparent positions of all vertices, which triangles share.
        let projections = scene.frames.iter().map(|f| observer.projection(&f.frame));
        let projections = projections.collect::<Result<Vec<_>>>()?;
        let frames = &scene.frames;
        let seen = frames.iter().zip(&projections);
        let straight = straight(raster.tessellation);
        let seen = seen.map(|(f, p)| transformed(p, f.shared_vertices(), straight));
        let seen: Vec<_> = seen.collect();
        let size = scene.layout.size;
        // Triangles are cut until they are straight enough; one memory limit applies to all frames.
        let cuts = Cuts::within(scene.memory_left);
        let frusta: Vec<_> = projections.iter().map(Frustum::of).collect();
        // They take an eighth as long as a triangle that is sorted by tiles: too long if there are few triangles.
        let triangles: u64 = frames.iter().map(|rest| rest.bvh.len() as u64).sum();
        let pixels = size.map(u64::from).iter().product::<u64>();
        let samples = (scene.layout.samples == 1 && 4 * triangles >= pixels)
            .then(|| SoleSamples::new(&scene.sampler, size));
        let dividers = (0..frames.len()).map(|frame| Divider {
            projection: &projections[frame],
            frustum: &frusta[frame],
            tessellation: raster.tessellation,
            vertices: FrameVertices {
                shared: frames[frame].shared_vertices(),
                apparent: &seen[frame],
            },
            cuts: &cuts,
            samples: samples.as_ref(),
        });
        let dividers: Vec<_> = dividers.collect();
        let batches = divided(frames, &dividers, &cuts, size, progress)?;
        if cuts.are_too_many() {
            return Err(cuts.refusal());
        }
        // Depths in units of the farthest vertex are of the order of 1 in scenes of any size.
        let farthest = seen.iter().map(|seen| seen.farthest).fold(0.0, f64::max);
        let seen: Vec<_> = seen.into_iter().map(|seen| seen.all).collect();
        Ok(Triangles {
            size,
            frames,
            projections,
            seen,
            by_tile: TileBatches::new(&batches, Tile::count(size)),
            batches,
            attributes: raster.attributes,
            ratios: CameraRatios::of(&scene.camera).ok_or_else(apart)?,
            // If everything is at the camera's position, any unit will do.
            unit: if farthest.is_normal() { farthest } else { 1.0 },
            has_holes: frames.iter().any(|rest| rest.bvh.has_holes()),
            needed: needed(
                scene.light.radiance().dependence(),
                !scene.layout.channels.is_empty(),
                raster.attributes,
            ),
        })
    }
}

/// The batches of all rest frames, one frame after the other, in the order of their trees.
fn divided(
    frames: &[RestFrame],
    dividers: &[Divider],
    cuts: &Cuts,
    size: [u32; 2],
    progress: &dyn Progress,
) -> Result<Vec<Batch>> {
    let runs = frames.iter().enumerate().flat_map(|(frame, rest)| {
        let slots = rest.bvh.len() as u32;
        // Several batches to share among threads, none with too few triangles to be worth a task.
        let run = slots.div_ceil(BATCHES).clamp(LEAST, BATCH);
        (0..slots.div_ceil(run)).map(move |k| (frame, k * run..slots.min((k + 1) * run)))
    });
    let runs: Vec<_> = runs.collect();
    let begun = |(frame, slots): (usize, Range<u32>)| {
        progress.check()?;
        let (rest, divider) = (&frames[frame], &dividers[frame]);
        let mut batch = BatchBuilder::new(frame as u32, divider);
        // Only triangles whose side facing the camera is visible.
        batch.begin(slots, |slot| {
            let (_, facing) = rest.bvh.triangle(slot);
            facing == Facing::TwoSided || is_front(rest.bvh.corners(slot), divider.projection)
        });
        Ok(batch)
    };
    let finished = |batch: BatchBuilder| {
        progress.check()?;
        Ok(batch.finish(Grid { size }))
    };
    if (dividers.iter()).all(|divider| divider.tessellation == Tessellation::None) {
        return (runs.into_par_iter().map(|run| finished(begun(run)?))).collect();
    }
    // If the total for all frames would be too much, no frame is begun.
    let mut batches: Vec<_> = (runs.into_par_iter().map(begun)).collect::<Result<_>>()?;
    loop {
        progress.check()?;
        // In stopped batches some points are not at their apparent positions, so no forecast can be based on them.
        if cuts.are_too_many() {
            return Err(cuts.refusal());
        }
        let forecasts: Vec<f64> = batches.par_iter().map(BatchBuilder::forecast).collect();
        let left = batches.iter().map(BatchBuilder::triangles).sum();
        match cuts.outlook(forecasts.iter().sum(), left) {
            Outlook::TooMany => return Err(cuts.refusal()),
            Outlook::Uncertain if left > 0 => batches.par_iter_mut().for_each(BatchBuilder::deepen),
            _ => return batches.into_par_iter().map(finished).collect(),
        }
    }
}

/// What has to be known of each hit: what radiance depends on, or everything if there are channels or attributes of vertices.
fn needed(radiance: Dependence, has_channels: bool, attributes: Attributes) -> Dependence {
    match !has_channels && attributes == Attributes::Fragment {
        true => radiance,
        false => Dependence::Weights,
    }
}

/// The test of vertices for the edges that end there.
fn straight(tessellation: Tessellation) -> Straight {
    match tessellation {
        Tessellation::None => Straight::ALWAYS,
        // Only by length.
        Tessellation::Uniform(_) => Straight::NEVER,
        Tessellation::Adaptive(pixels) => Straight::within(pixels),
    }
}

/// Whether the camera is on the side from which the corners run counter-clockwise. Light travels in straight lines in the rest frame, so
/// this is exact, and the same for the whole triangle.
pub(super) fn is_front([a, b, c]: [DVec3; 3], projection: &ApparentProjection) -> bool {
    (b - a).cross(c - a).dot(a - projection.origin()) < 0.0
}

#[cfg(test)]
mod tests;
