//! Independent parts of the samples of a tile, whose differences tell the error of their mean.
//!
//! # The standard error
//!
//! The samples of a pixel are evenly spread strata, so their variance says nothing about the error of their mean. The error is estimated
//! from R parts of the samples that are independent of each other ([`sampler`](crate::render::sampler)): with the means m₁ … m_R and their
//! mean m,
//!
//! ```text
//! standard error² = Σ (m_k − m)²/(R (R − 1)),                                                     (1)
//! ```
//!
//! whose expectation is the variance of m, whatever the distribution. For the reported error of a pixel m is the mean of R, G and B; for
//! decisions on passes squares are the means of those of R, G and B, so that noise in which red and blue differ does not cancel. If the means are normal, the error over the standard error is distributed as
//! Student's t with R − 1 degrees of freedom: for R = 8, 65 % are below 1 and 91 % below 2, while 68 % and 95 % of normal errors are. Light that
//! few samples find is worse: parts that have all missed it differ little, and suggest a small error although their mean is too low.
//!
//! Neighbours improve the estimate. With s² the variance of a pixel's parts and n the mean of those of the 5 × 5 pixels around it, the
//! reported error is
//!
//! ```text
//! standard error² = ((R − 1) s² + D n)/((R − 1 + D) R),    D = 4:                                 (2)
//! ```
//!
//! the mean of a variance for which the pixel's own parts have R − 1 degrees of freedom and the prior knowledge that it is near n is worth
//! D more (Smyth, "Linear models and empirical Bayes methods", Stat. Appl. Genet. Mol. Biol. 3(1), 2004). The pixel itself takes the place
//! of pixels beyond the edge of the tile, so that all weights are symmetric: the mean square over a tile is exactly that of (1). It is 0 if
//! the samples of each of the 25 pixels are equal, and as R grows (2) approaches (1). If 25 variances are alike, and independent, (2) has
//!
//! ```text
//! (R − 1)/(a² + 2 a b/25 + b²/25) degrees of freedom,    a = (R − 1)/(R − 1 + D), b = 1 − a,      (3)
//! ```
//!
//! 16 for R = 8, with which 67 % are below 1 and 94 % below 2. The price: pixels with little noise of their own next to an edge, or at the
//! rim of a shadow, report a part of their neighbours' error. Decisions on passes, below, use (1) itself.
//!
//! # How many passes a tile takes
//!
//! If a number of samples depends on the samples' values, their mean is biased. So the parts form two halves, the even and the odd ones,
//! and *each half decides how many parts of the other count*: with K_A a function only of the values of B, and independent of those of A,
//! the mean of the first K_A parts of A has no bias, nor has that of the first K_B parts of B. The pixel is the mean of both, and
//!
//! ```text
//! standard error² = s²/4 (1/K_A + 1/K_B),   s² the variance of all parts that were taken,               (4)
//! ```
//!
//! with the neighbours' as in (2). Parts that were taken after their own half was settled, while the other was not, count only in s².

/// Independent parts of the samples of a tile: the even ones and the odd ones.
#[derive(Debug)]
pub(in crate::render) struct Parts {
    /// Samples of each part.
    pub(super) samples: u32,
    /// The number of completed parts.
    pub(in crate::render) taken: u32,
    /// By half, the number of parts that count in the radiance.
    pub(in crate::render) counted: [u32; 2],
    /// By half, whether that number is settled.
    pub(in crate::render) settled: [bool; 2],
    /// By half and pixel, Σ of the means of the parts that count.
    pub(in crate::render) halves: [Vec<[f64; 3]>; 2],
    /// By pixel.
    spread: Vec<Spread>,
    /// By half, Σ d and Σ d² over its parts but the first: d is what a part adds to Σ (m − m̄)², summed over the pixels of the tile.
    scatter: [[f64; 2]; 2],
}

/// How the parts m of a pixel differ: m₀, the first, and by half Σ (m − m₀) and Σ (m − m₀)². Equal parts give exactly 0.
#[derive(Debug, Clone, Default)]
struct Spread {
    first: [f64; 3],
    sums: [[f64; 3]; 2],
    /// The mean over R, G and B.
    squares: [f64; 2],
    /// Of the mean of R, G and B.
    squares_of_mean: [f64; 2],
}

impl Spread {
    /// The mean over R, G and B of Σ (m − m̄)² = Σ (m − m₀)² − (Σ (m − m₀))²/n, for n parts with these sums.
    fn scatter(sums: [f64; 3], squares: f64, n: f64) -> f64 {
        (squares - mean(sums.map(|sum| sum * sum)) / n).max(0.0)
    }
}

