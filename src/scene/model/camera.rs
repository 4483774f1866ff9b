//! The camera: a pinhole on a world line, a sensor, a shutter.

use std::sync::Arc;

use glam::DVec3;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::io::gltf::GltfTrack;
use crate::spacetime::worldline::{Axes, Segment};
use crate::spacetime::{Event, Velocity, World};

/// The camera: a pinhole on a world line, and a sensor behind it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CameraModel {
    /// The position of the pinhole in the world when the camera's clock shows 0, and the world time at that moment.
    pub origin: Event<World>,
    /// Orthonormal axes in the camera frame (whose axes are the world's, boosted without rotation): right, up, forward.
    pub axes: [DVec3; 3],
    /// How these axes follow the time of the shot, if the camera is one of an animated glTF file.
    pub turning: Option<Turning>,
    /// The projection.
    pub projection: ProjectionKind,
    /// Horizontal field of view in the camera frame, radians, up to the projection's limit; with a sensor, the one at
    /// [`Sensor::focal_length`], which gives the sensor's width. For a stereo pair, that of each eye.
    pub horizontal_fov: f64,
    /// Image size in pixels, width and height.
    pub size: [u32; 2],
    /// Velocity in the world, when the camera's clock shows 0.
    pub velocity: Velocity,
    /// Its motion from there.
    pub motion: Motion,
    /// The sensor; `None` for a point camera, whose rays all leave one event.
    pub sensor: Option<Sensor>,
    /// The rotation of the sensor.
    pub rotation: Option<Rotation>,
    /// Two pinholes in place of one; their pictures are side by side.
    pub stereo: Option<Stereo>,
    /// The camera's proper time at the shot, or when the shutter opens, metres.
    pub time: f64,
    /// How long the shutter is open; `None` for an instant.
    pub shutter: Option<Shutter>,
    /// Camera time between the frames of a sequence, metres.
    pub frame_interval: Option<f64>,
}

/// How a camera of a glTF file turns with its animated node, from shot to shot.
#[derive(Debug, Clone, PartialEq)]
pub struct Turning {
    /// The axes without the animation.
    pub axes: [DVec3; 3],
    /// The animation.
    pub track: Arc<GltfTrack>,
    /// Metres of world time per second of the animation.
    pub speed_of_light: f64,
}

/// How a camera maps look directions to its picture.
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
    /// Its name in the scene file.
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

/// The world line of the pinhole, given its state at proper time 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// Without acceleration.
    Inertial,
    /// Constant proper acceleration, 1/m, in the camera's axes when its clock shows 0; at all times.
    Accelerated(DVec3),
    /// Consecutive segments from proper time 0 on; without acceleration before and after.
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
    /// The path of an animation through world events, at rest before the first and after the last; the clock shows 0 at the first.
    Animation {
        /// The events, ascending in time.
        events: Vec<Event<World>>,
        /// The velocities before and after each; between two events the path is the cubic with these, with short turns where they jump.
        velocities: Vec<[DVec3; 2]>,
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

/// A sensor behind the pinhole, perpendicular to the forward axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// The distance from the sensor to the pinhole, metres, above 0, in the frame that `assembly` names. The sensor's width is 2 d
    /// tan(fov/2) at this length d, whatever its length in the camera's own frame.
    pub focal_length: f64,
    /// What fixes the distance of the two.
    pub assembly: Assembly,
}

/// What fixes the distance of sensor and pinhole.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Assembly {
    /// A rigid body: the focal length is measured in the camera's own frame. Under acceleration it is Born-rigid.
    #[default]
    Rigid,
    /// The focal length is measured in the world: along the motion the camera's own is γ times longer.
    WorldLength,
    /// Sensor and pinhole accelerate alike, like Bell's two spaceships: where each element is, relative to the pinhole, is constant in the
    /// world. In the camera's own frame the whole sensor is stretched by γ along the motion; that of "world_length" keeps its
    /// width, and only its distance differs.
    Bell,
}

/// A sensor that rotates about an axis fixed in the camera's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// Unit vector along the axis, in the camera frame.
    pub axis: DVec3,
    /// Radians per metre of camera time, right-handed about the axis; at camera time 0 the angle is 0.
    pub rate: f64,
    /// What the axis passes through.
    pub through: Pivot,
    /// What the sensor's elements see.
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

/// What the elements of a rotating sensor see.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Elements {
    /// Light that reaches them through the pinhole, which does not rotate.
    #[default]
    Exact,
    /// Each is an inertial camera with its own comoving pinhole.
    Comoving,
    /// The same, with pinhole and sensor in their aberrated directions, so that the sensor can hide the pinhole.
    Aberrated,
}

impl CameraModel {
    /// How long the shutter is open, if samples take means over parts of the exposure.
    pub(crate) fn integrated_exposure(&self) -> Option<f64> {
        // Moments need no duration: each sample has its own time.
        let shutter = self.shutter?;
        (shutter.integration == Integration::Means).then_some(shutter.duration)
    }
}

#[cfg(test)]
impl CameraModel {
    /// A point camera at rest at `eye`, with a field of view of 60° about `forward`.
    pub(crate) fn looking(forward: DVec3, eye: DVec3, size: [u32; 2]) -> Self {
        let forward = forward.normalize();
        let right = forward.cross(DVec3::Y).normalize();
        CameraModel {
            origin: Event::new(0.0, eye),
            axes: [right, right.cross(forward), forward],
            turning: None,
            projection: ProjectionKind::default(),
            horizontal_fov: std::f64::consts::FRAC_PI_3,
            size,
            velocity: Velocity::REST,
            motion: Motion::Inertial,
            sensor: None,
            rotation: None,
            stereo: None,
            time: 0.0,
            shutter: None,
            frame_interval: None,
        }
    }
}

/// A shutter that is open for some time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    /// Camera time during which it is open, metres, above 0.
    pub duration: f64,
    /// What the picture holds.
    pub records: Records,
    /// What samples take from time-resolved data.
    pub integration: Integration,
}

/// What the samples of an exposure take from time-resolved data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Integration {
    /// The value at the moment of the sample.
    #[default]
    Moments,
    /// The mean over the sample's part of the exposure, at the point that it hits.
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
