//! Means over time spans: for exposures of finite length, and for parts of a tilted surface.
//!
//! Applied to the bins, a filter gives L(t) = Σ_k a_k φ(b − ½ − k) with b = (t − start)/w, so that over [b₀, b₁] its mean is
//!
//! ```text
//! 1/(b₁ − b₀) Σ_k a_k (Φ(b₁ − ½ − k) − Φ(b₀ − ½ − k)),      Φ(x) = ∫ φ from −∞ to x
//! ```
//!
//! - nearest: φ is 1 on [−½, ½];
//! - linear: Φ = (1 + x)²/2 on [−1, 0];
//! - cubic: φ = 3/2 |x|³ − 5/2 x² + 1 on |x| ≤ 1 and −½ |x|³ + 5/2 x² − 4 |x| + 2 on |x| ≤ 2, so that ∫ from 0 to x is
//!   3/8 x⁴ − 5/6 x³ + x, then 13/24 + (−1/8 x⁴ + 5/6 x³ − 2x² + 2x − 17/24); Φ = ½ + sign x times that;
//! - cubic from means: (26 Φ(x) − Φ(x − 1) − Φ(x + 1))/24 of the cubic one.
//!
//! Each Φ is 0 up to −3 and 1 from 3 on, so bins that far inside all have the weight 1/(b₁ − b₀): their sum is a difference of prefix
//! sums. These are stored at every 16th bin, which takes an eighth of the memory of f64 samples, each as a sum of two f64, so that a
//! faint tail keeps its digits after a bright peak. Without them (for cubes on disk) all bins are added one by one: the same but for rounding,
//! more slowly.
//!
//! Φ is rounded by about 2⁻⁵³, and its difference, over a length of few bins ℓ, by 2⁻⁵³/ℓ of the mean; the value in the middle differs from
//! the mean by at most ℓ/4 of the steepest kink, that of the linear filter. So shorter spans than 2⁻²⁶ are read in their middle. The nearest
//! filter jumps: its bins share such a span by their exact parts of it. Spans that begin and end at one number, as the spacing of f64 at
//! late times can be longer than an exposure, are moments.
//!
//! If widths differ, bins have weights of their own: the sums of those of the lookups that make up the mean (`irregular`).
//!
//! Times beyond the data follow the policy, weighted by the fraction of the span that is there.

use rayon::prelude::*;

use super::axis::{Moment, Phase, Reading, Timeline};
use super::irregular::Irregular;
use super::near::Near;
use super::weights::BinWeights;
use crate::io::cube::{Cube, CubeStore};
use crate::scene::model::{Fill, TimeFilter};

/// Lengths in bins below which a span is read in its middle.
const SHORT: f64 = 1.0 / (1u64 << 26) as f64;
/// Bins between prefix sums.
const BLOCK: usize = 16;
/// Distance in bins from a bin's centre beyond which its weight is 0.
const REACH: f64 = 3.0;
/// Distance in bins from the data beyond which a held end is constant.
const FAR: f64 = 4.0;
/// Maximum number of bins at the ends of a span that are neither outside it nor full: at each end those within the reach.
const ENDS: usize = 18;

/// Sums over all bins before every 16th, for each texel and channel.
#[derive(Debug)]
pub(super) struct PrefixSums {
    /// Texel by texel, block by block, channel by channel: a sum and its rounding error.
    sums: Vec<[f64; 2]>,
    blocks: usize,
    channels: usize,
}

/// The bins that a time span reads.
#[derive(Debug, Clone, Default)]
pub(super) struct Span {
    /// Bins with weights of their own.
    ends: [(usize, f64); ENDS],
    count: usize,
    /// Bins that all have the weight `full_weight`, or that times their own.
    full: std::ops::Range<usize>,
    full_weight: f64,
    /// The weights of the bins `full` if widths differ.
    own: Vec<f64>,
    /// The fractions of the span before, inside and after the data.
    pub parts: [f64; 3],
}

impl PrefixSums {
    /// Bytes of the sums of a cube of this shape.
    pub fn bytes([h, w, t, c]: [usize; 4]) -> u64 {
        [h, w, t / BLOCK + 1, c, size_of::<[f64; 2]>()]
            .iter()
            .fold(1, |product: u64, n| product.saturating_mul(*n as u64))
    }

