//! Packets against single rays: the same hits, bit for bit, with every kernel.

use glam::DVec3;
use nullray::accel::{Bvh, Counts, Facing, Hit, Kernel, Origins, Ray, Segment};

use crate::accel::common::*;

/// Compares all kernels with single rays; returns how many rays hit.
fn compare(bvh: &Bvh, origin: DVec3, directions: &[DVec3], before: &[Option<Hit>]) -> usize {
    let trace = |kernel| {
        let (mut hits, mut replaced) = (before.to_vec(), Vec::new());
        let from = Origins::Shared(origin);
        let method = certified(kernel);
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
    };
    let expected = trace(Kernel::Scalar);
    for kernel in packet_kernels() {
        let (hits, replaced) = trace(kernel);
        for (i, d) in directions.iter().enumerate() {
            assert_eq!(
                hits[i], expected.0[i],
                "{kernel:?}: ray {i} from {origin} along {d}"
            );
        }
        assert_eq!(replaced, expected.1, "{kernel:?}");
    }
    expected.1.len()
}

fn compare_new(bvh: &Bvh, origin: DVec3, directions: &[DVec3]) -> usize {
    compare(bvh, origin, directions, &vec![None; directions.len()])
}

#[test]
fn soups_at_all_scales_are_met_as_by_single_rays() {
    let mut random = Random(21);
    let mut hits = 0;
    for exponent in -9..=9 {
        let scale = 10f64.powi(exponent);
        for place in [DVec3::ZERO, DVec3::new(3.0, -7.0, 5.0) * scale] {
            let bvh = build(&random.soup(400, place, scale, 0.3 * scale));
            for i in 0..12 {
                let origin = place + random.vector() * 3.0 * scale;
                let axis = (place - origin) * 10f64.powi(i - 6);
                let pitch = 0.06 / 4f64.powi(i % 4);
                hits += compare_new(&bvh, origin, &tile(&mut random, axis, 16, pitch, 0.5));
            }
        }
    }
    assert!(hits > 40_000, "{hits}");
}

#[test]
fn many_small_triangles_are_met_as_by_single_rays() {
    let mut random = Random(22);
    let bvh = build(&random.soup(30_000, DVec3::ZERO, 1.0, 0.02));
    let mut hits = 0;
    for i in 0..200 {
        let origin = random.vector() * [0.5, 4.0][i % 2];
        let axis = random.vector() * 0.5 - origin;
        hits += compare_new(&bvh, origin, &tile(&mut random, axis, 16, 0.002, 0.5));
    }
    assert!(hits > 20_000, "{hits}");
}

#[test]
fn meshes_finer_than_the_gaps_between_rays_take_each_ray_few_triangles() {
    let mut random = Random(32);
    // A wavy sheet of 320 × 320 squares, of which a block of 8 × 8 rays sees 160 × 160.
    let n = 320;
    let corner = |i: usize, j: usize| {
        let [x, y] = [i, j].map(|k| k as f64 / n as f64 - 0.5);
        DVec3::new(x, y, 0.02 * (40.0 * x).sin() * (30.0 * y).cos())
    };
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        let [a, b] = [corner(i, j), corner(i + 1, j + 1)];
        [[a, corner(i + 1, j), b], [a, b, corner(i, j + 1)]]
    });
    let bvh = build(&triangles.collect::<Vec<_>>());
    let origin = DVec3::new(0.01, 0.02, 2.0);
    let directions = tile(&mut random, -DVec3::Z, 16, 0.03, 0.5);
    assert!(compare_new(&bvh, origin, &directions) > 200);
    // The same from behind the sheet to the origin.
    let segments: Vec<_> = directions
        .iter()
        .map(|d| Segment {
            ray: Ray {
                origin: origin + 1.5 * *d,
                direction: -1.5 * *d,
                s_min: 0.0,
            },
            s_max: 1.0,
            skip: None,
            end: None,
        })
        .collect();
    let blocked = |kernel| {
        let mut blocked = vec![false; segments.len()];
        bvh.any_by(certified(kernel), &segments, &mut blocked, None);
        blocked
    };
    for kernel in packet_kernels() {
        let mut counts = Counts::default();
        let mut hits = vec![None; directions.len()];
        let from = Origins::Shared(origin);
        let method = certified(kernel);
        bvh.closest_by(
            method,
            from,
            &directions,
            &mut hits,
            Some(&mut counts),
            None,
        );
        // As a block some 800 for each ray.
        let each = counts.triangles / directions.len() as u64;
        assert!(each < 20, "{kernel:?}: {each}");
        assert_eq!(blocked(kernel), blocked(Kernel::Scalar), "{kernel:?}");
    }
}

