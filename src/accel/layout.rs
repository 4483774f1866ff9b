//! Nodes and triangle slots in depth-first order.
//!
//! The number of nodes and triangles below each node is known, so the positions of both its sides are known before either is laid out:
//! large sides are laid out in parallel, at the same positions as serially.

use super::boxes::{BoxNode, BoxTree};
use super::leaves::{Extent, extents};
use super::node::{Child, Node, NodeRef};
use super::pages::{PageSize, Pages};

/// With fewer triangles, the layout uses one thread.
const MANY: u32 = 4096;
/// Threads share the work down to this level: 2³² parts of one triangle, and no deep recursion.
const SHARED_LEVELS: usize = 32;

/// A tree ready for traversal, without its triangles.
pub(super) struct Layout {
    pub nodes: Pages<Node>,
    /// The box index of each slot, with [`LAST`] if it is the last of its leaf.
    pub order: Vec<u32>,
    /// Levels of nodes.
    pub depth: usize,
}

/// Marks the last triangle of a leaf.
pub(super) const LAST: u32 = 1 << 31;

/// The tree to lay out, and the extent of each of its nodes.
struct Source<'a> {
    tree: &'a BoxTree,
    extents: Vec<Extent>,
}

/// Space for everything below a node: the nodes except itself, and the slots.
struct Places<'a> {
    nodes: &'a mut [Node],
    first_node: usize,
    order: &'a mut [u32],
    first_slot: usize,
}

impl Layout {
    /// The layout of `tree`, whose leaves contain one box each: larger leaves are formed here. Its slots begin at `first_slot`, and its
    /// nodes are stored in these `pages`.
    pub fn of(tree: &BoxTree, first_slot: usize, pages: PageSize) -> Layout {
        let source = Source {
            tree,
            extents: extents(tree),
        };
        let whole = source.extents.first().copied().unwrap_or_default();
        let mut layout = Layout {
            nodes: Pages::build(pages, whole.inner.max(1) as usize, |_| Node::EMPTY),
            order: vec![0; whole.boxes as usize],
            depth: 1,
        };
        let Some(root) = tree.nodes.first() else {
            return layout;
        };
        let (node, below) = layout.nodes.split_at_mut(1);
        let mut places = Places {
            nodes: below,
            first_node: 1,
            order: &mut layout.order,
            first_slot,
        };
        // A tree of a single leaf still has a root, with that leaf as its only child.
        if whole.inner == 0 {
            let leaf = places.leaf(&source, 0, &mut 0);
            node[0].set_child(0, child(root, leaf));
        } else {
            (node[0], layout.depth) = places.fill(&source, root.content.index(), 1);
        }
        layout
    }
}

impl Places<'_> {
    /// Lays out everything below the pair of children `pair` of a node on `level`. Returns that node, and the deepest level.
    fn fill(self, source: &Source, pair: usize, level: usize) -> (Node, usize) {
        let [left, right] = [pair, pair + 1].map(|child| source.extents[child]);
        let is_shared = left.inner.min(right.inner) > 0 && left.boxes + right.boxes >= MANY;
        if !is_shared || level > SHARED_LEVELS {
            return self.walk(source, pair, level);
        }
        // The two children are adjacent, followed by everything below either.
        let (heads, below) = self.nodes.split_at_mut(2);
        // The head of the left side is one of its inner nodes, and is in `heads`.
        let (left_nodes, right_nodes) = below.split_at_mut(left.inner as usize - 1);
        let (left_order, right_order) = self.order.split_at_mut(left.boxes as usize);
        let first = self.first_node + 2;
        let left_places = Places {
            first_node: first,
            nodes: left_nodes,
            order: left_order,
            first_slot: self.first_slot,
        };
        let right_places = Places {
            first_node: first + left.inner as usize - 1,
            nodes: right_nodes,
            order: right_order,
            first_slot: self.first_slot + left.boxes as usize,
        };
        let below = |child: usize| source.tree.nodes[child].content.index();
        let ((left_head, left_depth), (right_head, right_depth)) = rayon::join(
            || left_places.fill(source, below(pair), level + 1),
            || right_places.fill(source, below(pair + 1), level + 1),
        );
        heads.copy_from_slice(&[left_head, right_head]);
        let mut node = Node::EMPTY;
        for side in [0, 1] {
            let target = NodeRef::inner(self.first_node + side);
            node.set_child(side, child(&source.tree.nodes[pair + side], target));
        }
        (node, left_depth.max(right_depth))
    }

    /// [`Places::fill`] on one thread, without recursion.
    fn walk(mut self, source: &Source, pair: usize, level: usize) -> (Node, usize) {
        let (mut used_nodes, mut used_slots) = (0, 0);
        let (mut top, mut depth) = (Node::EMPTY, level);
        // Pairs of children still to be laid out, with the position of their node and its level.
        let mut pending = vec![(pair, None, level)];
        while let Some((pair, place, level)) = pending.pop() {
            depth = depth.max(level);
            let mut node = Node::EMPTY;
            for side in [0, 1] {
                let target = if source.extents[pair + side].inner == 0 {
                    self.leaf(source, pair + side, &mut used_slots)
                } else {
                    used_nodes += 1;
                    NodeRef::inner(self.first_node + used_nodes - 1)
                };
                node.set_child(side, child(&source.tree.nodes[pair + side], target));
            }
            // The left side is pushed last, and therefore laid out next, which gives depth-first order.
            for side in [1, 0] {
                if source.extents[pair + side].inner > 0 {
                    let below = source.tree.nodes[pair + side].content.index();
                    let place = node.children[side].index() - self.first_node;
                    pending.push((below, Some(place), level + 1));
                }
            }
            match place {
                Some(place) => self.nodes[place] = node,
                None => top = node,
            }
        }
        (top, depth)
    }

    /// A leaf with all triangles below `index`, from slot `used` on.
    fn leaf(&mut self, source: &Source, index: usize, used: &mut usize) -> NodeRef {
        let leaf = NodeRef::leaf(self.first_slot + *used);
        self.gather(source.tree, &source.tree.nodes[index], used);
        self.order[*used - 1] |= LAST;
        leaf
    }

    /// Puts everything below `node` into slots; at most one leaf's contents, which bounds the recursion.
    fn gather(&mut self, tree: &BoxTree, node: &BoxNode, used: &mut usize) {
        match node.children() {
            None => {
                self.order[*used] = node.content.index() as u32;
                *used += 1;
            }
            Some(pair) => {
                for child in pair {
                    self.gather(tree, &tree.nodes[child], used);
                }
            }
        }
    }
}

