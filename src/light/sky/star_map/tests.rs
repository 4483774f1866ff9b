//! Stars against sums over all of them.

use super::super::levels::Family;
use super::super::star::Motion;
use super::*;
use crate::spacetime::{Boost, CameraFrame, Direction, Velocity, World};

/// What is seen along each of `directions`, for pixels of these widths there.
fn seen(
    map: &StarMap,
    directions: &[DVec3],
    pixels: &[f64],
    light: impl Fn(&Star) -> [f64; 3],
) -> Vec<[f64; 3]> {
    let mut columns = Columns::default();
    directions.iter().for_each(|d| columns.push(*d));
    let ratios: Vec<_> = pixels.iter().map(|pixel| 1.0 / pixel).collect();
    let angles = PixelAngles {
        angle: 0.0,
        pixel: 1.0,
        ratios: &ratios,
        beaming: Beaming::REST,
        power: 0,
        motions: &[],
    };
    let mut seen = vec![[0.0; 3]; directions.len()];
    map.each_seen(
        &columns,
        angles,
        |_, star| light(star),
        |k, light| {
            seen[k] = light;
        },
    );
    seen
}

/// The same for one direction, with discs of this sin R.
fn widened(map: &StarMap, d: DVec3, reach: f64, light: impl Fn(&Star) -> [f64; 3]) -> [f64; 3] {
    let pixel = (reach * reach + LESS * map.sine * map.sine).sqrt() / REACH;
    seen(map, &[d], &[pixel], light)[0]
}

#[test]
fn directions_see_the_stars_in_whose_discs_they_lie_alone_and_in_blocks() {
    let mut next = numbers(3);
    let mut vector = || DVec3::new(next(), next(), next()).normalize();
    let stars: Vec<_> = (0..3000)
        .map(|_| Star::new(vector(), 5000.0, 1.0))
        .collect();
    // As small as discs may be, and as wide as some pixels.
    for radius in [1e-9, 7e-4, 0.03] {
        let map = StarMap::new(stars.clone(), radius);
        // Rows of a picture, some with a star in them, and directions all over the sky.
        let directions: Vec<_> = (0..5000)
            .map(|k| match k / 64 % 3 {
                0 => (stars[k % 3000].direction + vector() * radius).normalize(),
                1 => vector(),
                _ => {
                    let star = stars[k / 64].direction;
                    let side = star.any_orthonormal_vector();
                    (star + side * (k % 64) as f64 * radius / 40.0).normalize()
                }
            })
            .collect();
        let together = seen(&map, &directions, &vec![1e-12; 5000], |_| [1.0; 3]);
        let mut lit = 0;
        for (d, together) in directions.iter().zip(together) {
            let within = stars.iter().filter(|s| map.disc.around(s.direction, *d));
            let expected = within.count() as f64 * map.density;
            assert!(
                (together[0] - expected).abs() <= 1e-12 * expected,
                "{radius} {d}"
            );
            assert_eq!(together, map.radiance(*d, |_| [1.0; 3]), "{radius} {d}");
            lit += usize::from(expected > 0.0);
        }
        assert!(radius < 1e-6 || lit > 1000, "{lit}");
    }
}

#[test]
fn a_disc_that_ends_before_the_edge_of_a_cell_is_found_beyond_it() {
    const RADIUS: f64 = 3e-7;
    // On the face z = 1, where x = 0 is an edge between cells: directions just before it, each with a star whose disc ends just beyond
    // the direction. Near x = 0 an angle is du / √(1 + y²).
    let places = (0..2000).map(|k| {
        let (before, y) = (
            (f64::from(k) + 0.5) / 2000.0 * 4e-8,
            0.3 + f64::from(k) * 1e-4,
        );
        let along = |x: f64| DVec3::new(-x, y, 1.0).normalize();
        let star = along(before + 0.98 * RADIUS * (1.0 + y * y).sqrt());
        (along(before), Star::new(star, 5000.0, 1.0))
    });
    let (directions, stars): (Vec<_>, Vec<_>) = places.unzip();
    let map = StarMap::new(stars, RADIUS);
    for d in directions {
        assert!(map.radiance(d, |_| [1.0; 3]) != [0.0; 3], "{d}");
    }
}

