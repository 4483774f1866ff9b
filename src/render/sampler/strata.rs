//! Positions of samples in a pixel: multi-jittered strata, a pure function of pixel and index.
//!
//! n = a·b samples fill an a × b grid of cells, one each; within its cell a sample takes its own sub-row and sub-column, so that the n
//! samples also project onto n different strata of x and of y (Chiu, Shirley, Wang, "Multi-jittered sampling", Graphics Gems IV, 1994). A
//! prime n is 1 × n, which is N-rooks.
//!
//! Samples beyond the n-th belong to further replicates: sample k n + i is sample i of replicate k, which has the same set of strata with
//! its own random numbers, independent of all other replicates. The mean of R replicates has the variance of one of them over R, which R
//! means estimate without bias, however well the samples of each are distributed (Owen, "Monte Carlo theory, methods and examples", §
//! 17.3).

use std::ops::Range;

use super::random::{UNIT, halves, hash, pixel_key, unit};
use crate::accel::vectors::{VectorLoop, dispatch};

/// The sample positions of every pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampler {
    columns: u32,
    rows: u32,
    /// Width and height of a cell: 1 / columns, 1 / rows.
    cell: [f64; 2],
    centred: bool,
    seed: u32,
}

impl Sampler {
    /// `samples` ≥ 1 stratified samples per pixel.
    pub fn stratified(samples: u32) -> Self {
        let samples = samples.max(1);
        // The largest divisor not above the root: the grid is as square as n allows.
        let root = (1..=samples)
            .take_while(|d| *d <= samples / d)
            .filter(|d| samples.is_multiple_of(*d))
            .last()
            .unwrap_or(1);
        let rows = samples / root;
        Sampler {
            columns: root,
            rows,
            cell: [1.0 / root as f64, 1.0 / rows as f64],
            centred: false,
            seed: 0,
        }
    }

    /// The sampler with other random numbers, independent of those of other seeds.
    pub fn with_seed(self, seed: u32) -> Self {
        Sampler { seed, ..self }
    }

    /// The sampler with the same random numbers for replicates of `samples` samples.
    pub(crate) fn with_samples(self, samples: u32) -> Self {
        Sampler::stratified(samples).with_seed(self.seed)
    }

    /// One sample, at the pixel's centre.
    pub fn centred() -> Self {
        Sampler {
            columns: 1,
            rows: 1,
            cell: [1.0; 2],
            centred: true,
            seed: 0,
        }
    }

    /// Three samples at the pixel's centre: when an exposure begins, half-way through it, and when it ends.
    pub(crate) fn centred_throughout() -> Self {
        Sampler {
            rows: 3,
            ..Sampler::centred()
        }
    }

    /// Width and height of a sample's cell in a pixel.
    pub(crate) fn cell(&self) -> [f64; 2] {
        self.cell
    }

    /// Width and height of the part of a pixel, and the part of the time, that a sample of an exposure represents: each column of cells
    /// has one sample in each of as many parts of the time as there are rows, so that these cover both.
    pub(crate) fn cell_in_time(&self) -> [f64; 3] {
        [self.cell[0], 1.0, self.cell[1]]
    }

    /// Samples per pixel of one replicate.
    pub fn samples(&self) -> u32 {
        self.columns * self.rows
    }

    /// The sample of its replicate for sample `index`, and the value that is XORed with pixel keys; 0 for the first replicate of seed 0.
    pub(crate) fn replicate(&self, index: u32) -> (u32, u64) {
        let (replicate, within) = (index / self.samples(), index % self.samples());
        let number = u64::from(replicate) | u64::from(self.seed) << 32;
        match number {
            0 => (within, 0),
            number => (within, hash(hash(number))),
        }
    }

    /// The offset of sample `index` in pixel `(column, row)`, each in [0, 1).
    pub fn offset(&self, column: u32, row: u32, index: u32) -> [f64; 2] {
        let (mut x, mut y) = ([0.0], [0.0]);
        let (within, salt) = self.replicate(index);
        let key = pixel_key(column, row) ^ salt;
        self.offsets(&[key], within, &mut x, &mut y);
        [x[0], y[0]]
    }

