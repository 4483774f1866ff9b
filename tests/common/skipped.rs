//! Programs and features that this machine lacks, and tests that are skipped as a result.

use std::fmt::Display;
use std::io::Write;

/// Says what is skipped and why: directly, since the harness keeps to itself what passing tests print.
pub fn skipped(why: impl Display) {
    let _ = writeln!(std::io::stderr(), "skipped: {why}");
}
