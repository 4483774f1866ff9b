//! Blocks: up to 64 coherent rays, which start at or near one point and have similar directions.
//!
//! **(K1) Parameter.** Directions of a block are scaled by one power of two, chosen for its first ray, so that |d|∞ is about 1; τ is
//! measured in units of them and in tree space.
//!
//! **(K2) Coherence.** No |d|∞ of a block is below 1/4 or above 4. The point near the rays is within 2¹⁰ scene sizes, and origins are
//! within 2¹² of it, so a box, |y| ≤ 1, is hit at τ < 4 (2¹⁰ + 2¹² + 1) < 2¹⁵. The limit of 3/4 on differences of directions along an axis
//! is chosen for speed: wider beams cull too little. No bound depends on it. In a small tree there is little to cull, and rays in all
//! directions are traced together, too.
//!
//! **(K3) Bounds of rounded numbers.** Directions, moments and offsets are stored in f32, each within 2⁻²⁴ of its size, and sums of three
//! of them have two more roundings. The bounds D, M, ωᵢ and F of [`setup`](super::setup) hold for the numbers before rounding: they are the
//! maxima of the rounded ones times 1.001, far above 1 + 2⁻²².
//!
//! **(K4) Limits.** s as computed for single rays has an error below 2⁻⁴⁰ of a triangle's distance ([`triangle`](crate::accel::triangle)),
//! which is at most 4 τ + 4 in tree space; with |d|∞ ≥ 1/4 that is 2⁻³⁶(1 + τ) in τ. Rounding to f32 adds 2⁻²⁴ τ. Known hits are bounded by
//! factors 1 ± 2⁻²², and boxes are kept up to (1 + 2⁻²¹) τ + 2⁻²⁶.
//!
//! **(K5) Nearby starts.** Rays that start within ωᵢ of a point along each axis may be treated as if all started at that point: without
//! offsets and moments, which halves the work per triangle. The contributions of δ are then unknown: e·m in U, V and W, where m = δ × d,
//! |m|∞ ≤ M' = max (ωⱼ|dₖ| + ωₖ|dⱼ|), and n·δ, at most ω l₁l₂, in n·a. They are added to the bounds of [`setup`](super::setup). s is still
//! measured along the ray itself, and boxes are tested for the box of starts, as with own origins. If ω is a small fraction of a pixel, few
//! rays pass an edge so closely that it matters.

use glam::DVec3;

use super::ray_set::{RAYS, RaySet};
use super::simd::Simd;
use crate::accel::bvh::View;
use crate::accel::float::{exponent, greater, lesser, norm1, power_of_two};
use crate::accel::rays::Hit;
use crate::accel::tree_space::TreeSpace;

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;
/// Marks slots of triangles that were hit on their front, in blocks that are not certified.
pub(super) const FRONT: u32 = 1 << 31;
/// Origins farther than this many scene sizes are left to single rays, which rebase them: (K2).
const FAR: f64 = power_of_two(10);
/// |d|∞ is between 1/4 and 4: (K2).
pub(super) const SPREAD: f32 = 4.0;
/// Directions differ by no more than this along any axis: (K2).
const COHERENT: f32 = 0.75;
/// The factor in (K3).
const ABOVE: f32 = 1.001;

/// The rays, and their nearest hits so far.
#[repr(C, align(64))]
pub(super) struct Block {
    /// Directions, axis by axis.
    pub directions: [[f32; RAYS]; 3],
    /// Starts of rays relative to the point in the bounds, δ, and moments δ × d, axis by axis: see [`setup`](super::setup). Only for rays
    /// with their own origins.
    pub offsets: [[f32; RAYS]; 3],
    pub moments: [[f32; RAYS]; 3],
    /// Bounds on τ of the nearest hit.
    pub near: [f32; RAYS],
    pub far: [f32; RAYS],
    /// Barycentrics of the nearest hit, if it need not be certified.
    pub barycentrics: [[f32; RAYS]; 2],
    /// The slot of the nearest hit.
    pub slots: [u32; RAYS],
    /// Which lanes have a hit, as bits.
    pub hit: u64,
    /// The ray's index in the batch.
    pub order: [u32; RAYS],
    /// The triangle that each ray leaves, if rays leave any.
    left: Option<[u32; RAYS]>,
    /// The number of rays; the remaining lanes repeat the first, and do not count.
    pub count: usize,
    /// Whether every four rays in `order` are consecutive in the batch.
    pub in_fours: bool,
    /// τ per unit of s.
    pub tau_from_s: f64,
}

