//! Shining triangles, by rest frame, and sampling of a point on them for a point that they light.
//!
//! First a frame is chosen by the importances of the roots of the frames' trees, I in (1) of [`light_tree`](super::light_tree), times W⁻⁴ for energies towards
//! the middle of the tree, W² for solid angles, and the W that κ leaves out. Then a triangle of that frame is chosen by its tree, and a point on it, uniform in
//! solid angle or in area, as described in [`spherical_triangle`](super::spherical_triangle). The first of two random numbers makes all choices; what is left
//! of it and the second sample the point. The density with which a point is sampled is computed by the same functions.

use glam::DVec3;

use super::area_draws::{AreaDraws, DensitiesAt, Draws, SeenPoints};
use super::emitted::Emitted;
use super::light_tree::{Density, LightTree, Receiver, Shining, choose};
use super::occlusion::{lifted, shadow_size};
use super::point_columns::Points;
use super::run::Run;
use super::spherical_triangle::Triangle;
use super::surface_point::SurfacePoint;
use super::surfaces::Surfaces;
use crate::accel::vectors::{Block, Columns, dispatch};
use crate::spacetime::{Displacement, Rest};

/// Shining triangles, by rest frame.
#[derive(Debug)]
pub(super) struct ShiningFrames(Vec<FrameLights>);

/// The shining triangles of one rest frame.
#[derive(Debug)]
struct FrameLights {
    frame: u32,
    /// The index of the first of them among all frames.
    first: u32,
    /// Their indices in the frame's BVH, ascending.
    triangles: Vec<u32>,
    tree: LightTree,
}

/// A sampled point.
pub(super) struct DrawnPlace<'a> {
    /// The index of the triangle among all frames.
    pub element: u32,
    pub triangle: &'a Triangle,
    /// Barycentrics.
    pub place: (f64, f64),
    pub density: Density,
}

impl ShiningFrames {
    /// `all`: frame, index in the frame's BVH, and triangle, in ascending order.
    pub fn new(all: &[(u32, u32, Shining)]) -> ShiningFrames {
        let mut first = 0;
        let frames = all.chunk_by(|a, b| a.0 == b.0).map(|of_frame| {
            let lights = FrameLights {
                frame: of_frame[0].0,
                first,
                triangles: of_frame.iter().map(|(_, triangle, _)| *triangle).collect(),
                tree: LightTree::new(of_frame.iter().map(|(.., shining)| *shining).collect()),
            };
            first += of_frame.len() as u32;
            lights
        });
        ShiningFrames(frames.collect())
    }

    /// Samples one point of all elements for each point of `run`, using `emitted.numbers`.
    pub fn draw(&self, run: &Run, emitted: &mut Emitted) {
        let Emitted {
            points,
            numbers,
            draws,
            ..
        } = emitted;
        let surfaces = run.traced.surfaces;
        draws.resize(run.count());
        self.look(run, points, draws);
        self.choose_frames(run, &mut numbers[0], draws);
        // Frame by frame, for the points that have chosen it.
        let mut seen = std::mem::take(&mut draws.seen);
        for (at, (lights, seen)) in self.0.iter().zip(&seen).enumerate() {
            draws.chosen.clear();
            let all = draws.frames.iter().enumerate();
            let chosen = all.filter(|(_, frame)| **frame == at as u32);
            let frame = &surfaces.rest(lights.frame).frame;
            let gamma = frame.velocity().gamma();
            draws.chosen.extend(chosen.map(|(k, _)| k as u32));
            dispatch(Draws {
                tree: &lights.tree,
                first: lights.first,
                to_world: frame.world_from_frame(),
                stretch: 2.0 * gamma * gamma - 1.0,
                from_world: surfaces.boost(run.frame),
                seen,
                normals: &points.normals,
                numbers,
                draws,
            });
        }
        std::mem::swap(&mut draws.seen, &mut seen);
        // Light from below a triangle does not count, whatever the shading normal.
        if points.is_smooth() {
            for k in 0..run.count() {
                if points.is_below(k, draws.l.get(k)) {
                    draws.factors[k] = 0.0;
                }
            }
        }
    }

