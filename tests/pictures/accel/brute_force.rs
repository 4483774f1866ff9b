//! Against brute force, at all scales.

use glam::DVec3;

use crate::accel::common::*;

/// Brute force with a test of its own kind: signed volumes, plainly. None where f64 can't tell.
fn brute_force(triangles: &[Triangle], o: DVec3, d: DVec3) -> Option<Option<(usize, f64)>> {
    let d = d.normalize();
    let mut best: Option<(usize, f64)> = None;
    for (id, corners) in triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|c| c - o);
        let edge = |p: DVec3, q: DVec3| d.cross(p + q).dot(q - p) * 0.5;
        let (u, v, w) = (edge(c, a), edge(a, b), edge(b, c));
        let size = (b - a).length() + (c - a).length();
        let doubt = 1e-14 * size * (a.length() + size);
        if [u, v, w].iter().any(|e| e.abs() < doubt) {
            let opposite =
                [u, v, w].iter().any(|&e| e > doubt) && [u, v, w].iter().any(|&e| e < -doubt);
            if !opposite {
                return None;
            }
            continue;
        }
        if (u > 0.0) == (v > 0.0) && (v > 0.0) == (w > 0.0) {
            let s = (a * w + b * u + c * v).dot(d) / (u + v + w);
            if s > 0.0 && best.is_none_or(|(_, t)| s < t) {
                best = Some((id, s));
            }
        }
    }
    Some(best)
}

/// Compares `rays` rays from `origin` towards the soup; returns how many hit.
fn compare_with_brute_force(triangles: &[Triangle], rays: &[(DVec3, DVec3)]) -> usize {
    let bvh = build(triangles);
    let (mut decided, mut hits) = (0, 0);
    for &(o, d) in rays {
        let Some(expected) = brute_force(triangles, o, d) else {
            continue;
        };
        decided += 1;
        let hit = closest(&bvh, o, d);
        let id = hit.map(|h| h.triangle as usize);
        assert_eq!(id, expected.map(|e| e.0), "from {o} along {d}");
        assert_eq!(bvh.any(&ray(o, d), f64::INFINITY, None), id.is_some());
        if let (Some(hit), Some((_, s))) = (hit, expected) {
            assert!(
                (hit.s * d.length() - s).abs() <= 1e-9 * s.abs(),
                "{} {s}",
                hit.s
            );
            hits += 1;
        }
    }
    assert!(
        decided * 10 >= rays.len() * 9,
        "only {decided} rays are decidable"
    );
    hits
}

#[test]
fn soups_at_all_scales_agree_with_brute_force() {
    let mut random = Random(1);
    for exponent in -9..=9 {
        let scale = 10f64.powi(exponent);
        for place in [DVec3::ZERO, DVec3::new(3.0, -7.0, 5.0) * scale] {
            let triangles = random.soup(300, place, scale, 0.3 * scale);
            let rays: Vec<_> = (0..150)
                .map(|i| {
                    let length = 10f64.powi(i % 25 - 12);
                    let origin = place + random.vector() * 2.0 * scale;
                    let d = place + random.vector() * scale - origin;
                    (origin, d.normalize() * length)
                })
                .collect();
            let hits = compare_with_brute_force(&triangles, &rays);
            assert!(hits > 40, "{hits} hits at scale {scale}");
        }
    }
}

#[test]
fn rays_from_a_billion_metres_away_agree_with_brute_force() {
    let mut random = Random(2);
    for scale in [1e6, 1e3, 1.0] {
        let triangles = random.soup(200, DVec3::ZERO, scale, 0.5 * scale);
        let rays: Vec<_> = (0..200)
            .map(|_| {
                let origin = random.direction() * 1e9;
                (origin, (random.vector() * scale - origin) * 1e-9)
            })
            .collect();
        let hits = compare_with_brute_force(&triangles, &rays);
        assert!(hits > 100, "{hits} hits at scale {scale}");
    }
}

#[test]
fn huge_and_tiny_triangles_share_a_tree() {
    let mut random = Random(4);
    let mut mesh = random.soup(50, DVec3::ZERO, 1e-6, 1e-6);
    mesh.extend(random.soup(50, DVec3::ONE, 1.0, 1.0));
    mesh.extend(random.soup(50, DVec3::X * 1e3, 1e6, 1e6));
    let rays: Vec<_> = (0..400)
        .map(|i| {
            let scale = [3e-6, 3.0, 3e6][i % 3];
            let origin = random.direction() * scale;
            let target = random.vector() * scale * 0.3;
            (origin, target - origin)
        })
        .collect();
    assert!(compare_with_brute_force(&mesh, &rays) > 100);
}

#[test]
fn going_on_behind_each_hit_meets_all_triangles_in_order() {
    let mut random = Random(8);
    let mesh = random.soup(300, DVec3::ZERO, 1.0, 0.8);
    let (bvh, singles) = (
        build(&mesh),
        mesh.iter().map(|t| build(&[*t])).collect::<Vec<_>>(),
    );
    for i in 0..50 {
        let origin = random.direction() * 10f64.powi(i % 8);
        let direction = random.vector() * 0.5 - origin;
        let mut ray = ray(origin, direction);
        let mut expected: Vec<f64> = singles
            .iter()
            .filter_map(|t| closest(t, origin, direction))
            .map(|h| h.s)
            .collect();
        expected.sort_by(f64::total_cmp);
        let mut met = Vec::new();
        while let Some(hit) = bvh.closest(&ray, f64::INFINITY) {
            met.push(hit.s);
            assert!(bvh.any(&ray, hit.s.next_up(), None) && !bvh.any(&ray, hit.s, None));
            ray.s_min = hit.s;
        }
        assert_eq!(met, expected);
        assert!(met.len() > 3);
    }
}