/// Common properties of the rays of a block, in tree space.
pub(super) struct BlockBounds {
    /// A point near which the rays pass.
    pub point: DVec3,
    /// Minimum and maximum direction per axis.
    pub directions: [[f32; 2]; 3],
    /// The same for moments about the point.
    pub moments: [[f32; 2]; 3],
    /// The maximal distance of starts from the point, per axis: ωᵢ.
    pub offsets: [f32; 3],
    /// The maximum of |d|∞: D.
    pub max_direction: f32,
    /// The maximum of |moment|∞: M.
    pub max_moment: f32,
    /// The maximal distance of origins from the point, summed over the axes: F.
    pub max_distance: f32,
    /// The maximum of |δ × d|∞ for rays treated as starting at the point: (K5).
    pub shift_moment: f32,
    /// Whether rays are traced from their ends.
    pub reversed: bool,
}

/// Whether a point is too far for packets, in tree space; also for NaN.
#[inline(always)]
pub(super) fn is_far(point: DVec3) -> bool {
    let near = point.abs().cmple(DVec3::splat(FAR));
    !near.all()
}

impl Block {
    pub const EMPTY: Block = Block {
        directions: [[0.0; RAYS]; 3],
        offsets: [[0.0; RAYS]; 3],
        moments: [[0.0; RAYS]; 3],
        near: [0.0; RAYS],
        far: [0.0; RAYS],
        barycentrics: [[0.0; RAYS]; 2],
        slots: [NONE; RAYS],
        hit: 0,
        order: [0; RAYS],
        left: None,
        count: 0,
        in_fours: false,
        tau_from_s: 1.0,
    };

    /// Loads the rays in `order`; `None` if they are incoherent.
    #[inline(always)]
    pub fn load<K: Simd, R: RaySet>(&mut self, k: K, bvh: View, rays: R) -> Option<BlockBounds> {
        let space = &bvh.tree.space;
        // (K1).
        let first = rays.direction(self.order[0] as usize).abs().max_element();
        if !(power_of_two(-500)..power_of_two(500)).contains(&first) {
            return None;
        }
        let unit = power_of_two(-exponent(first));
        self.tau_from_s = space.scale * power_of_two(exponent(first));
        self.load_directions(k, rays, unit);
        // In a small tree rays may be incoherent: (K2).
        let apart = if bvh.is_small() {
            f32::INFINITY
        } else {
            COHERENT
        };
        let directions = self.direction_intervals(k, apart)?;
        self.load_left(rays);
        let mut bounds = BlockBounds {
            point: DVec3::ZERO,
            directions,
            moments: [[0.0; 2]; 3],
            offsets: [0.0; 3],
            max_direction: greatest(&directions) * ABOVE,
            max_moment: 0.0,
            max_distance: 0.0,
            shift_moment: 0.0,
            reversed: rays.is_reversed(),
        };
        match rays.shared_origin() {
            Some(origin) => share_origin(origin, space, rays, &mut bounds)?,
            None => self.load_origins(k, space, rays, unit, &mut bounds)?,
        }
        Some(bounds)
    }

    /// Whether some of the rays in `order` differ so much that [`Block::load`] rejects them in a large tree. Checks a few in scalar code:
    /// blocks of incoherent rays end here, before wide vector instructions, for which some processors lower their clock.
    #[inline(always)]
    pub fn is_certainly_incoherent(&self, bvh: View, direction: impl Fn(usize) -> DVec3) -> bool {
        // Two lanes of each quarter of the block, including the first and the last lane.
        const STRIDE: usize = 9;
        // A little more than in `load`, where directions are rounded to f32.
        const APART: f64 = COHERENT as f64 * (1.0 + power_of_two(-20));
        let first = direction(self.order[0] as usize);
        let size = first.abs().max_element();
        if bvh.is_small() || !(power_of_two(-500)..power_of_two(500)).contains(&size) {
            return false;
        }
        // In the units of (K1).
        let apart = APART * power_of_two(exponent(size));
        let mut differs = false;
        for lane in (STRIDE..RAYS).step_by(STRIDE) {
            let other = direction(self.order[lane] as usize);
            differs |= (other - first).abs().max_element() > apart;
        }
        differs
    }

    /// Stores the triangles that rays leave.
    #[inline(always)]
    fn load_left<R: RaySet>(&mut self, rays: R) {
        self.left = None;
        if rays.leaves() {
            let left = self.left.insert([NONE; RAYS]);
            for (slot, &ray) in left.iter_mut().zip(&self.order) {
                *slot = rays.left(ray as usize);
            }
        }
    }

