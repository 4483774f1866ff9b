//! How much memory the readers of a command may take together, so that no file can ask for more than there is.
//!
//! Readers take what they are going to hold, in bytes after widening, before they allocate it. What is let go again is not
//! given back: commands hold what they read until they end.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Message, Result, Setting};

/// Memory that may be taken, by any number of readers.
#[derive(Debug)]
pub struct Budget {
    limit: u64,
    left: AtomicU64,
}

impl Budget {
    /// So many bytes.
    pub fn new(memory_limit: u64) -> Self {
        Budget {
            limit: memory_limit,
            left: AtomicU64::new(memory_limit),
        }
    }

    /// How many bytes have been taken.
    pub(crate) fn taken(&self) -> u64 {
        self.limit - self.left()
    }

    /// How many bytes are left.
    pub(crate) fn left(&self) -> u64 {
        self.left.load(Ordering::Relaxed)
    }

    /// Takes `bytes` for what is read from `file`.
    ///
    /// # Errors
    /// More than is left; none is taken then.
    pub fn take(&self, bytes: u64, file: &Path) -> Result<()> {
        let taken = |left: u64| left.checked_sub(bytes);
        let taken = self
            .left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, taken);
        taken.map(drop).map_err(|left| {
            let what = format!(
                "needs {bytes} bytes of memory, and {left} of {} are left",
                self.limit
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
            refused.contains("41") && refused.contains("40 of 100"),
            "{refused}"
        );
        budget.take(40, Path::new("c")).unwrap();
        assert!(budget.take(u64::MAX, Path::new("d")).is_err());
    }
}
