//! Diagrams, drawings, overlays, contact sheets, the pixel probe.

#[path = "../common"]
mod common {
    pub mod png;
    pub mod skipped;
}

mod contact_sheet;
mod diagrams;
mod drawing;
mod isochrones;
mod overlay;
mod pixel_probe;
