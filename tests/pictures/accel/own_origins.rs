//! Packets of rays with separate origins against single rays: the same hits, bit for bit, with every kernel.

use glam::DVec3;
use nullray::accel::{Bvh, Counts, Facing, Hit, Kernel, Origins, Precision, Traversal};

use crate::accel::common::*;

/// Compares all kernels with single rays; returns how many rays hit.
fn compare(bvh: &Bvh, origins: &[DVec3], directions: &[DVec3]) -> usize {
    let trace = |kernel| {
        let mut hits = vec![None; directions.len()];
        let mut replaced = Vec::new();
        let from = Origins::Each(origins);
        bvh.closest_by(
            certified(kernel),
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
        for i in 0..directions.len() {
            let (o, d) = (origins[i], directions[i]);
            assert_eq!(
                hits[i], expected.0[i],
                "{kernel:?}: ray {i} from {o} along {d}"
            );
        }
        assert_eq!(replaced, expected.1, "{kernel:?}");
    }
    expected.1.len()
}

/// Origins about `centre`, off by as much as `size`.
fn origins(random: &mut Random, centre: DVec3, size: f64, count: usize) -> Vec<DVec3> {
    (0..count)
        .map(|_| centre + random.vector() * size)
        .collect()
}

#[test]
fn rays_with_origins_of_their_own_are_met_as_by_single_rays_at_all_scales_and_distances() {
    let mut random = Random(41);
    let mut hits = 0;
    for exponent in [-9, -4, 0, 3, 9] {
        let scale = 10f64.powi(exponent);
        for place in [DVec3::ZERO, DVec3::new(3.0, -7.0, 5.0) * scale] {
            let bvh = build(&random.soup(400, place, scale, 0.3 * scale));
            for i in 0..24 {
                let centre = place + random.vector() * 3.0 * scale;
                let size = scale * 10f64.powi(-(i % 12));
                let origins = origins(&mut random, centre, size, 256);
                let axis = (place - centre) * 10f64.powi(i - 12);
                let directions = tile(&mut random, axis, 16, 0.06 / 4f64.powi(i % 4), 0.5);
                hits += compare(&bvh, &origins, &directions);
            }
        }
    }
    assert!(hits > 20_000, "{hits}");
}

#[test]
fn pinholes_of_any_size_meet_small_triangles_as_single_rays_do() {
    let mut random = Random(42);
    let bvh = build(&random.soup(30_000, DVec3::ZERO, 1.0, 0.02));
    let mut hits = 0;
    for i in 0..120 {
        let centre = random.vector() * [0.5, 4.0][i % 2];
        let axis = random.vector() * 0.5 - centre;
        let directions = tile(&mut random, axis, 16, 0.002, 0.5);
        // The pixels of a sensor before its pinhole, and the pinhole's way during an exposure.
        let size = 10f64.powi(-(i as i32 % 8));
        let way = random.vector() * 0.1;
        let origins: Vec<DVec3> = directions
            .iter()
            .map(|d| centre + *d * size + way * size * random.number())
            .collect();
        hits += compare(&bvh, &origins, &directions);
    }
    assert!(hits > 10_000, "{hits}");
}

#[test]
fn rays_with_one_origin_are_met_as_those_that_share_it() {
    let mut random = Random(43);
    let bvh = build(&random.soup(3000, DVec3::ZERO, 1.0, 0.1));
    for _ in 0..40 {
        let origin = random.vector() * 2.0;
        let directions = tile(&mut random, -origin, 16, 0.01, 0.5);
        let trace = |from| {
            let mut hits: Vec<Option<Hit>> = vec![None; 256];
            let method = Traversal::default();
            bvh.closest_by(method, from, &directions, &mut hits, None, None);
            hits
        };
        assert_eq!(
            trace(Origins::Each(&[origin; 256])),
            trace(Origins::Shared(origin))
        );
    }
}

#[test]
fn rays_aimed_at_edges_and_corners_from_their_own_origins_never_leak() {
    let mut random = Random(44);
    for (scale, shift) in [
        (1.0, DVec3::ZERO),
        (1e-9, DVec3::ZERO),
        (1e9, DVec3::ZERO),
        (1.0, DVec3::new(1e3, 77.7, -3e4)),
    ] {
        let mesh = scaled(&sphere(4), scale, shift);
        let bvh = build(&mesh);
        for size in [1e-9, 1e-3, 0.3] {
            for fan in mesh.chunks(12) {
                let points: Vec<DVec3> = fan
                    .iter()
                    .flat_map(|&[a, b, c]| [a, b, (a + b) * 0.5, a + (c - a) * 0.3, b.lerp(c, 0.7)])
                    .collect();
                let origins = origins(&mut random, shift, size * scale, points.len());
                let directions: Vec<DVec3> =
                    points.iter().zip(&origins).map(|(p, o)| *p - *o).collect();
                assert_eq!(compare(&bvh, &origins, &directions), points.len(), "a leak");
            }
        }
    }
}

#[test]
fn rays_from_almost_one_point_are_met_at_edges_as_by_single_rays() {
    let mut random = Random(52);
    let mesh = sphere(4);
    let bvh = build(&mesh);
    for &[a, b, _] in mesh.iter().step_by(7) {
        // Along an edge, so near one another that all origins are taken for one: each ray then passes within what is left out.
        let step = (b - a) / 64.0;
        let targets: Vec<DVec3> = (0..64).map(|i| a + step * f64::from(i)).collect();
        for distance in [0.3, 2.0, 40.0] {
            let centre = (a + b) * 0.5 * (1.0 + distance) + random.vector() * 0.1;
            let size = step.length() / 300.0;
            let origins = origins(&mut random, centre, size, targets.len());
            let directions: Vec<DVec3> =
                targets.iter().zip(&origins).map(|(p, o)| *p - *o).collect();
            assert_eq!(compare(&bvh, &origins, &directions), 64, "a leak");
        }
    }
}

#[test]
fn origins_in_the_planes_of_triangles_are_met_as_by_single_rays() {
    let mut random = Random(45);
    let mesh: Vec<Triangle> = random.soup(200, DVec3::ZERO, 1.0, 0.5);
    let bvh = build(&mesh);
    for &[a, b, c] in mesh.iter().step_by(8) {
        let (u, v) = (b - a, c - a);
        let within = |random: &mut Random| a + u * random.number() + v * random.number();
        for target in [a, (b + c) * 0.5, a + b - c] {
            let size = [0.0, 1e-12, 1e-3][(random.0 % 3) as usize];
            let place = within(&mut random);
            let origins: Vec<DVec3> = (0..64)
                .map(|_| place + (within(&mut random) - a) * size)
                .collect();
            let directions: Vec<DVec3> = origins.iter().map(|&o| target - o).collect();
            compare(&bvh, &origins, &directions);
        }
    }
}

#[test]
fn parallel_rays_along_axes_from_a_grid_are_met_as_by_single_rays() {
    let mut random = Random(46);
    let bvh = build(&random.soup(800, DVec3::ZERO, 1.0, 0.4));
    let mut hits = 0;
    for axis in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Z] {
        let (right, up) = axis.any_orthonormal_pair();
        for pitch in [0.02, 1e-9] {
            let at = |i: usize| (i as f64 - 8.0) * pitch;
            let origins: Vec<DVec3> = (0..256)
                .map(|i| axis * -3.0 + right * at(i % 16) + up * at(i / 16))
                .collect();
            hits += compare(&bvh, &origins, &[axis; 256]);
            hits += compare(&bvh, &origins, &[axis + right * -0.0; 256]);
        }
    }
    assert!(hits > 1_000, "{hits}");
}

