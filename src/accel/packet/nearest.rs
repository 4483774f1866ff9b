//! Closest hits of a block: f32 says no, yes or "ask f64".

use super::beam::Beam;
use super::block::{NONE, RAYS};
use super::bundle::{Bundle, ray_of};
use super::facet::Facet;
use super::facets::Facets;
use super::simd::{Simd, Task};
use super::slabs::Slabs;
use super::walk::{Outcome, Quest, Waiting, descend};
use super::{FRONT, Workspace};
use crate::accel::query::Probe;
use crate::accel::wide::WIDTH;
use crate::accel::{Bvh, Hit, Tally, Work};

/// A block to lead through the tree.
pub(super) struct Nearest<'a, T, B, const CERTIFIED: bool> {
    pub bvh: &'a Bvh,
    pub rays: B,
    /// What was met before.
    pub hits: &'a [Option<Hit>],
    pub space: &'a mut Workspace,
    /// As many entries as can wait.
    pub stack: &'a mut [Waiting],
    pub tally: &'a mut T,
}

impl<T: Tally, B: Bundle, const CERTIFIED: bool> Task for Nearest<'_, T, B, CERTIFIED> {
    #[inline(always)]
    fn run<K: Simd>(self, k: K) {
        let tree = &self.bvh.wide;
        self.space.outcome = Outcome::Apart;
        let Some(view) = self.space.block.aim(k, &self.bvh.lattice, self.rays) else {
            return;
        };
        let slabs = Slabs::new(k.children(), &Beam::new(&view));
        self.space.outcome = Outcome::Missed;
        if slabs.meet(&tree.nodes[0], f32::MAX, &mut [0.0; WIDTH]) == 0 {
            return;
        }
        self.space.outcome = Outcome::Met;
        self.space.block.start(self.hits);
        let mut quest = Lookout::<T, B, CERTIFIED> {
            bvh: self.bvh,
            rays: self.rays,
            space: self.space,
            tally: self.tally,
        };
        descend(k, tree, &slabs, &view, self.stack, &mut quest);
        if CERTIFIED {
            let Workspace { block, numbers, .. } = &mut *self.space;
            numbers.fill(k, self.bvh, self.rays, block);
        }
    }
}

struct Lookout<'a, T, B, const CERTIFIED: bool> {
    bvh: &'a Bvh,
    rays: B,
    space: &'a mut Workspace,
    tally: &'a mut T,
}

impl<K: Simd, T: Tally, B: Bundle, const CERTIFIED: bool> Quest<K>
    for Lookout<'_, T, B, CERTIFIED>
{
    const OWN: bool = B::OWN;
    const CERTIFIED: bool = CERTIFIED;
    type Tally = T;

    #[inline(always)]
    fn meet(&mut self, k: K, facets: &Facets, at: usize, slot: u32) -> bool {
        if facets.certain >> at & 1 != 0 {
            self.meet_certain(k, facets, at, slot)
        } else {
            self.meet_edge_on(k, facets, at, slot)
        }
    }

    #[inline(always)]
    fn limit(&self, k: K) -> f32 {
        self.space.block.limit(k)
    }

    #[inline(always)]
    fn tally(&mut self) -> &mut T {
        self.tally
    }
}

