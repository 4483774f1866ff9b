//! The sky, seen and as a light.

use glam::DVec3;
use nullray::scene::model::Scene;

use crate::pipeline::stage::{self, assert_relative};

const PI: f64 = std::f64::consts::PI;

fn scene(sky: &str, object: &str, beta: f64) -> Scene {
    stage::scene(&format!(
        "
[camera]
eye = [0, 0, 4]
look_at = [0, 0, 0]
hfov = \"70 deg\"
size = [36, 28]
velocity = {{ beta = [0.2, 0.1, {}] }}
[[object]]
{object}
{sky}",
        -beta
    ))
}

const BALL: &str = "shape = { sphere = { radius = 1, subdivisions = 4 } }\ncolour = [1, 1, 1]";

/// λ′/λ of light from the world along the look direction d of the world.
fn ratio(beta: DVec3, d: DVec3) -> f64 {
    1.0 / ((1.0 + beta.dot(d)) / (1.0 - beta.length_squared()).sqrt())
}

#[test]
fn a_white_body_in_an_even_sky_is_not_seen_from_any_frame() {
    // White furnace: the body at rest reflects π L/π = L, and body and sky are seen with W⁻⁴ L.
    for beta in [0.0, 0.5, 0.9] {
        let film = stage::film(&scene("[sky]\nradiance = [1, 2, 0.5]", BALL, beta));
        let velocity = DVec3::new(0.2, 0.1, -beta);
        for i in 0..stage::pixels(&film) {
            let factor = ratio(velocity, stage::direction(&film, i)).powi(-4);
            for (got, l) in film.radiance()[i].into_iter().zip([1.0, 2.0, 0.5]) {
                assert_relative(got, l * factor, 2e-3, format!("pixel {i} at {beta}"));
            }
        }
        // Ahead at 0.9 c the ball is small.
        assert!(!stage::met(&film).is_empty(), "at {beta}");
    }
}

#[test]
fn the_gradient_and_the_sun_are_where_they_are_seen_from_a_moving_camera() {
    let sky = "[sky]\ngradient = { zenith = [0.1, 0.2, 0.6], horizon = [0.8, 0.8, 0.9], ground = [0.2, 0.1, 0] }\n\
               sun = { direction = [0.35, 0.3, -1], irradiance = 2, diameter = \"10 deg\" }";
    let film = stage::film(&scene(sky, BALL, 0.6));
    let sun = DVec3::new(0.35, 0.3, -1.0).normalize();
    let disc = 2.0 / (PI * 5f64.to_radians().sin().powi(2));
    let object = film
        .aov(nullray::render::aov::Aov::Object)
        .unwrap()
        .to_vec();
    let mut in_sun = 0;
    for i in (0..object.len()).filter(|i| object[*i] < 0.0) {
        let d = stage::direction(&film, i);
        let weight = 1.0 - (1.0 - d.y).powi(4);
        let mut expected = if d.y < 0.0 { 0.2 } else { 0.8 - 0.7 * weight };
        if d.dot(sun) > 5f64.to_radians().cos() {
            expected += disc;
            in_sun += 1;
        }
        let factor = ratio(DVec3::new(0.2, 0.1, -0.6), d).powi(-4);
        assert_relative(film.radiance()[i][0], expected * factor, 1e-9, i);
    }
    // 10° at rest are some 5 across ahead at 0.6 c, of 2° a pixel.
    assert!(in_sun > 2, "{in_sun}");
}

#[test]
fn a_floor_under_half_a_sky_has_half_its_light() {
    // A wall that stands on the floor and has no end hides the half of the sky from what is next to it. From
    // (x, 0, 0), a wall at x = 0 of height h and length 2l hides ½ (1 − x/√(x² + h²)) of the cosine-weighted half.
    let text = "
[camera]
eye = [1, 3, 0]
look_at = [1, 0, -0.001]
hfov = \"20 deg\"
size = [4, 4]
[[object]]
shape = { plane = { size = [40, 40] } }
colour = [1, 1, 1]
[[object]]
shape = { box = { size = [0.01, 4, 4000] } }
transform = { translate = [-0.005, 2, 0] }
[sky]
radiance = 1
[display]
samples_per_pixel = 400
";
    let film = stage::rendered(&stage::scene(text), &stage::sampled()).unwrap();
    let mean = film.radiance().iter().map(|rgb| rgb[0]).sum::<f64>() / 16.0;
    // The picture spans x from 0.47 to 1.53; the mean of ½ (1 + x/√(x² + 16)) over it, at h = 4.
    let at = |k: i32| 0.471 + 1.058 * (f64::from(k) + 0.5) / 100.0;
    let lit = |x: f64| 0.5 * (1.0 + x / (x * x + 16.0).sqrt());
    let expected = (0..100).map(|k| lit(at(k))).sum::<f64>() / 100.0;
    // 16 × 400 × 4 draws of ½: 0.003 of standard error.
    assert!((mean - expected).abs() < 0.012, "{mean} {expected}");
}

#[test]
fn a_mirror_in_motion_reflects_the_sky_as_a_mirror_in_its_own_frame() {
    // A smooth metal plate moves along its normal, away from the camera at β: light that goes to and fro is seen with
    // W² of each way. Straight down and up: ((1 − β)/(1 + β))² times … to the fourth power of ω.
    let beta: f64 = 0.4;
    let text = "
[camera]
eye = [0, 2, 0]
look_at = [0, 0, -1e-6]
up = [0, 0, -1]
hfov = \"0.5 deg\"
size = [3, 3]
[[object]]
shape = { plane = { size = [40, 40] } }
colour = [1, 1, 1]
metallic = 1
roughness = 0
velocity = { beta = [0, -0.4, 0] }
[sky]
radiance = 1
";
    let film = stage::film(&stage::scene(text));
    // In the plate's frame, which leaves, the sky above is fainter by D⁴, D² = (1 − β)/(1 + β); so is the plate.
    let expected = ((1.0 - beta) / (1.0 + beta)).powi(4);
    for rgb in film.radiance() {
        assert_relative(rgb[0], expected, 5e-3, "mirror");
    }
}

#[test]
fn stars_keep_their_light_over_their_discs() {
    // One star ahead: its radiance is E/(π sin² ρ), at magnitude 2.5 a tenth of the scale, of luminance 1.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("one.csv"), "0,0,-1,2.5,6500\n").unwrap();
    let text = "
[camera]
eye = [0, 0, 0]
look_at = [0, 0, -1]
hfov = \"4 deg\"
size = [5, 5]
[[object]]
shape = { box = { size = [1, 1, 1] } }
transform = { translate = [0, 0, 9] }
[sky]
stars = { file = \"one.csv\", scale = 1e-3, diameter = \"2 deg\" }
";
    let film = stage::film(&stage::scene_in(folder.path(), text));
    let [r, g, b] = film.radiance()[12];
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let expected = 1e-4 / (PI * 1f64.to_radians().sin().powi(2));
    assert_relative(luminance, expected, 1e-3, "star");
    assert_eq!(film.radiance()[0], [0.0; 3]);
}
