//! From time to bins: the bins that a lookup reads, and their weights.
//!
//! Bin k covers [start + k·w, start + (k+1)·w], and its value sits at the centre. With
//! x = (t − start)/w − ½ and f = x − ⌊x⌋ the weights are, from bin ⌊x⌋ (cubic: ⌊x⌋ − 1) on,
//!
//! - nearest: 1 on the bin that contains t (the later one on a border);
//! - linear: 1 − f, f;
//! - cubic (Catmull–Rom, Keys 1981 with a = −½): ½(−f + 2f² − f³), ½(2 − 5f² + 3f³),
//!   ½(f + 4f² − 3f³), ½(−f² + f³). It reproduces quadratics; a cubic a·t³ is off by a·w³ f(1−f)(1−2f);
//! - cubic from means: the same on a_k − (a_{k−1} − 2a_k + a_{k+1})/24. A bin holds a *mean*, which for a
//!   smooth function exceeds the value at its centre by w²L″/24; this takes it off, so that quadratics are
//!   reproduced from their means.
//!
//! Times in [start, start + T·w], both ends included, are inside. Near the ends the filter extends over bins that do not exist. Their
//! values follow the policy for that side: zero for `Black`; the end bin's value for `Hold`; a `Mark` is not a radiance, so the end bin's
//! value is used too. Outside, `Black` and `Mark` read nothing, and `Hold` reads the same extended data (so it joins smoothly, and is the
//! end bin's value alone from at most 2½ bins on).
//!
//! `irregular` reads bins of different widths.

use std::sync::Arc;

use super::irregular::Irregular;
use super::weights::{BinWeights, NOTHING, catmull_rom, less_curvature};
use crate::io::cube::CubeError;
use crate::scene::model::{BinValues, CubeSource, Fill, Outside, TimeBins, TimeFilter};

/// The time axis of a cube. Times are metres of ct on the declared clock.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeAxis {
    /// The bins.
    pub bins: TimeBins,
    /// Whether values are per bin or per metre.
    pub values: BinValues,
    /// Reconstruction along time.
    pub filter: TimeFilter,
    /// Factor on all values.
    pub scale: f64,
}

impl From<&CubeSource> for TimeAxis {
    fn from(source: &CubeSource) -> TimeAxis {
        TimeAxis {
            bins: source.bins.evenly(),
            values: source.values,
            filter: source.filter,
            scale: source.scale,
        }
    }
}

impl TimeAxis {
    /// The end of the last of `bins` bins.
    pub fn end(&self, bins: usize) -> f64 {
        self.bins.edge(bins)
    }

    /// The factor from a stored value to radiance per metre of ct; if bin widths differ, the weights include the widths.
    pub(super) fn factor(&self) -> f64 {
        match (self.values, &self.bins) {
            (BinValues::PerBin, TimeBins::Uniform { width, .. }) => self.scale / width,
            (BinValues::PerBin, TimeBins::Edges(_)) | (BinValues::Density, _) => self.scale,
        }
    }

    fn check(&self, bins: usize) -> Result<(), CubeError> {
        let refuse = |quantity, value, right| {
            Err(CubeError::Axis {
                quantity,
                value,
                right,
            })
        };
        match &self.bins {
            &TimeBins::Uniform { start, width } => {
                if !start.is_finite() {
                    return refuse("start", start, "finite");
                }
                let inverse = 1.0 / width;
                if !(width > 0.0 && width.is_finite() && inverse.is_finite()) {
                    return refuse("bin width", width, "finite and above 0");
                }
                // A bin narrower than the spacing of f64 at its time could not be distinguished from its neighbour.
                let end = self.end(bins);
                if !(self.end(1) > start && end - width < end && end.is_finite()) {
                    return refuse("bin width", width, "resolvable beside the times");
                }
            }
            TimeBins::Edges(edges) => {
                if edges.len() != bins + 1 {
                    return Err(CubeError::Edges {
                        edges: edges.len(),
                        bins,
                    });
                }
                if let Some(bad) = edges.iter().find(|edge| !edge.is_finite()) {
                    return refuse("bin edge", *bad, "finite");
                }
                let follows =
                    |pair: &[f64]| (1.0 / (pair[1] - pair[0])).is_finite() && pair[1] > pair[0];
                if let Some(pair) = edges.windows(2).find(|pair| !follows(pair)) {
                    return refuse("bin edge", pair[1], "after the edge before it");
                }
            }
        }
        if !self.factor().is_finite() {
            return refuse("scale", self.scale, "finite, also per bin width");
        }
        Ok(())
    }
}

/// The position of a time relative to the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    Before,
    Inside,
    After,
}

/// The bins that a time reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    pub phase: Phase,
    pub bins: BinWeights,
}

/// How times are read.
#[derive(Debug, Clone)]
pub(super) enum Reading {
    /// From bins of one width.
    Uniform(TimeFilter),
    /// From bins whose widths differ.
    Irregular(Arc<Irregular>),
}

