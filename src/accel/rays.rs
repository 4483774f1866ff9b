//! Rays and their hits.

use glam::DVec3;

/// A ray origin + s · direction, s > `s_min`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Metres, rest frame.
    pub origin: DVec3,
    /// Metres per unit of s; any length. s is measured in units of this vector.
    pub direction: DVec3,
    /// Hits at or before this parameter do not count.
    pub s_min: f64,
}

/// The starts of the rays of a batch, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Origins<'a> {
    /// All at one point.
    Shared(DVec3),
    /// Each at its own point.
    Each(&'a [DVec3]),
    /// Each on a triangle of the tree, or offset from it against rounding; the ray leaves that triangle and cannot hit it again.
    Leaving {
        /// The starts.
        origins: &'a [DVec3],
        /// The triangle's position in the tree, as [`Hit::slot`]; [`NO_SLOT`] if it is not in this tree.
        slots: &'a [u32],
    },
}

/// The slot of no triangle.
pub const NO_SLOT: u32 = u32::MAX;

/// A ray up to `s_max` that may be blocked, ignoring one triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// From `ray.s_min` on, exclusive.
    pub ray: Ray,
    /// Hits at or beyond this parameter do not count.
    pub s_max: f64,
    /// The id of a triangle that is ignored: the one that the segment leaves.
    pub skip: Option<u32>,
    /// The id of another triangle that is ignored: the one at which the segment ends.
    pub end: Option<u32>,
}

/// Segments from many points that all end at one point, at s = 1. Neither the triangle that each leaves nor the one at which all end
/// blocks.
#[derive(Debug, Clone, Copy)]
pub struct Converging<'a> {
    /// The common end, metres.
    pub end: DVec3,
    /// The starts, metres: x, y and z of all. The number of segments is the length of the shortest slice.
    pub from: [&'a [f64]; 3],
    /// Hits at or before these parameters do not count.
    pub s_min: &'a [f64],
    /// Ids of the triangles that the segments leave; `u32::MAX` for none.
    pub skip: &'a [u32],
    /// Id of the triangle at which all end, which does not block either.
    pub at: Option<u32>,
}

/// A hit of a ray with a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The ray's parameter.
    pub s: f64,
    /// Barycentric weight of the triangle's second corner.
    pub u: f64,
    /// Barycentric weight of its third corner.
    pub v: f64,
    /// The triangle's id: its index when the tree was built.
    pub triangle: u32,
    /// Its position in the tree, for `Bvh::corners`.
    pub slot: u32,
    /// Whether the ray hits the front: the side from which the corners run counter-clockwise.
    pub front: bool,
}

/// Which sides of a triangle exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Facing {
    /// Both.
    TwoSided,
    /// Only the front: rays pass through from behind.
    FrontOnly,
}

impl Hit {
    /// The same hit, slightly farther: anything nearer than the result is at least as near as this hit.
    pub(super) fn up_to(self) -> Hit {
        Hit {
            s: self.s.next_up(),
            ..self
        }
    }

    /// The nearer of two hits; among equal ones, the one with the smaller id.
    pub(super) fn first(one: Option<Hit>, other: Option<Hit>) -> Option<Hit> {
        let (Some(a), Some(b)) = (one, other) else {
            return one.or(other);
        };
        // Where triangles share an edge, both are hit at the same s: the id decides, in whatever order the tree visits them.
        let is_other = b.s < a.s || (b.s == a.s && b.triangle < a.triangle);
        if is_other { other } else { one }
    }
}

impl Converging<'_> {
    /// The number of segments.
    pub fn count(&self) -> usize {
        let [x, y, z] = self.from;
        let starts = x.len().min(y.len()).min(z.len());
        starts.min(self.s_min.len()).min(self.skip.len())
    }

    /// The start of segment `at`.
    #[inline(always)]
    pub(super) fn start(&self, at: usize) -> DVec3 {
        let [x, y, z] = self.from;
        DVec3::new(x[at], y[at], z[at])
    }

    /// Segment `at`.
    #[inline(always)]
    pub(super) fn segment(&self, at: usize) -> Segment {
        let from = self.start(at);
        // With the way to the end as direction, the end is at s = 1.
        Segment {
            ray: Ray {
                origin: from,
                direction: self.end - from,
                s_min: self.s_min[at],
            },
            s_max: 1.0,
            skip: Some(self.skip[at]),
            end: self.at,
        }
    }
}

impl Origins<'_> {
    /// `count`, but at most the number of rays that have an origin.
    pub(super) fn limit(&self, count: usize) -> usize {
        match self {
            Origins::Shared(_) => count,
            Origins::Each(origins) => count.min(origins.len()),
            Origins::Leaving { origins, slots } => count.min(origins.len()).min(slots.len()),
        }
    }

    /// The start of ray `ray`.
    #[inline(always)]
    pub(super) fn of(&self, ray: usize) -> DVec3 {
        match self {
            Origins::Shared(origin) => *origin,
            Origins::Each(origins) | Origins::Leaving { origins, .. } => origins[ray],
        }
    }

    /// The slot of the triangle that ray `ray` leaves.
    #[inline(always)]
    pub(super) fn left(&self, ray: usize) -> u32 {
        match self {
            Origins::Leaving { slots, .. } => slots[ray],
            Origins::Shared(_) | Origins::Each(_) => NO_SLOT,
        }
    }
}
