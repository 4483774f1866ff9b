//! nullray

pub mod camera;
pub mod error;
pub mod mesh;
pub mod sampler;
pub mod scene;
pub mod shapes;
pub mod spacetime;
pub mod time_texture;

pub use error::{Error, Result};
