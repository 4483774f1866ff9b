//! Paths shared by several surface points: the light that a path finds at its second surface also falls on neighbours of its first surface.
//!
//! # The estimator
//!
//! If everything rests relative to each other and nothing changes with time, the light L that a diffuse surface reflects at a point y is
//! the same for all observers, at all times. Let x₁ … x_N be points of diffuse surfaces, n their normals and, with d = y − x_k,
//!
//! ```text
//! p_k(y) = (n_k·d) (−n_y·d)/(π d⁴) V(x_k, y),
//! ```
//!
//! the density, per area at y, of a direction sampled by the cosine at x_k; V is 1 if they see each other. M of the N points are chosen, each with the
//! probability q = M/N; a path continues from each of them and finds the light L_i that leaves y_i. All N points receive it: x_j reflects
//!
//! ```text
//! albedo_j Σ_i L_i w_j(y_i),    w_j(y) = p_j(y)/(q Σ_k p_k(y)).                                     (1)
//! ```
//!
//! Averaged over directions, and over the choice of points, this is albedo_j Σ_k q ∫ p_k L p_j/(q Σ p) dA = albedo_j ∫ p_j L dA, all that x_j reflects:
//! the balance heuristic over N ways to find y (Bekaert, Sbert, Halton, "Accelerating path tracing by re-using paths", EGWR 2002), some of which are
//! left out at random. The sum in the denominator is over all N points, chosen or not: otherwise, light that only points that were not chosen see would
//! be lost. For points near one another w is about 1/M: each has the noise of M paths at the cost of M/N of a path and M shadow rays, which all end at
//! one point. w is never above 1/q.
//!
//! The emission of y is shared in the same way. If x_j samples it as a light too (`area_lights`), with the density p_l per area, the light
//! sample has the weight p_l/(p_j + p_l), and (1) has the rest, p_j/(p_j + p_l). Directions that hit nothing but the sky act as points at
//! infinity: p_k is (n_k·l)/π V.
//!
//! # Groups and random numbers
//!
//! A group consists of points of one patch of a tile with similar normals. If these are more than 64, each group takes one of each 2 × 2 pixels, so that
//! neighbours are in different groups and edges of groups do not show. One number in [0, 1) per group decides which points are chosen: the first of every
//! N/M consecutive points, shifted by it. Paths take their other numbers from a sequence of the tile, path by path and group by group, so that the paths
//! that a point receives in all samples fill all directions evenly, and so do those of all points. Points of a group have the noise of the same paths, so
//! their noise is correlated: pictures that are scaled down afterwards, or viewed from afar, keep more of it than of independent noise per pixel. Samples of
//! a texel are means over one place and would gain nothing from sharing.

use std::f64::consts::{FRAC_1_PI, PI};
use std::ops::Range;

use glam::DVec3;

use super::occlusion::{any_hit, any_to_point, shadow_ray, shadow_size, shadow_start};
use crate::accel::vectors::{BLOCK, Block, Columns, VectorLoop, dispatch, load, store};
use crate::accel::{Bvh, Converging, Counts, Ray, Segment, Traversal};

/// The maximum number of points in a group.
pub(super) const MOST: usize = BLOCK;
/// The number of paths that continue from a group, if it has that many points.
const PATHS: usize = 8;
/// The number of samples per pixel whose paths are followed together: with 8 paths for 64 points, 4 samples of a tile of 256 pixels give
/// two whole packets of 64 rays at every surface. Measured in a Cornell box, two samples take 1.07 times as long, one 1.25 times, and eight
/// 0.99 times, with twice the memory.
pub(crate) const AT_ONCE: u32 = 4;

/// How paths are shared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sharing {
    /// The maximum number of points in a group.
    group: usize,
}

impl Sharing {
    /// `all_diffuse` says whether all surfaces are diffuse. Light of other surfaces is not shared, and only goes to the point from which
    /// the path continued: in scenes with such surfaces, a path continues from every point.
    pub fn new(all_diffuse: bool) -> Sharing {
        Sharing {
            group: if all_diffuse { MOST } else { PATHS },
        }
    }
}

/// Points that share paths.
#[derive(Debug)]
pub(super) struct Group {
    /// Their indices in the order of [`Groups`].
    pub points: Range<usize>,
    /// The key of the group's random numbers, and the index of its first one.
    pub key: u64,
    first: u32,
    /// The first rays of the paths that continue from the points.
    pub rays: Range<usize>,
}

impl Group {
    /// The number of points.
    pub fn count(&self) -> usize {
        self.points.len()
    }

    /// The number of paths that continue from the group.
    pub fn paths(&self) -> usize {
        self.count().min(PATHS)
    }

