//! Images in memory and in files.
//!
//! [`Layers`] holds the data of a frame per pixel: named channels, each in the precision in which it was computed. The writers store them
//! in `.exr` (linear, f32), `.npz` (NumPy, f64) and `.png` (display). Every file appears at once and complete, or not at all
//! ([`write_atomically`]); `encode` gives the same bytes in memory. [`Texture`] is an image on surfaces.
//!
//! This module is the only user of the crates `exr`, `png` and `zune-jpeg`, except for the PNG of drawings.

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
