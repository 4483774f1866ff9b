//! nullray

pub mod error;
pub mod mesh;
pub mod scene;
pub mod spacetime;
pub mod time_texture;
pub mod units;

pub use error::{Error, Result};
