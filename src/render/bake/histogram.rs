//! The energy of one pixel or texel per time bin.
//!
//! # Pulses much wider than the bins
//!
//! A pulse of standard deviation σ covers 16 σ. If that is 128 bins or more, its light is put into bins that are 2ᵏ times as wide, with k
//! such that their width H is from σ/8 to σ/4. When a part is complete, these bins are halved until they have the requested width, once for
//! all paths. With E_j the energies of consecutive bins, the left half of bin 0 has
//!
//! ```text
//! ½ E₀ + Σ_{k=1}^{5} a_k (E₋ₖ − E_k),                                                            (1)
//! ```
//!
//! the value of the integral at the middle, from the polynomial through its values at the twelve edges around it (average interpolation:
//! Donoho, "Smooth wavelet decompositions with blocky coefficient kernels", 1993). The right half has the rest, so that no energy is lost.
//!
//! The first paths of a part are put into the wide bins one by one, each into up to 128 of them. Each of the others, of which sharing makes
//! thousands, becomes fourteen impulses: as a function of the delay d, the energy of a bin is as smooth as the pulse, and the polynomial
//! through its values at the delays i H around d is the sum
//!
//! ```text
//! E_j(d) ≈ Σ_i l_i(d) K_{j−i},    K_m the energy that a pulse without delay has from m H to (m + 1) H,           (2)
//! ```
//!
//! with Lagrange's l_i. So the weights l_i of all paths are added up by i, and K is applied to the sums once. The cost of a path depends
//! neither on the bins nor on the pulse. For a Gaussian, the errors of (1) and (2) together are below 1·10⁻⁷ of the fullest bin, about the
//! size of rounding to f32 (tested). Bins beyond either end are kept as far as (1) reaches.

use std::ops::Range;

use super::{Bins, Energy};
use crate::light::lamp::Emission;

/// The coefficients a₁ to a₅ of (1).
const HALVING: [f64; 5] = [
    29_011.0 / 262_144.0,
    -569.0 / 16_384.0,
    4_661.0 / 524_288.0,
    -49.0 / 32_768.0,
    63.0 / 524_288.0,
];
/// Bins kept beyond either end: (1) reaches 5 from those that become end bins themselves after halving, which are half as many.
const BEYOND: usize = 2 * HALVING.len();
/// Width of the widest bins for a pulse in units of its σ, and of the narrowest.
const WIDEST: f64 = 0.25;
const NARROWEST: f64 = 0.125;

/// Points of (2), and how many of them are at or before the delay.
const POINTS: usize = 14;
const BEFORE: usize = POINTS / 2 - 1;
/// 1/∏ (k − m) over the other points m, for each point k of (2).
const LAGRANGE: [f64; POINTS] = lagrange();
/// Paths of a part that are put into bins one by one: about as many as cost the same as applying K once.
const ONE_BY_ONE: usize = 16;

/// Energies in bins that are 2ᵏ times as wide as requested.
struct Wide {
    bins: Bins,
    /// By bin and channel, including the bins beyond either end.
    part: Vec<f64>,
    /// Impulses of Gaussian pulses, by σ.
    impulses: Vec<Impulses>,
}

/// The sums of (2) for pulses of one σ, and the number of paths before them.
struct Impulses {
    sigma: f64,
    paths: usize,
    /// K of a pulse of unit integral, and the m of its first entry.
    kernel: Vec<f64>,
    first: i64,
    /// Sums of l_i by channel, from i = `from` on; delays are counted from the start of the wide bins.
    sums: [Vec<f64>; 3],
    from: i64,
    /// The range of indices of the nonzero sums.
    used: Range<usize>,
    /// The range of wide bins reached by pulses; energies of the others stay 0.
    reached: [f64; 2],
    /// Whether all light is nonnegative.
    is_positive: bool,
}

/// Energy of one pixel or texel per bin.
pub(super) struct Histogram {
    /// The current part: sums by bin and channel, and the number of samples.
    pub part: Vec<f64>,
    pub found: u32,
    /// Sums of all earlier parts.
    pub values: Vec<f64>,
    pub all_found: u32,
    pub parts: u32,
    /// Σ f².
    pub found_squares: f64,
    /// By bin Σ S² and Σ S f, with S the mean over channels.
    pub squares: Vec<[f64; 2]>,
    pub energy: Energy,
    /// Light of wide pulses in the current part, for k = 1, 2, …
    wide: Vec<Wide>,
    has_wide: bool,
}