    /// The rays from `first` on that leave this triangle, as bits.
    #[inline(always)]
    pub fn leaving<K: Simd>(&self, first: usize, triangle: u32) -> u32 {
        let mut bits = 0;
        if let Some(left) = &self.left {
            for (lane, left) in left[first..][..K::LANES].iter().enumerate() {
                bits |= u32::from(*left == triangle) << lane;
            }
        }
        bits
    }

    /// Loads directions, times `unit`.
    #[inline(always)]
    fn load_directions<K: Simd, R: RaySet>(&mut self, k: K, rays: R, unit: f64) {
        if let (Some(targets), Some(origin), true) =
            (rays.targets(), rays.shared_origin(), self.in_fours)
        {
            // From the shared start to their targets.
            let mut axis = 0;
            while axis < 3 {
                let (targets, to) = (targets[axis], &mut self.directions[axis]);
                let mut first = 0;
                while first < RAYS {
                    let ray = self.order[first] as usize;
                    let four = &targets[ray..ray + 4];
                    for i in 0..4 {
                        to[first + i] = ((four[i] - origin[axis]) * unit) as f32;
                    }
                    first += 4;
                }
                axis += 1;
            }
            return;
        }
        // Four consecutive vectors at a time, or one by one.
        let [xs, ys, zs] = &mut self.directions;
        match rays.directions() {
            Some(directions) if self.in_fours => {
                let mut first = 0;
                while first < RAYS {
                    let ray = self.order[first] as usize;
                    let (x, y, z) = (&mut xs[first..], &mut ys[first..], &mut zs[first..]);
                    k.store_vectors(&directions[ray..ray + 4], unit, [x, y, z]);
                    first += 4;
                }
            }
            _ => {
                for (lane, &ray) in self.order.iter().enumerate() {
                    let d = rays.direction(ray as usize) * unit;
                    (xs[lane], ys[lane], zs[lane]) = (d.x as f32, d.y as f32, d.z as f32);
                }
            }
        }
    }

