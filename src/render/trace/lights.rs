//! Where the light of shining surfaces and of the sky falls.
//!
//! An element dA of a surface that rests in its frame G and has the radiance L there, seen from the point X of a
//! surface that rests in F, was at the event of emission on the past light cone of X: in G a point that does not move, at the
//! distance r_G. It fills the solid angle dω_F = W² dω_G = W² cos θ_y dA/r_G², and L_F = W⁻ᵖ L, so that
//!
//! ```text
//! E_F = ∫ W²⁻ᵖ L cos θ_y cos θ_F/r_G² dA.
//! ```
//!
//! Every hit draws one point of all elements, with a density as their area times their radiance. Of the sky, a hit has
//! all that would fall on it with nothing in the way ([`BoostedSky::irradiance`]), and what stands in the way of four drawn directions,
//! by their density, is taken from it: the mean is right, and where the sky is open there is no noise. Surfaces that shine also
//! directionally draw one direction more for that part. What is in the way is black: light is followed once.

use glam::DVec3;

use super::base_colours::{BaseColour, BaseColours};
use super::emitted::Emitted;
use super::lamps::reflect_unblocked;
use super::point::SurfacePoint;
use super::run::Run;
use super::stats::Meter;
use crate::accel::Hit;
use crate::colour::ColourTable;
use crate::light::Received;
use crate::light::lamp::Incident;
use crate::light::reflection::Reflection;
use crate::light::sky::{BoostedSky, Sky};
use crate::spacetime::{Direction, Rest};

/// What random numbers of a hit are for.
const AREA: u32 = 0;
const SKY: u32 = 1;
const GLOSS: u32 = 2;

/// Directions of the sky that are drawn for what is in the way.
const DRAWS: u32 = 4;

/// Shadow rays end this part of the way before the shining surface, which is no obstacle to itself.
const SHORTER: f64 = 1.0 - 1e-6;

/// Surfaces that shine.
#[derive(Debug)]
pub struct AreaLights {
    elements: Vec<Element>,
    /// Power of all elements up to each, in parts of the whole.
    cumulative: Vec<f64>,
    /// What surfaces receive of them.
    received: Received,
    /// Frame, triangle and index of each element, ascending.
    places: Vec<(u32, u32, u32)>,
}

/// A triangle that shines.
#[derive(Debug, Clone)]
pub struct Element {
    /// Its rest frame.
    pub frame: u32,
    /// Its index in the frame's BVH.
    pub triangle: u32,
    /// Its corners in the frame.
    pub corners: [DVec3; 3],
    /// Radiance, by channel.
    pub radiance: BaseColour,
    /// The spectrum that the mean of the channels is a factor on, where it has one.
    pub spectrum: Option<std::sync::Arc<ColourTable>>,
    /// Whether its back shines too.
    pub two_sided: bool,
    /// Whether other surfaces shadow it.
    pub shadows: bool,
}

impl Element {
    fn area(&self) -> f64 {
        let [a, b, c] = self.corners;
        0.5 * (b - a).cross(c - a).length()
    }

    /// About how bright it is at rest: by this it is drawn.
    fn brightness(&self) -> f64 {
        let factor = self.radiance.factor.iter().sum::<f64>();
        let Some(table) = &self.spectrum else {
            return factor;
        };
        // What is not seen at rest may be seen in motion.
        let at_rest: f64 = table.colour(1.0).iter().sum();
        factor * if at_rest > 0.0 { at_rest } else { 1.0 }
    }
}

/// What an area light sends to a point.
pub(super) struct Sent {
    incident: Incident,
    /// Towards it in the point's rest frame.
    pub l: DVec3,
    /// Towards it in the world, and how far it is.
    d: DVec3,
    distance: f64,
    pub shadows: bool,
    /// Per solid angle of the point's rest frame.
    pub density: f64,
}

impl AreaLights {
    /// Those of `elements` that have an area and shine; none if none does.
    pub fn new(elements: Vec<Element>, received: Received) -> Option<AreaLights> {
        let power = |e: &Element| e.area() * e.brightness();
        let shines = |e: &Element| power(e) > 0.0 && power(e).is_finite();
        let elements: Vec<_> = elements.into_iter().filter(shines).collect();
        let mut sum = 0.0;
        let sums: Vec<f64> = elements
            .iter()
            .map(|e| {
                sum += power(e);
                sum
            })
            .collect();
        let places = (0..).zip(&elements);
        let mut places: Vec<_> = places.map(|(k, e)| (e.frame, e.triangle, k)).collect();
        places.sort_unstable();
        (sum > 0.0 && sum.is_finite()).then(|| AreaLights {
            places,
            cumulative: sums.into_iter().map(|part| part / sum).collect(),
            elements,
            received,
        })
    }

    /// Adds what falls on the points of `run`, in a medium of index `index`.
    pub(super) fn illuminate(
        &self,
        base: &BaseColours,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        let random = |k| run.random(k, AREA);
        self.illuminate_by(random, |_, _| 1.0, base, run, index, emitted, meter);
    }

