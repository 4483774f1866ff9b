//! What is drawn of area lights, in arrays.

use crate::accel::vectors::Columns;

/// What area lights send to the points of a run, by point: one drawn point of all elements for each.
#[derive(Debug, Default)]
pub(super) struct AreaDraws {
    /// The element.
    pub elements: Vec<u32>,
    /// Points whose element is in one frame, and, where that is not their own, where they are in it.
    pub chosen: Vec<u32>,
    pub places: Columns,
    /// Barycentrics of the point that is drawn.
    pub u: Vec<f64>,
    pub v: Vec<f64>,
    /// Towards it in the point's rest frame, and in the world.
    pub l: Columns,
    pub d: Columns,
    /// As far as something may be in the way, metres of the world.
    pub distances: Vec<f64>,
    /// W.
    pub ratios: Vec<f64>,
    /// cos θ_y cos θ_F/r² over the density per area; 0 where no light falls.
    pub factors: Vec<f64>,
    /// Per solid angle of the point's rest frame.
    pub densities: Vec<f64>,
}

impl AreaDraws {
    /// Makes room for `count` points.
    pub fn resize(&mut self, count: usize) {
        self.l.resize(count);
        self.d.resize(count);
        self.places.resize(count);
        for numbers in [
            &mut self.u,
            &mut self.v,
            &mut self.distances,
            &mut self.ratios,
            &mut self.factors,
            &mut self.densities,
        ] {
            numbers.resize(count, 0.0);
        }
    }
}
