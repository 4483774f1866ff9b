//! Samples of area lights, in arrays: for each point of a run a triangle chosen by a [`LightTree`] and a point on it, uniform in solid
//! angle if it appears large, otherwise in area.

use glam::DVec3;

use super::light_tree::{LightTree, Receivers};
use super::occlusion::{lifted, shadow_end};
use super::spherical_triangle::Triangle;
use crate::accel::sincos::sincos_each;
use crate::accel::vectors::{BLOCK, Block, Columns, VectorLoop, Vectors, load};
use crate::spacetime::{Boost, Direction, Rest, World, unit_and_length_or_nan};

/// Samples of area lights at the points of a run: for each point, one sample of all elements.
#[derive(Debug, Default)]
pub(super) struct AreaDraws {
    /// The index of the shining frame, if there are several, and the probability of choosing it.
    pub frames: Vec<u32>,
    pub shares: Vec<f64>,
    /// For each shining frame, the points in its coordinates.
    pub seen: Vec<SeenPoints>,
    /// The points for which the current frame is chosen.
    pub chosen: Vec<u32>,
    /// The element.
    pub elements: Vec<u32>,
    /// Barycentrics of the sampled point.
    pub u: Vec<f64>,
    pub v: Vec<f64>,
    /// The direction to that point in the rest frame of the point that is lit, and in the world.
    pub l: Columns,
    pub d: Columns,
    /// The length of the shadow ray, metres of the world: up to [`shadow_end`].
    pub distances: Vec<f64>,
    /// W.
    pub ratios: Vec<f64>,
    /// cos θ_F over the density per solid angle of the element's frame; 0 if no light arrives.
    pub factors: Vec<f64>,
    /// Density per solid angle in the rest frame of the point that is lit.
    pub densities: Vec<f64>,
}

/// The points of a run in a frame; see [`Receiver`](super::light_tree::Receiver).
#[derive(Debug, Default)]
pub(super) struct SeenPoints {
    pub x: Columns,
    pub normals: Columns,
    pub tilts: Vec<f64>,
    /// The magnitudes of the coordinates that determine the rounding errors of `x`.
    pub sizes: Vec<f64>,
}

impl AreaDraws {
    /// Makes room for `count` points.
    pub fn resize(&mut self, count: usize) {
        self.l.resize(count);
        self.d.resize(count);
        self.frames.resize(count, 0);
        self.elements.resize(count, 0);
        self.shares.resize(count, 1.0);
        for numbers in [
            &mut self.u,
            &mut self.v,
            &mut self.distances,
            &mut self.ratios,
            &mut self.factors,
            &mut self.densities,
        ] {
            numbers.resize(count, 0.0);
        }
    }
}

/// The loop over the points for which one frame is chosen.
pub(super) struct Draws<'a> {
    pub tree: &'a LightTree,
    /// The tree's first triangle, in the numbering of all elements.
    pub first: u32,
    pub to_world: &'a Boost<World, Rest>,
    /// As for [`shadow_end`].
    pub stretch: f64,
    /// `None` if no boost is needed.
    pub from_world: Option<&'a Boost<Rest, World>>,
    /// The points in the frame.
    pub seen: &'a SeenPoints,
    /// Normals in the rest frame of the points.
    pub normals: &'a Columns,
    /// What is left of the first of two random numbers, and the second.
    pub numbers: &'a [Vec<f64>; 2],
    pub draws: &'a mut AreaDraws,
}

/// Several triangles in arrays.
struct Triangles {
    corner: Vectors,
    edges: [Vectors; 2],
    normal: Vectors,
    twice: Block,
    /// 1 or 0.
    two_sided: Block,
}

impl Triangles {
    const NONE: Triangles = Triangles {
        corner: Vectors::ZERO,
        edges: [Vectors::ZERO; 2],
        normal: Vectors::ZERO,
        twice: [1.0; BLOCK],
        two_sided: [0.0; BLOCK],
    };

