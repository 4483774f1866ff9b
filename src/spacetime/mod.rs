//! Special relativity in f64: events, velocities, boosts, null rays, wavelength ratios, radiance.
//!
//! Conventions, used everywhere in this crate:
//! - c = 1: an event is `(ct, x, y, z)`, all four in metres.
//! - A frame's velocity is held as a rapidity vector w: β = tanh|w| ŵ, γ = cosh|w|.
//! - Boosts are rotation-free. Transforms are named target-from-source (`world_from_camera`), and
//!   typed that way too: a [`Boost<World, CameraFrame>`](Boost) takes camera quantities to the world, and
//!   nothing else compiles.
//! - A look direction points *out of* the camera, against the light's propagation. The past-directed
//!   null vector of a ray is k = (−ω, ω d).
//!
//! Nothing here depends on images, meshes or files.

#[doc = include_str!("guide.md")]
pub mod guide {}

mod boost;
mod doppler;
mod event;
pub mod paper2015;
mod ray;
pub mod units;
mod velocity;
pub mod worldline;

pub(crate) use boost::Tangents;
pub use boost::{Boost, InertialFrame};
pub(crate) use doppler::{Hue, QuantityKind};
pub use doppler::{Quantity, WavelengthRatio};
pub(crate) use event::unit_and_length_or_nan;
pub use event::{CameraFrame, Direction, Displacement, Event, Frame, Rest, World};
pub use ray::NullRay;
pub use velocity::{MAX_RAPIDITY, Velocity, VelocityError};

/// The speed of light in vacuum, metres per second (exact in SI).
pub const SPEED_OF_LIGHT: f64 = 299_792_458.0;
