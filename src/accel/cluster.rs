//! From boxes to a binary tree, by locally ordered clustering (PLOC): Meister and Bittner, "Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction", TVCG 24(3), 2018.
//!
//! Boxes are sorted along the Morton curve by their centres. In each pass every cluster finds, among the r clusters before and after it,
//! the one whose union with it has the smallest area; two clusters that choose each other are merged.
//!
//! Each pass takes n (2r + 1) steps, and among randomly placed clusters it merges a fixed fraction. This is not guaranteed: among
//! identical boxes, or boxes nested by size, every cluster prefers one that prefers a third, and a pass merges a single pair, so that n
//! boxes take n²(2r + 1)/2 steps. Hence the bound here: a pass that merges fewer than n/[`SLOWEST`] pairs instead merges neighbours along
//! the curve pairwise, which leaves ⌈n/2⌉. With m(n) ≤ n (1 − 1/SLOWEST) all passes together take at most SLOWEST · n (2r + 1) steps, and
//! the tree is at most log(n)/−log(1 − 1/SLOWEST) + [`FEW`] levels deep before it is optimised.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::boxes::{Aabb, BoxNode, BoxTree, GoesOn};
use super::node::NodeRef;

/// A pass must merge at least one cluster in this many. With meshes it merges one in three or four.
const SLOWEST: usize = 20;
/// This few clusters need no bound: at most n²(2r + 1)/2 steps.
const FEW: usize = 64;
/// The number of clusters per task.
const CHUNK: usize = 4096;
/// With fewer boxes, sorting and searching use one thread.
const MANY: usize = 2 * CHUNK;

/// The tree over `leaves`, at least one and without NaN, each with one box and its index. Clusters search for partners `radius` (2, 14 or
/// 32) positions away, in the first `narrow` passes only 1. `None` once `goes_on` says no.
pub(super) fn cluster(
    leaves: Vec<BoxNode>,
    radius: usize,
    narrow: usize,
    goes_on: GoesOn,
) -> Option<BoxTree> {
    let mut clusters = sorted(&leaves);
    let mut next = leaves;
    let mut partners = vec![0i8; clusters.len()];
    // Pairs fill the list from its end, so that children come after their parents and the first position remains for the root.
    let mut nodes = vec![BoxNode::EMPTY; 2 * clusters.len() - 1];
    let mut free = nodes.len();
    let mut passes = 0;
    while clusters.len() > 1 {
        if !goes_on() {
            return None;
        }
        let partners = &mut partners[..clusters.len()];
        // Each radius is compiled separately, with a search of fixed length.
        match radius {
            _ if passes < narrow => find_partners::<1>(&clusters, partners),
            2 => find_partners::<2>(&clusters, partners),
            14 => find_partners::<14>(&clusters, partners),
            _ => find_partners::<32>(&clusters, partners),
        }
        // A pass that merges too few would make the whole algorithm quadratic: see the module documentation.
        if clusters.len() > FEW && pairs(partners) < clusters.len() / SLOWEST {
            pair_neighbours(partners);
        }
        let merged = merge(&clusters, partners, &mut next, &mut nodes[..free]);
        free -= 2 * merged;
        next.truncate(clusters.len() - merged);
        // Swap the two lists, so that no pass allocates.
        std::mem::swap(&mut clusters, &mut next);
        passes += 1;
    }
    nodes[0] = clusters[0];
    Some(BoxTree {
        nodes,
        parents_first: true,
    })
}

/// Puts mutual partners into the tree, from the end of `free` on, and appends a parent of the two to `next`; appends all others unchanged.
/// Returns the number of pairs.
fn merge(
    clusters: &[BoxNode],
    partners: &[i8],
    next: &mut [BoxNode],
    free: &mut [BoxNode],
) -> usize {
    let range = |chunk: usize| chunk * CHUNK..((chunk + 1) * CHUNK).min(clusters.len());
    let partner = |index: usize| index.wrapping_add_signed(partners[index].into());
    let agreed = |index: usize| partners[index] != 0 && partner(partner(index)) == index;
    // How many of a chunk's clusters are the first of a mutual pair, and how many the second, which puts both into the tree.
    let count = |chunk: usize| {
        range(chunk)
            .filter(|&i| agreed(i))
            .fold([0, 0], |counts, index| {
                let [first, second] = counts;
                match partner(index) > index {
                    true => [first + 1, second],
                    false => [first, second + 1],
                }
            })
    };
    let chunks = clusters.len().div_ceil(CHUNK);
    let counts: Vec<[usize; 2]> = match clusters.len() < MANY {
        true => (0..chunks).map(count).collect(),
        false => (0..chunks).into_par_iter().map(count).collect(),
    };
    // Each chunk's own part of the lists, in order.
    let (mut next, mut free) = (next, free);
    let mut parts = Vec::with_capacity(chunks);
    for (chunk, [first, second]) in counts.iter().enumerate() {
        let (followers, more) = next.split_at_mut(range(chunk).len() - first);
        let (less, pairs) = free.split_at_mut(free.len() - 2 * second);
        parts.push((chunk, followers, pairs, less.len()));
        (next, free) = (more, less);
    }
    let fill =
        |(chunk, followers, pairs, begin): (usize, &mut [BoxNode], &mut [BoxNode], usize)| {
            let (mut at, mut end) = (0, pairs.len());
            for index in range(chunk) {
                let partner = partner(index);
                // The first of two adds no entry: the second, possibly in a later chunk, represents both.
                if agreed(index) && partner > index {
                    continue;
                }
                followers[at] = clusters[index];
                // From the end, as the whole list of pairs is filled.
                if agreed(index) {
                    end -= 2;
                    pairs[end] = clusters[index];
                    pairs[end + 1] = clusters[partner];
                    let both = clusters[index].aabb().union(clusters[partner].aabb());
                    // Indices are in the whole tree, which has `begin` nodes before this chunk's.
                    followers[at] = BoxNode::new(both, NodeRef::inner(begin + end));
                }
                at += 1;
            }
        };
    match clusters.len() < MANY {
        true => parts.into_iter().for_each(fill),
        false => parts.into_par_iter().for_each(fill),
    }
    counts.iter().map(|[_, second]| second).sum()
}

