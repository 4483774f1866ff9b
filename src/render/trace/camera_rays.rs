//! Camera rays of a batch: offset in the pixel → film point → look direction, W, origin.

use std::ops::Range;

use glam::DVec3;

use crate::accel::Traversal;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::camera::{AnyProjection, AnyView, FilmPoints, Projection, RayOrigin, RaySlices, View};
use crate::colour::Wavelengths;
use crate::render::film::Tile;
use crate::render::sampler::{
    Sampler, halves, pixel_key, sobol, sobol_among, sobol_of_each, sobol_of_each_at,
};

/// Camera rays of one sample, or of several consecutive samples, of every pixel of a tile.
#[derive(Debug, Default)]
pub struct CameraRays {
    pixels: Vec<u64>,
    /// The keys of the pixels for this replicate, from which random numbers are derived.
    keys: Vec<u64>,
    /// The sample index in the replicate; the first, if there are several samples.
    index: u32,
    /// Sample index by ray, if there are several samples.
    indices: Vec<u32>,
    in_pixel: u32,
    offsets: [Vec<f64>; 2],
    film: [Vec<f64>; 2],
    moments: Vec<f64>,
    /// Look directions in the world, unit vectors.
    pub(crate) directions: Vec<DVec3>,
    /// W for a source at rest in the world.
    pub(crate) ratios: Vec<f64>,
    /// The event at which each ray leaves; empty if all leave at the event of the shot.
    origins: Vec<RayOrigin>,
}

/// Rays of one batch.
#[derive(Debug, Clone, Copy)]
pub struct Rays<'a> {
    /// Look directions, unit vectors of the world.
    pub directions: &'a [DVec3],
    /// The event at which each ray leaves; `None` if all leave at the event of the shot.
    pub origins: Option<&'a [RayOrigin]>,
    /// W for a source at rest in the world, as each ray's observer sees it: the camera, or the frame of a surface.
    pub ratios: &'a [f64],
    /// The moment within the exposure of each ray, 0 to 1; empty if there is one for all, or none is known.
    pub moments: &'a [f64],
    /// The wavelengths that each ray's observer samples; empty if there are none, or if samples choose them.
    pub wavelengths: &'a [Wavelengths],
    /// The triangle that each ray leaves, and cannot hit again; empty if the rays leave no triangles.
    pub left: &'a [LeftTriangle],
    /// How the rays are traced.
    pub method: Traversal,
    /// The source of random numbers at their hits.
    pub samples: Samples<'a>,
}

impl<'a> Rays<'a> {
    /// Rays that all leave at the event of the shot, without random choices at their hits.
    pub fn from_shot(directions: &'a [DVec3], method: Traversal) -> Self {
        Rays {
            directions,
            origins: None,
            ratios: &[],
            moments: &[],
            wavelengths: &[],
            left: &[],
            method,
            samples: Samples::default(),
        }
    }
}

/// A triangle that a ray leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LeftTriangle {
    /// Index of its rest frame.
    pub frame: u32,
    /// Its position in the frame's tree.
    pub slot: u32,
}

/// Which samples of which pixels the rays of a batch belong to.
#[derive(Debug, Clone, Copy, Default)]
pub struct Samples<'a> {
    /// The key of each ray's pixel and replicate; past the end, the number of the ray.
    pub pixels: &'a [u64],
    /// The sample index, if all rays share it.
    pub index: u32,
    /// The sample index of each ray; empty if all share one.
    pub indices: &'a [u32],
    /// The number of samples per pixel.
    pub in_pixel: u32,
    /// The number of surfaces that the rays have left so far.
    pub depth: u32,
    /// The parts of an exposure that the rays stand for, if data are integrated over them.
    pub exposure: Option<Exposure<'a>>,
    /// Their cells, if lookups are means over footprints.
    pub cells: Option<Cells<'a>>,
}

