//! What packets are made of: rays as they are given, and as they are traced.

use glam::DVec3;

use crate::accel::{Ray, Segment};

/// Rays to trace. `start` and `direction` are a ray as it is traced, which may be the other way round.
pub(super) trait Bundle: Copy {
    /// Whether each has an origin of its own.
    const OWN: bool;

    /// Where all start, if they start together.
    fn shared_origin(self) -> Option<DVec3>;
    /// Whether they are traced the other way round.
    fn is_reversed(&self) -> bool {
        false
    }
    /// All directions in a row, if they are.
    fn directions(&self) -> Option<&[DVec3]>;
    /// Metres per unit of s.
    fn direction(self, ray: usize) -> DVec3;
    /// Metres.
    fn start(self, ray: usize) -> DVec3;
    /// Where the ray starts as given, metres.
    fn origin(self, ray: usize) -> DVec3;
}

/// Rays from one point.
#[derive(Clone, Copy)]
pub(super) struct Pencil<'a> {
    /// Metres.
    pub origin: DVec3,
    pub directions: &'a [DVec3],
}

/// Rays from a point each.
#[derive(Clone, Copy)]
pub(super) struct Sheaf<'a> {
    /// Metres.
    pub origins: &'a [DVec3],
    pub directions: &'a [DVec3],
}

/// Segments, from where they start or from where they end.
#[derive(Clone, Copy)]
pub(super) struct Segments<'a> {
    pub segments: &'a [Segment],
    pub reversed: bool,
}

impl Bundle for Pencil<'_> {
    const OWN: bool = false;

    #[inline(always)]
    fn shared_origin(self) -> Option<DVec3> {
        Some(self.origin)
    }

    #[inline(always)]
    fn directions(&self) -> Option<&[DVec3]> {
        Some(self.directions)
    }

    #[inline(always)]
    fn direction(self, ray: usize) -> DVec3 {
        self.directions[ray]
    }

    #[inline(always)]
    fn start(self, _: usize) -> DVec3 {
        self.origin
    }

    #[inline(always)]
    fn origin(self, _: usize) -> DVec3 {
        self.origin
    }
}

impl Bundle for Sheaf<'_> {
    const OWN: bool = true;

    #[inline(always)]
    fn shared_origin(self) -> Option<DVec3> {
        None
    }

    #[inline(always)]
    fn directions(&self) -> Option<&[DVec3]> {
        Some(self.directions)
    }

    #[inline(always)]
    fn direction(self, ray: usize) -> DVec3 {
        self.directions[ray]
    }

    #[inline(always)]
    fn start(self, ray: usize) -> DVec3 {
        self.origins[ray]
    }

    #[inline(always)]
    fn origin(self, ray: usize) -> DVec3 {
        self.origins[ray]
    }
}

impl Bundle for Segments<'_> {
    const OWN: bool = true;

    #[inline(always)]
    fn shared_origin(self) -> Option<DVec3> {
        None
    }

    #[inline(always)]
    fn is_reversed(&self) -> bool {
        self.reversed
    }

    #[inline(always)]
    fn directions(&self) -> Option<&[DVec3]> {
        None
    }

    #[inline(always)]
    fn direction(self, ray: usize) -> DVec3 {
        let direction = self.segments[ray].ray.direction;
        if self.reversed { -direction } else { direction }
    }

    #[inline(always)]
    fn start(self, ray: usize) -> DVec3 {
        let Segment { ray, s_max, .. } = &self.segments[ray];
        if self.reversed {
            ray.origin + ray.direction * *s_max
        } else {
            ray.origin
        }
    }

    #[inline(always)]
    fn origin(self, ray: usize) -> DVec3 {
        self.segments[ray].ray.origin
    }
}

/// The ray of `rays` that is in place `ray`, from its start on.
#[inline(always)]
pub(super) fn ray_of(rays: impl Bundle, ray: usize) -> Ray {
    Ray {
        origin: rays.origin(ray),
        direction: rays.direction(ray),
        s_min: 0.0,
    }
}
