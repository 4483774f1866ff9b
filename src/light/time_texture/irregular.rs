//! Bins of different widths: the bins that a lookup reads, and their weights.
//!
//! Bin k covers [e_k, e_{k+1}], w_k wide, centre c_k. The values a_k are densities: stored ones, or stored
//! energies over w_k. With c_k ≤ t < c_{k+1}, H = c_{k+1} − c_k and f = (t − c_k)/H:
//!
//! - nearest: the bin that contains t; linear: 1 − f, f;
//! - cubic: the Hermite cubic (2f³ − 3f² + 1) a_k + (f³ − 2f² + f) H m_k + (3f² − 2f³) a_{k+1} + (f³ − f²) H m_{k+1}
//!   with the slope at c_k of the parabola through three centres, h = c_k − c_{k−1}, g = c_{k+1} − c_k:
//!   m_k = (g (a_k − a_{k−1})/h + h (a_{k+1} − a_k)/g) / (h + g). Quadratics are reproduced; for equal widths
//!   it is Catmull–Rom.
//! - cubic from means: the same on L_k = a_k − w_k² S_k/24. The mean of a quadratic L exceeds its value at the
//!   centre by w²L″/24. Let D_k(y) = 2 (y_{k−1}/(h(h + g)) − y_k/(hg) + y_{k+1}/(g(h + g))), the second divided
//!   difference; then D(a) = L″ + L″ D(w²)/24, so that S_k = D_k(a)/(1 + D_k(w²)/24) is L″. As h, g ≥ w_k/2, the
//!   denominator is at least 1 − 2·4/24 = 2/3. For equal widths it is the uniform filter.
//!
//! Between neighbouring edges and centres all of these are polynomials of at most third degree, whose mean from t₀ to t₁ is that of the
//! values at (t₀ + t₁)/2 ± (t₁ − t₀)/(2 √3) (Gauss). Means over time spans are sums of such.
//!
//! Beyond the ends the bins continue with the width of the last; the axis defines their values.

use std::sync::Arc;

use super::weights::BinWeights;
use crate::scene::model::{BinValues, TimeFilter};

/// Edges of bins, at least two and ascending, and the interpolation between centres.
#[derive(Debug, Clone)]
pub(super) struct Irregular {
    edges: Arc<[f64]>,
    values: BinValues,
    filter: TimeFilter,
}

/// Weights of consecutive bins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    weights: [f64; 6],
    count: usize,
}

impl Run {
    fn new(run: &[f64]) -> Run {
        let mut weights = [0.0; 6];
        weights[..run.len()].copy_from_slice(run);
        Run {
            weights,
            count: run.len(),
        }
    }

    pub fn as_slice(&self) -> &[f64] {
        &self.weights[..self.count]
    }
}

impl Irregular {
    /// `edges` has been checked: at least two, ascending.
    pub fn new(edges: &Arc<[f64]>, values: BinValues, filter: TimeFilter) -> Irregular {
        Irregular {
            edges: edges.clone(),
            values,
            filter,
        }
    }

    /// The first bin that `t` reads, and the density weights from it on; bins beyond the ends continue the numbering.
    pub fn weights(&self, t: f64) -> (i64, Run) {
        if self.filter == TimeFilter::Nearest {
            return (self.containing(t).clamp(0, self.last()), Run::new(&[1.0]));
        }
        let (k, f) = self.between(t);
        match self.filter {
            TimeFilter::Nearest | TimeFilter::Linear => (k, Run::new(&[1.0 - f, f])),
            TimeFilter::Cubic => (k - 1, Run::new(&self.cubic(k, f))),
            TimeFilter::CubicMeans => (k - 2, Run::new(&self.of_means(k, self.cubic(k, f)))),
        }
    }

    /// The times from `from` to `to` at which the filtered values are read, ascending, each with its part of that time, so that their sum
    /// is the mean.
    pub fn times_between(&self, from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let bins = self.containing(from)..=self.containing(to);
        let joints = bins.flat_map(|bin| [self.start(bin), self.centre(bin)]);
        let joints = joints.filter(move |joint| *joint > from && *joint < to);
        let mut begin = from;
        joints.chain([to]).flat_map(move |end| {
            let [middle, half] = [0.5 * (begin + end), 0.5 * (end - begin)];
            begin = end;
            let aside = half / 3f64.sqrt();
            [middle - aside, middle + aside].map(|time| (time, half / (to - from)))
        })
    }

