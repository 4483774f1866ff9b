//! The appearance of moving objects: Penrose's sphere and Terrell's cube.

use glam::DVec3;
use nullray::spacetime::{Boost, CameraFrame, Direction, Rest, Velocity, World};
use proptest::prelude::*;

use crate::closed_forms::sample::{config, perpendicular, unit};

const OUTLINE: usize = 180;

/// The directions from the origin that touch the sphere around `centre` with radius `sine` · |centre|:
/// a cone of half angle arcsin(`sine`).
fn tangent_cone(centre: DVec3, sine: f64) -> impl Iterator<Item = DVec3> {
    let axis = centre.normalize();
    let a = perpendicular(axis);
    let b = axis.cross(a);
    (0..OUTLINE).map(move |i| {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / OUTLINE as f64).sin_cos();
        axis * (1.0 - sine * sine).sqrt() + (a * cos + b * sin) * sine
    })
}

/// The largest distance of the points from one plane, over the radius of the circle through three of
/// them. On the unit sphere, points of a plane are points of a circle.
fn departure_from_a_circle(points: &[DVec3]) -> f64 {
    let third = points.len() / 3;
    let [p, q, r] = [points[0], points[third], points[2 * third]];
    let (pq, pr) = (q - p, r - p);
    let normal = pq.cross(pr);
    let radius = pq.length() * pr.length() * (q - r).length() / (2.0 * normal.length());
    let normal = normal.normalize();
    let height = |x: &DVec3| normal.dot(*x - p).abs();
    points.iter().map(height).fold(0.0, f64::max) / radius
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn the_outline_of_a_moving_sphere_is_a_circle(
        n in unit(), beta in 0.0..0.999f64, m in unit(), camera_beta in 0.0..0.999f64,
        centre in unit(), sine in 0.02..0.98f64,
    ) {
        // Where a point camera sees a sphere's outline, its light paths touch the sphere. In the sphere's
        // rest frame these directions are a circular cone; aberration is a conformal map of the sphere of
        // directions that takes circles to circles (Penrose 1959). The camera moves as well.
        let velocity = Velocity::from_beta(n * beta).unwrap();
        let camera = Velocity::from_beta(m * camera_beta).unwrap();
        let world_from_rest = Boost::<World, Rest>::new(velocity);
        let camera_from_world = Boost::<World, CameraFrame>::new(camera).inverse();
        let rest = tangent_cone(centre, sine).map(|d| Direction::new(d).unwrap());
        let world: Vec<_> = rest.map(|d| world_from_rest.direction(d).0).collect();
        let seen = |d: &Direction<World>| camera_from_world.direction(*d).0.unit();
        let outline: Vec<DVec3> = world.iter().map(seen).collect();
        let departure = departure_from_a_circle(&outline);
        prop_assert!(departure < 1e-9, "{departure}");

        // In the world, by the textbook: seen at x = s d, t = −s, the sphere is where
        // r = −C + s V with V∥ = γ(d∥ + β), V⊥ = d⊥ has |r| = R. The paths touch it if the discriminant
        // (C·V)² − V² (C² − R²) of that quadratic in s vanishes.
        for d in &world {
            let along = n.dot(d.unit());
            let v = d.unit() + n * (velocity.gamma() * (along + beta) - along);
            let discriminant = centre.dot(v).powi(2) - v.length_squared() * (1.0 - sine * sine);
            let scale = v.length_squared();
            // V∥ has lost γ² of its digits where d∥ + β cancels.
            prop_assert!(discriminant.abs() < 1e-9 * scale, "{discriminant} of {scale}");
        }
    }
}

#[test]
fn without_delay_the_outline_of_a_moving_sphere_is_not_a_circle() {
    // A sphere contracted to 1/γ along x, seen "now": stretching x by γ makes it a sphere again.
    let gamma = 2.0;
    let centre = DVec3::new(0.0, 0.0, 5.0);
    let outline: Vec<DVec3> = tangent_cone(centre, 0.3)
        .map(|d| DVec3::new(d.x / gamma, d.y, d.z).normalize())
        .collect();
    assert!(departure_from_a_circle(&outline) > 1e-2);
}

/// Where a camera at the world's origin sees, at time 0, the point that rests at `x` in a frame that
/// moves at β along x and shares the origin: |r₀ − β τ| = τ for the delay τ, with r₀ = (x/γ, y, z).
fn apparent_position(x: DVec3, beta: f64) -> DVec3 {
    let gamma_squared = 1.0 / ((1.0 - beta) * (1.0 + beta));
    let r = DVec3::new(x.x / gamma_squared.sqrt(), x.y, x.z);
    let b = r.x * beta;
    let delay = r.length_squared() / (b + (b * b + r.length_squared() / gamma_squared).sqrt());
    r - DVec3::X * (beta * delay)
}

/// The largest distance, in metres across the line of sight, between a unit cube that passes at
/// `distance` and a resting cube there turned by arcsin β about the axis across.
fn departure_from_a_turned_cube(beta: f64, distance: f64) -> f64 {
    let gamma = 1.0 / ((1.0 - beta) * (1.0 + beta)).sqrt();
    let velocity = Velocity::from_beta(DVec3::X * beta).unwrap();
    let world_from_rest = Boost::<World, Rest>::new(velocity);
    // Seen along z, at a right angle to its motion, the centre sent its light at (−D, 0, 0, D), which is
    // the place D (γβ, 0, 1) in the cube's frame.
    let centre = DVec3::new(gamma * beta, 0.0, 1.0) * distance;
    let (sin, cos) = beta.asin().sin_cos();
    let mut worst = 0f64;
    for corner in 0..8 {
        let sign = |bit: i32| if corner >> bit & 1 == 0 { -0.5 } else { 0.5 };
        let corner = DVec3::new(sign(0), sign(1), sign(2));
        let rest = Direction::new(centre + corner).unwrap();
        let seen = world_from_rest.direction(rest).0.unit();
        let expected = apparent_position(centre + corner, beta).normalize();
        assert!((seen - expected).length() < 1e-14 * gamma * gamma);
        let turned = DVec3::new(corner.x * cos - corner.z * sin, corner.y, 0.0);
        let across = (seen / seen.z * distance).with_z(0.0);
        worst = worst.max((across - turned).length());
    }
    worst
}

#[test]
fn a_distant_cube_passing_by_looks_turned_by_arcsin_beta() {
    // Looking at a right angle to the motion in the camera's frame, one looks along (β, 0, 1/γ) in the
    // cube's: cos θ = (0 + β)/(1 + 0). So one sees the cube as if turned by arcsin β; and at its true size, because
    // angles there are smaller by dθ/dθ′ = 1/W = 1/γ, and its distance larger by γ. What is left is
    // perspective, of order (size/distance) (Terrell 1959).
    for beta in [0.1, 0.5, 0.9, 0.99] {
        for distance in [1e3, 1e4, 1e5] {
            let departure = departure_from_a_turned_cube(beta, distance);
            assert!(departure < 2.0 / distance, "β {beta}: {departure}");
        }
    }
}
