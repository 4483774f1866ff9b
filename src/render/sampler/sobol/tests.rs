use super::super::pixel_key;
use super::*;

#[test]
fn the_second_dimension_is_made_of_its_direction_numbers() {
    for index in (0..4096).chain((0..4096).map(|k: u32| k.wrapping_mul(0x9e37_79b9))) {
        let (mut digits, mut direction) = (0, 1u32 << 31);
        for bit in 0..32 {
            if index >> bit & 1 == 1 {
                digits ^= direction;
            }
            direction ^= direction >> 1;
        }
        assert_eq!(second_dimension(index), digits, "{index}");
    }
}

#[test]
fn scrambled_points_fill_all_elementary_intervals_once() {
    // 2⁶ points: one in each rectangle of 2ᵃ × 2⁶⁻ᵃ. Also for a part that begins at a multiple of 2⁶.
    for (pixel, dimension) in [(0, 0), (7, 3), (1 << 33, 11)] {
        for first in [0, 64, 640] {
            let points: Vec<_> = (first..first + 64)
                .map(|k| sobol(pixel, k, dimension))
                .collect();
            for a in 0..=6 {
                let [columns, rows] = [1u32 << a, 64 >> a];
                let mut cells: Vec<u32> = points
                    .iter()
                    .map(|[x, y]| {
                        (x * f64::from(columns)) as u32 * rows + (y * f64::from(rows)) as u32
                    })
                    .collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..64).collect::<Vec<_>>(), "{pixel} {first} {a}");
            }
        }
    }
}

#[test]
fn neighbouring_pixels_share_one_set_of_points() {
    // 16 numbers for each of 4 × 4 pixels: those of each pixel fill 4 × 4 cells once, and those of all fill 16 × 16, in any replicate.
    // With 12 numbers each is in a cell of its own.
    for (salt, count) in [(0, 16), (hash(7), 16), (0, 12)] {
        let mut all = [0; 256];
        for key in 0..16 {
            let pixel = pixel_key(40 + key % 4, 80 + key / 4) ^ salt;
            let mut own = [0; 16];
            for index in 0..count {
                let [x, y] = sobol_among(pixel, index, count, 1);
                let cell = |n: f64| (x * n) as usize * n as usize + (y * n) as usize;
                own[cell(4.0)] += 1;
                all[cell(16.0)] += 1;
            }
            assert!(own.iter().all(|n| *n <= 1));
        }
        assert!(all.iter().all(|n| *n <= 1));
    }
}

#[test]
fn scrambled_dimensions_are_independent() {
    // Products of centred coordinates over 4096 points have the variance (1/12)²: the mean is within 5 standard errors of 1.3e-3.
    for (a, b) in [(0, 1), (2, 9)] {
        let product = |k| (sobol(3, k, a)[0] - 0.5) * (sobol(3, k, b)[0] - 0.5);
        let mean = (0..4096).map(product).sum::<f64>() / 4096.0;
        assert!(mean.abs() < 5.0 / (12.0 * 64.0), "{a} {b}: {mean}");
    }
}
