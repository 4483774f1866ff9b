//! What a film stores, and the tiles that it consists of.

use serde::Serialize;

use crate::accel::Precision;
use crate::error::{Error, Result};
use crate::render::aov::Aov;
use crate::render::sampler::samples_per_part;
use crate::scene::limits;

/// Edge length of a tile in pixels.
pub const TILE: u32 = 16;

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// Leftmost column and topmost row.
    pub corner: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

impl Tile {
    /// Tile `index` of an image of `size` pixels, row by row; beyond [`Tile::count`] one without pixels.
    pub fn of_image(size: [u32; 2], index: u64) -> Self {
        let across = u64::from(size[0].div_ceil(TILE)).max(1);
        let corner = [index % across, index / across].map(|n| {
            let pixels = n.saturating_mul(u64::from(TILE));
            u32::try_from(pixels).unwrap_or(u32::MAX)
        });
        Tile {
            corner,
            size: std::array::from_fn(|a| TILE.min(size[a].saturating_sub(corner[a]))),
        }
    }

    /// The tile's index in an image of `size` pixels.
    pub fn index(self, size: [u32; 2]) -> u64 {
        let across = size[0].div_ceil(TILE) as u64;
        (self.corner[1] / TILE) as u64 * across + (self.corner[0] / TILE) as u64
    }

    /// The index of the tile that contains this pixel, in an image of `size` pixels.
    pub(crate) fn holding(size: [u32; 2], [column, row]: [u32; 2]) -> u64 {
        let corner = [column / TILE * TILE, row / TILE * TILE];
        let tile = Tile {
            corner,
            size: [1, 1],
        };
        tile.index(size)
    }

    /// The number of tiles that cover an image of `size` pixels.
    pub fn count(size: [u32; 2]) -> u64 {
        size[0].div_ceil(TILE) as u64 * size[1].div_ceil(TILE) as u64
    }

    /// The number of pixels.
    pub fn pixels(self) -> usize {
        (self.size[0] * self.size[1]) as usize
    }

    /// Column and row of each pixel, row by row.
    pub fn coordinates(self) -> impl Iterator<Item = (u32, u32)> {
        let Tile {
            corner: [left, top],
            size: [width, height],
        } = self;
        (top..top + height)
            .flat_map(move |row| (left..left + width).map(move |column| (column, row)))
    }
}

/// What a film stores.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Layout {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Samples per pixel.
    pub samples: u32,
    /// Whether there is only one sample per pixel, at its centre.
    pub pixel_centers: bool,
    /// The precision of visibility.
    pub precision: Precision,
    /// Auxiliary channels.
    pub channels: Vec<Aov>,
    /// Whether radiance can be missing, so that coverage must be summed.
    pub has_gaps: bool,
    /// Whether the camera's sensor can hide its pinhole from parts of itself.
    pub covers_itself: bool,
}

impl Layout {
    /// Refuses sizes and numbers of samples that no picture can have.
    pub(crate) fn check(&self) -> Result<()> {
        let samples = limits::samples_per_pixel(self.samples);
        limits::image_size(self.size)
            .and(samples)
            .map_err(|(what, help)| Error::invalid("film", "layout", what, help))
    }

    /// The bytes of a film with this layout.
    pub fn bytes(&self) -> u64 {
        // The radiance, three numbers of 8 bytes, and one number per channel.
        let pixel = 24 + 8 * self.channels.len();
        self.size[0] as u64 * self.size[1] as u64 * pixel as u64
    }

    /// The bytes of the sums of all tiles, if they are kept between passes.
    pub(crate) fn bytes_of_passes(&self) -> u64 {
        // Radiance, its halves and their spread; missing radiance and its fractions; hits, blind samples, and the nearest distance.
        let pixel = 24 + 48 + 104 + 40 + 16 + 8 * self.channels.len();
        self.size[0] as u64 * self.size[1] as u64 * pixel as u64
    }

    /// The number of samples in each of the independent parts of a pixel: all of them, unless the standard error is needed. That takes 8
    /// parts, or the next higher number that divides the samples, or one per sample.
    pub fn samples_per_part(&self) -> u32 {
        const PARTS: u32 = 8;
        if !self.channels.contains(&Aov::StandardError) {
            return self.samples;
        }
        samples_per_part(self.samples, PARTS)
    }
}
