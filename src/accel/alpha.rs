//! Triangles with holes: points that an alpha test calls transparent are not hit.
//!
//! Packets find the hits with whole triangles. If the nearest of those is opaque, it is the answer, because anything that the test
//! removes only lies behind it. If it is transparent, the ray is traced once more by itself, and the test is applied to every triangle
//! that it hits; blocked segments are treated the same way. Trees without a test pay nothing.

use std::fmt::Debug;

/// Decides where triangles have holes.
pub trait AlphaTest: Debug + Send + Sync {
    /// Whether triangle `id` is opaque at the point with the barycentric weights `u` of its second and `v` of its third corner. The
    /// answer must always be the same.
    fn is_opaque(&self, id: u32, u: f64, v: f64) -> bool;
}
