//! A block's way through the tree of wide nodes, nearer children first.

use super::block::{Beam, NONE, RAYS};
use super::facet::{Facet, Viewpoint};
use super::simd::{Simd, Task};
use super::slabs::Slabs;
use super::{Batch, FRONT, Workspace};
use crate::accel::query::Probe;
use crate::accel::slab::Link;
use crate::accel::wide::WIDTH;
use crate::accel::{Bvh, Hit, Tally, Work};

/// A child to visit later, and where the block enters its box at the earliest.
pub(super) type Waiting = (f32, Link);

/// A block to lead through the tree.
pub(super) struct Walk<'a, T, const CERTIFIED: bool> {
    pub bvh: &'a Bvh,
    pub batch: Batch<'a>,
    /// What was met before.
    pub hits: &'a [Option<Hit>],
    pub space: &'a mut Workspace,
    /// As many entries as can wait.
    pub stack: &'a mut [Waiting],
    pub tally: &'a mut T,
}

/// What became of a block.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Outcome {
    /// Its rays don't go together, and nothing was done.
    Apart,
    /// It passes the tree.
    Missed,
    /// It has met what it has met.
    Met,
}

impl<T: Tally, const CERTIFIED: bool> Task for Walk<'_, T, CERTIFIED> {
    #[inline(always)]
    fn run<K: Simd>(mut self, k: K) {
        let lattice = &self.bvh.lattice;
        let Some(extent) = self.space.block.aim(k, lattice, self.batch.directions) else {
            self.space.outcome = Outcome::Apart;
            return;
        };
        let beam = Beam::new(
            (self.batch.origin - lattice.centre) * lattice.scale,
            &extent,
        );
        let slabs = Slabs::new(k.children(), &beam);
        self.space.outcome = Outcome::Missed;
        if slabs.meet(&self.bvh.wide[0], f32::MAX, &mut [0.0; WIDTH]) == 0 {
            return;
        }
        self.space.outcome = Outcome::Met;
        self.space.block.start(self.hits);
        let at = Viewpoint::new(self.batch.origin, lattice, beam.reach);
        self.descend(k, &slabs, &at);
        if CERTIFIED {
            let Workspace { block, numbers, .. } = &mut *self.space;
            numbers.fill(self.bvh, self.batch, block);
        }
    }
}

