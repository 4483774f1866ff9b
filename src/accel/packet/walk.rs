//! Single rays through the wide tree: eight boxes, and the triangles of a leaf, at a time.
//!
//! Boxes are tested as in [`slab`](crate::accel::slab), with its bounds. Of a leaf's triangles those that a ray certainly
//! misses are found in f32; the others are decided in f64 as everywhere, so that results are those of the binary tree.
//!
//! **(W1) Nearness.** The leaf's corners A are relative to its centre, and so is the point p of the ray that is nearest to that. Moving
//! along the ray changes no edge function. In f64 p is off by ρ of (S2) and 2⁻⁴⁶(1 + |r|), r from the centre; with the
//! error of the corners and that of p as f32, a = A − p is off by e = error + ρ + 2⁻⁴⁶(1 + |r|) + 2⁻²⁴|p|, and by its own 2⁻²⁴|a|.
//!
//! **(W2) Edge functions.** With m the largest coordinate of a, b and c and M = m + 2e, a product of two coordinates is off by
//! 2 M e + 2⁻²⁴ M² of its factors and as much again for their own rounding, a component of b × c by twice that and 2⁻²³ M²; and with
//! |d|∞ < 2, which is off by 2⁻²⁴ of itself, d·(b × c) in all by less than 36 M e + 108·2⁻²⁴ M². M (64 e + 256·2⁻²⁴ M) is more.
//! A ray hits where U, V and W have one sign: it certainly misses where one of them is below minus that, and one above.

use glam::DVec3;

use super::any_hits::SegmentSet;
use super::ray_set::RaySet;
use super::simd::{Simd, Task};
use super::traverse::StackEntry;
use crate::accel::bvh::Bvh;
use crate::accel::float::power_of_two;
use crate::accel::node::NodeRef;
use crate::accel::rays::Hit;
use crate::accel::single::{AnyHit, ClosestHit, ScaledRay};
use crate::accel::slab::SlabRay;
use crate::accel::tally::{Tally, Work};
use crate::accel::traverse::Query;
use crate::accel::wide::{WIDTH, WideLeaf};

/// The nearest hits of at most 64 rays, one by one; by place in `order`, bits say which hits were replaced.
pub(super) struct ClosestSingles<'a, R, T> {
    pub bvh: &'a Bvh,
    pub rays: R,
    /// Which of them.
    pub order: &'a [u32],
    pub hits: &'a mut [Option<Hit>],
    pub stack: &'a mut [StackEntry],
    pub tally: &'a mut T,
}

impl<R: RaySet, T: Tally> Task for ClosestSingles<'_, R, T> {
    type Output = u64;

    #[inline(always)]
    fn run<K: Simd>(self, k: K) -> u64 {
        self.tally.add(Work::Singles, self.order.len());
        let mut replaced = 0;
        for (place, ray) in self.order.iter().enumerate() {
            let at = *ray as usize;
            let s_max = match &self.hits[at] {
                Some(hit) => hit.s,
                None => f64::INFINITY,
            };
            let left = self.rays.left(at);
            let Some(ray) = ScaledRay::new(&self.rays.ray(at)) else {
                continue;
            };
            let mut query = ClosestHit::new(self.bvh, &ray, s_max, left, self.tally);
            walk(k.children(), self.bvh, &ray, self.stack, &mut query);
            if let Some(hit) = query.into_hit(&ray) {
                self.hits[at] = Some(hit);
                replaced |= 1 << place;
            }
        }
        replaced
    }
}

/// What blocks segments, one by one.
pub(super) struct AnySingles<'a, S, T> {
    pub bvh: &'a Bvh,
    pub segments: S,
    /// Which of them.
    pub order: &'a [u32],
    pub blocked: &'a mut [bool],
    pub stack: &'a mut [StackEntry],
    pub tally: &'a mut T,
}

impl<S: SegmentSet, T: Tally> Task for AnySingles<'_, S, T> {
    type Output = ();

    #[inline(always)]
    fn run<K: Simd>(self, k: K) {
        self.tally.add(Work::Singles, self.order.len());
        for at in self.order {
            let at = *at as usize;
            let segment = &self.segments.segment(at);
            let Some(ray) = ScaledRay::new(&segment.ray) else {
                self.blocked[at] = false;
                continue;
            };
            let mut query = AnyHit::new(self.bvh, &ray, segment, self.tally);
            walk(k.children(), self.bvh, &ray, self.stack, &mut query);
            self.blocked[at] = query.is_found();
        }
    }
}

/// Along one axis: which plane is nearer, and for both the origin and 1/d as (S3) and (S4) have them.
struct Slab<F> {
    near: usize,
    origins: [F; 2],
    inverse: [F; 2],
}

