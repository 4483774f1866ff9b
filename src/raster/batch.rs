//! Small triangles in homogeneous film coordinates, in batches: one for each run of triangles of a tree.

use glam::DVec3;

use super::Attributes;
use super::bins::{Bins, Grid};
use super::cull::Frustum;
use super::divide::Corner;
use crate::apparent::{Image, Sight};

/// More small triangles than these in one batch are refused.
pub(super) const MOST: usize = 1 << 25;

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
    /// Whether there are more triangles than are kept.
    pub is_cut_short: bool,
}

/// A batch while it is filled.
pub(super) struct Parts<'a> {
    sight: &'a Sight<'a>,
    attributes: Attributes,
    /// The slot whose triangle is being divided.
    slot: u32,
    /// The first vertex of that triangle.
    first: usize,
    batch: Batch,
}

impl<'a> Parts<'a> {
    /// An empty batch of rest frame `frame`.
    pub fn new(frame: u32, sight: &'a Sight<'a>, attributes: Attributes) -> Self {
        Parts {
            sight,
            attributes,
            slot: 0,
            first: 0,
            batch: Batch {
                frame,
                vertices: Vec::new(),
                attributes: Vec::new(),
                triangles: Vec::new(),
                bins: Bins::default(),
                is_cut_short: false,
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

    /// Whether there are more triangles than are kept.
    pub fn is_full(&self) -> bool {
        self.batch.vertices.len() > 2 * MOST || self.batch.triangles.len() > MOST
    }

    /// The batch, sorted by the tiles of `grid`.
    pub fn finish(self, grid: Grid) -> Batch {
        let is_cut_short = self.is_full();
        let mut batch = self.batch;
        batch.is_cut_short = is_cut_short;
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
