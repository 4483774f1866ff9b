//! The points of a run in arrays, for loops that compute their illumination.

use glam::DVec3;

use super::run::{Run, TracedRays, in_a_row};
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, Vectors, dispatch, gather_vectors, load};
use crate::light::lamp::{EventColumns, PointsOnRays, Start};
use crate::light::time_texture::CapturePoint;
use crate::spacetime::{Displacement, Event, World};

/// The points of a run, by member.
#[derive(Debug)]
pub(super) struct Points {
    /// Triangles and their slots in the tree, unless the points are only used for lamps without shadows.
    pub triangles: Vec<u32>,
    pub slots: Vec<u32>,
    /// Positions in the rest frame.
    pub positions: Columns,
    /// Unit normals, on the side that the camera sees.
    pub normals: Columns,
    /// Normals of the triangles, if shading normals differ.
    geometric: Columns,
    is_smooth: bool,
    /// Tangents of the rays that hit the points, in the rest frame, if all data of the points were taken over.
    tangents: Columns,
    /// Whether those are unit vectors.
    are_unit: bool,
    /// Directions of these rays in the world, if needed.
    directions: Columns,
    /// Origins of the rays that hit the points, in the rest frame: a common one, or one for each.
    eye: DVec3,
    eyes: Columns,
    /// Distances of the points along the rays.
    pub s: Vec<f64>,
    /// The event of the shot in the world, and the refractive index that delays the rays.
    shot: Event<World>,
    index: f64,
    /// Whether each ray has its own origin event: then these events, and the displacements from there to the points.
    own_origins: bool,
    origins: EventColumns,
    offsets: EventColumns,
}

/// Which data of points are taken over.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Taken {
    /// Their positions, and the tangents of the rays that hit them.
    All,
    Positions,
    Tangents,
}

impl Points {
    /// Point `k` in the form that captures look up.
    pub(super) fn captured(&self, k: usize) -> CapturePoint {
        CapturePoint {
            position: self.positions.get(k),
            normal: self.normals.get(k),
        }
    }

    /// Takes over the points of `run`, with all data.
    pub(super) fn fill(&mut self, run: &Run) {
        self.fill_all(run, Taken::All);
    }

    /// The same, but without positions if these need computing: for light that nothing can block.
    pub(super) fn fill_unshadowed(&mut self, run: &Run) {
        self.fill_all(run, Taken::Tangents);
    }

    fn fill_all(&mut self, run: &Run, taken: Taken) {
        self.tangents.resize(run.count());
        self.fill_rest(run, taken);
        let TracedRays {
            surfaces,
            rays,
            event,
            ..
        } = run.traced;
        self.shot = *event;

        self.index = run.traced.index;

        // Displacements in the world from the origins of the rays. In a frame at rest in the world, tangents are directions.
        let Some(origins) = rays.origins else {
            if surfaces.at_rest().is_none() {
                self.directions.resize(run.count());
                for (k, ray) in run.members.iter().enumerate() {
                    self.directions.set(k, rays.directions[*ray as usize]);
                }
            }
            return;
        };
        // Rays with origins of their own: displacements along them, and the events where they start.
        self.offsets.resize(run.count());
        for (k, ray) in run.members.iter().enumerate() {
            let ray = run.traced.ray(*ray as usize);
            let offset = ray.tangent * self.s[k];
            self.offsets.ct[k] = offset.ct;
            self.offsets.x.set(k, offset.x);
        }
        self.origins.resize(run.count());
        for (k, ray) in run.members.iter().enumerate() {
            let event = *event + origins[*ray as usize].displacement;
            self.origins.ct[k] = event.ct;
            self.origins.x.set(k, event.x);
        }
    }

    /// Takes over the points of `run` in their rest frame only, without data in the world.
    pub(super) fn fill_places(&mut self, run: &Run) {
        self.fill_rest(run, Taken::Positions);
    }

