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

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use super::batch::{Batch, Bins, Grid, Piece};
use super::cull::{Frustum, Reach, is_before};
use super::method::Tessellation;
use super::vertices::{Vertex, extend};
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::approximate::projection::Projection;
use crate::error::Error;
use crate::render::trace::{BuildPlaceHasher, SharedVertices};

/// So often an edge is cut at most: 10⁻⁹ of it is left.
const DEEPEST: u32 = 30;
/// Lengths that are the same but for rounding count as such.
const SAME: f64 = 1.0 - 1e-12;
/// Number of triangles whose edges are looked at together.
const LOT: usize = 64;
/// Number of triangles of a batch by which it is estimated into how many all will be divided.
const ENOUGH: usize = 1024;

/// How many points triangles have been cut at so far, in all batches.
#[derive(Debug)]
pub(super) struct Cuts {
    count: AtomicUsize,
    /// More are refused.
    most: usize,
}

impl Cuts {
    /// The most that are kept however much memory there is.
    const MOST: usize = 1 << 24;
    /// Number of cuts that are counted at once.
    const LOT: usize = 1 << 10;
    /// What one takes at most: it, its two pieces, and what is kept to divide them.
    pub const BYTES: u64 = 400;
    /// Triangles are refused untried only if the estimate exceeds the limit by this factor: estimates from few triangles overrate
    /// those that bend in one place alone.
    const MARGIN: f64 = 8.0;
    /// From this part of as many as may be on, smaller triangles are asked.
    const UNCERTAIN: f64 = 0.25;
    /// The same for forecasts from [`Cuts::CLOSE`] triangles.
    const CLOSE_MARGIN: f64 = 1.1;
    /// From so many triangles, those of pictures near the limit are a few pixels of what they will be cut into.
    const CLOSE: usize = 1 << 18;

    /// None yet, of at most so many as `memory` bytes hold.
    pub fn within(memory: u64) -> Self {
        Cuts {
            count: AtomicUsize::new(0),
            most: Cuts::most(memory),
        }
    }

    /// How many `memory` bytes hold.
    pub fn most(memory: u64) -> usize {
        (memory / Cuts::BYTES).min(Cuts::MOST as u64) as usize
    }

    /// Whether there are more than may be. Once so, it stays so; before, nobody stops for it: that it is so
    /// in the end does not depend on threads.
    pub fn are_too_many(&self) -> bool {
        self.count.load(Ordering::Relaxed) > self.most
    }

    /// What is known of the end by about this many cuts more, estimated from this many triangles.
    pub fn outlook(&self, more: f64, triangles: usize) -> Outlook {
        let all = self.count.load(Ordering::Relaxed) as f64 + more;
        let most = self.most as f64;
        match triangles >= Cuts::CLOSE {
            // Nothing is divided any more, and there is nothing to wait for.
            _ if self.are_too_many() => Outlook::TooMany,
            _ if all > Cuts::MARGIN * most => Outlook::TooMany,
            true if all > Cuts::CLOSE_MARGIN * most => Outlook::TooMany,
            false if all > Cuts::UNCERTAIN * most => Outlook::Uncertain,
            _ => Outlook::Enough,
        }
    }

    /// The refusal of too many.
    pub fn refusal(&self) -> Error {
        let help = match self.most {
            Cuts::MOST => "a longer edge, or more pixels of error",
            _ => "a longer edge, more pixels of error, or a higher `memory_limit`",
        };
        Error::unsupported(
            "command line",
            "--method",
            format!("triangles would be cut at more than {} points", self.most),
            help,
        )
    }
}

/// What a forecast says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outlook {
    /// The estimate is within the limit, or division is tried.
    Enough,
    /// Smaller triangles tell.
    Uncertain,
    /// More than may be.
    TooMany,
}

/// The vertices of a rest frame: where they are, and how they are seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrameVertices<'a> {
    pub shared: &'a SharedVertices,
    pub seen: &'a [Vertex],
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
    pub projection: &'a Projection<'a>,
    pub frustum: &'a Frustum,
    pub tessellation: Tessellation,
    pub vertices: FrameVertices<'a>,
    pub cuts: &'a Cuts,
}

/// A batch while it is filled.
pub(super) struct BatchBuilder<'a> {
    divider: &'a Divider<'a>,
    batch: Batch,
    /// Triangles that have to be looked at, and those of the next level.
    level: Vec<Part>,
    next: Vec<Part>,
    /// How many levels there have been.
    depth: u32,
    /// By their ends, the points at which edges of this level were cut.
    points: HashMap<[u32; 2], u32, BuildPlaceHasher>,
    /// Cuts that are not counted yet.
    uncounted: usize,
}

