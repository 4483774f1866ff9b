//! Closest and any hits of rays with triangles at rest.
//!
//! Triangles and rays are f64, in metres relative to the origin of the rest frame. A tree of f32 boxes skips what a ray certainly misses
//! (`slab` derives "certainly"); the rest is decided in f64, and exactly where f64 is in doubt (`triangle`). Hence
//!
//! - a ray hits a triangle iff exact arithmetic on the given numbers says so; edges and corners belong to all triangles that share them,
//!   so closed meshes have no gaps;
//! - among equal parameters the smaller id wins, and every parameter is a function of ray and triangle alone: a hit depends neither on
//!   the tree nor on the order in which it is traversed;
//! - coherent rays, which start at or near one point and have similar directions, are traced in packets of as many rays as the processor
//!   has lanes ([`Kernel`]), with the same hits as single rays, bit for bit; so are segments, which are only tested for occlusion;
//! - nothing depends on the scale or the position of the scene, or on the length of a direction.
//!
//! Limits: coordinates up to 2³⁰⁰ m; directions of length 2⁻⁵⁰⁰ to 2⁵⁰⁰; origins up to 2¹⁰⁰ scene sizes away. Anything outside these
//! limits, or NaN, hits nothing. This is the only module that converts rays from f64 to f32.
//!
//! From bottom to top: `float` and `exact` are arithmetic, `pages` long arrays; `triangle` intersects a ray with a triangle; `node` and
//! `wide` are the two trees, in the coordinates of `tree_space`; `bvh` holds them, `islands` decides how many there are, `boxes`,
//! `cluster`, `reinsert`, `leaves`, `layout` and `build` make them, `alpha` makes holes; `slab`, `traverse` and `single` trace single
//! rays; `packet` traces batches. `vectors`, `texels`, `sincos` and `arctan` are vector loops that all higher modules share.

#[doc = include_str!("guide.md")]
pub mod guide {}

mod alpha;
pub(crate) mod arctan;
mod boxes;
mod build;
mod bvh;
mod cluster;
mod exact;
mod float;
mod islands;
mod layout;
mod leaves;
mod node;
mod packet;
// Only for a memory map.
#[allow(unsafe_code)]
pub(crate) mod pages;
mod rays;
mod reinsert;
pub(crate) mod sincos;
mod single;
mod slab;
mod tally;
pub(crate) mod texels;
mod traverse;
mod tree_space;
mod triangle;
pub(crate) mod vectors;
mod wide;

pub use alpha::AlphaTest;
pub use build::{ExpectedRays, Preset};
pub use bvh::Bvh;
pub use packet::{Kernel, Precision, Traversal};
pub use rays::{Converging, Facing, Hit, NO_SLOT, Origins, Ray, Segment};
pub use tally::Counts;

/// Pseudo-random numbers from −1 to 1, for tests: a linear congruential generator.
#[cfg(test)]
pub(crate) fn numbers(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
