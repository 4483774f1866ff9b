//! Illumination by the sky.
//!
//! The unoccluded irradiance on a hit is known: E of [`BoostedSky::irradiance`]. Obstacles are found along sampled directions. With lᵢ the light along
//! these over its density, with mean E, and vᵢ = 1 if the direction is free, else 0, the estimator
//!
//! ```text
//! c E + Σ (vᵢ − c) lᵢ/N
//! ```
//!
//! has the mean Σ vᵢ lᵢ/N for every c that does not depend on the samples, and no noise if nothing is occluded and c = 1, or everything is
//! and c = 0 (a control variate: Hammersley and Handscomb, "Monte Carlo Methods", 1964, 5.5). So two independent pairs of directions are
//! sampled, and for each pair c is the unoccluded fraction of the other: under the open sky there is no noise, a closed box is exactly
//! dark, and the mean is right everywhere. In between, single samples may be below 0.
//!
//! If light is sampled at wavelengths ([`spectral`](super::spectral)), E is not known at them, and c is 0.
//!
//! Surfaces with specular reflection sample one more direction for that part. If directions of the sky are sampled by its light, the N directions above
//! contribute to it, too, as they find small suns, which the one for the lobe rarely does. Both are weighted by the balance heuristic (Veach, "Robust Monte
//! Carlo Methods", 1997, 9.2.2): a direction sampled for the lobe with the density q and for the sky with p has the weight q/(q + N p) there and N p/(q + N
//! p) here. If the lobe is narrower than a texel, the lobe's direction has the full weight, as only it sees the picture. Obstacles are black: light is
//! traced for one step only.

use glam::DVec3;

use super::emitted::Emitted;
use super::lamps::reflect_unblocked;
use super::run::Run;
use super::stats::Meter;
use crate::accel::vectors::Columns;
use crate::light::lamp::Incident;
use crate::light::reflection::Reflection;
use crate::light::sky::{BoostedSky, Sky, SkySample};

/// Purposes of random numbers of a hit, in addition to that of [`area_lights`](super::area_lights).
const SKY: u32 = 1;
const GLOSS: u32 = 2;

/// The purpose of random numbers of the second pair, and the number of directions in a pair.
const OTHER_PAIR: u32 = 3;
const PAIR: u32 = 2;
/// Directions of both pairs.
const DRAWS: usize = 4;

/// The sky as a light of surfaces.
#[derive(Debug)]
pub struct SkyLight {
    /// The sky.
    pub sky: std::sync::Arc<Sky>,
    /// The sky as seen in each rest frame.
    pub frames: Vec<BoostedSky>,
    /// Whether surfaces block its light.
    pub shadows: bool,
}

/// Light from one sampled direction.
struct Drawn {
    /// The index of the point in the run, and of its pair of directions.
    k: usize,
    pair: usize,
    l: DVec3,
    /// Whether the direction is below the surface, by the normal of its triangle.
    is_below: bool,
    /// L cos θ over density, divided by the number of samples.
    light: [f64; 3],
    /// Its weight in the specular part.
    specular: f64,
}

/// The unoccluded fraction of one pair of a point's directions; 1 if none was sampled.
fn open_part(drawn: &[Drawn], pair: usize, blocked: impl Fn(usize) -> bool) -> f64 {
    let of_pair = || drawn.iter().enumerate().filter(|(_, d)| d.pair == pair);
    let open = of_pair().filter(|(i, _)| !blocked(*i)).count();
    match of_pair().count() {
        0 => 1.0,
        count => open as f64 / count as f64,
    }
}

/// Samples the directions of both pairs for each point of `run`, and calls `each` with the point, the index of the pair, the direction, and the cosine
/// over its density, divided by the number of samples.
fn draw(
    boosted: &BoostedSky,
    run: &Run,
    emitted: &mut Emitted,
    mut each: impl FnMut(&mut Emitted, usize, usize, SkySample, f64),
) {
    for k in 0..run.count() {
        let n = emitted.points.normals.get(k);
        for (pair, dimension) in [SKY, OTHER_PAIR].into_iter().enumerate() {
            for draw in 0..PAIR {
                let numbers = run.one_random_of(k, dimension, draw, PAIR);
                if let Some(sample) = boosted.sample(n, numbers) {
                    let factor = n.dot(sample.in_rest) / (sample.density * DRAWS as f64);
                    each(emitted, k, pair, sample, factor);
                }
            }
        }
    }
}

