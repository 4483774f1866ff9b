//! The program as its users see it, and the tools that validate pictures.

#[path = "../common"]
mod common {
    pub mod png;
    pub mod skipped;
}

mod cli;
mod compare;
mod export;
mod house;
mod study;
