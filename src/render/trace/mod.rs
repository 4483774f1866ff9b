//! Tracing a batch: one sample of every pixel of a tile.
//!
//! Camera ray → nearest hit over all rest frames → retarded event → radiance × factor. The rays of a batch are coherent, and the rays of a
//! point camera share one origin event. Each stage processes the whole batch, in plain loops for the widest vectors:
//!
//! ```text
//! camera rays → hits (boosts, nearest hits) → shading: runs of points of one patch
//!                                             → emit (lookups, shadows, all of a run together) → factors → film
//! ```
//!
//! The kinds of cameras, surfaces and [`Radiance`] are matched once per batch or run, so that loops over rays contain no such branches.
//! Buffers are reused from batch to batch: nothing is allocated per ray.

mod alpha_masks;
mod area_draws;
mod area_lights;
mod base_colours;
mod blend;
mod camera_rays;
mod captures;
mod channels;
mod cone;
mod custom;
mod emitted;
mod footprint;
mod hits;
mod lamp_light;
mod lamps;
mod light_tree;
mod occlusion;
mod onward;
mod paths;
mod point_columns;
mod radiance;
mod rest_frame;
mod run;
mod shading;
mod shadows;
mod shared_paths;
mod sharing;
mod shining_frames;
mod sky_light;
mod spectral;
mod spectral_points;
mod spherical_triangle;
mod stats;
mod surface_point;
mod surfaces;
mod time_resolved;
mod timed_paths;
mod tubes;

pub(crate) use alpha_masks::{AlphaMask, AlphaMasks, MaskedRun};
pub(crate) use area_lights::{AreaLights, Element};
pub use base_colours::Dependence;
pub(crate) use base_colours::{BaseColour, BaseColours, Finish, Glass, Gloss, TextureLookup};
pub(crate) use camera_rays::{CameraRays, Cells, Rays, TIME, generator};
pub(crate) use channels::record;
pub(crate) use custom::CustomRadiance;
pub use emitted::{Colouring, Emission, Emitted, Eye, Response, Scaling};
pub(crate) use hits::{HitBuffer, SurfaceHit};
pub(crate) use paths::PathTraced;
pub use radiance::Radiance;
pub(crate) use rest_frame::{BuildPlaceHasher, SharedVertices};
pub use rest_frame::{Patch, RestFrame};
pub use run::Run;
pub(crate) use run::TracedRays;
pub use shading::{Background, SkySpectra};
pub(crate) use shading::{RadianceSink, Shading, weigh};
pub(crate) use sharing::AT_ONCE;
pub(crate) use sky_light::SkyLight;
pub(crate) use spectral::SampledSpectra;
pub(crate) use stats::Counter;
pub use stats::{Meter, Stage, Stats};
pub(crate) use surface_point::ObservedPoint;
pub use surface_point::{EmissionClock, SurfacePoint};
pub(crate) use surfaces::Surfaces;
pub(crate) use time_resolved::{CapturedCube, Emitter, TimeResolved};
pub(crate) use timed_paths::{Start, TimedPaths, Viewpoint};