    #[inline(always)]
    fn set(&mut self, lane: usize, triangle: &Triangle, two_sided: bool) {
        self.corner.set(lane, triangle.corner);
        self.edges[0].set(lane, triangle.edges[0]);
        self.edges[1].set(lane, triangle.edges[1]);
        self.normal.set(lane, triangle.normal);
        self.twice[lane] = triangle.twice;
        self.two_sided[lane] = if two_sided { 1.0 } else { 0.0 };
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Triangle {
        Triangle {
            corner: self.corner.get(k),
            edges: [self.edges[0].get(k), self.edges[1].get(k)],
            normal: self.normal.get(k),
            twice: self.twice[k],
        }
    }
}

impl VectorLoop for Draws<'_> {
    #[inline(always)]
    fn run(self) {
        let Draws {
            tree,
            first,
            to_world,
            stretch,
            from_world,
            seen,
            normals,
            numbers,
            draws,
        } = self;
        let mut begin = 0;
        while begin < draws.chosen.len() {
            // Load a block of points and their random numbers.
            let count = (draws.chosen.len() - begin).min(BLOCK);
            let mut receivers = Receivers {
                x: Vectors::ZERO,
                normal: Vectors::ZERO,
                tilt: [0.0; BLOCK],
            };
            let mut facing = Vectors::ZERO;
            let (mut x, mut y, mut sizes) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
            let mut lane = 0;
            while lane < count {
                let k = draws.chosen[begin + lane] as usize;
                receivers.x.set(lane, seen.x.get(k));
                receivers.normal.set(lane, seen.normals.get(k));
                receivers.tilt[lane] = seen.tilts[k];
                facing.set(lane, normals.get(k));
                (x[lane], y[lane]) = (numbers[0][k], numbers[1][k]);
                sizes[lane] = seen.sizes[k];
                lane += 1;
            }

            // Choose an element for each.
            let (mut chosen, mut shares) = ([0; BLOCK], [0.0; BLOCK]);
            tree.choose_each(&receivers, count, &mut x, (&mut chosen, &mut shares));
            let mut triangles = Triangles::NONE;
            let (mut wide, mut any_wide) = ([false; BLOCK], false);
            let mut lane = 0;
            while lane < count {
                let shining = tree.shining(chosen[lane]);
                triangles.set(lane, &shining.triangle, shining.two_sided);
                wide[lane] = tree.is_wide(chosen[lane], receivers.x.get(lane));
                any_wide |= wide[lane];
                shares[lane] *= draws.shares[draws.chosen[begin + lane] as usize];
                lane += 1;
            }

            // Sample a point on each, with what is left of the number that chose the element.
            let (mut us, mut vs) = ([0.0; BLOCK], [0.0; BLOCK]);
            for k in 0..BLOCK {
                (us[k], vs[k]) = Triangle::draw_by_area([x[k], y[k]]);
            }
            let mut halves = [1.0; BLOCK];
            if any_wide {
                let mut angles = [0.0; BLOCK];
                for k in 0..BLOCK {
                    let triangle = triangles.get(k);
                    halves[k] = triangle.half_angle(receivers.x.get(k), triangles.two_sided[k]);
                    angles[k] = x[k] * halves[k];
                }
                let (mut sines, mut cosines) = ([0.0; BLOCK], [0.0; BLOCK]);
                sincos_each(&angles, &mut sines, &mut cosines);
                for k in 0..BLOCK {
                    let angle = (sines[k], cosines[k]);
                    let triangle = triangles.get(k);
                    let (u, v) = triangle.draw_by_angle(receivers.x.get(k), angle, y[k]);
                    us[k] = if wide[k] { u } else { us[k] };
                    vs[k] = if wide[k] { v } else { vs[k] };
                }
            }

            let (mut ls, mut ds) = (Vectors::ZERO, Vectors::ZERO);
            let (mut distances, mut ratios) = ([0.0; BLOCK], [0.0; BLOCK]);
            let (mut factors, mut densities) = ([0.0; BLOCK], [0.0; BLOCK]);
            for k in 0..BLOCK {
                // k in G, the frame in which the element rests.
                let triangle = triangles.get(k);
                let place = triangle.at((us[k], vs[k]));
                let (in_light, distance) = unit_and_length_or_nan(place - receivers.x.get(k));
                let cosine_there = -triangle.normal.dot(in_light) / triangle.twice;
                let opposite = -cosine_there * triangles.two_sided[k];
                let cosine_there = if cosine_there > opposite {
                    cosine_there
                } else {
                    opposite
                };
                // Directions to it in the world and in F, with ω_G/ω_world = 1/ratio.
                let (d, ratio) = to_world.direction(Direction::from_unit(in_light));
                let (l, rho) = match from_world {
                    Some(boost) => boost.direction(d),
                    None => (Direction::from_unit(d.unit()), 1.0),
                };
                let cosine = facing.get(k).dot(l.unit());
                let w = 1.0 / (ratio * rho);
                // Per solid angle of G: p_A r_G²/cos θ_y, or one over Ω = 2 h, times the share of the triangle.
                let by_area = shares[k] / triangle.area() * (distance * distance) / cosine_there;
                let by_angle = shares[k] / (2.0 * halves[k]);
                let density = if wide[k] { by_angle } else { by_area };
                ls.set(k, l.unit());
                ds.set(k, d.unit());
                distances[k] = shadow_end([distance, cosine_there], [sizes[k], stretch]) * ratio;
                ratios[k] = w;
                // False for NaN too, if the point is on the element.
                let falls = (cosine_there > 0.0) & (cosine > 0.0) & (density > 0.0);
                factors[k] = if falls { cosine / density } else { 0.0 };
                // Per solid angle of F: dω_F = W² dω_G.
                densities[k] = density / (w * w);
            }

            let mut lane = 0;
            while lane < count {
                let k = draws.chosen[begin + lane] as usize;
                draws.elements[k] = first + chosen[lane];
                (draws.u[k], draws.v[k]) = (us[lane], vs[lane]);
                draws.l.set(k, ls.get(lane));
                draws.d.set(k, ds.get(lane));
                draws.distances[k] = distances[lane];
                draws.ratios[k] = ratios[lane];
                draws.factors[k] = factors[lane];
                draws.densities[k] = densities[lane];
                lane += 1;
            }
            begin += BLOCK;
        }
    }
}

