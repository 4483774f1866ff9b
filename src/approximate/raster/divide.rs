//! Tessellation: triangles divided until straight edges will do.
//!
//! An edge that is to have n > 1 equal parts is cut after the first ⌊n/2⌋, counted from the end whose
//! coordinates are less, and its two pieces likewise. How many is decided by its two ends alone: triangles
//! that share an edge cut it alike, and no cracks open. A triangle is cut by those of its edges that are cut
//! into two, three or four, and so on.
//!
//! *Uniform*: n = ⌈length/L⌉, so that all edges are at most L.
//!
//! *Adaptive*: with Δ and δ of [`projection`](crate::approximate::projection), n = ⌈√(E/ε)⌉, or 2 where that is above 3 and E
//! not to be relied on, with
//!
//! ```text
//! E = 4/3 · max |Δ/δ| · |c_A × c_B|² / (8 |c|³_min),
//! ```
//!
//! |c|_min being that of the edge's nearest point and |Δ/δ| that of the end where a metre is more. |c| is
//! convex, its second derivative largest at the nearest point, so that this bounds δ wherever on the edge.
//! Within a triangle whose edges are all at most L, δ is at most 4/3 of what it can be on an edge (Jung: it
//! lies in a circle of radius L/√3). Ends beside the film, or behind the camera, count as if they were in its
//! corner, where a radian has most pixels.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use super::batch::{Batch, Bins, Grid, Piece, Vertex};
use super::cull::Frustum;
use super::method::{Attributes, Tessellation};
use crate::approximate::projection::{Image, Projection};
use crate::camera::Projection as _;

/// So often an edge is cut at most: 10⁻⁹ of it is left.
const DEEPEST: u32 = 30;
/// Lengths that are the same but for rounding count as such.
const SAME: f64 = 1.0 - 1e-12;

/// A point of a triangle that is being divided.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    /// In the rest frame, metres.
    pub x: DVec3,
    /// See [`projection`](crate::approximate::projection).
    pub c: DVec3,
    pub image: Image,
    /// Barycentric weights of the second and third corner of the triangle.
    pub weights: [f64; 2],
    /// |c| |Δ/δ|, pixels; 0 where nobody asks.
    scale: f64,
    /// Its index among the vertices.
    pub index: u32,
}

/// How many points triangles have been cut at so far, in all batches.
#[derive(Debug, Default)]
pub(super) struct Cuts(AtomicUsize);

impl Cuts {
    /// More are refused.
    pub const MOST: usize = 1 << 24;
    /// So many are counted at once.
    const LOT: usize = 1 << 10;

    /// Whether there are more than may be. Once so, it stays so; before, nobody stops for it: that it is so
    /// in the end does not depend on threads.
    pub fn are_too_many(&self) -> bool {
        self.0.load(Ordering::Relaxed) > Cuts::MOST
    }
}

/// A batch while it is filled.
pub(super) struct BatchBuilder<'a> {
    projection: &'a Projection<'a>,
    attributes: Attributes,
    cuts: &'a Cuts,
    /// Cuts that are not counted yet.
    uncounted: usize,
    /// The slot whose triangle is being divided.
    slot: u32,
    /// The first vertex of that triangle.
    first: usize,
    batch: Batch,
}

impl<'a> BatchBuilder<'a> {
    /// An empty batch of rest frame `frame`.
    pub fn new(
        frame: u32,
        projection: &'a Projection<'a>,
        attributes: Attributes,
        cuts: &'a Cuts,
    ) -> Self {
        BatchBuilder {
            projection,
            attributes,
            cuts,
            uncounted: 0,
            slot: 0,
            first: 0,
            batch: Batch {
                frame,
                vertices: Vec::new(),
                attributes: Vec::new(),
                triangles: Vec::new(),
                bins: Bins::default(),
            },
        }
    }

    /// Begins with the triangle in `slot`.
    pub fn begin(&mut self, slot: u32) {
        // A triangle of which nothing was kept leaves no vertices.
        if self
            .batch
            .triangles
            .last()
            .is_none_or(|t| (t.corners[0] as usize) < self.first)
        {
            self.batch.vertices.truncate(self.first);
            self.batch.attributes.truncate(self.first);
        }
        self.slot = slot;
        self.first = self.batch.vertices.len();
    }

