//! Points of surfaces that rays hit.

use glam::{DVec2, DVec3};

use super::rest_frame::{Patch, RestFrame};
use crate::accel::Hit;
use crate::camera::RayOrigin;
use crate::spacetime::{Event, NullRay, Rest, WavelengthRatio, World};

/// A point of a surface at the event at which its light leaves for the camera.
#[derive(Debug)]
#[non_exhaustive]
pub struct SurfacePoint<'a> {
    /// The rest frame.
    pub rest: &'a RestFrame,
    /// Its index.
    pub frame: u32,
    /// The run of triangles.
    pub patch: &'a Patch,
    /// The hit.
    pub hit: Hit,
    /// The world ray.
    pub ray: NullRay<World>,
    /// The origin of the ray, relative to the event of the shot.
    pub origin: RayOrigin,
    /// The same ray in the rest frame.
    pub local: NullRay<Rest>,
}

/// A surface point and the wavelength ratio at which the camera sees it.
#[derive(Debug)]
pub struct ObservedPoint<'a> {
    /// The point.
    pub point: SurfacePoint<'a>,
    /// Observed / emitted wavelength.
    pub w: WavelengthRatio,
}

impl SurfacePoint<'_> {
    /// The emission event in the world's frame, with the scene's own origin.
    #[inline]
    pub fn event(&self) -> Event<World> {
        self.ray.at(self.hit.s)
    }

    /// The emission event in the rest frame of the object: the world's axes, boosted without rotation by its velocity. All objects with one
    /// velocity share that frame, whose origin is that of the first of them in the scene
    /// ([`Object::origin`](crate::scene::model::Object::origin)). On the object's own clock and from its own origin the event is
    /// `rest_event() - patch.object_origin`, as in the channels `object_event`.
    #[inline]
    pub fn rest_event(&self) -> Event<Rest> {
        self.local.at(self.hit.s)
    }

    /// Index of the triangle in its object's mesh.
    #[inline]
    pub fn primitive(&self) -> u32 {
        self.hit.triangle - self.patch.object_first
    }

    /// The geometric unit normal, in the rest frame, on the side that the camera sees.
    #[inline]
    pub fn facing_normal(&self) -> DVec3 {
        let normal = self.rest.bvh.normal(&self.hit);
        if self.hit.front { normal } else { -normal }
    }

    /// Texture coordinates of set `set`, if the object has them.
    pub fn uv(&self, set: usize) -> Option<DVec2> {
        self.rest.uv(self.patch, set, &self.hit)
    }
}

/// A clock at the emission event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EmissionClock {
    /// World time.
    World,
    /// The proper time of the point's object.
    Object,
}

impl EmissionClock {
    /// The time of emission at a point.
    pub(crate) fn time(self, point: &SurfacePoint) -> f64 {
        match self {
            EmissionClock::World => point.event().ct,
            EmissionClock::Object => point.rest_event().ct - point.patch.object_origin.ct,
        }
    }
}
