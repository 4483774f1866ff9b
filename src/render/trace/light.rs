//! The radiance of a run of points, before the observer's factors.

use super::emission::{Colouring, Emission, Response};
use super::occlusion::Questions;
use super::pulse::{Incident, Irradiance};
use crate::accel::Segment;
use crate::light::time_texture::{Coverage, Located, Lookups};

/// What leaves the points of a run towards the camera, point by point.
#[derive(Debug)]
pub struct Light {
    /// What becomes of it at the observer.
    pub response: Response,
    /// Radiance to which the factors apply, per channel.
    pub radiance: Vec<[f64; 3]>,
    /// What is to be said of points beyond that, in their order.
    pub details: Vec<Detail>,
    pub(super) lookups: Box<Lookups>,
    /// What may stand in the way of light.
    pub(super) questions: Questions,
    pub(super) segments: Vec<Segment>,
    pub(super) blocked: Vec<bool>,
    /// Of one pulse, by the point that it may fall on.
    pub(super) arriving: Vec<(usize, Incident)>,
    /// Of all pulses, by point.
    pub(super) incident: Vec<Irradiance>,
    /// Where points lie in the image of a capture camera, with their times.
    pub(super) located: Vec<(Located, f64)>,
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
            lookups: Box::default(),
            questions: Questions::default(),
            segments: Vec::new(),
            blocked: Vec::new(),
            arriving: Vec::new(),
            incident: Vec::new(),
            located: Vec::new(),
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
