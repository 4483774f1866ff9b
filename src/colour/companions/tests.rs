use super::*;

/// Ratios in the table's range and beyond, none of which is an entry.
fn ratios() -> impl Iterator<Item = f64> {
    (0..3000).map(|k| 0.08 * libm::pow(125.0, (f64::from(k) + 0.37) / 3000.0))
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a: f64, x| a.max(x.abs()))
}

/// The columns of both bands, summed here with the CIE's own numbers (linear between them) over 0.01 nm.
#[test]
fn the_columns_are_the_integrals_over_the_bands_to_1e_4() {
    let rows = crate::colour::observer::numbers();
    // White at 830 and 360 nm: all that an edge continuation of (1, 1, 1) is.
    let white = crate::colour::Spectrum::rgb([1.0; 3], Continuation::Edge);
    let shift = CompanionShift::get();
    for w in [
        0.09, 0.11, 0.16, 0.2, 0.3, 0.43, 0.6, 0.8, 0.95, 1.0, 1.05, 1.4, 2.2, 3.0, 5.0, 8.0, 9.0,
    ] {
        let mut xyz = [[0.0; 3]; 2];
        for pair in rows.windows(2) {
            for k in 0..100 {
                let part = (f64::from(k) + 0.5) / 100.0;
                let seen = pair[0][0] + part * (pair[1][0] - pair[0][0]);
                let at_rest = seen / w;
                let band = match at_rest {
                    l if l > 830.0 && l < 3500.0 => 0,
                    l if l > 100.0 && l < 360.0 => 1,
                    _ => continue,
                };
                let end = [831e-9, 359e-9][band];
                let radiance = white.per_wavelength(end) / w.powi(5);
                let width = (pair[1][0] - pair[0][0]) / 100.0 * 1e-9;
                for j in 0..3 {
                    let cmf = pair[0][j + 1] + part * (pair[1][j + 1] - pair[0][j + 1]);
                    xyz[band][j] += width * cmf * radiance;
                }
            }
        }
        let matrix = shift.matrix(w);
        for (band, xyz) in xyz.into_iter().enumerate() {
            let expected = rgb_from_xyz(xyz);
            let error = largest((0..3).map(|j| matrix[j][3 + band] - expected[j]));
            // The sum's own midpoints are off by as much again at a band's end.
            let least = 1.5e-4 * w.powi(-5);
            assert!(error < least, "{w} {band}: {error:e}, {expected:?}");
        }
    }
}

#[test]
fn tabulated_columns_are_those_of_integration_to_1e_4() {
    let shift = CompanionShift::get();
    let mut worst: f64 = 0.0;
    for w in ratios() {
        let exact = band_colour(w);
        let seen = shift.apply(w, [0.0; 3], [1.0; 2]);
        let error = largest((0..3).map(|j| exact[j] - seen[j]));
        worst = worst.max(error / largest(exact).max(w.powi(-5)));
    }
    assert!(worst < 1e-4, "{worst:e}");
}

#[test]
fn five_equal_channels_are_white_with_a_constant_continuation() {
    // As long as all that is in view lies between 100 and 3500 nm.
    let (shift, edge) = (CompanionShift::get(), RgbShift::of(Continuation::Edge));
    for w in ratios().filter(|w| *w > 830.0 / 3500.0 && *w < 3.6) {
        let (seen, expected) = (shift.apply(w, [1.0; 3], [1.0; 2]), edge.apply(w, [1.0; 3]));
        let error = largest((0..3).map(|j| seen[j] - expected[j]));
        assert!(
            error < 2e-4 * largest(expected).max(w.powi(-5)),
            "{w}: {error:e}"
        );
    }
    // Beyond, some of that is missing.
    let [less, all] = [
        shift.apply(0.18, [1.0; 3], [1.0; 2]),
        edge.apply(0.18, [1.0; 3]),
    ];
    assert!(less[0] < 0.9 * all[0], "{less:?} {all:?}");
}

#[test]
fn without_companions_it_is_dark_beyond_bit_for_bit() {
    let (shift, dark) = (CompanionShift::get(), RgbShift::of(Continuation::Dark));
    for w in ratios() {
        let rgb = [0.3, 0.7, 0.1];
        assert_eq!(shift.apply(w, rgb, [0.0; 2]), dark.apply(w, rgb), "{w}");
    }
    // At rest nothing of the bands is seen.
    assert_eq!(shift.apply(1.0, [0.3, 0.7, 0.1], [5.0; 2]), [0.3, 0.7, 0.1]);
    for w in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
        assert_eq!(shift.apply(w, [1.0; 3], [1.0; 2]), [0.0; 3], "{w}");
    }
}
