//! All triangles of a scene, divided, moved to where they appear and sorted by tiles; and what they show.

use glam::DVec3;
use rayon::prelude::*;

use super::batch::{Batch, Grid};
use super::cull::Frustum;
use super::divide::{BatchBuilder, Cuts, Divider};
use super::draw::{RayBatch, ShadingRay, TileSamples, Visibility};
use super::method::{Attributes, Raster};
use super::tile::{NOTHING, SetupTriangle, TileBuffers};
use crate::accel::{Facing, Hit};
use crate::approximate::projection::{Observer, Projection};
use crate::error::{Error, Result};
use crate::render::film::Tile;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::{RestFrame, SurfaceHit};
use crate::spacetime::{Direction, Displacement};

/// All triangles of a scene in homogeneous film coordinates.
#[derive(Debug)]
pub(super) struct Triangles<'a> {
    size: [u32; 2],
    frames: &'a [RestFrame],
    projections: Vec<Projection<'a>>,
    batches: Vec<Batch>,
    attributes: Attributes,
}

impl<'a> Triangles<'a> {
    /// Divides the triangles of `scene` as `raster` says, moves them to their apparent positions and
    /// sorts them by tiles.
    pub fn new(
        scene: &'a Prepared,
        observer: &'a Observer,
        raster: &Raster,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let projections = scene.frames.iter().map(|f| observer.projection(&f.frame));
        let mut triangles = Triangles {
            size: scene.layout.size,
            frames: &scene.frames,
            projections: projections.collect::<Result<Vec<_>>>()?,
            batches: Vec::new(),
            attributes: raster.attributes,
        };
        let mut batches = Vec::new();
        let cuts = Cuts::default();
        for frame in 0..scene.frames.len() {
            batches.extend(triangles.divided(frame as u32, raster, &cuts, progress)?);
        }
        if cuts.are_too_many() {
            return Err(too_many());
        }
        triangles.batches = batches;
        Ok(triangles)
    }

    /// The batches of rest frame `frame`, in the order of its tree.
    fn divided(
        &self,
        frame: u32,
        raster: &Raster,
        cuts: &Cuts,
        progress: &dyn Progress,
    ) -> Result<Vec<Batch>> {
        let (rest, projection) = (
            &self.frames[frame as usize],
            &self.projections[frame as usize],
        );
        let frustum = Frustum::of(projection);
        let divider = Divider::new(projection, &frustum, raster.tessellation);
        let slots = rest.bvh.len() as u32;
        let run = (slots / 64).clamp(1, 4096);
        let batch = |k: u32| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let mut batch = BatchBuilder::new(frame, projection, raster.attributes, cuts);
            for slot in k * run..slots.min((k + 1) * run) {
                divide(rest, &divider, slot, &mut batch);
            }
            Ok(batch.finish(Grid { size: self.size }))
        };
        (0..slots.div_ceil(run))
            .into_par_iter()
            .map(batch)
            .collect()
    }

    /// Where triangle `triangle` is met at film point (x, y).
    #[inline]
    fn fragment(&self, triangle: &SetupTriangle, x: f64, y: f64) -> Fragment<'_> {
        let batch = &self.batches[triangle.batch as usize];
        let piece = &batch.triangles[triangle.piece as usize];
        // λ on the flat apparent triangle; with it the place on the surface, linearly in its rest frame.
        let lambda = triangle.weights(x, y);
        let corners = piece.corners.map(|v| batch.vertices[v as usize].weights);
        let [u, v] = [0, 1].map(|i| (0..3).map(|k| lambda[k] * corners[k][i]).sum());
        let rest = &self.frames[batch.frame as usize];
        let projection = &self.projections[batch.frame as usize];
        let [a, b, c] = rest.bvh.corners(piece.slot);
        let attributes = match self.attributes {
            Attributes::Fragment => None,
            Attributes::Vertex => {
                let known = piece.corners.map(|v| batch.attributes[v as usize]);
                Some([0, 1].map(|i| (0..3).map(|k| lambda[k] * known[k][i]).sum()))
            }
        };
        Fragment {
            frame: batch.frame,
            rest,
            projection,
            x: a + (b - a) * u + (c - a) * v,
            attributes,
            hit: Hit {
                s: 0.0,
                u,
                v,
                triangle: rest.bvh.triangle(piece.slot).0,
                slot: piece.slot,
                front: is_front([a, b, c], projection),
            },
        }
    }
}

