//! The film: sums of samples per pixel, box filter, in f64 and in a fixed order.
//!
//! A tile is rendered by one thread, each of its pixels sample by sample, and tiles do not overlap. So the film's bits do not depend on the
//! number of threads.

mod layout;
mod parts;
mod tile;

pub use layout::{Layout, TILE, Tile};
pub(crate) use tile::AddScaled;
pub use tile::TileFilm;

use std::sync::{Mutex, PoisonError};

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

/// Where the tiles of a film are placed, in any order and from any thread: each row of tiles has a lock of its own.
pub(crate) struct Rows<'a>(Vec<Mutex<Row<'a>>>);

/// A row of tiles.
struct Row<'a> {
    layout: &'a Layout,
    radiance: &'a mut [[f64; 3]],
    aovs: Vec<&'a mut [f64]>,
    coverage: &'a mut [TileCoverage],
    /// As in [`Film`], of these tiles. Sums are of multiples of the same share unless there are passes, whose tiles are placed in order.
    unmet: f64,
    parts: Option<u32>,
}

impl Rows<'_> {
    /// Places a finished tile.
    pub fn place(&self, tile: &TileFilm) {
        let row = &self.0[(tile.tile.corner[1] / TILE) as usize];
        // A poisoned lock means a panic in another thread, which rayon propagates.
        row.lock()
            .unwrap_or_else(PoisonError::into_inner)
            .place(tile);
    }
}

impl Row<'_> {
    fn place(&mut self, tile: &TileFilm) {
        let samples = tile.taken(self.layout);
        let parts = tile.parts().map(|parts| parts.taken);
        self.parts = self.parts.into_iter().chain(parts).min();
        // 1 if there is one pass.
        let share = f64::from(self.layout.samples) / f64::from(samples);
        self.unmet += tile.unmet as f64 * share;
        let Tile { corner, size } = tile.tile;
        if let Some(coverage) = self.coverage.get_mut((corner[0] / TILE) as usize) {
            *coverage = TileCoverage {
                sum: tile.coverage * share,
                from_data: tile.from_data * share,
                hidden: tile.hidden * share,
            };
        }
        let scale = 1.0 / samples as f64;
        let [left, width, across] = [corner[0], self.layout.size[0], size[0]].map(|n| n as usize);
        // Convert sums to means, row by row of the tile.
        for (row, sums) in tile.radiance.chunks(across.max(1)).enumerate() {
            let means = self.radiance[row * width + left..].iter_mut();
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
        let channels = self.layout.channels.iter().zip(&mut self.aovs);
        for (channel, (aov, values)) in channels.enumerate() {
            let of_tile = tile.aov(channel, *aov, samples);
            for ((column, row), value) in tile.tile.coordinates().zip(of_tile) {
                values[(row - corner[1]) as usize * width + column as usize] = value;
            }
        }
    }
}

impl Film {
    /// The film on which `render` places tiles; black outside them.
    ///
    /// # Errors
    /// Those of `render`.
    pub(crate) fn of_tiles<E>(
        layout: &Layout,
        render: impl FnOnce(&Rows) -> Result<(), E>,
    ) -> Result<Film, E> {
        Film::of_all_tiles(layout, None, render)
    }

    /// The film on which `render` places all tiles, in the memory of `over`.
    ///
    /// # Errors
    /// Those of `render`.
    pub(crate) fn of_all_tiles<E>(
        layout: &Layout,
        over: Option<Film>,
        render: impl FnOnce(&Rows) -> Result<(), E>,
    ) -> Result<Film, E> {
        let [width, height] = layout.size.map(|n| n as usize);
        let n = width * height;
        let of_gaps = if layout.has_gaps {
            Tile::count(layout.size)
        } else {
            0
        };
        let (radiance, aovs) =
            over.map_or_else(Default::default, |film| (film.radiance, film.aovs));
        let mut radiance = reused(radiance, n);
        let mut aovs: Vec<_> = (aovs.into_iter().chain(std::iter::repeat_with(Vec::new)))
            .take(layout.channels.len())
            .map(|aov| reused(aov, n))
            .collect();
        let mut coverage = vec![TileCoverage::default(); of_gaps as usize];

        // All arrays, row of tiles by row of tiles.
        let pixels = width * TILE as usize;
        let mut of_aovs: Vec<_> = aovs.iter_mut().map(|a| a.chunks_mut(pixels)).collect();
        let mut of_coverage = coverage.chunks_mut(layout.size[0].div_ceil(TILE) as usize);
        let rows = radiance.chunks_mut(pixels).map(|radiance| {
            Mutex::new(Row {
                layout,
                radiance,
                aovs: of_aovs.iter_mut().filter_map(Iterator::next).collect(),
                coverage: of_coverage.next().unwrap_or_default(),
                unmet: 0.0,
                parts: None,
            })
        });
        let rows = Rows(rows.collect());
        render(&rows)?;

        let (mut unmet, mut parts) = (0.0, None);
        for row in rows.0 {
            let row = row.into_inner().unwrap_or_else(PoisonError::into_inner);
            unmet += row.unmet;
            parts = parts.into_iter().chain(row.parts).min();
        }
        Ok(Film {
            layout: layout.clone(),
            radiance,
            unmet,
            passes: 1,
            error: None,
            parts,
            coverage,
            aovs,
        })
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
        Some(parts::degrees_of_freedom(parts))
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

/// `n` values that will be replaced: the old ones if these are as many, else new ones, so that a film takes no more memory than its own.
fn reused<T: Clone + Default>(old: Vec<T>, n: usize) -> Vec<T> {
    if old.len() == n {
        return old;
    }
    drop(old);
    vec![T::default(); n]
}

fn stored(aov: Aov, values: &[f64]) -> Samples {
    if aov.is_identity() {
        Samples::I32(values.iter().map(|v| *v as i32).collect())
    } else {
        Samples::F64(values.to_vec())
    }
}
