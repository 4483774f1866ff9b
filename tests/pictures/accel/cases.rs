//! One property at a time.

use glam::DVec3;
use nullray::accel::{Bvh, Facing, Hit, Ray};
use proptest::prelude::*;

use crate::accel::common::*;

#[test]
fn of_coplanar_and_duplicate_triangles_the_smaller_id_is_hit() {
    let one = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let turned = [DVec3::X, DVec3::Y, DVec3::ZERO];
    let opposite = [DVec3::ZERO, DVec3::Y, DVec3::X];
    let mut mesh = vec![[DVec3::ONE * 3.0, DVec3::X * 9.0, DVec3::Y * 9.0]; 5];
    mesh.extend([one, one, turned, opposite, one].repeat(20));
    let bvh = build(&mesh);
    let hit = closest(&bvh, DVec3::new(0.25, 0.25, 1.0), -DVec3::Z).unwrap();
    assert_eq!((hit.triangle, hit.s), (5, 1.0));
    let behind = Bvh::build(mesh, |id| {
        if id < 8 {
            Facing::FrontOnly
        } else {
            Facing::TwoSided
        }
    });
    let from_behind = closest(&behind, DVec3::new(0.25, 0.25, -1.0), DVec3::Z).unwrap();
    assert_eq!((from_behind.triangle, from_behind.front), (8, true));
}

#[test]
fn degenerate_and_broken_triangles_are_never_hit() {
    let third = DVec3::new(0.1, 0.2, 0.3);
    let broken = [
        [third; 3],
        [third, third, DVec3::ONE],
        [DVec3::ZERO, DVec3::ONE, DVec3::ONE * 3.0],
        [third, DVec3::NAN, DVec3::X],
        [third, DVec3::X, DVec3::INFINITY],
        [third, DVec3::X * 1e200, DVec3::Y * 1e200],
    ];
    assert!(build(&broken).is_empty());
    assert_eq!(build(&broken).bounds(), None);
    let mut mesh = broken.to_vec();
    mesh.push([DVec3::X, DVec3::Y, DVec3::Z]);
    let bvh = build(&mesh);
    assert_eq!(
        (bvh.len(), bvh.bounds()),
        (1, Some((DVec3::ZERO, DVec3::ONE)))
    );
    let origin = DVec3::splat(7.0);
    for target in [third, DVec3::ONE, DVec3::ONE * 2.0, DVec3::X * 0.5] {
        let hit = closest(&bvh, origin, target - origin);
        assert!(hit.is_none_or(|h| h.triangle == 6));
    }
}

#[test]
fn broken_rays_hit_nothing_and_return() {
    let mesh = sphere(3);
    let bvh = build(&mesh);
    let numbers = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        0.0,
        1e308,
        5e-324,
    ];
    for x in numbers {
        for y in numbers {
            for z in numbers {
                let v = DVec3::new(x, y, z);
                let finite_origin = v.is_finite() && v.max_element() < 1.0;
                assert!(finite_origin || closest(&bvh, v, DVec3::Z).is_none());
                assert!(closest(&bvh, DVec3::ZERO, v).is_none(), "along {v}");
                assert!(!bvh.any(&ray(DVec3::ZERO, v), 1.0, None));
            }
        }
    }
    let mut inward = ray(DVec3::ZERO, DVec3::Z);
    assert!(bvh.closest(&inward, f64::NAN).is_none());
    assert!(bvh.closest(&inward, f64::NEG_INFINITY).is_none());
    for s_min in [f64::NAN, f64::INFINITY, 1.5] {
        inward.s_min = s_min;
        assert!(bvh.closest(&inward, f64::INFINITY).is_none());
    }
    inward.s_min = f64::NEG_INFINITY;
    assert!((bvh.closest(&inward, f64::INFINITY).unwrap().s + 1.0).abs() < 1e-15);
}

#[test]
fn an_empty_mesh_is_a_mesh() {
    let bvh = build(&[]);
    assert!(bvh.is_empty() && bvh.bounds().is_none());
    assert!(closest(&bvh, DVec3::ZERO, DVec3::X).is_none());
    let mut hits = [None; 2];
    trace(&bvh, DVec3::ZERO, &[DVec3::X, DVec3::Y], &mut hits);
    assert_eq!(hits, [None; 2]);
}

#[test]
fn one_triangle_answers_in_full() {
    let bvh = Bvh::build(vec![[DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 4.0]], |_| {
        Facing::FrontOnly
    });
    let origin = DVec3::new(0.5, 1.0, 3.0);
    let hit = closest(&bvh, origin, DVec3::NEG_Z * 2.0).unwrap();
    assert_eq!((hit.s, hit.u, hit.v), (1.5, 0.25, 0.25));
    assert!(hit.front);
    assert_eq!(bvh.normal(&hit), DVec3::Z);
    assert_eq!(bvh.corners(hit.slot)[1], DVec3::X * 2.0);
    // Not from behind, not beyond s_max, not before s_min, not if it is to be skipped.
    let down = ray(origin, DVec3::NEG_Z);
    assert!(closest(&bvh, origin * DVec3::new(1.0, 1.0, -1.0), DVec3::Z).is_none());
    assert!(bvh.closest(&down, 3.0).is_none());
    assert!(bvh.closest(&down, 3.0f64.next_up()).is_some());
    assert!(
        bvh.closest(&Ray { s_min: 3.0, ..down }, f64::INFINITY)
            .is_none()
    );
    assert!(bvh.any(&down, f64::INFINITY, None));
    assert!(bvh.any(&down, f64::INFINITY, Some(7)));
    assert!(!bvh.any(&down, f64::INFINITY, Some(0)));
    assert!(!bvh.any(&down, 3.0, None));
}

