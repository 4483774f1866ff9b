//! The colours of blackbodies, tabulated by temperature.

use std::array::from_fn;

use rayon::prelude::*;

use super::observer::LAST;
use super::spectrum::{Spectrum, SpectrumShape};
use super::table::{MadeOnce, Table};

/// The colours of all blackbodies, by temperature.
pub(super) struct Blackbodies {
    /// By temperature in kelvin, divided by `reference` of [`SHORT`].
    table: Table<3>,
    /// Colours of lower temperatures, which few scenes have, divided by `reference` of [`LONG`]: exact ones, the first just below
    /// [`Blackbodies::COLDEST`].
    cold: MadeOnce<Vec<[f64; 3]>>,
}

/// A wavelength at which Planck's law varies like the colours of blackbodies, metres.
const SHORT: f64 = 600e-9;

/// The same for low temperatures: the end of the observer's functions, which dominates their colours.
const LONG: f64 = LAST * 1e-9;

pub(super) static BLACKBODIES: MadeOnce<Blackbodies> = MadeOnce::new(Blackbodies::new);

impl Blackbodies {
    /// Below this, colours come from the table of low temperatures.
    const COLD: f64 = 1024.0;

    /// Below this, colours are taken as 0: with the luminance that the eye's functions and Planck's law give them, they are 1e-301 at 25
    /// K, and below 24 K they underflow f64. The range of f32, in which pictures are written, ends at 163 K. The eye, which needs some
    /// 1e-6 cd/m², sees nothing glow below 600 K.
    const COLDEST: f64 = 16.0;

    /// Above this, all colours grow with the temperature plus a constant (Rayleigh and Jeans, to 1e-8).
    const HOTTEST: f64 = 16_777_216.0;

    /// Exact colours per factor of 2; between them, cubic in the logarithm of the temperature. The ratio varies as T⁻ᵏ with k up to 3 for
    /// hot ones and 10 for cold ones; of that a cubic leaves 0.023 (k ln 2/n)⁴ with n per factor of 2, less than 3·10⁻⁸.
    const EXACT: u32 = 64;
    const EXACT_COLD: u32 = 256;

    fn new() -> Blackbodies {
        let range = [Self::COLD, Self::HOTTEST];
        let ratios = exact(range, Self::EXACT, SHORT);
        Blackbodies {
            // Just below the end, at which the table would need one entry more.
            table: Table::new([Self::COLD, Self::HOTTEST * 0.999], |t| {
                between(&ratios, libm::log2(t / Self::COLD) * f64::from(Self::EXACT))
            }),
            cold: MadeOnce::new(|| exact([Self::COLDEST, Self::COLD], Self::EXACT_COLD, LONG)),
        }
    }

    /// Linear sRGB of Planck's law at `t` kelvin.
    pub(super) fn colour(&self, t: f64) -> [f64; 3] {
        let hottest = Self::HOTTEST * 0.999;
        match self.table.at(t) {
            Some(ratio) => ratio.map(|c| c * reference(t, SHORT)),
            // a t + b, by the values at two temperatures below.
            None if t >= hottest => {
                let [a, b] = [hottest * 0.5, hottest * 0.999].map(|t| (t, self.colour(t)));
                let along = (t - a.0) / (b.0 - a.0);
                from_fn(|k| a.1[k] + (b.1[k] - a.1[k]) * along)
            }
            None => self.cold_colour(t),
        }
    }

    #[cold]
    fn cold_colour(&self, t: f64) -> [f64; 3] {
        if t.is_nan() || t < Self::COLDEST {
            return [0.0; 3];
        }
        let at = libm::log2(t / Self::COLDEST) * f64::from(Self::EXACT_COLD);
        between(self.cold.get(), at).map(|c| c * reference(t, LONG))
    }
}

/// The ratios to `reference` at `wavelength` for temperatures from the first to the last, which is some power of 2 times it: `count` per
/// factor of 2, starting one step before the first.
fn exact([coldest, hottest]: [f64; 2], count: u32, wavelength: f64) -> Vec<[f64; 3]> {
    let octaves = libm::log2(hottest / coldest).round() as u32;
    let exact = |k: u32| {
        let power = (f64::from(k) - 1.0) / f64::from(count);
        ratio(coldest * libm::exp2(power), wavelength)
    };
    (0..octaves * count + 4)
        .into_par_iter()
        .map(exact)
        .collect()
}

