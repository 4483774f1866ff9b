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
            (*low, *high) = (least(column), greatest(column));
        }
    }
}

/// The least of some numbers, lane by lane and then across.
#[inline(always)]
fn least(numbers: &[f64]) -> f64 {
    let mut lanes = [f64::INFINITY; FEW];
    let (chunks, rest) = numbers.as_chunks::<FEW>();
    for chunk in chunks {
        for (lane, x) in lanes.iter_mut().zip(chunk) {
            *lane = lesser_of(*x, *lane);
        }
    }
    for (lane, x) in lanes.iter_mut().zip(rest) {
        *lane = lesser_of(*x, *lane);
    }
    lanes
        .into_iter()
        .fold(f64::INFINITY, |a, b| if b < a { b } else { a })
}

/// The same of the greatest.
#[inline(always)]
fn greatest(numbers: &[f64]) -> f64 {
    let mut lanes = [f64::NEG_INFINITY; FEW];
    let (chunks, rest) = numbers.as_chunks::<FEW>();
    for chunk in chunks {
        for (lane, x) in lanes.iter_mut().zip(chunk) {
            *lane = greater_of(*x, *lane);
        }
    }
    for (lane, x) in lanes.iter_mut().zip(rest) {
        *lane = greater_of(*x, *lane);
    }
    lanes
        .into_iter()
        .fold(f64::NEG_INFINITY, |a, b| if b > a { b } else { a })
}

/// The lesser of two numbers; the second if one is NaN.
#[inline(always)]
fn lesser_of(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greater of two numbers; the second if one is NaN.
#[inline(always)]
fn greater_of(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
