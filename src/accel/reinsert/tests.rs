use glam::Vec3A;

use super::super::boxes::Aabb;
use super::super::cluster::cluster;
use super::super::numbers;
use super::*;
use crate::accel::boxes::ALWAYS;

/// `count` boxes of all sizes up to `size` in a room of size 2, and a tree over them.
fn tree(count: usize, size: f32) -> (Vec<Aabb>, BoxTree) {
    let mut random = numbers(count as u64);
    let mut point = || Vec3A::from_array(std::array::from_fn(|_| random() as f32));
    let boxes: Vec<Aabb> = (0..count)
        .map(|_| {
            let (middle, half) = (point(), point().abs() * point().x.abs() * size);
            Aabb {
                lo: middle - half,
                hi: middle + half,
            }
        })
        .collect();
    let leaf = |(index, aabb): (usize, &Aabb)| BoxNode::new(*aabb, NodeRef::leaf(index));
    let tree = cluster(boxes.iter().enumerate().map(leaf).collect(), 2, 2, ALWAYS).unwrap();
    (boxes, tree)
}

fn moving(tree: &mut BoxTree) -> Moving<'_> {
    tree.parents_first = false;
    Moving {
        parents: tree.parents(),
        is_touched: vec![false; tree.nodes.len()],
        tree,
    }
}

/// The sum of the areas of nodes with children.
fn cost(tree: &BoxTree) -> f64 {
    let inner = tree.nodes.iter().filter(|node| !node.is_leaf());
    inner.map(|node| f64::from(node.aabb().half_area())).sum()
}

#[test]
fn boxes_stay_in_the_tree_once_and_its_cost_falls() {
    for (count, size) in [
        (2, 0.1),
        (3, 0.1),
        (9, 1.0),
        (500, 0.05),
        (500, 2.0),
        (4000, 0.3),
    ] {
        for part in [0.02, 0.5, 1.0] {
            let (boxes, mut tree) = tree(count, size);
            let before = cost(&tree);
            let parents = tree.parents();
            reinsert(&mut tree, parents, part, ALWAYS).unwrap();
            tree.check(&boxes);
            let after = cost(&tree);
            assert!(after <= before, "{count} {size} {part}");
            // Among many boxes, some are badly placed after clustering.
            let is_large = count > 100 && part > 0.1;
            assert!(!is_large || after < 0.99 * before, "{after} {before}");
        }
    }
}

#[test]
fn each_move_gains_what_was_foretold_and_no_other_place_gains_more() {
    let (boxes, start) = tree(24, 1.0);
    let before = cost(&start);
    let mut made = 0;
    for node in 1..start.nodes.len() {
        let mut tree = start.clone();
        let best = moving(&mut tree).best_move(node, &mut Vec::new());
        // Try all places except the node itself, and those below, above or next to it.
        let gain = |place: usize| {
            let mut tree = start.clone();
            let mut moving = moving(&mut tree);
            let is_place = !moving.is_below(place, node)
                && ![sibling(node), moving.parent(node)].contains(&place)
                && !moving.is_below(node, place);
            if !is_place {
                return None;
            }
            moving.make(Move {
                node: node as u32,
                beside: place as u32,
                gain: 0.0,
            });
            tree.check(&boxes);
            Some(before - cost(&tree))
        };
        let most = (1..start.nodes.len()).filter_map(gain).fold(0.0, f64::max);
        let foretold = best.map_or(0.0, |best| f64::from(best.gain));
        // f32 sums of some tens of areas up to 50.
        assert!((most - foretold).abs() < 1e-4, "{node}: {most} {foretold}");
        if let Some(best) = best {
            assert!((gain(best.beside as usize).unwrap() - most).abs() < 1e-4);
            made += 1;
        }
    }
    assert!(made > 5, "{made}");
}

#[test]
fn two_nodes_do_not_move_below_each_other() {
    let (boxes, start) = tree(60, 1.0);
    // The first child of the first child of `node`, which no node next to `node` is adjacent to.
    let far_below = |node: usize| {
        let [child, _] = start.nodes[node].children()?;
        Some(start.nodes[child].children()?[0])
    };
    let mut tried = 0;
    for a in 1..start.nodes.len() {
        for b in 1..start.nodes.len() {
            let mut tree = start.clone();
            let mut moving = moving(&mut tree);
            let apart = !moving.is_below(a, b) && !moving.is_below(b, a);
            let (Some(below_a), Some(below_b), true) = (far_below(a), far_below(b), apart) else {
                continue;
            };
            for (node, beside) in [(a, below_b), (b, below_a)] {
                moving.make(Move {
                    node: node as u32,
                    beside: beside as u32,
                    gain: 0.0,
                });
            }
            tree.check(&boxes);
            tried += 1;
        }
    }
    assert!(tried > 50, "{tried}");
}
