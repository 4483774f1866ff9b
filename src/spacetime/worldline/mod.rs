//! World lines: the position of a body at each proper time, and the event at which light last left it.
//!
//! | kind | given by | proper times |
//! |---|---|---|
//! | [inertial](WorldLine::inertial) | velocity | all |
//! | [hyperbolic](WorldLine::hyperbolic) | constant proper acceleration | all |
//! | [segments](WorldLine::segments) | stretches of constant proper acceleration | all |
//! | [profile](WorldLine::profile) | proper acceleration over proper time | first to last knot |
//! | [keyframes](WorldLine::keyframes) | events of the world, a smooth curve between | first to last event |
//! | [polyline](WorldLine::polyline) | events of the world, straight between | first to last event |
//! | [animation](WorldLine::animation) | events of the world and velocities there; at rest before the first and after the last event | all |
//! | [circular](WorldLine::circular) | axis and rate | all |
//!
//! Proper time τ and world time ct are in metres, accelerations in 1/m (1 m⁻¹ is c²/m = 9·10¹⁶ m/s²).
//! The comoving frame's axes are the world's, boosted without rotation. Axes carried along without rotation, those of a gyroscope
//! (Fermi–Walker transport), rotate relative to them when the acceleration is oblique to the velocity (Thomas precession). Accelerations
//! are given in the gyroscope's axes, so that splitting a stretch anywhere does not change the path; those of a profile may also be given
//! in the others ([`Axes`]).
//!
//! For a line slower than light, t_E − t(τ) − |x_E − x(τ)| strictly decreases with τ, so the past light cone of an event E crosses the line
//! at most once. It may not cross it at all: a line that accelerates for ever has a horizon, and a line with a beginning and an end does
//! not exist before and after.
//!
//! [`WorldLine::on_past_light_cone`] uses differences from a nearby state, so that the displacement from a sensor to its pinhole keeps its
//! digits wherever in the world the camera is.
//!
//! ```
//! use glam::DVec3;
//! use nullray::spacetime::worldline::WorldLine;
//! use nullray::spacetime::{Displacement, Event, Velocity};
//! # fn main() -> Result<(), nullray::spacetime::worldline::WorldLineError> {
//! let ship = WorldLine::hyperbolic(Velocity::REST, Event::ORIGIN, DVec3::X)?;
//! let later = ship.state(2.0).unwrap();
//! assert_eq!(later.event.ct, f64::sinh(2.0));
//!
//! // The event at which it is seen from a metre behind.
//! let seen = ship.on_past_light_cone(&later, Displacement::new(0.0, -DVec3::X)).unwrap();
//! assert!(seen.proper_time() < 2.0);
//!
//! // None of its light reaches events beyond its horizon.
//! assert!(ship.on_past_light_cone_of(Event::new(-3.0, DVec3::ZERO)).is_none());
//! # Ok(())
//! # }
//! ```

mod arcs;
mod circular;
mod clock;
mod cone;
mod cubics;
mod elapsed;
mod error;
mod horizon;
mod hyperbola;
mod keyframes;
mod profile;
mod root;
mod rounding;
mod series;
mod spline;
mod state;
mod stretch;
mod taylor;
mod thrust;
mod vicinity;
mod world_line;

pub use arcs::Segment;
pub use error::{MAX_ACCELERATION, MAX_ENTRIES, MAX_KEYFRAME_SPEED, WorldLineError};
pub use profile::Axes;
pub use state::{Crossing, State};
pub use stretch::{Anchor, Stretch};
pub use vicinity::Vicinity;
pub use world_line::WorldLine;
