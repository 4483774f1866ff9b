use super::*;
use crate::accel::packet::{Kernel, Precision, Traversal};
use crate::accel::{Bvh, Counts, Facing, Hit, Origins, Ray, Segment, numbers};

/// A round net of 2 n² triangles around `centre`.
fn ball(centre: DVec3, radius: f64, n: usize) -> Vec<[DVec3; 3]> {
    let point = |i: usize, j: usize| {
        let (sin, cos) = (std::f64::consts::PI * i as f64 / n as f64).sin_cos();
        let (y, x) = (std::f64::consts::TAU * j as f64 / n as f64).sin_cos();
        centre + radius * DVec3::new(sin * x, sin * y, cos)
    };
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    squares
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[x, y]| point(i + x, j + y));
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A planet with two statues, and a distant moon with one.
fn planets() -> Vec<[DVec3; 3]> {
    let mut all = ball(DVec3::ZERO, 6.4e6, 40);
    all.extend(ball(DVec3::new(0.0, 0.0, 6.4e6 + 1.0), 1.0, 60));
    all.extend(ball(DVec3::new(6.4e6 + 2.0, 0.0, 0.0), 1.0, 60));
    let moon = DVec3::new(0.0, 3.8e12, 0.0);
    all.extend(ball(moon, 1.7e6, 40));
    all.extend(ball(moon - DVec3::Y * 1.700002e6, 1.5, 50));
    all
}

fn all(triangles: &[[DVec3; 3]]) -> Vec<u32> {
    (0..triangles.len() as u32).collect()
}

#[test]
fn statues_on_planets_have_trees_of_their_own() {
    let triangles = planets();
    let sets = islands(&triangles, all(&triangles));
    // Relative to the distance of the moon, both bodies are fine, too.
    let sizes: Vec<f64> = sets.iter().map(|set| set.bounds.half()).collect();
    assert_eq!(sets.len(), 5, "{sizes:?}");
    for (set, half) in sets.iter().zip(&sizes) {
        let is_fine = |id: &&u32| Bounds::of(&triangles[**id as usize]).half() < FINE * half;
        assert!(set.ids.iter().filter(is_fine).count() < FEW, "{half}");
    }
    let mut every: Vec<u32> = sets.into_iter().flat_map(|set| set.ids).collect();
    every.sort_unstable();
    assert_eq!(every, all(&triangles));
}

#[test]
fn geometry_of_one_scale_is_one_set_in_the_order_given() {
    let mut next = numbers(4);
    let mut vector = || DVec3::new(next(), next(), next());
    // Statues; dust without gaps; a few grains on a floor.
    let dust = (0..5000).map(|_| {
        let at = vector();
        [0, 1, 2].map(|_| at + 1e-9 * vector())
    });
    let dust: Vec<_> = dust.collect();
    let floor = [DVec3::ZERO, DVec3::X * 1e6, DVec3::Y * 1e6];
    let mut grains = vec![floor];
    grains.extend(ball(DVec3::ONE, 1e-3, 10));
    for triangles in [ball(DVec3::ONE, 3.0, 40), dust, grains] {
        let sets = islands(&triangles, all(&triangles));
        assert_eq!(sets.len(), 1);
        assert_eq!(sets[0].ids, all(&triangles));
    }
    assert!(islands(&[], Vec::new()).is_empty());
}

#[test]
fn there_are_no_more_trees_than_are_allowed() {
    let statues = (0..200u32).flat_map(|k| ball(DVec3::X * f64::from(k * k) * 1e7, 1.0, 12));
    let triangles: Vec<_> = statues.collect();
    let sets = islands(&triangles, all(&triangles));
    assert!((10..=MOST).contains(&sets.len()), "{}", sets.len());
    assert_eq!(
        sets.iter().map(|set| set.ids.len()).sum::<usize>(),
        triangles.len()
    );
}

