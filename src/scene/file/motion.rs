//! `[camera.motion]`, and that of a light.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::at::At;
use crate::scene::values::Vector;
use crate::spacetime::units::{Acceleration, AngularRate, Time};
use crate::spacetime::worldline::Axes;

/// How a pinhole, or a light, moves from `eye` (`position`), `velocity` and `clock_zero` on, given in exactly one way. For a light read
/// "light" for "camera" and "pinhole". Without this table: no acceleration.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { acceleration = { proper = \"0.1 /m\", direction = [0, 0, -1] } }"
)]
pub(in crate::scene) struct Motion {
    /// Constant proper acceleration at all times: hyperbolic motion.
    pub acceleration: Option<At<ProperAcceleration>>,
    /// Consecutive segments of constant proper acceleration, from the camera's time 0 on; before and after them the camera coasts. At
    /// most 100000.
    pub segments: Option<At<Vec<At<MotionSegment>>>>,
    /// Proper acceleration at ascending proper times, linear between them. The world line extends only from the first time to the last; 0
    /// must be one of the times or between them. 2 to 100000 entries.
    pub profile: Option<At<Vec<At<ProfileKnot>>>>,
    /// The axes for the directions of accelerations. "gyroscope": carried along without rotation from the camera's time 0 on, when they
    /// are the world's boosted axes, so that splitting a segment changes nothing. "world": the world's axes, boosted at each moment; if
    /// an acceleration is oblique to the velocity, only `profile` can use these. Default: "gyroscope".
    pub axes: Option<At<Axes>>,
    /// World events that the pinhole passes through smoothly, in place of `eye`, `velocity` and `clock_zero`: times ascend, and
    /// everything in between is slower than light. The world line extends only from the first event, where the camera's clock shows 0, to
    /// the last. The forward axis is look_at − the first position. 2 to 100000 entries.
    pub keyframes: Option<At<Vec<At<Keyframe>>>>,
    /// The path of a node of a glTF file by one of its animations, in place of `eye`, `velocity` and `clock_zero`: seconds of the
    /// animation are world seconds, converted by `speed_of_light`. The world line follows the path of the node as glTF defines it, with short
    /// turns where its velocity jumps, and rests at the first position before it and at the last after it. The clock shows 0 at the first. A camera whose pose is given by `gltf` also turns with the
    /// node, from picture to picture.
    pub animation: Option<At<Animation>>,
    /// A circle through `eye` at constant speed, in place of `velocity`, which follows from it.
    pub circle: Option<At<Circle>>,
}

/// A proper acceleration: the reading of an accelerometer on board.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { proper = \"0.1 /m\", direction = [0, 0, -1] }"
)]
pub(in crate::scene) struct ProperAcceleration {
    /// Its magnitude, like "0.1 /m" (a/c²), "9.81 m/s2" or "0.03 c/ns"; a negative one is opposite to `direction`. 0 is no acceleration.
    pub proper: At<Acceleration>,
    /// Its direction in the `axes` of the motion; of any length but 0. Needed unless `proper` is 0.
    pub direction: Option<At<Vector>>,
}

/// A segment of constant proper acceleration.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { duration = \"2 m\", acceleration = { proper = \"0.5 /m\", direction = [0, 0, -1] } }"
)]
pub(in crate::scene) struct MotionSegment {
    /// The proper time that it lasts, above 0. Only the last segment may omit it: it then lasts for ever.
    pub duration: Option<At<Time>>,
    /// The proper acceleration. Default: none; the camera coasts.
    pub acceleration: Option<At<ProperAcceleration>>,
}

/// A proper acceleration at a proper time.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { time = \"2 m\", acceleration = { proper = \"0.5 /m\", direction = [0, 0, -1] } }"
)]
pub(in crate::scene) struct ProfileKnot {
    /// The camera's time, above that of the previous entry.
    pub time: At<Time>,
    /// The proper acceleration then. Default: none.
    pub acceleration: Option<At<ProperAcceleration>>,
}

/// A world event of the pinhole.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { time = \"3 m\", position = [1, 1, 4] }"
)]
pub(in crate::scene) struct Keyframe {
    /// World time (ct), above that of the previous entry.
    pub time: At<Time>,
    /// World position, metres.
    pub position: At<Vector>,
}

/// An animation of a node.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { gltf = \"model.glb\", node = \"Camera\" }"
)]
pub(in crate::scene) struct Animation {
    /// The glTF file, relative to the scene file. Its data are embedded, or in its folder.
    pub gltf: At<String>,
    /// The node to follow; nodes above it may be animated too.
    pub node: At<String>,
    /// The animation, by name. Default: the file's only one.
    pub name: Option<At<String>>,
}

/// A circle at constant speed.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { centre = [0, 0, 0], axis = [0, 1, 0], period = \"60 m\" }"
)]
pub(in crate::scene) struct Circle {
    /// A point of the axis, world metres; `eye` is not on the axis.
    pub centre: At<Vector>,
    /// The axis in the world, of any length but 0; the camera circles it right-handed.
    pub axis: At<Vector>,
    /// World time of a revolution, above 0. Excludes `rate`.
    pub period: Option<At<Time>>,
    /// Angle per world time, like "1 rad/m"; negative for the opposite sense, 0 for rest. Excludes `period`.
    pub rate: Option<At<AngularRate>>,
}
