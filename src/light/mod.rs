//! Sources of radiance: time-resolved textures, lamps, the sky, and the reflection of surfaces.

#[doc = include_str!("guide.md")]
pub mod guide {}

pub mod depth;
pub mod lamp;
mod received;
pub mod reflection;
pub mod sky;
pub mod time_texture;

pub use received::Received;
