use super::*;
use crate::colour::Scale;

const ALL: [Continuation; 3] = [
    Continuation::Dark,
    Continuation::Edge,
    Continuation::Blackbody,
];

/// Ratios from 2⁻³ to 2³ that are no entries of a table.
fn ratios() -> impl Iterator<Item = f64> {
    (0..600).map(|k| libm::exp2(-3.0 + 6.0 * (f64::from(k) + 0.37) / 600.0))
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a, x| a.max(x.abs()))
}

#[test]
fn without_a_shift_rgb_is_what_it_was() {
    for continuation in ALL {
        for (j, row) in rgb_shift(1.0 + 1e-15, continuation).iter().enumerate() {
            for (k, value) in row.iter().enumerate() {
                let unit = f64::from(j == k);
                assert!((value - unit).abs() < 1e-11, "{continuation:?}: {value}");
            }
        }
        assert_eq!(
            RgbShift::of(continuation).apply(1.0, [0.25, 0.5, 2.0]),
            [0.25, 0.5, 2.0]
        );
    }
}

#[test]
fn tabulated_shifts_are_those_of_integration_to_1e_4() {
    for continuation in ALL {
        let shift = RgbShift::of(continuation);
        let mut worst: f64 = 0.0;
        for w in ratios() {
            let (exact, table) = (rgb_shift(w, continuation), shift.matrix(w));
            let pairs = exact.into_iter().flatten().zip(table.into_iter().flatten());
            let error = largest(pairs.map(|(a, b)| a - b));
            let size = largest(exact.into_iter().flatten()).max(1.0 / (w * w * w * w * w));
            worst = worst.max(error / size);
        }
        assert!(worst < 1e-4, "{continuation:?}: {worst:e}");
    }
}

#[test]
fn tabulated_colours_are_those_of_integration_to_1e_4() {
    let rows = [[4e-7, 1.0], [5e-7, 3.0], [6e-7, 0.5], [7e-7, 2.0]];
    let shapes = [
        SpectrumShape::Lines(vec![[486e-9, 1.0], [656e-9, 2.0]]),
        SpectrumShape::Gaussian {
            centre: 550e-9,
            sigma: 10e-9,
        },
        SpectrumShape::Table(rows.into()),
        SpectrumShape::Blackbody(5800.0),
        SpectrumShape::Rgb([0.2, 0.5, 0.9], Continuation::Dark),
        SpectrumShape::Rgb([0.2, 0.5, 0.9], Continuation::Edge),
        SpectrumShape::Rgb([0.2, 0.5, 0.9], Continuation::Blackbody),
    ];
    for shape in shapes {
        let spectrum = Spectrum::new(shape, Scale::Luminance(1.0)).unwrap();
        let table = ColourTable::new(&spectrum);
        let mut worst: f64 = 0.0;
        for w in ratios() {
            let (exact, seen) = (spectrum.colour_at(w), table.colour(w));
            let error = largest((0..3).map(|k| exact[k] - seen[k]));
            worst = worst.max(error / largest(exact).max(1.0 / (w * w * w * w * w)));
        }
        assert!(worst < 1e-4, "{spectrum:?}: {worst:e}");
    }
}

#[test]
fn tabulated_reflections_are_those_of_integration_to_1e_4() {
    for spectrum in [
        Spectrum::rgb([1.0, 0.8, 0.6], Continuation::Blackbody),
        Spectrum::new(SpectrumShape::Blackbody(3000.0), Scale::Luminance(1.0)).unwrap(),
        Spectrum::new(
            SpectrumShape::Lines(vec![[589e-9, 1.0]]),
            Scale::Luminance(1.0),
        )
        .unwrap(),
    ] {
        let table = ReflectionTable::new(&spectrum);
        let albedo = [0.7, 0.3, 0.1];
        for w in ratios().step_by(7) {
            let exact = spectrum.reflected_at(w);
            let exact = exact.map(|row| (0..3).map(|k| row[k] * albedo[k]).sum::<f64>());
            let seen = table.reflected(w, albedo);
            let error = largest((0..3).map(|k| exact[k] - seen[k]));
            let size = largest(exact).max(1.0 / (w * w * w * w * w));
            assert!(error < 1e-4 * size, "{spectrum:?} {w}: {error:e}");
        }
    }
}

#[test]
fn far_shifts_go_on_as_the_continuation_says() {
    // Constant beyond 830 nm: at W = 1/8 and less all that is seen is the constant, and grows as W⁻⁵.
    let edge = RgbShift::of(Continuation::Edge);
    let [a, b] = [0.125, 0.0625].map(|w| edge.apply(w, [1.0; 3])[1]);
    assert!((b / a / 32.0 - 1.0).abs() < 1e-6);
    // The white is a blackbody there: at W = 1/10 one of 65040 K, brighter by little more than W⁻¹ · (1 + …).
    let thermal = RgbShift::of(Continuation::Blackbody);
    let [a, b] = [1e-4, 0.5e-4].map(|w| thermal.apply(w, [1.0; 3])[1]);
    assert!((b / a - 2.0).abs() < 2e-3, "{}", b / a);
    for w in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
        for continuation in ALL {
            let seen = RgbShift::of(continuation).apply(w, [1.0; 3]);
            assert!(seen.iter().all(|c| !c.is_nan()), "{w}: {seen:?}");
        }
    }
}
