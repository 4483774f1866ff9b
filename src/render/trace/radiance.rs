//! Radiance of surfaces: the light that points emit at their retarded events, in their own rest frames. Both base colours, which need no
//! time, and time-resolved sources.

use std::cell::Cell;
use std::f64::consts::FRAC_1_PI;
use std::fmt::Debug;

use glam::DVec3;

use super::base_colours::{BaseColour, BaseColours, Dependence, Finish};
use super::captures::captured_point;
use super::emitted::{Colouring, Detail, Emission, Emitted, Response, Scaling};
use super::footprint::{self, Recorded};
use super::lamps;
use super::occlusion::{any_to_point, shadow_starts};
use super::run::Run;
use super::stats::{Counter, Meter};
use super::surface_point::{EmissionClock, SurfacePoint};
use super::time_resolved::{CapturedCube, Emitter, TimeResolved};
use crate::accel::Converging;
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch};
use crate::light::reflection::{Glosses, Reflection};
use crate::light::time_texture::{BATCH, Capture, CaptureView, Coverage, TimeTexture};

/// Radiance of surfaces, run by run.
///
/// A custom radiance is a type with two functions: [`emit`](Radiance::emit), which computes the light that leaves each point in the rest frame
/// of its object (the [`Response`](super::Response) then applies the camera's Doppler factor), and [`has_gaps`](Radiance::has_gaps).
/// [`Prepared::set_radiance`](crate::render::prepare::Prepared::set_radiance) replaces the radiance of the scene by it. This example shows
/// stripes that move along a moving sphere in its proper time, without data before its time −3.3:
///
/// ```
/// use nullray::light::time_texture::Coverage;
/// use nullray::render::plan::{Plan, Request};
/// use nullray::render::trace::{Colouring, Emission, Emitted, Meter, Radiance, Response, Run, Scaling};
/// use nullray::render::{prepare::Prepared, progress::Silent, render};
/// use nullray::scene::{Builder, model::Shape};
/// use nullray::spacetime::Quantity;
///
/// #[derive(Debug)]
/// struct Stripes;
///
/// impl Radiance for Stripes {
///     fn has_gaps(&self) -> bool {
///         true
///     }
///
///     fn emit(&self, run: &Run, emitted: &mut Emitted, _: &mut Meter) {
///         // The channels are colours, whose brightness changes like radiance over the whole spectrum, by W⁻⁴.
///         emitted.start(Response {
///             scaled: Scaling::Of(Quantity::Integrated),
///             colour: Colouring::Channels,
///         });
///         for point in run.points() {
///             let event = point.rest_event() - point.patch.object_origin;
///             let stripe = 0.5 + 0.5 * (20.0 * event.x.y - event.ct).sin();
///             emitted.push(match event.ct < -3.3 {
///                 true => Emission {
///                     coverage: Coverage { before: 1.0, ..Coverage::NONE },
///                     ..Emission::full([0.0; 3])
///                 },
///                 false => Emission::full([stripe; 3]),
///             });
///         }
///     }
/// }
///
/// let scene = Builder::new("a striped sphere")
///     .set("camera.eye", [0.0, 0.0, 4.0])
///     .set("camera.look_at", [0.0, 0.0, 0.0])
///     .set("camera.size", [64, 48])
///     .shape("sphere", Shape::Sphere { radius: 1.0, subdivisions: 3 })
///     .set("object.sphere.velocity.beta", [0.3, 0.0, 0.0])
///     .build()?;
/// let plan = Plan::new(&scene, &Request::default())?;
/// let mut prepared = Prepared::new(&scene, &plan, &Silent)?;
/// prepared.set_radiance(Box::new(Stripes));
/// let film = render(&prepared, &Silent)?;
/// let coverage = film.mean_coverage().unwrap_or_default();
/// assert!(coverage.held > 0.0 && coverage.before > 0.0);
/// # Ok::<(), nullray::Error>(())
/// ```
pub trait Radiance: Debug + Send + Sync {
    /// What radiance depends on: data of hits beyond this need not be computed. Channels may need more.
    fn dependence(&self) -> Dependence {
        Dependence::Weights
    }

    /// The radiance by emitter, and the observer's factor common to all of them, if every emitter is uniform in position, time and direction, and
    /// channels are plain colours; otherwise `None`.
    fn even(&self) -> Option<(Scaling, Vec<[f64; 3]>)> {
        None
    }

