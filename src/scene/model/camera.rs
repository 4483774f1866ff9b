//! The camera: a pinhole on a world line, a sensor, a shutter.

use glam::DVec3;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spacetime::worldline::{Axes, Segment};
use crate::spacetime::{Event, Velocity, World};

/// The camera: a pinhole on a world line, and a sensor behind it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CameraModel {
    /// Where the pinhole is in the world when the camera's clock shows 0, and the world time then.
    pub origin: Event<World>,
    /// Orthonormal axes in the camera frame (whose axes are the world's, boosted without rotation):
    /// right, up, forward.
    pub axes: [DVec3; 3],
    /// How film points look.
    pub projection: ProjectionKind,
    /// Horizontal field of view in the camera frame, radians, up to that of the projection; with a sensor, that
    /// at [`Sensor::focal_length`], which gives the sensor's width. Of a stereo pair, that of either eye.
    pub horizontal_fov: f64,
    /// Image size in pixels, width and height.
    pub size: [u32; 2],
    /// Velocity in the world, when the camera's clock shows 0.
    pub velocity: Velocity,
    /// How it moves on from there.
    pub motion: Motion,
    /// The sensor; none for a point camera, whose rays all leave one event.
    pub sensor: Option<Sensor>,
    /// How the sensor turns.
    pub rotation: Option<Rotation>,
    /// Two pinholes in place of one; their pictures are side by side.
    pub stereo: Option<Stereo>,
    /// The camera's proper time of the shot, or at which the shutter opens, metres.
    pub time: f64,
    /// How long the shutter is open; none for an instant.
    pub shutter: Option<Shutter>,
    /// Camera time between the frames of a sequence, metres.
    pub frame_interval: Option<f64>,
}

/// How film points look: the projections of [`crate::camera`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ProjectionKind {
    /// Through a pinhole onto a plane: straight lines are straight.
    #[default]
    Perspective,
    /// A fisheye: distances from the middle are angles.
    FisheyeEquidistant,
    /// A fisheye: areas are solid angles.
    FisheyeEquisolid,
    /// A fisheye: half the sky as a globe seen from far outside.
    FisheyeOrthographic,
    /// A panorama: longitude across, latitude down.
    Equirectangular,
}

impl ProjectionKind {
    /// As the scene file says it.
    pub fn name(self) -> &'static str {
        match self {
            ProjectionKind::Perspective => "perspective",
            ProjectionKind::FisheyeEquidistant => "fisheye_equidistant",
            ProjectionKind::FisheyeEquisolid => "fisheye_equisolid",
            ProjectionKind::FisheyeOrthographic => "fisheye_orthographic",
            ProjectionKind::Equirectangular => "equirectangular",
        }
    }

    /// The widest horizontal field of view, degrees; a perspective camera's is below it.
    pub fn widest(self) -> f64 {
        match self {
            ProjectionKind::Perspective | ProjectionKind::FisheyeOrthographic => 180.0,
            ProjectionKind::FisheyeEquidistant
            | ProjectionKind::FisheyeEquisolid
            | ProjectionKind::Equirectangular => 360.0,
        }
    }
}

/// Two pinholes side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stereo {
    /// Their distance in the camera frame, metres, at least 0.
    pub interpupillary_distance: f64,
}

/// The world line of the pinhole, from the state at its proper time 0 on (and before).
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// Without acceleration.
    Inertial,
    /// Constant proper acceleration, 1/m, in the camera's axes when its clock shows 0; for ever.
    Accelerated(DVec3),
    /// One segment after the other from proper time 0 on; without acceleration before and after.
    Segments(Vec<Segment>),
    /// Proper acceleration at proper times, linear between; from the first time to the last.
    Profile {
        /// Proper times, metres, and accelerations, 1/m.
        knots: Vec<(f64, DVec3)>,
        /// The axes of the accelerations.
        axes: Axes,
    },
    /// A smooth curve through world events, from the first to the last; the clock shows 0 at the first.
    Keyframes(Vec<Event<World>>),
    /// As an animation goes through world events, at rest at the first and the last of them before and after; the clock shows 0 at
    /// the first.
    Animation {
        /// The events, ascending in time.
        events: Vec<Event<World>>,
        /// Whether the way between them is straight, with short turns, or a smooth curve.
        is_straight: bool,
    },
    /// At constant speed around an axis.
    Circular {
        /// A point of the axis, world metres.
        centre: DVec3,
        /// Unit vector along the axis.
        axis: DVec3,
        /// Radians per metre of world time, right-handed about the axis.
        rate: f64,
    },
}

/// A sensor behind the pinhole, across the forward axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// From the sensor to the pinhole, metres, above 0, in the frame that `assembly` names. The sensor's
    /// width is 2 d tan(fov/2) at this length d, whatever its length in the camera's own frame.
    pub focal_length: f64,
    /// What holds the two together.
    pub assembly: Assembly,
}

/// What keeps sensor and pinhole apart.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Assembly {
    /// A rigid body: the focal length is that of the camera's own frame. When it accelerates, Born-rigid.
    #[default]
    Rigid,
    /// The focal length is that measured in the world: along the motion the camera's own is γ times longer.
    WorldLength,
    /// Sensor and pinhole accelerate alike, like the two ships of Bell: their distance in the world stays.
    /// Without acceleration the same as [`Assembly::WorldLength`].
    Bell,
}

/// A sensor that turns about an axis fixed in the camera's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// Unit vector along the axis, in the camera frame.
    pub axis: DVec3,
    /// Radians per metre of camera time, right-handed about the axis; at camera time 0 nothing is turned.
    pub rate: f64,
    /// What the axis passes through.
    pub through: Pivot,
    /// How the sensor's elements see.
    pub elements: Elements,
}

/// What an axis of rotation passes through.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Pivot {
    /// The pinhole.
    #[default]
    Pinhole,
    /// The centre of the sensor.
    Sensor,
}

/// How the elements of a turning sensor see.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Elements {
    /// By the light that comes to them through the pinhole, which does not turn.
    #[default]
    Exact,
    /// Each like an inertial camera with a pinhole of its own that moves along with it.
    Comoving,
    /// The same, with pinhole and sensor seen aberrated, so that the sensor can cover the pinhole.
    Aberrated,
}

impl CameraModel {
    /// How long the shutter is open, where samples take means over parts of that.
    pub(crate) fn integrated_exposure(&self) -> Option<f64> {
        // Moments need no duration: each sample has its own time.
        let shutter = self.shutter?;
        (shutter.integration == Integration::Means).then_some(shutter.duration)
    }
}

/// A shutter that is open for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    /// Camera time for which it is open, metres, above 0.
    pub duration: f64,
    /// What the picture holds.
    pub records: Records,
    /// What samples take of time-resolved data.
    pub integration: Integration,
}

/// What the samples of an exposure take of time-resolved data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Integration {
    /// What there is at the moment of the sample.
    #[default]
    Moments,
    /// The mean over the part of the exposure that the sample stands for, of the point that it meets.
    Means,
}

/// What an exposure records.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Records {
    /// The mean over the exposure.
    #[default]
    Mean,
    /// The integral over the exposure: mean × duration in metres.
    Energy,
}