    fn fill_rest(&mut self, run: &Run, taken: Taken) {
        let with_tangents = taken != Taken::Positions;
        let count = run.count();
        self.own_origins = run.traced.rays.origins.is_some();
        self.resize(count);

        let TracedRays { surfaces, rays, .. } = run.traced;
        // Boosts change the length of tangents: unit vectors are left only where there is none.
        self.are_unit = surfaces.at_rest().is_some();
        let shared = surfaces.shared_origin(rays, run.traced.hits);
        let hits = run.traced.hits.hits();
        // Tangents of consecutive rays are consecutive in memory.
        let all = shared.filter(|_| with_tangents);
        let row = all.and_then(|(_, all)| all.get(in_a_row(run.members)?));
        if let Some(row) = row {
            self.tangents.take(row);
        }
        // Lanes past the last member keep old slots: they get normals that nothing reads.
        let (mut slots, mut sides) = ([0; BLOCK], [0.0; BLOCK]);
        for (block, members) in run.members.chunks(BLOCK).enumerate() {
            let begin = block * BLOCK;
            // Data of the hits, and the normals of their triangles on the visible side.
            let of = self.s[begin..].iter_mut().zip(&mut slots).zip(&mut sides);
            for (ray, ((s, slot), side)) in members.iter().zip(of) {
                let Some(hit) = &hits[*ray as usize] else {
                    continue;
                };
                (*s, *slot) = (hit.s, hit.slot);
                *side = if hit.front { 1.0 } else { -1.0 };
            }
            let Some(to) = self.normals.block_mut(begin) else {
                continue;
            };
            match run.rest.normals() {
                [] => {
                    let [x, y, z] = to;
                    for (k, ray) in members.iter().enumerate() {
                        if let Some(hit) = &hits[*ray as usize] {
                            let normal = run.rest.bvh.normal(hit) * sides[k];
                            (x[k], y[k], z[k]) = (normal.x, normal.y, normal.z);
                        }
                    }
                }
                normals => gather_vectors(normals, &slots, &sides, to),
            }
            if taken != Taken::Tangents {
                let of_points = self.triangles[begin..].iter_mut();
                let of_points = of_points.zip(&mut self.slots[begin..]);
                for (ray, (triangle, slot)) in members.iter().zip(of_points) {
                    if let Some(hit) = &hits[*ray as usize] {
                        (*triangle, *slot) = (hit.triangle, hit.slot);
                    }
                }
            }

            // Positions, in one frame whose rays are available, in a loop that does nothing else.
            if let (Some((eye, tangents)), true) = (shared, with_tangents) {
                self.eye = eye;
                if row.is_none()
                    && let Some([x, y, z]) = self.tangents.block_mut(begin)
                {
                    for (k, ray) in members.iter().enumerate() {
                        let t = tangents[*ray as usize];
                        (x[k], y[k], z[k]) = (t.x, t.y, t.z);
                    }
                }
                if taken == Taken::All {
                    dispatch(Along {
                        eye,
                        tangents: &self.tangents,
                        s: &self.s,
                        begin,
                        positions: &mut self.positions,
                    });
                }
                continue;
            }
            // Positions alone, straight from the batch's tangents.
            if let Some((eye, tangents)) = shared {
                self.eye = eye;
                if let Some([x, y, z]) = self.positions.block_mut(begin) {
                    let s = &self.s[begin..];
                    for (k, (ray, s)) in members.iter().zip(s).enumerate() {
                        let p = eye + tangents[*ray as usize] * *s;
                        (x[k], y[k], z[k]) = (p.x, p.y, p.z);
                    }
                }
                continue;
            }
            // Otherwise each ray is taken into the frame by itself.
            let Some([x, y, z]) = self.positions.block_mut(begin) else {
                continue;
            };
            let s = &self.s[begin..];
            let (eyes, eye, own_origins) = (&mut self.eyes, &mut self.eye, self.own_origins);
            let tangents = &mut self.tangents;
            run.each_local(members, |k, local, _| {
                let position = local.at(s[k]).x;
                (x[k], y[k], z[k]) = (position.x, position.y, position.z);
                if with_tangents {
                    tangents.set(begin + k, local.tangent.x);
                }
                match own_origins {
                    true => eyes.push(local.origin.x),
                    false => *eye = local.origin.x,
                }
            });
        }
    }

    /// Stores the triangles' normals separately, before [`Points::normals`] is replaced by vertex normals.
    pub(super) fn keep_geometric(&mut self) {
        self.geometric.clone_from(&self.normals);
        self.is_smooth = true;
    }

    /// Whether shading normals may differ from those of the triangles.
    #[inline(always)]
    pub(super) fn is_smooth(&self) -> bool {
        self.is_smooth
    }

    /// The normal of the triangle at point `k`, on the side that the camera sees.
    #[inline(always)]
    pub(super) fn geometric(&self, k: usize) -> DVec3 {
        match self.is_smooth {
            true => self.geometric.get(k),
            false => self.normals.get(k),
        }
    }

    /// Whether light from direction `l`, which is above the shading normal's horizon at point `k`, comes from below the triangle.
    #[inline(always)]
    pub(super) fn is_below(&self, k: usize, l: DVec3) -> bool {
        self.is_smooth && self.geometric.get(k).dot(l) <= 0.0
    }

    /// Tangents of the rays in the rest frame, if they are unit vectors: the opposite of [`Points::views`].
    pub(super) fn unit_tangents(&self) -> Option<&Columns> {
        self.are_unit.then_some(&self.tangents)
    }

    /// Unit vectors towards the observer, in the rest frame.
    pub(super) fn views(&self, views: &mut Columns) {
        views.resize(self.count());
        dispatch(Views {
            tangents: &self.tangents,
            are_unit: self.are_unit,
            views,
        });
    }

