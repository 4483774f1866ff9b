//! The nearest hits of a batch so far, and its rays in the rest frame that was intersected last.

use glam::DVec3;

use super::camera_rays::Rays;
use super::cone::VisibleCone;
use super::stats::Meter;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::accel::{Bvh, Hit, NO_SLOT, Origins};
use crate::camera::RayOrigin;
use crate::spacetime::{Boost, Displacement, Event, NullRay, Rest, Tangents, World};

/// A hit and the rest frame that it is in.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceHit {
    /// The hit; its s is the world distance in metres.
    pub hit: Hit,
    /// Index of the rest frame.
    pub frame: u32,
}

/// Buffers of one tile, reused from batch to batch.
#[derive(Debug, Default)]
pub struct HitBuffer {
    /// The nearest hit of each ray; empty if only `alike` is needed.
    hits: Vec<Option<Hit>>,
    /// Runs of consecutive rays that hit the same side of one triangle, or nothing, if known: the end of each run, and its hit.
    alike: Vec<(u32, Option<SurfaceHit>)>,
    /// The rest frame of each hit; empty if all are in the first.
    frames: Vec<u32>,
    /// Index of the medium along each ray.
    indices: Vec<f64>,
    /// Tangents in the frame that was intersected last, and ω_rest/ω_world.
    local: Vec<DVec3>,
    times: Vec<f64>,
    ratios: Vec<f64>,
    /// Rays that may hit something in the frame, with their world directions and hits.
    chosen: Vec<u32>,
    chosen_directions: Vec<DVec3>,
    chosen_hits: Vec<Option<Hit>>,
    /// The origin of each ray in the frame that was intersected last; empty if all leave at one event.
    origins: Vec<DVec3>,
    origin_times: Vec<f64>,
    /// Slots of the triangles of that frame that rays leave; empty if no ray leaves a triangle in any frame.
    left: Vec<u32>,
    /// Rays whose hits that frame has replaced.
    replaced: Vec<usize>,
}

impl HitBuffer {
    /// Makes room for `rays` rays that may hit `frames` rest frames.
    pub(super) fn start(&mut self, rays: usize, frames: usize) {
        self.alike.clear();
        self.hits.clear();
        self.hits.resize(rays, None);
        self.frames.clear();
        if frames > 1 {
            self.frames.resize(rays, 0);
        }
    }

    /// Clears all hits, before hits in several rest frames are added that were found without [`Surfaces::nearest`](super::Surfaces).
    pub(crate) fn clear(&mut self) {
        self.hits.clear();
        self.alike.clear();
        self.frames.clear();
        self.origins.clear();
    }

    /// Adds the hit of the next ray.
    #[inline(always)]
    pub(crate) fn push(&mut self, hit: Option<SurfaceHit>) {
        let before = self.hits.len();
        self.hits.push(hit.map(|found| found.hit));
        self.record_frame(before, hit.map_or(0, |found| found.frame));
    }

    /// Records the rest frame of all hits but the `before` first, if any so far is in another than the first frame.
    #[inline(always)]
    fn record_frame(&mut self, before: usize, frame: u32) {
        if frame != 0 || !self.frames.is_empty() {
            self.frames.resize(before, 0);
            self.frames.resize(self.hits.len(), frame);
        }
    }

    /// Adds the hits of the next `rays` rays, which all hit the same point or nothing.
    #[inline(always)]
    pub(crate) fn push_alike(&mut self, hit: Option<SurfaceHit>, rays: usize) {
        let before = self.hits.len();
        self.push_run(hit, rays);
        self.hits.resize(before + rays, hit.map(|found| found.hit));
        self.record_frame(before, hit.map_or(0, |found| found.frame));
    }

    /// Adds the hits of rays on one triangle, each with its own distance and weights.
    #[inline(always)]
    pub(crate) fn push_places(&mut self, found: SurfaceHit, s: &[f64], [u, v]: [&[f64]; 2]) {
        let before = self.hits.len();
        self.push_run(Some(found), s.len());
        let places = s.iter().zip(u.iter().zip(v));
        let hits = places.map(|(s, (u, v))| Hit {
            s: *s,
            u: *u,
            v: *v,
            ..found.hit
        });
        self.hits.extend(hits.map(Some));
        self.record_frame(before, found.frame);
    }

    /// Removes the hits of some rays, after all hits have been added.
    pub(crate) fn remove(&mut self, rays: impl Iterator<Item = usize>) {
        // Runs of equal hits no longer hold.
        for ray in rays {
            self.hits[ray] = None;
            if let Some(frame) = self.frames.get_mut(ray) {
                *frame = 0;
            }
            self.alike.clear();
        }
    }

