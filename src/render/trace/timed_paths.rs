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
//! Directions are drawn as for [`paths`](super::paths), where densities and random numbers are told; W is 1 throughout.
//!
//! Source: Jarabo, Marco, Muñoz, Buisan, Jarosz, Gutierrez, "A framework for transient rendering", ACM TOG 33(6), 2014.

use glam::DVec3;

use super::camera_rays::Samples;
use super::occlusion::shadow_ray;
use super::paths::{diffuse_part, reflection};
use super::rest_frame::{Patch, RestFrame};
use super::time_resolved::{Emitter, TimeResolved};
use crate::accel::{Hit, Ray};
use crate::light::lamp::Lamp;
use crate::light::reflection::Reflection;
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
}

/// A surface of a path.
struct Vertex {
    hit: Hit,
    /// In the rest frame.
    x: DVec3,
    /// Where the path came from.
    from: DVec3,
    reflection: Reflection,
}

impl TimedPaths<'_> {
    /// Follows sample `index` of the path that comes from `from` along the unit vector `d` of the rest frame to `hit`, and calls
    /// `found` with each lamp, what the path carries of it, and its delay: the time at `from` less the lamp's proper time of emission.
    pub fn follow(
        &self,
        (from, d): (DVec3, DVec3),
        hit: Hit,
        sample: (u64, u32),
        found: impl FnMut(&Lamp, [f64; 3], f64),
    ) {
        let delay = self.light.index * hit.s;
        if let Some((vertex, lamps)) = self.vertex(from, d, hit, 1.0) {
            self.go_on(vertex, lamps, delay, sample, found);
        }
    }

    /// The same of the diffuse part of what leaves the front of a surface at `hit`; delays are up to there.
    pub fn follow_from(
        &self,
        hit: Hit,
        sample: (u64, u32),
        found: impl FnMut(&Lamp, [f64; 3], f64),
    ) {
        let [a, b, c] = self.rest.bvh.corners(hit.slot);
        let x = a + (b - a) * hit.u + (c - a) * hit.v;
        let patch = self.rest.patch(hit.triangle);
        let normal = self.rest.bvh.normal(&hit);
        let Emitter::Lit { finish, lamps } = &self.light.emitters[patch.emitter as usize].0 else {
            return;
        };
        let place = (self.rest, patch, &hit);
        let vertex = Vertex {
            hit,
            x,
            from: x,
            reflection: diffuse_part(&self.light.base, finish, place, normal),
        };
        self.go_on(vertex, lamps, 0.0, sample, found);
    }

    /// Goes on from the first surface of a path, `delay` away.
    fn go_on(
        &self,
        first: Vertex,
        lit_by: &[usize],
        mut delay: f64,
        (pixel, index): (u64, u32),
        mut found: impl FnMut(&Lamp, [f64; 3], f64),
    ) {
        let mut carried = [1.0; 3];
        let (mut vertex, mut lit_by) = (first, lit_by);
        for depth in 0..=self.bounces {
            for lamp in lit_by.iter().filter_map(|k| self.light.lamps[*k].as_ref()) {
                if let Some((light, proper_time)) = self.lit(&vertex, lamp) {
                    let light = std::array::from_fn(|c| carried[c] * light[c]);
                    found(lamp, light, delay - proper_time);
                }
            }
            if depth == self.bounces {
                return;
            }
            let samples = Samples {
                pixels: &[pixel],
                index,
                in_pixel: 1,
                depth,
                exposure: None,
                cells: None,
            };
            let Some(drawn) = vertex.reflection.sample(samples.on_path(0, ONWARD)) else {
                return;
            };
            for (carried, weight) in carried.iter_mut().zip(drawn.weight) {
                *carried *= weight;
            }
            let next = self
                .onward(&vertex, drawn.l)
                .filter(|_| carried != [0.0; 3]);
            let Some((from, d, hit)) = next else {
                return;
            };
            delay += self.light.index * drawn.index * hit.s;
            let Some(met) = self.vertex(from, d, hit, drawn.index) else {
                return;
            };
            (vertex, lit_by) = met;
        }
    }

    /// The surface at `hit`, which is seen through the index `near`, and the lamps that light it; none where nothing is reflected.
    fn vertex(&self, from: DVec3, d: DVec3, hit: Hit, near: f64) -> Option<(Vertex, &[usize])> {
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
        let vertex = Vertex {
            hit,
            x: from + d * hit.s,
            from,
            reflection: reflection(&self.light.base, finish, place, (normal, -d), near),
        };
        Some((vertex, lamps))
    }

    /// What the surface reflects of a lamp of emission 1, and the lamp's proper time of emission for the frame's time 0 at the surface.
    fn lit(&self, vertex: &Vertex, lamp: &Lamp) -> Option<([f64; 3], f64)> {
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
        let ray = shadow_ray(vertex.from, vertex.x, l);
        let skip = Some(vertex.hit.triangle);
        // Distances are as frequencies: r_F/r_world = ω_F/ω_world.
        let blocked = lamp.shadows && self.rest.bvh.any(&ray, arrival.distance * rho, skip);
        (!blocked).then_some((light, proper_time))
    }

    /// The next surface along `l`.
    fn onward(&self, vertex: &Vertex, l: DVec3) -> Option<(DVec3, DVec3, Hit)> {
        // As far from the surface as in `paths`.
        let off = shadow_ray(vertex.from, vertex.x, l).s_min;
        let normal = vertex.reflection.normal();
        let side = if normal.dot(l) < 0.0 { -off } else { off };
        let origin = vertex.x + normal * side;
        let ray = Ray {
            origin,
            direction: l,
            s_min: 0.0,
        };
        let hit = self.rest.bvh.closest(&ray, f64::INFINITY)?;
        Some((origin, l, hit))
    }

    /// What a clock shows at the frame's time 0 on `patch`: the world's where the frame rests in it, else the object's own.
    pub fn clock(&self, patch: &Patch) -> f64 {
        match self.rest.frame.velocity().is_rest() {
            true => self.rest.frame.origin().ct,
            false => -patch.object_origin.ct,
        }
    }
}
