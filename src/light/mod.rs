//! Where radiance comes from: time-resolved textures.

pub mod time_texture;
