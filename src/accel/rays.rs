//! Rays, and what they hit.

use glam::DVec3;

/// A ray origin + s · direction, s > `s_min`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Metres, rest frame.
    pub origin: DVec3,
    /// Metres per unit of s; any length. s is measured in it as it is.
    pub direction: DVec3,
    /// Hits at this parameter or before don't count.
    pub s_min: f64,
}

/// Where the rays of a batch start, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Origins<'a> {
    /// All in one point.
    Shared(DVec3),
    /// Each in its own.
    Each(&'a [DVec3]),
    /// Each on a triangle of the tree, or off it by what rounding asks for, which it leaves and so doesn't meet again.
    Leaving {
        /// Where.
        origins: &'a [DVec3],
        /// The triangle's place in the tree, as [`Hit::slot`]; [`NO_SLOT`] for none of this tree.
        slots: &'a [u32],
    },
}

/// The place of no triangle.
pub const NO_SLOT: u32 = u32::MAX;

/// What may stand between two points: a ray up to `s_max`, without one triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// From `ray.s_min` on, which doesn't count.
    pub ray: Ray,
    /// Hits at this parameter or beyond don't count.
    pub s_max: f64,
    /// The id of a triangle that doesn't count: the one it leaves.
    pub skip: Option<u32>,
    /// The id of another that doesn't: the one it ends at.
    pub end: Option<u32>,
}

/// What may stand between points and one place: segments that all end there, at s = 1. The triangle that each leaves and the one at which all end are
/// not in the way.
#[derive(Debug, Clone, Copy)]
pub struct Converging<'a> {
    /// Where they end, metres.
    pub end: DVec3,
    /// Where they start, metres: x, y and z of all. There are as many segments as the shortest of the slices has entries.
    pub from: [&'a [f64]; 3],
    /// Hits at these parameters or before don't count.
    pub s_min: &'a [f64],
    /// Ids of the triangles that they leave; `u32::MAX` for none.
    pub skip: &'a [u32],
    /// Id of the triangle that all end at, which is not in the way either.
    pub at: Option<u32>,
}

/// Where a ray hits a triangle.
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
    /// Its place in the tree, for `Bvh::corners`.
    pub slot: u32,
    /// Whether the ray hits the front: the side from which the corners run counter-clockwise.
    pub front: bool,
}

/// Which sides of a triangle are there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Facing {
    /// Both.
    TwoSided,
    /// The front only: rays pass through from behind.
    FrontOnly,
}

impl Hit {
    /// The same, a little farther: what is nearer than that is as near as this, or nearer.
    pub(super) fn up_to(self) -> Hit {
        Hit {
            s: self.s.next_up(),
            ..self
        }
    }

    /// The nearer of two hits, of equal ones that with the smaller id.
    pub(super) fn first(one: Option<Hit>, other: Option<Hit>) -> Option<Hit> {
        let (Some(a), Some(b)) = (one, other) else {
            return one.or(other);
        };
        let is_other = b.s < a.s || (b.s == a.s && b.triangle < a.triangle);
        if is_other { other } else { one }
    }
}

impl Converging<'_> {
    /// How many there are.
    pub fn count(&self) -> usize {
        let [x, y, z] = self.from;
        let starts = x.len().min(y.len()).min(z.len());
        starts.min(self.s_min.len()).min(self.skip.len())
    }

    /// Where segment `at` starts.
    #[inline(always)]
    pub(super) fn start(&self, at: usize) -> DVec3 {
        let [x, y, z] = self.from;
        DVec3::new(x[at], y[at], z[at])
    }

    /// Segment `at`.
    #[inline(always)]
    pub(super) fn segment(&self, at: usize) -> Segment {
        let from = self.start(at);
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
    /// Of `count` rays those that have an origin.
    pub(super) fn limit(&self, count: usize) -> usize {
        match self {
            Origins::Shared(_) => count,
            Origins::Each(origins) => count.min(origins.len()),
            Origins::Leaving { origins, slots } => count.min(origins.len()).min(slots.len()),
        }
    }

    /// Where ray `ray` starts.
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