/// An exposure, divided equally among its samples.
#[derive(Debug, Clone, Copy)]
pub struct Exposure<'a> {
    /// Duration in metres of the camera's proper time.
    pub duration: f64,
    /// The number of samples per pixel.
    pub samples: u32,
    /// The moment within the exposure of each ray, 0 to 1.
    pub moments: &'a [f64],
    /// W for sources at rest in the world, by ray.
    pub ratios: &'a [f64],
}

impl Exposure<'_> {
    /// The two ends of the part of the exposure that a ray stands for, relative to the ray's moment, metres of camera time.
    pub(super) fn part(&self, ray: usize) -> [f64; 2] {
        let (moment, count) = (self.moments[ray], f64::from(self.samples));
        // The equal part of the exposure that contains the moment.
        let part = (moment * count).floor();
        [part, part + 1.0].map(|end| (end / count - moment) * self.duration)
    }
}

/// The cells that the rays of a batch stand for.
#[derive(Debug, Clone, Copy)]
pub struct Cells<'a> {
    /// The rays.
    pub(crate) rays: &'a CameraRays,
    /// Rays slightly offset from these along x, along y, and, for an integrated exposure, in time.
    pub(crate) beside: &'a [CameraRays],
    /// Width and height of a cell in pixels, and its fraction of the exposure.
    pub(crate) size: [f64; 3],
}

/// The axis after those of the film.
pub(crate) const TIME: usize = 2;

/// The offset of a neighbouring ray, in pixels or exposures: small enough for a derivative, and much larger than rounding errors.
const BESIDE: f64 = 1.0 / 1024.0;

/// The largest number of pairs of random numbers used at one surface of a path.
const DRAWN_AT_A_SURFACE: u32 = 8;

impl Samples<'_> {
    /// Two numbers in [0, 1) of ray `ray` for purpose `dimension`, the `number`-th pair of `count`.
    #[inline]
    pub(super) fn one_of(&self, ray: usize, dimension: u32, number: u32, count: u32) -> [f64; 2] {
        let index = self.index(ray).wrapping_mul(count).wrapping_add(number);
        let in_pixel = self.in_pixel.wrapping_mul(count);
        sobol_among(self.pixel(ray), index, in_pixel, dimension)
    }

    /// Two numbers in [0, 1) of the only ray, or of the first, for purpose `dimension` at the surface that it hits.
    #[inline]
    pub(super) fn on_path(&self, dimension: u32) -> [f64; 2] {
        let dimension = self.depth * DRAWN_AT_A_SURFACE + dimension;
        sobol(self.pixel(0), self.index(0), dimension)
    }

    /// The same for rays with these keys and, if they have them, sample indices.
    pub(super) fn each_on_path(
        &self,
        (keys, indices): (&[u64], &[u32]),
        dimension: u32,
        numbers: &mut [Vec<f64>; 2],
    ) {
        let dimension = self.depth * DRAWN_AT_A_SURFACE + dimension;
        match indices {
            [] => sobol_of_each(keys, self.index, dimension, numbers),
            indices => sobol_of_each_at(keys, indices, dimension, numbers),
        }
    }

    /// Two numbers in [0, 1) of sample `index` with this key for purpose `dimension`.
    pub(super) fn of_key(&self, key: u64, index: u32, dimension: u32) -> [f64; 2] {
        let dimension = self.depth * DRAWN_AT_A_SURFACE + dimension;
        sobol(key, index, dimension)
    }

    /// The sample index of ray `ray`.
    #[inline]
    pub(crate) fn index(&self, ray: usize) -> u32 {
        self.indices.get(ray).copied().unwrap_or(self.index)
    }

    /// The key of the pixel of ray `ray`.
    #[inline]
    pub(crate) fn pixel(&self, ray: usize) -> u64 {
        self.pixels.get(ray).copied().unwrap_or(ray as u64)
    }
}

