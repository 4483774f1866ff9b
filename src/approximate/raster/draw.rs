//! From samples to radiance: what each sample sees, in the ray tracer's data structures.

use std::iter;
use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::accel::vectors::{VectorLoop, dispatch};
use crate::camera::RayOrigin;
use crate::error::{Error, Result};
use crate::light::time_texture::Coverage;
use crate::render::film::{AddScaled, Film, TILE, Tile, TileFilm};
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::trace::{
    Background, CameraRays, HitBuffer, Meter, RadianceSink, Rays, Shading, SurfaceHit, Surfaces,
    TracedRays, generator, record,
};
use crate::spacetime::{Direction, World};

/// Samples of a strip, pixel by pixel: one ray for each sample, in order, or several with their weights.
#[derive(Debug, Default)]
pub(super) struct RayBatch {
    /// Look directions in the world, unit vectors; empty if the rays are the camera rays of the samples.
    pub directions: Vec<DVec3>,
    /// W for sources at rest in the world; as empty as the directions.
    pub ratios: Vec<f64>,
    /// World time of the light's travel, metres per metre, if each ray has its own; otherwise empty.
    pub origins: Vec<RayOrigin>,
    /// What the rays hit.
    pub hits: HitBuffer,
    /// For each ray, its sample and its weight; empty if each sample has one ray.
    parts: Vec<(u32, f64)>,
    /// The first ray of each sample, for which channels are recorded; empty if each sample has one ray.
    firsts: Vec<u32>,
}

impl RayBatch {
    /// Clears all rays; if all new ones `are_written`, the old values may stay in place.
    fn clear(&mut self, are_written: bool) {
        if !are_written {
            self.directions.clear();
            self.ratios.clear();
        }
        self.origins.clear();
        self.hits.clear();
        self.parts.clear();
        self.firsts.clear();
    }

    /// Assigns the following rays to the next sample.
    pub fn next_sample(&mut self) {
        self.firsts.push(self.ratios.len() as u32);
    }

    /// Adds a ray along `d`, with the weight `part` in its sample.
    #[inline]
    pub fn add(&mut self, d: DVec3, ratio: f64, hit: Option<SurfaceHit>, part: f64) {
        let sample = (self.firsts.len() - 1) as u32;
        self.directions.push(d);
        self.ratios.push(ratio);
        self.hits.push(hit);
        self.parts.push((sample, part));
    }
}

/// Some rows of a tile, and the number of samples of each of its pixels that are processed together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strip {
    /// The rows, as a tile of their own.
    pub rows: Tile,
    /// The first of them, counted from the tile's first.
    pub first: u32,
    /// Samples of each pixel.
    pub each: usize,
}

impl Strip {
    /// The maximum number of samples of a strip that are shaded in one batch, unless a row of pixels has more.
    const SAMPLES: u32 = TILE * TILE;

    /// The number of rows of a strip whose pixels have `each` samples.
    fn height(each: u32) -> u32 {
        // Rows are never split, however many samples their pixels have.
        (Strip::SAMPLES / (TILE * each.max(1))).max(1)
    }

    /// The strips of `tile`, `height` rows each, from the top.
    pub fn of(tile: Tile, height: u32, each: usize) -> impl Iterator<Item = Strip> {
        let [left, top] = tile.corner;
        let [width, rows] = tile.size;
        (0..rows).step_by(height as usize).map(move |first| Strip {
            rows: Tile {
                corner: [left, top + first],
                size: [width, height.min(rows - first)],
            },
            first,
            each,
        })
    }

    /// All samples.
    pub fn samples(&self) -> usize {
        self.rows.pixels() * self.each
    }

    /// The pixel of the tile to which sample `sample` belongs.
    #[inline(always)]
    pub fn pixel(&self, sample: usize) -> usize {
        (self.first * self.rows.size[0]) as usize + sample / self.each
    }

    /// Fills `x` and `y` with the film points of its samples, pixels from `corner`, from the positions in their pixels. `columns` are those of
    /// the samples of a row.
    pub fn points(
        &self,
        columns: &mut SampleColumns,
        corner: [u32; 2],
        [in_x, in_y]: [&[f64]; 2],
        [x, y]: [&mut Vec<f64>; 2],
    ) {
        let Strip { rows, each, .. } = *self;
        let count = rows.pixels() * each;
        x.resize(count, 0.0);
        y.resize(count, 0.0);
        let [left, top] = [0, 1].map(|k| rows.corner[k] - corner[k]);
        dispatch(PlacePoints {
            columns: columns.of(rows.size[0] as usize, each),
            corner: [left, top],
            from: [&in_x[..count], &in_y[..count]],
            to: [x, y],
        });
    }

