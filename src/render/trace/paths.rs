//! Light from surface to surface: path tracing in space-time.
//!
//! # The equation
//!
//! Let F be the rest frame of a surface, X an event on it, n its normal, v the direction to the observer and d a look direction from X,
//! towards the origin of the light. The radiance that leaves X towards v is
//!
//! ```text
//! L_o(X, v) = L_e(X, v) + ∫ f(d, v) L_i(X, d) n·d dω_F,                                      (1)
//! ```
//!
//! all of it in F, where the surface rests and other velocities do not matter. L_i is the light of the first surface that the null ray from
//! X along d, going into the past, hits, at the event Y; let G be the rest frame of that surface, k the null vector Y − X, and u the
//! four-velocities. The number of photons in a cell of phase space is the same for all observers and is proportional to L_ν/ν³ (Misner,
//! Thorne, Wheeler, § 22.6); frequencies are proportional to k·u. So
//!
//! ```text
//! W = λ_F/λ_G = ν_G/ν_F = (k·u_G)/(k·u_F)
//! L_ν^F(ν) = W⁻³ L_ν^G(W ν),   L_λ^F(λ) = W⁻⁵ L_λ^G(λ/W),   ∫ L dν: W⁻⁴,                      (2)
//! ```
//!
//! since dν_F = dν_G/W and dλ_F = W dλ_G. Linear RGB has M(W) in place of the power ([`Received`]). (1) with (2) at every surface is the whole
//! equation: along a path X₀, X₁, … radiance is multiplied by f₀ M(W₁) f₁ M(W₂) …, and W₁ W₂ … Wₙ is the wavelength ratio of the whole path,
//! as the ratios of k·u on null rays that meet in a frame telescope if that frame does not change. The event Y is on the past light cone of X,
//! so each path has its own times: delays, shadows of moving objects and light that is still on its way need no further treatment.
//!
//! # Densities
//!
//! d³p/E = p dp dω is invariant, and dp/p is the same for all observers of one beam, so ν² dω is invariant:
//!
//! ```text
//! dω_F = W² dω_G,                                                                            (3)
//! ```
//!
//! and an element dA of a surface at rest in G, whose normal makes the angle θ_y with the ray there, at distance r_G = k·u_G, subtends
//!
//! ```text
//! dω_F = W² cos θ_y dA/r_G².                                                                 (4)
//! ```
//!
//! A direction sampled in F according to the material has a density per dω_F and needs no factor. A point sampled on a shining surface with the density p_A has
//! p_A r_G²/(W² cos θ_y) per dω_F by (4). A direction sampled with p_ω per dω_G has p_ω/W² by (3), and so has a direction of the sky sampled with p_ω per dω of
//! the world.
//!
//! # The estimator
//!
//! At every surface a direction is sampled with a density p_f according to the material's reflection, and the ray continues along it. Light
//! of lamps without extent is added directly (`lamps`); one point on all shining surfaces and, if the sky is not uniform, one direction of
//! it are sampled with densities p_l in F. Contributions that both techniques can find are weighted by p/(p_f + p_l) (the balance
//! heuristic: Veach and Guibas, "Optimally combining sampling techniques for Monte Carlo rendering", SIGGRAPH 1995); the direction of a
//! mirror can only be sampled by the mirror. After the last surface one more ray looks for emission. There is no Russian roulette: N
//! bounces are N bounces, and the mean has no bias. Numbers are Owen-scrambled Sobol' points, by pixel, sample and dimension
//! ([`sampler`](crate::render::sampler)): the same on any number of threads.
//!
//! Rays start at 2⁻⁴² of the coordinates involved above their surface, 10⁻¹² m in a scene of metres: rounding displaces events by 2⁻⁵³ of
//! their coordinates, multiplied by γ in boosts, to either side of the surface. Coordinates of a surface that moves at γ with the camera are γ
//! times as large in the world, so that the clearance grows with γ² there: plans say when it is no longer small.
//!
//! In one rest frame with constant light, neighbouring diffuse points share what paths find beyond them: [`sharing`](super::sharing).
//!
//! If light is sampled at wavelengths, each ray carries the wavelengths of its path in the frame that it leaves, and lines are carried back
//! along the path: [`spectral`](super::spectral).
//!
//! # Glass
//!
//! In a body of index n, light has the tangent (−n, d) of its rest frame F in place of (−1, d), which is transformed through all frames
//! like any other; its frequency in F stays, so W is 1 for everything at rest in the body. Objects that move relative to a body around
//! them are not computed, and neither are touching bodies of glass: seen from inside, the other side is the scene's medium. Bodies that
//! move in a medium are refused, and rays from a camera inside a body have the delay of the medium up to its surface. Reflection and
//! refraction are those of [`reflection`](crate::light::reflection). Lamps without extent are not found through glass, and glass
//! blocks sampled light of others: their light through it is found by rays that hit them, like that of the sky.
//!
//! Missing data of a cube are dark for other surfaces. Lines of different shifts in one sample are shown at their mean wavelength.
//! `display.background` lights nothing.
//!
//! Sources: Kajiya, "The rendering equation", SIGGRAPH 1986; Misner, Thorne, Wheeler, Gravitation, § 22.6 (L_ν/ν³); Weiskopf, Kraus,
//! Ruder, ACM TOG 18(3), 1999 (radiance and solid angle); Jarabo et al., ACM TOG 33(6), 2014 (time-resolved transport).

