//! From boxes to a binary tree, by locally ordered clustering (PLOC): Meister and Bittner, "Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction", TVCG 24(3), 2018.
//!
//! Boxes stand in the order of their centres along the Morton curve. In each pass every cluster finds, among the r
//! before and after it, the one with which its common box has the least area; two that find each other become one.
//!
//! Each pass takes n (2r + 1) steps, and of n clusters that lie anyhow it merges a fixed part. It need not: of boxes
//! that are all the same, or that lie one in the other by size, every cluster prefers one that prefers a third, and a pass
//! merges a single pair, so that n boxes take n²(2r + 1)/2 steps. Hence the bound here: a pass that merges less than
//! n/[`SLOWEST`] pairs instead merges neighbours along the curve two by two, which leaves ⌈n/2⌉. With m(n) ≤ n (1 − 1/SLOWEST)
//! all passes together take at most SLOWEST · n (2r + 1) steps, and the tree is at most
//! log(n)/−log(1 − 1/SLOWEST) + [`FEW`] levels deep before it is optimised.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ploc::morton::morton_encode_u64_unorm;
use rayon::prelude::*;

/// A pass has to merge one cluster in so many. Of meshes it merges one in three or four.
const SLOWEST: usize = 20;
/// So few clusters need no bound: at most n²(2r + 1)/2 steps.
const FEW: usize = 64;
/// Clusters that one task looks at.
const CHUNK: usize = 4096;
/// Fewer boxes are sorted and searched by one thread.
const MANY: usize = 2 * CHUNK;

/// The tree over `boxes`, at least one and none with NaN. Clusters look for each other `radius` (of 1, 14 or 32)
/// places away, in the first `narrow` passes only 1. Leaves have one box each, whose index is theirs.
pub(super) fn cluster(boxes: &[Aabb], radius: usize, narrow: usize) -> Bvh2 {
    let mut clusters = sorted(boxes);
    let mut next = Vec::with_capacity(clusters.len());
    let mut partners = vec![0i8; clusters.len()];
    let mut nodes = vec![Bvh2Node::default(); 2 * clusters.len() - 1];
    let mut free = nodes.len();
    let mut passes = 0;
    while clusters.len() > 1 {
        let partners = &mut partners[..clusters.len()];
        match radius {
            _ if passes < narrow => find_partners::<1>(&clusters, partners),
            1 => find_partners::<1>(&clusters, partners),
            14 => find_partners::<14>(&clusters, partners),
            _ => find_partners::<32>(&clusters, partners),
        }
        if clusters.len() > FEW && pairs(partners) < clusters.len() / SLOWEST {
            pair_neighbours(partners);
        }
        next.clear();
        for (index, cluster) in clusters.iter().enumerate() {
            let partner = index.wrapping_add_signed(partners[index].into());
            let agreed = partner.wrapping_add_signed(partners[partner].into()) == index;
            if !agreed || partner == index {
                next.push(*cluster);
            } else if partner < index {
                // The second of the two brings both into the tree.
                free -= 2;
                nodes[free] = *cluster;
                nodes[free + 1] = clusters[partner];
                let both = cluster.aabb().union(clusters[partner].aabb());
                next.push(Bvh2Node::new(both, 0, free as u32));
            }
        }
        std::mem::swap(&mut clusters, &mut next);
        passes += 1;
    }
    nodes[0] = clusters[0];
    let mut tree = Bvh2::zeroed(boxes.len());
    tree.nodes = nodes;
    tree.primitive_indices = (0..boxes.len() as u32).collect();
    tree.max_depth = tree.max_depth.max(passes + 1);
    tree.children_are_ordered_after_parents = true;
    tree
}

/// A leaf for each box, in the order of the centres along the Morton curve; those with one code by index.
fn sorted(boxes: &[Aabb]) -> Vec<Bvh2Node> {
    let (lo, hi) = (boxes.iter()).fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(lo, hi), b| {
        (lo.min(b.min), hi.max(b.max))
    });
    let scale = 1.0 / (hi - lo).as_dvec3().max(DVec3::splat(f64::MIN_POSITIVE));
    let code = |(index, b): (usize, &Aabb)| {
        let centre = (b.center() - lo).as_dvec3() * scale;
        (morton_encode_u64_unorm(centre), index as u32)
    };
    let mut order: Vec<(u64, u32)>;
    if boxes.len() < MANY {
        order = boxes.iter().enumerate().map(code).collect();
        order.sort_unstable();
    } else {
        order = boxes.par_iter().enumerate().map(code).collect();
        order.par_sort_unstable();
    }
    let leaf = |&(_, index): &(u64, u32)| Bvh2Node::new(boxes[index as usize], 1, index);
    order.par_iter().with_min_len(CHUNK).map(leaf).collect()
}

/// For each cluster, how many places away its best partner is; of equals the last.
fn find_partners<const RADIUS: usize>(clusters: &[Bvh2Node], partners: &mut [i8]) {
    if clusters.len() < MANY {
        return find_partners_from::<RADIUS>(clusters, 0, partners);
    }
    let chunks = partners.par_chunks_mut(CHUNK).enumerate();
    chunks.for_each(|(chunk, partners)| {
        find_partners_from::<RADIUS>(clusters, chunk * CHUNK, partners);
    });
}

