//! The whole pipeline, from a scene's text to its film, against closed forms.

mod bounces;
mod channels;
mod clocks;
mod costs;
mod coverage;
mod determinism;
mod doppler;
mod effects;
mod extremes;
pub mod files;
mod glass;
mod invariance;
mod lamps;
mod lorentz;
mod moving_pulse;
mod outlines;
mod passes;
mod pulse;
mod refusals;
mod sampled;
mod shared_paths;
mod skies;
mod skipping;
mod smooth;
mod spectra;
pub mod stage;
mod together;