impl<T: Tally, B: Bundle, const CERTIFIED: bool> Lookout<'_, T, B, CERTIFIED> {
    /// U + B, V + B and W + B of a packet.
    #[inline(always)]
    fn weigh<K: Simd>(&self, k: K, facet: &Facet<K>, d: &[K::F; 3], first: usize) -> [K::F; 3] {
        if B::OWN {
            facet.weigh::<true>(d, &vectors(k, &self.space.block.moments, first))
        } else {
            facet.weigh::<false>(d, d)
        }
    }

    /// n·a − n·δ of a packet.
    #[inline(always)]
    fn volume<K: Simd>(&self, k: K, facet: &Facet<K>, first: usize) -> K::F {
        if B::OWN {
            facet.volume::<true>(&vectors(k, &self.space.block.offsets, first))
        } else {
            facet.volume::<false>(&[k.splat(0.0); 3])
        }
    }

    /// A triangle whose σ is certain.
    #[inline(always)]
    fn meet_certain<K: Simd>(&mut self, k: K, facets: &Facets, at: usize, slot: u32) -> bool {
        let facet = match B::OWN {
            true => Facet::of::<true>(k, facets, at),
            false => Facet::of::<false>(k, facets, at),
        };
        let slot = match CERTIFIED {
            true => slot,
            false => {
                slot | if facets.front >> at & 1 != 0 {
                    FRONT
                } else {
                    0
                }
            }
        };
        let mut changed = false;
        let mut first = 0;
        while first < RAYS {
            let d = vectors(k, &self.space.block.directions, first);
            let weights = self.weigh(k, &facet, &d, first);
            let inside = k.not_negative(weights[0], weights[1], weights[2]);
            if inside != 0 {
                changed |= match CERTIFIED {
                    true => self.certify(k, &facet, slot, (first, inside), d, weights),
                    false => self.accept(k, &facet, slot, (first, inside), d, weights),
                };
            }
            first += K::LANES;
        }
        changed
    }

    /// Of the rays that may be inside: certain hits where they are certainly the nearest, and what
    /// f64 says of the rest.
    #[inline(always)]
    fn certify<K: Simd>(
        &mut self,
        k: K,
        facet: &Facet<K>,
        slot: u32,
        (first, inside): (usize, u32),
        d: [K::F; 3],
        weights: [K::F; 3],
    ) -> bool {
        let volume = self.volume(k, facet, first);
        let block = &mut self.space.block;
        let (slope, slack) = (facet.slope(&d), facet.slope_slack());
        let unsure = facet.volume_slack(volume);
        let least = k.sub(slope, slack);
        let near = k.div(k.sub(volume, unsure), k.add(slope, slack));
        let known_far = k.load(&block.far[first..]);
        let candidates = inside & k.le(near, known_far);
        if candidates == 0 {
            return false;
        }
        let far = k.div(k.add(volume, unsure), least);
        let steep = k.le(k.splat(f32::MIN_POSITIVE), least);
        let known_near = k.load(&block.near[first..]);
        let before = k.le(known_near, far);
        let certain = candidates & steep & !before & facet.is_inside(&weights);
        if certain != 0 {
            k.prefetch(&self.bvh.corners[slot as usize]);
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
        facet: &Facet<K>,
        slot: u32,
        (first, inside): (usize, u32),
        d: [K::F; 3],
        weights: [K::F; 3],
    ) -> bool {
        let volume = self.volume(k, facet, first);
        let block = &mut self.space.block;
        let slope = facet.slope(&d);
        let zero = k.splat(0.0);
        let inverse = k.div(k.splat(1.0), slope);
        let tau = k.mul(volume, inverse);
        let known = k.load(&block.far[first..]);
        let elsewhere = k.le(known, tau) | k.le(slope, zero) | k.le(tau, zero);
        let nearer = inside & !elsewhere;
        if nearer == 0 {
            return false;
        }
        k.store(&mut block.far[first..], k.select(nearer, tau, known));
        let [u, v, _] = weights;
        k.store_some(&mut block.weights[0][first..], nearer, k.mul(u, inverse));
        k.store_some(&mut block.weights[1][first..], nearer, k.mul(v, inverse));
        k.store_index(&mut block.slots[first..], nearer, slot);
        true
    }

    /// A triangle in whose plane rays may start: f64 decides wherever it may be met.
    #[cold]
    #[inline(never)]
    fn meet_edge_on<K: Simd>(&mut self, k: K, facets: &Facets, at: usize, slot: u32) -> bool {
        let turned = facets.turned(at);
        if !CERTIFIED {
            let before = self.meet_certain(k, facets, at, slot);
            return self.meet_certain(k, &turned, at, slot) | before;
        }
        let mut changed = false;
        for facets in [facets, &turned] {
            let facet = match B::OWN {
                true => Facet::of::<true>(k, facets, at),
                false => Facet::of::<false>(k, facets, at),
            };
            for first in (0..RAYS).step_by(K::LANES) {
                let d = vectors(k, &self.space.block.directions, first);
                let [u, v, w] = self.weigh(k, &facet, &d, first);
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
        let Some(probe) = Probe::new(&ray_of(self.rays, ray)) else {
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

/// Some vectors of a packet.
#[inline(always)]
pub(super) fn vectors<K: Simd>(k: K, of: &[[f32; RAYS]; 3], first: usize) -> [K::F; 3] {
    [
        k.load(&of[0][first..]),
        k.load(&of[1][first..]),
        k.load(&of[2][first..]),
    ]
}
