//! A cube of samples as in the file: shape (H, W, T, C), C order, one copy in memory.

use std::ops::Range;

use half::f16;
use rayon::prelude::*;

use crate::io::npy::Dtype;

/// Samples in their stored precision.
#[derive(Debug, Clone, PartialEq)]
pub enum CubeSamples {
    /// IEEE half precision.
    F16(Vec<f16>),
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
}

/// A cube of finite samples, shape (H, W, T, C), C order; row 0 is the top row.
///
/// [`Cube::new`] checks all of this. Of a cube built by hand [`Cube::check`] does, which is called for those of a scene before it is
/// rendered; a time texture checks again what reading relies on, so that it cannot be read out of range.
#[derive(Debug, Clone, PartialEq)]
pub struct Cube {
    /// H, W, T, C; each at least 1.
    pub shape: [usize; 4],
    /// H·W·T·C samples.
    pub samples: CubeSamples,
}

/// Why something is not a cube, or cannot be looked up. The reader of the file adds its name.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CubeError {
    /// An axis has no entries.
    #[error("the {0} axis is empty; every axis of (H, W, T, C) needs at least one entry")]
    EmptyAxis(&'static str),
    /// The shape and the number of samples disagree (or the shape's product overflows).
    #[error("shape {shape:?} does not hold {samples} samples")]
    Length {
        /// H, W, T, C.
        shape: [usize; 4],
        /// The number of samples.
        samples: usize,
    },
    /// A sample is NaN or infinite.
    #[error("the sample at (row, column, bin, channel) = {0:?} is not finite")]
    NotFinite([usize; 4]),
    /// Neither one channel nor three.
    #[error("{0} channels: a cube holds 1 (grey) or 3 (linear RGB)")]
    Channels(usize),
    /// A table of bin edges does not match the number of bins.
    #[error("{edges} bin edges for {bins} time bins, which have {} edges", bins + 1)]
    Edges {
        /// The number of edges.
        edges: usize,
        /// The number of bins.
        bins: usize,
    },
    /// Start, bin width or scale of the time axis is unusable.
    #[error("the time axis has {quantity} {value}; it must be {right}")]
    Axis {
        /// The quantity.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What would be right.
        right: &'static str,
    },
}

crate::error::value_errors!(CubeError);

impl CubeError {
    /// The field of a cube, or of its source, that it is about.
    pub(crate) fn field(&self) -> String {
        match self {
            CubeError::EmptyAxis(_) | CubeError::Length { .. } | CubeError::Channels(_) => {
                "shape".into()
            }
            CubeError::NotFinite([i, j, k, c]) => format!("samples[{i},{j},{k},{c}]"),
            CubeError::Edges { .. } => "edges".into(),
            CubeError::Axis { quantity, .. } => (*quantity).into(),
        }
    }
}

impl CubeSamples {
    /// The number of samples.
    pub fn len(&self) -> usize {
        match self {
            CubeSamples::F16(s) => s.len(),
            CubeSamples::F32(s) => s.len(),
            CubeSamples::F64(s) => s.len(),
        }
    }

    /// Their size in bytes.
    pub fn bytes(&self) -> u64 {
        let each = match self {
            CubeSamples::F16(_) => 2,
            CubeSamples::F32(_) => 4,
            CubeSamples::F64(_) => 8,
        };
        each * self.len() as u64
    }

    /// Resizes to this many; new ones are 0.
    pub(super) fn resize(&mut self, count: usize) {
        match self {
            CubeSamples::F16(s) => s.resize(count, f16::ZERO),
            CubeSamples::F32(s) => s.resize(count, 0.0),
            CubeSamples::F64(s) => s.resize(count, 0.0),
        }
    }