use std::f64::consts::PI;
use std::ops::Range;

use glam::DVec3;

use super::base_colours::Finish;
use super::emitted::{
    Colouring, Drawn, Emission, Emitted, Level, Met, MetPatch, MetSurface, Paths, Response,
};
use super::lamps;
use super::onward::{choose, level};
use super::radiance::Radiance;
use super::rest_frame::{Patch, RestFrame};
use super::run::{Run, TracedRays};
use super::sharing::{AT_ONCE, Sharing};
use super::sky_light::SkyLight;
use super::stats::{Meter, Stage};
use super::surface_point::SurfacePoint;
use super::time_resolved::{Emitter, TimeResolved};
use crate::colour::{Line, Wavelengths, per_wavelength_power};
use crate::light::Received;
use crate::light::lamp::{Incident, Irradiance};
use crate::light::reflection::{Reflection, Scattered};
use crate::light::sky::FromSky;
use crate::light::time_texture::CaptureView;

/// Purposes of random numbers at a surface.
pub(super) const AREA: u32 = 0;
const SKY: u32 = 1;

/// Light of all kinds, and surfaces that reflect it.
#[derive(Debug)]
pub struct PathTraced {
    /// The lights and the surfaces.
    pub light: TimeResolved,
    /// The number of reflections after the first surface.
    bounces: u32,
    /// By emitter, the form in which surfaces receive its radiance.
    received: Vec<Received>,
    /// Whether there is light that only rays that hit it can find.
    shines: bool,
    /// By emitter, the first emitter that is lit by the same lamps; `None` for emitters that lamps do not light.
    alike: Vec<Option<u32>>,
    /// How neighbours share paths; `None` if they do not.
    sharing: Option<Sharing>,
}

impl PathTraced {
    /// `light`, reflected `bounces` more times by everything at rest in `frames`; `received` is, by emitter, the form in which surfaces
    /// receive its radiance.
    pub fn new(
        light: TimeResolved,
        bounces: u32,
        received: Vec<Received>,
        frames: &[RestFrame],
    ) -> Self {
        let sharing = match frames {
            // With sampled wavelengths, neighbours have different ones, and share nothing.
            [rest] if light.spectra.is_none() && light.is_steady_for(rest) => {
                Some(Sharing::new(light.is_diffuse()))
            }
            _ => None,
        };
        // Rays cannot hit lamps: the last ray is worth tracing only if surfaces or the sky shine by themselves.
        let mut emitters = light.emitters.iter();
        let shines = light.areas.is_some()
            || light.sky.is_some()
            || emitters.any(|(emitter, _)| !matches!(emitter, Emitter::Lit { .. }));
        let lamps = |(emitter, _): &(Emitter, Response)| match emitter {
            Emitter::Lit { lamps, .. } => Some(lamps.clone()),
            _ => None,
        };
        let lamps: Vec<_> = light.emitters.iter().map(lamps).collect();
        // Emitters with the same list of lamps share the index of the first one, and `meet` lights their points in one run.
        let first = |own: &Option<Vec<usize>>| {
            let place = own.as_ref().and(lamps.iter().position(|all| all == own));
            place.map(|first| first as u32)
        };
        let alike = lamps.iter().map(first).collect();
        PathTraced {
            light,
            bounces,
            received,
            shines,
            alike,
            sharing,
        }
    }
}

/// The points of a run on one patch: runs of paths span all patches of a frame that the same lamps light.
struct Part<'a> {
    patch: &'a Patch,
    finish: &'a Finish,
    /// The range of points.
    points: Range<usize>,
}

impl Radiance for PathTraced {
    fn samples_at_once(&self) -> u32 {
        if self.goes_on(0) { AT_ONCE } else { 1 }
    }

    fn has_gaps(&self) -> bool {
        self.light.has_gaps()
    }

