//! Space-time diagrams, for teachers: the layout as data, and the drawing made from it.
//!
//! ```text
//! scene file ── load ──▶ model::Diagram ── layout ──▶ Layout ── draw ──▶ Drawing → svg, pdf, png
//! ```
//!
//! A diagram shows ct upwards and one direction of space to the right, in the coordinates of any inertial
//! frame and on equal scales, so that light is at 45 degrees. The axes of a frame with the velocity β are
//!
//! ```text
//! ct′ axis: x = β ct,     x′ axis: ct = β x,
//! ```
//!
//! and one unit of them is √((1 + β²)/(1 − β²)) units long on the page: the events at one interval from the origin are on hyperbolae,
//! (ct)² − x² = τ² (Minkowski 1908). Anything outside the plane of the diagram is projected onto it. [`Series`] draws animations: a
//! boost, or a sweep of a line of simultaneity.
//!
//! In 2+1 dimensions it shows two directions of space, y going into the page at an angle and half as long (oblique projection). A light
//! cone is then |Δ(x, y)| = |Δct|, and the events simultaneous in a frame form a plane, Δct = β·Δ(x, y). Shadows straight below things
//! are drawn on the floor, at the lowest ct.
//!
//! # The table of a scene file
//!
//! `[diagram]` names frames, world lines and events, in any order, and the elements drawn between them. Its numbers are plain, in its
//! `unit`, times as ct: `[ct, x]` is an event, `velocity = 0.6` is β along x, an acceleration is one per unit. Units of time, and accelerations with
//! a unit, are those of the scene's `speed_of_light`. Things of the scene (`of = "camera"`, `"sensor"`, or the name of an object, a lamp or a
//! pulse) are converted from metres. x is the component along `direction`; anything beside that
//! line is projected onto it, and light that goes there is then steeper than 45 degrees. Notes below the diagram say so
//! ([`Layout::notes`]).
//!
//! With `dimensions = "2+1"` there is also y, the component along `across`, and `[ct, x, y]` is an event. Light cones are cones,
//! `simultaneity` without `to` is a plane, and everything has a shadow on the floor below. Grids of frames, hyperbolae and wedges are
//! lines of 1+1 dimensions, and refused.
//!
//! ```
//! use nullray::figures::diagram;
//! # fn main() -> nullray::Result<()> {
//! let text = r#"
//!     [diagram]
//!     frame = [{ name = "S'", velocity = 0.6 }]
//!     event = [{ name = "A", at = [1, 0], frame = "S'" }]
//! "#;
//! let model = diagram::parse(text, "a clock", ".".as_ref(), &Default::default())?;
//! let layout = diagram::layout(&model);
//! // A second of the moving clock takes 5/4 s of the other.
//! assert!((layout.panels[0].events[0].at.ct - 1.25).abs() < 1e-15);
//! let drawing = diagram::draw(&layout, &model.style)?;
//! assert!(drawing.height > 0.0);
//! # Ok(())
//! # }
//! ```

mod animation;
mod draw;
mod file;
mod layout;
mod load;
pub mod model;
mod resolve;
mod series;
mod spot;
mod track;

pub use draw::draw;
pub use layout::{
    Area, Axes, Axis, Bead, Cone, Curve, GridLine, Hyperbola, Interval, Kind, Layout, Limits,
    Nappe, Note, Now, Panel, Placed, Plane, Point, Projection, Solid, Tick, WorldLine, layout,
};
pub(crate) use layout::{limits, number, tick_step};
#[cfg(feature = "schema")]
pub use load::derived_schema;
pub use load::{load, parse};
pub use series::Series;
