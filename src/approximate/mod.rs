//! The same pictures by other means: rasterizers of apparent vertices and image-space warps, and how fine
//! triangles have to be for them.

pub mod projection;
pub mod raster;
pub mod tessellation;