    pub fn new(cube: &Cube) -> PrefixSums {
        let [h, w, bins, channels] = cube.shape;
        let blocks = bins / BLOCK + 1;
        let mut sums = vec![[0.0; 2]; h * w * blocks * channels];
        let texels = sums.par_chunks_exact_mut(blocks * channels);
        texels.enumerate().for_each(|(texel, sums)| {
            let first = texel * bins * channels;
            for channel in 0..channels {
                let mut running = [0.0; 2];
                for block in 0..blocks {
                    // Before the block's own bins are added.
                    sums[block * channels + channel] = running;
                    for bin in block * BLOCK..((block + 1) * BLOCK).min(bins) {
                        let sample = cube.samples.get(first + bin * channels + channel);
                        add(&mut running, sample.unwrap_or(0.0));
                    }
                }
            }
        });
        PrefixSums {
            sums,
            blocks,
            channels,
        }
    }

    /// The sum of blocks `from` to `to` of a texel.
    fn between(&self, texel: usize, from: usize, to: usize, channel: usize) -> f64 {
        let at = |block: usize| self.sums[(texel * self.blocks + block) * self.channels + channel];
        let ([low, low_rest], [high, high_rest]) = (at(from), at(to));
        (high - low) + (high_rest - low_rest)
    }
}

/// Adds exactly, up to rounding of the compensation (Knuth's two-sum).
fn add(sum: &mut [f64; 2], x: f64) {
    let total = sum[0] + x;
    let part = total - sum[0];
    sum[1] += (sum[0] - (total - part)) + (x - part);
    sum[0] = total;
}

/// Φ of a filter.
fn integral(filter: TimeFilter, x: f64) -> f64 {
    let cubic = |x: f64| {
        let y = x.abs();
        if y >= 2.0 {
            return f64::from(x > 0.0);
        }
        // ∫ of the Catmull–Rom kernel from 0 to y: 1 − 5/2 y² + 3/2 y³ up to 1, 2 − 4 y + 5/2 y² − ½ y³ from there to 2.
        let half = match y <= 1.0 {
            true => ((0.375 * y - 5.0 / 6.0) * y * y + 1.0) * y,
            false => {
                13.0 / 24.0 + ((((5.0 / 6.0 - 0.125 * y) * y - 2.0) * y + 2.0) * y - 17.0 / 24.0)
            }
        };
        0.5 + half.copysign(x)
    };
    match filter {
        TimeFilter::Nearest => (x + 0.5).clamp(0.0, 1.0),
        TimeFilter::Linear => {
            let y = 1.0 - x.abs().min(1.0);
            let outer = 0.5 * y * y;
            if x < 0.0 { outer } else { 1.0 - outer }
        }
        TimeFilter::Cubic => cubic(x),
        // The kernel minus 1/24 of its second difference.
        TimeFilter::CubicMeans => (26.0 * cubic(x) - cubic(x - 1.0) - cubic(x + 1.0)) / 24.0,
    }
}

impl Timeline {
    /// The reads for the times from `from` to `to`, which must be finite and ascending.
    pub(super) fn span(&self, from: f64, to: f64) -> Span {
        let filter = match &self.reading {
            Reading::Uniform(filter) => *filter,
            Reading::Irregular(bins) => return self.irregular_span(bins, from, to),
        };
        let last = self.bins as f64;
        let [b0, b1] = [from, to].map(|t| (t - self.start) * self.bins_per_metre);
        let length = b1 - b0;
        if !length.is_normal() {
            return Span::at(self.moment(from));
        }
        let before = (b1.min(0.0) - b0).max(0.0) / length;
        let after = (b1 - b0.max(last)).max(0.0) / length;
        let mut span = Span {
            ends: [(0, 0.0); ENDS],
            count: 0,
            full: 0..0,
            full_weight: 1.0 / length,
            own: Vec::new(),
            parts: [before, (1.0 - before - after).max(0.0), after],
        };
        // Far beyond held ends the value is that of the end.
        let (mut low, mut high) = (b0.max(0.0), b1.min(last));
        let mut far = [0.0; 2];
        if self.before == Fill::Hold {
            low = b0.max(-FAR).min(last + FAR);
            far[0] = (b1.min(-FAR) - b0).max(0.0);
        }
        if self.after == Fill::Hold {
            high = b1.min(last + FAR).max(-FAR);
            far[1] = (b1 - b0.max(last + FAR)).max(0.0);
        }
        match high > low {
            true if length < SHORT => self.read_short(filter, low, high, &mut span),
            true => self.read(filter, low, high, &mut span),
            false => {}
        }
        for (bin, length) in [0, self.bins - 1].into_iter().zip(far) {
            if length > 0.0 {
                span.push(bin, length);
            }
        }
        span
    }