    /// Copies those of `from` in `range`, if of the same type and in range, to place `at` and on.
    pub(super) fn copy(&mut self, at: usize, from: &CubeSamples, range: Range<usize>) {
        fn each<T: Copy>(to: &mut [T], at: usize, from: &[T], range: Range<usize>) {
            if let (Some(to), Some(from)) = (to.get_mut(at..at + range.len()), from.get(range)) {
                to.copy_from_slice(from);
            }
        }
        match (self, from) {
            (CubeSamples::F16(to), CubeSamples::F16(from)) => each(to, at, from, range),
            (CubeSamples::F32(to), CubeSamples::F32(from)) => each(to, at, from, range),
            (CubeSamples::F64(to), CubeSamples::F64(from)) => each(to, at, from, range),
            _ => {}
        }
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A sample as f64; `None` beyond the last.
    pub fn get(&self, index: usize) -> Option<f64> {
        match self {
            CubeSamples::F16(s) => s.get(index).map(|x| x.to_f64()),
            CubeSamples::F32(s) => s.get(index).map(|x| f64::from(*x)),
            CubeSamples::F64(s) => s.get(index).copied(),
        }
    }

    /// Numbers that are of this type, in it.
    pub(super) fn of(dtype: &Dtype, numbers: &[f64]) -> CubeSamples {
        match dtype {
            Dtype::F16 => CubeSamples::F16(numbers.iter().map(|x| f16::from_f64(*x)).collect()),
            Dtype::F32 => CubeSamples::F32(numbers.iter().map(|x| *x as f32).collect()),
            Dtype::F64 | Dtype::Other(_) => CubeSamples::F64(numbers.to_vec()),
        }
    }

    /// This many zeros of this type.
    pub(super) fn zeros(dtype: &Dtype, count: usize) -> CubeSamples {
        let mut zeros = CubeSamples::of(dtype, &[]);
        zeros.resize(count);
        zeros
    }

    /// Fills `to` with the numbers from the `from`-th on, as far as there are any.
    #[inline]
    pub(crate) fn widen(&self, from: usize, to: &mut [f64]) {
        #[inline(always)]
        fn each<T: Copy>(samples: &[T], from: usize, to: &mut [f64], number: impl Fn(T) -> f64) {
            let samples = samples.get(from..).unwrap_or_default();
            to.iter_mut()
                .zip(samples)
                .for_each(|(to, sample)| *to = number(*sample));
        }
        match self {
            CubeSamples::F16(samples) => each(samples, from, to, f16::to_f64),
            CubeSamples::F32(samples) => each(samples, from, to, f64::from),
            CubeSamples::F64(samples) => each(samples, from, to, |number| number),
        }
    }

    /// Inserts this many zeros before the first.
    pub(super) fn pad(&mut self, count: usize) {
        fn each<T: Clone + Default>(samples: &mut Vec<T>, count: usize) {
            samples.splice(..0, std::iter::repeat_n(T::default(), count));
        }
        match self {
            CubeSamples::F16(s) => each(s, count),
            CubeSamples::F32(s) => each(s, count),
            CubeSamples::F64(s) => each(s, count),
        }
    }

    /// The index of the first sample in `range` that is not finite.
    pub(super) fn first_not_finite(&self, range: Range<usize>) -> Option<usize> {
        // Normally all are finite: a loop without an early exit vectorizes.
        fn first<T>(
            samples: &[T],
            range: Range<usize>,
            is_finite: impl Fn(&T) -> bool,
        ) -> Option<usize> {
            let samples = samples.get(range.clone())?;
            let all = samples.iter().fold(true, |all, x| all & is_finite(x));
            match all {
                true => None,
                false => Some(range.start + samples.iter().position(|x| !is_finite(x))?),
            }
        }
        match self {
            CubeSamples::F16(s) => first(s, range, |x| x.is_finite()),
            CubeSamples::F32(s) => first(s, range, |x| x.is_finite()),
            CubeSamples::F64(s) => first(s, range, |x| x.is_finite()),
        }
    }
}

impl Cube {
    /// A cube of `shape` (H, W, T, C).
    ///
    /// # Errors
    /// An empty axis, a number of samples other than H·W·T·C, a sample that is not finite.
    pub fn new(shape: [usize; 4], samples: CubeSamples) -> Result<Cube, CubeError> {
        let cube = Cube { shape, samples };
        cube.check()?;
        Ok(cube)
    }

