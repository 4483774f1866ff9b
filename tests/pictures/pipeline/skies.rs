//! Skies, as background and as light.

use std::path::Path;

use glam::DVec3;
use nullray::colour::{colour_matching, rgb_from_xyz};
use nullray::io::image::{Channel, Layers, Samples, exr};
use nullray::render::plan::Request;
use nullray::scene::model::Scene;

use crate::pipeline::lorentz;
use crate::pipeline::stage::{self, assert_relative, planck};

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
               sun = { direction = [0.35, 0.3, -1], irradiance = 2, diameter = \"16 deg\" }";
    let film = stage::film(&scene(sky, BALL, 0.6));
    let sun = DVec3::new(0.35, 0.3, -1.0).normalize();
    let disc = 2.0 / (PI * 8f64.to_radians().sin().powi(2));
    let object = film
        .aov(nullray::render::aov::Aov::Object)
        .unwrap()
        .to_vec();
    let mut in_sun = 0;
    for i in (0..object.len()).filter(|i| object[*i] < 0.0) {
        let d = stage::direction(&film, i);
        let weight = 1.0 - (1.0 - d.y).powi(4);
        let mut expected = if d.y < 0.0 { 0.2 } else { 0.8 - 0.7 * weight };
        if d.dot(sun) > 8f64.to_radians().cos() {
            expected += disc;
            in_sun += 1;
        }
        let factor = ratio(DVec3::new(0.2, 0.1, -0.6), d).powi(-4);
        assert_relative(film.radiance()[i][0], expected * factor, 1e-9, i);
    }
    // 16° at rest are some 8 across ahead at 0.6 c, of 2° a pixel: too wide to be widened as points are.
    assert!(in_sun > 2, "{in_sun}");
}

#[test]
fn discs_of_sun_and_stars_keep_their_area_in_the_narrowest_fields_of_view() {
    // Seen across a quarter of a square picture, a disc fills π/64 of it.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("one.csv"), "0.36,0.48,-0.8,0,6000\n").unwrap();
    for diameter in ["1e-4 deg", "3e-6 deg", "1e-6 deg", "6e-8 deg"] {
        for sky in [
            "sun = { direction = [0.36, 0.48, -0.8], irradiance = 2,",
            "stars = { file = \"one.csv\",",
        ] {
            let width: f64 = diameter.trim_end_matches(" deg").parse().unwrap();
            let text = format!(
                "[camera]\neye = [0, 0, 0]\nforward = [0.36, 0.48, -0.8]\nhfov = \"{} deg\"\nsize = [64, 64]\n\
                 [radiance]\nquantity = \"rgb\"\n[sky]\n{sky} diameter = \"{diameter}\" }}",
                4.0 * width
            );
            let film = stage::film(&stage::scene_in(folder.path(), &text));
            let lit = film.radiance().iter().filter(|l| l[0] > 0.0).count();
            let part = lit as f64 / 64f64.powi(2) / (PI / 64.0);
            assert!((part - 1.0).abs() < 0.05, "{sky} {diameter}: {part}");
        }
    }
}

