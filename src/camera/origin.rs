//! Where the rays of a picture leave the camera, relative to the event of the shot.

use crate::spacetime::{Displacement, World};

/// Where and how a ray leaves the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayOrigin {
    /// From the event of the shot to the event at which the ray leaves.
    pub displacement: Displacement<World>,
    /// Factor on the delay of the light along the ray; 1 except in approximations.
    pub delay: f64,
    /// Factor on the recorded radiance; 0 if the element sees nothing.
    pub weight: f64,
}

impl RayOrigin {
    /// The event of the shot, from which all rays of a point camera leave.
    pub(crate) const AT_SHOT: RayOrigin = RayOrigin {
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
