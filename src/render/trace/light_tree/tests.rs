//! Trees compared with sums over all triangles, and light sampled by them compared with closed forms.

use std::f64::consts::PI;

use super::*;
use crate::accel::numbers;
use crate::accel::vectors::{VectorLoop, dispatch};

fn random(next: &mut impl FnMut() -> f64) -> DVec3 {
    DVec3::new(next(), next(), next())
}

fn shining(corners: [DVec3; 3], brightness: f64, two_sided: bool) -> Shining {
    Shining {
        triangle: Triangle::new(corners),
        brightness,
        two_sided,
    }
}

/// Random triangles of all sizes and radiances, one- and two-sided.
fn soup(count: usize, next: &mut impl FnMut() -> f64) -> Vec<Shining> {
    let triangle = |k: usize| {
        let (middle, size) = (random(next), 0.02 + 0.3 * next().powi(4));
        let corners = [(); 3].map(|()| middle + random(next) * size);
        shining(corners, 1.5 + next(), k.is_multiple_of(3))
    };
    (0..count).map(triangle).collect()
}

/// A ball of radius 1 about the origin that shines outwards, made of 8 · 4ⁿ triangles.
fn ball(halvings: usize) -> Vec<Shining> {
    let mut all = Vec::new();
    for signs in 0..8 {
        let sign = |axis: usize| if signs >> axis & 1 == 0 { 1.0 } else { -1.0 };
        let [a, b, c] = [DVec3::X * sign(0), DVec3::Y * sign(1), DVec3::Z * sign(2)];
        all.push(if a.cross(b).dot(c) > 0.0 {
            [a, b, c]
        } else {
            [a, c, b]
        });
    }
    for _ in 0..halvings {
        let parts = all.iter().flat_map(|[a, b, c]| {
            let [p, q, r] = [a + b, b + c, c + a].map(DVec3::normalize);
            [[*a, p, r], [p, *b, q], [r, q, *c], [p, q, r]]
        });
        all = parts.collect();
    }
    all.into_iter()
        .map(|corners| shining(corners, 1.0, false))
        .collect()
}

/// A square panel of this width, made of 2 · n² triangles at height 0, that shines down.
fn panel(n: usize, width: f64, two_sided: bool) -> Vec<Shining> {
    let at = |i: usize, k: usize| {
        let [x, z] = [i, k].map(|k| width * (k as f64 / n as f64 - 0.5));
        DVec3::new(x, 0.0, z)
    };
    let cells = (0..n * n).map(|cell| (cell % n, cell / n));
    let all = cells.flat_map(|(i, k)| {
        let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
        [[a, b, c], [a, c, d]].map(|corners| shining(corners, 1.0, two_sided))
    });
    all.collect()
}

fn receiver(x: DVec3, normal: DVec3) -> Receiver {
    Receiver {
        x,
        normal: normal.normalize(),
        tilt: 0.0,
    }
}

/// A receiver in any frame: N is a spacelike unit vector for any boost.
fn anywhere(next: &mut impl FnMut() -> f64) -> Receiver {
    let rapidity = 3.0 * next();
    // Every third is at rest.
    let tilt = if rapidity.abs() < 1.0 {
        0.0
    } else {
        libm::sinh(rapidity)
    };
    let normal = random(next).normalize() * (1.0 + tilt * tilt).sqrt();
    let x = 1.5 * random(next);
    Receiver { x, normal, tilt }
}

/// N·k for the direction to y; 0 from the side that does not shine.
fn cosine(receiver: &Receiver, shining: &Shining, y: DVec3) -> f64 {
    let l = (y - receiver.x).normalize();
    let faces = shining.two_sided || shining.triangle.normal.dot(l) < 0.0;
    if faces {
        (receiver.tilt + receiver.normal.dot(l)).max(0.0)
    } else {
        0.0
    }
}

#[test]
fn every_triangle_from_which_light_can_come_has_a_share_and_shares_are_those_of_draws() {
    let mut next = numbers(11);
    for count in [1, 2, 3, 7, 60, 400] {
        let tree = LightTree::new(soup(count, &mut next));
        for _ in 0..12 {
            let receiver = anywhere(&mut next);
            let shares: Vec<f64> = (0..count as u32)
                .map(|k| tree.share(k, &receiver))
                .collect();
            // Probability is lost if a node has an importance and its children have none: what is missing from a sum of 1.
            let sum: f64 = shares.iter().sum();
            assert!((0.0..1.0 + 1e-12).contains(&sum), "{sum}");
            for (k, share) in shares.iter().enumerate() {
                let shining = tree.shining(k as u32);
                for _ in 0..20 {
                    let place = Triangle::draw_by_area([next().abs(), next().abs()]);
                    let y = shining.triangle.at(place);
                    let cosine = cosine(&receiver, shining, y);
                    assert!(*share > 0.0 || cosine == 0.0, "{k} of {count}: {cosine}");
                }
            }
            let draws = 4000;
            let mut drawn = vec![0.0; count];
            for i in 0..draws {
                let number = (i as f64 + 0.5) / f64::from(draws);
                let choice = tree.choose(&receiver, number);
                let k = choice.triangle as usize;
                assert!((0.0..=1.0).contains(&choice.number));
                if choice.share > 0.0 {
                    assert!((choice.share - shares[k]).abs() <= 1e-12 * shares[k]);
                    drawn[k] += 1.0 / f64::from(draws);
                }
            }
            // The numbers that choose one triangle form an interval.
            for (drawn, share) in drawn.iter().zip(&shares) {
                let off = (drawn - share).abs();
                assert!(off < 1.01 / f64::from(draws), "{drawn} {share}");
            }
        }
    }
}

