//! `[camera]` and every `velocity`.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::motion::Motion;
use super::sensor::{Sensor, SensorRotation, Shutter, Stereo};
use crate::scene::at::At;
use crate::scene::model::ProjectionKind;
use crate::scene::values::{Number, NumberOrVector, Numbers, Vector};
use crate::spacetime::units::{Angle, Time};

/// The camera: a pinhole on a world line, and a sensor. With only a pose, a velocity and a time it is a point camera without
/// acceleration: all rays of a picture leave one event.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { eye = [0, 1, 5], look_at = [0, 0, 0] }"
)]
pub(in crate::scene) struct Camera {
    /// World position of the pinhole when the camera's clock shows 0, metres, like [0, 1, 5].
    pub eye: Option<At<Vector>>,
    /// look_at − eye is the forward axis in the *camera* frame, whose axes are always the world's axes boosted without rotation. For a
    /// moving camera it is a direction, not a point that is seen in the middle, because aberration shifts where that point is seen.
    pub look_at: Option<At<Vector>>,
    /// The forward axis itself, of any length, in place of `look_at`: far from the origin, look_at − eye loses digits by cancellation.
    pub forward: Option<At<Vector>>,
    /// The up direction of the picture, in the camera frame; only its component perpendicular to the forward axis counts. Default: [0, 1,
    /// 0].
    pub up: Option<At<Vector>>,
    /// Takes the pose (and the field of view, unless `hfov` is given) from a camera of this glTF file,
    /// in place of `eye`, `look_at` (or `forward`) and `up`. The path is relative to the scene file.
    pub gltf: Option<At<String>>,
    /// The node of the glTF file that holds the camera. Default: the file's only camera.
    pub node: Option<At<String>>,
    /// How film points map to look directions: "perspective" (through a pinhole onto a plane), "fisheye_equidistant" (distances from the
    /// middle are angles), "fisheye_equisolid" (areas are solid angles), "fisheye_orthographic" (half the sky as a globe seen from far
    /// outside) or "equirectangular" (a panorama: longitude across, latitude down; the whole sky if the picture is twice as wide as
    /// high). Film points outside a fisheye's image circle or beyond a panorama's poles see nothing. Default: "perspective".
    pub projection: At<ProjectionKind>,
    /// Horizontal field of view in the camera frame, above 0: below 180 deg for a perspective camera, up to 180 deg for
    /// "fisheye_orthographic" and 360 deg for the others. With a sensor, that at its given focal length; for a stereo pair, that of each
    /// eye. Default: for a perspective camera the glTF camera's, or else "60 deg"; "180 deg" for fisheyes, "360 deg" for a panorama.
    pub hfov: Option<At<Angle>>,
    /// Width and height in pixels, each 1 to 65536, together at most 2^28. Default: [640, 480].
    pub size: At<[u32; 2]>,
    /// Velocity in the world when the camera's clock shows 0. Default: at rest.
    pub velocity: Option<At<Velocity>>,
    /// World time (ct) at which the camera's clock shows 0 and the pinhole is at `eye`. Default: "0 m".
    pub clock_zero: At<Time>,
    /// The camera's proper time at the shot, or when the shutter opens, like "3.2 m" or "2 ns". Default: "0 m".
    pub time: At<Time>,
    /// Camera time between the frames of a sequence, above 0.
    pub frame_interval: Option<At<Time>>,
    /// The motion of the pinhole from there. Default: without acceleration.
    pub motion: Option<At<Motion>>,
    /// A sensor behind the pinhole. Default: none; all rays of a picture leave one event.
    pub sensor: Option<At<Sensor>>,
    /// The rotation of the sensor. Default: none.
    pub rotation: Option<At<SensorRotation>>,
    /// Two pinholes in place of one, and their two pictures side by side. Default: one.
    pub stereo: Option<At<Stereo>>,
    /// How long the shutter is open. Default: an instant.
    pub shutter: Option<At<Shutter>>,
}

impl Default for Camera {
    fn default() -> Self {
        Camera {
            eye: None,
            look_at: None,
            forward: None,
            up: None,
            gltf: None,
            node: None,
            projection: At::nowhere(ProjectionKind::Perspective),
            hfov: None,
            size: At::nowhere([640, 480]),
            velocity: None,
            clock_zero: At::nowhere(Time::customary(0.0)),
            time: At::nowhere(Time::customary(0.0)),
            frame_interval: None,
            motion: None,
            sensor: None,
            rotation: None,
            stereo: None,
            shutter: None,
        }
    }
}

impl Camera {
    /// The default of `up`.
    pub const UP: Vector = Numbers([0.0, 1.0, 0.0]);

    /// The default of `hfov` without a glTF camera.
    pub const fn hfov(projection: ProjectionKind) -> Angle {
        Angle::customary(match projection {
            ProjectionKind::Perspective => 60.0,
            ProjectionKind::FisheyeEquidistant
            | ProjectionKind::FisheyeEquisolid
            | ProjectionKind::FisheyeOrthographic => 180.0,
            ProjectionKind::Equirectangular => 360.0,
        })
    }
}

/// A velocity in the world, given in exactly one way: `beta`, `gamma`, `rapidity` or `one_minus_beta`; a single number needs a
/// `direction`.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { beta = [0.9, 0, 0] } or { gamma = 7, direction = [1, 0, 0] }"
)]
pub(crate) struct Velocity {
    /// v/c: a vector of length below 1, or a number in (−1, 1) along `direction`.
    pub beta: Option<At<NumberOrVector>>,
    /// 1/√(1 − β²), at least 1, along `direction`.
    pub gamma: Option<At<Number>>,
    /// artanh β: a vector along the motion, or a number along `direction`; at most 40.
    pub rapidity: Option<At<NumberOrVector>>,
    /// 1 − β in (0, 1], along `direction`: for speeds at which β rounds to 1.
    pub one_minus_beta: Option<At<Number>>,
    /// The direction of motion, of any length but 0.
    pub direction: Option<At<Vector>>,
}