    fn has_data(&self, emitter: u32) -> bool {
        self.light.has_data(emitter)
    }

    fn capture(&self, point: &SurfacePoint) -> Option<CaptureView> {
        self.light.capture(point)
    }

    fn emit(&self, run: &Run, emitted: &mut Emitted, meter: &mut Meter) {
        let (emitter, response) = &self.light.emitters[run.patch.emitter as usize];
        let Emitter::Lit { finish, lamps } = emitter else {
            return self.light.emit(run, emitted, meter);
        };
        emitted.start(response.clone());
        if let Some(spectra) = &self.light.spectra {
            spectra.begin(run, &mut emitted.spectral);
        }
        // A run of camera rays covers one patch, which is its only part.
        let whole = [Part {
            patch: run.patch,
            finish,
            points: 0..run.count(),
        }];
        self.receive(&whole, lamps, run, emitted, meter);
        self.follow(run, emitted, meter);
        self.add_own(finish, run, emitted);
    }
}

impl PathTraced {
    /// Clears the light of the last run, and records how the points of `run` reflect, part by part.
    fn start(&self, parts: &[Part], run: &Run, emitted: &mut Emitted) {
        emitted.points.fill(run);
        emitted.incident.start(run.count(), true);
        emitted.added.fill(run.count(), DVec3::ZERO);
        emitted.glosses.clear();
        emitted.reflections.clear();
        emitted.spectral.start();
        emitted.points.views(&mut emitted.views);
        // Before the loop below overwrites the normals of smooth parts.
        if parts.iter().any(|part| part.finish.is_smooth) {
            emitted.points.keep_geometric();
        }
        for part in parts {
            for k in part.points.clone() {
                // All members have hit something, so reflection k is that of point k.
                let Some(hit) = run.hit(k) else {
                    continue;
                };
                let (view, geometric) = (emitted.views.get(k), emitted.points.geometric(k));
                let place = (run.rest, part.patch, &hit);
                let near = self.near(run, k);
                let (base, sides) = (&self.light.base, (geometric, view));
                let reflection = base.reflection(part.finish, place, sides, near);
                if part.finish.is_smooth {
                    emitted.points.normals.set(k, reflection.normal());
                }
                emitted.reflections.push(reflection);
            }
        }
        if let Some(spectra) = &self.light.spectra {
            spectra.reflect(&mut emitted.reflections, &mut emitted.spectral);
        }
    }

    /// The index of the medium from which point `k` of `run` is seen, relative to that of the scene's medium.
    fn near(&self, run: &Run, k: usize) -> f64 {
        let traced = run.traced;
        let ray = run.members[k] as usize;
        // The delay of the scene's medium: the ray does not come through glass.
        if traced.rays.origin(ray).delay == 1.0 {
            return 1.0;
        }
        // In glass: that of the ray in the rest frame.
        let (local, _) = traced
            .surfaces
            .local(run.frame, ray, &traced.rays, traced.hits);
        -local.tangent.ct / (local.tangent.x.length() * self.light.index)
    }

    /// Adds the light of lamps at the points of `run`, and samples of shining surfaces and of the sky.
    fn illuminate(&self, lamps: &[usize], run: &Run, emitted: &mut Emitted, meter: &mut Meter) {
        let TimeResolved {
            lamps: all,
            areas,
            sky,
            base,
            index,
            ..
        } = &self.light;
        // No ray hits a lamp without extent: its light needs no weight.
        for lamp in lamps.iter().filter_map(|k| all[*k].as_ref()) {
            lamps::illuminate(run, lamp, *index, emitted, meter);
        }
        // If an obstacle is in the way, followed rays do not find shining surfaces whose light ignores shadows: only light samples do.
        let weight = |reflection: Option<&Reflection>, l, density, shadows| match shadows {
            true => balance(density, reflection.map_or(0.0, |r| r.density(l))),
            false => 1.0,
        };
        if let Some(areas) = areas {
            let buffers = (&mut emitted.keys, &mut emitted.indices);
            run.each_on_path(AREA, buffers, &mut emitted.numbers);
            areas.illuminate_by(
                |reflection, sent| weight(reflection, sent.l, sent.density, sent.shadows),
                base,
                run,
                *index,
                emitted,
                meter,
            );
        }
        // A sky without bright parts is left to the rays that continue, unless it ignores shadows, which they do not.
        let is_drawn =
            |sky: &&super::SkyLight| !sky.shadows || sky.frames[run.frame as usize].is_uneven();
        if let Some(sky) = sky.as_ref().filter(is_drawn) {
            let buffers = (&mut emitted.keys, &mut emitted.indices);
            run.each_on_path(SKY, buffers, &mut emitted.numbers);
            sky.illuminate_by(
                |reflection, l, density| weight(reflection, l, density, sky.shadows),
                run,
                *index,
                emitted,
                meter,
            );
        }
    }

