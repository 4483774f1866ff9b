//! Where the rays of a picture leave the camera: all from one event, or each from its own.

use crate::spacetime::{Displacement, World};

/// Where a ray leaves, relative to the event of the shot.
pub trait Departure: Copy + Send + Sync + Into<Apart> + 'static {
    /// Whether all rays leave the event of the shot, alike in everything else too.
    const TOGETHER: bool;
    /// At the event of the shot.
    const HERE: Self;
}

/// All rays leave the event of the shot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Together;

/// A ray that leaves an event of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Apart {
    /// From the event of the shot to the event at which the ray leaves.
    pub displacement: Displacement<World>,
    /// Factor on the delay of the light along the ray; 1 but for approximations.
    pub delay: f64,
    /// Factor on the radiance that is recorded; 0 where the element sees nothing.
    pub weight: f64,
}

impl Apart {
    /// From the event of the shot, as if all rays left there.
    pub const NOWHERE_ELSE: Apart = Apart {
        displacement: Displacement::new(0.0, glam::DVec3::ZERO),
        delay: 1.0,
        weight: 1.0,
    };

    /// Whether the element sees anything.
    #[inline]
    pub fn sees(&self) -> bool {
        self.weight != 0.0
    }
}

impl Departure for Together {
    const TOGETHER: bool = true;
    const HERE: Together = Together;
}

impl Departure for Apart {
    const TOGETHER: bool = false;
    const HERE: Apart = Apart::NOWHERE_ELSE;
}

impl From<Together> for Apart {
    #[inline(always)]
    fn from(_: Together) -> Apart {
        Apart::NOWHERE_ELSE
    }
}