impl<T: Tally, const CERTIFIED: bool> Walk<'_, T, CERTIFIED> {
    #[inline(always)]
    fn descend<K: Simd>(&mut self, k: K, slabs: &Slabs<K::Children>, at: &Viewpoint) {
        let mut limit = self.space.block.limit(k);
        let mut waiting = 1;
        self.stack[0] = (0.0, Link::ROOT);
        while waiting > 0 {
            waiting -= 1;
            let (entry, link) = self.stack[waiting];
            if entry > limit {
                continue;
            }
            if link.is_leaf() {
                if self.leaf(k, at, link.index()) {
                    limit = self.space.block.limit(k);
                }
                continue;
            }
            self.tally.add(Work::Nodes, 1);
            let node = &self.bvh.wide[link.index()];
            let mut entries = [0.0; WIDTH];
            let mut met = slabs.meet(node, limit, &mut entries);
            let first = waiting;
            while met != 0 {
                let child = met.trailing_zeros() as usize % WIDTH;
                met &= met - 1;
                // Insertion, the farthest deepest.
                let entry = entries[child];
                let link = node.links[child];
                if link.is_leaf() {
                    k.prefetch(&self.bvh.corners[link.index()]);
                }
                let mut place = waiting;
                while place > first && self.stack[place - 1].0 < entry {
                    self.stack[place] = self.stack[place - 1];
                    place -= 1;
                }
                self.stack[place] = (entry, link);
                waiting += 1;
            }
        }
    }

    /// Looks at the triangles of a leaf; whether anything was met.
    #[inline(always)]
    fn leaf<K: Simd>(&mut self, k: K, at: &Viewpoint, first: usize) -> bool {
        let bvh = self.bvh;
        let triangles = bvh.corners[first..].iter().zip(&bvh.tags[first..]);
        let mut changed = false;
        for (i, (corners, tag)) in triangles.enumerate() {
            self.tally.add(Work::Triangles, 1);
            let slot = (first + i) as u32;
            let facet = Facet::new::<CERTIFIED>(at, corners);
            if !facet.certain {
                changed |= self.meet_edge_on(k, &facet, slot);
            } else if tag.shows(facet.front) {
                changed |= self.meet(k, &facet, slot);
            }
            if tag.is_last() {
                break;
            }
        }
        changed
    }

    /// Takes over where rays meet `facet`, whose σ is certain.
    #[inline(always)]
    fn meet<K: Simd>(&mut self, k: K, facet: &Facet, slot: u32) -> bool {
        let [p, q, r] = facet.edges;
        let (p, q, r) = (k.splat3(p), k.splat3(q), k.splat3(r));
        let [b, c, e] = k.splat3(facet.slack);
        let mut changed = false;
        let mut first = 0;
        while first < RAYS {
            let d = self.load(k, first);
            let uvw = [k.dot(&d, &p, b), k.dot(&d, &q, c), k.dot(&d, &r, e)];
            let inside = k.not_negative(uvw[0], uvw[1], uvw[2]);
            if inside != 0 {
                changed |= match CERTIFIED {
                    true => self.certify(k, facet, slot, (first, inside), d, uvw),
                    false => self.accept(k, facet, slot, (first, inside), d, uvw),
                };
            }
            first += K::LANES;
        }
        changed
    }

    /// The directions of a packet.
    #[inline(always)]
    fn load<K: Simd>(&self, k: K, first: usize) -> [K::F; 3] {
        let [x, y, z] = &self.space.block.directions;
        [
            k.load(&x[first..]),
            k.load(&y[first..]),
            k.load(&z[first..]),
        ]
    }

    /// Of the rays that may be inside: certain hits where they are certainly the nearest, and what
    /// f64 says of the rest.
    #[inline(always)]
    fn certify<K: Simd>(
        &mut self,
        k: K,
        facet: &Facet,
        slot: u32,
        (first, inside): (usize, u32),
        d: [K::F; 3],
        uvw: [K::F; 3],
    ) -> bool {
        let block = &mut self.space.block;
        let delta = k.dot(&d, &k.splat3(facet.normal), k.splat(0.0));
        let slack = k.splat(facet.normal_slack);
        let least = k.sub(delta, slack);
        let grazing = k.le(least, k.splat(facet.grazing));
        let near = k.div(k.splat(facet.volume[0]), k.add(delta, slack));
        let in_reach = k.le(near, k.load(&block.far[first..]));
        let candidates = inside & (in_reach | grazing);
        if candidates == 0 {
            return false;
        }
        let far = k.div(k.splat(facet.volume[1]), least);
        let before = k.le(k.load(&block.near[first..]), far);
        let [b, c, e] = facet.slack;
        let u = k.sub(uvw[0], k.splat(2.0 * b));
        let v = k.sub(uvw[1], k.splat(2.0 * c));
        let w = k.sub(uvw[2], k.splat(2.0 * e));
        let certain = candidates & !grazing & !before & k.not_negative(u, v, w);
        if certain != 0 {
            let (known_near, known_far) =
                (k.load(&block.near[first..]), k.load(&block.far[first..]));
            k.store(
                &mut block.near[first..],
                k.select(certain, near, known_near),
            );
            // A limit that is nearer than the far end of this stays.
            let far = k.select(certain, k.min(far, known_far), known_far);
            k.store(&mut block.far[first..], far);
            k.store_index(&mut block.slots[first..], certain, slot);
        }
        let mut doubtful = candidates & !certain;
        let mut changed = certain != 0;
        while doubtful != 0 {
            let lane = first + doubtful.trailing_zeros() as usize;
            changed |= self.decide(lane, slot);
            doubtful &= doubtful - 1;
        }
        changed
    }

    /// f32 as it is.
    #[inline(always)]
    fn accept<K: Simd>(
        &mut self,
        k: K,
        facet: &Facet,
        slot: u32,
        (first, inside): (usize, u32),
        d: [K::F; 3],
        uvw: [K::F; 3],
    ) -> bool {
        let block = &mut self.space.block;
        let delta = k.dot(&d, &k.splat3(facet.normal), k.splat(0.0));
        let inverse = k.div(k.splat(1.0), delta);
        let tau = k.mul(k.splat(facet.volume[0]), inverse);
        let farther = k.le(k.load(&block.far[first..]), tau) | k.le(delta, k.splat(0.0));
        let nearer = inside & !farther;
        if nearer == 0 {
            return false;
        }
        let known = k.load(&block.far[first..]);
        k.store(&mut block.far[first..], k.select(nearer, tau, known));
        k.store_some(
            &mut block.weights[0][first..],
            nearer,
            k.mul(uvw[0], inverse),
        );
        k.store_some(
            &mut block.weights[1][first..],
            nearer,
            k.mul(uvw[1], inverse),
        );
        let marked = slot | if facet.front { FRONT } else { 0 };
        k.store_index(&mut block.slots[first..], nearer, marked);
        true
    }

    /// A triangle in whose plane the origin may be: f64 decides wherever it may be met.
    #[cold]
    #[inline(never)]
    fn meet_edge_on<K: Simd>(&mut self, k: K, facet: &Facet, slot: u32) -> bool {
        let mut changed = false;
        for facet in [facet, &facet.flipped()] {
            for first in (0..RAYS).step_by(K::LANES) {
                let d = self.load(k, first);
                let [p, q, r] = facet.edges;
                let [b, c, e] = k.splat3(facet.slack);
                let u = k.dot(&d, &k.splat3(p), b);
                let v = k.dot(&d, &k.splat3(q), c);
                let w = k.dot(&d, &k.splat3(r), e);
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

    /// Whether the triangle in `slot` is what ray `lane` meets first, as single rays decide it.
    #[cold]
    #[inline(never)]
    fn decide(&mut self, lane: usize, slot: u32) -> bool {
        if lane >= self.space.block.count {
            return false;
        }
        self.tally.add(Work::Doubts, 1);
        let ray = self.space.block.order[lane] as usize;
        let Some(probe) = Probe::new(&self.batch.ray(ray)) else {
            return false;
        };
        let rival = match self.space.block.slots[lane] {
            NONE => None,
            rival => probe
                .line
                .meet(&self.bvh.corners[rival as usize], self.tally)
                .map(|c| (c, rival)),
        };
        let Some((crossing, slot)) = probe.nearer(self.bvh, rival, slot, self.tally) else {
            return false;
        };
        self.space.block.set(lane, slot, crossing.s * probe.unit);
        true
    }
}
