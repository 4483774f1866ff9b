//! From samples to radiance: what is seen at each, in the terms of the ray tracer.

use std::sync::{Mutex, PoisonError};

use glam::DVec3;
use rayon::prelude::*;

use crate::camera::RayOrigin;
use crate::error::{Error, Result};
use crate::light::time_texture::Coverage;
use crate::render::film::{Film, Tile, TileFilm};
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::{
    CameraRays, HitBuffer, Meter, RadianceSink, RayGenerator, Rays, Shading, SurfaceHit, Surfaces,
    TracedRays, record,
};
use crate::spacetime::{Direction, World};

/// One sample of each pixel of a tile: one ray for each pixel, in order, or several with their parts of its sample.
#[derive(Debug, Default)]
pub(super) struct RayBatch {
    /// Look directions in the world, unit vectors.
    pub directions: Vec<DVec3>,
    /// W for sources at rest in the world.
    pub ratios: Vec<f64>,
    /// World time that the light is on its way, metres per metre, where each ray has its own; otherwise empty.
    pub origins: Vec<RayOrigin>,
    /// What the rays meet.
    pub hits: HitBuffer,
    /// Of each ray, its pixel and its part of the pixel's sample; empty where each pixel has one ray.
    parts: Vec<(u32, f64)>,
    /// The first ray of each pixel, whose channels are recorded; empty where each pixel has one.
    firsts: Vec<u32>,
}

impl RayBatch {
    /// Forgets all rays.
    fn clear(&mut self) {
        self.directions.clear();
        self.ratios.clear();
        self.origins.clear();
        self.hits.clear();
        self.parts.clear();
        self.firsts.clear();
    }

    /// The rays that are added from now on are the next pixel's.
    pub fn next_pixel(&mut self) {
        self.firsts.push(self.ratios.len() as u32);
    }

    /// Adds a ray along `d`, which is `part` of its pixel's sample.
    #[inline]
    pub fn add(&mut self, d: DVec3, ratio: f64, hit: Option<SurfaceHit>, part: f64) {
        let pixel = (self.firsts.len() - 1) as u32;
        self.directions.push(d);
        self.ratios.push(ratio);
        self.hits.push(hit);
        self.parts.push((pixel, part));
    }
}

/// Adds up rays to samples of pixels.
pub(super) struct Blend<'a> {
    parts: &'a [(u32, f64)],
    sums: &'a mut [[f64; 3]],
    film: &'a mut TileFilm,
}

impl Blend<'_> {
    /// Puts the samples onto the film.
    pub fn finish(self) {
        for (pixel, sum) in self.sums.iter().enumerate() {
            self.film.add(pixel, *sum);
        }
    }
}

impl RadianceSink for Blend<'_> {
    #[inline(always)]
    fn add(&mut self, ray: usize, radiance: [f64; 3]) {
        let (pixel, part) = self.parts[ray];
        for (sum, value) in self.sums[pixel as usize].iter_mut().zip(radiance) {
            *sum += value * part;
        }
    }

    #[inline(always)]
    fn add_coverage(&mut self, ray: usize, coverage: Coverage) {
        let (pixel, part) = self.parts[ray];
        self.film.add_coverage(pixel as usize, coverage * part);
    }

    fn add_held(&mut self, rays: &[u32]) {
        for ray in rays {
            self.add_coverage(*ray as usize, Coverage::HELD);
        }
    }

    /// Samples that show nothing are counted by their first ray.
    fn add_unmet(&mut self, _: u64) {}
}

/// Finds out what samples see.
pub(super) trait Visibility: Sync {
    /// What is reused from tile to tile.
    type TileBuffers: Default;

    /// Whether rays have [`RayBatch::origins`].
    fn has_own_delays(&self) -> bool {
        false
    }

    /// Gets ready for `tile`.
    fn begin(&self, tile: Tile, buffers: &mut Self::TileBuffers);

    /// Fills `rays` with what one sample of every pixel of `tile` sees.
    fn paint(
        &self,
        samples: &TileSamples,
        tile: Tile,
        buffers: &mut Self::TileBuffers,
        rays: &mut RayBatch,
    );
}

/// One sample of each pixel of a tile: its camera ray.
pub(super) struct TileSamples<'a> {
    pub camera_rays: &'a CameraRays,
    surfaces: &'a Surfaces<'a>,
    /// World time that light takes per metre; 0 where retardation is turned off.
    pub index: f64,
}

