//! Paths of light with their delays, among surfaces and lamps at rest relative to each other.
//!
//! In the common rest frame, only the emission of lamps depends on time. Light that reaches the detector at the time t along a path x₀, x₁,
//! …, xₙ of surfaces left xₙ at t − D, where D = Σ η |xₖ₊₁ − xₖ| plus the detector's delay, and a lamp at y at its proper time
//!
//! ```text
//! τ = t − D − η |xₙ − y| − (the time at which the lamp's clock shows 0).
//! ```
//!
//! So one path serves all times: its contribution for a lamp, f₀ … fₙ E(xₙ)/(densities), is multiplied by the lamp's emission as a function of t,
//! shifted by its delay. A bin from a to b receives the integral of the emission from τ(a) to τ(b), which is exact. Every surface of a path is lit by
//! all lamps (next-event estimation), so that the direct light and all bounces come from one set of paths. Shining surfaces are found as in
//! [`paths`](super::paths): at each surface, one point on all of them is sampled, paths that hit one carry its emission, and the balance heuristic
//! weights both; the proper time is that of their object, and D ends at the shining point. Steady emission has no place in time bins and is left out.
//! What is found beyond the second surface of a path does not depend on the observer, except for a delay: it is shared as in
//! [`sharing`](super::sharing), even if emission depends on time, and the light that x_j receives from y_i is delayed by η |x_j − y_i|. Directions are
//! sampled as in [`paths`](super::paths), which describes densities and random numbers; W is 1 throughout. Many paths are followed together, surface
//! by surface, so that their rays are traced in packets.
//!
//! Source: Jarabo, Marco, Muñoz, Buisan, Jarosz, Gutierrez, "A framework for transient rendering", ACM TOG 33(6), 2014.

use glam::DVec3;

use super::base_colours::BaseColour;
use super::camera_rays::Samples;
use super::emitted::Colouring;
use super::occlusion::{lifted, shadow_end, shadow_ray, shadow_size};
use super::onward::{CHOICE, ONWARD};
use super::paths::{AREA, balance};
use super::rest_frame::{Patch, RestFrame};
use super::sharing::{End, Groups, MOST, Receivers, Sharing, Ungrouped};
use super::time_resolved::{Emitter, TimeResolved};
use crate::accel::{Hit, Origins, Segment, Traversal};
use crate::light::lamp::{Emission, Lamp};
use crate::light::reflection::{Reflection, Scattered};
use crate::render::sampler::sobol;
use crate::spacetime::{Direction, Event, NullRay, Rest};

/// Paths in one rest frame.
#[derive(Debug)]
pub(crate) struct TimedPaths<'a> {
    pub rest: &'a RestFrame,
    pub light: &'a TimeResolved,
    /// The number of reflections after the first surface.
    pub bounces: u32,
    /// How rays are traced.
    pub method: Traversal,
}

/// The start of a path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    /// The first hit.
    pub hit: Hit,
    /// How it is seen.
    pub seen: Viewpoint,
    /// The key of its pixel, and the sample index.
    pub sample: (u64, u32),
}

/// How the first surface of a path is seen.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Viewpoint {
    /// From this point along a unit vector of the rest frame. Delays include the way to the point.
    From(DVec3, DVec3),
    /// By diffuse reflection from the side of the hit. Delays end at the surface.
    Diffuse,
}

/// A surface of a path.
struct Vertex<'a> {
    /// The index of the path's start.
    path: usize,
    hit: Hit,
    /// In the rest frame.
    x: DVec3,
    /// The origin of the ray that hit it.
    from: DVec3,
    reflection: Reflection,
    /// The lamps that light it.
    lamps: &'a [usize],
    /// The product of f₀ … over the densities, and the delay, up to this surface.
    carried: [f64; 3],
    delay: f64,
}

/// The contribution of a lamp or a shining surface along a path.
struct Contribution<'a> {
    path: usize,
    emission: &'a Emission,
    light: [f64; 3],
    /// The time at the start of the path minus the proper time of emission.
    delay: f64,
    /// Whether this is the emission of the second surface of a shared path.
    is_end: bool,
}

