//! The whole image: tiles are spread over threads, with the same bits for any number of them.

use std::num::NonZeroU32;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::io::cube::BytesRead;
use crate::render::film::{Film, Tile, TileFilm};
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::sampler::Sampler;
use crate::render::trace::{
    CameraRays, Cells, Counter, HitBuffer, Meter, Shading, Stage, Stats, Surfaces, TIME, generator,
    record,
};
use crate::spacetime::Direction;

/// Renders a prepared scene on rayon's current thread pool.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled) if `progress` cancels; data that are read on demand and cannot be read; and a caller's own
/// radiance that does not give one emission for each point.
pub fn render(scene: &Prepared, progress: &dyn Progress) -> Result<Film> {
    render_tiles(scene, 0..Tile::count(scene.layout.size), progress)
}

/// The same picture in the memory of `film`, an earlier picture of any scene, if that is as large: frame after frame then needs no new memory.
///
/// # Errors
/// As for [`render`].
pub fn render_over(scene: &Prepared, film: Film, progress: &dyn Progress) -> Result<Film> {
    let tiles = 0..Tile::count(scene.layout.size);
    tiles_with(scene, tiles, Some(film), progress, None)
}

/// The same picture, and its cost.
///
/// # Errors
/// As for [`render`].
pub fn render_with_stats(scene: &Prepared, progress: &dyn Progress) -> Result<(Film, Stats)> {
    let tiles = 0..Tile::count(scene.layout.size);
    let total = Mutex::new(Stats::default());
    let before = scene.light.bytes_read();
    let film = tiles_with(scene, tiles, None, progress, Some(&total))?;
    let after = scene.light.bytes_read();
    let mut total = total.into_inner().unwrap_or_else(PoisonError::into_inner);
    total.disk = BytesRead {
        all: after.all - before.all,
        again: after.again - before.again,
    };
    Ok((film, total))
}

/// Renders only some tiles of the image, numbered as in [`Tile::of_image`], each with the same bits as in the whole image; the rest of the
/// film stays empty.
///
/// # Errors
/// As for [`render`], and tiles beyond the image.
pub fn render_tiles(scene: &Prepared, tiles: Range<u64>, progress: &dyn Progress) -> Result<Film> {
    let count = Tile::count(scene.layout.size);
    if tiles.end > count {
        let what = format!("tiles {} to {} of {count}", tiles.start, tiles.end);
        let help = "tiles of the image: Tile::count says how many there are";
        return Err(Error::invalid("film", "tiles", what, help));
    }
    tiles_with(scene, tiles, None, progress, None)
}

/// Renders every `step`-th tile; the rest of the film stays empty.
pub(crate) fn render_every(scene: &Prepared, step: u64, progress: &dyn Progress) -> Result<Film> {
    let all = 0..Tile::count(scene.layout.size);
    let tiles = all.into_par_iter().filter(|tile| tile % step == 0);
    tiles_with(scene, tiles, None, progress, None)
}

/// The same, in the memory of `over` if these are all tiles; the cost is added to `total`.
fn tiles_with(
    scene: &Prepared,
    tiles: impl IntoParallelIterator<Item = u64>,
    over: Option<Film>,
    progress: &dyn Progress,
    total: Option<&Mutex<Stats>>,
) -> Result<Film> {
    let pipeline = Pipeline::new(scene, scene.sampler);
    let layout = &scene.layout;
    layout.check()?;
    Film::of_all_tiles(layout, over, |rows| {
        let done: Result<()> =
            tiles
                .into_par_iter()
                .try_for_each_init(Default::default, |(buffers, kept), index| {
                    let tile = Tile::of_image(layout.size, index);
                    let tile_film = TileFilm::reused(kept, tile, layout);
                    let mut meter = Meter::new(total.is_some());
                    let samples = &mut (0..layout.samples);
                    pipeline.samples(samples, buffers, tile_film, progress, &mut meter)?;
                    rows.place(tile_film);
                    if let (Some(total), Some(stats)) = (total, meter.into_stats()) {
                        let mut total = total.lock().unwrap_or_else(PoisonError::into_inner);
                        total.merge(stats);
                    }
                    Ok(())
                });
        scene.light.check()?;
        done
    })
}