    /// Whether rays continue from surfaces that have `depth` surfaces before them.
    fn goes_on(&self, depth: u32) -> bool {
        depth < self.bounces || (depth == self.bounces && self.shines)
    }

    /// Adds the light that is found along one sampled direction from each point of `run`, and from there on: level by level, so that each
    /// level has many rays, and then back.
    fn follow(&self, run: &Run, emitted: &mut Emitted, meter: &mut Meter) {
        let depth = run.traced.rays.samples.depth;
        if !self.goes_on(depth) {
            return;
        }
        // Level 0: one ray from each point, or from a few points of each group, which share what these find.
        let mut paths = emitted.paths.take().unwrap_or_default();
        let first = level(&mut paths.levels, 0);
        first.start(depth + 1);
        match &self.sharing {
            None => first.draw(run, emitted, |k| k as u32),
            Some(sharing) => {
                let Paths {
                    levels,
                    groups,
                    chosen,
                    ..
                } = &mut *paths;
                choose(run, emitted, sharing, groups, chosen);
                level(levels, 0).draw_chosen(run, emitted, chosen, groups);
            }
        }
        // `meet` samples the rays of the next level, until a level has none.
        let mut count = 0;
        while !level(&mut paths.levels, count).drawn.is_empty() {
            self.meet(&mut paths, count, run.traced, meter);
            count += 1;
        }
        // The light that the last surfaces send is known; it completes the light of the surfaces before them.
        for at in (1..count).rev() {
            let (before, after) = paths.levels.split_at_mut(at);
            for (drawn, met) in after[0].drawn.iter().zip(&after[0].met) {
                let light = self.sent(met);
                if let (Some(light), Met::Surface(point)) =
                    (light, &mut before[at - 1].met[drawn.from as usize])
                {
                    let known = (&mut point.reflected, &mut point.incident);
                    add(known, drawn.scattered.weight, light);
                }
            }
        }

        // Level 0 starts at the points of the run. Its shared rays come last, and `share` weights them for each point of a group.
        let first = level(&mut paths.levels, 0);
        let alone = first.shared_from.unwrap_or(first.drawn.len());
        for (drawn, met) in first.drawn[..alone].iter().zip(&first.met) {
            if let Some(light) = self.sent(met) {
                let k = drawn.from as usize;
                let mut reflected = emitted.added.get(k).to_array();
                let mut incident = emitted.incident.get(k);
                add(
                    (&mut reflected, &mut incident),
                    drawn.scattered.weight,
                    light,
                );
                emitted.added.set(k, reflected.into());
                emitted.incident.set(k, &incident);
            }
        }
        if first.shared_from.is_some() {
            self.share(&mut paths, run, emitted, meter);
        }
        emitted.spectral.leaving.append(&mut paths.lines);
        emitted.paths = Some(paths);
    }