    /// The same as [`HitBuffer::push_alike`] for a buffer in which hits of single rays are not needed.
    #[inline(always)]
    pub(crate) fn push_run(&mut self, hit: Option<SurfaceHit>, rays: usize) {
        let begin = self.alike.last().map_or(0, |(end, _)| *end);
        self.alike.push((begin + rays as u32, hit));
    }

    /// The ends and hits of runs of consecutive rays that hit the same side of one triangle; empty if not known.
    pub(super) fn alike(&self) -> &[(u32, Option<SurfaceHit>)] {
        &self.alike
    }

    /// Sets the distance of the hit of ray `ray`.
    pub(crate) fn set_distance(&mut self, ray: usize, s: f64) {
        if let Some(hit) = &mut self.hits[ray] {
            hit.s = s;
        }
    }

    /// Chooses those of the rays along `directions` that are within `cone`, and returns their number.
    pub(super) fn choose(&mut self, cone: &VisibleCone, directions: &[DVec3]) -> usize {
        cone.choose(directions, &mut self.chosen);
        self.chosen.len()
    }

    /// Boosts the tangents of the chosen ones of `rays`, which share their origin, into a rest frame.
    pub(super) fn boost_chosen(&mut self, boost: &Boost<Rest, World>, index: f64, rays: &Rays) {
        let chosen = self.chosen.iter().map(|ray| *ray as usize);
        self.chosen_directions.clear();
        self.chosen_directions
            .extend(chosen.map(|ray| rays.directions[ray]));
        self.indices.clear();
        self.indices.resize(self.chosen.len(), index);
        let directions = std::mem::take(&mut self.chosen_directions);
        self.boost_directions(boost, &directions);
        self.chosen_directions = directions;
    }

    /// Intersects the chosen rays, which were boosted last, as [`HitBuffer::intersect`] does with all rays.
    pub(super) fn intersect_chosen(
        &mut self,
        frame: u32,
        bvh: &Bvh,
        rays: &Rays,
        origin: DVec3,
        meter: &mut Meter,
    ) {
        let HitBuffer {
            hits,
            frames,
            local,
            chosen,
            chosen_hits,
            replaced,
            ..
        } = self;
        chosen_hits.clear();
        chosen_hits.extend(chosen.iter().map(|ray| hits[*ray as usize]));
        // Where there is one rest frame, no record is kept of which was hit.
        replaced.clear();
        let wanted = (!frames.is_empty()).then_some(&mut *replaced);
        let (method, from) = (rays.method, Origins::Shared(origin));
        let counts = meter.visibility();
        bvh.closest_by(method, from, local, chosen_hits, counts, wanted);
        for k in replaced {
            frames[chosen[*k] as usize] = frame;
        }
        for (ray, hit) in chosen.iter().zip(chosen_hits) {
            hits[*ray as usize] = *hit;
        }
    }

    /// Boosts the tangents of `rays` into a rest frame.
    pub(super) fn boost_tangents(&mut self, boost: &Boost<Rest, World>, index: f64, rays: &Rays) {
        let count = rays.directions.len();
        self.indices.clear();
        self.indices
            .extend((0..count).map(|ray| rays.index(index, ray)));
        self.boost_directions(boost, rays.directions);
    }

    /// Boosts the tangents along `directions`, with their indices of the medium.
    fn boost_directions(&mut self, boost: &Boost<Rest, World>, directions: &[DVec3]) {
        let count = directions.len();
        self.local.resize(count, DVec3::ZERO);
        self.times.resize(count, 0.0);
        self.ratios.resize(count, 0.0);
        dispatch(BoostTangents {
            boost,
            indices: &self.indices,
            directions,
            tangents: Tangents {
                space: &mut self.local,
                time: &mut self.times,
                ratio: &mut self.ratios,
            },
        });
    }

    /// Boosts the origins of `rays`, which are relative to `shot`, into a rest frame.
    pub(super) fn boost_origins(
        &mut self,
        boost: &Boost<Rest, World>,
        shot: Event<Rest>,
        rays: &Rays,
    ) {
        let origins = rays.origins.unwrap_or_default();
        self.origins.resize(origins.len(), DVec3::ZERO);
        self.origin_times.resize(origins.len(), 0.0);
        if !origins.is_empty() {
            dispatch(BoostOrigins {
                boost,
                shot,
                origins,
                places: &mut self.origins,
                times: &mut self.origin_times,
            });
        }
    }

