//! Samples below 0: statistics, and their treatment.

use std::path::Path;
use std::sync::Arc;

use half::f16;
use rayon::prelude::*;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::samples::{Cube, CubeSamples, place_of};
use crate::error::{Error, Result};

/// What to do with samples below 0, which occur in data with a background subtracted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Negative {
    /// They stay, so that means over many keep their value.
    Keep,
    /// They become 0.
    Zero,
    /// The cube is refused.
    Refuse,
}

/// Statistics of samples below 0.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BelowZero {
    /// Their number, and the number of samples.
    pub count: u64,
    /// The number of samples examined.
    pub of: u64,
    /// The smallest.
    pub least: f64,
    /// Its row, column, bin and channel; the first among equals.
    pub place: [usize; 4],
}

impl BelowZero {
    /// For the samples examined, each with its place in a cube of this shape; `None` if there are none.
    pub fn among(
        samples: impl Iterator<Item = (usize, f64)>,
        shape: [usize; 4],
    ) -> Option<BelowZero> {
        let mut counted = Counted::default();
        samples.for_each(|(at, x)| counted.add(at, x));
        counted.below_zero(shape)
    }
}

/// Samples that were examined one by one, and those of them that are below 0.
#[derive(Debug, Default)]
pub(crate) struct Counted {
    count: u64,
    of: u64,
    /// The place of the least, and the least.
    least: (usize, f64),
}

impl Counted {
    /// Counts the sample at this place in a cube.
    pub fn add(&mut self, at: usize, x: f64) {
        self.of += 1;
        if x < 0.0 {
            self.count += 1;
            self.least = if x < self.least.1 {
                (at, x)
            } else {
                self.least
            };
        }
    }

    /// For a cube of this shape; `None` if none is below 0.
    pub fn below_zero(&self, shape: [usize; 4]) -> Option<BelowZero> {
        (self.count > 0).then(|| BelowZero {
            count: self.count,
            of: self.of,
            least: self.least.1,
            place: place_of(self.least.0, shape),
        })
    }
}

impl std::fmt::Display for BelowZero {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let [i, j, k, c] = self.place;
        let part = 100.0 * self.count as f64 / self.of as f64;
        let are = if self.count == 1 { "is" } else { "are" };
        write!(
            f,
            "{} of {} samples {are} below 0 ({part:.2} %), the least {} at [{i}, {j}, {k}, {c}]",
            self.count,
            self.of,
            shown(self.least)
        )
    }
}

impl Cube {
    /// The statistics of samples below 0; `None` if there are none.
    pub fn below_zero(&self) -> Option<BelowZero> {
        /// Samples that a thread counts at a time.
        const PIECE: usize = 1 << 16;
        fn found<T: Copy + Sync>(
            samples: &[T],
            shape: [usize; 4],
            number: fn(T) -> f64,
        ) -> Option<BelowZero> {
            let pieces = samples.par_chunks(PIECE).enumerate();
            let of_pieces: Vec<BelowZero> = pieces
                .filter_map(|(n, piece)| {
                    let numbered = piece.iter().enumerate();
                    let samples = numbered.map(|(at, x)| (n * PIECE + at, number(*x)));
                    BelowZero::among(samples, shape)
                })
                .collect();
            // In the order of the samples, so that the first among equals is found.
            let all = of_pieces.into_iter().reduce(|a, b| BelowZero {
                count: a.count + b.count,
                ..if b.least < a.least { b } else { a }
            });
            all.map(|all| BelowZero {
                of: samples.len() as u64,
                ..all
            })
        }
        match &self.samples {
            CubeSamples::F16(s) => found(s, self.shape, f16::to_f64),
            CubeSamples::F32(s) => found(s, self.shape, f64::from),
            CubeSamples::F64(s) => found(s, self.shape, |x| x),
        }
    }
}

