//! The sky as a light: mean radiances in the texels of an equirectangular grid, and directions sampled by them.
//!
//! Texels have equal widths in longitude and latitude; a texel of Δφ between the heights y₁ > y₂ of its edges (y = sin latitude) has the
//! solid angle Δφ (y₁ − y₂). Texels are means over the picture by solid angle, so that all light is kept in its place, however small a sun
//! in it is. They are grouped into 96 × 48 blocks, whose flux is computed for each rest frame. Within a block a texel is sampled by its
//! light in the world, whose ratio to that of its neighbours hardly depends on the frame, and within a texel directions are sampled
//! uniformly (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th edition, 2023, A.5: piecewise-constant distributions).

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::panorama::arctan;
use super::{Background, Sky};

/// Number of blocks around, and from pole to pole.
const AROUND: usize = 96;
const BANDS: usize = AROUND / 2;
/// Number of blocks of the sphere.
pub(super) const BLOCKS: usize = AROUND * BANDS;
/// Texels along the edge of a block: according to the width of the picture, from 1.9° to 0.38°.
const LEAST_SIDE: usize = 2;
const GREATEST_SIDE: usize = 10;

/// Radiance by texel.
#[derive(Debug)]
pub struct LightGrid {
    /// Texels along the edge of a block.
    side: usize,
    /// By block, and row by row within a block.
    radiance: Vec<[f32; 3]>,
    /// Cumulative distribution over the texels of each block of the light sent.
    within: Vec<f32>,
    /// y of the upper edges of rows, from +1 down to −1.
    heights: Vec<f64>,
}

/// A texel: its block, and its index among all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Texel {
    pub block: usize,
    index: usize,
}

impl LightGrid {
    /// The grid of the background of `sky`.
    pub fn new(sky: &Sky) -> LightGrid {
        // As fine as the picture, within limits.
        let side = match &sky.background {
            Background::Image(picture) => {
                (picture.width() / AROUND).clamp(LEAST_SIDE, GREATEST_SIDE)
            }
            _ => LEAST_SIDE,
        };
        let rows = BANDS * side;
        let heights: Vec<f64> = (0..=rows)
            .map(|row| libm::cos(PI * row as f64 / rows as f64))
            .collect();
        let mut grid = LightGrid {
            side,
            radiance: Vec::new(),
            within: Vec::new(),
            heights,
        };
        let means = match &sky.background {
            Background::Image(picture) => Some(picture.means(AROUND * side)),
            _ => None,
        };
        let texels = 0..BLOCKS * side * side;
        let radiance = |index: usize| match &means {
            Some(means) => {
                let [row, column] = grid.place(index);
                means[row * AROUND * side + column]
            }
            None => sky.background.radiance(grid.middle(index), 0.0),
        };
        let radiance: Vec<[f32; 3]> = texels
            .into_par_iter()
            .map(|index| radiance(index).map(|l| l as f32))
            .collect();
        grid.radiance = radiance;
        grid.within = (0..BLOCKS).flat_map(|block| grid.parts(block)).collect();
        grid
    }

    /// Bytes of the grid of a picture with this many columns.
    pub fn bytes(width: usize) -> u64 {
        let side = (width / AROUND).clamp(LEAST_SIDE, GREATEST_SIDE);
        (BLOCKS * side * side * (size_of::<[f32; 3]>() + size_of::<f32>())) as u64
    }

    /// Cumulative distribution over the texels of a block of the light sent; by solid angle if the block is dark.
    fn parts(&self, block: usize) -> Vec<f32> {
        // Colours outside the gamut may have a sum below 0.
        let sent = |index: usize| {
            let sum: f64 = self.radiance(index).into_iter().sum();
            sum.max(0.0) * self.solid_angle(index)
        };
        let mut all = self.texels(block).map(sent).collect::<Vec<f64>>();
        if all.iter().sum::<f64>() <= 0.0 {
            all = self
                .texels(block)
                .map(|index| self.solid_angle(index))
                .collect();
        }
        let total: f64 = all.iter().sum();
        let mut sum = 0.0;
        let parts = all.iter().map(|part| {
            sum += part;
            (sum / total) as f32
        });
        let mut parts: Vec<f32> = parts.collect();
        // Rounding must leave no number without a texel: texels after the last one that sends anything get nothing.
        let last = all.iter().rposition(|part| *part > 0.0).unwrap_or(0);
        parts[last..].fill(1.0);
        parts
    }

