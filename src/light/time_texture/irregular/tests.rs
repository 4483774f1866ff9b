//! Bins of different widths against uniform ones, and what they reproduce.

use super::super::weights::{catmull_rom, less_curvature};
use super::*;

const EDGES: [f64; 9] = [1.0, 1.1, 1.4, 1.5, 2.3, 2.4, 3.0, 3.7, 3.9];

fn bins(edges: &[f64], filter: TimeFilter) -> Irregular {
    Irregular::new(&edges.into(), BinValues::Density, filter)
}

/// The filtered value at `t` of `value(bin)`.
fn read(bins: &Irregular, t: f64, value: impl Fn(i64) -> f64) -> f64 {
    let (first, run) = bins.weights(t);
    (first..)
        .zip(run.as_slice())
        .map(|(k, w)| w * value(k))
        .sum()
}

#[test]
fn bins_of_one_width_are_read_as_uniform_ones() {
    let edges: Vec<f64> = (0..12).map(|k| 0.25 * f64::from(k)).collect();
    for i in 0..50 {
        let t = 1.0 + 0.02 * f64::from(i);
        let x = t / 0.25 - 0.5;
        let (k, f) = (x.floor() as i64, x - x.floor());
        let (first, run) = bins(&edges, TimeFilter::Cubic).weights(t);
        assert_eq!(first, k - 1);
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-13);
        assert!(near(run.as_slice(), &catmull_rom(f)));
        let (first, run) = bins(&edges, TimeFilter::CubicMeans).weights(t);
        assert_eq!(first, k - 2);
        assert!(near(run.as_slice(), &less_curvature(catmull_rom(f))));
    }
}

#[test]
fn quadratics_come_back_from_their_values_and_from_their_means() {
    let quadratic = |t: f64| 2.0 - 3.0 * t + 0.7 * t * t;
    // ∫ q over a bin, from its antiderivative.
    let integral = |t: f64| 2.0 * t - 1.5 * t * t + 0.7 / 3.0 * t * t * t;
    let cubic = bins(&EDGES, TimeFilter::Cubic);
    let means = bins(&EDGES, TimeFilter::CubicMeans);
    let linear = bins(&EDGES, TimeFilter::Linear);
    let mean = |k: i64| {
        let (from, to) = (
            means.centre(k) - 0.5 * means.width(k),
            means.centre(k) + 0.5 * means.width(k),
        );
        (integral(to) - integral(from)) / (to - from)
    };
    for i in 0..=290 {
        let t = 1.0 + 0.01 * f64::from(i);
        let at_centre = |k| quadratic(cubic.centre(k));
        assert!(
            (read(&cubic, t, at_centre) - quadratic(t)).abs() < 1e-12,
            "{t}"
        );
        assert!((read(&means, t, mean) - quadratic(t)).abs() < 1e-12, "{t}");
        assert!((read(&linear, t, |k| 3.0 * linear.centre(k)) - 3.0 * t).abs() < 1e-12);
    }
}

#[test]
fn times_find_the_bin_that_contains_them_and_stay_near_the_ends() {
    let bins = bins(&EDGES, TimeFilter::Nearest);
    for (t, bin) in [
        (1.0, 0),
        (1.1, 1),
        (2.29, 3),
        (3.9, 7),
        (0.0, 0),
        (f64::NAN, 0),
    ] {
        assert_eq!(bins.weights(t).0, bin, "{t}");
    }
    let cubic = super::tests::bins(&EDGES, TimeFilter::CubicMeans);
    for t in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -1e300] {
        let (first, run) = cubic.weights(t);
        assert!((-8..16).contains(&first), "{t}: {first}");
        assert!((run.as_slice().iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn energies_are_divided_by_the_width_of_their_own_bin() {
    let bins = Irregular::new(&EDGES.into(), BinValues::PerBin, TimeFilter::Linear);
    let mut run = BinWeights {
        first: 2,
        count: 2,
        weights: [0.5, 0.5, 0.0, 0.0, 0.0, 0.0],
    };
    bins.per_metre(&mut run);
    // Bins 2 and 3 are 0.1 and 0.8 wide.
    assert!((run.weights[0] - 5.0).abs() < 1e-12 && (run.weights[1] - 0.625).abs() < 1e-12);
}
