//! Closest hits of a block: f32 says no, yes or "ask f64".

use super::beam::Beam;
use super::block::{Block, FRONT, NONE, RAYS};
use super::ray_set::RaySet;
use super::refine::RefinedHits;
use super::setup::{LeafTriangles, PacketTriangle};
use super::simd::{Simd, Task, load_vectors};
use super::traverse::{BlockQuery, Outcome, StackEntry, traverse};
use crate::accel::bvh::Bvh;
use crate::accel::rays::Hit;
use crate::accel::single::ScaledRay;
use crate::accel::tally::{Tally, Work};
use crate::accel::vectors::prefetch_all;
use crate::accel::wide::WIDTH;

/// Finds the closest hits of the rays in a block's order; the block and `refined` receive them.
pub(super) struct ClosestHits<'a, T, R, const CERTIFIED: bool> {
    pub bvh: &'a Bvh,
    pub rays: R,
    /// What was hit before, by rays of the batch.
    pub hits: &'a [Option<Hit>],
    pub block: &'a mut Block,
    pub refined: &'a mut RefinedHits,
    /// As many entries as can wait.
    pub stack: &'a mut [StackEntry],
    pub tally: &'a mut T,
}

impl<T: Tally, R: RaySet, const CERTIFIED: bool> Task for ClosestHits<'_, T, R, CERTIFIED> {
    type Output = Outcome;

    #[inline(always)]
    fn run<K: Simd>(self, k: K) -> Outcome {
        let (bvh, rays, block) = (self.bvh, self.rays, self.block);
        let tree = &bvh.wide;
        let Some(bounds) = block.load(k, &bvh.space, rays) else {
            return Outcome::Incoherent;
        };
        let beam = Beam::new(k.children(), &bounds);
        if beam.intersect(&tree.nodes[0], f32::MAX, &mut [0.0; WIDTH]) == 0 {
            return Outcome::Missed;
        }
        block.reset(self.hits);
        let mut query = ClosestQuery::<T, R, CERTIFIED> {
            bvh,
            rays,
            block,
            tally: self.tally,
        };
        traverse(k, tree, &beam, &bounds, self.stack, &mut query);
        if CERTIFIED {
            self.refined.fill(k, bvh, rays, query.block);
        }
        Outcome::Traced
    }
}

struct ClosestQuery<'a, T, R, const CERTIFIED: bool> {
    bvh: &'a Bvh,
    rays: R,
    block: &'a mut Block,
    tally: &'a mut T,
}

impl<K: Simd, T: Tally, R: RaySet, const CERTIFIED: bool> BlockQuery<K>
    for ClosestQuery<'_, T, R, CERTIFIED>
{
    type Rays = R;
    type Tally = T;
    const CERTIFIED: bool = CERTIFIED;

    #[inline(always)]
    fn intersect(&mut self, k: K, triangles: &LeafTriangles, at: usize, slot: u32) -> bool {
        if triangles.certain >> at & 1 != 0 {
            self.intersect_certain(k, triangles, at, slot)
        } else {
            self.intersect_edge_on(k, triangles, at, slot)
        }
    }

    #[inline(always)]
    fn limit(&self, k: K) -> f32 {
        self.block.limit(k)
    }

    #[inline(always)]
    fn tally(&mut self) -> &mut T {
        self.tally
    }
}

