//! Proper time along a curve that is given by world time: τ = ∫ √(1 − |v|²) dct.
//!
//! Gauss's rule of ten points on cells that are halved until both halves add up to the whole. Near the speed
//! of light the root bends sharply, and cells become short there. Within a cell the same rule, on a part
//! of it, gives the time from its beginning. A rate r is known to eps/r, since 1 − |v|² is a difference: what
//! halves and whole may differ by of that alone is no reason to go on.
//!
//! Source: Abramowitz and Stegun, table 25.4.

use super::root::{self, Sample};

/// Abscissae and weights of Gauss's rule on [−1, 1], those of one side.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_2, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_36),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// How often a cell is halved.
const HALVINGS: u32 = 40;

/// Cells per span of the curve, on average, beyond which none is halved any more.
const CELLS: usize = 64;

/// What the halves of a cell may differ from the whole, relative.
const TOLERANCE: f64 = 1e-15;

/// Cells of world time, with the proper time at which each begins.
#[derive(Debug, Clone)]
pub(super) struct Clock {
    /// Ends of the cells: world time and proper time.
    ends: Vec<[f64; 2]>,
    /// So many ends at most, while cells are made.
    most: usize,
}

impl Clock {
    /// The clock that shows 0 at the first of `nodes` (ascending world times, between which `rate` is
    /// smooth), and runs at `rate` = dτ/dct.
    pub fn new(nodes: &[f64], rate: impl Fn(f64) -> f64) -> Self {
        let mut clock = Clock {
            ends: vec![[nodes[0], 0.0]],
            most: 0,
        };
        for (index, span) in nodes.windows(2).enumerate() {
            let whole = gauss(&rate, span[0], span[1]);
            clock.most = CELLS * (index + CELLS);
            clock.add([span[0], span[1]], whole, HALVINGS, &rate);
        }
        clock
    }

    fn add(&mut self, [from, to]: [f64; 2], whole: f64, halvings: u32, rate: &impl Fn(f64) -> f64) {
        let middle = 0.5 * (from + to);
        let halves = [gauss(rate, from, middle), gauss(rate, middle, to)];
        let apart = (halves[0] + halves[1] - whole).abs();
        let width = to - from;
        // A rate r is known to eps/r (head of this file), and so are the halves and the whole.
        let noise = 4.0 * f64::EPSILON * width * (width / whole);
        let is_exact = apart <= TOLERANCE * whole + noise;
        let is_short = halvings == 0 || middle <= from || middle >= to;
        if is_exact || is_short || self.ends.len() >= self.most {
            let before = self.ends[self.ends.len() - 1][1];
            self.ends.push([to, before + whole]);
            return;
        }
        self.add([from, middle], halves[0], halvings - 1, rate);
        self.add([middle, to], halves[1], halvings - 1, rate);
    }

    /// The proper time at the last node.
    pub fn end(&self) -> f64 {
        self.ends[self.ends.len() - 1][1]
    }

    /// The proper time at world time `ct`.
    pub fn proper_time(&self, ct: f64, rate: impl Fn(f64) -> f64) -> f64 {
        let [begin, proper_time] = self.ends[self.cell(|end| end[0] <= ct)];
        proper_time + gauss(&rate, begin, ct)
    }

    /// The world time at which the clock shows `proper_time`.
    pub fn world_time(&self, proper_time: f64, rate: impl Fn(f64) -> f64) -> f64 {
        let cell = self.cell(|end| end[1] <= proper_time);
        let ([begin, shown], [end, last]) = (self.ends[cell], self.ends[cell + 1]);
        let (whole, elapsed) = (end - begin, proper_time - shown);
        // As if the clock ran evenly within the cell.
        let start = whole * elapsed / (last - shown);
        let ct = root::decreasing([0.0, whole], start, |s| Sample {
            value: elapsed - gauss(&rate, begin, begin + s),
            slope: -rate(begin + s),
            noise: f64::EPSILON * elapsed,
        });
        begin + ct
    }

    /// The cell that holds what `before` tells from the ends of cells; the later one at an end.
    fn cell(&self, before: impl Fn(&[f64; 2]) -> bool) -> usize {
        self.ends[1..self.ends.len() - 1].partition_point(before)
    }
}

/// ∫ `f` from `a` to `b`.
fn gauss(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let pair = |(x, weight): &(f64, f64)| weight * (f(middle - half * x) + f(middle + half * x));
    half * GAUSS.iter().map(pair).sum::<f64>()
}
