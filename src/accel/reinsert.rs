//! Reinsertion of nodes at better places: Meister and Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization",
//! Computer Graphics Forum 37(2), 2018.
//!
//! By the surface area heuristic, a tree's cost is proportional to the sum of its nodes' areas. Node A with parent P and sibling B moves
//! beside node C: P is removed and replaced by B, and C is replaced by a node that holds A and C. The sum then shrinks by
//!
//! ```text
//! gain = area(P) + Σ (area(Q) − area(Q without A)) − Σ (area(R ∪ A) − area(R)) − area(C ∪ A)
//! ```
//!
//! where Q runs over all nodes above P up to the first that also contains C, and R over all nodes below that one which contain C. Seen from
//! A, C lies below the sibling of a node above it: for each of these siblings, from bottom to top, everything below it is searched as long
//! as the gain can still exceed the best so far. It cannot if the upper bound exceeds the best by at most area(A), which is the minimum
//! area of C ∪ A.
//!
//! All moves of a pass are found in parallel in the unchanged tree, and made in order of decreasing gain, each unless an earlier one
//! changed an adjacent node or put the target below the node itself.
//!
//! obvhs has the same search, which is not used here: it stores indices in the fourth lanes of boxes, which are denormal numbers, and
//! Intel's processors take over a hundred cycles for a product of such vectors. Trees with many moves took two to three times as long.

use rayon::prelude::*;

use super::boxes::{BoxNode, BoxTree, GoesOn};
use super::node::NodeRef;

/// The number of passes, over decreasing fractions of the nodes: 1, 1/3, 1/5 … of the given one.
const PASSES: usize = 16;

/// Searches for better places for the fraction `part` of the nodes of `tree` with the largest boxes, and for fewer in later passes.
/// `None` once `goes_on` says no.
pub(super) fn reinsert(
    tree: &mut BoxTree,
    parents: Vec<u32>,
    part: f32,
    goes_on: GoesOn,
) -> Option<()> {
    if tree.nodes.len() < 4 || part <= 0.0 {
        return Some(());
    }
    tree.parents_first = false;
    let count = tree.nodes.len();
    let mut moving = Moving {
        is_touched: vec![false; count],
        tree,
        parents,
    };
    for pass in 0..PASSES {
        if !goes_on() {
            return None;
        }
        let wanted = count as f32 * part / (2 * pass + 1) as f32;
        moving.pass((wanted as usize).clamp(1, count - 1));
    }
    Some(())
}

/// A tree whose nodes are being moved.
struct Moving<'a> {
    tree: &'a mut BoxTree,
    parents: Vec<u32>,
    /// Whether a move of this pass has changed the surroundings of a node.
    is_touched: Vec<bool>,
}

/// A node, its new sibling, and the reduction of the areas.
#[derive(Debug, Clone, Copy)]
struct Move {
    node: u32,
    beside: u32,
    gain: f32,
}

/// The other node of a pair.
fn sibling(node: usize) -> usize {
    // Pairs begin at odd indices.
    ((node - 1) ^ 1) + 1
}

