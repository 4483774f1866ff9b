//! World lines.

use glam::DVec3;

/// A stretch of constant proper acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Proper time that it takes, metres; infinite for the last.
    pub duration: f64,
    /// Proper acceleration in the comoving frame's axes at its beginning, 1/m; zero is coasting.
    pub acceleration: DVec3,
}