impl Rays<'_> {
    /// The event at which ray `ray` leaves.
    #[inline(always)]
    pub(crate) fn origin(&self, ray: usize) -> RayOrigin {
        self.origins.map_or(RayOrigin::AT_SHOT, |all| all[ray])
    }

    /// The index of the medium along ray `ray`.
    #[inline(always)]
    pub(super) fn index(&self, index: f64, ray: usize) -> f64 {
        self.origins.map_or(index, |all| index * all[ray].delay)
    }
}

impl CameraRays {
    /// The exposure of the given duration; each ray is one of `samples` samples of its pixel.
    pub(crate) fn exposure(&self, duration: f64, samples: u32) -> Option<Exposure<'_>> {
        (self.moments.len() == self.directions.len()).then_some(Exposure {
            duration,
            samples,
            moments: &self.moments,
            ratios: &self.ratios,
        })
    }

    /// The position of sample `ray` in its pixel.
    pub(crate) fn offset(&self, ray: usize) -> [f64; 2] {
        [self.offsets[0][ray], self.offsets[1][ray]]
    }

    /// The positions of all samples, by axis.
    pub(crate) fn offsets(&self) -> [&[f64]; 2] {
        self.offsets.each_ref().map(Vec::as_slice)
    }

    /// The position along an axis of the film, or the moment in the exposure for [`TIME`].
    pub(super) fn place(&self, ray: usize, axis: usize) -> f64 {
        self.offsets.get(axis).unwrap_or(&self.moments)[ray]
    }

    /// The rays, traced by `method`.
    pub(crate) fn rays(&self, method: Traversal) -> Rays<'_> {
        Rays {
            directions: &self.directions,
            origins: (!self.origins.is_empty()).then_some(&self.origins),
            ratios: &self.ratios,
            moments: &self.moments,
            wavelengths: &[],
            left: &[],
            method,
            samples: Samples {
                pixels: &self.keys,
                index: self.index,
                indices: &self.indices,
                in_pixel: self.in_pixel,
                depth: 0,
                exposure: None,
                cells: None,
            },
        }
    }

    /// The event at which ray `ray` leaves.
    pub(super) fn origin(&self, ray: usize) -> RayOrigin {
        self.origins.get(ray).copied().unwrap_or(RayOrigin::AT_SHOT)
    }

    /// Generates the rays of `view` at the known offsets and moments. The projection is matched here, not for each ray.
    fn look_through<V: View>(&mut self, view: &V) {
        match view.film() {
            AnyProjection::Perspective(film) => self.look(view, film),
            any => self.look(view, any),
        }
    }

    /// Generates the rays of `view`, whose projection is `film`, at the known offsets and moments.
    fn look<V: View, P: Projection + Sync>(&mut self, view: &V, film: &P) {
        let [x, y] = &mut self.film;
        dispatch(Generate {
            view,
            film,
            pixels: &self.pixels,
            offsets: [&self.offsets[0], &self.offsets[1]],
            x,
            y,
            moments: &self.moments,
            directions: &mut self.directions,
            ratios: &mut self.ratios,
            origins: &mut self.origins,
        });
    }

    fn resize<V: View>(&mut self, count: usize) {
        self.pixels.resize(count, 0);
        for axis in 0..2 {
            self.offsets[axis].resize(count, 0.0);
            self.film[axis].resize(count, 0.0);
        }
        self.directions.resize(count, DVec3::ZERO);
        self.ratios.resize(count, 0.0);
        let own_origins = if V::SHARED_ORIGIN { 0 } else { count };
        self.origins.resize(own_origins, RayOrigin::AT_SHOT);
    }
}

/// A generator of rays by the batch.
pub trait RayGenerator: Sync {
    /// Generates the rays of `samples` for every pixel of `tile`, sample by sample.
    fn generate(&self, rays: &mut CameraRays, sampler: &Sampler, tile: Tile, samples: Range<u32>);

    /// Whether they depend on the moment of an exposure.
    fn uses_moments(&self) -> bool;

    /// Sets the positions of the same samples, pixel by pixel, without the keys of random numbers at their hits.
    fn place_by_pixel(
        &self,
        rays: &mut CameraRays,
        sampler: &Sampler,
        tile: Tile,
        samples: Range<u32>,
    );

