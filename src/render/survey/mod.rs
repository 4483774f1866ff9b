//! When the light in view was emitted, compared with the times that have data: why a picture is dark, in numbers.
//!
//! One ray goes through the centre of each pixel; if none of these hits anything, all samples of the picture are traced, because in a
//! small picture objects may be smaller than pixels. At each point that it hits and that varies with time, the time that a lookup would
//! use is computed on the data's own clock:
//!
//! - a cube: world time or the object's own, and for a warped one later by the travel time of its light to the capture camera (η times
//!   the distance);
//! - a pulse: the world time at which its light left the source, E.ct − ηr; its data span ± 4 σ about its centre;
//! - a lamp whose emission begins and ends: the lamp's own time at which its light left, compared with when it shines.
//!
//! Later shots see later light: [`Shots`] finds those that show some of it.

mod in_view;
mod search;

pub use in_view::other_times;
pub use search::Shots;

use rayon::prelude::*;

use crate::camera::Camera;
use crate::colour::SpectrumShape;
use crate::error::{Message, Result, Setting};
use crate::light::lamp::Emission;
use crate::light::time_texture::survey::{lit_span, rounded};
use crate::render::film::Tile;
use crate::render::plan::{Plan, unfound_light};
use crate::render::prepare::Prepared;
use crate::render::sampler::Sampler;
use crate::render::trace::{
    Background, CameraRays, EmissionClock, Emitter, HitBuffer, Meter, ObservedPoint, SurfacePoint,
    Surfaces, TimeResolved, generator,
};
use crate::scene::MADE_FOR_MODEL;
use crate::scene::model::{
    self, Clock, CubeSource, LightKind, Mapping, Motion, Scene, Source, SourceKind, TimeBins,
};
use crate::spacetime::Quantity;

/// How many standard deviations of a pulse count as its duration, on either side.
const PULSE_REACH: f64 = 4.0;

/// The maximum number of tiles surveyed for the times of light in view.
const MOST_TILES: u64 = 1024;

/// The number of tiles surveyed first.
const LOOKED_AT: u64 = 64;

/// The rays of a survey: the given number of samples of each pixel.
#[derive(Debug, Clone, Copy)]
struct PixelSamples {
    sampler: Sampler,
    samples: u32,
}

impl PixelSamples {
    /// One through the centre of each pixel.
    fn centred() -> PixelSamples {
        PixelSamples {
            sampler: Sampler::centred(),
            samples: 1,
        }
    }

    /// Those of the picture itself.
    fn of_picture(scene: &Prepared) -> PixelSamples {
        PixelSamples {
            sampler: scene.sampler,
            samples: scene.layout.samples,
        }
    }
}

/// Times on the clock of a source, metres of ct; for a lamp, its own (proper) times.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SeenTimes {
    /// Index of the source in the scene; lights are numbered after the sources.
    pub source: usize,
    /// The earliest and the latest time at which light in view was emitted (or, on a capture camera's clock, arrived there).
    pub seen: [f64; 2],
    /// The times that the data span.
    pub data: [f64; 2],
}

impl SeenTimes {
    /// Whether some of the light in view was emitted during the data.
    pub fn meets(&self) -> bool {
        self.seen[0] <= self.data[1] && self.seen[1] >= self.data[0]
    }
}

impl SeenTimes {
    /// Whether they belong to a cube.
    pub(crate) fn is_of_cube(&self, scene: &Scene) -> bool {
        let source = scene.sources.get(self.source);
        source.is_some_and(|source| matches!(source.kind, SourceKind::Cube(_)))
    }

    /// Their source, as text.
    fn source(&self, scene: &Scene) -> String {
        let name = |name: &str| name.escape_debug().to_string();
        let light = self.source.checked_sub(scene.sources.len());
        match (scene.sources.get(self.source), light) {
            (Some(source), _) => format!("source \"{}\"", name(&source.name)),
            (None, light) => {
                let light = light.and_then(|k| scene.lights.get(k));
                format!(
                    "light \"{}\"",
                    light.map_or(String::new(), |light| name(&light.name))
                )
            }
        }
    }