    /// Traces the rays of level `at`, records what they hit, and samples the rays of the next level.
    fn meet(&self, paths: &mut Paths, at: usize, before: &TracedRays, meter: &mut Meter) {
        let Paths {
            levels,
            order,
            members,
            wavelength_ratios,
            emitted,
            lines,
            ..
        } = paths;
        level(levels, at + 1);
        let (levels, next) = levels.split_at_mut(at + 1);
        let this = &mut levels[at];
        // Both are filled below, from the rest of the level.
        let (mut hits, mut met) = (
            std::mem::take(&mut this.hits),
            std::mem::take(&mut this.met),
        );
        let this = &levels[at];
        let (depth, drawn, ratios) = (this.depth, &this.drawn, &this.ratios);
        let is_shared = |ray: usize| this.shared_from.is_some_and(|from| ray >= from);
        next[0].start(depth + 1);
        let rays = this.rays(before);
        meter.lap(Stage::Radiance);
        before.surfaces.nearest(&rays, &mut hits, meter);
        let traced = TracedRays {
            surfaces: before.surfaces,
            rays,
            hits: &hits,
            event: before.event,
            index: before.index,
        };
        // By patch: points with the same lamps and finish are shaded together.
        sort(&traced, order);
        // Rays that hit nothing see the sky, whose lines are carried back one by one.
        met.clear();
        let escaped = drawn.iter().zip(traced.hits.hits()).enumerate();
        met.extend(escaped.map(|(ray, (drawn, hit))| match hit {
            None => Met::Light(self.escaped(drawn, is_shared(ray), this.wavelengths.get(ray))),
            Some(_) => Met::Nothing,
        }));
        if let Some(light) = self
            .light
            .sky
            .as_ref()
            .filter(|_| !this.rgb_weights.is_empty())
        {
            for (ray, (drawn, hit)) in drawn.iter().zip(traced.hits.hits()).enumerate() {
                if hit.is_none() {
                    self.escaped_lines(light, drawn, |line| {
                        lines.extend(carried_back(levels, ray as u32, line));
                    });
                }
            }
        }
        // Process rays that hit surfaces of one frame that the same lamps light together, and rays on other patches patch by patch.
        let by_patch: Vec<&[MetPatch]> = order.chunk_by(|a, b| a.place == b.place).collect();
        let patch = |group: &[MetPatch]| {
            let place = group[0];
            traced.surfaces.rest(place.frame()).patch(place.triangle())
        };
        let emitter = |group: &[MetPatch]| &self.light.emitters[group[0].emitter as usize].0;
        let lit = |group: &[MetPatch]| self.alike[group[0].emitter as usize];
        let alike = |a: &&[MetPatch], b: &&[MetPatch]| {
            a[0].frame() == b[0].frame() && lit(a).is_some() && lit(a) == lit(b)
        };
        for groups in by_patch.chunk_by(alike) {
            let frame = groups[0][0].frame();
            members.clear();
            members.extend(groups.iter().copied().flatten().map(|met| met.ray));
            let run = Run {
                traced: &traced,
                members,
                patch: patch(groups[0]),
                rest: traced.surfaces.rest(frame),
                frame,
            };
            // W = ω_G/ω_F in two factors: ω_world/ω_F of this level's rays, and ω_G/ω_world.
            run.ratios(ratios, wavelength_ratios);
            if let Some(spectra) = &self.light.spectra {
                spectra.go_on(&run, wavelength_ratios, &mut emitted.spectral);
            }
            emitted.own_weights.clear();
            match emitter(groups[0]) {
                Emitter::Lit { lamps, .. } => {
                    // One part of the run for each patch.
                    let mut parts = Vec::with_capacity(groups.len());
                    let mut end = 0;
                    for group in groups {
                        let points = end..end + group.len();
                        end = points.end;
                        if let Emitter::Lit { finish, .. } = emitter(group) {
                            parts.push(Part {
                                patch: patch(group),
                                finish,
                                points,
                            });
                        }
                    }
                    // Parts follow each other in the run, so weights are pushed in the order of its points.
                    for part in &parts {
                        let shines = part.finish.emission.is_some();
                        let points = (&run, part.points.clone());
                        self.weigh_own(points, shines, this, wavelength_ratios, emitted);
                    }
                    self.receive(&parts, lamps, &run, emitted, meter);
                    if self.goes_on(depth) {
                        next[0].draw(&run, emitted, |k| run.members[k]);
                    }
                    self.note_surfaces(&parts, &run, (wavelength_ratios, emitted), &mut met);
                    // Lines that leave these surfaces arrive in the frames of the points before, and from there go back along the path.
                    for (k, line) in emitted.spectral.leaving.drain(..) {
                        let line = line.received(wavelength_ratios[k]);
                        lines.extend(carried_back(levels, run.members[k], line));
                    }
                }
                other => {
                    // With a spectrum, it may be found by light samples.
                    let shines = matches!(other, Emitter::Base(_));
                    let points = (&run, 0..run.count());
                    self.weigh_own(points, shines, this, wavelength_ratios, emitted);
                    self.light.emit(&run, emitted, meter);
                    self.note_light(&run, (wavelength_ratios, emitted), &mut met);
                    if self.light.spectra.is_some() {
                        note_lines(&run, (wavelength_ratios, emitted), |ray, line| {
                            lines.extend(carried_back(levels, ray, line));
                        });
                    }
                }
            }
        }
        (levels[at].hits, levels[at].met) = (hits, met);
    }

    /// Gathers the direct light at the points of `run` from lamps, shining surfaces and the sky; nothing after the last surface.
    fn receive(
        &self,
        parts: &[Part],
        lamps: &[usize],
        run: &Run,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        if run.traced.rays.samples.depth <= self.bounces {
            self.start(parts, run, emitted);
            self.illuminate(lamps, run, emitted, meter);
        } else {
            emitted.spectral.start();
        }
    }