#[test]
fn rays_find_in_many_trees_what_tests_of_all_triangles_find() {
    let triangles = planets();
    let bvh = Bvh::build(triangles.clone(), |_| Facing::TwoSided);
    assert_eq!(bvh.trees().count(), 5);
    let mut next = numbers(6);
    let mut vector = || DVec3::new(next(), next(), next());
    // From near each statue to points on it, beside it, and to the other bodies.
    let places = [
        DVec3::new(0.0, 0.0, 6.4e6 + 1.0),
        DVec3::new(6.4e6 + 2.0, 0.0, 0.0),
        DVec3::new(0.0, 3.8e12 - 1.700002e6, 0.0),
    ];
    let rays: Vec<(DVec3, DVec3)> = (0..300)
        .map(|k| {
            let from = places[k % 3] + 5.0 * vector();
            let to = match k % 4 {
                0 => places[(k + 1) % 3] + vector(),
                _ => places[k % 3] + 1.2 * vector(),
            };
            (from, to - from)
        })
        .collect();
    let (origins, directions): (Vec<_>, Vec<_>) = rays.iter().copied().unzip();
    // The nearest hit among all triangles, each in its own tree.
    let single: Vec<Bvh> = triangles
        .iter()
        .map(|&triangle| Bvh::build(vec![triangle], |_| Facing::TwoSided))
        .collect();
    let expected: Vec<Option<(u32, f64)>> = rays
        .iter()
        .map(|&(origin, direction)| {
            let ray = Ray {
                origin,
                direction,
                s_min: 0.0,
            };
            let hits = (0..).zip(&single).filter_map(|(id, tree)| {
                let hit = tree.closest(&ray, f64::INFINITY)?;
                Some((id, hit.s))
            });
            // Of equal hits, the first has the smallest id.
            hits.min_by(|x, y| x.1.total_cmp(&y.1))
        })
        .collect();
    assert!(expected.iter().flatten().count() > 150);
    for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
        let method = Traversal {
            kernel,
            precision: Precision::Certified,
        };
        let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
        let mut told = vec![false; rays.len()];
        let from = Origins::Each(&origins);
        let mut replaced = Vec::new();
        bvh.closest_by(
            method,
            from,
            &directions,
            &mut hits,
            None,
            Some(&mut replaced),
        );
        replaced.into_iter().for_each(|ray: usize| told[ray] = true);
        for (ray, hit) in hits.iter().enumerate() {
            let found = hit.map(|hit| (hit.triangle, hit.s));
            assert_eq!(found, expected[ray], "{kernel:?}, ray {ray}");
            assert_eq!(told[ray], hit.is_some());
            let one = Ray {
                origin: origins[ray],
                direction: directions[ray],
                s_min: 0.0,
            };
            assert_eq!(bvh.closest(&one, f64::INFINITY), *hit);
            // The slot holds the triangle that was hit.
            if let Some(hit) = hit {
                assert_eq!(bvh.corners(hit.slot), triangles[hit.triangle as usize]);
            }
        }
        // Segments up to just before the hit, and just beyond it.
        for (factor, is_beyond) in [(0.999, false), (1.001, true)] {
            let segments: Vec<Segment> = (0..rays.len())
                .map(|ray| Segment {
                    ray: Ray {
                        origin: origins[ray],
                        direction: directions[ray],
                        s_min: 0.0,
                    },
                    s_max: expected[ray].map_or(1e9, |(_, s)| factor * s),
                    skip: None,
                    end: None,
                })
                .collect();
            let mut blocked = vec![false; rays.len()];
            bvh.any_by(method, &segments, &mut blocked, None);
            for (ray, &blocked) in blocked.iter().enumerate() {
                assert_eq!(blocked, is_beyond && expected[ray].is_some(), "ray {ray}");
            }
        }
    }
}

#[test]
fn of_equal_hits_in_two_trees_the_smaller_id_wins() {
    // A square of many triangles in the plane of a very large one, before and after it.
    let large = [DVec3::ZERO, DVec3::X * 1e8, DVec3::Y * 1e8];
    let corner = |i: usize, j: usize| DVec3::new(1.0 + i as f64, 1.0 + j as f64, 0.0);
    let square: Vec<_> = (0..400)
        .map(|k| {
            let (i, j) = (k % 20, k / 20);
            [corner(i, j), corner(i + 1, j), corner(i, j + 1)]
        })
        .collect();
    let orders = [
        [vec![large], square.clone()].concat(),
        [square, vec![large]].concat(),
    ];
    for triangles in orders {
        let bvh = Bvh::build(triangles, |_| Facing::TwoSided);
        assert_eq!(bvh.trees().count(), 2);
        let ray = Ray {
            origin: DVec3::new(1.25, 1.25, 3.0),
            direction: -DVec3::Z,
            s_min: 0.0,
        };
        let hit = bvh.closest(&ray, f64::INFINITY);
        assert_eq!(hit.map(|hit| (hit.triangle, hit.s)), Some((0, 3.0)));
        for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
            let method = Traversal {
                kernel,
                precision: Precision::Certified,
            };
            let (mut hits, from) = ([None], Origins::Shared(ray.origin));
            bvh.closest_by(method, from, &[ray.direction], &mut hits, None, None);
            assert_eq!(hits[0], hit, "{kernel:?}");
        }
    }
}

#[test]
fn a_statue_on_a_planet_takes_no_more_tests_than_it_takes_alone() {
    let statue = ball(DVec3::ZERO, 1.0, 100);
    let planet = ball(DVec3::Z * -6.4e6, 6.4e6 - 1.0, 40);
    let with_planet = [planet, statue.clone()].concat();
    let directions: Vec<DVec3> = (0..256)
        .map(|at| {
            let pixel = |i: usize| (i as f64 + 0.5) / 16.0 - 0.5;
            DVec3::new(pixel(at % 16), pixel(at / 16), -1.0)
        })
        .collect();
    let work = |triangles: Vec<[DVec3; 3]>| {
        let bvh = Bvh::build(triangles, |_| Facing::TwoSided);
        let mut counts = Counts::default();
        let mut hits = vec![None; directions.len()];
        let method = Traversal::default();
        let from = Origins::Shared(DVec3::Z * 3.0);
        bvh.closest_by(
            method,
            from,
            &directions,
            &mut hits,
            Some(&mut counts),
            None,
        );
        counts.triangles
    };
    let [alone, together] = [statue, with_planet].map(work);
    assert!(together < alone + alone / 2 + 256, "{alone}, {together}");
}
