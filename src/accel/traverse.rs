//! Depth-first traversal, nearer child first.

use glam::Vec4;

use super::slab::{Link, Node, Slabs, met};

/// What a traversal is for.
pub(super) trait Query {
    /// Looks at the triangles of the leaf that starts at `slot`; true ends the traversal.
    fn leaf(&mut self, slot: usize) -> bool;

    /// Is told of each node that is looked at.
    fn node(&mut self);

    /// The ray's parameter up to which boxes are of interest.
    fn limit(&self) -> f64;
}

/// A child to visit later, and where the ray enters its box.
pub(super) type Waiting = (Link, f32);

/// Stack entries that are kept without allocation.
pub(super) const USUAL_DEPTH: usize = 64;

/// Leads `query` through the tree of `nodes` (not empty) along `ray`. `stack` holds at least as many
/// entries as the tree is deep.
#[inline(always)]
pub(super) fn traverse(nodes: &[Node], ray: &Slabs, stack: &mut [Waiting], query: &mut impl Query) {
    match ray.descends {
        [false, false, false] => walk::<false, false, false>(nodes, ray, stack, query),
        [true, false, false] => walk::<true, false, false>(nodes, ray, stack, query),
        [false, true, false] => walk::<false, true, false>(nodes, ray, stack, query),
        [true, true, false] => walk::<true, true, false>(nodes, ray, stack, query),
        [false, false, true] => walk::<false, false, true>(nodes, ray, stack, query),
        [true, false, true] => walk::<true, false, true>(nodes, ray, stack, query),
        [false, true, true] => walk::<false, true, true>(nodes, ray, stack, query),
        [true, true, true] => walk::<true, true, true>(nodes, ray, stack, query),
    }
}

fn walk<const X: bool, const Y: bool, const Z: bool>(
    nodes: &[Node],
    ray: &Slabs,
    stack: &mut [Waiting],
    query: &mut impl Query,
) {
    let mut limit = query.limit();
    let mut range = ray.range(limit);
    let mut waiting = 0;
    let mut link = Link::ROOT;
    loop {
        if link.is_leaf() {
            if query.leaf(link.index()) {
                return;
            }
            if query.limit() < limit {
                limit = query.limit();
                range = ray.range(limit);
            }
        } else {
            query.node();
            let node = &nodes[link.index()];
            let clip = node.clip::<X, Y, Z>(ray, range);
            let [first, second] = node.links;
            // Branches, not selections: a branch that is guessed right lets the next node load early.
            match met(clip) {
                0 => {}
                1 => {
                    link = first;
                    continue;
                }
                2 => {
                    link = second;
                    continue;
                }
                _ if clip.x <= clip.y => {
                    stack[waiting] = (second, clip.y);
                    waiting += 1;
                    link = first;
                    continue;
                }
                _ => {
                    stack[waiting] = (first, clip.x);
                    waiting += 1;
                    link = second;
                    continue;
                }
            }
        }
        match next(stack, &mut waiting, range) {
            Some(next) => link = next,
            None => return,
        }
    }
}

/// The last waiting child that is entered within `range`.
#[inline(always)]
fn next(stack: &[Waiting], waiting: &mut usize, range: Vec4) -> Option<Link> {
    while *waiting > 0 {
        *waiting -= 1;
        let (link, entry) = stack[*waiting];
        if entry <= -range.w {
            return Some(link);
        }
    }
    None
}
