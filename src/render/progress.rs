//! Progress and cancellation of long work.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::{Error, Result};

/// Lets a caller monitor and stop work. Methods are called from worker threads, and from the thread that started the work.
pub trait Progress: Sync {
    /// Reports that `rays` more camera rays are done, of `rays.camera` in [`Plan`](crate::render::plan::Plan).
    fn rays_done(&self, _rays: u64) {}

    /// Whether to stop as soon as possible.
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Returns the error if work is to stop.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    fn check(&self) -> Result<()> {
        match self.is_cancelled() {
            true => Err(Error::Cancelled),
            false => Ok(()),
        }
    }
}

/// Reports nothing and never stops.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {}

/// Stopped by setting it to `true`, from another thread.
impl Progress for AtomicBool {
    fn is_cancelled(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}
