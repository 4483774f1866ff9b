//! The whole image: tiles over threads, the same bits on any number of them.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::camera::{AnyView, Departure};
use crate::error::{Error, Result};
use crate::film::{Film, Layout, Tile, TileFilm};
use crate::prepare::{Light, Prepared};
use crate::progress::Progress;
use crate::trace::{
    self, Aim, AovRecorder, Meter, NoAovs, Pipeline, Radiance, Recorder, Stats, Surfaces, Unmetered,
};

/// Renders a prepared scene on rayon's current thread pool.
///
/// # Errors
/// [`Error::Cancelled`] when `progress` says so.
pub fn render(scene: &Prepared, progress: &dyn Progress) -> Result<Film> {
    Ok(metered::<Unmetered>(scene, progress)?.0)
}

/// The same picture, and what it has cost.
///
/// # Errors
/// As [`render`].
pub fn render_with_stats(scene: &Prepared, progress: &dyn Progress) -> Result<(Film, Stats)> {
    metered(scene, progress)
}

fn metered<M: Meter>(scene: &Prepared, progress: &dyn Progress) -> Result<(Film, M)> {
    match &scene.camera.view {
        AnyView::Still(view) => scene.seen(view, progress),
        AnyView::Moving(view) => scene.seen(view, progress),
        AnyView::Unaberrated(view) => scene.seen(view, progress),
        AnyView::Inertial(view) => scene.seen(view, progress),
        AnyView::Accelerated(view) => scene.seen(view.as_ref(), progress),
        AnyView::Turning(view) => scene.seen(view, progress),
        AnyView::Paper(view) => scene.seen(view, progress),
    }
}

// Each step fixes one type of the pipeline; every combination is compiled for itself.
impl Prepared {
    fn seen<D: Departure, M: Meter>(
        &self,
        view: &dyn Aim<D>,
        progress: &dyn Progress,
    ) -> Result<(Film, M)> {
        let (event, index) = (self.camera.shot.event, self.ray_index);
        match self.frames.as_slice() {
            [rest] if rest.frame.velocity().is_rest() => {
                self.met(view, trace::Still::new(rest, event, index), progress)
            }
            [rest] => self.met(view, trace::Moving::new(rest, event, index), progress),
            frames => self.met(view, trace::Frames::new(frames, event, index), progress),
        }
    }

    fn met<D: Departure, S: Surfaces, M: Meter>(
        &self,
        view: &dyn Aim<D>,
        surfaces: S,
        progress: &dyn Progress,
    ) -> Result<(Film, M)> {
        match &self.light {
            Light::Constant(light) => self.lit(view, surfaces, light, progress),
            Light::TimeResolved(light) => self.lit(view, surfaces, light, progress),
        }
    }

    fn lit<D: Departure, S: Surfaces, R: Radiance, M: Meter>(
        &self,
        view: &dyn Aim<D>,
        surfaces: S,
        radiance: &R,
        progress: &dyn Progress,
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
            run(&pipeline, &NoAovs, &self.layout, progress)
        } else {
            let recorder = AovRecorder {
                channels: self.layout.channels.clone(),
            };
            run(&pipeline, &recorder, &self.layout, progress)
        }
    }
}

fn run<D: Departure, S: Surfaces, R: Radiance, A: Recorder, M: Meter>(
    pipeline: &Pipeline<'_, D, S, R>,
    recorder: &A,
    layout: &Layout,
    progress: &dyn Progress,
) -> Result<(Film, M)> {
    let finished = Mutex::new((Film::new(layout.clone()), M::default()));
    (0..Tile::count(layout.size))
        .into_par_iter()
        .try_for_each_init(trace::Buffers::default, |buffers, index| {
            let tile = Tile::of_image(layout.size, index);
            let mut tile_film = TileFilm::new(tile, layout);
            let mut meter = M::default();
            for sample in 0..layout.samples {
                if progress.is_cancelled() {
                    return Err(Error::Cancelled);
                }
                pipeline.sample(tile, sample, recorder, buffers, &mut tile_film, &mut meter);
                progress.rays_done(tile.pixels() as u64);
            }
            // A poisoned lock means a panic elsewhere, which rayon passes on.
            let mut finished = finished.lock().unwrap_or_else(PoisonError::into_inner);
            finished.0.place(&tile_film);
            finished.1.merge(meter);
            Ok(())
        })?;
    Ok(finished
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner))
}
