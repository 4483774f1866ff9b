//! What other programs wrote, read into this program's types: glTF into [`Mesh`](crate::mesh::Mesh),
//! NumPy arrays into [`Cube`](crate::time_texture::Cube).
//!
//! A file is never trusted. Every count, offset and index is checked, in arithmetic that cannot
//! overflow, before memory is asked for or a byte is read, so that a broken or hostile file ends
//! in one [`Error`](crate::Error) that names the file, the place in it and what would be right.
//! Each importer has an `inspect` that reads headers only, for planning.

mod file;
pub mod gltf;
pub mod npy;
