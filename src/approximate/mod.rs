//! The same pictures by approximate methods: rasterizers of apparent vertices and image-space warps, and the tessellation that they need.

pub mod projection;
pub mod raster;
pub mod tessellation;
