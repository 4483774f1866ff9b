//! The program as its users meet it, and the tools that validate pictures.

mod cli;
mod compare;
mod export;
mod study;
