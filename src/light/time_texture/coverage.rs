//! How much of a lookup is covered by data, and why the rest is not.

use std::ops::{Add, AddAssign, Mul};

/// Weights in [0, 1] that sum to 1 for one lookup; add lookups and divide by their number for a pixel. If several reasons apply, the
/// first of off-texture, occluded, before/after is counted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coverage {
    /// Read from the data.
    pub held: f64,
    /// Before the first bin starts (or at a time that is not a number).
    pub before: f64,
    /// After the last bin ends.
    pub after: f64,
    /// Beyond the texture's edge, or outside the capture camera's image.
    pub off_texture: f64,
    /// Not seen by the capture camera, or hidden from an element of the sensor by others.
    pub occluded: f64,
}

impl Coverage {
    /// No lookup.
    pub const NONE: Coverage = Coverage {
        held: 0.0,
        before: 0.0,
        after: 0.0,
        off_texture: 0.0,
        occluded: 0.0,
    };
    /// All within the data.
    pub const HELD: Coverage = Coverage {
        held: 1.0,
        ..Coverage::NONE
    };
    /// All off the texture.
    pub const OFF_TEXTURE: Coverage = Coverage {
        off_texture: 1.0,
        ..Coverage::NONE
    };
    /// All occluded.
    pub const OCCLUDED: Coverage = Coverage {
        occluded: 1.0,
        ..Coverage::NONE
    };

    /// The sum of all weights: the number of lookups added up.
    pub fn total(&self) -> f64 {
        self.held + self.before + self.after + self.off_texture + self.occluded
    }
}

impl Add for Coverage {
    type Output = Coverage;
    fn add(self, other: Coverage) -> Coverage {
        Coverage {
            held: self.held + other.held,
            before: self.before + other.before,
            after: self.after + other.after,
            off_texture: self.off_texture + other.off_texture,
            occluded: self.occluded + other.occluded,
        }
    }
}

impl AddAssign for Coverage {
    fn add_assign(&mut self, other: Coverage) {
        *self = *self + other;
    }
}

impl Mul<f64> for Coverage {
    type Output = Coverage;
    fn mul(self, factor: f64) -> Coverage {
        Coverage {
            held: self.held * factor,
            before: self.before * factor,
            after: self.after * factor,
            off_texture: self.off_texture * factor,
            occluded: self.occluded * factor,
        }
    }
}
