use super::*;
use crate::light::sky::panorama::Panorama;

/// A grey picture with a sun of one texel, at `row` and `column`.
fn sky(width: usize, [row, column]: [usize; 2], rotation: f64) -> Sky {
    let mut texels = vec![[1.0f32, 0.5, 0.25]; width * width / 2];
    texels[row * width + column] = [2e4, 1e4, 5e3];
    Sky {
        background: Background::Image(Panorama::new(texels, width, [2.0, 1.0, 1.0], rotation)),
        sun: None,
        stars: None,
        thermal_stars: false,
    }
}

/// ∫ L d dω and ∫ L dω as a plain sum over the picture's texels.
fn expected(width: usize, [row, column]: [usize; 2], rotation: f64) -> (DVec3, f64) {
    let (mut moment, mut sum) = (DVec3::ZERO, 0.0);
    for (i, j) in (0..width / 2).flat_map(|i| (0..width).map(move |j| (i, j))) {
        let edge = |i: usize| libm::cos(PI * i as f64 / (width / 2) as f64);
        let solid_angle = TAU / width as f64 * (edge(i) - edge(i + 1));
        let light = solid_angle * if [i, j] == [row, column] { 4e4 } else { 2.0 };
        let longitude = TAU * ((j as f64 + 0.5) / width as f64 - 0.5) - rotation;
        let height = 0.5 * (edge(i) + edge(i + 1));
        let across = (1.0 - height * height).sqrt();
        let (sine, cosine) = libm::sincos(longitude);
        moment += light * DVec3::new(sine * across, height, -cosine * across);
        sum += light;
    }
    (moment, sum)
}

#[test]
fn a_sun_of_one_texel_has_all_its_light_and_its_place() {
    for (width, place, rotation) in [
        (512, [40, 300], 0.0),
        (1024, [251, 17], 1.0),
        (2048, [500, 1001], -0.3),
        (1000, [255, 999], 2.0),
        (100, [20, 99], 0.7),
    ] {
        let sky = sky(width, place, rotation);
        let grid = LightGrid::new(&sky);
        let (mut moment, mut sum) = (DVec3::ZERO, 0.0);
        for index in 0..BLOCKS * grid.side * grid.side {
            let light = grid.radiance(index)[0] * grid.solid_angle(index);
            moment += grid.middle(index) * light;
            sum += light;
        }
        let (expected_moment, expected_sum) = expected(width, place, rotation);
        assert!(
            (sum / expected_sum - 1.0).abs() < 1e-6,
            "{width}: {sum} {expected_sum}"
        );
        // Its direction is known to half a texel of the grid.
        let off = moment.angle_between(expected_moment);
        let texel = TAU / (AROUND * grid.side) as f64;
        assert!(off < 0.5 * texel, "{width}: {off} of {texel}");
    }
}

#[test]
fn directions_are_drawn_by_their_density() {
    let sky = sky(512, [40, 300], 0.3);
    let grid = LightGrid::new(&sky);
    let sun = DVec3::from({
        let longitude = TAU * (300.5 / 512.0 - 0.5) - 0.3;
        let latitude = PI * (0.5 - 40.5 / 256.0);
        let (sine, cosine) = libm::sincos(longitude);
        let across = libm::cos(latitude);
        [sine * across, libm::sin(latitude), -cosine * across]
    });
    let block = grid.texel(sun).block;
    // The density is one over the block's fraction of directions, and integrates to one.
    let all = grid.texels(block);
    let texel = |index: usize| Texel { block, index };
    let total: f64 = all
        .clone()
        .map(|index| grid.density(texel(index)) * grid.solid_angle(index))
        .sum();
    assert!((total - 1.0).abs() < 1e-6, "{total}");
    // Sampled directions lie in the block, and are distributed over texels by their fractions.
    let count = 400;
    let mut counts = vec![0; all.len()];
    for k in 0..count * count {
        let at = |k: usize| (k as f64 + 0.5) / f64::from(count as u32);
        let d = grid.sample(block, at(k % count), at(k / count));
        assert!((d.length() - 1.0).abs() < 1e-12);
        let met = grid.texel(d);
        assert_eq!(met.block, block);
        counts[met.index - all.start] += 1;
    }
    for (count_of_one, index) in counts.into_iter().zip(all) {
        let share = grid.density(texel(index)) * grid.solid_angle(index);
        let drawn = f64::from(count_of_one) / f64::from((count * count) as u32);
        assert!((drawn - share).abs() < 0.01, "{index}: {drawn} {share}");
    }
}
