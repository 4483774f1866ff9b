//! The points of a run in arrays: what falls on them is found in loops.

use glam::DVec3;

use super::run::{Run, TracedRays};
use crate::accel::unit_normal;
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, Vectors, dispatch, load};
use crate::light::lamp::{EventColumns, PointsOnRays};
use crate::light::time_texture::SurfacePoint as CapturePoint;
use crate::spacetime::{Displacement, Event, World};

/// The points of a run, by member.
#[derive(Debug)]
pub(super) struct Points {
    /// Their triangles.
    pub triangles: Vec<u32>,
    /// Their places in the tree.
    pub slots: Vec<u32>,
    /// Where they are in their rest frame.
    pub positions: Columns,
    /// Unit normals there, on the side that the camera sees.
    pub normals: Columns,
    /// Tangents of the rays that hit them, in the rest frame.
    tangents: Columns,
    /// Where the rays leave that hit them, in the rest frame: one for all, or each.
    eye: DVec3,
    eyes: Columns,
    /// The same in the world, the way from there to the points, and the distance.
    shot: Event<World>,
    origins: EventColumns,
    offsets: EventColumns,
    pub s: Vec<f64>,
    /// Whether rays leave each from its own event.
    own_origins: bool,
    /// Two edges of the triangles, and 1 for hits on the front, −1 for those on the back.
    edges: [Columns; 2],
    sides: Vec<f64>,
}

impl Points {
    /// Point `k` as its capture cameras look at it.
    pub(super) fn captured(&self, k: usize) -> CapturePoint {
        CapturePoint {
            position: self.positions.get(k),
            normal: self.normals.get(k),
        }
    }

    /// Takes over the points of `run`.
    pub(super) fn fill(&mut self, run: &Run) {
        self.fill_places(run);
        let TracedRays { rays, event, .. } = run.traced;
        self.shot = *event;

        // Where they are in the world from where their rays leave.
        self.offsets.resize(run.count());
        for (k, ray) in run.members.iter().enumerate() {
            let ray = run.traced.ray(*ray as usize);
            let offset = ray.tangent * self.s[k];
            self.offsets.ct[k] = offset.ct;
            self.offsets.x.set(k, offset.x);
        }
        let Some(origins) = rays.origins else {
            return self.origins.resize(0);
        };
        self.origins.resize(run.count());
        for (k, ray) in run.members.iter().enumerate() {
            let event = *event + origins[*ray as usize].displacement;
            self.origins.ct[k] = event.ct;
            self.origins.x.set(k, event.x);
        }
    }

    /// Takes over the points of `run` as they are in their rest frame, and nothing of the world.
    pub(super) fn fill_places(&mut self, run: &Run) {
        let count = run.count();
        self.own_origins = run.traced.rays.origins.is_some();
        self.resize(count);

        // Triangles lie apart in memory: their corners are gathered first.
        let [e1, e2] = &mut self.edges;
        for k in 0..count {
            let Some(hit) = run.hit(k) else {
                continue;
            };
            let [a, b, c] = run.rest.bvh.corners(hit.slot);
            e1.set(k, b - a);
            e2.set(k, c - a);
            self.sides[k] = if hit.front { 1.0 } else { -1.0 };
            self.triangles[k] = hit.triangle;
            self.slots[k] = hit.slot;
            self.s[k] = hit.s;
        }
        dispatch(Normals {
            edges: &self.edges,
            sides: &self.sides,
            normals: &mut self.normals,
        });

        // Where they are.
        let Points {
            positions,
            tangents,
            eyes,
            eye,
            s,
            own_origins,
            ..
        } = self;
        run.each_local(run.members, |k, local, _| {
            positions.set(k, local.at(s[k]).x);
            tangents.set(k, local.tangent.x);
            match own_origins {
                true => eyes.push(local.origin.x),
                false => *eye = local.origin.x,
            }
        });
    }

    /// Unit vectors towards the observer, in the rest frame.
    pub(super) fn views(&self, views: &mut Columns) {
        views.resize(self.count());
        dispatch(Views {
            tangents: &self.tangents,
            views,
        });
    }

    /// How many points.
    pub(super) fn count(&self) -> usize {
        self.triangles.len()
    }

    /// Where the rays leave that hit points from `begin` on, in the rest frame.
    #[inline(always)]
    pub(super) fn load_eyes(&self, begin: usize) -> Vectors {
        match self.own_origins {
            true => self.eyes.load(begin),
            false => Vectors::splat(self.eye),
        }
    }

    /// Where the ray leaves that hit point `k`, in the rest frame.
    #[inline(always)]
    pub(super) fn eye(&self, k: usize) -> DVec3 {
        match self.own_origins {
            true => self.eyes.get(k),
            false => self.eye,
        }
    }

    /// From where its ray leaves to point `k`, in the world.
    #[inline(always)]
    pub(super) fn offset(&self, k: usize) -> Displacement<World> {
        Displacement::new(self.offsets.ct[k], self.offsets.x.get(k))
    }

    /// Point `k` in the world, at the emission of its light.
    #[inline(always)]
    pub(super) fn event(&self, k: usize) -> Event<World> {
        let offset = self.offset(k);
        match self.own_origins {
            true => Event::new(self.origins.ct[k], self.origins.x.get(k)) + offset,
            false => self.shot + offset,
        }
    }

    /// Where they are in the world.
    pub(super) fn on_rays(&self) -> PointsOnRays<'_> {
        PointsOnRays {
            shot: self.shot,
            origins: self.own_origins.then_some(&self.origins),
            offsets: &self.offsets,
        }
    }

    fn resize(&mut self, count: usize) {
        self.triangles.resize(count, 0);
        self.slots.resize(count, 0);
        self.sides.resize(count, 1.0);
        self.s.resize(count, 0.0);
        self.positions.resize(count);
        self.tangents.resize(count);
        self.normals.resize(count);
        self.edges.iter_mut().for_each(|edge| edge.resize(count));
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
            normals: Columns::default(),
            eye: DVec3::ZERO,
            eyes: Columns::default(),
            shot: Event::ORIGIN,
            origins: EventColumns::default(),
            offsets: EventColumns::default(),
            s: Vec::new(),
            own_origins: false,
            edges: Default::default(),
            sides: Vec::new(),
        }
    }
}

/// Edges of triangles to unit normals, on the side that is seen.
struct Normals<'a> {
    edges: &'a [Columns; 2],
    sides: &'a [f64],
    normals: &'a mut Columns,
}

impl VectorLoop for Normals<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        while begin < self.sides.len() {
            let [e1, e2] = [self.edges[0].block(begin), self.edges[1].block(begin)];
            let sides = load(self.sides, begin);
            let mut normals = Vectors::ZERO;
            for (k, side) in sides.iter().enumerate() {
                normals.set(k, unit_normal(e1.get(k), e2.get(k)) * *side);
            }
            self.normals.store(&normals, begin);
            begin += BLOCK;
        }
    }
}

/// Tangents of rays to unit vectors back along them.
struct Views<'a> {
    tangents: &'a Columns,
    views: &'a mut Columns,
}

impl VectorLoop for Views<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        while begin < self.tangents.len() {
            let mut views = self.tangents.load(begin);
            for k in 0..BLOCK {
                views.set(k, -views.get(k).normalize_or_zero());
            }
            self.views.store(&views, begin);
            begin += BLOCK;
        }
    }
}
