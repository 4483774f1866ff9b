//! Images in memory and in files.
//!
//! [`Layers`] holds what a frame has per pixel: named channels, each in the precision in which it was
//! computed. The writers put them into `.exr` (linear, f32), `.npz` (numpy, f64) and `.png` (display).
//! Every file appears at once and whole, or not at all ([`write_atomically`]). [`Texture`] is an image
//! that surfaces show.
//!
//! This module is the only user of the crates `exr`, `png` and `zune-jpeg`, but for the PNG of drawings.

pub mod exr;
mod file;
mod layers;
pub mod npz;
pub mod png;
mod texture;

pub use file::write_atomically;
pub use layers::{Channel, Layers, Samples};
pub use texture::Texture;

use std::panic::{AssertUnwindSafe, catch_unwind};

/// An 8-bit sRGB image, row 0 at the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RgbImage {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// 3·width·height bytes.
    pub rgb: Vec<u8>,
}

/// Runs another crate's decoder on bytes from outside, or none where it panicked.
///
/// The decoders report bad files as errors, with some assertions left that a hostile file can reach.
/// They own all that they touch, so nothing half-changed survives a panic.
fn guarded<T>(decode: impl FnOnce() -> T) -> Option<T> {
    catch_unwind(AssertUnwindSafe(decode)).ok()
}
