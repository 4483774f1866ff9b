//! Comparing pictures: metrics against other programs, geometric errors against known shifts, planted errors.

mod arrays;
mod browser;
mod metrics;
mod pictures;
mod planted;
mod program;
mod refusals;
mod surfaces;
mod usual_bugs;
