//! Batches of rays that go nearly the same way: blocks of 64 rays, and packets of as many as the processor has lanes.
//!
//! A block goes down the wide tree as one (`beam`: the interval test). At the leaves up to eight triangles are set up for
//! the block, and packets of its rays are tested against those in f32 (`setup`: the bounds). What the bounds leave
//! open is decided by the f64 test of single rays, and the numbers of every hit are worked out by its operations
//! (`refine`): the triangle that is hit, and s, u and v, are those of single rays, bit for bit, with every kernel.
//!
//! Rays may share their origin or have their own; the farther those are from one another, the less a block
//! culls. Rays that are incoherent go through the wide tree each on its own way, 64 in turn (`walk`; `lanes`: their set-up), but in a small tree together, 64 whose directions have
//! signs in common (`tile`); origins more than 2¹⁰ scene sizes away go through the binary tree.

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
// The kernels' intrinsics, and nothing else.
#[allow(unsafe_code)]
mod simd;
mod tile;
mod traverse;
mod walk;

pub use method::{Kernel, Precision, Traversal};