    /// When light in view was emitted, and the times that have data, as text; for lamps and pulses.
    fn said(&self, scene: &Scene, is_train: bool) -> String {
        let [[a, b], [c, d]] = [self.seen, self.data].map(|span| span.map(rounded));
        let source = self.source(scene);
        match (self.source < scene.sources.len(), is_train) {
            (true, _) => format!(
                "{source}: light in view left between ct = {a} m and {b} m; its data span {c} m to {d} m"
            ),
            (false, false) => format!(
                "{source}: light in view left between its own times {a} m and {b} m; it shines from {c} m to {d} m"
            ),
            (false, true) => format!(
                "{source}: light in view left between its own times {a} m and {b} m; its pulse nearest to that lasts from \
                 {c} m to {d} m"
            ),
        }
    }
}

/// For each lamp and pulse whose light begins and ends and reaches surfaces in view: when the light in view was emitted, the times that
/// have light, and the camera times that show some of it; with `dark`, only for those with none in view.
pub fn moments(scene: &Scene, prepared: &mut Prepared, dark: bool) -> Vec<Message> {
    // Enough rays to find the ends of the times in view.
    let every = (Tile::count(scene.camera.size) / MOST_TILES) | 1;
    let mut remarks = Vec::new();
    let mut shots = Shots::among(scene, prepared, every);
    for mut times in shots.seen() {
        let pulse = nearest_pulse(scene, &times);
        times.data = pulse.unwrap_or(times.data);
        if times.is_of_cube(scene) || (dark && times.meets()) {
            continue;
        }
        let mut text = Message::from(times.said(scene, pulse.is_some()));
        if !dark {
            let now = rounded(scene.camera.time);
            let is = if times.meets() {
                "some of it"
            } else {
                "none of it"
            };
            text += format!("; the camera's time {now} m shows {is}");
        }
        if !times.meets()
            && let Some([from, to]) = shots.showing(&times)
        {
            let [from, to] = [from, to].map(rounded);
            text += "; try ";
            text += Setting::Time + format!(" \"{from} m\" to \"{to} m\"");
        }
        remarks.push(text);
    }
    remarks
}

/// For a light with separate pulses, the pulse in view, or the next one.
fn nearest_pulse(scene: &Scene, times: &SeenTimes) -> Option<[f64; 2]> {
    let light = times.source.checked_sub(scene.sources.len())?;
    let profile = match &scene.lights.get(light)?.kind {
        LightKind::Lamp(lamp) => &lamp.emission,
        LightKind::Area { emission, .. } => emission,
    };
    Emission::from(profile).pulse_near(times.seen)
}

/// The eye, which needs some 1e-6 cd/m², sees nothing colder glow, kelvin.
const COLDEST_GLOW: f64 = 600.0;