fn too_many() -> Error {
    Error::unsupported(
        "command line",
        "--method",
        format!("triangles would be cut at more than {} points", Cuts::MOST),
        "a longer edge, or more pixels of error",
    )
}

/// Divides the triangle in `slot`, where the side that the camera is on is there.
fn divide(rest: &RestFrame, divider: &Divider, slot: u32, batch: &mut BatchBuilder) {
    let corners = rest.bvh.corners(slot);
    let (_, facing) = rest.bvh.triangle(slot);
    if facing == Facing::FrontOnly && !is_front(corners, divider.projection) {
        return;
    }
    batch.begin(slot);
    divider.divide(corners, batch);
}

/// Whether the camera is on the side from which the corners run counter-clockwise. Light goes straight in
/// the rest frame, so that this is exact, and the same for the whole triangle.
fn is_front([a, b, c]: [DVec3; 3], projection: &Projection) -> bool {
    (b - a).cross(c - a).dot(a - projection.origin()) < 0.0
}

/// A point of a triangle that a sample sees.
struct Fragment<'a> {
    frame: u32,
    rest: &'a RestFrame,
    projection: &'a Projection<'a>,
    /// In the rest frame, metres.
    x: DVec3,
    /// Time of emission relative to the shot in the rest frame, and W, where they are interpolated.
    attributes: Option<[f64; 2]>,
    /// All but s.
    hit: Hit,
}

impl Fragment<'_> {
    /// The ray that meets the point at its own event of emission, or at the one that is interpolated.
    #[inline]
    fn at_emission(&self, samples: &TileSamples, pixel: usize) -> Option<ShadingRay> {
        let hit = |s: f64| SurfaceHit {
            hit: Hit { s, ..self.hit },
            frame: self.frame,
        };
        let Some([time, w]) = self.attributes else {
            let image = self.projection.image(self.x)?;
            return Some(ShadingRay {
                d: image.d.unit(),
                delay: samples.index,
                ratio: samples.ratio(pixel, self.frame, image.d),
                hit: Some(hit(image.s)),
            });
        };
        let local = Displacement::new(time, self.x - self.projection.origin());
        let world = self.rest.frame.world_from_frame().displacement(local);
        let (s, d) = (world.x.length(), Direction::new(world.x)?);
        Some(ShadingRay {
            d: d.unit(),
            delay: -world.ct / s,
            ratio: samples.ratio_of(w, self.frame, d),
            hit: Some(hit(s)),
        })
    }
}

impl Visibility for Triangles<'_> {
    type TileBuffers = TileBuffers;

    fn begin(&self, tile: Tile, buffers: &mut TileBuffers) {
        buffers.gather(self.size, tile, &self.batches);
    }

    fn paint(
        &self,
        samples: &TileSamples,
        tile: Tile,
        buffers: &mut TileBuffers,
        rays: &mut RayBatch,
    ) {
        buffers.cover(tile, |pixel| samples.camera_rays.offset(pixel));
        for pixel in 0..tile.pixels() {
            rays.next_pixel();
            let nearest = buffers.nearest[pixel];
            let ray = (nearest != NOTHING).then(|| {
                let triangle = &buffers.triangles[nearest as usize];
                let fragment = self.fragment(triangle, buffers.x[pixel], buffers.y[pixel]);
                fragment.at_emission(samples, pixel)
            });
            let nothing = ShadingRay {
                d: samples.direction(pixel).unit(),
                delay: samples.index,
                ratio: 1.0,
                hit: None,
            };
            rays.add(ray.flatten().unwrap_or(nothing), 1.0);
        }
    }
}
