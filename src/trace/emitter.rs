//! Emitters: base colours, which need no time, and time-resolved sources.

use glam::{DVec2, DVec3};

use super::emission::{Emission, Radiance, Response, SurfacePoint};
use super::surfaces::{Surfaces, shadow_ray};
use crate::image::Texture;
use crate::mesh::Wrap;
use crate::scene::model::Pulse;
use crate::spacetime::Quantity;
use crate::time_texture::{Capture, Sampled, SurfacePoint as CapturePoint, TimeTexture};

/// Time-independent radiance: a factor and a texture.
#[derive(Debug, Clone)]
pub struct BaseColour {
    /// Linear RGB.
    pub factor: [f64; 3],
    /// Texture, its coordinate set and wrap modes.
    pub texture: Option<(usize, usize, [Wrap; 2])>,
}

/// Base colours of all patches.
#[derive(Debug)]
pub struct BaseColours {
    /// By emitter index.
    pub colours: Vec<BaseColour>,
    /// Decoded textures.
    pub textures: Vec<Texture>,
    /// The common response.
    pub response: Response,
}

/// All kinds of emitters, some of which vary with time.
#[derive(Debug)]
pub struct TimeResolved {
    /// By emitter index.
    pub emitters: Vec<(Emitter, Response)>,
    /// Base colours (also albedos of pulses).
    pub base: BaseColours,
    /// Cubes with their time axes.
    pub cubes: Vec<TimeTexture>,
    /// Capture cameras and what they saw.
    pub captures: Vec<Capture>,
    /// By source of the scene: pulses, each with its quantity.
    pub pulses: Vec<Option<(Pulse, Quantity)>>,
    /// Refractive index of the medium.
    pub index: f64,
}

/// Where the radiance of a patch comes from.
#[derive(Debug, Clone)]
pub enum Emitter {
    /// A base colour.
    Base(usize),
    /// A cube by texture coordinates.
    Uv {
        /// Index of the cube.
        cube: usize,
        /// TEXCOORD set.
        set: usize,
        /// The clock of its time axis.
        clock: EmissionClock,
    },
    /// A cube projected from its capture camera.
    Capture {
        /// Index of the cube.
        cube: usize,
        /// Index of the capture camera.
        capture: usize,
        /// The clock before the delay to the capture camera.
        clock: EmissionClock,
    },
    /// The light of pulses, reflected.
    Pulses {
        /// Index of the albedo among the base colours.
        albedo: usize,
        /// Which pulses.
        pulses: Vec<usize>,
    },
}

/// A clock at the emission event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EmissionClock {
    /// World time.
    World,
    /// The own time of the object that the point is on.
    Object,
}

impl EmissionClock {
    #[inline]
    fn time(self, point: &SurfacePoint) -> f64 {
        match self {
            EmissionClock::World => point.event().ct,
            EmissionClock::Object => point.rest_event().ct - point.patch.object_origin.ct,
        }
    }
}

impl BaseColours {
    fn radiance(&self, index: usize, point: &SurfacePoint) -> [f64; 3] {
        let base = &self.colours[index];
        let Some((texture, set, wrap)) = base.texture else {
            return base.factor;
        };
        let Some(uv) = point.uv(set) else {
            return base.factor;
        };
        let texel = self.textures[texture].sample(uv.to_array(), wrap);
        std::array::from_fn(|c| base.factor[c] * texel[c])
    }
}

impl Radiance for BaseColours {
    const HAS_GAPS: bool = false;

    #[inline]
    fn emission<S: Surfaces>(&self, _: &S, point: &SurfacePoint) -> Emission {
        Emission::full(
            self.radiance(point.patch.emitter as usize, point),
            self.response,
        )
    }
}

impl Radiance for TimeResolved {
    const HAS_GAPS: bool = true;

    fn emission<S: Surfaces>(&self, surfaces: &S, point: &SurfacePoint) -> Emission {
        let (emitter, response) = &self.emitters[point.patch.emitter as usize];
        match emitter {
            Emitter::Base(colour) => Emission::full(self.base.radiance(*colour, point), *response),
            Emitter::Uv { cube, set, clock } => {
                let uv = point.uv(*set).unwrap_or(DVec2::NAN);
                Emission::stored(
                    self.cubes[*cube].sample_uv(uv, clock.time(point)),
                    *response,
                )
            }
            Emitter::Capture {
                cube,
                capture,
                clock,
            } => Emission::stored(
                self.captured(*cube, *capture, clock.time(point), point),
                *response,
            ),
            Emitter::Pulses { albedo, pulses } => {
                let albedo = self.base.radiance(*albedo, point);
                let (irradiance, wavelength_scale) = self.irradiance(surfaces, pulses, point);
                let radiance =
                    std::array::from_fn(|c| albedo[c] * irradiance[c] / std::f64::consts::PI);
                Emission {
                    wavelength_scale,
                    ..Emission::full(radiance, *response)
                }
            }
        }
    }
}

impl TimeResolved {
    /// What the capture camera recorded of `point`, as far as it saw it. The capture camera rests in
    /// the point's frame, and so does all that can stand between them.
    fn captured(&self, cube: usize, capture: usize, t: f64, point: &SurfacePoint) -> Sampled {
        let captured = CapturePoint {
            position: point.rest_event().x,
            normal: point.facing_normal(),
        };
        let occluded = |from: DVec3, eye: DVec3| {
            let ray = shadow_ray(point.local.origin.x, from, eye - from);
            point.rest.bvh.any(&ray, 1.0, Some(point.hit.triangle))
        };
        self.cubes[cube].sample_capture(&self.captures[capture], &captured, t, occluded)
    }
}
