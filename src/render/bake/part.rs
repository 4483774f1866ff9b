//! The result of a tile of pixels or a row of texels, and how it is stored.

use super::histogram::Histogram;
use super::{Bins, Energy};
use crate::error::Result;
use crate::render::journal::Journal;

/// The result of a tile of pixels or a row of texels.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// Energy by texel, bin and channel.
    pub values: Vec<f32>,
    /// By texel, whether it has any surface.
    pub covered: Vec<bool>,
    pub summary: Summary,
}

/// Sums over texels.
#[derive(Debug)]
pub(super) struct Summary {
    pub energy: Energy,
    /// The energy in numbers that the cube's format blurs; journals, which serve all formats, leave it out.
    pub faint: f64,
    /// By bin, Σ of the squared standard errors.
    pub error_squares: Vec<f64>,
    /// Σ over bins of the squared energies (means of the channels) of the same texels.
    pub energy_squares: f64,
    /// Number of texels hit by samples of two parts or more.
    pub texels: u64,
}

impl Default for Summary {
    fn default() -> Self {
        Summary {
            energy: Energy::NONE,
            faint: 0.0,
            error_squares: Vec::new(),
            energy_squares: 0.0,
            texels: 0,
        }
    }
}

impl Part {
    /// One without texels, with room for this many.
    pub fn new(bins: &Bins, texels: usize) -> Self {
        let mut part = Part {
            values: Vec::with_capacity(3 * bins.count * texels),
            ..Part::default()
        };
        part.summary.error_squares = vec![0.0; bins.count];
        part
    }

    /// Adds the next texel.
    pub fn push(&mut self, texel: &Histogram) {
        let n = texel.all_found;
        self.covered.push(n > 0);
        if n == 0 {
            let blank = std::iter::repeat_n(0.0, texel.values.len());
            return self.values.extend(blank);
        }
        let scale = 1.0 / f64::from(n);
        let means = texel.values.iter().map(|sum| (sum * scale) as f32);
        self.values.extend(means);
        // Of the mean over samples, as the values are.
        let Energy {
            held,
            before,
            after,
            span,
        } = texel.energy;
        self.summary.energy.add(&Energy {
            held: held * scale,
            before: before * scale,
            after: after * scale,
            span,
        });
        // One part gives no error estimate.
        if texel.parts < 2 {
            return;
        }
        self.summary.texels += 1;
        for (bin, sum) in self.summary.error_squares.iter_mut().enumerate() {
            *sum += texel.error_square(bin);
        }
        let values = &self.values[self.values.len() - texel.values.len()..];
        let energies = values
            .chunks(3)
            .map(|rgb| rgb.iter().map(|c| f64::from(*c)).sum::<f64>());
        self.summary.energy_squares += energies.map(|sum| (sum / 3.0).powi(2)).sum::<f64>();
    }

    pub fn to_bytes(&self) -> Vec<u8> {
        let Summary {
            energy,
            error_squares,
            energy_squares,
            texels,
            ..
        } = &self.summary;
        // Without light there is no span, which is written as NaN.
        let [from, to] = energy.span.unwrap_or([f64::NAN; 2]);
        let numbers = [
            energy.held,
            energy.before,
            energy.after,
            from,
            to,
            *energy_squares,
        ];
        let numbers = numbers.iter().chain(error_squares);
        let count = 8 * (1 + numbers.clone().count()) + self.covered.len() + 4 * self.values.len();
        let mut bytes = Vec::with_capacity(count);
        bytes.extend(texels.to_le_bytes());
        bytes.extend(numbers.flat_map(|x| x.to_le_bytes()));
        bytes.extend(self.covered.iter().map(|covered| u8::from(*covered)));
        bytes.extend(self.values.iter().flat_map(|x| x.to_le_bytes()));
        bytes
    }

    /// Reads a part of `texels` texels; `None` if the bytes are not such a part.
    pub fn from_bytes(bytes: &[u8], texels: usize, bins: usize) -> Option<Part> {
        let (count, rest) = bytes.split_first_chunk::<8>()?;
        // Three energies, the two ends of their span, the sum of squares, and one error per bin.
        let (numbers, rest) = rest.split_at_checked(8 * (6 + bins))?;
        let (covered, values) = rest.split_at_checked(texels)?;
        let (values, left) = values.as_chunks::<4>();
        if values.len() != 3 * texels * bins || !left.is_empty() {
            return None;
        }
        let numbers = numbers.as_chunks::<8>().0.iter();
        let numbers: Vec<f64> = numbers.map(|x| f64::from_le_bytes(*x)).collect();
        let span = [numbers[3], numbers[4]];
        let energy = Energy {
            held: numbers[0],
            before: numbers[1],
            after: numbers[2],
            span: (!span[0].is_nan()).then_some(span),
        };
        Some(Part {
            values: values.iter().map(|x| f32::from_le_bytes(*x)).collect(),
            covered: covered.iter().map(|covered| *covered == 1).collect(),
            summary: Summary {
                energy,
                faint: 0.0,
                error_squares: numbers[6..].to_vec(),
                energy_squares: numbers[5],
                texels: u64::from_le_bytes(*count),
            },
        })
    }
}

/// Part `index` of the work, of `texels` texels: read from the journal, or else computed by `make` and added to it.
pub(super) fn kept(
    journal: Option<&Journal>,
    index: usize,
    [texels, bins]: [usize; 2],
    make: impl FnOnce() -> Result<Part>,
) -> Result<Part> {
    let Some(journal) = journal else {
        return make();
    };
    let bytes = journal.part(index as u64)?;
    if let Some(part) = bytes.and_then(|bytes| Part::from_bytes(&bytes, texels, bins)) {
        return Ok(part);
    }
    let part = make()?;
    journal.add(index as u64, &part.to_bytes())?;
    Ok(part)
}