    /// Records the points of `run`, their W and the light that `emitted` has gathered for them.
    fn note_surfaces(
        &self,
        parts: &[Part],
        run: &Run,
        (ratios, emitted): (&[f64], &Emitted),
        met: &mut [Met],
    ) {
        let receives = run.traced.rays.samples.depth <= self.bounces;
        for part in parts {
            for at in part.points.clone() {
                let (reflected, incident) = match receives {
                    true => (emitted.added.get(at).to_array(), emitted.incident.get(at)),
                    false => Default::default(),
                };
                let own = self.own((part.finish, part.patch), run, at, emitted);
                met[run.members[at] as usize] = Met::Surface(MetSurface {
                    emitter: part.patch.emitter,
                    ratio: ratios[at],
                    reflected,
                    own: match &self.light.spectra {
                        None => own,
                        Some(spectra) => spectra.of_rgb(at, own, &emitted.spectral),
                    },
                    is_diffuse: !receives || emitted.reflections[at].is_diffuse(),
                    incident,
                });
            }
        }
    }

    /// Records the light of the points of `run`, whose W are `ratios`.
    fn note_light(&self, run: &Run, (ratios, emitted): (&[f64], &Emitted), met: &mut [Met]) {
        let emitter = run.patch.emitter as usize;
        let mut details = emitted.details.iter().peekable();
        for (at, ray) in run.members.iter().enumerate() {
            let detail = details.next_if(|detail| detail.at == at);
            let scale = detail.map_or(1.0, |detail| detail.wavelength_scale);
            let radiance = (emitted.radiance[at], emitted.companions(at));
            let wavelengths = run.traced.rays.wavelengths.get(*ray as usize);
            let light = match wavelengths {
                Some(wavelengths) => {
                    let seen = (ratios[at], *wavelengths);
                    self.arriving_at(emitter, &emitted.response, seen, radiance)
                }
                None => {
                    let light = (radiance.0, radiance.1, scale);
                    self.arriving(emitter, &emitted.response, ratios[at], light)
                }
            };
            let weight = emitted.own_weights.get(at).copied().unwrap_or(1.0);
            met[*ray as usize] = Met::Light(light.scaled(weight));
        }
    }

    /// The light that arrives along a ray that has hit this.
    fn sent(&self, met: &Met) -> Option<Incident> {
        match met {
            Met::Nothing => None,
            Met::Light(light) => Some(*light),
            Met::Surface(point) => {
                let emitter = point.emitter as usize;
                let radiance = std::array::from_fn(|c| point.reflected[c] + point.own[c]);
                let scale = point.incident.wavelength_scale();
                let response = &self.light.emitters[emitter].1;
                // Reflecting surfaces have no companions.
                let light = (radiance, [0.0; 2], scale);
                Some(self.arriving(emitter, response, point.ratio, light))
            }
        }
    }

    /// The incident light due to the radiance that leaves a surface of emitter `emitter`, seen at W.
    pub(super) fn arriving(
        &self,
        emitter: usize,
        response: &Response,
        w: f64,
        (radiance, companions, wavelength_scale): ([f64; 3], [f64; 2], f64),
    ) -> Incident {
        // (2): from G to F. The power of W is that of the declared quantity, or part of M(W) or of the spectrum's colour.
        let received = &self.received[emitter];
        let light = match &response.colour {
            Colouring::Spectrum(table, _) => {
                let factor = (radiance[0] + radiance[1] + radiance[2]) / 3.0;
                table.colour(w).map(|c| c * factor)
            }
            Colouring::Companions(shift, _) => shift.apply(w, radiance, companions),
            Colouring::Sampled(_) => radiance.map(|l| l * per_wavelength_power(w)),
            _ => received.radiance(w, radiance),
        };
        Incident::new(light, wavelength_scale * received.wavelength_scale(w))
    }

    /// The incident light, at given wavelengths, due to linear RGB or to a spectrum without its lines that leaves a surface of emitter `emitter`,
    /// seen at W.
    fn arriving_at(
        &self,
        emitter: usize,
        response: &Response,
        (w, wavelengths): (f64, Wavelengths),
        (radiance, companions): ([f64; 3], [f64; 2]),
    ) -> Incident {
        let light = match &response.colour {
            Colouring::Spectrum(table, _) => {
                let factor = mean(radiance);
                table.spectrum().at(w, wavelengths).map(|l| l * factor)
            }
            Colouring::Companions(shift, _) => shift.at(w, radiance, companions, wavelengths),
            _ => self.received[emitter].at(w, radiance, wavelengths),
        };
        Incident::new(light, 1.0)
    }

