//! Tessellation: triangles are divided until straight edges are accurate enough.
//!
//! An edge that is to have n > 1 equal parts is cut after the first ⌊n/2⌋, counted from the end with the smaller coordinates, and its two
//! pieces likewise. Their number depends only on its two ends: triangles that share an edge cut it alike, and no cracks open. A triangle
//! is divided along those of its edges that are cut into two, three or four, and so on.
//!
//! *Uniform*: n = ⌈length/L⌉, so that all edges are at most L. *Adaptive*: n by a bound on the error of straight edges (`flatness`).

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec3;

use super::batch::{Batch, Bins, Grid, Piece};
use super::cull::{Before, Frustum, ReachAll, SEEN, ScreenBounds, SoleSamples, UNSEEN};
use super::cuts::{Cuts, points};
use super::flatness::{Bend, Edges, LOT};
use super::method::Tessellation;
use super::vertices::{ApparentVertices, Vertex, extend};
use crate::accel::vectors::dispatch;
use crate::approximate::projection::ApparentProjection;
use crate::render::trace::{BuildPlaceHasher, SharedVertices};

/// The largest number of times an edge is halved: 10⁻⁹ of it is left.
const DEEPEST: u32 = 30;
/// Lengths that are equal up to rounding count as equal.
const SAME: f64 = 1.0 - 1e-12;
/// The number of triangles in a batch from which the total number of pieces is estimated.
const ENOUGH: usize = 1024;

/// The vertices of a rest frame: their positions, and their views.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrameVertices<'a> {
    pub shared: &'a SharedVertices,
    pub apparent: &'a ApparentVertices,
}

/// A triangle that may have to be divided.
#[derive(Debug, Clone, Copy)]
struct Part {
    corners: [u32; 3],
    slot: u32,
}

/// Divides triangles of one rest frame.
#[derive(Debug)]
pub(super) struct Divider<'a> {
    pub projection: &'a ApparentProjection<'a>,
    pub frustum: &'a Frustum,
    pub tessellation: Tessellation,
    pub vertices: FrameVertices<'a>,
    pub cuts: &'a Cuts,
    /// If pixels have one sample each.
    pub samples: Option<&'a SoleSamples>,
}

/// A batch while it is filled.
pub(super) struct BatchBuilder<'a> {
    divider: &'a Divider<'a>,
    batch: Batch,
    /// Triangles to examine, and those of the next level.
    level: Vec<Part>,
    next: Vec<Part>,
    /// The number of levels so far.
    depth: u32,
    /// The points at which edges of this level were cut, by the ends of the edge.
    points: HashMap<[u32; 2], u32, BuildPlaceHasher>,
    /// Cuts not yet counted.
    uncounted: usize,
}

impl<'a> BatchBuilder<'a> {
    /// An empty batch of rest frame `frame`.
    pub fn new(frame: u32, divider: &'a Divider<'a>) -> Self {
        BatchBuilder {
            divider,
            batch: Batch {
                frame,
                shared: divider.vertices.apparent.all.len() as u32,
                cuts: Vec::new(),
                places: Vec::new(),
                pieces: Vec::new(),
                bins: Bins::default(),
            },
            level: Vec::new(),
            next: Vec::new(),
            depth: 0,
            points: HashMap::default(),
            uncounted: 0,
        }
    }

    /// Adds the triangles in `slots` that exist, and divides until there are enough for an estimate, or none left to divide. Most are
    /// straight enough without division: those are kept immediately.
    pub fn begin(&mut self, slots: Range<u32>, is_there: impl Fn(u32) -> bool) {
        self.add(slots, is_there);
        while (self.depth == 0 || self.level.len() < ENOUGH) && self.is_unfinished() {
            self.descend();
        }
        self.count();
    }

    /// The triangles left to examine.
    pub fn triangles(&self) -> usize {
        self.level.len()
    }

    /// Divides once more, for a closer forecast.
    pub fn deepen(&mut self) {
        if self.is_unfinished() {
            self.descend();
        }
        self.count();
    }

    /// The approximate number of further points at which triangles will be cut.
    ///
    /// Each half of an edge with n parts counts its own parts again, rounded up: pieces are 0.7 parts long on average, and there are 2.1 to
    /// 2.9 times as many points as with exact parts (measured on five scenes).
    pub fn forecast(&self) -> f64 {
        const FINER: f64 = 2.0;
        if self.divider.tessellation == Tessellation::None {
            return 0.0;
        }
        let mut edges = Box::new(Edges::EMPTY);
        let mut sum = 0.0;
        for begin in (0..self.level.len()).step_by(LOT) {
            let end = (begin + LOT).min(self.level.len());
            self.measure(begin..end, &mut edges);
            for at in begin..end {
                let needed = edges.needed.each_ref().map(|needed| needed[at - begin]);
                // Edges of one part each add less than a point.
                if needed.iter().all(|needed| *needed <= 1.0) {
                    continue;
                }
                let points = points(needed);
                if points > 1.0 && !self.misses(self.level[at]) {
                    sum += points;
                }
            }
        }
        FINER * sum
    }

