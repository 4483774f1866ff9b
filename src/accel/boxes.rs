//! Boxes in f32, and the binary tree over them during the build.

use glam::{Vec3, Vec3A};

use super::node::NodeRef;

/// A box in tree space.
///
/// Its vectors have a fourth lane, which repeats a coordinate: an index there would be a denormal number, and every product of such a
/// vector would take over a hundred cycles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Aabb {
    pub lo: Vec3A,
    pub hi: Vec3A,
}

/// A box and its content, in half a cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct BoxNode {
    lo: Vec3,
    /// A leaf's box, or the first of two children, which are adjacent.
    pub content: NodeRef,
    hi: Vec3,
}

/// A binary tree whose leaves hold one box each. The root is first; children are stored in pairs from index 1 on.
#[derive(Debug, Clone)]
pub(super) struct BoxTree {
    pub nodes: Vec<BoxNode>,
    /// Whether all children come after their parents.
    pub parents_first: bool,
}

/// Whether the build goes on: asked often, from the thread that builds.
pub(super) type GoesOn<'a> = &'a (dyn Fn() -> bool + Sync);

/// A build that is never stopped.
pub(super) const ALWAYS: GoesOn = &|| true;

impl Aabb {
    #[inline(always)]
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    /// Half the box's surface.
    #[inline(always)]
    pub fn half_area(self) -> f32 {
        let [x, y, z] = (self.hi - self.lo).to_array();
        (x + y) * z + x * y
    }
}

impl BoxNode {
    /// A placeholder for nodes that are not set yet.
    pub const EMPTY: BoxNode = BoxNode {
        lo: Vec3::ZERO,
        content: NodeRef::ROOT,
        hi: Vec3::ZERO,
    };

    #[inline(always)]
    pub fn new(aabb: Aabb, content: NodeRef) -> BoxNode {
        let (lo, hi) = (aabb.lo.into(), aabb.hi.into());
        BoxNode { lo, content, hi }
    }

    #[inline(always)]
    pub fn aabb(&self) -> Aabb {
        let (lo, hi) = (self.lo.into(), self.hi.into());
        Aabb { lo, hi }
    }

    #[inline(always)]
    pub fn is_leaf(&self) -> bool {
        self.content.is_leaf()
    }

    /// The two children, if it has any.
    #[inline(always)]
    pub fn children(&self) -> Option<[usize; 2]> {
        let first = self.content.index();
        (!self.is_leaf()).then_some([first, first + 1])
    }
}

impl BoxTree {
    /// The parent of each node; the root's is the root.
    pub fn parents(&self) -> Vec<u32> {
        let mut parents = vec![0; self.nodes.len()];
        for (parent, node) in self.nodes.iter().enumerate() {
            for child in node.children().into_iter().flatten() {
                parents[child] = parent as u32;
            }
        }
        parents
    }
}

#[cfg(test)]
impl BoxTree {
    /// Panics unless each box is in exactly one leaf, each node has one parent, and each box is the smallest that encloses its children's.
    pub(super) fn check(&self, boxes: &[Aabb]) {
        let mut found = vec![0; boxes.len()];
        let mut linked = vec![0; self.nodes.len()];
        linked[0] = 1;
        for (index, node) in self.nodes.iter().enumerate() {
            match node.children() {
                None => {
                    found[node.content.index()] += 1;
                    assert_eq!(node.aabb(), boxes[node.content.index()]);
                }
                Some(pair) => {
                    assert!(!self.parents_first || pair[0] > index, "{index} {pair:?}");
                    let [a, b] = pair.map(|child| {
                        linked[child] += 1;
                        self.nodes[child].aabb()
                    });
                    assert_eq!(node.aabb(), a.union(b));
                }
            }
        }
        assert!(found.iter().chain(&linked).all(|&times| times == 1));
        // No cycle is detached from the root: the root reaches all nodes.
        let (mut met, mut pending) = (0, vec![0]);
        while let Some(index) = pending.pop() {
            met += 1;
            pending.extend(self.nodes[index].children().into_iter().flatten());
        }
        assert_eq!(met, self.nodes.len());
    }
}