    /// The incident light of the sky along `drawn`, if the ray that continues along it hits nothing; not weighted if the ray `is_shared`.
    fn escaped(
        &self,
        drawn: &Drawn,
        is_shared: bool,
        wavelengths: Option<&Wavelengths>,
    ) -> Incident {
        let Some(light) = &self.light.sky else {
            return Incident::new([0.0; 3], 1.0);
        };
        let Drawn {
            cosine,
            scattered: Scattered { l, density, .. },
            ..
        } = *drawn;
        // The sky rests in the world: W = λ_F/λ_world = 1/ρ with ρ = ω_F/ω_world.
        let boosted = &light.frames[drawn.frame as usize];
        let (d, rho) = boosted.in_world(l);
        let w = 1.0 / rho;
        let from = FromSky {
            sky: &light.sky,
            d,
            rho,
            wavelengths,
        };
        let radiance = if density.is_infinite() {
            // A mirror shows the sun, which it does not reflect as a lamp.
            boosted.radiance_with_sun(&from)
        } else if is_shared {
            boosted.mean_radiance(&from)
        } else {
            let weight = match (light.shadows, boosted.is_uneven()) {
                (false, _) => 0.0,
                (true, false) => 1.0,
                (true, true) => balance(density, boosted.density(cosine, d, rho)),
            };
            let radiance = boosted.reflected_radiance(&from, density);
            radiance.map(|l| l * weight)
        };
        Incident::new(radiance, boosted.received().wavelength_scale(w))
    }

    /// Calls `each` with the sky's lines that arrive along `drawn`, if the ray that continues along it hits nothing.
    fn escaped_lines(&self, light: &SkyLight, drawn: &Drawn, mut each: impl FnMut(Line)) {
        let Scattered { l, density, .. } = drawn.scattered;
        let boosted = &light.frames[drawn.frame as usize];
        let (d, rho) = boosted.in_world(l);
        let weight = match (light.shadows, boosted.is_uneven()) {
            _ if density.is_infinite() => 1.0,
            (false, _) => 0.0,
            (true, false) => 1.0,
            (true, true) => balance(density, boosted.density(drawn.cosine, d, rho)),
        };
        for line in light.sky.lines(1.0 / rho) {
            each(line.scaled(weight));
        }
    }

    /// Records the weights of the emission of `points` of `run`, if they emit: each was hit by a ray of `level` and could have been found by
    /// light samples, too. `ratios` are W. Emission on shared rays is weighted by each point that shares them.
    fn weigh_own(
        &self,
        (run, points): (&Run, Range<usize>),
        shines: bool,
        level: &Level,
        ratios: &[f64],
        emitted: &mut Emitted,
    ) {
        let weights = &mut emitted.own_weights;
        let Some(areas) = self.light.areas.as_ref().filter(|_| shines) else {
            weights.resize(weights.len() + points.len(), 1.0);
            return;
        };
        for at in points {
            let Some(point) = run.point(at) else {
                continue;
            };
            let ray = run.members[at] as usize;
            if level.shared_from.is_some_and(|from| ray >= from) {
                weights.push(1.0);
                continue;
            }
            let drawn = &level.drawn[ray];
            let by_material = drawn.scattered.density;
            let from = (drawn.frame, drawn.normal);
            let by_area = areas.density(run.traced.surfaces, &point, from);
            let weight = match by_area {
                _ if by_material.is_infinite() => 1.0,
                None => 1.0,
                Some((_, false)) => 0.0,
                Some((by_area, true)) => {
                    // (4), with r_G = s |k| in the rest frame of the shining surface.
                    let k = point.local.tangent.x;
                    let (r, w) = (point.hit.s * k.length(), ratios[at]);
                    let cosine = -point.facing_normal().dot(k) / k.length();
                    let cosine = cosine.max(f64::MIN_POSITIVE);
                    let by_light = by_area.per_solid_angle(r * r, cosine) / (w * w);
                    balance(by_material, by_light)
                }
            };
            weights.push(weight);
        }
    }

    /// The emission of point `at` of `run`, times its weight.
    fn own(
        &self,
        (finish, patch): (&Finish, &Patch),
        run: &Run,
        at: usize,
        emitted: &Emitted,
    ) -> [f64; 3] {
        let (Some(emission), Some(hit)) = (&finish.emission, run.hit(at)) else {
            return [0.0; 3];
        };
        let base = &self.light.base;
        let own = base.colour_at(emission, run.rest, patch, &hit);
        // At the object's proper time.
        let factor = emission.factor_at(|| match run.point(at) {
            Some(point) => point.rest_event().ct - patch.object_origin.ct,
            None => f64::NAN,
        });
        let weight = emitted.own_weights.get(at).copied().unwrap_or(1.0);
        own.map(|c| weight * factor * c)
    }