#[test]
fn broken_origins_and_directions_hit_nothing_and_spoil_no_others() {
    let mut random = Random(47);
    let bvh = build(&sphere(3));
    let numbers = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e308,
        1e60,
        5e-324,
    ];
    for broken in numbers {
        for at in [0, 5, 63] {
            for axis in 0..3 {
                let mut origins = origins(&mut random, DVec3::new(0.1, 0.0, 0.2), 0.01, 64);
                let mut directions = tile(&mut random, DVec3::ONE, 8, 0.01, 0.5);
                origins[at][axis] = broken;
                compare(&bvh, &origins, &directions);
                directions[at][axis] = broken;
                compare(&bvh, &origins, &directions);
            }
        }
    }
}

#[test]
fn a_closed_mesh_has_no_gap_for_rays_with_origins_of_their_own() {
    let mut random = Random(48);
    let centre = DVec3::new(3.0, 0.1, -2.0);
    let bvh = build(&scaled(&sphere(5), 1.0, centre));
    for i in 0..1500 {
        let place = centre + random.vector() * 0.5;
        let origins = origins(&mut random, place, 10f64.powi(-(i as i32 % 9) - 1), 256);
        let axis = random.direction();
        let directions = tile(&mut random, axis, 16, 0.001, 0.5);
        let mut hits = vec![None; 256];
        let kernel = Kernel::ALL[i % 3];
        let from = Origins::Each(&origins);
        let method = certified(kernel);
        bvh.closest_by(method, from, &directions, &mut hits, None, None);
        let inside = |hit: &Option<Hit>| hit.is_some_and(|hit| !hit.front);
        assert!(hits.iter().all(inside), "{kernel:?}: a leak near {place}");
    }
}

