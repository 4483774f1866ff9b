//! The tree of packets: nodes of up to eight children, and packs of up to eight triangles.
//!
//! Both are collapsed from the pairs of [`slab`](super::slab), and the boxes are those of the pairs, bit
//! for bit. What holds no more than eight triangles becomes a pack. Of a node's other children the one
//! with the largest surface is replaced by its own two until there are eight: rays that meet the node
//! meet that one most probably (Wald, Benthin, Boulos, RT 2008).

use super::pack::Pack;
use super::query::Tag;
use super::slab::{Lattice, Link, Node};
use glam::DVec3;

/// Children of a node, and triangles of a pack.
pub(super) const WIDTH: usize = 8;

/// Up to eight child boxes, and where the children are.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Wide {
    /// Per axis: lo and hi of the children. Where there is no child, lo = ∞ and hi = −∞.
    pub planes: [[[f32; WIDTH]; 2]; 3],
    /// What the children are: [`Link::inner`] counts wide nodes here, [`Link::leaf`] packs.
    pub links: [Link; WIDTH],
}

/// A box of the tree of pairs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Child {
    pub link: Link,
    pub lo: [f32; 3],
    pub hi: [f32; 3],
}

impl Child {
    /// A quarter of the surface.
    fn weight(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|axis| self.hi[axis] - self.lo[axis]);
        x * y + y * z + z * x
    }
}

impl Wide {
    const NOTHING: Wide = Wide {
        planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        links: [Link::ROOT; WIDTH],
    };

    fn set_child(&mut self, at: usize, child: &Child, link: Link) {
        for axis in 0..3 {
            self.planes[axis][0][at] = child.lo[axis];
            self.planes[axis][1][at] = child.hi[axis];
        }
        self.links[at] = link;
    }
}

/// The tree of packets.
#[derive(Debug, Clone, Default)]
pub(super) struct WideTree {
    pub nodes: Vec<Wide>,
    pub packs: Vec<Pack>,
    /// Levels of nodes.
    pub depth: usize,
}

/// What the tree of pairs holds.
#[derive(Clone, Copy)]
pub(super) struct Pairs<'a> {
    pub nodes: &'a [Node],
    pub corners: &'a [[DVec3; 3]],
    pub tags: &'a [Tag],
    pub lattice: &'a Lattice,
}

impl WideTree {
    /// The tree over what `pairs` hold.
    pub fn collapsed(pairs: Pairs) -> WideTree {
        let ranges = pairs.ranges();
        let mut tree = WideTree {
            nodes: Vec::with_capacity(pairs.nodes.len() / 16 + 1),
            packs: Vec::with_capacity(pairs.corners.len() / 5 + 1),
            depth: 0,
        };
        let mut pending = Vec::new();
        if !pairs.nodes.is_empty() {
            tree.nodes.push(Wide::NOTHING);
            pending.push((0, 0, 1));
        }
        while let Some((source, target, level)) = pending.pop() {
            tree.depth = tree.depth.max(level);
            for (at, child) in pairs.descendants(&ranges, source).iter().enumerate() {
                let (first, count) = pairs.range(&ranges, child.link);
                let link = if count <= WIDTH {
                    tree.packs.push(pairs.pack(first, count));
                    Link::leaf(tree.packs.len() - 1)
                } else {
                    pending.push((child.link.index(), tree.nodes.len(), level + 1));
                    tree.nodes.push(Wide::NOTHING);
                    Link::inner(tree.nodes.len() - 1)
                };
                tree.nodes[target].set_child(at, child, link);
            }
        }
        tree.nodes.shrink_to_fit();
        tree.packs.shrink_to_fit();
        tree
    }
}

impl Pairs<'_> {
    /// Per node its first slot and how many there are: depth-first, they follow one another.
    fn ranges(&self) -> Vec<(u32, u32)> {
        let mut ranges = vec![(0, 0); self.nodes.len()];
        for node in (0..self.nodes.len()).rev() {
            let (mut first, mut end) = (u32::MAX, 0);
            for child in self.nodes[node].children() {
                let (slot, count) = self.range(&ranges, child.link);
                first = first.min(slot as u32);
                end = end.max((slot + count) as u32);
            }
            ranges[node] = (first, end.saturating_sub(first));
        }
        ranges
    }

    /// The first slot below `link`, and how many there are.
    fn range(&self, ranges: &[(u32, u32)], link: Link) -> (usize, usize) {
        if link.is_leaf() {
            let first = link.index();
            let last = self.tags[first..].iter().position(|tag| tag.is_last());
            (first, last.map_or(1, |last| last + 1))
        } else {
            let (first, count) = ranges[link.index()];
            (first as usize, count as usize)
        }
    }

    /// At most eight boxes that hold all that is below `node`.
    fn descendants(&self, ranges: &[(u32, u32)], node: usize) -> Vec<Child> {
        let mut children: Vec<Child> = self.nodes[node].children().collect();
        while children.len() < WIDTH {
            let splits = |child: &Child| self.range(ranges, child.link).1 > WIDTH;
            let inner = children.iter().enumerate().filter(|(_, c)| splits(c));
            let largest = inner.max_by(|(_, x), (_, y)| x.weight().total_cmp(&y.weight()));
            let Some((at, child)) = largest else {
                break;
            };
            let pair = self.nodes[child.link.index()].children();
            children.swap_remove(at);
            children.extend(pair);
        }
        children
    }

    fn pack(&self, first: usize, count: usize) -> Pack {
        let slots = first..first + count;
        let corners = &self.corners[slots.clone()];
        let mut pack = Pack::new(self.lattice, corners, first as u32);
        for (at, tag) in self.tags[slots].iter().enumerate() {
            pack.front_only |= u32::from(!tag.shows(false)) << at;
        }
        pack
    }
}
