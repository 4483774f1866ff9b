//! The acceleration structure against brute force, closed meshes and reference vectors.

mod brute_force;
mod cases;
mod closed;
mod common;
mod holes;
mod leaving;
mod own_origins;
mod packets;
mod reference;
mod segments;
mod watertight;