    /// Whether coverage can be less than full: then the film records it.
    fn has_gaps(&self) -> bool;

    /// Whether the radiance of emitter `emitter` is read from data, which may have gaps.
    fn has_data(&self, _emitter: u32) -> bool {
        self.has_gaps()
    }

    /// The number of samples of each pixel of a tile that are best shaded together.
    fn samples_at_once(&self) -> u32 {
        1
    }

    /// Fills `emitted` with the radiance that leaves the points of `run` towards the camera: call [`Emitted::start`] once, then
    /// [`Emitted::push`] once for each of [`Run::points`], in their order. Rendering with the caller's own radiance that does otherwise is an
    /// error. Values are not checked: NaN, infinite and negative radiances get into the film as they are.
    ///
    /// It is called on many threads at once, and again for a run that is rendered again: the same run has to give the same radiance.
    fn emit(&self, run: &Run, emitted: &mut Emitted, meter: &mut Meter);

    /// How the camera that captured the radiance of `point` sees it; `None` if no camera captured it.
    fn capture(&self, _point: &SurfacePoint) -> Option<CaptureView> {
        None
    }

    /// Scene index of the source, a capture, that contributes most to the point's radiance; `None` if no capture contains the point.
    fn capture_source(&self, _point: &SurfacePoint) -> Option<usize> {
        None
    }
}

impl Radiance for BaseColours {
    fn dependence(&self) -> Dependence {
        let all = self.colours.iter().map(BaseColour::dependence);
        all.max().unwrap_or(Dependence::Patch)
    }

    fn even(&self) -> Option<(Scaling, Vec<[f64; 3]>)> {
        let Response { scaled, colour } = &self.response;
        let are_channels = matches!(colour, Colouring::Channels);
        let is_alike = |base: &BaseColour| base.response.is_none() && base.profile.is_none();
        let radiance = |base: &BaseColour| base.constant().filter(|_| is_alike(base));
        let all: Option<Vec<_>> = self.colours.iter().map(radiance).collect();
        all.filter(|_| are_channels).map(|all| (*scaled, all))
    }

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
    fn dependence(&self) -> Dependence {
        // Lights that are sampled use random numbers, which may depend on everything.
        if self.areas.is_some() || self.sky.is_some() {
            return Dependence::Weights;
        }
        let all = self.emitters.iter().map(|(emitter, _)| match emitter {
            Emitter::Base(colour) => self.base.colours[*colour].dependence(),
            Emitter::Uv { .. } => Dependence::Weights,
            Emitter::Captured(_) => Dependence::Event,
            Emitter::Lit { finish, .. } => self.base.dependence_of(finish).max(Dependence::Event),
        });
        all.max().unwrap_or(Dependence::Patch)
    }

    fn has_gaps(&self) -> bool {
        true
    }

    fn has_data(&self, emitter: u32) -> bool {
        match &self.emitters[emitter as usize].0 {
            Emitter::Uv { .. } | Emitter::Captured(_) => true,
            Emitter::Base(_) | Emitter::Lit { .. } => false,
        }
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
            // Companions first: their values are stored, and those of the colours stay.
            Emitter::Uv {
                cube,
                companions,
                set,
                clock,
            } => {
                for (band, cube) in present(*companions) {
                    look_up(&self.cubes[cube], *set, *clock, run, emitted, meter);
                    emitted.set_aside(band);
                }
                look_up(&self.cubes[*cube], *set, *clock, run, emitted, meter);
            }
            Emitter::Captured(captures) => match captures.as_slice() {
                [only] => {
                    let (texture, capture) = (&self.cubes[only.cube], &self.captures[only.capture]);
                    let means = locate(texture, capture, only.clock, run, emitted, meter);
                    let by = (capture, only.clock);
                    for (band, cube) in present(only.companions) {
                        project(&self.cubes[cube], by, means, run, emitted, meter);
                        emitted.set_aside(band);
                    }
                    project(texture, by, means, run, emitted, meter);
                }
                several => {
                    // All captures of one surface have the same companions.
                    for (band, _) in present(several.first().map_or([None; 2], |c| c.companions)) {
                        let cube = |one: &CapturedCube| one.companions[band].unwrap_or(one.cube);
                        self.blend(several, cube, run, emitted, meter);
                        emitted.set_aside(band);
                    }
                    self.blend(several, |one| one.cube, run, emitted, meter);
                }
            },
            Emitter::Lit { finish, lamps } => {
                self.reflect(finish, lamps, run, emitted, meter);
            }
        }
    }
}

