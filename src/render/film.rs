//! The film: sums of samples per pixel, box filter, in f64 and in a fixed order.
//!
//! A tile is rendered by one thread, each of its pixels sample by sample; tiles do not overlap. So the
//! film's bits do not depend on the number of threads.

use serde::Serialize;

use crate::accel::Precision;
use crate::io::image::{Channel, Samples};
use crate::light::time_texture::Coverage;
use crate::render::aov::{Aov, Combine};

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
    /// Tile `index` of an image of `size` pixels, row by row.
    pub fn of_image(size: [u32; 2], index: u64) -> Self {
        let across = size[0].div_ceil(TILE) as u64;
        let corner = [
            (index % across) as u32 * TILE,
            (index / across) as u32 * TILE,
        ];
        Tile {
            corner,
            size: std::array::from_fn(|a| TILE.min(size[a] - corner[a])),
        }
    }

    /// The tile's index in an image of `size` pixels.
    pub fn index(self, size: [u32; 2]) -> u64 {
        let across = size[0].div_ceil(TILE) as u64;
        (self.corner[1] / TILE) as u64 * across + (self.corner[0] / TILE) as u64
    }

    /// The index of the tile of an image of `size` pixels that holds this pixel.
    pub fn holding(size: [u32; 2], [column, row]: [u32; 2]) -> u64 {
        let corner = [column / TILE * TILE, row / TILE * TILE];
        let tile = Tile {
            corner,
            size: [1, 1],
        };
        tile.index(size)
    }

    /// How many tiles cover an image of `size` pixels.
    pub fn count(size: [u32; 2]) -> u64 {
        size[0].div_ceil(TILE) as u64 * size[1].div_ceil(TILE) as u64
    }

    /// How many pixels.
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

/// What the film has to hold.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Layout {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Samples per pixel.
    pub samples: u32,
    /// Whether the one sample of each pixel is at its centre.
    pub pixel_centers: bool,
    /// What visibility is worth.
    pub precision: Precision,
    /// Auxiliary channels.
    pub channels: Vec<Aov>,
    /// Whether radiance can be missing, so that coverage has to be summed.
    pub has_gaps: bool,
}

impl Layout {
    /// Bytes of a film of this layout.
    pub fn bytes(&self) -> u64 {
        let pixel = 24 + 8 * self.channels.len();
        self.size[0] as u64 * self.size[1] as u64 * pixel as u64
    }
}

/// The sums of one tile.
#[derive(Debug)]
pub struct TileFilm {
    tile: Tile,
    radiance: Vec<[f64; 3]>,
    /// Samples that hit nothing.
    unmet: u64,
    /// Of all samples of the tile.
    coverage: Coverage,
    /// Σ of the known parts, for the channel.
    held: Vec<f64>,
    /// Σ of the missing parts by reason, for the channels: before, after, off the texture, occluded.
    missing: Vec<[f64; 4]>,
    /// For the standard error, with m the mean of R, G, B: m₀ of the first sample, Σ (m − m₀) and
    /// Σ (m − m₀)². Equal samples give exactly 0.
    spread: Vec<[f64; 3]>,
    /// Samples that hit a surface.
    hits: Vec<u32>,
    /// Squared distance from the pixel's centre of the nearest sample so far.
    nearest: Vec<f64>,
    aovs: Vec<Vec<f64>>,
}

impl TileFilm {
    /// An empty film of `tile`.
    pub fn new(tile: Tile, layout: &Layout) -> Self {
        let n = tile.pixels();
        let some = |wanted: bool| if wanted { n } else { 0 };
        let aovs = !layout.channels.is_empty();
        TileFilm {
            tile,
            radiance: vec![[0.0; 3]; n],
            unmet: 0,
            coverage: Coverage::NONE,
            held: vec![0.0; some(layout.has_gaps && layout.channels.contains(&Aov::Coverage))],
            missing: vec![[0.0; 4]; some(layout.has_gaps && is_missing_wanted(layout))],
            spread: vec![[f64::NAN, 0.0, 0.0]; some(layout.channels.contains(&Aov::StandardError))],
            hits: vec![0; some(aovs)],
            nearest: vec![f64::INFINITY; some(aovs)],
            aovs: vec![vec![0.0; n]; layout.channels.len()],
        }
    }

