//! Pictures of uniformly shining surfaces, with the minimum of work per sample.
//!
//! If radiance depends only on the patch (colours, no lamps, no channels), a sample is the product of its patch's radiance L and the
//! observer's factor f(W), and pixels that see only one patch at W = 1, or nothing, are the same wherever their samples lie. So coverage is
//! first determined by pixel (`tile`). Sample positions are computed only for partly covered pixels, and where W differs from sample to
//! sample; W is computed only for samples that see something moving relative to the camera:
//!
//! ```text
//! W = W_camera(d′) W_rest(d),     d′ the direction in which the camera looks at the sample, d that in the world,
//! ```
//!
//! with the ray tracer's sums and products, added in its order: bit for bit the film that shading gives.

use std::ops::Range;

use super::draw::{Painter, SampleColumns, Strip};
use super::ratios::CameraRatios;
use super::tile::{Gathered, NOTHING, TileBuffers, WHOLE};
use super::triangles::{Triangles, is_front};
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::render::film::{Tile, TileFilm};
use crate::render::prepare::Prepared;
use crate::render::sampler::{Sampler, halves, pixel_key};
use crate::render::trace::{Background, Dependence, Scaling, weigh};

/// A black patch.
const BLACK: u32 = NOTHING - 1;

/// A scene of uniformly shining surfaces, with a background of one colour.
pub(super) struct Even<'a> {
    triangles: &'a Triangles<'a>,
    sampler: Sampler,
    ratios: CameraRatios<'a>,
    scaled: Scaling,
    /// The factor at W = 1.
    one: f64,
    background: [f64; 3],
    /// The patches of all frames, and where those of each begin.
    patches: Vec<EvenPatch>,
    firsts: Vec<u32>,
    /// By batch of triangles, whether W differs from sample to sample.
    batches_with_ratios: Vec<bool>,
}

/// The appearance of a patch.
#[derive(Debug, Clone, Copy)]
struct EvenPatch {
    radiance: [f64; 3],
    frame: u32,
    /// Whether W differs from sample to sample.
    has_ratios: bool,
}

/// Buffers that are reused from tile to tile.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    /// The current tile, and the number of rows of its strips.
    tile: Option<(Tile, u32)>,
    triangles: TileBuffers,
    /// By triangle of the tile, its patch, or [`BLACK`]; [`NOTHING`] if it has not been looked up.
    patches: Vec<u32>,
    samples: Positions,
    runs: Vec<PatchRun>,
    /// Film points of the samples whose W is needed.
    x: Vec<f64>,
    y: Vec<f64>,
    ratios: Vec<f64>,
    factors: Vec<f64>,
}

/// The positions of the samples of a strip.
#[derive(Debug, Default)]
struct Positions {
    keys: Vec<u64>,
    /// In pixels, from the corner of each pixel.
    x: Vec<f64>,
    y: Vec<f64>,
    columns: SampleColumns,
}

/// Consecutive samples that see the same patch.
#[derive(Debug, Clone, Copy)]
struct PatchRun {
    /// Its number, [`BLACK`] or [`NOTHING`].
    patch: u32,
    samples: u32,
    /// The index of its first W, if it has any.
    at: u32,
}

impl<'a> Even<'a> {
    /// Returns the painter; `None` if radiance depends on more than the patch, or a channel is needed.
    pub fn new(scene: &'a Prepared, triangles: &'a Triangles<'a>) -> Option<Self> {
        let (scaled, radiance) = scene.light.radiance().even()?;
        let Background::Observed(background) = scene.background else {
            return None;
        };
        if triangles.needed > Dependence::Patch
            || triangles.has_holes
            || scene.light.radiance().has_gaps()
        {
            return None;
        }
        let ratios = CameraRatios::of(&scene.camera)?;
        let (mut patches, mut firsts) = (Vec::new(), Vec::new());
        for (frame, rest) in (0..).zip(triangles.frames) {
            firsts.push(patches.len() as u32);
            let is_still = rest.frame.frame_from_world().is_identity();
            for patch in &rest.patches {
                patches.push(EvenPatch {
                    radiance: *radiance.get(patch.emitter as usize)?,
                    frame,
                    has_ratios: ratios.differ() || !is_still,
                });
            }
        }
        let has_ratios = |frame: u32| {
            let first = patches.get(firsts[frame as usize] as usize);
            first.is_some_and(|patch: &EvenPatch| patch.has_ratios)
        };
        let batches = triangles.batches.iter();
        let mut one = Vec::new();
        weigh(scaled, &[1.0], &mut one);
        Some(Even {
            one: one[0],
            batches_with_ratios: batches.map(|batch| has_ratios(batch.frame)).collect(),
            triangles,
            sampler: scene.sampler,
            ratios,
            scaled,
            background,
            patches,
            firsts,
        })
    }

