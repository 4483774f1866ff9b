//! The targets, for cargo-fuzz.

mod targets;

pub use targets::{TARGETS, Target};

/// Runs the target of this name.
pub fn run(name: &str, bytes: &[u8]) {
    let target = TARGETS.iter().find(|target| target.name == name);
    (target.expect("a target of this name").run)(bytes);
}