    /// Whether it has exactly one sample for each pixel of `tile`.
    pub fn is_all_of(&self, tile: Tile) -> bool {
        self.each == 1 && self.rows.size == tile.size
    }
}

/// The column of each sample of a row of pixels, counted from the first.
#[derive(Debug, Default)]
pub(super) struct SampleColumns {
    each: usize,
    columns: Vec<f64>,
}

impl SampleColumns {
    /// The columns of `width` pixels with `each` samples, which are known already in most strips.
    fn of(&mut self, width: usize, each: usize) -> &[f64] {
        if self.each != each || self.columns.len() != width * each {
            self.each = each;
            self.columns.clear();
            let all = (0..width as u32).flat_map(|column| iter::repeat_n(f64::from(column), each));
            self.columns.extend(all);
        }
        &self.columns
    }
}

/// The loop from positions in pixels to film points.
struct PlacePoints<'a> {
    columns: &'a [f64],
    /// Column and row of the first pixel.
    corner: [u32; 2],
    from: [&'a [f64]; 2],
    to: [&'a mut [f64]; 2],
}

impl VectorLoop for PlacePoints<'_> {
    #[inline(always)]
    fn run(self) {
        let (in_row, [in_x, in_y], [x, y]) = (self.columns.len().max(1), self.from, self.to);
        let [left, top] = self.corner;
        let left = f64::from(left);
        for (x, in_x) in x.chunks_mut(in_row).zip(in_x.chunks(in_row)) {
            // Whole numbers first: their sum is exact, so that there is one rounding.
            for ((x, in_x), column) in x.iter_mut().zip(in_x).zip(self.columns) {
                *x = (left + column) + in_x;
            }
        }
        let rows = (top..).zip(y.chunks_mut(in_row).zip(in_y.chunks(in_row)));
        for (row, (y, in_y)) in rows {
            let row = f64::from(row);
            for (y, in_y) in y.iter_mut().zip(in_y) {
                *y = row + in_y;
            }
        }
    }
}

/// Sums of rays by sample, which are added to the film in the order of the samples of each pixel.
struct SampleSums<'a> {
    strip: Strip,
    sums: &'a mut Vec<[f64; 3]>,
    /// A buffer.
    pixels: &'a mut Vec<u32>,
    film: &'a mut TileFilm,
}

impl<'a> SampleSums<'a> {
    fn new(
        strip: Strip,
        sums: &'a mut Vec<[f64; 3]>,
        pixels: &'a mut Vec<u32>,
        film: &'a mut TileFilm,
    ) -> Self {
        sums.clear();
        sums.resize(strip.samples(), [0.0; 3]);
        SampleSums {
            strip,
            sums,
            pixels,
            film,
        }
    }

    /// Adds the samples to the film.
    fn finish(self) {
        let first = self.strip.pixel(0);
        self.film.add_samples(first, self.strip.each, self.sums);
    }

    /// Fills the buffer with the pixels of `samples`; only with as many numbers if the film has no channel of what is known, and reads none.
    fn take_pixels(&mut self, samples: &[u32]) {
        let strip = self.strip;
        if !self.film.has_coverage_channels() {
            return self.pixels.resize(samples.len(), 0);
        }
        self.pixels.clear();
        let pixels = samples.iter().map(|s| strip.pixel(*s as usize) as u32);
        self.pixels.extend(pixels);
    }
}

impl RadianceSink for SampleSums<'_> {
    #[inline(always)]
    fn add(&mut self, ray: usize, radiance: [f64; 3]) {
        for (sum, value) in self.sums[ray].iter_mut().zip(radiance) {
            *sum += value;
        }
    }

    fn add_scaled(&mut self, first: usize, radiance: &[[f64; 3]], factors: &[f64]) {
        let sums = &mut self.sums[first..first + radiance.len()];
        dispatch(AddScaled {
            sums,
            radiance,
            factors,
        });
    }

    fn add_blind(&mut self, ray: usize) {
        self.film.add_blind(self.strip.pixel(ray));
    }

    fn add_known(&mut self, rays: &[u32]) {
        self.take_pixels(rays);
        self.film.add_known(self.pixels);
    }

    fn cover(&mut self, rays: &[u32], parts: impl Iterator<Item = (usize, Coverage)>) {
        self.take_pixels(rays);
        self.film.cover(self.pixels, parts);
    }

    fn add_misses(&mut self, rays: u64) {
        self.film.add_misses(rays);
    }
}

