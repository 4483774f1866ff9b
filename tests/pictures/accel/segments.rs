//! Packets of segments against single rays: the same answers with every kernel.

use glam::DVec3;
use nullray::accel::{Bvh, Counts, Facing, Kernel, Ray, Segment};

use crate::accel::common::*;

/// Compares all kernels with [`Bvh::any`]; returns how many segments are blocked.
fn compare(bvh: &Bvh, segments: &[Segment]) -> usize {
    let single = |s: &Segment| bvh.any(&s.ray, s.s_max, s.skip);
    let expected: Vec<bool> = segments.iter().map(single).collect();
    for kernel in Kernel::ALL {
        // What was there before doesn't count.
        let mut blocked: Vec<bool> = (0..segments.len()).map(|i| i % 2 == 0).collect();
        bvh.any_by(certified(kernel), segments, &mut blocked, None);
        for (i, segment) in segments.iter().enumerate() {
            assert_eq!(blocked[i], expected[i], "{kernel:?}: {i}, {segment:?}");
        }
    }
    expected.iter().filter(|&&b| b).count()
}

fn segment(origin: DVec3, direction: DVec3, s_max: f64, skip: Option<u32>) -> Segment {
    let size = origin.length() * 1e-12 / direction.length();
    Segment {
        ray: Ray {
            origin,
            direction,
            s_min: if size.is_finite() { size } else { 0.0 },
        },
        s_max,
        skip,
        end: None,
    }
}

/// From what a tile sees to `lamp`.
fn shadows(bvh: &Bvh, eye: DVec3, directions: &[DVec3], lamp: DVec3) -> Vec<Segment> {
    let mut hits = vec![None; directions.len()];
    trace(bvh, eye, directions, &mut hits);
    let hits = directions
        .iter()
        .zip(hits)
        .filter_map(|(d, h)| Some((d, h?)));
    hits.map(|(d, hit)| {
        let from = eye + *d * hit.s;
        segment(from, lamp - from, 1.0, Some(hit.triangle))
    })
    .collect()
}

#[test]
fn shadows_of_a_lamp_are_those_of_single_rays_at_all_scales() {
    let mut random = Random(61);
    let (mut blocked, mut all) = (0, 0);
    for exponent in [-9, -3, 0, 4, 9] {
        let scale = 10f64.powi(exponent);
        for place in [DVec3::ZERO, DVec3::new(3.0, -7.0, 5.0) * scale] {
            let bvh = build(&random.soup(300, place, scale, 0.4 * scale));
            for _ in 0..12 {
                let eye = place + random.direction() * 3.0 * scale;
                let lamp = place + random.direction() * 4.0 * scale;
                let directions = tile(&mut random, place - eye, 16, 0.01, 0.5);
                let segments = shadows(&bvh, eye, &directions, lamp);
                all += segments.len();
                blocked += compare(&bvh, &segments);
            }
        }
    }
    assert!(
        blocked > 3_000 && all - blocked > 1_000,
        "{blocked} of {all}"
    );
}

#[test]
fn shadows_of_lamps_on_edges_and_corners_and_far_from_the_origin_are_those_of_single_rays() {
    let mut random = Random(69);
    let (mut blocked, mut all) = (0, 0);
    for distance in [0.0, 1.0, 1e3, 1e6, 1e12] {
        let place = DVec3::new(1.0, -0.7, 0.4) * distance;
        let mesh = random.soup(200, place, 1.0, 0.4);
        let bvh = build(&mesh);
        for (k, &[a, b, c]) in mesh.iter().enumerate().take(60) {
            // In a corner, on an edge, in the plane beside the triangle, just before it.
            let lamp = match k % 4 {
                0 => a,
                1 => a.midpoint(b),
                2 => a + (b - a) * 1.5 + (c - a) * 0.5,
                _ => (a + b + c) / 3.0 + (b - a).cross(c - a).normalize() * 1e-9,
            };
            let segments: Vec<Segment> = (0..128)
                .map(|_| place + random.vector())
                .map(|from| segment(from, lamp - from, 1.0, None))
                .collect();
            all += segments.len();
            blocked += compare(&bvh, &segments);
        }
    }
    assert!(
        blocked > 10_000 && all - blocked > 1_000,
        "{blocked} of {all}"
    );
}

#[test]
fn shadows_on_a_closed_mesh_are_those_of_single_rays() {
    let mut random = Random(62);
    let mesh = scaled(&sphere(5), 1.0, DVec3::new(0.3, 0.2, 0.1));
    let bvh = build(&mesh);
    let (mut blocked, mut all) = (0, 0);
    for i in 0..60 {
        let eye = random.direction() * 4.0;
        let lamp = random.direction() * [1.3, 5.0, 0.3, 900.0][i % 4];
        let directions = tile(&mut random, -eye, 16, 0.01, 0.5);
        let segments = shadows(&bvh, eye, &directions, lamp);
        all += segments.len();
        blocked += compare(&bvh, &segments);
    }
    assert!(
        blocked > 3_000 && all - blocked > 1_000,
        "{blocked} of {all}"
    );
}

