//! The rays of a batch, as given and as traced.

use glam::DVec3;

use crate::accel::float::{greater, lesser, power_of_two};
use crate::accel::rays::{Converging, NO_SLOT, Ray, Segment};
use crate::accel::tree_space::TreeSpace;

/// Number of rays in a block.
pub(super) const RAYS: usize = 64;

/// Rays are treated as starting at one point if none starts farther from it than this fraction of a pixel: then a few per cent pass so
/// close to an edge that f64 decides.
const SHARED: f64 = 1.0 / 64.0;

/// Rays to trace, by their index in the batch. `start` and `direction` are those of the ray as traced, possibly from its end.
pub(super) trait RaySet: Copy {
    /// Whether each ray has its own origin.
    const OWN_ORIGINS: bool;

    /// The common start, if there is one.
    #[inline(always)]
    fn shared_origin(self) -> Option<DVec3> {
        None
    }
    /// The maximum distance from the shared start at which rays start, or pass, along each axis, metres: (K5) of [`block`](super::block).
    #[inline(always)]
    fn origin_extent(self) -> DVec3 {
        DVec3::ZERO
    }
    /// The maximum distance of the given starts from the shared start, metres, summed over the axes.
    #[inline(always)]
    fn farthest_origin(self) -> f64 {
        0.0
    }
    /// Whether rays are traced from their ends.
    #[inline(always)]
    fn is_reversed(&self) -> bool {
        false
    }
    /// All starts as a slice, if there is one.
    #[inline(always)]
    fn origins(&self) -> Option<&[DVec3]> {
        None
    }
    /// The rays in `order` as rays from one point, if their starts are close enough for that to pay: (K5) of [`block`](super::block).
    #[inline(always)]
    fn as_shared(&self, _space: &TreeSpace, _order: &[u32; RAYS]) -> Option<SharedOrigin<'_>> {
        None
    }
    /// All directions as a slice, if there is one.
    #[inline(always)]
    fn directions(&self) -> Option<&[DVec3]> {
        None
    }
    /// The targets of rays traced from a shared start, axis by axis, if they are stored that way.
    #[inline(always)]
    fn targets(&self) -> Option<[&[f64]; 3]> {
        None
    }
    /// The direction, metres per unit of s.
    fn direction(self, ray: usize) -> DVec3;
    /// The start of the ray as traced, metres.
    #[inline(always)]
    fn start(self, ray: usize) -> DVec3 {
        self.origin(ray)
    }
    /// The start of the ray as given, metres.
    fn origin(self, ray: usize) -> DVec3;
    /// Whether any ray leaves a triangle.
    #[inline(always)]
    fn leaves(self) -> bool {
        false
    }
    /// The slot of the triangle that the ray leaves, and therefore cannot hit.
    #[inline(always)]
    fn left(self, _: usize) -> u32 {
        NO_SLOT
    }
    /// The ray from its start on.
    #[inline(always)]
    fn ray(self, ray: usize) -> Ray {
        Ray {
            origin: self.origin(ray),
            direction: self.direction(ray),
            s_min: 0.0,
        }
    }
}

/// Rays with an end, for which only occlusion is tested.
pub(super) trait Blockable: RaySet {
    /// The segment as given.
    fn segment(self, ray: usize) -> Segment;
    /// Whether a ray ignores the triangle with this id.
    fn passes(self, ray: usize, triangle: u32) -> bool;
    /// The range of s in which hits count, for each of the rays in `order`. `in_fours` is as in [`Block`](super::block::Block).
    fn ends(self, order: &[u32; RAYS], in_fours: bool) -> [[f64; RAYS]; 2];
}

/// Rays from one point, or from so close to it that they are traced as if they were.
#[derive(Clone, Copy)]
pub(super) struct SharedOrigin<'a> {
    /// Metres.
    pub origin: DVec3,
    /// The start of each ray; empty if all start at `origin`.
    pub origins: &'a [DVec3],
    /// The maximal distance of starts from `origin` along each axis, metres.
    pub extent: DVec3,
    pub directions: &'a [DVec3],
}