impl<'a> BatchBuilder<'a> {
    /// An empty batch of rest frame `frame`.
    pub fn new(frame: u32, divider: &'a Divider<'a>) -> Self {
        BatchBuilder {
            divider,
            batch: Batch {
                frame,
                shared: divider.vertices.seen.len() as u32,
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

    /// Adds the triangle in `slot`.
    #[inline]
    pub fn add(&mut self, slot: u32) {
        let corners = self.divider.vertices.shared.corners[slot as usize];
        self.level.push(Part { corners, slot });
    }

    /// Divides until there are enough triangles to estimate from, or none that is to be divided. Most are straight enough as they are:
    /// those are kept at once, and not asked again.
    pub fn begin(&mut self) {
        self.keep_straight();
        while (self.depth == 0 || self.level.len() < ENOUGH) && self.is_unfinished() {
            self.descend();
        }
        self.count();
    }

    /// Triangles that are left to be looked at.
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

    /// At about how many more points triangles will be cut.
    ///
    /// Of an edge that is to have n parts each half counts its own anew, and takes the next whole number: pieces are 0.7 parts long on
    /// average, and there are 2.1 to 2.9 times as many points as whole parts would have (measured on five scenes).
    pub fn forecast(&self) -> f64 {
        const FINER: f64 = 2.0;
        let Divider {
            projection,
            frustum,
            tessellation,
            ..
        } = *self.divider;
        if tessellation == Tessellation::None {
            return 0.0;
        }
        let mut edges = Box::new(Edges::EMPTY);
        let mut sum = 0.0;
        for begin in (0..self.level.len()).step_by(LOT) {
            let end = (begin + LOT).min(self.level.len());
            self.measure(begin..end, &mut edges);
            for at in begin..end {
                let needed = edges.needed.each_ref().map(|needed| needed[at - begin]);
                // Edges of one part each make less than a point.
                if needed.iter().all(|needed| *needed <= 1.0) {
                    continue;
                }
                let points = points(needed);
                let places = self.level[at].corners.map(|index| self.vertex(index).c);
                if points > 1.0 && !frustum.misses(projection, places) {
                    sum += points;
                }
            }
        }
        FINER * sum
    }

    /// Keeps triangles of the first level that are straight enough by more than rounding, without a division; the others are left.
    fn keep_straight(&mut self) {
        let Tessellation::Adaptive(pixels) = self.divider.tessellation else {
            return;
        };
        let mut lot = Box::new(Whole::EMPTY);
        self.batch.pieces.reserve(self.level.len());
        let mut left = 0;
        for begin in (0..self.level.len()).step_by(LOT) {
            let end = (begin + LOT).min(self.level.len());
            let seen = self.divider.vertices.seen;
            for (at, part) in self.level[begin..end].iter().enumerate() {
                for (k, index) in part.corners.iter().enumerate() {
                    let corner = &seen[*index as usize];
                    lot.c[k][0][at] = corner.c.x;
                    lot.c[k][1][at] = corner.c.y;
                    lot.c[k][2][at] = corner.c.z;
                    lot.scale[k][at] = corner.scale;
                    lot.point[k][0][at] = corner.point[0];
                    lot.point[k][1][at] = corner.point[1];
                    lot.z[k][at] = corner.film.z;
                }
            }
            dispatch(Straight {
                lot: &mut lot,
                pixels,
                frustum: self.divider.frustum,
            });
            for at in begin..end {
                let part = self.level[at];
                match lot.kinds[at - begin] {
                    Kind::BENT => {
                        self.level[left] = part;
                        left += 1;
                    }
                    Kind::SEEN => self.batch.pieces.push(Piece {
                        corners: part.corners,
                        slot: part.slot,
                        reach: Reach(lot.reach.each_ref().map(|bound| bound[at - begin])),
                    }),
                    Kind::BESIDE => self.keep(part),
                    _ => {}
                }
            }
        }
        self.level.truncate(left);
    }

    fn is_unfinished(&self) -> bool {
        !self.level.is_empty() && !self.divider.cuts.are_too_many()
    }

    /// Cuts the triangles of this level, and goes to the next.
    fn descend(&mut self) {
        match self.depth == DEEPEST || self.divider.tessellation == Tessellation::None {
            true => self.keep_all(),
            false => self.divide_level(),
        }
        // All points of a level are transformed together. An edge is cut in the same level on either side.
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
        let (mut batch, seen) = (self.batch, self.divider.vertices.seen);
        if self.divider.cuts.are_too_many() {
            // Not all points have been transformed, and nobody looks at the rest.
            batch.pieces.clear();
        }
        let film = |piece: &Piece| batch.corners(seen, piece).map(|v| v.film);
        batch.bins = Bins::new(grid, &batch.pieces, film);
        batch
    }

    fn keep_all(&mut self) {
        for at in 0..self.level.len() {
            self.keep(self.level[at]);
        }
    }

    /// Keeps what need not be cut, and cuts the rest once.
    fn divide_level(&mut self) {
        let mut edges = Box::new(Edges::EMPTY);
        let mut begin = 0;
        while begin < self.level.len() && !self.divider.cuts.are_too_many() {
            let end = (begin + LOT).min(self.level.len());
            self.measure(begin..end, &mut edges);
            for at in begin..end {
                let part = self.level[at];
                let parts = edges.parts.each_ref().map(|parts| parts[at - begin]);
                // Not for NaN either.
                match parts.iter().any(|parts| *parts > 1.0) {
                    false => self.keep(part),
                    true => self.divide(part, parts),
                }
            }
            begin = end;
        }
    }

    /// Finds into how many parts the edges opposite to each corner are to be cut, in all and in this level.
    fn measure(&self, range: std::ops::Range<usize>, edges: &mut Edges) {
        match self.divider.tessellation {
            Tessellation::None => {}
            Tessellation::Uniform(length) => {
                // By rest length alone.
                for (at, part) in self.level[range].iter().enumerate() {
                    let [a, b, c] = part.corners.map(|index| self.place(index));
                    let ends = [(b, c), (c, a), (a, b)];
                    for (edge, (a, b)) in ends.into_iter().enumerate() {
                        let needed = a.distance(b) / length;
                        edges.needed[edge][at] = needed;
                        edges.parts[edge][at] = (needed * SAME).ceil();
                    }
                }
            }
            Tessellation::Adaptive(pixels) => {
                for (at, part) in self.level[range].iter().enumerate() {
                    let corners = part.corners.map(|index| self.vertex(index));
                    // Corners by coordinate, for the vector loop over E of the head.
                    for (k, corner) in corners.iter().enumerate() {
                        edges.c[k][0][at] = corner.c.x;
                        edges.c[k][1][at] = corner.c.y;
                        edges.c[k][2][at] = corner.c.z;
                        edges.scale[k][at] = corner.scale;
                    }
                }
                dispatch(Bend { edges, pixels });
            }
        }
    }

    #[inline(always)]
    fn vertex(&self, index: u32) -> &Vertex {
        match index.checked_sub(self.batch.shared) {
            None => &self.divider.vertices.seen[index as usize],
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

    /// Keeps the triangle, if it can be seen.
    #[inline]
    fn keep(&mut self, part: Part) {
        let corners = part.corners.map(|index| self.vertex(index));
        if let Some(reach) = self.divider.frustum.reach(corners) {
            self.batch.pieces.push(Piece {
                corners: part.corners,
                slot: part.slot,
                reach,
            });
        }
    }

    /// Cuts the triangle at those of its edges that are to have several `parts`.
    fn divide(&mut self, part: Part, parts: [f64; 3]) {
        let places = part.corners.map(|index| self.vertex(index).c);
        if self.divider.frustum.misses(self.divider.projection, places) {
            return;
        }
        // Turned so that the one edge that differs from the others is opposite to the first corner.
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

    /// What is left beside the first corner when its two edges are cut at `ca` and `ab`: cut by the shorter diagonal.
    fn three(&self, [_, b, c]: [u32; 3], ca: u32, ab: u32) -> [[u32; 3]; 2] {
        let square = |a, b| self.place(a).distance_squared(self.place(b));
        match square(ab, c) <= square(ca, b) {
            true => [[ab, b, c], [ab, c, ca]],
            false => [[ab, b, ca], [b, c, ca]],
        }
    }

    /// The point after the first ⌊n/2⌋ of the n `parts` of an edge, counted from the end whose coordinates are less:
    /// the same from either side of it.
    fn cut(&mut self, a: u32, b: u32, parts: f64) -> u32 {
        let key = [a.min(b), a.max(b)];
        if let Some(known) = self.points.get(&key) {
            return *known;
        }
        let ends = [self.place(a), self.place(b)];
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
        let all = &self.divider.cuts.count;
        all.fetch_add(self.uncounted, Ordering::Relaxed);
        self.uncounted = 0;
    }
}

/// The same of a triangle whose edges are to be at most `length` long; 0 for one that is not cut.
pub(super) fn cuts_of([a, b, c]: [DVec3; 3], length: f64) -> f64 {
    let parts = [b.distance(c), c.distance(a), a.distance(b)].map(|edge| edge / length);
    points(parts)
}

/// About how many points a triangle is cut at whose edges are cut into so many parts: there is one for every two pieces
/// (Euler), and pieces have edges of one part. Heron's formula gives their number; n²/2 points where all edges have n.
fn points([a, b, c]: [f64; 3]) -> f64 {
    let half = 0.5 * (a + b + c);
    let square = half * (half - a) * (half - b) * (half - c);
    // No more than a little where one edge is cut alone. Not for NaN either.
    match square > 0.0 {
        true => square.sqrt() * 2.0 / 3f64.sqrt(),
        false => 0.0,
    }
}

/// What becomes of a triangle of the first level.
struct Kind;

impl Kind {
    /// It is outside of the film.
    const UNSEEN: u32 = 0;
    /// It is straight enough, and in front of the camera.
    const SEEN: u32 = 1;
    /// It is straight enough, and a part of it may be behind the camera.
    const BESIDE: u32 = 2;
    /// It may have to be cut.
    const BENT: u32 = 3;
}

/// Triangles of the first level.
struct Whole {
    /// By corner: the places c, |c| |Δ/δ|, the film point and z.
    c: [[[f64; LOT]; 3]; 3],
    scale: [[f64; LOT]; 3],
    point: [[[f64; LOT]; 2]; 3],
    z: [[f64; LOT]; 3],
    /// What becomes of them, and the part of the film that those which are seen can reach.
    kinds: [u32; LOT],
    reach: [[f32; LOT]; 4],
}

impl Whole {
    const EMPTY: Whole = Whole {
        c: [[[0.0; LOT]; 3]; 3],
        scale: [[0.0; LOT]; 3],
        point: [[[0.0; LOT]; 2]; 3],
        z: [[0.0; LOT]; 3],
        kinds: [0; LOT],
        reach: [[0.0; LOT]; 4],
    };
}

/// The loop over triangles of the first level.
struct Straight<'a> {
    lot: &'a mut Whole,
    pixels: f64,
    frustum: &'a Frustum,
}

impl VectorLoop for Straight<'_> {
    #[inline(always)]
    fn run(self) {
        let Whole {
            c,
            scale,
            point,
            z,
            kinds,
            reach,
        } = self.lot;
        let (pixels, frustum) = (self.pixels, self.frustum.edges());
        let mut is_bent = [0; LOT];
        for edge in 0..3 {
            let (from, to) = ((edge + 1) % 3, (edge + 2) % 3);
            for at in 0..LOT {
                let a = DVec3::new(c[from][0][at], c[from][1][at], c[from][2][at]);
                let b = DVec3::new(c[to][0][at], c[to][1][at], c[to][2][at]);
                let is_straight = is_straight(a, b, scale[from][at].max(scale[to][at]), pixels);
                is_bent[at] |= u32::from(!is_straight);
            }
        }
        let [left, top, right, bottom] = reach;
        for at in 0..LOT {
            let least = |axis: usize| {
                let [a, b, c] = [point[0][axis][at], point[1][axis][at], point[2][axis][at]];
                (a.min(b).min(c), a.max(b).max(c))
            };
            let ((x, to_x), (y, to_y)) = (least(0), least(1));
            let [a, b, c] = [z[0][at], z[1][at], z[2][at]];
            let is_beside = !is_before(a, b, c);
            let (is_seen, [l, t, r, b]) = frustum.reach([x, y, to_x, to_y]);
            (left[at], top[at], right[at], bottom[at]) = (l, t, r, b);
            let kind = if is_seen { Kind::SEEN } else { Kind::UNSEEN };
            let kind = if is_beside { Kind::BESIDE } else { kind };
            kinds[at] = if is_bent[at] != 0 { Kind::BENT } else { kind };
        }
    }
}

/// Whether [`bend`] is at most so many pixels by more than rounding, which is a few eps: its terms multiplied out. Not for NaN.
#[inline(always)]
fn is_straight(a: DVec3, b: DVec3, scale: f64, pixels: f64) -> bool {
    const SAFELY: f64 = 1.0 - 1e-12;
    let e = b - a;
    let cross = a.cross(b).length_squared();
    let between = (a.dot(e) < 0.0) & (b.dot(e) > 0.0);
    // |c|² of the nearest point is cross/|e|² between the ends.
    let (square, ends) = (
        e.length_squared(),
        a.length_squared().min(b.length_squared()),
    );
    let error = 4.0 / 3.0 / 8.0 * scale * if between { square * square } else { cross };
    let most = SAFELY * pixels * if between { cross } else { ends * ends };
    error <= most
}

/// The edges of a lot of triangles.
struct Edges {
    /// By corner and coordinate, the places c.
    c: [[[f64; LOT]; 3]; 3],
    /// By corner, |c| |Δ/δ|.
    scale: [[f64; LOT]; 3],
    /// How many parts the edges opposite to each corner need in all, and into how many they are cut now.
    needed: [[f64; LOT]; 3],
    parts: [[f64; LOT]; 3],
}

impl Edges {
    const EMPTY: Edges = Edges {
        c: [[[0.0; LOT]; 3]; 3],
        scale: [[0.0; LOT]; 3],
        needed: [[0.0; LOT]; 3],
        parts: [[0.0; LOT]; 3],
    };
}

/// The loop over edges for a bound on errors in pixels.
struct Bend<'a> {
    edges: &'a mut Edges,
    pixels: f64,
}

impl VectorLoop for Bend<'_> {
    #[inline(always)]
    fn run(self) {
        let Edges {
            c,
            scale,
            needed,
            parts,
        } = self.edges;
        let mut any = 0;
        for (edge, squares) in needed.iter_mut().enumerate() {
            let (from, to) = ((edge + 1) % 3, (edge + 2) % 3);
            for at in 0..LOT {
                let a = DVec3::new(c[from][0][at], c[from][1][at], c[from][2][at]);
                let b = DVec3::new(c[to][0][at], c[to][1][at], c[to][2][at]);
                let error = bend(a, b, scale[from][at].max(scale[to][at]));
                squares[at] = error / self.pixels;
                any |= u64::from(squares[at] > 1.0);
            }
        }
        // Most edges are straight enough, and their n² is as good as n.
        if any == 0 {
            return parts.fill([1.0; LOT]);
        }
        for (needed, parts) in needed.iter_mut().zip(parts) {
            for (needed, parts) in needed.iter_mut().zip(parts) {
                // n of the head: above 3 the bound is only good enough to halve the edge.
                let root = needed.sqrt();
                let count = root.ceil();
                *needed = root;
                *parts = if count > 3.0 { 2.0 } else { count };
            }
        }
    }
}

/// A bound on how far points of an edge are drawn from their places, pixels. It is the same from either end.
#[inline(always)]
fn bend(a: DVec3, b: DVec3, scale: f64) -> f64 {
    let e = b - a;
    let cross = a.cross(b).length_squared();
    let between = (a.dot(e) < 0.0) & (b.dot(e) > 0.0);
    let nearest = if between {
        cross / e.length_squared()
    } else {
        a.length_squared().min(b.length_squared())
    };
    // E of the module's head: 4/3 (Jung) · |Δ/δ| · |c_A × c_B|² / (8 |c|³), with |c|² of the nearest point
    // squared, as one |c| belongs to the scale.
    4.0 / 3.0 / 8.0 * scale * cross / (nearest * nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forecasts_end_once_there_are_too_many_cuts() {
        // However few are to come, and however few triangles are left: none of them is divided any more.
        let cuts = Cuts::within(1000 * Cuts::BYTES);
        cuts.count.store(1000, Ordering::Relaxed);
        assert_eq!(cuts.outlook(0.0, 1), Outlook::Uncertain);
        cuts.count.store(1001, Ordering::Relaxed);
        assert_eq!(cuts.outlook(0.0, 1), Outlook::TooMany);
        assert_eq!(cuts.outlook(100.0, Cuts::CLOSE), Outlook::TooMany);
    }

    /// Edges before and beside the camera whose bend is around a tenth of a pixel.
    #[test]
    fn edges_taken_for_straight_are_and_others_by_rounding_alone() {
        let mut state = 1u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut counts = [0; 2];
        for _ in 0..20_000 {
            let [a, b] = [(); 2].map(|()| DVec3::new(random(), random(), random()));
            let error = bend(a, b, 1.0);
            for factor in [
                0.5,
                1.0 - 1e-11,
                1.0 - 1e-14,
                1.0,
                1.0 + 1e-14,
                1.0 + 1e-11,
                2.0,
            ] {
                let pixels = factor * error;
                let is_taken = is_straight(a, b, 1.0, pixels);
                assert!(!is_taken || error / pixels <= 1.0, "{a} {b} {factor}");
                assert!(is_taken || factor < 1.0 + 1e-11, "{a} {b} {factor}");
                counts[usize::from(is_taken)] += 1;
            }
        }
        assert!(counts[0] > 40_000 && counts[1] >= 40_000, "{counts:?}");
        assert!(!is_straight(DVec3::NAN, DVec3::X, 1.0, 1.0));
        assert!(!is_straight(DVec3::X, -DVec3::X, f64::NAN, 1.0));
    }
}
