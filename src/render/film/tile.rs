//! The sums of a tile, sample by sample.

use std::ops::Range;

use super::layout::{Layout, Tile};
use super::parts::Parts;
use crate::accel::vectors::{BLOCK, VectorLoop, dispatch};
use crate::light::time_texture::Coverage;
use crate::render::aov::{Aov, Combine, Why};

/// The sums of one tile.
#[derive(Debug)]
pub struct TileFilm {
    pub(super) tile: Tile,
    pub(super) radiance: Vec<[f64; 3]>,
    /// Samples that hit nothing.
    pub(super) unmet: u64,
    /// Sums over the samples of the tile that hit surfaces with data.
    pub(super) coverage: Coverage,
    /// The number of these samples.
    pub(super) from_data: f64,
    /// The number of samples that the sensor itself blocks.
    pub(super) hidden: f64,
    /// Whether the sensor can do that.
    covers_itself: bool,
    /// Σ of the known fractions, for the channel.
    held: Vec<f64>,
    /// Σ of the missing fractions by reason, for the channels.
    missing: Vec<Missing>,
    /// The completed parts, if the samples have several.
    pub(super) parts: Option<Parts>,
    /// Samples that hit a surface.
    hits: Vec<u32>,
    /// Samples for which the film sees nothing.
    blind: Vec<u32>,
    /// Squared distance from the pixel's centre of the nearest sample so far.
    nearest: Vec<f64>,
    aovs: Vec<Vec<f64>>,
}

/// Σ of the missing fractions of the samples' radiance, by reason.
#[derive(Debug, Clone, Copy, Default)]
struct Missing {
    before: f64,
    after: f64,
    off_texture: f64,
    occluded: f64,
}

impl Missing {
    fn add(&mut self, coverage: Coverage) {
        // Destructured, so that a forgotten reason does not compile.
        let Coverage {
            held: _,
            before,
            after,
            off_texture,
            occluded,
        } = coverage;
        self.before += before;
        self.after += after;
        self.off_texture += off_texture;
        self.occluded += occluded;
    }