    /// Computes how the points of `run` appear in the shining frames.
    fn look(&self, run: &Run, points: &Points, draws: &mut AreaDraws) {
        let surfaces = run.traced.surfaces;
        draws.seen.resize_with(self.0.len(), SeenPoints::default);
        for (lights, seen) in self.0.iter().zip(&mut draws.seen) {
            let is_own = surfaces.shares_places(lights.frame, run.frame);
            seen.x.resize(run.count());
            seen.normals.resize(run.count());
            seen.tilts.resize(run.count(), 0.0);
            seen.sizes.resize(run.count(), 0.0);
            for k in 0..run.count() {
                let (own, normal) = (points.positions.get(k), points.geometric(k));
                // Only a point at rest with the triangles is lifted off its surface.
                let (receiver, size) = if is_own {
                    let size = shadow_size(points.eye(k), own);
                    (at_rest(lifted(size, own, normal), normal), size)
                } else {
                    let place = |point: &SurfacePoint| {
                        let x = surfaces.event(lights.frame, point).x;
                        (x, shadow_size(surfaces.origin(lights.frame, point), x))
                    };
                    let place = run.point(k).as_ref().map(place);
                    let (x, size) = place.unwrap_or((DVec3::NAN, f64::NAN));
                    let receiver = receiver(surfaces, (run.frame, normal), lights.frame, x);
                    (receiver, size)
                };
                seen.x.set(k, receiver.x);
                seen.normals.set(k, receiver.normal);
                (seen.tilts[k], seen.sizes[k]) = (receiver.tilt, size);
            }
        }
    }

    /// Chooses a frame for each point of `run`, and replaces each number by what is left of it.
    fn choose_frames(&self, run: &Run, numbers: &mut [f64], draws: &mut AreaDraws) {
        draws.frames.clear();
        draws.frames.resize(run.count(), 0);
        draws.shares.clear();
        draws.shares.resize(run.count(), 1.0);
        if self.0.len() == 1 {
            return;
        }
        let motions: Vec<_> = (self.0.iter())
            .map(|lights| motion(run.traced.surfaces, run.frame, lights.frame))
            .collect();
        let mut importances = Vec::with_capacity(self.0.len());
        for (k, number) in numbers.iter_mut().enumerate() {
            let all = self.0.iter().zip(&motions).zip(&draws.seen);
            importances.clear();
            importances.extend(all.map(|((lights, motion), seen)| {
                let receiver = Receiver {
                    x: seen.x.get(k),
                    normal: seen.normals.get(k),
                    tilt: seen.tilts[k],
                };
                lights.importance(&receiver, motion)
            }));
            let chosen = choose(*number, &importances);
            let (at, share, rest) = chosen.unwrap_or_default();
            (draws.frames[k], draws.shares[k]) = (at as u32, share);
            *number = rest;
        }
    }

