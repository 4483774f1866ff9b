//! Text as outlines, the same on every machine and in every format.
//!
//! A [`RichText`] is a line in Libertinus Serif (embedded), read from light markup, with italics and scripts.
//! [`RichText::outline`] turns it into path segments that raster, SVG and PDF writers share. Lengths are in units of the page, y runs down, and the origin of an outline is the
//! left end of its baseline. Pairs are kerned.

mod markup;
mod outline;
pub mod rich;
mod setter;
mod tex;

pub use outline::{Outline, Rect, Segment, bounds};
pub use rich::RichText;
#[cfg(feature = "pdf")]
pub(crate) use setter::{Glyph, font};