/// `node` in the form in which its parent stores it.
fn child(node: &BoxNode, target: NodeRef) -> Child {
    Child {
        node: target,
        lo: node.aabb().lo.to_array(),
        hi: node.aabb().hi.to_array(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::boxes::Aabb;
    use super::super::cluster::cluster;
    use super::*;
    use crate::accel::boxes::ALWAYS;
    use glam::Vec3A;

    /// A tree over boxes along a bent line, some of them equal.
    fn tree(count: usize) -> BoxTree {
        let leaf = |index: usize| {
            let x = (index / 3) as f32;
            let centre = Vec3A::new(x, (0.01 * x).sin(), 0.1 * (index % 7) as f32);
            let (lo, hi) = (centre - 0.5, centre + 0.5);
            BoxNode::new(Aabb { lo, hi }, NodeRef::leaf(index))
        };
        cluster((0..count).map(leaf).collect(), 14, 3, ALWAYS).unwrap()
    }

    #[test]
    fn threads_lay_out_what_one_walk_does() {
        let tree = tree(50_000);
        let shared = Layout::of(&tree, 0, PageSize::Usual);
        let source = Source {
            extents: extents(&tree),
            tree: &tree,
        };
        let mut nodes = vec![Node::EMPTY; shared.nodes.len()];
        let mut order = vec![0; shared.order.len()];
        let places = Places {
            nodes: &mut nodes[1..],
            first_node: 1,
            order: &mut order,
            first_slot: 0,
        };
        let (root, depth) = places.walk(&source, tree.nodes[0].content.index(), 1);
        nodes[0] = root;
        assert_eq!((shared.depth, &shared.order), (depth, &order));
        for (one, other) in shared.nodes.iter().zip(&nodes) {
            assert_eq!((one.planes, one.children), (other.planes, other.children));
        }
    }

    #[test]
    fn every_box_has_a_slot_and_leaves_end() {
        for count in [1, 2, 5, 9, 64, 10_000] {
            let layout = Layout::of(&tree(count), 0, PageSize::Usual);
            let mut boxes: Vec<u32> = layout.order.iter().map(|place| place & !LAST).collect();
            boxes.sort_unstable();
            assert!(boxes.into_iter().eq(0..count as u32), "{count}");
            // Each leaf begins where the previous one ends.
            let children = layout.nodes.iter().flat_map(|node| node.children());
            let leaves = children.filter(|child| child.node.is_leaf());
            let mut begins: Vec<usize> = leaves.map(|leaf| leaf.node.index()).collect();
            begins.sort_unstable();
            let ends = (0..count).filter(|&slot| layout.order[slot] & LAST != 0);
            let after = ends.map(|slot| slot + 1);
            let expected: Vec<usize> = [0].into_iter().chain(after).collect();
            assert_eq!(begins, expected[..expected.len() - 1], "{count}");
            assert_eq!(expected.last(), Some(&count));
        }
    }
}