    /// Converts weights of densities to weights of stored values.
    pub fn per_metre(&self, bins: &mut BinWeights) {
        if self.values == BinValues::PerBin {
            let run = (bins.first as i64..).zip(&mut bins.weights[..bins.count]);
            run.for_each(|(bin, weight)| *weight /= self.width(bin));
        }
    }

    fn last(&self) -> i64 {
        self.edges.len() as i64 - 2
    }

    fn width(&self, bin: i64) -> f64 {
        let bin = bin.clamp(0, self.last()) as usize;
        self.edges[bin + 1] - self.edges[bin]
    }

    fn centre(&self, bin: i64) -> f64 {
        let there = bin.clamp(0, self.last());
        let centre = 0.5 * (self.edges[there as usize] + self.edges[there as usize + 1]);
        centre + (bin - there) as f64 * self.width(there)
    }

    fn start(&self, bin: i64) -> f64 {
        match usize::try_from(bin)
            .ok()
            .and_then(|bin| self.edges.get(bin))
        {
            Some(edge) => *edge,
            None => self.centre(bin) - 0.5 * self.width(bin),
        }
    }

    /// The bin that contains `t`, at most a few beyond the ends; the first for NaN.
    fn containing(&self, t: f64) -> i64 {
        // No filter reads any farther.
        const BEYOND: f64 = 4.0;
        let (start, end) = (self.edges[0], self.edges[self.edges.len() - 1]);
        if t < start {
            ((t - start) / self.width(0)).max(-BEYOND).floor() as i64
        } else if t >= end {
            let beyond = ((t - end) / self.width(self.last())).min(BEYOND) as i64;
            self.last() + 1 + beyond
        } else {
            self.edges.partition_point(|edge| *edge <= t) as i64 - 1
        }
    }

    /// The bin with the last centre at or before `t`, and the fraction of the way from there to the next centre, 0 to 1.
    fn between(&self, t: f64) -> (i64, f64) {
        let bin = self.containing(t).max(-4);
        let k = if t < self.centre(bin) { bin - 1 } else { bin };
        let (from, to) = (self.centre(k), self.centre(k + 1));
        let f = (t - from) / (to - from);
        // Clamped far beyond the ends, where a held end is constant; NaN becomes 0.
        (k, if f > 0.0 { f.min(1.0) } else { 0.0 })
    }

    /// The Hermite cubic's weights of bins k − 1 to k + 2.
    fn cubic(&self, k: i64, f: f64) -> [f64; 4] {
        let [p, q, r, s] = [-1, 0, 1, 2].map(|i| self.centre(k + i));
        let (h, g, l) = (q - p, r - q, s - r);
        // The Hermite basis, with the slopes multiplied by H.
        let value = [(2.0 * f - 3.0) * f * f + 1.0, (3.0 - 2.0 * f) * f * f];
        let slope = [((f - 2.0) * f + 1.0) * f * g, (f - 1.0) * f * f * g];
        // Slopes at both centres as weights of the three values around each.
        let before = slope_weights(h, g).map(|weight| weight * slope[0]);
        let after = slope_weights(g, l).map(|weight| weight * slope[1]);
        [
            before[0],
            value[0] + before[1] + after[0],
            value[1] + before[2] + after[1],
            after[2],
        ]
    }

    /// Weights of values at the centres of bins k − 1 to k + 2, as weights of the means of bins k − 2 to k + 3.
    fn of_means(&self, k: i64, weights: [f64; 4]) -> [f64; 6] {
        let mut means = [0.0; 6];
        for (i, weight) in weights.into_iter().enumerate() {
            let bin = k - 1 + i as i64;
            let (h, g) = (
                self.centre(bin) - self.centre(bin - 1),
                self.centre(bin + 1) - self.centre(bin),
            );
            let difference = [2.0 / (h * (h + g)), -2.0 / (h * g), 2.0 / (g * (h + g))];
            // D(w²), and w² S/24 as weights of the three means.
            let squares = [-1, 0, 1].map(|j| self.width(bin + j) * self.width(bin + j));
            let spread: f64 = difference.iter().zip(squares).map(|(d, w)| d * w).sum();
            let excess = squares[1] / 24.0 / (1.0 + spread / 24.0);
            means[i + 1] += weight;
            for (mean, d) in means[i..].iter_mut().zip(difference) {
                *mean -= weight * excess * d;
            }
        }
        means
    }
}

/// The slope at the middle of three centres, h after the first and g before the last, as weights of their values.
fn slope_weights(h: f64, g: f64) -> [f64; 3] {
    let (before, after) = (g / (h * (h + g)), h / (g * (h + g)));
    [-before, before - after, after]
}

#[cfg(test)]
mod tests;
