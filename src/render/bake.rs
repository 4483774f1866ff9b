//! Baking: time-resolved light of what rests relative to each other, as cubes that any moving camera can look up.
//!
//! A cube holds for each pixel of a camera, or each texel of a surface, the energy of its radiance in each bin of time: the integral of
//! L over the bin, mean over pixel or texel. Paths come from `TimedPaths`; the light of one path goes into all bins in which its lamps' emission
//! arrives, so that the cost is that of the paths, whatever the number of bins. Pixels and texels are each summed by one thread,
//! sample by sample: the bits do not depend on the threads. Tiles of pixels and rows of texels are kept in a [`Journal`] as they are
//! done, where one is given.
//!
//! # The standard error
//!
//! The samples of a texel are R = 2 or more independent parts ([`sampler`](crate::render::sampler)). With the sums S_k of part k in a bin, the
//! numbers f_k of its samples that lie on the surface, and m = Σ S_k/Σ f_k what is baked,
//!
//! ```text
//! standard error² = R/(R − 1) Σ (S_k − m f_k)²/(Σ f_k)²
//! ```
//!
//! (Cochran, Sampling Techniques, § 6.4; of equal f_k it is the variance of R means over R). Of each bin the root of the mean square over all
//! texels is told.
//!
//! A camera's times are those of arrival: of emission at the surface, by the world's clock (or the object's own where all moves), plus η
//! times the *distance* to the pinhole, as in mitransient with `camera_unwarp = false`, whose arrays (H, W, T, C) these are. A surface's times
//! are those of emission, and its radiance is the diffuse part, which is the same for all directions.

use std::sync::{Mutex, PoisonError};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::accel::{Hit, Ray};
use crate::error::{Error, Result};
use crate::io::cube::{Cube, Samples};
use crate::light::Received;
use crate::light::lamp::Lamp;
use crate::render::film::{TILE, Tile};
use crate::render::journal::Journal;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::sampler::{Sampler, pixel_key, samples_per_part, sobol};
use crate::render::trace::{CameraRays, Patch, RayGenerator, RestFrame, TimedPaths};
use crate::scene::model::{LightKind, Motion, ProjectionKind, Scene, SourceKind};
use crate::spacetime::{Direction, Velocity};

/// Bins of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bins {
    /// Time at the start of bin 0, metres.
    pub start: f64,
    /// Width of a bin, metres, above 0.
    pub width: f64,
    /// How many, at least 1.
    pub count: usize,
}

/// Energy of light by when it arrives, sums over all pixels or texels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    /// In bins, before the first and after the last.
    pub held: f64,
    /// Before the first.
    pub before: f64,
    /// After the last.
    pub after: f64,
    /// When the first light begins to arrive, and when the last has arrived; none where it is dark.
    pub span: Option<[f64; 2]>,
}

/// A baked cube.
#[derive(Debug, Clone)]
pub struct Baked {
    /// Energy per bin, (H, W, T, 3), linear RGB, f32.
    pub cube: Cube,
    /// Of each bin, the root of the mean square over pixels or texels of the standard error of its energy (mean of R, G, B); NaN of one sample.
    pub standard_error: Vec<f64>,
    /// What is in it, and what is not.
    pub energy: Energy,
    /// Whether its times are those of the object's own clock, and not of the world's.
    pub own_clock: bool,
}

impl Baked {
    /// The root of the mean square over all bins of the standard error, over that of the energy.
    pub fn relative_error(&self) -> f64 {
        let bins = self.standard_error.len().max(1);
        let errors: f64 = self.standard_error.iter().map(|e| e * e).sum();
        let [h, w, t, _] = self.cube.shape;
        let texels = (0..h * w).flat_map(|texel| (0..t).map(move |bin| (texel, bin)));
        let square = |(texel, bin)| (self.cube.total(texel, bin) / 3.0).powi(2);
        let squares: f64 = texels.map(square).sum();
        let mean = squares / (h * w * t) as f64;
        match mean > 0.0 {
            true => (errors / bins as f64 / mean).sqrt(),
            false => 0.0,
        }
    }
}

