//! A space-time diagram, resolved: every name looked up, every event solved for. Metres throughout.

use glam::DVec3;
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spacetime::{Direction, Event, InertialFrame, Rest, Velocity, World};

pub use super::track::{Moment, Track};

/// A space-time diagram. Indices into `lines` and `frames` are those of these lists.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Diagram {
    /// The file as named by the user.
    pub name: String,
    /// The text that was parsed, after overrides.
    pub text: String,
    /// A line above the diagram.
    pub title: Option<String>,
    /// The unit of numbers at the axes.
    pub unit: Unit,
    /// The unit vector of the world along which x is measured.
    pub direction: DVec3,
    /// The unit vector across it along which y is measured; `None` in a diagram of 1+1 dimensions.
    pub across: Option<DVec3>,
    /// The meaning of x, if the view's axis needs to state it; markup.
    pub meaning: Option<String>,
    /// The labels of the view's own axes, of ct and of x, as markup; `None` for the default.
    pub labels: Option<[String; 2]>,
    /// The range of x on the axes, metres; `None` to fit the contents.
    pub x: Option<[f64; 2]>,
    /// The range of y on the axes, metres.
    pub y: Option<[f64; 2]>,
    /// The range of ct on the axes, metres.
    pub ct: Option<[f64; 2]>,
    /// The frames in whose coordinates the diagram is drawn, side by side; at least one.
    pub views: Vec<usize>,
    /// Frames of reference; the first is the world.
    pub frames: Vec<Reference>,
    /// World lines.
    pub lines: Vec<NamedLine>,
    /// Events that are marked.
    pub events: Vec<Spot>,
    /// Light cones.
    pub cones: Vec<Cone>,
    /// Light signals.
    pub signals: Vec<Segment>,
    /// Lines of equal time or equal place.
    pub slices: Vec<Slice>,
    /// Intervals.
    pub intervals: Vec<Interval>,
    /// Hyperbolae.
    pub hyperbolae: Vec<Hyperbola>,
    /// Curves that are not world lines.
    pub curves: Vec<DrawnCurve>,
    /// World sheets.
    pub sheets: Vec<WorldSheet>,
    /// Regions.
    pub regions: Vec<Region>,
    /// Arrows.
    pub arrows: Vec<Segment>,
    /// Rindler wedges.
    pub wedges: Vec<Wedge>,
    /// Texts.
    pub texts: Vec<Spot>,
    /// Lines below the diagram about what it leaves out; markup.
    pub notes: Vec<String>,
    /// The change over a series of pictures.
    pub animation: Option<Animation>,
    /// Simultaneous events, with the readings of clocks, for one picture.
    pub now: Option<Now>,
    /// Its style.
    pub style: Style,
}

/// The unit vector of the part of `v` perpendicular to the unit vector `direction`, if that is more than a millionth of it.
pub(crate) fn part_across(direction: DVec3, v: DVec3) -> Option<DVec3> {
    let v = Direction::<World>::new(v)?.unit();
    let part = v - direction * direction.dot(v);
    // Below this, v is along the direction except for rounding, and the remainder points anywhere.
    let is_some = part.length() > 1e-6;
    is_some
        .then(|| Direction::<World>::new(part))?
        .map(Direction::unit)
}

/// The unit of numbers at the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Unit {
    /// Its length, metres.
    pub metres: f64,
    /// The units on the time axis and on the space axis; `None` to show no unit.
    pub names: Option<[&'static str; 2]>,
    /// Whether the time axis shows t (a unit of time) rather than ct.
    pub is_time: bool,
}

impl Default for Unit {
    /// Metres, with no unit at the axes.
    fn default() -> Self {
        Unit {
            metres: 1.0,
            names: None,
            is_time: false,
        }
    }
}

/// A frame of reference, and which parts of it are drawn.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Reference {
    /// Unique name.
    pub name: String,
    /// The frame.
    pub frame: InertialFrame<Rest>,
    /// Whether its axes are drawn.
    pub axes: bool,
    /// Whether its lines of equal time and place are drawn.
    pub grid: bool,
    /// The distance between its ticks, metres; `None` for the diagram's own.
    pub ticks: Option<f64>,
    /// The colour; `None` for the next of the palette.
    pub colour: Option<Colour>,
}

impl Reference {
    /// A frame without drawn parts.
    pub(crate) fn bare(name: &str, frame: InertialFrame<Rest>) -> Reference {
        Reference {
            name: name.into(),
            frame,
            axes: false,
            grid: false,
            ticks: None,
            colour: None,
        }
    }

    /// The frame of the scene file itself, with its axes.
    pub(crate) fn world() -> Reference {
        let frame = InertialFrame::new(Velocity::REST, Event::ORIGIN);
        Reference {
            axes: true,
            ..Reference::bare("world", frame)
        }
    }
}

