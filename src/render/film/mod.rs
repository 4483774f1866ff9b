//! The film: sums of samples per pixel, box filter, in f64 and in a fixed order.
//!
//! A tile is rendered by one thread, each of its pixels sample by sample, and tiles do not overlap. So the film's bits do not depend on the
//! number of threads.

mod layout;
mod tile;

pub use layout::{Layout, TILE, Tile};
pub use tile::TileFilm;

use crate::accel::Precision;
use crate::io::image::{Channel, Samples};
use crate::light::time_texture::Coverage;
use crate::render::aov::Aov;

/// The whole image, pixel means.
#[derive(Debug, Clone)]
pub struct Film {
    layout: Layout,
    radiance: Vec<[f64; 3]>,
    /// Sum over pixels of the fraction of their samples that hit nothing, times the samples of the layout.
    unmet: f64,
    /// The number of passes of `layout.samples` samples, and the relative error requested.
    passes: u32,
    error: Option<f64>,
    /// The number of independent parts in the tile that has the fewest.
    parts: Option<u32>,
    /// Coverage by tile: summed in the order of tiles, whichever threads rendered them.
    coverage: Vec<TileCoverage>,
    aovs: Vec<Vec<f64>>,
}

/// How much of a tile's radiance is known, as sums over samples.
#[derive(Debug, Clone, Copy, Default)]
struct TileCoverage {
    /// Sum over samples that hit surfaces with data.
    sum: Coverage,
    /// The number of these samples, and the number that the sensor blocks.
    from_data: f64,
    hidden: f64,
}

/// A film on which tiles are placed in any order.
#[derive(Debug)]
pub(crate) struct FilmBuilder(Film);

impl FilmBuilder {
    /// An empty film, which is black.
    pub fn new(layout: Layout) -> Self {
        let n = layout.size[0] as usize * layout.size[1] as usize;
        let tiles = if layout.has_gaps {
            Tile::count(layout.size) as usize
        } else {
            0
        };
        FilmBuilder(Film {
            radiance: Vec::with_capacity(n),
            unmet: 0.0,
            passes: 1,
            error: None,
            parts: None,
            coverage: vec![TileCoverage::default(); tiles],
            aovs: vec![vec![0.0; n]; layout.channels.len()],
            layout,
        })
    }

    /// Places a finished tile.
    pub fn place(&mut self, tile: &TileFilm) {
        // Rows are made when they are first needed, so that they are in the cache when tiles are written to them.
        let Tile { corner, size } = tile.tile;
        self.extend(corner[1] + size[1]);
        self.0.place(tile);
    }

    /// Makes the rows up to row `end` that do not exist yet, black.
    fn extend(&mut self, end: u32) {
        let pixels = end as usize * self.0.layout.size[0] as usize;
        if pixels > self.0.radiance.len() {
            self.0.radiance.resize(pixels, [0.0; 3]);
        }
    }

    /// The film; black outside the tiles placed.
    pub fn finish(mut self) -> Film {
        self.extend(self.0.layout.size[1]);
        self.0
    }
}

impl Film {
    /// Places a finished tile.
    fn place(&mut self, tile: &TileFilm) {
        let samples = tile.taken(&self.layout);
        let parts = tile.parts().map(|parts| parts.taken);
        self.parts = self.parts.into_iter().chain(parts).min();
        // 1 if there is one pass.
        let share = f64::from(self.layout.samples) / f64::from(samples);
        self.unmet += tile.unmet as f64 * share;
        let index = tile.tile.index(self.layout.size) as usize;
        if let Some(coverage) = self.coverage.get_mut(index) {
            *coverage = TileCoverage {
                sum: tile.coverage * share,
                from_data: tile.from_data * share,
                hidden: tile.hidden * share,
            };
        }
        let scale = 1.0 / samples as f64;
        let [left, top] = tile.tile.corner.map(|c| c as usize);
        let (width, across) = (self.layout.size[0] as usize, tile.tile.size[0] as usize);
        // Convert sums to means, row by row of the tile.
        for (row, sums) in tile.radiance.chunks(across.max(1)).enumerate() {
            let first = (top + row) * width + left;
            let means = self.radiance[first..].iter_mut();
            match &tile.parts {
                None => {
                    for (mean, sum) in means.zip(sums) {
                        *mean = sum.map(|sum| sum * scale);
                    }
                }
                Some(parts) => {
                    for (at, mean) in means.take(sums.len()).enumerate() {
                        *mean = parts.mean(row * across + at);
                    }
                }
            }
        }
        for (channel, aov) in self.layout.channels.iter().enumerate() {
            let values = tile.aov(channel, *aov, samples);
            for ((column, row), value) in tile.tile.coordinates().zip(values) {
                let at = row as usize * width + column as usize;
                self.aovs[channel][at] = value;
            }
        }
    }

