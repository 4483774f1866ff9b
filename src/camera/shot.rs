//! The camera of a scene at the moment of its shot.

use glam::DVec3;

use super::any_projection::AnyProjection;
use super::projection::rotation_matrix;
use crate::error::{Error, Result};
use crate::scene::model::{CameraModel, Motion};
use crate::spacetime::worldline::{State, WorldLine};
use crate::spacetime::{self, Event, Frame, InertialFrame, World};

/// A camera at the moment of its shot, or when its shutter opens.
#[derive(Debug, Clone)]
pub struct Shot {
    /// Its projection at that moment.
    pub projection: AnyProjection,
    /// The inertial frame in which the camera is at rest at that moment.
    pub frame: InertialFrame<spacetime::CameraFrame>,
    /// The pinhole's event then.
    pub event: Event<World>,
    /// What the camera's clock shows then, if it moves without acceleration: the clock of its frame.
    time: Option<f64>,
}

impl Shot {
    /// The shot that `model` takes at its proper time `model.time`.
    ///
    /// # Errors
    /// The motion is impossible, or it has not begun or is over by then.
    pub fn new(model: &CameraModel) -> Result<Self> {
        let state = state(&model.world_line().map_err(impossible)?, model.time)?;
        let turn = model
            .rotation
            .map(|r| rotation_matrix(r.axis, r.rate * model.time));
        let film = AnyProjection::new(model);
        // Its clock shows `time` at the event of the shot.
        let clock = Event::new(model.time, DVec3::ZERO) - Event::ORIGIN;
        let boost = spacetime::Boost::<World, spacetime::CameraFrame>::new(state.velocity);
        let origin = state.event + boost.displacement(clock) * -1.0;
        let inertial = model.motion == Motion::Inertial;
        Ok(Shot {
            projection: turn.map_or(film.clone(), |turn| film.turned(turn)),
            // Without acceleration that is the event of the scene, without rounding.
            frame: InertialFrame::new(state.velocity, if inertial { model.origin } else { origin }),
            event: state.event,
            time: inertial.then_some(model.time),
        })
    }

    /// The pinhole's event then, in the coordinates of `frame`: from the camera's clock if both move in the world without acceleration, so
    /// that no digit is lost to large coordinates there.
    pub fn event_in<F: Frame>(&self, frame: &InertialFrame<F>) -> Event<F> {
        match self.time {
            Some(time) if !self.frame.velocity().is_rest() && !frame.velocity().is_rest() => {
                frame.event_of_clock(&self.frame, time)
            }
            _ => frame.event_from_world(self.event),
        }
    }
}

/// The state of the pinhole on its world line at proper time `time`.
fn state(line: &WorldLine, time: f64) -> Result<State> {
    line.state(time).ok_or_else(|| {
        let [first, last] = line.span();
        let what = match time < first {
            true => format!(
                "the camera's clock shows {time} m, before its world line begins at {first} m"
            ),
            false => {
                format!("the camera's clock shows {time} m, after its world line ends at {last} m")
            }
        };
        Error::invalid(
            "camera",
            "time",
            what,
            "expose within the motion, or lengthen it",
        )
    })
}

/// The error of an impossible world line.
pub(super) fn impossible(error: spacetime::worldline::WorldLineError) -> Error {
    Error::invalid(
        "camera",
        "motion",
        error.to_string(),
        "give a motion slower than light",
    )
}