#[test]
fn needles_and_slivers_are_met_as_by_single_rays() {
    let mut random = Random(23);
    let mut mesh = Vec::new();
    for i in 0..600 {
        let (at, along) = (random.vector(), random.vector());
        let width = 10f64.powi(-(i % 16));
        mesh.push([at, at + along, at + along * 0.5 + random.vector() * width]);
    }
    let bvh = build(&mesh);
    let mut hits = 0;
    for i in 0..300usize {
        // Aimed at the middle of a needle, so that the tile is full of its borders.
        let [a, b, c] = mesh[i * 2];
        let origin = random.vector() * 3.0;
        let axis = (a + b + c) / 3.0 - origin;
        let pitch = 10f64.powi(-(i as i32 % 9) - 2);
        hits += compare_new(&bvh, origin, &tile(&mut random, axis, 16, pitch, 0.5));
    }
    assert!(hits > 5_000, "{hits}");
}

#[test]
fn coplanar_and_duplicate_triangles_are_met_as_by_single_rays() {
    let mut random = Random(24);
    let mut mesh = Vec::new();
    for _ in 0..40 {
        let corner = |r: &mut Random| DVec3::new(r.number(), r.number(), 0.0);
        let t = [
            corner(&mut random),
            corner(&mut random),
            corner(&mut random),
        ];
        mesh.extend([t, [t[1], t[2], t[0]], [t[0], t[2], t[1]]]);
    }
    // One bit before or behind the plane.
    let shifted = mesh
        .iter()
        .map(|t| t.map(|c| c + DVec3::Z * f64::EPSILON * random.number()));
    let shifted: Vec<Triangle> = shifted.collect();
    mesh.extend(shifted);
    let bvh = Bvh::build(mesh, |id| match id % 3 {
        0 => Facing::FrontOnly,
        _ => Facing::TwoSided,
    });
    let mut hits = 0;
    for i in 0..60 {
        let origin = random.vector() + DVec3::Z * [2.0, -2.0][i % 2];
        hits += compare_new(&bvh, origin, &tile(&mut random, -origin, 16, 0.03, 0.5));
    }
    assert!(hits > 5_000, "{hits}");
}

#[test]
fn triangles_seen_from_within_their_plane_are_met_as_by_single_rays() {
    let mut random = Random(25);
    let mesh: Vec<Triangle> = random.soup(200, DVec3::ZERO, 1.0, 0.5);
    let bvh = build(&mesh);
    for &[a, b, c] in mesh.iter().step_by(4) {
        for origin in [
            a,
            b,
            (a + b) * 0.5,
            a + b - c,
            a * 0.25 + b * 0.25 + c * 0.5,
        ] {
            for target in [a, b, c, (b + c) * 0.5] {
                if (target - origin).length() > 1e-3 {
                    let directions = tile(&mut random, target - origin, 8, 1e-3, 0.0);
                    compare_new(&bvh, origin, &directions);
                }
            }
        }
    }
}

#[test]
fn rays_at_edges_and_corners_of_closed_meshes_are_met_as_by_single_rays() {
    let mut random = Random(26);
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
            for fan in mesh.chunks(12) {
                let points = fan.iter().flat_map(|&[a, b, c]| {
                    [a, b, (a + b) * 0.5, a + (c - a) * 0.3, b.lerp(c, 0.7)]
                });
                let directions: Vec<DVec3> = points.map(|p| p - origin).collect();
                let hits = compare_new(&bvh, origin, &directions);
                assert_eq!(hits, directions.len(), "a leak");
            }
        }
    }
}

#[test]
fn origins_on_corners_and_far_away_are_traced_as_by_single_rays() {
    let mut random = Random(27);
    let mesh = scaled(&sphere(3), 2.0, DVec3::new(0.3, 0.1, -0.7));
    let bvh = build(&mesh);
    let mut hits = 0;
    for i in 0..120 {
        let corner = mesh[i * 4][i % 3];
        let far = random.direction() * 10f64.powi((i % 16) as i32 - 2);
        for (origin, size) in [(corner, 0.02), (far, 0.1 / (1.0 + far.length()))] {
            let axis = random.vector() * 0.5 - origin;
            hits += compare_new(&bvh, origin, &tile(&mut random, axis, 16, size, 0.5));
        }
    }
    assert!(hits > 20_000, "{hits}");
}

