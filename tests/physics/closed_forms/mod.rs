//! The spacetime core against closed forms; each test carries its derivation and its number.

mod appearance;
mod doppler;
mod intervals;
mod invariance;
mod light_paths;
mod sample;