    /// The number of the patch of a triangle.
    fn patch_of(&self, triangle: &Gathered) -> u32 {
        let batch = &self.triangles.batches[triangle.batch as usize];
        let rest = &self.triangles.frames[batch.frame as usize];
        let first = self.firsts[batch.frame as usize];
        // The usual case needs neither the search nor the test of the side.
        if let [only] = rest.patches.as_slice()
            && !only.black_back
        {
            return first;
        }
        let slot = batch.pieces[triangle.piece as usize].slot;
        let (triangle, _) = rest.bvh.triangle(slot);
        // Patches are in the order of their first triangles.
        let after = (rest.patches).partition_point(|patch| patch.first <= triangle);
        let own = after.max(1) - 1;
        let projection = &self.triangles.projections[batch.frame as usize];
        match rest.patches[own].black_back && !is_front(rest.bvh.corners(slot), projection) {
            true => BLACK,
            false => first + own as u32,
        }
    }
}

impl Painter for Even<'_> {
    type Buffers = Buffers;

    fn begin(&self, tile: Tile, rows: u32, buffers: &mut Buffers) {
        buffers.triangles.start();
        buffers.tile = Some((tile, rows));
    }

    fn paint(
        &self,
        strip: Strip,
        samples: Range<u32>,
        buffers: &mut Buffers,
        (tile, film): (Tile, &mut TileFilm),
    ) {
        let Buffers {
            tile: Some((_, rows)),
            triangles,
            patches,
            samples: positions,
            runs,
            x,
            y,
            ratios,
            factors,
        } = buffers
        else {
            return;
        };
        let pieces = self.triangles.pieces();
        // The sample positions, and the triangle that each sample sees.
        positions.start(&strip);
        let are_pixels = strip.each.is_multiple_of(WHOLE);
        let has_more = match strip.is_all_of(tile) {
            true => true,
            false => triangles.complete(&pieces, tile, *rows),
        };
        if are_pixels {
            let is_sampled = triangles.begin_pixels(&strip, &self.batches_with_ratios);
            positions.sample(&self.sampler, samples.clone(), is_sampled);
            let Positions { keys, x, y, .. } = &mut *positions;
            let mut sample = |pixel: usize, x: &mut [f64], y: &mut [f64]| {
                let own = pixel * strip.each..(pixel + 1) * strip.each;
                let keys = &keys[pixel..=pixel];
                let (x, y) = (&mut x[own.clone()], &mut y[own]);
                (self.sampler).offsets_by_pixel(keys, samples.clone(), x, y);
            };
            triangles.cover_pixels(&strip, (x, y), &mut sample);
        } else {
            positions.sample_run(&self.sampler, samples, 0..strip.rows.pixels());
            positions.points(&strip, tile.corner, [x, y]);
            match strip.is_all_of(tile) {
                true => triangles.cover_tile(&pieces, tile, x, y),
                false => triangles.cover(&strip, x, y),
            }
        }
        if has_more {
            patches.clear();
            patches.resize(triangles.triangles.len(), NOTHING);
        }
        // The patch that each sample sees.
        runs.clear();
        let see = |triangle: u32, samples: usize| {
            let patch = match patches.get_mut(triangle as usize) {
                None => NOTHING,
                Some(known) => {
                    // Once per triangle of the tile, however many samples see it.
                    if *known == NOTHING {
                        *known = self.patch_of(&triangles.triangles[triangle as usize]);
                    }
                    *known
                }
            };
            match runs.last_mut() {
                Some(last) if last.patch == patch => last.samples += samples as u32,
                _ => runs.push(PatchRun {
                    patch,
                    samples: samples as u32,
                    at: 0,
                }),
            }
        };
        match are_pixels {
            true => triangles.each_run_of_pixels(&strip, see),
            false => triangles.each_run(strip.samples(), see),
        }
        // W of the samples that need it, frame by frame, in the order of samples.
        let has_ratios = |run: &PatchRun| {
            let known = self.patches.get(run.patch as usize);
            known.is_some_and(|patch| patch.has_ratios)
        };
        let all_have_ratios = runs.iter().all(has_ratios);
        x.clear();
        y.clear();
        if all_have_ratios {
            positions.points(&strip, [0; 2], [x, y]);
        }
        let mut begin = 0;
        for run in &mut *runs {
            let own = begin..begin + run.samples as usize;
            // W of a run begin at its first sample, or at the end of what other runs have appended.
            run.at = if all_have_ratios { begin } else { x.len() } as u32;
            begin = own.end;
            if has_ratios(run) && !all_have_ratios {
                positions.append(strip.each, own, [x, y]);
            }
        }
        ratios.resize(x.len(), 0.0);
        let mut frames = runs.iter().filter_map(|run| {
            let patch = self.patches.get(run.patch as usize)?;
            patch.has_ratios.then_some((patch.frame, run.at as usize))
        });
        let mut next = frames.next();
        // Runs of one frame that follow each other have their W computed together.
        while let Some((frame, begin)) = next {
            next = frames.find(|(other, _)| *other != frame);
            let end = next.map_or(x.len(), |(_, begin)| begin);
            let own = begin..end;
            let points = [&x[own.clone()], &y[own.clone()]];
            let rest = self.triangles.frames[frame as usize]
                .frame
                .frame_from_world();
            (self.ratios).fill(rest, points, [0.0; 2], &mut ratios[own]);
        }
        weigh(self.scaled, ratios, factors);
        let unmet = runs.iter().filter(|run| run.patch == NOTHING);
        film.add_misses(unmet.map(|run| u64::from(run.samples)).sum());
        dispatch(AddUp {
            even: self,
            strip: &strip,
            runs,
            factors,
            film,
        });
    }
}

