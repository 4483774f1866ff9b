//! M(W) of [`shift`](super::RgbShift) as rays look it up: tabulated, with linear interpolation.

use std::array::from_fn;

/// M(W) at a step: by column, its three numbers and a fourth of 0, and their increments to the next step. Everything that a ray needs is
/// contiguous.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShiftMatrix {
    pub columns: [[f32; 8]; 3],
}

impl ShiftMatrix {
    /// Of the columns at a step and at the next.
    pub(super) fn new(entries: &[[f32; 12]]) -> ShiftMatrix {
        let (below, above) = (&entries[0], &entries[1]);
        let number = |at: usize, k: usize| match k < 4 {
            true => below[at],
            false => above[at] - below[at],
        };
        ShiftMatrix {
            columns: from_fn(|column| from_fn(|k| number(4 * column + k % 4, k))),
        }
    }

    /// The matrix of this index, if there is one.
    #[inline(always)]
    pub fn of(matrices: &[ShiftMatrix], at: u64) -> Option<&ShiftMatrix> {
        matrices.get(usize::try_from(at).unwrap_or(usize::MAX))
    }

    /// The matrix at the fraction `rest` of the step to the next, times `v`.
    #[inline(always)]
    pub fn times(&self, rest: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = &self.columns;
        from_fn(|row| {
            let at = |column: &[f32; 8]| f64::from(column[row]) + f64::from(column[4 + row]) * rest;
            at(a) * x + at(b) * y + at(c) * z
        })
    }
}
