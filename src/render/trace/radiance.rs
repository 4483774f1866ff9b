//! Radiance of surfaces: what points emit at their retarded events, in their own rest frames. Base colours,
//! which need no time, and time-resolved sources.

use std::fmt::Debug;
use std::sync::Arc;

use super::captures::{CapturedCube, captured_point};
use super::emitted::{Detail, Emission, Emitted, Response};
use super::lamps;
use super::lights::{AreaLights, SkyLight};
use super::occlusion::{any_hit, shadow_ray};
use super::point::SurfacePoint;
use super::rest_frame::{Patch, RestFrame};
use super::run::Run;
use super::stats::{Counter, Meter};
use crate::accel::{Hit, Segment};
use crate::io::cube::Bricks;
use crate::io::image::Texture;
use crate::light::lamp::Lamp;
use crate::light::reflection::Reflection;
use crate::light::time_texture::{
    BATCH, Capture, CaptureLookups, CaptureView, Coverage, Located, Sampled, TimeTexture,
};
use crate::mesh::Wrap;
use crate::scene::model::CaptureChoice;

/// Radiance of surfaces, run by run.
pub trait Radiance: Debug + Send + Sync {
    /// Whether coverage can be other than full.
    fn has_gaps(&self) -> bool;

    /// Fills `emitted` with what leaves the points of `run` towards the camera: [`Emitted::start`], then
    /// [`Emitted::push`] for each point.
    fn emit(&self, run: &Run, emitted: &mut Emitted, meter: &mut Meter);

    /// How the camera that captured the radiance of `point` looks at it; none where no camera did.
    fn capture(&self, _point: &SurfacePoint) -> Option<CaptureView> {
        None
    }

    /// Index in the scene of the source, a capture, that gives the point most of its radiance; none where no capture
    /// holds the point.
    fn capture_source(&self, _point: &SurfacePoint) -> Option<usize> {
        None
    }
}

/// Time-independent radiance: a factor, a texture, colours of vertices.
#[derive(Debug, Clone)]
pub struct BaseColour {
    /// Linear RGB.
    pub factor: [f64; 3],
    /// Its texture.
    pub texture: Option<TextureLookup>,
    /// Whether the mesh's colours are a factor too.
    pub vertex_colours: bool,
    /// What an observer makes of it, where that is not the common response.
    pub response: Option<Response>,
}

/// A texture, and how it is looked up.
#[derive(Debug, Clone, Copy)]
pub struct TextureLookup {
    /// Index into [`BaseColours::textures`].
    pub texture: usize,
    /// The set of texture coordinates.
    pub uv_set: usize,
    /// What lies outside [0, 1] along u and v.
    pub wrap: [Wrap; 2],
}

/// How a surface reflects and shines.
#[derive(Debug, Clone)]
pub struct Finish {
    /// Index of its colour among the base colours.
    pub colour: usize,
    /// Metalness and roughness; none of a diffuse surface.
    pub gloss: Option<Gloss>,
    /// What goes through; none of an opaque surface.
    pub glass: Option<Glass>,
    /// Radiance of its own.
    pub emission: Option<BaseColour>,
}

/// What goes through a surface.
#[derive(Debug, Clone, Copy)]
pub struct Glass {
    /// The part of what is not reflected.
    pub transmission: f64,
    /// Refractive index of the body that it bounds.
    pub index: f64,
    /// Whether it bounds a body, and is not a film without thickness.
    pub solid: bool,
}

/// Metalness and roughness.
#[derive(Debug, Clone, Copy)]
pub struct Gloss {
    /// Factor on the metalness.
    pub metallic: f64,
    /// Factor on the perceptual roughness.
    pub roughness: f64,
    /// Roughness in its green channel, metalness in its blue one.
    pub texture: Option<TextureLookup>,
}

/// Base colours of all patches.
#[derive(Debug)]
pub struct BaseColours {
    /// By emitter index.
    pub colours: Vec<BaseColour>,
    /// Decoded textures.
    pub textures: Vec<Texture>,
    /// The common response.
    pub response: Response,
}

/// All kinds of emitters, some of which vary with time.
#[derive(Debug)]
pub struct TimeResolved {
    /// By emitter index.
    pub emitters: Vec<(Emitter, Response)>,
    /// Base colours (also albedos of what lamps light).
    pub base: BaseColours,
    /// Cubes with their time axes.
    pub cubes: Vec<TimeTexture>,
    /// The source of the scene that each of them is.
    pub cube_sources: Vec<usize>,
    /// Which of several captures of one surface is taken.
    pub choice: CaptureChoice,
    /// Capture cameras and what they saw.
    pub captures: Vec<Capture>,
    /// By source of the scene: pulses; then the scene's lights without extent.
    pub lamps: Vec<Option<Lamp>>,
    /// Surfaces that shine.
    pub areas: Option<Box<AreaLights>>,
    /// The sky, where it lights.
    pub sky: Option<SkyLight>,
    /// Refractive index of the medium.
    pub index: f64,
}

