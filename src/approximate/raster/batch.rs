//! Small triangles in homogeneous film coordinates, in batches: one for each run of triangles of a tree.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use super::Attributes;
use super::bins::{Bins, Grid};
use super::cull::Frustum;
use super::divide::Corner;
use crate::approximate::projection::{Image, Sight};

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

/// A corner of small triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    /// Homogeneous film coordinates.
    pub film: DVec3,
    /// Barycentric weights of the second and third corner of the triangle that was divided.
    pub weights: [f64; 2],
}

/// A small triangle, a part of one of the tree's.
#[derive(Debug, Clone, Copy)]
pub(super) struct Small {
    /// Indices of its vertices.
    pub corners: [u32; 3],
    /// The slot of the triangle that was divided.
    pub slot: u32,
    /// The pixels that it can reach: first column and row, last column and row.
    pub reach: [u16; 4],
}

/// Small triangles of one rest frame, by the tiles that they may reach.
#[derive(Debug)]
pub(super) struct Batch {
    /// Index of the rest frame.
    pub frame: u32,
    pub vertices: Vec<Vertex>,
    /// Of each vertex, where they are interpolated: time of emission relative to the shot in the rest
    /// frame, metres, and W.
    pub attributes: Vec<[f64; 2]>,
    pub triangles: Vec<Small>,
    pub bins: Bins,
}

/// A batch while it is filled.
pub(super) struct Parts<'a> {
    sight: &'a Sight<'a>,
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

impl<'a> Parts<'a> {
    /// An empty batch of rest frame `frame`.
    pub fn new(frame: u32, sight: &'a Sight<'a>, attributes: Attributes, cuts: &'a Cuts) -> Self {
        Parts {
            sight,
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
            let (_, emission) = self.sight.emission(image.d, image.s);
            let ratio = self.sight.wavelength_ratio(image.d);
            self.batch.attributes.push([emission.ct, ratio]);
        }
        self.batch.vertices.len() as u32 - 1
    }

    /// Keeps the triangle, if it can be seen.
    #[inline]
    pub fn keep(&mut self, corners: &[Corner; 3], frustum: &Frustum) {
        let [a, b, c] = corners;
        if let Some(reach) = frustum.reach([a.image.film, b.image.film, c.image.film]) {
            self.batch.triangles.push(Small {
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
        batch.bins = Bins::new(grid, &batch.triangles, |small| batch.film(small));
        batch
    }
}

impl Batch {
    /// The film coordinates of a triangle's corners.
    #[inline(always)]
    pub fn film(&self, small: &Small) -> [DVec3; 3] {
        let [a, b, c] = small.corners;
        [
            self.vertices[a as usize].film,
            self.vertices[b as usize].film,
            self.vertices[c as usize].film,
        ]
    }
}
