//! Fragments: what samples see of the triangles that cover them, in the ray tracer's data structures.
//!
//! The position c gives the look direction and the distance. Consecutive samples that see one triangle form a run, which a loop processes
//! with the triangle's functions (`surfaces`).

use glam::DVec3;

use super::draw::{RayBatch, SampleColumns, StripSamples};
use super::surfaces::{Surface, place};
use super::tile::NOTHING;
use super::triangles::Triangles;
use crate::accel::Hit;
use crate::accel::vectors::{BLOCK, VectorLoop, Vectors, dispatch, load, store};
use crate::approximate::projection::Apparent;
use crate::camera::RayOrigin;
use crate::render::trace::{Dependence, SurfaceHit};
use crate::spacetime::{Boost, Direction, Displacement, Rest, World};

/// The number of samples of a run that are computed together, or twice as many in long runs: four f64 fill an AVX2 vector. Most runs of small
/// triangles are not much longer.
const LANES: usize = 4;

/// Consecutive samples that see the same surface.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// Its index, or [`NOTHING`].
    surface: u32,
    begin: usize,
    end: usize,
}

/// The fragments of a strip: what its samples see.
#[derive(Debug, Default)]
pub(super) struct Fragments {
    /// The number of samples. Lists with an entry per sample have room for [`LANES`] more.
    count: usize,
    columns: SampleColumns,
    /// Their points in the tile.
    x: Vec<f64>,
    y: Vec<f64>,
    runs: Vec<Run>,
    /// Positions c, metres.
    c: [Vec<f64>; 3],
    /// Barycentric weights.
    weights: [Vec<f64>; 2],
    /// World distances, metres.
    distances: Vec<f64>,
}

impl Fragments {
    /// Takes over `samples`, and makes room for their rays in `rays` if these will be turned to the fragments.
    pub fn start(&mut self, samples: &StripSamples, needed: Dependence, rays: &mut RayBatch) {
        self.count = samples.strip.samples();
        samples.points(&mut self.columns, [&mut self.x, &mut self.y]);
        for places in [&mut self.x, &mut self.y] {
            places.resize(self.count + LANES, 0.0);
        }
        if needed > Dependence::Patch {
            samples.start(rays);
        }
        self.runs.clear();
    }

    /// The points of the samples.
    pub fn points_mut(&mut self) -> (&mut [f64], &mut [f64]) {
        (&mut self.x[..self.count], &mut self.y[..self.count])
    }

    /// Sets the index of the surface that the next `samples` samples see.
    #[inline(always)]
    pub fn see(&mut self, surface: Option<u32>, samples: usize) {
        let surface = surface.unwrap_or(NOTHING);
        match self.runs.last_mut() {
            Some(last) if last.surface == surface => last.end += samples,
            last => {
                let begin = last.map_or(0, |run| run.end);
                let end = begin + samples;
                self.runs.push(Run {
                    surface,
                    begin,
                    end,
                });
            }
        }
    }

    /// Turns `rays` to the fragments on `surfaces` if these are needed, and records their hits: at the fragments' own emission events, or
    /// at interpolated ones.
    pub fn finish(
        &mut self,
        all: &Triangles,
        samples: &StripSamples,
        surfaces: &[Surface],
        rays: &mut RayBatch,
    ) {
        self.distances.resize(self.count + LANES, 0.0);
        for places in self.c.iter_mut().chain(&mut self.weights) {
            places.resize(self.count + LANES, 0.0);
        }
        if all.needed > Dependence::Patch {
            dispatch(Interpolate {
                runs: &self.runs,
                surfaces,
                points: [&self.x, &self.y],
                c: &mut self.c,
                weights: (all.needed == Dependence::Weights).then_some(&mut self.weights),
            });
        }
        let are_there = all.needed == Dependence::Patch || self.look(all, samples, surfaces, rays);
        self.meet(all, surfaces, rays);
        if !are_there {
            self.remove(samples, surfaces, rays);
        }
        if all.has_interpolated_attributes() {
            self.interpolate(all, samples, surfaces, rays);
        }
    }

