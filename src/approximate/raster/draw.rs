//! From samples to radiance: what is seen at each, in the terms of the ray tracer.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::bundle::Bundle;
use crate::accel::Method;
use crate::camera::Together;
use crate::error::{Error, Result};
use crate::render::film::{Film, Layout, Tile, TileFilm};
use crate::render::prepare::{Light, Prepared};
use crate::render::progress::Progress;
use crate::render::sampler::Sampler;
use crate::render::trace::{
    Aim, AovRecorder, Developer, Frames, Looks, NoAovs, Radiance, Rays, Recorder, Scratch,
    Surfaces, Traced, Unmetered,
};
use crate::spacetime::{Direction, Event, World};

/// Finds out what samples see.
pub(super) trait Painter: Sync {
    /// What is reused from tile to tile.
    type Space: Default;

    /// Gets ready for `tile`.
    fn begin(&self, tile: Tile, space: &mut Self::Space);

    /// Fills `bundle` with what one sample of every pixel of `tile` sees.
    fn paint(&self, eye: &Eye, tile: Tile, space: &mut Self::Space, bundle: &mut Bundle);
}

/// One sample of each pixel of a tile: how it looks at the scene.
pub(super) struct Eye<'a> {
    pub looks: &'a Looks<Together>,
    surfaces: &'a Frames<'a>,
    /// World time that light takes per metre; 0 where retardation is turned off.
    pub index: f64,
}

impl Eye<'_> {
    /// The look direction of a pixel's sample.
    #[inline]
    pub fn direction(&self, pixel: usize) -> Direction<World> {
        Direction::from_unit(self.looks.directions[pixel])
    }

    /// The W that a ray along `d` must have for a source at rest in the world, so that what it meets in rest
    /// frame `frame` is seen with the wavelength that the pixel's own direction gives.
    #[inline]
    pub fn ratio(&self, pixel: usize, frame: u32, d: Direction<World>) -> f64 {
        let (_, rho) = self.surfaces.turned(frame, self.direction(pixel));
        self.ratio_of(self.looks.ratios[pixel] * rho, frame, d)
    }

    /// The same where what is met is seen with wavelength ratio `w`.
    #[inline]
    pub fn ratio_of(&self, w: f64, frame: u32, d: Direction<World>) -> f64 {
        let (_, rho) = self.surfaces.turned(frame, d);
        w / rho
    }
}

/// A scene, and who sees it.
struct Stage<'a, R> {
    view: &'a dyn Aim<Together>,
    surfaces: Frames<'a>,
    radiance: &'a R,
    event: Event<World>,
    index: f64,
    background: [f64; 3],
    sampler: Sampler,
    method: Method,
}

/// Buffers of one thread.
#[derive(Default)]
struct Buffers<T> {
    looks: Looks<Together>,
    bundle: Bundle,
    sums: Vec<[f64; 3]>,
    scratch: Scratch,
    developer: Developer,
    space: T,
}

/// The film of `scene` as `painter` paints it.
pub(super) fn film(
    scene: &Prepared,
    painter: &impl Painter,
    progress: &dyn Progress,
) -> Result<Film> {
    match &scene.light {
        Light::Constant(light) => lit(scene, light, painter, progress),
        Light::TimeResolved(light) => lit(scene, light, painter, progress),
    }
}

fn lit<R: Radiance>(
    scene: &Prepared,
    radiance: &R,
    painter: &impl Painter,
    progress: &dyn Progress,
) -> Result<Film> {
    let view = scene.camera.view.point();
    let view = view.ok_or_else(crate::approximate::projection::apart)?;
    let event = scene.camera.shot.event;
    let stage = Stage {
        view: &view,
        // The index is that of each ray.
        surfaces: Frames::new(&scene.frames, event, 1.0),
        radiance,
        event,
        index: scene.ray_index,
        background: scene.background,
        sampler: scene.sampler,
        method: scene.method,
    };
    if scene.layout.channels.is_empty() {
        return run(&stage, &NoAovs, &scene.layout, painter, progress);
    }
    let recorder = AovRecorder {
        channels: scene.layout.channels.clone(),
    };
    run(&stage, &recorder, &scene.layout, painter, progress)
}

fn run<R: Radiance, A: Recorder, P: Painter>(
    stage: &Stage<R>,
    recorder: &A,
    layout: &Layout,
    painter: &P,
    progress: &dyn Progress,
) -> Result<Film> {
    let film = Mutex::new(Film::new(layout.clone()));
    (0..Tile::count(layout.size))
        .into_par_iter()
        .try_for_each_init(Buffers::<P::Space>::default, |buffers, index| {
            let tile = Tile::of_image(layout.size, index);
            let mut tile_film = TileFilm::new(tile, layout);
            painter.begin(tile, &mut buffers.space);
            for sample in 0..layout.samples {
                if progress.is_cancelled() {
                    return Err(Error::Cancelled);
                }
                let Buffers { looks, bundle, .. } = buffers;
                stage.view.aim(looks, &stage.sampler, tile, sample);
                let eye = Eye {
                    looks,
                    surfaces: &stage.surfaces,
                    index: stage.index,
                };
                bundle.clear();
                painter.paint(&eye, tile, &mut buffers.space, bundle);
                stage.develop(buffers, recorder, &mut tile_film);
                progress.rays_done(tile.pixels() as u64);
            }
            // A poisoned lock means a panic elsewhere, which rayon passes on.
            let mut film = film.lock().unwrap_or_else(PoisonError::into_inner);
            film.place(&tile_film);
            Ok(())
        })?;
    Ok(film.into_inner().unwrap_or_else(PoisonError::into_inner))
}

impl<R: Radiance> Stage<'_, R> {
    /// Adds what the rays of the bundle have met to `film`.
    fn develop<T, A: Recorder>(&self, buffers: &mut Buffers<T>, recorder: &A, film: &mut TileFilm) {
        let Buffers {
            looks,
            bundle,
            sums,
            scratch,
            developer,
            ..
        } = buffers;
        let firsts = bundle.firsts.iter();
        let unmet = firsts.filter(|ray| bundle.found[**ray as usize].is_none());
        film.add_unmet(unmet.count() as u64);
        scratch.hold(&bundle.found);
        let traced = Traced {
            surfaces: &self.surfaces,
            rays: Rays {
                directions: &bundle.directions,
                from: &bundle.from,
                method: self.method,
            },
            scratch,
            event: self.event,
            index: 1.0,
        };
        let (background, ratios) = (self.background, &bundle.ratios);
        let mut blend = bundle.blend(sums, film);
        let meter = &mut Unmetered::default();
        developer.develop(
            self.radiance,
            &traced,
            background,
            ratios,
            &mut blend,
            meter,
        );
        blend.finish();
        if !A::RECORDS {
            return;
        }
        for (pixel, &ray) in bundle.firsts.iter().enumerate() {
            let seen = traced.seen(ray as usize, ratios[ray as usize]);
            let d = Direction::from_unit(looks.directions[pixel]);
            recorder.record(pixel, looks.offset(pixel), d, seen.as_ref(), film);
        }
    }
}
