//! Comparing pictures: metrics against other programs, geometric errors against known shifts, planted errors.

mod metrics;
mod pictures;
mod planted;
mod program;
mod refusals;
mod surfaces;
