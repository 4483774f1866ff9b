//! Paths shared by several surface points: what a path finds at its second surface also lights the first surfaces of its neighbours.
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
//! the density, per area at y, of a direction that is drawn with the cosine at x_k; V is 1 where they see each other. M of the N points are chosen, each with
//! the probability q = M/N; a path goes on from each of them and finds the light L_i that leaves y_i. All N points receive it: x_j
//!
//! ```text
//! albedo_j Σ_i L_i w_j(y_i),    w_j(y) = p_j(y)/(q Σ_k p_k(y)).                                     (1)
//! ```
//!
//! The mean of that over directions, and over what is chosen, is albedo_j Σ_k q ∫ p_k L p_j/(q Σ p) dA = albedo_j ∫ p_j L dA, what x_j reflects of all:
//! the balance heuristic over N ways to find y (Bekaert, Sbert, Halton, "Accelerating path tracing by re-using paths", EGWR 2002), of which
//! some are left out at random. The sum in the denominator is over all N, chosen or not, or what only points that were not chosen see would be lost.
//! For points near one another w is about 1/M: each has the noise of M paths at the cost of M/N of a path and M shadow rays, which all end in
//! one point. No w is above 1/q.
//!
//! What y shines of its own is shared likewise; where x_j draws it as a light too (`area_lights`), with the density p_l per area, that counts for p_l/(p_j + p_l) there,
//! and (1) for the rest, p_j/(p_j + p_l). Directions that meet nothing but the sky are as points at infinity: p_k is (n_k·l)/π V.
//!
//! # Its numbers
//!
//! Groups are made of the points of one patch of a tile whose normals are alike: where they are more than 64, of one of
//! each 2 × 2 pixels, so that neighbours are in different groups and edges of groups do not show. Which are
//! chosen is decided by one number in [0, 1) of the group: the first of every N/M points in a row, moved by it. Paths take their other numbers from a
//! sequence of the tile, path by path and group after group, so that those that a point receives in all samples fill all directions evenly, and so do
//! those of all points. The noise of points of a group is that of the same paths, and so correlated: pictures that are made smaller afterwards, or looked at
//! from afar, keep more of it than of noise of their pixels' own. Samples of a texel are means over one place, and would gain nothing by it.

use std::f64::consts::{FRAC_1_PI, PI};
use std::ops::Range;

use glam::DVec3;

use super::occlusion::{any_hit, any_to_point, shadow_ray, shadow_size, shadow_start};
use crate::accel::vectors::{BLOCK, Block, Columns, VectorLoop, dispatch, load, store};
use crate::accel::{Bvh, Converging, Counts, Ray, Segment, Traversal};

/// Most points of a group.
pub(super) const MOST: usize = BLOCK;
/// Paths that go on from a group, if it has as many points.
const PATHS: usize = 8;
/// Samples of a pixel whose paths are followed together: where 8 paths go on from 64 points, those of 4 samples of a tile of 256 pixels are
/// two whole packets of 64 rays at every surface. Measured in a Cornell box, two take 1.07 times as long, one by one 1.25 times, and eight
/// 0.99 times, with twice the memory.
pub(crate) const AT_ONCE: u32 = 4;

/// How paths are shared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sharing {
    /// Most points of a group.
    group: usize,
}

impl Sharing {
    /// `all_diffuse`: whether all surfaces are. Light of others is not shared, and is found by the point alone from which a path goes on:
    /// then one goes on from all.
    pub fn new(all_diffuse: bool) -> Sharing {
        Sharing {
            group: if all_diffuse { MOST } else { PATHS },
        }
    }
}

/// Points that share paths.
#[derive(Debug)]
pub(super) struct Group {
    /// Their places in the order of [`Groups`].
    pub points: Range<usize>,
    /// What random numbers come from, and where its own begin among them.
    pub key: u64,
    first: u32,
    /// The paths that go on from them, by the rays that begin them.
    pub rays: Range<usize>,
}

impl Group {
    /// How many points.
    pub fn count(&self) -> usize {
        self.points.len()
    }

    /// How many paths go on from it.
    pub fn paths(&self) -> usize {
        self.count().min(PATHS)
    }

    /// Places in the group of the points from which paths go on, by a number in [0, 1).
    pub fn chosen(&self, number: f64) -> impl Iterator<Item = usize> + use<> {
        let (count, paths) = (self.count(), self.paths());
        let step = count as f64 / paths as f64;
        (0..paths).map(move |k| (((k as f64 + number) * step) as usize).min(count - 1))
    }

    /// The number of path `path` of sample `index` in the sequence of the group.
    pub fn number(&self, index: u32, path: usize) -> u32 {
        let number = index.wrapping_mul(PATHS as u32).wrapping_add(path as u32);
        self.first.wrapping_add(number)
    }
}

/// Points by group.
#[derive(Debug, Default)]
pub(super) struct Groups {
    /// The points that are in groups, group by group.
    pub order: Vec<u32>,
    pub all: Vec<Group>,
    /// By point, which bucket it is in.
    buckets: Vec<u8>,
}

/// Points to be grouped: some of a run.
pub(super) struct Ungrouped<'a, N, P> {
    pub points: Range<usize>,
    /// What tells their patch.
    pub patch: u32,
    /// By point, the normal; none for those that share nothing.
    pub normal: N,
    /// By point, the key of its pixel.
    pub pixel: P,
    /// How many samples a pixel has.
    pub in_pixel: u32,
    pub sharing: &'a Sharing,
}