/// Parts of the samples of a texel: few, as samples of one part are spread more evenly, and the error is a mean over many texels.
const PARTS: u32 = 2;

/// Bytes of a cube of `size` (columns and rows) and `bins`, and of what is summed at a time on this many threads.
pub fn bytes(size: [u32; 2], bins: &Bins, threads: usize) -> u64 {
    let texels = u64::from(size[0]) * u64::from(size[1]);
    let bins = bins.count as u64;
    // A tile of sums: two of three channels, two for the error, each f64; and what it becomes.
    let tile = u64::from(TILE * TILE).min(texels) * bins * (8 * 8 + 12);
    let cube = texels.saturating_mul(bins).saturating_mul(12);
    cube.saturating_add(tile.saturating_mul(threads as u64))
}

/// Refuses scenes whose light cannot be baked.
///
/// # Errors
/// Bodies or lamps that move relative to each other, light without an end, no lamps.
pub fn check(scene: &Scene) -> Result<()> {
    let refuse = |place: String, what: String, help: &str| {
        Err(Error::invalid(&scene.name, place, what, help))
    };
    let Some(first) = scene.objects.first() else {
        return Ok(());
    };
    let moves = |velocity: Velocity| {
        let difference = velocity.rapidity() - first.velocity.rapidity();
        difference.length() > 1e-12
    };
    if let Some(other) = scene.objects.iter().find(|o| moves(o.velocity)) {
        let what = format!("it moves relative to \"{}\"", first.name);
        let help = "bake what rests relative to each other, each in a scene of its own, or follow light with `render.bounces`";
        return refuse(format!("object \"{}\"", other.name), what, help);
    }
    for light in &scene.lights {
        let place = format!("light \"{}\"", light.name);
        let LightKind::Lamp(lamp) = &light.kind else {
            let what = "a surface that shines does so steadily, which has no place in bins of time";
            return refuse(
                place,
                what.into(),
                "leave it out, or follow light with `render.bounces`",
            );
        };
        if lamp.motion != Motion::Inertial || moves(lamp.velocity) {
            let what = format!("it moves relative to \"{}\"", first.name);
            let help = "a lamp that rests with the objects, or `render.bounces`";
            return refuse(place, what, help);
        }
        let end = Lamp::new(lamp, Received::Scaled(scene.quantity), false, lamp.origin);
        if end.emission_span().is_none() {
            let what = "it shines for ever, which has no place in bins of time";
            let help = "give it an emission with an end, like emission = { gaussian = { sigma = \"5 cm\" } }, or follow light with `render.bounces`";
            return refuse(place, what.into(), help);
        }
    }
    if scene.sky.as_ref().is_some_and(|sky| sky.lights) {
        let what = "it lights surfaces steadily, which has no place in bins of time";
        return refuse("sky".into(), what.into(), "set sky.lights = false");
    }
    let pulses = scene
        .sources
        .iter()
        .filter(|s| matches!(s.kind, SourceKind::Pulse(_)));
    if let Some(pulse) = pulses.clone().next().filter(|_| !first.velocity.is_rest()) {
        let what = format!(
            "a pulse leaves a place at rest in the world, and \"{}\" moves",
            first.name
        );
        let help = "a [[light]] of the same velocity, with a Gaussian emission";
        return refuse(format!("source \"{}\"", pulse.name), what, help);
    }
    if scene.lights.is_empty() && pulses.count() == 0 {
        let help =
            "add [[light]] with an emission, like emission = { gaussian = { sigma = \"5 cm\" } }";
        return refuse("light".into(), "there is no light to bake".into(), help);
    }
    Ok(())
}

/// Energy per bin of one pixel or texel.
struct Histogram {
    /// Of the part that is being taken: sums by bin and channel, and how many samples.
    part: Vec<f64>,
    found: u32,
    /// Of all parts before it.
    values: Vec<f64>,
    all_found: u32,
    parts: u32,
    /// Σ f².
    found_squares: f64,
    /// By bin Σ S² and Σ S f, with S the mean of the channels.
    squares: Vec<[f64; 2]>,
    energy: Energy,
}

