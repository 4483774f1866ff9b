//! Guards against panics in decoders of other crates.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs another crate's decoder on bytes from outside; `None` if it panicked.
///
/// The decoders report bad files as errors, but a hostile file can still reach some of their assertions. They own everything they modify,
/// so no inconsistent state survives a panic.
pub(super) fn guarded<T>(decode: impl FnOnce() -> T) -> Option<T> {
    catch_unwind(AssertUnwindSafe(decode)).ok()
}
