//! A block's way through the tree of wide nodes, nearer children first.

use glam::DVec3;

use super::FRONT;
use super::block::{Axis, Beam, Block, NONE, RAYS};
use super::facet::{Facet, Viewpoint};
use super::simd::{Simd, Task};
use crate::accel::query::Probe;
use crate::accel::slab::Link;
use crate::accel::wide::{WIDTH, Wide};
use crate::accel::{Bvh, Hit, Ray};

/// A child to visit later, and where the block enters its box at the earliest.
pub(super) type Waiting = (f32, Link);

/// A block to lead through the tree.
pub(super) struct Walk<'a, const CERTIFIED: bool> {
    pub bvh: &'a Bvh,
    /// Metres.
    pub origin: DVec3,
    /// Of the batch.
    pub directions: &'a [DVec3],
    /// Of the batch: what was met before.
    pub hits: &'a [Option<Hit>],
    pub block: &'a mut Block,
    /// As many entries as can wait.
    pub stack: &'a mut [Waiting],
    /// Whether the rays went together. If not, nothing was done.
    pub coherent: &'a mut bool,
}

impl<const CERTIFIED: bool> Task for Walk<'_, CERTIFIED> {
    #[inline(always)]
    fn run<K: Simd>(mut self, k: K) {
        let lattice = &self.bvh.lattice;
        let Some(extent) = self.block.aim(k, lattice, self.directions) else {
            *self.coherent = false;
            return;
        };
        *self.coherent = true;
        let hits = self.hits;
        self.block.start(|ray| hits[ray].as_ref().map(|hit| hit.s));
        let beam = Beam::new((self.origin - lattice.centre) * lattice.scale, &extent);
        let at = Viewpoint::new(self.origin, lattice, beam.reach);
        let slabs = Slabs::new(k.children(), &beam);
        self.descend(k, &slabs, &at);
    }
}

impl<const CERTIFIED: bool> Walk<'_, CERTIFIED> {
    #[inline(always)]
    fn descend<K: Simd>(&mut self, k: K, slabs: &Slabs<K::Children>, at: &Viewpoint) {
        let mut limit = self.block.limit(k);
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
                    limit = self.block.limit(k);
                }
                continue;
            }
            let node = &self.bvh.wide[link.index()];
            let mut entries = [0.0; WIDTH];
            let mut met = slabs.meet(node, limit, &mut entries);
            let first = waiting;
            while met != 0 {
                let child = met.trailing_zeros() as usize % WIDTH;
                met &= met - 1;
                // Insertion, the farthest deepest.
                let entry = entries[child];
                let mut place = waiting;
                while place > first && self.stack[place - 1].0 < entry {
                    self.stack[place] = self.stack[place - 1];
                    place -= 1;
                }
                self.stack[place] = (entry, node.links[child]);
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
        let edges = facet.edges.map(|e| e.map(|x| k.splat(x)));
        let slack = facet.slack.map(|x| k.splat(x));
        let mut changed = false;
        for first in (0..RAYS).step_by(K::LANES) {
            let d = [0, 1, 2].map(|axis| k.load(&self.block.directions[axis][first..]));
            let uvw: [K::F; 3] = std::array::from_fn(|i| dot(k, d, edges[i], slack[i]));
            let inside = k.not_negative(uvw[0], uvw[1], uvw[2]);
            if inside != 0 {
                changed |= match CERTIFIED {
                    true => self.certify(k, facet, slot, (first, inside), d, uvw),
                    false => self.accept(k, facet, slot, (first, inside), d, uvw),
                };
            }
        }
        changed
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
        let block = &mut *self.block;
        let delta = dot(k, d, facet.normal.map(|x| k.splat(x)), k.splat(0.0));
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
        let [u, v, w] = std::array::from_fn(|i| k.sub(uvw[i], k.splat(2.0 * facet.slack[i])));
        let certain = candidates & !grazing & !before & k.not_negative(u, v, w);
        if certain != 0 {
            k.store_some(&mut block.near[first..], certain, near);
            // What was known to be nearer than the far end of this stays so.
            let far = k.min(far, k.load(&block.far[first..]));
            k.store_some(&mut block.far[first..], certain, far);
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
        let block = &mut *self.block;
        let delta = dot(k, d, facet.normal.map(|x| k.splat(x)), k.splat(0.0));
        let inverse = k.div(k.splat(1.0), delta);
        let tau = k.mul(k.splat(facet.volume[0]), inverse);
        let farther = k.le(k.load(&block.far[first..]), tau) | k.le(delta, k.splat(0.0));
        let nearer = inside & !farther;
        if nearer == 0 {
            return false;
        }
        k.store_some(&mut block.far[first..], nearer, tau);
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
                let d = [0, 1, 2].map(|axis| k.load(&self.block.directions[axis][first..]));
                let [u, v, w] = std::array::from_fn(|i| {
                    dot(
                        k,
                        d,
                        facet.edges[i].map(|x| k.splat(x)),
                        k.splat(facet.slack[i]),
                    )
                });
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
        if lane >= self.block.count {
            return false;
        }
        let direction = self.directions[self.block.order[lane] as usize];
        let ray = Ray {
            origin: self.origin,
            direction,
            s_min: 0.0,
        };
        let Some(probe) = Probe::new(&ray) else {
            return false;
        };
        let rival = match self.block.slots[lane] {
            NONE => None,
            rival => probe
                .line
                .meet(&self.bvh.corners[rival as usize])
                .map(|c| (c, rival)),
        };
        let Some((crossing, slot)) = probe.nearer(self.bvh, rival, slot) else {
            return false;
        };
        self.block.set(lane, slot, crossing.s * probe.unit);
        true
    }
}