    fn of(self, why: Why) -> f64 {
        match why {
            Why::Before => self.before,
            Why::After => self.after,
            Why::OffTexture => self.off_texture,
            Why::Occluded => self.occluded,
        }
    }
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
            from_data: 0.0,
            hidden: 0.0,
            covers_itself: layout.covers_itself,
            held: vec![0.0; some(layout.has_gaps && layout.channels.contains(&Aov::Coverage))],
            missing: vec![Missing::default(); some(layout.has_gaps && is_missing_wanted(layout))],
            parts: (layout.samples_per_part() < layout.samples)
                .then(|| Parts::new(n, layout.samples_per_part())),
            hits: vec![0; some(aovs)],
            blind: vec![0; some(aovs)],
            nearest: vec![f64::INFINITY; some(aovs)],
            aovs: vec![vec![0.0; n]; layout.channels.len()],
        }
    }

    /// An empty film of `tile`, which reuses `kept` if that has as many pixels of this layout.
    pub(crate) fn reused<'a>(
        kept: &'a mut Option<TileFilm>,
        tile: Tile,
        layout: &Layout,
    ) -> &'a mut TileFilm {
        let fits = |film: &TileFilm| film.parts.is_none() && film.radiance.len() == tile.pixels();
        match kept {
            Some(film) if fits(film) => film.clear(tile),
            _ => *kept = None,
        }
        kept.get_or_insert_with(|| TileFilm::new(tile, layout))
    }

    /// Turns this into the empty film of tile `of`, which must have as many pixels.
    fn clear(&mut self, of: Tile) {
        // Destructured, so that a forgotten field does not compile.
        let TileFilm {
            tile,
            radiance,
            unmet,
            coverage,
            from_data,
            hidden,
            covers_itself: _,
            held,
            missing,
            parts: _,
            hits,
            blind,
            nearest,
            aovs,
        } = self;
        (*tile, *unmet, *coverage) = (of, 0, Coverage::NONE);
        (*from_data, *hidden) = (0.0, 0.0);
        radiance.fill([0.0; 3]);
        held.fill(0.0);
        missing.fill(Missing::default());
        hits.fill(0);
        blind.fill(0);
        nearest.fill(f64::INFINITY);
        aovs.iter_mut().for_each(|aov| aov.fill(0.0));
    }

    /// The pixel of ray `ray`: each sample has one ray per pixel.
    #[inline]
    fn pixel(&self, ray: usize) -> usize {
        let pixels = self.radiance.len();
        // Most batches have one sample, and need no division.
        if ray < pixels { ray } else { ray % pixels }
    }

    /// Adds the radiance of ray `ray` to its pixel.
    #[inline]
    pub fn add(&mut self, ray: usize, radiance: [f64; 3]) {
        // The box filter: all samples of the pixel have equal weight.
        let pixel = self.pixel(ray);
        let sum = &mut self.radiance[pixel];
        for (sum, value) in sum.iter_mut().zip(radiance) {
            *sum += value;
        }
    }

    /// The sum of the radiance of a pixel, for adding sample by sample.
    #[inline(always)]
    pub(crate) fn sum_mut(&mut self, pixel: usize) -> &mut [f64; 3] {
        &mut self.radiance[pixel]
    }

    /// The same of consecutive pixels.
    #[inline(always)]
    pub(crate) fn sums_mut(&mut self, pixels: Range<usize>) -> &mut [[f64; 3]] {
        &mut self.radiance[pixels]
    }

    /// Adds the radiance of `each` samples of each pixel from `first` on, one after the other.
    pub(crate) fn add_samples(&mut self, first: usize, each: usize, samples: &[[f64; 3]]) {
        dispatch(AddSamples {
            sums: &mut self.radiance[first..],
            each,
            samples,
        });
    }

    /// Whether [`TileFilm::add_known`] and [`TileFilm::cover`] record anything by pixel.
    pub(crate) fn has_coverage_channels(&self) -> bool {
        !self.held.is_empty() || !self.missing.is_empty()
    }

    /// Adds the radiance of consecutive rays from `first` on, each to its pixel.
    pub(crate) fn add_row(&mut self, first: usize, radiance: &[[f64; 3]]) {
        // Consecutive rays of one sample are consecutive pixels.
        let pixels = first..first + radiance.len();
        match self.radiance.get_mut(pixels) {
            Some(sums) => {
                let sums = sums.as_flattened_mut().iter_mut();
                for (sum, value) in sums.zip(radiance.as_flattened()) {
                    *sum += value;
                }
            }
            None => (first..)
                .zip(radiance)
                .for_each(|(ray, rgb)| self.add(ray, *rgb)),
        }
    }

    /// Adds the radiance of consecutive rays from `first` on, times their factors, each to its pixel.
    pub(crate) fn add_scaled(&mut self, first: usize, radiance: &[[f64; 3]], factors: &[f64]) {
        let pixels = first..first + radiance.len();
        // Consecutive rays of one sample are consecutive pixels.
        if let Some(sums) = self.radiance.get_mut(pixels) {
            return dispatch(AddScaled {
                sums,
                radiance,
                factors,
            });
        }
        for (ray, (rgb, factor)) in (first..).zip(radiance.iter().zip(factors)) {
            self.add(ray, rgb.map(|value| factor * value));
        }
    }

    /// An empty film of `tile` for any number of passes, each of which is a part.
    pub(in crate::render) fn of_passes(tile: Tile, layout: &Layout) -> Self {
        TileFilm {
            parts: Some(Parts::new(tile.pixels(), layout.samples)),
            ..TileFilm::new(tile, layout)
        }
    }

    /// The first ones of `samples`, at most `most`, that can be added before any of them is completed.
    pub(crate) fn together(&self, samples: Range<u32>, most: u32) -> Range<u32> {
        let first = samples.start;
        // Samples of different parts are kept apart.
        let left = self
            .parts
            .as_ref()
            .map_or(u32::MAX, |parts| parts.samples - first % parts.samples);
        first..samples.end.min(first.saturating_add(left.min(most)))
    }

    /// Completes `samples` of all pixels, which belong to one part.
    pub(crate) fn end_samples(&mut self, samples: Range<u32>) {
        if let Some(parts) = &mut self.parts
            && samples.end.is_multiple_of(parts.samples)
        {
            parts.add(&self.radiance);
            self.radiance.fill([0.0; 3]);
        }
    }

    /// The parts, if there are several.
    pub(in crate::render) fn parts(&self) -> Option<&Parts> {
        self.parts.as_ref()
    }

    /// The same, mutable.
    pub(in crate::render) fn parts_mut(&mut self) -> Option<&mut Parts> {
        self.parts.as_mut()
    }

    /// The tile.
    pub(in crate::render) fn tile(&self) -> Tile {
        self.tile
    }

    /// Everything that is kept between passes, in a fixed order: numbers as `f64`s, and counts as `u64`s.
    pub(in crate::render) fn each_sum(
        &mut self,
        numbers: &mut dyn FnMut(&mut [f64]),
        counts: &mut dyn FnMut(&mut u64),
    ) {
        // Destructured, so that a forgotten field does not compile.
        let Coverage {
            held,
            before,
            after,
            off_texture,
            occluded,
        } = &mut self.coverage;
        for part in [held, before, after, off_texture, occluded] {
            numbers(std::slice::from_mut(part));
        }
        numbers(std::slice::from_mut(&mut self.from_data));
        numbers(std::slice::from_mut(&mut self.hidden));
        numbers(&mut self.held);
        for missing in &mut self.missing {
            let Missing {
                before,
                after,
                off_texture,
                occluded,
            } = missing;
            for part in [before, after, off_texture, occluded] {
                numbers(std::slice::from_mut(part));
            }
        }
        numbers(&mut self.nearest);
        self.aovs.iter_mut().for_each(|aov| numbers(aov));
        counts(&mut self.unmet);
        // Files store counts as 64 bits; in memory 32 are enough.
        for samples in self.hits.iter_mut().chain(&mut self.blind) {
            let mut count = u64::from(*samples);
            counts(&mut count);
            *samples = count as u32;
        }
        if let Some(parts) = &mut self.parts {
            parts.each_sum(numbers, counts);
        }
    }

    /// Records samples that hit nothing.
    pub(crate) fn add_misses(&mut self, samples: u64) {
        self.unmet += samples;
    }

    /// Adds how much of the radiance of ray `ray` is covered by its surface's data; it counts as `part` of a sample.
    #[inline]
    pub(crate) fn add_coverage(&mut self, ray: usize, coverage: Coverage, part: f64) {
        self.coverage += coverage;
        self.from_data += part;
        self.add_to_pixel(ray, coverage);
    }

    /// Records a sensor element, for ray `ray`, that no light reaches: either the sensor itself blocks it, or there is nothing to see
    /// beyond the edge of a fisheye's picture, which counts as background.
    pub(crate) fn add_blind(&mut self, ray: usize) {
        match self.covers_itself {
            true => {
                self.hidden += 1.0;
                self.add_to_pixel(ray, Coverage::OCCLUDED);
            }
            false => self.add_to_pixel(ray, Coverage::HELD),
        }
    }

    /// Adds to the coverage channels of a pixel.
    #[inline]
    pub(crate) fn add_to_pixel(&mut self, ray: usize, coverage: Coverage) {
        let pixel = self.pixel(ray);
        if let Some(held) = self.held.get_mut(pixel) {
            *held += coverage.held;
        }
        if let Some(missing) = self.missing.get_mut(pixel) {
            missing.add(coverage);
        }
    }

    /// Records `rays` whose radiance is fully known and does not come from data.
    pub(crate) fn add_known(&mut self, rays: &[u32]) {
        if !self.held.is_empty() {
            for ray in rays {
                let pixel = self.pixel(*ray as usize);
                self.held[pixel] += 1.0;
            }
        }
    }

    /// Adds how much of the radiance of `rays`, whose surface has data, the data cover: full coverage, except for `parts`, which are in
    /// order.
    #[inline]
    pub(crate) fn cover(&mut self, rays: &[u32], parts: impl Iterator<Item = (usize, Coverage)>) {
        let mut begin = 0;
        self.from_data += rays.len() as f64;
        let has_channels = self.has_coverage_channels();
        // Without channels only the sum is needed: it stays in registers. Fully covered samples are counted rather than added up: this is
        // exact, however many there are.
        let mut sum = self.coverage;
        for (at, coverage) in parts {
            if has_channels {
                self.add_known(&rays[begin..at]);
                self.add_to_pixel(rays[at] as usize, coverage);
            }
            sum.held += (at - begin) as f64;
            sum += coverage;
            begin = at + 1;
        }
        if has_channels {
            self.add_known(&rays[begin..]);
        }
        sum.held += (rays.len() - begin) as f64;
        self.coverage = sum;
    }

    /// Records a sample in `pixel` for which the film sees nothing.
    pub(crate) fn add_blind_sample(&mut self, pixel: usize) {
        self.blind[pixel] += 1;
    }

    /// Records a sample at `offset` in `pixel`; true if it is the nearest to the centre so far.
    pub(crate) fn is_nearest_to_centre(
        &mut self,
        pixel: usize,
        offset: [f64; 2],
        hit: bool,
    ) -> bool {
        self.hits[pixel] += hit as u32;
        // If distances are equal, the earlier sample counts.
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

    /// The finished values of `aov` after `samples` samples, pixel by pixel.
    pub(super) fn aov(&self, channel: usize, aov: Aov, samples: u32) -> Vec<f64> {
        let sums = &self.aovs[channel];
        let each = |value: &dyn Fn(usize) -> f64| (0..sums.len()).map(value).collect();
        let parts = self.parts.as_ref();
        match aov.combine() {
            Combine::Coverage => each(&|pixel| {
                let held = self.held.get(pixel);
                held.map_or(1.0, |held| held / samples as f64)
            }),
            // These sums are not kept if nothing can be missing.
            Combine::Missing(why) => each(&|pixel| {
                let sums = self.missing.get(pixel);
                sums.map_or(0.0, |sums| sums.of(why) / samples as f64)
            }),
            Combine::StandardError => match parts {
                Some(parts) => parts.standard_errors(self.tile.size[0] as usize),
                None => vec![f64::NAN; sums.len()],
            },
            Combine::Samples => {
                let counted = parts.map(|p| p.counted.iter().sum::<u32>() * p.samples);
                vec![f64::from(counted.unwrap_or(samples)); sums.len()]
            }
            Combine::MeanOfAll => each(&|pixel| sums[pixel] / samples as f64),
            // 0/0 = NaN if the film sees nothing.
            Combine::MeanOfSeeing => {
                each(&|pixel| sums[pixel] / (samples - self.blind[pixel]) as f64)
            }
            Combine::Nearest | Combine::NearestIdentity => sums.clone(),
            // 0/0 = NaN if nothing was hit.
            Combine::MeanOfHits => each(&|pixel| sums[pixel] / self.hits[pixel] as f64),
        }
    }

    /// The number of samples taken of each pixel.
    pub(super) fn taken(&self, layout: &Layout) -> u32 {
        let parts = self.parts.as_ref();
        parts.map_or(layout.samples, |parts| parts.taken * parts.samples)
    }
}