#[test]
fn every_direction_finds_the_stars_that_it_lies_in() {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut vector = || DVec3::new(next(), next(), next()).normalize();
    let stars: Vec<_> = (0..400).map(|_| Star::new(vector(), 5000.0, 1.0)).collect();
    for radius in [1e-4, 0.01, 0.087] {
        let map = StarMap::new(stars.clone(), radius);
        for k in 0..4000 {
            let near = stars[k % stars.len()].direction;
            let d = (near + vector() * (radius * 1.2)).normalize();
            let lies_in = |s: &&Star| d.dot(s.direction) > libm::cos(radius);
            let count = stars.iter().filter(lies_in).count() as f64;
            let found = map.radiance(d, |_| [0.0, 1.0, 0.0])[1] / map.density;
            assert!(
                (found - count).abs() < 1e-9,
                "{radius} {d}: {found} {count}"
            );
        }
    }
}

/// Numbers from −1 to 1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Directions within some distance of −Z in the plane at distance one, and within a cap of the same size.
fn cap(count: usize, half: f64, seed: u64) -> Vec<DVec3> {
    let mut next = numbers(seed);
    let direction = |_| DVec3::new(half * next(), half * next(), -1.0).normalize();
    (0..count).map(direction).collect()
}

fn stars_at(directions: &[DVec3], seed: u64) -> Vec<Star> {
    let mut next = numbers(seed);
    let star = |d: &DVec3| {
        let (kelvin, magnitude) = (3000.0 * 4f64.powf(next().abs()), 2.5 * next());
        Star::new(*d, kelvin, 10f64.powf(-0.4 * magnitude))
    };
    directions.iter().map(star).collect()
}

/// L/E as given at the head of this file.
fn density(sine: f64, reach: f64, d: DVec3, middle: DVec3) -> f64 {
    let s = d.cross(middle).length_squared() / (reach * reach);
    let q = (sine / reach).powi(2);
    match d.dot(middle) > 0.0 && s < 1.0 {
        true => {
            let fall = 5.0 * (1.0 - q * q) * (1.0 - s).powi(4) + q * q;
            fall / (std::f64::consts::PI * reach * reach)
        }
        false => 0.0,
    }
}

/// Sums over pixel centres are within 0.4 % of the integral: the contribution of the second ring of harmonics at the first one's zero.
#[test]
fn pixel_centres_keep_the_light_of_a_star_wherever_it_lies_among_them() {
    const PIXEL: f64 = 1e-3;
    for radius in [1e-7, 1e-4] {
        for k in 0..144 {
            let at = |k: usize| (k as f64 / 12.0 + 0.3) * PIXEL;
            let star = DVec3::new(at(k % 12), at(k / 12), -1.0).normalize();
            let map = StarMap::new(vec![Star::new(star, 5000.0, 2.0)], radius);
            let centres = (0..100).map(|n| {
                let at = |n: i32| f64::from(n - 5) * PIXEL;
                DVec3::new(at(n % 10), at(n / 10), -1.0).normalize()
            });
            let centres: Vec<_> = centres.collect();
            let seen = seen(&map, &centres, &[PIXEL; 100], |star| [star.luminance(); 3]);
            let light = seen.iter().map(|seen| seen[0]).sum::<f64>() * PIXEL * PIXEL;
            assert!((light / 2.0 - 1.0).abs() < 4e-3, "{radius} {k}: {light}");
        }
    }
}