/// [`find_partners`] for the clusters from `first` on, of which there are as many as `partners`.
fn find_partners_from<const RADIUS: usize>(
    clusters: &[Bvh2Node],
    first: usize,
    partners: &mut [i8],
) {
    let end = first + partners.len();
    let mut areas = [f32::INFINITY; CHUNK];
    let mut areas_of_more;
    let areas = match partners.len() <= CHUNK {
        true => &mut areas[..partners.len()],
        false => {
            areas_of_more = vec![f32::INFINITY; partners.len()];
            &mut areas_of_more[..]
        }
    };
    partners.fill(0);
    // Each pair once: all partners before a cluster come before those after it.
    for i in first.saturating_sub(RADIUS)..end {
        let ours = clusters[i].aabb();
        let last = (i + RADIUS).min(clusters.len() - 1);
        let (mut best, mut partner) = match i >= first {
            true => (areas[i - first], partners[i - first]),
            false => (f32::INFINITY, 0),
        };
        for j in i + 1..=last {
            let area = ours.union(clusters[j].aabb()).half_area();
            if area <= best {
                (best, partner) = (area, (j - i) as i8);
            }
            if (first..end).contains(&j) && area <= areas[j - first] {
                areas[j - first] = area;
                partners[j - first] = -((j - i) as i8);
            }
        }
        if i >= first {
            partners[i - first] = partner;
        }
    }
}

/// How many clusters agree with one after them.
fn pairs(partners: &[i8]) -> usize {
    let agreed = |(index, &away): (usize, &i8)| {
        away > 0 && partners.get(index + away as usize) == Some(&-away)
    };
    partners.iter().enumerate().filter(|p| agreed(*p)).count()
}

/// Makes partners of neighbours, two by two; a last one stays alone.
fn pair_neighbours(partners: &mut [i8]) {
    for pair in partners.chunks_mut(2) {
        match pair {
            [a, b] => (*a, *b) = (1, -1),
            alone => alone.fill(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels of a tree, and how many leaves it has.
    fn levels(tree: &Bvh2) -> (usize, usize) {
        let (mut deepest, mut leaves) = (0, 0);
        let mut pending = vec![(0, 1)];
        while let Some((index, level)) = pending.pop() {
            deepest = deepest.max(level);
            let node = &tree.nodes[index];
            match node.is_leaf() {
                true => leaves += 1,
                false => pending.extend([0, 1].map(|k| (node.first_index as usize + k, level + 1))),
            }
        }
        (deepest, leaves)
    }

    fn around(centre: Vec3A, half: f32) -> Aabb {
        Aabb::new(centre - half, centre + half)
    }

    #[test]
    fn a_tree_over_boxes_that_cannot_be_told_apart_has_few_levels() {
        const N: usize = 30_000;
        // log2(30,000) = 15; at worst log(n)/−log(1 − 1/20) + 64 = 265. Without the bound it was n.
        let fraction = |i: usize| (i + 1) as f32 / N as f32;
        type Make = fn(f32) -> Aabb;
        let families: [(&str, Make); 4] = [
            ("coincident", |_| around(Vec3A::splat(0.5), 0.25)),
            ("concentric", |x| around(Vec3A::splat(0.5), 0.5 * x)),
            ("from one corner", |x| {
                Aabb::new(Vec3A::ZERO, Vec3A::new(x, x, 0.01))
            }),
            ("collinear", |x| around(Vec3A::new(x, 0.0, 0.0), 0.0)),
        ];
        for (name, make) in families {
            let boxes: Vec<Aabb> = (0..N).map(|i| make(fraction(i))).collect();
            for (radius, narrow) in [(1, 2), (14, 3), (32, 2)] {
                let (deepest, leaves) = levels(&cluster(&boxes, radius, narrow));
                assert_eq!(leaves, N, "{name}");
                assert!(deepest <= 96, "{name}, radius {radius}: {deepest} levels");
            }
        }
    }

    #[test]
    fn few_boxes_make_trees_too() {
        for n in 1..70 {
            let boxes: Vec<Aabb> = (0..n)
                .map(|i| around(Vec3A::splat(i as f32), 0.6))
                .collect();
            assert_eq!(levels(&cluster(&boxes, 14, 3)).1, n);
        }
    }

    #[test]
    fn chunks_find_the_partners_that_one_search_finds() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let boxes: Vec<Aabb> = (0..MANY + 777)
            .map(|_| around(Vec3A::new(random(), random(), random()), 0.02 * random()))
            .collect();
        let clusters = sorted(&boxes);
        let mut whole = vec![0; clusters.len()];
        find_partners_from::<14>(&clusters, 0, &mut whole);
        let mut chunked = vec![0; clusters.len()];
        find_partners::<14>(&clusters, &mut chunked);
        assert_eq!(whole, chunked);
    }
}