/// A world line.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct NamedLine {
    /// Unique name.
    pub name: String,
    /// Its label.
    pub label: Option<String>,
    /// Its track.
    pub track: Track,
    /// The distance between the ticks of its own clock, metres.
    pub ticks: Option<f64>,
    /// Whether these have numbers.
    pub numbers: bool,
    /// The colour; `None` for the next of the palette.
    pub colour: Option<Colour>,
}

/// A marked event, or text: an event of the world in the model, a point of a view in its layout.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Spot<P = Event<World>> {
    /// Unique name of an event; empty for words.
    pub name: String,
    /// Its position; for text, that of its middle.
    pub at: P,
    /// Its label, or the one there.
    pub label: Option<String>,
    /// Whether it has a dot.
    pub dot: bool,
    /// The colour.
    pub colour: Option<Colour>,
}

/// A straight line: from event to event of the world in the model, from point to point of a view in its layout.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Segment<P = Event<World>> {
    /// Its ends; of light, the emission first.
    pub ends: [P; 2],
    /// Its label; for an interval, `None` for its value.
    pub label: Option<String>,
    /// The colour; `None` for its owner's, or that of its kind.
    pub colour: Option<Colour>,
    /// The frame, or the world line whose four-velocity it is.
    pub owner: Option<usize>,
}

impl<P: Copy> Spot<P> {
    /// The same with positions mapped by `place`.
    pub(crate) fn map<Q>(&self, place: impl Fn(P) -> Q) -> Spot<Q> {
        Spot {
            name: self.name.clone(),
            at: place(self.at),
            label: self.label.clone(),
            dot: self.dot,
            colour: self.colour,
        }
    }
}

impl<P: Copy> Segment<P> {
    /// The same with positions mapped by `place`.
    pub(crate) fn map<Q>(&self, place: impl Fn(P) -> Q) -> Segment<Q> {
        Segment {
            ends: self.ends.map(place),
            label: self.label.clone(),
            colour: self.colour,
            owner: self.owner,
        }
    }
}

/// The light cone of an event.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Cone {
    /// Its apex.
    pub event: Event<World>,
    /// Whether its future is drawn.
    pub future: bool,
    /// Whether its past is drawn.
    pub past: bool,
    /// The distance from the apex to which it is drawn in 2+1 dimensions, metres of the view's time; `None` for the extent of the contents.
    pub height: Option<f64>,
    /// Whether its interior is shaded.
    pub shade: bool,
}

/// A line of equal time or equal place of a frame.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Slice {
    /// The frame.
    pub frame: usize,
    /// Whether time or position is equal along it.
    pub kind: SliceKind,
    /// An event on it.
    pub event: Event<World>,
    /// Its end, if it goes from `event` to somewhere; `None` if it has no ends.
    pub to: Option<Event<World>>,
    /// Its label.
    pub label: Option<String>,
    /// The colour; `None` for the frame's.
    pub colour: Option<Colour>,
}

/// The quantity that is equal along a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SliceKind {
    /// Time.
    Simultaneity,
    /// Position.
    Place,
}

/// The events of one interval from an event, on one side of its light cone.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Hyperbola {
    /// The event.
    pub about: Event<World>,
    /// The event on it that is at rest (or simultaneous) with `about` in the world.
    pub vertex: Event<World>,
    /// Its label.
    pub label: Option<String>,
    /// The colour.
    pub colour: Option<Colour>,
}

/// The interval between two events.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Interval {
    /// The events.
    pub ends: [Event<World>; 2],
    /// (Δct)² − |Δx|², square metres; below this in size if its kind is [`Kind::Unresolved`].
    pub squared: f64,
    /// Its kind.
    pub kind: Kind,
    /// Its label; `None` for its value.
    pub label: Option<String>,
    /// The colour; `None` for that of its kind.
    pub colour: Option<Colour>,
}

/// The kind of an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A clock can be at both events.
    Timelike,
    /// A frame has both at one time.
    Spacelike,
    /// A light ray connects them.
    Null,
    /// Rounding hides which of these it is.
    Unresolved,
}

/// Events joined by straight lines.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DrawnCurve<P = Event<World>> {
    /// The events, at least two.
    pub points: Vec<P>,
    /// Whether it is dashed.
    pub dashed: bool,
    /// Its label.
    pub label: Option<String>,
    /// The colour; `None` for black.
    pub colour: Option<Colour>,
}

/// The strip between two world lines.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WorldSheet {
    /// The two world lines.
    pub between: [usize; 2],
    /// The label on it.
    pub label: Option<String>,
    /// The colour; `None` for that of the first world line.
    pub colour: Option<Colour>,
}

/// A shaded region with straight edges.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Region {
    /// Its corners, at least three.
    pub corners: Vec<Event<World>>,
    /// The label on it.
    pub label: Option<String>,
    /// The colour.
    pub colour: Option<Colour>,
}

/// A quarter of the diagram between the light rays through an event.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Wedge {
    /// The event.
    pub event: Event<World>,
    /// Its side.
    pub side: Side,
    /// The label on it.
    pub label: Option<String>,
    /// The colour.
    pub colour: Option<Colour>,
}

