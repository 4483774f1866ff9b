//! `[diagram]`: a space-time diagram, by its frames, world lines, events and what is drawn between them.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::model::{Colour, Side};
use super::spot::{OneOrMany, Place, ProperAcceleration, Speed};
use crate::scene::{At, Number, Numbers, Vector};
use crate::spacetime::units::Length;

/// A space-time diagram: ct upwards, one direction of space to the right, light at 45 degrees. Numbers are
/// in the diagram's `unit`, times as ct. An event is given by its name, as [ct, x], or as [ct, x, y] in 2+1 dimensions.
#[derive(Debug, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { title = \"Time dilation\" }"
)]
pub(super) struct Diagram {
    /// A title above the diagram.
    pub title: Option<At<String>>,
    /// The unit of this table's numbers: "m", "mm", "cm", "km", or a time, with lengths as the time that
    /// light takes for them at the scene's `speed_of_light`: "ps", "ns", "us", "ms", "s", "min", "h", "d", "yr". Default: metres,
    /// with no unit on the axes.
    pub unit: Option<At<Unit>>,
    /// The range of x on the axes, [from, to]. Default: to fit the contents.
    pub x: Option<At<Numbers<2>>>,
    /// The range of ct on the axes, [from, to]. Default: to fit the contents.
    pub ct: Option<At<Numbers<2>>>,
    /// The range of y on the axes of a 2+1-dimensional diagram, [from, to]. Default: to fit the contents.
    pub y: Option<At<Numbers<2>>>,
    /// "1+1": ct and x. "2+1": ct, x and y in oblique projection, with light cones as cones and simultaneous
    /// events as planes. Default: "1+1".
    pub dimensions: Option<At<Dimensions>>,
    /// The direction of the world along which x is measured, of any length but 0; a note below the diagram names it if it is
    /// not [1, 0, 0]. Default: that of the camera's motion, or of the first object that moves, or else [1, 0, 0].
    pub direction: Option<At<Vector>>,
    /// The direction along which y is measured in 2+1 dimensions; only its component perpendicular to `direction`
    /// counts. Default: a perpendicular direction in which something moves, or else upright.
    pub across: Option<At<Vector>>,
    /// The frame in whose coordinates everything is drawn, or several for views side by side: "world", "camera",
    /// or the name of a frame. Default: "world".
    pub view: Option<At<OneOrMany>>,
    /// The labels of the view's own axes, of ct and of x. Default: "*ct*" and "*x*", with their unit.
    pub labels: Option<At<[At<String>; 2]>>,
    /// Frames of reference.
    pub frame: Vec<At<DiagramFrame>>,
    /// World lines.
    pub worldline: Vec<At<DiagramLine>>,
    /// Events.
    pub event: Vec<At<DiagramEvent>>,
    /// Light cones of events.
    pub light_cone: Vec<At<LightCone>>,
    /// Light from events or world lines to world lines.
    pub signal: Vec<At<Signal>>,
    /// Lines of events that are simultaneous in a frame.
    pub simultaneity: Vec<At<Slice>>,
    /// Lines of events that happen at one place of a frame.
    pub place: Vec<At<Slice>>,
    /// Intervals between two events, with their value.
    pub interval: Vec<At<Interval>>,
    /// Hyperbolae of constant interval, which calibrate the axes of frames.
    pub hyperbola: Vec<At<Hyperbola>>,
    /// Curves that are not world lines.
    pub curve: Vec<At<DrawnCurve>>,
    /// World sheets: the surfaces between two world lines.
    pub sheet: Vec<At<Sheet>>,
    /// Shaded regions.
    pub region: Vec<At<Region>>,
    /// Arrows: four-velocities, or from event to event.
    pub arrow: Vec<At<Arrow>>,
    /// Rindler wedges, with their horizons.
    pub wedge: Vec<At<Wedge>>,
    /// Words.
    pub text: Vec<At<Text>>,
    /// A series of pictures, for `--frames` and `-o FILE.apng`.
    pub animation: Option<At<Animation>>,
    /// How it looks.
    pub style: DiagramStyle,
}

