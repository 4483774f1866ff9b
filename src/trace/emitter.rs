//! Emitters: base colours, which need no time, and time-resolved sources.

use glam::DVec3;

use super::emission::{Emission, Radiance, Response, SurfacePoint};
use super::light::{Detail, Light};
use super::run::Run;
use super::surfaces::{Surfaces, shadow_ray};
use crate::camera::Departure;
use crate::image::Texture;
use crate::mesh::Wrap;
use crate::scene::model::Pulse;
use crate::spacetime::Quantity;
use crate::time_texture::{BATCH, Capture, Sampled, SurfacePoint as CapturePoint, TimeTexture};

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
    /// At member `k` of `run`, whose hit is at `s`.
    #[inline(always)]
    fn time_of<D: Departure, S: Surfaces>(self, run: &Run<D, S>, k: usize, s: f64) -> f64 {
        match self {
            EmissionClock::World => run.world_time(k, s),
            EmissionClock::Object => run.object_time(k, s),
        }
    }

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

impl BaseColours {
    /// What colour `index` emits at the points of `run`.
    fn fill<D: Departure, S: Surfaces>(&self, index: usize, run: &Run<D, S>, light: &mut Light) {
        match self.colours[index].texture {
            None => light
                .radiance
                .resize(run.members.len(), self.colours[index].factor),
            Some(_) => light
                .radiance
                .extend(run.points().map(|point| self.radiance(index, &point))),
        }
    }
}

impl Radiance for BaseColours {
    const HAS_GAPS: bool = false;

    fn emit<D: Departure, S: Surfaces>(&self, run: &Run<D, S>, light: &mut Light) {
        light.start(self.response);
        self.fill(run.patch.emitter as usize, run, light);
    }
}

impl Radiance for TimeResolved {
    const HAS_GAPS: bool = true;

    fn emit<D: Departure, S: Surfaces>(&self, run: &Run<D, S>, light: &mut Light) {
        let (emitter, response) = &self.emitters[run.patch.emitter as usize];
        light.start(*response);
        match emitter {
            Emitter::Base(colour) => self.base.fill(*colour, run, light),
            Emitter::Uv { cube, set, clock } => {
                look_up(&self.cubes[*cube], *set, *clock, run, light);
            }
            Emitter::Capture {
                cube,
                capture,
                clock,
            } => {
                for point in run.points() {
                    let t = clock.time(&point);
                    let sampled = self.captured(*cube, *capture, t, &point);
                    light.push(Emission::stored(sampled, *response));
                }
            }
            Emitter::Pulses { albedo, pulses } => {
                for point in run.points() {
                    let albedo = self.base.radiance(*albedo, &point);
                    light.push(self.reflected(run.traced.surfaces, albedo, pulses, &point));
                }
            }
        }
    }
}

/// What `texture` holds at the points of `run`.
fn look_up<D: Departure, S: Surfaces>(
    texture: &TimeTexture,
    set: usize,
    clock: EmissionClock,
    run: &Run<D, S>,
    light: &mut Light,
) {
    let mut begin = 0;
    while begin < run.members.len() {
        let count = (run.members.len() - begin).min(BATCH);
        for at in 0..count {
            let Some(hit) = run.hit(begin + at) else {
                continue;
            };
            let uv = run.uv(set, &hit);
            light.lookups.u[at] = uv.x;
            light.lookups.v[at] = uv.y;
            light.lookups.t[at] = clock.time_of(run, begin + at, hit.s);
        }
        texture.sample_each(&mut light.lookups, count);
        light
            .radiance
            .extend_from_slice(&light.lookups.radiance[..count]);
        let details = light.lookups.others.iter().map(|(at, sampled)| Detail {
            at: begin + at,
            unscaled: sampled.unscaled,
            coverage: sampled.coverage,
            wavelength_scale: 1.0,
        });
        light.details.extend(details);
        begin += count;
    }
}

impl TimeResolved {
    /// The light of pulses that `point` reflects.
    fn reflected<S: Surfaces>(
        &self,
        surfaces: &S,
        albedo: [f64; 3],
        pulses: &[usize],
        point: &SurfacePoint,
    ) -> Emission {
        let (_, response) = &self.emitters[point.patch.emitter as usize];
        let (irradiance, wavelength_scale) = self.irradiance(surfaces, pulses, point);
        let radiance = std::array::from_fn(|c| albedo[c] * irradiance[c] / std::f64::consts::PI);
        Emission {
            wavelength_scale,
            ..Emission::full(radiance, *response)
        }
    }

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
