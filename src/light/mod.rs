//! Where radiance comes from: time-resolved textures, and pulses of light.

#[doc = include_str!("guide.md")]
pub mod guide {}

pub mod pulse;
pub mod time_texture;
