//! Traversal of the wide tree by a block, nearer children first.

use super::beam::Beam;
use super::block::BlockBounds;
use super::ray_set::RaySet;
use super::setup::{LeafTriangles, TriangleSetup};
use super::simd::Simd;
use crate::accel::node::NodeRef;
use crate::accel::tally::{Counts, Work};
use crate::accel::vectors::prefetch_all;
use crate::accel::wide::{WIDTH, WideLeaf, WideTree};

/// A child to visit later, and the earliest parameter at which the block enters its box.
pub(super) type StackEntry = (f32, NodeRef);

/// The outcome for a block.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Outcome {
    /// Its rays are incoherent, and nothing was done.
    Incoherent,
    /// It meets more triangles than it may test, because they are finer than the gaps between its rays.
    Fine,
    /// It misses the tree.
    Missed,
    /// It was traced.
    Traced,
}

/// A query of the tree by a block.
pub(super) trait BlockQuery<K: Simd> {
    type Rays: RaySet;
    /// Whether error bounds are needed.
    const CERTIFIED: bool;

    /// Skips quarters of the block for triangles that were just set up, if that pays.
    fn narrow(&mut self, _: K, _: &mut LeafTriangles) {}
    /// Tests triangle `at` of `triangles`, which is in `slot`; returns whether [`BlockQuery::limit`] may have changed.
    fn intersect(&mut self, k: K, triangles: &LeafTriangles, at: usize, slot: u32) -> bool;
    /// The τ beyond which nothing matters; negative if nothing does.
    fn limit(&self, k: K) -> f32;
    /// Counts the work.
    fn tally(&mut self) -> &mut Counts;
}

/// Runs `query` on `tree`, which must not be empty, for a block with these `bounds`. `stack` must have room for all entries that can be
/// pending. Returns whether it was finished with at most `most` leaves and triangles.
#[inline(always)]
pub(super) fn traverse<K: Simd, Q: BlockQuery<K>>(
    k: K,
    tree: &WideTree,
    beam: &Beam<K::Children>,
    bounds: &BlockBounds,
    stack: &mut [StackEntry],
    most: usize,
    query: &mut Q,
) -> bool {
    let setup = TriangleSetup::new(k.children(), bounds);
    let mut triangles = LeafTriangles::NONE;
    let mut limit = query.limit(k);
    let (mut nodes, mut tested, mut work) = (0, 0, 0);
    let mut waiting = 1;
    stack[0] = (0.0, NodeRef::ROOT);
    while waiting > 0 && work <= most {
        waiting -= 1;
        let (entry, at) = stack[waiting];
        // A nearer hit has been found since.
        if entry > limit {
            continue;
        }
        if at.is_leaf() {
            let leaf = &tree.leaves[at.index()];
            tested += leaf.present.count_ones() as usize;
            if intersect_leaf(k, leaf, &setup, limit, &mut triangles, query) {
                limit = query.limit(k);
            }
            work += 1 + triangles.candidates.count_ones() as usize;
            continue;
        }
        nodes += 1;
        let node = &tree.nodes[at.index()];
        let mut entries = [0.0; WIDTH];
        let mut hit = beam.intersect(node, limit, &mut entries);
        let first = waiting;
        while hit != 0 {
            let at = hit.trailing_zeros() as usize % WIDTH;
            hit &= hit - 1;
            let (entry, child) = (entries[at], node.children[at]);
            if child.is_leaf() {
                prefetch_all(&tree.leaves[child.index()]);
            } else {
                prefetch_all(&tree.nodes[child.index()]);
            }
            // Insertion sort, the farthest deepest.
            let mut place = waiting;
            while place > first && stack[place - 1].0 < entry {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place] = (entry, child);
            waiting += 1;
        }
    }
    query.tally().add(Work::Nodes, nodes);
    query.tally().add(Work::Triangles, tested);
    work <= most
}

/// Tests the triangles of `leaf`; returns whether the limit may have changed.
#[inline(always)]
fn intersect_leaf<K: Simd, Q: BlockQuery<K>>(
    k: K,
    leaf: &WideLeaf,
    setup: &TriangleSetup<K::Children>,
    limit: f32,
    triangles: &mut LeafTriangles,
    query: &mut Q,
) -> bool {
    // An associated constant cannot be a const argument: use two branches, one of which is compiled out.
    match Q::CERTIFIED {
        true => setup.set_up::<Q::Rays, true>(leaf, limit, triangles),
        false => setup.set_up::<Q::Rays, false>(leaf, limit, triangles),
    }
    query.narrow(k, triangles);
    let (mut candidates, mut changed) = (triangles.candidates, false);
    while candidates != 0 {
        let at = candidates.trailing_zeros();
        candidates &= candidates - 1;
        changed |= query.intersect(k, triangles, at as usize, leaf.first + at);
    }
    changed
}
