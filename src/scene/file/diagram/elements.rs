//! What is drawn between the frames, world lines and events of a diagram.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Colour, OneOrMany, Spot};
use crate::scene::at::At;
use crate::scene::values::Number;

/// The light cone of an event.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table like { of = \"A\" }")]
pub(in crate::scene) struct LightCone {
    /// The event.
    pub of: At<Spot>,
    /// Whether its future is drawn. Default: true, unless `past` is said.
    pub future: Option<bool>,
    /// Whether its past is drawn. Default: true, unless `future` is said.
    pub past: Option<bool>,
    /// How far from its apex it is drawn in 2+1 dimensions, above 0. Default: as far as the contents go.
    pub height: Option<At<Number>>,
    /// Whether what is within the cone is shaded. Default: false; in 2+1 dimensions it is always.
    pub shade: Option<bool>,
}

/// Light from an event or a world line to a world line, and on to others.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { from = \"A\", to = \"ship\" }"
)]
pub(in crate::scene) struct Signal {
    /// The event of its emission, or the world line that emits it.
    pub from: At<Spot>,
    /// The time of the world line's own clock when it does.
    pub proper_time: Option<At<Number>>,
    /// Emits one after the other in these distances of the world line's own time, above 0, from its
    /// beginning (or its time 0) to its end (or `count` of them). Excludes `proper_time`.
    pub every: Option<At<Number>>,
    /// How many; needed where the world line has no end. At most 1000.
    pub count: Option<At<u32>>,
    /// The world line that receives it; of several the first sends it on to the next.
    pub to: At<OneOrMany>,
    /// What stands beside it. Default: nothing.
    pub label: Option<At<String>>,
    /// The colour. Default: that of light.
    pub colour: Option<At<Colour>>,
}

/// A line of equal time, or of equal place, of a frame.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { frame = \"S'\", event = \"A\" }"
)]
pub(in crate::scene) struct Slice {
    /// The frame. Default: "world".
    pub frame: Option<At<String>>,
    /// An event on the line.
    pub event: At<Spot>,
    /// The world line at which it ends; it goes there from the event, and for a line of equal place to the
    /// first crossing after the world line's time 0, or else the last before. Default: it has no ends.
    pub to: Option<At<String>>,
    /// What stands beside it. Default: nothing.
    pub label: Option<At<String>>,
    /// The colour. Default: the frame's.
    pub colour: Option<At<Colour>>,
}

/// The interval between two events.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { from = \"A\", to = \"B\" }"
)]
pub(in crate::scene) struct Interval {
    /// One event.
    pub from: At<Spot>,
    /// The other.
    pub to: At<Spot>,
    /// What stands beside it; "" is nothing. Default: its value.
    pub label: Option<At<String>>,
    /// The colour. Default: grey.
    pub colour: Option<At<Colour>>,
}

/// The events of one interval from an event: said by one of them, or by its value.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table like { proper_time = 1 }")]
pub(in crate::scene) struct Hyperbola {
    /// The event that the interval is from. Default: [0, 0].
    pub about: Option<At<Spot>>,
    /// An event on it.
    pub through: Option<At<Spot>>,
    /// The proper time from `about` to it, above 0 into the future and below 0 into the past.
    pub proper_time: Option<At<Number>>,
    /// The proper distance from `about` to it, above 0 to the right and below 0 to the left.
    pub proper_length: Option<At<Number>>,
    /// What stands beside it. Default: nothing.
    pub label: Option<At<String>>,
    /// The colour. Default: grey.
    pub colour: Option<At<Colour>>,
}

/// What lies between two world lines: that of a rod, from end to end.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { between = [\"rear\", \"front\"] }"
)]
pub(in crate::scene) struct Sheet {
    /// The two world lines.
    pub between: At<[At<String>; 2]>,
    /// What stands on it. Default: nothing.
    pub label: Option<At<String>>,
    /// The colour. Default: that of the first world line.
    pub colour: Option<At<Colour>>,
}

/// A shaded region with straight edges.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { corners = [\"A\", \"B\", [0, 1]] }"
)]
pub(in crate::scene) struct Region {
    /// Its corners, in order: 3 or more events.
    pub corners: At<Vec<At<Spot>>>,
    /// What stands on it. Default: nothing.
    pub label: Option<At<String>>,
    /// The colour. Default: grey.
    pub colour: Option<At<Colour>>,
}

/// An arrow: the four-velocity of a world line, or from event to event.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { of = \"ship\", proper_time = 1 }"
)]
pub(in crate::scene) struct Arrow {
    /// The world line whose four-velocity it is.
    pub of: Option<At<String>>,
    /// The time of the world line's own clock. Default: 0.
    pub proper_time: Option<At<Number>>,
    /// How long a four-velocity is drawn, above 0. Default: 1.
    pub length: Option<At<Number>>,
    /// The event from which it goes. Excludes `of`.
    pub from: Option<At<Spot>>,
    /// The event to which it goes. Excludes `of`.
    pub to: Option<At<Spot>>,
    /// What stands beside it. Default: nothing.
    pub label: Option<At<String>>,
    /// The colour. Default: that of the world line.
    pub colour: Option<At<Colour>>,
}

/// A quarter of the diagram between the light rays through an event, and these rays: the horizons of those
/// who accelerate away from the event for ever.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { of = [0, 0], side = \"right\" }"
)]
pub(in crate::scene) struct Wedge {
    /// The event.
    pub of: At<Spot>,
    /// Which: "right", "left", "future" or "past". Default: "right".
    pub side: Option<At<Side>>,
    /// What stands on it. Default: nothing.
    pub label: Option<At<String>>,
    /// The colour. Default: grey.
    pub colour: Option<At<Colour>>,
}

/// A quarter of the diagram.
#[derive(Debug, Clone, Copy, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub(in crate::scene) enum Side {
    Right,
    Left,
    Future,
    Past,
}

/// Words at an event.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { at = [1, 2], text = \"here\" }"
)]
pub(in crate::scene) struct Text {
    /// The words.
    pub text: At<String>,
    /// Where their middle is.
    pub at: At<Spot>,
    /// The colour. Default: black.
    pub colour: Option<At<Colour>>,
}
