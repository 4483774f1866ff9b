use super::*;

fn chromaticity([x, y, z]: [f64; 3]) -> [f64; 2] {
    [x / (x + y + z), y / (x + y + z)]
}

fn is_close(a: [f64; 2], b: [f64; 2], tolerance: f64) -> bool {
    (a[0] - b[0]).abs() < tolerance && (a[1] - b[1]).abs() < tolerance
}

fn blackbody(t: f64) -> Spectrum {
    Spectrum::new(SpectrumShape::Blackbody(t), Scale::Factor(1.0)).unwrap()
}

#[test]
fn a_filter_is_shifted_with_its_light() {
    // Against a plain sum over 0.1 nm of W⁻⁵ L(λ/W) F(λ/W); the filter is given at rest with the source.
    let filter = [1.0, 0.05, 0.2];
    let table = SpectrumShape::Table(vec![[400e-9, 1e6], [555e-9, 3e6], [720e-9, 2e6]]);
    for shape in [SpectrumShape::Blackbody(5800.0), table] {
        let bare = Spectrum::new(shape, Scale::Factor(1.0)).unwrap();
        for w in [0.7, 1.0, 1.3] {
            let mut sum = [0.0; 3];
            for k in 0..4700 {
                let l = (360.05 + 0.1 * f64::from(k)) * 1e-9;
                let of = rgb_basis::weights(l / w);
                let part: f64 = (0..3).map(|j| of[j] * filter[j]).sum();
                let seen = bare.per_wavelength(l / w) * part / w.powi(5);
                let xyz = colour_matching(l);
                (0..3).for_each(|j| sum[j] += seen * xyz[j] * 1e-10);
            }
            let found = bare.filtered(filter).xyz_at(w);
            for (found, sum) in found.into_iter().zip(sum) {
                assert!((found / sum - 1.0).abs() < 1e-4, "{w}: {found} {sum}");
            }
        }
    }
    // A filter only dims a single line, whose hue it cannot change.
    let line = SpectrumShape::Lines(vec![[589e-9, 2.0]]);
    let line = Spectrum::new(line, Scale::Factor(1.0)).unwrap();
    let (bare, behind) = (line.colour_at(0.9), line.filtered(filter).colour_at(0.9));
    let part = behind[0] / bare[0];
    assert!(0.0 < part && part < 1.0);
    (0..3).for_each(|k| assert!((behind[k] - part * bare[k]).abs() < 1e-12 * bare[0].abs()));
}

#[test]
fn a_blackbody_in_motion_is_one_of_another_temperature() {
    // By W⁻⁵ B(λ/W; T), written out here, and a plain sum over 0.1 nm, against the spectrum of temperature T/W.
    for (t, w) in [(5800.0, 0.5), (5800.0, 2.0), (3000.0, 0.23), (2.725, 5e-4)] {
        let mut sum = [0.0; 3];
        for k in 0..4700 {
            let l = (360.05 + 0.1 * f64::from(k)) * 1e-9;
            let x = 6.62607015e-34 * 299792458.0 * w / (l * 1.380649e-23 * t);
            let per_wavelength = (w / l).powi(5) / x.exp_m1() / w.powi(5);
            let xyz = colour_matching(l);
            (0..3).for_each(|j| sum[j] += per_wavelength * xyz[j] * 1e-10);
        }
        let sum = sum.map(|c| c * 2.0 * 6.62607015e-34 * 299792458.0f64.powi(2));
        let (moving, other) = (blackbody(t).xyz_at(w), blackbody(t / w).xyz_at(1.0));
        assert_eq!(moving, other);
        assert!(
            (sum[1] / other[1] - 1.0).abs() < 1e-5,
            "{t} {w}: {sum:?} {other:?}"
        );
        assert!(
            is_close(chromaticity(sum), chromaticity(other), 1e-6),
            "{t} {w}"
        );
    }
}

#[test]
fn a_shifted_table_of_a_blackbody_is_a_blackbody_of_another_temperature() {
    // The table goes the general way of scaled wavelengths; Planck's law at every nm is linear to 1e-6 there.
    let rows = (300..2000).map(|nm| {
        let l = f64::from(nm) * 1e-9;
        [l, planck(l, 4000.0)]
    });
    let table = Spectrum::new(SpectrumShape::Table(rows.collect()), Scale::Factor(1.0)).unwrap();
    for w in [0.6, 0.9, 1.0, 1.15] {
        let (a, b) = (table.xyz_at(w), blackbody(4000.0 / w).xyz_at(1.0));
        assert!((a[1] / b[1] - 1.0).abs() < 5e-6, "{w}: {a:?} {b:?}");
        assert!(is_close(chromaticity(a), chromaticity(b), 1e-6), "{w}");
    }
}

