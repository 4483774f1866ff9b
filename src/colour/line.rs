//! The colour of a spectral line on a display.
//!
//! Monochromatic light lies outside every display's gamut: one or two of its linear sRGB components are
//! negative. White is added until none is (which keeps the hue, and gives up saturation), and the colour
//! is divided by its largest component. So this is a hue: the line's brightness is carried by its
//! radiance, not by the eye's sensitivity. Outside the visible range a line is shown in grey, as by
//! Jarabo et al., CGF 34(8), 2015: radiance is there, and no colour.

use std::ops::RangeInclusive;
use std::sync::LazyLock;

use super::observer::{between, colour_matching};
use super::rgb_from_xyz;

/// Wavelengths that have a hue, metres.
pub const VISIBLE: RangeInclusive<f64> = 380e-9..=780e-9;

/// The linear grey level of invisible lines; about the mean luminance of the visible ones.
pub const OUTSIDE_GREY: f64 = 0.5;

/// Steps of the table per nanometre.
const STEPS: f64 = 2.0;

/// The colours of 380 to 780 nm.
static COLOURS: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    let count = (400.0 * STEPS) as u32 + 1;
    let nanometres = (0..count).map(|i| 380.0 + f64::from(i) / STEPS);
    nanometres.map(|nm| hue(nm * 1e-9)).collect()
});

/// Linear RGB of a line at `wavelength` (metres, as observed): its largest component is 1 in the
/// visible range, and all are [`OUTSIDE_GREY`] beyond it and for NaN.
#[inline]
pub fn line_colour(wavelength: f64) -> [f64; 3] {
    if !VISIBLE.contains(&wavelength) {
        return [OUTSIDE_GREY; 3];
    }
    // The ends, in metres, may round to just outside the table.
    let last = COLOURS.len() as f64 - 1.0;
    let position = ((wavelength * 1e9 - 380.0) * STEPS).clamp(0.0, last);
    between(&COLOURS, position).unwrap_or([OUTSIDE_GREY; 3])
}

/// The colour itself, from the observer's functions.
fn hue(wavelength: f64) -> [f64; 3] {
    let rgb = rgb_from_xyz(colour_matching(wavelength));
    let white = rgb.into_iter().fold(0.0, f64::min);
    let rgb = rgb.map(|c| c - white);
    let largest = rgb.into_iter().fold(0.0, f64::max);
    rgb.map(|c| c / largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(nanometres: f64) -> [f64; 3] {
        line_colour(nanometres * 1e-9)
    }

    #[test]
    fn visible_lines_have_a_largest_component_of_one_and_none_below_zero() {
        for i in 0..=8000 {
            let rgb = at(380.0 + f64::from(i) * 0.05);
            let largest = rgb.into_iter().fold(0.0, f64::max);
            assert!((0.99..=1.0).contains(&largest), "{i}: {rgb:?}");
            assert!(rgb.into_iter().all(|c| c >= 0.0), "{i}: {rgb:?}");
        }
    }

    #[test]
    fn the_rainbow_is_in_order() {
        let [r, g, b] = at(650.0);
        assert!(r == 1.0 && g < 0.1 && b < 0.1);
        let [r, g, b] = at(580.0);
        assert!(r > 0.9 && g > 0.4 && b < 0.1, "yellow");
        let [r, g, b] = at(532.0);
        assert!(g == 1.0 && r < 0.1 && b < 0.3, "green");
        let [r, g, b] = at(460.0);
        assert!(b == 1.0 && r < 0.3 && g < 0.1, "blue");
        let [r, g, b] = at(420.0);
        assert!(b == 1.0 && r > g, "violet");
    }

    #[test]
    fn a_spectral_colour_and_its_hue_differ_by_white_alone() {
        // (hue · s + w) must be the colour itself for one s and w common to all components.
        let rgb = rgb_from_xyz(colour_matching(520e-9));
        let hue = at(520.0);
        let scale = (rgb[1] - rgb[0]) / (hue[1] - hue[0]);
        let white = rgb.into_iter().zip(hue).map(|(c, h)| c - scale * h);
        let white: Vec<_> = white.collect();
        assert!((white[0] - white[1]).abs() < 1e-12 && (white[1] - white[2]).abs() < 1e-12);
        assert!(white[0] < 0.0);
    }

    #[test]
    fn lines_outside_the_visible_range_are_grey() {
        let grey = [OUTSIDE_GREY; 3];
        for nanometres in [f64::NAN, 379.9, 780.1, 1e4, 0.0, -500.0, f64::INFINITY] {
            assert_eq!(at(nanometres), grey, "{nanometres}");
        }
        assert_ne!(line_colour(*VISIBLE.start()), grey);
        assert_ne!(line_colour(*VISIBLE.end()), grey);
    }

    #[test]
    fn neighbouring_wavelengths_have_neighbouring_colours() {
        for i in 0..4000 {
            let (a, b) = (
                at(380.0 + f64::from(i) * 0.1),
                at(380.1 + f64::from(i) * 0.1),
            );
            let step = (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max);
            assert!(step < 0.02, "{i}: {a:?} {b:?}");
        }
    }
}