    /// Intersects `rays` with the surfaces of `frame`, from `origin` if they share one, along `directions` or, without these, along the
    /// tangents that were boosted last. Keeps the hits that are nearer than those so far.
    pub(super) fn intersect(
        &mut self,
        frame: u32,
        bvh: &Bvh,
        rays: &Rays,
        origin: DVec3,
        directions: Option<&[DVec3]>,
        meter: &mut Meter,
    ) {
        let HitBuffer {
            hits,
            frames,
            replaced,
            ..
        } = self;
        // As above.
        replaced.clear();
        let wanted = (!frames.is_empty()).then_some(&mut *replaced);
        let origins = match self.origins.as_slice() {
            [] => Origins::Shared(origin),
            origins if rays.left.is_empty() => Origins::Each(origins),
            origins => {
                // A slot has a meaning only in the frame of the triangle that the ray leaves.
                self.left.clear();
                self.left
                    .extend(rays.left.iter().map(|left| match left.frame == frame {
                        true => left.slot,
                        false => NO_SLOT,
                    }));
                let slots = &self.left;
                Origins::Leaving { origins, slots }
            }
        };
        let directions = directions.unwrap_or(&self.local);
        let counts = meter.visibility();
        bvh.closest_by(rays.method, origins, directions, hits, counts, wanted);
        for ray in replaced {
            frames[*ray] = frame;
        }
    }

    /// Ray `ray` in the frame into which rays were boosted last, and ω_rest/ω_world of its light.
    #[inline(always)]
    pub(super) fn boosted(&self, ray: usize, origin: Event<Rest>) -> (NullRay<Rest>, f64) {
        let boosted = NullRay {
            origin: self.origin(ray, origin),
            tangent: Displacement::new(self.times[ray], self.local[ray]),
        };
        (boosted, self.ratios[ray])
    }

    /// The tangents of all rays in that frame.
    #[inline(always)]
    pub(super) fn tangents(&self) -> &[DVec3] {
        &self.local
    }

    /// ω_rest/ω_world of the light of all rays in that frame.
    #[inline(always)]
    pub(super) fn ratios(&self) -> &[f64] {
        &self.ratios
    }

    /// The event at which ray `ray` leaves in that frame; `origin` if all rays leave at one event.
    #[inline(always)]
    pub(super) fn origin(&self, ray: usize, origin: Event<Rest>) -> Event<Rest> {
        match self.origins.get(ray) {
            Some(place) => Event::new(self.origin_times[ray], *place),
            None => origin,
        }
    }

    /// The nearest hit of each ray of the batch, except those added by [`push_run`](Self::push_run).
    #[inline]
    pub fn hits(&self) -> &[Option<Hit>] {
        &self.hits
    }

    /// The nearest hit of ray `ray`.
    #[inline]
    pub fn hit(&self, ray: usize) -> Option<SurfaceHit> {
        self.hits[ray].map(|hit| SurfaceHit {
            hit,
            frame: self.frame(ray),
        })
    }

    /// The rest frame that ray `ray` hit.
    #[inline(always)]
    pub(super) fn frame(&self, ray: usize) -> u32 {
        self.frames.get(ray).copied().unwrap_or(0)
    }
}

/// The loop over directions.
struct BoostTangents<'a> {
    boost: &'a Boost<Rest, World>,
    indices: &'a [f64],
    directions: &'a [DVec3],
    tangents: Tangents<'a>,
}

impl VectorLoop for BoostTangents<'_> {
    #[inline(always)]
    fn run(self) {
        self.boost
            .tangents(self.indices, self.directions, self.tangents);
    }
}

/// The loop over origins.
struct BoostOrigins<'a> {
    boost: &'a Boost<Rest, World>,
    shot: Event<Rest>,
    origins: &'a [RayOrigin],
    places: &'a mut [DVec3],
    times: &'a mut [f64],
}

impl VectorLoop for BoostOrigins<'_> {
    #[inline(always)]
    fn run(self) {
        boost_origins(self.boost, self.shot, self.origins, self.places, self.times);
    }
}

#[inline(always)]
fn boost_origins(
    boost: &Boost<Rest, World>,
    shot: Event<Rest>,
    origins: &[RayOrigin],
    places: &mut [DVec3],
    times: &mut [f64],
) {
    let count = origins.len();
    let (places, times) = (&mut places[..count], &mut times[..count]);
    // E′ = E′_shot + Λ ΔE; boosts are linear.
    for k in 0..count {
        let event = shot + boost.displacement(origins[k].displacement);
        places[k] = event.x;
        times[k] = event.ct;
    }
}
