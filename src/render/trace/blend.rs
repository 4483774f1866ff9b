//! Blends several captures of one point.

use crate::light::time_texture::{Coverage, Sampled};
use crate::scene::model::CaptureChoice;

/// Rounding error of the weights of taps, which sum to 1 (2⁻⁵³ each): a smaller deficit does not count as missing data.
const ROUNDING: f64 = 1e-9;

/// The values of a surface's captures at one point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Blend {
    /// Weighted sum of radiance, and the sum of the weights.
    radiance: [f64; 3],
    weight: f64,
    /// Index of the capture that contributes most, in the emitter's list, and its weight.
    most: Option<(usize, f64)>,
    /// The best substitute from captures that do not contain the point, and its rank.
    stand_in: (f64, Sampled),
}

impl Blend {
    /// Adds the value of capture `index`, with weight `weight` if it sees the point.
    pub fn add(
        &mut self,
        choice: CaptureChoice,
        index: usize,
        sampled: Sampled,
        weight: Option<f64>,
    ) {
        let is_held = sampled.coverage.held > 1.0 - ROUNDING;
        match weight.filter(|_| is_held) {
            Some(weight) => {
                if choice == CaptureChoice::First && self.weight > 0.0 {
                    return;
                }
                // The first capture is used bit for bit.
                let counts = match choice {
                    CaptureChoice::Blend => weight,
                    CaptureChoice::First => 1.0,
                };
                self.weight += counts;
                for (sum, value) in self.radiance.iter_mut().zip(sampled.radiance) {
                    *sum += counts * value;
                }
                if self.most.is_none_or(|(_, most)| weight > most) {
                    self.most = Some((index, weight));
                }
            }
            None => {
                // A camera that saw the point at another time is better than one that did not see it, which is better than one that looked
                // elsewhere.
                let good = match weight {
                    Some(_) => 2.0 + sampled.coverage.held,
                    None => 1.0 + sampled.coverage.occluded,
                };
                if good > self.stand_in.0 {
                    self.stand_in = (good, sampled);
                }
            }
        }
    }

    /// The blended value.
    pub fn finish(&self) -> Sampled {
        if self.weight == 0.0 {
            return self.stand_in.1;
        }
        Sampled {
            radiance: self.radiance.map(|sum| sum / self.weight),
            coverage: Coverage::HELD,
            ..Sampled::default()
        }
    }

    /// The capture that contributes most to the point; `None` if none contains the point.
    pub fn most(&self) -> Option<usize> {
        self.most.map(|(index, _)| index)
    }
}