    /// Turns the rays to the fragments. Returns whether all are at a distance from the camera.
    fn look(
        &mut self,
        all: &Triangles,
        strip: &StripSamples,
        surfaces: &[Surface],
        rays: &mut RayBatch,
    ) -> bool {
        let mut are_there = true;
        let corner = strip.tile_corner();
        let frame_of = |run: &Run| surfaces.get(run.surface as usize).map(|s| s.frame);
        for runs in self.runs.chunk_by(|a, b| frame_of(a) == frame_of(b)) {
            let (Some(frame), [first, ..], [.., last]) = (frame_of(&runs[0]), runs, runs) else {
                continue;
            };
            let samples = first.begin..last.end;
            let boost = all.frames[frame as usize].frame.frame_from_world();
            let points = [&self.x, &self.y].map(|all| &all[samples.clone()]);
            (all.ratios).fill(boost, points, corner, &mut rays.ratios[samples.clone()]);
            dispatch(Look {
                apparent: all.projections[frame as usize].apparent(),
                boost,
                c: self.c.each_ref().map(|c| &c[samples.clone()]),
                directions: &mut rays.directions[samples.clone()],
                distances: &mut self.distances[samples.clone()],
                ratios: &mut rays.ratios[samples],
                are_there: &mut are_there,
            });
        }
        are_there
    }

    /// Removes the hits at the camera's own position.
    #[cold]
    fn remove(&self, samples: &StripSamples, surfaces: &[Surface], rays: &mut RayBatch) {
        let placed = self.runs.iter();
        let placed = placed.filter(|run| surfaces.get(run.surface as usize).is_some());
        let removed = placed.flat_map(|run| run.begin..run.end);
        let removed = removed.filter(|ray| !is_there(self.distances[*ray]));
        let removed: Vec<_> = removed.collect();
        for ray in &removed {
            samples.look(*ray, rays);
        }
        rays.hits.remove(removed.into_iter());
    }

    /// Records what the rays hit.
    fn meet(&self, all: &Triangles, surfaces: &[Surface], rays: &mut RayBatch) {
        let is_placed = all.needed > Dependence::Patch;
        for run in &self.runs {
            let on_surface = |surface: &Surface, s: f64, [u, v]: [f64; 2]| SurfaceHit {
                hit: Hit {
                    s,
                    u,
                    v,
                    triangle: surface.triangle,
                    slot: surface.slot,
                    front: surface.front,
                },
                frame: surface.frame,
            };
            let surface = match surfaces.get(run.surface as usize) {
                Some(surface) if is_placed => surface,
                found => {
                    let hit = found.map(|surface| on_surface(surface, 0.0, [0.0; 2]));
                    match is_placed {
                        true => rays.hits.push_alike(hit, run.end - run.begin),
                        // The positions of the hits are not needed.
                        false => rays.hits.push_run(hit, run.end - run.begin),
                    }
                    continue;
                }
            };
            let own = run.begin..run.end;
            let distances = &self.distances[own.clone()];
            let weights = self.weights.each_ref().map(|all| &all[own.clone()]);
            (rays.hits).push_places(on_surface(surface, 0.0, [0.0; 2]), distances, weights);
        }
    }

    /// Turns rays to those that hit the fragments at interpolated times, with interpolated W.
    fn interpolate(
        &self,
        all: &Triangles,
        samples: &StripSamples,
        surfaces: &[Surface],
        rays: &mut RayBatch,
    ) {
        let at_shot = RayOrigin {
            delay: samples.index,
            ..RayOrigin::AT_SHOT
        };
        rays.origins.resize(self.count, at_shot);
        for run in &self.runs {
            let known = surfaces.get(run.surface as usize);
            let Some((surface, known)) = known.and_then(|s| Some((s, s.attributes?))) else {
                continue;
            };
            for ray in run.begin..run.end {
                let Some(SurfaceHit { hit, frame }) = rays.hits.hit(ray) else {
                    continue;
                };
                let p = DVec3::new(self.x[ray], self.y[ray], 1.0);
                let p = p * (1.0 / surface.sum.dot(p));
                // With the λ of the head of `raster`: linear functions of the film point over Σ eᵢ·p.
                let [time, w] = known.map(|value| value.dot(p));
                let rest = &all.frames[frame as usize];
                // The point on the triangle relative to the camera, at the interpolated time instead of its retarded one.
                let x = place(rest.bvh.corners(hit.slot), [hit.u, hit.v]);
                let from = x - all.projections[frame as usize].origin();
                let world = rest
                    .frame
                    .world_from_frame()
                    .displacement(Displacement::new(time, from));
                let s = world.x.length();
                if let Some(d) = Direction::new(world.x) {
                    rays.directions[ray] = d.unit();
                    // The time that light would have needed, per metre of its path.
                    rays.origins[ray].delay = -world.ct / s;
                    rays.ratios[ray] = samples.ratio_of(w, frame, d);
                    rays.hits.set_distance(ray, s);
                }
            }
        }
    }
}

/// Whether a point at this distance can be seen: there is no hit at the camera's own position.
#[inline(always)]
fn is_there(s: f64) -> bool {
    (s > 0.0) & (s < f64::INFINITY)
}

