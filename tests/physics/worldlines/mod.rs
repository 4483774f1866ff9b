//! World lines against reference values, 320-bit arithmetic, closed forms and each other.

#[allow(dead_code)] // each test uses its part
mod agreement;
mod keyframes;
mod laws;
mod lines;
mod precision;
mod profile;
mod refusals;
mod tables;
mod vicinity;
