//! Light by the sky against plain sums over directions, texels and stars.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::super::{Panorama, Star, StarMap};
use super::*;
use crate::colour::{ColourTable, Continuation, RgbShift, Scale, Spectrum, blackbody_colour};
use crate::scene::model;
use crate::spacetime::{Quantity, Velocity};

fn uniform() -> Sky {
    Sky::new(
        &model::Sky {
            background: model::SkyRadiance::Uniform([1.0, 2.0, 0.5]),
            sun: None,
            stars: None,
            lights: true,
            shadows: true,
            span: 0..0,
        },
        None,
        Vec::new(),
        false,
    )
}

fn of(sky: &Sky, boost: &Boost<Rest, World>, received: Received) -> BoostedSky {
    BoostedSky::new(sky, &Arc::new(LightGrid::new(sky)), boost, received)
}

fn boost(beta: f64) -> Boost<Rest, World> {
    let rapidity = DVec3::new(2.0, -1.0, 0.5).normalize() * libm::atanh(beta);
    Boost::new(Velocity::from_rapidity(-rapidity).unwrap())
}

/// E_F of a uniform sky of radiance 1 as a plain sum over directions of the rest frame: L_F = (γ (1 + β c))⁴ with γ (1 + β c) = 1/(γ (1
/// − β c′)), in rings that get narrower towards c′ = 1.
fn expected(beta: f64, tilt: f64) -> f64 {
    let gamma = 1.0 / (1.0 - beta * beta).sqrt();
    let (n, m) = (6000, 720);
    let mut sum = 0.0;
    let below_one = |k: f64| 2.0 * libm::expm1(-12.0 * k / f64::from(n)) / libm::expm1(-12.0);
    for k in 0..n {
        let (less, more) = (f64::from(k), f64::from(k + 1));
        let from_one = below_one(f64::from(n)) - below_one(more);
        let width = below_one(more) - below_one(less);
        let from_one = from_one + 0.5 * width;
        let c = 1.0 - from_one;
        let doppler = 1.0 / (gamma * (1.0 - beta) + gamma * beta * from_one);
        let s = (from_one * (2.0 - from_one)).sqrt();
        let around = (0..m).map(|i| {
            let phi = TAU * (f64::from(i) + 0.5) / f64::from(m);
            (c * libm::cos(tilt) + s * libm::sin(tilt) * libm::cos(phi)).max(0.0)
        });
        let mean = around.sum::<f64>() / f64::from(m);
        sum += doppler.powi(4) * mean * TAU * width;
    }
    sum
}

/// The irradiance of a surface with normal `n` estimated from `count`² evenly distributed samples: their mean, and the largest one.
fn drawn(boosted: &BoostedSky, sky: &Sky, n: DVec3, count: usize) -> [f64; 2] {
    let (mut sum, mut most) = (0.0, 0.0f64);
    let at = |k: usize| (k as f64 + 0.5) / count as f64;
    for k in 0..count * count {
        if let Some(s) = boosted.sample(n, [at(k % count), at(k / count)]) {
            let radiance = boosted.mean_radiance(&s.of(sky, None))[1];
            let drawn = radiance * n.dot(s.in_rest) / s.density;
            sum += drawn;
            most = most.max(drawn);
        }
    }
    [sum / (count * count) as f64, most]
}

#[test]
fn a_uniform_sky_lights_a_moving_surface_by_the_law() {
    for beta in [0.0, 0.5, 0.9, 0.99, 0.999] {
        let boost = boost(beta);
        let sky = of(&uniform(), &boost, Received::Scaled(Quantity::Integrated));
        // The direction of motion of the frame, and one across.
        let along = DVec3::new(2.0, -1.0, 0.5).normalize();
        let across = along.any_orthonormal_vector();
        for tilt in [0.0, 0.4, 1.0, 1.4, FRAC_PI_2, 1.65, 2.0, 2.5, PI] {
            let n = along * libm::cos(tilt) + across * libm::sin(tilt);
            let [r, g, b] = sky.irradiance(n);
            let e = expected(beta, tilt);
            assert!((r - e).abs() < 2e-4 * e, "{beta} {tilt}: {r} {e}");
            assert!((g - 2.0 * r).abs() < 1e-12 * g && (b - 0.5 * r).abs() < 1e-12 * g);
        }
    }
}