/// How many dimensions of space-time a diagram shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(inline))]
pub(super) enum Dimensions {
    #[serde(rename = "1+1")]
    Two,
    #[serde(rename = "2+1")]
    Three,
}

/// What a number of a diagram means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", schemars(inline))]
pub(super) enum Unit {
    M,
    Mm,
    Cm,
    Km,
    Ps,
    Ns,
    Us,
    Ms,
    S,
    Min,
    H,
    D,
    Yr,
}

/// A frame of reference, and how it is drawn.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { name = \"S'\", velocity = 0.6 }"
)]
pub(super) struct DiagramFrame {
    /// Unique name; "world" is the scene's own frame.
    pub name: At<String>,
    /// Velocity: β along the diagram's direction, or a table as elsewhere. Excludes `of`.
    pub velocity: Option<At<Speed>>,
    /// The frame to which `velocity` is relative. Default: "world".
    pub relative_to: Option<At<String>>,
    /// The world line whose momentary rest frame this is. Excludes `velocity`.
    pub of: Option<At<String>>,
    /// The time on that world line's own clock at which its rest frame is taken. Default: 0, or the camera's time.
    pub proper_time: Option<At<Number>>,
    /// The event at which the frame's clock and coordinates are 0. Default: [0, 0], or with `of` the event of the
    /// world line at that time.
    pub origin: Option<At<Place>>,
    /// Whether its axes are drawn. Default: true.
    pub axes: Option<bool>,
    /// Whether its lines of equal time and equal place are drawn. Default: false.
    pub grid: Option<bool>,
    /// The distance between the ticks on its axes, above 0. Default: as on the diagram's axes, without numbers if the axes of
    /// several moving frames are drawn.
    pub ticks: Option<At<Number>>,
    /// The colour. Default: the next of the palette.
    pub colour: Option<Colour>,
}

/// A world line, given in one way: inertial, accelerated or circling, through an event; through several events; or that
/// of something in the scene.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { name = \"ship\", at = [0, 0], velocity = 0.6 }"
)]
pub(super) struct DiagramLine {
    /// Unique name.
    pub name: At<String>,
    /// Its label; "" for none. Default: the name.
    pub label: Option<At<String>>,
    // One of these ways: `of`; `at` with `velocity` and at most one kind of acceleration; `through`; `keyframes`. Which of them is
    // checked in `resolve`: an enum would lose the places of keys that exclude each other.
    /// The thing in the scene whose world line it is: "camera" (or "pinhole"), "sensor" (its centre), or the
    /// name of an object, of a point or spot light, or of a pulse.
    pub of: Option<At<String>>,
    /// The event at which its clock shows 0. Default: [0, 0].
    pub at: Option<At<Place>>,
    /// The velocity then: β along the diagram's direction, or a table as elsewhere. Default: at rest.
    pub velocity: Option<At<Speed>>,
    /// The frame to which `velocity` is relative. Default: "world".
    pub relative_to: Option<At<String>>,
    /// Constant proper acceleration along the diagram's direction: per unit of length, or a quantity like "1 g", with
    /// the scene's `speed_of_light`.
    pub acceleration: Option<At<ProperAcceleration>>,
    /// One stretch of constant proper acceleration after the other, from the event `at` on.
    pub segments: Option<At<Vec<At<LineSegment>>>>,
    /// Proper acceleration along the diagram's direction at ascending proper times, [time, acceleration] each,
    /// linear between them. The world line extends only from the first time to the last; 0, at the event `at`, is
    /// one of the times or between them.
    pub profile: Option<At<Vec<At<Numbers<2>>>>>,
    /// A circle at constant speed, seen from the side; at the event `at` it is farthest along the diagram's
    /// direction.
    pub circle: Option<At<LineCircle>>,
    /// Events that it connects by straight lines; its clock shows 0 at the first, and it ends at the last.
    pub through: Option<At<Vec<At<Place>>>>,
    /// Events that it connects by a smooth curve; its clock shows 0 at the first, and it ends at the last.
    pub keyframes: Option<At<Vec<At<Place>>>>,
    /// The event at whose world time it begins. Default: it has no beginning.
    pub from: Option<At<Place>>,
    /// The event at whose world time it ends. Default: it has no end.
    pub to: Option<At<Place>>,
    /// The world line at which it ends: the first that it meets after its own time 0 and after `from`. Excludes `to`.
    pub until: Option<At<String>>,
    /// The distance between the ticks of its own clock, above 0. Default: no ticks.
    pub ticks: Option<At<Number>>,
    /// Whether the ticks have numbers. Default: false.
    pub numbers: Option<bool>,
    /// The colour. Default: the next of the palette.
    pub colour: Option<Colour>,
}