impl Histogram {
    fn new(bins: &Bins) -> Self {
        Histogram {
            part: vec![0.0; 3 * bins.count],
            found: 0,
            values: vec![0.0; 3 * bins.count],
            all_found: 0,
            parts: 0,
            found_squares: 0.0,
            squares: vec![[0.0; 2]; bins.count],
            energy: Energy::NONE,
        }
    }

    /// Ends a part.
    fn end_part(&mut self) {
        if self.found == 0 {
            return;
        }
        let f = f64::from(self.found);
        for (bin, [squares, with_found]) in self.squares.iter_mut().enumerate() {
            let part = &mut self.part[3 * bin..3 * bin + 3];
            let s = (part[0] + part[1] + part[2]) / 3.0;
            *squares += s * s;
            *with_found += s * f;
            for (sum, part) in self.values[3 * bin..].iter_mut().zip(part) {
                *sum += *part;
                *part = 0.0;
            }
        }
        self.all_found += self.found;
        self.found_squares += f * f;
        self.parts += 1;
        self.found = 0;
    }

    /// The square of the standard error in a bin.
    fn error_square(&self, bin: usize) -> f64 {
        let (n, r) = (f64::from(self.all_found), f64::from(self.parts));
        let m = self.values[3 * bin..3 * bin + 3].iter().sum::<f64>() / (3.0 * n);
        let [squares, with_found] = self.squares[bin];
        // Σ (S − m f)².
        let spread = squares - 2.0 * m * with_found + m * m * self.found_squares;
        r / (r - 1.0) * spread.max(0.0) / (n * n)
    }

    /// Adds `light` times the emission of `lamp` at its proper times, which are `delay` before those of the bins.
    fn add(&mut self, bins: &Bins, lamp: &Lamp, light: [f64; 3], delay: f64) {
        let Some([from, to]) = lamp.emission_span() else {
            return;
        };
        if !delay.is_finite() || !light.iter().all(|c| c.is_finite()) {
            return;
        }
        let bin = |time: f64| (time + delay - bins.start) / bins.width;
        let first = (bin(from).max(0.0) as usize).min(bins.count);
        let end = (bin(to).ceil().max(0.0) as usize).min(bins.count);
        let edge = |bin: usize| bins.start + bin as f64 * bins.width - delay;
        let until = |bin: usize| lamp.emitted_until(edge(bin));
        let mean = (light[0] + light[1] + light[2]) / 3.0;
        // Most paths have all of their light in the bins: its integral is not asked for before it begins and after it ends.
        let begun = if edge(first) <= from {
            0.0
        } else {
            until(first)
        };
        let mut before = begun;
        for bin in first..end {
            let after = until(bin + 1);
            for (value, light) in self.part[3 * bin..3 * bin + 3].iter_mut().zip(light) {
                *value += light * (after - before);
            }
            before = after;
        }
        let span = [from + delay, to + delay];
        self.energy.add(&Energy {
            held: mean * (before - begun),
            before: mean * begun,
            after: match edge(end) >= to {
                true => 0.0,
                false => mean * (lamp.emitted_until(to) - before),
            },
            span: Some(span),
        });
    }
}

impl Energy {
    const NONE: Energy = Energy {
        held: 0.0,
        before: 0.0,
        after: 0.0,
        span: None,
    };

    fn add(&mut self, other: &Energy) {
        self.held += other.held;
        self.before += other.before;
        self.after += other.after;
        self.span = match (self.span, other.span) {
            (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
            (span, None) => span,
            (None, span) => span,
        };
    }
}

/// What becomes of a tile of pixels or a row of texels.
#[derive(Debug, Default)]
struct Part {
    /// Energy by texel, bin and channel.
    values: Vec<f32>,
    /// By texel, whether there is any surface.
    covered: Vec<bool>,
    summary: Summary,
}

/// What is summed over texels.
#[derive(Debug)]
struct Summary {
    energy: Energy,
    /// By bin, Σ of the squares of standard errors.
    error_squares: Vec<f64>,
    /// Of so many texels.
    texels: u64,
}

impl Default for Summary {
    fn default() -> Self {
        Summary {
            energy: Energy::NONE,
            error_squares: Vec::new(),
            texels: 0,
        }
    }
}

impl Part {
    fn new(bins: &Bins) -> Self {
        let mut part = Part::default();
        part.summary.error_squares = vec![0.0; bins.count];
        part
    }