    /// The same by the numbers `random`, each point's light weighted by `weight`.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn illuminate_by(
        &self,
        random: impl Fn(usize) -> [f64; 2],
        weight: impl Fn(Option<&Reflection>, &Sent) -> f64,
        base: &BaseColours,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        for shadows in [true, false] {
            emitted.arriving.clear();
            emitted.queries.clear();
            for (k, point) in run.points().enumerate() {
                let normal = emitted.points.normals.get(k);
                let sent = self.sent(base, run, &point, normal, random(k));
                if let Some(sent) = sent.filter(|sent| sent.shadows == shadows) {
                    let weight = weight(emitted.reflections.get(k), &sent);
                    let incident = sent.incident.scaled(weight);
                    emitted.arriving.push((k, incident, sent.l));
                    emitted.queries.push(k, sent.d, sent.distance);
                }
            }
            reflect_unblocked(run, shadows, index, emitted, meter);
            if self.elements.iter().all(|e| e.shadows) {
                break;
            }
        }
    }

    /// The density per area with which a point of this triangle is drawn, where it shines, and whether other surfaces
    /// shadow it.
    pub(super) fn density(&self, frame: u32, triangle: u32) -> Option<(f64, bool)> {
        let at = |place: &(u32, u32, u32)| (place.0, place.1).cmp(&(frame, triangle));
        let place = self.places.binary_search_by(at).ok()?;
        let k = self.places[place].2 as usize;
        let before = k.checked_sub(1).map_or(0.0, |k| self.cumulative[k]);
        let element = &self.elements[k];
        let share = self.cumulative[k] - before;
        Some((share / element.area(), element.shadows))
    }

    /// What one point of all elements sends, by its density.
    fn sent(
        &self,
        base: &BaseColours,
        run: &Run,
        point: &SurfacePoint,
        facing: DVec3,
        [x, y]: [f64; 2],
    ) -> Option<Sent> {
        // The element, and from what is left of the number where on it.
        let last = self.cumulative.len() - 1;
        let chosen = self.cumulative.partition_point(|sum| *sum <= x).min(last);
        let before = chosen.checked_sub(1).map_or(0.0, |k| self.cumulative[k]);
        let share = self.cumulative[chosen] - before;
        let root = ((x - before) / share).clamp(0.0, 1.0).sqrt();
        let (u, v) = (root * (1.0 - y), root * y);
        let element = &self.elements[chosen];
        let [a, b, c] = element.corners;
        let normal = (b - a).cross(c - a);
        let twice = normal.length();
        // k in G, where the element does not move.
        let surfaces = run.traced.surfaces;
        let rest = surfaces.rest(element.frame);
        let place = a + (b - a) * u + (c - a) * v;
        let way = place - surfaces.event(element.frame, point).x;
        let distance = way.length();
        let in_light = Direction::<Rest>::new(way)?;
        let cosine_there = -normal.dot(in_light.unit()) / twice;
        let cosine_there = if element.two_sided {
            cosine_there.abs()
        } else {
            cosine_there
        };
        // Towards it in the world and in F, with ω_G/ω_world = 1/ratio.
        let (d, ratio) = rest.frame.world_from_frame().direction(in_light);
        let (l, rho) = surfaces.direction(point.frame, d);
        let cosine = facing.dot(l.unit());
        if cosine_there <= 0.0 || cosine <= 0.0 {
            return None;
        }
        let w = 1.0 / (ratio * rho);
        let density = share / (0.5 * twice);
        let factor = cosine_there * cosine / (distance * distance * density);
        let hit = Hit {
            s: 0.0,
            u,
            v,
            triangle: element.triangle,
            slot: 0,
            front: true,
        };
        let radiance = base.colour_at(&element.radiance, rest, rest.patch(element.triangle), &hit);
        let irradiance = match &element.spectrum {
            None => self.received.irradiance(w, radiance, factor),
            // W⁻⁵ is in the colour, and W² of the solid angle is not.
            Some(table) => {
                let factor = w * w * factor * radiance.iter().sum::<f64>() / 3.0;
                table.colour(w).map(|c| c * factor)
            }
        };
        Some(Sent {
            incident: Incident::new(irradiance, self.received.wavelength_scale(w)),
            l: l.unit(),
            d: d.unit(),
            distance: distance * ratio * SHORTER,
            shadows: element.shadows,
            density: density * distance * distance / (w * w * cosine_there),
        })
    }
}

/// The sky as a light of surfaces.
#[derive(Debug)]
pub struct SkyLight {
    /// The sky.
    pub sky: std::sync::Arc<Sky>,
    /// By rest frame.
    pub frames: Vec<BoostedSky>,
    /// Whether surfaces shadow it.
    pub shadows: bool,
}

/// Light from one direction, by its density.
struct Drawn {
    /// The point of the run.
    k: usize,
    l: DVec3,
    /// L cos θ over density, or with the weight of what reflects it.
    light: [f64; 3],
}

