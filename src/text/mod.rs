//! Text as outlines, the same on every machine and in every format.
//!
//! A [`Label`] is a line of upright and italic runs in Libertinus Serif (embedded). [`outline`] turns it
//! into a list of path segments that raster, SVG and PDF writers share; [`draw`] fills them on a
//! tiny-skia pixmap. Lengths are in units of the page, y runs down, and the origin of an outline is the
//! left end of its baseline. Pairs are kerned.

mod font;
mod kern;
mod raster;

pub use font::{Label, Outline, Segment, Style, outline, width};
pub use raster::{Anchor, draw, path};
