//! Radiance at a hit: what the surface emits at the retarded event, in its own rest frame.
//!
//! [`emitter`](super::emitter) implements it: base colours, which need no time, and
//! time-resolved sources.

use glam::{DVec2, DVec3};

use super::light::Light;
use super::run::Run;
use super::stats::Meter;
use super::surfaces::{Patch, RestFrame, Surfaces};
use crate::accel::Hit;
use crate::camera::{Apart, Departure};
use crate::light::time_texture::{Coverage, Sampled};
use crate::spacetime::{Event, NullRay, Quantity, Rest, World};

/// A point of a surface at the event at which its light leaves for the camera.
#[derive(Debug)]
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
    /// Where it leaves, relative to the event of the shot.
    pub from: Apart,
    /// The same ray in the rest frame.
    pub local: NullRay<Rest>,
}

impl SurfacePoint<'_> {
    /// The emission event in the world.
    #[inline]
    pub fn event(&self) -> Event<World> {
        self.ray.at(self.hit.s)
    }

    /// The emission event in the rest frame.
    #[inline]
    pub fn rest_event(&self) -> Event<Rest> {
        self.local.at(self.hit.s)
    }

    /// Index of the triangle in its object.
    #[inline]
    pub fn primitive(&self) -> u32 {
        self.hit.triangle - self.patch.object_first
    }

    /// The geometric unit normal, in the rest frame, on the side that the camera sees.
    pub fn facing_normal(&self) -> DVec3 {
        let normal = self.rest.bvh.normal(&self.hit);
        if self.hit.front { normal } else { -normal }
    }

    /// Texture coordinates of set `set`, where the object has them.
    pub fn uv(&self, set: usize) -> Option<DVec2> {
        let mesh = self.rest.meshes.get(self.patch.mesh as usize)?;
        mesh.uv(set, self.primitive(), [self.hit.u, self.hit.v])
    }
}

/// Radiance that leaves a surface, per channel, in its rest frame.
#[derive(Debug, Clone, Copy)]
pub struct Emission {
    /// Radiance to which the factors apply.
    pub radiance: [f64; 3],
    /// Radiance that stands for missing data and is shown as it is.
    pub unscaled: [f64; 3],
    /// How much of it the data hold.
    pub coverage: Coverage,
    /// Emitted wavelength over that of the declared line.
    pub wavelength_scale: f64,
    /// What becomes of it at the observer.
    pub response: Response,
}

/// What an observer makes of emitted radiance; resolved from quantity and switches beforehand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// The declared quantity where the searchlight effect is on; its factor is applied.
    pub scaled: Option<Quantity>,
    /// The colour.
    pub colour: Colouring,
}

/// How radiance becomes a colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Colouring {
    /// The channels are colours as they stand.
    Channels,
    /// The mean of the channels is the radiance of a line of this emitted wavelength, metres.
    ShiftedLine(f64),
    /// The same, shown in its emitted colour.
    UnshiftedLine(f64),
}

/// Radiance of surfaces.
pub trait Radiance: Sync {
    /// Whether coverage can be other than full.
    const HAS_GAPS: bool;

    /// What leaves the points of `run` towards the camera, in place of what `light` holds.
    fn emit<D: Departure, S: Surfaces, M: Meter>(
        &self,
        run: &Run<D, S>,
        light: &mut Light,
        meter: &mut M,
    );
}

impl Emission {
    /// Radiance that is fully known.
    pub(super) fn full(radiance: [f64; 3], response: Response) -> Self {
        Emission {
            radiance,
            unscaled: [0.0; 3],
            coverage: Coverage::HELD,
            wavelength_scale: 1.0,
            response,
        }
    }

    /// Radiance from a cube.
    pub(super) fn stored(sampled: Sampled, response: Response) -> Self {
        Emission {
            unscaled: sampled.unscaled,
            coverage: sampled.coverage,
            ..Emission::full(sampled.radiance, response)
        }
    }
}
