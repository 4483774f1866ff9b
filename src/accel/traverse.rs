//! Depth-first traversal of the binary tree by a single ray, nearer child first.

use glam::Vec4;

use super::node::{Node, NodeRef};
use super::slab::{SlabRay, hit_children};
use super::tally::{Counts, Work};

/// A query of the tree by a ray.
pub(super) trait Query {
    /// Tests the triangles of the leaf that starts at `slot`; true ends the traversal.
    fn leaf(&mut self, slot: usize, tally: &mut Counts) -> bool;

    /// The ray parameter beyond which boxes do not matter.
    fn limit(&self) -> f64;
}

/// A child to visit later, and the parameter at which the ray enters its box.
pub(super) type StackEntry = (NodeRef, f32);

/// Stack entries that fit without allocation.
pub(super) const USUAL_DEPTH: usize = 64;

/// Runs `query` on the tree of `nodes`, which must not be empty, along `ray`. `stack` must have at least as many entries as the tree has
/// levels.
#[inline(always)]
pub(super) fn traverse(
    nodes: &[Node],
    ray: &SlabRay,
    stack: &mut [StackEntry],
    query: &mut impl Query,
    tally: &mut Counts,
) {
    // One copy of the loop per octant of directions: no node tests signs.
    match ray.descends {
        [false, false, false] => walk::<false, false, false>(nodes, ray, stack, query, tally),
        [true, false, false] => walk::<true, false, false>(nodes, ray, stack, query, tally),
        [false, true, false] => walk::<false, true, false>(nodes, ray, stack, query, tally),
        [true, true, false] => walk::<true, true, false>(nodes, ray, stack, query, tally),
        [false, false, true] => walk::<false, false, true>(nodes, ray, stack, query, tally),
        [true, false, true] => walk::<true, false, true>(nodes, ray, stack, query, tally),
        [false, true, true] => walk::<false, true, true>(nodes, ray, stack, query, tally),
        [true, true, true] => walk::<true, true, true>(nodes, ray, stack, query, tally),
    }
}

fn walk<const X: bool, const Y: bool, const Z: bool>(
    nodes: &[Node],
    ray: &SlabRay,
    stack: &mut [StackEntry],
    query: &mut impl Query,
    tally: &mut Counts,
) {
    let mut limit = query.limit();
    let mut range = ray.range(limit);
    let mut waiting = 0;
    let mut at = NodeRef::ROOT;
    loop {
        if at.is_leaf() {
            if query.leaf(at.index(), tally) {
                return;
            }
            // A nearer hit narrows the range.
            if query.limit() < limit {
                limit = query.limit();
                range = ray.range(limit);
            }
        } else {
            tally.add(Work::Nodes, 1);
            let node = &nodes[at.index()];
            let clip = ray.clip::<X, Y, Z>(node, range);
            let [first, second] = node.children;
            // Branches, not selects: a correctly predicted branch lets the next node load early.
            match hit_children(clip) {
                0 => {}
                1 => {
                    at = first;
                    continue;
                }
                2 => {
                    at = second;
                    continue;
                }
                // Both are hit: the farther one waits.
                _ if clip.x <= clip.y => {
                    stack[waiting] = (second, clip.y);
                    waiting += 1;
                    at = first;
                    continue;
                }
                _ => {
                    stack[waiting] = (first, clip.x);
                    waiting += 1;
                    at = second;
                    continue;
                }
            }
        }
        match next(stack, &mut waiting, range) {
            Some(next) => at = next,
            None => return,
        }
    }
}

/// The last waiting child that is entered within `range`.
#[inline(always)]
fn next(stack: &[StackEntry], waiting: &mut usize, range: Vec4) -> Option<NodeRef> {
    while *waiting > 0 {
        *waiting -= 1;
        let (node, entry) = stack[*waiting];
        // The last lane of the range is its negated end.
        if entry <= -range.w {
            return Some(node);
        }
    }
    None
}
