//! Space-time diagrams, for teachers: what is where as data, and the drawing made from it.
//!
//! ```text
//! scene file → scene::model::diagram::Diagram ── layout ──▶ Layout ── draw ──▶ Drawing → svg, pdf, png
//! ```
//!
//! A diagram shows ct upwards and one direction of space to the right, in the coordinates of any inertial
//! frame and on equal scales, so that light is at 45 degrees. The axes of a frame with the velocity β are
//!
//! ```text
//! ct′ axis: x = β ct,     x′ axis: ct = β x,
//! ```
//!
//! and one unit of them is √((1 + β²)/(1 − β²)) units long on the page: the events of one interval from the
//! origin are on hyperbolae, (ct)² − x² = τ² (Minkowski 1908). What is not in the plane of the diagram is
//! projected onto it. [`Series`] draws what changes from picture to picture: a boost, a sweep of what is
//! simultaneous.
//!
//! In 2+1 dimensions it shows two directions of space, y going into the page at an angle and half as long
//! (oblique projection). A light cone is then |Δ(x, y)| = |Δct|, and what is simultaneous in a frame a plane,
//! Δct = β·Δ(x, y). What is straight below things is drawn on the floor, at the lowest ct.
//!
//! ```
//! use nullray::{figures::diagram, scene};
//! # fn main() -> nullray::Result<()> {
//! let text = r#"
//!     [diagram]
//!     frame = [{ name = "S'", velocity = 0.6 }]
//!     event = [{ name = "A", at = [1, 0], frame = "S'" }]
//! "#;
//! let model = scene::parse_diagram(text, "a clock", ".".as_ref(), &Default::default())?;
//! let layout = diagram::layout(&model);
//! // A second of the moving clock takes 5/4 s of the other.
//! assert!((layout.panels[0].events[0].at.ct - 1.25).abs() < 1e-15);
//! let drawing = diagram::draw(&layout, &model.style)?;
//! assert!(drawing.height > 0.0);
//! # Ok(())
//! # }
//! ```

mod draw;
mod layout;
mod series;

pub use draw::draw;
pub use layout::{
    Area, Axes, Axis, Bead, Cone, Curve, GridLine, Hyperbola, Interval, Kind, Layout, Limits,
    Nappe, Now, Panel, Placed, Plane, Point, Segment, Solid, Spot, Tick, WorldLine, layout,
};
pub(crate) use layout::{limits, number, round_step};
pub use series::Series;
