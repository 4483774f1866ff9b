//! The cube of what a camera sees.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use glam::DVec3;
use rayon::prelude::*;

use super::histogram::Histogram;
use super::part::{Part, Summary, kept};
use super::{Baked, Bins, PARTS, baked, check, paths};
use crate::accel::{NoTally, Origins};
use crate::error::{Error, Result};
use crate::render::film::Tile;
use crate::render::journal::Journal;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::sampler::{Sampler, samples_per_part};
use crate::render::trace::{AT_ONCE, CameraRays, RayGenerator, Seen, Start, TimedPaths};
use crate::scene::model::{Motion, ProjectionKind, Scene};
use crate::spacetime::Direction;

/// The cube of the scene's camera, which rests relative to all objects; tiles are kept in `journal`, where there is one.
///
/// # Errors
/// What [`check`] refuses, a camera that moves relative to the objects, I/O errors of the journal, and [`Error::Cancelled`] when `progress` says so.
pub fn camera_cube(
    scene: &Scene,
    prepared: &Prepared,
    bins: &Bins,
    journal: Option<&Journal>,
    progress: &dyn Progress,
) -> Result<Baked> {
    check(scene)?;
    check_camera(scene)?;
    let paths = paths(scene, prepared)?;
    let layout = &prepared.layout;
    let per_part = samples_per_part(layout.samples, PARTS);
    let sampler = match layout.pixel_centers {
        true => prepared.sampler,
        false => prepared.sampler.with_samples(per_part),
    };
    let [width, height] = layout.size.map(|n| n as usize);
    let mut values = vec![0f32; width * height * bins.count * 3];
    let placed = Mutex::new(&mut values);
    let make = |tile: Tile, rays: &mut CameraRays| {
        let mut pixels: Vec<_> = (0..tile.pixels()).map(|_| Histogram::new(bins)).collect();
        let mut sample = 0;
        while sample < layout.samples {
            progress.check()?;
            // Samples of different parts are kept apart.
            let left = per_part - sample % per_part;
            let samples = sample..sample + left.min(AT_ONCE);
            sample = samples.end;
            let place = (tile, samples);
            sample_tile(prepared, &paths, (bins, &sampler), place, rays, &mut pixels);
            if sample.is_multiple_of(per_part) {
                pixels.iter_mut().for_each(Histogram::end_part);
            }
        }
        let mut part = Part::new(bins);
        pixels.iter().for_each(|pixel| part.push(pixel));
        Ok(part)
    };
    let tiles = (0..Tile::count(layout.size) as usize).into_par_iter();
    let summaries: Vec<Summary> = tiles
        .map_init(CameraRays::default, |rays, index| {
            let tile = Tile::of_image(layout.size, index as u64);
            let size = [tile.pixels(), bins.count];
            let part = kept(journal, index, size, || make(tile, rays))?;
            progress.rays_done(tile.pixels() as u64 * u64::from(layout.samples));
            // A poisoned lock means a panic elsewhere, which rayon passes on.
            let mut values = placed.lock().unwrap_or_else(PoisonError::into_inner);
            let pixels = part.values.chunks(3 * bins.count);
            for ((column, row), pixel) in tile.coordinates().zip(pixels) {
                let first = (row as usize * width + column as usize) * bins.count * 3;
                values[first..first + pixel.len()].copy_from_slice(pixel);
            }
            Ok(part.summary)
        })
        .collect::<Result<_>>()?;
    baked(scene, prepared, [height, width], bins, values, &summaries)
}

/// Adds `samples`, which are of one part, to each pixel of a tile.
fn sample_tile(
    prepared: &Prepared,
    paths: &TimedPaths,
    (bins, sampler): (&Bins, &Sampler),
    (tile, samples): (Tile, Range<u32>),
    rays: &mut CameraRays,
    pixels: &mut [Histogram],
) {
    let view = &prepared.camera.view;
    view.generate(rays, sampler, tile, samples);
    let frame = &paths.rest.frame;
    let boost = frame.frame_from_world();
    let shot = frame.event_from_world(prepared.camera.shot.event);
    // A plain camera: all rays leave one event.
    let direction = |d: &DVec3| boost.direction(Direction::from_unit(*d)).0.unit();
    let directions: Vec<_> = rays.directions.iter().map(direction).collect();
    let mut hits = vec![None; directions.len()];
    let from = Origins::Shared(shot.x);
    let (bvh, method) = (&paths.rest.bvh, prepared.method);
    bvh.closest_by(method, from, &directions, &mut hits, &mut NoTally, |_| ());

    // The paths that meet something, and their pixels.
    let (mut starts, mut met) = (Vec::new(), Vec::new());
    let numbers = rays.rays(method).samples;
    for (ray, (hit, d)) in hits.into_iter().zip(&directions).enumerate() {
        let pixel = ray % tile.pixels();
        pixels[pixel].found += 1;
        if let Some(hit) = hit {
            starts.push(Start {
                hit,
                seen: Seen::From(shot.x, *d),
                sample: (numbers.pixel(ray), numbers.index(ray)),
            });
            met.push(pixel);
        }
    }
    paths.follow(
        &starts,
        sampler.samples(),
        |path, emission, light, delay| {
            let clock = paths.clock(paths.rest.patch(starts[path].hit.triangle));
            pixels[met[path]].add(bins, emission, light, delay + clock);
        },
    );
}

/// The pinhole of the camera as [`camera_cube`] has it, where a capture camera is given: in the world, or in the coordinates of the
/// first object where all moves.
pub fn eye(scene: &Scene, prepared: &Prepared) -> DVec3 {
    let event = prepared.camera.shot.event;
    let Some(rest) = prepared
        .frames
        .first()
        .filter(|f| !f.frame.velocity().is_rest())
    else {
        return event.x;
    };
    let origin = scene
        .objects
        .first()
        .map_or(rest.frame.origin(), |o| o.origin);
    rest.frame.event_from_world(event).x - rest.frame.event_from_world(origin).x
}

fn check_camera(scene: &Scene) -> Result<()> {
    let camera = &scene.camera;
    let refuse = |what: &str| {
        let help = "a plain camera that rests with the objects; the cube can then be looked at by any other";
        Err(Error::invalid(&scene.name, "camera", what, help))
    };
    let objects = scene.objects.first().map(|o| o.velocity.rapidity());
    let difference = objects.map_or(0.0, |w| (w - camera.velocity.rapidity()).length());
    // Rapidities that are the same but for rounding.
    if difference > 1e-12 || camera.motion != Motion::Inertial {
        return refuse("it moves relative to the objects");
    }
    if camera.projection != ProjectionKind::Perspective {
        return refuse("a capture camera has a flat film, and this one has another projection");
    }
    if camera.shutter.is_some()
        || camera.sensor.is_some()
        || camera.rotation.is_some()
        || camera.stereo.is_some()
    {
        return refuse(
            "a cube is that of one pinhole, without a shutter, a moving sensor or a second eye",
        );
    }
    Ok(())
}
