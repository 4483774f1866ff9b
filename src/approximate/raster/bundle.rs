//! Rays with what each has met, hit by other means than tracing them.

use glam::DVec3;

use crate::camera::RayOrigin;
use crate::light::time_texture::Coverage;
use crate::render::film::TileFilm;
use crate::render::trace::{RadianceSink, SurfaceHit};

/// A ray, and what it has met.
#[derive(Debug, Clone, Copy)]
pub(super) struct BundleRay {
    /// Look direction in the world, a unit vector.
    pub d: DVec3,
    /// World time that the light is on its way, metres, per metre.
    pub delay: f64,
    /// W for a source at rest in the world.
    pub ratio: f64,
    /// What is met.
    pub hit: Option<SurfaceHit>,
}

/// One sample of each pixel of a tile: for each pixel, in order, one ray or several.
#[derive(Debug, Default)]
pub(super) struct Bundle {
    pub directions: Vec<DVec3>,
    pub ratios: Vec<f64>,
    pub origins: Vec<RayOrigin>,
    pub hits: Vec<Option<SurfaceHit>>,
    /// Of each ray, its pixel and its part of the pixel's sample.
    parts: Vec<(u32, f64)>,
    /// The first ray of each pixel, whose channels are recorded.
    pub firsts: Vec<u32>,
}

impl Bundle {
    /// Forgets all rays.
    pub fn clear(&mut self) {
        self.directions.clear();
        self.ratios.clear();
        self.origins.clear();
        self.hits.clear();
        self.parts.clear();
        self.firsts.clear();
    }

    /// The rays that are added from now on are the next pixel's.
    pub fn next_pixel(&mut self) {
        self.firsts.push(self.hits.len() as u32);
    }

    /// Adds a ray, which is `part` of its pixel's sample.
    #[inline]
    pub fn add(&mut self, seeing: BundleRay, part: f64) {
        let pixel = (self.firsts.len() - 1) as u32;
        self.directions.push(seeing.d);
        self.ratios.push(seeing.ratio);
        self.origins.push(RayOrigin {
            delay: seeing.delay,
            ..RayOrigin::AT_SHOT
        });
        self.hits.push(seeing.hit);
        self.parts.push((pixel, part));
    }

    /// Where the rays' radiance goes: by way of `sums` to `film`, as the parts of their pixels.
    pub fn blend<'a>(&'a self, sums: &'a mut Vec<[f64; 3]>, film: &'a mut TileFilm) -> Blend<'a> {
        sums.clear();
        sums.resize(self.firsts.len(), [0.0; 3]);
        Blend {
            parts: &self.parts,
            sums,
            film,
        }
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