    /// Adds the next texel.
    fn push(&mut self, texel: &Histogram) {
        let n = texel.all_found;
        self.covered.push(n > 0);
        if n == 0 {
            let blank = std::iter::repeat_n(0.0, texel.values.len());
            return self.values.extend(blank);
        }
        let scale = 1.0 / f64::from(n);
        let means = texel.values.iter().map(|sum| (sum * scale) as f32);
        self.values.extend(means);
        self.summary.energy.add(&texel.energy);
        self.summary.texels += 1;
        for (bin, sum) in self.summary.error_squares.iter_mut().enumerate() {
            *sum += texel.error_square(bin);
        }
    }

    fn to_bytes(&self) -> Vec<u8> {
        let Summary {
            energy,
            error_squares,
            texels,
        } = &self.summary;
        let [from, to] = energy.span.unwrap_or([f64::NAN; 2]);
        let numbers = [energy.held, energy.before, energy.after, from, to];
        let mut bytes = texels.to_le_bytes().to_vec();
        let numbers = numbers.iter().chain(error_squares);
        bytes.extend(numbers.flat_map(|x| x.to_le_bytes()));
        bytes.extend(self.covered.iter().map(|covered| u8::from(*covered)));
        bytes.extend(self.values.iter().flat_map(|x| x.to_le_bytes()));
        bytes
    }

