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
mod tests {
    use super::super::weights::{catmull_rom, less_curvature};
    use super::*;

    const EDGES: [f64; 9] = [1.0, 1.1, 1.4, 1.5, 2.3, 2.4, 3.0, 3.7, 3.9];

    fn bins(edges: &[f64], filter: TimeFilter) -> Irregular {
        Irregular::new(&edges.into(), BinValues::Density, filter)
    }

    /// The filtered value at `t` of `value(bin)`.
    fn read(bins: &Irregular, t: f64, value: impl Fn(i64) -> f64) -> f64 {
        let (first, run) = bins.weights(t);
        (first..)
            .zip(run.as_slice())
            .map(|(k, w)| w * value(k))
            .sum()
    }

    #[test]
    fn bins_of_one_width_are_read_as_uniform_ones() {
        let edges: Vec<f64> = (0..12).map(|k| 0.25 * f64::from(k)).collect();
        for i in 0..50 {
            let t = 1.0 + 0.02 * f64::from(i);
            let x = t / 0.25 - 0.5;
            let (k, f) = (x.floor() as i64, x - x.floor());
            let (first, run) = bins(&edges, TimeFilter::Cubic).weights(t);
            assert_eq!(first, k - 1);
            let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-13);
            assert!(near(run.as_slice(), &catmull_rom(f)));
            let (first, run) = bins(&edges, TimeFilter::CubicMeans).weights(t);
            assert_eq!(first, k - 2);
            assert!(near(run.as_slice(), &less_curvature(catmull_rom(f))));
        }
    }

    #[test]
    fn quadratics_come_back_from_their_values_and_from_their_means() {
        let quadratic = |t: f64| 2.0 - 3.0 * t + 0.7 * t * t;
        // ∫ q over a bin, from its antiderivative.
        let integral = |t: f64| 2.0 * t - 1.5 * t * t + 0.7 / 3.0 * t * t * t;
        let cubic = bins(&EDGES, TimeFilter::Cubic);
        let means = bins(&EDGES, TimeFilter::CubicMeans);
        let linear = bins(&EDGES, TimeFilter::Linear);
        let mean = |k: i64| {
            let (from, to) = (
                means.centre(k) - 0.5 * means.width(k),
                means.centre(k) + 0.5 * means.width(k),
            );
            (integral(to) - integral(from)) / (to - from)
        };
        for i in 0..=290 {
            let t = 1.0 + 0.01 * f64::from(i);
            let at_centre = |k| quadratic(cubic.centre(k));
            assert!(
                (read(&cubic, t, at_centre) - quadratic(t)).abs() < 1e-12,
                "{t}"
            );
            assert!((read(&means, t, mean) - quadratic(t)).abs() < 1e-12, "{t}");
            assert!((read(&linear, t, |k| 3.0 * linear.centre(k)) - 3.0 * t).abs() < 1e-12);
        }
    }

    #[test]
    fn times_find_the_bin_that_contains_them_and_stay_near_the_ends() {
        let bins = bins(&EDGES, TimeFilter::Nearest);
        for (t, bin) in [
            (1.0, 0),
            (1.1, 1),
            (2.29, 3),
            (3.9, 7),
            (0.0, 0),
            (f64::NAN, 0),
        ] {
            assert_eq!(bins.weights(t).0, bin, "{t}");
        }
        let cubic = super::tests::bins(&EDGES, TimeFilter::CubicMeans);
        for t in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -1e300] {
            let (first, run) = cubic.weights(t);
            assert!((-8..16).contains(&first), "{t}: {first}");
            assert!((run.as_slice().iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn energies_are_divided_by_the_width_of_their_own_bin() {
        let bins = Irregular::new(&EDGES.into(), BinValues::PerBin, TimeFilter::Linear);
        let mut run = BinWeights {
            first: 2,
            count: 2,
            weights: [0.5, 0.5, 0.0, 0.0, 0.0, 0.0],
        };
        bins.per_metre(&mut run);
        // Bins 2 and 3 are 0.1 and 0.8 wide.
        assert!((run.weights[0] - 5.0).abs() < 1e-12 && (run.weights[1] - 0.625).abs() < 1e-12);
    }
}