/// Puts `query` to the tree along `ray`, nearer children first.
#[inline(always)]
fn walk<K: Simd>(
    k: K,
    bvh: &Bvh,
    ray: &ScaledRay,
    stack: &mut [StackEntry],
    query: &mut impl Query,
) {
    let Some(slabs) = SlabRay::new(&bvh.space, &ray.line, ray.s_min) else {
        return;
    };
    let axes = [slab(k, &slabs, 0), slab(k, &slabs, 1), slab(k, &slabs, 2)];
    let filter = Filter::new(k, &slabs, ray.line.direction);
    let mut limit = query.limit();
    let mut far = slabs.far(limit);
    let mut waiting = 1;
    stack[0] = (0.0, NodeRef::ROOT);
    while waiting > 0 {
        waiting -= 1;
        let (entry, at) = stack[waiting];
        if entry > far {
            continue;
        }
        if at.is_leaf() {
            let leaf = &bvh.wide.leaves[at.index()];
            let mut candidates = filter.candidates(leaf);
            while candidates != 0 {
                let lane = candidates.trailing_zeros();
                candidates &= candidates - 1;
                if query.triangle((leaf.first + lane) as usize) {
                    return;
                }
            }
            // A nearer hit narrows the range.
            if query.limit() < limit {
                limit = query.limit();
                far = slabs.far(limit);
            }
            continue;
        }
        query.node();
        let node = &bvh.wide.nodes[at.index()];
        let (mut enter, mut leave) = (k.splat(0.0), k.splat(far));
        let mut axis = 0;
        while axis < 3 {
            let (slab, planes) = (&axes[axis], &node.planes[axis]);
            let near = k.sub(k.load(&planes[slab.near]), slab.origins[0]);
            let beyond = k.sub(k.load(&planes[1 - slab.near]), slab.origins[1]);
            enter = k.max(enter, k.mul(near, slab.inverse[0]));
            leave = k.min(leave, k.mul(beyond, slab.inverse[1]));
            axis += 1;
        }
        let mut entries = [0.0; WIDTH];
        k.store(&mut entries, enter);
        let mut hit = k.le(enter, leave);
        let first = waiting;
        while hit != 0 {
            let at = hit.trailing_zeros() as usize % WIDTH;
            hit &= hit - 1;
            // Insertion sort, the farthest deepest.
            let (entry, child) = (entries[at], node.children[at]);
            let mut place = waiting;
            while place > first && stack[place - 1].0 < entry {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place] = (entry, child);
            waiting += 1;
        }
    }
}

#[inline(always)]
fn slab<K: Simd>(k: K, ray: &SlabRay, axis: usize) -> Slab<K::F> {
    let [above, below] = ray.origins(axis);
    let [enter, leave] = ray.inverses(axis);
    match ray.descends[axis] {
        false => Slab {
            near: 0,
            origins: [k.splat(above), k.splat(below)],
            inverse: [k.splat(enter), k.splat(leave)],
        },
        true => Slab {
            near: 1,
            origins: [k.splat(below), k.splat(above)],
            inverse: [k.splat(-enter), k.splat(-leave)],
        },
    }
}

/// Which triangles of leaves a ray may hit.
struct Filter<K: Simd> {
    kernel: K,
    /// d, and as f32 in all lanes.
    direction: DVec3,
    lanes: [K::F; 3],
    /// 1/d².
    inverse_square: f64,
    /// A point of the ray in tree space, and ρ.
    base: DVec3,
    unsure: f64,
}

impl<K: Simd> Filter<K> {
    #[inline(always)]
    fn new(k: K, ray: &SlabRay, direction: DVec3) -> Self {
        Filter {
            kernel: k,
            direction,
            lanes: k.splat3([direction.x as f32, direction.y as f32, direction.z as f32]),
            inverse_square: 1.0 / direction.length_squared(),
            base: ray.base,
            unsure: ray.unsure,
        }
    }

    /// The triangles of `leaf` that the ray does not certainly miss, as bits.
    #[inline(always)]
    fn candidates(&self, leaf: &WideLeaf) -> u32 {
        let k = self.kernel;
        // p and e: (W1).
        let [x, y, z] = leaf.centre;
        let r = self.base - DVec3::new(f64::from(x), f64::from(y), f64::from(z));
        let p = r - self.direction * (r.dot(self.direction) * self.inverse_square);
        let (far, near) = (r.abs().max_element(), p.abs().max_element());
        let off = self.unsure + power_of_two(-46) * (1.0 + far) + power_of_two(-24) * near;
        let e = k.splat(leaf.error + off as f32 * (1.0 + f32::EPSILON));
        let p = k.splat3([p.x as f32, p.y as f32, p.z as f32]);

        // Corners from p, and their largest coordinate.
        let [a, b, c] = [
            self.corner(leaf, 0, &p),
            self.corner(leaf, 1, &p),
            self.corner(leaf, 2, &p),
        ];
        let mut m = k.splat(0.0);
        let mut axis = 0;
        while axis < 3 {
            let of_two = k.max(k.abs(a[axis]), k.abs(b[axis]));
            m = k.max(m, k.max(of_two, k.abs(c[axis])));
            axis += 1;
        }
        // (W2).
        let m = k.add(m, k.add(e, e));
        let part = k.mul_add(
            m,
            k.splat(256.0 * power_of_two(-24) as f32),
            k.mul(e, k.splat(64.0)),
        );
        let bound = k.mul(m, part);
        let (u, v, w) = (self.edge(&b, &c), self.edge(&c, &a), self.edge(&a, &b));
        let least = k.min(u, k.min(v, w));
        let greatest = k.max(u, k.max(v, w));
        let none_below = k.le(k.splat(0.0), k.add(least, bound));
        let none_above = k.le(greatest, bound);
        (none_below | none_above) & leaf.present
    }