/// The weight of the direction of `sample`, which has the density with which the sky samples it, if it is sampled for the specular part.
fn own_part(reflection: &Reflection, boosted: &BoostedSky, sample: &SkySample) -> f64 {
    // A sky without suns is sampled by cosine, which finds less of any lobe than the lobe itself.
    if !boosted.is_uneven() {
        return 1.0;
    }
    let own = reflection.specular_density(sample.in_rest);
    match boosted.shows_picture(sample.d, sample.rho, own) {
        true => 1.0,
        false => own / (own + DRAWS as f64 * sample.density),
    }
}

/// f for light from `l`, which was sampled for the sky, with this weight of the specular part.
fn drawn_value(reflection: &Reflection, l: DVec3, part: f64) -> [f64; 3] {
    let diffuse = reflection.diffuse_value(l);
    if part == 0.0 {
        return diffuse;
    }
    let specular = reflection.specular_value(l);
    std::array::from_fn(|c| diffuse[c] + part * specular[c])
}

impl SkyLight {
    /// Adds the reflection of the sky at the points of `run`, in a medium of index `index`.
    pub(super) fn illuminate(
        &self,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        let boosted = &self.frames[run.frame as usize];
        let glossy = !emitted.reflections.is_empty();
        if emitted.spectral.is_sampled() {
            self.illuminate_sampled(boosted, run, index, emitted, meter);
        } else if self.shadows || glossy || emitted.points.is_smooth() {
            self.illuminate_open(boosted, run, index, emitted, meter);
        } else {
            for k in 0..run.count() {
                let irradiance = boosted.irradiance(emitted.points.normals.get(k));
                emitted.incident.add(k, &Incident::new(irradiance, 1.0));
            }
        }
        if glossy {
            self.gloss(boosted, run, index, emitted, meter);
        }
    }