impl<T: Tally, R: RaySet, const CERTIFIED: bool> ClosestQuery<'_, T, R, CERTIFIED> {
    /// A triangle whose σ is certain.
    #[inline(always)]
    fn intersect_certain<K: Simd>(
        &mut self,
        k: K,
        triangles: &LeafTriangles,
        at: usize,
        slot: u32,
    ) -> bool {
        let triangle = PacketTriangle::new::<R>(k, triangles, at);
        // Only f32 hits carry their side; f64 finds it again.
        let front = triangles.front >> at & 1 != 0;
        let slot = if front && !CERTIFIED {
            slot | FRONT
        } else {
            slot
        };
        let mut changed = false;
        let mut first = 0;
        while first < RAYS {
            let d = load_vectors(k, &self.block.directions, first);
            let edge_functions = triangle.edge_functions::<R>(&d, self.block, first);
            let [u, v, w] = edge_functions;
            // Inside, or so nearly that f32 cannot tell: none of U + B, V + B and W + B is negative.
            let inside = k.not_negative(u, v, w);
            if inside != 0 {
                changed |= match CERTIFIED {
                    true => self.certify(k, &triangle, slot, (first, inside), d, edge_functions),
                    false => self.accept(k, &triangle, slot, (first, inside), d, edge_functions),
                };
            }
            first += K::LANES;
        }
        changed
    }

    /// Of the rays that may be inside: takes over certain hits that are certainly the nearest, and lets f64 decide the
    /// rest.
    #[inline(always)]
    fn certify<K: Simd>(
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
        let (delta, slack) = (triangle.determinant(&d), triangle.determinant_slack());
        let unsure = triangle.volume_slack(volume);
        // Bounds of τ: (E6) of `setup`.
        let least = k.sub(delta, slack);
        let near = k.div(k.sub(volume, unsure), k.add(delta, slack));
        let known_far = k.load(&block.far[first..]);
        let candidates = inside & k.le(near, known_far);
        if candidates == 0 {
            return false;
        }
        let far = k.div(k.add(volume, unsure), least);
        let steep = k.le(k.splat(f32::MIN_POSITIVE), least);
        // Certain are hits inside, not along the plane, and before the nearest so far.
        let known_near = k.load(&block.near[first..]);
        let before = k.le(known_near, far);
        let certain = candidates & steep & !before & triangle.is_certainly_inside(&edge_functions);
        if certain != 0 {
            prefetch_all(&self.bvh.corners[slot as usize]);
            k.store(
                &mut block.near[first..],
                k.select(certain, near, known_near),
            );
            // A limit that is nearer than the far end of this stays.
            let far = k.select(certain, k.min(far, known_far), known_far);
            k.store(&mut block.far[first..], far);
            k.store_index(&mut block.slots[first..], certain, slot);
        }
        // What is left: near an edge, along the plane, or at about the distance of the nearest hit.
        let mut doubtful = candidates & !certain;
        let mut changed = certain != 0;
        while doubtful != 0 {
            let lane = first + doubtful.trailing_zeros() as usize;
            changed |= self.decide(lane, slot);
            doubtful &= doubtful - 1;
        }
        changed
    }

    /// Of the rays that are inside: takes over what f32 finds nearer.
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
        // τ = (n·a − n·δ)/Δ, which has to be above 0 and nearer.
        let delta = triangle.determinant(&d);
        let zero = k.splat(0.0);
        let inverse = k.div(k.splat(1.0), delta);
        let tau = k.mul(volume, inverse);
        let known = k.load(&block.far[first..]);
        let elsewhere = k.le(known, tau) | k.le(delta, zero) | k.le(tau, zero);
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
        true
    }

    /// A triangle in whose plane rays may start: f64 decides wherever it may be hit, from either side. Inlined, because
    /// a function of its own would not have the kernel's instructions.
    #[inline(always)]
    fn intersect_edge_on<K: Simd>(
        &mut self,
        k: K,
        triangles: &LeafTriangles,
        at: usize,
        slot: u32,
    ) -> bool {
        let other = triangles.with_other_side(at);
        if !CERTIFIED {
            let before = self.intersect_certain(k, triangles, at, slot);
            return self.intersect_certain(k, &other, at, slot) | before;
        }
        let mut changed = false;
        for triangles in [triangles, &other] {
            let triangle = PacketTriangle::new::<R>(k, triangles, at);
            for first in (0..RAYS).step_by(K::LANES) {
                let d = load_vectors(k, &self.block.directions, first);
                let [u, v, w] = triangle.edge_functions::<R>(&d, self.block, first);
                let mut inside = k.not_negative(u, v, w);
                while inside != 0 {
                    let lane = first + inside.trailing_zeros() as usize;
                    changed |= self.decide(lane, slot);
                    inside &= inside - 1;
                }
            }
        }
        changed
    }

    /// Whether the triangle in `slot` is what ray `lane` hits first, as single rays decide it.
    #[cold]
    #[inline(never)]
    fn decide(&mut self, lane: usize, slot: u32) -> bool {
        if lane >= self.block.count {
            return false;
        }
        self.tally.add(Work::Doubts, 1);
        let ray = self.block.order[lane] as usize;
        let Some(ray) = ScaledRay::new(&self.rays.ray(ray)) else {
            return false;
        };
        // The nearest so far, as exactly as the challenger is found.
        let rival = match self.block.slots[lane] {
            NONE => None,
            rival => {
                let corners = &self.bvh.corners[rival as usize];
                let crossing = ray.line.intersect(corners, self.tally);
                crossing.map(|c| (c, rival))
            }
        };
        let Some((crossing, slot)) = ray.nearer(self.bvh, rival, slot, self.tally) else {
            return false;
        };
        self.block.set_hit(lane, slot, crossing.s * ray.unit);
        true
    }
}