    /// Of so many texels; none where that is not what these bytes are.
    fn from_bytes(bytes: &[u8], texels: usize, bins: usize) -> Option<Part> {
        let (count, rest) = bytes.split_first_chunk::<8>()?;
        let (numbers, rest) = rest.split_at_checked(8 * (5 + bins))?;
        let (covered, values) = rest.split_at_checked(texels)?;
        let (values, left) = values.as_chunks::<4>();
        if values.len() != 3 * texels * bins || !left.is_empty() {
            return None;
        }
        let numbers = numbers.as_chunks::<8>().0.iter();
        let numbers: Vec<f64> = numbers.map(|x| f64::from_le_bytes(*x)).collect();
        let span = [numbers[3], numbers[4]];
        let energy = Energy {
            held: numbers[0],
            before: numbers[1],
            after: numbers[2],
            span: (!span[0].is_nan()).then_some(span),
        };
        Some(Part {
            values: values.iter().map(|x| f32::from_le_bytes(*x)).collect(),
            covered: covered.iter().map(|covered| *covered == 1).collect(),
            summary: Summary {
                energy,
                error_squares: numbers[5..].to_vec(),
                texels: u64::from_le_bytes(*count),
            },
        })
    }
}

/// Part `index` of the work, of `texels` texels: from the journal, or else made by `make` and added to it.
fn kept(
    journal: Option<&Journal>,
    index: usize,
    [texels, bins]: [usize; 2],
    make: impl FnOnce() -> Result<Part>,
) -> Result<Part> {
    let Some(journal) = journal else {
        return make();
    };
    let bytes = journal.part(index as u64)?;
    if let Some(part) = bytes.and_then(|bytes| Part::from_bytes(&bytes, texels, bins)) {
        return Ok(part);
    }
    let part = make()?;
    journal.add(index as u64, &part.to_bytes())?;
    Ok(part)
}

/// The cube of the scene's camera, which rests relative to all objects; tiles are kept in `journal`, where there is one.
///
/// # Errors
/// What [`check`] refuses, a camera that moves relative to the objects, I/O errors of the journal, and [`Error::Cancelled`] when `progress` says so.
pub fn camera_cube(
    scene: &Scene,
    prepared: &Prepared,
    bins: &Bins,
    journal: Option<&Journal>,
    progress: &dyn Progress,
) -> Result<Baked> {
    check(scene)?;
    check_camera(scene)?;
    let paths = paths(scene, prepared)?;
    let layout = &prepared.layout;
    let per_part = samples_per_part(layout.samples, PARTS);
    let sampler = match layout.pixel_centers {
        true => prepared.sampler,
        false => prepared.sampler.with_samples(per_part),
    };
    let [width, height] = layout.size.map(|n| n as usize);
    let mut values = vec![0f32; width * height * bins.count * 3];
    let placed = Mutex::new(&mut values);
    let make = |tile: Tile, rays: &mut CameraRays| {
        let mut pixels: Vec<_> = (0..tile.pixels()).map(|_| Histogram::new(bins)).collect();
        for sample in 0..layout.samples {
            progress.check()?;
            let place = (tile, sample);
            sample_tile(prepared, &paths, (bins, &sampler), place, rays, &mut pixels);
            if (sample + 1).is_multiple_of(per_part) {
                pixels.iter_mut().for_each(Histogram::end_part);
            }
        }
        let mut part = Part::new(bins);
        pixels.iter().for_each(|pixel| part.push(pixel));
        Ok(part)
    };
    let tiles = (0..Tile::count(layout.size) as usize).into_par_iter();
    let summaries: Vec<Summary> = tiles
        .map_init(CameraRays::default, |rays, index| {
            let tile = Tile::of_image(layout.size, index as u64);
            let size = [tile.pixels(), bins.count];
            let part = kept(journal, index, size, || make(tile, rays))?;
            progress.rays_done(tile.pixels() as u64 * u64::from(layout.samples));
            // A poisoned lock means a panic elsewhere, which rayon passes on.
            let mut values = placed.lock().unwrap_or_else(PoisonError::into_inner);
            let pixels = part.values.chunks(3 * bins.count);
            for ((column, row), pixel) in tile.coordinates().zip(pixels) {
                let first = (row as usize * width + column as usize) * bins.count * 3;
                values[first..first + pixel.len()].copy_from_slice(pixel);
            }
            Ok(part.summary)
        })
        .collect::<Result<_>>()?;
    baked(scene, prepared, [height, width], bins, values, &summaries)
}

/// Adds one sample to each pixel of a tile.
fn sample_tile(
    prepared: &Prepared,
    paths: &TimedPaths,
    (bins, sampler): (&Bins, &Sampler),
    (tile, sample): (Tile, u32),
    rays: &mut CameraRays,
    pixels: &mut [Histogram],
) {
    let view = &prepared.camera.view;
    view.generate(rays, sampler, tile, sample);
    let (within, salt) = sampler.replicate(sample);
    let frame = &paths.rest.frame;
    let boost = frame.frame_from_world();
    let shot = frame.event_from_world(prepared.camera.shot.event);
    let traced = rays.rays(prepared.method);
    let keys = tile.coordinates();
    for (ray, ((column, row), pixel)) in keys.zip(pixels).enumerate() {
        pixel.found += 1;
        let origin = traced.origin(ray);
        let d = Direction::from_unit(traced.directions[ray]);
        let d = boost.direction(d).0.unit();
        let origin = shot.x + boost.displacement(origin.displacement).x;
        let Some(hit) = nearest(paths.rest, origin, d) else {
            continue;
        };
        let clock = paths.clock(paths.rest.patch(hit.triangle));
        let key = (pixel_key(column, row) ^ salt, within);
        paths.follow((origin, d), hit, key, |lamp, light, delay| {
            pixel.add(bins, lamp, light, delay + clock);
        });
    }
}

fn nearest(rest: &RestFrame, origin: DVec3, direction: DVec3) -> Option<Hit> {
    let ray = Ray {
        origin,
        direction,
        s_min: 0.0,
    };
    rest.bvh.closest(&ray, f64::INFINITY)
}

/// The pinhole of the camera as [`camera_cube`] has it, where a capture camera is given: in the world, or in the coordinates of the
/// first object where all moves.
pub fn eye(scene: &Scene, prepared: &Prepared) -> DVec3 {
    let event = prepared.camera.shot.event;
    let Some(rest) = prepared
        .frames
        .first()
        .filter(|f| !f.frame.velocity().is_rest())
    else {
        return event.x;
    };
    let origin = scene
        .objects
        .first()
        .map_or(rest.frame.origin(), |o| o.origin);
    rest.frame.event_from_world(event).x - rest.frame.event_from_world(origin).x
}

fn check_camera(scene: &Scene) -> Result<()> {
    let camera = &scene.camera;
    let refuse = |what: &str| {
        let help = "a plain camera that rests with the objects; the cube can then be looked at by any other";
        Err(Error::invalid(&scene.name, "camera", what, help))
    };
    let objects = scene.objects.first().map(|o| o.velocity.rapidity());
    let difference = objects.map_or(0.0, |w| (w - camera.velocity.rapidity()).length());
    if difference > 1e-12 || camera.motion != Motion::Inertial {
        return refuse("it moves relative to the objects");
    }
    if camera.projection != ProjectionKind::Perspective {
        return refuse("a capture camera has a flat film, and this one has another projection");
    }
    if camera.shutter.is_some()
        || camera.sensor.is_some()
        || camera.rotation.is_some()
        || camera.stereo.is_some()
    {
        return refuse(
            "a cube is that of one pinhole, without a shutter, a moving sensor or a second eye",
        );
    }
    Ok(())
}

fn paths<'a>(scene: &Scene, prepared: &'a Prepared) -> Result<TimedPaths<'a>> {
    let rest = prepared.frames.first();
    match (rest, prepared.light.time_resolved()) {
        (Some(rest), Some(light)) if prepared.frames.len() == 1 => Ok(TimedPaths {
            rest,
            light,
            bounces: scene.bounces,
        }),
        _ => Err(Error::invalid(
            &scene.name,
            "light",
            "no surface reflects any light",
            "objects that rest relative to each other, with lamps that light them",
        )),
    }
}