    /// Adds the light of one sampled direction at each point of `run`, sampled with `emitted.numbers` and weighted by `weight` of the
    /// point's reflection, the direction and its density.
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
            if emitted.points.is_below(k, l) {
                continue;
            }
            let weight = weight(emitted.reflections.get(k), l, sample.density);
            let factor = weight * n.dot(l) / sample.density;
            let scale = boosted.received().wavelength_scale(1.0 / sample.rho);
            self.arrive(boosted, (k, &sample), [factor, scale], emitted);
        }
        reflect_unblocked(Reflection::value, run, self.shadows, index, emitted, meter);
    }

    /// Adds the light of a direction sampled for point `k`, to be tested for obstacles: times `factor`, and with this scale of wavelengths.
    fn arrive(
        &self,
        boosted: &BoostedSky,
        (k, sample): (usize, &SkySample),
        [factor, scale]: [f64; 2],
        emitted: &mut Emitted,
    ) {
        let radiance = boosted.mean_radiance(&sample.of(&self.sky, emitted.spectral.at(k)));
        let incident = Incident::new(radiance.map(|l| l * factor), scale);
        if self.sky.has_lines() && emitted.spectral.is_sampled() {
            let at = emitted.arriving.len();
            let lines = self.sky.lines(1.0 / sample.rho);
            let lines = lines.map(|line| (at, line.scaled(factor)));
            emitted.spectral.arriving.extend(lines);
        }
        emitted.arriving.push((k, incident, sample.in_rest));
        emitted.queries.push(k, sample.d.unit(), f64::INFINITY);
    }

    /// Adds the light at the points, reflected diffusely and by these directions' part of the specular reflection, if light is sampled at
    /// wavelengths: the irradiance from the whole sky at one wavelength is not tabulated, so all of it comes from sampled directions.
    fn illuminate_sampled(
        &self,
        boosted: &BoostedSky,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        emitted.arriving.clear();
        emitted.queries.clear();
        draw(boosted, run, emitted, |emitted, k, _, sample, factor| {
            if !emitted.points.is_below(k, sample.in_rest) {
                self.arrive(boosted, (k, &sample), [factor, 1.0], emitted);
            }
        });
        let value = |reflection: &Reflection, l: DVec3| {
            let sample = boosted.sample_at(reflection.normal(), l);
            drawn_value(reflection, l, 1.0 - own_part(reflection, boosted, &sample))
        };
        reflect_unblocked(value, run, self.shadows, index, emitted, meter);
    }

    /// Adds the unoccluded light at the points, reflected diffusely and by these directions' part of the specular reflection.
    fn illuminate_open(
        &self,
        boosted: &BoostedSky,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        emitted.queries.clear();
        let mut drawn = Vec::with_capacity(run.count() * DRAWS);
        draw(boosted, run, emitted, |emitted, k, pair, sample, factor| {
            let radiance = boosted.mean_radiance(&sample.of(&self.sky, None));
            let specular = match emitted.reflections.get(k) {
                None => 0.0,
                Some(reflection) => 1.0 - own_part(reflection, boosted, &sample),
            };
            drawn.push(Drawn {
                k,
                pair,
                l: sample.in_rest,
                is_below: emitted.points.is_below(k, sample.in_rest),
                light: radiance.map(|l| l * factor),
                specular,
            });
            emitted.queries.push(k, sample.d.unit(), f64::INFINITY);
        });
        self.occlude(run, index, emitted, meter);
        let mut at = 0;
        for k in 0..run.count() {
            let of_point = drawn[at..].iter().take_while(|d| d.k == k).count();
            let drawn = &drawn[at..at + of_point];
            let blocked = |i: usize| drawn[i].is_below || emitted.queries.is_blocked(at + i);
            let open = [0, 1].map(|pair| open_part(drawn, pair, blocked));
            let irradiance = boosted.irradiance(emitted.points.normals.get(k));
            // The mean of both pairs' estimators: each has the open fraction of the other as its c.
            let c = 0.5 * (open[0] + open[1]);
            let reflection = emitted.reflections.get(k);
            // c E is reflected with the mean of the diffuse value over directions, and so is each sampled direction in its control variate.
            let mean = reflection.map_or([1.0; 3], Reflection::mean_diffuse_value);
            let mut sum: [f64; 3] = std::array::from_fn(|i| c * irradiance[i] * mean[i]);
            for (i, drawn) in drawn.iter().enumerate() {
                let value = match (blocked(i), reflection) {
                    (true, _) => [0.0; 3],
                    (false, None) => [1.0; 3],
                    (false, Some(reflection)) => drawn_value(reflection, drawn.l, drawn.specular),
                };
                let open = open[1 - drawn.pair];
                for (channel, sum) in sum.iter_mut().enumerate() {
                    *sum += (value[channel] - open * mean[channel]) * drawn.light[channel];
                }
            }
            match reflection {
                None => emitted.incident.add(k, &Incident::new(sum, 1.0)),
                Some(_) => add(&mut emitted.added, k, |i| sum[i]),
            }
            at += of_point;
        }
    }

    /// Adds the specular part, from one direction sampled for it.
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
            let density = reflection.specular_density(l);
            let sample = boosted.sample_at(reflection.normal(), l);
            let part = own_part(reflection, boosted, &sample);
            let spectral = &mut emitted.spectral;
            let from = sample.of(&self.sky, spectral.at(k));
            let radiance = boosted.reflected_radiance(&from, density);
            let light: [f64; 3] = std::array::from_fn(|c| part * weight[c] * radiance[c]);
            // Lines from the same direction, which does not depend on colours.
            let in_rgb = spectral.in_rgb.get(k);
            let in_rgb = in_rgb.and_then(|of| of.sample_specular(run.random(k, GLOSS)));
            if let Some((_, weight)) = in_rgb {
                let lines = self.sky.lines(1.0 / sample.rho);
                let lines =
                    lines.map(|line| (drawn.len(), line.reflected(weight.map(|c| part * c))));
                spectral.arriving.extend(lines);
            }
            drawn.push((k, light));
            emitted.queries.push(k, sample.d.unit(), f64::INFINITY);
        }
        self.occlude(run, index, emitted, meter);
        for (at, (k, light)) in drawn.iter().enumerate() {
            if !emitted.queries.is_blocked(at) {
                add(&mut emitted.added, *k, |c| light[c]);
            }
        }
        let (spectral, queries) = (&mut *emitted.spectral, &emitted.queries);
        for (at, line) in spectral.arriving.drain(..) {
            if !queries.is_blocked(at) {
                spectral.leaving.push((drawn[at].0, line));
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
