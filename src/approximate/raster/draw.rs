//! From samples to radiance: what is seen at each, in the terms of the ray tracer.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::bundle::Bundle;
use crate::camera::Point;
use crate::error::{Error, Result};
use crate::render::film::{Film, Tile, TileFilm};
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::{
    CameraRays, HitBuffer, Meter, RayGenerator, Rays, Shading, Surfaces, TracedRays, record,
};
use crate::spacetime::{Direction, World};

/// Finds out what samples see.
pub(super) trait Painter: Sync {
    /// What is reused from tile to tile.
    type Space: Default;

    /// Gets ready for `tile`.
    fn begin(&self, tile: Tile, space: &mut Self::Space);

    /// Fills `bundle` with what one sample of every pixel of `tile` sees.
    fn paint(&self, eye: &Eye, tile: Tile, space: &mut Self::Space, bundle: &mut Bundle);
}

/// One sample of each pixel of a tile: its camera ray.
pub(super) struct Eye<'a> {
    pub camera_rays: &'a CameraRays,
    surfaces: &'a Surfaces<'a>,
    /// World time that light takes per metre; 0 where retardation is turned off.
    pub index: f64,
}

impl Eye<'_> {
    /// The look direction of a pixel's sample.
    #[inline]
    pub fn direction(&self, pixel: usize) -> Direction<World> {
        Direction::from_unit(self.camera_rays.directions[pixel])
    }

    /// The W that a ray along `d` must have for a source at rest in the world, so that what it meets in rest
    /// frame `frame` is seen with the wavelength that the pixel's own direction gives.
    #[inline]
    pub fn ratio(&self, pixel: usize, frame: u32, d: Direction<World>) -> f64 {
        let (_, rho) = self.surfaces.direction(frame, self.direction(pixel));
        self.ratio_of(self.camera_rays.ratios[pixel] * rho, frame, d)
    }

    /// The same where what is met is seen with wavelength ratio `w`.
    #[inline]
    pub fn ratio_of(&self, w: f64, frame: u32, d: Direction<World>) -> f64 {
        let (_, rho) = self.surfaces.direction(frame, d);
        w / rho
    }
}

/// A scene, and who sees it.
struct Stage<'a> {
    scene: &'a Prepared,
    view: Point<'a>,
    surfaces: Surfaces<'a>,
}

/// Buffers of one thread.
#[derive(Default)]
struct Buffers<T> {
    camera_rays: CameraRays,
    bundle: Bundle,
    sums: Vec<[f64; 3]>,
    hits: HitBuffer,
    shading: Shading,
    space: T,
}

/// The film of `scene` as `painter` paints it.
pub(super) fn film<P: Painter>(
    scene: &Prepared,
    painter: &P,
    progress: &dyn Progress,
) -> Result<Film> {
    let view = scene.camera.view.point();
    let stage = Stage {
        scene,
        view: view.ok_or_else(crate::approximate::projection::apart)?,
        // The index is that of each ray.
        surfaces: Surfaces::unbuffered(&scene.frames, scene.camera.shot.event, 1.0),
    };
    let layout = &scene.layout;
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
                let Buffers {
                    camera_rays,
                    bundle,
                    ..
                } = buffers;
                let sampler = &scene.sampler;
                stage.view.generate(camera_rays, sampler, tile, sample);
                let eye = Eye {
                    camera_rays,
                    surfaces: &stage.surfaces,
                    index: scene.ray_index,
                };
                bundle.clear();
                painter.paint(&eye, tile, &mut buffers.space, bundle);
                stage.shade(buffers, &mut tile_film);
                progress.rays_done(tile.pixels() as u64);
            }
            // A poisoned lock means a panic elsewhere, which rayon passes on.
            let mut film = film.lock().unwrap_or_else(PoisonError::into_inner);
            film.place(&tile_film);
            Ok(())
        })?;
    Ok(film.into_inner().unwrap_or_else(PoisonError::into_inner))
}

impl Stage<'_> {
    /// Adds the radiance of the rays of the bundle to `film`.
    fn shade<T>(&self, buffers: &mut Buffers<T>, film: &mut TileFilm) {
        let Buffers {
            camera_rays,
            bundle,
            sums,
            hits,
            shading,
            ..
        } = buffers;
        let scene = self.scene;
        let firsts = bundle.firsts.iter();
        let unmet = firsts.filter(|ray| bundle.hits[**ray as usize].is_none());
        film.add_unmet(unmet.count() as u64);
        hits.set(&bundle.hits);
        let traced = TracedRays {
            surfaces: &self.surfaces,
            rays: Rays {
                directions: &bundle.directions,
                origins: Some(&bundle.origins),
                method: scene.method,
            },
            hits,
            event: scene.camera.shot.event,
            index: 1.0,
        };
        let (radiance, ratios) = (scene.light.radiance(), &bundle.ratios);
        let mut blend = bundle.blend(sums, film);
        let meter = &mut Meter::off();
        shading.shade(
            radiance,
            &traced,
            scene.background,
            ratios,
            &mut blend,
            meter,
        );
        blend.finish();
        let channels = scene.layout.channels.as_slice();
        if channels.is_empty() {
            return;
        }
        for (pixel, &ray) in bundle.firsts.iter().enumerate() {
            let observed = traced.observed(ray as usize, ratios[ray as usize]);
            let d = Direction::from_unit(camera_rays.directions[pixel]);
            let offset = camera_rays.offset(pixel);
            record(channels, pixel, offset, d, observed.as_ref(), film);
        }
    }
}