/// A Planck sky of temperature T has T/W in each direction, for moving surfaces too: by the same plain sum, seen from behind, where it
/// is cold.
#[test]
fn a_sky_of_a_blackbody_lights_the_far_side_of_what_moves() {
    let shape = crate::colour::SpectrumShape::Blackbody(5000.0);
    let spectrum = Spectrum::new(shape, Scale::Factor(1.0)).unwrap();
    let sky = Sky {
        background: Background::Spectrum(ColourTable::new(&spectrum)),
        ..uniform()
    };
    let (beta, motion) = (0.8, DVec3::new(2.0, -1.0, 0.5).normalize());
    let received = Received::Rgb(RgbShift::of(Continuation::Blackbody));
    let lit = of(&sky, &boost(beta), received).irradiance(-motion);
    let (n, mut expected) = (20_000, [0.0; 3]);
    for k in 0..n {
        // c is the cosine to the normal, which points backwards.
        let c = (f64::from(k) + 0.5) / f64::from(n);
        let w = (1.0 + beta * c) / (1.0 - beta * beta).sqrt();
        let seen = blackbody_colour(5000.0 / w).map(|l| l * TAU * c / f64::from(n));
        expected = sum(expected, seen);
    }
    for (lit, expected) in lit.into_iter().zip(expected) {
        assert!((lit - expected).abs() < 2e-4 * expected, "{lit} {expected}");
    }
}

#[test]
fn normals_summed_together_have_the_sums_of_each() {
    let mut next = crate::accel::numbers(5);
    let mut vector = || DVec3::new(next(), next(), next());
    let beams: Vec<Beam> = (0..50)
        .map(|_| Beam {
            in_rest: vector(),
            flux: vector().to_array(),
        })
        .collect();
    for count in [1, TOGETHER - 1, TOGETHER] {
        let normals: Vec<DVec3> = (0..count).map(|_| vector().normalize()).collect();
        let mut sums = vec![[1.0; 3]; count];
        dispatch(Illumination {
            beams: &beams,
            normals: &normals,
            sums: &mut sums,
        });
        let alone = normals.iter().map(|n| {
            let mut sum = [0.0; 3];
            beams.iter().for_each(|beam| beam.add_to(&mut sum, *n));
            sum
        });
        assert_eq!(sums, alone.collect::<Vec<_>>());
    }
}

#[test]
fn drawn_directions_give_the_irradiance() {
    for beta in [0.0, 0.8] {
        let (sky, boost) = (uniform(), boost(beta));
        let boosted = of(&sky, &boost, Received::Scaled(Quantity::Integrated));
        for n in [DVec3::Y, DVec3::new(0.6, 0.0, -0.8)] {
            let ([mean, _], e) = (drawn(&boosted, &sky, n, 300), boosted.irradiance(n)[1]);
            assert!((mean - e).abs() < 5e-3 * e, "{beta} {n}: {mean} {e}");
        }
    }
}

