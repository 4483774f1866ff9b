//! Colours that stand for spectra: RGB whose hue shifts, and objects with spectra of their own.
//!
//! The light of a spectrum seen at W is ∫ W⁻⁵ L(λ/W) m_j(λ) dλ; here it is summed from the spectrum's own values over 0.025 nm,
//! independently of the renderer's tables.

use glam::DVec3;
use nullray::colour::{
    Continuation, Scale, Spectrum, SpectrumShape, colour_matching, rgb_from_xyz,
};
use nullray::render::aov::Aov;
use nullray::scene::model::Scene;
use nullray::spacetime::{Quantity, Velocity};

use crate::pipeline::stage::{self, assert_relative};

/// The camera, at 0.6 c, is inside a large ball with these keys.
fn enclosed(keys: &str) -> Scene {
    let radiance = match keys.starts_with("spectrum") {
        true => "radiance.quantity = \"rgb\"",
        false => "",
    };
    let mut scene = stage::scene(&format!(
        "
{radiance}
[display]
back_faces = \"two_sided\"
[camera]
eye = [0.3, 0.1, -0.2]
look_at = [0.9, 0.5, -1.2]
hfov = \"150 deg\"
size = [8, 6]
[[object]]
shape = {{ sphere = {{ radius = 50, subdivisions = 2 }} }}
{keys}
"
    ));
    scene.camera.velocity = Velocity::from_beta(DVec3::new(0.3, 0.2, -0.48)).unwrap();
    scene
}

/// The sum over wavelengths.
fn seen(spectrum: &Spectrum, w: f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for k in 0..18_800 {
        let l = (360.0125 + 0.025 * f64::from(k)) * 1e-9;
        let radiance = spectrum.per_wavelength(l / w) / w.powi(5) * 0.025e-9;
        let m = colour_matching(l);
        (0..3).for_each(|j| xyz[j] += radiance * m[j]);
    }
    rgb_from_xyz(xyz)
}

#[track_caller]
fn check(scene: &Scene, spectrum: &Spectrum) {
    let film = stage::film(scene);
    for i in 0..stage::pixels(&film) {
        let w = stage::value(&film, Aov::WavelengthRatio, i);
        let (got, expected) = (film.radiance()[i], seen(spectrum, w));
        let size = expected.iter().fold(0.0f64, |a, c| a.max(c.abs()));
        for (got, expected) in got.into_iter().zip(expected) {
            // 1e-4 of the table, and as much of the sum.
            let error = (got - expected).abs() / size;
            assert!(error < 2e-4, "W = {w}: {got} is not {expected}");
        }
    }
}

const COLOUR: [f64; 3] = [0.25, 0.5, 0.125];

#[test]
fn rgb_is_seen_as_the_spectrum_that_it_stands_for() {
    for continuation in [
        Continuation::Dark,
        Continuation::Edge,
        Continuation::Blackbody,
    ] {
        let mut scene = enclosed("colour = [0.25, 0.5, 0.125]");
        scene.quantity = Quantity::Rgb;
        scene.continuation = continuation;
        check(&scene, &Spectrum::rgb(COLOUR, continuation));
    }
}

#[test]
fn rgb_at_rest_is_what_it_was_bit_for_bit() {
    let mut scene = enclosed("colour = [0.25, 0.5, 0.125]");
    scene.camera.velocity = Velocity::REST;
    scene.quantity = Quantity::Rgb;
    let film = stage::film(&scene);
    assert!(film.radiance().iter().all(|rgb| *rgb == COLOUR));
}

#[test]
fn a_blackbody_is_seen_as_one_of_another_temperature() {
    // The factor is that of luminance 1 at rest; Planck's law at T/W beyond it.
    let scene = enclosed("spectrum = { blackbody = \"4000 K\" }");
    let at_rest = Spectrum::new(SpectrumShape::Blackbody(4000.0), Scale::Luminance(1.0)).unwrap();
    let film = stage::film(&scene);
    for i in 0..stage::pixels(&film) {
        let w = stage::value(&film, Aov::WavelengthRatio, i);
        let other = Spectrum::new(
            SpectrumShape::Blackbody(4000.0 / w),
            Scale::Factor(at_rest.factor()),
        );
        let expected = seen(&other.unwrap(), 1.0);
        for (got, expected) in film.radiance()[i].into_iter().zip(expected) {
            assert_relative(got, expected, 1e-6, w);
        }
    }
}

