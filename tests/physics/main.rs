//! The spacetime core: closed forms, reference vectors, arbitrary precision.

#[path = "../common"]
mod common {
    pub mod exact;
    pub mod sequence;
    pub mod table;
    pub mod worst;
}

mod closed_forms;
mod lamps;
mod paper_equations;
mod precision;
mod reference_vectors;
mod stability;
mod worldlines;