#[test]
fn the_sun_ahead_of_a_fast_camera_is_seen_with_its_whole_light_wherever_it_lies_among_pixels() {
    // Ahead at 0.99 c the sun has a radius of 0.02°, a tenth of a pixel. A plane surface receives W⁻² of its energy.
    let beta: f64 = 0.99;
    let ratio = ((1.0 - beta) / (1.0 + beta)).sqrt();
    for accelerates in [false, true] {
        // The second camera passes through the same velocity, and hardly changes it during the exposure.
        let motion = match accelerates {
            false => "",
            true => {
                "motion = { acceleration = { proper = \"0.1 /m\", direction = [1, 0, 0] } }\nshutter = { duration = \"1 mm\" }\n"
            }
        };
        let mut sum = 0.0;
        for step in 0..8 {
            let text = format!(
                "[camera]\neye = [0, 0, 0]\nlook_at = [{}, 0.2, -1]\nhfov = \"30 deg\"\nsize = [160, 100]\n\
                 velocity = {{ beta = {beta}, direction = [0.3, 0.25, -1] }}\n{motion}\
                 [radiance]\nquantity = \"integrated\"\n\
                 [sky]\nsun = {{ direction = [0.3, 0.25, -1], irradiance = 2 }}\n\
                 [display]\nsamples_per_pixel = 4\n",
                0.3 + 0.003 * f64::from(step)
            );
            let film = stage::rendered(&stage::scene(&text), &stage::sampled()).unwrap();
            let side = (15f64.to_radians().tan()) / 80.0;
            let flux: f64 = (0..stage::pixels(&film))
                .map(|i| {
                    let (x, y) = ((i % 160) as f64 + 0.5 - 80.0, (i / 160) as f64 + 0.5 - 50.0);
                    let away = 1.0 + (x * x + y * y) * side * side;
                    film.radiance()[i][0] * side * side / away.powf(1.5)
                })
                .sum();
            // Some 25 samples, four a pixel, see it: 6 % of noise.
            let part = flux * ratio.powi(2) / 2.0;
            assert!((part - 1.0).abs() < 0.2, "{accelerates} {step}: {part}");
            sum += part;
        }
        let mean = sum / 8.0;
        assert!((mean - 1.0).abs() < 0.05, "{accelerates}: {mean}");
    }
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
    let mean = stage::mean(&film, &stage::met(&film))[0];
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
    let text = stage::above_plane(
        3,
        [0.0; 3],
        [0.0, -beta, 0.0],
        "metallic = 1\nroughness = 0\n[sky]\nradiance = 1\n",
    );
    let film = stage::film(&stage::scene(&text));
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

/// A sky of 40 stars of magnitude 0 and 6000 K ahead, seen at a speed along −Z; and the picture's places of the stars, their W,
/// and how many pixels there are per unit of its plane.
fn starry(folder: &Path, beta: f64, quantity: &str) -> (Scene, Vec<([f64; 2], f64)>, f64) {
    let gamma = 1.0 / (1.0 - beta * beta).sqrt();
    let half = 30f64.to_radians().tan();
    let mut table = String::new();
    let mut places = Vec::new();
    for k in 0..40 {
        // On the plane one before the camera, 40 pixels apart and as far from its edge, at many places between pixels; d = B d′ from there.
        let at = |n: i32, of: i32, golden: f64| {
            let between = (f64::from(k) * golden).fract();
            (f64::from(40 * (n - of)) + 20.0 + between) * half / 180.0
        };
        let place = [
            at(k % 8, 4, 0.618),
            at(k / 8, 3, 0.7549) + 20.0 * half / 180.0,
        ];
        let seen = DVec3::new(place[0], place[1], -1.0).normalize();
        let w = gamma * (1.0 + beta * seen.z);
        let d = DVec3::new(seen.x, seen.y, gamma * (seen.z + beta)) / w;
        table += &format!("{},{},{},0,6000\n", d.x, d.y, d.z);
        places.push((place, w));
    }
    std::fs::write(folder.join("many.csv"), table).unwrap();
    let text = format!(
        "
[camera]
eye = [0, 0, 0]
look_at = [0, 0, -1]
hfov = \"60 deg\"
size = [360, 270]
velocity = {{ beta = [0, 0, {}] }}
[radiance]
quantity = \"{quantity}\"
[display]
samples_per_pixel = 16
[sky]
stars = {{ file = \"many.csv\", scale = 1, diameter = \"0.001 deg\" }}
",
        -beta
    );
    (stage::scene_in(folder, &text), places, 180.0 / half)
}

#[test]
fn stars_that_are_smaller_than_pixels_keep_their_light_and_none_is_missed() {
    // ∫ L′ dω′ = W^(2−p) E of channels, p = 4; of a blackbody W² times its colour at T/W, as the table of luminances of Planck's law says it.
    let folder = tempfile::tempdir().unwrap();
    let at_rest = luminance(thermal(6000.0, 0.5));
    for (beta, quantity) in [
        (0.0, "integrated"),
        (0.9, "integrated"),
        (0.99, "integrated"),
        (0.0, "rgb"),
        (0.9, "rgb"),
        (0.99, "rgb"),
    ] {
        let (scene, places, per_plane) = starry(folder.path(), beta, quantity);
        for (request, bound) in [(stage::centred(), 0.05), (stage::sampled(), 0.05)] {
            let film = stage::rendered(&scene, &request).unwrap();
            let (mut seen, mut all) = (0.0, 0.0);
            for ([x, y], w) in &places {
                // Pixels about it, none of which sees another star, with dω′ = cos³ dx dy.
                let [column, row] =
                    [180.0 + x * per_plane, 135.0 - y * per_plane].map(|x| x as usize);
                let mut light = 0.0;
                for i in row - 8..=row + 8 {
                    for j in column - 8..=column + 8 {
                        let at = [
                            (j as f64 + 0.5 - 180.0) / per_plane,
                            (135.0 - i as f64 - 0.5) / per_plane,
                        ];
                        let cosine = 1.0 / (1.0 + at[0] * at[0] + at[1] * at[1]).sqrt();
                        light += luminance(film.radiance()[i * 360 + j]) * cosine.powi(3)
                            / per_plane.powi(2);
                    }
                }
                let expected = match quantity {
                    "rgb" => w * w * luminance(thermal(6000.0 / w, 0.5)) / at_rest,
                    _ => w.powi(-2),
                };
                let error = (light / expected - 1.0).abs();
                assert!(
                    error < bound,
                    "{beta} {quantity}: {light} of {expected} at {x} {y}"
                );
                seen += light;
                all += expected;
            }
            // Towards the edges pixels are narrower than the widest, which sums over them show; all stars together are right to 1 %.
            assert!(
                (seen / all - 1.0).abs() < 0.01,
                "{beta} {quantity}: {seen} of {all}"
            );
        }
    }
}

/// The total is ∫ L′ dω′ = Σ W^(2−p) E, or W² times the colour at T/W, with W of each star: however much of the sky a pixel sees.
/// Pixels of 15° see stars whose W differs much from their own. An exposure is the mean of pictures at its moments; stars with W of its
/// start are off by 2 to 4 %.
#[test]
fn an_exposure_of_a_camera_that_accelerates_shows_the_mean_of_the_stars_at_its_moments() {
    let moments = 8;
    for quantity in ["integrated", "rgb"] {
        let seen = |samples: u32, keys: &str| {
            let scene = stage::scene(&format!(
                "
[camera]
eye = [0, 0, 0]
look_at = [0, 0, -1]
projection = \"equirectangular\"
size = [24, 12]
velocity = {{ beta = [0.4, 0, 0] }}
{keys}
[camera.motion.acceleration]
proper = \"0.8 /m\"
direction = [0, 0, -1]
[radiance]
quantity = \"{quantity}\"
[display]
samples_per_pixel = {samples}
[sky]
stars = {{ count = 300 }}
"
            ));
            let film = stage::rendered(&scene, &Request::default()).unwrap();
            film.radiance().to_vec()
        };
        let exposed = seen(64 * moments, "shutter = { duration = \"0.6 m\" }");
        let mut mean = vec![[0.0; 3]; exposed.len()];
        for k in 0..moments {
            let time = 0.6 * (f64::from(k) + 0.5) / f64::from(moments);
            let at_moment = seen(64, &format!("time = \"{time} m\""));
            for (mean, rgb) in mean.iter_mut().zip(at_moment) {
                *mean = std::array::from_fn(|c| mean[c] + rgb[c] / f64::from(moments));
            }
        }
        let all: f64 = mean.iter().flatten().sum();
        let pairs = exposed.iter().flatten().zip(mean.iter().flatten());
        let off = pairs.map(|(a, b)| (a - b).abs()).sum::<f64>() / all;
        assert!(off < 0.01, "{quantity}: {off}");
    }
}

#[test]
fn all_stars_together_keep_their_light_at_any_speed_in_pixels_of_any_width() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = 5u64;
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let stars: Vec<_> = (0..500)
        .map(|_| DVec3::new(next(), next(), next()).normalize())
        .collect();
    let line = |d: &DVec3| format!("{},{},{},0,6000\n", d.x, d.y, d.z);
    let table: String = stars.iter().map(line).collect();
    std::fs::write(folder.path().join("many.csv"), table).unwrap();
    let at_rest = luminance(thermal(6000.0, 0.5));
    let round = "projection = \"equirectangular\"\nsize = [72, 36]";
    let fisheye = "projection = \"fisheye_equidistant\"\nhfov = \"180 deg\"\nsize = [36, 36]";
    let flat = "hfov = \"60 deg\"\nsize = [60, 60]";
    for (gamma, quantity, camera) in [
        (1.0, "integrated", round),
        (10.0, "integrated", round),
        (100.0, "integrated", round),
        (1000.0, "integrated", round),
        (10.0, "rgb", round),
        (100.0, "rgb", round),
        (30.0, "integrated", fisheye),
        (1000.0, "integrated", fisheye),
        (30.0, "integrated", flat),
        (1000.0, "integrated", flat),
    ] {
        let text = format!(
            "
[camera]
eye = [0, 0, 0]
look_at = [0, 0, -1]
velocity = {{ gamma = {gamma}, direction = [0, 0, -1] }}
{camera}
[radiance]
quantity = \"{quantity}\"
[display]
samples_per_pixel = 64
[sky]
stars = {{ file = \"many.csv\", scale = 1, diameter = \"0.001 deg\" }}
"
        );
        let scene = stage::scene_in(folder.path(), &text);
        let light = |d: &DVec3| {
            let w = 1.0 / (gamma - (gamma * gamma - 1.0f64).sqrt() * d.z);
            match quantity {
                "rgb" => w * w * luminance(thermal(6000.0 / w, 0.5)) / at_rest,
                _ => w.powi(-2),
            }
        };
        let expected: f64 = stars.iter().map(light).sum();
        for request in [stage::centred(), stage::sampled()] {
            let film = stage::rendered(&scene, &request).unwrap();
            let [width, height] = film.size().map(f64::from);
            let mut seen = 0.0;
            for (k, rgb) in film.radiance().iter().enumerate() {
                let x = k as f64 % width + 0.5 - 0.5 * width;
                let y = (k as f64 / width).floor() + 0.5 - 0.5 * height;
                let a = (if camera == flat { 60.0 } else { 180.0 / height }).to_radians();
                let solid_angle = if camera == round {
                    a * a * (y * a).cos()
                } else if camera == fisheye {
                    let angle = x.hypot(y) * a;
                    a * a * angle.sin() / angle
                } else {
                    let pixel = 2.0 * (0.5 * a).tan() / width;
                    pixel * pixel * (1.0 + (x * x + y * y) * pixel * pixel).powf(-1.5)
                };
                seen += luminance(*rgb) * solid_angle;
            }
            assert_relative(
                seen,
                expected,
                0.015,
                format!("{gamma} {quantity} {camera}"),
            );
        }
    }
}

/// Linear sRGB of a blackbody, by a plain sum over `step` nm.
fn thermal(kelvin: f64, step: f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for k in 0..(470.0 / step).round() as u32 {
        let l = (360.0 + step * (f64::from(k) + 0.5)) * 1e-9;
        let m = colour_matching(l);
        (0..3).for_each(|j| xyz[j] += planck(l, kelvin) * m[j] * step * 1e-9);
    }
    rgb_from_xyz(xyz)
}

fn largest(rgb: [f64; 3]) -> f64 {
    rgb.into_iter().fold(0.0, |a: f64, c| a.max(c.abs()))
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// A camera that sees nothing but the sky, in motion along −Z with this speed.
fn traveller(folder: &Path, beta: f64, sky: &str) -> Scene {
    wide_traveller(folder, 120, beta, sky)
}

/// The same with a field of view of so many degrees.
fn wide_traveller(folder: &Path, hfov: u32, beta: f64, sky: &str) -> Scene {
    let text = format!(
        "
[camera]
eye = [0, 0, 0]
look_at = [0, 0, -1]
projection = \"fisheye_equidistant\"
hfov = \"{hfov} deg\"
size = [9, 9]
velocity = {{ beta = [0, 0, {}] }}
[[object]]
shape = {{ box = {{ size = [1, 1, 1] }} }}
transform = {{ translate = [0, 0, 1e6] }}
[radiance]
quantity = \"rgb\"
[sky]
{sky}
",
        -beta
    );
    stage::scene_in(folder, &text)
}

#[test]
fn a_sky_of_a_blackbody_is_seen_as_one_of_another_temperature_in_each_direction() {
    let folder = Path::new("");
    for (beta, kelvin) in [(0.0, 3000.0), (0.5, 3000.0), (-0.5, 6000.0), (0.99, 8000.0)] {
        let sky = format!("spectrum = {{ blackbody = \"{kelvin} K\", factor = 2 }}");
        let film = stage::film(&traveller(folder, beta, &sky));
        let mut ratios = Vec::new();
        for i in 0..stage::pixels(&film) {
            let w = ratio(DVec3::new(0.0, 0.0, -beta), stage::direction(&film, i));
            let expected = thermal(kelvin / w, 0.05).map(|c| 2.0 * c);
            let size = largest(expected);
            for (got, expected) in film.radiance()[i].into_iter().zip(expected) {
                let error = (got - expected).abs() / size;
                assert!(error < 3e-6, "W = {w}: {got} is not {expected}");
            }
            ratios.push(w);
        }
        ratios.sort_by(f64::total_cmp);
        let spread = ratios[ratios.len() - 1] / ratios[0];
        assert!(beta == 0.0 || spread > 1.2, "{spread} at {beta}");
    }
}

#[test]
fn the_cosmic_background_has_its_dipole() {
    // T(θ′) = T₀/(γ (1 − β cos θ′)) at the angle θ′ from ahead as the camera has it, seen in millimetres: with 1 mm
    // shown as s⁻¹ · 1 mm = 555 nm, B(sλ; T) s = s⁻⁴ B(λ; sT).
    let s: f64 = 1e-3 / 555e-9;
    let total = 5.670374419e-8 * 2.725f64.powi(4) / PI;
    for beta in [1.23e-3, 0.6, -0.6] {
        let sky = "spectrum = { blackbody = \"2.725 K\", total = 1 }";
        let mut scene = traveller(Path::new(""), beta, sky);
        scene.false_colour = Some(1e-3);
        let film = stage::film(&scene);
        let gamma = 1.0 / (1.0 - beta * beta).sqrt();
        for i in 0..stage::pixels(&film) {
            // Aberration, to the angle at the camera.
            let ahead = -stage::direction(&film, i).z;
            let cosine = (ahead + beta) / (1.0 + beta * ahead);
            let kelvin = 2.725 / (gamma * (1.0 - beta * cosine));
            let expected = thermal(s * kelvin, 0.05).map(|c| c / s.powi(4) / total);
            let size = largest(expected);
            for (got, expected) in film.radiance()[i].into_iter().zip(expected) {
                assert!(
                    (got - expected).abs() < 3e-6 * size,
                    "{got} is not {expected}"
                );
            }
        }
    }
}

#[test]
fn a_star_in_motion_is_a_blackbody_of_another_temperature() {
    // 3000 K ahead of a camera at 0.8 c, W = 1/3: 9000 K, which is 790 times as bright per solid angle. As RGB it would be 10 times too faint.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("one.csv"), "0,0,-1,0,3000\n").unwrap();
    let sky = "stars = { file = \"one.csv\", scale = 1e-3, diameter = \"10 deg\" }";
    let density = 1e-3 / (PI * 5f64.to_radians().sin().powi(2));
    let at_rest = luminance(thermal(3000.0, 0.05));
    // Pixels that are narrower than the disc at any speed.
    for (beta, kelvin, hfov) in [(0.0, 3000.0, 12), (0.8, 9000.0, 12), (-0.8, 1000.0, 60)] {
        let film = stage::film(&wide_traveller(folder.path(), hfov, beta, sky));
        let expected = thermal(kelvin, 0.05).map(|c| c * density / at_rest);
        let size = largest(expected);
        for (got, expected) in film.radiance()[40].into_iter().zip(expected) {
            let error = (got - expected).abs() / size;
            assert!(error < 1e-5, "{beta}: {got} is not {expected}");
        }
        assert_eq!(film.radiance()[0], [0.0; 3]);
    }
}

/// A white floor that moves together with the camera above it.
fn floor(folder: &Path, sky: &str) -> [f64; 3] {
    let beta = [0.6, 0.48, 0.0];
    let keys = format!("[radiance]\nquantity = \"rgb\"\n[sky]\nshadows = false\n{sky}");
    let text = stage::above_plane(1, beta, beta, &keys);
    stage::film(&stage::scene_in(folder, &text)).radiance()[0]
}

#[test]
fn surfaces_in_motion_are_lit_by_the_spectrum_of_the_sky_as_they_see_it() {
    // E_F = ∫ B(λ; T/W) cos θ_F dω_F with W = γ (1 − β·d′) over the half of F's sky above the floor, by 120 × 240 cells.
    let beta = DVec3::new(0.6, 0.48, 0.0);
    let gamma = 1.0 / (1.0 - beta.length_squared()).sqrt();
    let (n, m) = (120, 240);
    let mut sum = [0.0; 3];
    for k in 0..n * m {
        let height = (f64::from(k / m) + 0.5) / f64::from(n);
        let (sine, cosine) = (2.0 * PI * (f64::from(k % m) + 0.5) / f64::from(m)).sin_cos();
        let across = (1.0 - height * height).sqrt();
        let d = DVec3::new(across * cosine, height, across * sine);
        let seen = thermal(2500.0 / (gamma * (1.0 - beta.dot(d))), 10.0);
        let cell = 2.0 * PI / f64::from(n * m);
        (0..3).for_each(|j| sum[j] += seen[j] * height * cell);
    }
    let lit = floor(
        Path::new(""),
        "spectrum = { blackbody = \"2500 K\", factor = 1 }",
    );
    for (got, e) in lit.into_iter().zip(sum) {
        assert_relative(got, e / PI, 4e-3, "floor");
    }
}

#[test]
fn surfaces_in_motion_are_lit_by_stars_as_they_see_them() {
    // E_F = W² Ω B(λ; T/W) cos θ_F of a star, wherever it is.
    let (longitude, height): (f64, f64) = (1.875f64.to_radians(), 1.0 - 2.0 * 2.5 / 48.0);
    let across = (1.0 - height * height).sqrt();
    let d = DVec3::new(longitude.sin() * across, height, -longitude.cos() * across);
    let folder = tempfile::tempdir().unwrap();
    let line = format!("{},{},{},0,3500\n", d.x, d.y, d.z);
    std::fs::write(folder.path().join("one.csv"), line).unwrap();
    let beta = DVec3::new(0.6, 0.48, 0.0);
    let gamma = 1.0 / (1.0 - beta.length_squared()).sqrt();
    let omega = gamma * (1.0 + beta.dot(d));
    let along = beta.normalize();
    let seen = (d + along * ((gamma - 1.0) * along.dot(d) + gamma * beta.length())) / omega;
    let lit = floor(folder.path(), "stars = { file = \"one.csv\", scale = 1 }");
    let at_rest = luminance(thermal(3500.0, 0.05));
    let expected = thermal(3500.0 * omega, 0.05);
    for (got, colour) in lit.into_iter().zip(expected) {
        let expected = colour / at_rest * seen.y / (omega * omega) / PI;
        assert_relative(got, expected, 1e-4, "floor");
    }
}

#[test]
fn skies_of_spectra_need_radiance_that_is_a_spectrum_and_one_way() {
    let refused = |sky: &str| {
        let text = format!(
            "[camera]\neye = [0, 0, 0]\nlook_at = [0, 0, -1]\nhfov = \"50 deg\"\nsize = [2, 2]\n\
             [[object]]\nshape = {{ box = {{ size = [1, 1, 1] }} }}\n{sky}"
        );
        let parsed = nullray::scene::parse(&text, "sky.toml", Path::new(""), &Default::default());
        parsed.unwrap_err().to_string()
    };
    let error = refused("[sky]\nspectrum = { blackbody = \"3000 K\" }");
    assert!(error.contains("a sky has a spectrum where"), "{error}");
    let rgb = "[radiance]\nquantity = \"rgb\"\n[sky]\n";
    let error = refused(&format!("{rgb}spectrum = {{ blackbody = \"2.725 K\" }}"));
    assert!(error.contains("has no luminance"), "{error}");
    let error = refused(&format!(
        "{rgb}radiance = 1\nspectrum = {{ blackbody = \"3000 K\" }}"
    ));
    assert!(error.contains("given twice"), "{error}");
}

/// A sky of 512 × 256 texels of this radiance by look direction, as the table of a scene whose files are in `folder`.
fn pictured(folder: &Path, name: &str, radiance: impl Fn(DVec3) -> f64) -> String {
    let (width, height) = (512, 256);
    let texel = |k: usize| {
        let at = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        let longitude = 2.0 * PI * (at(k % width, width) - 0.5);
        let latitude = PI * (0.5 - at(k / width, height));
        let across = latitude.cos();
        radiance(DVec3::new(
            longitude.sin() * across,
            latitude.sin(),
            -longitude.cos() * across,
        )) as f32
    };
    let texels: Vec<f32> = (0..width * height).map(texel).collect();
    let channel = |name: &str| Channel {
        name: name.into(),
        samples: Samples::F32(texels.clone()),
    };
    let channels = ["R", "G", "B"].map(channel).into();
    let layers = Layers::new(width as u32, height as u32, channels, vec![]).unwrap();
    exr::write(&folder.join(name), &layers).unwrap();
    format!("[sky]\nimage = {{ file = \"{name}\" }}\nshadows = false")
}

#[test]
fn boosting_sky_bodies_and_camera_together_changes_rounding_and_interpolation_only() {
    let folder = tempfile::tempdir().unwrap();
    let bodies = format!(
        "{BALL}\n[[object]]\nname = \"crate\"\nshape = {{ box = {{ size = [1, 1, 1] }} }}\n\
         velocity = {{ beta = [-0.3, 0.5, 0.1] }}\norigin = {{ position = [1.2, -0.4, -3], time = \"-6 m\" }}"
    );
    let with = |sky: &str| {
        let text = format!(
            "[camera]\neye = [0, 0, 4]\nlook_at = [0, 0, 0]\nhfov = \"70 deg\"\nsize = [36, 28]\n\
             velocity = {{ beta = [0.2, 0.1, -0.4] }}\n[[object]]\n{bodies}\n{sky}"
        );
        stage::scene_in(folder.path(), &text)
    };
    // Brighter above than below.
    let bright = |d: DVec3| 1.0 + 0.6 * d.y + 0.2 * d.x;
    let scene = with(&pictured(folder.path(), "rest.exr", bright));
    let film = stage::film(&scene);
    for v in [DVec3::new(0.5, 0.2, 0.0), DVec3::new(-0.3, 0.4, 0.9)] {
        // What is seen along d in the new world came along d₀ in the old: w (−1, d₀) = B(−v) (−1, d), and W = 1/w.
        let seen = |d: DVec3| {
            let k = lorentz::boost(-v) * lorentz::four(-1.0, d);
            bright(lorentz::space(k).normalize()) * (-k.x).powi(-4)
        };
        let sky = with(&pictured(folder.path(), "moved.exr", seen)).sky;
        let mut moved = lorentz::boosted(&scene, v);
        moved.sky = sky;
        let moved = stage::film(&moved);
        let mut differ = 0;
        for (a, b) in film.radiance().iter().zip(moved.radiance()) {
            // Texels of 0.7°, and E_F to 2·10⁻³ of its largest.
            differ += usize::from((a[0] - b[0]).abs() > 5e-3 * a[0]);
        }
        assert!(differ <= 4, "{differ} pixels differ at {v}");
    }
    let met = stage::met(&film).len();
    assert!(met > 50, "{met}");
}

#[test]
fn rough_metal_reflects_a_small_sun_of_a_picture_with_little_noise() {
    // A sun of 2° in a dim sky, away from the direction of a mirror; the sum is over all texels.
    let folder = tempfile::tempdir().unwrap();
    let towards = DVec3::new(0.5, 1.0, 0.2).normalize();
    let bright = |d: DVec3| match d.dot(towards) > 2f64.to_radians().cos() {
        true => 400.0,
        false => 0.1,
    };
    let sky = pictured(folder.path(), "sun.exr", bright);
    let roughness: f64 = 0.6;
    for beta in [0.0, 0.6] {
        let text = format!(
            "
[camera]
eye = [0, 2, 2]
look_at = [0, 0, 0]
hfov = \"0.5 deg\"
size = [4, 4]
velocity = {{ beta = [{beta}, 0, 0] }}
[[object]]
shape = {{ plane = {{ size = [40, 40] }} }}
colour = [1, 1, 1]
metallic = 1
roughness = {roughness}
velocity = {{ beta = [{beta}, 0, 0] }}
{sky}
[display]
samples_per_pixel = 16
"
        );
        let film = stage::rendered(&stage::scene_in(folder.path(), &text), &stage::sampled());
        let all = film.unwrap().radiance().to_vec();
        let mean = all.iter().map(|rgb| rgb[0]).sum::<f64>() / 16.0;

        // f of glTF's metal of f0 = 1 is D V.
        let view = DVec3::new(0.0, 1.0, 1.0).normalize();
        let square = roughness.powi(4);
        let facing = view.y;
        let smith = |from: f64, to: f64| to * (square + (1.0 - square) * from * from).sqrt();
        let boost = lorentz::boost(lorentz::rapidity(DVec3::new(-beta, 0.0, 0.0)));
        let mut expected = 0.0;
        for k in 0..512 * 256 {
            let longitude = 2.0 * PI * ((f64::from(k % 512) + 0.5) / 512.0 - 0.5);
            let latitude = PI * (0.5 - (f64::from(k / 512) + 0.5) / 256.0);
            let across = latitude.cos();
            let cell = across * (PI / 256.0).powi(2);
            let (sine, cosine) = longitude.sin_cos();
            let d = DVec3::new(sine * across, latitude.sin(), -cosine * across);
            // From there W⁻⁴ L in W² dω.
            let moved = boost * lorentz::four(-1.0, d);
            let l = lorentz::space(moved).normalize();
            if l.y <= 0.0 {
                continue;
            }
            let w = -1.0 / moved.x;
            let half = (view + l).normalize();
            let peak = half.y * half.y * (square - 1.0) + 1.0;
            let f = square / (PI * peak * peak) * 0.5 / (smith(facing, l.y) + smith(l.y, facing));
            expected += bright(d) * f * l.y * cell / (w * w);
        }
        assert_relative(mean, expected, 0.02, "metal");
        // Directions drawn for the metal alone find the sun of 0.004 sr in one of some hundred samples, and pixels would differ by factors.
        for rgb in all {
            assert_relative(rgb[0], expected, 0.15, "pixel");
        }
    }
}
