//! Triangles with holes: packets and single rays against each triangle separately.

use std::sync::Arc;

use glam::DVec3;
use nullray::accel::{AlphaTest, Bvh, Facing, Hit, Kernel, Origins, Precision, Segment, Traversal};

use crate::accel::common::*;

/// Stripes, of another width on each triangle; every third triangle is whole.
#[derive(Debug)]
struct Stripes;

impl AlphaTest for Stripes {
    fn is_opaque(&self, id: u32, u: f64, v: f64) -> bool {
        id.is_multiple_of(3) || ((u + 2.0 * v) * f64::from(id % 7 + 2)).fract() < 0.4
    }
}

/// The nearest opaque hit: of trees of one triangle each, of equal ones that of the smallest id.
fn nearest(alone: &[Bvh], origin: DVec3, direction: DVec3, beyond: f64) -> Option<Hit> {
    let hits = (0..).zip(alone).filter_map(|(id, bvh)| {
        let hit = closest(bvh, origin, direction)?;
        (hit.s < beyond && Stripes.is_opaque(id, hit.u, hit.v)).then_some(Hit {
            triangle: id,
            slot: 0,
            ..hit
        })
    });
    hits.min_by(|a, b| a.s.total_cmp(&b.s))
}

#[test]
fn every_kernel_finds_the_nearest_hit_outside_holes() {
    let mut random = Random(5);
    let triangles = random.soup(200, DVec3::ZERO, 1.0, 0.5);
    let alone: Vec<Bvh> = triangles.iter().map(|t| build(&[*t])).collect();
    let bvh = Bvh::build(triangles, |_| Facing::TwoSided).with_alpha_test(Arc::new(Stripes));
    let eye = DVec3::new(0.3, 0.2, 4.0);
    // A tile of rays from one point, and rays that go all ways.
    let tile: Vec<DVec3> = (0..256)
        .map(|k| {
            DVec3::new(
                f64::from(k % 16) * 0.04 - 0.3,
                f64::from(k / 16) * 0.04 - 0.3,
                -1.0,
            )
        })
        .collect();
    let (origins, wild): (Vec<DVec3>, Vec<DVec3>) = (0..256)
        .map(|_| (random.vector() * 2.0, random.direction()))
        .unzip();
    for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
        let mut through_holes = 0;
        let method = Traversal {
            kernel,
            precision: Precision::Certified,
        };
        for (from, directions) in [
            (Origins::Shared(eye), &tile),
            (Origins::Each(&origins), &wild),
        ] {
            let origin = |ray: usize| match from {
                Origins::Shared(eye) => eye,
                _ => origins[ray],
            };
            // Every other ray has been stopped at s = 2 before.
            let wall = Hit {
                s: 2.0,
                u: 0.0,
                v: 0.0,
                triangle: u32::MAX,
                slot: 0,
                front: true,
            };
            let before: Vec<Option<Hit>> =
                (0..256).map(|ray| (ray % 2 == 1).then_some(wall)).collect();
            let (mut hits, mut replaced) = (before.clone(), Vec::new());
            bvh.closest_by(
                method,
                from,
                directions,
                &mut hits,
                None,
                Some(&mut replaced),
            );
            let mut blocked = vec![false; 256];
            let segment = |ray: usize| Segment {
                ray: crate::accel::common::ray(origin(ray), directions[ray]),
                s_max: 2.0,
                skip: Some(5),
                end: None,
            };
            let segments: Vec<Segment> = (0..256).map(segment).collect();
            bvh.any_by(method, &segments, &mut blocked, None);
            replaced.sort_unstable();
            for ray in 0..256 {
                let (origin, direction) = (origin(ray), directions[ray]);
                let beyond = before[ray].map_or(f64::INFINITY, |hit| hit.s);
                let expected = nearest(&alone, origin, direction, beyond);
                let found = hits[ray].map(|hit| Hit { slot: 0, ..hit });
                assert_eq!(found, expected.or(before[ray]), "{kernel:?}, ray {ray}");
                assert_eq!(
                    replaced.binary_search(&ray).is_ok(),
                    expected.is_some(),
                    "{kernel:?}, ray {ray}"
                );
                // Triangle 5 does not count, wherever it is.
                let others = (0..).zip(&alone).filter(|(id, _)| *id != 5);
                let is_blocked = others.into_iter().any(|(id, bvh)| {
                    let hit = closest(bvh, origin, direction).filter(|hit| hit.s < 2.0);
                    hit.is_some_and(|hit| Stripes.is_opaque(id, hit.u, hit.v))
                });
                assert_eq!(blocked[ray], is_blocked, "{kernel:?}, segment {ray}");
                let solid = alone
                    .iter()
                    .filter_map(|bvh| closest(bvh, origin, direction));
                let first = solid.map(|hit| hit.s).fold(f64::INFINITY, f64::min);
                through_holes += usize::from(expected.is_some_and(|hit| hit.s > first));
            }
        }
        assert!(through_holes > 25, "{kernel:?}: {through_holes}");
    }
}
