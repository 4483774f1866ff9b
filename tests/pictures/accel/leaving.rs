//! Rays that leave surfaces in all directions, in small and large trees: the same hits as single rays, with every kernel.

use glam::DVec3;
use nullray::accel::{Bvh, Counts, Facing, Hit, Kernel, NO_SLOT, Origins, Ray, Segment};

use crate::accel::common::*;

/// A box with these half extents, turned about y.
fn cuboid(centre: DVec3, half: DVec3, turn: f64) -> Vec<Triangle> {
    let turn = glam::DMat3::from_rotation_y(turn);
    let corner = |k: usize| {
        let sign = |axis: usize| f64::from((k >> axis & 1) as u8) * 2.0 - 1.0;
        centre + turn * (half * DVec3::new(sign(0), sign(1), sign(2)))
    };
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let quads = faces.map(|face| face.map(corner));
    let halves = |[a, b, c, d]: [DVec3; 4]| [[a, b, c], [a, c, d]];
    quads.into_iter().flat_map(halves).collect()
}

/// `count` boxes in a room.
fn room(random: &mut Random, count: usize, scale: f64, place: DVec3) -> Vec<Triangle> {
    let mut all = cuboid(place, DVec3::splat(scale), 0.0);
    for k in 0..count {
        let at = place + random.vector() * 0.8 * scale;
        let half = (random.vector().abs() + 0.1) * 0.15 * scale;
        let turn = if k % 3 == 0 { 0.0 } else { random.number() };
        all.extend(cuboid(at, half, turn));
    }
    all
}

/// Where rays start, along what, and what they leave.
struct Leaving {
    origins: Vec<DVec3>,
    directions: Vec<DVec3>,
    slots: Vec<u32>,
}

/// Sends a ray on from each of `hits` in any direction on its side.
fn go_on(bvh: &Bvh, random: &mut Random, rays: &Leaving, hits: &[Option<Hit>]) -> Leaving {
    let mut next = Leaving {
        origins: Vec::new(),
        directions: Vec::new(),
        slots: Vec::new(),
    };
    for (k, hit) in hits.iter().enumerate() {
        let Some(hit) = hit else {
            continue;
        };
        let normal = bvh.normal(hit) * if hit.front { 1.0 } else { -1.0 };
        let point = rays.origins[k] + rays.directions[k] * hit.s;
        let size = point.abs().max_element() + rays.origins[k].abs().max_element();
        let direction = random.direction();
        next.origins.push(point + normal * (size * 2f64.powi(-42)));
        next.directions
            .push(direction * direction.dot(normal).signum());
        next.slots.push(hit.slot);
    }
    next
}

/// The closest hits of all kernels, which agree; `tally` counts the work of the portable one.
fn closest(bvh: &Bvh, rays: &Leaving, tally: &mut Counts) -> Vec<Option<Hit>> {
    let mut trace = |kernel: Kernel| {
        let mut hits = vec![None; rays.directions.len()];
        let from = Origins::Leaving {
            origins: &rays.origins,
            slots: &rays.slots,
        };
        let method = certified(kernel);
        match kernel == Kernel::Portable {
            true => bvh.closest_by(method, from, &rays.directions, &mut hits, Some(tally), None),
            false => bvh.closest_by(method, from, &rays.directions, &mut hits, None, None),
        }
        hits
    };
    let expected = trace(Kernel::Scalar);
    for kernel in packet_kernels() {
        let hits = trace(kernel);
        for (k, (hit, expected)) in hits.iter().zip(&expected).enumerate() {
            let (o, d) = (rays.origins[k], rays.directions[k]);
            assert_eq!(hit, expected, "{kernel:?}: ray {k} from {o} along {d}");
        }
    }
    for (hit, slot) in expected.iter().zip(&rays.slots) {
        assert!(hit.is_none_or(|hit| hit.slot != *slot));
    }
    expected
}

/// Segments between the points that rays leave, in pairs, ask all kernels the same as single rays; returns how many are blocked.
fn connect(bvh: &Bvh, ids: &[u32], rays: &Leaving) -> usize {
    let count = rays.origins.len();
    let segments: Vec<_> = (0..count)
        .map(|k| {
            let (from, to) = (rays.origins[k], rays.origins[(k * 7 + 3) % count]);
            Segment {
                ray: Ray {
                    origin: from,
                    direction: to - from,
                    s_min: 1e-11,
                },
                s_max: if k % 2 == 0 { 1.0 - 1e-6 } else { 0.7 },
                skip: Some(ids[k]),
                end: (k % 4 == 0).then_some(ids[(k * 7 + 3) % count]),
            }
        })
        .collect();
    let ask = |kernel| {
        let mut blocked = vec![false; segments.len()];
        bvh.any_by(certified(kernel), &segments, &mut blocked, None);
        blocked
    };
    let expected = ask(Kernel::Scalar);
    for (segment, expected) in segments.iter().zip(&expected) {
        // What ends somewhere is blocked by nothing more than what does not.
        let any = bvh.any(&segment.ray, segment.s_max, segment.skip);
        assert!(any || !expected);
        assert!(segment.end.is_some() || any == *expected);
    }
    for kernel in packet_kernels() {
        let blocked = ask(kernel);
        for (k, segment) in segments.iter().enumerate() {
            assert_eq!(blocked[k], expected[k], "{kernel:?}: {k}, {segment:?}");
        }
    }
    expected.iter().filter(|b| **b).count()
}

