//! Random numbers of samples: positions in a pixel, times, and points for all other random choices.
//!
//! All are pure functions of pixel and index: nothing depends on threads, tiles or the order of rendering.

mod random;
mod sobol;
mod strata;

pub(crate) use random::{halves, pixel_key};
pub(crate) use sobol::{sobol, sobol_among, sobol_of_each, sobol_of_each_at};
pub use strata::Sampler;
pub(crate) use strata::samples_per_part;