#[test]
fn parallel_rays_without_end_are_blocked_as_single_rays() {
    let mut random = Random(63);
    let bvh = build(&random.soup(500, DVec3::ZERO, 1.0, 0.2));
    let mut blocked = 0;
    for i in 0..60 {
        let centre = random.vector();
        let sun = match i % 3 {
            0 => DVec3::Y,
            1 => -DVec3::X + DVec3::Z * -0.0,
            _ => random.direction(),
        };
        let size = 10f64.powi(-(i % 6));
        let rays = (0..200).map(|_| {
            let from = centre + random.vector() * size;
            segment(from, sun, f64::INFINITY, None)
        });
        blocked += compare(&bvh, &rays.collect::<Vec<_>>());
    }
    assert!(blocked > 1_000, "{blocked}");
}

#[test]
fn segments_that_end_on_edges_and_corners_are_blocked_as_single_rays() {
    let mut random = Random(64);
    let mesh = sphere(3);
    let bvh = build(&mesh);
    let mut blocked = 0;
    for end in [1.0, 1.0 + 1e-15, 1.0 - 1e-15, 1.0 + 1e-9, 1.0 - 1e-9, 2.0] {
        for fan in mesh.chunks(16) {
            let place = random.vector() * 0.3;
            let segments: Vec<Segment> = fan
                .iter()
                .flat_map(|&[a, b, c]| [a, (a + b) * 0.5, b.lerp(c, 0.3), (a + b + c) / 3.0])
                .map(|target| {
                    let from = place + random.vector() * 1e-3;
                    segment(from, target - from, end, None)
                })
                .collect();
            blocked += compare(&bvh, &segments);
        }
    }
    assert!(blocked > 2_000, "{blocked}");
}

#[test]
fn segments_from_triangles_to_their_neighbours_are_blocked_as_single_rays() {
    let mut random = Random(65);
    let mesh = random.soup(60, DVec3::ZERO, 0.5, 0.5);
    let bvh = Bvh::build(mesh.clone(), |id| match id % 3 {
        0 => Facing::FrontOnly,
        _ => Facing::TwoSided,
    });
    let mut blocked = 0;
    for (id, &[a, b, c]) in mesh.iter().enumerate() {
        // Ends and starts in planes of triangles, with and without the triangle itself.
        let lamp = random.vector();
        for skip in [None, Some(id as u32)] {
            let mut from = || a + (b - a) * random.number() * 0.4 + (c - a) * random.number() * 0.4;
            let starts: Vec<DVec3> = (0..70).map(|_| from()).collect();
            let to_lamp = |&p: &DVec3| segment(p, lamp - p, 1.0, skip);
            let from_lamp = |&p: &DVec3| segment(lamp, p - lamp, 1.0, skip);
            blocked += compare(&bvh, &starts.iter().map(to_lamp).collect::<Vec<_>>());
            blocked += compare(&bvh, &starts.iter().map(from_lamp).collect::<Vec<_>>());
        }
    }
    assert!(blocked > 2_000, "{blocked}");
}

#[test]
fn broken_segments_are_not_blocked_and_spoil_no_others() {
    let mut random = Random(66);
    let bvh = build(&sphere(3));
    let numbers = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -1.0,
        0.0,
        1e308,
        5e-324,
    ];
    let lamp = DVec3::new(0.1, 5.0, 0.3);
    for broken in numbers {
        for at in [0, 9, 63] {
            for field in 0..8 {
                let mut segments: Vec<Segment> = (0..64)
                    .map(|_| random.vector() * 0.2)
                    .map(|from| segment(from, lamp - from, 1.0, None))
                    .collect();
                let Segment { ray, s_max, .. } = &mut segments[at];
                match field {
                    0..3 => ray.origin[field] = broken,
                    3..6 => ray.direction[field - 3] = broken,
                    6 => ray.s_min = broken,
                    _ => *s_max = broken,
                }
                compare(&bvh, &segments);
            }
        }
    }
}

#[test]
fn any_number_of_segments_is_answered() {
    let mut random = Random(67);
    let bvh = build(&random.soup(300, DVec3::ZERO, 1.0, 0.3));
    let lamp = DVec3::new(0.0, 4.0, 0.0);
    for count in [0, 1, 7, 8, 63, 64, 65, 200, 255, 256, 300] {
        let segments: Vec<Segment> = (0..count)
            .map(|_| random.vector())
            .map(|from| segment(from, lamp - from, 1.0, None))
            .collect();
        compare(&bvh, &segments);
    }
}

#[test]
fn packets_of_shadows_visit_fewer_nodes_than_single_rays() {
    let mut random = Random(68);
    let bvh = build(&sphere(5));
    let eye = DVec3::new(0.0, 0.3, 4.0);
    let directions = tile(&mut random, -eye, 16, 0.002, 0.5);
    let segments = shadows(&bvh, eye, &directions, DVec3::new(1.0, 2.0, 3.0));
    let count = |kernel| {
        let mut counts = Counts::default();
        let mut blocked = vec![false; segments.len()];
        bvh.any_by(
            certified(kernel),
            &segments,
            &mut blocked,
            Some(&mut counts),
        );
        assert_eq!(counts.rays, segments.len() as u64);
        counts
    };
    let (packets, singles) = (count(Kernel::Portable), count(Kernel::Scalar));
    assert!(packets.nodes * 8 < singles.nodes, "{packets:?} {singles:?}");
    assert_eq!((packets.singles, singles.singles), (0, singles.rays));
}
