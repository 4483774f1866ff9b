use super::*;
use crate::accel::boxes::ALWAYS;

/// The levels of a tree, and the number of its leaves.
fn levels(tree: &BoxTree) -> (usize, usize) {
    let (mut deepest, mut leaves) = (0, 0);
    let mut pending = vec![(0, 1)];
    while let Some((index, level)) = pending.pop() {
        deepest = deepest.max(level);
        let node = &tree.nodes[index];
        match node.children() {
            None => leaves += 1,
            Some(pair) => pending.extend(pair.map(|child| (child, level + 1))),
        }
    }
    (deepest, leaves)
}

/// A leaf for each box.
fn leaves(boxes: &[Aabb]) -> Vec<BoxNode> {
    let leaf = |(index, b): (usize, &Aabb)| BoxNode::new(*b, NodeRef::leaf(index));
    boxes.iter().enumerate().map(leaf).collect()
}

fn around(centre: Vec3A, half: f32) -> Aabb {
    Aabb {
        lo: centre - half,
        hi: centre + half,
    }
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
        ("from one corner", |x| Aabb {
            lo: Vec3A::ZERO,
            hi: Vec3A::new(x, x, 0.01),
        }),
        ("collinear", |x| around(Vec3A::new(x, 0.0, 0.0), 0.0)),
    ];
    for (name, make) in families {
        let boxes: Vec<Aabb> = (0..N).map(|i| make(fraction(i))).collect();
        for (radius, narrow) in [(2, 2), (14, 3), (32, 2)] {
            let (deepest, found) =
                levels(&cluster(leaves(&boxes), radius, narrow, ALWAYS).unwrap());
            assert_eq!(found, N, "{name}");
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
        assert_eq!(
            levels(&cluster(leaves(&boxes), 14, 3, ALWAYS).unwrap()).1,
            n
        );
    }
}

/// Randomly placed boxes, some of them equal.
fn scattered(count: usize) -> Vec<Aabb> {
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let mut boxes: Vec<Aabb> = (0..count)
        .map(|_| around(Vec3A::new(random(), random(), random()), 0.02 * random()))
        .collect();
    let first = boxes[0];
    boxes[count / 2..][..count / 10].fill(first);
    boxes
}

#[test]
fn every_box_is_in_the_tree_once_and_within_all_above_it() {
    // In one chunk, in several, and with a last one that is not full.
    for count in [100, MANY, 3 * CHUNK + 5, 40_000] {
        let boxes = scattered(count);
        cluster(leaves(&boxes), 14, 3, ALWAYS)
            .unwrap()
            .check(&boxes);
    }
}

#[test]
fn chunks_find_the_partners_that_one_search_finds() {
    let boxes = scattered(MANY + 777);
    let clusters = sorted(&leaves(&boxes));
    let mut whole = vec![0; clusters.len()];
    find_partners_from::<14>(&clusters, 0, &mut whole);
    let mut chunked = vec![0; clusters.len()];
    find_partners::<14>(&clusters, &mut chunked);
    assert_eq!(whole, chunked);
}

#[test]
fn codes_hold_the_bits_of_the_coordinates_in_turn() {
    let mut random = super::super::numbers(7);
    for _ in 0..1000 {
        let point = DVec3::from_array(std::array::from_fn(|_| random().abs()));
        let code = morton_code(point);
        let expected = (0..63).fold(0, |code, bit| {
            let whole = (point[bit % 3] * 2f64.powi(21)) as u64;
            code | (whole >> (bit / 3) & 1) << bit
        });
        assert_eq!(code, expected);
    }
    // The last point of an axis is in its last interval.
    assert_eq!(morton_code(DVec3::ONE), (1 << 63) - 1);
}