/// A stretch of constant proper acceleration.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { duration = 2, acceleration = 0.5 }"
)]
pub(super) struct LineSegment {
    /// Its duration in proper time, above 0. Only the last stretch may leave it out.
    pub duration: Option<At<Number>>,
    /// Proper acceleration along the diagram's direction: per unit of length, or a quantity like "1 g". Default: none; it
    /// coasts.
    pub acceleration: Option<At<ProperAcceleration>>,
}

/// A circle at constant speed, in a plane that holds the diagram's direction.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { radius = 1, period = 10 }"
)]
pub(super) struct LineCircle {
    /// Its radius, above 0.
    pub radius: At<Number>,
    /// World time of a revolution, longer than light would take to go round.
    pub period: At<Number>,
}

/// An event, given in one way.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { name = \"A\", at = [0, 0] }"
)]
pub(super) struct DiagramEvent {
    /// Unique name.
    pub name: At<String>,
    /// Its label; "" for none. Default: the name.
    pub label: Option<At<String>>,
    /// Where it is: [ct, x] in `frame`, or another event.
    pub at: Option<At<Place>>,
    /// The frame of `at` or of `simultaneous_with`. Default: "world".
    pub frame: Option<At<String>>,
    /// The world line that it is on, at the place given by one of the next four keys.
    pub on: Option<At<String>>,
    /// Where the clock of that world line shows this time.
    pub proper_time: Option<At<Number>>,
    /// Where light from this event reaches that world line.
    pub light_from: Option<At<Place>>,
    /// Where light left that world line to reach this event.
    pub light_to: Option<At<Place>>,
    /// Where that world line is simultaneous with this event in `frame`.
    pub simultaneous_with: Option<At<Place>>,
    /// Two world lines that cross there; of several crossings, the first after proper time 0 of the first
    /// line, or else the last before that.
    pub cross: Option<At<[At<String>; 2]>>,
    /// Whether it is marked by a dot. Default: true.
    pub dot: Option<bool>,
    /// The colour of dot and label. Default: black.
    pub colour: Option<Colour>,
}

/// How a diagram looks.
#[derive(Debug, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { theme = \"dark\" }"
)]
pub(super) struct DiagramStyle {
    /// "light" or "dark". Default: "light".
    pub theme: Option<Theme>,
    /// Width of the page, like "120 mm". Default: "120 mm" for each view side by side.
    pub width: Option<At<Length>>,
    /// How many views stand side by side, 1 to 12; the others are below them. Default: all.
    pub columns: Option<At<u32>>,
    /// Size of the type, points. Default: 10.
    pub font_size: Option<At<Number>>,
    /// Width of world lines, points. Default: 1.4.
    pub line_width: Option<At<Number>>,
    /// Whether the diagram has a legend of its world lines, in place of labels beside them. Default: false.
    pub legend: Option<bool>,
    /// Whether the axes have ticks with numbers. Default: true.
    pub ticks: Option<bool>,
    /// Whether a faint grid of the view's own coordinates is drawn. Default: false.
    pub grid: Option<bool>,
}