/// At a width of 1.2 pixels: sin² R = 1.96 a² − 0.36 sin² ρ = sin² ρ.
#[test]
fn wide_discs_are_as_they_were_and_become_wider_without_a_step() {
    const RADIUS: f64 = 1e-3;
    let map = StarMap::new(vec![Star::new(DVec3::NEG_Z, 5000.0, 1.0)], RADIUS);
    let edge = RADIUS.sin() * 1.36f64.sqrt() / 1.4;
    let expected = 1.0 / (std::f64::consts::PI * RADIUS.sin().powi(2));
    for part in [0.0, 0.3, 0.9, 0.99999, 1.00001] {
        let d = DVec3::new(
            part * RADIUS.sin(),
            0.0,
            -(1.0 - (part * RADIUS.sin()).powi(2)).sqrt(),
        );
        let at = |pixel| seen(&map, &[d], &[pixel], |star| [star.luminance(); 3])[0][0];
        // The same bits up to there, and only a little less beyond.
        let (narrow, wide) = (at(edge * (1.0 - 1e-9)), at(edge * (1.0 + 1e-9)));
        assert_eq!(narrow, at(1e-12));
        assert!((narrow - if part < 1.0 { expected } else { 0.0 }).abs() < 1e-6 * expected);
        assert!(
            (wide - narrow).abs() < 1e-6 * expected,
            "{part}: {narrow} {wide}"
        );
        assert!(at(edge * 1.1) > 0.0);
    }
}

#[test]
fn levels_meet_without_a_step_and_find_all_that_they_hold() {
    let stars = stars_at(&cap(20_000, 0.6, 5), 6);
    let map = StarMap::new(stars, 1e-6);
    let light = |star: &Star| star.colour(0.7);
    let mut merged = 0;
    for number in 0..map.levels.len() {
        let bound = map.reach_of(number);
        assert_eq!(map.level_of(bound), number);
        assert_eq!(map.level_of(0.501 * bound), number);
        let level = map.level(number);
        merged += level.members.len();
        // The sum over all places on their way, without using the lists.
        let reach = 0.8 * bound;
        let profile = |d: DVec3, middle: DVec3| density(map.sine, reach, d, middle);
        let all = level.families.iter().flat_map(
            |Family {
                 merged, members, ..
             }| {
                let members = &level.members[members.start as usize..members.end as usize];
                let moved = members.iter().map(|m| {
                    let between = m.direction.lerp(merged.direction, 0.6);
                    (between.normalize(), m.parts.clone())
                });
                let itself = (merged.direction, merged.parts.clone());
                moved.chain(members.is_empty().then_some(itself))
            },
        );
        let all: Vec<_> = all.collect();
        for d in cap(150, 1.5, number as u64) {
            let found = widened(&map, d, reach, |star| [star.luminance(); 3])[0];
            let mut expected = 0.0;
            for (place, parts) in &all {
                let density = profile(d, *place);
                let parts = &level.parts[parts.start as usize..parts.end as usize];
                expected += density * parts.iter().map(|part| part.luminance).sum::<f64>();
            }
            assert!(
                (found - expected).abs() <= 1e-9 * expected,
                "{number} {d}: {found} {expected}"
            );
            // The end of this level, and the start of the next.
            if number + 1 < map.levels.len() {
                let (last, first) = (
                    widened(&map, d, bound, light),
                    widened(&map, d, bound * (1.0 + 1e-12), light),
                );
                for (last, first) in last.iter().zip(first) {
                    assert!(
                        (last - first).abs() <= 1e-6 * last.abs(),
                        "{number} {d}: {last} {first}"
                    );
                }
            }
        }
    }
    assert!(merged > 20_000, "{merged}");
}