/// D in (2): this value brings the errors of eight parts nearest to 68.3 % below 1 and 95.4 % below 2 in eight small scenes.
const PRIOR: f64 = 4.0;
/// How many columns and rows the pixels that n averages extend in each direction, and their number.
const REACH: usize = 2;
const AROUND: f64 = ((2 * REACH + 1) * (2 * REACH + 1)) as f64;
/// The standard deviations of a tile's squared error that are added to its estimate.
const DOUBTS: f64 = 2.0;

/// The degrees of freedom of standard errors from this number of parts: (3).
pub(super) fn degrees_of_freedom(parts: u32) -> f64 {
    let own = f64::from(parts.saturating_sub(1));
    let a = own / (own + PRIOR);
    let b = 1.0 - a;
    own / (a * a + (2.0 * a * b + b * b) / AROUND)
}

/// The mean of `values`, `across` per row, over the 5 × 5 around one of them, which replaces neighbours that do not exist or are not finite.
fn around(values: &[f64], across: usize, at: usize) -> f64 {
    let (row, column) = (at / across, at % across);
    let near = |at: usize, count: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(count);
    let columns = near(column, across);
    let of_row = |row: usize| &values[row * across..][columns.clone()];
    let all = near(row, values.len() / across).flat_map(of_row);
    let (mut sum, mut missing) = (0.0, AROUND);
    for value in all.filter(|value| value.is_finite()) {
        (sum, missing) = (sum + value, missing - 1.0);
    }
    (sum + missing * values[at]) / AROUND
}

impl Parts {
    pub(super) fn new(pixels: usize, samples: u32) -> Self {
        Parts {
            samples,
            taken: 0,
            counted: [0; 2],
            settled: [false; 2],
            halves: std::array::from_fn(|_| vec![[0.0; 3]; pixels]),
            spread: vec![Spread::default(); pixels],
            scatter: [[0.0; 2]; 2],
        }
    }

    /// Adds the sums of a part.
    pub(super) fn add(&mut self, radiance: &[[f64; 3]]) {
        // Parts go to the two halves alternately.
        let half = (self.taken % 2) as usize;
        let scale = 1.0 / f64::from(self.samples);
        let counts = !self.settled[half];
        // With n earlier parts, of mean m̄, a part adds (m − m̄)² n/(n + 1) to the squares, σ² on average whatever n is.
        let before = f64::from(self.taken / 2);
        let mut added = 0.0;
        for (pixel, sum) in radiance.iter().enumerate() {
            let part = sum.map(|sum| sum * scale);
            if counts {
                for (sum, part) in self.halves[half][pixel].iter_mut().zip(part) {
                    *sum += part;
                }
            }
            // Differences from the first part, so that no digits cancel in the variance.
            let spread = &mut self.spread[pixel];
            if self.taken == 0 {
                spread.first = part;
            }
            let from_first: [f64; 3] = std::array::from_fn(|c| part[c] - spread.first[c]);
            let sums = &mut spread.sums[half];
            if before > 0.0 {
                let off: [f64; 3] = std::array::from_fn(|c| from_first[c] - sums[c] / before);
                added += mean(off.map(|off| off * off)) * (before / (before + 1.0));
            }
            for (sum, from_first) in sums.iter_mut().zip(from_first) {
                *sum += from_first;
            }
            spread.squares[half] += mean(from_first.map(|off| off * off));
            spread.squares_of_mean[half] += mean(from_first).powi(2);
        }
        let scatter = &mut self.scatter[half];
        *scatter = [scatter[0] + added, scatter[1] + added * added];
        self.taken += 1;
        self.counted[half] += u32::from(counts);
    }

    /// The mean of a pixel.
    pub(super) fn mean(&self, pixel: usize) -> [f64; 3] {
        let [a, b] = self.counted.map(f64::from);
        let [x, y] = std::array::from_fn(|half| self.halves[half][pixel]);
        match self.settled.contains(&true) {
            // These weights depend on no value.
            true => std::array::from_fn(|c| 0.5 * (x[c] / a + y[c] / b)),
            false => std::array::from_fn(|c| (x[c] + y[c]) / (a + b)),
        }
    }

    /// s² of a pixel: the mean of those of R, G and B.
    fn variance(&self, pixel: usize) -> f64 {
        let n = f64::from(self.taken);
        let spread = &self.spread[pixel];
        let [a, b] = spread.sums;
        let sums = std::array::from_fn(|c| a[c] + b[c]);
        Spread::scatter(sums, spread.squares.iter().sum(), n) / (n - 1.0)
    }

    /// s² of the mean of R, G and B of a pixel.
    fn variance_of_mean(&self, pixel: usize) -> f64 {
        let n = f64::from(self.taken);
        let spread = &self.spread[pixel];
        let sum: f64 = spread.sums.into_iter().map(mean).sum();
        Spread::scatter([sum; 3], spread.squares_of_mean.iter().sum(), n) / (n - 1.0)
    }

