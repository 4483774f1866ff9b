//! Blocks: up to 64 rays from one point, or from points near one another, that go nearly the same way.
//!
//! **Parameter.** Directions of a block are scaled by one power of two, that of its first ray, so that
//! |d|∞ is about 1; τ is measured in them and in the tree's unit.

use glam::DVec3;

use super::bundle::Bundle;
use super::simd::Simd;
use super::{FAR, is_far};
use crate::accel::Hit;
use crate::accel::slab::{Lattice, exponent, power_of_two};
use crate::accel::triangle::{greater, lesser, norm1};

/// Rays of a block.
pub(super) const RAYS: usize = 64;
/// No triangle.
pub(super) const NONE: u32 = u32::MAX;
/// Within a block |d|∞ differs by no more than this factor.
const SPREAD: f32 = 4.0;
/// Directions of a block differ by no more than this along any axis.
const COHERENT: f32 = 0.75;

/// Rays, and the nearest hits so far.
#[repr(C, align(64))]
pub(super) struct Block {
    /// Directions, axis by axis.
    pub directions: [[f32; RAYS]; 3],
    /// Where rays start relative to the view's point, and δ × d, axis by axis: see
    /// [`facets`](super::facets). Only of rays with origins of their own.
    pub offsets: [[f32; RAYS]; 3],
    pub moments: [[f32; RAYS]; 3],
    /// Bounds of τ of the nearest hit.
    pub near: [f32; RAYS],
    pub far: [f32; RAYS],
    /// Barycentrics of the nearest hit, if nobody is to certify it.
    pub weights: [[f32; RAYS]; 2],
    /// The slot of the nearest hit.
    pub slots: [u32; RAYS],
    /// The ray's place in the batch.
    pub order: [u32; RAYS],
    /// How many rays there are; the rest repeat the first, and don't count.
    pub count: usize,
    /// Whether every four rays in `order` follow each other in the batch.
    pub in_fours: bool,
    /// s of a ray is so many τ.
    pub tau_from_s: f64,
}

/// What is known of all rays of a block, in the frame of the boxes.
pub(super) struct View {
    /// A point near which the rays pass.
    pub point: DVec3,
    /// Per axis least and greatest direction.
    pub directions: [[f32; 2]; 3],
    /// The same of moments about the point.
    pub moments: [[f32; 2]; 3],
    /// How far from the point rays start, per axis.
    pub offsets: [f32; 3],
    /// |d|∞ at most.
    pub reach: f32,
    /// |moment|∞ at most.
    pub turn: f32,
    /// No ray's origin is farther from the point, in sum over the axes.
    pub farthest: f32,
    /// Whether rays are traced from their ends.
    pub reversed: bool,
}

impl Block {
    pub const EMPTY: Block = Block {
        directions: [[0.0; RAYS]; 3],
        offsets: [[0.0; RAYS]; 3],
        moments: [[0.0; RAYS]; 3],
        near: [0.0; RAYS],
        far: [0.0; RAYS],
        weights: [[0.0; RAYS]; 2],
        slots: [NONE; RAYS],
        order: [0; RAYS],
        count: 0,
        in_fours: false,
        tau_from_s: 1.0,
    };

    /// Takes over the rays in `order`; none if they don't go together.
    #[inline(always)]
    pub fn aim<K: Simd, B: Bundle>(&mut self, k: K, lattice: &Lattice, rays: B) -> Option<View> {
        let first = rays.direction(self.order[0] as usize).abs().max_element();
        if !(power_of_two(-500)..power_of_two(500)).contains(&first) {
            return None;
        }
        let unit = power_of_two(-exponent(first));
        self.tau_from_s = lattice.scale * power_of_two(exponent(first));
        self.turn_to(k, rays, unit);
        let directions = self.extent(k)?;
        let mut view = View {
            point: DVec3::ZERO,
            directions,
            moments: [[0.0; 2]; 3],
            offsets: [0.0; 3],
            reach: greatest(&directions) * 1.001,
            turn: 0.0,
            farthest: 0.0,
            reversed: rays.is_reversed(),
        };
        match rays.shared_origin() {
            Some(origin) => view.point = lattice.place(origin),
            None => self.stand(k, lattice, rays, unit, &mut view)?,
        }
        Some(view)
    }

