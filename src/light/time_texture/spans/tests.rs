//! Integrals of filters against their weights, and the digits of prefix sums.

use super::super::weights::{catmull_rom, less_curvature};
use super::*;

const FILTERS: [TimeFilter; 4] = [
    TimeFilter::Nearest,
    TimeFilter::Linear,
    TimeFilter::Cubic,
    TimeFilter::CubicMeans,
];

/// φ from the weights of lookups: the weight of the bin whose centre is x before the time.
fn kernel(filter: TimeFilter, x: f64) -> f64 {
    let (k, f) = (x.floor(), x - x.floor());
    // Bin 0 is the n-th of the run, which begins k − n bins before that of the time.
    let of = |weights: &[f64], lead: f64| {
        let n = lead - k;
        match n >= 0.0 && (n as usize) < weights.len() {
            true => weights[n as usize],
            false => 0.0,
        }
    };
    match filter {
        TimeFilter::Nearest => f64::from((-0.5..0.5).contains(&x)),
        TimeFilter::Linear => of(&[1.0 - f, f], 0.0),
        TimeFilter::Cubic => of(&catmull_rom(f), 1.0),
        TimeFilter::CubicMeans => of(&less_curvature(catmull_rom(f)), 2.0),
    }
}

#[test]
fn integrals_are_those_of_the_weights_of_lookups() {
    const STEPS: i32 = 4000;
    for filter in FILTERS {
        let mut sum = 0.0;
        for n in -4 * STEPS..4 * STEPS {
            let x = (f64::from(n) + 0.5) / f64::from(STEPS);
            sum += kernel(filter, x) / f64::from(STEPS);
            let end = f64::from(n + 1) / f64::from(STEPS);
            let error = integral(filter, end) - sum;
            assert!(error.abs() < 1e-6, "{filter:?} {end}: {error}");
        }
        assert_eq!(integral(filter, -3.0), 0.0, "{filter:?}");
        assert!((integral(filter, 3.0) - 1.0).abs() < 1e-15, "{filter:?}");
    }
}

#[test]
fn prefix_sums_keep_the_digits_of_a_tail_after_a_peak() {
    let mut samples = vec![1e-9; 64];
    samples[3] = 1e9;
    samples[9] = 0.1;
    let cube = Cube::new([1, 1, 64, 1], crate::io::cube::CubeSamples::F64(samples)).unwrap();
    let sums = PrefixSums::new(&cube);
    let tail = sums.between(0, 1, 4, 0);
    assert!((tail / 48e-9 - 1.0).abs() < 1e-14, "{tail}");
    assert_eq!(PrefixSums::bytes(cube.shape), 16 * sums.sums.len() as u64);
}
