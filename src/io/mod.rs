//! Files: glTF, NumPy arrays, cubes, pictures, and the files that scenes name.
//!
//! A file is never trusted. Every count, offset and index is checked, in arithmetic that cannot
//! overflow, before memory is asked for or a byte is read, so that a broken or hostile file ends
//! in one [`Error`](crate::Error) that names the file, the place in it and what would be right.
//! Each reader has an `inspect` that reads headers only, for planning.

#[doc = include_str!("guide.md")]
pub mod guide {}

pub mod budget;
pub mod colmap;
pub mod cube;
pub mod files;
pub mod gltf;
pub mod image;
pub mod npy;
mod open;
mod packed;
pub mod sealed;
pub mod spectrum;
pub mod temporary;
