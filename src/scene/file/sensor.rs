//! `[camera.sensor]`, `[camera.rotation]` and `[camera.shutter]`.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::at::At;
use crate::scene::model::{Assembly, Elements, Integration, Pivot, Records};
use crate::scene::values::Vector;
use crate::spacetime::units::{AngularRate, Length, Time};

/// A sensor behind the pinhole, in place of a point camera, whose rays all leave one event.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { focal_length = \"36 mm\", width = \"24 mm\" }"
)]
pub(in crate::scene) struct Sensor {
    /// Distance from the sensor to the pinhole along the forward axis, above 0. `eye` is the pinhole.
    pub focal_length: At<Length>,
    /// Width of the sensor, above 0; its height follows from `size`. Excludes `hfov`. Default: the width that gives the horizontal field
    /// of view at this focal length.
    pub width: Option<At<Length>>,
    /// What fixes the distance of sensor and pinhole: "rigid" (the focal length is measured in the camera's frame; the camera accelerates
    /// as a rigid body), "world_length" (the focal length is measured in the world: along the motion the camera's own is γ times longer)
    /// or "bell" (both accelerate alike, so that where each element is, relative to the pinhole, is constant in the world: the camera's own
    /// sensor is γ times longer along the motion, in its width and height, too). Default: "rigid".
    #[serde(default)]
    pub assembly: At<Assembly>,
}

/// A sensor that rotates at a constant rate about an axis fixed in the frame of a camera without acceleration.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { axis = [0, 1, 0], rate = \"0.5 rad/m\" }"
)]
pub(in crate::scene) struct SensorRotation {
    /// The axis in the camera's frame, whose axes are the world's axes boosted without rotation; of any length but 0.
    pub axis: At<Vector>,
    /// Angle per camera time, like "0.5 rad/m" or "10 deg/ns", right-handed about the axis; at camera time 0 the angle is 0. Every part
    /// of the sensor must be slower than light.
    pub rate: At<AngularRate>,
    /// What the axis passes through: "pinhole", or "sensor" (its centre). Default: "pinhole".
    #[serde(default)]
    pub through: At<Pivot>,
    /// What the sensor's elements see: "exact" (light that reaches them through the pinhole, which does not rotate), "comoving" (each is
    /// an inertial camera with its own comoving pinhole) or "aberrated" (the same, with the pinhole in its aberrated direction, so that
    /// the sensor can hide it). The latter two need [camera.sensor]. Default: "exact".
    #[serde(default)]
    pub elements: At<Elements>,
}

/// Two pinholes in place of one: a point camera on either side of `eye`, both at the same camera time. The picture is twice as wide as
/// that of each eye; the left eye's is on the left.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { interpupillary_distance = \"64 mm\" }"
)]
pub(in crate::scene) struct Stereo {
    /// The distance of the two pinholes in the camera's own frame, along its right axis, at least 0.
    pub interpupillary_distance: At<Length>,
}

/// A shutter that is open for some time. Without this table the picture shows an instant.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { duration = \"0.5 m\" }"
)]
pub(in crate::scene) struct Shutter {
    /// Camera time during which it is open, above 0; it opens at `camera.time`.
    pub duration: At<Time>,
    /// What the picture holds: "mean" (over the exposure) or "energy" (the integral over the exposure:
    /// mean × duration in metres). Default: "mean".
    #[serde(default)]
    pub records: At<Records>,
    /// What samples take from cubes: "moments" (the value at a moment of the exposure) or "means" (the mean over the sample's part of the
    /// exposure, at the point that it hits: without noise, and exact for any number of samples if camera and object rest relative to each
    /// other). Default: "moments".
    #[serde(default)]
    pub integration: Integration,
}
