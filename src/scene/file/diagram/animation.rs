//! `[diagram.animation]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Colour;
use crate::scene::at::At;
use crate::scene::values::Number;

/// A series of pictures: the view is boosted to a frame step by step, or a line of simultaneity sweeps
/// over the diagram, or both.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { boost_to = \"S'\", frames = 49 }"
)]
pub(in crate::scene) struct Animation {
    /// How many pictures, 2 to 10000. Default: 49.
    pub frames: Option<At<u32>>,
    /// Pictures per second of an animated file, above 0. Default: 24.
    pub fps: Option<At<Number>>,
    /// The frame in whose coordinates the last picture is; from that of the view there in equal steps of
    /// rapidity.
    pub boost_to: Option<At<String>>,
    /// Whether it goes there and back again, in these pictures. Default: false.
    pub back: Option<bool>,
    /// A line of simultaneity that sweeps from one time to another, with the readings of the clocks on it.
    pub now: Option<At<Now>>,
}

/// A line of simultaneity that sweeps.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { frame = \"S'\", from = 0, to = 5 }"
)]
pub(in crate::scene) struct Now {
    /// The frame in which all on the line is simultaneous. Default: "world".
    pub frame: Option<At<String>>,
    /// The time of that frame in the first picture.
    pub from: At<Number>,
    /// The time of that frame in the last picture.
    pub to: At<Number>,
    /// The colour. Default: the frame's.
    pub colour: Option<At<Colour>>,
}
