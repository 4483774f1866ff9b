//! Look directions of rays.

use glam::DVec3;

use super::star::{Beaming, Motion};
use crate::accel::vectors::{BLOCK, VectorLoop, dispatch};

/// The number of rays processed together when a block does not look into one part of a face.
pub(super) const FEW: usize = 8;

/// Look directions by component, with the W of each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rays<'a> {
    pub axes: [&'a [f64]; 3],
    /// W of each ray.
    pub ratios: &'a [f64],
    /// The width of pixels at W = 1.
    pub pixel: f64,
    pub beaming: Beaming,
    /// The motion of each ray's observer; empty if all have that of `beaming`.
    pub motions: &'a [Motion],
}

impl<'a> Rays<'a> {
    /// The number of rays.
    #[inline(always)]
    pub fn len(self) -> usize {
        self.ratios.len()
    }

    /// The direction of ray `k`.
    #[inline(always)]
    pub fn get(self, k: usize) -> DVec3 {
        let [x, y, z] = self.axes;
        DVec3::new(x[k], y[k], z[k])
    }

    /// The motion of the observer of ray `k`; past the end that of the last.
    #[inline(always)]
    pub fn motion(self, k: usize) -> Motion {
        let own = self.motions.get(k).or(self.motions.last());
        own.copied().unwrap_or(self.beaming.motion)
    }

    /// γ of the fastest observer.
    #[inline]
    pub fn fastest(self) -> f64 {
        let own = self.motions.iter().map(|motion| motion.gamma);
        own.reduce(f64::max).unwrap_or(self.beaming.motion.gamma)
    }

    /// The rays of a range.
    #[inline]
    pub fn part(self, begin: usize, end: usize) -> Rays<'a> {
        Rays {
            axes: self.axes.map(|axis| &axis[begin..end]),
            ratios: &self.ratios[begin..end],
            motions: self.motions.get(begin..end).unwrap_or(&[]),
            ..self
        }
    }

    /// The rays in blocks, each with the index of its first.
    pub fn blocks(self) -> impl Iterator<Item = (usize, Rays<'a>)> {
        let begins = (0..self.len()).step_by(BLOCK);
        begins.map(move |begin| (begin, self.part(begin, self.len().min(begin + BLOCK))))
    }

    /// The minimum and maximum of each coordinate, and of W.
    #[inline]
    pub fn bounds(self) -> Bounds {
        let [x, y, z] = self.axes;
        let columns = [x, y, z, self.ratios];
        let mut bounds = Bounds::NONE;
        let extremes = Extremes {
            columns,
            bounds: &mut bounds,
        };
        // For a few rays the call of a loop with wider vectors costs more than it saves.
        match self.len() > FEW {
            true => dispatch(extremes),
            false => extremes.run(),
        }
        bounds
    }
}

/// The minimum and maximum of each coordinate of some directions, and of W.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub low: [f64; 4],
    pub high: [f64; 4],
}

impl Bounds {
    /// Those of no direction.
    pub const NONE: Bounds = Bounds {
        low: [f64::INFINITY; 4],
        high: [f64::NEG_INFINITY; 4],
    };

    /// The bounds of all directions within `self` and `other`.
    pub fn with(self, other: Bounds) -> Bounds {
        Bounds {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Whether `place` is within this `distance` of the box of the directions.
    #[inline(always)]
    pub fn is_near(&self, place: DVec3, distance: f64) -> bool {
        let mut square = 0.0;
        for (axis, x) in place.to_array().into_iter().enumerate() {
            // The distance from the box along this axis; 0 within it.
            let beyond = (self.low[axis] - x).max(x - self.high[axis]).max(0.0);
            square += beyond * beyond;
        }
        square <= distance * distance
    }
}

/// The minimum and maximum of columns of numbers.
struct Extremes<'a> {
    columns: [&'a [f64]; 4],
    bounds: &'a mut Bounds,
}

impl VectorLoop for Extremes<'_> {
    #[inline(always)]
    fn run(self) {
        let Bounds { low, high } = self.bounds;
        for (column, (low, high)) in self.columns.iter().zip(low.iter_mut().zip(high)) {
            (*low, *high) = (extreme::<false>(column), extreme::<true>(column));
        }
    }
}

/// The maximum or minimum of some numbers, lane by lane and then across lanes; NaN is ignored.
#[inline(always)]
fn extreme<const GREATEST: bool>(numbers: &[f64]) -> f64 {
    let start = if GREATEST {
        f64::NEG_INFINITY
    } else {
        f64::INFINITY
    };
    // Independent lanes: no comparison waits for the one before, and each chunk is one or two vectors.
    let mut lanes = [start; FEW];
    let (chunks, rest) = numbers.as_chunks::<FEW>();
    for chunk in chunks {
        for (lane, x) in lanes.iter_mut().zip(chunk) {
            *lane = farther::<GREATEST>(*x, *lane);
        }
    }
    for (lane, x) in lanes.iter_mut().zip(rest) {
        *lane = farther::<GREATEST>(*x, *lane);
    }
    // In pairs, so that this is done in vectors as well.
    let mut across = FEW / 2;
    while across > 0 {
        for k in 0..across {
            lanes[k] = farther::<GREATEST>(lanes[k + across], lanes[k]);
        }
        across /= 2;
    }
    lanes[0]
}

/// The greater or the lesser of two numbers; the second if one is NaN.
#[inline(always)]
fn farther<const GREATEST: bool>(a: f64, b: f64) -> f64 {
    let is_first = if GREATEST { a > b } else { a < b };
    if is_first { a } else { b }
}