    /// Keeps the triangles in `slots` whose corners show that they are straight enough; the other existing ones remain to be examined.
    fn add(&mut self, slots: Range<u32>, is_there: impl Fn(u32) -> bool) {
        let FrameVertices { shared, apparent } = self.divider.vertices;
        let (film, samples) = (self.divider.frustum.edges(), self.divider.samples);
        let mut lot = Box::new(Before::EMPTY);
        self.batch.pieces.reserve(slots.len());
        for begin in slots.clone().step_by(LOT) {
            let end = slots.end.min(begin + LOT as u32);
            let corners = &shared.corners[begin as usize..end as usize];
            for (at, of_triangle) in corners.iter().enumerate() {
                for (index, to) in of_triangle.iter().zip(&mut lot.corners) {
                    let corner = apparent.corners[*index as usize];
                    for (to, number) in to.iter_mut().zip(corner) {
                        to[at] = number;
                    }
                }
            }
            dispatch(ReachAll {
                lot: &mut lot,
                film,
            });
            // Triangles that are seen and straight are kept; the others are examined as the first level.
            for (at, (slot, corners)) in (begin..end).zip(corners).enumerate() {
                let kind = lot.kinds[at];
                if kind == UNSEEN || !is_there(slot) {
                    continue;
                }
                let corners = *corners;
                let reach = ScreenBounds(lot.reach.each_ref().map(|bound| bound[at]));
                match kind {
                    SEEN if samples.is_some_and(|samples| samples.miss(reach)) => {}
                    SEEN => self.batch.pieces.push(Piece {
                        corners,
                        slot,
                        reach,
                        tile: lot.tiles[at],
                    }),
                    _ => self.level.push(Part { corners, slot }),
                }
            }
        }
    }

    fn is_unfinished(&self) -> bool {
        !self.level.is_empty() && !self.divider.cuts.are_too_many()
    }

    /// Cuts the triangles of this level, and moves on to the next.
    fn descend(&mut self) {
        match self.depth == DEEPEST || self.divider.tessellation == Tessellation::None {
            true => self.keep_all(),
            false => self.divide_level(),
        }
        // All points of a level are transformed together. An edge is cut at the same level on both of its sides.
        let (places, cuts) = (&self.batch.places, &mut self.batch.cuts);
        if !self.divider.cuts.are_too_many() {
            extend(self.divider.projection, places, cuts);
        }
        self.points.clear();
        std::mem::swap(&mut self.level, &mut self.next);
        self.next.clear();
        self.depth += 1;
    }

    /// Divides all triangles, and sorts their pieces by the tiles of `grid`.
    pub fn finish(mut self, grid: Grid) -> Batch {
        while self.is_unfinished() {
            self.descend();
        }
        self.count();
        let (mut batch, vertices) = (self.batch, &self.divider.vertices.apparent.all);
        if self.divider.cuts.are_too_many() {
            // Some points were not transformed, but the rest is never read.
            batch.pieces.clear();
        }
        let film = |piece: &Piece| batch.corners(vertices, piece).map(|v| v.film);
        batch.bins = Bins::new(grid, &batch.pieces, film);
        batch
    }

    fn keep_all(&mut self) {
        for at in 0..self.level.len() {
            self.keep(self.level[at]);
        }
    }

    /// The place c of a vertex.
    #[inline(always)]
    fn optical(&self, index: u32) -> DVec3 {
        self.divider.projection.optical(self.place(index))
    }

    /// Keeps triangles that need no cut, and cuts the others once.
    fn divide_level(&mut self) {
        let mut edges = Box::new(Edges::EMPTY);
        let mut begin = 0;
        while begin < self.level.len() && !self.divider.cuts.are_too_many() {
            let end = (begin + LOT).min(self.level.len());
            self.measure(begin..end, &mut edges);
            for at in begin..end {
                let part = self.level[at];
                let parts = edges.parts.each_ref().map(|parts| parts[at - begin]);
                // False for NaN.
                match parts.iter().any(|parts| *parts > 1.0) {
                    false => self.keep(part),
                    true => self.divide(part, parts),
                }
            }
            begin = end;
        }
    }

    /// Computes the number of parts of the edges opposite to each corner, in total and at this level.
    fn measure(&self, range: Range<usize>, edges: &mut Edges) {
        match self.divider.tessellation {
            Tessellation::None => {}
            Tessellation::Uniform(length) => {
                // Only by rest length.
                for (at, part) in self.level[range].iter().enumerate() {
                    let [a, b, c] = part.corners.map(|index| self.place(index));
                    let ends = [(b, c), (c, a), (a, b)];
                    for (edge, (a, b)) in ends.into_iter().enumerate() {
                        let needed = a.distance(b) / length;
                        edges.needed[edge][at] = needed;
                        // An edge that exceeds a whole number of lengths only by rounding gets no further part.
                        edges.parts[edge][at] = (needed * SAME).ceil();
                    }
                }
            }
            Tessellation::Adaptive(pixels) => {
                for (at, part) in self.level[range].iter().enumerate() {
                    // Corners by coordinate, for the vector loop over E of `flatness`.
                    for (k, index) in part.corners.into_iter().enumerate() {
                        let c = self.optical(index);
                        edges.c[k][0][at] = c.x;
                        edges.c[k][1][at] = c.y;
                        edges.c[k][2][at] = c.z;
                        edges.scale[k][at] = self.vertex(index).scale;
                    }
                }
                dispatch(Bend { edges, pixels });
            }
        }
    }