    /// Loads the rays' starts, relative to the middle of the box of all starts; `None` if that is too far.
    #[inline(always)]
    fn load_origins<K: Simd, R: RaySet>(
        &mut self,
        k: K,
        space: &TreeSpace,
        rays: R,
        unit: f64,
        bounds: &mut BlockBounds,
    ) -> Option<()> {
        let mut starts = [[0.0; RAYS]; 3];
        let mut directions = [[0.0; RAYS]; 3];
        self.gather(k, rays, &mut starts, &mut directions);
        let point = centre(&starts);
        bounds.point = space.map(point);
        if is_far(bounds.point) {
            return None;
        }
        // δ.
        let mut axis = 0;
        while axis < 3 {
            let (start, direction) = (&mut starts[axis], &mut directions[axis]);
            for lane in 0..RAYS {
                start[lane] = (start[lane] - point[axis]) * space.scale;
                direction[lane] *= unit;
                self.offsets[axis][lane] = start[lane] as f32;
            }
            axis += 1;
        }
        // m = δ × d.
        axis = 0;
        while axis < 3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            for lane in 0..RAYS {
                let moment = starts[next][lane] * directions[last][lane]
                    - starts[last][lane] * directions[next][lane];
                self.moments[axis][lane] = moment as f32;
            }
            axis += 1;
        }
        // ωᵢ, M and F: (K3).
        let offsets = interval(k, &self.offsets);
        axis = 0;
        while axis < 3 {
            bounds.offsets[axis] = greater32(-offsets[axis][0], offsets[axis][1]) * ABOVE;
            axis += 1;
        }
        bounds.moments = interval(k, &self.moments);
        bounds.max_moment = greatest(&bounds.moments) * ABOVE;
        bounds.max_distance = bounds.offsets[0] + bounds.offsets[1] + bounds.offsets[2];
        // F refers to the given starts: (E5) of `setup` bounds the f64 errors from there.
        if rays.is_reversed() {
            bounds.max_distance = self.max_distance(space, rays, point);
        }
        // Origins within 2¹²: (K2).
        let size = f64::from(bounds.max_distance);
        (size + f64::from(bounds.max_moment) <= 4.0 * FAR && is_finite(k, &self.moments))
            .then_some(())
    }

    /// Starts and directions of the rays, axis by axis.
    #[inline(always)]
    fn gather<K: Simd, R: RaySet>(
        &self,
        k: K,
        rays: R,
        [xs, ys, zs]: &mut [[f64; RAYS]; 3],
        [us, vs, ws]: &mut [[f64; RAYS]; 3],
    ) {
        match (rays.origins(), rays.directions()) {
            (Some(origins), Some(directions)) if self.in_fours => {
                // Four consecutive vectors at a time: twelve numbers are loaded and split by axes in registers.
                let mut at = 0;
                while at < RAYS {
                    let ray = self.order[at] as usize;
                    let (starts, directions) = (&origins[ray..ray + 4], &directions[ray..ray + 4]);
                    let to = [&mut xs[at..], &mut ys[at..], &mut zs[at..]];
                    k.split_vectors(starts, to);
                    let to = [&mut us[at..], &mut vs[at..], &mut ws[at..]];
                    k.split_vectors(directions, to);
                    at += 4;
                }
            }
            _ => {
                for (lane, &ray) in self.order.iter().enumerate() {
                    let (o, d) = (rays.start(ray as usize), rays.direction(ray as usize));
                    (xs[lane], ys[lane], zs[lane]) = (o.x, o.y, o.z);
                    (us[lane], vs[lane], ws[lane]) = (d.x, d.y, d.z);
                }
            }
        }
    }

    /// The maximal distance of the given starts from `point`.
    #[inline(always)]
    fn max_distance<R: RaySet>(&self, space: &TreeSpace, rays: R, point: DVec3) -> f32 {
        let mut farthest = 0.0;
        for &ray in &self.order {
            let distance = norm1((rays.origin(ray as usize) - point) * space.scale);
            // Infinite for NaN.
            farthest = if distance <= farthest {
                farthest
            } else {
                distance
            };
        }
        farthest as f32 * ABOVE
    }

    /// Minimum and maximum direction along each axis; `None` if they differ by more than `apart`, or are incoherent.
    #[inline(always)]
    fn direction_intervals<K: Simd>(&self, k: K, apart: f32) -> Option<[[f32; 2]; 3]> {
        let zero = k.splat(0.0);
        let (mut size, mut broken) = (k.splat(f32::INFINITY), zero);
        let mut least = [k.splat(f32::INFINITY); 3];
        let mut greatest = [k.splat(f32::NEG_INFINITY); 3];
        let mut first = 0;
        while first < RAYS {
            let mut length = zero;
            let mut axis = 0;
            while axis < 3 {
                let d = k.load(&self.directions[axis][first..]);
                least[axis] = k.min(least[axis], d);
                greatest[axis] = k.max(greatest[axis], d);
                // NaN if any is: ∞·0 and NaN·0.
                broken = k.mul_add(d, zero, broken);
                length = k.max(length, k.max(d, k.sub(zero, d)));
                axis += 1;
            }
            size = k.min(size, length);
            first += K::LANES;
        }
        let mut extent = [[0.0; 2]; 3];
        // No |d|∞ below 1/4, and none above 4: (K2).
        let mut coherent = k.smallest(size) > 1.0 / SPREAD;
        let mut axis = 0;
        while axis < 3 {
            let (lo, hi) = (k.smallest(least[axis]), k.greatest(greatest[axis]));
            coherent &= hi - lo <= apart && hi < SPREAD && lo > -SPREAD;
            extent[axis] = [lo, hi];
            axis += 1;
        }
        coherent &= k.le(broken, zero) == u32::MAX >> (32 - K::LANES);
        if coherent { Some(extent) } else { None }
    }

    /// Clears all hits; afterwards, only hits nearer than those in `hits`, indexed by the batch, count.
    #[inline(always)]
    pub fn reset(&mut self, hits: &[Option<Hit>]) {
        self.near = [f32::INFINITY; RAYS];
        self.far = [f32::INFINITY; RAYS];
        self.slots = [NONE; RAYS];
        self.hit = 0;
        // Usually there are no earlier hits, and no lane needs individual treatment.
        let mut known = false;
        for &ray in &self.order {
            known |= hits[ray as usize].is_some();
        }
        if known {
            self.limit_to(hits);
        }
        // Lanes without a ray are never nearer.
        for lane in self.count..RAYS {
            (self.near[lane], self.far[lane]) = (-1.0, -1.0);
        }
    }

    fn limit_to(&mut self, hits: &[Option<Hit>]) {
        for (lane, &ray) in self.order.iter().enumerate() {
            if let Some(hit) = &hits[ray as usize] {
                self.far[lane] = upper(hit.s * self.tau_from_s);
            }
        }
    }

    /// Sets the nearest hit of a lane to one at `s` of the ray: (K4).
    pub fn set_hit(&mut self, lane: usize, slot: u32, s: f64) {
        let tau = s * self.tau_from_s;
        self.near[lane] = (tau * (1.0 - power_of_two(-22))) as f32;
        self.far[lane] = upper(tau);
        self.slots[lane] = slot;
        self.hit |= 1 << lane;
    }

    /// The τ beyond which no ray can have a nearer hit: (K4).
    #[inline(always)]
    pub fn limit<K: Simd>(&self, k: K) -> f32 {
        let mut far = k.load(&self.far);
        for at in (K::LANES..RAYS).step_by(K::LANES) {
            far = k.max(far, k.load(&self.far[at..]));
        }
        let far = k.greatest(far);
        let limit = far * (1.0 + power_of_two(-21) as f32) + power_of_two(-26) as f32;
        // Finite, as it is multiplied by numbers that may be 0.
        if limit < f32::MAX { limit } else { f32::MAX }
    }
}

