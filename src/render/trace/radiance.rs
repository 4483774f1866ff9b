//! Radiance of surfaces: what points emit at their retarded events, in their own rest frames. Base colours,
//! which need no time, and time-resolved sources.

use std::cell::Cell;
use std::fmt::Debug;

use super::base_colours::{BaseColours, Finish};
use super::captures::captured_point;
use super::emitted::{Detail, Emission, Emitted};
use super::footprint::{self, Recorded};
use super::lamps;
use super::occlusion::{any_hit, shadow_ray};
use super::point::{EmissionClock, SurfacePoint};
use super::run::Run;
use super::stats::{Counter, Meter};
use super::time_resolved::{Emitter, TimeResolved};
use crate::accel::Segment;
use crate::light::reflection::Reflection;
use crate::light::time_texture::{
    BATCH, Capture, CaptureLookups, CaptureView, Coverage, Located, Sampled, TimeTexture,
};

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
    if run.filters(texture) {
        return footprint::look_up(texture, set, clock, run, emitted, meter);
    }
    // Exposures that data are integrated over: the mean from the beginning to the end of each sample's part.
    if run.spans(clock, &mut emitted.spans) {
        emitted.times.resize(run.count(), 0.0);
        run.times(clock, 0, &mut emitted.times);
        let near = std::mem::take(&mut emitted.near);
        texture.look_up_each(&near, run.count(), |k| {
            let uv = run.hit(k).and_then(|hit| run.rest.uv(run.patch, set, &hit));
            let span = emitted.spans[k].map(|after| emitted.times[k] + after);
            let sampled = texture.mean_uv(uv.unwrap_or(glam::DVec2::NAN), span, &near);
            if near.is_asking() {
                return;
            }
            if meter.is_on() {
                meter.count(
                    Counter::TextureBytes,
                    texture.bytes_of_lookup(None, Some(span)),
                );
            }
            emitted.push(Emission::stored(sampled));
        });
        emitted.near = near;
        return;
    }
    // Otherwise by batches, whose times and lookups go in vectors.
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
        run.times(clock, begin, &mut lookups.t[..count]);
        texture.sample_each(lookups, count);
        let radiance = lookups.radiance[..count].iter();
        emitted
            .radiance
            .extend(radiance.map(|[r, g, b, _]| [*r, *g, *b]));
        // Only lookups that are not wholly within the data say more than their radiance.
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
                end: None,
            });
        }
        located.push(at);
    });
    emitted.times.resize(run.count(), 0.0);
    run.times(clock, 0, &mut emitted.times);
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

    // Points all of whose taps hold data together, the others one by one, and so means.
    let means = run.spans(clock, &mut emitted.spans);
    let singly = means || run.filters(texture);
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
    let read = Cell::new(0);
    let near = std::mem::take(&mut emitted.near);
    texture.look_up_each(&near, emitted.located.len(), |at| {
        let sampled = match emitted.known[at] {
            Some(_) if near.is_asking() => return,
            Some((radiance, 1.0)) => return emitted.radiance.push(radiance),
            Some((radiance, held)) => Sampled {
                radiance,
                coverage: Coverage {
                    held,
                    ..Coverage::default()
                },
                ..Sampled::default()
            },
            None => {
                let recorded = Recorded {
                    texture,
                    capture,
                    clock,
                    point: emitted.points.captured(at),
                    located: &emitted.located[at],
                    time: emitted.times[at],
                    span: means.then(|| emitted.spans[at]),
                    blocked: emitted.blocked[at],
                    near: &near,
                    read: meter.is_on().then_some(&read),
                };
                recorded.look_up(run, at)
            }
        };
        if !near.is_asking() {
            emitted.push(Emission::stored(sampled));
        }
    });
    emitted.near = near;
    meter.count(Counter::TextureBytes, read.get());
}

impl TimeResolved {
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
        // Matte surfaces gather irradiance here and take their colour once, below; others reflect light as it arrives.
        for lamp in lamps.iter().filter_map(|k| self.lamps[*k].as_ref()) {
            lamps::illuminate(run, lamp, self.index, emitted, meter);
        }
        if let Some(areas) = &self.areas {
            areas.illuminate(&self.base, run, self.index, emitted, meter);
        }
        if let Some(sky) = &self.sky {
            sky.illuminate(run, self.index, emitted, meter);
        }
        emitted.times.clear();
        if let Some(emission) = &finish.emission {
            emission.factors(run, &mut emitted.times);
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
                let factor = emitted.times.get(k).copied().unwrap_or(1.0);
                radiance = std::array::from_fn(|c| radiance[c] + factor * own[c]);
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
