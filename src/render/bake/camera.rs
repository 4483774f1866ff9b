//! The light cube of a camera's view.

use std::num::NonZeroU32;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use glam::DVec3;
use rayon::prelude::*;

use super::histogram::Histogram;
use super::part::{Part, Summary, kept};
use super::stored::Stored;
use super::{Baked, Bins, CubePrecision, PARTS, baked, check, paths, shown_light};
use crate::accel::Origins;
use crate::error::{Error, Result};
use crate::render::film::Tile;
use crate::render::journal::Journal;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::sampler::{Sampler, samples_per_part};
use crate::render::trace::{
    AT_ONCE, CameraRays, RestFrame, Start, TimedPaths, Viewpoint, generator,
};
use crate::scene::model::{Clock, Motion, ProjectionKind, Scene};
use crate::spacetime::{Direction, Event, Rest};

/// The cube of the scene's camera, which is at rest relative to all objects; finished tiles are stored in `journal`, if given.
///
/// # Errors
/// Whatever [`check`] refuses, surfaces that shine for ever, bins without width or number, energies above 65504 in half precision, a camera
/// that moves relative to the objects, or moves without aberration, objects that show cubes, I/O errors of the journal, and [`Error::Cancelled`] when `progress` says so.
pub fn camera_cube(
    scene: &Scene,
    prepared: &Prepared,
    bins: &Bins,
    precision: CubePrecision,
    journal: Option<&Journal>,
    progress: &dyn Progress,
) -> Result<Baked> {
    let cube = match precision {
        CubePrecision::Single => cube::<f32>,
        CubePrecision::Half => cube::<u16>,
    };
    cube(scene, prepared, bins, journal, progress)
}

fn cube<T: Stored>(
    scene: &Scene,
    prepared: &Prepared,
    bins: &Bins,
    journal: Option<&Journal>,
    progress: &dyn Progress,
) -> Result<Baked> {
    check(scene)?;
    check_plain(scene)?;
    let [width, height] = prepared.layout.size.map(|n| n as usize);
    bins.check::<T>(scene, width * height)?;
    let paths = paths(scene, prepared)?;
    let mut values = vec![T::default(); width * height * bins.count * 3];
    let placed = Mutex::new(&mut values);
    let pixels = Pixels::new((scene, prepared), &paths, bins, sampling(prepared));
    let tiles = (0..Tile::count(prepared.layout.size) as usize).into_par_iter();
    let summaries: Vec<Summary> = tiles
        .map_init(CameraRays::default, |rays, index| {
            let tile = Tile::of_image(prepared.layout.size, index as u64);
            let size = [tile.pixels(), bins.count];
            let make = || pixels.of_tile(tile, rays, progress);
            let mut part = kept(journal, index, size, make)?;
            part.summary.faint = T::faint(&part.values);
            progress.rays_done(tile.pixels() as u64 * u64::from(prepared.layout.samples));
            // A poisoned lock means a panic elsewhere, which rayon propagates.
            let mut values = placed.lock().unwrap_or_else(PoisonError::into_inner);
            let pixels = part.values.chunks(3 * bins.count);
            for ((column, row), pixel) in tile.coordinates().zip(pixels) {
                let first = (row as usize * width + column as usize) * bins.count * 3;
                let places = values[first..].iter_mut().zip(pixel);
                places.for_each(|(place, value)| *place = T::of(*value));
            }
            Ok(part.summary)
        })
        .collect::<Result<_>>()?;
    let baked = baked(scene, prepared, [height, width], bins, values, &summaries)?;
    Ok(Baked {
        clock: Clock::Capture,
        ..baked
    })
}

/// The sampler of the film's samples, in independent parts, and their number.
fn sampling(prepared: &Prepared) -> (Sampler, u32) {
    let layout = &prepared.layout;
    let sampler = match layout.pixel_centers {
        true => prepared.sampler,
        false => {
            let per_part = samples_per_part(layout.samples, PARTS);
            prepared.sampler.with_samples(per_part)
        }
    };
    (sampler, layout.samples)
}