    #[inline(always)]
    fn corner(&self, leaf: &WideLeaf, corner: usize, p: &[K::F; 3]) -> [K::F; 3] {
        let (k, from) = (self.kernel, &leaf.corners[corner]);
        [
            k.sub(k.load(&from[0]), p[0]),
            k.sub(k.load(&from[1]), p[1]),
            k.sub(k.load(&from[2]), p[2]),
        ]
    }

    /// d·(x × y).
    #[inline(always)]
    fn edge(&self, x: &[K::F; 3], y: &[K::F; 3]) -> K::F {
        let (k, d) = (self.kernel, &self.lanes);
        let cross = [
            k.mul_sub(x[1], y[2], k.mul(x[2], y[1])),
            k.mul_sub(x[2], y[0], k.mul(x[0], y[2])),
            k.mul_sub(x[0], y[1], k.mul(x[1], y[0])),
        ];
        k.dot(d, &cross, k.splat(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::packet::method::{Kernel, Method, Precision};
    use crate::accel::{Facing, NoTally, Origins, Ray, Segment, numbers};

    #[test]
    fn incoherent_rays_and_segments_find_what_the_binary_tree_finds() {
        let mut next = numbers(3);
        for (round, size) in [1.0f64, 0.05, 1e-4, 1e6].into_iter().enumerate() {
            let mut vector = || DVec3::new(next(), next(), next());
            let triangles: Vec<_> = (0..3000)
                .map(|k| {
                    // Some in one plane, and some as thin as a hair.
                    let centre = vector()
                        * if k % 3 == 0 {
                            DVec3::new(1.0, 1.0, 0.0)
                        } else {
                            DVec3::ONE
                        };
                    let (e1, e2) = (vector() * 0.1 * size.min(1.0), vector() * 0.1);
                    let e2 = if k % 5 == 0 {
                        e1 * 1.0001 + e2 * 1e-7
                    } else {
                        e2 * size.min(1.0)
                    };
                    [centre, centre + e1, centre + e2].map(|p| p * size.max(1.0))
                })
                .collect();
            let facing = |k: u32| match k % 7 {
                0 => Facing::FrontOnly,
                _ => Facing::TwoSided,
            };
            let corners = triangles.clone();
            let bvh = Bvh::build(triangles, facing);
            // Through corners and edges too, and along axes.
            let mut rays = Vec::new();
            for k in 0..4000 {
                let from = vector() * 3.0 * size.max(1.0);
                let triangle = corners[k % corners.len()];
                let to = match k % 4 {
                    0 => triangle[k % 3],
                    1 => triangle[0].midpoint(triangle[1]),
                    2 => (triangle[0] + triangle[1] + triangle[2]) / 3.0,
                    _ => from + DVec3::AXES[k % 3],
                };
                rays.push((from, to - from));
            }
            let (origins, directions): (Vec<_>, Vec<_>) = rays.iter().copied().unzip();
            let segments: Vec<_> = rays
                .iter()
                .map(|&(origin, direction)| Segment {
                    ray: Ray {
                        origin,
                        direction,
                        s_min: 1e-9,
                    },
                    s_max: 0.999,
                    skip: Some(17),
                    end: None,
                })
                .collect();
            let trace = |kernel| {
                let method = Method {
                    kernel,
                    precision: Precision::Certified,
                };
                let mut hits = vec![None; rays.len()];
                bvh.closest_by(
                    method,
                    Origins::Each(&origins),
                    &directions,
                    &mut hits,
                    &mut NoTally,
                    |_| (),
                );
                let mut blocked = vec![false; rays.len()];
                bvh.any_by(method, &segments, &mut blocked, &mut NoTally);
                (hits, blocked)
            };
            let expected = trace(Kernel::Scalar);
            assert!(
                expected.0.iter().filter(|hit| hit.is_some()).count() > 1000,
                "{round}"
            );
            for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
                assert!(trace(kernel) == expected, "{kernel:?}, size {size}");
            }
        }
    }
}
