//! The memory budget that the readers of a command share, so that no file can request more than there is.
//!
//! Readers reserve what they are going to hold, in bytes after widening, before they allocate it. Freed memory is not returned to the
//! budget: commands hold what they read until they end.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Message, Result, Setting};

/// Memory shared by any number of readers.
#[derive(Debug)]
pub struct Budget {
    limit: u64,
    left: AtomicU64,
}

impl Budget {
    /// A budget of `memory_limit` bytes.
    pub fn new(memory_limit: u64) -> Self {
        Budget {
            limit: memory_limit,
            left: AtomicU64::new(memory_limit),
        }
    }

    /// The bytes taken so far.
    pub(crate) fn taken(&self) -> u64 {
        self.limit - self.left()
    }

    /// The remaining bytes.
    pub(crate) fn left(&self) -> u64 {
        self.left.load(Ordering::Relaxed)
    }

    /// Takes `bytes` for what is read from `file`.
    ///
    /// # Errors
    /// More than the remainder; nothing is taken then.
    pub fn take(&self, bytes: u64, file: &Path) -> Result<()> {
        let taken = |left: u64| left.checked_sub(bytes);
        let taken = self
            .left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, taken);
        taken.map(drop).map_err(|left| {
            let what = format!(
                "needs {} of memory, and {} of {} are left",
                amount(bytes),
                amount(left),
                amount(self.limit)
            );
            Error::invalid(
                file,
                "memory",
                what,
                Message::from("a smaller file, or a higher ") + Setting::MemoryLimit,
            )
        })
    }
}

/// A number of bytes for people.
pub fn amount(bytes: u64) -> String {
    const UNITS: [&str; 5] = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = bytes as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    if unit == 0 {
        format!("{bytes} B")
    } else {
        format!("{value:.1} {}", UNITS[unit])
    }
}

impl Default for Budget {
    /// 16 GiB.
    fn default() -> Self {
        Budget::new(16 << 30)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readers_share_what_there_is_and_a_refused_one_takes_nothing() {
        let budget = Budget::new(100);
        budget.take(60, Path::new("a")).unwrap();
        let refused = budget.take(41, Path::new("b")).unwrap_err().to_string();
        assert!(
            refused.contains("41 B of memory") && refused.contains("40 B of 100 B"),
            "{refused}"
        );
        budget.take(40, Path::new("c")).unwrap();
        assert!(budget.take(u64::MAX, Path::new("d")).is_err());
    }
}
