//! Leaves of several triangles, where they cost a ray less than the nodes above them (surface area heuristic: MacDonald and
//! Booth, "Heuristics for ray tracing using space subdivision", The Visual Computer 6(3), 1990).
//!
//! A ray that meets a node of area A meets a child of area A' with probability A'/A. So n triangles in one leaf cost A n;
//! below a node that keeps its children they cost A c + A₁ n₁ + A₂ n₂, with c the cost of a node in those of a triangle.

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

/// The most triangles that a leaf is made of.
const LARGEST_LEAF: u8 = 4;
/// c above: the cost of a node in those of a triangle.
const NODE_COST: f32 = 4.0;

/// Per node of `tree`, whose leaves hold one box each, how many boxes a leaf in its place holds; 0 where it stays a node.
pub(super) fn boxes_of_leaves(tree: &Bvh2) -> Vec<u8> {
    let mut counts = vec![0; tree.nodes.len()];
    let mut decide = |index: usize| {
        let node = &tree.nodes[index];
        if node.is_leaf() {
            counts[index] = 1;
            return;
        }
        let pair = node.first_index as usize;
        let (left, right) = (counts[pair], counts[pair + 1]);
        if left == 0 || right == 0 || left + right > LARGEST_LEAF {
            return;
        }
        let area = |node: &Bvh2Node| node.aabb().half_area();
        let [below, beside] = [pair, pair + 1].map(|child| area(&tree.nodes[child]));
        let apart = below * f32::from(left) + beside * f32::from(right);
        if area(node) * (f32::from(left + right) - NODE_COST) <= apart {
            counts[index] = left + right;
        }
    };
    // Children before their parents.
    if tree.children_are_ordered_after_parents {
        (0..tree.nodes.len()).rev().for_each(decide);
    } else {
        let mut parents_first = Vec::with_capacity(tree.nodes.len());
        let mut pending = vec![0];
        while let Some(index) = pending.pop() {
            parents_first.push(index as u32);
            let node = &tree.nodes[index];
            if !node.is_leaf() {
                pending.extend([0, 1].map(|side| node.first_index as usize + side));
            }
        }
        let children_first = parents_first.iter().rev();
        children_first.for_each(|&index| decide(index as usize));
    }
    counts
}