/// The loop that adds samples to the sums of their pixels.
struct AddSamples<'a> {
    sums: &'a mut [[f64; 3]],
    /// The number of samples of a pixel.
    each: usize,
    samples: &'a [[f64; 3]],
}

impl VectorLoop for AddSamples<'_> {
    #[inline(always)]
    fn run(self) {
        let of_pixels = self.samples.chunks(self.each.max(1));
        for (sum, samples) in self.sums.iter_mut().zip(of_pixels) {
            // In a vector of four.
            let [r, g, b] = *sum;
            let mut wide = [r, g, b, 0.0];
            for [r, g, b] in samples {
                let sample = [*r, *g, *b, 0.0];
                for k in 0..4 {
                    wide[k] += sample[k];
                }
            }
            let [r, g, b, _] = wide;
            *sum = [r, g, b];
        }
    }
}

/// The loop that adds radiance, times its factors, to the sums.
pub(crate) struct AddScaled<'a> {
    pub sums: &'a mut [[f64; 3]],
    pub radiance: &'a [[f64; 3]],
    pub factors: &'a [f64],
}

impl VectorLoop for AddScaled<'_> {
    #[inline(always)]
    fn run(self) {
        // Each factor three times, then a loop over all numbers. Unrolled by pixels, the loop would be compiled to gathers, which are slow.
        let mut wide = [[0.0; 3]; BLOCK];
        let of_blocks = self.radiance.chunks(BLOCK).zip(self.factors.chunks(BLOCK));
        for (sums, (radiance, factors)) in self.sums.chunks_mut(BLOCK).zip(of_blocks) {
            for (wide, factor) in wide.iter_mut().zip(factors) {
                *wide = [*factor; 3];
            }
            let terms = radiance.as_flattened().iter().zip(wide.as_flattened());
            for (sum, (value, factor)) in sums.as_flattened_mut().iter_mut().zip(terms) {
                *sum += factor * value;
            }
        }
    }
}

