//! The examined subset of a cube's samples, read line by line along time; and words for numbers.

use std::ops::Range;

use crate::io::cube::{Bricks, CubeStore, Peeked};

/// Examined pixels.
const PIXELS: usize = 4096;
/// Examined lines along each axis.
const LINES: usize = 512;
/// For cubes on disk: examined lines, and neighbours in a row that are examined together.
const LINES_ON_DISK: usize = 12;
const TOGETHER: usize = 16;
/// The most samples of neighbours that are read together, and the bins that are read of each at a time: those of frames share pages.
const MOST_TOGETHER: usize = 1 << 19;
const BINS_TOGETHER: usize = 64;
/// The fraction of a cube on disk that is read, and bounds on it, bytes.
const PART_ON_DISK: u64 = 256;
const READ_ON_DISK: [u64; 2] = [8 << 20, 64 << 20];

/// Lines of samples along time, from memory or from disk.
pub(super) struct Lines<'a> {
    pub store: &'a CubeStore,
    near: Peeked,
    samples: Vec<f64>,
    /// For a cube on disk: neighbouring pixels, and the samples of their lines.
    group: (Range<usize>, Vec<f64>),
}

impl<'a> Lines<'a> {
    pub fn new(store: &'a CubeStore) -> Lines<'a> {
        Lines {
            store,
            near: Peeked::default(),
            samples: Vec::new(),
            group: (0..0, Vec::new()),
        }
    }

    /// The sums over channels of consecutive bins of a pixel from `bin` on, as many as `to` has room for.
    pub fn read(&mut self, pixel: usize, bin: usize, to: &mut [f64]) {
        let [_, _, bins, channels] = self.store.shape();
        self.samples.clear();
        self.samples.resize(to.len() * channels, 0.0);
        match self.store {
            CubeStore::Memory(cube) => {
                let first = (pixel * bins + bin) * channels;
                cube.samples.widen(first, &mut self.samples);
            }
            CubeStore::Disk(bricks) => bricks.peek(&mut self.near, pixel, bin, &mut self.samples),
        }
        for (to, samples) in to.iter_mut().zip(self.samples.chunks(channels)) {
            *to = samples.iter().sum();
        }
    }

    /// All samples of an examined pixel, bin by bin, channel by channel, replacing the contents of `to`.
    pub fn all(&mut self, pixel: usize, to: &mut Vec<f64>) {
        let [_, _, bins, channels] = self.store.shape();
        let each = bins * channels;
        to.clear();
        match self.store {
            CubeStore::Memory(cube) => {
                to.resize(each, 0.0);
                cube.samples.widen(pixel * each, to);
            }
            CubeStore::Disk(bricks) => {
                if !self.group.0.contains(&pixel) {
                    self.read_group(bricks, pixel);
                }
                let (pixels, samples) = &self.group;
                to.extend(samples[(pixel - pixels.start) * each..].iter().take(each));
            }
        }
    }

    /// The sums over channels of all bins of an examined pixel.
    pub fn line(&mut self, pixel: usize, to: &mut [f64]) {
        let mut samples = std::mem::take(&mut self.samples);
        self.all(pixel, &mut samples);
        for (to, samples) in to.iter_mut().zip(samples.chunks(self.store.shape()[3])) {
            *to = samples.iter().sum();
        }
        self.samples = samples;
    }

    /// Reads the lines of a pixel and of the neighbours that are examined with it.
    fn read_group(&mut self, bricks: &Bricks, pixel: usize) {
        let [h, w, bins, channels] = self.store.shape();
        let each = bins * channels;
        let count = TOGETHER.min(h * w - pixel).min(MOST_TOGETHER / each);
        let (pixels, samples) = &mut self.group;
        *pixels = pixel..pixel + count.max(1);
        samples.clear();
        samples.resize(pixels.len() * each, 0.0);
        for bin in (0..bins).step_by(BINS_TOGETHER) {
            let part = bin * channels..(bin + BINS_TOGETHER).min(bins) * channels;
            for (line, pixel) in samples.chunks_mut(each).zip(pixels.clone()) {
                bricks.peek(&mut self.near, pixel, bin, &mut line[part.clone()]);
            }
        }
    }

    /// The examined pixels.
    pub fn pixels(&self) -> Vec<usize> {
        let [h, w, ..] = self.store.shape();
        let Some(bricks) = self.store.on_disk() else {
            return spread(h * w, PIXELS).collect();
        };
        let samples: usize = self.store.shape().iter().product();
        let [least, most] = READ_ON_DISK;
        let all = samples as u64 * self.store.sample_bytes() as u64;
        let budget = (all / PART_ON_DISK).clamp(least, most);
        let group = bricks.bytes_of_lines(TOGETHER).max(1);
        let groups = (budget / group).clamp(1, (PIXELS / TOGETHER) as u64);
        // Each begins in the middle of its part of the picture.
        let begin = |group: u64| ((2 * group + 1) as usize * h * w) / (2 * groups as usize);
        let mut pixels: Vec<usize> = (0..groups)
            .flat_map(|group| begin(group)..(begin(group) + TOGETHER).min(h * w))
            .collect();
        pixels.dedup();
        pixels
    }

    /// The number of examined lines along each axis.
    pub fn lines(&self) -> usize {
        match self.store.on_disk() {
            None => LINES,
            Some(_) => LINES_ON_DISK,
        }
    }
}

/// Formats a number with six digits.
pub(crate) fn rounded(value: f64) -> f64 {
    // Adding 0 turns −0 into 0.
    format!("{value:.5e}").parse().unwrap_or(value) + 0.0
}

/// About `most` of `count` indices, evenly spread: every s-th one, with s odd, so that it is not a row size.
pub(super) fn spread(count: usize, most: usize) -> impl Iterator<Item = usize> {
    (0..count).step_by((count / most).max(1) | 1)
}

/// Formats a fraction.
pub(super) fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}