/// First surfaces of paths, and the paths that they share.
#[derive(Default)]
struct Shared<'a> {
    firsts: Vec<Vertex<'a>>,
    groups: Groups,
    chosen: Vec<Beginning>,
}

/// The beginning of a shared path.
struct Beginning {
    /// The group, and the index in it of the surface from which the path continues.
    group: usize,
    at: usize,
    met: Option<PathEnd>,
}

/// The second surface of a shared path.
#[derive(Clone, Copy)]
struct PathEnd {
    y: DVec3,
    /// On the side that was hit.
    normal: DVec3,
    triangle: u32,
    is_diffuse: bool,
}

/// Rays that continue from surfaces.
#[derive(Default)]
struct Onward {
    paths: Vec<OnwardPath>,
    origins: Vec<DVec3>,
    directions: Vec<DVec3>,
    slots: Vec<u32>,
}

/// A path that continues: its index, how it leaves the surface, the throughput after that, and the delay so far.
struct OnwardPath {
    path: usize,
    leaving: Leaving,
    carried: [f64; 3],
    delay: f64,
}

/// The normal of a triangle, and the direction in which a path leaves it.
struct Leaving {
    normal: DVec3,
    drawn: Scattered,
}

impl Onward {
    /// Continues path `path` from `vertex`, along a direction sampled with two numbers.
    fn draw(&mut self, vertex: &Vertex, path: usize, numbers: [f64; 2]) {
        let Some(drawn) = vertex.reflection.sample(numbers) else {
            return;
        };
        let carried = std::array::from_fn(|c| vertex.carried[c] * drawn.weight[c]);
        // Shared paths continue from black surfaces too, for other surfaces that are not black.
        if carried == [0.0; 3] && path == vertex.path {
            return;
        }
        // The same offset from the surface as in `paths`.
        let off = shadow_ray(vertex.from, vertex.x, drawn.l).s_min;
        let normal = vertex.reflection.geometric_normal();
        let side = if normal.dot(drawn.l) < 0.0 { -off } else { off };
        self.origins.push(vertex.x + normal * side);
        self.directions.push(drawn.l);
        self.slots.push(vertex.hit.slot);
        let leaving = Leaving { normal, drawn };
        self.paths.push(OnwardPath {
            path,
            leaving,
            carried,
            delay: vertex.delay,
        });
    }
}

/// A hit of a path: the index of the path, the hit, the ray's origin and unit direction, its refractive index, the throughput and the
/// delay.
struct PathHit {
    path: usize,
    hit: Hit,
    from: DVec3,
    d: DVec3,
    index: f64,
    carried: [f64; 3],
    delay: f64,
}

/// Light of a lamp at a surface, if it is not blocked.
struct LightSample<'a> {
    found: Contribution<'a>,
    /// The segment to be tested for obstacles.
    way: Option<Segment>,
}

