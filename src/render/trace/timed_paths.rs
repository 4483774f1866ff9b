//! Paths of light with their delays, among surfaces and lamps that rest relative to each other.
//!
//! In the frame in which all rest, nothing depends on when but the emission of lamps. Light that is at the detector at the time t
//! and has come along a path x₀, x₁, …, xₙ of surfaces left xₙ at t − D, D = Σ η |xₖ₊₁ − xₖ| with what the detector adds, and a lamp at y at
//! its proper time
//!
//! ```text
//! τ = t − D − η |xₙ − y| − (the time at which the lamp's clock shows 0).
//! ```
//!
//! So one path serves all times: what it carries of a lamp, f₀ … fₙ E(xₙ)/(densities), goes with the emission of the lamp as a
//! function of t, moved by its delay, and into a bin from a to b goes the integral of the emission from τ(a) to τ(b), which is exact.
//! Every surface of a path is lit by all lamps (next-event estimation), so that the direct light and all bounces come from one set of paths.
//! Surfaces that shine are found as in [`paths`](super::paths): one point of all of them is drawn at each surface, paths that meet one carry what it
//! shines, and the balance heuristic weighs both; their proper time is that of their object, and D ends at the point that shines. What shines steadily
//! has no place in bins of time and is left out.
//! Directions are drawn as for [`paths`](super::paths), where densities and random numbers are told; W is 1 throughout. Many paths are followed
//! together, surface by surface, so that their rays are traced in packets.
//!
//! Source: Jarabo, Marco, Muñoz, Buisan, Jarosz, Gutierrez, "A framework for transient rendering", ACM TOG 33(6), 2014.

use glam::DVec3;

use super::camera_rays::Samples;
use super::emitted::Colouring;
use super::lights::SHORTER;
use super::occlusion::shadow_ray;
use super::paths::{AREA, ONWARD, balance, diffuse_part, reflection};
use super::rest_frame::{Patch, RestFrame};
use super::time_resolved::{Emitter, TimeResolved};
use crate::accel::{Hit, Method, NoTally, Origins, Segment};
use crate::light::lamp::{Emission, Lamp};
use crate::light::reflection::{Reflection, Scattered};
use crate::spacetime::{Direction, Event, NullRay, Rest};

/// Paths in one rest frame.
#[derive(Debug)]
pub(crate) struct TimedPaths<'a> {
    pub rest: &'a RestFrame,
    pub light: &'a TimeResolved,
    /// How many more times light is reflected after the first surface.
    pub bounces: u32,
    /// How rays are traced.
    pub method: Method,
}

/// Where a path begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    /// What is met first.
    pub hit: Hit,
    /// How.
    pub seen: Seen,
    /// The key of its pixel, and the sample of that.
    pub sample: (u64, u32),
}

/// How the first surface of a path is seen.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Seen {
    /// From this point along a unit vector of the rest frame. Delays are up to the point.
    From(DVec3, DVec3),
    /// What leaves its front by diffuse reflection. Delays are up to the surface.
    Diffuse,
}

/// A surface of a path.
struct Vertex<'a> {
    /// Which path, by its start.
    path: usize,
    hit: Hit,
    /// In the rest frame.
    x: DVec3,
    /// Where the path came from.
    from: DVec3,
    reflection: Reflection,
    /// The lamps that light it.
    lamps: &'a [usize],
    /// f₀ … over the densities, and the delay, up to here.
    carried: [f64; 3],
    delay: f64,
}

/// What a path carries of a lamp or a surface that shines.
struct Found<'a> {
    path: usize,
    emission: &'a Emission,
    light: [f64; 3],
    /// The time at the start of the path less the proper time of emission.
    delay: f64,
}

/// What a path meets: where it leaves, along which unit vector, through which index, and what it carries, after which delay.
struct Meeting {
    path: usize,
    hit: Hit,
    from: DVec3,
    d: DVec3,
    near: f64,
    carried: [f64; 3],
    delay: f64,
}

/// Light of a lamp at a surface, if nothing is in the way.
struct Falling<'a> {
    found: Found<'a>,
    /// What may be in the way.
    way: Option<Segment>,
}