/// Colours for a white page, or for a black one.
#[derive(Debug, Clone, Copy, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", schemars(inline))]
pub(super) enum Theme {
    Light,
    Dark,
}

/// The light cone of an event.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { of = \"A\" }")]
pub(super) struct LightCone {
    /// The event.
    pub of: At<Place>,
    /// Whether its future is drawn. Default: true, unless `past` is given.
    pub future: Option<bool>,
    /// Whether its past is drawn. Default: true, unless `future` is given.
    pub past: Option<bool>,
    /// How far from its apex it is drawn in 2+1 dimensions, above 0. Default: as far as the contents go.
    pub height: Option<At<Number>>,
    /// Whether the inside of the cone is shaded. Default: false; in 2+1 dimensions it always is.
    pub shade: Option<bool>,
}

/// Light from an event or a world line to a world line, and on to others.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { from = \"A\", to = \"ship\" }"
)]
pub(super) struct Signal {
    /// The event of its emission, or the world line that emits it.
    pub from: At<Place>,
    /// The time on the world line's own clock when it emits.
    pub proper_time: Option<At<Number>>,
    /// The interval between several signals, in the world line's own time, above 0: from its beginning (or its
    /// time 0) to its end (or `count` of them). Excludes `proper_time`.
    pub every: Option<At<Number>>,
    /// How many signals; needed where the world line has no end. At most 1000.
    pub count: Option<At<u32>>,
    /// The world line that receives it; if there are several, each sends it on to the next.
    pub to: At<OneOrMany>,
    /// Its label. Default: none.
    pub label: Option<At<String>>,
    /// The colour. Default: that of light.
    pub colour: Option<Colour>,
}

/// A line of equal time, or of equal place, of a frame.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { frame = \"S'\", event = \"A\" }"
)]
pub(super) struct Slice {
    /// The frame. Default: "world".
    pub frame: Option<At<String>>,
    /// An event on the line.
    pub event: At<Place>,
    /// The world line at which it ends: it goes from the event to there, and for a line of equal place to the
    /// first crossing after the world line's time 0, or else the last before that. Default: it has no ends.
    pub to: Option<At<String>>,
    /// Its label. Default: none.
    pub label: Option<At<String>>,
    /// The colour. Default: the frame's.
    pub colour: Option<Colour>,
}

/// The interval between two events.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { from = \"A\", to = \"B\" }"
)]
pub(super) struct Interval {
    /// One event.
    pub from: At<Place>,
    /// The other.
    pub to: At<Place>,
    /// Its label; "" for none. Default: its value.
    pub label: Option<At<String>>,
    /// The colour. Default: grey.
    pub colour: Option<Colour>,
}

/// The events at one interval from an event; the interval is given by its value, or by one of the events.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table like { proper_time = 1 }")]
pub(super) struct Hyperbola {
    /// The event from which the interval is measured. Default: [0, 0].
    pub about: Option<At<Place>>,
    /// An event on it.
    pub through: Option<At<Place>>,
    /// The proper time from `about` to it, above 0 into the future and below 0 into the past.
    pub proper_time: Option<At<Number>>,
    /// The proper distance from `about` to it, above 0 to the right and below 0 to the left.
    pub proper_length: Option<At<Number>>,
    /// Its label. Default: none.
    pub label: Option<At<String>>,
    /// The colour. Default: grey.
    pub colour: Option<Colour>,
}

/// A curve that is not a world line: any events, joined by straight lines.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { through = [[0, 0], [1, 2]] }"
)]
pub(super) struct DrawnCurve {
    /// The events, at least two.
    pub through: At<Vec<At<Place>>>,
    /// Whether it is dashed. Default: false.
    pub dashed: Option<bool>,
    /// Its label. Default: none.
    pub label: Option<At<String>>,
    /// The colour. Default: black.
    pub colour: Option<Colour>,
}

