//! From a scene to a picture: what a scene needs, what is loaded and built for it, and how rays become pixels.
//!
//! ```text
//! scene ──▶ plan ──▶ prepare ──▶ tiles: trace ──▶ film ──▶ tonemap
//! ```

pub mod aov;
pub mod bake;
pub mod enclosed;
mod estimate_reads;
pub mod film;
pub(crate) mod identities;
pub mod journal;
pub mod metadata;
pub mod passes;
pub mod plan;
pub mod prepare;
pub mod progress;
pub mod sampler;
pub mod survey;
mod tiles;
pub mod tonemap;
pub mod trace;

pub use aov::Aov;
pub use estimate_reads::estimate_reads;
pub use film::Film;
pub use plan::{Plan, Request};
pub use prepare::Prepared;
pub use progress::Silent;
pub(crate) use tiles::render_every;
pub use tiles::{render, render_over, render_tiles, render_with_stats};