impl Histogram {
    pub fn new(bins: &Bins) -> Self {
        Histogram {
            part: vec![0.0; 3 * bins.count],
            found: 0,
            values: vec![0.0; 3 * bins.count],
            all_found: 0,
            parts: 0,
            found_squares: 0.0,
            squares: vec![[0.0; 2]; bins.count],
            energy: Energy::NONE,
            wide: Vec::new(),
            has_wide: false,
        }
    }

    /// Finishes the current part.
    pub fn end_part(&mut self) {
        if self.found == 0 {
            return;
        }
        self.halve_wide();
        let f = f64::from(self.found);
        for (bin, [squares, with_found]) in self.squares.iter_mut().enumerate() {
            let part = &mut self.part[3 * bin..3 * bin + 3];
            let s = (part[0] + part[1] + part[2]) / 3.0;
            *squares += s * s;
            *with_found += s * f;
            for (sum, part) in self.values[3 * bin..].iter_mut().zip(part) {
                *sum += *part;
                *part = 0.0;
            }
        }
        self.all_found += self.found;
        self.found_squares += f * f;
        self.parts += 1;
        self.found = 0;
    }

    /// The square of the standard error of a bin, given two parts or more.
    pub fn error_square(&self, bin: usize) -> f64 {
        let (n, r) = (f64::from(self.all_found), f64::from(self.parts));
        let m = self.values[3 * bin..3 * bin + 3].iter().sum::<f64>() / (3.0 * n);
        let [squares, with_found] = self.squares[bin];
        // Σ (S − m f)².
        let spread = squares - 2.0 * m * with_found + m * m * self.found_squares;
        // R/(R − 1) Σ (S − m f)²/n², as derived at the head of `bake`.
        r / (r - 1.0) * spread.max(0.0) / (n * n)
    }

    /// Adds `light` times `emission` at its proper times, which are earlier than those of the bins by `delay`.
    pub fn add(&mut self, bins: &Bins, emission: &Emission, light: [f64; 3], delay: f64) {
        let Some([from, to]) = emission.span() else {
            return;
        };
        if !delay.is_finite() || !light.iter().all(|c| c.is_finite()) {
            return;
        }
        let span = [from + delay, to + delay];
        let [begun, ended] = match halvings(bins, emission) {
            0 => spread(&mut self.part, bins, emission, (light, delay)),
            k => {
                self.wide(bins, k).add(emission, (light, delay));
                // The part within the requested bins.
                [bins.start, end_of(bins)].map(|time| emission.until(time - delay))
            }
        };
        let mean = (light[0] + light[1] + light[2]) / 3.0;
        let is_over = end_of(bins) - delay >= to;
        self.energy.add(&Energy {
            held: mean * (ended - begun),
            before: mean * begun,
            after: match is_over {
                true => 0.0,
                false => mean * (emission.until(to) - ended),
            },
            span: Some(span),
        });
    }

    /// The bins that are 2ᵏ times as wide as `bins`, k ≥ 1.
    fn wide(&mut self, bins: &Bins, k: usize) -> &mut Wide {
        while self.wide.len() < k {
            let last = self.wide.last().map_or(*bins, |wide| wide.bins);
            let beyond = if self.wide.is_empty() { 0 } else { BEYOND };
            self.wide.push(Wide::of(&last, beyond));
        }
        self.has_wide = true;
        &mut self.wide[k - 1]
    }

    /// Moves the light of wide pulses into the bins of the part.
    fn halve_wide(&mut self) {
        if !std::mem::take(&mut self.has_wide) {
            return;
        }
        // The widest first: each level is added to the next finer one.
        for k in (0..self.wide.len()).rev() {
            let (finer, wide) = self.wide.split_at_mut(k);
            wide[0].apply();
            match finer.last_mut() {
                Some(finer) => wide[0].halve(&mut finer.part, BEYOND),
                None => wide[0].halve(&mut self.part, 0),
            }
        }
    }
}

impl Wide {
    /// Bins twice as wide as `bins`, of which the first and last `beyond` are beyond the ends.
    fn of(bins: &Bins, beyond: usize) -> Wide {
        let width = 2.0 * bins.width;
        let start = bins.start + beyond as f64 * bins.width;
        let bins = Bins {
            start: start - BEYOND as f64 * width,
            width,
            count: (bins.count - 2 * beyond).div_ceil(2) + 2 * BEYOND,
        };
        Wide {
            bins,
            part: vec![0.0; 3 * bins.count],
            impulses: Vec::new(),
        }
    }