fn baked(
    scene: &Scene,
    prepared: &Prepared,
    [height, width]: [usize; 2],
    bins: &Bins,
    values: Vec<f32>,
    summaries: &[Summary],
) -> Result<Baked> {
    let mut energy = Energy::NONE;
    summaries.iter().for_each(|part| energy.add(&part.energy));
    let texels: u64 = summaries.iter().map(|part| part.texels).sum();
    let square = |bin: usize| {
        summaries
            .iter()
            .map(|part| part.error_squares[bin])
            .sum::<f64>()
    };
    let standard_error = (0..bins.count).map(|bin| (square(bin) / texels as f64).sqrt());
    let standard_error = standard_error.collect();
    let cube = Cube::new([height, width, bins.count, 3], Samples::F32(values));
    let cube = cube.map_err(|e| {
        let help = "lamps whose light f32 can hold";
        Error::invalid(&scene.name, "light", e.to_string(), help)
    })?;
    let still = |frame: &RestFrame| frame.frame.velocity().is_rest();
    Ok(Baked {
        cube,
        standard_error,
        energy,
        own_clock: !prepared.frames.iter().all(still),
    })
}

/// What of an object is baked onto its texture.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// Index of the object in the scene.
    pub object: usize,
    /// The set of texture coordinates.
    pub uv_set: usize,
    /// Columns and rows of texels.
    pub size: [u32; 2],
}

