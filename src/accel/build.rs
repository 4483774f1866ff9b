//! From triangles to a tree over f32 boxes: clustering, reinsertion of nodes, and a new node layout.

use glam::DVec3;
use rayon::prelude::*;
use robust::{Coord, orient2d};
use serde::Serialize;

use super::boxes::{ALWAYS, Aabb, BoxNode, BoxTree, GoesOn};
use super::bvh::{Bvh, Tree};
use super::cluster::cluster;
use super::islands::{Bounds, Island, islands};
use super::layout::{LAST, Layout};
use super::node::{NodeRef, Tag};
use super::pages::{PageSize, Pages};
use super::rays::Facing;
use super::reinsert::reinsert;
use super::tree_space::TreeSpace;
use super::wide::{BinaryTree, WideTree};

/// How much work goes into a tree. This affects only how fast hits are found, not which.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// Fastest to build: for a still of a large mesh.
    Quick,
    /// Up to twice the build time, and a few per cent faster to trace: for many samples or pictures.
    #[default]
    Balanced,
    /// Four to six times the build time, and faster still to trace for incoherent rays.
    Thorough,
}

/// The number of rays that a tree is built for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ExpectedRays {
    /// From the camera: neighbours have similar directions.
    pub camera: u64,
    /// To lamps.
    pub shadow: u64,
    /// From surfaces in all directions.
    pub bounced: u64,
}

/// A more careful tree saves this many times as much per shadow ray, or per bounced ray, as per camera ray.
const SHADOW_RAYS_WORTH: f64 = 5.0;
const BOUNCED_RAYS_WORTH: f64 = 30.0;
/// From this many camera rays per triangle on, a tree of the next preset pays.
const BALANCED_FROM: f64 = 1000.0;
const THOROUGH_FROM: f64 = 2000.0;

impl Preset {
    /// All of them, quickest first.
    pub const ALL: [Preset; 3] = [Preset::Quick, Preset::Balanced, Preset::Thorough];

    /// The preset that minimizes the total time for `rays` and the trees of this many triangles.
    ///
    /// Break-even as measured with `benches/build.rs` on meshes of 57,000 to 124,000 triangles, one thread: the balanced tree takes 250
    /// to 410 ns per triangle more to build than the quick one, the thorough one 1200 to 1950 ns. In a room of furniture they save 20 and
    /// 45 ns of 290 per incoherent ray, around statues 0 to 15 and 40 ns, and at most 0.4 ns per camera ray.
    pub fn for_rays(triangles: u64, rays: ExpectedRays) -> Preset {
        let worth = rays.camera as f64
            + SHADOW_RAYS_WORTH * rays.shadow as f64
            + BOUNCED_RAYS_WORTH * rays.bounced as f64;
        // No triangles and no rays give NaN, which is in neither range.
        match worth / triangles as f64 {
            per_triangle if per_triangle >= THOROUGH_FROM => Preset::Thorough,
            per_triangle if per_triangle >= BALANCED_FROM => Preset::Balanced,
            _ => Preset::Quick,
        }
    }

    /// Measured with `benches/visibility.rs` and `benches/build.rs`. Without any reinsertion, incoherent rays through a room of furniture
    /// take a third longer; most of that is gained with the topmost nodes. Splitting triangles would exceed the memory budget. Leaves of up
    /// to four triangles save 16 to 20 bytes per triangle, out of 182 to 188, and cost single rays up to a tenth of their speed; packets
    /// use the leaves of the wide tree.
    fn effort(self) -> Effort {
        match self {
            Preset::Quick => Effort {
                radius: 2,
                narrow: 2,
                reinserted: 0.02,
                pages: PageSize::Usual,
            },
            Preset::Balanced => Effort {
                radius: 14,
                narrow: 3,
                reinserted: 0.1,
                pages: PageSize::Large,
            },
            Preset::Thorough => Effort {
                radius: 32,
                narrow: 2,
                reinserted: 0.5,
                pages: PageSize::Large,
            },
        }
    }
}

/// The parameters of a [`Preset`].
struct Effort {
    /// The search radius of clusters, in positions, and the number of first passes in which it is only one.
    radius: usize,
    narrow: usize,
    /// The fraction of the nodes, from the root on, that are reinserted at a better place.
    reinserted: f32,
    /// Large pages cost up to 250 ns per triangle if the system has to fetch them, and save up to 140 ns per incoherent ray.
    pages: PageSize,
}