/// Where the radiance of a patch comes from.
#[derive(Debug, Clone)]
pub enum Emitter {
    /// A base colour.
    Base(usize),
    /// A cube by texture coordinates.
    Uv {
        /// Index of the cube.
        cube: usize,
        /// TEXCOORD set.
        set: usize,
        /// The clock of its time axis.
        clock: EmissionClock,
    },
    /// Cubes projected from their capture cameras, one or more.
    Captured(Vec<CapturedCube>),
    /// The light of lamps, reflected, and also that of shining surfaces and of the sky.
    Lit {
        /// How it is reflected.
        finish: Box<Finish>,
        /// Which lamps.
        lamps: Vec<usize>,
    },
}

/// A clock at the emission event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EmissionClock {
    /// World time.
    World,
    /// The own time of the object that the point is on.
    Object,
}

impl EmissionClock {
    /// The time of emission at a point.
    pub(crate) fn time(self, point: &SurfacePoint) -> f64 {
        match self {
            EmissionClock::World => point.event().ct,
            EmissionClock::Object => point.rest_event().ct - point.patch.object_origin.ct,
        }
    }

    /// The times of members `begin` and on.
    pub(super) fn times(self, run: &Run, begin: usize, times: &mut [f64]) {
        match self {
            EmissionClock::World => run.world_times(begin, times),
            EmissionClock::Object => run.object_times(begin, times),
        }
    }
}

impl BaseColours {
    /// What colour `index` emits at `hit`.
    fn radiance(&self, index: usize, run: &Run, hit: &Hit) -> [f64; 3] {
        self.colour_at(&self.colours[index], run.rest, run.patch, hit)
    }

    /// What `base` is at a hit on `patch` of the frame `rest`.
    pub(super) fn colour_at(
        &self,
        base: &BaseColour,
        rest: &RestFrame,
        patch: &Patch,
        hit: &Hit,
    ) -> [f64; 3] {
        let mut colour = base.factor;
        if let Some(lookup) = base.texture
            && let Some(uv) = rest.uv(patch, lookup.uv_set, hit)
        {
            let texel = self.textures[lookup.texture].sample(uv.to_array(), lookup.wrap);
            colour = std::array::from_fn(|c| base.factor[c] * texel[c]);
        }
        if base.vertex_colours
            && let Some(vertex) = rest.vertex_colour(patch, hit)
        {
            colour = std::array::from_fn(|c| colour[c] * vertex[c]);
        }
        colour
    }

    /// Metalness and roughness at a hit.
    pub(super) fn gloss(
        &self,
        gloss: &Gloss,
        rest: &RestFrame,
        patch: &Patch,
        hit: &Hit,
    ) -> [f64; 2] {
        let both = [gloss.metallic, gloss.roughness];
        let Some(lookup) = gloss.texture else {
            return both;
        };
        let Some(uv) = rest.uv(patch, lookup.uv_set, hit) else {
            return both;
        };
        let [_, roughness, metallic] =
            self.textures[lookup.texture].sample_linear(uv.to_array(), lookup.wrap);
        [gloss.metallic * metallic, gloss.roughness * roughness]
    }

    /// What colour `index` emits at the points of `run`.
    fn fill(&self, index: usize, run: &Run, emitted: &mut Emitted) {
        match &self.colours[index] {
            BaseColour {
                texture: None,
                vertex_colours: false,
                factor,
                ..
            } => emitted.radiance.resize(run.count(), *factor),
            _ => {
                let hits = (0..run.count()).filter_map(|k| run.hit(k));
                let radiance = hits.map(|hit| self.radiance(index, run, &hit));
                emitted.radiance.extend(radiance);
            }
        }
    }
}

impl Radiance for BaseColours {
    fn has_gaps(&self) -> bool {
        false
    }

    fn emit(&self, run: &Run, emitted: &mut Emitted, _: &mut Meter) {
        let index = run.patch.emitter as usize;
        let own = self.colours[index].response.as_ref();
        emitted.start(own.unwrap_or(&self.response).clone());
        self.fill(index, run, emitted);
    }
}

impl Radiance for TimeResolved {
    fn has_gaps(&self) -> bool {
        true
    }

    fn capture(&self, point: &SurfacePoint) -> Option<CaptureView> {
        match &self.emitters[point.patch.emitter as usize].0 {
            Emitter::Captured(captures) => {
                let chosen = match captures.as_slice() {
                    [only] => *only,
                    several => several[self.blend_at(several, point).most()?],
                };
                self.captures[chosen.capture].view_of(&captured_point(point))
            }
            Emitter::Base(_) | Emitter::Uv { .. } | Emitter::Lit { .. } => None,
        }
    }

