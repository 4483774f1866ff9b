//! Which objects rays through given film points hit first.

use rayon::prelude::*;

use crate::error::Result;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::{CameraRays, HitBuffer, Meter, Surfaces, generator};

/// Points of one batch.
const BATCH: usize = 4096;

/// The index of the visible object at each of these film points (pixels; (0, 0) is the upper left corner); `None` if there is none. An
/// exposure is sampled at its middle.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled) when `progress` says so.
pub(crate) fn objects_at(
    scene: &Prepared,
    points: &[[f64; 2]],
    progress: &dyn Progress,
) -> Result<Vec<Option<u32>>> {
    let surfaces = scene.surfaces();
    let batches = points.par_chunks(BATCH).map(|points| {
        progress.check()?;
        Ok(batch(scene, &surfaces, points))
    });
    let batches: Vec<Vec<_>> = batches.collect::<Result<_>>()?;
    Ok(batches.concat())
}

fn batch(scene: &Prepared, surfaces: &Surfaces, points: &[[f64; 2]]) -> Vec<Option<u32>> {
    let (mut camera_rays, mut hits) = (CameraRays::default(), HitBuffer::default());
    generator(&scene.camera.view).through(&mut camera_rays, points);
    let rays = camera_rays.rays(scene.method);
    let traced = scene.trace(surfaces, rays, &mut hits, &mut Meter::off());
    let object = |(ray, ratio): (usize, &f64)| {
        let sees = traced.rays.origin(ray).sees();
        let observed = traced.observed(ray, *ratio).filter(|_| sees)?;
        Some(observed.point.patch.object)
    };
    camera_rays.ratios.iter().enumerate().map(object).collect()
}