impl Negative {
    /// Applies the treatment to a shared cube, which is copied if it changes.
    pub(crate) fn applied(self, mut cube: Arc<Cube>, path: &Path) -> Result<Arc<Cube>> {
        if self != Negative::Keep && cube.below_zero().is_some() {
            self.apply_to_cube(Arc::make_mut(&mut cube), path)?;
        }
        Ok(cube)
    }

    /// Applies the treatment to a cube.
    pub(super) fn apply_to_cube(self, cube: &mut Cube, path: &Path) -> Result<()> {
        match (self, cube.below_zero()) {
            (Negative::Keep, _) | (_, None) => Ok(()),
            (Negative::Refuse, Some(found)) => Err(refused(path, found.to_string())),
            (Negative::Zero, Some(_)) => self.apply_to_samples(&mut cube.samples, path),
        }
    }

    /// The same for samples that are read on demand.
    pub(super) fn apply_to_samples(self, samples: &mut CubeSamples, path: &Path) -> Result<()> {
        match samples {
            CubeSamples::F16(samples) => self.apply(samples, path),
            CubeSamples::F32(samples) => self.apply(samples, path),
            CubeSamples::F64(samples) => self.apply(samples, path),
        }
    }

    /// The same of numbers of one type.
    pub(super) fn apply<T>(self, samples: &mut [T], path: &Path) -> Result<()>
    where
        T: Copy + Default + PartialOrd + Into<f64>,
    {
        let zero = T::default();
        match self {
            Negative::Keep => Ok(()),
            Negative::Zero => {
                for x in samples {
                    *x = if *x < zero { zero } else { *x };
                }
                Ok(())
            }
            Negative::Refuse => match samples.iter().find(|x| **x < zero) {
                None => Ok(()),
                Some(x) => {
                    let what = format!("a sample is below 0: {}", shown((*x).into()));
                    Err(refused(path, what))
                }
            },
        }
    }
}

/// A number to six digits.
fn shown(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

fn refused(path: &Path, what: String) -> Error {
    let help = "negative = \"zero\" replaces them by 0, negative = \"keep\" reads them as they are";
    Error::invalid(path, "samples", what, help)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100 000 samples of each type, some below 0, counted one by one.
    #[test]
    fn samples_below_zero_are_counted_and_dealt_with() {
        let shape = [10, 20, 500, 1];
        let value = |n: usize| {
            if n % 977 == 5 {
                -((n % 7) as f64) - 0.5
            } else {
                (n % 11) as f64
            }
        };
        let numbers: Vec<f64> = (0..100_000).map(value).collect();
        let count = numbers.iter().filter(|x| **x < 0.0).count() as u64;
        let first = numbers.iter().position(|x| *x == -6.5).unwrap();
        for samples in [
            CubeSamples::F16(numbers.iter().map(|x| f16::from_f64(*x)).collect()),
            CubeSamples::F32(numbers.iter().map(|x| *x as f32).collect()),
            CubeSamples::F64(numbers.clone()),
        ] {
            let cube = Cube::new(shape, samples).unwrap();
            let found = cube.below_zero().unwrap();
            assert_eq!((found.count, found.of, found.least), (count, 100_000, -6.5));
            assert_eq!(
                found.place,
                [first / 10_000, first / 500 % 20, first % 500, 0]
            );
            let path = Path::new("a.npy");
            let dealt = |with: Negative| {
                let mut cube = cube.clone();
                with.apply_to_cube(&mut cube, path).map(|()| cube)
            };
            assert_eq!(dealt(Negative::Keep).unwrap(), cube);
            let zero = dealt(Negative::Zero).unwrap();
            for (n, x) in numbers.iter().enumerate() {
                assert_eq!(zero.samples.get(n), Some(x.max(0.0)));
            }
            assert_eq!(zero.below_zero(), None);
            let said = dealt(Negative::Refuse).unwrap_err().to_string();
            assert!(
                said.contains(&format!("{count} of 100000")) && said.contains("-6.5"),
                "{said}"
            );
        }
    }
}