/// The smallest and the largest W = λ′/λ with which the light of each lamp reaches surfaces in view, if it is invisible there: by the index
/// of the light. `seen` is W of light that is shown as it was emitted: 1 without false colours.
pub fn unseen_lamps(scene: &Scene, prepared: &Prepared, seen: f64) -> Vec<(usize, [f64; 2])> {
    let Some(light) = prepared.light.time_resolved() else {
        return Vec::new();
    };
    let surfaces = prepared.surfaces();
    let rapidities = scene.objects.iter().map(|o| o.velocity.rapidity().length());
    let fastest = rapidities.fold(0.0, f64::max);
    let is_visible = |lamp: &model::Lamp, incident: f64, w: f64| match lamp.spectrum.as_ref() {
        // Colours stand for spectra from 360 to 830 nm.
        None => (360.0 * w < 830.0 * seen) && (830.0 * w > 360.0 * seen),
        Some(spectrum) => match spectrum.shape() {
            SpectrumShape::Rgb(..) => (360.0 * w < 830.0 * seen) && (830.0 * w > 360.0 * seen),
            SpectrumShape::Blackbody(t) => t / w * seen > COLDEST_GLOW,
            _ => incident > 0.0,
        },
    };
    // Light of quantities without a spectrum is visible at any W, and other light at any that a lamp and an object this slow can have.
    let may_be_unseen = |k: &usize| match &scene.lights[*k].kind {
        LightKind::Lamp(lamp) => {
            let has_spectrum = lamp.spectrum.is_some() || scene.quantity == Quantity::Rgb;
            let apart = fastest + lamp.velocity.rapidity().length();
            let is_slow = lamp.motion == Motion::Inertial
                && [-apart, apart]
                    .iter()
                    .all(|apart| is_visible(lamp, 0.0, libm::exp(*apart)));
            has_spectrum && !is_slow
        }
        LightKind::Area { .. } => false,
    };
    // Lamps are numbered after the sources.
    let ratios = |k: usize, pixel_samples: PixelSamples, every: u64| {
        let index = scene.sources.len() + k;
        let lamp = light.lamps.get(index)?.as_ref()?;
        let LightKind::Lamp(of_scene) = &scene.lights[k].kind else {
            return None;
        };
        let tiles = (0..Tile::count(prepared.layout.size)).into_par_iter();
        let tiles = tiles.filter(|tile| tile % every == 0);
        let ratios = tiles.map(|tile| {
            let (mut range, mut is_seen) = ([f64::INFINITY, 0.0f64], false);
            each_point(
                prepared,
                &surfaces,
                (Tile::of_image(prepared.layout.size, tile), pixel_samples),
                |observed| {
                    let point = &observed.point;
                    let arrival = lamp.arrival_at_peak(&point.ray, point.hit.s, light.index);
                    let Some((arrival, _)) = arrival else {
                        return;
                    };
                    // W of light that arrives, from the lamp's frame to the surface's.
                    let rho = surfaces.direction(point.frame, arrival.d).1;
                    let w = arrival.wavelength_ratio(rho);
                    range = [range[0].min(w), range[1].max(w)];
                    let incident = lamp.incident_at(w, 1.0).irradiance;
                    is_seen |= is_visible(of_scene, incident.into_iter().fold(0.0, f64::max), w);
                },
                |_| {},
            );
            (range, is_seen)
        });
        Some(tiles_reduced(ratios))
    };
    let of_lamp = |k: usize| {
        let is_lit = |([least, greatest], _): &([f64; 2], bool)| least <= greatest;
        // A few tiles show of most lamps that their light is visible.
        let few = ratios(k, PixelSamples::centred(), one_in(scene.camera.size))?;
        if few.1 {
            return None;
        }
        let found = ratios(k, PixelSamples::centred(), 1)?;
        let (range, is_seen) = match is_lit(&found) {
            true => found,
            false => ratios(k, PixelSamples::of_picture(prepared), 1).filter(is_lit)?,
        };
        (!is_seen).then_some((k, range))
    };
    (0..scene.lights.len())
        .filter(may_be_unseen)
        .filter_map(of_lamp)
        .collect()
}

fn tiles_reduced(ratios: impl ParallelIterator<Item = ([f64; 2], bool)>) -> ([f64; 2], bool) {
    ratios.reduce(
        || ([f64::INFINITY, 0.0], false),
        |(a, seen), (b, also)| ([a[0].min(b[0]), a[1].max(b[1])], seen || also),
    )
}

/// The times of all sources and lamps that light something in view, by source.
pub fn seen_times(scene: &Prepared) -> Vec<SeenTimes> {
    seen_times_among(scene, 1)
}

/// [`seen_times`] for one tile in `every`.
fn seen_times_among(scene: &Prepared, every: u64) -> Vec<SeenTimes> {
    seen_times_by(scene, every, PixelSamples::centred())
}

/// [`seen_times_among`]; if no ray through the centre of a pixel hits anything lit, with all samples.
fn seen_or_sampled(scene: &Prepared, every: u64) -> Vec<SeenTimes> {
    let seen = seen_times_among(scene, every);
    match seen.is_empty() {
        true => seen_times_by(scene, every, PixelSamples::of_picture(scene)),
        false => seen,
    }
}