    /// [`Sampler::offset`] in many pixels, by their keys; `index` is below [`Sampler::samples`].
    pub(crate) fn offsets(&self, pixels: &[u64], index: u32, x: &mut [f64], y: &mut [f64]) {
        if self.centred {
            x.fill(0.5);
            y.fill(0.5);
            return;
        }
        // The cell (i, j) of this sample, the same in all pixels.
        let (i, j) = (index % self.columns, index / self.columns);
        // Within it, the sub-column of row j in this pixel, and the sub-row of column i.
        let [columns, rows] = [self.columns, self.rows];
        if columns.is_power_of_two() && rows.is_power_of_two() {
            return dispatch(Offsets {
                sampler: self,
                pixels,
                index,
                x,
                y,
            });
        }
        for ((pixel, x), y) in pixels.iter().zip(&mut *x).zip(&mut *y) {
            let pixel = hash(*pixel);
            *x = sub_cell(j, rows, pixel);
            // Rotated by 31 bits, so that shift and stride come from other bits of the hash than those of x.
            *y = sub_cell(i, columns, pixel.rotate_left(31));
        }
        let [width, height] = self.cell;
        dispatch(Jitter {
            pixels,
            salt: (index as u64).wrapping_mul(STEP),
            cell: [i as f64, j as f64],
            size: [width, height],
            x,
            y,
        });
    }
}

impl Sampler {
    /// The offsets of `samples` in many pixels, by their keys without a replicate's, pixel by pixel: the same bits as [`Sampler::offset`].
    pub(crate) fn offsets_by_pixel(
        &self,
        pixels: &[u64],
        samples: Range<u32>,
        x: &mut [f64],
        y: &mut [f64],
    ) {
        let each = samples.len().max(1);
        let (within, salt) = self.replicate(samples.start);
        let is_one_replicate = within as usize + samples.len() <= self.samples() as usize;
        let are_powers = self.columns.is_power_of_two() && self.rows.is_power_of_two();
        if self.centred {
            x.fill(0.5);
            y.fill(0.5);
        } else if is_one_replicate && are_powers && each <= 16 {
            let of = ByPixel::<16> {
                sampler: self,
                pixels,
                salt,
                first: within,
                each,
                x,
                y,
            };
            // Loops have a fixed length, the shortest of three that fits all samples.
            match each {
                0..=4 => dispatch(of.at_most::<4>()),
                5..=8 => dispatch(of.at_most::<8>()),
                _ => dispatch(of),
            }
        } else {
            let of_pixels = x.chunks_mut(each).zip(y.chunks_mut(each));
            for (pixel, (x, y)) in pixels.iter().zip(of_pixels) {
                for (sample, (x, y)) in samples.clone().zip(x.iter_mut().zip(y)) {
                    let (within, salt) = self.replicate(sample);
                    let (x, y) = (std::slice::from_mut(x), std::slice::from_mut(y));
                    self.offsets(&[pixel ^ salt], within, x, y);
                }
            }
        }
    }
}

/// The number of samples that are placed together.
const TOGETHER: usize = 16;

/// The loop over at most `MOST` samples of each pixel, for a grid with powers of two of columns and rows.
struct ByPixel<'a, const MOST: usize> {
    sampler: &'a Sampler,
    pixels: &'a [u64],
    salt: u64,
    /// The first sample, and the number of samples.
    first: u32,
    each: usize,
    x: &'a mut [f64],
    y: &'a mut [f64],
}

impl<'a, const MOST: usize> ByPixel<'a, MOST> {
    /// The same loop for fewer samples.
    fn at_most<const FEWER: usize>(self) -> ByPixel<'a, FEWER> {
        let ByPixel {
            sampler,
            pixels,
            salt,
            first,
            each,
            x,
            y,
        } = self;
        ByPixel {
            sampler,
            pixels,
            salt,
            first,
            each,
            x,
            y,
        }
    }
}

