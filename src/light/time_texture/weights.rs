//! Weights on runs of bins, and the filters that give them.

use crate::scene::model::TimeFilter;

/// A run of existing bins, and their weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BinWeights {
    pub first: usize,
    /// 0 to 6.
    pub count: usize,
    /// Only the first `count` are used.
    pub weights: [f64; 6],
}

/// No bin.
pub(super) const NOTHING: BinWeights = BinWeights {
    first: 0,
    count: 0,
    weights: [0.0; 6],
};

/// Weights of the four bins around a position, `f` after the second: the cubic of Catmull and Rom (1974), whose slopes at the middle bins
/// are central differences.
#[inline(always)]
pub(super) fn catmull_rom(f: f64) -> [f64; 4] {
    [
        0.5 * f * ((2.0 - f) * f - 1.0),
        0.5 * ((3.0 * f - 5.0) * f * f + 2.0),
        0.5 * f * ((4.0 - 3.0 * f) * f + 1.0),
        0.5 * (f - 1.0) * f * f,
    ]
}

/// Weights on a_k − (a_{k−1} − 2a_k + a_{k+1})/24, as weights on a: one bin more on each side.
#[inline(always)]
pub(super) fn less_curvature([p, q, r, s]: [f64; 4]) -> [f64; 6] {
    let spread = |before: f64, own: f64, after: f64| (26.0 * own - before - after) / 24.0;
    [
        spread(0.0, 0.0, p),
        spread(0.0, p, q),
        spread(p, q, r),
        spread(q, r, s),
        spread(r, s, 0.0),
        spread(s, 0.0, 0.0),
    ]
}

/// The number of bins that a filter reads.
pub(super) fn bins_of(filter: TimeFilter) -> usize {
    match filter {
        TimeFilter::Nearest => 1,
        TimeFilter::Linear => 2,
        TimeFilter::Cubic => 4,
        TimeFilter::CubicMeans => 6,
    }
}
