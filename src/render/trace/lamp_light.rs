//! Light that falls on the points of a run.

use crate::accel::vectors::{BLOCK, Columns};
use crate::light::lamp::{Arrivals, Incidence, Incident, Irradiance};

/// The light of one lamp.
#[derive(Debug, Default)]
pub(super) struct LampLight {
    pub arrivals: Arrivals,
    pub incidence: Incidence,
    /// The lamp's intensity as seen at W, if it depends on W.
    pub colours: Columns,
    /// The points that it lights, and the value of f there if the surfaces are not of one kind.
    pub lit: Vec<u32>,
    pub values: Columns,
}

/// The light of all lamps, like [`Irradiance`], in columns of whole blocks.
#[derive(Debug, Default)]
pub(super) struct Gathered {
    pub sum: Columns,
    /// Empty if wavelengths are not averaged.
    pub weight: Vec<f64>,
    pub weighted: Vec<f64>,
    /// Whether anything depends on the wavelengths.
    pub weighs: bool,
}

impl Gathered {
    /// Starts with no light at `count` points; `weighs` says whether wavelengths are averaged.
    pub fn start(&mut self, count: usize, weighs: bool) {
        self.start_unlit(count, weighs);
        self.sum.fill(count, glam::DVec3::ZERO);
    }

    /// The same, but the first light will overwrite the sum.
    pub fn start_unlit(&mut self, count: usize, weighs: bool) {
        self.weighs = weighs;
        self.sum.resize(count);
        let weighed = if weighs { count } else { 0 };
        for column in [&mut self.weight, &mut self.weighted] {
            column.clear();
            column.resize(weighed.next_multiple_of(BLOCK), 0.0);
        }
    }

    /// The light of point `k`.
    #[inline]
    pub fn get(&self, k: usize) -> Irradiance {
        let sum = self.sum.get(k).to_array();
        let weights = match self.weighs {
            true => [self.weight[k], self.weighted[k]],
            false => [0.0; 2],
        };
        Irradiance::from_parts(sum, weights)
    }

    /// Adds light to point `k`.
    #[inline]
    pub fn add(&mut self, k: usize, light: &Incident) {
        let mut all = self.get(k);
        all.add(light);
        self.set(k, &all);
    }

    /// Overwrites the light of point `k`.
    #[inline]
    pub fn set(&mut self, k: usize, light: &Irradiance) {
        let (sum, weights) = light.parts();
        self.sum.set(k, sum.into());
        if self.weighs {
            [self.weight[k], self.weighted[k]] = weights;
        }
    }
}