    /// Adds a vertex and returns its index.
    #[inline]
    pub fn add(&mut self, weights: [f64; 2], image: &Image) -> u32 {
        self.batch.vertices.push(Vertex {
            film: image.film,
            weights,
        });
        if self.attributes == Attributes::Vertex {
            let (_, emission) = self.projection.emission(image.d, image.s);
            let ratio = self.projection.wavelength_ratio(image.d);
            self.batch.attributes.push([emission.ct, ratio]);
        }
        self.batch.vertices.len() as u32 - 1
    }

    /// Keeps the triangle, if it can be seen.
    #[inline]
    pub fn keep(&mut self, corners: &[Corner; 3], frustum: &Frustum) {
        let [a, b, c] = corners;
        if let Some(reach) = frustum.reach([a.image.film, b.image.film, c.image.film]) {
            self.batch.triangles.push(Piece {
                corners: [a.index, b.index, c.index],
                slot: self.slot,
                reach,
            });
        }
    }

    /// Counts a cut; false where there are too many.
    #[inline]
    pub fn count_cut(&mut self) -> bool {
        self.uncounted += 1;
        if self.uncounted == Cuts::LOT {
            self.count();
        }
        !self.cuts.are_too_many()
    }

    fn count(&mut self) {
        self.cuts.0.fetch_add(self.uncounted, Ordering::Relaxed);
        self.uncounted = 0;
    }

    /// The batch, sorted by the tiles of `grid`.
    pub fn finish(mut self, grid: Grid) -> Batch {
        self.count();
        let mut batch = self.batch;
        batch.bins = Bins::new(grid, &batch.triangles, |piece| batch.film(piece));
        batch
    }
}

/// The up to four pieces of a triangle.
type Pieces = [Option<[Corner; 3]>; 4];

/// Divides triangles of one rest frame.
#[derive(Debug)]
pub(super) struct Divider<'a> {
    pub projection: &'a Projection<'a>,
    pub frustum: &'a Frustum,
    pub tessellation: Tessellation,
    /// Pixels per radian in the corner of the film.
    density: f64,
}

impl<'a> Divider<'a> {
    pub fn new(
        projection: &'a Projection<'a>,
        frustum: &'a Frustum,
        tessellation: Tessellation,
    ) -> Self {
        Divider {
            projection,
            frustum,
            tessellation,
            density: projection.film().density(),
        }
    }

    /// Makes the corner at `x` one of the vertices; none at the place of the camera.
    fn corner(&self, x: DVec3, weights: [f64; 2], batch: &mut BatchBuilder) -> Option<Corner> {
        let c = self.projection.optical(x);
        let image = self.projection.image_of(c)?;
        Some(Corner {
            x,
            c,
            image,
            weights,
            scale: match self.tessellation {
                Tessellation::Adaptive(_) => self.scale(c, &image),
                _ => 0.0,
            },
            index: batch.add(weights, &image),
        })
    }

    /// |c| |Δ/δ| in pixels.
    fn scale(&self, c: DVec3, image: &Image) -> f64 {
        let [width, height] = self.projection.film().size();
        let near = |x: f64, size: f64| x > -0.5 * size && x < 1.5 * size;
        let pixels = match (image.film_point(), self.projection.slide(image.film)) {
            (Some([x, y]), Some([u, v])) if near(x, width) && near(y, height) => {
                (u * u + v * v).sqrt()
            }
            _ => self.density * self.projection.turn(image),
        };
        c.length() * pixels
    }

    /// Into how many parts the edge is cut.
    fn parts(&self, a: &Corner, b: &Corner) -> f64 {
        match self.tessellation {
            Tessellation::None => 1.0,
            Tessellation::Uniform(length) => (a.x.distance(b.x) / length * SAME).ceil(),
            Tessellation::Adaptive(pixels) => match (self.error(a, b) / pixels).sqrt().ceil() {
                parts if parts > 3.0 => 2.0,
                parts => parts,
            },
        }
    }

    /// Where the edge is cut, as a part of it from `a`; none where it stays whole.
    fn cut(&self, a: &Corner, b: &Corner) -> Option<f64> {
        let parts = self.parts(a, b);
        // Not for NaN either.
        (parts > 1.0).then(|| {
            let first = (0.5 * parts).floor() / parts;
            if comes_first(a.x, b.x) {
                first
            } else {
                1.0 - first
            }
        })
    }

