//! The caller's own radiance, held to its contract.

use std::sync::OnceLock;

use super::base_colours::Dependence;
use super::emitted::{Emission, Emitted, Scaling};
use super::radiance::Radiance;
use super::run::Run;
use super::stats::Meter;
use super::surface_point::SurfacePoint;
use crate::error::{Error, Result};
use crate::light::time_texture::CaptureView;

/// A caller's radiance, which has to start every run once and push one emission for each of its points: the first run without that is an
/// error of [`render`](crate::render::render).
#[derive(Debug)]
pub struct CustomRadiance {
    radiance: Box<dyn Radiance>,
    wrong: OnceLock<Wrong>,
}

/// What was wrong with a run.
#[derive(Debug, Clone, Copy)]
struct Wrong {
    points: usize,
    /// The number of emissions; `None` without a start.
    pushed: Option<usize>,
}

impl CustomRadiance {
    /// From the caller's.
    pub(crate) fn new(radiance: Box<dyn Radiance>) -> Self {
        CustomRadiance {
            radiance,
            wrong: OnceLock::new(),
        }
    }

    /// # Errors
    /// A run that was not started, or with another number of emissions than points.
    pub(crate) fn check(&self) -> Result<()> {
        let Some(Wrong { points, pushed }) = self.wrong.get() else {
            return Ok(());
        };
        let what = match pushed {
            None => "emit did not call Emitted::start".to_string(),
            Some(pushed) => format!("emit pushed {pushed} emissions for a run of {points} points"),
        };
        let help = "for each run call Emitted::start once, then Emitted::push once for each of Run::points, in their order";
        Err(Error::invalid("custom radiance", "", what, help))
    }

    /// Whether a run was wrong, so that the picture is none.
    pub(crate) fn has_failed(&self) -> bool {
        self.wrong.get().is_some()
    }
}

impl Radiance for CustomRadiance {
    fn dependence(&self) -> Dependence {
        self.radiance.dependence()
    }

    fn even(&self) -> Option<(Scaling, Vec<[f64; 3]>)> {
        self.radiance.even()
    }

    fn has_gaps(&self) -> bool {
        self.radiance.has_gaps()
    }

    fn has_data(&self, emitter: u32) -> bool {
        self.radiance.has_data(emitter)
    }

    fn samples_at_once(&self) -> u32 {
        self.radiance.samples_at_once()
    }

    fn emit(&self, run: &Run, emitted: &mut Emitted, meter: &mut Meter) {
        emitted.forget();
        self.radiance.emit(run, emitted, meter);
        let (points, pushed) = (run.count(), emitted.pushed());
        if pushed == Some(points) {
            return;
        }
        // The first is reported; another thread may have been faster.
        let _ = self.wrong.set(Wrong { points, pushed });
        emitted.forget();
        for _ in 0..points {
            emitted.push(Emission::full([0.0; 3]));
        }
    }

    fn capture(&self, point: &SurfacePoint) -> Option<CaptureView> {
        self.radiance.capture(point)
    }

    fn capture_source(&self, point: &SurfacePoint) -> Option<usize> {
        self.radiance.capture_source(point)
    }
}