/// A quarter of the diagram: towards +x, −x, +ct or −ct.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", schemars(inline))]
#[allow(missing_docs)]
pub enum Side {
    Right,
    Left,
    Future,
    Past,
}

/// The change from picture to picture.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Animation {
    /// The number of pictures, at least 2.
    pub frames: u32,
    /// Pictures per second.
    pub fps: f64,
    /// The boost of the view.
    pub boost: Option<Boost>,
    /// The line of simultaneity that sweeps.
    pub sweep: Option<Sweep>,
}

/// A view that is boosted.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Boost {
    /// The final frame.
    pub to: usize,
    /// Whether it goes back again.
    pub back: bool,
}

/// A line of simultaneity that sweeps.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Sweep {
    /// The frame.
    pub frame: usize,
    /// Its times in the first and in the last picture, metres.
    pub times: [f64; 2],
    /// The colour; `None` for the frame's.
    pub colour: Option<Colour>,
}

/// All events that are simultaneous in a frame, with the readings of the clocks.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Now {
    /// The frame.
    pub frame: usize,
    /// Its time, metres.
    pub ct: f64,
    /// Decimals of the readings, in the diagram's unit.
    pub decimals: usize,
    /// The colour; `None` for the frame's.
    pub colour: Option<Colour>,
}

/// A colour of the palette, or any.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(try_from = "String", into = "String")]
#[allow(missing_docs)]
pub enum Colour {
    Black,
    Grey,
    Blue,
    Red,
    Green,
    Orange,
    Sky,
    Purple,
    /// sRGB; the same on white and on black.
    Rgb([u8; 3]),
}

impl Colour {
    /// The palette by name.
    const PALETTE: [(&str, Colour); 8] = [
        ("black", Colour::Black),
        ("grey", Colour::Grey),
        ("blue", Colour::Blue),
        ("red", Colour::Red),
        ("green", Colour::Green),
        ("orange", Colour::Orange),
        ("sky", Colour::Sky),
        ("purple", Colour::Purple),
    ];
}

impl TryFrom<String> for Colour {
    type Error = String;

    fn try_from(text: String) -> Result<Colour, String> {
        let named = Self::PALETTE.iter().find(|(name, _)| *name == text);
        if let Some((_, colour)) = named {
            return Ok(*colour);
        }
        // Digits are checked first: `from_str_radix` would accept a sign.
        let digits = text.strip_prefix('#').filter(|hex| hex.len() == 6);
        let digits = digits.filter(|hex| hex.bytes().all(|b| b.is_ascii_hexdigit()));
        let number = digits.and_then(|hex| u32::from_str_radix(hex, 16).ok());
        // Big-endian: the highest of four bytes is 0, then red, green, blue as they are written.
        if let Some([_, r, g, b]) = number.map(u32::to_be_bytes) {
            return Ok(Colour::Rgb([r, g, b]));
        }
        let names = Self::PALETTE.map(|(name, _)| format!("\"{name}\""));
        Err(format!(
            "{} is not a colour: there are {}, and any as \"#0072b2\"",
            crate::spacetime::units::quoted(&text),
            names.join(", ")
        ))
    }
}

impl From<Colour> for String {
    fn from(colour: Colour) -> String {
        let named = Colour::PALETTE.iter().find(|(_, known)| *known == colour);
        match (named, colour) {
            (Some((name, _)), _) => name.to_string(),
            (None, Colour::Rgb([r, g, b])) => format!("#{r:02x}{g:02x}{b:02x}"),
            (None, _) => String::new(),
        }
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Colour {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Colour".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let names = Self::PALETTE.map(|(name, _)| name);
        schemars::json_schema!({
            "anyOf": [
                { "type": "string", "enum": names },
                { "type": "string", "pattern": "^#[0-9A-Fa-f]{6}$" },
            ]
        })
    }
}

/// The style of a diagram.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Style {
    /// For a black page rather than a white one.
    pub dark: bool,
    /// Width of the page, points; `None` for 120 mm per view side by side.
    pub width: Option<f64>,
    /// Number of views side by side, at least 1; `None` for all.
    pub columns: Option<u32>,
    /// Height of the page, points; `None` for what the contents need.
    pub height: Option<f64>,
    /// Size of the type, points.
    pub font_size: f64,
    /// Width of world lines, points.
    pub line_width: f64,
    /// Whether world lines are named in a legend.
    pub legend: bool,
    /// Whether the view's axes have ticks with numbers.
    pub ticks: bool,
    /// Whether the view's own grid is drawn.
    pub grid: bool,
}

impl Default for Style {
    fn default() -> Self {
        Style {
            dark: false,
            width: None,
            columns: None,
            height: None,
            font_size: 10.0,
            line_width: 1.4,
            legend: false,
            ticks: true,
            grid: false,
        }
    }
}