/// The surface between two world lines, like the world sheet of a rod between those of its ends.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { between = [\"rear\", \"front\"] }"
)]
pub(super) struct Sheet {
    /// The two world lines.
    pub between: At<[At<String>; 2]>,
    /// Its label. Default: none.
    pub label: Option<At<String>>,
    /// The colour. Default: that of the first world line.
    pub colour: Option<Colour>,
}

/// A shaded region with straight edges.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { corners = [\"A\", \"B\", [0, 1]] }"
)]
pub(super) struct Region {
    /// Its corners, in order: 3 or more events.
    pub corners: At<Vec<At<Place>>>,
    /// Its label. Default: none.
    pub label: Option<At<String>>,
    /// The colour. Default: grey.
    pub colour: Option<Colour>,
}

/// An arrow: the four-velocity of a world line, or from event to event.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { of = \"ship\", proper_time = 1 }"
)]
pub(super) struct Arrow {
    /// The world line whose four-velocity it is.
    pub of: Option<At<String>>,
    /// The time of the world line's own clock. Default: 0.
    pub proper_time: Option<At<Number>>,
    /// How long a four-velocity is drawn, above 0. Default: 1.
    pub length: Option<At<Number>>,
    /// The event from which it goes. Excludes `of`.
    pub from: Option<At<Place>>,
    /// The event to which it goes. Excludes `of`.
    pub to: Option<At<Place>>,
    /// Its label. Default: none.
    pub label: Option<At<String>>,
    /// The colour. Default: that of the world line.
    pub colour: Option<Colour>,
}

/// A quarter of the diagram between the light rays through an event, with these rays: the horizons of observers
/// who accelerate away from the event for ever.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { of = [0, 0], side = \"right\" }"
)]
pub(super) struct Wedge {
    /// The event.
    pub of: At<Place>,
    /// Which quarter: "right", "left", "future" or "past". Default: "right".
    pub side: Option<At<Side>>,
    /// Its label. Default: none.
    pub label: Option<At<String>>,
    /// The colour. Default: grey.
    pub colour: Option<Colour>,
}

/// Words at an event.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { at = [1, 2], text = \"here\" }"
)]
pub(super) struct Text {
    /// The words.
    pub text: At<String>,
    /// The event on which they are centred.
    pub at: At<Place>,
    /// The colour. Default: black.
    pub colour: Option<Colour>,
}

/// A series of pictures: the view is boosted to a frame step by step, or a line of simultaneity sweeps
/// over the diagram, or both.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { boost_to = \"S'\", frames = 72 }"
)]
pub(super) struct Animation {
    /// How many pictures, 2 to 10000. Default: 72.
    pub frames: Option<At<u32>>,
    /// Pictures per second of an animated file, above 0. Default: 24.
    pub fps: Option<At<Number>>,
    /// The frame in whose coordinates the last picture is drawn; the first is drawn in those of the view, and the
    /// steps between them are equal in rapidity.
    pub boost_to: Option<At<String>>,
    /// Whether these pictures go there and back again. Default: false.
    pub back: Option<bool>,
    /// A line of simultaneity that sweeps from one time to another, with the readings of the clocks on it.
    pub now: Option<At<Now>>,
}

/// A line of simultaneity that sweeps.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { frame = \"S'\", from = 0, to = 5 }"
)]
pub(super) struct Now {
    /// The frame in which the events on the line are simultaneous. Default: "world".
    pub frame: Option<At<String>>,
    /// The time of that frame in the first picture.
    pub from: At<Number>,
    /// The time of that frame in the last picture.
    pub to: At<Number>,
    /// The colour. Default: the frame's.
    pub colour: Option<Colour>,
}