impl Positions {
    /// Empty runs for `strip`.
    fn start(&mut self, strip: &Strip) {
        let Tile {
            corner: [left, top],
            size: [width, height],
        } = strip.rows;
        self.keys.clear();
        for row in top..top + height {
            (self.keys).extend((left..left + width).map(|column| pixel_key(column, row)));
        }
        self.x.resize(strip.samples(), 0.0);
        self.y.resize(strip.samples(), 0.0);
    }

    /// Computes the sample positions of some pixels.
    fn sample(&mut self, sampler: &Sampler, samples: Range<u32>, is_sampled: &[bool]) {
        let mut begin = 0;
        for alike in is_sampled.chunk_by(|a, b| a == b) {
            let own = begin..begin + alike.len();
            begin = own.end;
            if alike[0] {
                self.sample_run(sampler, samples.clone(), own);
            }
        }
    }

    /// Computes the sample positions of consecutive pixels.
    fn sample_run(&mut self, sampler: &Sampler, samples: Range<u32>, pixels: Range<usize>) {
        let each = samples.len();
        let keys = &mut self.keys[pixels.clone()];
        let own = pixels.start * each..pixels.end * each;
        let (x, y) = (&mut self.x[own.clone()], &mut self.y[own]);
        let (within, salt) = sampler.replicate(samples.start);
        match (each, salt) {
            (1, 0) => sampler.offsets(keys, within, x, y),
            (1, salt) => {
                // The salt turns each key into the replicate's key, and when applied again back into the pixel's.
                keys.iter_mut().for_each(|key| *key ^= salt);
                sampler.offsets(keys, within, x, y);
                keys.iter_mut().for_each(|key| *key ^= salt);
            }
            _ => sampler.offsets_by_pixel(keys, samples, x, y),
        }
    }

    /// Sets `to` to the film points of all samples of `strip`, pixels from `corner`.
    fn points(&mut self, strip: &Strip, corner: [u32; 2], to: [&mut Vec<f64>; 2]) {
        strip.points(&mut self.columns, corner, [&self.x, &self.y], to);
    }

