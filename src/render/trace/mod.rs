//! One sample: event → null ray → nearest hit over all rest frames → retarded event → radiance × factor.
//!
//! A [`Pipeline`] is put together from the plan: which [`View`](crate::camera::View), which [`Surfaces`], which
//! [`Radiance`] and which recorder of auxiliary channels. Each combination of those beyond the view, which
//! is asked once per batch, is compiled for itself, so that a scene pays nothing for what it does not need.
//!
//! Rays go in batches: one sample of every pixel of a tile, which share the camera's event and are
//! coherent. Each stage goes over the whole batch, in plain loops for the widest vectors:
//!
//! ```text
//! looks → scratch (boosts, nearest hits) → develop: runs of points of one patch
//!                                          → emit (lookups, shadows, all of a run together) → factors → film
//! ```
//!
//! Buffers are kept from batch to batch: nothing is allocated for a ray.

mod develop;
mod emission;
mod emitter;
mod light;
mod looks;
mod occlusion;
mod pulse;
mod reach;
mod record;
mod run;
mod scratch;
mod stats;
mod surfaces;

pub use develop::{Developer, Exposed};
pub use emission::{Colouring, Emission, Radiance, Response, SurfacePoint};
pub use emitter::{BaseColour, BaseColours, EmissionClock, Emitter, TimeResolved};
pub use light::{Detail, Light};
pub use looks::{Aim, Looks};
pub use occlusion::{Question, Questions};
pub use record::{AovRecorder, NoAovs, Recorder, Seen};
pub use run::{Run, Traced};
pub use scratch::Scratch;
pub use stats::{Counter, Meter, Stage, Stats, Unmetered};
pub use surfaces::{Found, Frames, Moving, Patch, Rays, RestFrame, Still, Surfaces};

use crate::accel::Method;
use crate::camera::Departure;
use crate::render::film::{Tile, TileFilm};
use crate::render::sampler::Sampler;
use crate::spacetime::{Direction, Event, World};

/// Everything that turns film points into radiance; rays leave as `D` says.
pub struct Pipeline<'a, D, S, R> {
    /// Film point → world direction and W.
    pub view: &'a dyn Aim<D>,
    /// Ray → nearest hit.
    pub surfaces: S,
    /// Hit → emitted radiance.
    pub radiance: &'a R,
    /// The event from which all rays leave.
    pub event: Event<World>,
    /// Refractive index that delays the rays; 0 where retardation is turned off.
    pub index: f64,
    /// Observed radiance of rays that meet nothing.
    pub background: [f64; 3],
    /// Where samples lie in a pixel.
    pub sampler: Sampler,
    /// How rays are traced.
    pub method: Method,
}

/// Buffers of one thread's tile.
#[derive(Debug)]
pub struct Buffers<D> {
    looks: Looks<D>,
    scratch: Scratch,
    developer: Developer,
}

impl<D> Default for Buffers<D> {
    fn default() -> Self {
        Buffers {
            looks: Looks::default(),
            scratch: Scratch::default(),
            developer: Developer::default(),
        }
    }
}

impl<D: Departure, S: Surfaces, R: Radiance> Pipeline<'_, D, S, R> {
    /// Renders sample `index` of every pixel of `tile`.
    pub fn sample<A: Recorder, M: Meter>(
        &self,
        tile: Tile,
        index: u32,
        recorder: &A,
        buffers: &mut Buffers<D>,
        film: &mut TileFilm,
        meter: &mut M,
    ) {
        meter.start();
        let Buffers {
            looks,
            scratch,
            developer,
        } = buffers;
        self.view.aim(looks, &self.sampler, tile, index);
        meter.lap(Stage::Looks);
        let rays = Rays {
            directions: &looks.directions,
            from: &looks.from,
            method: self.method,
        };
        self.surfaces.nearest(rays, scratch, meter);
        let traced = Traced {
            surfaces: &self.surfaces,
            rays,
            scratch,
            event: self.event,
            index: self.index,
        };
        let (background, ratios) = (self.background, &looks.ratios);
        developer.develop(self.radiance, &traced, background, ratios, film, meter);
        if A::RECORDS {
            record(looks, &traced, recorder, film);
        }
        meter.count(Counter::Rays, tile.pixels() as u64);
        meter.lap(Stage::Film);
    }
}

/// Records auxiliary channels of samples that looked along `looks`.
fn record<D: Departure, S: Surfaces, A: Recorder>(
    looks: &Looks<D>,
    traced: &Traced<D, S>,
    recorder: &A,
    film: &mut TileFilm,
) {
    for (ray, ratio) in looks.ratios.iter().enumerate() {
        let sees = D::TOGETHER || looks.from[ray].into().sees();
        let seen = traced.seen(ray, *ratio).filter(|_| sees);
        let d = Direction::from_unit(looks.directions[ray]);
        recorder.record(ray, looks.offset(ray), d, seen.as_ref(), film);
    }
}
