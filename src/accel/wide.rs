//! The wide tree, which packets traverse: nodes of up to eight children, leaves of up to eight triangles.
//!
//! It is collapsed from the binary tree, and its boxes are those of the binary tree, bit for bit. Subtrees of at most eight triangles
//! become leaves. Among a node's other children, the one with the largest surface is replaced by its own two until there are eight: rays
//! that hit the node are most likely to hit that one (Wald, Benthin, Boulos, RT 2008).
//!
//! **Corners.** A leaf stores them in f32, relative to its own centre in tree space, so that their precision scales with the leaf. Their
//! error is known: the error of the conversion is measured, and f64 adds less than 2⁻⁵⁰ before it (differences and products with |y| ≤ 1).

use glam::DVec3;

use super::float::power_of_two;
use super::node::{Child, Node, NodeRef, Tag};
use super::pages::{PageSize, Pages};
use super::tree_space::TreeSpace;

/// The maximum number of children of a node, and of triangles in a leaf.
pub(super) const WIDTH: usize = 8;

/// Up to eight child boxes, and references to the children.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct WideNode {
    /// Per axis: lo and hi of the children. For missing children, lo = ∞ and hi = −∞.
    pub planes: [[[f32; WIDTH]; 2]; 3],
    /// Indices of wide nodes and of wide leaves.
    pub children: [NodeRef; WIDTH],
}

/// Up to eight nearby triangles, one per lane.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct WideLeaf {
    /// Per corner and axis; 0 if there is no triangle.
    pub corners: [[[f32; WIDTH]; 3]; 3],
    /// The point to which corners are relative.
    pub centre: [f32; 3],
    /// The largest error of a coordinate.
    pub error: f32,
    /// The slot of the first triangle.
    pub first: u32,
    /// Which triangles exist, as bits.
    pub present: u32,
    /// Those that are visible from the front only.
    pub front_only: u32,
    /// The largest absolute value of `corners`.
    pub size: f32,
}

#[derive(Debug, Clone, Default)]
pub(super) struct WideTree {
    pub nodes: Pages<WideNode>,
    pub leaves: Pages<WideLeaf>,
    /// Levels of nodes.
    pub depth: usize,
}

/// The tree to collapse.
#[derive(Clone, Copy)]
pub(super) struct BinaryTree<'a> {
    pub nodes: &'a [Node],
    pub corners: &'a [[DVec3; 3]],
    pub tags: &'a [Tag],
    pub space: &'a TreeSpace,
}

impl WideNode {
    const EMPTY: WideNode = WideNode {
        planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        children: [NodeRef::ROOT; WIDTH],
    };

    fn set_child(&mut self, at: usize, child: &Child, node: NodeRef) {
        for axis in 0..3 {
            self.planes[axis][0][at] = child.lo[axis];
            self.planes[axis][1][at] = child.hi[axis];
        }
        self.children[at] = node;
    }
}

impl WideLeaf {
    /// The triangles with `corners` and `tags`, at most eight, in slots from `first` on.
    fn new(space: &TreeSpace, corners: &[[DVec3; 3]], tags: &[Tag], first: usize) -> WideLeaf {
        // Corners in tree space, and the box around them.
        let mut mapped = [DVec3::ZERO; 3 * WIDTH];
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (mapped, corner) in mapped.iter_mut().zip(corners.as_flattened()) {
            *mapped = space.map(*corner);
            (lo, hi) = (lo.min(*mapped), hi.max(*mapped));
        }
        let all = &mapped[..3 * corners.len()];
        let centre = ((lo + hi) * 0.5).as_vec3();
        let mut leaf = WideLeaf {
            corners: [[[0.0; WIDTH]; 3]; 3],
            centre: centre.to_array(),
            error: 0.0,
            first: first as u32,
            present: (1 << corners.len()) - 1,
            front_only: 0,
            size: 0.0,
        };
        // Convert corners to f32, by lane, and find the largest error that this causes.
        let mut error = 0.0f64;
        for (at, corner) in all.iter().enumerate() {
            let exact = corner - centre.as_dvec3();
            let kept = exact.as_vec3();
            error = error.max((kept.as_dvec3() - exact).abs().max_element());
            leaf.size = leaf.size.max(kept.abs().max_element());
            for axis in 0..3 {
                leaf.corners[at % 3][axis][at / 3] = kept[axis];
            }
        }
        // The measured error of the conversion, 2⁻⁵⁰ for f64, and the rounding of their sum to f32.
        leaf.error = (error + power_of_two(-50)) as f32 * (1.0 + f32::EPSILON);
        // Triangles whose back does not show are visible from the front only.
        for (at, tag) in tags.iter().enumerate() {
            leaf.front_only |= u32::from(!tag.shows(false)) << at;
        }
        leaf
    }
}

