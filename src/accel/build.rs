//! From triangles to a tree over f32 boxes: clustered, optimised by obvhs, and its nodes laid out anew.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use rayon::prelude::*;
use robust::{Coord, orient2d};

use super::bvh::Bvh;
use super::cluster::cluster;
use super::node::{Child, Node, NodeRef, Tag};
use super::rays::Facing;
use super::tree_space::TreeSpace;
use super::wide::{BinaryTree, WideTree};

/// How much work goes into a tree. Hits do not depend on it, only how fast they are found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Preset {
    /// Built fastest.
    Quick,
    /// The best sum of building and tracing for a still.
    #[default]
    Balanced,
    /// Some per cent faster to trace, for several times the time to build.
    Thorough,
}

impl Preset {
    /// All of them, quickest first.
    pub const ALL: [Preset; 3] = [Preset::Quick, Preset::Balanced, Preset::Thorough];

    /// Measured with `benches/visibility.rs` and `benches/build.rs`. Reinsertion beyond 0.1 multiplies the
    /// time to build for 3 % of speed; splitting triangles would break the memory budget. Leaves of up to
    /// four triangles save 16 to 20 bytes per triangle, of 182 to 188, and cost single rays up to a tenth of
    /// their speed; packets have the leaves of the wide tree.
    fn effort(self) -> Effort {
        let (radius, narrow, reinserted) = match self {
            Preset::Quick => (1, 2, 0.0),
            Preset::Balanced => (14, 3, 0.1),
            Preset::Thorough => (32, 2, 0.5),
        };
        Effort {
            radius,
            narrow,
            reinserted,
        }
    }
}

/// What a [`Preset`] means.
struct Effort {
    /// How many places away clusters look for each other, and in how many first passes only one place.
    radius: usize,
    narrow: usize,
    /// The part of the nodes for which a better place is looked for, with single triangles; twice that with leaves.
    reinserted: f32,
}

/// The most triangles of a leaf.
const LARGEST_LEAF: u32 = 4;
/// The cost of a node in those of a triangle, for which leaves are made.
const NODE_COST: f32 = 4.0;
/// Better places for nodes are looked for where a ray that meets the root meets one node in so many at most: a search
/// sees as many, and where boxes are much the same no place is better. (Random small triangles: one in 50 of 5,000 and one
/// in 1,200 of 10⁶; boxes one in the other: one in 2.)
const OVERLAPPING: f64 = 16.0;
/// Of so few triangles they are looked for in any case.
const FEW: usize = 256;

impl Bvh {
    /// Builds the tree over `triangles`: their corners in metres, relative to the rest frame's origin.
    /// A triangle's id is its index; `facing` says which of its sides are there.
    ///
    /// Triangles without area, and those with a coordinate that isn't finite or is beyond 2³⁰⁰ m,
    /// are never hit. Triangles beyond [`Bvh::MAX_TRIANGLES`] are ignored.
    pub fn build(triangles: Vec<[DVec3; 3]>, facing: impl Fn(u32) -> Facing) -> Bvh {
        Bvh::build_with(triangles, facing, Preset::default())
    }

    /// [`Bvh::build`] with more or less care for the tree.
    pub fn build_with(
        triangles: Vec<[DVec3; 3]>,
        facing: impl Fn(u32) -> Facing,
        preset: Preset,
    ) -> Bvh {
        let count = triangles.len().min(Bvh::MAX_TRIANGLES);
        let solid = solid_triangles(&triangles[..count]);
        let Some((lo, hi)) = bounds(&triangles, &solid) else {
            return Bvh::empty();
        };
        // Each list is dropped once the next one is made from it: meshes of 10⁸ triangles have to fit.
        let space = TreeSpace::new(lo, hi);
        let tree = build_tree(&triangles, &solid, &space, preset);
        let layout = Layout::of(&tree);
        drop(tree);
        let ids: Vec<u32> = layout.order.iter().map(|&i| solid[i as usize]).collect();
        drop(solid);
        let corners = ids.par_iter().map(|&id| triangles[id as usize]).collect();
        drop(triangles);
        let tags = ids
            .iter()
            .map(|&id| Tag::new(id, facing(id)))
            .collect::<Vec<_>>();
        let mut bvh = Bvh {
            corners,
            tags,
            nodes: layout.nodes,
            depth: layout.depth,
            wide: WideTree::default(),
            space,
            bounds: (lo, hi),
            alpha: None,
        };
        // A leaf is read up to the tag that ends it.
        for &slot in &layout.last_of_leaf {
            bvh.tags[slot as usize].end_leaf();
        }
        bvh.wide = WideTree::collapsed(BinaryTree {
            nodes: &bvh.nodes,
            corners: &bvh.corners,
            tags: &bvh.tags,
            space: &bvh.space,
        });
        bvh
    }
}

/// The indices of the triangles that a ray can hit.
fn solid_triangles(triangles: &[[DVec3; 3]]) -> Vec<u32> {
    let ids = 0..triangles.len() as u32;
    ids.into_par_iter()
        .filter(|&id| is_in_range(&triangles[id as usize]) && has_area(&triangles[id as usize]))
        .collect()
}