    /// Adds `light` times `emission`, delayed by `delay`.
    fn add(&mut self, emission: &Emission, (light, delay): ([f64; 3], f64)) {
        let Wide {
            bins,
            part,
            impulses,
        } = self;
        let Emission::Gaussian {
            centre,
            sigma,
            scale,
        } = *emission
        else {
            spread(part, bins, emission, (light, delay));
            return;
        };
        // For a pulse much wider than all bins together, K would be longer than the bins.
        if bins.width < NARROWEST * sigma {
            spread(part, bins, emission, (light, delay));
            return;
        }
        let at = impulses.iter().position(|of| of.sigma == sigma);
        let at = at.unwrap_or_else(|| {
            impulses.push(Impulses::new(bins, sigma));
            impulses.len() - 1
        });
        let of = &mut impulses[at];
        of.paths += 1;
        if of.paths <= ONE_BY_ONE {
            spread(part, bins, emission, (light, delay));
        } else {
            of.add(bins, light.map(|c| c * scale), centre + delay);
        }
    }

    /// Adds the light of the impulses to the bins, and removes the impulses.
    fn apply(&mut self) {
        for of in &mut self.impulses {
            of.apply(&mut self.part);
        }
    }

    /// Adds the halves of the bins to the bins `finer`, of which the first and last `beyond` are beyond the ends, and empties them.
    fn halve(&mut self, finer: &mut [f64], beyond: usize) {
        // The first finer bin is the left half of this one.
        let first = BEYOND - beyond / 2;
        for (at, halves) in finer.chunks_mut(6).enumerate() {
            let own = 3 * (first + at);
            for c in 0..3 {
                let all = self.part[own + c];
                let terms = (1..).zip(HALVING).map(|(k, a)| {
                    let [before, after] = [own - 3 * k, own + 3 * k];
                    a * (self.part[before + c] - self.part[after + c])
                });
                // Far from its middle a pulse is smaller than the error of (1): each half gets a fraction of the whole, from 0 to 1.
                let left = 0.5 * all + terms.sum::<f64>();
                let left = left.clamp(all.min(0.0), all.max(0.0));
                halves[c] += left;
                if let Some(right) = halves.get_mut(3 + c) {
                    *right += all - left;
                }
            }
        }
        self.part.fill(0.0);
    }
}

impl Impulses {
    fn new(bins: &Bins, sigma: f64) -> Impulses {
        let pulse = Emission::Gaussian {
            centre: 0.0,
            sigma,
            scale: 1.0,
        };
        let [from, to] = pulse.span().unwrap_or_default();
        let edge = |m: i64| m as f64 * bins.width;
        let first = (from / bins.width).floor() as i64;
        let end = (to / bins.width).ceil() as i64;
        let kernel = (first..end).map(|m| pulse.until(edge(m + 1)) - pulse.until(edge(m)));
        // Delays of pulses that reach any bin, with the interpolation points around them.
        let begin = -end - POINTS as i64;
        let count = (bins.count as i64 - first + POINTS as i64 - begin) as usize;
        Impulses {
            sigma,
            paths: 0,
            kernel: kernel.collect(),
            first,
            sums: std::array::from_fn(|_| vec![0.0; count]),
            from: begin,
            used: count..0,
            reached: [f64::INFINITY, f64::NEG_INFINITY],
            is_positive: true,
        }
    }

    /// Adds the light of a path with this delay.
    fn add(&mut self, bins: &Bins, light: [f64; 3], delay: f64) {
        let delay = (delay - bins.start) / bins.width;
        let whole = delay.floor();
        let place = whole - self.from as f64 - BEFORE as f64;
        // Other delays reach no bin.
        if !(place >= 0.0 && place + POINTS as f64 <= self.sums[0].len() as f64) {
            return;
        }
        let first = place as usize;
        let weights = weights(delay - whole);
        for (sums, light) in self.sums.iter_mut().zip(light) {
            for (sum, weight) in sums[first..first + POINTS].iter_mut().zip(weights) {
                *sum += light * weight;
            }
        }
        self.used = self.used.start.min(first)..self.used.end.max(first + POINTS);
        // K is symmetric: it reaches as many bins after that of the delay as before it.
        let reach = self.first as f64;
        let [least, most] = self.reached;
        self.reached = [least.min(whole + reach), most.max(whole - reach + 1.0)];
        self.is_positive &= light.iter().all(|c| *c >= 0.0);
    }

