//! What falls on the points of a run from one lamp.

use crate::accel::vectors::Columns;
use crate::light::lamp::Arrivals;

/// The light of one lamp at the points of a run, by point.
#[derive(Debug, Default)]
pub(super) struct Falling {
    pub arrivals: Arrivals,
    /// Towards the lamp in the points' rest frame.
    pub l: Columns,
    /// Of the angle of incidence.
    pub cosines: Vec<f64>,
    /// W, and factors on the lamp's intensity.
    pub ratios: Vec<f64>,
    pub factors: Vec<f64>,
    /// Points that it shines on, and f there where surfaces are not diffuse.
    pub lit: Vec<u32>,
    pub values: Columns,
}

impl Falling {
    /// Makes room for `count` points.
    pub fn resize(&mut self, count: usize) {
        self.l.resize(count);
        self.cosines.resize(count, 0.0);
        self.ratios.resize(count, 0.0);
    }
}