    /// Checks that no axis is empty, that there are H·W·T·C samples, and that all are finite. Reads all of them, in parallel.
    ///
    /// # Errors
    /// The first of these that fails.
    pub fn check(&self) -> Result<(), CubeError> {
        /// Samples that a thread checks at a time.
        const PIECE: usize = 1 << 16;
        self.check_shape()?;
        let count = self.samples.len();
        let pieces = (0..count.div_ceil(PIECE)).into_par_iter();
        let bad = pieces.find_map_first(|n| {
            let range = n * PIECE..count.min((n + 1) * PIECE);
            self.samples.first_not_finite(range)
        });
        match bad {
            Some(place) => Err(CubeError::NotFinite(place_of(place, self.shape))),
            None => Ok(()),
        }
    }

    /// What [`Cube::check`] asks for, for messages.
    pub(crate) const CHECKED: &str =
        "a shape (H, W, T, C) without empty axes, H·W·T·C samples, all of them finite";

    /// The sum over the channels of bin `bin` of pixel `pixel` (row · W + column); 0 if it does not exist.
    pub fn total(&self, pixel: usize, bin: usize) -> f64 {
        let [_, _, bins, channels] = self.shape;
        let first = (pixel * bins + bin) * channels;
        (first..first + channels)
            .filter_map(|at| self.samples.get(at))
            .sum()
    }

    /// Whether the shape matches the samples: everything that reading in range relies on.
    pub(crate) fn check_shape(&self) -> Result<(), CubeError> {
        let names = ["row", "column", "time", "channel"];
        if let Some((name, _)) = names.iter().zip(self.shape).find(|(_, n)| *n == 0) {
            return Err(CubeError::EmptyAxis(name));
        }
        let product = self
            .shape
            .iter()
            .try_fold(1usize, |product, n| product.checked_mul(*n));
        if product == Some(self.samples.len()) {
            Ok(())
        } else {
            Err(CubeError::Length {
                shape: self.shape,
                samples: self.samples.len(),
            })
        }
    }
}

/// (row, column, bin, channel) of sample `index`.
pub(super) fn place_of(index: usize, [_, w, t, c]: [usize; 4]) -> [usize; 4] {
    [
        index / (w * t * c),
        index / (t * c) % w,
        index / c % t,
        index % c,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_that_disagrees_with_the_samples_is_refused() {
        let samples = || CubeSamples::F32(vec![0.0; 24]);
        assert!(Cube::new([2, 3, 4, 1], samples()).is_ok());
        for shape in [[2, 3, 4, 2], [usize::MAX, usize::MAX, 2, 12]] {
            let refused = Cube::new(shape, samples());
            assert_eq!(refused, Err(CubeError::Length { shape, samples: 24 }));
        }
        let empty = Cube::new([2, 0, 4, 1], CubeSamples::F64(vec![]));
        assert_eq!(empty, Err(CubeError::EmptyAxis("column")));
    }

    #[test]
    fn a_sample_that_is_not_finite_is_named_by_its_place() {
        let mut samples = vec![1.0; 2 * 3 * 4 * 3];
        samples[((3 + 2) * 4 + 3) * 3 + 1] = f64::NAN;
        let refused = Cube::new([2, 3, 4, 3], CubeSamples::F64(samples));
        assert_eq!(refused, Err(CubeError::NotFinite([1, 2, 3, 1])));
        let half = CubeSamples::F16(vec![half::f16::INFINITY]);
        assert!(Cube::new([1, 1, 1, 1], half).is_err());
    }
}
