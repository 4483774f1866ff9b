//! Batches of coherent rays: blocks of 64 rays, and packets of as many rays as the processor has lanes.
//!
//! A block traverses the wide tree as a unit (`beam`: the interval test). At the leaves up to eight triangles are set up for the block, and
//! packets of its rays are tested against them in f32 (`setup`: the bounds). What the bounds leave open is decided by the f64 test of
//! single rays, and the numbers of every hit are computed by the same operations (`refine`): the triangle that is hit, and s, u and v, are
//! those of single rays, bit for bit, with every kernel.
//!
//! Rays may share their origin or have their own; the farther apart origins are, the less a block culls. Incoherent rays traverse the wide
//! tree individually, 32 of a block interleaved (`walk`; set-up in `lanes`), except in a small tree, where 64 rays that share some signs of
//! directions are traced together (`tile`). Rays from origins more than 2¹⁰ scene sizes away use the binary tree.

mod any_hits;
mod batch;
mod beam;
mod block;
mod closest_hits;
mod lanes;
mod method;
mod quarters;
mod ray_set;
mod refine;
mod setup;
// Only for the kernels' intrinsics.
#[allow(unsafe_code)]
mod simd;
mod tile;
mod traverse;
mod walk;

pub use method::{Kernel, Precision, Traversal};
