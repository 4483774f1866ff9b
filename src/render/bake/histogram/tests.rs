use std::f64::consts::TAU;

use super::*;
use crate::scene::model::EmissionProfile;

fn pulse(sigma: f64) -> Emission {
    Emission::Gaussian {
        centre: 0.3,
        sigma,
        scale: sigma * TAU.sqrt(),
    }
}

const BINS: Bins = Bins {
    start: -1.0,
    width: 0.05,
    count: 501,
};

/// Enough equal paths that most of the part's light comes from impulses.
const MANY: usize = 50 * ONE_BY_ONE;

/// Energies by bin and channel of pulses with these delays, in one part.
fn energies(emission: &Emission, delays: &[f64]) -> Histogram {
    let mut texel = Histogram::new(&BINS);
    for delay in delays {
        texel.add(&BINS, emission, [1.0, 0.5, 0.0], *delay);
    }
    texel.found = 1;
    texel.end_part();
    texel
}

#[test]
fn bins_that_were_halved_have_what_the_integral_of_the_pulse_says() {
    // From a pulse of 8 bins, the shortest treated as wide, to one of 400 that does not fit into the bins; also cut off by the first
    // and last bins.
    for sigma in [0.4, 0.55, 0.799, 0.8, 3.0, 20.0] {
        let emission = pulse(sigma);
        assert!(halvings(&BINS, &emission) > 0, "{sigma}");
        for delay in [
            -3.0, -1.3, -0.98, 4.123, 11.0, 11.025, 11.05, 11.08, 23.7, 24.05, 30.0,
        ] {
            let found = energies(&emission, &[delay]);
            // Impulses alone: the result of many paths minus that of the paths put into bins one by one.
            let [few, many] = [ONE_BY_ONE, MANY].map(|n| energies(&emission, &vec![delay; n]));
            let rest = (MANY - ONE_BY_ONE) as f64;
            let until = |bin: usize| emission.until(-1.0 + bin as f64 * 0.05 - delay);
            let exact: Vec<f64> = (0..501).map(|bin| until(bin + 1) - until(bin)).collect();
            // The fullest bin of an uncut pulse.
            let most = 0.05;
            for (bin, exact) in exact.iter().enumerate() {
                for (c, light) in [1.0, 0.5, 0.0].into_iter().enumerate() {
                    let value = found.values[3 * bin + c];
                    assert!(value >= 0.0, "{sigma} {delay} {bin}: {value:e}");
                    let off = (value - light * exact).abs() / most;
                    assert!(off < 1e-7, "{sigma} {delay} {bin}: {off:e}");
                    let [few, many] = [&few, &many].map(|of| of.values[3 * bin + c]);
                    assert!(many >= 0.0);
                    let off = ((many - few) / rest - light * exact).abs() / most;
                    assert!(off < 1e-7, "impulses: {sigma} {delay} {bin}: {off:e}");
                }
            }
            let held = exact.iter().sum::<f64>() * 0.5;
            let energy = found.energy;
            assert!(
                (energy.held - held).abs() < 1e-11 * sigma,
                "{sigma} {delay}"
            );
            let all = energy.held + energy.before + energy.after;
            assert!((all / (0.5 * sigma * TAU.sqrt()) - 1.0).abs() < 1e-11);
        }
    }
}

#[test]
fn a_wide_pulse_reaches_as_many_bins_however_narrow_they_are() {
    for k in 0..40 {
        let bins = Bins {
            count: 60_000,
            width: 0.05 * 0.8f64.powi(k),
            ..BINS
        };
        let emission = pulse(0.4);
        let halvings = halvings(&bins, &emission);
        let width = bins.width * 2f64.powi(halvings as i32);
        // The bins within 16 σ, or all there are.
        let all = (bins.count >> halvings) + 2 * BEYOND;
        let reached = (16.0 * 0.4 / width).min(all as f64);
        assert!(reached <= 128.0 && width <= 0.1, "{k}: {width}");
    }
    // Functions with corners are not Gaussian.
    let table = Emission::from(&EmissionProfile::Table(vec![[0.0, 1.0], [20.0, 1.0]]));
    assert_eq!(halvings(&BINS, &table), 0);
}

#[test]
fn a_pulse_far_wider_than_all_bins_takes_no_more_than_they_do() {
    let bins = Bins { count: 100, ..BINS };
    for sigma in [50.0, 1e12] {
        let emission = pulse(sigma);
        let (delay, paths) = (2.0, 3 * ONE_BY_ONE);
        let mut texel = Histogram::new(&bins);
        for _ in 0..paths {
            texel.add(&bins, &emission, [1.0, 0.5, 0.0], delay);
        }
        assert!(texel.wide.iter().all(|wide| wide.impulses.is_empty()));
        texel.found = paths as u32;
        texel.end_part();
        // Near its middle the pulse is practically constant: width times its maximum.
        for (bin, of) in texel.values.chunks(3).enumerate() {
            let even = paths as f64 * bins.width;
            let time = bins.start + (bin as f64 + 0.5) * bins.width - delay - 0.3;
            let exact = even * (-0.5 * (time / sigma).powi(2)).exp();
            let off = (of[0] - exact).abs() / even;
            // As accurate as differences of integrals of that size.
            assert!(off < 1e-7 + 1e-14 * sigma, "{sigma} {bin}: {off:e}");
        }
    }
}

#[test]
fn pulses_of_different_widths_add_up_and_parts_begin_empty() {
    let all = [pulse(0.1), pulse(0.4), pulse(3.0)];
    let alone = all
        .each_ref()
        .map(|emission| energies(emission, &[3.0, 7.77]));
    let mut texel = Histogram::new(&BINS);
    for _ in 0..2 {
        for (emission, delay) in all.iter().flat_map(|e| [(e, 3.0), (e, 7.77)]) {
            texel.add(&BINS, emission, [1.0, 0.5, 0.0], delay);
        }
        texel.found = 1;
        texel.end_part();
    }
    for (at, value) in texel.values.iter().enumerate() {
        let sum: f64 = alone.iter().map(|alone| 2.0 * alone.values[at]).sum();
        assert!(
            (value - sum).abs() <= 1e-14 * sum.max(1e-3),
            "{at}: {value} {sum}"
        );
    }
    // Two equal parts: only rounding error.
    let error = (0..501)
        .map(|bin| texel.error_square(bin))
        .fold(0.0, f64::max);
    assert!(error.sqrt() < 1e-8, "{error:e}");
}
