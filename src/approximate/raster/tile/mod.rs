//! One tile: which triangle each sample sees.
//!
//! Triangles that may reach the tile are gathered (`gather`) and set up (`setup`). They are evaluated for the samples of one strip of the
//! tile after the other, pixel by pixel, so that even a small triangle fills vectors with the samples of the few pixels that it may
//! cover: sample by sample (`samples`), or, if the samples of a pixel fill whole vectors, first for whole pixels (`pixels`). Both use the
//! same depth test (`depth`).

mod buffers;
mod depth;
mod gather;
mod pixels;
#[cfg(test)]
mod random_triangles;
mod samples;
mod setup;

pub(super) use buffers::TileBuffers;
pub(super) use depth::{MOST_TOGETHER, NOTHING, WHOLE};
pub(super) use gather::{Gathered, Pieces};
