//! Emitters: base colours, which need no time, and time-resolved sources.

use super::emission::{Emission, Radiance, Response, SurfacePoint};
use super::light::{Detail, Light};
use super::occlusion::shadow_ray;
use super::run::Run;
use super::stats::{Counter, Meter};
use super::surfaces::Surfaces;
use crate::accel::Segment;
use crate::camera::Departure;
use crate::io::image::Texture;
use crate::light::time_texture::{BATCH, Capture, SurfacePoint as CapturePoint, TimeTexture};
use crate::mesh::Wrap;
use crate::scene::model::Pulse;
use crate::spacetime::Quantity;

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
    pub(super) fn radiance(&self, index: usize, point: &SurfacePoint) -> [f64; 3] {
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

    fn emit<D: Departure, S: Surfaces, M: Meter>(
        &self,
        run: &Run<D, S>,
        light: &mut Light,
        _: &mut M,
    ) {
        light.start(self.response);
        self.fill(run.patch.emitter as usize, run, light);
    }
}

impl Radiance for TimeResolved {
    const HAS_GAPS: bool = true;

    fn emit<D: Departure, S: Surfaces, M: Meter>(
        &self,
        run: &Run<D, S>,
        light: &mut Light,
        meter: &mut M,
    ) {
        let (emitter, response) = &self.emitters[run.patch.emitter as usize];
        light.start(*response);
        match emitter {
            Emitter::Base(colour) => self.base.fill(*colour, run, light),
            Emitter::Uv { cube, set, clock } => {
                look_up(&self.cubes[*cube], *set, *clock, run, light, meter);
            }
            Emitter::Capture {
                cube,
                capture,
                clock,
            } => self.capture(*cube, *capture, *clock, run, light, meter),
            Emitter::Pulses { albedo, pulses } => self.reflect(run, *albedo, pulses, light, meter),
        }
    }
}

/// What `texture` holds at the points of `run`.
fn look_up<D: Departure, S: Surfaces, M: Meter>(
    texture: &TimeTexture,
    set: usize,
    clock: EmissionClock,
    run: &Run<D, S>,
    light: &mut Light,
    meter: &mut M,
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
        let radiance = light.lookups.radiance[..count].iter();
        light
            .radiance
            .extend(radiance.map(|[r, g, b, _]| [*r, *g, *b]));
        let details = light.lookups.others.iter().map(|(at, sampled)| Detail {
            at: begin + at,
            unscaled: sampled.unscaled,
            coverage: sampled.coverage,
            wavelength_scale: 1.0,
        });
        light.details.extend(details);
        if M::ON {
            let bytes = light.lookups.bytes_read(texture, count);
            meter.count(Counter::TextureBytes, bytes);
        }
        begin += count;
    }
}

impl TimeResolved {
    /// What the capture camera recorded of the points of `run`, as far as it saw them. The capture camera rests
    /// in the points' frame, and so does all that can stand between them.
    fn capture<D: Departure, S: Surfaces, M: Meter>(
        &self,
        cube: usize,
        capture: usize,
        clock: EmissionClock,
        run: &Run<D, S>,
        light: &mut Light,
        meter: &mut M,
    ) {
        let (texture, capture) = (&self.cubes[cube], &self.captures[capture]);
        light.located.clear();
        light.segments.clear();
        for point in run.points() {
            let captured = CapturePoint {
                position: point.rest_event().x,
                normal: point.facing_normal(),
            };
            let located = texture.locate(capture, &captured);
            if located.is_seen() {
                let from = captured.position;
                light.segments.push(Segment {
                    ray: shadow_ray(point.local.origin.x, from, capture.eye() - from),
                    s_max: 1.0,
                    skip: Some(point.hit.triangle),
                });
            }
            light.located.push((located, clock.time(&point)));
        }
        light.blocked.clear();
        light.blocked.resize(light.segments.len(), false);
        let (method, tally) = (run.traced.rays.method, meter.occlusion());
        run.rest
            .bvh
            .any_by(method, &light.segments, &mut light.blocked, tally);
        let mut asked = 0;
        for at in 0..light.located.len() {
            let (located, t) = light.located[at];
            let blocked = located.is_seen() && light.blocked[asked];
            asked += usize::from(located.is_seen());
            let sampled = texture.sample_located(capture, &located, t, blocked);
            light.push(Emission::stored(sampled, light.response));
        }
    }
}