#[test]
fn a_batch_replaces_only_farther_hits() {
    let mesh = sphere(3);
    let (near, far) = (
        build(&scaled(&mesh, 1.0, DVec3::ZERO)),
        build(&scaled(&mesh, 2.0, DVec3::ZERO)),
    );
    let mut random = Random(5);
    let origin = random.vector() * 0.1;
    let directions: Vec<DVec3> = (0..100).map(|_| random.direction()).collect();
    let mut hits = vec![None; directions.len()];
    trace(&near, origin, &directions, &mut hits);
    for (&d, hit) in directions.iter().zip(&hits) {
        assert_eq!(*hit, closest(&near, origin, d));
    }
    let before = hits.clone();
    trace(&far, origin, &directions, &mut hits);
    assert_eq!(hits, before);
    let mut outward = vec![None; directions.len()];
    trace(&far, origin, &directions, &mut outward);
    trace(&near, origin, &directions, &mut outward);
    assert_eq!(outward, before);
}

#[test]
fn the_order_of_triangles_does_not_matter() {
    let mut random = Random(6);
    let mut mesh = random.soup(400, DVec3::ZERO, 1.0, 0.3);
    mesh.extend(sphere(2));
    let permutation: Vec<usize> = (0..mesh.len()).map(|i| (i * 7 + 3) % mesh.len()).collect();
    assert_ne!(mesh.len() % 7, 0);
    let permuted: Vec<Triangle> = permutation.iter().map(|&i| mesh[i]).collect();
    let (bvh, other) = (build(&mesh), build(&permuted));
    for _ in 0..2000 {
        let (o, d) = (random.vector() * 2.0, random.direction());
        let (hit, same) = (closest(&bvh, o, d), closest(&other, o, d));
        let mapped = same.map(|h| permutation[h.triangle as usize] as u32);
        assert_eq!(hit.map(|h| h.triangle), mapped);
        assert_eq!(hit.map(|h| (h.s, h.u, h.v)), same.map(|h| (h.s, h.u, h.v)));
    }
}

#[test]
fn memory_stays_within_the_budget() {
    for mesh in [sphere(6), Random(7).soup(20_000, DVec3::ZERO, 1.0, 0.05)] {
        let bvh = build(&mesh);
        assert!(
            bvh.bytes() <= 195 * mesh.len(),
            "{}",
            bvh.bytes() / mesh.len()
        );
        assert!(bvh.bytes() <= Bvh::estimate_bytes(mesh.len()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_scene_scaled_by_a_power_of_two_gives_the_same_hits(seed: u64, power in -40i32..40, length in -40i32..40) {
        let mut random = Random(seed);
        let scale = 2f64.powi(power);
        let mesh = random.soup(40, DVec3::ZERO, 1.0, 0.6);
        let (bvh, other) = (build(&mesh), build(&scaled(&mesh, scale, DVec3::ZERO)));
        let (o, d) = (random.vector() * 3.0, random.direction());
        let hit = closest(&bvh, o, d);
        let same = closest(&other, o * scale, d * 2f64.powi(length));
        let unscaled = same.map(|h| Hit { s: h.s / scale * 2f64.powi(length), ..h });
        prop_assert_eq!(hit.map(|h| Hit { slot: 0, ..h }), unscaled.map(|h| Hit { slot: 0, ..h }));
    }

    #[test]
    fn a_hit_lies_on_its_triangle_and_on_its_ray(seed: u64, far in 0.0..6.0f64) {
        let mut random = Random(seed);
        let mesh = random.soup(60, DVec3::ZERO, 1.0, 0.8);
        let bvh = build(&mesh);
        let o = random.direction() * 10f64.powf(far);
        let d = random.vector() - o;
        if let Some(hit) = closest(&bvh, o, d) {
            let [a, b, c] = mesh[hit.triangle as usize];
            let on_triangle = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
            let n = (b - a).cross(c - a);
            let grazing = n.normalize().dot(d.normalize()).abs();
            let error = (o + d * hit.s - on_triangle).length();
            prop_assert!(error <= 1e-14 * (1.0 + o.length()) / grazing * (1.0 + d.length() / n.length().sqrt()), "{}", error);
            prop_assert_eq!(hit.front, n.dot(d) < 0.0);
            prop_assert!(hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.0 + 1e-12);
        }
    }
}