impl TimedPaths<'_> {
    /// Follows the paths from `starts`, with `in_pixel` samples per pixel in all, and calls `found` for each lamp or shining surface that
    /// they find, with the path, the emission, the path's contribution, and its delay: the time at the start of the path minus the proper
    /// time of emission.
    pub fn follow(
        &self,
        starts: &[Start],
        in_pixel: u32,
        mut found: impl FnMut(usize, &Emission, [f64; 3], f64),
    ) {
        let shines = self
            .light
            .areas
            .as_ref()
            .is_some_and(|areas| areas.changes());
        let mut all = Vec::new();
        // The surfaces that the camera sees: their own emission is found here, without any reflection.
        let first = starts.iter().enumerate();
        let mut vertices: Vec<_> = first
            .filter_map(|(path, start)| self.first(path, start, &mut all))
            .collect();
        let mut samples: Vec<_> = starts.iter().map(|start| start.sample).collect();
        let mut shared = Shared::default();
        // Samples of a texel could only share with one another, and gain nothing.
        let shares = |start: &Start| matches!(start.seen, Viewpoint::From(..));
        let shares = starts.first().is_some_and(shares);
        for depth in 0..=self.bounces {
            // Next-event estimation: every lamp, and one point on all shining surfaces.
            self.light_up(&vertices, &mut all);
            if shines {
                self.light_up_by_areas(&vertices, (&samples, depth), &mut all);
            }
            // After the last surface, one more ray looks for shining surfaces.
            if depth == 0 && shares && (depth < self.bounces || shines) {
                // Groups consist of adjacent vertices: a stable sort puts those of a patch next to each other.
                vertices.sort_by_key(|vertex| self.rest.patch(vertex.hit.triangle).first);
                shared = self.choose(vertices, in_pixel, &mut samples);
                vertices = self.begin(&mut shared, &samples, &mut all);
            } else if depth < self.bounces || shines {
                vertices = self.go_on(vertices, (&samples, depth), &mut all);
            }
        }
        // Sums over a path's lamps are in the order of the path.
        all.sort_by_key(|found| found.path);
        // Shared paths are numbered after the starts, so their light is at the end.
        let own = all.partition_point(|found| found.path < starts.len());
        for one in &all[..own] {
            found(one.path, one.emission, one.light, one.delay);
        }
        self.share(&shared, starts.len(), &all[own..], found);
    }

    /// Groups the diffuse first surfaces of paths, chooses those from which a path continues, and adds the samples of those paths.
    fn choose<'a>(
        &self,
        firsts: Vec<Vertex<'a>>,
        in_pixel: u32,
        samples: &mut Vec<(u64, u32)>,
    ) -> Shared<'a> {
        let sharing = Sharing::new(self.light.is_diffuse());
        let mut groups = Groups::default();
        let patch = |vertex: &Vertex| self.rest.patch(vertex.hit.triangle).first;
        // Points of one sample share paths, which are numbered by the sample index.
        let sample = |vertex: &Vertex| samples[vertex.path].1;
        let are_alike = |a: &Vertex, b: &Vertex| patch(a) == patch(b) && sample(a) == sample(b);
        let mut begin = 0;
        for of_patch in firsts.chunk_by(are_alike) {
            let normal = |k: usize| {
                let reflection: &Reflection = &firsts[k].reflection;
                reflection.is_diffuse().then(|| reflection.normal())
            };
            groups.add(Ungrouped {
                points: begin..begin + of_patch.len(),
                patch: patch(&of_patch[0]),
                normal,
                pixel: |k: usize| samples[firsts[k].path].0,
                in_pixel,
                sharing: &sharing,
            });
            begin += of_patch.len();
        }
        let mut chosen = Vec::new();
        for (group, of) in groups.all.iter().enumerate() {
            let points = &groups.order[of.points.clone()];
            let (_, index) = samples[firsts[points[0] as usize].path];
            let [number, _] = sobol(of.key, index, CHOICE);
            for (path, at) in of.chosen(number).enumerate() {
                chosen.push(Beginning {
                    group,
                    at,
                    met: None,
                });
                samples.push((of.key, of.number(index, path)));
            }
        }
        Shared {
            firsts,
            groups,
            chosen,
        }
    }

    /// The second surfaces of all paths. The throughputs and delays of shared paths start there.
    fn begin<'a>(
        &'a self,
        shared: &mut Shared,
        samples: &[(u64, u32)],
        all: &mut Vec<Contribution<'a>>,
    ) -> Vec<Vertex<'a>> {
        // The samples of shared paths follow those of the starts.
        let starts = samples.len() - shared.chosen.len();
        // Non-diffuse surfaces share nothing: each continues its own path.
        let alone = shared.firsts.iter();
        let alone = alone.filter(|vertex| !vertex.reflection.is_diffuse());
        let mut onward = Onward::default();
        for vertex in alone {
            let (pixel, index) = samples[vertex.path];
            let numbers = self::samples(&[pixel], index, 0).on_path(ONWARD);
            onward.draw(vertex, vertex.path, numbers);
        }
        for (k, beginning) in shared.chosen.iter().enumerate() {
            let group = &shared.groups.all[beginning.group];
            let point = shared.groups.order[group.points.start + beginning.at];
            let (key, index) = samples[starts + k];
            let numbers = self::samples(&[key], index, 0).on_path(ONWARD);
            onward.draw(&shared.firsts[point as usize], starts + k, numbers);
        }
        let mut next = Vec::new();
        for (path_hit, leaving) in self.met(onward) {
            let Some(k) = path_hit.path.checked_sub(starts) else {
                next.extend(self.meet(&path_hit, &leaving, all));
                continue;
            };
            // Relative to the second surface: `share` applies each receiver's own throughput and delay.
            let path_hit = PathHit {
                carried: [1.0; 3],
                delay: 0.0,
                ..path_hit
            };
            let own = self.own(
                path_hit.path,
                &path_hit.hit,
                path_hit.carried,
                path_hit.delay,
            );
            all.extend(own.map(|own| Contribution {
                is_end: true,
                ..own
            }));
            let vertex = self.vertex(&path_hit);
            let normal = self.rest.bvh.normal(&path_hit.hit);
            shared.chosen[k].met = Some(PathEnd {
                y: path_hit.from + path_hit.d * path_hit.hit.s,
                normal: if path_hit.hit.front { normal } else { -normal },
                triangle: path_hit.hit.triangle,
                is_diffuse: vertex.as_ref().is_none_or(|v| v.reflection.is_diffuse()),
            });
            next.extend(vertex);
        }
        next
    }

    /// Calls `found` with the light that the points of groups receive from the paths that they share, numbered from `starts` on, which have
    /// found `all`.
    fn share(
        &self,
        shared: &Shared,
        starts: usize,
        all: &[Contribution],
        mut found: impl FnMut(usize, &Emission, [f64; 3], f64),
    ) {
        let Shared {
            firsts,
            groups,
            chosen,
        } = shared;
        let mut receivers = Receivers::default();
        let mut filled = usize::MAX;
        for of_path in all.chunk_by(|a, b| a.path == b.path) {
            let beginning = &chosen[of_path[0].path - starts];
            let Some(end) = beginning.met else {
                continue;
            };
            let group = &groups.all[beginning.group];
            let points = &groups.order[group.points.clone()];
            // The points of a group are set up once for all of its paths, which come in a row.
            if filled != beginning.group {
                filled = beginning.group;
                receivers.clear();
                let reflection = |k: &u32| &firsts[*k as usize].reflection;
                let are_smooth = points.iter().any(|k| reflection(k).is_smooth());
                for k in points {
                    let vertex = &firsts[*k as usize];
                    let place = (vertex.x, vertex.reflection.normal());
                    receivers.push(place, vertex.from, vertex.hit.triangle);
                    if are_smooth {
                        receivers.push_geometric(vertex.reflection.geometric_normal());
                    }
                }
            }
            // What each point receives of the path, (1) of `sharing`, and the densities of light samples at its end.
            let on = End::On {
                y: end.y,
                normal: end.normal,
                triangle: end.triangle,
            };
            let numbers = (beginning.at, group.paths());
            receivers.find(on, numbers, &self.rest.bvh, self.method, None);
            let mut by_area = [0.0; MOST];
            let is_drawn = self.light.areas.as_ref().and_then(|areas| {
                areas.densities_at(end.triangle, end.y, receivers.places(), &mut by_area)
            });
            // 1/q, for light that only the point receives from which the path continued.
            let alone = group.count() as f64 / group.paths() as f64;
            for (at, point) in points.iter().enumerate() {
                let (weight, density) = (receivers.weights[at], receivers.densities[at]);
                if weight == 0.0 && at != beginning.at {
                    continue;
                }
                let vertex = &firsts[*point as usize];
                // The light travels from y to this receiver, not to the point from which the path continued.
                let delay = vertex.delay + self.light.index * (end.y - vertex.x).length();
                let albedo = vertex.reflection.albedo();
                let carried: [f64; 3] = std::array::from_fn(|c| vertex.carried[c] * albedo[c]);
                if carried == [0.0; 3] {
                    continue;
                }
                for one in of_path {
                    let weight = match (one.is_end, is_drawn) {
                        (true, None) => weight,
                        (true, Some(false)) => 0.0,
                        (true, Some(true)) => weight * balance(density, by_area[at]),
                        (false, _) if end.is_diffuse => weight,
                        // Light of non-diffuse surfaces only goes to the point from which the path continued.
                        (false, _) if at == beginning.at => alone,
                        (false, _) => continue,
                    };
                    if weight > 0.0 {
                        let light = std::array::from_fn(|c| carried[c] * one.light[c] * weight);
                        found(vertex.path, one.emission, light, delay + one.delay);
                    }
                }
            }
        }
    }

    /// The first surface of a path.
    fn first<'a>(
        &'a self,
        path: usize,
        start: &Start,
        all: &mut Vec<Contribution<'a>>,
    ) -> Option<Vertex<'a>> {
        let hit = start.hit;
        let (from, d) = match start.seen {
            Viewpoint::From(from, d) => (from, d),
            Viewpoint::Diffuse => {
                all.extend(self.own(path, &hit, [1.0; 3], 0.0));
                return self.first_diffuse(path, hit);
            }
        };
        let path_hit = PathHit {
            path,
            hit,
            from,
            d,
            index: 1.0,
            carried: [1.0; 3],
            delay: self.light.index * hit.s,
        };
        all.extend(self.own(path, &hit, path_hit.carried, path_hit.delay));
        self.vertex(&path_hit)
    }

    /// The emission of a surface, hit by a path with this throughput and this delay.
    fn own(
        &self,
        path: usize,
        hit: &Hit,
        carried: [f64; 3],
        delay: f64,
    ) -> Option<Contribution<'_>> {
        let patch = self.rest.patch(hit.triangle);
        if patch.black_back && !hit.front {
            return None;
        }
        let colour = self.shines(patch)?;
        // Steady light has no place in time bins.
        let emission = colour.profile.as_deref()?;
        let radiance = self.light.base.colour_at(colour, self.rest, patch, hit);
        let (_, response) = &self.light.emitters[patch.emitter as usize];
        let radiance = match &response.colour {
            Colouring::Spectrum(table, _) => {
                // The colour is that of the spectrum; the surface's colour only dims it.
                let factor = (radiance[0] + radiance[1] + radiance[2]) / 3.0;
                table.colour(1.0).map(|c| c * factor)
            }
            _ => radiance,
        };
        Some(Contribution {
            path,
            emission,
            light: std::array::from_fn(|c| carried[c] * radiance[c]),
            delay: delay + patch.object_origin.ct,
            is_end: false,
        })
    }

    /// The emission of a surface, apart from the light of cubes.
    fn shines(&self, patch: &Patch) -> Option<&BaseColour> {
        match &self.light.emitters[patch.emitter as usize].0 {
            Emitter::Lit { finish, .. } => finish.emission.as_ref(),
            Emitter::Base(colour) => Some(&self.light.base.colours[*colour]),
            Emitter::Uv { .. } | Emitter::Captured(_) => None,
        }
    }

    /// The scene index of an object that shines steadily, if any: paths ignore its light.
    pub fn steady_object(&self) -> Option<u32> {
        let is_steady = |colour: &BaseColour| colour.profile.is_none() && colour.factor != [0.0; 3];
        let mut patches = self.rest.patches.iter();
        let found = patches.find(|patch| self.shines(patch).is_some_and(is_steady));
        found.map(|patch| patch.object)
    }

    /// Whether light may reach the back of any of these triangles, given by slots: if one shines itself, or if a lamp or a corner of a
    /// shining or reflecting surface lies behind its plane. Obstacles are ignored.
    pub fn may_light_backs(&self, slots: impl Iterator<Item = u32>) -> bool {
        /// The maximum number of corners tested, about 0.1 s. Beyond it, the answer is yes.
        const MOST: usize = 30_000_000;
        /// The rounding error of corners in one plane, relative to the size of the scene.
        const NEAR: f64 = 1e-12;
        let bvh = &self.rest.bvh;
        let Some((low, high)) = bvh.bounds() else {
            return false;
        };
        let near = NEAR * low.abs().max(high.abs()).max_element();
        let surfaces_light = self.bounces > 0 || self.light.areas.is_some();
        let mut tested = 0;
        for slot in slots {
            let patch = self.rest.patch(bvh.triangle(slot).0);
            let [a, b, c] = bvh.corners(slot);
            if self.shines(patch).is_some_and(|own| own.factor != [0.0; 3]) {
                return true;
            }
            // Other surfaces reflect nothing, and triangles without area receive no light.
            let (Emitter::Lit { lamps, .. }, Some(back)) = (
                &self.light.emitters[patch.emitter as usize].0,
                (c - a).cross(b - a).try_normalize(),
            ) else {
                continue;
            };
            if self.is_lit_along(back, a, lamps) {
                return true;
            }
            // Test the corner of the scene's bounding box that lies farthest behind, then all corners.
            let lies_behind = |p: DVec3| (p - a).dot(back) > near;
            let farthest = DVec3::select(back.cmpgt(DVec3::ZERO), high, low);
            if !surfaces_light || !lies_behind(farthest) {
                continue;
            }
            tested += 3 * bvh.len();
            let mut all = 0..bvh.len() as u32;
            if tested > MOST || all.any(|slot| bvh.corners(slot).into_iter().any(lies_behind)) {
                return true;
            }
        }
        false
    }

    /// Whether light of any of these lamps arrives at `x` from the side to which `normal` points.
    fn is_lit_along(&self, normal: DVec3, x: DVec3, lamps: &[usize]) -> bool {
        // At any time: lamps rest in this frame, so their directions do not change.
        let event = Event::<Rest>::new(0.0, x);
        let event = self.rest.frame.event_to_world(event);
        let at = NullRay::new(event, Direction::from_unit(DVec3::X), self.light.index);
        let lamps = lamps.iter().filter_map(|k| self.light.lamps[*k].as_ref());
        let mut arrivals = lamps.map(|lamp| lamp.arrival_at_peak(&at, 0.0, self.light.index));
        // If this is undefined, as at the position of the lamp, light may arrive.
        arrivals.any(|arrival| {
            arrival.is_none_or(|(arrival, _)| {
                let (l, _) = self.rest.frame.frame_from_world().direction(arrival.d);
                l.unit().dot(normal) > 0.0
            })
        })
    }

    /// The same for a path that begins on a surface.
    fn first_diffuse(&self, path: usize, hit: Hit) -> Option<Vertex<'_>> {
        let [a, b, c] = self.rest.bvh.corners(hit.slot);
        // From the weights, as no ray leads here.
        let x = a + (b - a) * hit.u + (c - a) * hit.v;
        let patch = self.rest.patch(hit.triangle);
        let normal = self.rest.bvh.normal(&hit);
        let normal = if hit.front { normal } else { -normal };
        let Emitter::Lit { finish, lamps } = &self.light.emitters[patch.emitter as usize].0 else {
            return None;
        };
        let place = (self.rest, patch, &hit);
        Some(Vertex {
            path,
            hit,
            x,
            from: x,
            reflection: self.light.base.diffuse_part(finish, place, normal),
            lamps,
            carried: [1.0; 3],
            delay: 0.0,
        })
    }

    /// Adds the reflection of lamps at `vertices` to `all`.
    fn light_up<'a>(&'a self, vertices: &[Vertex], all: &mut Vec<Contribution<'a>>) {
        let mut candidates = Vec::new();
        for vertex in vertices {
            let lamps = vertex.lamps.iter();
            for lamp in lamps.filter_map(|k| self.light.lamps[*k].as_ref()) {
                candidates.extend(self.light_sample(vertex, lamp));
            }
        }
        let segments: Vec<_> = candidates.iter().filter_map(|sample| sample.way).collect();
        self.add_open(candidates, &segments, all);
    }

    /// Adds the reflection at `vertices`, which have `depth` surfaces before them, of points sampled on shining surfaces.
    fn light_up_by_areas<'a>(
        &'a self,
        vertices: &[Vertex],
        (samples, depth): (&[(u64, u32)], u32),
        all: &mut Vec<Contribution<'a>>,
    ) {
        let Some(areas) = &self.light.areas else {
            return;
        };
        let (mut candidates, mut segments) = (Vec::new(), Vec::new());
        for vertex in vertices {
            let (pixel, index) = samples[vertex.path];
            let numbers = self::samples(&[pixel], index, depth).on_path(AREA);
            let reflection = &vertex.reflection;
            let geometric = reflection.geometric_normal();
            // The light tree expects a point lifted off its triangle, so that the triangle itself is not above it.
            let size = shadow_size(vertex.from, vertex.x);
            let x = lifted(size, vertex.x, geometric);
            let place = (x, reflection.normal(), geometric);
            let base = (&self.light.base, self.rest);
            let Some(draw) = areas.drawn_from(base, place, numbers) else {
                continue;
            };
            if !vertex.reflection.is_open(draw.sent.l) {
                continue;
            }
            // Emission that followed paths can hit as well is weighted against that.
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
                s_max: shadow_end([draw.distance, draw.cosine], [size, 1.0]),
                skip: Some(vertex.hit.triangle),
                end: Some(draw.triangle),
            });
            segments.extend(way);
            let found = Contribution {
                path: vertex.path,
                emission: draw.emission,
                light,
                delay: vertex.delay + self.light.index * draw.distance + draw.clock_zero,
                is_end: false,
            };
            candidates.push(LightSample { found, way });
        }
        self.add_open(candidates, &segments, all);
    }

    /// Adds the contributions that are not blocked.
    fn add_open<'a>(
        &self,
        candidates: Vec<LightSample<'a>>,
        segments: &[Segment],
        all: &mut Vec<Contribution<'a>>,
    ) {
        let mut blocked = vec![false; segments.len()];
        let bvh = &self.rest.bvh;
        bvh.any_by(self.method, segments, &mut blocked, None);
        // Answers come in the order of the candidates with a segment; those without one ignore shadows.
        let mut blocked = blocked.into_iter();
        let open = candidates
            .into_iter()
            .filter(|sample| sample.way.is_none() || blocked.next() == Some(false));
        all.extend(open.map(|sample| sample.found));
    }

    /// The next surfaces along directions sampled at `vertices`, which have `depth` surfaces before them; their emission is added to `all`.
    fn go_on<'a>(
        &'a self,
        vertices: Vec<Vertex<'_>>,
        (samples, depth): (&[(u64, u32)], u32),
        all: &mut Vec<Contribution<'a>>,
    ) -> Vec<Vertex<'a>> {
        let mut onward = Onward::default();
        for vertex in &vertices {
            let (pixel, index) = samples[vertex.path];
            let numbers = self::samples(&[pixel], index, depth).on_path(ONWARD);
            onward.draw(vertex, vertex.path, numbers);
        }
        let met = self.met(onward).into_iter();
        met.filter_map(|(path_hit, leaving)| self.meet(&path_hit, &leaving, all))
            .collect()
    }

    /// The hits of the rays that hit anything.
    fn met(&self, onward: Onward) -> Vec<(PathHit, Leaving)> {
        let Onward {
            paths,
            origins,
            directions,
            slots,
        } = onward;
        let mut hits = vec![None; directions.len()];
        let from = Origins::Leaving {
            origins: &origins,
            slots: &slots,
        };
        let bvh = &self.rest.bvh;
        bvh.closest_by(self.method, from, &directions, &mut hits, None, None);
        let met = paths.into_iter().zip(hits).zip(origins);
        let meetings = met.filter_map(|((onward, hit), from)| {
            let hit: Hit = hit?;
            let OnwardPath {
                path,
                leaving,
                carried,
                delay,
            } = onward;
            let drawn = &leaving.drawn;
            let path_hit = PathHit {
                path,
                hit,
                from,
                d: drawn.l,
                index: drawn.index,
                carried,
                delay: delay + self.light.index * drawn.index * hit.s,
            };
            Some((path_hit, leaving))
        });
        meetings.collect()
    }

    /// The surface that a path hits after leaving another in this way, if it reflects; its emission is added to `all`.
    fn meet<'a>(
        &'a self,
        path_hit: &PathHit,
        leaving: &Leaving,
        all: &mut Vec<Contribution<'a>>,
    ) -> Option<Vertex<'a>> {
        let (carried, delay) = (path_hit.carried, path_hit.delay);
        if let Some(own) = self.own(path_hit.path, &path_hit.hit, carried, delay) {
            let weight = self.weight_of_own(path_hit, leaving);
            all.push(Contribution {
                light: own.light.map(|c| weight * c),
                ..own
            });
        }
        self.vertex(path_hit)
    }

    /// The weight of the emission of a shining surface that was hit by a path, if light samples could find it, too: (4) of
    /// [`paths`](super::paths), with W = 1.
    fn weight_of_own(&self, path_hit: &PathHit, leaving: &Leaving) -> f64 {
        let density = leaving.drawn.density;
        let areas = self.light.areas.as_ref();
        let from = (path_hit.from, leaving.normal);
        match areas.and_then(|areas| areas.density_at(path_hit.hit.triangle, from)) {
            _ if density.is_infinite() => 1.0,
            None => 1.0,
            Some((_, false)) => 0.0,
            Some((by_area, true)) => {
                let r = path_hit.hit.s;
                let cosine = self.rest.bvh.normal(&path_hit.hit).dot(path_hit.d).abs();
                let cosine = cosine.max(f64::MIN_POSITIVE);
                balance(density, by_area.per_solid_angle(r * r, cosine))
            }
        }
    }

    /// The surface that a path hits; `None` if it does not reflect.
    fn vertex(&self, path_hit: &PathHit) -> Option<Vertex<'_>> {
        let PathHit {
            path,
            hit,
            from,
            d,
            index,
            carried,
            delay,
        } = *path_hit;
        let x = from + d * hit.s;
        let patch = self.rest.patch(hit.triangle);
        if patch.black_back && !hit.front {
            return None;
        }
        let Emitter::Lit { finish, lamps } = &self.light.emitters[patch.emitter as usize].0 else {
            return None;
        };
        // The normal on the side that was hit.
        let normal = self.rest.bvh.normal(&hit);
        let normal = if hit.front { normal } else { -normal };
        let place = (self.rest, patch, &hit);
        Some(Vertex {
            path,
            hit,
            x,
            from,
            reflection: self
                .light
                .base
                .reflection(finish, place, (normal, -d), index),
            lamps,
            carried,
            delay,
        })
    }

    /// The reflection of a lamp of emission 1 at the surface, if it is not blocked.
    fn light_sample<'a>(&self, vertex: &Vertex, lamp: &'a Lamp) -> Option<LightSample<'a>> {
        // The lamp's proper time that corresponds to the frame's time 0 at the surface.
        let event = self
            .rest
            .frame
            .event_to_world(Event::<Rest>::new(0.0, vertex.x));
        let at = NullRay::new(event, Direction::from_unit(DVec3::X), self.light.index);
        let (arrival, proper_time) = lamp.arrival_at_peak(&at, 0.0, self.light.index)?;
        let (l, rho) = self.rest.frame.frame_from_world().direction(arrival.d);
        let l = l.unit();
        let cosine = vertex.reflection.normal().dot(l);
        if cosine <= 0.0 || !vertex.reflection.is_open(l) {
            return None;
        }
        let incident = lamp.incident(&arrival, rho, cosine);
        let value = vertex.reflection.value(l);
        // f E: the lamp has no extent, so there is no density to divide by.
        let light: [f64; 3] = std::array::from_fn(|c| value[c] * incident.irradiance[c]);
        if light.iter().all(|c| *c == 0.0) {
            return None;
        }
        // Distances transform like frequencies: r_F/r_world = ω_F/ω_world.
        let way = lamp.shadows.then(|| Segment {
            ray: shadow_ray(vertex.from, vertex.x, l),
            s_max: arrival.distance * rho,
            skip: Some(vertex.hit.triangle),
            end: None,
        });
        let found = Contribution {
            path: vertex.path,
            emission: lamp.emission(),
            light: std::array::from_fn(|c| vertex.carried[c] * light[c]),
            delay: vertex.delay - proper_time,
            is_end: false,
        };
        Some(LightSample { found, way })
    }

    /// The reading of a clock on `patch` at the frame's time 0: the world's clock if the frame rests in it, else the object's own.
    pub fn clock(&self, patch: &Patch) -> f64 {
        match self.rest.frame.velocity().is_rest() {
            true => self.rest.frame.origin().ct,
            false => -patch.object_origin.ct,
        }
    }
}

/// Random numbers at a path's surface that has `depth` surfaces before it.
fn samples(pixels: &[u64; 1], index: u32, depth: u32) -> Samples<'_> {
    Samples {
        pixels,
        index,
        indices: &[],
        in_pixel: 1,
        depth,
        exposure: None,
        cells: None,
    }
}
