//! Rasterizers and warps against the ray tracer: what they share is equal, what they approximate converges as it should, and the forecast
//! of their tessellation holds.

mod apparent;
mod convergence;
mod even;
mod forecast;
mod refusals;
mod same;
pub mod stage;
mod together;
mod warp;
