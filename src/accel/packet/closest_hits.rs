//! Closest hits of a block: f32 answers no, yes or "ask f64".

use super::beam::Beam;
use super::block::{Block, FRONT, NONE};
use super::quarters::{ALL, PER_QUARTER, Quarters};
use super::ray_set::{RAYS, RaySet};
use super::refine::RefinedHits;
use super::setup::{LeafTriangles, PacketTriangle};
use super::simd::{Simd, Task, load_vectors};
use super::traverse::{BlockQuery, Outcome, StackEntry, traverse};
use crate::accel::bvh::View;
use crate::accel::rays::Hit;
use crate::accel::single::ScaledRay;
use crate::accel::tally::{Counts, Work};
use crate::accel::vectors::prefetch_all;
use crate::accel::wide::WIDTH;

/// The number of candidates in a leaf from which on testing by quarters pays (measured with 2 to 5, on meshes of pixel-sized and larger
/// triangles).
const SEVERAL: u32 = 2;

/// Finds the closest hits of the rays in a block; results go to the block and to `refined`.
pub(super) struct ClosestHits<'a, R, const CERTIFIED: bool> {
    pub bvh: View<'a>,
    pub rays: R,
    /// Earlier hits, for all rays of the batch.
    pub hits: &'a [Option<Hit>],
    pub block: &'a mut Block,
    pub refined: &'a mut RefinedHits,
    /// Space for all entries that can be pending.
    pub stack: &'a mut [StackEntry],
    /// The most leaves and triangles to test.
    pub most: usize,
    pub tally: &'a mut Counts,
}

impl<R: RaySet, const CERTIFIED: bool> Task for ClosestHits<'_, R, CERTIFIED> {
    type Output = Outcome;

    #[inline(always)]
    fn run<K: Simd>(self, k: K) -> Outcome {
        let (bvh, rays, block) = (self.bvh, self.rays, self.block);
        let tree = &bvh.tree.wide;
        let Some(bounds) = block.load(k, bvh, rays) else {
            return Outcome::Incoherent;
        };
        let beam = Beam::new(k.children(), &bounds);
        // A block that misses the tree ends here, before its hits are reset.
        if beam.intersect(&tree.nodes[0], f32::MAX, &mut [0.0; WIDTH]) == 0 {
            return Outcome::Missed;
        }
        block.reset(self.hits);
        let mut query = ClosestQuery::<R, CERTIFIED> {
            bvh,
            rays,
            block,
            quarters: None,
            tally: self.tally,
        };
        if !traverse(k, tree, &beam, &bounds, self.stack, self.most, &mut query) {
            return Outcome::Fine;
        }
        if CERTIFIED {
            self.refined.fill(k, bvh.bvh, rays, query.block);
        }
        Outcome::Traced
    }
}

struct ClosestQuery<'a, R, const CERTIFIED: bool> {
    bvh: View<'a>,
    rays: R,
    block: &'a mut Block,
    /// Directions of each quarter of the block, once triangles need them.
    quarters: Option<Quarters>,
    tally: &'a mut Counts,
}

impl<K: Simd, R: RaySet, const CERTIFIED: bool> BlockQuery<K> for ClosestQuery<'_, R, CERTIFIED> {
    type Rays = R;
    const CERTIFIED: bool = CERTIFIED;

    #[inline(always)]
    fn narrow(&mut self, k: K, triangles: &mut LeafTriangles) {
        // (Q1) holds for a shared origin only.
        if R::OWN_ORIGINS {
            return;
        }
        let candidates = triangles.candidates & triangles.certain;
        if candidates.count_ones() < SEVERAL {
            triangles.quarters = [ALL; WIDTH];
            return;
        }
        // Not a closure, which would not be compiled for the kernel's instructions.
        if self.quarters.is_none() {
            self.quarters = Some(Quarters::of(k.children(), &self.block.directions));
        }
        if let Some(quarters) = &self.quarters {
            quarters.narrow(k.children(), triangles);
        }
    }

    #[inline(always)]
    fn intersect(&mut self, k: K, triangles: &LeafTriangles, at: usize, slot: u32) -> bool {
        if triangles.certain >> at & 1 != 0 {
            self.intersect_certain(k, triangles, at, slot)
        } else {
            self.intersect_either_side(k, triangles, at, slot)
        }
    }

    #[inline(always)]
    fn limit(&self, k: K) -> f32 {
        self.block.limit(k)
    }

    #[inline(always)]
    fn tally(&mut self) -> &mut Counts {
        self.tally
    }
}

