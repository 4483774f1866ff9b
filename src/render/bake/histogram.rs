//! The energy of one pixel or texel by bins of time.

use super::{Bins, Energy};
use crate::light::lamp::Emission;

/// Energy per bin of one pixel or texel.
pub(super) struct Histogram {
    /// Of the part that is being taken: sums by bin and channel, and how many samples.
    pub part: Vec<f64>,
    pub found: u32,
    /// Of all parts before it.
    pub values: Vec<f64>,
    pub all_found: u32,
    pub parts: u32,
    /// Σ f².
    pub found_squares: f64,
    /// By bin Σ S² and Σ S f, with S the mean of the channels.
    pub squares: Vec<[f64; 2]>,
    pub energy: Energy,
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
        }
    }

    /// Ends a part.
    pub fn end_part(&mut self) {
        if self.found == 0 {
            return;
        }
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

    /// The square of the standard error in a bin, of two parts or more.
    pub fn error_square(&self, bin: usize) -> f64 {
        let (n, r) = (f64::from(self.all_found), f64::from(self.parts));
        let m = self.values[3 * bin..3 * bin + 3].iter().sum::<f64>() / (3.0 * n);
        let [squares, with_found] = self.squares[bin];
        // Σ (S − m f)².
        let spread = squares - 2.0 * m * with_found + m * m * self.found_squares;
        r / (r - 1.0) * spread.max(0.0) / (n * n)
    }

    /// Adds `light` times `emission` at its proper times, which are `delay` before those of the bins.
    pub fn add(&mut self, bins: &Bins, emission: &Emission, light: [f64; 3], delay: f64) {
        let Some([from, to]) = emission.span() else {
            return;
        };
        if !delay.is_finite() || !light.iter().all(|c| c.is_finite()) {
            return;
        }
        let bin = |time: f64| (time + delay - bins.start) / bins.width;
        let first = (bin(from).max(0.0) as usize).min(bins.count);
        let end = (bin(to).ceil().max(0.0) as usize).min(bins.count);
        let edge = |bin: usize| bins.start + bin as f64 * bins.width - delay;
        let until = |bin: usize| emission.until(edge(bin));
        let mean = (light[0] + light[1] + light[2]) / 3.0;
        // Most paths have all of their light in the bins: its integral is not asked for before it begins and after it ends.
        let begun = if edge(first) <= from {
            0.0
        } else {
            until(first)
        };
        let mut before = begun;
        for bin in first..end {
            let after = until(bin + 1);
            for (value, light) in self.part[3 * bin..3 * bin + 3].iter_mut().zip(light) {
                *value += light * (after - before);
            }
            before = after;
        }
        let span = [from + delay, to + delay];
        self.energy.add(&Energy {
            held: mean * (before - begun),
            before: mean * begun,
            after: match edge(end) >= to {
                true => 0.0,
                false => mean * (emission.until(to) - before),
            },
            span: Some(span),
        });
    }
}