/// The companions that exist, by band: 0 is infrared, 1 ultraviolet.
fn present(companions: [Option<usize>; 2]) -> impl Iterator<Item = (usize, usize)> {
    let numbered = companions.into_iter().enumerate();
    numbered.filter_map(|(band, cube)| Some((band, cube?)))
}

/// Looks up `texture` at the points of `run`.
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
    // Data integrated over an exposure: the mean from the beginning to the end of each sample's part.
    if run.spans(clock, &mut emitted.spans) {
        emitted.times.resize(run.count(), 0.0);
        run.times(clock, 0, &mut emitted.times);
        let near = std::mem::take(&mut emitted.near);
        texture.look_up_each(&near, run.count(), |k| {
            let uv = run.hit(k).and_then(|hit| {
                let uv = run.rest.uv(run.patch, set, &hit)?;
                Some(texture.on_side(uv, hit.front))
            });
            let span = emitted.spans[k].map(|after| emitted.times[k] + after);
            let sampled = texture.mean_uv(uv.unwrap_or(glam::DVec2::NAN), span, &near);
            // In this pass bricks on disk are only requested: there is no result to keep.
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
    // Otherwise in batches, whose times and lookups are vectorised.
    let mut begin = 0;
    while begin < run.count() {
        let count = (run.count() - begin).min(BATCH);
        let lookups = &mut *emitted.lookups;
        for at in 0..count {
            let Some(hit) = run.hit(begin + at) else {
                continue;
            };
            let uv = run.rest.uv(run.patch, set, &hit);
            let uv = uv.map_or(glam::DVec2::NAN, |uv| texture.on_side(uv, hit.front));
            lookups.u[at] = uv.x;
            lookups.v[at] = uv.y;
        }
        run.times(clock, begin, &mut lookups.t[..count]);
        texture.sample_each(lookups, count);
        let radiance = lookups.radiance[..count].iter();
        emitted
            .radiance
            .extend(radiance.map(|[r, g, b, _]| [*r, *g, *b]));
        // Only lookups that are not wholly within the data have more than a radiance.
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

/// Positions of the points of `run` in the image of a capture camera, and whether the scene blocks their view of it. The capture camera
/// rests in the points' frame, and so does everything that can block. Returns whether lookups are means over spans of time.
fn locate(
    texture: &TimeTexture,
    capture: &Capture,
    clock: EmissionClock,
    run: &Run,
    emitted: &mut Emitted,
    meter: &mut Meter,
) -> bool {
    emitted.points.fill_places(run);
    let count = run.count();
    // Means over exposures and footprints are looked up one by one, all others in batches if the data contain them.
    let means = run.spans(clock, &mut emitted.spans);
    let singly = means || run.filters(texture);
    let Emitted {
        points,
        seen,
        leaving,
        starts,
        blocked,
        answers,
        ..
    } = emitted;
    let columns = (&points.positions, &points.normals);
    seen.locate(texture, capture, columns, singly);
    // Obstacles between the pinhole and the points that a pixel may have seen.
    let eye = capture.eye();
    shadow_starts(points, eye, starts);
    let (bvh, method, counts) = (&run.rest.bvh, run.traced.rays.method, meter.occlusion());
    // No selection: the points' own columns serve as the starts of the rays.
    if seen.is_all_plain() {
        let all = Converging {
            end: eye,
            from: points.positions.axes(),
            s_min: starts,
            skip: &points.triangles,
            at: None,
        };
        any_to_point(bvh, method, all, answers, counts);
        return means;
    }
    leaving.resize(count);
    let mut left = 0;
    seen.each_seen(|k| {
        leaving.from.set(left, points.positions.get(k));
        leaving.s_min[left] = starts[k];
        leaving.triangles[left] = points.triangles[k];
        leaving.points[left] = k as u32;
        left += 1;
    });
    leaving.resize(left);
    any_to_point(bvh, method, leaving.towards(eye), blocked, counts);
    // Whether each point is blocked; points that no pixel saw are not.
    answers.clear();
    answers.resize(count, false);
    for (point, blocked) in leaving.points.iter().zip(blocked) {
        answers[*point as usize] = *blocked;
    }
    means
}

/// Looks up what the capture camera recorded of the points of `run`, which were located before, if it saw them; `means` says that lookups
/// are means over spans of time.
fn project(
    texture: &TimeTexture,
    (capture, clock): (&Capture, EmissionClock),
    means: bool,
    run: &Run,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    let count = run.count();
    let singly = means || run.filters(texture);
    // Points all of whose taps are within the data, a whole batch at a time.
    let room = count.next_multiple_of(BATCH);
    emitted.times.resize(room, 0.0);
    run.times(clock, 0, &mut emitted.times[..count]);
    emitted.radiance.resize(count, [0.0; 3]);
    emitted.rest.clear();
    let all = std::mem::take(&mut emitted.seen);
    let mut others = all.others().iter().peekable();
    let [occluded, off_image] = [texture.occluded(), texture.off_image()];
    let mut begin = 0;
    while begin < count {
        let batch = BATCH.min(count - begin);
        let (times, blocked) = (&emitted.times[..], &emitted.answers[..]);
        let lookups = &mut emitted.captured;
        let points = (&all, begin, batch);
        match singly {
            true => lookups.clear(batch),
            false => texture.sample_taps(points, (times, blocked), lookups),
        }
        for k in 0..batch {
            let at = begin + k;
            let Some((radiance, held)) = emitted.captured.answer(k) else {
                // For some, there are known to be no data, and the substitute is known.
                let other = others.next_if(|(other, _)| *other as usize == at);
                let is_blocked = emitted.answers[at];
                let stand_in = match other {
                    Some((_, located)) => texture.without_data(located, is_blocked),
                    None if all.is_plain_at(at) && !is_blocked => None,
                    None if all.is_beside_at(at) => off_image,
                    None => occluded,
                };
                match stand_in {
                    Some(sampled) => emitted.put(at, Emission::stored(sampled)),
                    None => emitted.rest.push(at as u32),
                }
                continue;
            };
            emitted.radiance[at] = radiance;
            if capture.is_warped() && held != 1.0 {
                let coverage = Coverage {
                    held,
                    ..Coverage::default()
                };
                emitted.details.push(Detail {
                    at,
                    unscaled: [0.0; 3],
                    coverage,
                    wavelength_scale: 1.0,
                });
            }
        }
        if meter.is_on() {
            meter.count(Counter::TextureBytes, emitted.captured.bytes_read(texture));
        }
        begin += batch;
    }
    if emitted.rest.is_empty() {
        emitted.seen = all;
        return;
    }

    // The remaining points, one by one.
    let read = Cell::new(0);
    let near = std::mem::take(&mut emitted.near);
    let rest = std::mem::take(&mut emitted.rest);
    let mut others = all.others().iter().peekable();
    texture.look_up_each(&near, rest.len(), |n| {
        let at = rest[n] as usize;
        let point = emitted.points.captured(at);
        if n == 0 {
            others = all.others().iter().peekable();
        }
        // Plain points whose times are outside the data are located again.
        while others
            .next_if(|(other, _)| (*other as usize) < at)
            .is_some()
        {}
        let known = others.next_if(|(other, _)| *other as usize == at);
        let located = match known {
            Some((_, located)) => located,
            None => &texture.locate(capture, &point),
        };
        let recorded = Recorded {
            texture,
            capture,
            clock,
            point,
            located,
            time: emitted.times[at],
            span: means.then(|| emitted.spans[at]),
            blocked: emitted.answers[at],
            near: &near,
            read: meter.is_on().then_some(&read),
        };
        let sampled = recorded.look_up(run, at);
        if !near.is_asking() {
            emitted.put(at, Emission::stored(sampled));
        }
    });
    // Sort by point.
    emitted.details.sort_unstable_by_key(|detail| detail.at);
    (emitted.near, emitted.rest, emitted.seen) = (near, rest, all);
    meter.count(Counter::TextureBytes, read.get());
}

/// Replaces normals of triangles by vertex normals, at the points of `run`, which must have been taken over.
fn smooth(finish: &Finish, run: &Run, emitted: &mut Emitted) {
    let Emitted { points, views, .. } = emitted;
    if finish.gloss.is_some() {
        points.views(views);
    }
    // The triangles' normals still decide which light comes from below the surface.
    points.keep_geometric();
    for k in 0..run.count() {
        if let Some(hit) = run.hit(k) {
            let place = (run.rest, run.patch, &hit);
            let normal = finish.normal(place, points.geometric(k), || views.get(k));
            points.normals.set(k, normal);
        }
    }
}

impl TimeResolved {
    /// Reflects light at the points of `run`: that of `lamps`, and in lit scenes all other light.
    fn reflect(
        &self,
        finish: &Finish,
        lamps: &[usize],
        run: &Run,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        let mut lamps_that_shine = lamps.iter().filter_map(|k| self.lamps[*k].as_ref());
        let has_shadows = lamps_that_shine.any(|lamp| lamp.shadows);
        // Samples of area lights and of the sky need the points' positions, too.
        match has_shadows || self.areas.is_some() || self.sky.is_some() {
            true => emitted.points.fill(run),
            false => emitted.points.fill_unshadowed(run),
        }
        if finish.is_smooth {
            smooth(finish, run, emitted);
        }
        if let Some(spectra) = &self.spectra {
            spectra.begin(run, &mut emitted.spectral);
        }
        self.start(finish, run, emitted);
        // Matte surfaces gather irradiance here and are multiplied by their colour once, below; others reflect light as it arrives.
        for lamp in lamps.iter().filter_map(|k| self.lamps[*k].as_ref()) {
            lamps::illuminate(run, lamp, self.index, emitted, meter);
        }
        // Without light, nothing has been written yet.
        if std::mem::take(&mut emitted.is_unlit) {
            match finish.gloss {
                Some(_) => emitted.added.fill(run.count(), DVec3::ZERO),
                None => emitted.incident.sum.fill(run.count(), DVec3::ZERO),
            }
        }
        if let Some(areas) = &self.areas {
            areas.illuminate(&self.base, run, self.index, emitted, meter);
        }
        if let Some(sky) = &self.sky {
            sky.illuminate(run, self.index, emitted, meter);
        }
        // Factors of the surface's own emission, at the object's proper times of emission; none if it is steady.
        emitted.times.clear();
        if let Some(emission) = self.shown_emission(finish) {
            emission.factors(run, &mut emitted.times);
        }
        // Glossy points hold radiance. Matte points hold irradiance, which becomes radiance in place.
        let reflected = match finish.gloss {
            Some(_) => &emitted.added,
            None => {
                let albedo = self.base.colours[finish.colour].constant();
                let albedo = albedo.filter(|_| self.spectra.is_none());
                match (albedo, &self.spectra) {
                    (Some(_), _) => {}
                    (None, None) => self.colours(finish, run, &mut emitted.glosses.colours),
                    // Lines need them unsampled, and have used them by now.
                    (None, Some(_)) => emitted.spectral.sample(&mut emitted.glosses.colours),
                }
                dispatch(Matte {
                    albedo: albedo.map(DVec3::from_array),
                    albedos: &emitted.glosses.colours,
                    light: &mut emitted.incident.sum,
                });
                &emitted.incident.sum
            }
        };
        reflected.add_to(&mut emitted.radiance);
        if let Some(emission) = self.shown_emission(finish) {
            for k in 0..run.count() {
                let Some(hit) = run.hit(k) else {
                    continue;
                };
                let own = self.base.colour_at(emission, run.rest, run.patch, &hit);
                let factor = emitted.times.get(k).copied().unwrap_or(1.0);
                if let Some(spectra) = &self.spectra {
                    spectra.see_rgb(k, own.map(|c| factor * c), &mut emitted.spectral);
                    continue;
                }
                let radiance = &mut emitted.radiance[k];
                *radiance = std::array::from_fn(|c| radiance[c] + factor * own[c]);
            }
        }
        if let Some(spectra) = &self.spectra {
            spectra.see_lines(&mut emitted.spectral);
        }
        emitted.note_wavelengths();
    }

    /// Fills `colours` with the base colours at the points of `run`.
    fn colours(&self, finish: &Finish, run: &Run, colours: &mut Columns) {
        if let Some(colour) = self.base.colours[finish.colour].constant() {
            return colours.fill(run.count(), colour.into());
        }
        colours.resize(run.count());
        for k in 0..run.count() {
            if let Some(hit) = run.hit(k) {
                let colour = self.base.radiance(finish.colour, run, &hit);
                colours.set(k, colour.into());
            }
        }
    }

    /// Clears the light of the last run, and records how the points of `run`, which must have been taken over, reflect if they are not
    /// diffuse.
    fn start(&self, finish: &Finish, run: &Run, emitted: &mut Emitted) {
        // Only the colour of a line depends on wavelengths.
        let is_line = matches!(emitted.response.colour, Colouring::ShiftedLine(_));
        emitted.incident.start_unlit(run.count(), is_line);
        emitted.is_unlit = true;
        emitted.glosses.clear();
        emitted.reflections.clear();
        emitted.spectral.start();
        let Some(gloss) = &finish.gloss else {
            if self.spectra.is_some() {
                self.colours(finish, run, &mut emitted.glosses.colours);
            }
            return;
        };
        let Emitted {
            points,
            views,
            glosses,
            reflections,
            added,
            is_unlit,
            incident,
            spectral,
            ..
        } = emitted;
        // Samples of areas and of the sky need the reflection of each point; loops over lamps need only one block if all points are alike.
        let has_lines = self.spectra.is_some_and(|spectra| spectra.has_lines);
        let by_point = self.areas.is_some() || self.sky.is_some() || has_lines;
        added.resize(run.count());
        if by_point {
            *is_unlit = false;
            added.fill(run.count(), DVec3::ZERO);
            incident.sum.fill(run.count(), DVec3::ZERO);
        }
        if by_point || points.unit_tangents().is_none() {
            points.views(views);
        }
        // One block serves all points if nothing differs between them.
        let colour = self.base.colours[finish.colour].constant();
        let has_own = by_point || self.spectra.is_some();
        if let (Some(colour), None, false) = (colour, gloss.texture, has_own) {
            return glosses.fill_alike(colour, [gloss.metallic, gloss.roughness], gloss.dielectric);
        }
        glosses.dielectric = gloss.dielectric;
        self.colours(finish, run, &mut glosses.colours);
        let Glosses {
            colours,
            metallic,
            roughness,
            ..
        } = glosses;
        metallic.resize(run.count(), gloss.metallic);
        roughness.resize(run.count(), gloss.roughness);
        // Metalness and roughness by texture.
        if gloss.texture.is_some() {
            for k in 0..run.count() {
                if let Some(hit) = run.hit(k) {
                    [metallic[k], roughness[k]] = self.base.gloss(gloss, run.rest, run.patch, &hit);
                }
            }
        }
        if by_point {
            let all = metallic.iter().zip(&*roughness).enumerate();
            reflections.extend(all.map(|(k, (metallic, roughness))| {
                let (normal, view) = (points.normals.get(k), views.get(k));
                let colour = colours.get(k).to_array();
                let look = [*metallic, *roughness];
                Reflection::metallic_roughness(normal, view, colour, look, gloss.dielectric)
                    .on(points.geometric(k))
            }));
        }
        if let Some(spectra) = &self.spectra {
            spectra.reflect(reflections, spectral);
            spectral.sample(&mut glosses.colours);
        }
    }
}

/// The loop from irradiance on matte surfaces to their radiance: albedo E_F/π.
struct Matte<'a> {
    /// The albedo, if it is constant; otherwise by point.
    albedo: Option<DVec3>,
    albedos: &'a Columns,
    light: &'a mut Columns,
}

impl VectorLoop for Matte<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        while begin < self.light.len() {
            // In place, channel by channel.
            let Some(light) = self.light.block_mut(begin) else {
                return;
            };
            match self.albedo {
                Some(albedo) => {
                    for (light, albedo) in light.into_iter().zip(albedo.to_array()) {
                        for light in light {
                            *light = albedo * *light * FRAC_1_PI;
                        }
                    }
                }
                None => {
                    let albedos = self.albedos.block(begin).axes();
                    for (light, albedos) in light.into_iter().zip(albedos) {
                        for (light, albedo) in light.iter_mut().zip(albedos) {
                            *light = albedo * *light * FRAC_1_PI;
                        }
                    }
                }
            }
            begin += BLOCK;
        }
    }
}