    /// Adds the energies of all pulses to the bins, and clears the sums.
    fn apply(&mut self, part: &mut [f64]) {
        self.paths = 0;
        let used = std::mem::replace(&mut self.used, self.sums[0].len()..0);
        if used.is_empty() {
            return;
        }
        let count = part.len() / 3;
        let bin = |at: f64| (at.max(0.0) as usize).min(count);
        let [least, most] =
            std::mem::replace(&mut self.reached, [f64::INFINITY, f64::NEG_INFINITY]);
        let reached = bin(least)..bin(most);
        let mut energies = vec![0.0; used.len() + self.kernel.len()];
        // The index of the first bin reached.
        let first = self.from + used.start as i64 + self.first;
        for (c, sums) in self.sums.iter_mut().enumerate() {
            energies.fill(0.0);
            for (at, sum) in sums[used.clone()].iter_mut().enumerate() {
                let sum = std::mem::take(sum);
                for (energy, k) in energies[at..].iter_mut().zip(&self.kernel) {
                    *energy += sum * k;
                }
            }
            // Far from its middle a pulse is smaller than the error of (2): nonnegative light must not become negative.
            let least = if self.is_positive {
                0.0
            } else {
                f64::NEG_INFINITY
            };
            for bin in reached.clone() {
                let energy = energies.get((bin as i64 - first) as usize);
                part[3 * bin + c] += energy.map_or(0.0, |energy| energy.max(least));
            }
        }
        self.is_positive = true;
    }
}

const fn lagrange() -> [f64; POINTS] {
    let mut all = [1.0; POINTS];
    let mut k = 0;
    while k < POINTS {
        let mut m = 0;
        while m < POINTS {
            if m != k {
                all[k] /= k as f64 - m as f64;
            }
            m += 1;
        }
        k += 1;
    }
    all
}

/// The weights l_i at `x`, from 0 to 1 past point `BEFORE`.
fn weights(x: f64) -> [f64; POINTS] {
    let off = |k: usize| x + BEFORE as f64 - k as f64;
    // Products over the points before each point, then over those after it.
    let mut weights = LAGRANGE;
    let mut product = 1.0;
    for (k, weight) in weights.iter_mut().enumerate() {
        *weight *= product;
        product *= off(k);
    }
    product = 1.0;
    for (k, weight) in weights.iter_mut().enumerate().rev() {
        *weight *= product;
        product *= off(k);
    }
    weights
}

/// How many halvings lead from the bins for a pulse to `bins`: 0 if the pulse is not smooth or is too short.
fn halvings(bins: &Bins, emission: &Emission) -> usize {
    let Some(sigma) = emission.sigma() else {
        return 0;
    };
    let (mut k, mut width) = (0, bins.width);
    // No more than that, or most bins would lie beyond the ends.
    while 2.0 * width <= WIDEST * sigma && bins.count >> k >= 4 * BEYOND {
        width *= 2.0;
        k += 1;
    }
    k
}

/// The time at the end of the last bin.
fn end_of(bins: &Bins) -> f64 {
    bins.start + bins.count as f64 * bins.width
}

/// Adds `light` times `emission`, delayed by `delay`, to the bins; returns its integral up to the first bin that it reaches and up to the
/// end of the last.
fn spread(
    part: &mut [f64],
    bins: &Bins,
    emission: &Emission,
    (light, delay): ([f64; 3], f64),
) -> [f64; 2] {
    let Some([from, to]) = emission.span() else {
        return [0.0; 2];
    };
    let bin = |time: f64| (time + delay - bins.start) / bins.width;
    let first = (bin(from).max(0.0) as usize).min(bins.count);
    let end = (bin(to).ceil().max(0.0) as usize).min(bins.count);
    let edge = |bin: usize| bins.start + bin as f64 * bins.width - delay;
    let until = |bin: usize| emission.until(edge(bin));
    // Most paths have all of their light within the bins: the integral before it begins is not evaluated.
    let begun = if edge(first) <= from {
        0.0
    } else {
        until(first)
    };
    let mut before = begun;
    for bin in first..end {
        let after = until(bin + 1);
        for (value, light) in part[3 * bin..3 * bin + 3].iter_mut().zip(light) {
            *value += light * (after - before);
        }
        before = after;
    }
    [begun, before]
}

#[cfg(test)]
mod tests;
