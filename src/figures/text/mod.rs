//! Text as outlines, the same on every machine and in every format.
//!
//! A [`Label`] is a line of upright and italic runs in Libertinus Serif (embedded). [`outline`] turns it
//! into a list of path segments that raster, SVG and PDF writers share; [`draw`] fills them on a
//! tiny-skia pixmap. [`RichText`] is such a line read from light markup, with scripts. Lengths are in units of the page, y runs down, and the origin of an outline is the
//! left end of its baseline. Pairs are kerned.

mod font;
mod kern;
mod markup;
mod outline;
mod raster;
pub mod rich;
mod setter;

pub use font::{Label, Style, outline, width};
pub use outline::{Outline, Rect, Segment, bounds};
pub use raster::{Anchor, draw, path};
pub use rich::RichText;
