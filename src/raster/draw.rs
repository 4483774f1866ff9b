//! From samples to radiance: what is seen at each, in the terms of the ray tracer.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::camera::{Point, Together, View};
use crate::error::{Error, Result};
use crate::film::{Film, Layout, Tile, TileFilm};
use crate::prepare::{Light, Prepared};
use crate::progress::Progress;
use crate::spacetime::{Direction, WavelengthRatio, World};
use crate::trace::{
    AovRecorder, Buffers, Frames, NoAovs, Pipeline, Radiance, Recorder, Seen, Surfaces,
};

/// Finds out what samples see.
pub(super) trait Painter: Sync {
    /// What is reused from tile to tile.
    type Space: Default;

    /// Gets ready for `tile`.
    fn begin(&self, tile: Tile, space: &mut Self::Space);

    /// Adds one sample of every pixel of `tile`, whose looks are in `buffers`.
    fn paint<V: View<From = Together>, S: Surfaces, R: Radiance, A: Recorder>(
        &self,
        brush: &mut Brush<'_, V, S, R, A>,
        tile: Tile,
        space: &mut Self::Space,
    );
}

/// What a painter paints with: one sample of each pixel of a tile.
pub(super) struct Brush<'a, V, S, R, A> {
    pub pipeline: &'a Pipeline<'a, V, S, R>,
    pub recorder: &'a A,
    pub buffers: &'a mut Buffers<Together>,
    pub film: &'a mut TileFilm,
}

impl<V: View<From = Together>, S: Surfaces, R: Radiance, A: Recorder> Brush<'_, V, S, R, A> {
    /// The look direction of a pixel's sample.
    #[inline]
    pub fn direction(&self, pixel: usize) -> Direction<World> {
        self.buffers.directions[pixel]
    }

    /// The observed wavelength over the emitted one of what a pixel's sample sees in a rest frame.
    #[inline]
    pub fn ratio(&self, pixel: usize, frame: u32) -> WavelengthRatio {
        let (_, rho) = self.pipeline.surfaces.turned(frame, self.direction(pixel));
        WavelengthRatio(self.buffers.ratios[pixel] * rho)
    }

    /// The sample sees nothing.
    pub fn nothing(&mut self, pixel: usize) {
        let unmet = self.pipeline.unmet(1.0);
        self.pipeline.expose(pixel, unmet, self.film);
        self.film.add_unmet();
        self.record(pixel, None);
    }

    /// The sample sees a point, and its radiance.
    pub fn something(&mut self, pixel: usize, seen: &Seen) {
        let observed = self.pipeline.observe(&seen.point, seen.w, 1.0);
        self.pipeline.expose(pixel, observed, self.film);
        self.record(pixel, Some(seen));
    }

    /// Records the channels of a sample that sees `seen`.
    pub fn record(&mut self, pixel: usize, seen: Option<&Seen>) {
        let offset = self.buffers.offsets[pixel];
        let d = self.direction(pixel);
        self.recorder.record(pixel, offset, d, seen, self.film);
    }
}

/// The film of `scene` as `painter` paints it.
pub(super) fn film(
    scene: &Prepared,
    painter: &impl Painter,
    progress: &dyn Progress,
) -> Result<Film> {
    let view = scene.camera.view.point();
    let view = view.ok_or_else(crate::apparent::apart)?;
    match &scene.light {
        Light::Constant(light) => lit(scene, view, light, painter, progress),
        Light::TimeResolved(light) => lit(scene, view, light, painter, progress),
    }
}

fn lit<R: Radiance>(
    scene: &Prepared,
    view: Point,
    radiance: &R,
    painter: &impl Painter,
    progress: &dyn Progress,
) -> Result<Film> {
    let event = scene.camera.shot.event;
    let pipeline = Pipeline {
        view: &view,
        surfaces: Frames::new(&scene.frames, event, scene.ray_index),
        radiance,
        event,
        index: scene.ray_index,
        background: scene.background,
        sampler: scene.sampler,
    };
    if scene.layout.channels.is_empty() {
        return run(&pipeline, &NoAovs, &scene.layout, painter, progress);
    }
    let recorder = AovRecorder {
        channels: scene.layout.channels.clone(),
    };
    run(&pipeline, &recorder, &scene.layout, painter, progress)
}

fn run<V: View<From = Together>, S: Surfaces, R: Radiance, A: Recorder, P: Painter>(
    pipeline: &Pipeline<'_, V, S, R>,
    recorder: &A,
    layout: &Layout,
    painter: &P,
    progress: &dyn Progress,
) -> Result<Film> {
    let film = Mutex::new(Film::new(layout.clone()));
    (0..Tile::count(layout.size))
        .into_par_iter()
        .try_for_each_init(
            || (Buffers::default(), P::Space::default()),
            |(buffers, space), index| {
                let tile = Tile::of_image(layout.size, index);
                let mut tile_film = TileFilm::new(tile, layout);
                painter.begin(tile, space);
                for sample in 0..layout.samples {
                    if progress.is_cancelled() {
                        return Err(Error::Cancelled);
                    }
                    pipeline.shoot(tile, sample, buffers);
                    let film = &mut tile_film;
                    let mut brush = Brush {
                        pipeline,
                        recorder,
                        buffers,
                        film,
                    };
                    painter.paint(&mut brush, tile, space);
                    progress.rays_done(tile.pixels() as u64);
                }
                // A poisoned lock means a panic elsewhere, which rayon passes on.
                let mut film = film.lock().unwrap_or_else(PoisonError::into_inner);
                film.place(&tile_film);
                Ok(())
            },
        )?;
    Ok(film.into_inner().unwrap_or_else(PoisonError::into_inner))
}