impl<const MOST: usize> VectorLoop for ByPixel<'_, MOST> {
    #[inline(always)]
    fn run(self) {
        let sampler = *self.sampler;
        // Values common to all pixels.
        let (mut i, mut j, mut salts) = ([0; MOST], [0; MOST], [0; MOST]);
        for (k, index) in (self.first..).take(self.each.min(MOST)).enumerate() {
            ([i[k], j[k]], salts[k]) = sampler.cell_and_salt(index);
        }
        // Several pixels at a time whose samples fill a block; then those that are left.
        let mut done = 0;
        if self.each == MOST && MOST < TOGETHER {
            let (mut all_i, mut all_j, mut all_salts) =
                ([0; TOGETHER], [0; TOGETHER], [0; TOGETHER]);
            for k in 0..TOGETHER {
                (all_i[k], all_j[k], all_salts[k]) = (i[k % MOST], j[k % MOST], salts[k % MOST]);
            }
            let (to_x, _) = self.x.as_chunks_mut::<TOGETHER>();
            let (to_y, _) = self.y.as_chunks_mut::<TOGETHER>();
            let keys = self.pixels.chunks_exact(TOGETHER / MOST);
            for (keys, (to_x, to_y)) in keys.zip(to_x.iter_mut().zip(to_y)) {
                let mut hashes = [0; TOGETHER];
                for (k, key) in keys.iter().enumerate().take(TOGETHER / MOST) {
                    hashes[k] = hash(key ^ self.salt);
                }
                let mut pixels = [0; TOGETHER];
                for k in 0..TOGETHER {
                    pixels[k] = hashes[k / MOST];
                }
                let (mut x, mut y) = ([0.0; TOGETHER], [0.0; TOGETHER]);
                for k in 0..TOGETHER {
                    let cell = [all_i[k], all_j[k]];
                    [x[k], y[k]] = sampler.offset_of_powers(pixels[k], cell, all_salts[k]);
                }
                (*to_x, *to_y) = (x, y);
                done += TOGETHER / MOST;
            }
        }
        let left = done * self.each;
        let of_pixels = self.x[left..]
            .chunks_mut(self.each)
            .zip(self.y[left..].chunks_mut(self.each));
        for (key, (to_x, to_y)) in self.pixels[done..].iter().zip(of_pixels) {
            let pixel = hash(key ^ self.salt);
            let (mut x, mut y) = ([0.0; MOST], [0.0; MOST]);
            for k in 0..MOST {
                [x[k], y[k]] = sampler.offset_of_powers(pixel, [i[k], j[k]], salts[k]);
            }
            // Whole blocks, which are the vast majority, are copied in registers, without a call.
            match (to_x.first_chunk_mut(), to_y.first_chunk_mut()) {
                (Some(to_x), Some(to_y)) => (*to_x, *to_y) = (x, y),
                _ => {
                    to_x.copy_from_slice(&x[..to_x.len()]);
                    to_y.copy_from_slice(&y[..to_y.len()]);
                }
            }
        }
    }
}

/// A number below 2³², in a form that the compiler recognises: the product of two of these is one AVX2 instruction.
#[inline(always)]
fn low(x: u64) -> u64 {
    x & 0xffff_ffff
}

/// A number below 2³² as a float, exactly.
#[inline(always)]
fn whole(x: u64) -> f64 {
    halves(x)[0]
}

/// The number of samples in each of at least `parts` equal parts of `samples`, or in as many parts as there are samples.
pub(crate) fn samples_per_part(samples: u32, parts: u32) -> u32 {
    // The smallest sufficient number of parts that divides the samples evenly.
    let counts = parts.min(samples)..=samples;
    let parts = counts
        .into_iter()
        .find(|r| *r > 0 && samples.is_multiple_of(*r));
    samples / parts.unwrap_or(1)
}

/// The offsets of one sample of each pixel, for a grid with powers of two of columns and rows.
struct Offsets<'a> {
    sampler: &'a Sampler,
    pixels: &'a [u64],
    index: u32,
    x: &'a mut [f64],
    y: &'a mut [f64],
}

impl VectorLoop for Offsets<'_> {
    #[inline(always)]
    fn run(self) {
        let count = self.pixels.len();
        let (x, y) = (&mut self.x[..count], &mut self.y[..count]);
        let sampler = *self.sampler;
        let (cell, salt) = sampler.cell_and_salt(self.index);
        // For a single sample the cell is the pixel, and the terms of the general formula are 0.
        if sampler.samples() == 1 {
            for k in 0..count {
                let [for_x, for_y] = halves(hash(hash(self.pixels[k]) ^ salt));
                (x[k], y[k]) = (for_x * UNIT, for_y * UNIT);
            }
            return;
        }
        for k in 0..count {
            [x[k], y[k]] = sampler.offset_of_powers(hash(self.pixels[k]), cell, salt);
        }
    }
}

impl Sampler {
    /// The cell (i, j) of sample `index`, the same in all pixels, and the salt of its hashes.
    #[inline(always)]
    fn cell_and_salt(&self, index: u32) -> ([u64; 2], u64) {
        let cell = [index % self.columns, index / self.columns].map(u64::from);
        (cell, u64::from(index).wrapping_mul(STEP))
    }

