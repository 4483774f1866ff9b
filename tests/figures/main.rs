//! Diagrams, drawings, overlays, contact sheets, the pixel probe.

mod contact_sheet;
mod diagrams;
mod drawing;
mod isochrones;
mod overlay;
mod pixel_probe;
