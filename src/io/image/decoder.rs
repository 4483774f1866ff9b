//! Decoders of other crates, kept from taking the program down.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs another crate's decoder on bytes from outside, or none where it panicked.
///
/// The decoders report bad files as errors, with some assertions left that a hostile file can reach.
/// They own all that they touch, so nothing half-changed survives a panic.
pub(super) fn guarded<T>(decode: impl FnOnce() -> T) -> Option<T> {
    catch_unwind(AssertUnwindSafe(decode)).ok()
}
