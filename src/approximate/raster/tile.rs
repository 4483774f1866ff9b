//! One tile: edge functions and depths of all samples.

use glam::DVec3;

use super::batch::{Batch, Piece};
use crate::render::film::Tile;

/// No triangle.
pub(super) const NOTHING: u32 = u32::MAX;

/// A small triangle, ready to be met by samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct SetupTriangle {
    /// eᵢ times the sign of D: all eᵢ·p ≥ 0 inside.
    pub edges: [DVec3; 3],
    /// 1/z = depth·p.
    depth: DVec3,
    /// Pixels of the tile: first column and row, last column and row.
    pixels: [u8; 4],
    /// Index of the batch and of the triangle in it.
    pub batch: u32,
    pub piece: u32,
}

impl SetupTriangle {
    /// None where the triangle is seen edge-on.
    #[inline]
    pub fn new(
        tile: Tile,
        batch: u32,
        index: u32,
        piece: &Piece,
        film: [DVec3; 3],
    ) -> Option<Self> {
        let [a, b, c] = film;
        let edges = [b.cross(c), c.cross(a), a.cross(b)];
        let determinant = a.dot(edges[0]);
        let edges = match determinant < 0.0 {
            true => edges.map(|e| -e),
            false => edges,
        };
        let depth = (edges[0] + edges[1] + edges[2]) / determinant.abs();
        let [left, top] = tile.corner;
        let [right, bottom] = [left + tile.size[0] - 1, top + tile.size[1] - 1];
        let reach = piece.reach.map(u32::from);
        let pixels = [
            reach[0].clamp(left, right) - left,
            reach[1].clamp(top, bottom) - top,
            reach[2].clamp(left, right) - left,
            reach[3].clamp(top, bottom) - top,
        ];
        // None where the triangle is edge-on, and none for NaN.
        (determinant.abs() > 0.0 && depth.is_finite()).then_some(SetupTriangle {
            edges,
            depth,
            pixels: pixels.map(|p| p as u8),
            batch,
            piece: index,
        })
    }

    /// λ of the sample at film point (x, y).
    #[inline]
    pub fn weights(&self, x: f64, y: f64) -> [f64; 3] {
        let p = DVec3::new(x, y, 1.0);
        let e = self.edges.map(|e| e.dot(p));
        let sum = 1.0 / (e[0] + e[1] + e[2]);
        e.map(|e| e * sum)
    }
}

/// What is reused from tile to tile.
#[derive(Debug, Default)]
pub(super) struct TileBuffers {
    pub triangles: Vec<SetupTriangle>,
    /// Film coordinates of each pixel's sample.
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    /// 1/z of the nearest so far.
    depth: Vec<f64>,
    /// Index of its triangle.
    pub nearest: Vec<u32>,
}

impl TileBuffers {
    /// Gathers the triangles that may reach `tile`.
    pub fn gather(&mut self, size: [u32; 2], tile: Tile, batches: &[Batch]) {
        self.triangles.clear();
        for (at, batch) in batches.iter().enumerate() {
            for &index in batch.bins.of(size, tile) {
                let piece = &batch.triangles[index as usize];
                let triangle = SetupTriangle::new(tile, at as u32, index, piece, batch.film(piece));
                self.triangles.extend(triangle);
            }
        }
    }

    /// Finds the nearest triangle at the samples with these offsets in their pixels.
    pub fn cover(&mut self, tile: Tile, offset: impl Fn(usize) -> [f64; 2]) {
        self.x.clear();
        self.y.clear();
        for (pixel, (column, row)) in tile.coordinates().enumerate() {
            let offset = offset(pixel);
            self.x.push(column as f64 + offset[0]);
            self.y.push(row as f64 + offset[1]);
        }
        self.depth.clear();
        self.depth.resize(tile.pixels(), 0.0);
        self.nearest.clear();
        self.nearest.resize(tile.pixels(), NOTHING);
        let width = tile.size[0] as usize;
        for (at, triangle) in self.triangles.iter().enumerate() {
            let [left, top, right, bottom] = triangle.pixels.map(usize::from);
            for row in top..=bottom {
                let span = row * width + left..=row * width + right;
                triangle.cover(
                    at as u32,
                    &self.x[span.clone()],
                    &self.y[span.clone()],
                    &mut self.depth[span.clone()],
                    &mut self.nearest[span],
                );
            }
        }
    }
}

impl SetupTriangle {
    /// Replaces what lies behind this triangle.
    #[inline(always)]
    fn cover(&self, index: u32, x: &[f64], y: &[f64], depth: &mut [f64], nearest: &mut [u32]) {
        let [a, b, c] = self.edges;
        let n = x.len();
        let (y, depth, nearest) = (&y[..n], &mut depth[..n], &mut nearest[..n]);
        for i in 0..n {
            let ea = a.x * x[i] + a.y * y[i] + a.z;
            let eb = b.x * x[i] + b.y * y[i] + b.z;
            let ec = c.x * x[i] + c.y * y[i] + c.z;
            let near = self.depth.x * x[i] + self.depth.y * y[i] + self.depth.z;
            let seen = (ea >= 0.0) & (eb >= 0.0) & (ec >= 0.0) & (near > depth[i]);
            depth[i] = if seen { near } else { depth[i] };
            nearest[i] = if seen { index } else { nearest[i] };
        }
    }
}
