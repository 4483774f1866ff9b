//! All triangles of a scene, divided, moved to where they appear and sorted by tiles; and what they show.

use glam::DVec3;
use rayon::prelude::*;

use super::batch::{Batch, Cuts, Parts};
use super::bins::Grid;
use super::bundle::{Bundle, BundleRay};
use super::cull::Frustum;
use super::divide::Divider;
use super::draw::{Eye, Painter};
use super::tile::{Facet, NOTHING, Space};
use super::{Attributes, Raster};
use crate::accel::{Facing, Hit};
use crate::approximate::projection::{Observer, Sight};
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
    sights: Vec<Sight<'a>>,
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
        let sights = scene.frames.iter().map(|f| observer.sight(&f.frame));
        let mut triangles = Triangles {
            size: scene.layout.size,
            frames: &scene.frames,
            sights: sights.collect::<Result<Vec<_>>>()?,
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
        let (rest, sight) = (&self.frames[frame as usize], &self.sights[frame as usize]);
        let frustum = Frustum::of(sight);
        let divider = Divider::new(sight, &frustum, raster.tessellation);
        let slots = rest.bvh.len() as u32;
        let run = (slots / 64).clamp(1, 4096);
        let batch = |k: u32| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let mut parts = Parts::new(frame, sight, raster.attributes, cuts);
            for slot in k * run..slots.min((k + 1) * run) {
                divide(rest, &divider, slot, &mut parts);
            }
            Ok(parts.finish(Grid { size: self.size }))
        };
        (0..slots.div_ceil(run))
            .into_par_iter()
            .map(batch)
            .collect()
    }

    /// Where facet `facet` is met at film point (x, y).
    #[inline]
    fn met(&self, facet: &Facet, x: f64, y: f64) -> Met<'_> {
        let batch = &self.batches[facet.batch as usize];
        let small = &batch.triangles[facet.triangle as usize];
        let lambda = facet.weights(x, y);
        let corners = small.corners.map(|v| batch.vertices[v as usize].weights);
        let [u, v] = [0, 1].map(|i| (0..3).map(|k| lambda[k] * corners[k][i]).sum());
        let rest = &self.frames[batch.frame as usize];
        let sight = &self.sights[batch.frame as usize];
        let [a, b, c] = rest.bvh.corners(small.slot);
        let attributes = match self.attributes {
            Attributes::Fragment => None,
            Attributes::Vertex => {
                let known = small.corners.map(|v| batch.attributes[v as usize]);
                Some([0, 1].map(|i| (0..3).map(|k| lambda[k] * known[k][i]).sum()))
            }
        };
        Met {
            frame: batch.frame,
            rest,
            sight,
            x: a + (b - a) * u + (c - a) * v,
            attributes,
            hit: Hit {
                s: 0.0,
                u,
                v,
                triangle: rest.bvh.triangle(small.slot).0,
                slot: small.slot,
                front: is_front([a, b, c], sight),
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
fn divide(rest: &RestFrame, divider: &Divider, slot: u32, parts: &mut Parts) {
    let corners = rest.bvh.corners(slot);
    let (_, facing) = rest.bvh.triangle(slot);
    if facing == Facing::FrontOnly && !is_front(corners, divider.sight) {
        return;
    }
    parts.begin(slot);
    divider.divide(corners, parts);
}

/// Whether the camera is on the side from which the corners run counter-clockwise. Light goes straight in
/// the rest frame, so that this is exact, and the same for the whole triangle.
fn is_front([a, b, c]: [DVec3; 3], sight: &Sight) -> bool {
    (b - a).cross(c - a).dot(a - sight.origin()) < 0.0
}

/// A point of a triangle that a sample sees.
struct Met<'a> {
    frame: u32,
    rest: &'a RestFrame,
    sight: &'a Sight<'a>,
    /// In the rest frame, metres.
    x: DVec3,
    /// Time of emission relative to the shot in the rest frame, and W, where they are interpolated.
    attributes: Option<[f64; 2]>,
    /// All but s.
    hit: Hit,
}

impl Met<'_> {
    /// The ray that meets the point at its own event of emission, or at the one that is interpolated.
    #[inline]
    fn at_emission(&self, eye: &Eye, pixel: usize) -> Option<BundleRay> {
        let hit = |s: f64| SurfaceHit {
            hit: Hit { s, ..self.hit },
            frame: self.frame,
        };
        let Some([time, w]) = self.attributes else {
            let image = self.sight.image(self.x)?;
            return Some(BundleRay {
                d: image.d.unit(),
                delay: eye.index,
                ratio: eye.ratio(pixel, self.frame, image.d),
                hit: Some(hit(image.s)),
            });
        };
        let local = Displacement::new(time, self.x - self.sight.origin());
        let world = self.rest.frame.world_from_frame().displacement(local);
        let (s, d) = (world.x.length(), Direction::new(world.x)?);
        Some(BundleRay {
            d: d.unit(),
            delay: -world.ct / s,
            ratio: eye.ratio_of(w, self.frame, d),
            hit: Some(hit(s)),
        })
    }
}

impl Painter for Triangles<'_> {
    type Space = Space;

    fn begin(&self, tile: Tile, space: &mut Space) {
        space.gather(self.size, tile, &self.batches);
    }

    fn paint(&self, eye: &Eye, tile: Tile, space: &mut Space, bundle: &mut Bundle) {
        space.cover(tile, |pixel| eye.camera_rays.offset(pixel));
        for pixel in 0..tile.pixels() {
            bundle.next_pixel();
            let nearest = space.nearest[pixel];
            let seeing = (nearest != NOTHING).then(|| {
                let facet = &space.facets[nearest as usize];
                let met = self.met(facet, space.x[pixel], space.y[pixel]);
                met.at_emission(eye, pixel)
            });
            let nothing = BundleRay {
                d: eye.direction(pixel).unit(),
                delay: eye.index,
                ratio: 1.0,
                hit: None,
            };
            bundle.add(seeing.flatten().unwrap_or(nothing), 1.0);
        }
    }
}