    #[cold]
    fn irregular_span(&self, bins: &Irregular, from: f64, to: f64) -> Span {
        let length = to - from;
        if !length.is_normal() {
            return Span::at(self.moment(from));
        }
        let before = (to.min(self.start) - from).max(0.0) / length;
        let after = (to - from.max(self.end)).max(0.0) / length;
        let mut span = Span {
            full_weight: 1.0,
            parts: [before, (1.0 - before - after).max(0.0), after],
            ..Span::default()
        };
        for (time, part) in bins.times_between(from, to) {
            let read = self.moment(time).bins;
            if read.count == 0 {
                continue;
            }
            // Times ascend, and so do the first bins that they read.
            if span.own.is_empty() {
                span.full = read.first..read.first;
            }
            let first = read.first.saturating_sub(span.full.start);
            span.full.end = span.full.end.max(read.first + read.count);
            span.own.resize(span.full.len(), 0.0);
            let own = span.own[first..].iter_mut().zip(read.weights);
            own.take(read.count)
                .for_each(|(own, weight)| *own += part * weight);
        }
        span
    }

    /// The same as [`Timeline::read`] for a short range.
    fn read_short(&self, filter: TimeFilter, low: f64, high: f64, span: &mut Span) {
        // The nearest filter is constant on both sides of a bin's edge; with all others the second part is empty.
        let (edge, way) = match filter {
            TimeFilter::Nearest => ((low.floor() + 1.0).min(high), 0.0),
            _ => (high, 0.5),
        };
        for [from, to] in [[low, edge], [edge, high]] {
            let bins = self.filtered(filter, from + way * (to - from));
            span.push_all(&bins, to - from);
        }
    }

    /// Weights, in bins, of the range `low` to `high`.
    fn read(&self, filter: TimeFilter, low: f64, high: f64, span: &mut Span) {
        let first = (low - REACH - 0.5).floor() as i64;
        let last = (high + REACH - 0.5).ceil() as i64;
        let bins = self.bins as i64;
        // The existing full bins; without any, all are at the ends.
        let full = ((low + REACH - 0.5).ceil() as i64).max(0)
            ..((high - REACH - 0.5).floor() as i64 + 1).min(bins);
        let (before, after) = match full.is_empty() {
            true => (first..last + 1, 0..0),
            false => (first..full.start, full.end..last + 1),
        };
        // Only at these bins is the difference of Φ neither 0 nor 1.
        for k in before.chain(after) {
            let centre = k as f64 + 0.5;
            let weight = integral(filter, high - centre) - integral(filter, low - centre);
            let black =
                (k < 0 && self.before == Fill::Black) || (k >= bins && self.after == Fill::Black);
            if weight != 0.0 && !black {
                span.push(k.clamp(0, bins - 1) as usize, weight);
            }
        }
        if !full.is_empty() {
            span.full = full.start as usize..full.end as usize;
        }
    }
}

impl Span {
    /// The reads at a moment.
    fn at(moment: Moment) -> Span {
        let part = |phase| f64::from(moment.phase == phase);
        let mut span = Span {
            full_weight: 1.0,
            parts: [Phase::Before, Phase::Inside, Phase::After].map(part),
            ..Span::default()
        };
        span.push_all(&moment.bins, 1.0);
        span
    }

