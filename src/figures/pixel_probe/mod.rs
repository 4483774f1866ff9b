//! What one pixel sees, and its space-time diagram.
//!
//! The pixel's ray is traced by the pipeline that renders: the same tile, at the centre of the pixel, so that its
//! numbers are those of the picture's channels. Along the ray and into the past there are
//!
//! ```text
//! E  reception: the sensor element, or the pinhole of a point camera
//! P  = E + |x_P − x_E| (−1, d)      the light passes the pinhole
//! S  = P + s (−η, d)                it left a surface at S, of which the object's clock shows τ_S
//! ```
//!
//! The point of the surface moves on. *Now* it is elsewhere: where its world line is simultaneous with E, in the
//! camera's frame or in the world.
//!
//! ```text
//! scene, pixel ── trace ──▶ Probe ── diagram ──▶ model::diagram::Diagram → layout → drawing
//! ```
//!
//! Of the diagram, x is along the ray. In vacuum the ray lies in the plane of x and ct and has the slope of 45
//! degrees; what is beside that plane is projected onto it, and its light is steeper. In a medium, and with
//! retardation turned off, the ray has the slope that it is rendered with.

mod diagram;
mod summary;
mod trace;

pub use diagram::diagram;
pub use summary::{Lit, Summary, Surface};
pub use trace::trace;

use glam::DVec3;

use crate::figures::diagram::model::Track;
use crate::spacetime::{self, Direction, Event, InertialFrame, Velocity, World};

/// What one pixel sees. Lengths and times are in metres.
#[derive(Debug, Clone)]
pub struct Probe {
    /// Column and row.
    pub pixel: [u32; 2],
    /// The light's arrival in the camera.
    pub reception: Reception,
    /// The look direction in the world.
    pub direction: Direction<World>,
    /// Metres of ct per metre of the ray: the medium's refractive index; 0 where light takes no time.
    pub index: f64,
    /// The world line of the pinhole.
    pub camera: Track,
    /// That of the sensor element, where there is a sensor that does not turn.
    pub element: Option<Track>,
    /// What the ray meets.
    pub hit: Option<Hit>,
    /// How far the ray is followed that meets nothing.
    pub reach: f64,
}

/// The light's arrival.
#[derive(Debug, Clone, Copy)]
pub struct Reception {
    /// At the sensor element; at the pinhole of a point camera.
    pub event: Event<World>,
    /// Proper time of the camera then: that of its pinhole.
    pub time: f64,
    /// The pinhole's event when the light passes it.
    pub pinhole: Event<World>,
    /// Proper time of the pinhole then.
    pub pinhole_time: f64,
    /// The inertial frame that moves along with the camera at `time`, its origin at `event`.
    pub frame: InertialFrame<spacetime::Camera>,
}

/// What a ray meets.
#[derive(Debug, Clone)]
pub struct Hit {
    /// Index of the object in the scene.
    pub object: usize,
    /// Its name.
    pub name: String,
    /// Its velocity in the world.
    pub velocity: Velocity,
    /// Index of the triangle in the object.
    pub triangle: u32,
    /// The emission event.
    pub emission: Event<World>,
    /// The object's own time of it.
    pub time: f64,
    /// The point in the object's coordinates.
    pub place: DVec3,
    /// World distance from the pinhole's event.
    pub distance: f64,
    /// Observed / emitted wavelength.
    pub ratio: f64,
    /// The world line of the point, by the object's clock.
    pub track: Track,
    /// The event of the point that is simultaneous with the reception in the camera's frame.
    pub now: Option<Event<World>>,
    /// The same in the world.
    pub now_in_world: Option<Event<World>>,
    /// The pulses whose light is seen there, the brightest first.
    pub pulses: Vec<PulseLight>,
}

/// A pulse that lights what is seen.
#[derive(Debug, Clone)]
pub struct PulseLight {
    /// The source's name.
    pub name: String,
    /// The event at which the light that is seen left it.
    pub left: Event<World>,
    /// How long after the pulse's centre that was, in its standard deviations.
    pub deviations: f64,
    /// Its part of the radiance from all pulses.
    pub share: f64,
}