    /// Completes the points of `run`: what they reflect, and their own emission.
    fn add_own(&self, finish: &Finish, run: &Run, emitted: &mut Emitted) {
        for k in 0..run.count() {
            let mut own = match self.light.shows_emission {
                true => self.own((finish, run.patch), run, k, emitted),
                false => [0.0; 3],
            };
            if let Some(spectra) = &self.light.spectra {
                // Emission seen directly is exact.
                spectra.see_rgb(k, own, &mut emitted.spectral);
                own = [0.0; 3];
            }
            let reflected = emitted.added.get(k);
            let wavelength_scale = emitted.incident.get(k).wavelength_scale();
            emitted.push(Emission {
                wavelength_scale,
                ..Emission::full(std::array::from_fn(|c| reflected[c] + own[c]))
            });
        }
        if let Some(spectra) = &self.light.spectra {
            spectra.see_lines(&mut emitted.spectral);
        }
    }
}

/// Calls `each` with the lines that the points of `run` emit, whose W are `ratios`, as they arrive along their rays.
fn note_lines(run: &Run, (ratios, emitted): (&[f64], &Emitted), mut each: impl FnMut(u32, Line)) {
    let Colouring::Spectrum(table, _) = &emitted.response.colour else {
        return;
    };
    for (at, ray) in run.members.iter().enumerate() {
        let weight = emitted.own_weights.get(at).copied().unwrap_or(1.0);
        let factor = weight * mean(emitted.radiance[at]);
        for line in table.spectrum().lines() {
            each(*ray, line.received(ratios[at]).scaled(factor));
        }
    }
}

/// A line that arrives along a ray of the last of `levels`, carried back to where it leaves the first surface of the path, and the index of
/// that point.
fn carried_back(levels: &[Level], ray: u32, line: Line) -> Option<(usize, Line)> {
    let (mut ray, mut line) = (ray as usize, line);
    // Backwards: a line is reflected where its ray left, and received by the point whose ray hit that surface.
    let (last, before) = levels.split_last()?;
    let reflect = |level: &Level, ray: usize, line: Line| {
        Some((
            level.drawn.get(ray)?.from,
            line.reflected(*level.rgb_weights.get(ray)?),
        ))
    };
    let (mut from, reflected) = reflect(last, ray, line)?;
    line = reflected;
    for level in before.iter().rev() {
        ray = from as usize;
        let Met::Surface(point) = level.met.get(ray)? else {
            return None;
        };
        (from, line) = reflect(level, ray, line.received(point.ratio))?;
    }
    Some((from as usize, line))
}

fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}

/// The weight of the sky's light along `l` of frame `frame`, found by a cosine-distributed direction of this density.
pub(super) fn sky_weight(light: &SkyLight, frame: u32, l: DVec3, density: f64) -> f64 {
    let boosted = &light.frames[frame as usize];
    match (light.shadows, boosted.is_uneven()) {
        (false, _) => 0.0,
        (true, false) => 1.0,
        (true, true) => {
            // The density is n·l/π, and the sky's own density needs n·l.
            let (d, rho) = boosted.in_world(l);
            balance(density, boosted.density(density * PI, d, rho))
        }
    }
}

/// Puts the rays that have hit something into `order`, by patch. Black backs do not count.
fn sort(traced: &TracedRays, order: &mut Vec<MetPatch>) {
    order.clear();
    for (ray, hit) in traced.hits.hits().iter().enumerate() {
        let Some(hit) = hit else {
            continue;
        };
        let frame = traced.hits.frame(ray);
        let patch = traced.surfaces.rest(frame).patch(hit.triangle);
        if hit.front || !patch.black_back {
            order.push(MetPatch {
                place: u64::from(frame) << 32 | u64::from(patch.first),
                ray: ray as u32,
                emitter: patch.emitter,
            });
        }
    }
    // Comparing a single number needs no branch.
    order.sort_unstable_by_key(|met| u128::from(met.place) << 32 | u128::from(met.ray));
}

/// Adds incident light to what a point reflects with this weight.
pub(super) fn add(
    (reflected, incident): (&mut [f64; 3], &mut Irradiance),
    weight: [f64; 3],
    light: Incident,
) {
    for (c, sum) in reflected.iter_mut().enumerate() {
        *sum += weight[c] * light.irradiance[c];
    }
    // As an irradiance, like that of lamps.
    incident.weigh(&light.scaled(PI));
}

/// The weight of a sample drawn with density `own` that could also be drawn with density `other`.
#[inline]
pub(super) fn balance(own: f64, other: f64) -> f64 {
    // 0 also for 0/0, where neither technique samples the direction.
    match own > 0.0 {
        true => own / (own + other),
        false => 0.0,
    }
}
