//! When the light in view was emitted, compared with the times that have data: why a picture is dark, in numbers.
//!
//! One ray goes through the centre of each pixel, or three as a shutter opens, half-way, and as it closes; if none of these hits anything,
//! all samples of the picture are traced, because in a small picture objects may be smaller than pixels. At each point that is hit and that
//! varies with time, the time that a lookup would use is computed on the data's own clock:
//!
//! - a cube: world time or the object's own, and for a warped one later by the travel time of its light to the capture camera (η times
//!   the distance);
//! - a pulse: the world time at which its light left the source, E.ct − ηr; its data span ± 4 σ about its centre;
//! - a lamp whose emission begins and ends: the lamp's own time at which its light left, compared with when it shines.
//!
//! Later shots see later light: [`Shots`] finds those that show some of it.

mod in_view;
mod search;
mod wavelengths;

pub use in_view::other_times;
pub use search::Shots;
pub use wavelengths::{
    camera_ratios_outside, unseen_lamps, wavelength_ratios, wavelength_ratios_outside,
};

use rayon::prelude::*;

use crate::camera::Camera;
use crate::error::{Message, Setting};
use crate::light::lamp::Emission;
use crate::light::time_texture::survey::{lit_span, rounded};
use crate::render::film::Tile;
use crate::render::plan::{Plan, unfound_light};
use crate::render::prepare::Prepared;
use crate::render::sampler::Sampler;
use crate::render::trace::{
    CameraRays, EmissionClock, Emitter, HitBuffer, Meter, ObservedPoint, SurfacePoint, Surfaces,
    TimeResolved, generator,
};
use crate::scene::MADE_FOR_MODEL;
use crate::scene::model::{
    Clock, CubeSource, LightKind, Mapping, Scene, Source, SourceKind, TimeBins,
};

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
    /// Through the centre of each pixel: one, or three from the beginning to the end of an exposure. What was emitted later is seen later,
    /// so that these see the first and the last of it, on whatever world line.
    fn centred(camera: &Camera) -> PixelSamples {
        let sampler = match generator(&camera.view).uses_moments() {
            false => Sampler::centred(),
            true => Sampler::centred_throughout(),
        };
        PixelSamples {
            sampler,
            samples: sampler.samples(),
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
            (true, _) => {
                let has = match self.is_of_cube(scene) {
                    true => "its data span",
                    false => "its light is emitted from",
                };
                format!(
                    "{source}: light in view left between ct = {a} m and {b} m; {has} {c} m to {d} m"
                )
            }
            (false, false) => format!(
                "{source}: light in view left between its own times {a} m and {b} m; it shines from {c} m to {d} m"
            ),
            (false, true) => format!(
                "{source}: light in view left between its own times {a} m and {b} m; its pulse nearest to that lasts from \
                 {c} m to {d} m"
            ),
        }
    }

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

/// The times of all sources and lamps that light something in view, by source.
pub fn seen_times(scene: &Prepared) -> Vec<SeenTimes> {
    seen_times_among(scene, 1)
}

/// [`seen_times`] for one tile in `every`.
fn seen_times_among(scene: &Prepared, every: u64) -> Vec<SeenTimes> {
    seen_times_by(scene, every, PixelSamples::centred(&scene.camera))
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

/// One tile in this many is representative of most pictures: odd, so that these tiles do not lie in columns.
fn one_in(size: [u32; 2]) -> u64 {
    (Tile::count(size) / LOOKED_AT) | 1
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