/// Adds up the rays of each sample.
struct Blend<'a> {
    parts: &'a [(u32, f64)],
    sums: SampleSums<'a>,
}

impl Blend<'_> {
    /// The pixel of a ray, and its weight in the sample.
    fn pixel(&self, ray: u32) -> (usize, f64) {
        let (sample, part) = self.parts[ray as usize];
        (self.sums.strip.pixel(sample as usize), part)
    }
}

impl RadianceSink for Blend<'_> {
    #[inline(always)]
    fn add(&mut self, ray: usize, radiance: [f64; 3]) {
        let (sample, part) = self.parts[ray];
        self.sums
            .add(sample as usize, radiance.map(|value| value * part));
    }

    fn add_blind(&mut self, ray: usize) {
        self.sums.add_blind(self.parts[ray].0 as usize);
    }

    fn add_known(&mut self, rays: &[u32]) {
        for ray in rays {
            let (pixel, part) = self.pixel(*ray);
            self.sums.film.add_to_pixel(pixel, Coverage::HELD * part);
        }
    }

    fn cover(&mut self, rays: &[u32], parts: impl Iterator<Item = (usize, Coverage)>) {
        let mut parts = parts.peekable();
        for (at, ray) in rays.iter().enumerate() {
            let own = parts.next_if(|(other, _)| *other == at);
            let coverage = own.map_or(Coverage::HELD, |(_, coverage)| coverage);
            let (pixel, part) = self.pixel(*ray);
            self.sums.film.add_coverage(pixel, coverage * part, part);
        }
    }

    /// Samples that show nothing are counted by their first ray.
    fn add_misses(&mut self, _: u64) {}
}

/// Determines what samples see.
pub(super) trait Visibility: Sync {
    /// Buffers that are reused from tile to tile.
    type TileBuffers: Default;

    /// Whether rays have [`RayBatch::origins`].
    fn has_own_delays(&self) -> bool {
        false
    }

    /// Whether [`Visibility::paint`] sets the rays that hit something itself, and needs only sample positions.
    fn turns_rays(&self) -> bool {
        false
    }

    /// The largest number of samples of a pixel that are rasterized together.
    fn samples_at_once(&self) -> u32 {
        1
    }

    /// Prepares for `tile`, which is rasterized in strips of this many rows.
    fn begin(&self, tile: Tile, rows: u32, buffers: &mut Self::TileBuffers);

    /// Fills `rays`, which is empty, with what `samples` see.
    fn paint(&self, samples: &StripSamples, buffers: &mut Self::TileBuffers, rays: &mut RayBatch);
}

/// Samples of the pixels of a strip, pixel by pixel: their camera rays.
pub(super) struct StripSamples<'a> {
    pub strip: Strip,
    camera_rays: &'a CameraRays,
    /// Whether directions and W of the camera rays are needed.
    has_directions: bool,
    surfaces: &'a Surfaces<'a>,
    /// World time of the light's travel per metre; 0 if retardation is turned off.
    pub index: f64,
}

