//! Where the light of the sky falls.
//!
//! Of the sky, a hit has all that would fall on it with nothing in the way ([`BoostedSky::irradiance`]), and what stands in the way of four drawn
//! directions, by their density, is taken from it: the mean is right, and where the sky is open there is no noise. Surfaces that shine also
//! directionally draw one direction more for that part. What is in the way is black: light is followed once.

use glam::DVec3;

use super::emitted::Emitted;
use super::lamps::reflect_unblocked;
use super::run::Run;
use super::stats::Meter;
use crate::accel::vectors::Columns;
use crate::light::lamp::Incident;
use crate::light::reflection::Reflection;
use crate::light::sky::{BoostedSky, Sky};

/// What random numbers of a hit are for, beside that of [`area_lights`](super::area_lights).
const SKY: u32 = 1;
const GLOSS: u32 = 2;

/// Directions of the sky that are drawn for what is in the way.
const DRAWS: u32 = 4;

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
                None => emitted.incident.add(k, &Incident::new(irradiance, 1.0)),
                Some(reflection) => {
                    let value = reflection.mean_diffuse_value();
                    add(&mut emitted.added, k, |c| value[c] * irradiance[c]);
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

    /// Adds the light of one drawn direction to each point of `run`, drawn by `emitted.numbers` and weighted by `weight` of how the
    /// point reflects, the direction and its density.
    pub(super) fn illuminate_by(
        &self,
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
            let numbers = [emitted.numbers[0][k], emitted.numbers[1][k]];
            let Some(sample) = boosted.sample(n, numbers) else {
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
        // An estimate of what `illuminate` got wrong: it took the sky as open, and the diffuse value as its mean over directions.
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
                // Matte surfaces have no direction to correct: what is blocked is taken away again.
                None if blocked => {
                    let taken = Incident::new(light.map(|l| -l), 1.0);
                    emitted.incident.add(k, &taken);
                }
                None => {}
                Some(reflection) => {
                    let mean = reflection.mean_diffuse_value();
                    let value = if blocked {
                        [0.0; 3]
                    } else {
                        reflection.diffuse_value(l)
                    };
                    add(&mut emitted.added, k, |c| (value[c] - mean[c]) * light[c]);
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
            // `weight` is value times cosine over density.
            let (d, rho) = boosted.in_world(l);
            let radiance = boosted.radiance(&self.sky, d, rho);
            let light = std::array::from_fn(|c| weight[c] * radiance[c]);
            drawn.push(Drawn { k, l, light });
            emitted.queries.push(k, d.unit(), f64::INFINITY);
        }
        self.occlude(run, index, emitted, meter);
        for (at, Drawn { k, light, .. }) in drawn.into_iter().enumerate() {
            if !emitted.queries.is_blocked(at) {
                add(&mut emitted.added, k, |c| light[c]);
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
fn add(sums: &mut Columns, k: usize, part: impl Fn(usize) -> f64) {
    sums.set(k, sums.get(k) + DVec3::new(part(0), part(1), part(2)));
}