    /// The number of samples per pixel in each pass.
    pub fn samples(&self) -> u32 {
        self.layout.samples
    }

    /// The maximum number of passes of any pixel.
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// The relative error that tiles were to reach, if requested.
    pub(crate) fn error_asked_for(&self) -> Option<f64> {
        self.error
    }

    /// The degrees of freedom of standard errors, if these were requested and can be computed: if noise is normal, an error over its standard error is
    /// distributed as Student's t with this number of degrees of freedom. If tiles took passes until they reached an error, this is the number for the tile
    /// with the fewest.
    pub fn degrees_of_freedom(&self) -> Option<f64> {
        let parts = self.parts.filter(|parts| *parts > 1)?;
        self.aov(Aov::StandardError)?;
        Some(tile::degrees_of_freedom(parts))
    }

    /// The same film, after this number of passes that were to reach this error.
    pub(super) fn with_passes(self, passes: u32, error: Option<f64>) -> Self {
        Film {
            passes,
            error,
            ..self
        }
    }

    /// Whether there is only one sample per pixel, at its centre.
    pub(crate) fn is_centred(&self) -> bool {
        self.layout.pixel_centers
    }

    /// Precision of visibility.
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

    /// An auxiliary channel as an array of shape (height, width), if it was requested.
    pub fn aov_array(&self, aov: Aov) -> Option<([usize; 2], &[f64])> {
        let [width, height] = self.size().map(|n| n as usize);
        Some(([height, width], self.aov(aov)?))
    }

    /// The values of an auxiliary channel, if it was requested.
    pub fn aov(&self, aov: Aov) -> Option<&[f64]> {
        let channel = self.layout.channels.iter().position(|c| *c == aov)?;
        Some(&self.aovs[channel])
    }

    /// The fraction of samples that hit a surface, 0 to 1.
    pub fn met(&self) -> f64 {
        1.0 - self.unmet / self.samples_of_all()
    }

    /// Mean coverage over the samples that hit surfaces with data, that is, surfaces lit by cubes; `None` if no sample does. Background and
    /// surfaces that need no data do not count.
    pub fn mean_coverage(&self) -> Option<Coverage> {
        let TileCoverage { sum, from_data, .. } = self.coverage();
        (from_data > 0.0).then(|| sum * (1.0 / from_data))
    }

    /// The fraction of samples that hit surfaces with data, 0 to 1.
    pub fn from_data(&self) -> f64 {
        self.coverage().from_data / self.samples_of_all()
    }

    /// The fraction of samples that the sensor blocks from its own pinhole, 0 to 1.
    pub fn hidden(&self) -> f64 {
        self.coverage().hidden / self.samples_of_all()
    }

    /// The sums over all tiles, in tile order.
    fn coverage(&self) -> TileCoverage {
        let mut all = TileCoverage::default();
        for tile in &self.coverage {
            all.sum += tile.sum;
            all.from_data += tile.from_data;
            all.hidden += tile.hidden;
        }
        all
    }

    fn samples_of_all(&self) -> f64 {
        self.radiance.len() as f64 * self.layout.samples as f64
    }

    /// The film as named channels: radiance and those of `channels` that were requested.
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