    /// Appends the film points of some samples, `each` per pixel, to `x` and `y`.
    fn append(&self, each: usize, samples: Range<usize>, [x, y]: [&mut Vec<f64>; 2]) {
        let from = x.len();
        x.extend_from_slice(&self.x[samples.clone()]);
        y.extend_from_slice(&self.y[samples.clone()]);
        let (x, y) = (&mut x[from..], &mut y[from..]);
        if each == 1 {
            for ((x, y), key) in x.iter_mut().zip(y).zip(&self.keys[samples]) {
                let [column, row] = halves(*key);
                (*x, *y) = (column + *x, row + *y);
            }
            return;
        }
        // The range may begin and end in the middle of a pixel's samples.
        let (mut pixel, mut begin) = (samples.start / each, 0);
        let mut end = ((pixel + 1) * each - samples.start).min(x.len());
        while begin < x.len() {
            let [column, row] = halves(self.keys[pixel]);
            for (x, y) in x[begin..end].iter_mut().zip(&mut y[begin..end]) {
                (*x, *y) = (column + *x, row + *y);
            }
            (pixel, begin) = (pixel + 1, end);
            end = (end + each).min(x.len());
        }
    }
}

/// The loop over runs that adds their radiance to their pixels, sample by sample.
struct AddUp<'a> {
    even: &'a Even<'a>,
    strip: &'a Strip,
    runs: &'a [PatchRun],
    factors: &'a [f64],
    film: &'a mut TileFilm,
}

impl VectorLoop for AddUp<'_> {
    #[inline(always)]
    fn run(self) {
        let each = self.strip.each;
        let (mut pixel, mut left) = (self.strip.pixel(0), each);
        let end = pixel + self.strip.rows.pixels();
        // Four lanes fill a vector; the fourth adds zeros.
        let mut sum = wide(*self.film.sum_mut(pixel));
        for run in self.runs {
            let (colour, factors) = match self.even.patches.get(run.patch as usize) {
                Some(patch) => {
                    let own = match patch.has_ratios {
                        true => self.factors.get(run.at as usize..).unwrap_or_default(),
                        false => &[],
                    };
                    (wide(patch.radiance), own)
                }
                None if run.patch == BLACK => ([0.0; 4], [].as_slice()),
                None => (wide(self.even.background), [].as_slice()),
            };
            let is_seen = run.patch < BLACK;
            // One sample for each pixel.
            if each == 1 {
                let own = pixel..pixel + run.samples as usize;
                pixel = own.end;
                let factor = if is_seen { self.even.one } else { 1.0 };
                match factors {
                    [] => {
                        for sum in self.film.sums_mut(own) {
                            add(sum, factor, colour);
                        }
                    }
                    factors => {
                        for (sum, factor) in self.film.sums_mut(own).iter_mut().zip(factors) {
                            add(sum, *factor, colour);
                        }
                    }
                }
                continue;
            }
            let (mut at, mut samples) = (0, run.samples as usize);
            while samples > 0 {
                let now = samples.min(left);
                match factors.get(at..at + now) {
                    Some(factors) if !factors.is_empty() => {
                        for factor in factors {
                            for k in 0..4 {
                                sum[k] += factor * colour[k];
                            }
                        }
                    }
                    _ => {
                        let factor = if is_seen { self.even.one } else { 1.0 };
                        // One at a time, like the ray tracer: a product with their number would be rounded differently.
                        for _ in 0..now {
                            for k in 0..4 {
                                sum[k] += factor * colour[k];
                            }
                        }
                    }
                }
                at += now;
                samples -= now;
                left -= now;
                if left == 0 {
                    let [r, g, b, _] = sum;
                    *self.film.sum_mut(pixel) = [r, g, b];
                    (pixel, left) = (pixel + 1, each);
                    if pixel < end {
                        sum = wide(*self.film.sum_mut(pixel));
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn add(sum: &mut [f64; 3], factor: f64, [r, g, b, _]: [f64; 4]) {
    for (sum, value) in sum.iter_mut().zip([r, g, b]) {
        *sum += factor * value;
    }
}

/// Three numbers in a vector of four.
#[inline(always)]
fn wide([r, g, b]: [f64; 3]) -> [f64; 4] {
    [r, g, b, 0.0]
}