#[test]
fn the_tree_of_a_ball_loses_little_and_finds_what_is_seen() {
    // Seen from near its surface, most of a ball of many triangles is hidden by the ball itself.
    let tree = LightTree::new(ball(3));
    let receiver = receiver(DVec3::X * 1.1, -DVec3::X);
    let share = |k: u32| tree.share(k, &receiver);
    let all: f64 = (0..512).map(share).sum();
    assert!(all > 0.7, "{all}");
}

/// The importances and choices of a block in one call.
struct Both<'a>(
    &'a LightTree,
    &'a Receivers,
    &'a mut Block,
    &'a mut [u32; BLOCK],
    &'a mut [Block; 2],
);

impl VectorLoop for Both<'_> {
    #[inline(always)]
    fn run(self) {
        let Both(tree, receivers, numbers, triangles, [shares, asked]) = self;
        tree.choose_each(receivers, BLOCK, numbers, (triangles, shares));
        tree.shares(triangles[0], receivers, asked);
    }
}

#[test]
fn blocks_have_the_bits_of_single_points() {
    let mut next = numbers(12);
    for count in [1, 2, 5, 100] {
        let tree = LightTree::new(soup(count, &mut next));
        let all: [Receiver; BLOCK] = std::array::from_fn(|_| anywhere(&mut next));
        let mut block = Receivers {
            x: Vectors::ZERO,
            normal: Vectors::ZERO,
            tilt: all.map(|receiver| receiver.tilt),
        };
        for (k, receiver) in all.iter().enumerate() {
            block.x.set(k, receiver.x);
            block.normal.set(k, receiver.normal);
        }
        let first: Block = std::array::from_fn(|_| next().abs());
        let (mut numbers, mut triangles, mut shares) = (first, [0; BLOCK], [[0.0; BLOCK]; 2]);
        dispatch(Both(
            &tree,
            &block,
            &mut numbers,
            &mut triangles,
            &mut shares,
        ));
        for k in 0..BLOCK {
            let one = tree.choose(&all[k], first[k]);
            let of_block = (triangles[k], shares[0][k], numbers[k]);
            assert_eq!(of_block, (one.triangle, one.share, one.number));
            assert_eq!(shares[1][k], tree.share(triangles[0], &all[k]));
        }
    }
}

#[test]
fn densities_add_up_to_one_over_all_that_shines() {
    // ∫ p dA by the midpoint rule on 4096 parts of each triangle, p per area from cos θ/r² times p per solid angle.
    let mut next = numbers(13);
    let parts = 64;
    for (all, x) in [
        (panel(1, 1.0, false), DVec3::new(0.1, -0.3, 0.2)),
        (panel(3, 1.0, true), DVec3::new(0.4, 0.2, 0.1)),
        (ball(1), DVec3::new(0.3, 1.5, 0.2)),
        (ball(1), DVec3::new(30.0, 15.0, 2.0)),
    ] {
        let tree = LightTree::new(all);
        let receiver = receiver(x, -x + 0.3 * random(&mut next));
        let (mut sum, mut shares) = (0.0, 0.0);
        for (k, shining) in (0..).zip(&tree.all) {
            let share = tree.share(k, &receiver);
            let density = tree.density(k, share, x);
            let triangle = &shining.triangle;
            shares += share;
            if share == 0.0 {
                continue;
            }
            // Cells of a lattice of barycentrics are cut in two: one half is in the triangle for i + j < n, the other for i + j + 1 < n.
            for (cell, (half, third)) in
                (0..parts * parts).flat_map(|cell| [(0, 1.0), (1, 2.0)].map(|half| (cell, half)))
            {
                let (i, j) = (cell % parts, cell / parts);
                if i + j + half >= parts {
                    continue;
                }
                let [u, v] = [i, j].map(|k| (f64::from(k) + third / 3.0) / f64::from(parts));
                let way = triangle.at((u, v)) - x;
                let r2 = way.length_squared();
                let cosine = triangle.normal.dot(way).abs() / (triangle.twice * r2.sqrt());
                let per_area = density.per_solid_angle(r2, cosine) * cosine / r2;
                sum += per_area * triangle.area() / f64::from(parts * parts);
            }
        }
        assert!((sum - shares).abs() < 2e-3, "{sum} {shares}");
        assert!(shares > 0.8 && shares < 1.0 + 1e-12, "{shares}");
    }
}