/// x·y + z.
#[inline(always)]
fn dot<K: Simd>(k: K, x: [K::F; 3], y: [K::F; 3], z: K::F) -> K::F {
    k.mul_add(x[0], y[0], k.mul_add(x[1], y[1], k.mul_add(x[2], y[2], z)))
}

/// A beam in eight lanes.
struct Slabs<K: Simd> {
    kernel: K,
    axes: [Slab<K::F>; 3],
}

struct Slab<F> {
    near: usize,
    straddles: bool,
    inverse: [F; 2],
    near_offset: [F; 2],
    far_offset: [F; 2],
}

impl<K: Simd> Slabs<K> {
    #[inline(always)]
    fn new(k: K, beam: &Beam) -> Slabs<K> {
        let splat = |x: [f32; 2]| x.map(|x| k.splat(x));
        let slab = |axis: &Axis| Slab {
            near: axis.near,
            straddles: axis.straddles,
            inverse: splat(axis.inverse),
            near_offset: splat(axis.near_offset),
            far_offset: splat(axis.far_offset),
        };
        Slabs {
            kernel: k,
            axes: [
                slab(&beam.axes[0]),
                slab(&beam.axes[1]),
                slab(&beam.axes[2]),
            ],
        }
    }

    /// The children that a ray of the block may meet before `limit`, and where they are entered.
    #[inline(always)]
    fn meet(&self, node: &Wide, limit: f32, entries: &mut [f32; WIDTH]) -> u32 {
        let k = self.kernel;
        let (mut enter, mut leave) = (k.splat(0.0), k.splat(limit));
        for (slab, planes) in self.axes.iter().zip(&node.planes) {
            let [i, j] = slab.inverse;
            let [a, b] = slab.near_offset;
            let near = k.load(&planes[slab.near]);
            let far = k.load(&planes[1 - slab.near]);
            if slab.straddles {
                enter = k.max(enter, k.max(k.mul_add(near, i, a), k.mul_add(far, j, b)));
            } else {
                let [c, d] = slab.far_offset;
                enter = k.max(enter, k.min(k.mul_add(near, i, a), k.mul_add(near, j, b)));
                leave = k.min(leave, k.max(k.mul_add(far, i, c), k.mul_add(far, j, d)));
            }
        }
        k.store(entries, enter);
        k.le(enter, leave)
    }
}