impl TimedPaths<'_> {
    /// Follows the paths that begin so, and calls `found`, path by path, with the path, the emission of each lamp or surface that it
    /// finds, what it carries of it, and its delay: the time at its start less the proper time of emission.
    pub fn follow(&self, starts: &[Start], mut found: impl FnMut(usize, &Emission, [f64; 3], f64)) {
        let shines = self
            .light
            .areas
            .as_ref()
            .is_some_and(|areas| areas.changes());
        let mut all = Vec::new();
        let first = starts.iter().enumerate();
        let mut vertices: Vec<_> = first
            .filter_map(|(path, start)| self.first(path, start, &mut all))
            .collect();
        for depth in 0..=self.bounces {
            self.light_up(&vertices, &mut all);
            if shines {
                self.light_up_by_areas(&vertices, (starts, depth), &mut all);
            }
            // After the last surface one more ray looks for what shines.
            if depth < self.bounces || shines {
                vertices = self.go_on(vertices, (starts, depth), &mut all);
            }
        }
        // Sums over a path's lamps are in the order of the path.
        all.sort_by_key(|found| found.path);
        for Found {
            path,
            emission,
            light,
            delay,
        } in all
        {
            found(path, emission, light, delay);
        }
    }

    /// The first surface of a path.
    fn first<'a>(
        &'a self,
        path: usize,
        start: &Start,
        all: &mut Vec<Found<'a>>,
    ) -> Option<Vertex<'a>> {
        let hit = start.hit;
        let (from, d) = match start.seen {
            Seen::From(from, d) => (from, d),
            Seen::Diffuse => {
                all.extend(self.own(path, &hit, [1.0; 3], 0.0));
                return self.first_diffuse(path, hit);
            }
        };
        let meeting = Meeting {
            path,
            hit,
            from,
            d,
            near: 1.0,
            carried: [1.0; 3],
            delay: self.light.index * hit.s,
        };
        all.extend(self.own(path, &hit, meeting.carried, meeting.delay));
        self.vertex(&meeting)
    }

    /// What a surface shines of its own, met by a path that carries this after this delay.
    fn own(&self, path: usize, hit: &Hit, carried: [f64; 3], delay: f64) -> Option<Found<'_>> {
        let patch = self.rest.patch(hit.triangle);
        let (emitter, response) = &self.light.emitters[patch.emitter as usize];
        let base = &self.light.base;
        let colour = match emitter {
            _ if patch.black_back && !hit.front => None,
            Emitter::Lit { finish, .. } => finish.emission.as_ref(),
            Emitter::Base(colour) => Some(&base.colours[*colour]),
            Emitter::Uv { .. } | Emitter::Captured(_) => None,
        }?;
        let emission = colour.profile.as_deref()?;
        let radiance = base.colour_at(colour, self.rest, patch, hit);
        let radiance = match &response.colour {
            Colouring::Spectrum(table, _) => {
                // A spectrum has the colour; that of the surface only dims it.
                let factor = (radiance[0] + radiance[1] + radiance[2]) / 3.0;
                table.colour(1.0).map(|c| c * factor)
            }
            _ => radiance,
        };
        Some(Found {
            path,
            emission,
            light: std::array::from_fn(|c| carried[c] * radiance[c]),
            delay: delay + patch.object_origin.ct,
        })
    }

    /// The same of one that begins on a surface.
    fn first_diffuse(&self, path: usize, hit: Hit) -> Option<Vertex<'_>> {
        let [a, b, c] = self.rest.bvh.corners(hit.slot);
        let x = a + (b - a) * hit.u + (c - a) * hit.v;
        let patch = self.rest.patch(hit.triangle);
        let normal = self.rest.bvh.normal(&hit);
        let Emitter::Lit { finish, lamps } = &self.light.emitters[patch.emitter as usize].0 else {
            return None;
        };
        let place = (self.rest, patch, &hit);
        Some(Vertex {
            path,
            hit,
            x,
            from: x,
            reflection: diffuse_part(&self.light.base, finish, place, normal),
            lamps,
            carried: [1.0; 3],
            delay: 0.0,
        })
    }

    /// Adds what `vertices` reflect of lamps to `all`.
    fn light_up<'a>(&'a self, vertices: &[Vertex], all: &mut Vec<Found<'a>>) {
        let mut falling = Vec::new();
        for vertex in vertices {
            let lamps = vertex.lamps.iter();
            for lamp in lamps.filter_map(|k| self.light.lamps[*k].as_ref()) {
                falling.extend(self.falling(vertex, lamp));
            }
        }
        let segments: Vec<_> = falling.iter().filter_map(|falling| falling.way).collect();
        self.add_open(falling, &segments, all);
    }

    /// Adds what `vertices`, which `depth` others come before, reflect of points that are drawn on surfaces that shine.
    fn light_up_by_areas<'a>(
        &'a self,
        vertices: &[Vertex],
        (starts, depth): (&[Start], u32),
        all: &mut Vec<Found<'a>>,
    ) {
        let Some(areas) = &self.light.areas else {
            return;
        };
        let (mut falling, mut segments) = (Vec::new(), Vec::new());
        for vertex in vertices {
            let (pixel, index) = starts[vertex.path].sample;
            let numbers = samples(&[pixel], index, depth).on_path(0, AREA);
            let place = (vertex.x, vertex.reflection.normal());
            let base = (&self.light.base, self.rest);
            let Some(draw) = areas.drawn_from(base, place, numbers) else {
                continue;
            };
            // What followed paths can meet, too, is weighed against that.
            let (l, density) = (draw.sent.l, draw.sent.density);
            let weight = match draw.sent.shadows {
                true => balance(density, vertex.reflection.density(l)),
                false => 1.0,
            };
            let value = vertex.reflection.value(l);
            let light =
                std::array::from_fn(|c| vertex.carried[c] * value[c] * draw.light[c] * weight);
            if light == [0.0; 3] {
                continue;
            }
            let way = draw.sent.shadows.then(|| Segment {
                ray: shadow_ray(vertex.from, vertex.x, l),
                s_max: draw.distance * SHORTER,
                skip: Some(vertex.hit.triangle),
                end: Some(draw.triangle),
            });
            segments.extend(way);
            let found = Found {
                path: vertex.path,
                emission: draw.emission,
                light,
                delay: vertex.delay + self.light.index * draw.distance + draw.clock_zero,
            };
            falling.push(Falling { found, way });
        }
        self.add_open(falling, &segments, all);
    }

    /// Adds those that nothing is in the way of.
    fn add_open<'a>(
        &self,
        falling: Vec<Falling<'a>>,
        segments: &[Segment],
        all: &mut Vec<Found<'a>>,
    ) {
        let mut blocked = vec![false; segments.len()];
        let bvh = &self.rest.bvh;
        bvh.any_by(self.method, segments, &mut blocked, &mut NoTally);
        let mut blocked = blocked.into_iter();
        let open = falling
            .into_iter()
            .filter(|falling| falling.way.is_none() || blocked.next() == Some(false));
        all.extend(open.map(|falling| falling.found));
    }

    /// The next surfaces along directions that are drawn at `vertices`, which `depth` others come before; what they shine is added to `all`.
    fn go_on<'a>(
        &'a self,
        vertices: Vec<Vertex<'_>>,
        (starts, depth): (&[Start], u32),
        all: &mut Vec<Found<'a>>,
    ) -> Vec<Vertex<'a>> {
        let mut onward: Vec<(usize, Scattered, [f64; 3], f64)> = Vec::new();
        let (mut origins, mut directions, mut slots) = (Vec::new(), Vec::new(), Vec::new());
        for vertex in &vertices {
            let (pixel, index) = starts[vertex.path].sample;
            let numbers = samples(&[pixel], index, depth).on_path(0, ONWARD);
            let Some(drawn) = vertex.reflection.sample(numbers) else {
                continue;
            };
            let carried = std::array::from_fn(|c| vertex.carried[c] * drawn.weight[c]);
            if carried == [0.0; 3] {
                continue;
            }
            // As far from the surface as in `paths`.
            let off = shadow_ray(vertex.from, vertex.x, drawn.l).s_min;
            let normal = vertex.reflection.normal();
            let side = if normal.dot(drawn.l) < 0.0 { -off } else { off };
            origins.push(vertex.x + normal * side);
            directions.push(drawn.l);
            slots.push(vertex.hit.slot);
            onward.push((vertex.path, drawn, carried, vertex.delay));
        }
        let mut hits = vec![None; directions.len()];
        let from = Origins::Leaving {
            origins: &origins,
            slots: &slots,
        };
        let bvh = &self.rest.bvh;
        bvh.closest_by(
            self.method,
            from,
            &directions,
            &mut hits,
            &mut NoTally,
            |_| (),
        );
        let met = onward.into_iter().zip(hits).zip(origins);
        let next = met.filter_map(|(((path, drawn, carried, delay), hit), from)| {
            let hit: Hit = hit?;
            let delay = delay + self.light.index * drawn.index * hit.s;
            let meeting = Meeting {
                path,
                hit,
                from,
                d: drawn.l,
                near: drawn.index,
                carried,
                delay,
            };
            if let Some(own) = self.own(path, &hit, carried, delay) {
                let weight = self.weight_of_own(&meeting, drawn.density);
                all.push(Found {
                    light: own.light.map(|c| weight * c),
                    ..own
                });
            }
            self.vertex(&meeting)
        });
        next.collect()
    }

    /// What counts of the light of a surface that shines, met along a direction drawn with `density`, where it could have been drawn
    /// itself: (4) of [`paths`](super::paths), with W = 1.
    fn weight_of_own(&self, meeting: &Meeting, density: f64) -> f64 {
        let areas = self.light.areas.as_ref();
        match areas.and_then(|areas| areas.density(0, meeting.hit.triangle)) {
            _ if density.is_infinite() => 1.0,
            None => 1.0,
            Some((_, false)) => 0.0,
            Some((by_area, true)) => {
                let r = meeting.hit.s;
                let cosine = self.rest.bvh.normal(&meeting.hit).dot(meeting.d).abs();
                let by_light = by_area * r * r / cosine.max(f64::MIN_POSITIVE);
                balance(density, by_light)
            }
        }
    }

    /// The surface that a path meets; none where nothing is reflected.
    fn vertex(&self, meeting: &Meeting) -> Option<Vertex<'_>> {
        let Meeting {
            path,
            hit,
            from,
            d,
            near,
            carried,
            delay,
        } = *meeting;
        let x = from + d * hit.s;
        let patch = self.rest.patch(hit.triangle);
        if patch.black_back && !hit.front {
            return None;
        }
        let Emitter::Lit { finish, lamps } = &self.light.emitters[patch.emitter as usize].0 else {
            return None;
        };
        // The normal on the side that the path came to.
        let normal = self.rest.bvh.normal(&hit);
        let normal = if hit.front { normal } else { -normal };
        let place = (self.rest, patch, &hit);
        Some(Vertex {
            path,
            hit,
            x,
            from,
            reflection: reflection(&self.light.base, finish, place, (normal, -d), near),
            lamps,
            carried,
            delay,
        })
    }

    /// What the surface reflects of a lamp of emission 1, where nothing is in the way.
    fn falling<'a>(&self, vertex: &Vertex, lamp: &'a Lamp) -> Option<Falling<'a>> {
        // The lamp's proper time for the frame's time 0 at the surface.
        let event = self
            .rest
            .frame
            .event_to_world(Event::<Rest>::new(0.0, vertex.x));
        let at = NullRay::new(event, Direction::from_unit(DVec3::X), self.light.index);
        let (arrival, proper_time) = lamp.arrival_at_peak(&at, 0.0, self.light.index)?;
        let (l, rho) = self.rest.frame.frame_from_world().direction(arrival.d);
        let l = l.unit();
        let cosine = vertex.reflection.normal().dot(l);
        if cosine <= 0.0 {
            return None;
        }
        let incident = lamp.incident(&arrival, rho, cosine);
        let value = vertex.reflection.value(l);
        let light: [f64; 3] = std::array::from_fn(|c| value[c] * incident.irradiance[c]);
        if light.iter().all(|c| *c == 0.0) {
            return None;
        }
        // Distances are as frequencies: r_F/r_world = ω_F/ω_world.
        let way = lamp.shadows.then(|| Segment {
            ray: shadow_ray(vertex.from, vertex.x, l),
            s_max: arrival.distance * rho,
            skip: Some(vertex.hit.triangle),
            end: None,
        });
        let found = Found {
            path: vertex.path,
            emission: lamp.emission(),
            light: std::array::from_fn(|c| vertex.carried[c] * light[c]),
            delay: vertex.delay - proper_time,
        };
        Some(Falling { found, way })
    }

    /// What a clock shows at the frame's time 0 on `patch`: the world's where the frame rests in it, else the object's own.
    pub fn clock(&self, patch: &Patch) -> f64 {
        match self.rest.frame.velocity().is_rest() {
            true => self.rest.frame.origin().ct,
            false => -patch.object_origin.ct,
        }
    }
}

/// The numbers of a path's surface that `depth` others come before.
fn samples(pixels: &[u64; 1], index: u32, depth: u32) -> Samples<'_> {
    Samples {
        pixels,
        index,
        in_pixel: 1,
        depth,
        exposure: None,
        cells: None,
    }
}
