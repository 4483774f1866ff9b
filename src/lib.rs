//! nullray

pub mod colour;
pub mod error;
pub mod image;
pub mod isochrones;
pub mod mesh;
pub mod scene;
pub mod spacetime;
pub mod text;
pub mod time_texture;
pub mod tonemap;

pub use error::{Error, Result};
