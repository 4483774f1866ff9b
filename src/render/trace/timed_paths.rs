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
//! Directions are drawn as for [`paths`](super::paths), where densities and random numbers are told; W is 1 throughout. Many paths are followed
//! together, surface by surface, so that their rays are traced in packets.
//!
//! Source: Jarabo, Marco, Muñoz, Buisan, Jarosz, Gutierrez, "A framework for transient rendering", ACM TOG 33(6), 2014.

use glam::DVec3;

use super::camera_rays::Samples;
use super::occlusion::shadow_ray;
use super::paths::{diffuse_part, reflection};
use super::rest_frame::{Patch, RestFrame};
use super::time_resolved::{Emitter, TimeResolved};
use crate::accel::{Hit, Method, NoTally, Origins, Segment};
use crate::light::lamp::Lamp;
use crate::light::reflection::{Reflection, Scattered};
use crate::spacetime::{Direction, Event, NullRay, Rest};

/// What random numbers at a surface are for: the same as of all paths.
const ONWARD: u32 = 2;

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

/// What a path carries of a lamp.
struct Found<'a> {
    path: usize,
    lamp: &'a Lamp,
    light: [f64; 3],
    /// The time at the start of the path less the lamp's proper time of emission.
    delay: f64,
}

/// Light of a lamp at a surface, if nothing is in the way.
struct Falling<'a> {
    found: Found<'a>,
    /// What may be in the way.
    way: Option<Segment>,
}

impl TimedPaths<'_> {
    /// Follows the paths that begin so, and calls `found`, path by path, with the path, each lamp that it finds, what it carries of it,
    /// and its delay: the time at its start less the lamp's proper time of emission.
    pub fn follow(&self, starts: &[Start], mut found: impl FnMut(usize, &Lamp, [f64; 3], f64)) {
        let first = starts.iter().enumerate();
        let mut vertices: Vec<_> = first.filter_map(|(path, s)| self.first(path, s)).collect();
        let mut all = Vec::new();
        for depth in 0..=self.bounces {
            self.light_up(&vertices, &mut all);
            if depth < self.bounces {
                vertices = self.go_on(vertices, starts, depth);
            }
        }
        // Sums over a path's lamps are in the order of the path.
        all.sort_by_key(|found| found.path);
        for Found {
            path,
            lamp,
            light,
            delay,
        } in all
        {
            found(path, lamp, light, delay);
        }
    }

    /// The first surface of a path.
    fn first(&self, path: usize, start: &Start) -> Option<Vertex<'_>> {
        let hit = start.hit;
        let (from, d) = match start.seen {
            Seen::From(from, d) => (from, d),
            Seen::Diffuse => return self.first_diffuse(path, hit),
        };
        let (x, delay) = (from + d * hit.s, self.light.index * hit.s);
        self.vertex(path, (from, x), hit, (d, 1.0), ([1.0; 3], delay))
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
        let mut blocked = vec![false; segments.len()];
        let bvh = &self.rest.bvh;
        bvh.any_by(self.method, &segments, &mut blocked, &mut NoTally);
        let mut blocked = blocked.into_iter();
        let open = falling
            .into_iter()
            .filter(|falling| falling.way.is_none() || blocked.next() == Some(false));
        all.extend(open.map(|falling| falling.found));
    }

    /// The next surfaces along directions that are drawn at `vertices`, which `depth` others come before.
    fn go_on(&self, vertices: Vec<Vertex<'_>>, starts: &[Start], depth: u32) -> Vec<Vertex<'_>> {
        let mut onward: Vec<(usize, Scattered, [f64; 3], f64)> = Vec::new();
        let (mut origins, mut directions, mut slots) = (Vec::new(), Vec::new(), Vec::new());
        for vertex in &vertices {
            let (pixel, index) = starts[vertex.path].sample;
            let samples = Samples {
                pixels: &[pixel],
                index,
                in_pixel: 1,
                depth,
                exposure: None,
                cells: None,
            };
            let Some(drawn) = vertex.reflection.sample(samples.on_path(0, ONWARD)) else {
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
        let next = met.filter_map(|(((path, drawn, carried, delay), hit), origin)| {
            let hit: Hit = hit?;
            let x = origin + drawn.l * hit.s;
            let delay = delay + self.light.index * drawn.index * hit.s;
            self.vertex(
                path,
                (origin, x),
                hit,
                (drawn.l, drawn.index),
                (carried, delay),
            )
        });
        next.collect()
    }

    /// The surface at `hit`, x, which is seen from `from` along `d` through the index `near`; none where nothing is reflected.
    fn vertex(
        &self,
        path: usize,
        (from, x): (DVec3, DVec3),
        hit: Hit,
        (d, near): (DVec3, f64),
        (carried, delay): ([f64; 3], f64),
    ) -> Option<Vertex<'_>> {
        let patch = self.rest.patch(hit.triangle);
        if patch.black_back && !hit.front {
            return None;
        }
        let Emitter::Lit { finish, lamps } = &self.light.emitters[patch.emitter as usize].0 else {
            return None;
        };
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
            lamp,
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
