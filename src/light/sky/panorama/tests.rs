use std::f64::consts::TAU;

use super::super::Beaming;
use super::*;

#[test]
fn the_arctangent_is_right_to_its_bound() {
    for k in -1000..=1000 {
        let angle = PI * f64::from(k) / 1000.0;
        let (y, x) = (libm::sin(angle), libm::cos(angle));
        let error = (arctan(y, x) - libm::atan2(y, x)).abs();
        assert!(error < 2.1e-8 || (TAU - error) < 2.1e-8, "{angle}: {error}");
        let narrow = arctan_f32(y as f32, x as f32);
        let error = (f64::from(narrow) - libm::atan2(y, x)).abs();
        assert!(error < 3e-7 || (TAU - error) < 3e-7, "{angle}: {error}");
    }
    assert_eq!((arctan(0.0, 0.0), arctan_f32(0.0, 0.0)), (0.0, 0.0));
}

#[test]
fn texels_are_where_they_are_said_to_be() {
    let (width, height) = (16, 8);
    let texels: Vec<_> = (0..width * height).map(|k| [k as f32, 1.0, 0.0]).collect();
    let sky = Panorama::new(texels, width, [1.0, 2.0, 1.0], 0.0);
    for (j, i) in [(0, 0), (8, 4), (15, 7), (4, 3)] {
        let longitude = TAU * ((j as f64 + 0.5) / 16.0 - 0.5);
        let latitude = PI * (0.5 - (i as f64 + 0.5) / 8.0);
        let [r, g, _] = sky.radiance(direction(longitude, latitude), 0.0);
        assert!((r - (i * width + j) as f64).abs() < 1e-4, "{j} {i}: {r}");
        assert_eq!(g, 2.0);
    }
}

#[test]
fn many_directions_at_once_are_seen_as_each_alone() {
    let (width, height) = (50, 25);
    let value = |k: usize| ((k * 7919) % 1009) as f32;
    let texels: Vec<_> = (0..width * height)
        .map(|k| [value(k), value(k + 1), value(k + 2)])
        .collect();
    let sky = Panorama::new(texels, width, [1.0, 2.0, 3.0], 0.7);
    // The poles, the seam, and points between, at fractions of texels.
    let all: Vec<DVec3> = (0..=180)
        .flat_map(|i| {
            (0..7).map(move |j| direction(f64::from(j) - PI, PI * (f64::from(i) / 180.0 - 0.5)))
        })
        .collect();
    let ratios: Vec<f64> = (0..all.len())
        .map(|k| 1e3 / 1.007f64.powi(k as i32))
        .collect();
    let angles = PixelAngles {
        angle: 0.7,
        pixel: 0.7,
        ratios: &ratios,
        beaming: Beaming::REST,
        power: 0,
        motions: &[],
    };
    // Rays in a row, and in another order.
    let count = all.len() as u32;
    let orders: [Vec<u32>; 2] = [
        (0..count).collect(),
        (0..count).map(|k| k * 11 % count).collect(),
    ];
    for rays in orders {
        let look = LookDirections {
            directions: &all,
            rays: &rays,
        };
        let mut radiance = vec![[0.0; 3]; all.len()];
        sky.radiance_each(look, angles, &mut radiance);
        for ((ray, w), together) in rays.iter().zip(&ratios).zip(radiance) {
            let d = all[*ray as usize];
            assert_eq!(sky.radiance(d, 0.7 / w), together, "{d}, {w}");
        }
    }
}

#[test]
fn looking_up_in_single_precision_is_off_by_less_than_2e_5_of_steps_between_texels() {
    // Noise from 0 to 1 on 128 columns, where f32 positions give errors of 2·10⁻⁷ · 128 texels.
    let (width, height) = (128, 64);
    let value = |j: usize, i: usize| ((j * 7919 + i * 6151) % 1009) as f32 / 1009.0;
    let texels: Vec<_> = (0..width * height)
        .map(|k| [value(k % width, k / width); 3])
        .collect();
    let sky = Panorama::new(texels, width, [1.0; 3], 0.7);
    let mut largest: f64 = 0.0;
    for k in 0..20_000 {
        let (longitude, latitude) = (
            TAU * ((f64::from(k) * 0.618_033_988_75).fract() - 0.5),
            PI * ((f64::from(k) + 0.5) / 20_000.0 - 0.5),
        );
        // The same in f64 with library functions: rotated about +Y by 0.7, longitudes decrease by 0.7.
        let u = ((longitude + 0.7) / TAU + 0.5).rem_euclid(1.0);
        let (x, y) = (u * 128.0 - 0.5, (0.5 - latitude / PI) * 64.0 - 0.5);
        let texel = |j: f64, i: f64| {
            let (j, i) = (j.rem_euclid(128.0) as usize, i.clamp(0.0, 63.0) as usize);
            f64::from(value(j, i))
        };
        let (j, i) = (x.floor(), y.floor());
        let row = |i: f64| texel(j, i) + (texel(j + 1.0, i) - texel(j, i)) * (x - j);
        let expected = row(i) + (row(i + 1.0) - row(i)) * (y - i);
        let got = sky.radiance(direction(longitude, latitude), 0.0)[0];
        largest = largest.max((got - expected).abs());
    }
    assert!(largest < 3e-5, "{largest:e}");
}

#[test]
fn a_picture_is_turned_right_handed_about_y() {
    // One bright texel in the middle, −Z; a rotation by +90° about +Y takes −Z to −X.
    let mut texels = vec![[0.0f32; 3]; 64 * 32];
    for (i, j) in [(15, 31), (15, 32), (16, 31), (16, 32)] {
        texels[i * 64 + j] = [1.0; 3];
    }
    let sky = Panorama::new(texels, 64, [1.0; 3], FRAC_PI_2);
    assert!(sky.radiance(DVec3::NEG_X, 0.0)[0] > 0.99);
    assert_eq!(sky.radiance(DVec3::NEG_Z, 0.0)[0], 0.0);
}

#[test]
fn smaller_sizes_keep_the_mean_over_the_sphere() {
    let (width, height) = (50, 25);
    let value = |j: usize, i: usize| ((j * 7 + i * 13) % 11) as f32;
    let texels: Vec<_> = (0..width * height)
        .map(|k| [value(k % width, k / width); 3])
        .collect();
    let weight = |i: usize| {
        let edge = |i: usize| libm::cos(PI * i as f64 / height as f64);
        0.5 * (edge(i) - edge(i + 1)) / width as f64
    };
    let mean: f64 = (0..width * height)
        .map(|k| f64::from(texels[k][0]) * weight(k / width))
        .sum();
    let sky = Panorama::new(texels, width, [1.0; 3], 0.0);
    assert_eq!(Panorama::bytes(width), 4 * sky.texels.len() as u64);
    let last = sky.count - 1;
    let (columns, begin) = (sky.sizes.widths[last] as usize, sky.sizes.begins[last]);
    let row = &sky.texels[3 * begin as usize..][..3 * columns];
    let got = row.chunks(3).map(|t| f64::from(t[0])).sum::<f64>() / columns as f64;
    assert_eq!(sky.sizes.heights[last], 1.0);
    // Odd widths leave parts of three texels: with columns taken as equal, an error of about one per cent.
    assert!((got - mean).abs() < 0.05 * mean, "{got} {mean}");
}