impl Moving<'_> {
    /// Finds the moves of `count` nodes and makes them.
    fn pass(&mut self, count: usize) {
        // Large nodes are near the start of the list, but not sorted: take the largest among the first 2 · `count` + 2.
        let listed = (2 * count + 2).min(self.tree.nodes.len());
        let mut largest: Vec<(f32, u32)> = (1..listed)
            .map(|node| (self.area(node), node as u32))
            .collect();
        let by_area = |a: &(f32, u32), b: &(f32, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
        if largest.len() > count {
            largest.select_nth_unstable_by(count, by_area);
            largest.truncate(count);
        }
        let search = |pending: &mut Vec<(f32, u32)>, &(_, node): &(f32, u32)| {
            self.best_move(node as usize, pending)
        };
        let found = largest.par_iter().map_init(Vec::new, search);
        let mut moves: Vec<Move> = found.flatten_iter().collect();
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        self.is_touched.fill(false);
        for found in moves {
            self.make(found);
        }
    }

    fn area(&self, node: usize) -> f32 {
        self.tree.nodes[node].aabb().half_area()
    }

    fn parent(&self, node: usize) -> usize {
        self.parents[node] as usize
    }

    /// The place for `node` with the largest gain, if one is above 0: see the module documentation. `pending` is a scratch list.
    fn best_move(&self, node: usize, pending: &mut Vec<(f32, u32)>) -> Option<Move> {
        let nodes = &self.tree.nodes[..];
        let moved = nodes[node].aabb();
        let own = moved.half_area();
        let parent = self.parent(node);
        let mut best = Move {
            node: node as u32,
            beside: 0,
            gain: 0.0,
        };
        // The area saved above the searched place by removing the node, and the box of that place's parent without the node.
        let mut saved = self.area(parent);
        let mut above = parent;
        let mut searched = sibling(node);
        let mut without = nodes[searched].aabb();
        loop {
            pending.clear();
            pending.push((saved, searched as u32));
            while let Some((saved, place)) = pending.pop() {
                // No box that contains the node is smaller than the node's own.
                if saved - own <= best.gain {
                    continue;
                }
                let there = &nodes[place as usize];
                let gain = saved - there.aabb().union(moved).half_area();
                if gain > best.gain {
                    (best.beside, best.gain) = (place, gain);
                }
                // Below this place the node can only make boxes grow.
                if let Some(children) = there.children() {
                    let below = gain + there.aabb().half_area();
                    pending.extend(children.map(|child| (below, child as u32)));
                }
            }
            if above != parent {
                without = without.union(nodes[searched].aabb());
                saved += self.area(above) - without.half_area();
            }
            if above == 0 {
                break;
            }
            searched = sibling(above);
            above = self.parent(above);
        }
        // The node is already next to its sibling, and its parent would be removed.
        let stays = [sibling(node), parent].contains(&(best.beside as usize));
        (best.gain > 0.0 && !stays).then_some(best)
    }

    /// Makes a move that was found before other moves were made, if it is still possible.
    fn make(&mut self, Move { node, beside, .. }: Move) {
        let (node, beside) = (node as usize, beside as usize);
        let (other, parent) = (sibling(node), self.parent(node));
        let next_to = [node, other, parent, beside, self.parent(beside)];
        if next_to.iter().any(|&near| self.is_touched[near]) || self.is_below(beside, node) {
            return;
        }
        for near in next_to {
            self.is_touched[near] = true;
        }
        // The node's pair of slots is reused for it and its new sibling.
        let pair = NodeRef::inner(node.min(other));
        let [moved_other, there] = [other, beside].map(|index| self.tree.nodes[index]);
        let both = there.aabb().union(self.tree.nodes[node].aabb());
        self.tree.nodes[beside] = BoxNode::new(both, pair);
        self.put(there, other);
        self.put(moved_other, parent);
        self.parents[node] = beside as u32;
        self.parents[other] = beside as u32;
        self.refit_above(beside);
        self.refit_above(parent);
    }

    /// Whether `node` is `top` or below it.
    fn is_below(&self, mut node: usize, top: usize) -> bool {
        while node != top && node != 0 {
            node = self.parent(node);
        }
        node == top
    }

    fn put(&mut self, node: BoxNode, place: usize) {
        self.tree.nodes[place] = node;
        for child in node.children().into_iter().flatten() {
            self.parents[child] = place as u32;
        }
    }

    /// Updates the boxes of all nodes above `node`, up to the first that does not change.
    fn refit_above(&mut self, mut node: usize) {
        while node != 0 {
            node = self.parent(node);
            let above = self.tree.nodes[node];
            let Some([a, b]) = above.children() else {
                return;
            };
            let both = self.tree.nodes[a].aabb().union(self.tree.nodes[b].aabb());
            if both == above.aabb() {
                return;
            }
            self.tree.nodes[node] = BoxNode::new(both, above.content);
        }
    }
}

#[cfg(test)]
mod tests;