/// What is left of the key of a pixel in a tile.
const IN_TILE: u64 = 15 | 15 << 32;
/// Interleaved lattices of pixels, and classes of normals.
const LATTICES: usize = 4;
const CLASSES: usize = 6;
const BUCKETS: usize = LATTICES * CLASSES;
/// The bucket of no group.
const ALONE: u8 = BUCKETS as u8;

impl Groups {
    /// Forgets all groups.
    pub fn clear(&mut self) {
        self.order.clear();
        self.all.clear();
    }

    /// Adds groups of `some` points.
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
        // Where each bucket begins, and then each point to its place.
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
            // Few are one group, whatever lattice they are on.
            if all.len() <= most {
                self.cut(all, (class, 0), &some);
                continue;
            }
            for (lattice, bucket) in lattices.enumerate() {
                self.cut(begins[bucket]..ends[bucket], (class, lattice), &some);
            }
        }
    }

    /// Cuts points of one bucket into groups.
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
            // Lattices take parts of one sequence.
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

/// The bucket of a point of this normal.
fn bucket(pixel: u64, normal: DVec3) -> u8 {
    // Of each 2 × 2 pixels one is on each lattice, which one as chance has it: the eye would see regular lattices.
    let quad = (pixel >> 1 & 0x7fff_ffff | pixel >> 33 << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let chance = (quad ^ quad >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 62;
    let lattice = ((pixel & 1 | (pixel >> 32 & 1) << 1) ^ chance) as u8;
    // Not quite the cube about the axes: on faces at 45 degrees rounding does not decide.
    let [x, y, z] = normal.to_array();
    let (x, y, z) = (x, y * 1.037, z * 1.019);
    let (axis, sign) = match (x.abs(), y.abs(), z.abs()) {
        (a, b, c) if a >= b && a >= c => (0, x),
        (_, b, c) if b >= c => (1, y),
        _ => (2, z),
    };
    (2 * axis + u8::from(sign < 0.0)) * LATTICES as u8 + lattice
}

/// Where a path has ended that is shared.
#[derive(Debug, Clone, Copy)]
pub(super) enum End {
    /// On this triangle, with its normal on the side that was met.
    On {
        /// Where.
        y: DVec3,
        /// Unit normal.
        normal: DVec3,
        /// Its id.
        triangle: u32,
    },
    /// Nowhere, in this direction.
    Open(DVec3),
}

/// The points of a group, and what each receives of a path.
#[derive(Debug)]
pub(super) struct Receivers {
    positions: Columns,
    normals: Columns,
    /// Those of their triangles, where others stand for them; empty otherwise.
    geometric: Columns,
    /// What shadow rays from them begin by, and their triangles.
    sizes: Vec<f64>,
    triangles: Vec<u32>,
    starts: Vec<f64>,
    segments: Vec<Segment>,
    blocked: Vec<bool>,
    /// By place in the group, p per area at y, or per solid angle; 0 for points that do not see the end.
    pub densities: Block,
    /// w of (1).
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
    /// Forgets the last group.
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

    /// Says the normal of the triangle of the point that was added last, where another stands for it.
    pub fn push_geometric(&mut self, normal: DVec3) {
        self.geometric.push(normal);
    }

    /// Where they are, the normals of their triangles, and what they are lifted by.
    pub fn places(&self) -> (&Columns, &Columns, &[f64]) {
        let normals = match self.geometric.len() {
            0 => &self.normals,
            _ => &self.geometric,
        };
        (&self.positions, normals, &self.sizes)
    }

    /// Finds what each receives of a path that point `own` has sent to `end`; `paths` go on from the group.
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
        // No direction is drawn that goes below a surface.
        for k in 0..self.geometric.len().min(count) {
            let d = match end {
                End::On { y, .. } => y - self.positions.get(k),
                End::Open(l) => l,
            };
            if self.geometric.get(k).dot(d) <= 0.0 {
                self.densities[k] = 0.0;
            }
        }
        // Nearly always all points may see the end, and are asked as they are, with the own one, which has seen it.
        let mut others = self.densities[..count].iter().enumerate();
        if others.any(|(at, density)| *density > 0.0 && at != own) {
            match end {
                End::On {
                    y,
                    normal,
                    triangle,
                } => self.ask_towards((y, normal, triangle), own, bvh, method, counts),
                End::Open(l) => self.ask_along(l, bvh, method, counts),
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

    /// Asks whether anything stands between the points and y, just off its surface as paths leave it.
    fn ask_towards(
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

    /// Asks whether anything is in the way along `l`.
    fn ask_along(&mut self, l: DVec3, bvh: &Bvh, method: Traversal, counts: Option<&mut Counts>) {
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

/// Where shadow rays from the points of a group to `end` begin.
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

/// w of (1) by p: 0 for all where Σ p is no number, or no light is found by it.
struct Weights<'a> {
    densities: &'a Block,
    points_per_path: f64,
    weights: &'a mut Block,
}

impl VectorLoop for Weights<'_> {
    #[inline(always)]
    fn run(self) {
        // Eight sums, and the sum of those: so as vectors of any width add.
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
        let factor = self.points_per_path / sum;
        // In this form also for NaN.
        let factor = match factor > 0.0 && factor.is_finite() {
            true => factor,
            false => 0.0,
        };
        for k in 0..BLOCK {
            self.weights[k] = self.densities[k] * factor;
        }
    }
}

/// p of all points of a group, with V = 1; 0 where they do not face the end.
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
                    // Also for NaN, where both are one point.
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