#[test]
fn merged_stars_shine_as_all_of_them() {
    let stars = stars_at(&cap(40_000, 1.0, 7), 8);
    let map = StarMap::new(stars.clone(), 1e-6);
    for w in [0.02, 0.3, 1.0] {
        for reach in [0.02, 0.11, 0.3] {
            let profile = |d: DVec3, middle: DVec3| density(map.sine, reach, d, middle);
            let (mut off, mut more, mut whole) = (0.0, 0.0, 0.0);
            for d in cap(300, 0.4, 9) {
                let found = widened(&map, d, reach, |star| star.colour(w));
                let mut expected = [0.0; 3];
                for star in &stars {
                    let density = profile(d, star.direction);
                    if density > 0.0 {
                        for (sum, e) in expected.iter_mut().zip(star.colour(w)) {
                            *sum += e * density;
                        }
                    }
                }
                for (found, expected) in found.iter().zip(expected) {
                    off += (found - expected).abs();
                    more += found - expected;
                    whole += expected;
                }
            }
            // Merging within a square makes most of that; the total light is conserved.
            assert!(off < 0.05 * whole, "{w} {reach}: {off} of {whole}");
            assert!(more.abs() < 0.01 * whole, "{w} {reach}: {more} of {whole}");
        }
    }
    // However many stars there are: 6 · 16² squares of the last level, each of at most 15 steps from 3000 to 12000 K.
    let last = map.level(map.levels.len() - 1);
    assert!(last.families.len() <= 6 * 256, "{}", last.families.len());
    for Family { merged, .. } in &last.families {
        assert!(merged.parts.len() <= 15, "{}", merged.parts.len());
    }
}

/// Blocks in which W changes by little and by much, within one level and across several.
#[test]
fn directions_see_the_same_in_blocks_as_alone_in_pixels_of_any_width() {
    let stars = stars_at(&cap(3000, 1.0, 11), 12);
    let map = StarMap::new(stars, 1e-4);
    let scattered = cap(2000, 1.0, 13);
    let rows = (0..2000).map(|k| {
        let (x, y) = (f64::from(k % 64), f64::from(k / 64));
        DVec3::new(0.003 * (x - 20.0), 0.003 * (y - 10.0), -1.0).normalize()
    });
    for directions in [scattered, rows.collect()] {
        for growth in [1.0, 1.0 + 1e-5, 1.005] {
            let pixel = |k: usize| 0.004 * f64::powi(growth, k as i32 - 1000);
            let pixels: Vec<_> = (0..directions.len()).map(pixel).collect();
            let colour = |star: &Star| star.colour(0.8);
            let together = seen(&map, &directions, &pixels, colour);
            let mut lit = 0;
            for ((d, pixel), together) in directions.iter().zip(&pixels).zip(together) {
                assert_eq!(
                    seen(&map, &[*d], &[*pixel], colour)[0],
                    together,
                    "{d} {pixel}"
                );
                lit += usize::from(together != [0.0; 3]);
            }
            assert!(lit > 50, "{growth}: {lit}");
        }
    }
}

/// The radiance that a camera sees along directions of its own frame, of channels if `channels`, and otherwise of blackbodies.
fn seen_from(
    map: &StarMap,
    camera: &Boost<World, CameraFrame>,
    own: &[DVec3],
    pixel: f64,
    channels: bool,
) -> Vec<f64> {
    let looks = own
        .iter()
        .map(|d| camera.direction(Direction::from_unit(*d)));
    let (directions, ratios): (Vec<_>, Vec<_>) = looks.map(|(d, w)| (d.unit(), w)).unzip();
    let mut columns = Columns::default();
    columns.take(&directions);
    let angles = PixelAngles {
        angle: 0.0,
        pixel,
        ratios: &ratios,
        beaming: Beaming {
            motion: Motion::of(camera),
            power: if channels { 2 } else { -2 },
            channels,
            shifted: true,
        },
        power: 0,
        motions: &[],
    };
    let light = |k: usize, star: &Star| match channels {
        true => star.channels(),
        false => star.colour(ratios[k]),
    };
    let mut seen = vec![0.0; own.len()];
    map.each_seen(&columns, angles, light, |k, [r, _, _]| {
        seen[k] = r * if channels { ratios[k].powi(-4) } else { 1.0 };
    });
    seen
}