    fn capture_source(&self, point: &SurfacePoint) -> Option<usize> {
        match &self.emitters[point.patch.emitter as usize].0 {
            Emitter::Captured(captures) => {
                let chosen = self.blend_at(captures, point).most()?;
                Some(self.cube_sources[captures[chosen].cube])
            }
            Emitter::Base(_) | Emitter::Uv { .. } | Emitter::Lit { .. } => None,
        }
    }

    fn emit(&self, run: &Run, emitted: &mut Emitted, meter: &mut Meter) {
        let (emitter, response) = &self.emitters[run.patch.emitter as usize];
        emitted.start(response.clone());
        match emitter {
            Emitter::Base(colour) => self.base.fill(*colour, run, emitted),
            Emitter::Uv { cube, set, clock } => {
                look_up(&self.cubes[*cube], *set, *clock, run, emitted, meter);
            }
            Emitter::Captured(captures) => match captures.as_slice() {
                [only] => {
                    let (texture, capture) = (&self.cubes[only.cube], &self.captures[only.capture]);
                    project(texture, capture, only.clock, run, emitted, meter);
                }
                several => self.blend(several, run, emitted, meter),
            },
            Emitter::Lit { finish, lamps } => {
                self.reflect(finish, lamps, run, emitted, meter);
            }
        }
    }
}

/// What `texture` holds at the points of `run`.
fn look_up(
    texture: &TimeTexture,
    set: usize,
    clock: EmissionClock,
    run: &Run,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    if run.spans(clock, &mut emitted.spans) {
        emitted.times.resize(run.count(), 0.0);
        clock.times(run, 0, &mut emitted.times);
        for k in 0..run.count() {
            let uv = run.hit(k).and_then(|hit| run.rest.uv(run.patch, set, &hit));
            let span = emitted.spans[k].map(|after| emitted.times[k] + after);
            let sampled = texture.mean_uv(uv.unwrap_or(glam::DVec2::NAN), span);
            emitted.push(Emission::stored(sampled));
        }
        return;
    }
    let mut begin = 0;
    while begin < run.count() {
        let count = (run.count() - begin).min(BATCH);
        let lookups = &mut *emitted.lookups;
        for at in 0..count {
            let Some(hit) = run.hit(begin + at) else {
                continue;
            };
            let uv = run.rest.uv(run.patch, set, &hit);
            let uv = uv.unwrap_or(glam::DVec2::NAN);
            lookups.u[at] = uv.x;
            lookups.v[at] = uv.y;
        }
        clock.times(run, begin, &mut lookups.t[..count]);
        texture.sample_each(lookups, count);
        let radiance = lookups.radiance[..count].iter();
        emitted
            .radiance
            .extend(radiance.map(|[r, g, b, _]| [*r, *g, *b]));
        let details = lookups.others.iter().map(|(at, sampled)| Detail {
            at: begin + at,
            unscaled: sampled.unscaled,
            coverage: sampled.coverage,
            wavelength_scale: 1.0,
        });
        emitted.details.extend(details);
        if meter.is_on() {
            meter.count(Counter::TextureBytes, lookups.bytes_read(texture, count));
        }
        begin += count;
    }
}