/// From film points to radiance.
pub(super) struct Pipeline<'a> {
    scene: &'a Prepared,
    sampler: Sampler,
    surfaces: Surfaces<'a>,
}

/// Buffers for one thread's tile.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    camera_rays: CameraRays,
    beside: [CameraRays; 3],
    hits: HitBuffer,
    shading: Shading,
}

impl<'a> Pipeline<'a> {
    pub(super) fn new(scene: &'a Prepared, sampler: Sampler) -> Self {
        Pipeline {
            scene,
            sampler,
            surfaces: scene.surfaces(),
        }
    }

    /// Renders the samples that are `left` of every pixel of the tile of `film`.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if `progress` cancels, and errors of reading data; the samples before those still `left` are complete.
    pub(super) fn samples(
        &self,
        left: &mut Range<u32>,
        buffers: &mut Buffers,
        film: &mut TileFilm,
        progress: &dyn Progress,
        meter: &mut Meter,
    ) -> Result<()> {
        let best = self.scene.light.radiance().samples_at_once();
        let at_once = self.scene.samples_at_once.map_or(best, NonZeroU32::get);
        while left.start < left.end {
            progress.check()?;
            if self.scene.light.has_failed() {
                return Err(Error::Cancelled);
            }
            let batch = film.together(left.clone(), at_once);
            let rays = film.tile().pixels() as u64 * batch.len() as u64;
            self.batch(batch.clone(), buffers, film, meter);
            left.start = batch.end;
            film.end_samples(batch);
            progress.rays_done(rays);
        }
        Ok(())
    }

    /// Renders `samples` of every pixel in one batch.
    fn batch(
        &self,
        samples: Range<u32>,
        buffers: &mut Buffers,
        film: &mut TileFilm,
        meter: &mut Meter,
    ) {
        let (scene, surfaces, tile) = (self.scene, &self.surfaces, film.tile());
        let Buffers {
            camera_rays,
            beside,
            hits,
            shading,
        } = buffers;
        // Camera rays and, if footprints are needed, rays slightly offset along both axes of the film.
        meter.start();
        let generator = generator(&scene.camera.view);
        generator.generate(camera_rays, &self.sampler, tile, samples);
        let exposure = scene
            .integrated_exposure
            .and_then(|duration| camera_rays.exposure(duration, self.sampler.samples()));
        // Offset along the axes of the film, and in time if that is integrated over.
        let (beside, size) = match exposure {
            Some(_) => (&mut beside[..], self.sampler.cell_in_time()),
            None => {
                let [width, height] = self.sampler.cell();
                (&mut beside[..TIME], [width, height, 1.0])
            }
        };
        if scene.light.has_footprints() {
            for (axis, beside) in beside.iter_mut().enumerate() {
                generator.beside(beside, camera_rays, axis);
            }
        }
        meter.lap(Stage::CameraRays);
        // What a sample stands for: a part of the exposure, and a cell of the pixel.
        let mut rays = camera_rays.rays(scene.method);
        rays.samples.exposure = exposure;
        rays.samples.cells = scene.light.has_footprints().then_some(Cells {
            rays: camera_rays,
            beside,
            size,
        });
        // Hits, and their radiance.
        let traced = scene.trace(surfaces, rays, hits, meter);
        let (radiance, ratios) = (scene.light.radiance(), &camera_rays.ratios);
        shading.shade(radiance, &traced, &scene.background, ratios, film, meter);
        // Channels last: they use the same rays, and most pictures have none.
        let channels = scene.layout.channels.as_slice();
        if !channels.is_empty() {
            for (ray, ratio) in ratios.iter().enumerate() {
                let sees = traced.rays.origin(ray).sees();
                // A sensor element that no light reaches has hits all the same, but no channel shows them.
                let observed = traced.observed(ray, *ratio).filter(|_| sees);
                let d = sees.then(|| Direction::from_unit(camera_rays.directions[ray]));
                let offset = camera_rays.offset(ray);
                let pixel = ray % tile.pixels();
                record(
                    channels,
                    radiance,
                    pixel,
                    offset,
                    d,
                    observed.as_ref(),
                    film,
                );
            }
        }
        meter.count(Counter::Rays, ratios.len() as u64);
        meter.lap(Stage::Film);
    }
}
