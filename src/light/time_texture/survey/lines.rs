//! The examined subset of a cube's samples, read line by line along time; and words for numbers.

use crate::io::cube::{CubeStore, Peeked};

/// Examined pixels.
const PIXELS: usize = 4096;
/// Examined lines along each axis.
const LINES: usize = 512;
/// For cubes on disk: examined lines, and neighbours in a row that are examined together.
const LINES_ON_DISK: usize = 12;
const TOGETHER: usize = 16;
/// The fraction of a cube on disk that is read, and bounds on it, bytes.
const PART_ON_DISK: u64 = 256;
const READ_ON_DISK: [u64; 2] = [8 << 20, 64 << 20];

/// Lines of samples along time, from memory or from disk.
pub(super) struct Lines<'a> {
    pub store: &'a CubeStore,
    near: Peeked,
    samples: Vec<f64>,
}

impl<'a> Lines<'a> {
    pub fn new(store: &'a CubeStore) -> Lines<'a> {
        Lines {
            store,
            near: Peeked::default(),
            samples: Vec::new(),
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

    /// All samples of a pixel, bin by bin, channel by channel, replacing the contents of `to`.
    pub fn all(&mut self, pixel: usize, to: &mut Vec<f64>) {
        let [_, _, bins, channels] = self.store.shape();
        let each = bins * channels;
        to.clear();
        to.resize(each, 0.0);
        match self.store {
            CubeStore::Memory(cube) => cube.samples.widen(pixel * each, to),
            CubeStore::Disk(bricks) => bricks.peek(&mut self.near, pixel, 0, to),
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
        let groups = (budget / bricks.bytes_of_line().max(1)).clamp(1, (PIXELS / TOGETHER) as u64);
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
