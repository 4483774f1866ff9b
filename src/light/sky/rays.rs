//! Look directions of a block of rays, taken together.

use glam::DVec3;

use crate::accel::vectors::{VectorLoop, dispatch};

/// How many rays are taken together that do not look into the same part of a face with the others of their block.
pub(super) const FEW: usize = 8;

/// Up to a block of look directions, by component, with W of each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rays<'a> {
    pub axes: [&'a [f64]; 3],
    /// W of each.
    pub ratios: &'a [f64],
    /// How wide pixels are at W = 1.
    pub pixel: f64,
}

impl<'a> Rays<'a> {
    /// How many.
    #[inline(always)]
    pub fn len(self) -> usize {
        self.ratios.len()
    }

    /// Ray `k`.
    #[inline(always)]
    pub fn get(self, k: usize) -> DVec3 {
        let [x, y, z] = self.axes;
        DVec3::new(x[k], y[k], z[k])
    }

    /// Those of a range.
    #[inline]
    pub fn part(self, begin: usize, end: usize) -> Rays<'a> {
        Rays {
            axes: self.axes.map(|axis| &axis[begin..end]),
            ratios: &self.ratios[begin..end],
            ..self
        }
    }

    /// The least and the greatest of each coordinate, and of W.
    #[inline]
    pub fn bounds(self) -> [[f64; 4]; 2] {
        let [x, y, z] = self.axes;
        let columns = [x, y, z, self.ratios];
        let mut bounds = [[f64::INFINITY; 4], [f64::NEG_INFINITY; 4]];
        match self.len() > FEW {
            true => dispatch(Bounds {
                columns,
                bounds: &mut bounds,
            }),
            false => Bounds {
                columns,
                bounds: &mut bounds,
            }
            .run(),
        }
        bounds
    }
}

/// The least and the greatest numbers of columns.
struct Bounds<'a> {
    columns: [&'a [f64]; 4],
    bounds: &'a mut [[f64; 4]; 2],
}

impl VectorLoop for Bounds<'_> {
    #[inline(always)]
    fn run(self) {
        let [low, high] = self.bounds;
        for (column, (low, high)) in self.columns.iter().zip(low.iter_mut().zip(high)) {
            (*low, *high) = (extreme::<false>(column), extreme::<true>(column));
        }
    }
}

/// The greatest of some numbers, or the least, lane by lane and then across; NaN is passed over.
#[inline(always)]
fn extreme<const GREATEST: bool>(numbers: &[f64]) -> f64 {
    let start = if GREATEST {
        f64::NEG_INFINITY
    } else {
        f64::INFINITY
    };
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
    let mut all = start;
    for lane in lanes {
        all = farther::<GREATEST>(lane, all);
    }
    all
}

/// The greater of two numbers, or the lesser; the second if one is NaN.
#[inline(always)]
fn farther<const GREATEST: bool>(a: f64, b: f64) -> f64 {
    let is_first = if GREATEST { a > b } else { a < b };
    if is_first { a } else { b }
}