#[test]
fn blackbodies_have_the_published_colours_and_energies() {
    // CIE 015:2018: illuminant A, 2855.5 K on the scale of today, is at (0.44758, 0.40745).
    let a = chromaticity(blackbody(2855.5).xyz_at(1.0));
    assert!(is_close(a, [0.44758, 0.40745], 3e-5), "{a:?}");
    // Stefan–Boltzmann: σT⁴/π, σ = 5.670374419e-8 W m⁻² K⁻⁴ (CODATA 2018).
    let total = blackbody(1000.0).total().unwrap();
    let expected = 5.670374419e-8 * 1e12 / std::f64::consts::PI;
    assert!((total / expected - 1.0).abs() < 1e-9, "{total}");
}

#[test]
fn a_line_in_motion_is_a_line_elsewhere() {
    // 656.28 nm at W = 0.8 is at 525.024 nm: chromaticity of the locus there by the observer's own table, and
    // W⁻⁴ of the energy.
    let line = Spectrum::new(
        SpectrumShape::Lines(vec![[656.28e-9, 3.0]]),
        Scale::Factor(1.0),
    )
    .unwrap();
    let seen = line.xyz_at(0.8);
    let locus = colour_matching(525.024e-9);
    for k in 0..3 {
        let expected = 3.0 * locus[k] * 2.44140625;
        assert!((seen[k] - expected).abs() < 1e-9 * expected, "{seen:?}");
    }
    // Between (0.0743, 0.8338) at 520 nm and (0.1547, 0.8059) at 530 nm (Wyszecki & Stiles, table 3.3.1).
    let [x, y] = chromaticity(seen);
    assert!((0.0743..0.1547).contains(&x) && (0.8059..0.8338).contains(&y));
}

#[test]
fn a_narrow_gaussian_is_a_line() {
    let gaussian = SpectrumShape::Gaussian {
        centre: 550.5e-9,
        sigma: 1e-12,
    };
    let gaussian = Spectrum::new(gaussian, Scale::Factor(2.0)).unwrap();
    let line = Spectrum::new(
        SpectrumShape::Lines(vec![[550.5e-9, 2.0]]),
        Scale::Factor(1.0),
    )
    .unwrap();
    for w in [0.9, 1.0, 1.0 / 1.1] {
        let (a, b) = (gaussian.xyz_at(w), line.xyz_at(w));
        for k in 0..3 {
            assert!((a[k] / b[k] - 1.0).abs() < 2e-3, "{w}: {a:?} {b:?}");
        }
    }
}

#[test]
fn equal_energy_is_at_a_third_and_a_third() {
    let flat = SpectrumShape::Table(vec![[300e-9, 1.0], [900e-9, 1.0]]);
    let flat = Spectrum::new(flat, Scale::Luminance(5.0)).unwrap();
    let xyz = flat.xyz_at(1.0);
    assert!((xyz[1] - 5.0).abs() < 1e-12);
    assert!(is_close(chromaticity(xyz), [1.0 / 3.0; 2], 2e-4), "{xyz:?}");
}

#[test]
fn rgb_is_what_it_says_at_rest_and_so_is_what_white_light_falls_on() {
    for continuation in [
        Continuation::Dark,
        Continuation::Edge,
        Continuation::Blackbody,
    ] {
        let seen = Spectrum::rgb([0.2, 0.7, 1.5], continuation).colour_at(1.0);
        for (value, expected) in seen.into_iter().zip([0.2, 0.7, 1.5]) {
            assert!((value - expected).abs() < 1e-11, "{seen:?}");
        }
        let reflected = Spectrum::rgb([1.0; 3], continuation).reflected_at(1.0);
        for (j, row) in reflected.iter().enumerate() {
            for (k, value) in row.iter().enumerate() {
                assert!((value - f64::from(j == k)).abs() < 1e-11, "{reflected:?}");
            }
        }
    }
}

#[test]
fn totals_are_integrals() {
    // A triangle from 400 to 700 nm with a peak of 2 per metre: 3e-7.
    let triangle = SpectrumShape::Table(vec![[400e-9, 0.0], [500e-9, 2.0], [700e-9, 0.0]]);
    let spectrum = Spectrum::new(triangle.clone(), Scale::Factor(1.0)).unwrap();
    assert!((spectrum.total().unwrap() - 3e-7).abs() < 1e-20);
    let unit = Spectrum::new(triangle, Scale::Total(1.0)).unwrap();
    assert!((unit.total().unwrap() - 1.0).abs() < 1e-12);
    assert!((unit.per_wavelength(450e-9) - 1.0 / 3e-7).abs() < 1e-3);
}

#[test]
fn a_luminance_of_what_nobody_sees_cannot_be_had() {
    let infrared = || SpectrumShape::Lines(vec![[10e-6, 1.0]]);
    assert_eq!(Spectrum::new(infrared(), Scale::Luminance(1.0)), None);
    assert!(Spectrum::new(infrared(), Scale::Total(1.0)).is_some());
}
