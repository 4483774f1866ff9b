//! Adds the light found by paths that several points of a run share: (1) of [`sharing`](super::sharing), by the loops of
//! [`paths`](super::paths).

use std::f64::consts::PI;

use glam::DVec3;

use super::emitted::{Emitted, Met, Paths};
use super::paths::{PathTraced, add, balance, sky_weight};
use super::run::Run;
use super::sharing::{End, MOST};
use super::stats::Meter;
use crate::accel::vectors::{Block, VectorLoop, dispatch};
use crate::light::lamp::{Incident, Irradiance};

impl PathTraced {
    /// Adds the light found by the paths of groups to the points of `run` that share them: (1) of [`sharing`](super::sharing).
    pub(super) fn share(
        &self,
        paths: &mut Paths,
        run: &Run,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        let Paths {
            levels,
            groups,
            receivers,
            ..
        } = paths;
        let Some(first) = levels.first() else {
            return;
        };
        let rays = first.rays(run.traced);
        let (surfaces, bvh) = (run.traced.surfaces, &run.rest.bvh);
        let sky = self.light.sky.as_ref();
        for group in &groups.all {
            receivers.clear();
            let points = &groups.order[group.points.clone()];
            let mut shared = Shared::NOTHING;
            for k in points.iter().map(|k| *k as usize) {
                let points = &emitted.points;
                let place = (points.positions.get(k), points.normals.get(k));
                receivers.push(place, points.eye(k), points.triangles[k]);
                if points.is_smooth() {
                    receivers.push_geometric(points.geometric(k));
                }
            }
            for ray in group.rays.clone() {
                let (drawn, hit) = (&first.drawn[ray], first.hits.hits()[ray]);
                let Some(sent) = self.sent_in_parts(&first.met[ray]) else {
                    continue;
                };
                // Where the path ends: on a surface, or at infinity.
                let end = match hit {
                    None => End::Open(drawn.scattered.l),
                    Some(hit) => {
                        let (local, _) = surfaces.local(run.frame, ray, &rays, &first.hits);
                        let normal = bvh.normal(&hit);
                        End::On {
                            y: local.at(hit.s).x,
                            normal: if hit.front { normal } else { -normal },
                            triangle: hit.triangle,
                        }
                    }
                };
                // w of (1) for each point, by shadow rays to the end.
                let own = drawn.at as usize;
                let numbers = (own, group.paths());
                receivers.find(end, numbers, bvh, run.traced.rays.method, meter.occlusion());
                let mut by_area = [0.0; MOST];
                let is_drawn = match (end, &self.light.areas) {
                    (End::On { y, triangle, .. }, Some(areas)) => {
                        areas.densities_at(triangle, y, receivers.places(), &mut by_area)
                    }
                    _ => None,
                };
                // Emission that light samples could find as well is weighted against these, for each point.
                let densities = &receivers.densities;
                let parts = match (end, is_drawn, sky) {
                    (End::On { .. }, None, _) | (End::Open(_), _, None) => [1.0; MOST],
                    (End::On { .. }, Some(false), _) => [0.0; MOST],
                    (End::On { .. }, Some(true), _) => {
                        std::array::from_fn(|k| balance(densities[k], by_area[k]))
                    }
                    (End::Open(l), _, Some(sky)) => {
                        densities.map(|density| sky_weight(sky, run.frame, l, density))
                    }
                };
                dispatch(Share {
                    sent: &sent,
                    parts: &parts,
                    weights: &receivers.weights,
                    shared: &mut shared,
                });
                // Light of non-diffuse surfaces only goes to the point from which the path continued.
                if !sent.is_diffuse {
                    let part = group.count() as f64 / group.paths() as f64;
                    shared.add(own, sent.reflected.scaled(part));
                }
            }
            for (at, k) in points.iter().enumerate() {
                let k = *k as usize;
                let albedo = emitted.reflections[k].albedo();
                let (reflected, incident) = shared.of(at);
                let added = emitted.added.get(k) + DVec3::from(albedo) * reflected;
                emitted.added.set(k, added);
                let mut all = emitted.incident.get(k);
                all.merge(&incident);
                emitted.incident.set(k, &all);
            }
        }
    }

