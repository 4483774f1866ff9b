//! The radiance of a run of points, before the observer's factors.

use crate::time_texture::{Coverage, Lookups};

use super::emission::{Colouring, Emission, Response};

/// What leaves the points of a run towards the camera, point by point.
#[derive(Debug)]
pub struct Light {
    /// What becomes of it at the observer.
    pub response: Response,
    /// Radiance to which the factors apply, per channel.
    pub radiance: Vec<[f64; 3]>,
    /// What is to be said of points beyond that, in their order.
    pub details: Vec<Detail>,
    /// Bytes of time-resolved data that were read.
    pub bytes: u64,
    /// Rays that were asked for occlusion.
    pub occlusion_rays: u64,
    pub(super) lookups: Box<Lookups>,
}

/// A point whose radiance is not fully known, or has another wavelength than the response says.
#[derive(Debug, Clone, Copy)]
pub struct Detail {
    /// The point's place in the run.
    pub at: usize,
    /// Radiance that stands for missing data and is shown as it is.
    pub unscaled: [f64; 3],
    /// How much of it the data hold.
    pub coverage: Coverage,
    /// Emitted wavelength over that of the declared line.
    pub wavelength_scale: f64,
}

impl Default for Light {
    fn default() -> Self {
        Light {
            response: Response {
                scaled: None,
                colour: Colouring::Channels,
            },
            radiance: Vec::new(),
            details: Vec::new(),
            bytes: 0,
            occlusion_rays: 0,
            lookups: Box::default(),
        }
    }
}

impl Light {
    /// Forgets the last run.
    pub(super) fn start(&mut self, response: Response) {
        self.response = response;
        self.radiance.clear();
        self.details.clear();
    }

    /// Adds what the next point emits.
    pub(super) fn push(&mut self, emission: Emission) {
        let plain = emission.coverage == Coverage::HELD
            && emission.wavelength_scale == 1.0
            && emission.unscaled == [0.0; 3];
        if !plain {
            self.details.push(Detail {
                at: self.radiance.len(),
                unscaled: emission.unscaled,
                coverage: emission.coverage,
                wavelength_scale: emission.wavelength_scale,
            });
        }
        self.radiance.push(emission.radiance);
    }
}
