//! nullray

pub mod accel;
pub mod error;
pub mod mesh;
pub mod scene;
pub mod spacetime;
pub mod time_texture;

pub use error::{Error, Result};
