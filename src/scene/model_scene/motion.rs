//! The camera's motion.

use std::path::Path;

use glam::DVec3;

use super::view::{Heading, ModelView, VIEWPOINT};
use crate::error::{Error, Result};
use crate::spacetime::{Boost, CameraFrame, Direction, Velocity, World};

/// The camera's motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Motion {
    pub(super) beta: f64,
    pub(super) gamma: f64,
    /// Unit vector.
    pub(super) n: DVec3,
}

impl Motion {
    /// The motion; `None` at rest.
    pub(super) fn new(path: &Path, view: &ModelView) -> Result<Option<Motion>> {
        let refuse =
            |place: &str, what: String, help: &str| Err(Error::invalid(path, place, what, help));
        let default = view.flyby.then_some(ModelView::FLYBY_SPEED);
        let Some(beta) = view.beta.or(default) else {
            return Ok(None);
        };
        if !(beta > -1.0 && beta < 1.0) {
            let what = format!("|β| = {} is not below 1", beta.abs());
            return refuse("beta", what, "give a speed between −1 and 1, like 0.9");
        }
        let away = VIEWPOINT.normalize();
        let n = match view.direction.unwrap_or(Heading::Along(DVec3::X)) {
            Heading::Along(vector) => vector,
            Heading::Towards => -away,
            Heading::Away => away,
        };
        let Some(n) = Direction::<World>::new(n) else {
            let what = format!("{n} has no direction");
            return refuse("direction", what, "give a vector like 1,0,-1");
        };
        if beta == 0.0 && view.flyby {
            let what = "a camera at rest passes nothing".to_owned();
            return refuse("beta", what, "give a speed above 0, like 0.9");
        }
        let velocity = Velocity::from_beta(n.unit() * beta);
        let gamma = velocity.map_or(f64::INFINITY, Velocity::gamma);
        if gamma.is_nan() || gamma >= 1e8 {
            let what = format!("at |β| = {} nothing can be framed", beta.abs());
            return refuse("beta", what, "give a slower camera");
        }
        let (beta, n) = (beta.abs(), n.unit() * beta.signum());
        Ok((beta > 0.0).then_some(Motion { beta, gamma, n }))
    }

    /// The boost to the camera's frame.
    pub(super) fn boost(&self) -> Boost<CameraFrame, World> {
        let velocity = Velocity::from_beta(self.n * self.beta);
        // The speed was checked when the motion was created.
        Boost::<World, CameraFrame>::new(velocity.unwrap_or(Velocity::REST)).inverse()
    }
}