fn is_in_range(corners: &[DVec3; 3]) -> bool {
    let limit = DVec3::splat(Bvh::MAX_COORDINATE);
    // False for NaN.
    corners.iter().all(|c| c.abs().cmple(limit).all())
}

/// Whether the corners are not on one line: exactly so, by the three projections.
fn has_area(corners: &[DVec3; 3]) -> bool {
    let projected = |x: usize, y: usize| {
        let [a, b, c] = corners.map(|c| Coord { x: c[x], y: c[y] });
        orient2d(a, b, c)
    };
    projected(0, 1) != 0.0 || projected(1, 2) != 0.0 || projected(2, 0) != 0.0
}

fn bounds(triangles: &[[DVec3; 3]], ids: &[u32]) -> Option<(DVec3, DVec3)> {
    ids.par_iter()
        .map(|&id| {
            let [a, b, c] = triangles[id as usize];
            (a.min(b).min(c), a.max(b).max(c))
        })
        .reduce_with(|x, y| (x.0.min(y.0), x.1.max(y.1)))
}

fn build_tree(triangles: &[[DVec3; 3]], ids: &[u32], space: &TreeSpace, preset: Preset) -> Bvh2 {
    let boxes: Vec<Aabb> = ids
        .par_iter()
        .map(|&id| {
            let (lo, hi) = space.bounds(&triangles[id as usize]);
            Aabb::new(Vec3A::from(lo), Vec3A::from(hi))
        })
        .collect();
    let Effort {
        radius,
        narrow,
        reinserted,
    } = preset.effort();
    let mut tree = cluster(&boxes, radius, narrow);
    let searchable = boxes.len() <= FEW || nodes_met(&tree) * OVERLAPPING <= boxes.len() as f64;
    let reinserted = if searchable { reinserted } else { 0.0 };
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut tree, reinserted, None);
    collapse(&mut tree, LARGEST_LEAF, NODE_COST);
    optimizer.run(&mut tree, 2.0 * reinserted, None);
    tree
}

/// How many nodes a random line meets that meets the root: the sum of their areas over the root's.
fn nodes_met(tree: &Bvh2) -> f64 {
    let area = |node: &Bvh2Node| f64::from(node.aabb().half_area());
    let all: f64 = tree.nodes.iter().map(area).sum();
    all / tree.nodes.first().map_or(1.0, area)
}

/// Nodes and leaves in the order of a depth-first walk.
struct Layout {
    nodes: Vec<Node>,
    /// What obvhs calls a primitive, by slot.
    order: Vec<u32>,
    last_of_leaf: Vec<u32>,
    /// Levels of nodes.
    depth: usize,
}

impl Layout {
    fn of(tree: &Bvh2) -> Layout {
        let inner = tree.nodes.len() / 2;
        let mut layout = Layout {
            nodes: Vec::with_capacity(inner.max(1)),
            order: Vec::with_capacity(tree.primitive_indices.len()),
            last_of_leaf: Vec::with_capacity(inner + 1),
            depth: 1,
        };
        layout.nodes.push(Node::EMPTY);
        match tree.nodes.first() {
            Some(root) if root.is_leaf() => layout.set_child(tree, 0, 0, 0),
            Some(root) => layout.walk(tree, root.first_index as usize),
            None => {}
        }
        layout
    }

    /// Lays out all that is below the pair of children `pair`, which are those of node 0.
    fn walk(&mut self, tree: &Bvh2, pair: usize) {
        let mut pending = vec![(pair, 0, 1)];
        while let Some((pair, node, depth)) = pending.pop() {
            self.depth = self.depth.max(depth);
            for side in [0, 1] {
                self.set_child(tree, pair + side, node, side);
            }
            for side in [1, 0] {
                let child = &tree.nodes[pair + side];
                if !child.is_leaf() {
                    let index = self.nodes[node].children[side].index();
                    pending.push((child.first_index as usize, index, depth + 1));
                }
            }
        }
    }

    /// Makes `tree.nodes[source]` the child of `node` on `side`.
    fn set_child(&mut self, tree: &Bvh2, source: usize, node: usize, side: usize) {
        let child = &tree.nodes[source];
        let node_ref = if child.is_leaf() {
            let first = child.first_index as usize;
            let slot = self.order.len();
            let primitives = &tree.primitive_indices[first..first + child.prim_count as usize];
            self.order.extend_from_slice(primitives);
            self.last_of_leaf.push(self.order.len() as u32 - 1);
            NodeRef::leaf(slot)
        } else {
            self.nodes.push(Node::EMPTY);
            NodeRef::inner(self.nodes.len() - 1)
        };
        let child = Child {
            node: node_ref,
            lo: child.aabb().min.to_array(),
            hi: child.aabb().max.to_array(),
        };
        self.nodes[node].set_child(side, child);
    }
}