    /// A bound on how far points are drawn from their places, pixels. It is the same from either end.
    fn error(&self, a: &Corner, b: &Corner) -> f64 {
        let e = b.c - a.c;
        let cross = a.c.cross(b.c).length_squared();
        let between = a.c.dot(e) < 0.0 && b.c.dot(e) > 0.0;
        let nearest = match between {
            true => cross / e.length_squared(),
            false => a.c.length_squared().min(b.c.length_squared()),
        };
        // E of the module's head: 4/3 (Jung) · |Δ/δ| · |c_A × c_B|² / (8 |c|³), with |c|² of the nearest point
        // squared, as one |c| belongs to the scale.
        4.0 / 3.0 / 8.0 * a.scale.max(b.scale) * cross / (nearest * nearest)
    }

    /// Divides the triangle with these corners, in the rest frame, into `batch`.
    pub fn divide(&self, [a, b, c]: [DVec3; 3], batch: &mut BatchBuilder) {
        let corners = (
            self.corner(a, [0.0, 0.0], batch),
            self.corner(b, [1.0, 0.0], batch),
            self.corner(c, [0.0, 1.0], batch),
        );
        if let (Some(a), Some(b), Some(c)) = corners {
            self.divide_by([a, b, c], DEEPEST, batch);
        }
    }

    /// Of the edges opposite to each corner, where they are cut.
    fn cuts(&self, [a, b, c]: &[Corner; 3]) -> [Option<f64>; 3] {
        [self.cut(b, c), self.cut(c, a), self.cut(a, b)]
    }

    fn divide_by(&self, mut corners: [Corner; 3], depth: u32, batch: &mut BatchBuilder) {
        let mut cuts = self.cuts(&corners);
        let count = cuts.iter().flatten().count();
        if count == 0 || depth == 0 {
            return batch.keep(&corners, self.frustum);
        }
        if self
            .frustum
            .misses(self.projection, corners.map(|corner| corner.c))
        {
            return;
        }
        // Turned so that the one edge that differs from the others is opposite to the first corner.
        let first = match count {
            1 => cuts.iter().position(Option::is_some),
            2 => cuts.iter().position(Option::is_none),
            _ => None,
        };
        corners.rotate_left(first.unwrap_or(0));
        cuts.rotate_left(first.unwrap_or(0));
        let [a, b, c] = &corners;
        let points = [
            cuts[0].and_then(|at| self.between(b, c, at, batch)),
            cuts[1].and_then(|at| self.between(c, a, at, batch)),
            cuts[2].and_then(|at| self.between(a, b, at, batch)),
        ];
        let pieces = match points {
            [Some(bc), None, None] => two(&corners, bc),
            [None, Some(ca), Some(ab)] => three(&corners, ca, ab),
            [Some(bc), Some(ca), Some(ab)] => four(&corners, bc, ca, ab),
            _ => [None; 4],
        };
        for piece in pieces.into_iter().flatten() {
            self.divide_by(piece, depth - 1, batch);
        }
    }

    /// The corner after the part `at` of the edge, the same from either side of it.
    fn between(&self, a: &Corner, b: &Corner, at: f64, batch: &mut BatchBuilder) -> Option<Corner> {
        let (a, b, at) = match comes_first(a.x, b.x) {
            true => (a, b, at),
            false => (b, a, 1.0 - at),
        };
        if !batch.count_cut() {
            return None;
        }
        let x = a.x + (b.x - a.x) * at;
        let weights = [0, 1].map(|i| a.weights[i] + (b.weights[i] - a.weights[i]) * at);
        self.corner(x, weights, batch)
    }
}

/// Whether `a` has the lesser coordinates, the first that differ.
fn comes_first(a: DVec3, b: DVec3) -> bool {
    a.to_array() <= b.to_array()
}

/// Cut by a point of the edge opposite to the first corner.
fn two([a, b, c]: &[Corner; 3], bc: Corner) -> Pieces {
    [Some([*a, *b, bc]), Some([*a, bc, *c]), None, None]
}

/// Cut by points of the two edges at the first corner, and by the shorter diagonal.
fn three([a, b, c]: &[Corner; 3], ca: Corner, ab: Corner) -> Pieces {
    let [second, third] = match ab.x.distance_squared(c.x) <= ca.x.distance_squared(b.x) {
        true => [[ab, *b, *c], [ab, *c, ca]],
        false => [[ab, *b, ca], [*b, *c, ca]],
    };
    [Some([*a, ab, ca]), Some(second), Some(third), None]
}

fn four([a, b, c]: &[Corner; 3], bc: Corner, ca: Corner, ab: Corner) -> Pieces {
    [
        Some([*a, ab, ca]),
        Some([ab, *b, bc]),
        Some([ca, bc, *c]),
        Some([ab, bc, ca]),
    ]
}