    /// Generates the rays of samples whose positions are set.
    fn look(&self, rays: &mut CameraRays);

    /// Generates rays slightly offset from those of `of` along an axis of the film, towards the centres of their pixels, or for [`TIME`]
    /// slightly towards the middle of the exposure.
    fn beside(&self, rays: &mut CameraRays, of: &CameraRays, axis: usize);

    /// Generates the rays through these film points, in pixels, half-way through the exposure.
    fn through(&self, rays: &mut CameraRays, points: &[[f64; 2]]);
}

/// The ray generator of a view. The kind of view is matched once per batch, and its loops are compiled for that kind.
pub fn generator(view: &AnyView) -> &dyn RayGenerator {
    match view {
        AnyView::Still(view) => view,
        AnyView::Moving(view) => view,
        AnyView::Unaberrated(view) => view,
        AnyView::Inertial(view) => view,
        AnyView::Accelerated(view) => view.as_ref(),
        AnyView::Turning(view) => view,
        AnyView::Stereo(view) => view,
        AnyView::Paper(view) => view,
    }
}

/// Sets the positions of `samples` for every pixel of `tile`, sample by sample.
fn place<V: View>(
    view: &V,
    rays: &mut CameraRays,
    sampler: &Sampler,
    (tile, samples): (Tile, Range<u32>),
) {
    let (pixels, count) = (tile.pixels(), samples.len() * tile.pixels());
    rays.resize::<V>(count);
    rays.index = sampler.replicate(samples.start).0;
    rays.in_pixel = sampler.samples();
    rays.keys.clear();
    rays.indices.clear();
    let uses_time = view.uses_time();
    rays.moments.resize(if uses_time { count } else { 0 }, 0.0);
    let [left, top] = tile.corner;
    for (sample, begin) in samples.clone().zip((0..count).step_by(pixels.max(1))) {
        let of_sample = begin..begin + pixels;
        let rows = rays.pixels[of_sample.clone()].chunks_mut(tile.size[0].max(1) as usize);
        for (row, pixels) in (top..).zip(rows) {
            // The keys of pixels in a row are consecutive.
            let first = pixel_key(left, row);
            for (column, pixel) in pixels.iter_mut().enumerate() {
                *pixel = first + column as u64;
            }
        }
        let (within, salt) = sampler.replicate(sample);
        let keys = rays.pixels[of_sample.clone()].iter();
        rays.keys.extend(keys.map(|pixel| pixel ^ salt));
        if samples.len() > 1 {
            rays.indices.resize(of_sample.end, within);
        }
        let keys = &rays.keys[of_sample.clone()];
        let [x, y] = &mut rays.offsets;
        let (x, y) = (&mut x[of_sample.clone()], &mut y[of_sample.clone()]);
        sampler.offsets(keys, within, x, y);
        if uses_time {
            sampler.moments(keys, within, &mut rays.moments[of_sample]);
        }
    }
}

impl<V: View> RayGenerator for V {
    fn generate(&self, rays: &mut CameraRays, sampler: &Sampler, tile: Tile, samples: Range<u32>) {
        place(self, rays, sampler, (tile, samples));
        rays.look_through(self);
    }

    fn uses_moments(&self) -> bool {
        self.uses_time()
    }