/// What the capture camera recorded of the points of `run`, as far as it saw them. The capture camera rests
/// in the points' frame, and so does all that can stand between them.
fn project(
    texture: &TimeTexture,
    capture: &Capture,
    clock: EmissionClock,
    run: &Run,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    emitted.located.clear();
    emitted.segments.clear();
    emitted.points.fill(run);
    let Emitted {
        points,
        segments,
        located,
        ..
    } = emitted;
    texture.locate_each(capture, &points.positions, &points.normals, |k, at| {
        if at.is_seen() {
            let from = points.positions.get(k);
            segments.push(Segment {
                ray: shadow_ray(points.eye(k), from, capture.eye() - from),
                s_max: 1.0,
                skip: Some(points.triangles[k]),
            });
        }
        located.push(at);
    });
    emitted.times.resize(run.count(), 0.0);
    clock.times(run, 0, &mut emitted.times);
    let (method, counts) = (run.traced.rays.method, meter.occlusion());
    let (segments, blocked) = (&emitted.segments, &mut emitted.blocked);
    any_hit(&run.rest.bvh, method, segments, blocked, counts);
    // Only points that lie in the camera's image have a segment: by point, whether it is blocked.
    let seen = emitted.located.iter().map(Located::is_seen);
    let mut answers = emitted.blocked.drain(..);
    let blocked: Vec<bool> = seen
        .map(|seen| seen && answers.next() == Some(true))
        .collect();
    drop(answers);
    emitted.blocked = blocked;

    // Points all of whose taps hold data together, the others one by one, and so means and what is read from disk.
    let means = run.spans(clock, &mut emitted.spans);
    let singly = means || texture.cube().on_disk().is_some();
    let Emitted {
        captured,
        located,
        times,
        blocked,
        known,
        ..
    } = emitted;
    known.clear();
    known.resize(located.len(), None);
    captured.clear();
    let mut look_up = |captured: &mut CaptureLookups| {
        texture.sample_taps(captured);
        for (at, radiance, held) in captured.answers() {
            known[at] = Some((radiance, if capture.is_warped() { held } else { 1.0 }));
        }
        if meter.is_on() {
            meter.count(Counter::TextureBytes, captured.bytes_read(texture));
        }
        captured.clear();
    };
    for (at, located) in located.iter().enumerate() {
        if !blocked[at] && !singly {
            captured.push(at, capture, located, times[at]);
        }
        if captured.is_full() {
            look_up(captured);
        }
    }
    look_up(captured);
    for at in 0..emitted.located.len() {
        let sampled = match emitted.known[at] {
            Some((radiance, 1.0)) => {
                emitted.radiance.push(radiance);
                continue;
            }
            Some((radiance, held)) => Sampled {
                radiance,
                coverage: Coverage {
                    held,
                    ..Coverage::default()
                },
                ..Sampled::default()
            },
            None => {
                let (located, time) = (&emitted.located[at], emitted.times[at]);
                match means {
                    true => {
                        let span = emitted.spans[at].map(|after| time + after);
                        texture.mean_located(capture, located, span, emitted.blocked[at])
                    }
                    false => texture.sample_located(capture, located, time, emitted.blocked[at]),
                }
            }
        };
        emitted.push(Emission::stored(sampled));
    }
}

impl TimeResolved {
    /// The cubes that are read from disk, each once.
    pub(crate) fn on_disk(&self) -> impl Iterator<Item = &Bricks> {
        let bricks = |at: usize| self.cubes[at].cube().on_disk();
        let is_first = move |at: &usize| {
            let mut earlier = (0..*at).filter_map(bricks);
            bricks(*at).is_some_and(|own| !earlier.any(|other| Arc::ptr_eq(other, own)))
        };
        let first = (0..self.cubes.len()).filter(is_first);
        first.filter_map(move |at| bricks(at).map(Arc::as_ref))
    }

    /// Reflects light at the points of `run`: that of `lamps`, and in lit scenes all other.
    fn reflect(
        &self,
        finish: &Finish,
        lamps: &[usize],
        run: &Run,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        self.start(finish, run, emitted);
        for lamp in lamps.iter().filter_map(|k| self.lamps[*k].as_ref()) {
            lamps::illuminate(run, lamp, self.index, emitted, meter);
        }
        if let Some(areas) = &self.areas {
            areas.illuminate(&self.base, run, self.index, emitted, meter);
        }
        if let Some(sky) = &self.sky {
            sky.illuminate(run, self.index, emitted, meter);
        }
        for k in 0..run.count() {
            let Some(hit) = run.hit(k) else {
                continue;
            };
            let irradiance = emitted.incident[k];
            let mut radiance = match emitted.reflections.is_empty() {
                true => irradiance.reflected(self.base.radiance(finish.colour, run, &hit)),
                false => emitted.added[k],
            };
            if let Some(emission) = &finish.emission {
                let own = self.base.colour_at(emission, run.rest, run.patch, &hit);
                radiance = std::array::from_fn(|c| radiance[c] + own[c]);
            }
            emitted.push_known(radiance, irradiance.wavelength_scale());
        }
    }

    /// Forgets the light of the last run, and notes how the points of `run` reflect where they are not diffuse.
    fn start(&self, finish: &Finish, run: &Run, emitted: &mut Emitted) {
        emitted.points.fill(run);
        emitted.incident.clear();
        emitted.incident.resize(run.count(), Default::default());
        emitted.reflections.clear();
        let Some(gloss) = &finish.gloss else {
            return;
        };
        emitted.added.clear();
        emitted.added.resize(run.count(), [0.0; 3]);
        emitted.points.views(&mut emitted.views);
        for k in 0..run.count() {
            let Some(hit) = run.hit(k) else {
                continue;
            };
            let colour = self.base.radiance(finish.colour, run, &hit);
            let [metallic, roughness] = self.base.gloss(gloss, run.rest, run.patch, &hit);
            let (view, normal) = (emitted.views.get(k), emitted.points.normals.get(k));
            emitted.reflections.push(Reflection::metallic_roughness(
                normal, view, colour, metallic, roughness,
            ));
        }
    }
}