    /// The offset of the sample with this cell and salt in the pixel with the hashed key `pixel`, if the numbers of columns and rows are
    /// powers of two.
    #[inline(always)]
    fn offset_of_powers(&self, pixel: u64, [i, j]: [u64; 2], salt: u64) -> [f64; 2] {
        let [of_columns, of_rows] = [self.columns, self.rows].map(|n| u64::from(n - 1));
        let [width, height] = self.cell;
        // The sub-column of row j and the sub-row of column i: `among_power_of_two` in u64, whose low bits are the same.
        let turned = pixel.rotate_left(31);
        let stride_x = (1 + ((pixel >> 32) & of_rows)) | 1;
        let stride_y = (1 + ((turned >> 32) & of_columns)) | 1;
        let sub_x = (low(j) * low(stride_x)).wrapping_add(pixel) & of_rows;
        let sub_y = (low(i) * low(stride_y)).wrapping_add(turned) & of_columns;
        // 32 random bits per axis place the sample in its sub-cell.
        let [for_x, for_y] = halves(hash(pixel ^ salt));
        let (in_x, in_y) = (whole(sub_x) + for_x * UNIT, whole(sub_y) + for_y * UNIT);
        // x = (i + (sub-column + noise) / rows) / columns, and y likewise.
        [
            (whole(i) + in_x * height) * width,
            (whole(j) + in_y * width) * height,
        ]
    }
}

/// Random positions in the sub-cells given by `x` and `y`, as offsets in the pixel.
struct Jitter<'a> {
    pixels: &'a [u64],
    salt: u64,
    cell: [f64; 2],
    size: [f64; 2],
    x: &'a mut [f64],
    y: &'a mut [f64],
}

impl VectorLoop for Jitter<'_> {
    #[inline(always)]
    fn run(self) {
        jitter(self.pixels, self.salt, self.cell, self.size, self.x, self.y);
    }
}

#[inline(always)]
fn jitter(
    pixels: &[u64],
    salt: u64,
    [i, j]: [f64; 2],
    [width, height]: [f64; 2],
    x: &mut [f64],
    y: &mut [f64],
) {
    let count = pixels.len();
    let (x, y) = (&mut x[..count], &mut y[..count]);
    for k in 0..count {
        // 32 random bits per axis place the sample in its sub-cell.
        let [for_x, for_y] = halves(hash(hash(pixels[k]) ^ salt));
        let (in_x, in_y) = (x[k] + for_x * UNIT, y[k] + for_y * UNIT);
        // x = (i + (sub-column + noise) / rows) / columns, and y likewise.
        x[k] = (i + in_x * height) * width;
        y[k] = (j + in_y * width) * height;
    }
}

impl Sampler {
    /// The moment of sample `index` in an exposure, in [0, 1): n samples take n different strata of
    /// time.
    ///
    /// In an a × b grid of cells (a ≤ b columns, rows) the a samples of each b-th part of the time lie in all columns, and in rows b/a
    /// apart, so time and position are uncorrelated for anything that depends on time minus delay, and hence on both alike (an orthogonal
    /// array; Owen 1992). Columns and rows are permuted at random in each pixel, or the samples would lie on planes of position and time.
    #[inline]
    pub fn moment(&self, column: u32, row: u32, index: u32) -> f64 {
        let mut moment = [0.0];
        let (within, salt) = self.replicate(index);
        let key = pixel_key(column, row) ^ salt;
        self.moments(&[key], within, &mut moment);
        moment[0]
    }

    /// [`Sampler::moment`] in many pixels, by their keys; `index` is below [`Sampler::samples`].
    pub(crate) fn moments(&self, pixels: &[u64], index: u32, moments: &mut [f64]) {
        if self.centred {
            moments.fill(match self.rows {
                1 => 0.5,
                rows => f64::from(index) / f64::from(rows - 1),
            });
            return;
        }
        let of = Moments {
            columns: self.columns,
            rows: self.rows,
            index,
            pixels,
            moments,
        };
        // Permutations of powers of two need no cycle walking, so their loops vectorize.
        match (self.columns.is_power_of_two(), self.rows.is_power_of_two()) {
            (true, true) => dispatch(of),
            _ => of.fill::<false>(),
        }
    }
}

