//! Image-based warping: a picture in all directions by a camera at rest at the event of the shot, looked up by the aberrated directions
//! of a moving camera.
//!
//! The map stores hits, not their radiance: that is computed where it is looked up, by the ray tracer's own code. The event is the same,
//! so times of emission are right whatever the camera's velocity.

use glam::DVec3;
use rayon::prelude::*;

use super::draw::{RayBatch, StripSamples, Visibility};
use super::method::{Lookup, Map, Warp, moves};
use crate::accel::Traversal;
use crate::error::Result;
use crate::render::film::Tile;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::{HitBuffer, Meter, Rays, SurfaceHit, Surfaces};
use crate::spacetime::Direction;

/// Texels of one batch of rays: part of a row, which is coherent.
const RUN: usize = 256;
/// The memory of a texel.
pub(super) const TEXEL_BYTES: u64 = size_of::<Option<SurfaceHit>>() as u64;

/// The hits in all directions from the event of the shot.
#[derive(Debug)]
pub(super) struct Warped {
    map: Map,
    lookup: Lookup,
    texels: Vec<Option<SurfaceHit>>,
}

impl Warped {
    /// The bytes of its texels.
    pub fn bytes(&self) -> u64 {
        size_of_val::<[_]>(&self.texels) as u64
    }

    /// Traces all texels of the map of `warp`.
    pub fn new(scene: &Prepared, warp: &Warp, progress: &dyn Progress) -> Result<Self> {
        let moving = scene.frames.iter().find(|f| !f.frame.velocity().is_rest());
        if let Some(frame) = moving {
            let object = frame.patches.first().map_or(0, |p| p.object);
            return Err(moves("scene", &format!("object {object}")));
        }
        let map = warp.map;
        let event_in = |frame: &_| scene.camera.shot.event_in(frame);
        let surfaces = Surfaces::unbuffered(&scene.frames, event_in, scene.ray_index);
        let mut texels = vec![None; map.texels() as usize];
        let runs = texels.par_chunks_mut(RUN).enumerate();
        runs.try_for_each_init(HitBuffer::default, |hits, (run, texels)| -> Result<()> {
            progress.check()?;
            let first = (run * RUN) as u64;
            let directions = (first..).map(|t| map.direction(t)).take(texels.len());
            let directions: Vec<_> = directions.collect();
            fill(texels, &directions, &surfaces, scene.method, hits);
            Ok(())
        })?;
        Ok(Warped {
            map,
            lookup: warp.lookup,
            texels,
        })
    }
}

/// Finds the hits of `texels` in these directions.
fn fill(
    texels: &mut [Option<SurfaceHit>],
    directions: &[DVec3],
    surfaces: &Surfaces,
    method: Traversal,
    hits: &mut HitBuffer,
) {
    let rays = Rays::from_shot(directions, method);
    surfaces.nearest(&rays, hits, &mut Meter::off());
    for (ray, texel) in texels.iter_mut().enumerate() {
        *texel = hits.hit(ray);
    }
}

impl Visibility for Warped {
    type TileBuffers = ();

    fn begin(&self, _: Tile, _: u32, (): &mut ()) {}

    fn paint(&self, samples: &StripSamples, (): &mut (), rays: &mut RayBatch) {
        for sample in 0..samples.strip.samples() {
            rays.next_sample();
            let direction = samples.direction(sample).unit();
            let taps = self.map.taps(self.lookup, direction);
            for (texel, part) in taps.into_iter().filter(|tap| tap.1 > 0.0) {
                let hit = self.texels[texel as usize];
                // Along the texel's direction, where its hit lies; its W is that of the sample's own direction.
                let d = Direction::from_unit(self.map.direction(texel.into()));
                let ratio = match hit {
                    Some(hit) => samples.ratio(sample, hit.frame, d),
                    None => samples.world_ratio(sample),
                };
                rays.add(d.unit(), ratio, hit, part);
            }
        }
    }
}