impl<R: RaySet, const CERTIFIED: bool> ClosestQuery<'_, R, CERTIFIED> {
    /// Tests a triangle whose σ is certain.
    #[inline(always)]
    fn intersect_certain<K: Simd>(
        &mut self,
        k: K,
        triangles: &LeafTriangles,
        at: usize,
        slot: u32,
    ) -> bool {
        let triangle = PacketTriangle::new::<R>(k, triangles, at);
        // Only f32 hits store their side; f64 recomputes it.
        let front = triangles.front >> at & 1 != 0;
        let slot = if front && !CERTIFIED {
            slot | FRONT
        } else {
            slot
        };
        let (mut quarters, rays) = match R::OWN_ORIGINS {
            true => (1, RAYS),
            false => (triangles.quarters[at % WIDTH], PER_QUARTER),
        };
        let mut changed = false;
        while quarters != 0 {
            let mut first = quarters.trailing_zeros() as usize * PER_QUARTER % RAYS;
            quarters &= quarters - 1;
            let end = first + rays;
            while first < end {
                let d = load_vectors(k, &self.block.directions, first);
                let edge_functions = triangle.edge_functions::<R>(&d, self.block, first);
                let [u, v, w] = edge_functions;
                // Inside, or too close to decide in f32: none of U + B, V + B and W + B is negative.
                let inside = k.not_negative(u, v, w);
                if inside != 0 {
                    changed |= match CERTIFIED {
                        true => {
                            let volume = triangle.volume::<R>(self.block, first);
                            let numbers = (edge_functions, triangle.determinant(&d), volume);
                            self.certify(k, &triangle, slot, (first, inside), numbers)
                        }
                        false => {
                            self.accept(k, &triangle, slot, (first, inside), d, edge_functions)
                        }
                    };
                }
                first += K::LANES;
            }
        }
        changed
    }

    /// For rays that may be inside: accepts certain hits that are certainly the nearest, and lets f64 decide the rest.
    #[inline(always)]
    fn certify<K: Simd>(
        &mut self,
        k: K,
        triangle: &PacketTriangle<K>,
        slot: u32,
        (first, inside): (usize, u32),
        (edge_functions, delta, volume): ([K::F; 3], K::F, K::F),
    ) -> bool {
        let block = &mut *self.block;
        let slack = triangle.determinant_slack();
        let unsure = triangle.volume_slack(volume);
        // Bounds of τ: (E6) of `setup`.
        let least = k.sub(delta, slack);
        let near = k.quotient(k.sub(volume, unsure), k.add(delta, slack));
        let known_far = k.load(&block.far[first..]);
        // Both bounds are strict; NaN goes to f64.
        let candidates = inside & !k.le(known_far, near);
        if candidates == 0 {
            return false;
        }
        let far = k.quotient(k.add(volume, unsure), least);
        let steep = k.le(k.splat(f32::MIN_POSITIVE), least);
        // Certain hits are inside, not parallel to the plane, and before the nearest so far.
        let known_near = k.load(&block.near[first..]);
        let before = k.le(known_near, far);
        let certain = candidates & steep & !before & triangle.is_certainly_inside(&edge_functions);
        if certain != 0 {
            prefetch_all(&self.bvh.corners[slot as usize]);
            k.store(
                &mut block.near[first..],
                k.select(certain, near, known_near),
            );
            // If the known limit is nearer than the far bound of this hit, keep it.
            let far = k.select(certain, k.min(far, known_far), known_far);
            k.store(&mut block.far[first..], far);
            k.store_index(&mut block.slots[first..], certain, slot);
            block.hit |= u64::from(certain) << first;
        }
        // The rest: near an edge, nearly parallel to the plane, or at about the distance of the nearest hit.
        let mut doubtful = candidates & !certain;
        let mut changed = certain != 0;
        while doubtful != 0 {
            let lane = first + doubtful.trailing_zeros() as usize;
            changed |= self.decide(lane, slot);
            doubtful &= doubtful - 1;
        }
        changed
    }

    /// For rays that are inside: accepts nearer hits in f32.
    #[inline(always)]
    fn accept<K: Simd>(
        &mut self,
        k: K,
        triangle: &PacketTriangle<K>,
        slot: u32,
        (first, inside): (usize, u32),
        d: [K::F; 3],
        edge_functions: [K::F; 3],
    ) -> bool {
        let block = &mut *self.block;
        let volume = triangle.volume::<R>(block, first);
        // τ = (n·a − n·δ)/Δ must be above 0 and nearer.
        let delta = triangle.determinant(&d);
        let zero = k.splat(0.0);
        let inverse = k.div(k.splat(1.0), delta);
        let tau = k.mul(volume, inverse);
        let known = k.load(&block.far[first..]);
        let left = match R::OWN_ORIGINS {
            true => block.leaving::<K>(first, slot & !FRONT),
            false => 0,
        };
        let elsewhere = k.le(known, tau) | k.le(delta, zero) | k.le(tau, zero) | left;
        let nearer = inside & !elsewhere;
        if nearer == 0 {
            return false;
        }
        k.store(&mut block.far[first..], k.select(nearer, tau, known));
        // U/Δ and V/Δ are the barycentrics of the second and of the third corner.
        let [u, v, _] = edge_functions;
        k.store_some(
            &mut block.barycentrics[0][first..],
            nearer,
            k.mul(u, inverse),
        );
        k.store_some(
            &mut block.barycentrics[1][first..],
            nearer,
            k.mul(v, inverse),
        );
        k.store_index(&mut block.slots[first..], nearer, slot);
        block.hit |= u64::from(nearer) << first;
        true
    }

    /// Tests a triangle for rays that may start in its plane or on either side: each ray has its own σ, the sign of n·a − n·δ. If that is
    /// within its bound, f64 decides wherever the triangle may be hit from either side. Inlined, because a separate function would not be
    /// compiled for the kernel's instructions.
    #[inline(always)]
    fn intersect_either_side<K: Simd>(
        &mut self,
        k: K,
        triangles: &LeafTriangles,
        at: usize,
        slot: u32,
    ) -> bool {
        if !CERTIFIED {
            let before = self.intersect_certain(k, triangles, at, slot);
            let other = triangles.with_other_side(at);
            return self.intersect_certain(k, &other, at, slot) | before;
        }
        let triangle = PacketTriangle::new::<R>(k, triangles, at);
        // The sides that exist, for σ and for its opposite.
        let (tag, front) = (self.bvh.tags[slot as usize], triangles.front >> at & 1 != 0);
        let shown = if tag.shows(front) { u32::MAX } else { 0 };
        let other_shown = if tag.shows(!front) { u32::MAX } else { 0 };
        let mut changed = false;
        let mut first = 0;
        while first < RAYS {
            let d = load_vectors(k, &self.block.directions, first);
            let seen = triangle.edge_functions::<R>(&d, self.block, first);
            let other = triangle.of_other_side(&seen);
            let [u, v, w] = seen;
            let inside = k.not_negative(u, v, w) & shown;
            let other_inside = k.not_negative(other[0], other[1], other[2]) & other_shown;
            if inside | other_inside != 0 {
                let volume = triangle.volume::<R>(self.block, first);
                let unsure = triangle.volume_slack(volume);
                // A shared origin is within the bound.
                let (mut ahead, mut behind) = (0, 0);
                if R::OWN_ORIGINS {
                    ahead = k.le(unsure, volume);
                    behind = k.le(unsure, k.sub(k.splat(0.0), volume));
                }
                // Rays that certainly start on one side.
                let inside_of_own = (inside & ahead) | (other_inside & behind);
                if inside_of_own != 0 {
                    let edge_functions = [
                        k.select(behind, other[0], u),
                        k.select(behind, other[1], v),
                        k.select(behind, other[2], w),
                    ];
                    let delta = k.flip(triangle.determinant(&d), volume);
                    let numbers = (edge_functions, delta, k.abs(volume));
                    changed |= self.certify(k, &triangle, slot, (first, inside_of_own), numbers);
                }
                // Rays that may start in its plane, except those that leave it.
                let mut doubtful = (inside | other_inside) & !(ahead | behind);
                if doubtful != 0 {
                    doubtful &= !self.block.leaving::<K>(first, slot);
                }
                while doubtful != 0 {
                    let lane = first + doubtful.trailing_zeros() as usize;
                    changed |= self.decide(lane, slot);
                    doubtful &= doubtful - 1;
                }
            }
            first += K::LANES;
        }
        changed
    }

    /// Whether ray `lane` hits the triangle in `slot` first, by the single-ray test.
    #[cold]
    #[inline(never)]
    fn decide(&mut self, lane: usize, slot: u32) -> bool {
        if lane >= self.block.count {
            return false;
        }
        let ray = self.block.order[lane] as usize;
        let left = self.rays.left(ray);
        if left == slot {
            return false;
        }
        self.tally.add(Work::Doubts, 1);
        let Some(ray) = ScaledRay::new(&self.rays.ray(ray)) else {
            return false;
        };
        // The nearest so far, computed as exactly as the challenger.
        let rival = match self.block.slots[lane] {
            NONE => None,
            rival => {
                let corners = &self.bvh.corners[rival as usize];
                let crossing = ray.line.intersect(corners, self.tally);
                crossing.map(|c| (c, rival))
            }
        };
        let Some(s) = ray.nearer(self.bvh.bvh, rival, slot, left, self.tally) else {
            return false;
        };
        self.block.set_hit(lane, slot, s * ray.unit);
        true
    }
}
