//! Time-resolved textures: radiance on (v, u, t, channel), with what they do not hold.

mod cube;

pub use cube::{Cube, Samples};