/// Between the ratios at `at` steps from the second on.
fn between(ratios: &[[f64; 3]], at: f64) -> [f64; 3] {
    let first = (at.max(0.0) as usize).min(ratios.len() - 4);
    let f = at - first as f64;
    // Lagrange through the points at −1, 0, 1 and 2.
    let weights = [
        -f * (f - 1.0) * (f - 2.0) / 6.0,
        (f + 1.0) * (f - 1.0) * (f - 2.0) / 2.0,
        -(f + 1.0) * f * (f - 2.0) / 2.0,
        (f + 1.0) * f * (f - 1.0) / 6.0,
    ];
    let value = |j| (0..4).fold(0.0, |sum, k| sum + weights[k] * ratios[first + k][j]);
    [value(0), value(1), value(2)]
}

/// Linear sRGB of Planck's law, W m⁻² sr⁻¹ per metre, at `t` kelvin, by the table: below 0 outside the gamut.
#[inline]
pub fn blackbody_colour(t: f64) -> [f64; 3] {
    BLACKBODIES.get().colour(t)
}

/// The factor with the strongest variation in the colours of blackbodies: Planck's law at a wavelength.
fn reference(t: f64, wavelength: f64) -> f64 {
    super::planck(wavelength, t)
}

/// The colour of a blackbody, divided by [`reference`]; must not be called where that underflows.
fn ratio(t: f64, wavelength: f64) -> [f64; 3] {
    let colour = Spectrum::unscaled(SpectrumShape::Blackbody(t)).colour_at(1.0);
    let reference = reference(t, wavelength);
    match reference > 0.0 {
        true => colour.map(|c| c / reference),
        false => [0.0; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{ColourTable, Scale, rgb_from_xyz};

    /// Planck's law written out here, summed with the CIE's own numbers (linear between them) over 0.005 nm; and seen with W, that
    /// of T/W.
    #[test]
    fn blackbodies_too_cold_to_glow_have_the_colour_of_plancks_law() {
        let rows = crate::colour::observer::numbers();
        for t in [
            26.0, 31.0, 77.0, 128.5, 256.3, 300.0, 385.4, 450.0, 511.0, 511.75, 515.0, 700.0,
            1023.5, 1024.5, 2000.0,
        ] {
            let mut xyz = [0.0; 3];
            for pair in rows.windows(2) {
                for k in 0..200 {
                    let part = (f64::from(k) + 0.5) / 200.0;
                    let l = (pair[0][0] + part * (pair[1][0] - pair[0][0])) * 1e-9;
                    let x = 6.62607015e-34 * 299792458.0 / (l * 1.380649e-23 * t);
                    let radiance =
                        2.0 * 6.62607015e-34 * 299792458.0f64.powi(2) / l.powi(5) / x.exp_m1();
                    let width = (pair[1][0] - pair[0][0]) / 200.0 * 1e-9;
                    for j in 0..3 {
                        let cmf = pair[0][j + 1] + part * (pair[1][j + 1] - pair[0][j + 1]);
                        xyz[j] += width * cmf * radiance;
                    }
                }
            }
            let expected = rgb_from_xyz(xyz);
            assert!(expected[0] > 0.0);
            for (at_rest, w) in [(t, 1.0), (3.0 * t, 3.0), (6500.0, 6500.0 / t)] {
                let body =
                    Spectrum::new(SpectrumShape::Blackbody(at_rest), Scale::Factor(1.0)).unwrap();
                let seen = ColourTable::new(&body).colour(w);
                for j in 0..3 {
                    let error = (seen[j] - expected[j]).abs()
                        / expected[0]
                            .abs()
                            .max(expected[1].abs())
                            .max(expected[2].abs());
                    assert!(error < 1e-6, "{t} {w}: {seen:?} {expected:?}");
                }
            }
        }
        // Without a gap: 1 K more is some per cent more.
        let mut colder = blackbody_colour(300.0)[0];
        for k in 1..20_000 {
            let red = blackbody_colour(300.0 + 0.05 * f64::from(k))[0];
            assert!((1.0..1.02).contains(&(red / colder)), "{k}: {red} {colder}");
            colder = red;
        }
        // Below all that f64 has.
        assert_eq!(blackbody_colour(2.725), [0.0; 3]);
        assert_eq!(blackbody_colour(0.0), [0.0; 3]);
    }
}
