//! Long work, watched and stopped by its caller.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::{Error, Result};

/// What a caller can watch, and stop. Methods are called from worker threads, and from the thread that has begun the work.
pub trait Progress: Sync {
    /// `rays` more camera rays are done, of those that [`Plan`](crate::render::plan::Plan) has as `rays.camera`.
    fn rays_done(&self, _rays: u64) {}

    /// Whether to stop as soon as possible.
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Ends work that is to stop.
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

/// Watches nothing and never stops.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {}

/// Is stopped by `true`, from another thread.
impl Progress for AtomicBool {
    fn is_cancelled(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}
