//! The whole image: tiles over threads, the same bits on any number of them.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::camera::{AnyView, Departure};
use crate::error::{Error, Result};
use crate::render::film::{Film, Layout, Tile, TileFilm};
use crate::render::prepare::{Light, Prepared};
use crate::render::progress::Progress;
use crate::render::trace::{
    self, Aim, AovRecorder, Meter, NoAovs, Pipeline, Radiance, Recorder, Stats, Surfaces, Unmetered,
};

/// Renders a prepared scene on rayon's current thread pool.
///
/// # Errors
/// [`Error::Cancelled`] when `progress` says so.
pub fn render(scene: &Prepared, progress: &dyn Progress) -> Result<Film> {
    render_tiles(scene, 0..Tile::count(scene.layout.size), progress)
}

/// The same picture, and what it has cost.
///
/// # Errors
/// As [`render`].
pub fn render_with_stats(scene: &Prepared, progress: &dyn Progress) -> Result<(Film, Stats)> {
    let tiles = 0..Tile::count(scene.layout.size);
    metered(scene, &Work { tiles, progress })
}

/// Renders some tiles of the image alone, by [`Tile::of_image`], each with the bits that it has in the whole;
/// the rest of the film stays empty.
///
/// # Errors
/// As [`render`].
pub fn render_tiles(scene: &Prepared, tiles: Range<u64>, progress: &dyn Progress) -> Result<Film> {
    Ok(metered::<Unmetered>(scene, &Work { tiles, progress })?.0)
}

fn metered<M: Meter>(scene: &Prepared, work: &Work) -> Result<(Film, M)> {
    match &scene.camera.view {
        AnyView::Still(view) => scene.seen(view, work),
        AnyView::Moving(view) => scene.seen(view, work),
        AnyView::Unaberrated(view) => scene.seen(view, work),
        AnyView::Inertial(view) => scene.seen(view, work),
        AnyView::Accelerated(view) => scene.seen(view.as_ref(), work),
        AnyView::Turning(view) => scene.seen(view, work),
        AnyView::Paper(view) => scene.seen(view, work),
    }
}

/// Which tiles are rendered, and who is told.
struct Work<'a> {
    tiles: Range<u64>,
    progress: &'a dyn Progress,
}

// Each step fixes one type of the pipeline; every combination is compiled for itself.
impl Prepared {
    fn seen<D: Departure, M: Meter>(&self, view: &dyn Aim<D>, work: &Work) -> Result<(Film, M)> {
        let (event, index) = (self.camera.shot.event, self.ray_index);
        match self.frames.as_slice() {
            [rest] if rest.frame.velocity().is_rest() => {
                self.met(view, trace::Still::new(rest, event, index), work)
            }
            [rest] => self.met(view, trace::Moving::new(rest, event, index), work),
            frames => self.met(view, trace::Frames::new(frames, event, index), work),
        }
    }

    fn met<D: Departure, S: Surfaces, M: Meter>(
        &self,
        view: &dyn Aim<D>,
        surfaces: S,
        work: &Work,
    ) -> Result<(Film, M)> {
        match &self.light {
            Light::Constant(light) => self.lit(view, surfaces, light, work),
            Light::TimeResolved(light) => self.lit(view, surfaces, light, work),
        }
    }

    fn lit<D: Departure, S: Surfaces, R: Radiance, M: Meter>(
        &self,
        view: &dyn Aim<D>,
        surfaces: S,
        radiance: &R,
        work: &Work,
    ) -> Result<(Film, M)> {
        let pipeline = Pipeline {
            view,
            surfaces,
            radiance,
            event: self.camera.shot.event,
            index: self.ray_index,
            background: self.background,
            sampler: self.sampler,
            method: self.method,
        };
        if self.layout.channels.is_empty() {
            run(&pipeline, &NoAovs, &self.layout, work)
        } else {
            let recorder = AovRecorder {
                channels: self.layout.channels.clone(),
            };
            run(&pipeline, &recorder, &self.layout, work)
        }
    }
}

fn run<D: Departure, S: Surfaces, R: Radiance, A: Recorder, M: Meter>(
    pipeline: &Pipeline<'_, D, S, R>,
    recorder: &A,
    layout: &Layout,
    work: &Work,
) -> Result<(Film, M)> {
    let finished = Mutex::new((Film::new(layout.clone()), M::default()));
    work.tiles.clone().into_par_iter().try_for_each_init(
        trace::Buffers::default,
        |buffers, index| {
            let tile = Tile::of_image(layout.size, index);
            let mut tile_film = TileFilm::new(tile, layout);
            let mut meter = M::default();
            for sample in 0..layout.samples {
                if work.progress.is_cancelled() {
                    return Err(Error::Cancelled);
                }
                pipeline.sample(tile, sample, recorder, buffers, &mut tile_film, &mut meter);
                work.progress.rays_done(tile.pixels() as u64);
            }
            // A poisoned lock means a panic elsewhere, which rayon passes on.
            let mut finished = finished.lock().unwrap_or_else(PoisonError::into_inner);
            finished.0.place(&tile_film);
            finished.1.merge(meter);
            Ok(())
        },
    )?;
    Ok(finished
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner))
}