    fn place_by_pixel(
        &self,
        rays: &mut CameraRays,
        sampler: &Sampler,
        tile: Tile,
        samples: Range<u32>,
    ) {
        let each = samples.len();
        if each == 1 {
            return place(self, rays, sampler, (tile, samples));
        }
        rays.resize::<V>(each * tile.pixels());
        rays.index = sampler.replicate(samples.start).0;
        rays.in_pixel = sampler.samples();
        rays.indices.clear();
        rays.moments.clear();
        rays.keys.clear();
        let [left, top] = tile.corner;
        let [width, height] = tile.size;
        for row in top..top + height {
            (rays.keys).extend((left..left + width).map(|column| pixel_key(column, row)));
        }
        // The key of each pixel, for all of its samples.
        let of_pixels = rays.pixels.chunks_exact_mut(each.max(1));
        for (of_one, key) in of_pixels.zip(&rays.keys) {
            of_one.fill(*key);
        }
        let [x, y] = &mut rays.offsets;
        sampler.offsets_by_pixel(&rays.keys, samples.clone(), x, y);
        if self.uses_time() {
            for key in &rays.keys {
                // Each with the key of its replicate.
                for sample in samples.clone() {
                    let (within, salt) = sampler.replicate(sample);
                    let mut moment = [0.0];
                    sampler.moments(&[key ^ salt], within, &mut moment);
                    rays.moments.extend(moment);
                }
            }
        }
        rays.keys.clear();
    }

    fn look(&self, rays: &mut CameraRays) {
        rays.look_through(self);
    }

    fn beside(&self, rays: &mut CameraRays, of: &CameraRays, axis: usize) {
        rays.resize::<V>(of.pixels.len());
        rays.index = of.index;
        rays.indices.clone_from(&of.indices);
        rays.pixels.clone_from(&of.pixels);
        rays.moments.clone_from(&of.moments);
        rays.offsets.clone_from(&of.offsets);
        let places = match axis {
            TIME => &mut rays.moments,
            axis => &mut rays.offsets[axis],
        };
        // Towards the middle, so that the neighbour stays within the pixel or the exposure.
        for offset in places {
            *offset += if *offset < 0.5 { BESIDE } else { -BESIDE };
        }
        rays.look_through(self);
    }

    fn through(&self, rays: &mut CameraRays, points: &[[f64; 2]]) {
        rays.resize::<V>(points.len());
        rays.index = 0;
        rays.indices.clear();
        rays.in_pixel = 1;
        for (k, [x, y]) in points.iter().enumerate() {
            let [column, row] = [x.floor(), y.floor()];
            rays.pixels[k] = pixel_key(column as u32, row as u32);
            (rays.offsets[0][k], rays.offsets[1][k]) = (x - column, y - row);
        }
        rays.moments.clear();
        if self.uses_time() {
            rays.moments.resize(points.len(), 0.5);
        }
        rays.look_through(self);
    }
}

/// The loop over film points.
struct Generate<'a, V, P> {
    view: &'a V,
    film: &'a P,
    pixels: &'a [u64],
    offsets: [&'a [f64]; 2],
    x: &'a mut [f64],
    y: &'a mut [f64],
    moments: &'a [f64],
    directions: &'a mut [DVec3],
    ratios: &'a mut [f64],
    origins: &'a mut [RayOrigin],
}

impl<V: View, P: Projection> VectorLoop for Generate<'_, V, P> {
    #[inline(always)]
    fn run(self) {
        let [in_x, in_y] = self.offsets;
        film_points(self.pixels, in_x, in_y, self.x, self.y);
        let points = FilmPoints {
            x: self.x,
            y: self.y,
            moments: self.moments,
        };
        let rays = RaySlices {
            directions: self.directions,
            ratios: self.ratios,
            origins: self.origins,
        };
        self.view.rays(self.film, &points, rays);
    }
}

/// Film points in pixels: the corner of each pixel plus the offset in it.
#[inline(always)]
fn film_points(pixels: &[u64], in_x: &[f64], in_y: &[f64], x: &mut [f64], y: &mut [f64]) {
    let count = pixels.len();
    // Slices of one length need no bounds checks within the loop, which is then vectorised.
    let (in_x, in_y) = (&in_x[..count], &in_y[..count]);
    let (x, y) = (&mut x[..count], &mut y[..count]);
    for k in 0..count {
        // The lower half of a key is the column, the upper half the row.
        let [column, row] = halves(pixels[k]);
        (x[k], y[k]) = (column + in_x[k], row + in_y[k]);
    }
}

#[cfg(test)]
mod tests;