    /// Adds one sample's radiance to `pixel`.
    #[inline]
    pub fn add(&mut self, pixel: usize, radiance: [f64; 3]) {
        // The box filter: every sample of the pixel counts alike.
        let sum = &mut self.radiance[pixel];
        for (sum, value) in sum.iter_mut().zip(radiance) {
            *sum += value;
        }
        // Differences from the first sample, so that no digits cancel in the variance.
        if let Some([first, sum, squares]) = self.spread.get_mut(pixel) {
            let mean = mean(radiance);
            if first.is_nan() {
                *first = mean;
            }
            *sum += mean - *first;
            *squares += (mean - *first) * (mean - *first);
        }
    }

    /// Notes samples that hit nothing.
    pub fn add_unmet(&mut self, samples: u64) {
        self.unmet += samples;
    }

    /// Adds how much of one sample's radiance is known.
    #[inline]
    pub fn add_coverage(&mut self, pixel: usize, coverage: Coverage) {
        self.coverage += coverage;
        if let Some(held) = self.held.get_mut(pixel) {
            *held += coverage.held;
        }
        if let Some(missing) = self.missing.get_mut(pixel) {
            let parts = [
                coverage.before,
                coverage.after,
                coverage.off_texture,
                coverage.occluded,
            ];
            missing
                .iter_mut()
                .zip(parts)
                .for_each(|(sum, part)| *sum += part);
        }
    }

    /// Notes one sample, in each of `pixels`, whose radiance is fully known.
    pub fn add_held(&mut self, pixels: &[u32]) {
        // Counted rather than added up: exact, however many.
        self.coverage.held += pixels.len() as f64;
        if !self.held.is_empty() {
            pixels.iter().for_each(|p| self.held[*p as usize] += 1.0);
        }
    }

    /// Notes a sample at `offset` in `pixel`; true if it is the nearest to the centre so far.
    pub(crate) fn is_nearest_to_centre(
        &mut self,
        pixel: usize,
        offset: [f64; 2],
        hit: bool,
    ) -> bool {
        self.hits[pixel] += hit as u32;
        // Of equal distances the earlier sample counts.
        let [x, y] = offset.map(|o| o - 0.5);
        let distance = x * x + y * y;
        let nearest = distance < self.nearest[pixel];
        if nearest {
            self.nearest[pixel] = distance;
        }
        nearest
    }

    /// Adds to the sum of auxiliary channel `channel`.
    pub(crate) fn add_aov(&mut self, channel: usize, pixel: usize, value: f64) {
        self.aovs[channel][pixel] += value;
    }

    /// Sets auxiliary channel `channel`.
    pub(crate) fn set_aov(&mut self, channel: usize, pixel: usize, value: f64) {
        self.aovs[channel][pixel] = value;
    }

    /// The finished value of `aov` in `pixel` after `samples` samples.
    fn aov(&self, channel: usize, aov: Aov, pixel: usize, samples: u32) -> f64 {
        let sum = self.aovs[channel][pixel];
        match aov.combine() {
            Combine::Coverage => self
                .held
                .get(pixel)
                .map_or(1.0, |held| held / samples as f64),
            Combine::Missing => {
                let sums = self.missing.get(pixel).zip(aov.missing());
                sums.map_or(0.0, |(sums, reason)| sums[reason] / samples as f64)
            }
            Combine::StandardError => self.standard_error(pixel, samples as f64),
            Combine::MeanOfAll => sum / samples as f64,
            Combine::Nearest | Combine::NearestIdentity => sum,
            // 0/0 = NaN where nothing was hit.
            Combine::MeanOfHits => sum / self.hits[pixel] as f64,
        }
    }

    /// √(sample variance / n): independent samples would have it; stratified ones have less.
    fn standard_error(&self, pixel: usize, n: f64) -> f64 {
        // Unbiased: Σ(m − m̄)² / (n − 1), and Σ(m − m̄)² = Σ(m − m₀)² − (Σ(m − m₀))²/n.
        let [_, sum, squares] = self.spread[pixel];
        let variance = (squares - sum * sum / n) / (n - 1.0);
        if n > 1.0 {
            (variance.max(0.0) / n).sqrt()
        } else {
            f64::NAN
        }
    }
}

/// Whether a channel shows why radiance is missing.
fn is_missing_wanted(layout: &Layout) -> bool {
    layout.channels.iter().any(|aov| aov.missing().is_some())
}

fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}

/// The whole image, pixel means.
#[derive(Debug, Clone)]
pub struct Film {
    layout: Layout,
    radiance: Vec<[f64; 3]>,
    unmet: u64,
    /// Per tile, summed over its samples: added up in the order of tiles, whoever rendered them.
    coverage: Vec<Coverage>,
    aovs: Vec<Vec<f64>>,
}