fn seen_times_by(scene: &Prepared, every: u64, pixel_samples: PixelSamples) -> Vec<SeenTimes> {
    let Some(light) = scene.light.time_resolved() else {
        return Vec::new();
    };
    let surfaces = scene.surfaces();
    let tiles = 0..Tile::count(scene.layout.size).div_ceil(every);
    let survey = |index| {
        tile(
            scene,
            &surfaces,
            light,
            Tile::of_image(scene.layout.size, index * every),
            pixel_samples,
        )
    };
    // Minimum and maximum do not depend on the order.
    let all = tiles.into_par_iter().map(survey);
    all.reduce(Vec::new, |mut a, b| {
        b.into_iter().for_each(|times| note(&mut a, times));
        a
    })
}

/// The smallest and the largest W = λ′/λ along rays through pixel centres, including the sky, or along all samples if the former hit no
/// surface; `None` if they hit nothing.
pub fn wavelength_ratios(scene: &Prepared) -> Option<[f64; 2]> {
    let (range, has_met) = ratios_by(scene, 1, PixelSamples::centred());
    match has_met {
        true => range,
        false => ratios_by(scene, 1, PixelSamples::of_picture(scene)).0,
    }
}

/// [`wavelength_ratios`] if all of them are below or all above the range `within`: for most pictures a few rays show that they are not.
pub fn wavelength_ratios_outside(scene: &Prepared, within: [f64; 2]) -> Option<[f64; 2]> {
    let (few, _) = ratios_by(scene, one_in(scene.layout.size), PixelSamples::centred());
    match few {
        Some(range) if !is_outside(range, within) => None,
        _ => wavelength_ratios(scene).filter(|range| is_outside(*range, within)),
    }
}

/// The range of W over all directions in the camera's view if everything rests in the world, whatever is seen there; `None` if something
/// moves.
///
/// # Errors
/// A camera that sees nothing at its time.
pub fn camera_ratios_outside(scene: &Scene, within: [f64; 2]) -> Result<Option<[f64; 2]>> {
    if scene.objects.iter().any(|o| !o.velocity.is_rest()) {
        return Ok(None);
    }
    let camera = Camera::new(scene)?;
    let generator = generator(&camera.view);
    let size = scene.camera.size;
    let range = |every: u64| {
        let of_tile = |index: u64| {
            let mut rays = CameraRays::default();
            let tile = Tile::of_image(size, index * every);
            generator.generate(&mut rays, &Sampler::centred(), tile, 0..1);
            rays.ratios
                .iter()
                .fold(NOTHING, |range, w| widened(range, *w))
        };
        let tiles = (0..Tile::count(size).div_ceil(every)).into_par_iter();
        tiles
            .map(of_tile)
            .reduce(|| NOTHING, |a, [low, high]| widened(widened(a, low), high))
    };
    let is_outside = |range: &[f64; 2]| range[0] <= range[1] && is_outside(*range, within);
    let few = Some(range(one_in(size))).filter(is_outside);
    Ok(few.map(|_| range(1)).filter(is_outside))
}

const NOTHING: [f64; 2] = [f64::INFINITY, 0.0];

fn widened([low, high]: [f64; 2], w: f64) -> [f64; 2] {
    [low.min(w), high.max(w)]
}

fn is_outside([low, high]: [f64; 2], [least, most]: [f64; 2]) -> bool {
    low > most || high < least
}

/// One tile in this many is representative of most pictures: odd, so that these tiles do not lie in columns.
fn one_in(size: [u32; 2]) -> u64 {
    (Tile::count(size) / LOOKED_AT) | 1
}

