//! Packets by the million: closed meshes, and the failures of f32 alone on them.

use nullray::accel::{Hit, Kernel, Origins, Precision, Traversal};

use glam::DVec3;

use crate::accel::common::*;

#[test]
fn a_closed_mesh_seen_from_inside_has_no_gap_in_a_million_rays() {
    watertight(1_000_000);
}

#[test]
#[ignore = "takes a minute"]
fn a_closed_mesh_seen_from_inside_has_no_gap_in_a_hundred_million_rays() {
    watertight(100_000_000);
}

fn watertight(rays: usize) {
    let mut random = Random(34);
    let mesh = scaled(&sphere(5), 1.0, DVec3::new(3.0, 0.1, -2.0));
    let bvh = build(&mesh);
    for i in 0..rays / 256 {
        let origin = DVec3::new(3.0, 0.1, -2.0) + random.vector() * 0.5;
        let axis = random.direction();
        let directions = tile(&mut random, axis, 16, 0.001, 0.5);
        let mut hits = vec![None; 256];
        let kernel = Kernel::ALL[i % 3];
        bvh.closest_by(
            certified(kernel),
            Origins::Shared(origin),
            &directions,
            &mut hits,
            None,
            None,
        );
        let inside = |hit: &Option<Hit>| hit.is_some_and(|hit| !hit.front);
        assert!(
            hits.iter().all(inside),
            "{kernel:?}: a leak from {origin} about {axis}"
        );
    }
}

#[test]
fn fast_results_are_those_of_f32() {
    let mut random = Random(35);
    let bvh = build(&sphere(4));
    let (mut same, mut all) = (0, 0);
    for _ in 0..50 {
        let origin = random.direction() * 3.0;
        let directions = tile(&mut random, -origin, 16, 0.01, 0.5);
        for kernel in Kernel::ALL {
            let trace = |precision| {
                let mut hits = vec![None; directions.len()];
                bvh.closest_by(
                    Traversal { kernel, precision },
                    Origins::Shared(origin),
                    &directions,
                    &mut hits,
                    None,
                    None,
                );
                hits
            };
            for (fast, hit) in trace(Precision::Fast)
                .iter()
                .zip(trace(Precision::Certified))
            {
                all += 1;
                same += usize::from(fast.map(|h| h.triangle) == hit.map(|h| h.triangle));
                let (Some(fast), Some(hit)) = (fast, hit) else {
                    continue;
                };
                assert!((fast.s - hit.s).abs() < 1e-4 * hit.s);
                assert_eq!(fast.front, hit.front);
                let close = fast.triangle != hit.triangle
                    || ((fast.u - hit.u).abs() < 1e-3 && (fast.v - hit.v).abs() < 1e-3);
                assert!(close, "{fast:?} {hit:?}");
            }
        }
    }
    assert!(same * 1000 > all * 998, "{same} of {all}");
}