#[test]
fn lines_of_an_object_are_seen_where_they_are_shifted_to() {
    // Hα and Hβ: W⁻⁴ E m(W λ), written out.
    let lines =
        "lines = [{ wavelength = \"656.28 nm\", energy = 3 }, { wavelength = \"486.13 nm\" }]";
    let scene = enclosed(&format!("spectrum = {{ {lines}, total = 1 }}"));
    let film = stage::film(&scene);
    for i in 0..stage::pixels(&film) {
        let w = stage::value(&film, Aov::WavelengthRatio, i);
        let [a, b] = [656.28e-9, 486.13e-9].map(|l| rgb_from_xyz(colour_matching(w * l)));
        for k in 0..3 {
            let expected = (0.75 * a[k] + 0.25 * b[k]) / w.powi(4);
            let error = (film.radiance()[i][k] - expected).abs();
            assert!(error < 1e-12 / w.powi(4), "W = {w}");
        }
    }
}

#[test]
fn hue_and_brightness_can_be_turned_off_apart() {
    let mut scene = enclosed("colour = [0.25, 0.5, 0.125]");
    scene.quantity = Quantity::Rgb;
    let whole = stage::film(&scene);
    scene.effects.searchlight = false;
    let hue = stage::film(&scene);
    scene.effects.doppler = false;
    let neither = stage::film(&scene);
    scene.effects.searchlight = true;
    let brightness = stage::film(&scene);
    for i in 0..stage::pixels(&whole) {
        let w = stage::value(&whole, Aov::WavelengthRatio, i);
        for (k, c) in COLOUR.into_iter().enumerate() {
            let at = |film: &nullray::render::film::Film| film.radiance()[i][k];
            // Brightness goes by all energy, W⁻⁴; hue is what is left.
            assert_eq!(at(&neither), c);
            assert_relative(at(&brightness), c / w.powi(4), 1e-12, "brightness");
            assert_relative(at(&hue) / w.powi(4), at(&whole), 1e-12, "hue");
        }
    }
}

#[test]
fn false_colours_show_a_line_of_the_infrared_as_a_visible_one() {
    // 10 µm shown as 555 nm: a line at 9 µm, seen at W, is shown at W · 9/10 · 555 nm.
    let mut scene = enclosed("spectrum = { line = \"9 um\", total = 1 }");
    scene.false_colour = Some(10e-6);
    let film = stage::film(&scene);
    for i in 0..stage::pixels(&film) {
        let w = stage::value(&film, Aov::WavelengthRatio, i);
        let shown = rgb_from_xyz(colour_matching(w * 9e-6 * 555e-9 / 10e-6));
        for (got, shown) in film.radiance()[i].into_iter().zip(shown) {
            let error = (got - shown / w.powi(4)).abs();
            assert!(error < 1e-9 / w.powi(4), "W = {w}: {got}");
        }
    }
}

#[test]
fn a_white_pulse_at_rest_with_a_surface_reflects_the_surfaces_spectrum() {
    // A white pulse on a red floor: irradiance times albedo, and its shift by a camera in motion.
    let text = "
[camera]
eye = [0, 2, 0]
look_at = [0, 0, 0]
up = [0, 0, -1]
hfov = \"20 deg\"
size = [4, 4]
time = \"5 m\"
[[object]]
shape = { plane = { size = [20, 20] } }
colour = [0.8, 0.1, 0.05]
[[source]]
pulse = { position = [0, 3, 0], time = \"0 m\", sigma = \"1 m\", shadows = false }
[radiance]
quantity = \"rgb\"
";
    let mut scene = stage::scene(text);
    let still = stage::film(&scene);
    let [r, g, b] = still.radiance()[5];
    assert!(r > 0.0);
    assert_relative(g / r, 0.125, 1e-6, "green");
    assert_relative(b / r, 0.0625, 1e-6, "blue");
    // It is at 4.9 m at 5.8 m of world time.
    scene.camera.velocity = Velocity::from_beta(DVec3::new(0.0, 0.5, 0.0)).unwrap();
    let moving = stage::film(&scene);
    // Left behind with W = √3: the ratio of components is that of the shifted colour.
    let w = stage::value(&moving, Aov::WavelengthRatio, 5);
    let colour = [0.8, 0.1, 0.05];
    let expected = seen(&Spectrum::rgb(colour, Continuation::Blackbody), w);
    let got = moving.radiance()[5];
    for k in 1..3 {
        assert_relative(got[k] / got[0], expected[k] / expected[0], 5e-3, k);
    }
}