/// Stores the common start; `None` if it, or the given starts, are too far away.
#[inline(always)]
fn share_origin<R: RaySet>(
    origin: DVec3,
    space: &TreeSpace,
    rays: R,
    bounds: &mut BlockBounds,
) -> Option<()> {
    bounds.point = space.map(origin);
    let farthest = rays.farthest_origin() * space.scale;
    bounds.max_distance = farthest as f32 * ABOVE;
    // (K5).
    let extent = (rays.origin_extent() * space.scale).as_vec3() * ABOVE;
    bounds.offsets = extent.to_array();
    let most = |[lo, hi]: [f32; 2]| greater32(-lo, hi);
    let [x, y, z] = bounds.directions.map(most);
    // The maximum of |δ × d|, axis by axis.
    let moment = [
        extent.y * z + extent.z * y,
        extent.z * x + extent.x * z,
        extent.x * y + extent.y * x,
    ];
    bounds.shift_moment = greater32(greater32(moment[0], moment[1]), moment[2]) * ABOVE;
    // The condition on origins in (K2); false for NaN.
    (!is_far(bounds.point) && farthest <= 4.0 * FAR).then_some(())
}

/// An f32 above a parameter: (K4).
#[inline(always)]
fn upper(tau: f64) -> f32 {
    (tau * (1.0 + power_of_two(-22))) as f32
}

/// The middle of the box of points.
#[inline(always)]
fn centre(points: &[[f64; RAYS]; 3]) -> DVec3 {
    let mut centre = DVec3::ZERO;
    let mut axis = 0;
    while axis < 3 {
        // Eight at a time, in vectors, then the remaining ones.
        let (mut lo, mut hi) = ([points[axis][0]; 8], [points[axis][0]; 8]);
        let mut first = 0;
        while first < RAYS {
            for i in 0..8 {
                lo[i] = lesser(points[axis][first + i], lo[i]);
                hi[i] = greater(points[axis][first + i], hi[i]);
            }
            first += 8;
        }
        for i in 1..8 {
            (lo[0], hi[0]) = (lesser(lo[0], lo[i]), greater(hi[0], hi[i]));
        }
        // Halved first: the sum of the two could be infinite.
        centre[axis] = lo[0] * 0.5 + hi[0] * 0.5;
        axis += 1;
    }
    centre
}

/// Whether all numbers are finite.
#[inline(always)]
fn is_finite<K: Simd>(k: K, vectors: &[[f32; RAYS]; 3]) -> bool {
    let zero = k.splat(0.0);
    let mut broken = zero;
    for numbers in vectors {
        let mut first = 0;
        while first < RAYS {
            broken = k.mul_add(k.load(&numbers[first..]), zero, broken);
            first += K::LANES;
        }
    }
    k.le(broken, zero) == u32::MAX >> (32 - K::LANES)
}

/// Minimum and maximum along each axis.
#[inline(always)]
fn interval<K: Simd>(k: K, vectors: &[[f32; RAYS]; 3]) -> [[f32; 2]; 3] {
    let mut intervals = [[0.0; 2]; 3];
    let mut axis = 0;
    while axis < 3 {
        let mut least = k.load(&vectors[axis]);
        let mut most = least;
        let mut first = K::LANES;
        while first < RAYS {
            let x = k.load(&vectors[axis][first..]);
            (least, most) = (k.min(least, x), k.max(most, x));
            first += K::LANES;
        }
        intervals[axis] = [k.smallest(least), k.greatest(most)];
        axis += 1;
    }
    intervals
}

/// The maximum absolute value.
#[inline(always)]
fn greatest(intervals: &[[f32; 2]; 3]) -> f32 {
    let mut most = 0.0f32;
    for x in intervals.as_flattened() {
        most = greater32(most, x.abs());
    }
    most
}

#[inline(always)]
fn greater32(x: f32, y: f32) -> f32 {
    if x > y { x } else { y }
}