#[test]
fn hits_known_before_are_replaced_as_by_single_rays() {
    let mut random = Random(28);
    let (near, far) = (
        build(&random.soup(300, DVec3::ZERO, 1.0, 0.4)),
        build(&random.soup(300, DVec3::ZERO, 1.0, 0.4)),
    );
    for _ in 0..40 {
        let origin = random.vector() * 3.0;
        let directions = tile(&mut random, -origin, 16, 0.03, 0.5);
        let mut hits = vec![None; directions.len()];
        near.closest_by(
            certified(Kernel::Scalar),
            Origins::Shared(origin),
            &directions,
            &mut hits,
            None,
            None,
        );
        compare(&far, origin, &directions, &hits);
        // A hit doesn't replace its equal.
        assert_eq!(compare(&near, origin, &directions, &hits), 0);
    }
}

#[test]
fn tiles_of_any_shape_are_traced() {
    let mut random = Random(29);
    let bvh = build(&random.soup(500, DVec3::ZERO, 1.0, 0.3));
    let origin = DVec3::new(0.1, 0.2, 3.0);
    let all = tile(&mut random, -origin, 16, 0.01, 0.5);
    for width in 1..=16 {
        for height in [1, 3, 7, 8, 12, 16] {
            let rows = all.chunks(16).take(height);
            let directions: Vec<DVec3> = rows.flat_map(|row| &row[..width]).copied().collect();
            compare_new(&bvh, origin, &directions);
        }
    }
}

#[test]
fn rays_of_any_direction_and_length_are_traced() {
    let mut random = Random(30);
    let bvh = build(&random.soup(500, DVec3::ZERO, 1.0, 0.3));
    for i in 0..100 {
        let origin = random.vector();
        let length = |random: &mut Random| 2f64.powi((random.number() * (i as f64) * 8.0) as i32);
        let mut directions: Vec<DVec3> = (0..128)
            .map(|_| random.direction() * length(&mut random))
            .collect();
        compare_new(&bvh, origin, &directions);
        // Nearly the same way, with lengths that differ.
        directions = tile(&mut random, origin, 8, 0.01, 0.5);
        for d in &mut directions {
            *d *= 1.0 + 0.7 * random.number() * f64::from(i % 3);
        }
        compare_new(&bvh, origin, &directions);
    }
}

#[test]
fn rays_along_axes_are_traced_as_by_single_rays() {
    let mut random = Random(31);
    let bvh = build(&random.soup(800, DVec3::ZERO, 1.0, 0.4));
    let mut hits = 0;
    for axis in [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        -DVec3::X,
        -DVec3::Y,
        -DVec3::Z,
    ] {
        for pitch in [0.02, 1e-12, 1e-30, 1e-320, 0.0] {
            let (right, up) = (axis.zxy_turned(), axis.zxy_turned().zxy_turned());
            let at = |i: usize| (i as f64 - 8.0) * pitch;
            let directions: Vec<DVec3> = (0..256)
                .map(|i| axis + right * at(i % 16) + up * at(i / 16))
                .collect();
            for _ in 0..4 {
                let origin = random.vector() * 0.5 - axis * 2.0;
                hits += compare_new(&bvh, origin, &directions);
            }
        }
    }
    assert!(hits > 5_000, "{hits}");
}

trait Turned {
    fn zxy_turned(self) -> DVec3;
}

impl Turned for DVec3 {
    fn zxy_turned(self) -> DVec3 {
        DVec3::new(self.z, self.x, self.y)
    }
}

#[test]
fn broken_rays_hit_nothing_and_spoil_no_others() {
    let mut random = Random(32);
    let bvh = build(&sphere(3));
    let origin = DVec3::new(0.1, 0.0, 0.2);
    let numbers = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        0.0,
        1e308,
        5e-324,
    ];
    for broken in numbers {
        for at in [0, 5, 63] {
            let mut directions = tile(&mut random, DVec3::ONE, 8, 0.01, 0.5);
            for axis in 0..3 {
                directions[at][axis] = broken;
                compare_new(&bvh, origin, &directions);
                compare_new(&bvh, DVec3::splat(broken), &directions);
            }
        }
    }
}

#[test]
fn triangles_of_very_different_sizes_are_met_as_by_single_rays() {
    let mut random = Random(33);
    let mut mesh = random.soup(50, DVec3::ZERO, 1e-6, 1e-6);
    mesh.extend(random.soup(50, DVec3::ONE, 1.0, 1.0));
    mesh.extend(random.soup(50, DVec3::X * 1e3, 1e6, 1e6));
    mesh.extend(random.soup(50, DVec3::ZERO, 1e-20, 1e-20));
    let bvh = build(&mesh);
    let mut hits = 0;
    for i in 0..160 {
        let scale = [3e-20, 3e-6, 3.0, 3e6][i % 4];
        let origin = random.direction() * scale;
        let axis = random.vector() * scale * 0.3 - origin;
        hits += compare_new(&bvh, origin, &tile(&mut random, axis, 16, 0.02, 0.5));
    }
    assert!(hits > 5_000, "{hits}");
}
