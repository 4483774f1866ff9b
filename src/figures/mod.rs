//! Figures: space-time diagrams, overlays, contact sheets, and the drawing that they share.

#[doc = include_str!("guide.md")]
pub mod guide {}

pub mod contact_sheet;
pub mod diagram;
pub mod drawing;
pub mod isochrones;
pub mod overlay;
pub mod page;
pub mod pixel_probe;
pub(crate) mod ticks;