impl StripSamples<'_> {
    /// Fills `x` and `y` with the film points of the samples, pixels from the corner of the tile.
    pub fn points(&self, columns: &mut SampleColumns, points: [&mut Vec<f64>; 2]) {
        let Strip { rows, first, .. } = self.strip;
        let corner = [rows.corner[0], rows.corner[1] - first];
        (self.strip).points(columns, corner, self.camera_rays.offsets(), points);
    }

    /// Makes room for one ray for each sample in `rays`: the camera rays, if these are needed.
    pub fn start(&self, rays: &mut RayBatch) {
        match self.has_directions {
            true => {
                rays.ratios.clone_from(&self.camera_rays.ratios);
                rays.directions.clone_from(&self.camera_rays.directions);
            }
            // The values of rays without a hit are never read.
            false => {
                let count = self.strip.samples();
                rays.ratios.resize(count, 1.0);
                rays.directions.resize(count, DVec3::ZERO);
            }
        }
    }

    /// Resets a ray of `rays` to the camera ray of its sample, if these are needed.
    pub fn look(&self, sample: usize, rays: &mut RayBatch) {
        if self.has_directions {
            rays.ratios[sample] = self.camera_rays.ratios[sample];
            rays.directions[sample] = self.camera_rays.directions[sample];
        }
    }

    /// The corner of the tile, pixels of the film.
    pub fn tile_corner(&self) -> [f64; 2] {
        let Strip { rows, first, .. } = self.strip;
        let [left, top] = rows.corner;
        [left, top - first].map(f64::from)
    }

    /// The look direction of a sample.
    #[inline]
    pub fn direction(&self, sample: usize) -> Direction<World> {
        Direction::from_unit(self.camera_rays.directions[sample])
    }

    /// W of a sample for sources at rest in the world, as the sky is.
    #[inline]
    pub fn world_ratio(&self, sample: usize) -> f64 {
        self.camera_rays.ratios[sample]
    }

    /// The W that a ray along `d` must have for a source at rest in the world, so that a hit in rest frame `frame` is seen with the
    /// wavelength that the sample's own direction gives.
    #[inline]
    pub fn ratio(&self, sample: usize, frame: u32, d: Direction<World>) -> f64 {
        let (_, rho) = self.surfaces.direction(frame, self.direction(sample));
        self.ratio_of(self.world_ratio(sample) * rho, frame, d)
    }

    /// The same if the hit is seen with wavelength ratio `w`.
    #[inline]
    pub fn ratio_of(&self, w: f64, frame: u32, d: Direction<World>) -> f64 {
        let (_, rho) = self.surfaces.direction(frame, d);
        w / rho
    }
}

/// A scene, and its observer.
struct Stage<'a, P> {
    scene: &'a Prepared,
    visibility: &'a P,
    /// Whether directions and W of camera rays are needed.
    has_directions: bool,
    surfaces: Surfaces<'a>,
    /// The index of the medium; 1 if rays have their own delays.
    index: f64,
}

/// Buffers of one thread.
#[derive(Default)]
struct Buffers<T> {
    camera_rays: CameraRays,
    rays: RayBatch,
    sums: Vec<[f64; 3]>,
    pixels: Vec<u32>,
    shading: Shading,
    tile: T,
}

/// The film of `scene` as `visibility` renders it, in the memory of `over`.
pub(super) fn film<P: Visibility>(
    scene: &Prepared,
    visibility: &P,
    over: Option<Film>,
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
    // Rays without a hit need their own direction only if the background depends on it; channels need it too.
    let is_plain = matches!(scene.background, Background::Observed(_));
    let stage = Stage {
        scene,
        has_directions: !(visibility.turns_rays() && is_plain && scene.layout.channels.is_empty()),
        surfaces: Surfaces::unbuffered(
            &scene.frames,
            |frame| scene.camera.shot.event_in(frame),
            index,
        ),
        index,
        visibility,
    };
    paint(scene, visibility.samples_at_once(), &stage, over, progress)
}

/// Renders the strips of tiles.
pub(super) trait Painter: Sync {
    /// Buffers that are reused from tile to tile.
    type Buffers: Default;

    /// Prepares for `tile`, which is rasterized in strips of this many rows.
    fn begin(&self, tile: Tile, rows: u32, buffers: &mut Self::Buffers);

    /// Adds the radiance of `samples` of each pixel of `strip`, a part of `tile`, to the tile's film.
    fn paint(
        &self,
        strip: Strip,
        samples: Range<u32>,
        buffers: &mut Self::Buffers,
        film: (Tile, &mut TileFilm),
    );
}

/// The film of `scene` by `painter`, which takes at most this many samples of a pixel at a time, in the memory of `over`.
pub(super) fn paint<P: Painter>(
    scene: &Prepared,
    most: u32,
    painter: &P,
    over: Option<Film>,
    progress: &dyn Progress,
) -> Result<Film> {
    let layout = &scene.layout;
    Film::of_all_tiles(layout, over, |film| {
        let done = (0..Tile::count(layout.size))
            .into_par_iter()
            .try_for_each_init(Default::default, |(buffers, kept), index| {
                let tile = Tile::of_image(layout.size, index);
                let tile_film = TileFilm::reused(kept, tile, layout);
                // As many samples at a time as a film takes between the ends of its parts.
                let all = 0..layout.samples;
                let rows = Strip::height(tile_film.together(all.clone(), most).len() as u32);
                painter.begin(tile, rows, buffers);
                let mut left = all;
                while !left.is_empty() {
                    let samples = tile_film.together(left.clone(), most);
                    for strip in Strip::of(tile, rows, samples.len()) {
                        if progress.is_cancelled() || scene.light.has_failed() {
                            return Err(Error::Cancelled);
                        }
                        painter.paint(strip, samples.clone(), buffers, (tile, tile_film));
                        progress.rays_done(strip.samples() as u64);
                    }
                    left.start = samples.end;
                    tile_film.end_samples(samples);
                }
                film.place(tile_film);
                Ok(())
            });
        scene.light.check()?;
        done
    })
}