/// The mean and the variance of single-sample estimates of the irradiance at `receiver`: sampled by the tree, or by power and area only.
fn drawn(tree: &LightTree, receiver: &Receiver, by_tree: bool) -> [f64; 2] {
    let power: f64 = tree
        .all
        .iter()
        .map(|s| s.triangle.area() * s.brightness)
        .sum();
    let count: i32 = 1 << 18;
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..count {
        // Hammersley points.
        let first = (f64::from(i) + 0.5) / f64::from(count);
        let second = f64::from((i as u32).reverse_bits()) / 2f64.powi(32);
        let (k, place, density) = if by_tree {
            let choice = tree.choose(receiver, first);
            let place = tree.draw(&choice, receiver.x, second);
            let density = tree.density(choice.triangle, choice.share, receiver.x);
            (choice.triangle, place, density)
        } else {
            let mut left = first * power;
            let of = |s: &Shining| s.triangle.area() * s.brightness;
            let k = tree.all.iter().position(|s| {
                left -= of(s);
                left < 0.0
            });
            let k = k.unwrap();
            let number = 1.0 + left / of(&tree.all[k]);
            let place = Triangle::draw_by_area([number, second]);
            (
                k as u32,
                place,
                Density::PerArea(tree.all[k].brightness / power),
            )
        };
        let shining = tree.shining(k);
        let y = shining.triangle.at(place);
        let (r2, cosine) = (
            (y - receiver.x).length_squared(),
            cosine(receiver, shining, y),
        );
        let there = shining
            .triangle
            .normal
            .dot((y - receiver.x).normalize())
            .abs();
        let density = density.per_solid_angle(r2, there / shining.triangle.twice);
        let light = if cosine > 0.0 && density > 0.0 {
            shining.brightness * cosine / density
        } else {
            0.0
        };
        sum += light;
        squares += light * light;
    }
    let mean = sum / f64::from(count);
    [mean, squares / f64::from(count) - mean * mean]
}

/// E under the centre of a square panel of width w at the distance h, with radiance 1: 4 times E of a quarter below its corner, by Lambert's
/// formula 2 a/√(1 + a²) arctan(a/√(1 + a²)), a = w/2h.
fn under_panel(width: f64, height: f64) -> f64 {
    let a = width / (2.0 * height);
    let root = (1.0 + a * a).sqrt();
    4.0 * a / root * libm::atan(a / root)
}

#[test]
fn light_of_a_close_panel_is_lamberts_with_little_noise() {
    for (n, part) in [(1, 0.05), (8, 0.03)] {
        for height in [0.05, 0.2] {
            let tree = LightTree::new(panel(n, 1.0, false));
            let below = receiver(-DVec3::Y * height, DVec3::Y);
            let expected = under_panel(1.0, height);
            let [mean, variance] = drawn(&tree, &below, true);
            assert!(
                (mean / expected - 1.0).abs() < 2e-3,
                "{n} {height}: {mean} {expected}"
            );
            let [by_power, most] = drawn(&tree, &below, false);
            assert!((by_power / expected - 1.0).abs() < 2e-2, "{by_power}");
            assert!(variance < part * most, "{n} {height}: {variance} of {most}");
            // It is dark behind the panel.
            let above = receiver(DVec3::Y * height, -DVec3::Y);
            assert_eq!(drawn(&tree, &above, true), [0.0, 0.0]);
        }
    }
}

#[test]
fn a_sheet_that_shines_on_both_sides_lights_both_alike() {
    let tree = LightTree::new(panel(4, 1.0, true));
    let expected = under_panel(1.0, 0.3);
    for side in [1.0, -1.0] {
        let point = receiver(DVec3::Y * (0.3 * side), -DVec3::Y * side);
        let [mean, _] = drawn(&tree, &point, true);
        assert!((mean / expected - 1.0).abs() < 2e-3, "{mean} {expected}");
    }
}

#[test]
fn light_of_a_ball_is_as_its_solid_angle_with_little_noise() {
    // E = π L R²/d² towards the centre. Chords of 8192 triangles are up to 5·10⁻⁴ inside the ball.
    let tree = LightTree::new(ball(5));
    for (distance, part) in [(1.05, 0.02), (1.5, 0.05), (4.0, 0.1)] {
        let point = receiver(
            DVec3::new(0.6, 0.64, 0.48) * distance,
            -DVec3::new(0.6, 0.64, 0.48),
        );
        let expected = PI / (distance * distance);
        let [mean, variance] = drawn(&tree, &point, true);
        assert!(
            (mean / expected - 1.0).abs() < 4e-3,
            "{distance}: {mean} {expected}"
        );
        let [_, most] = drawn(&tree, &point, false);
        assert!(variance < part * most, "{distance}: {variance} of {most}");
    }
}