    /// The variance of the mean of a pixel, relative to that of a part: 1/R, or as in (4) if a half is settled.
    fn share(&self) -> f64 {
        match self.settled.contains(&true) {
            // The variance of a mean of two is a quarter of the sum of theirs.
            true => 0.25 * self.counted.map(|k| 1.0 / f64::from(k)).iter().sum::<f64>(),
            false => 1.0 / f64::from(self.taken),
        }
    }

    /// The square of the standard error of a pixel from its own parts only: (1), the mean of those of R, G and B.
    pub(in crate::render) fn own_error_square(&self, pixel: usize) -> f64 {
        match self.taken < 2 {
            true => f64::NAN,
            false => self.variance(pixel) * self.share(),
        }
    }

    /// The standard errors of all pixels, `across` per row: (2).
    pub(super) fn standard_errors(&self, across: usize) -> Vec<f64> {
        if self.taken < 2 {
            return vec![f64::NAN; self.spread.len()];
        }
        let all = 0..self.spread.len();
        let variances = all.map(|pixel| self.variance_of_mean(pixel));
        let variances: Vec<f64> = variances.collect();
        let own = f64::from(self.taken - 1);
        let share = self.share();
        let square = |(pixel, variance): (usize, &f64)| {
            let around = around(&variances, across, pixel);
            (own * variance + PRIOR * around) / (own + PRIOR) * share
        };
        let squares = variances.iter().enumerate().map(square);
        squares.map(f64::sqrt).collect()
    }

    /// The estimates of one half for a pixel: its mean radiance, and the squared standard error of these parts together with as many of the
    /// other half.
    fn judgement(&self, half: usize, pixel: usize) -> [f64; 2] {
        // The halves alternate: both have equally many.
        let n = f64::from(self.taken / 2);
        let spread = &self.spread[pixel];
        let sums = spread.sums[half];
        let variance = Spread::scatter(sums, spread.squares[half], n) / (n - 1.0);
        // For these n parts and as many of the other half.
        [mean(spread.first) + mean(sums) / n, variance / (2.0 * n)]
    }

    /// The estimates of one half for the tile: its mean radiance, and an upper bound of its standard error, the root of the mean square over
    /// pixels. That square is a mean over parts, and as uncertain as these scatter: where few of them find a bright light, stopping at the
    /// first mean that happens to be low enough would understate the error.
    pub(in crate::render) fn tile_judgement(&self, half: usize) -> [f64; 2] {
        let count = self.spread.len() as f64;
        let mut sums = [0.0; 2];
        for pixel in 0..self.spread.len() {
            let judged = self.judgement(half, pixel);
            sums = [sums[0] + judged[0], sums[1] + judged[1]];
        }
        // The standard deviation of the mean of d over k parts, relative to it.
        let k = f64::from((self.taken / 2).saturating_sub(1));
        let [sum, squares] = self.scatter[half];
        let variance = (squares - sum * sum / k).max(0.0) * k / (k - 1.0);
        let doubt = match sum > 0.0 {
            true => variance.sqrt() / sum,
            false => 0.0,
        };
        let square = sums[1] / count * (1.0 + DOUBTS * doubt);
        [sums[0] / count, square.sqrt()]
    }

    /// Number of pixels.
    pub(in crate::render) fn pixels(&self) -> usize {
        self.spread.len()
    }

    /// The mean radiance of the tile in the picture.
    pub(in crate::render) fn tile_radiance(&self) -> f64 {
        let all = 0..self.spread.len();
        let sum: f64 = all.map(|pixel| mean(self.mean(pixel))).sum();
        sum / self.spread.len() as f64
    }

    /// Whether both halves are settled.
    pub(in crate::render) fn is_settled(&self) -> bool {
        self.settled == [true; 2]
    }

    /// Everything that is kept between passes, in a fixed order: numbers as `f64`s, and counts as `u64`s.
    pub(super) fn each_sum(
        &mut self,
        numbers: &mut dyn FnMut(&mut [f64]),
        counts: &mut dyn FnMut(&mut u64),
    ) {
        for half in &mut self.halves {
            numbers(half.as_flattened_mut());
        }
        for spread in &mut self.spread {
            numbers(&mut spread.first);
            numbers(spread.sums.as_flattened_mut());
            numbers(&mut spread.squares);
            numbers(&mut spread.squares_of_mean);
        }
        numbers(self.scatter.as_flattened_mut());
        let [a, b] = &mut self.counted;
        for count in [&mut self.taken, a, b] {
            let mut wide = u64::from(*count);
            counts(&mut wide);
            *count = wide as u32;
        }
        for settled in &mut self.settled {
            let mut wide = u64::from(*settled);
            counts(&mut wide);
            *settled = wide != 0;
        }
    }
}

fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}
