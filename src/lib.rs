//! nullray

pub mod accel;
pub mod aov;
pub mod camera;
pub mod colour;
pub mod error;
pub mod files;
pub mod film;
pub mod image;
pub mod import;
pub mod isochrones;
pub mod mesh;
pub mod plan;
pub mod prepare;
pub mod render;
pub mod sampler;
pub mod scene;
pub mod shapes;
pub mod spacetime;
pub mod text;
pub mod time_texture;
pub mod tonemap;
pub mod trace;
pub mod units;

pub use error::{Error, Result};
