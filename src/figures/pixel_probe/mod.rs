//! What a single pixel sees, and its space-time diagram.
//!
//! The pixel's ray is traced by the rendering pipeline: the same tile, at the centre of the pixel, so its numbers are those of the
//! picture's channels. Along the ray and into the past there are
//!
//! ```text
//! E  reception: the sensor element, or the pinhole of a point camera
//! P  = E + |x_P − x_E| (−1, d)      the light passes the pinhole
//! S  = P + s (−η, d)                it left a surface at S, of which the object's clock shows τ_S
//! ```
//!
//! The point of the surface moves on. *Now* it is elsewhere: where its world line is simultaneous with E, in the camera's frame or in the
//! world.
//!
//! ```text
//! scene, pixel ── trace ──▶ Probe ── diagram ──▶ model::diagram::Diagram → layout → drawing
//! ```
//!
//! In the diagram, x is along the ray. In vacuum the ray lies in the plane of x and ct and has a slope of 45 degrees; anything beside
//! that plane is projected onto it, and its light is steeper. In a medium, and with retardation turned off, the ray has the slope with
//! which it is rendered.

mod data;
mod diagram;
mod trace;

pub use diagram::{Origin, diagram};
pub use trace::{check, trace};

use glam::DVec3;
use serde::Serialize;

use crate::figures::diagram::model::Track;
use crate::spacetime::{self, Direction, Event, InertialFrame, Velocity, World};

/// What a single pixel sees. Lengths and times are in metres; as data, events are (ct, x, y, z) in the world.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Probe {
    /// Column and row.
    pub pixel: [u32; 2],
    /// The light's arrival in the camera.
    #[serde(flatten)]
    pub reception: Reception,
    /// The look direction in the world.
    #[serde(serialize_with = "data::direction")]
    pub direction: Direction<World>,
    /// Metres of ct per metre of the ray: the medium's refractive index; 0 where light takes no time.
    #[serde(rename = "refractive_index")]
    pub index: f64,
    /// The world line of the pinhole.
    #[serde(skip)]
    pub camera: Track,
    /// The world line of the sensor element, if there is a sensor that does not turn.
    #[serde(skip)]
    pub element: Option<Track>,
    /// What the ray hits.
    #[serde(rename = "surface")]
    pub hit: Option<ProbeHit>,
    /// How far a ray that hits nothing is followed.
    #[serde(skip)]
    pub reach: f64,
}

/// The light's arrival.
#[derive(Debug, Clone, Copy, Serialize)]
#[non_exhaustive]
pub struct Reception {
    /// Proper time of the camera at the arrival: that of its pinhole.
    #[serde(rename = "reception_proper_time")]
    pub time: f64,
    /// The arrival: at the sensor element, or at the pinhole of a point camera.
    #[serde(rename = "reception", serialize_with = "data::event")]
    pub event: Event<World>,
    /// The pinhole's event when the light passes it.
    #[serde(serialize_with = "data::event")]
    pub pinhole: Event<World>,
    /// Proper time of the pinhole then.
    #[serde(rename = "pinhole_proper_time")]
    pub pinhole_time: f64,
    /// The inertial frame that moves along with the camera at `time`, its origin at `event`; as data its β
    /// and rapidity.
    #[serde(flatten, serialize_with = "data::frame")]
    pub frame: InertialFrame<spacetime::CameraFrame>,
}

/// What a ray hits.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct ProbeHit {
    /// The object's name.
    #[serde(rename = "object")]
    pub name: String,
    /// Index of the object in the scene.
    #[serde(rename = "object_index")]
    pub object: usize,
    /// Index of the triangle in the object.
    pub triangle: u32,
    /// Its velocity in the world; as data β and rapidity.
    #[serde(flatten, serialize_with = "data::velocity")]
    pub velocity: Velocity,
    /// The emission event.
    #[serde(serialize_with = "data::event")]
    pub emission: Event<World>,
    /// The object's own time of it.
    #[serde(rename = "emission_proper_time")]
    pub time: f64,
    /// The point in the object's coordinates.
    #[serde(rename = "object_position", serialize_with = "data::vector")]
    pub place: DVec3,
    /// World distance from the pinhole's event.
    pub distance: f64,
    /// Observed / emitted wavelength.
    #[serde(rename = "wavelength_ratio")]
    pub ratio: f64,
    /// The world line of the point, by the object's clock.
    #[serde(skip)]
    pub track: Track,
    /// The event of the point that is simultaneous with the reception in the camera's frame.
    #[serde(rename = "now_for_camera", serialize_with = "data::maybe_event")]
    pub now: Option<Event<World>>,
    /// The same in the world.
    #[serde(serialize_with = "data::maybe_event")]
    pub now_in_world: Option<Event<World>>,
    /// The pulses whose light is visible there, the brightest first.
    #[serde(rename = "lit_by")]
    pub pulses: Vec<PulseLight>,
}

/// A pulse that lights the visible point.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct PulseLight {
    /// The source's name.
    #[serde(rename = "source")]
    pub name: String,
    /// The event at which the light that is seen left it.
    #[serde(serialize_with = "data::event")]
    pub left: Event<World>,
    /// The time since the pulse's centre, in its standard deviations.
    pub deviations: f64,
    /// Its part of the radiance from all pulses.
    pub share: f64,
}