    #[inline(always)]
    fn vertex(&self, index: u32) -> &Vertex {
        match index.checked_sub(self.batch.shared) {
            None => &self.divider.vertices.apparent.all[index as usize],
            Some(own) => &self.batch.cuts[own as usize],
        }
    }

    #[inline(always)]
    fn place(&self, index: u32) -> DVec3 {
        match index.checked_sub(self.batch.shared) {
            None => self.divider.vertices.shared.positions[index as usize],
            Some(own) => self.batch.places[own as usize],
        }
    }

    /// Whether all of a triangle is seen outside the film, however it is divided.
    fn misses(&self, part: Part) -> bool {
        let Divider {
            projection,
            frustum,
            ..
        } = self.divider;
        let places = part.corners.map(|index| self.optical(index));
        let film = part.corners.map(|index| self.vertex(index).film);
        frustum.misses(projection, places, film)
    }

    /// Keeps the triangle, if it may be visible.
    #[inline]
    fn keep(&mut self, part: Part) {
        let corners = part.corners.map(|index| self.vertex(index));
        if let Some(reach) = self.divider.frustum.reach(corners) {
            self.batch.pieces.push(Piece {
                corners: part.corners,
                slot: part.slot,
                reach,
                tile: reach.tile(self.divider.frustum.edges().pixels()),
            });
        }
    }

    /// Cuts the triangle at those of its edges that have several `parts`.
    fn divide(&mut self, part: Part, parts: [f64; 3]) {
        if self.misses(part) {
            return;
        }
        // Rotates the corners so that the one edge that differs from the others is opposite to the first corner.
        let is_cut = parts.map(|parts| parts > 1.0);
        let first = match is_cut.iter().filter(|cut| **cut).count() {
            1 => is_cut.iter().position(|cut| *cut),
            2 => is_cut.iter().position(|cut| !*cut),
            _ => None,
        };
        let (mut corners, mut parts) = (part.corners, parts);
        corners.rotate_left(first.unwrap_or(0));
        parts.rotate_left(first.unwrap_or(0));
        let [a, b, c] = corners;
        let mut cut = |a, b, parts: f64| (parts > 1.0).then(|| self.cut(a, b, parts));
        let points = [
            cut(b, c, parts[0]),
            cut(c, a, parts[1]),
            cut(a, b, parts[2]),
        ];
        let pieces = match points {
            [Some(bc), None, None] => [Some([a, b, bc]), Some([a, bc, c]), None, None],
            [None, Some(ca), Some(ab)] => {
                let [second, third] = self.three([a, b, c], ca, ab);
                [Some([a, ab, ca]), Some(second), Some(third), None]
            }
            [Some(bc), Some(ca), Some(ab)] => [
                Some([a, ab, ca]),
                Some([ab, b, bc]),
                Some([ca, bc, c]),
                Some([ab, bc, ca]),
            ],
            _ => [None; 4],
        };
        let slot = part.slot;
        let pieces = pieces.into_iter().flatten();
        self.next
            .extend(pieces.map(|corners| Part { corners, slot }));
    }

    /// Divides the quadrilateral left after cutting off the first corner at `ca` and `ab`, along its shorter diagonal.
    fn three(&self, [_, b, c]: [u32; 3], ca: u32, ab: u32) -> [[u32; 3]; 2] {
        let square = |a, b| self.place(a).distance_squared(self.place(b));
        match square(ab, c) <= square(ca, b) {
            true => [[ab, b, c], [ab, c, ca]],
            false => [[ab, b, ca], [b, c, ca]],
        }
    }

    /// Cuts an edge of n `parts` after the first ⌊n/2⌋, counted from the end with the smaller coordinates: the point is the same from both
    /// sides.
    fn cut(&mut self, a: u32, b: u32, parts: f64) -> u32 {
        // The same for both triangles at the edge.
        let key = [a.min(b), a.max(b)];
        if let Some(known) = self.points.get(&key) {
            return *known;
        }
        let ends = [self.place(a), self.place(b)];
        // By coordinates: batches number the same points differently, and must cut a common edge at the same place.
        let [from, to] = match ends[0].to_array() <= ends[1].to_array() {
            true => ends,
            false => [ends[1], ends[0]],
        };
        let at = (0.5 * parts).floor() / parts;
        let index = self.batch.shared + self.batch.places.len() as u32;
        self.batch.places.push(from + (to - from) * at);
        self.points.insert(key, index);
        self.uncounted += 1;
        if self.uncounted == Cuts::LOT {
            self.count();
        }
        index
    }

    fn count(&mut self) {
        self.divider.cuts.add(self.uncounted);
        self.uncounted = 0;
    }
}