/// How the pixels of a cube are computed.
pub(super) struct Pixels<'a> {
    prepared: &'a Prepared,
    paths: &'a TimedPaths<'a>,
    /// The reading of the cube's clock at the frame's time 0: one clock for all objects, as a pixel may show several.
    clock: f64,
    bins: &'a Bins,
    sampler: Sampler,
    /// Samples, and those of each part, whose mean is kept separately.
    samples: u32,
    per_part: u32,
}

impl<'a> Pixels<'a> {
    pub fn new(
        (scene, prepared): (&Scene, &'a Prepared),
        paths: &'a TimedPaths<'a>,
        bins: &'a Bins,
        (sampler, samples): (Sampler, u32),
    ) -> Self {
        Pixels {
            prepared,
            paths,
            clock: match clock_zero(scene, paths.rest) {
                Some(zero) => -zero.ct,
                None => paths.rest.frame.origin().ct,
            },
            bins,
            sampler,
            samples,
            per_part: samples_per_part(samples, PARTS),
        }
    }

    /// The pixels of a tile, with a limited number of samples traced together.
    pub fn of_tile(
        &self,
        tile: Tile,
        rays: &mut CameraRays,
        progress: &dyn Progress,
    ) -> Result<Part> {
        let blank = |_| Histogram::new(self.bins);
        let mut pixels: Vec<_> = (0..tile.pixels()).map(blank).collect();
        let samples_at_once = self.prepared.samples_at_once;
        let at_once = samples_at_once.map_or(AT_ONCE, NonZeroU32::get);
        let mut sample = 0;
        while sample < self.samples {
            progress.check()?;
            // Samples of different parts are kept separate.
            let left = self.per_part - sample % self.per_part;
            let samples = sample..sample + left.min(at_once);
            sample = samples.end;
            self.add(tile, samples, rays, &mut pixels);
            if sample.is_multiple_of(self.per_part) {
                pixels.iter_mut().for_each(Histogram::end_part);
            }
        }
        let mut part = Part::new(self.bins, tile.pixels());
        pixels.iter().for_each(|pixel| part.push(pixel));
        Ok(part)
    }

    /// Adds `samples` samples, all of one part, to each pixel of a tile.
    fn add(
        &self,
        tile: Tile,
        samples: Range<u32>,
        rays: &mut CameraRays,
        pixels: &mut [Histogram],
    ) {
        let Pixels {
            prepared,
            paths,
            clock,
            bins,
            sampler,
            ..
        } = self;
        generator(&prepared.camera.view).generate(rays, sampler, tile, samples);
        let frame = &paths.rest.frame;
        let boost = frame.frame_from_world();
        let shot = prepared.camera.shot.event_in(frame);
        // A plain camera: all rays start at one event.
        let direction = |d: &DVec3| boost.direction(Direction::from_unit(*d)).0.unit();
        let directions: Vec<_> = rays.directions.iter().map(direction).collect();
        let mut hits = vec![None; directions.len()];
        let from = Origins::Shared(shot.x);
        let (bvh, method) = (&paths.rest.bvh, prepared.method);
        bvh.closest_by(method, from, &directions, &mut hits, None, None);

        // The paths that hit something, and their pixels.
        let (mut starts, mut met) = (Vec::new(), Vec::new());
        let numbers = rays.rays(method).samples;
        for (ray, (hit, d)) in hits.into_iter().zip(&directions).enumerate() {
            let pixel = ray % tile.pixels();
            pixels[pixel].found += 1;
            if let Some(hit) = hit {
                starts.push(Start {
                    hit,
                    seen: Viewpoint::From(shot.x, *d),
                    sample: (numbers.pixel(ray), numbers.index(ray)),
                });
                met.push(pixel);
            }
        }
        paths.follow(
            &starts,
            sampler.samples(),
            |path, emission, light, delay| {
                pixels[met[path]].add(bins, emission, light, delay + clock);
            },
        );
    }
}

/// Refuses the scenes that [`camera_cube`] would refuse, before any light is traced.
///
/// # Errors
/// As for [`camera_cube`], except those of bins and of the journal.
pub fn check_camera(scene: &Scene, prepared: &Prepared) -> Result<()> {
    check(scene)?;
    check_plain(scene)?;
    paths(scene, prepared).map(|_| ())
}

/// How a source with a capture camera reads the cube of [`camera_cube`] for objects that share its coordinates.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Captured {
    /// Their indices in the scene.
    pub objects: Vec<usize>,
    /// The pinhole: in the world, or in the coordinates of these objects if everything moves.
    pub eye: DVec3,
    /// How much later bins start by their clock than by that of the first object, which the cube shows, metres.
    pub later: f64,
}