    /// The light found by a shared path, not weighted; `None` if it is dark.
    fn sent_in_parts(&self, met: &Met) -> Option<Sent> {
        let dark = |light: &Incident| light.irradiance == [0.0; 3];
        let sent = match met {
            Met::Nothing => return None,
            Met::Light(own) => Sent {
                own: *own,
                reflected: own.with([0.0; 3]),
                is_diffuse: true,
            },
            Met::Surface(point) => {
                let emitter = point.emitter as usize;
                let response = &self.light.emitters[emitter].1;
                let scale = point.incident.wavelength_scale();
                let arriving = |radiance| {
                    let light = (radiance, [0.0; 2], scale);
                    self.arriving(emitter, response, point.ratio, light)
                };
                Sent {
                    own: arriving(point.own),
                    reflected: arriving(point.reflected),
                    is_diffuse: point.is_diffuse,
                }
            }
        };
        (!dark(&sent.own) || !dark(&sent.reflected)).then_some(sent)
    }
}

/// The light found by a shared path.
struct Sent {
    /// The emission of its end.
    own: Incident,
    /// The light reflected there, and whether equally in all directions.
    reflected: Incident,
    is_diffuse: bool,
}

/// Light that falls on the points of a group, as a radiance, and the sums from which its wavelength is computed.
struct Shared {
    radiance: [Block; 3],
    /// The sums of weights, without and with the wavelength.
    weights: [Block; 2],
}

impl Shared {
    const NOTHING: Shared = Shared {
        radiance: [[0.0; MOST]; 3],
        weights: [[0.0; MOST]; 2],
    };

    /// The light that falls on point `at`.
    fn of(&self, at: usize) -> (DVec3, Irradiance) {
        let radiance = self.radiance.each_ref().map(|channel| channel[at]);
        let weights = self.weights.each_ref().map(|weights| weights[at]);
        (radiance.into(), Irradiance::from_parts([0.0; 3], weights))
    }

    /// Adds light to point `at` only.
    fn add(&mut self, at: usize, light: Incident) {
        let (radiance, mut incident) = self.of(at);
        let mut radiance = radiance.to_array();
        add((&mut radiance, &mut incident), [1.0; 3], light);
        for (channel, sum) in self.radiance.iter_mut().zip(radiance) {
            channel[at] = sum;
        }
        let (_, sums) = incident.parts();
        for (weights, sum) in self.weights.iter_mut().zip(sums) {
            weights[at] = sum;
        }
    }
}

/// The loop that adds the light found by a path to the points of its group, by their weights.
struct Share<'a> {
    sent: &'a Sent,
    /// The weights of the emission of its end.
    parts: &'a Block,
    weights: &'a Block,
    shared: &'a mut Shared,
}

impl VectorLoop for Share<'_> {
    #[inline(always)]
    fn run(self) {
        let Sent {
            own,
            reflected,
            is_diffuse,
        } = self.sent;
        let counts = if *is_diffuse { 1.0 } else { 0.0 };
        let [without, with] = &mut self.shared.weights;
        let mut channel = 0;
        while channel < 3 {
            let (own, reflected) = (own.irradiance[channel], reflected.irradiance[channel]);
            let sums = &mut self.shared.radiance[channel];
            for k in 0..MOST {
                let (part, weight) = (self.parts[k], self.weights[k]);
                let light = (part * own + counts * reflected) * weight;
                // Infinite light must not turn a zero weight into NaN.
                let light = if weight > 0.0 { light } else { 0.0 };
                sums[k] += light;
                // As an irradiance, like that of lamps.
                without[k] += light * PI;
                with[k] += light * PI * self.sent.reflected.wavelength_scale;
            }
            channel += 1;
        }
    }
}