/// Rays with their own origins.
#[derive(Clone, Copy)]
pub(super) struct OwnOrigins<'a> {
    /// Metres.
    pub origins: &'a [DVec3],
    pub directions: &'a [DVec3],
    /// Slots of the triangles that rays leave; empty if they leave none.
    pub left: &'a [u32],
}

/// Segments, traced from their starts or from their ends.
#[derive(Clone, Copy)]
pub(super) struct Segments<'a> {
    pub segments: &'a [Segment],
    pub reversed: bool,
}

/// Segments that end in one point, traced from there.
#[derive(Clone, Copy)]
pub(super) struct SegmentsToPoint<'a> {
    pub segments: &'a [Segment],
    /// The point, and the maximal distance at which they pass it, metres.
    pub end: DVec3,
    pub error: f64,
    /// The maximal distance of their starts from it, metres, summed over the axes.
    pub farthest: f64,
}

/// The same if that point is known, with starts in columns.
#[derive(Clone, Copy)]
pub(super) struct ColumnsToPoint<'a> {
    pub segments: Converging<'a>,
    /// As in [`SegmentsToPoint`].
    pub error: f64,
    pub farthest: f64,
}

impl RaySet for SharedOrigin<'_> {
    const OWN_ORIGINS: bool = false;

    #[inline(always)]
    fn shared_origin(self) -> Option<DVec3> {
        Some(self.origin)
    }

    #[inline(always)]
    fn origin_extent(self) -> DVec3 {
        self.extent
    }

    #[inline(always)]
    fn farthest_origin(self) -> f64 {
        self.extent.element_sum()
    }

    #[inline(always)]
    fn origins(&self) -> Option<&[DVec3]> {
        (!self.origins.is_empty()).then_some(self.origins)
    }

    #[inline(always)]
    fn directions(&self) -> Option<&[DVec3]> {
        Some(self.directions)
    }

    #[inline(always)]
    fn direction(self, ray: usize) -> DVec3 {
        self.directions[ray]
    }

    #[inline(always)]
    fn start(self, _: usize) -> DVec3 {
        self.origin
    }

    #[inline(always)]
    fn origin(self, ray: usize) -> DVec3 {
        match self.origins() {
            Some(origins) => origins[ray],
            None => self.origin,
        }
    }
}

impl<'a> SharedOrigin<'a> {
    /// Rays that all start at `origin`.
    pub fn new(origin: DVec3, directions: &'a [DVec3]) -> SharedOrigin<'a> {
        SharedOrigin {
            origin,
            origins: &[],
            extent: DVec3::ZERO,
            directions,
        }
    }
}

impl RaySet for OwnOrigins<'_> {
    const OWN_ORIGINS: bool = true;

    #[inline(always)]
    fn origins(&self) -> Option<&[DVec3]> {
        Some(self.origins)
    }