/// Whether a channel shows why radiance is missing.
fn is_missing_wanted(layout: &Layout) -> bool {
    let is_reason = |aov: &Aov| matches!(aov.combine(), Combine::Missing(_));
    layout.channels.iter().any(is_reason)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Precision;

    fn layout(size: [u32; 2]) -> Layout {
        Layout {
            size,
            samples: 2,
            pixel_centers: false,
            precision: Precision::Certified,
            channels: Vec::new(),
            has_gaps: false,
            covers_itself: false,
        }
    }

    /// Different values, whose sums depend on their order.
    fn radiance(count: usize) -> Vec<[f64; 3]> {
        let all = (1..=count).map(|k| [1.0, 0.1, 0.7].map(|c| c / k as f64));
        all.collect()
    }

    #[test]
    fn rays_in_a_row_are_added_as_each_of_them_is() {
        // More pixels than a block has.
        let layout = layout([13, 11]);
        let radiance = radiance(160);
        let factors: Vec<f64> = (1..161).map(|k| 1.0 + 0.3 / f64::from(k)).collect();
        // Some rays of the first sample, its last ray, and rays of both samples.
        let some = [
            (0, 143),
            (3, 4),
            (7, 64),
            (1, 65),
            (142, 1),
            (10, 160),
            (150, 3),
            (2, 0),
        ];
        for (first, count) in some {
            let tile = Tile::of_image(layout.size, 0);
            let [mut together, mut alone] = [(); 2].map(|()| TileFilm::new(tile, &layout));
            // Twice, so that the sums are not zero.
            for _ in 0..2 {
                together.add_scaled(first, &radiance[..count], &factors[..count]);
                for k in 0..count {
                    alone.add(first + k, radiance[k].map(|c| factors[k] * c));
                }
            }
            assert_eq!(together.radiance, alone.radiance, "{first} {count}");
            assert_eq!(count == 0, together.radiance == [[0.0; 3]; 143]);
        }
    }

    #[test]
    fn samples_of_pixels_are_added_as_each_of_them_is() {
        let layout = layout([13, 11]);
        let tile = Tile::of_image(layout.size, 0);
        for (first, each, pixels) in [
            (0, 1, 143),
            (26, 4, 39),
            (13, 3, 26),
            (142, 16, 1),
            (0, 2, 0),
        ] {
            let radiance = radiance(pixels * each);
            let [mut together, mut alone] = [(); 2].map(|()| TileFilm::new(tile, &layout));
            for _ in 0..2 {
                together.add_samples(first, each, &radiance);
                for (k, sample) in radiance.iter().enumerate() {
                    alone.add(first + k / each, *sample);
                }
            }
            assert_eq!(together.radiance, alone.radiance, "{first} {each}");
            let lit = together.radiance.iter().filter(|sum| **sum != [0.0; 3]);
            assert_eq!(lit.count(), pixels);
        }
    }
}