/// The loop over runs that computes the positions of fragments on their surfaces.
struct Interpolate<'a> {
    runs: &'a [Run],
    surfaces: &'a [Surface],
    points: [&'a [f64]; 2],
    c: &'a mut [Vec<f64>; 3],
    weights: Option<&'a mut [Vec<f64>; 2]>,
}

impl VectorLoop for Interpolate<'_> {
    #[inline(always)]
    fn run(mut self) {
        for run in self.runs {
            let Some(surface) = self.surfaces.get(run.surface as usize) else {
                continue;
            };
            // The lanes beyond the end of a run belong to the next run, which overwrites them later.
            let mut begin = run.begin;
            while begin < run.end {
                match run.end - begin > LANES {
                    true => self.lanes::<{ 2 * LANES }>(surface, begin),
                    false => self.lanes::<LANES>(surface, begin),
                }
                // A short rest was the last of the run, so the step is the same for both.
                begin += 2 * LANES;
            }
        }
    }
}

impl Interpolate<'_> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self, surface: &Surface, begin: usize) {
        let [x, y] = self.points.map(|all| all[begin..].first_chunk::<N>());
        let (Some(x), Some(y)) = (x.copied(), y.copied()) else {
            return;
        };
        // 1/Σ eᵢ·p, and with it c.
        let (sum, of_c) = (surface.sum, surface.c);
        let mut scale = [0.0; N];
        for k in 0..N {
            scale[k] = 1.0 / (sum.x * x[k] + sum.y * y[k] + sum.z);
        }
        for (c, to) in of_c.iter().zip(&mut *self.c) {
            if let Some(to) = to[begin..].first_chunk_mut::<N>() {
                let mut values = [0.0; N];
                for k in 0..N {
                    values[k] = (c.x * x[k] + c.y * y[k] + c.z) * scale[k];
                }
                *to = values;
            }
        }
        let Some([u, v]) = &mut self.weights else {
            return;
        };
        let both = (u[begin..].first_chunk_mut(), v[begin..].first_chunk_mut());
        let (Some(u), Some(v)): (Option<&mut [f64; N]>, Option<&mut [f64; N]>) = both else {
            return;
        };
        for k in 0..N {
            let p = DVec3::new(x[k], y[k], 1.0) * scale[k];
            [u[k], v[k]] = surface.barycentric(p);
        }
    }
}

/// The loop over fragments of one rest frame.
struct Look<'a> {
    apparent: &'a Apparent,
    boost: &'a Boost<Rest, World>,
    c: [&'a [f64]; 3],
    /// The look directions of the fragments, and their distances.
    directions: &'a mut [DVec3],
    distances: &'a mut [f64],
    /// W of the samples; on return, W that sources at rest in the world would have, from which shading derives the rest.
    ratios: &'a mut [f64],
    /// Set to false if any of them is not there.
    are_there: &'a mut bool,
}

impl VectorLoop for Look<'_> {
    #[inline(always)]
    fn run(self) {
        let count = self.directions.len();
        let boost = *self.boost;
        let is_moving = !boost.is_identity();
        let (mut c, mut d) = (Vectors::ZERO, Vectors::ZERO);
        let (mut lengths, mut distances) = ([0.0; BLOCK], [0.0; BLOCK]);
        let mut rhos = [1.0; BLOCK];
        for begin in (0..count).step_by(BLOCK) {
            let directions = &mut self.directions[begin..count.min(begin + BLOCK)];
            let ratios = &mut self.ratios[begin..count.min(begin + BLOCK)];
            let [x, y, z] = self.c.map(|c| load(c, begin));
            for k in 0..BLOCK {
                c.set(k, DVec3::new(x[k], y[k], z[k]));
            }
            self.apparent
                .look_at(&c, &mut d, [&mut lengths, &mut distances]);
            for (k, direction) in directions.iter_mut().enumerate() {
                *direction = d.get(k);
            }
            store(&distances, self.distances, begin);
            let mut absent = 0;
            for s in &distances[..directions.len()] {
                absent |= u32::from(!is_there(*s));
            }
            *self.are_there &= absent == 0;
            // Shading multiplies by the factor of the fragment's direction.
            if is_moving {
                for (k, rho) in rhos.iter_mut().enumerate() {
                    *rho = boost.direction_of_moving(Direction::from_unit(d.get(k))).1;
                }
                for (ratio, rho) in ratios.iter_mut().zip(&rhos) {
                    *ratio /= rho;
                }
            }
        }
    }
}