/// A time axis with its number of bins and its ends' policies.
#[derive(Debug, Clone)]
pub(super) struct Timeline {
    pub start: f64,
    pub end: f64,
    /// By the narrowest bin.
    pub bins_per_metre: f64,
    pub bins: usize,
    pub reading: Reading,
    pub before: Fill,
    pub after: Fill,
}

impl Timeline {
    pub fn new(axis: &TimeAxis, bins: usize, outside: &Outside) -> Result<Self, CubeError> {
        axis.check(bins)?;
        Ok(Timeline {
            start: axis.end(0),
            end: axis.end(bins),
            bins_per_metre: 1.0 / axis.bins.least_width(),
            bins,
            reading: match &axis.bins {
                TimeBins::Uniform { .. } => Reading::Uniform(axis.filter),
                TimeBins::Edges(edges) => {
                    Reading::Irregular(Arc::new(Irregular::new(edges, axis.values, axis.filter)))
                }
            },
            before: outside.before,
            after: outside.after,
        })
    }

    /// The bins that time `t` reads. NaN counts as before the data.
    #[inline]
    pub fn moment(&self, t: f64) -> Moment {
        let phase = self.phase(t);
        let reads = match phase {
            Phase::Inside => true,
            Phase::Before => self.before == Fill::Hold,
            Phase::After => self.after == Fill::Hold,
        };
        let bins = if reads { self.bins(t) } else { NOTHING };
        Moment { phase, bins }
    }

    #[inline]
    fn phase(&self, t: f64) -> Phase {
        if t >= self.start && t <= self.end {
            Phase::Inside
        } else if t > self.end {
            Phase::After
        } else {
            Phase::Before
        }
    }

    #[inline]
    fn bins(&self, t: f64) -> BinWeights {
        let last = self.bins as f64 - 1.0;
        // Clamped where a held end is already constant; max first, because it turns NaN into a number.
        let b = ((t - self.start) * self.bins_per_metre)
            .max(-3.0)
            .min(last + 4.0);
        match &self.reading {
            Reading::Uniform(filter) => self.filtered(*filter, b),
            Reading::Irregular(bins) => self.irregular(bins, t),
        }
    }

    /// The bins that are read `b` bins after the start.
    #[inline]
    pub fn filtered(&self, filter: TimeFilter, b: f64) -> BinWeights {
        let last = self.bins as f64 - 1.0;
        match filter {
            TimeFilter::Nearest => self.run(b.max(0.0).min(last) as i64, [1.0]),
            TimeFilter::Linear => {
                let (k, f) = split(b - 0.5);
                self.run(k, [1.0 - f, f])
            }
            TimeFilter::Cubic => {
                let (k, f) = split(b - 0.5);
                self.run(k - 1, catmull_rom(f))
            }
            TimeFilter::CubicMeans => {
                let (k, f) = split(b - 0.5);
                self.run(k - 2, less_curvature(catmull_rom(f)))
            }
        }
    }

    #[cold]
    fn irregular(&self, bins: &Irregular, t: f64) -> BinWeights {
        let (first, run) = bins.weights(t);
        let mut folded = self.folded(first, run.as_slice());
        bins.per_metre(&mut folded);
        folded
    }

    /// Weights on the bins from `first` on, folded onto the existing ones.
    #[inline]
    fn run<const N: usize>(&self, first: i64, run: [f64; N]) -> BinWeights {
        if first >= 0 && first + N as i64 <= self.bins as i64 {
            let mut weights = [0.0; 6];
            weights[..N].copy_from_slice(&run);
            BinWeights {
                first: first as usize,
                count: N,
                weights,
            }
        } else {
            self.folded(first, &run)
        }
    }

    #[cold]
    fn folded(&self, first: i64, run: &[f64]) -> BinWeights {
        let last = self.bins as i64 - 1;
        // The slot of a bin is counted from the first existing bin of the run, so slots are below the length of the run.
        let start = first.clamp(0, last);
        let mut folded = BinWeights {
            first: start as usize,
            ..NOTHING
        };
        // Bins beyond an end have the value of the end bin, or are black.
        for (bin, weight) in (first..).zip(run) {
            let black = (bin < 0 && self.before == Fill::Black)
                || (bin > last && self.after == Fill::Black);
            let slot = (bin.clamp(0, last) - start) as usize;
            if !black {
                folded.weights[slot] += weight;
                folded.count = folded.count.max(slot + 1);
            }
        }
        folded
    }
}

/// ⌊x⌋ and x − ⌊x⌋, for x of the size of a bin index.
#[inline]
fn split(x: f64) -> (i64, f64) {
    let truncated = x as i64;
    let floor = truncated - i64::from(x < truncated as f64);
    (floor, x - floor as f64)
}
