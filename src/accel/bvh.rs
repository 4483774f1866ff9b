//! The acceleration structure: triangles, and the trees over them.

use std::ops::Deref;
use std::sync::Arc;

use glam::DVec3;

use super::alpha::AlphaTest;
use super::float::{exponent, power_of_two};
use super::node::{Node, Tag};
use super::pages::{PageSize, Pages};
use super::rays::{Facing, Hit};
use super::tree_space::TreeSpace;
use super::wide::{WideLeaf, WideNode, WideTree};

/// A bounding volume hierarchy over triangles at rest.
#[derive(Debug, Clone)]
pub struct Bvh {
    /// Corners by slot.
    pub(super) corners: Pages<[DVec3; 3]>,
    /// Ids by slot.
    pub(super) tags: Pages<Tag>,
    /// The tree over all triangles, or over those that are not in an island.
    pub(super) tree: Tree,
    /// Trees over geometry that is too fine for the main tree: see [`islands`](super::islands).
    pub(super) islands: Vec<Tree>,
    pub(super) bounds: (DVec3, DVec3),
    /// The size of the memory pages that hold its arrays.
    pub(super) pages: PageSize,
    /// Where triangles have holes; `None` if there are none.
    pub(super) alpha: Option<Arc<dyn AlphaTest>>,
}

/// Boxes over some of the triangles, in the coordinates of their own tree space.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    pub nodes: Pages<Node>,
    /// Levels of nodes.
    pub depth: usize,
    /// The same tree, for packets.
    pub wide: WideTree,
    pub space: TreeSpace,
}

/// One of the trees, with the triangles of all of them.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub bvh: &'a Bvh,
    pub tree: &'a Tree,
}

impl Deref for View<'_> {
    type Target = Bvh;

    #[inline(always)]
    fn deref(&self) -> &Bvh {
        self.bvh
    }
}

impl Tree {
    /// Whether the line from `origin` comes near the tree's content; also true if that is uncertain.
    #[inline(always)]
    pub fn comes_near(&self, origin: DVec3, direction: DVec3) -> bool {
        // The sphere around the tree's box, enlarged by more than the rounding of the offset and the moment.
        let offset = self.space.centre - origin;
        let reach = self.space.radius()
            + power_of_two(-40) * (self.space.centre.length() + origin.length());
        let moment = offset.cross(direction).length_squared();
        let reached = reach * reach * direction.length_squared() * (1.0 + power_of_two(-40));
        // False for NaN and for squares beyond f64: such lines may come near.
        let misses = moment > reached;
        !misses
    }

    fn bytes(&self) -> usize {
        size_of_val::<[_]>(&self.nodes)
            + size_of_val::<[_]>(&self.wide.nodes)
            + size_of_val::<[_]>(&self.wide.leaves)
    }
}

impl Bvh {
    /// Triangles with a coordinate beyond this, 2³⁰⁰ m, are never hit.
    pub const MAX_COORDINATE: f64 = power_of_two(300);

    /// The largest number of triangles in a tree.
    pub const MAX_TRIANGLES: usize = 1 << 30;

    pub(super) fn empty() -> Bvh {
        Bvh {
            corners: Pages::default(),
            tags: Pages::default(),
            tree: Tree {
                nodes: Pages::default(),
                depth: 0,
                wide: WideTree::default(),
                space: TreeSpace::new(DVec3::ZERO, DVec3::ZERO),
            },
            islands: Vec::new(),
            bounds: (DVec3::ZERO, DVec3::ZERO),
            pages: PageSize::Usual,
            alpha: None,
        }
    }

