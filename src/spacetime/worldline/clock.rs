//! Proper time along a curve given as a function of world time: τ = ∫ √(1 − |v|²) dct.
//!
//! Ten-point Gauss quadrature on cells that are bisected until both halves add up to the whole. Near the speed of light the root bends
//! sharply, and cells become short there. Within a cell the same rule, on a part of it, gives the time since its beginning. A rate r is
//! known to eps/r, since 1 − |v|² is a difference: cells are not bisected for differences that this error alone can explain.
//!
//! Source: Abramowitz and Stegun, table 25.4.

use super::root::{self, Sample};

/// Abscissae and weights of Gauss's rule on [−1, 1], of one side.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_2, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_36),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// The maximum number of bisections of a cell.
const HALVINGS: u32 = 40;

/// Average number of cells per span of the curve at which bisection stops.
const CELLS: usize = 64;

/// The tolerance for the difference between the halves and the whole of a cell, relative.
const TOLERANCE: f64 = 1e-15;

/// Cells of world time, with the proper time at which each begins.
#[derive(Debug, Clone)]
pub(super) struct Clock {
    /// Ends of the cells, ascending.
    ends: Vec<End>,
    /// The maximum number of ends while cells are made.
    most: usize,
}

/// The boundary between two cells.
#[derive(Debug, Clone, Copy)]
struct End {
    /// World time.
    ct: f64,
    /// The span of the curve that the cell is in, and the cell's beginning relative to the node before: this way a rate keeps its digits
    /// however late it is.
    span: usize,
    from: f64,
    /// The clock's reading there.
    proper_time: f64,
}

impl Clock {
    /// The clock that reads 0 at the first of `nodes` (ascending world times) and runs at the rate dτ/dct, which must be smooth in each
    /// span between two nodes: `rate` takes the span and the world time since its beginning.
    pub fn new(nodes: &[f64], rate: impl Fn(usize, f64) -> f64) -> Self {
        let first = End {
            ct: nodes[0],
            span: 0,
            from: 0.0,
            proper_time: 0.0,
        };
        let mut clock = Clock {
            ends: vec![first],
            most: 0,
        };
        for (span, ends) in nodes.windows(2).enumerate() {
            let rate = |s| rate(span, s);
            let length = ends[1] - ends[0];
            // On average over the spans so far, plus a reserve for `CELLS` spans.
            clock.most = CELLS * (span + CELLS);
            clock.add(
                ends[0],
                [0.0, length],
                gauss(&rate, 0.0, length),
                HALVINGS,
                &rate,
            );
            // The next cell begins in the next span.
            let last = clock.ends.len() - 1;
            clock.ends[last] = End {
                ct: ends[1],
                span: span + 1,
                from: 0.0,
                ..clock.ends[last]
            };
        }
        clock
    }

    /// Adds the cells from `from` to `to`, relative to the node at the world time `node`; the last end so far is that of `from`.
    fn add(
        &mut self,
        node: f64,
        [from, to]: [f64; 2],
        whole: f64,
        halvings: u32,
        rate: &impl Fn(f64) -> f64,
    ) {
        let middle = 0.5 * (from + to);
        let halves = [gauss(rate, from, middle), gauss(rate, middle, to)];
        let apart = (halves[0] + halves[1] - whole).abs();
        let width = to - from;
        // A rate r is known to eps/r (see the module), and so are the halves and the whole.
        let noise = 4.0 * f64::EPSILON * width * (width / whole);
        let is_exact = apart <= TOLERANCE * whole + noise;
        // World times within a cell must differ from those of its ends.
        let is_short = halvings == 0 || node + middle <= node + from || node + middle >= node + to;
        if is_exact || is_short || self.ends.len() >= self.most {
            let before = self.ends[self.ends.len() - 1];
            self.ends.push(End {
                ct: node + to,
                from: to,
                proper_time: before.proper_time + whole,
                ..before
            });
            return;
        }
        self.add(node, [from, middle], halves[0], halvings - 1, rate);
        self.add(node, [middle, to], halves[1], halvings - 1, rate);
    }

    /// The proper time at the last node.
    pub fn end(&self) -> f64 {
        self.ends[self.ends.len() - 1].proper_time
    }

    /// The proper time at world time `ct`.
    pub fn proper_time(&self, ct: f64, rate: impl Fn(usize, f64) -> f64) -> f64 {
        let begin = self.ends[self.cell(|end| end.ct <= ct)];
        let rate = |s| rate(begin.span, s);
        begin.proper_time + gauss(&rate, begin.from, begin.from + (ct - begin.ct))
    }

    /// The world time at which the clock reads `proper_time`.
    pub fn world_time(&self, proper_time: f64, rate: impl Fn(usize, f64) -> f64) -> f64 {
        let cell = self.cell(|end| end.proper_time <= proper_time);
        let (begin, end) = (self.ends[cell], self.ends[cell + 1]);
        let rate = |s| rate(begin.span, s);
        let (whole, elapsed) = (end.ct - begin.ct, proper_time - begin.proper_time);
        // Start as if the clock ran uniformly within the cell.
        let start = whole * elapsed / (end.proper_time - begin.proper_time);
        let ct = root::decreasing([0.0, whole], start, |s| Sample {
            value: elapsed - gauss(&rate, begin.from, begin.from + s),
            slope: -rate(begin.from + s),
            noise: f64::EPSILON * elapsed,
        });
        begin.ct + ct
    }

    /// The cell for which `before` is true at its beginning and false at its end; the later one at an end.
    fn cell(&self, before: impl Fn(&End) -> bool) -> usize {
        self.ends[1..self.ends.len() - 1].partition_point(before)
    }
}

/// ∫ `f` from `a` to `b`.
fn gauss(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let pair = |(x, weight): &(f64, f64)| weight * (f(middle - half * x) + f(middle + half * x));
    half * GAUSS.iter().map(pair).sum::<f64>()
}