    /// Adds weights, times `length` in bins.
    fn push_all(&mut self, bins: &BinWeights, length: f64) {
        for (k, weight) in bins.weights.iter().enumerate().take(bins.count) {
            if weight * length != 0.0 {
                self.push(bins.first + k, weight * length);
            }
        }
    }

    /// Adds the weight `weight`, in bins, of `bin`.
    fn push(&mut self, bin: usize, weight: f64) {
        match self.ends[..self.count].iter_mut().find(|end| end.0 == bin) {
            Some(end) => end.1 += weight,
            None => {
                self.ends[self.count] = (bin, weight);
                self.count += 1;
            }
        }
    }

    /// The phases of its parts, with their sizes.
    pub fn phases(&self) -> [(Phase, f64); 3] {
        let [before, inside, after] = self.parts;
        [
            (Phase::Before, before),
            (Phase::Inside, inside),
            (Phase::After, after),
        ]
    }

    /// The weighted sum over the bins of a texel of `cube`, with the prefix sums `sums`; a single channel is copied to all three.
    pub fn texel(
        &self,
        cube: &CubeStore,
        sums: Option<&PrefixSums>,
        texel: usize,
        near: &Near,
    ) -> [f64; 3] {
        let [_, _, bins, channels] = cube.shape();
        let mut rgb = [0.0; 3];
        let mut fill = |value: &dyn Fn(usize, usize) -> f64| {
            for (channel, sum) in rgb.iter_mut().enumerate().take(channels) {
                *sum = self.channel(|bin| value(bin, channel), sums, (texel, channel));
            }
        };
        match cube {
            CubeStore::Memory(cube) => fill(&|bin, channel| {
                let at = (texel * bins + bin) * channels + channel;
                cube.samples.get(at).unwrap_or(0.0)
            }),
            // All at once, since finding each one's brick is expensive.
            CubeStore::Disk(bricks) => {
                let run = self.run();
                let mut values = vec![0.0; run.len() * channels];
                if !run.is_empty() {
                    near.samples(bricks, texel, run.start, &mut values);
                }
                fill(&|bin, channel| values[(bin - run.start) * channels + channel]);
            }
        }
        match channels {
            1 => [rgb[0]; 3],
            _ => rgb,
        }
    }

    /// The number of bins of a texel that it reads, with prefix sums or one by one.
    pub fn bins_read(&self, by_sums: bool) -> usize {
        let (first, last) = (self.full.start.div_ceil(BLOCK), self.full.end / BLOCK);
        let summed = if by_sums && self.own.is_empty() && first < last {
            (last - first) * BLOCK
        } else {
            0
        };
        self.count + self.full.len() - summed
    }

    /// The bins that it reads, and those between them.
    fn run(&self) -> std::ops::Range<usize> {
        let ends = self.ends[..self.count]
            .iter()
            .map(|(bin, _)| *bin..*bin + 1);
        let full = Some(self.full.clone()).filter(|full| !full.is_empty());
        let all = ends.chain(full);
        all.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end))
            .unwrap_or(0..0)
    }

    fn channel(
        &self,
        value: impl Fn(usize) -> f64,
        sums: Option<&PrefixSums>,
        (texel, channel): (usize, usize),
    ) -> f64 {
        let direct = |bins: std::ops::Range<usize>| bins.map(&value).sum::<f64>();
        let ends = self.ends[..self.count].iter();
        let at_ends: f64 = ends.map(|(bin, weight)| weight * value(*bin)).sum();
        let (first, last) = (self.full.start.div_ceil(BLOCK), self.full.end / BLOCK);
        // Whole blocks by prefix sums, and the full bins before and after them one by one.
        let full = match sums {
            _ if !self.own.is_empty() => (self.full.clone().zip(&self.own))
                .map(|(bin, weight)| weight * value(bin))
                .sum(),
            Some(sums) if first < last => {
                direct(self.full.start..first * BLOCK)
                    + sums.between(texel, first, last, channel)
                    + direct(last * BLOCK..self.full.end)
            }
            _ => direct(self.full.clone()),
        };
        (at_ends + full) * self.full_weight
    }
}

#[cfg(test)]
mod tests;