/// Follows light through rooms of `boxes` boxes; how many rays met something and how many segments were blocked.
fn follow(boxes: usize, facing: impl Fn(u32) -> Facing + Copy + Sync) -> [usize; 2] {
    let mut random = Random(71);
    let (mut met, mut blocked) = (0, 0);
    for (scale, place) in [
        (1.0, DVec3::ZERO),
        (1e-6, DVec3::ZERO),
        (1e5, DVec3::new(3e5, -7e5, 5e5)),
        (1.0, DVec3::new(300.0, -700.0, 500.0)),
    ] {
        let triangles = room(&mut random, boxes, scale, place);
        let bvh = Bvh::build(triangles, facing);
        let count = 1024;
        let mut rays = Leaving {
            origins: vec![place + DVec3::new(0.01, 0.02, 0.03) * scale; count],
            directions: (0..count).map(|_| random.direction()).collect(),
            slots: vec![NO_SLOT; count],
        };
        for _ in 0..5 {
            let hits = closest(&bvh, &rays, &mut Counts::default());
            let ids: Vec<u32> = hits.iter().flatten().map(|hit| hit.triangle).collect();
            met += ids.len();
            rays = go_on(&bvh, &mut random, &rays, &hits);
            blocked += connect(&bvh, &ids, &rays);
        }
    }
    [met, blocked]
}

#[test]
fn light_that_goes_from_wall_to_wall_meets_with_every_kernel_what_single_rays_meet() {
    for boxes in [0, 7, 20, 200] {
        let [met, blocked] = follow(boxes, |_| Facing::TwoSided);
        // Little gets out of a closed room, at edges where rays start beyond the next wall.
        assert!(met > 19_000, "{boxes}: {met}");
        assert_eq!(blocked > 1_000, boxes > 0, "{boxes}: {blocked}");
    }
}

#[test]
fn walls_that_show_one_side_let_the_same_rays_through_with_every_kernel() {
    let mut sides = [0; 2];
    for boxes in [7, 200] {
        let [met, blocked] = follow(boxes, |k| match k % 3 {
            0 => Facing::FrontOnly,
            _ => Facing::TwoSided,
        });
        sides[0] += met;
        sides[1] += blocked;
    }
    assert!(sides[0] > 10_000 && sides[1] > 1_000, "{sides:?}");
}

#[test]
fn rays_on_both_sides_of_a_plane_through_their_middle_each_see_their_own_side_of_it() {
    let mut random = Random(73);
    // Squares of both orientations in the plane y = 0 (or a little off it) that show their fronts only, and boxes.
    for off in [0.0, -0.0, 1e-300, -1e-12] {
        let corner = |x: f64, z: f64| DVec3::new(x, off, z);
        let mut triangles = Vec::new();
        for k in 0..8 {
            let (x, z) = (f64::from(k % 4) - 2.0, f64::from(k / 4) - 1.0);
            let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let [a, b, c, d] = square.map(|(u, v)| corner(x + u, z + v));
            match k % 3 {
                0 => triangles.extend([[a, b, c], [a, c, d]]),
                _ => triangles.extend([[a, c, b], [a, d, c]]),
            }
        }
        triangles.extend(cuboid(DVec3::new(0.0, -0.5, 0.0), DVec3::splat(0.2), 0.3));
        let bvh = Bvh::build(triangles, |_| Facing::FrontOnly);
        // Each ray with its image in a mirror: the middle of their origins is in the plane.
        let mut rays = Leaving {
            origins: Vec::new(),
            directions: Vec::new(),
            slots: vec![NO_SLOT; 2048],
        };
        for _ in 0..1024 {
            let (origin, direction) = (random.vector(), random.direction());
            for sign in [1.0, -1.0] {
                let mirror = DVec3::new(1.0, sign, 1.0);
                rays.origins.push(origin * mirror);
                rays.directions.push(direction * mirror);
            }
        }
        let hits = closest(&bvh, &rays, &mut Counts::default());
        assert!(hits.iter().flatten().all(|hit| hit.front));
        assert!(hits.iter().flatten().count() > 200);
        let ids = vec![u32::MAX; 2048];
        assert!(connect(&bvh, &ids, &rays) > 100);
    }
}

#[test]
fn in_a_small_room_few_of_the_rays_that_leave_walls_are_left_to_single_rays() {
    let mut random = Random(72);
    let bvh = build(&room(&mut random, 7, 1.0, DVec3::ZERO));
    let mut rays = Leaving {
        origins: vec![DVec3::new(0.01, 0.02, 0.03); 1024],
        directions: (0..1024).map(|_| random.direction()).collect(),
        slots: vec![NO_SLOT; 1024],
    };
    let mut counts = Counts::default();
    for _ in 0..4 {
        let hits = closest(&bvh, &rays, &mut counts);
        rays = go_on(&bvh, &mut random, &rays, &hits);
    }
    assert!(counts.rays > 3000, "{counts:?}");
    assert!(counts.doubts * 50 < counts.rays, "{counts:?}");
    assert_eq!(counts.singles, 0);
}
