//! Where radiance comes from: time-resolved textures.

#[doc = include_str!("guide.md")]
pub mod guide {}

pub mod time_texture;
