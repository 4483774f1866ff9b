use glam::DVec3;

use super::*;
use crate::accel::packet::method::{Kernel, Precision, Traversal};
use crate::accel::{Bvh, Counts, Facing, Origins, Ray, Segment, numbers};

fn certified(kernel: Kernel) -> Traversal {
    Traversal {
        kernel,
        precision: Precision::Certified,
    }
}

/// The nearest hits of these rays, and which rays have one, in order.
fn closest(
    bvh: &Bvh,
    method: Traversal,
    origins: &[DVec3],
    directions: &[DVec3],
) -> (Vec<Option<Hit>>, Vec<usize>) {
    let mut hits = vec![None; origins.len()];
    let mut replaced = Vec::new();
    let from = Origins::Each(origins);
    bvh.closest_by(
        method,
        from,
        directions,
        &mut hits,
        None,
        Some(&mut replaced),
    );
    replaced.sort_unstable();
    (hits, replaced)
}

#[test]
fn incoherent_rays_and_segments_find_what_the_binary_tree_finds() {
    let mut next = numbers(3);
    for (round, size) in [1.0f64, 0.05, 1e-4, 1e6].into_iter().enumerate() {
        let mut vector = || DVec3::new(next(), next(), next());
        let triangles: Vec<_> = (0..3000)
            .map(|k| {
                // Some in one plane, and some very thin.
                let centre = vector()
                    * if k % 3 == 0 {
                        DVec3::new(1.0, 1.0, 0.0)
                    } else {
                        DVec3::ONE
                    };
                let (e1, e2) = (vector() * 0.1 * size.min(1.0), vector() * 0.1);
                let e2 = if k % 5 == 0 {
                    e1 * 1.0001 + e2 * 1e-7
                } else {
                    e2 * size.min(1.0)
                };
                [centre, centre + e1, centre + e2].map(|p| p * size.max(1.0))
            })
            .collect();
        let facing = |k: u32| match k % 7 {
            0 => Facing::FrontOnly,
            _ => Facing::TwoSided,
        };
        let corners = triangles.clone();
        let bvh = Bvh::build(triangles, facing);
        // Through corners and edges too, and along axes.
        let mut rays = Vec::new();
        for k in 0..4000 {
            let from = vector() * 3.0 * size.max(1.0);
            let triangle = corners[k % corners.len()];
            let to = match k % 4 {
                0 => triangle[k % 3],
                1 => triangle[0].midpoint(triangle[1]),
                2 => (triangle[0] + triangle[1] + triangle[2]) / 3.0,
                _ => from + DVec3::AXES[k % 3],
            };
            rays.push((from, to - from));
        }
        let (origins, directions): (Vec<_>, Vec<_>) = rays.iter().copied().unzip();
        let segments: Vec<_> = rays
            .iter()
            .map(|&(origin, direction)| Segment {
                ray: Ray {
                    origin,
                    direction,
                    s_min: 1e-9,
                },
                s_max: 0.999,
                skip: Some(17),
                end: None,
            })
            .collect();
        let trace = |kernel| {
            let method = certified(kernel);
            let (hits, _) = closest(&bvh, method, &origins, &directions);
            let mut blocked = vec![false; rays.len()];
            bvh.any_by(method, &segments, &mut blocked, None);
            (hits, blocked)
        };
        let expected = trace(Kernel::Scalar);
        assert!(
            expected.0.iter().filter(|hit| hit.is_some()).count() > 1000,
            "{round}"
        );
        for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
            assert!(trace(kernel) == expected, "{kernel:?}, size {size}");
        }
    }
}

#[test]
fn rays_through_a_tree_that_is_deeper_than_their_stacks_are_left_to_the_binary_one() {
    let mut next = numbers(5);
    let mut point = |size: f64| DVec3::new(next(), next(), next()) * size;
    let triangles: Vec<[DVec3; 3]> = (0..500)
        .map(|_| {
            let corner = point(1.0);
            [corner, corner + point(0.3), corner + point(0.3)]
        })
        .collect();
    let (origins, directions): (Vec<_>, Vec<_>) =
        (0..500).map(|_| (point(1.5), point(1.0))).unzip();
    let mut bvh = Bvh::build(triangles, |_| Facing::TwoSided);
    let expected = closest(&bvh, certified(Kernel::Scalar), &origins, &directions);
    assert!(expected.1.len() > 100);
    let vector_kernels = Kernel::ALL.into_iter().filter(|k| k.is_supported());
    for kernel in vector_kernels.filter(|k| *k != Kernel::Scalar) {
        let [usual, deep] = [DEPTH, DEPTH + 1].map(|depth| {
            bvh.tree.wide.depth = depth;
            let mut counts = Counts::default();
            let mut hits = vec![None; origins.len()];
            let (method, from) = (certified(kernel), Origins::Each(&origins));
            bvh.closest_by(
                method,
                from,
                &directions,
                &mut hits,
                Some(&mut counts),
                None,
            );
            assert!(hits == expected.0, "{kernel:?}, depth {depth}");
            counts.nodes
        });
        // The binary tree has smaller nodes, and more of them.
        assert!(deep > 2 * usual, "{kernel:?}: {usual}, {deep}");
    }
}

#[test]
fn of_triangles_in_one_plane_the_first_is_hit_and_rays_beyond_the_limits_are_traced() {
    let mut next = numbers(8);
    // Many of them overlap, in a few axis-aligned planes.
    let triangles: Vec<[DVec3; 3]> = (0..400)
        .map(|k| {
            let height = 0.1 + f64::from(k as u8 % 5) * 0.17;
            [0, 1, 2].map(|_| match k % 3 {
                0 => DVec3::new(next(), next(), height),
                1 => DVec3::new(height, next(), next()),
                _ => DVec3::new(next(), height, next()),
            })
        })
        .collect();
    let bvh = Bvh::build(triangles, |_| Facing::TwoSided);
    let (origins, directions): (Vec<_>, Vec<_>) = (0..4000)
        .map(|k| {
            let (from, to) = (
                DVec3::new(next(), next(), next()),
                DVec3::new(next(), next(), next()),
            );
            match k % 40 {
                // From far away, from nowhere, to nowhere, and with lengths beyond the limits.
                0 => (from * 1e4, to - from * 1e4),
                1 => (from * 1e28, to - from * 1e28),
                2 => (from * f64::NAN, to),
                3 => (from, to * f64::INFINITY),
                4 => (from, DVec3::ZERO),
                5 => (from, to * 1e-200),
                _ => (from, to),
            }
        })
        .unzip();
    let trace = |kernel| closest(&bvh, certified(kernel), &origins, &directions);
    let expected = trace(Kernel::Scalar);
    let far = (0..4000).step_by(40);
    assert!(far.filter(|&k| expected.0[k].is_some()).count() > 50);
    for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
        assert!(trace(kernel) == expected, "{kernel:?}");
    }
}