/// Nodes are reinserted if a ray that hits the root hits at most one node in this many: among nearly equal boxes no place is better.
/// (Random small triangles: one in 50 of 5,000 and one in 1,200 of 10⁶; nested boxes: one in 2.)
const OVERLAPPING: f64 = 16.0;
/// Next to a floor such boxes are a small part of the whole, and are recognised by their shape: a node counts as one if the smaller of its
/// children has at least this fraction of its area, and the same holds for its parent and grandparent. (Copies of a mesh only form pairs.)
const MUCH_THE_SAME: f32 = 0.75;
/// Searches among N of them take up to 0.08 ns N², and everything else 0.5 µs per triangle (2 threads of a Zen 4): N² is limited to this
/// many times the number of triangles, so that searches take no longer than the rest. (Of 57,000 triangles of a kitchen, 1,200 nodes are
/// nested; of statues, none.)
const MOST_PAIRS: usize = 1 << 12;
/// With at most this many triangles, nodes are always reinserted.
const FEW: usize = 256;

impl Bvh {
    /// Builds the tree over `triangles`, given by their corners in metres, relative to the rest frame's origin. A triangle's id is its
    /// index; `facing` says which of its sides exist.
    ///
    /// Triangles without area, and those with a coordinate that isn't finite or is beyond 2³⁰⁰ m,
    /// are never hit. Triangles beyond [`Bvh::MAX_TRIANGLES`] are ignored.
    pub fn build(triangles: Vec<[DVec3; 3]>, facing: impl Fn(u32) -> Facing + Sync) -> Bvh {
        Bvh::build_with(triangles, facing, Preset::default())
    }

    /// [`Bvh::build`] with a choice of effort.
    pub fn build_with(
        triangles: Vec<[DVec3; 3]>,
        facing: impl Fn(u32) -> Facing + Sync,
        preset: Preset,
    ) -> Bvh {
        Bvh::build_while(triangles, &facing, preset, ALWAYS).unwrap_or_else(Bvh::empty)
    }