    /// The main tree: the first one, over the spatially largest set.
    #[inline(always)]
    pub(super) fn main(&self) -> View<'_> {
        View {
            bvh: self,
            tree: &self.tree,
        }
    }

    /// The other trees.
    pub(super) fn islands(&self) -> impl Iterator<Item = View<'_>> {
        let view = |tree| View { bvh: self, tree };
        self.islands.iter().map(view)
    }

    /// All trees.
    pub(super) fn trees(&self) -> impl Iterator<Item = View<'_>> {
        std::iter::once(self.main()).chain(self.islands())
    }

    /// The number of triangles that can be hit: those given, without degenerate ones.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there is nothing to hit.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The memory of the tree, bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Bvh>()
            + size_of_val::<[_]>(&self.corners)
            + size_of_val::<[_]>(&self.tags)
            + self.trees().map(|view| view.tree.bytes()).sum::<usize>()
    }

    /// An upper estimate of [`Bvh::bytes`] for this many triangles.
    ///
    /// Wide leaves of meshes hold about five triangles, and wide nodes about seven leaves; the estimate assumes three and six, and a
    /// binary node for every second triangle.
    pub fn estimate_bytes(triangles: usize) -> usize {
        let binary = size_of::<[DVec3; 3]>() + size_of::<Tag>() + size_of::<Node>() / 2;
        let wide = size_of::<WideLeaf>() / 3 + size_of::<WideNode>() / 18;
        let fixed =
            size_of::<Bvh>() + size_of::<Node>() + size_of::<WideNode>() + size_of::<WideLeaf>();
        triangles
            .saturating_mul(binary + wide)
            .saturating_add(fixed)
    }

    /// Minimum and maximum coordinates of the triangles that can be hit, metres.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        (!self.is_empty()).then_some(self.bounds)
    }

    /// The corners of the triangle in `slot`, metres.
    ///
    /// # Panics
    /// If the tree has no such slot: [`Hit::slot`] of its own hits is always valid, [`NO_SLOT`](super::NO_SLOT) never is.
    #[inline]
    pub fn corners(&self, slot: u32) -> [DVec3; 3] {
        self.corners[slot as usize]
    }

    /// The id of the triangle in `slot`, and which of its sides exist.
    ///
    /// # Panics
    /// As for [`corners`](Bvh::corners).
    #[inline]
    pub fn triangle(&self, slot: u32) -> (u32, Facing) {
        let tag = self.tags[slot as usize];
        let facing = match tag.shows(false) {
            true => Facing::TwoSided,
            false => Facing::FrontOnly,
        };
        (tag.id(), facing)
    }

    /// The same tree, with triangles that only exist where `test` says so.
    pub fn with_alpha_test(self, test: Arc<dyn AlphaTest>) -> Bvh {
        Bvh {
            alpha: Some(test),
            ..self
        }
    }

    /// Whether triangles may have holes.
    #[inline(always)]
    pub fn has_holes(&self) -> bool {
        self.alpha.is_some()
    }

    /// Whether triangle `id` is opaque at the point with these barycentric weights of its second and third corner.
    #[inline]
    pub fn is_opaque(&self, id: u32, [u, v]: [f64; 2]) -> bool {
        match &self.alpha {
            None => true,
            Some(test) => test.is_opaque(id, u, v),
        }
    }

    /// Whether a hit with the triangle in `slot` counts: the same for a slot.
    #[inline(always)]
    pub(super) fn is_met(&self, slot: u32, barycentric: [f64; 2]) -> bool {
        !self.has_holes() || self.is_opaque_in(slot, barycentric)
    }

    #[cold]
    fn is_opaque_in(&self, slot: u32, barycentric: [f64; 2]) -> bool {
        self.is_opaque(self.tags[slot as usize].id(), barycentric)
    }

    /// The unit normal of the triangle that was hit, on the side from which its corners run counter-clockwise.
    #[inline]
    pub fn normal(&self, hit: &Hit) -> DVec3 {
        let [a, b, c] = self.corners(hit.slot);
        unit_normal(b - a, c - a)
    }

    /// The same for all triangles, by slot.
    pub(crate) fn normals(&self) -> Pages<DVec3> {
        let corners = &self.corners;
        Pages::build(self.pages, corners.len(), |slot| {
            let [a, b, c] = corners[slot];
            unit_normal(b - a, c - a)
        })
    }
}

/// The unit normal of a triangle with these two edges, on the side from which its corners run counter-clockwise; 0 if it has no area.
#[inline(always)]
fn unit_normal(e1: DVec3, e2: DVec3) -> DVec3 {
    // Scaling by a power of two keeps the direction, and the squares in range.
    let size = e1.abs().max(e2.abs()).max_element();
    // Clamped, so that the factor is a normal number even if the edges are 0 or near the limits of f64.
    let scale = power_of_two(-exponent(size).clamp(-900, 900));
    (e1 * scale).cross(e2 * scale).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_of_all_triangles_are_those_of_hits_on_each() {
        let part = |k: u32| f64::from((31 * k * k + 7919 * k) % 1009) / 1009.0 - 0.5;
        let corner = |k: u32| DVec3::new(part(3 * k), part(3 * k + 1), part(3 * k + 2));
        let triangles = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2].map(corner));
        let bvh = Bvh::build(triangles.collect(), |_| Facing::TwoSided);
        let normals = bvh.normals();
        assert_eq!(normals.len(), 100);
        for (slot, &normal) in (0..).zip(normals.iter()) {
            let hit = Hit {
                s: 1.0,
                u: 0.2,
                v: 0.3,
                triangle: bvh.triangle(slot).0,
                slot,
                front: true,
            };
            assert_eq!(normal, bvh.normal(&hit));
            let [a, b, c] = bvh.corners(slot);
            let cross = (b - a).cross(c - a);
            assert!((normal - cross / cross.length()).length() < 1e-12);
        }
    }
}
