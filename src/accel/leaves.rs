//! Merges triangles into leaves where this costs a ray less than the nodes above them (surface area heuristic: MacDonald and Booth,
//! "Heuristics for ray tracing using space subdivision", The Visual Computer 6(3), 1990).
//!
//! A ray that hits a node of area A hits a child of area A' with probability A'/A. So n triangles in one leaf cost A n; a node that keeps
//! its children costs A c + A₁ n₁ + A₂ n₂, where c is the cost of a node relative to a triangle.

use super::boxes::{BoxNode, BoxTree};

/// The largest number of triangles in a leaf.
const LARGEST_LEAF: u32 = 4;
/// c above: the cost of a node relative to a triangle.
const NODE_COST: f32 = 4.0;

/// The contents of a node.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Extent {
    /// Nodes with children, including itself; 0 for a leaf.
    pub inner: u32,
    /// Boxes of triangles.
    pub boxes: u32,
}

/// The extent of each node of `tree`, whose leaves hold one box each, once small nodes are leaves.
pub(super) fn extents(tree: &BoxTree) -> Vec<Extent> {
    let mut extents = vec![Extent::default(); tree.nodes.len()];
    let mut measure = |index: usize| extents[index] = extent(tree, &extents, index);
    // Children before their parents.
    if tree.parents_first {
        (0..tree.nodes.len()).rev().for_each(measure);
    } else {
        let mut parents_first = Vec::with_capacity(tree.nodes.len());
        let mut pending = vec![0];
        while let Some(index) = pending.pop() {
            parents_first.push(index as u32);
            pending.extend(tree.nodes[index].children().into_iter().flatten());
        }
        let children_first = parents_first.iter().rev();
        children_first.for_each(|&index| measure(index as usize));
    }
    extents
}

/// The extent of a node, from those of its children.
fn extent(tree: &BoxTree, extents: &[Extent], index: usize) -> Extent {
    let node = &tree.nodes[index];
    let Some(pair) = node.children() else {
        return Extent { inner: 0, boxes: 1 };
    };
    let [left, right] = pair.map(|child| extents[child]);
    let boxes = left.boxes + right.boxes;
    let kept = Extent {
        inner: 1 + left.inner + right.inner,
        boxes,
    };
    // Only leaves are merged into a leaf: a node below that is worth its cost stays.
    if left.inner + right.inner > 0 || boxes > LARGEST_LEAF {
        return kept;
    }
    // The cost of one leaf compared with that of the node and both its leaves.
    let area = |node: &BoxNode| node.aabb().half_area();
    let [below, beside] = pair.map(|child| area(&tree.nodes[child]));
    let apart = below * left.boxes as f32 + beside * right.boxes as f32;
    // A n ≤ A c + A₁ n₁ + A₂ n₂, with A c on the left.
    match area(node) * (boxes as f32 - NODE_COST) <= apart {
        true => Extent { inner: 0, boxes },
        false => kept,
    }
}
