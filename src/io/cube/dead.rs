//! Bins in which a sensor counted nothing: each is interpolated linearly between its nearest live neighbours in time; before the first
//! live bin and after the last, it repeats that bin.
//!
//! Where bins differ in width, the interpolation is that of densities a/s at the centres c of bins, s being the width of bins that hold
//! energies and 1 for densities: a = s ((1 − f) a₀/s₀ + f a₁/s₁), f = (c − c₀)/(c₁ − c₀).

use std::ops::Range;
use std::path::Path;

use half::f16;

use super::samples::{Cube, CubeSamples};
use super::wanted::Wanted;
use crate::error::{Error, Result};
use crate::io::npy::Dtype;

/// Dead bins of a time axis, ascending.
#[derive(Debug, Clone, Default)]
pub(super) struct DeadBins(Vec<Dead>);

/// A dead bin: the live bins before and after it, with their weights.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Dead {
    bin: usize,
    before: usize,
    after: usize,
    weights: [f64; 2],
}

impl DeadBins {
    /// For an axis of `bins` bins of the cube at `path`.
    ///
    /// # Errors
    /// A bin that does not exist; no live bin.
    pub fn new(path: &Path, wanted: Wanted, bins: usize) -> Result<DeadBins> {
        let dead = wanted.dead_bins;
        let sizes = wanted.bin_sizes.filter(|sizes| sizes.0.len() == bins);
        let size = |bin: usize| match sizes {
            Some(sizes) => sizes.0[bin].map(f64::from_bits),
            None => [bin as f64, 1.0],
        };
        let mut is_dead = vec![false; if dead.is_empty() { 0 } else { bins }];
        for bin in dead {
            let Some(flag) = is_dead.get_mut(*bin) else {
                let what = format!(
                    "there is no bin {bin}: bins are counted from 0 to {}",
                    bins - 1
                );
                return Err(Error::invalid(path, "dead_bins", what, "leave it out"));
            };
            *flag = true;
        }
        if !is_dead.is_empty() && is_dead.iter().all(|dead| *dead) {
            let what = "every bin is listed as dead";
            return Err(Error::invalid(
                path,
                "dead_bins",
                what,
                "name the dead ones only",
            ));
        }
        let mended = |bin: usize| {
            let before = (0..bin).rev().find(|other| !is_dead[*other]);
            let after = (bin..bins).find(|other| !is_dead[*other]);
            // At an end of the axis both are the same live bin, and the line is constant.
            let [first, last] = [before.or(after), after.or(before)].map(|bin| bin.unwrap_or(0));
            let [[own, wide], [from, wide_first], [to, wide_last]] = [bin, first, last].map(size);
            let part = match last - first {
                0 => 0.0,
                _ => (own - from) / (to - from),
            };
            Dead {
                bin,
                before: first,
                after: last,
                weights: [
                    (1.0 - part) * (wide / wide_first),
                    part * (wide / wide_last),
                ],
            }
        };
        let dead = (0..is_dead.len()).filter(|bin| is_dead[*bin]);
        Ok(DeadBins(dead.map(mended).collect()))
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn among(&self, bins: &Range<usize>) -> &[Dead] {
        let at = |bin: usize| self.0.partition_point(|dead| dead.bin < bin);
        &self.0[at(bins.start)..at(bins.end)]
    }

    /// The bins that are needed to compute these.
    pub fn reach(&self, bins: Range<usize>) -> Range<usize> {
        let dead = self.among(&bins);
        let first = dead.iter().map(|dead| dead.before).min();
        let last = dead.iter().map(|dead| dead.after + 1).max();
        let [start, end] = [first.unwrap_or(bins.start), last.unwrap_or(bins.end)];
        start.min(bins.start)..end.max(bins.end)
    }

    /// Interpolates dead bins among the bins `bins` of one pixel, whose samples are in `line`; `read` gives those of any bin.
    pub fn mend(
        &self,
        bins: Range<usize>,
        dtype: &Dtype,
        line: &mut [f64],
        mut read: impl FnMut(usize, &mut [f64]),
    ) {
        let dead = self.among(&bins);
        if dead.is_empty() {
            return;
        }
        let channels = line.len() / bins.len();
        let mut ends = [vec![0.0; channels], vec![0.0; channels]];
        for dead in dead {
            for (bin, end) in [dead.before, dead.after].into_iter().zip(&mut ends) {
                read(bin, end);
            }
            let at = (dead.bin - bins.start) * channels;
            for (c, sample) in line[at..at + channels].iter_mut().enumerate() {
                // Rounded as a cube in memory stores it, so that both ways of reading give the same bits.
                *sample = rounded(dtype, dead.between(ends[0][c], ends[1][c]));
            }
        }
    }

    /// Interpolates the dead bins of a whole cube.
    pub fn mend_cube(&self, cube: &mut Cube) {
        let [h, w, bins, channels] = cube.shape;
        for pixel in 0..h * w {
            for dead in &self.0 {
                for c in 0..channels {
                    let at = |bin: usize| (pixel * bins + bin) * channels + c;
                    let end = |bin| cube.samples.get(at(bin)).unwrap_or(0.0);
                    let sample = dead.between(end(dead.before), end(dead.after));
                    match &mut cube.samples {
                        CubeSamples::F16(samples) => samples[at(dead.bin)] = f16::from_f64(sample),
                        CubeSamples::F32(samples) => samples[at(dead.bin)] = sample as f32,
                        CubeSamples::F64(samples) => samples[at(dead.bin)] = sample,
                    }
                }
            }
        }
    }
}

impl Dead {
    fn between(&self, before: f64, after: f64) -> f64 {
        self.weights[0] * before + self.weights[1] * after
    }
}

/// A number rounded to the type of samples in memory.
fn rounded(dtype: &Dtype, number: f64) -> f64 {
    match dtype {
        Dtype::F16 => f16::from_f64(number).to_f64(),
        Dtype::F32 => f64::from(number as f32),
        Dtype::F64 | Dtype::Other(_) => number,
    }
}
