//! Exactly aimed rays.

use glam::{DVec3, Vec3Swizzles};

use crate::accel::common::*;

#[test]
fn tiny_things_far_away_are_hit_exactly() {
    // 1e-9 m wide, 2³⁰ m away: 2⁶⁰ sizes. The ray runs along z, where nothing is rounded.
    let size = 2f64.powi(-30);
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0) * size;
    let triangle = [corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)];
    let bvh = build(&[triangle]);
    for (x, y, inside) in [
        (0.25, 0.25, true),
        (0.75, 0.75, false),
        (0.5, 0.5, true),
        (0.5, 0.5000001, false),
    ] {
        let origin = corner(x, y) + DVec3::Z * 2f64.powi(30);
        let hit = closest(&bvh, origin, -DVec3::Z);
        assert_eq!(hit.is_some(), inside, "{x} {y}");
        if let Some(hit) = hit {
            assert_eq!((hit.s, hit.u, hit.v), (2f64.powi(30), x, y));
        }
    }
}

#[test]
fn closed_meshes_do_not_leak_at_corners_and_edges() {
    let mut random = Random(3);
    for (scale, shift) in [
        (1.0, DVec3::ZERO),
        (1e-9, DVec3::ZERO),
        (1e9, DVec3::ZERO),
        (1.0, DVec3::new(1e3, 77.7, -3e4)),
        (1e-5, DVec3::ONE),
    ] {
        let mesh = scaled(&sphere(4), scale, shift);
        let bvh = build(&mesh);
        for origin in [shift, shift + random.vector() * 0.3 * scale] {
            for &[a, b, c] in &mesh {
                let share = random.number() * 0.5 + 0.5;
                for target in [a, b, (a + b) * 0.5, a + (c - a) * share, b.lerp(c, share)] {
                    let hit = closest(&bvh, origin, target - origin);
                    let hit = hit.unwrap_or_else(|| panic!("leak at {target}"));
                    assert!((hit.s - 1.0).abs() < 1e-6, "{} at {target}", hit.s);
                    assert!(!hit.front, "an inside is a back");
                }
            }
        }
    }
}

#[test]
fn oblique_rays_from_far_away_hit_the_very_border_that_they_aim_at() {
    // Tiles of 2⁻²² m, seen from 2²⁹ m: f64 positions along the ray are no finer than 2⁻²⁴ m.
    let n = 256;
    let at = |x: i32, y: i32| DVec3::new(f64::from(x), f64::from(y), 0.0) * 2f64.powi(-22);
    let row = (0..n).flat_map(|x| {
        let [a, b, c, d] = [at(x, 0), at(x + 1, 0), at(x + 1, 1), at(x, 1)];
        [[a, b, c], [a, c, d]]
    });
    let bvh = build(&row.collect::<Vec<_>>());
    for i in 0..=n {
        for (d, factor) in [
            (DVec3::new(1.0, 0.75, -0.5), 3.0),
            (DVec3::new(-0.5, 1.0, 0.75), 3.0),
            (DVec3::new(1.0, 1.0, -1.0), 0.7),
            (DVec3::new(-1.0, 1.0, 1.0), 0.7),
        ] {
            let distance = 2f64.powi(29) + f64::from(i);
            // At most 53 bits from 2²⁹ to 2⁻²³: exact, so that the ray meets the corner (i, 0) exactly.
            let origin = at(i, 0) - d * distance;
            assert_eq!(origin + d * distance, at(i, 0));
            let hit = closest(&bvh, origin, d * factor);
            let tile = hit.map(|h| h.triangle as i32 / 2);
            assert!(tile == Some(i) || tile == Some(i - 1), "{tile:?} for {i}");
        }
    }
}

#[test]
fn of_the_triangles_around_a_corner_the_nearest_then_the_smallest_id_is_hit() {
    let mesh = sphere(2);
    let bvh = build(&mesh);
    let (mut tried, mut ties) = (0, 0);
    for &[a, ..] in &mesh {
        // From the origin the direction to a corner is the corner: exact.
        let around = (0..).zip(&mesh).filter(|(_, t)| t.contains(&a));
        let single = |t: &Triangle| closest(&build(&[*t]), DVec3::ZERO, a).unwrap().s;
        let met: Vec<(u32, f64)> = around.map(|(id, t)| (id, single(t))).collect();
        let nearest = met.iter().map(|m| m.1).fold(f64::INFINITY, f64::min);
        let tied: Vec<u32> = met.iter().filter(|m| m.1 == nearest).map(|m| m.0).collect();
        let hit = closest(&bvh, DVec3::ZERO, a).unwrap();
        assert_eq!((hit.triangle, hit.s), (tied[0], nearest));
        tried += 1;
        ties += usize::from(tied.len() > 1);
    }
    assert!(tried > 100 && ties > 20, "{tried} tried, {ties} ties");
}

#[test]
fn rays_along_an_axis_meet_a_tiled_square_up_to_its_very_border() {
    let n = 8;
    let at = |x: i32, y: i32| DVec3::new(f64::from(x), f64::from(y), 0.1);
    let mut mesh = Vec::new();
    for (x, y) in (0..n).flat_map(|y| (0..n).map(move |x| (x, y))) {
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        mesh.extend([[a, b, c], [a, c, d]]);
    }
    for turn in [
        DVec3::to_array,
        |v: &DVec3| v.zxy().to_array(),
        |v: &DVec3| v.yzx().to_array(),
    ] {
        let turned: Vec<Triangle> = mesh.iter().map(|t| t.map(|c| turn(&c).into())).collect();
        let bvh = build(&turned);
        for (x, y) in (-1..=2 * n + 1).flat_map(|y| (-1..=2 * n + 1).map(move |x| (x, y))) {
            let inside = (0..=2 * n).contains(&x) && (0..=2 * n).contains(&y);
            let from = DVec3::new(f64::from(x) / 2.0, f64::from(y) / 2.0, 100.0);
            for slant in [0.0, -0.0, 1e-30, -1e-30] {
                let hit = closest(
                    &bvh,
                    turn(&from).into(),
                    turn(&DVec3::new(0.0, slant, -1.0)).into(),
                );
                // A slant of 1e-30 leaves the border by 1e-28: outside.
                if slant.abs() == 0.0 || (0 < y && y < 2 * n) {
                    assert_eq!(hit.is_some(), inside, "{x} {y} {slant}");
                } else {
                    let inward = inside && ((slant > 0.0) == (y == 0));
                    assert_eq!(hit.is_some(), inward, "{x} {y} {slant}");
                }
            }
        }
    }
}

#[test]
fn a_tree_of_many_levels_is_walked() {
    // Each triangle a hundred times smaller than the last: trees without balance.
    let mesh: Vec<Triangle> = (0..1500)
        .map(|i| {
            let size = 0.7f64.powi(i % 500);
            [
                DVec3::X * size,
                DVec3::Y * size,
                DVec3::Z * size * (1.0 + i as f64 * 1e-3),
            ]
        })
        .collect();
    let bvh = build(&mesh);
    let hit = closest(&bvh, DVec3::ONE, -DVec3::ONE).unwrap();
    assert_eq!(hit.triangle, 1000);
    assert!(closest(&bvh, DVec3::ZERO, DVec3::ONE).is_some());
}
