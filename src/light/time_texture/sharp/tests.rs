//! What pixels taken as means reproduce, and their noise.

use super::*;

#[test]
fn four_by_four_taps_reproduce_what_is_quadratic_along_each_axis() {
    let f = |x: f64, y: f64| 1.0 + 2.0 * x - 0.5 * y * y + 0.25 * x * x * y;
    for (x, y) in [(1.5, 1.5), (3.2, 2.7), (4.5, 3.5), (2.0, 3.49)] {
        let taps = bicubic([x, y], [6, 5]).unwrap();
        let centre = |tap: &Tap| ((tap.texel % 6) as f64 + 0.5, (tap.texel / 6) as f64 + 0.5);
        let sum: f64 = taps
            .iter()
            .map(|tap| tap.weight * f(centre(tap).0, centre(tap).1))
            .sum();
        assert!((sum - f(x, y)).abs() < 1e-12, "{x}, {y}");
    }
    for (x, y) in [
        (1.4, 2.0),
        (4.6, 2.0),
        (2.0, 1.49),
        (2.0, 3.6),
        (f64::NAN, 2.0),
    ] {
        assert!(bicubic([x, y], [6, 5]).is_none(), "{x}, {y}");
    }
    assert!(bicubic([1.5, 1.5], [3, 3]).is_none());
}

/// The numbers at the head of this file, by summing squared weights over a grid of positions.
#[test]
fn noise_grows_as_the_head_of_this_file_says() {
    let rms = |weights: &dyn Fn(f64) -> Vec<f64>| {
        // The weights are products of factors per axis only without the differences: sum over both axes.
        let mut total = 0.0;
        const N: usize = 40;
        for (i, j) in (0..N * N).map(|n| (n / N, n % N)) {
            let [fx, fy] = [i, j].map(|n| (n as f64 + 0.5) / N as f64);
            let (across, down) = (weights(fx), weights(fy));
            let at = |v: &[f64], n: isize| {
                usize::try_from(n)
                    .ok()
                    .and_then(|n| v.get(n))
                    .copied()
                    .unwrap_or(0.0)
            };
            let is_sharp = across.len() == 4;
            for (y, x) in (-1..5isize).flat_map(|y| (-1..5isize).map(move |x| (y, x))) {
                let own = at(&across, x) * at(&down, y);
                let spread = |v: &[f64], n| at(v, n - 1) - 2.0 * at(v, n) + at(v, n + 1);
                let differences =
                    spread(&across, x) * at(&down, y) + at(&across, x) * spread(&down, y);
                let weight = if is_sharp {
                    own - differences / 24.0
                } else {
                    own
                };
                total += weight * weight / (N * N) as f64;
            }
        }
        total.sqrt()
    };
    let bilinear = rms(&|f| vec![1.0 - f, f]);
    let sharp = rms(&|f| catmull_rom(f).to_vec());
    assert!((bilinear - 0.67).abs() < 0.005, "{bilinear}");
    assert!(
        (sharp - 0.93).abs() < 0.005 && (sharp / bilinear - 1.4).abs() < 0.01,
        "{sharp}"
    );
}