    /// Takes over directions.
    #[inline(always)]
    fn turn_to<K: Simd, B: Bundle>(&mut self, k: K, rays: B, unit: f64) {
        let [xs, ys, zs] = &mut self.directions;
        match rays.directions() {
            Some(directions) if self.in_fours => {
                let mut first = 0;
                while first < RAYS {
                    let ray = self.order[first] as usize;
                    let (x, y, z) = (&mut xs[first..], &mut ys[first..], &mut zs[first..]);
                    k.store_vectors(&directions[ray..ray + 4], unit, x, y, z);
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

    /// Takes over where rays start: about the middle of the box of all.
    #[inline(always)]
    fn stand<K: Simd, B: Bundle>(
        &mut self,
        k: K,
        lattice: &Lattice,
        rays: B,
        unit: f64,
        view: &mut View,
    ) -> Option<()> {
        let mut starts = [[0.0; RAYS]; 3];
        let mut directions = [[0.0; RAYS]; 3];
        self.gather(k, rays, &mut starts, &mut directions);
        let point = centre(&starts);
        view.point = lattice.place(point);
        if is_far(view.point) {
            return None;
        }
        let mut axis = 0;
        while axis < 3 {
            let (start, direction) = (&mut starts[axis], &mut directions[axis]);
            for lane in 0..RAYS {
                start[lane] = (start[lane] - point[axis]) * lattice.scale;
                direction[lane] *= unit;
                self.offsets[axis][lane] = start[lane] as f32;
            }
            axis += 1;
        }
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
        let offsets = interval(k, &self.offsets);
        axis = 0;
        while axis < 3 {
            view.offsets[axis] = greater32(-offsets[axis][0], offsets[axis][1]) * 1.001;
            axis += 1;
        }
        view.moments = interval(k, &self.moments);
        view.turn = greatest(&view.moments) * 1.001;
        view.farthest = view.offsets[0] + view.offsets[1] + view.offsets[2];
        if rays.is_reversed() {
            view.farthest = self.farthest(lattice, rays, point);
        }
        let size = f64::from(view.farthest);
        (size + f64::from(view.turn) <= 4.0 * FAR && is_whole(k, &self.moments)).then_some(())
    }

    /// Starts and directions of the rays, axis by axis.
    #[inline(always)]
    fn gather<K: Simd, B: Bundle>(
        &self,
        k: K,
        rays: B,
        [xs, ys, zs]: &mut [[f64; RAYS]; 3],
        [us, vs, ws]: &mut [[f64; RAYS]; 3],
    ) {
        match (rays.origins(), rays.directions()) {
            (Some(origins), Some(directions)) if self.in_fours => {
                let mut at = 0;
                while at < RAYS {
                    let ray = self.order[at] as usize;
                    let (starts, directions) = (&origins[ray..ray + 4], &directions[ray..ray + 4]);
                    k.split_vectors(starts, &mut xs[at..], &mut ys[at..], &mut zs[at..]);
                    k.split_vectors(directions, &mut us[at..], &mut vs[at..], &mut ws[at..]);
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

    /// How far from `point` rays start as given.
    #[inline(always)]
    fn farthest<B: Bundle>(&self, lattice: &Lattice, rays: B, point: DVec3) -> f32 {
        let mut farthest = 0.0;
        for &ray in &self.order {
            let distance = norm1((rays.origin(ray as usize) - point) * lattice.scale);
            // Infinite for NaN.
            farthest = if distance <= farthest {
                farthest
            } else {
                distance
            };
        }
        farthest as f32 * 1.001
    }

    /// Least and greatest direction along each axis; none if they don't go together.
    #[inline(always)]
    fn extent<K: Simd>(&self, k: K) -> Option<[[f32; 2]; 3]> {
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
                // NaN, if there is one: ∞·0 and NaN·0.
                broken = k.mul_add(d, zero, broken);
                length = k.max(length, k.max(d, k.sub(zero, d)));
                axis += 1;
            }
            size = k.min(size, length);
            first += K::LANES;
        }
        let mut extent = [[0.0; 2]; 3];
        let mut together = k.smallest(size) > 1.0 / SPREAD;
        let mut axis = 0;
        while axis < 3 {
            let (lo, hi) = (k.smallest(least[axis]), k.greatest(greatest[axis]));
            together &= hi - lo <= COHERENT && hi < SPREAD && lo > -SPREAD;
            extent[axis] = [lo, hi];
            axis += 1;
        }
        together &= k.le(broken, zero) == u32::MAX >> (32 - K::LANES);
        if together { Some(extent) } else { None }
    }

    /// Forgets all hits; of interest is what is nearer than those in `hits`, which are of the batch.
    #[inline(always)]
    pub fn start(&mut self, hits: &[Option<Hit>]) {
        self.near = [f32::INFINITY; RAYS];
        self.far = [f32::INFINITY; RAYS];
        self.slots = [NONE; RAYS];
        let mut known = false;
        for &ray in &self.order {
            known |= hits[ray as usize].is_some();
        }
        if known {
            self.limit_to(hits);
        }
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

    /// Replaces the nearest hit of a lane by one at `s` of the ray.
    pub fn set(&mut self, lane: usize, slot: u32, s: f64) {
        let tau = s * self.tau_from_s;
        self.near[lane] = (tau * (1.0 - power_of_two(-22))) as f32;
        self.far[lane] = upper(tau);
        self.slots[lane] = slot;
    }

    /// The τ beyond which no ray has an interest. Computed parameters may be off by 2⁻⁴⁰ of a
    /// triangle's distance, which is below 2¹¹.
    #[inline(always)]
    pub fn limit<K: Simd>(&self, k: K) -> f32 {
        let mut far = k.load(&self.far);
        for at in (K::LANES..RAYS).step_by(K::LANES) {
            far = k.max(far, k.load(&self.far[at..]));
        }
        let far = k.greatest(far);
        let limit = far * (1.0 + power_of_two(-21) as f32) + power_of_two(-26) as f32;
        if limit < f32::MAX { limit } else { f32::MAX }
    }
}

/// f32 above a parameter.
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
        centre[axis] = lo[0] * 0.5 + hi[0] * 0.5;
        axis += 1;
    }
    centre
}

/// Whether all numbers are finite.
#[inline(always)]
fn is_whole<K: Simd>(k: K, vectors: &[[f32; RAYS]; 3]) -> bool {
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

/// Least and greatest along each axis.
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

/// The greatest modulus.
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