impl SkyLight {
    /// Adds what the points of `run` reflect of the sky, in a medium of index `index`.
    pub(super) fn illuminate(
        &self,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        let boosted = &self.frames[run.frame as usize];
        for k in 0..run.count() {
            let irradiance = boosted.irradiance(emitted.points.normals.get(k));
            match emitted.reflections.get(k) {
                None => emitted.incident[k].add(&Incident::new(irradiance, 1.0)),
                Some(reflection) => {
                    let value = reflection.mean_diffuse_value();
                    add(&mut emitted.added[k], |c| value[c] * irradiance[c]);
                }
            }
        }
        let glossy = !emitted.reflections.is_empty();
        if self.shadows || glossy {
            self.correct(boosted, run, index, emitted, meter);
        }
        if glossy {
            self.gloss(boosted, run, index, emitted, meter);
        }
    }

    /// Adds the light of one drawn direction to each point of `run`, drawn by `random` and weighted by `weight` of how the point
    /// reflects, the direction and its density.
    pub(super) fn illuminate_by(
        &self,
        random: impl Fn(usize) -> [f64; 2],
        weight: impl Fn(Option<&Reflection>, DVec3, f64) -> f64,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        let boosted = &self.frames[run.frame as usize];
        emitted.arriving.clear();
        emitted.queries.clear();
        for k in 0..run.count() {
            let n = emitted.points.normals.get(k);
            let Some(sample) = boosted.sample(n, random(k)) else {
                continue;
            };
            let l = sample.in_rest;
            let weight = weight(emitted.reflections.get(k), l, sample.density);
            let factor = weight * n.dot(l) / sample.density;
            let radiance = boosted.radiance(&self.sky, sample.d, sample.rho);
            let scale = boosted.received().wavelength_scale(1.0 / sample.rho);
            let incident = Incident::new(radiance.map(|l| l * factor), scale);
            emitted.arriving.push((k, incident, l));
            emitted.queries.push(k, sample.d.unit(), f64::INFINITY);
        }
        reflect_unblocked(run, self.shadows, index, emitted, meter);
    }

    /// Takes away the light of what is in the way, and what the mean diffuse value has too much.
    fn correct(
        &self,
        boosted: &BoostedSky,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        emitted.queries.clear();
        let mut drawn = Vec::with_capacity(run.count() * DRAWS as usize);
        for k in 0..run.count() {
            let n = emitted.points.normals.get(k);
            for draw in 0..DRAWS {
                let Some(sample) = boosted.sample(n, run.one_random_of(k, SKY, draw, DRAWS)) else {
                    continue;
                };
                let factor = n.dot(sample.in_rest) / (sample.density * f64::from(DRAWS));
                let radiance = boosted.radiance(&self.sky, sample.d, sample.rho);
                drawn.push(Drawn {
                    k,
                    l: sample.in_rest,
                    light: radiance.map(|l| l * factor),
                });
                emitted.queries.push(k, sample.d.unit(), f64::INFINITY);
            }
        }
        self.occlude(run, index, emitted, meter);
        for (at, Drawn { k, l, light }) in drawn.into_iter().enumerate() {
            let blocked = emitted.queries.is_blocked(at);
            match emitted.reflections.get(k) {
                None if blocked => {
                    emitted.incident[k].add(&Incident::new(light.map(|l| -l), 1.0));
                }
                None => {}
                Some(reflection) => {
                    let mean = reflection.mean_diffuse_value();
                    let value = if blocked {
                        [0.0; 3]
                    } else {
                        reflection.diffuse_value(l)
                    };
                    add(&mut emitted.added[k], |c| (value[c] - mean[c]) * light[c]);
                }
            }
        }
    }

    /// Adds the specular part, by one direction drawn for it.
    fn gloss(
        &self,
        boosted: &BoostedSky,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        emitted.queries.clear();
        let mut drawn = Vec::with_capacity(run.count());
        for k in 0..run.count() {
            let reflection = &emitted.reflections[k];
            let Some((l, weight)) = reflection.sample_specular(run.random(k, GLOSS)) else {
                continue;
            };
            let (d, rho) = boosted.in_world(l);
            let radiance = boosted.radiance(&self.sky, d, rho);
            let light = std::array::from_fn(|c| weight[c] * radiance[c]);
            drawn.push(Drawn { k, l, light });
            emitted.queries.push(k, d.unit(), f64::INFINITY);
        }
        self.occlude(run, index, emitted, meter);
        for (at, Drawn { k, light, .. }) in drawn.into_iter().enumerate() {
            if !emitted.queries.is_blocked(at) {
                add(&mut emitted.added[k], |c| light[c]);
            }
        }
    }

    fn occlude(&self, run: &Run, index: f64, emitted: &mut Emitted, meter: &mut Meter) {
        if self.shadows {
            let (queries, points) = (&mut emitted.queries, &emitted.points);
            run.traced
                .surfaces
                .occlude(queries, run, points, index, meter);
        }
    }
}

#[inline]
fn add(sum: &mut [f64; 3], part: impl Fn(usize) -> f64) {
    for (c, sum) in sum.iter_mut().enumerate() {
        *sum += part(c);
    }
}
