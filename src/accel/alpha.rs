//! Triangles with holes: what an alpha test takes for transparent is not hit.
//!
//! Packets find the hits with whole triangles. The nearest of those is the answer where it is opaque, for all that the test would
//! take away lies behind it or is not there. Where it is transparent, the ray is traced once more by itself, and each triangle
//! that it meets is tested; so is a segment that something blocks. Trees without a test pay nothing.

use std::fmt::Debug;

/// Where triangles have holes.
pub trait AlphaTest: Debug + Send + Sync {
    /// Whether triangle `id` is there at the point with the barycentric weights `u` of its second and `v` of its third corner.
    /// The answer has to be the same whenever it is asked.
    fn is_opaque(&self, id: u32, u: f64, v: f64) -> bool;
}