    /// The same as long as `goes_on`, which is asked between the steps of the work; else `None`.
    pub(crate) fn build_while(
        triangles: Vec<[DVec3; 3]>,
        facing: &(dyn Fn(u32) -> Facing + Sync),
        preset: Preset,
        goes_on: GoesOn,
    ) -> Option<Bvh> {
        let count = triangles.len().min(Bvh::MAX_TRIANGLES);
        let solid = solid_triangles(&triangles[..count]);
        let Some(whole) = Bounds::of_all(&triangles, &solid) else {
            return Some(Bvh::empty());
        };
        // Each list is dropped once the next one has been built from it, so that meshes of 10⁸ triangles fit.
        let pages = preset.effort().pages;
        let mut order = Vec::new();
        let mut layouts = Vec::new();
        for Island { ids, bounds } in islands(&triangles, solid) {
            let space = TreeSpace::new(bounds.lo, bounds.hi);
            let tree = build_tree(&triangles, &ids, &space, preset, goes_on)?;
            let layout = Layout::of(&tree, order.len(), pages);
            drop(tree);
            // Layout indices are within the island; ids are within all triangles. The mark of a leaf's last triangle is kept.
            let id = |place: &u32| ids[(place & !LAST) as usize] | place & LAST;
            order.par_extend(layout.order.par_iter().map(id));
            layouts.push((layout.nodes, layout.depth, space));
            if !goes_on() {
                return None;
            }
        }
        let id = |slot: usize| order[slot] & !LAST;
        let corners = Pages::build(pages, order.len(), |slot| triangles[id(slot) as usize]);
        drop(triangles);
        // A leaf is read up to the tag that ends it.
        let tag = |slot: usize| {
            let tag = Tag::new(id(slot), facing(id(slot)));
            match order[slot] & LAST {
                0 => tag,
                _ => tag.ending_leaf(),
            }
        };
        let tags = Pages::build(pages, order.len(), tag);
        drop(order);
        if !goes_on() {
            return None;
        }
        let mut trees = layouts.into_iter().map(|(nodes, depth, space)| {
            let binary = BinaryTree {
                nodes: &nodes,
                corners: &corners,
                tags: &tags,
                space: &space,
            };
            let wide = WideTree::collapsed(binary, pages);
            Tree {
                nodes,
                depth,
                wide,
                space,
            }
        });
        // The spatially largest set comes first and is the main tree.
        let Some(tree) = trees.next() else {
            return Some(Bvh::empty());
        };
        let islands = trees.collect();
        Some(Bvh {
            corners,
            tags,
            tree,
            islands,
            bounds: (whole.lo, whole.hi),
            pages,
            alpha: None,
        })
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

/// Whether the corners are not collinear: exact, from the three projections.
fn has_area(corners: &[DVec3; 3]) -> bool {
    let projected = |x: usize, y: usize| {
        let [a, b, c] = corners.map(|c| Coord { x: c[x], y: c[y] });
        orient2d(a, b, c)
    };
    projected(0, 1) != 0.0 || projected(1, 2) != 0.0 || projected(2, 0) != 0.0
}

fn build_tree(
    triangles: &[[DVec3; 3]],
    ids: &[u32],
    space: &TreeSpace,
    preset: Preset,
    goes_on: GoesOn,
) -> Option<BoxTree> {
    let leaves: Vec<BoxNode> = ids
        .par_iter()
        .enumerate()
        .map(|(index, &id)| leaf(space, &triangles[id as usize], index))
        .collect();
    let Effort {
        radius,
        narrow,
        reinserted,
        ..
    } = preset.effort();
    let mut tree = cluster(leaves, radius, narrow, goes_on)?;
    let parents = tree.parents();
    // Among nearly equal boxes, reinsertion searches most of the tree for each node and gains nothing.
    if is_searchable(&tree, &parents, ids.len()) {
        reinsert(&mut tree, parents, reinserted, goes_on)?;
    }
    Some(tree)
}

/// The leaf of triangle `index` with these corners.
fn leaf(space: &TreeSpace, corners: &[DVec3; 3], index: usize) -> BoxNode {
    let (lo, hi) = space.bounds(corners);
    let (lo, hi) = (lo.into(), hi.into());
    BoxNode::new(Aabb { lo, hi }, NodeRef::leaf(index))
}

/// Whether nodes are reinserted.
fn is_searchable(tree: &BoxTree, parents: &[u32], triangles: usize) -> bool {
    triangles <= FEW
        || nodes_met(tree) * OVERLAPPING <= triangles as f64
            && nested(tree, parents).pow(2) <= MOST_PAIRS * triangles
}

/// The expected number of nodes that a random line through the root hits: the sum of their areas over the root's.
fn nodes_met(tree: &BoxTree) -> f64 {
    let area = |node: &BoxNode| f64::from(node.aabb().half_area());
    let all: f64 = tree.nodes.iter().map(area).sum();
    all / tree.nodes.first().map_or(1.0, area)
}

/// The number of nodes whose boxes are [`MUCH_THE_SAME`].
fn nested(tree: &BoxTree, parents: &[u32]) -> usize {
    let area = |node: usize| tree.nodes[node].aabb().half_area();
    let is_like_children = |node: usize| {
        (tree.nodes[node].children())
            .is_some_and(|[a, b]| area(a).min(area(b)) >= MUCH_THE_SAME * area(node))
    };
    let parent = |node: usize| parents[node] as usize;
    let is_nested = |&node: &usize| {
        is_like_children(node)
            && is_like_children(parent(node))
            && is_like_children(parent(parent(node)))
    };
    (0..tree.nodes.len()).filter(is_nested).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether nodes are reinserted for this many triangles.
    fn is_searched(count: usize, triangle: impl Fn(usize) -> [DVec3; 3]) -> bool {
        let triangles: Vec<_> = (0..count).map(triangle).collect();
        let ids: Vec<u32> = (0..count as u32).collect();
        let Bounds { lo, hi } = Bounds::of_all(&triangles, &ids).unwrap();
        let space = TreeSpace::new(lo, hi);
        let leaf = |(index, corners): (usize, &[DVec3; 3])| leaf(&space, corners, index);
        let leaves = triangles.iter().enumerate().map(leaf).collect();
        let tree = cluster(leaves, 14, 3, ALWAYS).unwrap();
        is_searchable(&tree, &tree.parents(), count)
    }

    #[test]
    fn better_places_are_looked_for_unless_much_of_the_tree_is_seen_each_time() {
        let place = |i: usize| {
            let part = |k: usize| (i * k % 10_007) as f64 / 10_007.0;
            DVec3::new(part(1237), part(5591), part(8861))
        };
        let small = |place: DVec3| [DVec3::ZERO, DVec3::X, DVec3::ONE].map(|p| place + 0.02 * p);
        let floor = [DVec3::X * -99.0, DVec3::X * 99.0, DVec3::Z * 99.0];
        let nested = |i: usize| [DVec3::X, DVec3::Y, -DVec3::ONE].map(|p| p * i as f64);
        assert!(is_searched(30_000, |i| small(place(i))));
        assert!(!is_searched(30_000, nested));
        // A large triangle does not hide them.
        assert!(!is_searched(60_000, |i| match i {
            0 => floor.map(|p| p * 60_000.0),
            _ => nested(i),
        }));
        // Copies that come in pairs do not count.
        assert!(is_searched(20_000, |i| small(place(i / 2))));
    }
}
