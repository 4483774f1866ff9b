//! A block's way through the tree of wide nodes, nearer children first.

use super::block::View;
use super::facets::{Facets, Viewpoint};
use super::simd::Simd;
use super::slabs::Slabs;
use crate::accel::pack::Pack;
use crate::accel::slab::Link;
use crate::accel::wide::{WIDTH, WideTree};
use crate::accel::{Tally, Work};

/// A child to visit later, and where the block enters its box at the earliest.
pub(super) type Waiting = (f32, Link);

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

/// What a block is led through the tree for.
pub(super) trait Quest<K: Simd> {
    /// Whether rays have origins of their own, and whether bounds are asked for.
    const OWN: bool;
    const CERTIFIED: bool;
    /// Who counts.
    type Tally: Tally;

    /// Meets triangle `at` of `facets`, which is in `slot`; whether [`Quest::limit`] may have changed.
    fn meet(&mut self, k: K, facets: &Facets, at: usize, slot: u32) -> bool;
    /// The τ beyond which nothing is of interest; less than nothing if nothing is.
    fn limit(&self, k: K) -> f32;
    /// Who counts.
    fn tally(&mut self) -> &mut Self::Tally;
}

/// Leads a block through `tree`, which isn't empty. `stack` has as many entries as can wait.
#[inline(always)]
pub(super) fn descend<K: Simd, Q: Quest<K>>(
    k: K,
    tree: &WideTree,
    slabs: &Slabs<K::Children>,
    view: &View,
    stack: &mut [Waiting],
    quest: &mut Q,
) {
    let at = Viewpoint::new(k.children(), view);
    let mut facets = Facets::NONE;
    let mut limit = quest.limit(k);
    let mut waiting = 1;
    stack[0] = (0.0, Link::ROOT);
    while waiting > 0 {
        waiting -= 1;
        let (entry, link) = stack[waiting];
        if entry > limit {
            continue;
        }
        if link.is_leaf() {
            if look(k, &tree.packs[link.index()], &at, limit, &mut facets, quest) {
                limit = quest.limit(k);
            }
            continue;
        }
        quest.tally().add(Work::Nodes, 1);
        let node = &tree.nodes[link.index()];
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
                k.prefetch(&tree.packs[link.index()]);
            } else {
                k.prefetch(&tree.nodes[link.index()]);
            }
            let mut place = waiting;
            while place > first && stack[place - 1].0 < entry {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place] = (entry, link);
            waiting += 1;
        }
    }
}

/// Looks at the triangles of `pack`; whether the limit may have changed.
#[inline(always)]
fn look<K: Simd, Q: Quest<K>>(
    k: K,
    pack: &Pack,
    at: &Viewpoint<K::Children>,
    limit: f32,
    facets: &mut Facets,
    quest: &mut Q,
) -> bool {
    // Constants of a trait can't be arguments: four ways, of which three are not compiled.
    match (Q::OWN, Q::CERTIFIED) {
        (false, false) => at.see::<false, false>(pack, limit, facets),
        (false, true) => at.see::<false, true>(pack, limit, facets),
        (true, false) => at.see::<true, false>(pack, limit, facets),
        (true, true) => at.see::<true, true>(pack, limit, facets),
    }
    quest
        .tally()
        .add(Work::Triangles, pack.present.count_ones() as usize);
    let (mut met, mut changed) = (facets.met, false);
    while met != 0 {
        let triangle = met.trailing_zeros();
        met &= met - 1;
        changed |= quest.meet(k, facets, triangle as usize, pack.first + triangle);
    }
    changed
}