/// Against the sum over all stars in the camera's frame: of the aberrated direction of each, its light W² Ω B(λ; T/W) or W⁻² times its
/// channels, and the profile around it.
#[test]
fn pixels_of_any_width_see_all_stars_where_they_are_at_any_speed() {
    let mut next = numbers(21);
    let vectors: Vec<_> = (0..3000)
        .map(|_| DVec3::new(next(), next(), next()).normalize())
        .collect();
    let stars = stars_at(&vectors, 22);
    let map = StarMap::new(stars.clone(), 1e-5);
    // Near the equator, where the pixels of the panorama are square.
    let ahead = DVec3::new(0.6, 0.02, -0.8).normalize();
    let side = ahead.any_orthonormal_vector();
    for gamma in [1.0, 3.0, 10.0, 30.0, 100.0, 1e3, 1e5] {
        let velocity = Velocity::from_gamma(gamma, ahead).unwrap();
        let camera = Boost::<World, CameraFrame>::new(velocity);
        for (degrees, channels) in [0.1f64, 1.0, 5.0]
            .into_iter()
            .flat_map(|degrees| [(degrees, true), (degrees, false)])
        {
            let pixel = degrees.to_radians();
            let images = stars.iter().map(|star| {
                let d = Direction::from_unit(star.direction);
                let (d, inverse) = camera.inverse().direction(d);
                let w = 1.0 / inverse;
                let light = match channels {
                    true => star.channels()[0] / (w * w),
                    false => star.colour(w)[0] * (w * w),
                };
                (d.unit(), light)
            });
            let images: Vec<_> = images.collect();
            // Pixels about the direction of motion, and at 5° all around, which see all light.
            let own: Vec<_> = match degrees {
                5.0 => (0..72 * 36)
                    .map(|k| {
                        let (at, up) = (f64::from(k % 72) + 0.5, f64::from(k / 72) + 0.5);
                        let ((s, c), (sin, cos)) = ((at * pixel).sin_cos(), (up * pixel).sin_cos());
                        DVec3::new(s * sin, cos, c * sin)
                    })
                    .collect(),
                _ => (0..600)
                    .map(|k| {
                        let at = |n: i32| (f64::from(n) - 11.3) * pixel;
                        let across = side * at(k % 24) + ahead.cross(side) * at(k / 24);
                        (ahead + across).normalize()
                    })
                    .collect(),
            };
            let seen = seen_from(&map, &camera, &own, pixel, channels);
            let reach = REACH * pixel;
            let (mut off, mut more, mut all, mut light) = (0.0, 0.0, 0.0, 0.0);
            for (d, seen) in own.iter().zip(seen) {
                let sum =
                    |sum, (s, light): &(DVec3, f64)| sum + light * density(map.sine, reach, *d, *s);
                let expected = images.iter().fold(0.0, sum);
                (off, more) = (off + (seen - expected).abs(), more + seen - expected);
                all += expected;
                light += seen * pixel * (0.5 * pixel).sin() * 2.0 * d.x.hypot(d.z);
            }
            let case = format!("{gamma} {degrees} {channels}");
            assert!(off < 0.1 * all, "{case}: {off} of {all}");
            assert!(more.abs() < 0.01 * all, "{case}: {more} of {all}");
            if degrees == 5.0 {
                let whole: f64 = images.iter().map(|(_, light)| light).sum();
                assert!(
                    (light / whole - 1.0).abs() < 0.01,
                    "{case}: {light} of {whole}"
                );
            }
        }
    }
}

#[test]
fn a_map_takes_no_more_bytes_than_foretold_once_all_of_its_levels_are_built() {
    fn size<T>(list: &[T]) -> u64 {
        size_of_val(list) as u64
    }
    for count in [1, 5000, 500_000] {
        let mut next = numbers(31);
        let mut vector = |_| DVec3::new(next(), next(), next()).normalize();
        let directions: Vec<_> = (0..count).map(&mut vector).collect();
        let map = StarMap::new(stars_at(&directions, 32), 1e-6);
        let levels = (0..map.levels.len()).map(|number| map.level(number));
        let of_levels = levels.map(|level| {
            let own = size(&level.families) + size(&level.members) + size(&level.parts);
            own + size(&level.finer) + level.index.bytes()
        });
        let all = size(&map.stars) + map.discs.bytes() + of_levels.sum::<u64>();
        let most = StarMap::bytes(count);
        assert!(all <= most, "{count}: {all} of {most}");
        assert!(count < 5000 || most < 2 * all, "{count}: {all} of {most}");
    }
}