    /// Samples a point with two numbers in [0, 1), for a lifted point in the only rest frame and the normal of its triangle.
    pub fn draw_one(
        &self,
        (x, normal): (DVec3, DVec3),
        [first, second]: [f64; 2],
    ) -> DrawnPlace<'_> {
        let tree = &self.0[0].tree;
        let choice = tree.choose(&at_rest(x, normal), first);
        DrawnPlace {
            element: choice.triangle,
            triangle: &tree.shining(choice.triangle).triangle,
            place: tree.draw(&choice, x, second),
            density: tree.density(choice.triangle, choice.share, x),
        }
    }

    /// The lights of a frame, and the index of a triangle among them, if it is one of them.
    fn find(&self, frame: u32, triangle: u32) -> Option<(&FrameLights, u32)> {
        let at = self.0.binary_search_by_key(&frame, |lights| lights.frame);
        let lights = &self.0[at.ok()?];
        let k = lights.triangles.binary_search(&triangle).ok()?;
        Some((lights, k as u32))
    }

    /// The index and the density of `point`, if it is on a shining triangle. `from` is the rest frame and the normal of the triangle from which the ray
    /// came that hit it.
    pub fn density(
        &self,
        surfaces: &Surfaces,
        point: &SurfacePoint,
        from: (u32, DVec3),
    ) -> Option<(u32, Density)> {
        let (lights, k) = self.find(point.frame, point.hit.triangle)?;
        let seen_by = |lights: &FrameLights| {
            let x = surfaces.origin(lights.frame, point);
            receiver(surfaces, from, lights.frame, x)
        };
        let own = seen_by(lights);
        let mut share = lights.tree.share(k, &own);
        // Times the probability of the frame, as in `choose_frames`.
        if self.0.len() > 1 {
            let importance = |lights: &FrameLights| {
                let motion = motion(surfaces, from.0, lights.frame);
                lights.importance(&seen_by(lights), &motion)
            };
            let sum: f64 = self.0.iter().map(importance).sum();
            let own = importance(lights);
            share *= if own > 0.0 { own / sum } else { 0.0 };
        }
        Some((lights.first + k, lights.tree.density(k, share, own.x)))
    }

    /// The same for a point on a triangle of the only rest frame, for a ray from x on a triangle with this normal.
    pub fn density_at(&self, triangle: u32, (x, normal): (DVec3, DVec3)) -> Option<(u32, Density)> {
        let (lights, k) = self.find(0, triangle)?;
        let share = lights.tree.share(k, &at_rest(x, normal));
        Some((k, lights.tree.density(k, share, x)))
    }

    /// The same per area at `y`, for a block of points, given the normals of their triangles and the offsets by which they are lifted.
    pub fn densities_at(
        &self,
        triangle: u32,
        y: DVec3,
        points: (&Columns, &Columns, &[f64]),
        densities: &mut Block,
    ) -> Option<u32> {
        let (lights, triangle) = self.find(0, triangle)?;
        dispatch(DensitiesAt {
            tree: &lights.tree,
            triangle,
            y,
            points,
            densities,
        });
        Some(triangle)
    }
}

impl FrameLights {
    /// The approximate light from these triangles at a receiver whose frame has this motion in theirs.
    fn importance(&self, receiver: &Receiver, motion: &Displacement<Rest>) -> f64 {
        let (importance, l) = self.tree.importance(receiver);
        // W⁻⁴ W² W = 1/W towards the middle; NaN if the receiver is at the middle.
        let inverse = motion.ct + motion.x.dot(l);
        importance * if inverse > 0.0 { inverse } else { 1.0 }
    }
}

/// A receiver at rest in the frame of the shining triangles.
fn at_rest(x: DVec3, normal: DVec3) -> Receiver {
    Receiver {
        x,
        normal,
        tilt: 0.0,
    }
}

/// The receiver in rest frame `to`, at position `x` there, with normal `normal` in rest frame `from`.
fn receiver(surfaces: &Surfaces, (from, normal): (u32, DVec3), to: u32, x: DVec3) -> Receiver {
    if surfaces.shares_places(to, from) {
        return at_rest(x, normal);
    }
    let seen = surfaces.displacement(from, to, Displacement::new(0.0, normal));
    let gamma = |frame| surfaces.rest(frame).frame.velocity().gamma();
    // A bound on the rounding errors of both boosts.
    let rounding = 16.0 * f64::EPSILON * gamma(from) * gamma(to);
    Receiver {
        x,
        normal: seen.x,
        tilt: seen.ct + rounding,
    }
}

/// The four-velocity of rest frame `from` in rest frame `to`.
fn motion(surfaces: &Surfaces, from: u32, to: u32) -> Displacement<Rest> {
    surfaces.displacement(from, to, Displacement::new(1.0, DVec3::ZERO))
}