/// The cube of the surface of an object by its texture coordinates; rows are kept in `journal`, where there is one.
///
/// # Errors
/// What [`check`] refuses, no texture coordinates, some outside [0, 1], charts that overlap, I/O errors of the journal, and
/// [`Error::Cancelled`] when `progress` says so.
pub fn surface_cube(
    scene: &Scene,
    prepared: &Prepared,
    surface: &Surface,
    bins: &Bins,
    journal: Option<&Journal>,
    progress: &dyn Progress,
) -> Result<Baked> {
    check(scene)?;
    let paths = paths(scene, prepared)?;
    let charts = Charts::new(scene, paths.rest, surface)?;
    let [width, height] = surface.size.map(|n| n as usize);
    let row = width * bins.count * 3;
    let mut values = vec![0f32; height * row];
    let sampler = Sampler::stratified(samples_per_part(prepared.layout.samples, PARTS));
    let sampling = (sampler.with_seed(scene.seed), prepared.layout.samples);
    let make = |i: usize| {
        let mut part = Part::new(bins);
        for j in 0..width {
            progress.check()?;
            let mut texel = Histogram::new(bins);
            charts.gather(&paths, bins, [j, i], sampling, &mut texel)?;
            part.push(&texel);
        }
        Ok(part)
    };
    let rows: Vec<(Summary, Vec<bool>)> = values
        .par_chunks_mut(row)
        .enumerate()
        .map(|(i, values)| {
            let part = kept(journal, i, [width, bins.count], || make(i))?;
            values.copy_from_slice(&part.values);
            progress.rays_done(width as u64 * u64::from(prepared.layout.samples));
            Ok((part.summary, part.covered))
        })
        .collect::<Result<_>>()?;
    let (summaries, covered): (Vec<Summary>, Vec<Vec<bool>>) = rows.into_iter().unzip();
    fill_gutters(
        &mut values,
        covered.concat(),
        [width, height],
        bins.count * 3,
    );
    baked(scene, prepared, [height, width], bins, values, &summaries)
}

/// The triangles of an object on its texture.
struct Charts<'a> {
    scene: &'a Scene,
    object: &'a str,
    triangles: Vec<ChartTriangle>,
    /// By texel, the triangles that may lie in it.
    texels: Vec<Vec<u32>>,
    size: [usize; 2],
}

struct ChartTriangle {
    /// Id and slot in the tree.
    triangle: u32,
    slot: u32,
    /// Corners in texels.
    corners: [DVec2; 3],
}

impl<'a> Charts<'a> {
    fn new(scene: &'a Scene, rest: &RestFrame, surface: &Surface) -> Result<Self> {
        let object = scene.objects[surface.object].name.as_str();
        let size = surface.size.map(|n| n as usize);
        let mut charts = Charts {
            scene,
            object,
            triangles: Vec::new(),
            texels: vec![Vec::new(); size[0] * size[1]],
            size,
        };
        for slot in 0..rest.bvh.len() as u32 {
            let (triangle, _) = rest.bvh.triangle(slot);
            let patch = rest.patch(triangle);
            if patch.object as usize == surface.object {
                charts.add(rest, patch, surface.uv_set, [triangle, slot])?;
            }
        }
        Ok(charts)
    }

    fn refuse(&self, what: String, help: &str) -> Error {
        let place = format!("object \"{}\"", self.object);
        Error::invalid(&self.scene.name, place, what, help)
    }

    fn add(
        &mut self,
        rest: &RestFrame,
        patch: &Patch,
        set: usize,
        [triangle, slot]: [u32; 2],
    ) -> Result<()> {
        let help = "texture coordinates of its own for every place, within 0 to 1; or bake what a camera sees (--camera)";
        let at = |u, v| rest.uv(patch, set, &place(triangle, slot, [u, v]));
        let corners = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
        let [Some(a), Some(b), Some(c)] = corners else {
            let what = format!("it has no texture coordinates of set {set}");
            return Err(self.refuse(what, help));
        };
        let corners = [a, b, c];
        // What was stored in f32 may be a little beyond.
        let inside = |uv: DVec2| uv.min_element() >= -1e-6 && uv.max_element() <= 1.0 + 1e-6;
        if let Some(uv) = corners.into_iter().find(|uv| !inside(*uv)) {
            let what = format!(
                "its texture coordinates ({}, {}) are outside of 0 to 1",
                uv.x, uv.y
            );
            return Err(self.refuse(what, help));
        }
        let scale = DVec2::new(self.size[0] as f64, self.size[1] as f64);
        let corners = corners.map(|uv| uv * scale);
        let index = self.triangles.len() as u32;
        let low = corners[0].min(corners[1]).min(corners[2]);
        let high = corners[0].max(corners[1]).max(corners[2]);
        let span = |low: f64, high: f64, size: usize| {
            low.max(0.0) as usize..(high.max(0.0) as usize + 1).min(size)
        };
        for i in span(low.y, high.y, self.size[1]) {
            for j in span(low.x, high.x, self.size[0]) {
                self.texels[i * self.size[0] + j].push(index);
            }
        }
        self.triangles.push(ChartTriangle {
            triangle,
            slot,
            corners,
        });
        Ok(())
    }