/// All objects of `scene`, grouped by what their sources have to say: one group if everything rests in the world, and otherwise one for
/// each origin.
pub fn captured(scene: &Scene, prepared: &Prepared) -> Vec<Captured> {
    let shot = &prepared.camera.shot;
    let rest = prepared.frames.first();
    let Some((rest, first)) = rest.and_then(|rest| Some((rest, clock_zero(scene, rest)?))) else {
        return vec![Captured {
            objects: (0..scene.objects.len()).collect(),
            eye: shot.event.x,
            later: 0.0,
        }];
    };
    let mut all: Vec<Captured> = Vec::new();
    for (index, object) in scene.objects.iter().enumerate() {
        let alike = |known: &&mut Captured| {
            let other = &scene.objects[known.objects[0]];
            other.velocity == object.velocity && other.origin == object.origin
        };
        if let Some(known) = all.iter_mut().find(alike) {
            known.objects.push(index);
            continue;
        }
        let origin = rest.frame.event_from_world(object.origin);
        all.push(Captured {
            objects: vec![index],
            eye: shot.event_in(&rest.frame).x - origin.x,
            later: first.ct - origin.ct,
        });
    }
    all
}

/// When and where the clock of the first object shows 0, in the frame; `None` if everything rests in the world, whose clock counts then.
fn clock_zero(scene: &Scene, rest: &RestFrame) -> Option<Event<Rest>> {
    let moves = !rest.frame.velocity().is_rest();
    let first = scene.objects.first().filter(|_| moves)?;
    Some(rest.frame.event_from_world(first.origin))
}

pub(super) fn check_plain(scene: &Scene) -> Result<()> {
    let camera = &scene.camera;
    if let Some((place, what)) = shown_light(scene) {
        let what = format!("{what}, which is not baked: it would be black");
        let help = "leave the source out, so that lamps light the object, or bake surfaces alone";
        return Err(Error::invalid(&scene.name, place, what, help));
    }
    if !scene.effects.aberration && !camera.velocity.is_rest() {
        let what = "without aberration, no pinhole at rest with the objects sees these directions";
        let help = "bake with aberration; a scene that shows the cube can turn it off";
        return Err(Error::invalid(
            &scene.name,
            "effects.aberration",
            what,
            help,
        ));
    }
    let refuse = |what: &str| {
        let help = "use a plain camera at rest with the objects; any other camera can then look at the cube";
        Err(Error::invalid(&scene.name, "camera", what, help))
    };
    let objects = scene.objects.first().map(|o| o.velocity.rapidity());
    let difference = objects.map_or(0.0, |w| (w - camera.velocity.rapidity()).length());
    // Rapidities that are equal up to rounding.
    if difference > 1e-12 || camera.motion != Motion::Inertial {
        return refuse("it moves relative to the objects");
    }
    if camera.projection != ProjectionKind::Perspective {
        return refuse(
            "pictures are baked through a perspective camera only, and this one has another projection",
        );
    }
    if camera.shutter.is_some()
        || camera.sensor.is_some()
        || camera.rotation.is_some()
        || camera.stereo.is_some()
    {
        return refuse(
            "a cube belongs to one pinhole, without a shutter, a moving sensor or a second eye",
        );
    }
    Ok(())
}