    /// Indices in the group of the points from which paths continue, by a number in [0, 1).
    pub fn chosen(&self, number: f64) -> impl Iterator<Item = usize> + use<> {
        let (count, paths) = (self.count(), self.paths());
        // One point of each stretch of N/M points: every point has the probability q = M/N.
        let step = count as f64 / paths as f64;
        (0..paths).map(move |k| (((k as f64 + number) * step) as usize).min(count - 1))
    }

    /// The index of path `path` of sample `index` in the sequence of the group.
    pub fn number(&self, index: u32, path: usize) -> u32 {
        let number = index.wrapping_mul(PATHS as u32).wrapping_add(path as u32);
        self.first.wrapping_add(number)
    }
}

/// Points by group.
#[derive(Debug, Default)]
pub(super) struct Groups {
    /// The points in groups, group by group.
    pub order: Vec<u32>,
    pub all: Vec<Group>,
    /// The bucket of each point.
    buckets: Vec<u8>,
}

/// Points of a run that are to be grouped.
pub(super) struct Ungrouped<'a, N, P> {
    pub points: Range<usize>,
    /// Identifies their patch.
    pub patch: u32,
    /// The normal of a point; `None` if it shares nothing.
    pub normal: N,
    /// The key of a point's pixel.
    pub pixel: P,
    /// The number of samples per pixel.
    pub in_pixel: u32,
    pub sharing: &'a Sharing,
}

/// Mask for the position of a pixel in a tile.
const IN_TILE: u64 = 15 | 15 << 32;
/// The numbers of interleaved lattices of pixels, and of classes of normals.
const LATTICES: usize = 4;
const CLASSES: usize = 6;
const BUCKETS: usize = LATTICES * CLASSES;
/// The bucket of points without a group.
const ALONE: u8 = BUCKETS as u8;

impl Groups {
    /// Removes all groups.
    pub fn clear(&mut self) {
        self.order.clear();
        self.all.clear();
    }

    /// Adds groups for `some` points.
    pub fn add<N, P>(&mut self, some: Ungrouped<N, P>)
    where
        N: Fn(usize) -> Option<DVec3>,
        P: Fn(usize) -> u64,
    {
        let most = some.sharing.group;
        self.buckets.clear();
        let mut ends = [0usize; BUCKETS + 1];
        for k in some.points.clone() {
            let bucket = (some.normal)(k).map_or(ALONE, |normal| bucket((some.pixel)(k), normal));
            self.buckets.push(bucket);
            ends[bucket as usize] += 1;
        }
        // Find where each bucket begins, then put each point in its place.
        let mut sum = self.order.len();
        for end in &mut ends[..BUCKETS] {
            sum += std::mem::replace(end, sum);
        }
        let begins = ends;
        self.order.resize(sum, 0);
        for (k, bucket) in some.points.clone().zip(&self.buckets) {
            if *bucket != ALONE {
                let place = &mut ends[*bucket as usize];
                self.order[*place] = k as u32;
                *place += 1;
            }
        }
        for class in 0..CLASSES {
            let lattices = class * LATTICES..(class + 1) * LATTICES;
            let all = begins[lattices.start]..ends[lattices.end - 1];
            // A small number of points form one group, whatever their lattices.
            if all.len() <= most {
                self.cut(all, (class, 0), &some);
                continue;
            }
            for (lattice, bucket) in lattices.enumerate() {
                self.cut(begins[bucket]..ends[bucket], (class, lattice), &some);
            }
        }
    }