/// The range of W for one tile in `every`, and whether the rays hit a surface.
fn ratios_by(
    scene: &Prepared,
    every: u64,
    pixel_samples: PixelSamples,
) -> (Option<[f64; 2]>, bool) {
    let surfaces = scene.surfaces();
    let range = |index| {
        let range = std::cell::Cell::new(None);
        let mut has_met = false;
        let tile = Tile::of_image(scene.layout.size, index * every);
        let note = |w: f64| range.set(Some(widened(range.get().unwrap_or(NOTHING), w)));
        let sky = matches!(scene.background, Background::Sky { .. });
        each_point(
            scene,
            &surfaces,
            (tile, pixel_samples),
            |observed| {
                has_met = true;
                note(observed.w.0);
            },
            |w| {
                if sky {
                    note(w);
                }
            },
        );
        (range.get(), has_met)
    };
    let tiles = (0..Tile::count(scene.layout.size).div_ceil(every)).into_par_iter();
    let both = |a: Option<[f64; 2]>, b: Option<[f64; 2]>| match (a, b) {
        (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
        (a, b) => a.or(b),
    };
    // Minimum and maximum do not depend on the order of tiles.
    tiles.map(range).reduce(
        || (None, false),
        |(a, met), (b, also)| (both(a, b), met || also),
    )
}

/// Adds to `plan` the mirrors whose light is not found because of their textures, which are known only after loading.
pub fn note_mirrors_by_texture(scene: &Scene, plan: &mut Plan, prepared: &Prepared) {
    let by_factors = unfound_light(scene, &plan.objects, |_| false);
    if by_factors != prepared.unfound_light {
        plan.notes.retain(|note| Some(note) != by_factors.as_ref());
        plan.notes.extend(prepared.unfound_light.clone());
    }
}

/// Cubes that the light in view misses, or hits only where they are dark: both time spans, and the start or unit that would fit, or else
/// the camera times that would. Cubes with the same times as a cube that is lit in view are skipped: light reaches some surfaces later than
/// others.
pub fn misfits(scene: &Scene, prepared: &mut Prepared) -> Vec<String> {
    let is_dark = |prepared: &Prepared, times: &SeenTimes| {
        let data = lit(prepared, times.source).unwrap_or(times.data);
        times.is_of_cube(scene) && !SeenTimes { data, ..*times }.meets()
    };
    let is_cube = |source: &Source| matches!(source.kind, SourceKind::Cube(_));
    // The bins of a flash on a model were made for it.
    if scene.text.starts_with(MADE_FOR_MODEL) || !scene.sources.iter().any(is_cube) {
        return Vec::new();
    }
    // For most pictures a few tiles show that their data are in view.
    let few = seen_times_among(prepared, one_in(scene.camera.size));
    if !few.is_empty() && !few.iter().any(|times| is_dark(prepared, times)) {
        return Vec::new();
    }
    let cube = |times: &SeenTimes| match &scene.sources[times.source].kind {
        SourceKind::Cube(cube) => Some(cube),
        SourceKind::Pulse(_) => None,
    };
    let mut fitting = Vec::new();
    let mut others = Vec::new();
    for times in seen_times(prepared) {
        if !times.is_of_cube(scene) {
            continue;
        }
        let lit = lit(prepared, times.source);
        let there = SeenTimes {
            data: lit.unwrap_or(times.data),
            ..times
        };
        match there.meets() {
            true => fitting.extend(cube(&times)),
            false => others.push((times, there, lit)),
        }
    }
    let mut remarks = Vec::new();
    let mut shots = Shots::new(scene, prepared);
    for (times, there, lit) in others {
        let is_alike = |own: &CubeSource| {
            let mut fitting = fitting.iter();
            fitting.any(|cube| cube.bins == own.bins && cube.clock == own.clock)
        };
        if cube(&times).is_some_and(|own| is_alike(own)) {
            continue;
        }
        // Values that are 0 up to rounding.
        let least = 1e-9 * (times.data[1] - times.data[0]);
        let shown = |time: f64| {
            if time.abs() < least {
                0.0
            } else {
                rounded(time)
            }
        };
        let [[a, b], [c, d], [e, f]] =
            [times.seen, times.data, there.data].map(|span| span.map(shown));
        let mut text = format!(
            "source \"{}\": light in view left (on a capture's clock: arrived) between ct = {a} m and {b} m; its data span \
             {c} m to {d} m",
            scene.sources[times.source].name
        );
        if lit.is_some() {
            text += &format!(", and are lit from {e} m to {f} m");
        }
        text += &there.other_times(scene);
        if let SourceKind::Cube(cube) = &scene.sources[times.source].kind
            && matches!(cube.mapping, Mapping::Capture(_))
            && cube.clock != Clock::Capture
        {
            text += "; or with clock = \"capture\", if times are those of arrival";
        }
        if let Some([from, to]) = shots.showing(&there) {
            let [from, to] = [from, to].map(rounded);
            text += &format!("; or camera times from \"{from} m\" to \"{to} m\"");
        }
        remarks.push(text);
    }
    remarks
}

impl SeenTimes {
    /// The unit or the start with which data lit in `self.data` would match what is seen.
    fn other_times(&self, scene: &Scene) -> String {
        let Some(SourceKind::Cube(cube)) = scene.sources.get(self.source).map(|s| &s.kind) else {
            return String::new();
        };
        let TimeBins::Uniform { start, width } = cube.bins else {
            return String::new();
        };
        let at = |power: i32| SeenTimes {
            data: self.data.map(|time| time * 10f64.powi(power)),
            ..*self
        };
        // About as long as what is seen, within a power of ten or so.
        let is_long = |power: i32| {
            let [data, seen] = [at(power).data, self.seen].map(|[from, to]| to - from);
            data > 0.3 * seen && data < 30.0 * seen
        };
        // The smallest powers of ten first.
        let mut powers = (1..=15).flat_map(|power| [-power, power]);
        let fitting = powers.find(|power| start != 0.0 && at(*power).meets() && is_long(*power));
        let unit = fitting.map(|power| {
            let [start, width] = [start, width].map(|time| rounded(time * 10f64.powi(power)));
            format!(
                "; in a unit 10^{power} times as long they would fit: start = \"{start} m\", bin_width = \"{width} m\""
            )
        });
        // Data of the right length probably have the right unit and begin at another time.
        if let Some(unit) = unit.as_ref().filter(|_| !is_long(0)) {
            return unit.clone();
        }
        let [from, to] = [
            start + self.seen[0] - self.data[1],
            start + self.seen[1] - self.data[0],
        ];
        let [from, to, now] = [from, to, start].map(rounded);
        format!(
            "; they would fit with a start (now {now} m) between {from} m and {to} m{}",
            unit.unwrap_or_default()
        )
    }
}

/// The time span in which a cube is lit.
pub fn lit(prepared: &Prepared, source: usize) -> Option<[f64; 2]> {
    let light = prepared.light.time_resolved()?;
    let cube = light
        .cube_sources
        .iter()
        .position(|known| *known == source)?;
    lit_span(&light.cubes[cube])
}

fn tile(
    scene: &Prepared,
    surfaces: &Surfaces,
    light: &TimeResolved,
    tile: Tile,
    pixel_samples: PixelSamples,
) -> Vec<SeenTimes> {
    let mut all = Vec::new();
    let each = |observed: &ObservedPoint| at_point(light, surfaces, observed, &mut all);
    each_point(scene, surfaces, (tile, pixel_samples), each, |_| {});
    all
}

/// Calls a function with the hits of rays through a tile's pixels, and another with the W of a world at rest for those that hit nothing.
fn each_point(
    scene: &Prepared,
    surfaces: &Surfaces,
    (tile, pixel_samples): (Tile, PixelSamples),
    mut each: impl FnMut(&ObservedPoint),
    mut escaped: impl FnMut(f64),
) {
    let (mut camera_rays, mut hits) = (CameraRays::default(), HitBuffer::default());
    let generator = generator(&scene.camera.view);
    for sample in 0..pixel_samples.samples {
        generator.generate(
            &mut camera_rays,
            &pixel_samples.sampler,
            tile,
            sample..sample + 1,
        );
        let rays = camera_rays.rays(scene.method);
        let traced = scene.trace(surfaces, rays, &mut hits, &mut Meter::off());
        for (ray, ratio) in camera_rays.ratios.iter().enumerate() {
            if !traced.rays.origin(ray).sees() {
                continue;
            }
            match traced.observed(ray, *ratio) {
                Some(observed) => each(&observed),
                None => escaped(*ratio),
            }
        }
    }
}

/// Records the times of all sources that light a point.
fn at_point(
    light: &TimeResolved,
    surfaces: &Surfaces,
    observed: &ObservedPoint,
    all: &mut Vec<SeenTimes>,
) {
    let point = &observed.point;
    let emitter = &light.emitters[point.patch.emitter as usize].0;
    shining_at_point(light, surfaces, (emitter, point), all);
    let mut of_cube = |cube: usize, t: f64| {
        let times = SeenTimes {
            source: light.cube_sources[cube],
            seen: [t; 2],
            data: light.cubes[cube].span(),
        };
        note(all, times);
    };
    match emitter {
        Emitter::Base(_) => {}
        Emitter::Uv { cube, clock, .. } => of_cube(*cube, clock.time(point)),
        Emitter::Captured(captures) => {
            for captured in captures {
                let capture = &light.captures[captured.capture];
                let distance = (point.rest_event().x - capture.eye()).length();
                let delay = match capture.is_warped() {
                    true => light.index * distance,
                    false => 0.0,
                };
                of_cube(captured.cube, captured.clock.time(point) + delay);
            }
        }
        Emitter::Lit { lamps, .. } => {
            for index in lamps {
                // Lights of the scene are not sources, and are numbered after those.
                let Some(lamp) = &light.lamps[*index] else {
                    continue;
                };
                let Some((origin, sigma)) = lamp.source_pulse() else {
                    let arrival = lamp.arrival_at_peak(&point.ray, point.hit.s, light.index);
                    if let (Some(data), Some((_, left))) = (lamp.emission().lit_times(), arrival) {
                        let times = SeenTimes {
                            source: *index,
                            seen: [left; 2],
                            data,
                        };
                        note(all, times);
                    }
                    continue;
                };
                let way = point.event() - origin;
                let left = origin.ct + way.ct - light.index * way.x.length();
                let reach = PULSE_REACH * sigma;
                let times = SeenTimes {
                    source: *index,
                    seen: [left; 2],
                    data: [origin.ct - reach, origin.ct + reach],
                };
                note(all, times);
            }
        }
    }
}

/// Records the times of surfaces with their own emission profile that the point is on, or that light it.
fn shining_at_point(
    light: &TimeResolved,
    surfaces: &Surfaces,
    (emitter, point): (&Emitter, &SurfacePoint),
    all: &mut Vec<SeenTimes>,
) {
    let mut of_light = |object: u32, emission: &Emission, left: f64| {
        let known = light.area_lights.iter().find(|(lit, _)| *lit == object);
        if let (Some((_, source)), Some(data)) = (known, emission.lit_times()) {
            let times = SeenTimes {
                source: *source,
                seen: [left; 2],
                data,
            };
            note(all, times);
        }
    };
    let (own, is_lit) = match emitter {
        Emitter::Base(colour) => (Some(&light.base.colours[*colour]), false),
        Emitter::Lit { finish, .. } => (finish.emission.as_ref(), true),
        Emitter::Uv { .. } | Emitter::Captured(_) => (None, false),
    };
    match (own.and_then(|own| own.profile.as_deref()), &light.areas) {
        // A surface that shines is seen by its own clock; other lights are seen by the surfaces that they light.
        (Some(emission), _) => of_light(
            point.patch.object,
            emission,
            EmissionClock::Object.time(point),
        ),
        (None, Some(areas)) if is_lit => areas.times_at(surfaces, point, light.index, of_light),
        _ => {}
    }
}

/// Widens the range of the same source, or inserts it.
fn note(all: &mut Vec<SeenTimes>, times: SeenTimes) {
    match all.binary_search_by_key(&times.source, |known| known.source) {
        Err(at) => all.insert(at, times),
        Ok(at) => {
            let [first, last] = &mut all[at].seen;
            *first = first.min(times.seen[0]);
            *last = last.max(times.seen[1]);
        }
    }
}