    /// The texels of a block.
    pub(super) fn texels(&self, block: usize) -> std::ops::Range<usize> {
        let each = self.side * self.side;
        block * each..(block + 1) * each
    }

    /// The row and the column of a texel.
    #[inline]
    fn place(&self, index: usize) -> [usize; 2] {
        let each = self.side * self.side;
        let (block, at) = (index / each, index % each);
        [
            block / AROUND * self.side + at / self.side,
            block % AROUND * self.side + at % self.side,
        ]
    }

    /// Mean radiance of a texel.
    #[inline]
    pub(super) fn radiance(&self, index: usize) -> [f64; 3] {
        self.radiance[index].map(f64::from)
    }

    /// The solid angle of a texel.
    #[inline]
    pub(super) fn solid_angle(&self, index: usize) -> f64 {
        let [row, _] = self.place(index);
        TAU / (AROUND * self.side) as f64 * (self.heights[row] - self.heights[row + 1])
    }

    /// The solid angle of a block.
    #[inline]
    pub(super) fn solid_angle_of_block(&self, block: usize) -> f64 {
        let row = block / AROUND * self.side;
        TAU / AROUND as f64 * (self.heights[row] - self.heights[row + self.side])
    }

    /// The direction of the centre of a texel.
    pub(super) fn middle(&self, index: usize) -> DVec3 {
        self.direction(index, 0.5, 0.5)
    }

    /// The direction at the fractions (x, y) of a texel, in longitude and height.
    #[inline]
    fn direction(&self, index: usize, x: f64, y: f64) -> DVec3 {
        let [row, column] = self.place(index);
        let longitude = TAU * ((column as f64 + x) / (AROUND * self.side) as f64 - 0.5);
        let (upper, lower) = (self.heights[row], self.heights[row + 1]);
        // Areas on the sphere are Δφ Δy: uniform in height is uniform in solid angle.
        let height = upper + (lower - upper) * y;
        let across = (1.0 - height * height).max(0.0).sqrt();
        let (sine, cosine) = libm::sincos(longitude);
        DVec3::new(sine * across, height, -cosine * across)
    }

    /// The texel that contains a direction.
    #[inline]
    pub(super) fn texel(&self, d: DVec3) -> Texel {
        let (columns, rows) = (AROUND * self.side, BANDS * self.side);
        let around = arctan(d.x, -d.z) / TAU + 0.5;
        let down = 0.5 - arctan(d.y, (d.x * d.x + d.z * d.z).sqrt()) / PI;
        let column = ((around * columns as f64) as usize).min(columns - 1);
        let row = ((down * rows as f64) as usize).min(rows - 1);
        let block = row / self.side * AROUND + column / self.side;
        let at = row % self.side * self.side + column % self.side;
        Texel {
            block,
            index: block * self.side * self.side + at,
        }
    }

    /// The mean radiance of the texel around a direction.
    #[inline]
    pub(super) fn radiance_about(&self, texel: Texel) -> [f64; 3] {
        self.radiance(texel.index)
    }

    /// The solid angle of the texel around a direction.
    #[inline]
    pub(super) fn solid_angle_about(&self, d: DVec3) -> f64 {
        self.solid_angle(self.texel(d).index)
    }

    /// A direction of `block`, sampled by two numbers in [0, 1).
    #[inline]
    pub(super) fn sample(&self, block: usize, x: f64, y: f64) -> DVec3 {
        let texels = self.texels(block);
        let first = texels.start;
        let parts = &self.within[texels];
        let at = parts
            .partition_point(|part| f64::from(*part) <= x)
            .min(parts.len() - 1);
        let texel = Texel {
            block,
            index: first + at,
        };
        // The remainder of x, again uniform.
        let share = self.share(texel);
        let rest = (x - (f64::from(parts[at]) - share)) / share.max(f64::MIN_POSITIVE);
        self.direction(texel.index, rest.clamp(0.0, 1.0), y)
    }

    /// The density per solid angle with which [`LightGrid::sample`] samples a direction of this texel within its block.
    #[inline]
    pub(super) fn density(&self, texel: Texel) -> f64 {
        self.share(texel) / self.solid_angle(texel.index)
    }

    /// The fraction of the light of its block sent by a texel.
    #[inline]
    fn share(&self, texel: Texel) -> f64 {
        let first = self.texels(texel.block).start;
        let before = match texel.index > first {
            true => self.within[texel.index - 1],
            false => 0.0,
        };
        f64::from(self.within[texel.index]) - f64::from(before)
    }
}

#[cfg(test)]
mod tests;