    /// The place of the surface at a point of the texture, in texels.
    fn locate(&self, [j, i]: [usize; 2], point: DVec2) -> Result<Option<Hit>> {
        let mut found = None;
        let mut inside = 0;
        for index in &self.texels[i * self.size[0] + j] {
            let triangle = &self.triangles[*index as usize];
            let Some([u, v]) = triangle.barycentric(point) else {
                continue;
            };
            let least = u.min(v).min(1.0 - u - v);
            if least >= 0.0 {
                found = found.or(Some(place(triangle.triangle, triangle.slot, [u, v])));
            }
            inside += u32::from(least > 1e-6);
        }
        if inside > 1 {
            let what = format!(
                "its charts overlap: {inside} triangles share the texture coordinates ({:.4}, {:.4})",
                point.x / self.size[0] as f64,
                point.y / self.size[1] as f64
            );
            let help = "texture coordinates of its own for every place; or bake what a camera sees (--camera)";
            return Err(self.refuse(what, help));
        }
        Ok(found)
    }

    /// Adds all samples of a texel that lie on the surface.
    fn gather(
        &self,
        paths: &TimedPaths,
        bins: &Bins,
        [j, i]: [usize; 2],
        (sampler, samples): (Sampler, u32),
        texel: &mut Histogram,
    ) -> Result<()> {
        for sample in 0..samples {
            let (within, salt) = sampler.replicate(sample);
            let key = pixel_key(j as u32, i as u32) ^ salt;
            let [x, y] = sobol(key, within, IN_TEXEL);
            let point = DVec2::new(j as f64 + x, i as f64 + y);
            if let Some(hit) = self.locate([j, i], point)? {
                texel.found += 1;
                let clock = paths.clock(paths.rest.patch(hit.triangle));
                paths.follow_from(hit, (key, within), |lamp, light, delay| {
                    texel.add(bins, lamp, light, delay + clock);
                });
            }
            if within + 1 == sampler.samples() {
                texel.end_part();
            }
        }
        Ok(())
    }
}

/// What random numbers of a texel are for, beside those of its paths.
const IN_TEXEL: u32 = 1 << 16;

/// A place of a triangle, on its front.
fn place(triangle: u32, slot: u32, [u, v]: [f64; 2]) -> Hit {
    Hit {
        s: 0.0,
        u,
        v,
        triangle,
        slot,
        front: true,
    }
}

impl ChartTriangle {
    /// The weights of the second and third corner at a point; none where the triangle has no area on the texture.
    fn barycentric(&self, point: DVec2) -> Option<[f64; 2]> {
        let [a, b, c] = self.corners;
        let (b, c, p) = (b - a, c - a, point - a);
        let area = b.perp_dot(c);
        let (u, v) = (p.perp_dot(c) / area, b.perp_dot(p) / area);
        (u.is_finite() && v.is_finite()).then_some([u, v])
    }
}

/// Gives texels beside charts the mean of their neighbours on them, two texels wide, so that bilinear lookups find no black there.
fn fill_gutters(
    values: &mut [f32],
    mut covered: Vec<bool>,
    [width, height]: [usize; 2],
    stride: usize,
) {
    for _ in 0..2 {
        let known = covered.clone();
        for texel in (0..width * height).filter(|texel| !known[*texel]) {
            let (i, j) = (texel / width, texel % width);
            let rows = i.saturating_sub(1)..(i + 2).min(height);
            let around = rows.flat_map(|i| {
                (j.saturating_sub(1)..(j + 2).min(width)).map(move |j| i * width + j)
            });
            let around: Vec<usize> = around.filter(|k| known[*k]).collect();
            if around.is_empty() {
                continue;
            }
            for at in 0..stride {
                let sum: f32 = around.iter().map(|k| values[k * stride + at]).sum();
                values[texel * stride + at] = sum / around.len() as f32;
            }
            covered[texel] = true;
        }
    }
}
