//! Image-space warping: what a camera at rest sees from the event of the shot, in all directions, looked up
//! by the aberrated directions of a camera in motion.
//!
//! The map holds what is met, not its radiance: that is worked out where it is looked up, by the ray
//! tracer's own code. The event is the same, so that times of emission are right whatever the camera's
//! velocity.

use glam::DVec3;
use rayon::prelude::*;

use super::draw::{Brush, Painter};
use super::{Lookup, Map, Warp, moves};
use crate::camera::{Together, View};
use crate::error::{Error, Result};
use crate::film::Tile;
use crate::prepare::Prepared;
use crate::progress::Progress;
use crate::spacetime::Direction;
use crate::time_texture::Coverage;
use crate::trace::{Found, Frames, Observed, Radiance, Rays, Recorder, Scratch, Seen, Surfaces};

/// Texels of one batch of rays: part of a row, which is coherent.
const RUN: u64 = 256;

/// What is met in all directions from the event of the shot.
#[derive(Debug)]
pub(super) struct Warped {
    map: Map,
    lookup: Lookup,
    texels: Vec<Option<Found>>,
}

impl Warped {
    /// Traces all texels of the map that `warp` asks for.
    pub fn new(scene: &Prepared, warp: &Warp, progress: &dyn Progress) -> Result<Self> {
        let moving = scene.frames.iter().find(|f| !f.frame.velocity().is_rest());
        if let Some(frame) = moving {
            let object = frame.patches.first().map_or(0, |p| p.object);
            return Err(moves(&format!("object {object}")));
        }
        let map = warp.map;
        let event = scene.camera.shot.event;
        let surfaces = Frames::new(&scene.frames, event, scene.ray_index);
        let runs = map.texels().div_ceil(RUN);
        let texels = (0..runs)
            .into_par_iter()
            .map_init(Scratch::default, |scratch, run| {
                if progress.is_cancelled() {
                    return Err(Error::Cancelled);
                }
                let texels = run * RUN..map.texels().min((run + 1) * RUN);
                Ok(met(&surfaces, texels.map(|t| map.direction(t)), scratch))
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(Warped {
            map,
            lookup: warp.lookup,
            texels: texels.into_iter().flatten().collect(),
        })
    }
}

fn met(
    surfaces: &Frames,
    directions: impl Iterator<Item = DVec3>,
    scratch: &mut Scratch,
) -> Vec<Option<Found>> {
    let directions: Vec<_> = directions.map(Direction::from_unit).collect();
    let from = vec![Together; directions.len()];
    let rays = Rays {
        directions: &directions,
        from: &from,
    };
    surfaces.nearest(rays, scratch);
    (0..directions.len())
        .map(|ray| scratch.found(ray))
        .collect()
}

impl Painter for Warped {
    type Space = ();

    fn begin(&self, _: Tile, (): &mut ()) {}

    fn paint<V: View<From = Together>, S: Surfaces, R: Radiance, A: Recorder>(
        &self,
        brush: &mut Brush<'_, V, S, R, A>,
        tile: Tile,
        (): &mut (),
    ) {
        for pixel in 0..tile.pixels() {
            let taps = self.map.taps(self.lookup, brush.direction(pixel).unit());
            let mut sum = Observed {
                radiance: [0.0; 3],
                coverage: Coverage::NONE,
            };
            for (texel, part) in taps.into_iter().filter(|tap| tap.1 > 0.0) {
                let observed = match self.seen(brush, pixel, texel) {
                    Some(seen) => brush.pipeline.observe(&seen.point, seen.w, 1.0),
                    None => brush.pipeline.unmet(1.0),
                };
                for (sum, value) in sum.radiance.iter_mut().zip(observed.radiance) {
                    *sum += value * part;
                }
                sum.coverage += observed.coverage * part;
            }
            brush.pipeline.expose(pixel, sum, brush.film);
            let nearest = self.seen(brush, pixel, taps[0].0);
            if nearest.is_none() {
                brush.film.add_unmet();
            }
            brush.record(pixel, nearest.as_ref());
        }
    }
}

impl Warped {
    /// What a texel shows to a pixel's sample.
    #[inline]
    fn seen<'p, V: View<From = Together>, S: Surfaces, R: Radiance, A: Recorder>(
        &self,
        brush: &Brush<'p, V, S, R, A>,
        pixel: usize,
        texel: u32,
    ) -> Option<Seen<'p>> {
        let found = self.texels[texel as usize]?;
        let d = Direction::from_unit(self.map.direction(texel.into()));
        let (point, _) = brush.pipeline.point(found, d, Together);
        let w = brush.ratio(pixel, found.frame);
        Some(Seen { point, w })
    }
}