    /// Splits the points of one bucket into groups.
    fn cut<N, P>(
        &mut self,
        points: Range<usize>,
        (class, lattice): (usize, usize),
        some: &Ungrouped<N, P>,
    ) where
        P: Fn(usize) -> u64,
    {
        let (mut begin, mut part) = (points.start, 0);
        while begin < points.end {
            let points = begin..(begin + some.sharing.group).min(points.end);
            begin = points.end;
            let pixel = (some.pixel)(self.order[points.start] as usize);
            let name = u64::from(some.patch) << 16 | (class as u64) << 12 | part;
            // Odd multiples of a large number differ from each other and from zero in all digits.
            let name = (2 * name + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            // Lattices use different parts of one sequence.
            let room = some.in_pixel.wrapping_mul(PATHS as u32);
            let room = room.checked_next_power_of_two().unwrap_or(0);
            part += 1;
            self.all.push(Group {
                points,
                key: (pixel & !IN_TILE) ^ name,
                first: room.wrapping_mul(lattice as u32),
                rays: 0..0,
            });
        }
    }
}

/// The bucket of a point with this normal.
fn bucket(pixel: u64, normal: DVec3) -> u8 {
    // Of each 2 × 2 pixels, one is on each lattice, assigned at random: regular lattices would be visible.
    let quad = (pixel >> 1 & 0x7fff_ffff | pixel >> 33 << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let chance = (quad ^ quad >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 62;
    let lattice = ((pixel & 1 | (pixel >> 32 & 1) << 1) ^ chance) as u8;
    // Slightly different from a cube aligned with the axes, so that rounding does not decide for faces at 45 degrees.
    let [x, y, z] = normal.to_array();
    let (x, y, z) = (x, y * 1.037, z * 1.019);
    let (axis, sign) = match (x.abs(), y.abs(), z.abs()) {
        (a, b, c) if a >= b && a >= c => (0, x),
        (_, b, c) if b >= c => (1, y),
        _ => (2, z),
    };
    (2 * axis + u8::from(sign < 0.0)) * LATTICES as u8 + lattice
}

/// The end of a shared path.
#[derive(Debug, Clone, Copy)]
pub(super) enum End {
    /// On this triangle.
    On {
        /// Position.
        y: DVec3,
        /// Unit normal, on the side that was hit.
        normal: DVec3,
        /// Index of the triangle.
        triangle: u32,
    },
    /// At infinity, in this direction.
    Open(DVec3),
}

/// The points of a group, and how much each receives of a path.
#[derive(Debug)]
pub(super) struct Receivers {
    positions: Columns,
    normals: Columns,
    /// Normals of the triangles, if shading normals differ; empty otherwise.
    geometric: Columns,
    /// The coordinates that determine where shadow rays from the points start, and the triangles of the points.
    sizes: Vec<f64>,
    triangles: Vec<u32>,
    starts: Vec<f64>,
    segments: Vec<Segment>,
    blocked: Vec<bool>,
    /// By index in the group: p per area at y, or per solid angle; 0 for points that do not see the end.
    pub densities: Block,
    /// w in (1).
    pub weights: Block,
}

impl Default for Receivers {
    fn default() -> Self {
        Receivers {
            positions: Columns::default(),
            normals: Columns::default(),
            geometric: Columns::default(),
            sizes: Vec::new(),
            triangles: Vec::new(),
            starts: Vec::new(),
            segments: Vec::new(),
            blocked: Vec::new(),
            densities: [0.0; BLOCK],
            weights: [0.0; BLOCK],
        }
    }
}

impl Receivers {
    /// Clears the last group.
    pub fn clear(&mut self) {
        self.positions.clear();
        self.normals.clear();
        self.geometric.clear();
        self.sizes.clear();
        self.triangles.clear();
    }

    /// Adds a point that was seen from `eye`.
    pub fn push(&mut self, (x, normal): (DVec3, DVec3), eye: DVec3, triangle: u32) {
        self.positions.push(x);
        self.normals.push(normal);
        self.sizes.push(shadow_size(eye, x));
        self.triangles.push(triangle);
    }

    /// Sets the triangle normal of the point that was added last, if its shading normal differs.
    pub fn push_geometric(&mut self, normal: DVec3) {
        self.geometric.push(normal);
    }

    /// Positions, normals of the triangles, and the offsets by which the points are lifted.
    pub fn places(&self) -> (&Columns, &Columns, &[f64]) {
        let normals = match self.geometric.len() {
            0 => &self.normals,
            _ => &self.geometric,
        };
        (&self.positions, normals, &self.sizes)
    }

    /// Computes how much each point receives of a path that point `own` has sent to `end`; `paths` paths continue from the group.
    pub fn find(
        &mut self,
        end: End,
        (own, paths): (usize, usize),
        bvh: &Bvh,
        method: Traversal,
        counts: Option<&mut Counts>,
    ) {
        let count = self.positions.len().min(BLOCK);
        dispatch(Densities {
            positions: &self.positions,
            normals: &self.normals,
            end,
            densities: &mut self.densities,
        });
        self.densities[count..].fill(0.0);
        // Directions below a surface are never sampled.
        for k in 0..self.geometric.len().min(count) {
            let d = match end {
                End::On { y, .. } => y - self.positions.get(k),
                End::Open(l) => l,
            };
            if self.geometric.get(k).dot(d) <= 0.0 {
                self.densities[k] = 0.0;
            }
        }
        // Usually all points may see the end, and all are tested without selection, including point `own`, which does see it.
        let mut others = self.densities[..count].iter().enumerate();
        if others.any(|(at, density)| *density > 0.0 && at != own) {
            match end {
                End::On {
                    y,
                    normal,
                    triangle,
                } => self.test_towards((y, normal, triangle), own, bvh, method, counts),
                End::Open(l) => self.test_along(l, bvh, method, counts),
            }
            for (at, (density, is_blocked)) in
                self.densities.iter_mut().zip(&self.blocked).enumerate()
            {
                *density = if *is_blocked & (at != own) {
                    0.0
                } else {
                    *density
                };
            }
        }
        dispatch(Weights {
            densities: &self.densities,
            // (1), with q = M/N.
            points_per_path: count as f64 / paths as f64,
            weights: &mut self.weights,
        });
    }

    /// Tests for obstacles between the points and y, slightly off its surface like the paths that leave it.
    fn test_towards(
        &mut self,
        (y, normal, triangle): (DVec3, DVec3, u32),
        own: usize,
        bvh: &Bvh,
        method: Traversal,
        counts: Option<&mut Counts>,
    ) {
        let off = shadow_ray(self.positions.get(own), y, normal).s_min;
        let end = y + normal * off;
        self.starts.resize(self.sizes.len(), 0.0);
        dispatch(StartsTowards {
            positions: &self.positions,
            sizes: &self.sizes,
            end,
            starts: &mut self.starts,
        });
        let segments = Converging {
            end,
            from: self.positions.axes(),
            s_min: &self.starts,
            skip: &self.triangles,
            at: Some(triangle),
        };
        any_to_point(bvh, method, segments, &mut self.blocked, counts);
    }

    /// Tests for obstacles along `l`.
    fn test_along(&mut self, l: DVec3, bvh: &Bvh, method: Traversal, counts: Option<&mut Counts>) {
        self.segments.clear();
        for (at, size) in self.sizes.iter().enumerate() {
            self.segments.push(Segment {
                ray: Ray {
                    origin: self.positions.get(at),
                    direction: l,
                    s_min: shadow_start(*size, l),
                },
                s_max: f64::INFINITY,
                skip: Some(self.triangles[at]),
                end: None,
            });
        }
        any_hit(bvh, method, &self.segments, &mut self.blocked, counts);
    }
}

/// The loop that computes start parameters of shadow rays from the points of a group to `end`.
struct StartsTowards<'a> {
    positions: &'a Columns,
    sizes: &'a [f64],
    end: DVec3,
    starts: &'a mut [f64],
}

impl VectorLoop for StartsTowards<'_> {
    #[inline(always)]
    fn run(self) {
        let (positions, sizes) = (self.positions.block(0), load(self.sizes, 0));
        let mut starts = [0.0; BLOCK];
        for (k, start) in starts.iter_mut().enumerate() {
            *start = shadow_start(sizes[k], self.end - positions.get(k));
        }
        store(&starts, self.starts, 0);
    }
}

/// The loop that computes w of (1) from p: 0 for all points if Σ p is NaN or infinite, or if it is 0.
struct Weights<'a> {
    densities: &'a Block,
    points_per_path: f64,
    weights: &'a mut Block,
}

