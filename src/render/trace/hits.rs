//! The nearest hits of a batch so far, and its rays in the last rest frame that was intersected.

use glam::DVec3;

use super::camera_rays::Rays;
use super::cone::VisibleCone;
use super::stats::Meter;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::accel::{Bvh, Hit, NO_SLOT, NoTally, Origins};
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
    /// The nearest hit of each ray; empty where nobody asks for more than `alike` says.
    hits: Vec<Option<Hit>>,
    /// Rays in a row that hit one side of one triangle, or nothing, where that is known: where they end, and what they hit.
    alike: Vec<(u32, Option<SurfaceHit>)>,
    /// Its rest frame; empty where there is one.
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
    /// Where each ray leaves, in the frame that was intersected last; empty where all leave one event.
    origins: Vec<DVec3>,
    origin_times: Vec<f64>,
    /// Places of the triangles of that frame that rays leave; empty where they leave none of any frame.
    left: Vec<u32>,
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

    /// Forgets all hits, and begins to take those of several rest frames over that were found without
    /// [`Surfaces::nearest`](super::Surfaces).
    pub(crate) fn clear(&mut self) {
        self.hits.clear();
        self.alike.clear();
        self.frames.clear();
        self.origins.clear();
    }

    /// Takes over what the next ray hits.
    #[inline(always)]
    pub(crate) fn push(&mut self, hit: Option<SurfaceHit>) {
        self.hits.push(hit.map(|found| found.hit));
        self.frames.push(hit.map_or(0, |found| found.frame));
    }

    /// Takes over what the next `rays` rays hit, all of them at the same place or at nothing.
    #[inline(always)]
    pub(crate) fn push_alike(&mut self, hit: Option<SurfaceHit>, rays: usize) {
        let count = self.hits.len() + rays;
        self.push_run(hit, rays);
        self.hits.resize(count, hit.map(|found| found.hit));
        self.frames
            .resize(count, hit.map_or(0, |found| found.frame));
    }

    /// The same for rays that hit one triangle, each at its own distance and weights.
    #[inline(always)]
    pub(crate) fn push_places(&mut self, found: SurfaceHit, s: &[f64], [u, v]: [&[f64]; 2]) {
        self.push_run(Some(found), s.len());
        let places = s.iter().zip(u.iter().zip(v));
        let hits = places.map(|(s, (u, v))| Hit {
            s: *s,
            u: *u,
            v: *v,
            ..found.hit
        });
        self.hits.extend(hits.map(Some));
        self.frames.resize(self.hits.len(), found.frame);
    }

    /// Says that some rays hit nothing after all, when all have been taken over.
    pub(crate) fn remove(&mut self, rays: impl Iterator<Item = usize>) {
        for ray in rays {
            (self.hits[ray], self.frames[ray]) = (None, 0);
            self.alike.clear();
        }
    }

    /// The same in a buffer of which nobody asks what a single ray hits.
    #[inline(always)]
    pub(crate) fn push_run(&mut self, hit: Option<SurfaceHit>, rays: usize) {
        let begin = self.alike.last().map_or(0, |(end, _)| *end);
        self.alike.push((begin + rays as u32, hit));
    }

    /// Where rays in a row that hit one side of one triangle end, and what they hit; empty where that is not known.
    pub(super) fn alike(&self) -> &[(u32, Option<SurfaceHit>)] {
        &self.alike
    }

    /// Says how far the hit of ray `ray` is.
    pub(crate) fn set_distance(&mut self, ray: usize, s: f64) {
        if let Some(hit) = &mut self.hits[ray] {
            hit.s = s;
        }
    }

    /// Chooses the rays along `directions` that are within `cone`, and says how many they are.
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

    /// Intersects the chosen rays, which were boosted last, as [`HitBuffer::intersect`] does all.
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
            ..
        } = self;
        chosen_hits.clear();
        chosen_hits.extend(chosen.iter().map(|ray| hits[*ray as usize]));
        // Where there is one rest frame, no record is kept of which was hit.
        let replaced = |k: usize| {
            if let Some(known) = frames.get_mut(chosen[k] as usize) {
                *known = frame;
            }
        };
        let (method, from) = (rays.method, Origins::Shared(origin));
        match meter.visibility() {
            None => bvh.closest_by(method, from, local, chosen_hits, &mut NoTally, replaced),
            Some(counts) => bvh.closest_by(method, from, local, chosen_hits, counts, replaced),
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

    /// Intersects `rays` with the surfaces of `frame`, from `origin` if they share one, and keeps what is nearer
    /// than the hits so far: along `directions`, or along the tangents that were boosted last.
    pub(super) fn intersect(
        &mut self,
        frame: u32,
        bvh: &Bvh,
        rays: &Rays,
        origin: DVec3,
        directions: Option<&[DVec3]>,
        meter: &mut Meter,
    ) {
        let (hits, frames) = (&mut self.hits, &mut self.frames);
        let replaced = |ray: usize| {
            if let Some(known) = frames.get_mut(ray) {
                *known = frame;
            }
        };
        let origins = match self.origins.as_slice() {
            [] => Origins::Shared(origin),
            origins if rays.left.is_empty() => Origins::Each(origins),
            origins => {
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
        // The traversal is compiled with counting and without.
        match meter.visibility() {
            None => bvh.closest_by(
                rays.method,
                origins,
                directions,
                hits,
                &mut NoTally,
                replaced,
            ),
            Some(counts) => {
                bvh.closest_by(rays.method, origins, directions, hits, counts, replaced)
            }
        }
    }

    /// Ray `ray` in the frame that was boosted into last, and ω_rest/ω_world of its light.
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

    /// Where ray `ray` leaves in that frame, if not at `origin`.
    #[inline(always)]
    pub(super) fn origin(&self, ray: usize, origin: Event<Rest>) -> Event<Rest> {
        match self.origins.get(ray) {
            Some(place) => Event::new(self.origin_times[ray], *place),
            None => origin,
        }
    }

    /// The nearest hit of each ray of the batch, but for those that hit [alike](Self::push_run).
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