impl<P: Visibility> Painter for Stage<'_, P> {
    type Buffers = Buffers<P::TileBuffers>;

    fn begin(&self, tile: Tile, rows: u32, buffers: &mut Self::Buffers) {
        self.visibility.begin(tile, rows, &mut buffers.tile);
    }

    fn paint(
        &self,
        strip: Strip,
        samples: Range<u32>,
        buffers: &mut Self::Buffers,
        (tile, film): (Tile, &mut TileFilm),
    ) {
        let Buffers {
            camera_rays, rays, ..
        } = buffers;
        let Stage { scene, .. } = self;
        let generator = generator(&scene.camera.view);
        generator.place_by_pixel(camera_rays, &scene.sampler, strip.rows, samples);
        if self.has_directions {
            generator.look(camera_rays);
        }
        let strip_samples = StripSamples {
            strip,
            camera_rays,
            has_directions: self.has_directions,
            surfaces: &self.surfaces,
            index: scene.ray_index,
        };
        rays.clear(self.visibility.turns_rays());
        self.visibility
            .paint(&strip_samples, &mut buffers.tile, rays);
        self.shade(strip, tile, buffers, film);
    }
}

impl<P> Stage<'_, P> {
    /// Adds the radiance of the rays of `strip`, a part of `tile`, to `film`.
    fn shade<T>(&self, strip: Strip, tile: Tile, buffers: &mut Buffers<T>, film: &mut TileFilm) {
        let Buffers {
            camera_rays,
            rays,
            sums,
            pixels,
            shading,
            ..
        } = buffers;
        let scene = self.scene;
        // Without rays of their own, samples have their camera rays.
        let (directions, ratios) = match rays.directions.as_slice() {
            [] => (&camera_rays.directions, &camera_rays.ratios),
            _ => (&rays.directions, &rays.ratios),
        };
        let traced = TracedRays {
            surfaces: &self.surfaces,
            rays: Rays {
                directions,
                origins: (!rays.origins.is_empty()).then_some(&rays.origins),
                moments: &[],
                left: &[],
                method: scene.method,
                ratios,
                wavelengths: &[],
                samples: Default::default(),
            },
            hits: &rays.hits,
            event: scene.camera.shot.event,
            index: self.index,
        };
        let (radiance, background) = (scene.light.radiance(), &scene.background);
        let meter = &mut Meter::off();
        // One ray for each pixel or sample, or several weighted rays; then the background counts by sample, not by ray.
        if !rays.parts.is_empty() {
            let firsts = rays.firsts.iter();
            let unmet = firsts.filter(|ray| rays.hits.hit(**ray as usize).is_none());
            film.add_misses(unmet.count() as u64);
            let mut blend = Blend {
                parts: &rays.parts,
                sums: SampleSums::new(strip, sums, pixels, film),
            };
            shading.shade(radiance, &traced, background, ratios, &mut blend, meter);
            blend.sums.finish();
        } else if strip.is_all_of(tile) {
            shading.shade(radiance, &traced, background, ratios, film, meter);
        } else {
            let mut sums = SampleSums::new(strip, sums, pixels, film);
            shading.shade(radiance, &traced, background, ratios, &mut sums, meter);
            sums.finish();
        }
        // Channels have one value per sample, that of its first ray.
        let channels = scene.layout.channels.as_slice();
        if channels.is_empty() {
            return;
        }
        let samples = StripSamples {
            strip,
            camera_rays,
            has_directions: self.has_directions,
            surfaces: &self.surfaces,
            index: self.index,
        };
        for sample in 0..strip.samples() {
            let ray = rays.firsts.get(sample).map_or(sample, |ray| *ray as usize);
            let observed = traced.observed(ray, ratios[ray]);
            let d = samples.direction(sample);
            let offset = camera_rays.offset(sample);
            let pixel = strip.pixel(sample);
            record(
                channels,
                radiance,
                pixel,
                offset,
                Some(d),
                observed.as_ref(),
                film,
            );
        }
    }
}