impl VectorLoop for Weights<'_> {
    #[inline(always)]
    fn run(self) {
        // Eight partial sums, then their sum: the order in which vectors of any width add.
        const SUMS: usize = 8;
        let mut sums = [0.0; SUMS];
        let mut begin = 0;
        while begin < BLOCK {
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += self.densities[begin + k];
            }
            begin += SUMS;
        }
        let [a, b, c, d, e, f, g, h] = sums;
        let sum = ((a + b) + (c + d)) + ((e + f) + (g + h));
        // w = p (N/M)/Σ p.
        let factor = self.points_per_path / sum;
        // NaN becomes 0, too.
        let factor = match factor > 0.0 && factor.is_finite() {
            true => factor,
            false => 0.0,
        };
        for k in 0..BLOCK {
            self.weights[k] = self.densities[k] * factor;
        }
    }
}

/// The loop that computes p of all points of a group, with V = 1; 0 if a point and the end do not face each other.
struct Densities<'a> {
    positions: &'a Columns,
    normals: &'a Columns,
    end: End,
    densities: &'a mut Block,
}

impl VectorLoop for Densities<'_> {
    #[inline(always)]
    fn run(self) {
        let (positions, normals) = (self.positions.block(0), self.normals.block(0));
        match self.end {
            End::On { y, normal, .. } => {
                for (k, density) in self.densities.iter_mut().enumerate() {
                    let d = y - positions.get(k);
                    let (cosine, there) = (normals.get(k).dot(d), -normal.dot(d));
                    let square = d.dot(d);
                    let p = cosine * there / (PI * square * square);
                    // NaN, if both are the same point, becomes 0 too.
                    let faces = (cosine > 0.0) & (there > 0.0) & (p > 0.0);
                    *density = if faces { p } else { 0.0 };
                }
            }
            End::Open(l) => {
                for (k, density) in self.densities.iter_mut().enumerate() {
                    let p = normals.get(k).dot(l) * FRAC_1_PI;
                    *density = if p > 0.0 { p } else { 0.0 };
                }
            }
        }
    }
}
