//! The tree of packets: nodes of up to eight children, collapsed from the pairs of [`slab`](super::slab).
//!
//! The boxes are those of the pairs, bit for bit, and so are the leaves. Of a node's inner children the
//! one with the largest surface is replaced by its own two until there are eight: rays that meet the
//! node meet that one most probably (Wald, Benthin, Boulos, RT 2008).

use super::slab::{Link, Node};

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Up to eight child boxes, and where the children are.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Wide {
    /// Per axis: lo and hi of the children. Where there is no child, lo = ∞ and hi = −∞.
    pub planes: [[[f32; WIDTH]; 2]; 3],
    /// What the children are: [`Link::inner`] counts wide nodes here.
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
    /// A quarter of the surface, or nothing for leaves, which can't be replaced.
    fn weight(&self) -> f32 {
        if self.link.is_leaf() {
            return -1.0;
        }
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

/// The wide nodes above the leaves of `nodes`, and how many levels they have.
pub(super) fn collapse(nodes: &[Node]) -> (Vec<Wide>, usize) {
    let mut wide = Vec::with_capacity(nodes.len() / 4 + 1);
    let mut depth = 0;
    let mut pending = Vec::new();
    if !nodes.is_empty() {
        wide.push(Wide::NOTHING);
        pending.push((0, 0, 1));
    }
    while let Some((source, target, level)) = pending.pop() {
        depth = depth.max(level);
        for (at, child) in descendants(nodes, source).iter().enumerate() {
            let mut link = child.link;
            if !link.is_leaf() {
                pending.push((link.index(), wide.len(), level + 1));
                link = Link::inner(wide.len());
                wide.push(Wide::NOTHING);
            }
            wide[target].set_child(at, child, link);
        }
    }
    wide.shrink_to_fit();
    (wide, depth)
}

/// At most eight boxes that hold all that is below `node`.
fn descendants(nodes: &[Node], node: usize) -> Vec<Child> {
    let mut children: Vec<Child> = nodes[node].children().collect();
    while children.len() < WIDTH {
        let by_weight =
            |(_, x): &(usize, &Child), (_, y): &(usize, &Child)| x.weight().total_cmp(&y.weight());
        let largest = children.iter().enumerate().max_by(by_weight);
        let Some((at, child)) = largest.filter(|(_, child)| !child.link.is_leaf()) else {
            break;
        };
        let pair = nodes[child.link.index()].children();
        children.swap_remove(at);
        children.extend(pair);
    }
    children
}
