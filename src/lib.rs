//! nullray

pub mod error;
pub mod import;
pub mod mesh;
pub mod scene;
pub mod spacetime;
pub mod time_texture;

pub use error::{Error, Result};
