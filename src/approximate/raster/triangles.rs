//! All triangles of a scene, divided, moved to where they appear and sorted by tiles.

use glam::DVec3;
use rayon::prelude::*;

use super::batch::{Batch, Grid};
use super::cull::Frustum;
use super::divide::{BatchBuilder, Cuts, Divider, FrameVertices, Outlook};
use super::method::{Attributes, Raster, Tessellation};
use super::vertices::{Vertex, transformed};
use crate::accel::Facing;
use crate::approximate::projection::{Observer, Projection};
use crate::error::Result;
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
    pub size: [u32; 2],
    pub frames: &'a [RestFrame],
    pub projections: Vec<Projection<'a>>,
    /// By rest frame, the vertices of its triangles.
    pub seen: Vec<Vec<Vertex>>,
    pub batches: Vec<Batch>,
    attributes: Attributes,
    /// What depths are measured in, metres: of the order of the farthest vertex.
    pub unit: f64,
    /// Whether some have holes.
    pub has_holes: bool,
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
        // Apparent places of all vertices first, as triangles share them.
        let projections = scene.frames.iter().map(|f| observer.projection(&f.frame));
        let projections = projections.collect::<Result<Vec<_>>>()?;
        let frames = &scene.frames;
        let seen = frames.iter().zip(&projections);
        let seen = seen.map(|(f, p)| transformed(p, &f.shared_vertices().positions));
        let seen: Vec<_> = seen.collect();
        let size = scene.layout.size;
        // Triangles are cut until they are straight enough; one limit of memory for all frames.
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
        // Depths in units of the farthest vertex are of the order of 1 in scenes of any size.
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
            has_holes: frames.iter().any(|rest| rest.bvh.has_holes()),
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
    let mut batches: Vec<_> = batches.collect::<Result<_>>()?;
    loop {
        progress.check()?;
        let forecasts: Vec<f64> = batches.par_iter().map(BatchBuilder::forecast).collect();
        let left = batches.iter().map(BatchBuilder::triangles).sum();
        match divider.cuts.outlook(forecasts.iter().sum(), left) {
            Outlook::TooMany => return Err(divider.cuts.refusal()),
            Outlook::Uncertain if left > 0 => batches.par_iter_mut().for_each(BatchBuilder::deepen),
            _ => return batches.into_par_iter().map(finished).collect(),
        }
    }
}

/// Whether the camera is on the side from which the corners run counter-clockwise. Light goes straight in
/// the rest frame, so that this is exact, and the same for the whole triangle.
pub(super) fn is_front([a, b, c]: [DVec3; 3], projection: &Projection) -> bool {
    (b - a).cross(c - a).dot(a - projection.origin()) < 0.0
}