    #[inline(always)]
    fn as_shared(&self, space: &TreeSpace, order: &[u32; RAYS]) -> Option<SharedOrigin<'_>> {
        // Rays that leave triangles start in their planes, so f64 would have to decide.
        if self.leaves() {
            return None;
        }
        // Four at a time, so that the loop is vectorised.
        let first = self.origins[order[0] as usize].to_array();
        let (mut lo, mut hi, mut sum) = ([first; 4], [first; 4], [[0.0; 3]; 4]);
        for four in order.chunks_exact(4) {
            let starts = [0, 1, 2, 3].map(|i| self.origins[four[i] as usize].to_array());
            for i in 0..4 {
                for axis in 0..3 {
                    lo[i][axis] = lesser(starts[i][axis], lo[i][axis]);
                    hi[i][axis] = greater(starts[i][axis], hi[i][axis]);
                    sum[i][axis] += starts[i][axis];
                }
            }
        }
        let lo = lo.map(DVec3::from).into_iter().fold(first.into(), lesser3);
        let hi = hi.map(DVec3::from).into_iter().fold(first.into(), greater3);
        let (origin, half) = (lo * 0.5 + hi * 0.5, hi * 0.5 - lo * 0.5);
        // (K5), including the rounding of the middle and the halves.
        let rounding = power_of_two(-51) * (lo.abs().max_element() + hi.abs().max_element());
        let extent = half + rounding;
        // The size of a pixel at the distance of the tree, or, within it, at a quarter of its size.
        let [one, other] = [order[0], order[1]].map(|ray| self.directions[ray as usize]);
        let distance = greater(space.map(origin).abs().max_element() - 1.0, 0.25);
        let pixel = (one - other).abs().max_element() / one.abs().max_element() * distance;
        // Comparisons ignore NaN, sums do not.
        let is_number = sum.as_flattened().iter().sum::<f64>() * 0.0 == 0.0;
        let is_shared = extent.max_element() * space.scale <= pixel * SHARED;
        (is_number && is_shared).then_some(SharedOrigin {
            origin,
            origins: self.origins,
            extent,
            directions: self.directions,
        })
    }

    #[inline(always)]
    fn directions(&self) -> Option<&[DVec3]> {
        Some(self.directions)
    }

    #[inline(always)]
    fn direction(self, ray: usize) -> DVec3 {
        self.directions[ray]
    }

    #[inline(always)]
    fn origin(self, ray: usize) -> DVec3 {
        self.origins[ray]
    }

    #[inline(always)]
    fn leaves(self) -> bool {
        !self.left.is_empty()
    }

    #[inline(always)]
    fn left(self, ray: usize) -> u32 {
        self.left.get(ray).copied().unwrap_or(NO_SLOT)
    }
}

impl RaySet for Segments<'_> {
    const OWN_ORIGINS: bool = true;

    #[inline(always)]
    fn is_reversed(&self) -> bool {
        self.reversed
    }

    #[inline(always)]
    fn leaves(self) -> bool {
        true
    }

    /// The id, in place of the slot.
    #[inline(always)]
    fn left(self, ray: usize) -> u32 {
        self.segments[ray].skip.unwrap_or(NO_SLOT)
    }

    #[inline(always)]
    fn direction(self, ray: usize) -> DVec3 {
        let direction = self.segments[ray].ray.direction;
        if self.reversed { -direction } else { direction }
    }

    #[inline(always)]
    fn start(self, ray: usize) -> DVec3 {
        let Segment { ray, s_max, .. } = &self.segments[ray];
        if self.reversed {
            ray.origin + ray.direction * *s_max
        } else {
            ray.origin
        }
    }

    #[inline(always)]
    fn origin(self, ray: usize) -> DVec3 {
        self.segments[ray].ray.origin
    }
}

impl RaySet for SegmentsToPoint<'_> {
    const OWN_ORIGINS: bool = false;

    #[inline(always)]
    fn shared_origin(self) -> Option<DVec3> {
        Some(self.end)
    }

    #[inline(always)]
    fn origin_extent(self) -> DVec3 {
        DVec3::splat(self.error)
    }

    #[inline(always)]
    fn farthest_origin(self) -> f64 {
        self.farthest
    }

    #[inline(always)]
    fn is_reversed(&self) -> bool {
        true
    }

    #[inline(always)]
    fn leaves(self) -> bool {
        true
    }

    /// The id, in place of the slot.
    #[inline(always)]
    fn left(self, ray: usize) -> u32 {
        self.segments[ray].skip.unwrap_or(NO_SLOT)
    }

    #[inline(always)]
    fn direction(self, ray: usize) -> DVec3 {
        -self.segments[ray].ray.direction
    }

    #[inline(always)]
    fn start(self, _: usize) -> DVec3 {
        self.end
    }

    #[inline(always)]
    fn origin(self, ray: usize) -> DVec3 {
        self.segments[ray].ray.origin
    }
}