    /// The number of points.
    pub(super) fn count(&self) -> usize {
        self.triangles.len()
    }

    /// Origins of the rays that hit a block of points from `begin` on, in the rest frame.
    #[inline(always)]
    pub(super) fn load_eyes(&self, begin: usize) -> Vectors {
        match self.own_origins {
            true => self.eyes.load(begin),
            false => Vectors::splat(self.eye),
        }
    }

    /// The common origin of all rays in the rest frame, if they have one.
    #[inline(always)]
    pub(super) fn shared_eye(&self) -> Option<DVec3> {
        (!self.own_origins).then_some(self.eye)
    }

    /// The origin of the ray that hit point `k`, in the rest frame.
    #[inline(always)]
    pub(super) fn eye(&self, k: usize) -> DVec3 {
        match self.own_origins {
            true => self.eyes.get(k),
            false => self.eye,
        }
    }

    /// The displacement from the origin of its ray to point `k`, in the world.
    #[inline(always)]
    pub(super) fn offset(&self, k: usize) -> Displacement<World> {
        match self.own_origins {
            true => Displacement::new(self.offsets.ct[k], self.offsets.x.get(k)),
            false => {
                // s (−η, d): light that reaches the origin left η s before.
                let s = self.s[k];
                Displacement::new(-self.index * s, self.directions().get(k) * s)
            }
        }
    }

    /// Directions in the world of the rays, which leave at the event of the shot.
    #[inline(always)]
    fn directions(&self) -> &Columns {
        match self.are_unit {
            true => &self.tangents,
            false => &self.directions,
        }
    }

    /// Event of point `k` in the world, at the emission of its light.
    #[inline(always)]
    pub(super) fn event(&self, k: usize) -> Event<World> {
        let offset = self.offset(k);
        match self.own_origins {
            true => Event::new(self.origins.ct[k], self.origins.x.get(k)) + offset,
            false => self.shot + offset,
        }
    }

    /// The points in the world.
    pub(super) fn on_rays(&self) -> PointsOnRays<'_> {
        let start = match self.own_origins {
            true => Start::Own {
                events: &self.origins,
                offsets: &self.offsets,
            },
            false => Start::Shot {
                index: self.index,
                directions: self.directions(),
                s: &self.s,
            },
        };
        PointsOnRays {
            shot: self.shot,
            start,
        }
    }

    fn resize(&mut self, count: usize) {
        self.triangles.resize(count, 0);
        self.slots.resize(count, 0);
        self.s.resize(count, 0.0);
        self.positions.resize(count);
        self.normals.resize(count);
        self.is_smooth = false;
        self.eyes.clear();
    }
}

impl Default for Points {
    fn default() -> Self {
        Points {
            triangles: Vec::new(),
            slots: Vec::new(),
            positions: Columns::default(),
            tangents: Columns::default(),
            are_unit: false,
            directions: Columns::default(),
            normals: Columns::default(),
            geometric: Columns::default(),
            is_smooth: false,
            eye: DVec3::ZERO,
            eyes: Columns::default(),
            s: Vec::new(),
            shot: Event::ORIGIN,
            index: 1.0,
            own_origins: false,
            origins: EventColumns::default(),
            offsets: EventColumns::default(),
        }
    }
}

/// The loop that computes a block of points from rays with a common origin.
struct Along<'a> {
    eye: DVec3,
    tangents: &'a Columns,
    s: &'a [f64],
    begin: usize,
    positions: &'a mut Columns,
}

impl VectorLoop for Along<'_> {
    #[inline(always)]
    fn run(self) {
        let tangents = self.tangents.block(self.begin);
        let s = load(self.s, self.begin);
        let mut positions = Vectors::ZERO;
        for (k, s) in s.iter().enumerate() {
            positions.set(k, self.eye + tangents.get(k) * *s);
        }
        self.positions.store(&positions, self.begin);
    }
}

/// The loop that computes unit vectors to the observer from tangents of rays.
struct Views<'a> {
    tangents: &'a Columns,
    are_unit: bool,
    views: &'a mut Columns,
}

impl VectorLoop for Views<'_> {
    #[inline(always)]
    fn run(self) {
        let mut views = Vectors::ZERO;
        let mut begin = 0;
        while begin < self.tangents.len() {
            // In vacuum a boosted tangent has the length ω_rest/ω_world.
            let tangents = self.tangents.block(begin);
            if !self.are_unit {
                for k in 0..BLOCK {
                    views.set(k, -tangents.get(k).normalize_or_zero());
                }
                self.views.store(&views, begin);
            } else if let Some(views) = self.views.block_mut(begin) {
                for (views, tangents) in views.into_iter().zip(tangents.axes()) {
                    for (view, tangent) in views.iter_mut().zip(tangents) {
                        *view = -*tangent;
                    }
                }
            }
            begin += BLOCK;
        }
    }
}
