//! Radiance at a hit: what the surface emits at the retarded event, in its own rest frame.
//!
//! Two implementations: base colours, which need no time, and time-resolved sources.
//!
//! A pulse from a point at rest in the world sends I(t) per solid angle. At a surface point met at
//! event E, the light left the source at E.ct − ηr, r the world distance. In the surface's rest
//! frame, with ρ = ω_rest/ω_world of that light and θ′ the angle of incidence there,
//!
//! ```text
//! E′ = I(E.ct − ηr) ρ^(p−2) cos θ′ / r²,      L′ = albedo E′ / π,
//! ```
//!
//! since radiance scales with ρᵖ and solid angle with ρ⁻² (p by the declared quantity). A line of
//! wavelength λ₀ arrives, and leaves again, with λ₀/ρ.

use glam::{DVec2, DVec3};

use super::surfaces::{Patch, RestFrame, Surfaces, shadow_ray};
use crate::accel::Hit;
use crate::image::Texture;
use crate::mesh::Wrap;
use crate::scene::model::Pulse;
use crate::spacetime::{Direction, Event, NullRay, Quantity, Rest, WavelengthRatio, World};
use crate::time_texture::{Capture, Coverage, Sampled, SurfacePoint as CapturePoint, TimeTexture};

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

    /// The look direction of the camera's ray.
    fn seen_along(&self) -> Direction<World> {
        Direction::from_unit(self.ray.tangent.x)
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

    /// What leaves `point` towards the camera.
    fn emission<S: Surfaces>(&self, surfaces: &S, point: &SurfacePoint) -> Emission;
}

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

impl Emission {
    fn full(radiance: [f64; 3], response: Response) -> Self {
        Emission {
            radiance,
            unscaled: [0.0; 3],
            coverage: Coverage::HELD,
            wavelength_scale: 1.0,
            response,
        }
    }

    fn stored(sampled: Sampled, response: Response) -> Self {
        Emission {
            unscaled: sampled.unscaled,
            coverage: sampled.coverage,
            ..Emission::full(sampled.radiance, response)
        }
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

    /// Irradiance of `pulses` on `point` in its rest frame, and the wavelength at which it arrives
    /// over that of the source (weighted by irradiance where several pulses meet).
    fn irradiance<S: Surfaces>(
        &self,
        surfaces: &S,
        pulses: &[usize],
        point: &SurfacePoint,
    ) -> ([f64; 3], f64) {
        let mut sum = [0.0; 3];
        let (mut weight, mut weighted) = (0.0, 0.0);
        for (pulse, quantity) in pulses.iter().filter_map(|k| self.pulses[*k].as_ref()) {
            let Some(light) = self.incident(surfaces, pulse, *quantity, point) else {
                continue;
            };
            for (sum, part) in sum.iter_mut().zip(light.irradiance) {
                *sum += part;
                weight += part;
                weighted += part * light.wavelength_scale;
            }
        }
        (sum, if weight > 0.0 { weighted / weight } else { 1.0 })
    }

    /// The light of one pulse on the side of the surface that faces the camera.
    fn incident<S: Surfaces>(
        &self,
        surfaces: &S,
        pulse: &Pulse,
        quantity: Quantity,
        point: &SurfacePoint,
    ) -> Option<Incident> {
        // By way of the camera's event, so that far from the world's origin no digits are lost.
        let camera = Event::ORIGIN + (point.ray.origin - pulse.origin);
        let way = camera + point.ray.tangent * point.hit.s;
        let (to_source, since) = (-way.x, way.ct);
        let r = to_source.length();
        let strength = gaussian((since - self.index * r) / pulse.sigma) / pulse.sigma;
        let d = Direction::<World>::new(to_source)?;
        let (d_rest, rho) = surfaces.turned(point.frame, d);
        let cosine = point.facing_normal().dot(d_rest.unit());
        if strength == 0.0 || cosine <= 0.0 {
            return None;
        }
        let skip = (point.frame, point.hit.triangle);
        let from = (point.seen_along(), point.hit.s);
        if pulse.shadows && surfaces.occluded(from, d, self.index, r, skip) {
            return None;
        }
        let w = WavelengthRatio(1.0 / rho);
        let factor = strength * quantity.irradiance_factor(w) * cosine / (r * r);
        Some(Incident {
            irradiance: pulse.intensity.map(|i| i * factor),
            wavelength_scale: w.0,
        })
    }
}

/// Light that falls on a surface.
struct Incident {
    irradiance: [f64; 3],
    wavelength_scale: f64,
}

/// The unit Gaussian; 0 where it is below the smallest f64 that matters (|x| > 8: 5·10⁻¹⁵).
fn gaussian(x: f64) -> f64 {
    if x.abs() > 8.0 {
        return 0.0;
    }
    libm::exp(-0.5 * x * x) / (std::f64::consts::TAU).sqrt()
}