impl RaySet for ColumnsToPoint<'_> {
    const OWN_ORIGINS: bool = false;

    #[inline(always)]
    fn shared_origin(self) -> Option<DVec3> {
        Some(self.segments.end)
    }

    #[inline(always)]
    fn origin_extent(self) -> DVec3 {
        DVec3::splat(self.error)
    }

    #[inline(always)]
    fn farthest_origin(self) -> f64 {
        self.farthest
    }

    #[inline(always)]
    fn is_reversed(&self) -> bool {
        true
    }

    #[inline(always)]
    fn targets(&self) -> Option<[&[f64]; 3]> {
        Some(self.segments.from)
    }

    #[inline(always)]
    fn leaves(self) -> bool {
        true
    }

    /// The id, in place of the slot.
    #[inline(always)]
    fn left(self, ray: usize) -> u32 {
        self.segments.skip[ray]
    }

    #[inline(always)]
    fn direction(self, ray: usize) -> DVec3 {
        self.segments.start(ray) - self.segments.end
    }

    #[inline(always)]
    fn start(self, _: usize) -> DVec3 {
        self.segments.end
    }

    #[inline(always)]
    fn origin(self, ray: usize) -> DVec3 {
        self.segments.start(ray)
    }
}

impl Blockable for ColumnsToPoint<'_> {
    #[inline(always)]
    fn segment(self, ray: usize) -> Segment {
        self.segments.segment(ray)
    }

    #[inline(always)]
    fn passes(self, ray: usize, triangle: u32) -> bool {
        self.segments.skip[ray] == triangle || self.segments.at == Some(triangle)
    }

    #[inline(always)]
    fn ends(self, order: &[u32; RAYS], in_fours: bool) -> [[f64; RAYS]; 2] {
        // They end at 1: directions reach up to the end.
        let mut ends = [[1.0; RAYS]; 2];
        let s_min = self.segments.s_min;
        if in_fours {
            let mut first = 0;
            while first < RAYS {
                let ray = order[first] as usize;
                ends[0][first..first + 4].copy_from_slice(&s_min[ray..ray + 4]);
                first += 4;
            }
        } else {
            for (s, ray) in ends[0].iter_mut().zip(order) {
                *s = s_min[*ray as usize];
            }
        }
        ends
    }
}

/// The componentwise minimum and maximum of two points.
#[inline(always)]
fn lesser3(x: DVec3, y: DVec3) -> DVec3 {
    DVec3::new(lesser(x.x, y.x), lesser(x.y, y.y), lesser(x.z, y.z))
}

#[inline(always)]
fn greater3(x: DVec3, y: DVec3) -> DVec3 {
    DVec3::new(greater(x.x, y.x), greater(x.y, y.y), greater(x.z, y.z))
}

/// The same for segments stored one by one.
#[inline(always)]
fn ends_of(segments: &[Segment], order: &[u32; RAYS]) -> [[f64; RAYS]; 2] {
    let mut ends = [[0.0; RAYS]; 2];
    for (lane, ray) in order.iter().enumerate() {
        let segment = &segments[*ray as usize];
        (ends[0][lane], ends[1][lane]) = (segment.ray.s_min, segment.s_max);
    }
    ends
}

impl Blockable for Segments<'_> {
    #[inline(always)]
    fn segment(self, ray: usize) -> Segment {
        self.segments[ray]
    }

    #[inline(always)]
    fn passes(self, ray: usize, triangle: u32) -> bool {
        let Segment { skip, end, .. } = &self.segments[ray];
        [*skip, *end].contains(&Some(triangle))
    }

    #[inline(always)]
    fn ends(self, order: &[u32; RAYS], _: bool) -> [[f64; RAYS]; 2] {
        ends_of(self.segments, order)
    }
}

impl Blockable for SegmentsToPoint<'_> {
    #[inline(always)]
    fn segment(self, ray: usize) -> Segment {
        self.segments[ray]
    }

    #[inline(always)]
    fn passes(self, ray: usize, triangle: u32) -> bool {
        let Segment { skip, end, .. } = &self.segments[ray];
        [*skip, *end].contains(&Some(triangle))
    }

    #[inline(always)]
    fn ends(self, order: &[u32; RAYS], _: bool) -> [[f64; RAYS]; 2] {
        ends_of(self.segments, order)
    }
}