/// Discs of stars are hit by only a few of a million directions, and are brighter than their surroundings by as much: no sum of a few
/// samples would have their light.
#[test]
fn stars_light_surfaces_without_noise() {
    let direction = |k: u32| {
        let height = 1.0 - (2.0 * f64::from(k) + 1.0) / 400.0;
        let (sine, cosine) = libm::sincos(2.4 * f64::from(k));
        let across = (1.0 - height * height).sqrt();
        DVec3::new(sine * across, height, cosine * across)
    };
    let stars: Vec<_> = (0..400)
        .map(|k| Star::new(direction(k), 4000.0, 1e-3))
        .collect();
    for is_thermal in [false, true] {
        let sky = Sky {
            background: Background::Uniform([0.0; 3]),
            sun: None,
            stars: Some(StarMap::new(stars.clone(), 1e-3)),
            thermal_stars: is_thermal,
        };
        for beta in [0.0, 0.8] {
            let received = match is_thermal {
                true => Received::Rgb(RgbShift::of(Continuation::Blackbody)),
                false => Received::Scaled(Quantity::Integrated),
            };
            let boosted = of(&sky, &boost(beta), received);
            let n = DVec3::new(0.6, 0.0, -0.8);
            // Not a multiple of the number of stars, whose blocks would be hit at their edges.
            let ([mean, most], e) = (drawn(&boosted, &sky, n, 463), boosted.irradiance(n)[1]);
            assert!(
                (mean - e).abs() < 0.03 * e,
                "{is_thermal} {beta}: {mean} {e}"
            );
            assert!(most < 100.0 * e, "{is_thermal} {beta}: {most} {e}");
        }
    }
}

/// A picture with a sun of 2 × 2 texels at several positions: by a plain sum over its texels, each with its own direction, W and solid
/// angle.
#[test]
fn a_small_sun_in_a_picture_lights_surfaces_from_where_it_is() {
    let width = 512;
    for (at, beta) in [
        ([40, 300], 0.0),
        ([41, 303], 0.0),
        ([77, 10], 0.6),
        ([120, 401], 0.9),
    ] {
        let [row, column]: [usize; 2] = at;
        let is_sun = |i: usize, j: usize| i.wrapping_sub(row) < 2 && j.wrapping_sub(column) < 2;
        let light = |i: usize, j: usize| if is_sun(i, j) { 5e4 } else { 1.0 };
        let places = || (0..width / 2).flat_map(move |i| (0..width).map(move |j| (i, j)));
        let texels = places().map(|(i, j)| [light(i, j) as f32; 3]).collect();
        let sky = Sky {
            background: Background::Image(Panorama::new(texels, width, [1.0; 3], 0.0)),
            ..uniform()
        };
        let boost = boost(beta);
        let boosted = of(&sky, &boost, Received::Scaled(Quantity::Integrated));
        let edge = |i: usize| libm::cos(PI * i as f64 / (width / 2) as f64);
        // n·d_F W⁻² L dω: the fourth power of 1/W, reduced to its square by dω_F.
        let expected = |n: DVec3| -> f64 {
            let of_texel = |(i, j): (usize, usize)| {
                let longitude = TAU * ((j as f64 + 0.5) / width as f64 - 0.5);
                let height = 0.5 * (edge(i) + edge(i + 1));
                let across = (1.0 - height * height).sqrt();
                let (sine, cosine) = libm::sincos(longitude);
                let d = DVec3::new(sine * across, height, -cosine * across);
                let (in_rest, rho) = boost.direction(Direction::from_unit(d));
                let solid_angle = TAU / width as f64 * (edge(i) - edge(i + 1));
                let cosine = n.dot(in_rest.unit()).max(0.0);
                light(i, j) * solid_angle * cosine * rho * rho
            };
            places().map(of_texel).sum()
        };
        let mut next = crate::accel::numbers(3);
        let normals = (0..20).map(|_| DVec3::new(next(), next(), next()).normalize());
        let pairs: Vec<_> = normals
            .map(|n| (expected(n), boosted.irradiance(n)[1]))
            .collect();
        let largest = pairs.iter().map(|pair| pair.0).fold(0.0, f64::max);
        for (expected, found) in pairs {
            let off = (found - expected).abs() / largest;
            assert!(off < 2e-3, "{at:?} {beta}: {found} {expected} of {largest}");
        }
        // Samples have it, too, and none is a thousand times the mean.
        let n = DVec3::Y;
        let ([mean, most], e) = (drawn(&boosted, &sky, n, 256), expected(n));
        let off = (mean - e).abs();
        assert!(off < 0.02 * e + 2e-3 * largest, "{at:?} {beta}: {mean} {e}");
        assert!(most < 10.0 * largest, "{at:?} {beta}: {most} {e}");
    }
}
