//! Light that falls on the points of a run, by point.

use crate::accel::vectors::{BLOCK, Columns};
use crate::light::lamp::{Arrivals, Incidence, Incident, Irradiance};

/// The light of one lamp.
#[derive(Debug, Default)]
pub(super) struct Falling {
    pub arrivals: Arrivals,
    pub incidence: Incidence,
    /// The lamp's intensity as it is seen at W, where that differs.
    pub colours: Columns,
    /// Points that it shines on, and f there where surfaces are none of one kind.
    pub lit: Vec<u32>,
    pub values: Columns,
}

/// The light of all lamps: as [`Irradiance`], in columns of whole blocks.
#[derive(Debug, Default)]
pub(super) struct Gathered {
    pub sum: Columns,
    /// Empty where wavelengths are not weighed.
    pub weight: Vec<f64>,
    pub weighted: Vec<f64>,
    /// Whether anything depends on the wavelengths.
    pub weighs: bool,
}

impl Gathered {
    /// No light at `count` points, whose wavelengths are to be weighed or not.
    pub fn start(&mut self, count: usize, weighs: bool) {
        self.start_unlit(count, weighs);
        self.sum.fill(count, glam::DVec3::ZERO);
    }

    /// The same where the first light overwrites the sum.
    pub fn start_unlit(&mut self, count: usize, weighs: bool) {
        self.weighs = weighs;
        self.sum.resize(count);
        let weighed = if weighs { count } else { 0 };
        for column in [&mut self.weight, &mut self.weighted] {
            column.clear();
            column.resize(weighed.next_multiple_of(BLOCK), 0.0);
        }
    }

    /// That of point `k`.
    #[inline]
    pub fn get(&self, k: usize) -> Irradiance {
        let sum = self.sum.get(k).to_array();
        let weights = match self.weighs {
            true => [self.weight[k], self.weighted[k]],
            false => [0.0; 2],
        };
        Irradiance::from_parts(sum, weights)
    }

    /// Adds light to that of point `k`.
    #[inline]
    pub fn add(&mut self, k: usize, light: &Incident) {
        let mut all = self.get(k);
        all.add(light);
        self.set(k, &all);
    }

    /// Overwrites that of point `k`.
    #[inline]
    pub fn set(&mut self, k: usize, light: &Irradiance) {
        let (sum, weights) = light.parts();
        self.sum.set(k, sum.into());
        if self.weighs {
            [self.weight[k], self.weighted[k]] = weights;
        }
    }
}