/// `leaves` sorted by their centres along the Morton curve; ties by index.
fn sorted(leaves: &[BoxNode]) -> Vec<BoxNode> {
    let (lo, hi) = (leaves.iter())
        .fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(lo, hi), leaf| {
            (lo.min(leaf.aabb().lo), hi.max(leaf.aabb().hi))
        });
    // An axis without extent gets a finite scale, which maps all centres to 0.
    let scale = 1.0 / (hi - lo).as_dvec3().max(DVec3::splat(f64::MIN_POSITIVE));
    let code = |(index, leaf): (usize, &BoxNode)| {
        let Aabb { lo: from, hi: to } = leaf.aabb();
        let centre = ((from + to) * 0.5 - lo).as_dvec3() * scale;
        // Ties are broken by index, so that the order does not depend on the sorting algorithm.
        (morton_code(centre), index as u32)
    };
    let mut order: Vec<(u64, u32)>;
    if leaves.len() < MANY {
        order = leaves.iter().enumerate().map(code).collect();
        order.sort_unstable();
    } else {
        order = leaves.par_iter().enumerate().map(code).collect();
        order.par_sort_unstable();
    }
    let leaf = |&(_, index): &(u64, u32)| leaves[index as usize];
    order.par_iter().with_min_len(CHUNK).map(leaf).collect()
}

/// The position along the Morton curve of a point with coordinates from 0 to 1: the bits of x, y and z interleaved, 21 of each.
fn morton_code(point: DVec3) -> u64 {
    // Inserts two zeros after each bit, in halving steps (the "Part1By2" of J. Baert and F. Giesen, "Decoding Morton codes", 2009).
    let spread = |x: f64| {
        let mut bits = ((x * (1 << 21) as f64) as u64).min((1 << 21) - 1);
        for (shift, kept) in [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ] {
            bits = (bits | bits << shift) & kept;
        }
        bits
    };
    spread(point.x) | spread(point.y) << 1 | spread(point.z) << 2
}

/// For each cluster, the offset of its best partner; ties go to the last.
fn find_partners<const RADIUS: usize>(clusters: &[BoxNode], partners: &mut [i8]) {
    if clusters.len() < MANY {
        return find_partners_from::<RADIUS>(clusters, 0, partners);
    }
    let chunks = partners.par_chunks_mut(CHUNK).enumerate();
    chunks.for_each(|(chunk, partners)| {
        find_partners_from::<RADIUS>(clusters, chunk * CHUNK, partners);
    });
}

/// [`find_partners`] for the `partners.len()` clusters from `first` on.
fn find_partners_from<const RADIUS: usize>(
    clusters: &[BoxNode],
    first: usize,
    partners: &mut [i8],
) {
    let end = first + partners.len();
    // Chunks fit on the stack; a list searched by one thread may be as long as two of them.
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
    // Each pair is evaluated once: all partners before a cluster are considered before those after it.
    for i in first.saturating_sub(RADIUS)..end {
        let ours = clusters[i].aabb();
        let last = (i + RADIUS).min(clusters.len() - 1);
        // Those before `first` belong to another chunk: here they only serve as partners of later ones.
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

/// The number of clusters whose mutual partner comes after them.
fn pairs(partners: &[i8]) -> usize {
    let agreed = |(index, &away): (usize, &i8)| {
        away > 0 && partners.get(index + away as usize) == Some(&-away)
    };
    partners.iter().enumerate().filter(|p| agreed(*p)).count()
}

/// Pairs neighbours, two by two; the last one may stay alone.
fn pair_neighbours(partners: &mut [i8]) {
    for pair in partners.chunks_mut(2) {
        match pair {
            [a, b] => (*a, *b) = (1, -1),
            alone => alone.fill(0),
        }
    }
}

#[cfg(test)]
mod tests;
