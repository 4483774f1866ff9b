//! Images in memory and in files.
//!
//! [`Layers`] holds what a frame has per pixel: named channels, each in the precision in which it was
//! computed. The writers put them into `.exr` (linear, f32), `.npz` (numpy, f64) and `.png` (display).
//! Every file appears at once and whole, or not at all ([`write_atomically`]). [`Texture`] is an image
//! that surfaces show.
//!
//! This module is the only user of the crates `exr`, `png` and `zune-jpeg`, but for the PNG of drawings.

mod decoder;
pub mod exr;
mod file;
pub mod film;
pub mod hdr;
mod layers;
pub mod npz;
pub mod panorama;
pub mod png;
mod texture;
#[cfg(feature = "tiff")]
pub mod tiff;

pub use file::write_atomically;
pub use layers::{Channel, Layers, RgbImage, Samples};
pub use texture::Texture;
