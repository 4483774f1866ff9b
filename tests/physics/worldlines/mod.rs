//! World lines against reference values, 320-bit arithmetic, closed forms and each other.

mod agreement;
mod keyframes;
mod laws;
mod lines;
mod precision;
mod profile;
mod refusals;
mod tables;
mod vicinity;