impl Film {
    /// A film that nothing has been placed on.
    pub fn new(layout: Layout) -> Self {
        let n = layout.size[0] as usize * layout.size[1] as usize;
        let tiles = if layout.has_gaps {
            Tile::count(layout.size) as usize
        } else {
            0
        };
        Film {
            radiance: vec![[0.0; 3]; n],
            unmet: 0,
            coverage: vec![Coverage::NONE; tiles],
            aovs: vec![vec![0.0; n]; layout.channels.len()],
            layout,
        }
    }

    /// Places a finished tile.
    pub fn place(&mut self, tile: &TileFilm) {
        let samples = self.layout.samples;
        let scale = 1.0 / samples as f64;
        self.unmet += tile.unmet;
        let index = tile.tile.index(self.layout.size) as usize;
        if let Some(coverage) = self.coverage.get_mut(index) {
            *coverage = tile.coverage;
        }
        let [left, top] = tile.tile.corner.map(|c| c as usize);
        let (width, across) = (self.layout.size[0] as usize, tile.tile.size[0] as usize);
        // Sums to means, row by row of the tile.
        for (row, sums) in tile.radiance.chunks(across.max(1)).enumerate() {
            let first = (top + row) * width + left;
            for (mean, sum) in self.radiance[first..].iter_mut().zip(sums) {
                *mean = sum.map(|sum| sum * scale);
            }
        }
        for (channel, aov) in self.layout.channels.iter().enumerate() {
            for (pixel, (column, row)) in tile.tile.coordinates().enumerate() {
                let at = row as usize * width + column as usize;
                self.aovs[channel][at] = tile.aov(channel, *aov, pixel, samples);
            }
        }
    }

    /// Samples per pixel.
    pub fn samples(&self) -> u32 {
        self.layout.samples
    }

    /// Whether the one sample of each pixel is at its centre.
    pub fn is_centred(&self) -> bool {
        self.layout.pixel_centers
    }

    /// What the visibility in it is worth.
    pub fn precision(&self) -> Precision {
        self.layout.precision
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.layout.size
    }

    /// Mean linear RGB radiance per pixel, row by row from the top.
    pub fn radiance(&self) -> &[[f64; 3]] {
        &self.radiance
    }

    /// The radiance as an array: its shape (height, width, 3), and its numbers in C order.
    pub fn radiance_array(&self) -> ([usize; 3], &[f64]) {
        let [width, height] = self.size().map(|n| n as usize);
        ([height, width, 3], self.radiance().as_flattened())
    }

    /// An auxiliary channel as an array of shape (height, width), where it was asked for.
    pub fn aov_array(&self, aov: Aov) -> Option<([usize; 2], &[f64])> {
        let [width, height] = self.size().map(|n| n as usize);
        Some(([height, width], self.aov(aov)?))
    }

    /// The values of an auxiliary channel, where it was asked for.
    pub fn aov(&self, aov: Aov) -> Option<&[f64]> {
        let channel = self.layout.channels.iter().position(|c| *c == aov)?;
        Some(&self.aovs[channel])
    }

    /// The part of all samples that hit a surface, 0 to 1.
    pub fn met(&self) -> f64 {
        let samples = self.radiance.len() as f64 * self.layout.samples as f64;
        1.0 - self.unmet as f64 / samples
    }

    /// Mean coverage of the image, or none where nothing could be missing.
    pub fn mean_coverage(&self) -> Option<Coverage> {
        let sum = self.coverage.iter().fold(Coverage::NONE, |mut sum, c| {
            sum += *c;
            sum
        });
        let samples = self.radiance.len() as f64 * self.layout.samples as f64;
        (!self.coverage.is_empty()).then(|| sum * (1.0 / samples))
    }

    /// The film as named channels: radiance and those of `channels` that were asked for.
    pub fn channels(&self, channels: &[Aov]) -> Vec<Channel> {
        let rgb = (0..3).map(|c| {
            let values = self.radiance.iter().map(|rgb| rgb[c]).collect();
            Channel {
                name: ["radiance.R", "radiance.G", "radiance.B"][c].into(),
                samples: Samples::F64(values),
            }
        });
        let aovs = channels
            .iter()
            .filter_map(|aov| Some((aov, self.aov(*aov)?)));
        rgb.chain(aovs.map(|(aov, values)| Channel {
            name: aov.name().into(),
            samples: stored(*aov, values),
        }))
        .collect()
    }
}

fn stored(aov: Aov, values: &[f64]) -> Samples {
    if aov.is_identity() {
        Samples::I32(values.iter().map(|v| *v as i32).collect())
    } else {
        Samples::F64(values.to_vec())
    }
}
