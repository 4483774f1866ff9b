//! Rays that continue from surfaces: which points emit them, and in which directions.
//!
//! Directions are sampled according to the material's reflection, and transformed to the world with the clearance that
//! [`paths`](super::paths) derives; points whose paths are shared are chosen as described in [`sharing`](super::sharing).

use super::camera_rays::{LeftTriangle, Rays, Samples};
use super::emitted::{Chosen, Drawn, Emitted, Level};
use super::occlusion::CLEARANCE;
use super::point_columns::Points;
use super::run::{Run, TracedRays};
use super::sharing::{Group, Groups, Sharing, Ungrouped};
use crate::camera::RayOrigin;
use crate::light::reflection::{Scattered, each_by_cosine};
use crate::spacetime::{Direction, Displacement, Rest, World};

/// Purposes of random numbers at a surface, in addition to those of [`paths`](super::paths).
pub(super) const ONWARD: u32 = 2;
pub(super) const CHOICE: u32 = 3;

/// Level `at`, created if missing.
pub(super) fn level(levels: &mut Vec<Level>, at: usize) -> &mut Level {
    if levels.len() <= at {
        levels.resize_with(at + 1, Level::default);
    }
    &mut levels[at]
}

impl Level {
    /// Clears all rays; the next ones have left `depth` surfaces.
    pub(super) fn start(&mut self, depth: u32) {
        self.depth = depth;
        self.drawn.clear();
        self.directions.clear();
        self.origins.clear();
        self.left.clear();
        self.ratios.clear();
        self.wavelengths.clear();
        self.rgb_weights.clear();
        self.pixels.clear();
        self.indices.clear();
        self.shared_from = None;
    }

    /// The rays of the level, traced like those `before` them.
    pub(super) fn rays<'a>(&'a self, before: &TracedRays<'a>) -> Rays<'a> {
        Rays {
            directions: &self.directions,
            origins: Some(&self.origins),
            ratios: &self.ratios,
            moments: &[],
            wavelengths: &self.wavelengths,
            left: &self.left,
            method: before.rays.method,
            samples: Samples {
                pixels: &self.pixels,
                index: before.rays.samples.index,
                indices: &self.indices,
                in_pixel: before.rays.samples.in_pixel,
                depth: self.depth,
                exposure: None,
                cells: None,
            },
        }
    }

    /// Samples a direction at each of the `chosen` points of `run`; those of `groups` come last and are shared.
    pub(super) fn draw_chosen(
        &mut self,
        run: &Run,
        emitted: &mut Emitted,
        chosen: &[Chosen],
        groups: &mut Groups,
    ) {
        let Emitted {
            points,
            keys,
            indices,
            numbers,
            reflections,
            by_cosine,
            normals,
            ..
        } = emitted;
        keys.clear();
        keys.extend(chosen.iter().map(|chosen| chosen.key));
        indices.clear();
        indices.extend(chosen.iter().map(|chosen| chosen.index));
        let samples = &run.traced.rays.samples;
        samples.each_on_path((keys, indices), ONWARD, numbers);
        normals.clear();
        for chosen in chosen {
            normals.push(points.normals.get(chosen.point as usize));
        }
        // For all chosen points in one vector loop; only the diffuse ones use their direction.
        each_by_cosine(normals, numbers, by_cosine);
        let gamma = run.rest.frame.velocity().gamma();
        let add = |level: &mut Level, k: usize, is_shared: bool| {
            let chosen = &chosen[k];
            let point = chosen.point as usize;
            let reflection = &reflections[point];
            let drawn = match reflection.is_diffuse() {
                true => reflection.scattered(by_cosine.get(k)),
                false => reflection.sample([numbers[0][k], numbers[1][k]]),
            };
            // A black point that is chosen still emits a path for points that are not black.
            let shows = |drawn: &Scattered| is_shared || drawn.weight.iter().any(|w| *w > 0.0);
            let Some(scattered) = drawn.filter(shows) else {
                return;
            };
            level.drawn.push(Drawn {
                from: chosen.point,
                frame: run.frame,
                normal: reflection.geometric_normal(),
                cosine: reflection.normal().dot(scattered.l),
                at: chosen.at,
                scattered,
            });
            level.push(point, &scattered, (run, gamma), points);
            level.pixels.push(chosen.key);
            level.indices.push(chosen.index);
        };
        // Points without a group come first in `chosen`, then the points of each group in turn.
        let in_groups: usize = groups.all.iter().map(Group::paths).sum();
        let mut next = chosen.len() - in_groups;
        (0..next).for_each(|k| add(self, k, false));
        self.shared_from = Some(self.drawn.len());
        for group in &mut groups.all {
            let begin = self.drawn.len();
            let end = next + group.paths();
            (next..end).for_each(|k| add(self, k, true));
            (next, group.rays) = (end, begin..self.drawn.len());
        }
    }