impl WideTree {
    /// `tree`, collapsed, in these `pages`.
    pub fn collapsed(tree: BinaryTree, pages: PageSize) -> WideTree {
        let ranges = tree.ranges();
        // Room for as many nodes, and below for as many leaves, as a usual mesh has.
        let (mut nodes, mut depth) = (Vec::with_capacity(tree.nodes.len() / 16 + 1), 0);
        // Depth-first with a list of nodes whose children are still to be set: source, target, level. Leaves are built afterwards, from
        // their slots.
        let mut slots = Vec::with_capacity(tree.corners.len() / 5 + 1);
        let mut pending = Vec::new();
        if !tree.nodes.is_empty() {
            nodes.push(WideNode::EMPTY);
            pending.push((0, 0, 1));
        }
        while let Some((source, target, level)) = pending.pop() {
            depth = level.max(depth);
            for (at, child) in tree.descendants(&ranges, source).all().iter().enumerate() {
                let (first, count) = tree.range(&ranges, child.node);
                let node = if count <= WIDTH {
                    slots.push((first, count));
                    NodeRef::leaf(slots.len() - 1)
                } else {
                    pending.push((child.node.index(), nodes.len(), level + 1));
                    nodes.push(WideNode::EMPTY);
                    NodeRef::inner(nodes.len() - 1)
                };
                nodes[target].set_child(at, child, node);
            }
        }
        drop(ranges);
        let leaf = |at: usize| {
            let (first, count): (usize, usize) = slots[at];
            tree.leaf(first, count)
        };
        WideTree {
            nodes: Pages::build(pages, nodes.len(), |at| nodes[at]),
            leaves: Pages::build(pages, slots.len(), leaf),
            depth,
        }
    }
}

/// Up to eight boxes, the largest of which can be replaced by its children.
#[derive(Default)]
struct Descendants {
    children: [Child; WIDTH],
    /// A quarter of each box's surface; negative if it cannot be replaced.
    areas: [f32; WIDTH],
    count: usize,
}

impl Descendants {
    fn push(&mut self, child: Child, splits: bool) {
        self.areas[self.count] = if splits { child.quarter_area() } else { -1.0 };
        self.children[self.count] = child;
        self.count += 1;
    }

    /// Removes the largest replaceable box, the last among equals; the last box takes its place.
    fn take_largest(&mut self) -> Option<Child> {
        let mut largest = None;
        let mut area = 0.0;
        for (at, &other) in self.areas[..self.count].iter().enumerate() {
            if other >= area {
                (largest, area) = (Some(at), other);
            }
        }
        let at = largest?;
        let child = self.children[at];
        self.count -= 1;
        self.children[at] = self.children[self.count];
        self.areas[at] = self.areas[self.count];
        Some(child)
    }

    fn all(&self) -> &[Child] {
        &self.children[..self.count]
    }
}

impl BinaryTree<'_> {
    /// The first slot of each node and its number of slots: in depth-first order, they are consecutive.
    fn ranges(&self) -> Vec<(u32, u32)> {
        // Children come after their parents: going backwards from the last node, their ranges are known.
        let mut ranges = vec![(0, 0); self.nodes.len()];
        for node in (0..self.nodes.len()).rev() {
            let (mut first, mut end) = (u32::MAX, 0);
            for child in self.nodes[node].children() {
                let (slot, count) = self.range(&ranges, child.node);
                first = first.min(slot as u32);
                end = end.max((slot + count) as u32);
            }
            ranges[node] = (first, end.saturating_sub(first));
        }
        ranges
    }

    /// The first slot below `node`, and the number of slots.
    fn range(&self, ranges: &[(u32, u32)], node: NodeRef) -> (usize, usize) {
        if node.is_leaf() {
            let first = node.index();
            let last = self.tags[first..].iter().position(|tag| tag.is_last());
            (first, last.map_or(1, |last| last + 1))
        } else {
            let (first, count) = ranges[node.index()];
            (first as usize, count as usize)
        }
    }

    /// At most eight boxes that enclose everything below `node`.
    fn descendants(&self, ranges: &[(u32, u32)], node: usize) -> Descendants {
        let mut found = Descendants::default();
        let add = |found: &mut Descendants, child: Child| {
            // Triangles that fit into one leaf stay together.
            let splits = self.range(ranges, child.node).1 > WIDTH;
            found.push(child, splits);
        };
        self.nodes[node]
            .children()
            .for_each(|child| add(&mut found, child));
        while found.count < WIDTH {
            let Some(largest) = found.take_largest() else {
                break;
            };
            // The largest is replaced by its own two children.
            let pair = self.nodes[largest.node.index()].children();
            pair.for_each(|child| add(&mut found, child));
        }
        found
    }

    fn leaf(&self, first: usize, count: usize) -> WideLeaf {
        let (corners, tags) = (
            &self.corners[first..][..count],
            &self.tags[first..][..count],
        );
        WideLeaf::new(self.space, corners, tags, first)
    }
}
