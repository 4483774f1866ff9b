use super::*;

#[test]
fn sub_cells_among_powers_of_two_are_an_affine_permutation_modulo_that() {
    for (n, number) in [1u32, 2, 4, 8, 16, 1024, 1 << 31].into_iter().zip(0u64..) {
        for seed in (0..500).map(|k| hash(k ^ number << 32)) {
            let stride = (seed >> 32) % u64::from(n) + 1;
            let stride = if stride % 2 == 0 { stride + 1 } else { stride };
            let place =
                |k: u32| (u128::from(k) * u128::from(stride) + u128::from(seed)) % u128::from(n);
            for k in (0..n).step_by((n as usize / 64).max(1)) {
                assert_eq!(
                    u128::from(among_power_of_two(k, n, seed)),
                    place(k),
                    "{k} of {n}"
                );
            }
        }
    }
}

#[test]
fn samples_fill_every_stratum_of_x_and_y_once() {
    for n in [1, 2, 4, 7, 12, 16, 64] {
        let sampler = Sampler::stratified(n);
        for pixel in [(0, 0), (3, 5), (1000, 17)] {
            for axis in 0..2 {
                let mut strata: Vec<u32> = (0..n)
                    .map(|i| (sampler.offset(pixel.0, pixel.1, i)[axis] * n as f64).floor() as u32)
                    .collect();
                strata.sort_unstable();
                assert_eq!(
                    strata,
                    (0..n).collect::<Vec<_>>(),
                    "{n} samples, axis {axis}"
                );
            }
        }
    }
}

#[test]
fn offsets_by_pixel_are_those_of_each_sample_bit_for_bit() {
    let samplers = [1, 2, 4, 7, 8, 12, 16, 32].map(Sampler::stratified);
    let seeded = [4, 16].map(|n| Sampler::stratified(n).with_seed(9));
    for sampler in samplers
        .into_iter()
        .chain(seeded)
        .chain([Sampler::centred()])
    {
        let all = sampler.samples();
        // Whole replicates, parts of one, and some of two.
        for samples in [
            0..all,
            all / 2..all,
            3 * all..4 * all,
            all - 1..all + 1,
            0..1,
        ] {
            let places = [[0, 0], [3, 1], [65_535, 4], [17, 65_535], [18, 2]];
            let keys = places.map(|[column, row]| pixel_key(column, row));
            let each = samples.len();
            let (mut x, mut y) = (vec![9.0; 5 * each], vec![9.0; 5 * each]);
            sampler.offsets_by_pixel(&keys, samples.clone(), &mut x, &mut y);
            for (pixel, [column, row]) in places.into_iter().enumerate() {
                for (k, sample) in samples.clone().enumerate() {
                    let at = pixel * each + k;
                    let expected = sampler.offset(column, row, sample).map(f64::to_bits);
                    let found = [x[at], y[at]].map(f64::to_bits);
                    assert_eq!(found, expected, "{sampler:?} {samples:?} {pixel} {k}");
                }
            }
        }
    }
}

#[test]
fn square_numbers_fill_the_cells_of_a_square_grid() {
    let sampler = Sampler::stratified(16);
    let mut cells: Vec<u32> = (0..16)
        .map(|i| {
            let [x, y] = sampler.offset(2, 9, i);
            (x * 4.0) as u32 + 4 * (y * 4.0) as u32
        })
        .collect();
    cells.sort_unstable();
    assert_eq!(cells, (0..16).collect::<Vec<_>>());
}

#[test]
fn the_mean_offset_over_many_pixels_is_the_centre() {
    let sampler = Sampler::stratified(1);
    let sum: f64 = (0..10_000).map(|i| sampler.offset(i, 3, 0)[0]).sum();
    // Standard error of the mean of 10⁴ uniform numbers: 1/√(12·10⁴) = 0.0029.
    assert!((sum / 10_000.0 - 0.5).abs() < 0.012);
}

#[test]
fn moments_fill_every_stratum_of_time_once() {
    for n in [1, 2, 5, 7, 12, 16, 64, 100] {
        let sampler = Sampler::stratified(n);
        for pixel in [(0, 0), (3, 5), (1000, 17)] {
            let moment = |i| sampler.moment(pixel.0, pixel.1, i);
            let mut strata: Vec<u32> = (0..n).map(|i| (moment(i) * n as f64) as u32).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..n).collect::<Vec<_>>(), "{n} samples");
        }
    }
}

#[test]
fn place_and_time_are_uncorrelated_in_every_pixel() {
    // Of 64 samples, those of each eighth of the time lie in all 8 columns and all 8 rows.
    let sampler = Sampler::stratified(64);
    for pixel in [(0, 0), (7, 2), (90, 4000)] {
        let mut seen = [[0; 8]; 16];
        for i in 0..64 {
            let [x, y] = sampler.offset(pixel.0, pixel.1, i);
            let part = (sampler.moment(pixel.0, pixel.1, i) * 8.0) as usize;
            seen[(x * 8.0) as usize][part] += 1;
            seen[8 + (y * 8.0) as usize][part] += 1;
        }
        assert_eq!(seen, [[1; 8]; 16]);
    }
}

#[test]
fn what_moves_through_a_pixel_is_averaged_as_well_as_by_random_samples() {
    // The mean of cos 2π(x ± y ± t) is 0, and random samples would have an error of √(½/n).
    for n in [64, 256, 1024, 60] {
        let sampler = Sampler::stratified(n);
        for signs in [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0]] {
            let error = |pixel| {
                let wave = |i| {
                    let [x, y] = sampler.offset(pixel, 7, i);
                    let t = sampler.moment(pixel, 7, i);
                    (std::f64::consts::TAU * (x + signs[0] * y + signs[1] * t)).cos()
                };
                (0..n).map(wave).sum::<f64>() / f64::from(n)
            };
            let square = (0..400).map(|p| error(p).powi(2)).sum::<f64>() / 400.0;
            assert!(
                square.sqrt() < 1.3 * (0.5 / f64::from(n)).sqrt(),
                "{n} {signs:?}"
            );
        }
    }
}

#[test]
fn the_only_moment_of_a_centred_sample_is_the_middle() {
    assert_eq!(Sampler::centred().moment(4, 5, 0), 0.5);
    let throughout = Sampler::centred_throughout();
    let moments = [0, 1, 2].map(|index| throughout.moment(4, 5, index));
    assert_eq!(moments, [0.0, 0.5, 1.0]);
    assert_eq!(throughout.offset(4, 5, 2), [0.5; 2]);
}