/// Densities per area with which points of one frame sample a given place on a triangle.
pub(super) struct DensitiesAt<'a> {
    pub tree: &'a LightTree,
    /// The triangle, and the place on it.
    pub triangle: u32,
    pub y: DVec3,
    /// Positions of the points, normals of their triangles, and the offsets by which they are lifted.
    pub points: (&'a Columns, &'a Columns, &'a [f64]),
    pub densities: &'a mut Block,
}

impl VectorLoop for DensitiesAt<'_> {
    #[inline(always)]
    fn run(self) {
        let (positions, normals, sizes) = self.points;
        let (positions, sizes) = (positions.load(0), load(sizes, 0));
        let mut receivers = Receivers {
            x: Vectors::ZERO,
            normal: normals.load(0),
            tilt: [0.0; BLOCK],
        };
        for (k, size) in sizes.iter().enumerate() {
            let x = lifted(*size, positions.get(k), receivers.normal.get(k));
            receivers.x.set(k, x);
        }
        let mut shares = [0.0; BLOCK];
        self.tree.shares(self.triangle, &receivers, &mut shares);
        let shining = *self.tree.shining(self.triangle);
        let (triangle, y) = (shining.triangle, self.y);
        let two_sided = if shining.two_sided { 1.0 } else { 0.0 };
        for (k, density) in self.densities.iter_mut().enumerate() {
            let x = receivers.x.get(k);
            let half = triangle.half_angle(x, two_sided);
            let (l, distance) = unit_and_length_or_nan(y - x);
            let cosine = triangle.normal.dot(l).abs() / triangle.twice;
            let by_angle = shares[k] / (2.0 * half) * cosine / (distance * distance);
            let by_area = shares[k] / triangle.area();
            let is_wide = self.tree.is_wide(self.triangle, x);
            let by_both = if is_wide { by_angle } else { by_area };
            // NaN, for points on the triangle, becomes 0 too.
            *density = if by_both > 0.0 { by_both } else { 0.0 };
        }
    }
}
