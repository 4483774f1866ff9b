use std::f64::consts::{FRAC_PI_2, PI};

use super::*;
use crate::accel::numbers;

fn random(next: &mut impl FnMut() -> f64) -> DVec3 {
    DVec3::new(next(), next(), next())
}

#[test]
fn an_eighth_of_the_sphere_is_seen_from_the_origin_and_nothing_from_behind() {
    let triangle = Triangle::new([DVec3::X, DVec3::Y, DVec3::Z]);
    assert!((triangle.half_angle(DVec3::ZERO, 1.0) - PI / 4.0).abs() < 1e-15);
    // Its normal is (1, 1, 1).
    assert_eq!(triangle.half_angle(DVec3::ZERO, 0.0), 0.0);
    let mirrored = 2.0 / 3.0 * DVec3::ONE;
    assert!((triangle.half_angle(mirrored, 0.0) - PI / 4.0).abs() < 1e-15);
}

#[test]
fn far_triangles_have_their_area_over_the_square_of_the_distance() {
    let triangle = Triangle::new([DVec3::ZERO, DVec3::X, DVec3::Y]);
    for far in [1e4, 1e6, 1e12] {
        let seen = 2.0 * triangle.half_angle(DVec3::Z * far, 0.0);
        assert!((seen * far * far / 0.5 - 1.0).abs() < 3.0 / (far * far) + 1e-14);
    }
}

/// The moment of unit vectors towards points of a triangle, ∫ d dω, is ½ Σ θ n over its edges (Lambert's formula).
#[test]
fn points_are_drawn_evenly_in_solid_angle() {
    let mut next = numbers(7);
    for case in 0..60 {
        // Close, flat, thin and distant triangles.
        let size = [1.0, 1.0, 0.1, 1e-3][case % 4];
        let middle = random(&mut next) * 0.7 + DVec3::Z;
        let mut corners = [(); 3].map(|()| middle + random(&mut next) * size);
        if case % 3 == 0 {
            corners.iter_mut().for_each(|corner| corner.z *= 0.02);
        }
        let triangle = Triangle::new(corners);
        let half = triangle.half_angle(DVec3::ZERO, 1.0);
        let (n, mut sum) = (200, DVec3::ZERO);
        for i in 0..n * n {
            let [x, y] = [i % n, i / n].map(|k| (k as f64 + 0.5) / n as f64);
            let (u, v) = triangle.draw_by_angle(DVec3::ZERO, libm::sincos(x * half), y);
            assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-15);
            sum += triangle.at((u, v)).normalize();
        }
        let seen = sum * (2.0 * half / f64::from(n * n));
        let mut expected = DVec3::ZERO;
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let across = a.cross(b);
            let angle = libm::atan2(across.length(), a.dot(b));
            expected += across.normalize() * (0.5 * angle);
        }
        let expected = expected * triangle.normal.dot(corners[0]).signum();
        let off = (seen - expected).length() / (2.0 * half);
        assert!(off < 2e-4, "case {case}: {seen} {expected}, off {off:e}");
    }
}

#[test]
fn halves_of_a_triangle_that_is_cut_in_two_get_draws_by_their_solid_angles() {
    let mut next = numbers(9);
    for _ in 0..20 {
        let [a, b, c] = [(); 3].map(|()| random(&mut next) + 0.5 * DVec3::Z);
        let triangle = Triangle::new([a, b, c]);
        let half = triangle.half_angle(DVec3::ZERO, 1.0);
        // Cut from C to the midpoint of AB: there the barycentrics of A and B are equal.
        let expected = Triangle::new([a, (a + b) * 0.5, c]).half_angle(DVec3::ZERO, 1.0) / half;
        let n = 300;
        let mut count = 0;
        for i in 0..n * n {
            let [x, y] = [i % n, i / n].map(|k| (k as f64 + 0.5) / n as f64);
            let (u, v) = triangle.draw_by_angle(DVec3::ZERO, libm::sincos(x * half), y);
            count += u32::from(1.0 - u - v > u);
        }
        let seen = f64::from(count) / f64::from(n * n);
        assert!((seen - expected).abs() < 5e-3, "{seen} {expected}");
    }
}

#[test]
fn points_in_the_plane_of_a_triangle_see_nothing_and_draw_within_it() {
    let triangle = Triangle::new([DVec3::X, 2.0 * DVec3::X, DVec3::new(1.5, 1.0, 0.0)]);
    assert_eq!(triangle.half_angle(DVec3::ZERO, 1.0), 0.0);
    for (sine, cosine) in [(0.0, 1.0), (1e-9, 1.0), libm::sincos(FRAC_PI_2)] {
        let (u, v) = triangle.draw_by_angle(DVec3::ZERO, (sine, cosine), 0.5);
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0, "{u} {v}");
    }
}
