use super::*;
use crate::io::cube::CubeSamples;

fn camera() -> CaptureCamera {
    let forward = DVec3::new(0.3, -0.2, -1.0).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    CaptureCamera::new(
        DVec3::new(0.5, 1.0, 4.0),
        [right, right.cross(forward), forward],
        0.8,
    )
}

/// A floor, and a ball before it.
fn distance(origin: DVec3, d: DVec3) -> f64 {
    let centre = DVec3::new(1.5, 0.7, 0.5);
    let b = (centre - origin).dot(d);
    let under = b * b - (centre - origin).length_squared() + 0.36;
    if under > 0.0 {
        return b - under.sqrt();
    }
    let r = -origin.y / d.y;
    if r > 0.0 && r < 40.0 { r } else { f64::NAN }
}

#[test]
fn light_that_came_by_a_surface_tells_its_distance() {
    let rays = PixelRays::new(&camera(), [24, 18]);
    let truth: Vec<f64> = (0..24 * 18)
        .map(|pixel| distance(rays.eye, rays.direction(pixel).unwrap()))
        .collect();
    for (position, index) in [
        (DVec3::new(-1.0, 3.0, 2.0), 1.0),
        (rays.eye, 1.0),
        (DVec3::new(2.0, 2.0, 3.0), 1.33),
    ] {
        let flash = Flash {
            position,
            time: -0.7,
        };
        let arrivals: Vec<f64> = (truth.iter().enumerate())
            .map(|(pixel, r)| {
                let point = rays.eye + rays.direction(pixel).unwrap() * *r;
                flash.time + index * (point.distance(position) + r)
            })
            .collect();
        let found = rays.distances(&arrivals, &flash, index);
        for (found, truth) in found.iter().zip(&truth) {
            assert!(
                found.is_nan() && truth.is_nan() || (found - truth).abs() < 1e-12 * 40.0,
                "{found} is not {truth}"
            );
        }
        // Light that arrived before this was possible.
        assert!(rays.distances(&[flash.time - 1.0], &flash, index)[0].is_nan());
    }
}

#[test]
fn a_mesh_lies_on_its_surfaces_and_is_torn_between_them() {
    let size = [96, 72];
    let rays = PixelRays::new(&camera(), size);
    let directions: Vec<DVec3> = (0..96 * 72).map(|p| rays.direction(p).unwrap()).collect();
    let distances: Vec<f64> = directions.iter().map(|d| distance(rays.eye, *d)).collect();
    let DepthMesh {
        mesh,
        unknown,
        torn,
    } = rays.mesh(&distances, 4.0);
    assert_eq!(unknown, distances.iter().filter(|r| r.is_nan()).count());
    assert!(torn > 20 && torn < 400, "{torn}");
    // All triangles lie on the floor, or on the ball up to the sagitta of a pixel: none bridges them.
    let centre = DVec3::new(1.5, 0.7, 0.5);
    let (mut on_floor, mut on_ball) = (0, 0);
    for triangle in &mesh.triangles {
        let corners = triangle.map(|v| mesh.positions[v as usize]);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        if corners.iter().all(|p| p.y.abs() < 1e-9) {
            on_floor += 1;
        } else {
            assert!(
                corners
                    .iter()
                    .all(|p| (p.distance(centre) - 0.6).abs() < 1e-9)
            );
            assert!((middle.distance(centre) - 0.6).abs() < 0.05, "{middle}");
            on_ball += 1;
        }
        // Its front faces the camera.
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        assert!(normal.dot(middle - rays.eye) < 0.0);
    }
    let known = distances.iter().filter(|r| !r.is_nan()).count();
    assert!(on_floor > 0 && on_ball > 300, "{on_floor} {on_ball}");
    assert!(mesh.triangles.len() > 2 * known - 2 * known / 8, "{known}");
    // Texture coordinates are those of the pixels in that direction.
    for (position, [u, v]) in mesh.positions.iter().zip(&mesh.uvs[0]) {
        let (column, row) = (f64::from(*u) * 96.0 - 0.5, f64::from(*v) * 72.0 - 0.5);
        let pixel = row.round() as usize * 96 + column.round() as usize;
        let d = (*position - rays.eye).normalize();
        assert!(d.distance(directions[pixel]) < 1e-12);
    }
}

#[test]
fn the_first_of_several_pulses_is_found_to_a_part_of_a_bin() {
    const BINS: usize = 64;
    let pulse = |t: f64, at: f64| (-0.5 * ((t - at) / 0.15).powi(2)).exp();
    let arrivals = [1.234, 2.0, 3.871];
    let mut samples = Vec::new();
    for at in arrivals {
        // The mean over bins of 0.1, from 20 points each; then a second, brighter pulse via another surface.
        samples.extend((0..BINS).map(|k| {
            let mean = |n: i32| {
                let t = (k as f64 + (f64::from(n) + 0.5) / 20.0) * 0.1;
                0.5 * pulse(t, at) + pulse(t, at + 1.7)
            };
            (0..20).map(mean).sum::<f64>() / 20.0
        }));
    }
    samples.extend([1e-4; BINS]);
    let cube = Cube::new([1, 4, BINS, 1], CubeSamples::F64(samples)).unwrap();
    let found = first_light(&cube, 5.0, 0.1, &FirstLight::default());
    for (found, at) in found.iter().zip(arrivals) {
        assert!((found - (5.0 + at)).abs() < 1e-3, "{found}");
    }
    assert!(found[3].is_nan());
}
