//! The nodes of the binary tree, and the tags of its triangles.

use glam::Vec4;

use super::rays::Facing;

/// Two child boxes, and references to the children. 64 bytes: a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Per axis: lo of child 0, lo of child 1, −hi of child 0, −hi of child 1.
    pub planes: [Vec4; 3],
    pub children: [NodeRef; 2],
    /// Pads the node to a cache line.
    _pad: [u32; 2],
}

/// The index of a node, or of the first element of a leaf.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(transparent)]
pub(super) struct NodeRef(u32);

/// A child of a node.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Child {
    pub node: NodeRef,
    pub lo: [f32; 3],
    pub hi: [f32; 3],
}

/// A triangle's id, its facing and whether it is the last of its leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tag(u32);

impl NodeRef {
    const LEAF: u32 = 1 << 31;
    pub const ROOT: NodeRef = NodeRef(0);

    pub fn inner(node: usize) -> NodeRef {
        NodeRef(node as u32)
    }

    /// The leaf that begins with triangle slot `first`; in the wide tree, leaf number `first`.
    pub fn leaf(first: usize) -> NodeRef {
        NodeRef(first as u32 | Self::LEAF)
    }

    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }
}

impl Node {
    /// A node with two children that no ray hits.
    pub const EMPTY: Node = Node {
        planes: [Vec4::INFINITY; 3],
        children: [NodeRef::ROOT; 2],
        _pad: [0; 2],
    };

    /// Sets the child on `side`.
    pub fn set_child(&mut self, side: usize, child: Child) {
        for axis in 0..3 {
            self.planes[axis][side] = child.lo[axis];
            // Negated, so that a single maximum finds the latest entry and the earliest exit.
            self.planes[axis][side + 2] = -child.hi[axis];
        }
        self.children[side] = child.node;
    }

    /// The children that exist.
    pub fn children(&self) -> impl Iterator<Item = Child> + use<> {
        let node = *self;
        [0, 1].into_iter().filter_map(move |side| {
            let child = Child {
                node: node.children[side],
                lo: node.planes.map(|p| p[side]),
                hi: node.planes.map(|p| -p[side + 2]),
            };
            // A missing child has lo = ∞ and hi = −∞.
            (child.lo[0] <= child.hi[0]).then_some(child)
        })
    }
}

impl Child {
    /// A quarter of the box's surface.
    pub fn quarter_area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|axis| self.hi[axis] - self.lo[axis]);
        x * y + y * z + z * x
    }
}

impl Tag {
    const FRONT_ONLY: u32 = 1 << 31;
    const LAST: u32 = 1 << 30;

    pub fn new(id: u32, facing: Facing) -> Tag {
        match facing {
            Facing::TwoSided => Tag(id),
            Facing::FrontOnly => Tag(id | Self::FRONT_ONLY),
        }
    }

    /// The same for the last triangle of a leaf.
    pub fn ending_leaf(self) -> Tag {
        Tag(self.0 | Self::LAST)
    }

    #[inline(always)]
    pub fn id(self) -> u32 {
        self.0 & !(Self::FRONT_ONLY | Self::LAST)
    }

    #[inline(always)]
    pub fn is_last(self) -> bool {
        self.0 & Self::LAST != 0
    }

    /// Whether a ray sees the triangle from this side.
    #[inline(always)]
    pub fn shows(self, front: bool) -> bool {
        front || self.0 & Self::FRONT_ONLY == 0
    }
}