#[test]
fn one_sided_triangles_are_passed_from_behind_whatever_the_origins() {
    let mut random = Random(49);
    let mesh = random.soup(400, DVec3::ZERO, 1.0, 0.4);
    let bvh = Bvh::build(mesh, |id| match id % 2 {
        0 => Facing::FrontOnly,
        _ => Facing::TwoSided,
    });
    let mut hits = 0;
    for _ in 0..40 {
        let centre = random.direction() * 3.0;
        let origins = origins(&mut random, centre, 0.1, 256);
        let directions = tile(&mut random, -centre, 16, 0.02, 0.5);
        hits += compare(&bvh, &origins, &directions);
    }
    assert!(hits > 2_000, "{hits}");
}

#[test]
fn fast_results_from_origins_near_one_another_are_those_of_f32() {
    let mut random = Random(50);
    let bvh = build(&sphere(4));
    let (mut same, mut all) = (0, 0);
    for _ in 0..50 {
        let centre = random.direction() * 3.0;
        let origins = origins(&mut random, centre, 0.01, 256);
        let directions = tile(&mut random, -centre, 16, 0.01, 0.5);
        for kernel in Kernel::ALL {
            let trace = |precision| {
                let mut hits: Vec<Option<Hit>> = vec![None; 256];
                let (method, from) = (Traversal { kernel, precision }, Origins::Each(&origins));
                bvh.closest_by(method, from, &directions, &mut hits, None, None);
                hits
            };
            for (fast, hit) in trace(Precision::Fast)
                .iter()
                .zip(trace(Precision::Certified))
            {
                all += 1;
                same += usize::from(fast.map(|h| h.triangle) == hit.map(|h| h.triangle));
                if let (Some(fast), Some(hit)) = (fast, hit) {
                    assert!((fast.s - hit.s).abs() < 1e-4 * hit.s);
                    assert_eq!(fast.front, hit.front);
                }
            }
        }
    }
    assert!(same * 1000 > all * 998, "{same} of {all}");
}

#[test]
fn a_tally_counts_the_rays_and_changes_nothing() {
    let mut random = Random(51);
    let bvh = build(&random.soup(3000, DVec3::ZERO, 1.0, 0.1));
    let origin = DVec3::new(0.2, 0.1, 3.0);
    let origins = origins(&mut random, origin, 0.01, 256);
    let directions = tile(&mut random, -origin, 16, 0.01, 0.5);
    for from in [Origins::Shared(origin), Origins::Each(&origins)] {
        for kernel in Kernel::ALL {
            let (mut counts, method) = (Counts::default(), certified(kernel));
            let (mut counted, mut hits) = (vec![None; 256], vec![None; 256]);
            bvh.closest_by(
                method,
                from,
                &directions,
                &mut counted,
                Some(&mut counts),
                None,
            );
            bvh.closest_by(method, from, &directions, &mut hits, None, None);
            assert_eq!(counted, hits);
            assert_eq!(counts.rays, 256);
            assert!(counts.nodes > 0 && counts.triangles > 0, "{counts:?}");
            let singles = if kernel == Kernel::Scalar { 256 } else { 0 };
            assert_eq!(counts.singles, singles, "{kernel:?}");
        }
    }
}