    /// Samples a direction at each point of `run`, whose data are in `emitted`; `from` gives the index by which levels refer to a point.
    pub(super) fn draw(&mut self, run: &Run, emitted: &mut Emitted, from: impl Fn(usize) -> u32) {
        let buffers = (&mut emitted.keys, &mut emitted.indices);
        run.each_on_path(ONWARD, buffers, &mut emitted.numbers);
        let Emitted {
            points,
            numbers,
            reflections,
            by_cosine,
            spectral,
            ..
        } = emitted;
        each_by_cosine(&points.normals, numbers, by_cosine);
        let gamma = run.rest.frame.velocity().gamma();
        for (k, reflection) in reflections.iter().enumerate() {
            // Diffuse directions were sampled in a vector loop above, from the same numbers.
            let drawn = match reflection.is_diffuse() {
                true => reflection.scattered(by_cosine.get(k)),
                false => reflection.sample([numbers[0][k], numbers[1][k]]),
            };
            let is_any = |weight: [f64; 3]| weight.iter().any(|w| *w > 0.0);
            // Lines may be reflected even if nothing is reflected at the wavelengths of the sample.
            let in_rgb = |drawn: &Scattered| {
                let of = spectral.in_rgb.get(k);
                of.map(|of| of.weight_of(drawn, reflection))
            };
            let shows =
                |drawn: &Scattered| is_any(drawn.weight) || in_rgb(drawn).is_some_and(is_any);
            let Some(scattered) = drawn.filter(shows) else {
                continue;
            };
            self.rgb_weights.extend(in_rgb(&scattered));
            self.wavelengths.extend(spectral.at(k));
            self.drawn.push(Drawn {
                from: from(k),
                frame: run.frame,
                normal: reflection.geometric_normal(),
                cosine: reflection.normal().dot(scattered.l),
                at: 0,
                scattered,
            });
            self.push(k, &scattered, (run, gamma), points);
            let (samples, ray) = (&run.traced.rays.samples, run.members[k] as usize);
            self.pixels.push(samples.pixel(ray));
            if !samples.indices.is_empty() {
                self.indices.push(samples.index(ray));
            }
        }
    }

    /// Adds the ray from the k-th of `points`, those of `run` in a frame with this γ, along `drawn`.
    fn push(&mut self, k: usize, drawn: &Scattered, (run, gamma): (&Run, f64), points: &Points) {
        let world_from_rest = run.rest.frame.world_from_frame();
        let (d, ratio, delay) = along(run, drawn);
        // From the event of the shot to the point, lifted off its surface.
        let ray = run.members[k] as usize;
        let way = run.traced.rays.origin(ray).displacement + points.offset(k);
        // All coordinates whose rounding moves the point: a boost multiplies those of the world by up to γ.
        let size = gamma * (way.ct.abs() + way.x.abs().max_element())
            + points.eye(k).abs().max_element()
            + points.positions.get(k).abs().max_element();
        let normal = points.geometric(k);
        // Light from beyond a glass surface is traced on the other side.
        let side = match normal.dot(drawn.l) < 0.0 {
            true => -CLEARANCE,
            false => CLEARANCE,
        };
        // At the same time in the rest frame, where the normal is perpendicular to the surface.
        let off = world_from_rest.displacement(Displacement::new(0.0, normal * (side * size)));
        self.directions.push(d.unit());
        self.ratios.push(ratio);
        self.origins.push(RayOrigin {
            displacement: way + off,
            delay,
            weight: 1.0,
        });
        self.left.push(LeftTriangle {
            frame: run.frame,
            slot: points.slots[k],
        });
    }
}

/// Groups the diffuse points of `run`, and chooses those from which paths continue; non-diffuse points come first.
pub(super) fn choose(
    run: &Run,
    emitted: &Emitted,
    sharing: &Sharing,
    groups: &mut Groups,
    chosen: &mut Vec<Chosen>,
) {
    let samples = &run.traced.rays.samples;
    let pixel = |k: usize| samples.pixel(run.members[k] as usize);
    let reflections = &emitted.reflections;
    let normal = |k: usize| {
        let is_diffuse = reflections[k].is_diffuse();
        is_diffuse.then(|| emitted.points.normals.get(k))
    };
    groups.clear();
    // Points of one sample share paths, which are numbered by the sample index.
    let sample = |k: usize| samples.index(run.members[k] as usize);
    let mut begin = 0;
    for members in run
        .members
        .chunk_by(|a, b| samples.index(*a as usize) == samples.index(*b as usize))
    {
        let points = begin..begin + members.len();
        begin = points.end;
        groups.add(Ungrouped {
            points,
            patch: run.patch.first,
            normal,
            pixel,
            in_pixel: samples.in_pixel,
            sharing,
        });
    }
    // Paths continue from all glossy points, and from the chosen points of each group.
    chosen.clear();
    let glossy = (0..run.count()).filter(|k| !reflections[*k].is_diffuse());
    chosen.extend(glossy.map(|k| Chosen {
        point: k as u32,
        at: 0,
        key: pixel(k),
        index: sample(k),
    }));
    for group in &groups.all {
        let points = &groups.order[group.points.clone()];
        let index = sample(points[0] as usize);
        let [number, _] = samples.of_key(group.key, index, CHOICE);
        for (path, at) in group.chosen(number).enumerate() {
            chosen.push(Chosen {
                point: points[at],
                at: at as u32,
                key: group.key,
                index: group.number(index, path),
            });
        }
    }
}

/// The look direction in the world of a ray that continues along `drawn`, ω_world/ω_rest of its light, and the factor on its delay.
fn along(run: &Run, drawn: &Scattered) -> (Direction<World>, f64, f64) {
    let frame = &run.rest.frame;
    let l = Direction::<Rest>::from_unit(drawn.l);
    if drawn.index == 1.0 {
        let (d, ratio) = frame.world_from_frame().direction(l);
        return (d, ratio, 1.0);
    }
    // In glass (−n, l) in its rest frame; rays that all frames share travel one metre of the world at s = 1.
    let index = run.traced.index * drawn.index;
    let tangent = frame.world_from_frame().tangent(index, l);
    let length = tangent.x.length();
    let d = Direction::from_unit(tangent.x / length);
    // Light keeps its frequency in glass: W of surfaces at rest that it hits there is 1.
    let (_, rho) = frame.frame_from_world().direction(d);
    (d, 1.0 / rho, -tangent.ct / (length * run.traced.index))
}