impl TileSamples<'_> {
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
    surfaces: Surfaces<'a>,
    /// Of the medium; 1 where rays have delays of their own.
    index: f64,
}

/// Buffers of one thread.
#[derive(Default)]
struct Buffers<T> {
    camera_rays: CameraRays,
    rays: RayBatch,
    sums: Vec<[f64; 3]>,
    shading: Shading,
    tile: T,
}

/// The film of `scene` as `visibility` paints it.
pub(super) fn film<P: Visibility>(
    scene: &Prepared,
    visibility: &P,
    progress: &dyn Progress,
) -> Result<Film> {
    scene
        .camera
        .view
        .point()
        .ok_or_else(crate::approximate::projection::apart)?;
    let index = match visibility.has_own_delays() {
        true => 1.0,
        false => scene.ray_index,
    };
    let stage = Stage {
        scene,
        surfaces: Surfaces::unbuffered(&scene.frames, scene.camera.shot.event, index),
        index,
    };
    let layout = &scene.layout;
    let film = Mutex::new(Film::new(layout.clone()));
    let done = (0..Tile::count(layout.size))
        .into_par_iter()
        .try_for_each_init(Buffers::<P::TileBuffers>::default, |buffers, index| {
            let tile = Tile::of_image(layout.size, index);
            let mut tile_film = TileFilm::new(tile, layout);
            visibility.begin(tile, &mut buffers.tile);
            for sample in 0..layout.samples {
                if progress.is_cancelled() || scene.light.has_failed() {
                    return Err(Error::Cancelled);
                }
                let Buffers {
                    camera_rays, rays, ..
                } = buffers;
                let view = &scene.camera.view;
                view.generate(camera_rays, &scene.sampler, tile, sample..sample + 1);
                let samples = TileSamples {
                    camera_rays,
                    surfaces: &stage.surfaces,
                    index: scene.ray_index,
                };
                rays.clear();
                visibility.paint(&samples, tile, &mut buffers.tile, rays);
                stage.shade(buffers, &mut tile_film);
                tile_film.end_samples(sample..sample + 1);
                progress.rays_done(tile.pixels() as u64);
            }
            // A poisoned lock means a panic elsewhere, which rayon passes on.
            let mut film = film.lock().unwrap_or_else(PoisonError::into_inner);
            film.place(&tile_film);
            Ok(())
        });
    scene.light.check()?;
    done?;
    Ok(film.into_inner().unwrap_or_else(PoisonError::into_inner))
}

impl Stage<'_> {
    /// Adds the radiance of the rays to `film`.
    fn shade<T>(&self, buffers: &mut Buffers<T>, film: &mut TileFilm) {
        let Buffers {
            camera_rays,
            rays,
            sums,
            shading,
            ..
        } = buffers;
        let scene = self.scene;
        let traced = TracedRays {
            surfaces: &self.surfaces,
            rays: Rays {
                directions: &rays.directions,
                origins: (!rays.origins.is_empty()).then_some(&rays.origins),
                left: &[],
                method: scene.method,
                samples: Default::default(),
            },
            hits: &rays.hits,
            event: scene.camera.shot.event,
            index: self.index,
        };
        let (radiance, background) = (scene.light.radiance(), &scene.background);
        let (ratios, meter) = (&rays.ratios, &mut Meter::off());
        // One ray for each pixel, or several parts that are blended: then background counts by pixel, not by part.
        if rays.parts.is_empty() {
            shading.shade(radiance, &traced, background, ratios, film, meter);
        } else {
            let firsts = rays.firsts.iter();
            let unmet = firsts.filter(|ray| rays.hits.hit(**ray as usize).is_none());
            film.add_unmet(unmet.count() as u64);
            sums.clear();
            sums.resize(rays.firsts.len(), [0.0; 3]);
            let parts = &rays.parts;
            let mut blend = Blend { parts, sums, film };
            shading.shade(radiance, &traced, background, ratios, &mut blend, meter);
            blend.finish();
        }
        // Channels have one value for a pixel, that of its first part.
        let channels = scene.layout.channels.as_slice();
        if channels.is_empty() {
            return;
        }
        for (pixel, direction) in camera_rays.directions.iter().enumerate() {
            let ray = rays.firsts.get(pixel).map_or(pixel, |ray| *ray as usize);
            let observed = traced.observed(ray, ratios[ray]);
            let d = Direction::from_unit(*direction);
            let offset = camera_rays.offset(pixel);
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
}