/// Computes the moments of one sample in many pixels.
struct Moments<'a> {
    columns: u32,
    rows: u32,
    index: u32,
    pixels: &'a [u64],
    moments: &'a mut [f64],
}

impl VectorLoop for Moments<'_> {
    #[inline(always)]
    fn run(self) {
        self.fill::<true>();
    }
}

impl Moments<'_> {
    /// `POWERS_OF_TWO` says that the numbers of columns and rows are powers of two.
    #[inline(always)]
    fn fill<const POWERS_OF_TWO: bool>(self) {
        let (a, b) = (self.columns, self.rows);
        let (i, j) = (self.index % a, self.index / a);
        let salt = (self.index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        for (pixel, moment) in self.pixels.iter().zip(self.moments) {
            // The complement has other hashes than those used for positions.
            let pixel = hash(!pixel);
            let noise = hash(pixel ^ salt);
            let (columns, rows) = (pixel as u32, (pixel >> 32) as u32);
            // The b-th part of the time: the orthogonal array over rows and columns.
            let place = permuted::<POWERS_OF_TWO>(j, b, rows)
                + permuted::<POWERS_OF_TWO>(i, a, columns) * (b / a);
            let part = match POWERS_OF_TWO {
                true => place & (b - 1),
                false => place % b,
            };
            // Within the part, one of its a strata, permuted anew for each part.
            let seed = !columns ^ part.wrapping_mul(0x9e37_79b9);
            let within = permuted::<POWERS_OF_TWO>(i, a, seed);
            let within = (f64::from(within) + unit(noise as u32)) / f64::from(a);
            // Rounding may raise the last sample to 1.
            *moment = ((f64::from(part) + within) / f64::from(b)).min(1.0 - f64::EPSILON);
        }
    }
}

/// The position of `k` in a random permutation of 0..n, by its seed: a bijection of the next power of two, iterated until the result is
/// below n (Kensler, "Correlated multi-jittered sampling", Pixar 2013).
#[inline(always)]
fn permuted<const POWER_OF_TWO: bool>(k: u32, n: u32, seed: u32) -> u32 {
    let mask = match POWER_OF_TWO {
        true => n - 1,
        false => n.next_power_of_two() - 1,
    };
    let mut i = k;
    loop {
        // Each line is a bijection of 0..=mask: odd factors, and shifts that only move bits down.
        i ^= seed;
        i = i.wrapping_mul(0xe170_893d);
        i ^= seed >> 16;
        i ^= (i & mask) >> 4;
        i ^= seed >> 8;
        i = i.wrapping_mul(0x0929_eb3f);
        i ^= seed >> 23;
        i ^= (i & mask) >> 1;
        i = i.wrapping_mul(1 | seed >> 27);
        i = i.wrapping_mul(0x6935_fa69);
        i ^= (i & mask) >> 11;
        i = i.wrapping_mul(0x74dc_b303);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0x9e50_1cc3);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0xc860_a3df);
        i &= mask;
        i ^= i >> 5;
        if POWER_OF_TWO {
            return i.wrapping_add(seed) & mask;
        }
        // Cycle walking: outside of 0..n the hash is applied again.
        if i < n {
            return (i.wrapping_add(seed)) % n;
        }
    }
}

/// Position `k` in an affine permutation of 0..n: a·k + b mod n with a coprime to n.
fn sub_cell(k: u32, n: u32, seed: u64) -> f64 {
    if n.is_power_of_two() {
        return f64::from(among_power_of_two(k, n, seed));
    }
    let shift = (seed % n as u64) as u32;
    let stride = (1 + (seed >> 32) % n as u64) as u32;
    let stride = (stride..stride + n).find(|a| coprime(*a, n)).unwrap_or(1);
    ((k as u64 * stride as u64 + shift as u64) % n as u64) as f64
}

/// The same if n is a power of two, without divisions: the odd strides are the coprime ones.
#[inline(always)]
fn among_power_of_two(k: u32, n: u32, seed: u64) -> u32 {
    // Only the lowest bits of products and sums matter.
    let stride = (1 + ((seed >> 32) as u32 & (n - 1))) | 1;
    k.wrapping_mul(stride).wrapping_add(seed as u32) & (n - 1)
}

fn coprime(mut a: u32, mut b: u32) -> bool {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

/// The difference between salts of consecutive samples: 2⁶⁴ divided by the golden ratio, odd.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

#[cfg(test)]
mod tests;
