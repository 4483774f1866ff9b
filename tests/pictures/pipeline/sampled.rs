//! Light reflected by surfaces at sampled wavelengths, against sums of spectra over wavelengths and directions.
//!
//! The sums are over rows of the published tables, with their own steps: they share nothing with the renderer's sampling, shifts and
//! weights of wavelengths. A lamp of irradiance S(λ) perpendicular to its light, which travels along n in its frame, lights a plane with w
//! = λ_plane/λ_lamp; the plane reflects R(λ) w⁻³ S(λ/w) cos θ/π, seen with W⁻⁵ at λ/W.

use std::f64::consts::PI;
use std::sync::LazyLock;

use glam::DVec3;
use nullray::colour::{Scale, Spectrum, SpectrumShape, colour_matching, rgb_from_xyz};
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::scene::model::{LightKind, Scene, Spectra};

use crate::pipeline::lorentz;
use crate::pipeline::stage::{self, PANEL, assert_relative, mean, planck};

/// Rows of the published basis: white, and the reflectances of red, green and blue, from 360 nm on every 5 nm.
fn basis(wavelength: f64) -> [f64; 4] {
    static ROWS: LazyLock<Vec<[f64; 4]>> = LazyLock::new(|| {
        let rows = include_str!("../../../src/colour/rgb_basis.csv").lines();
        let row = |line: &str| {
            let numbers: Vec<f64> = line.split(',').map(|n| n.parse().unwrap()).collect();
            [numbers[1], numbers[2], numbers[3], numbers[4]]
        };
        rows.skip(1).map(row).collect()
    });
    let rows = &*ROWS;
    let at = ((wavelength * 1e9 - 360.0) / 5.0).clamp(0.0, rows.len() as f64 - 1.0);
    let first = (at as usize).min(rows.len() - 2);
    let rest = at - first as f64;
    std::array::from_fn(|k| rows[first][k] + rest * (rows[first + 1][k] - rows[first][k]))
}

/// A table of a function of wavelength every nanometre, for sums over many directions.
struct Tabulated(Vec<f64>);

impl Tabulated {
    fn new(of: impl Fn(f64) -> f64) -> Tabulated {
        Tabulated((0..4000).map(|nm| of(f64::from(nm) * 1e-9)).collect())
    }

    fn at(&self, wavelength: f64) -> f64 {
        let at = (wavelength * 1e9).clamp(0.0, 3998.0);
        let first = at as usize;
        self.0[first] + (at - first as f64) * (self.0[first + 1] - self.0[first])
    }
}

/// The reflectance of a linear RGB colour.
fn reflectance(colour: [f64; 3]) -> Tabulated {
    Tabulated::new(|l| {
        let [_, r, g, b] = basis(l);
        colour[0] * r + colour[1] * g + colour[2] * b
    })
}

/// The linear RGB of a colour, as light: a white that is a blackbody of 6504 K beyond what the eye sees.
fn light(colour: [f64; 3]) -> Tabulated {
    Tabulated::new(|l| {
        let end = l.clamp(360e-9, 830e-9);
        let [white, r, g, b] = basis(end);
        let beyond = if l == end {
            1.0
        } else {
            planck(l, 6504.0) / planck(end, 6504.0)
        };
        beyond * white * (colour[0] * r + colour[1] * g + colour[2] * b)
    })
}

/// What the eye sees of a spectrum: the sum over 0.5 nm.
fn seen(radiance: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for k in 0..940 {
        let l = (360.25 + 0.5 * f64::from(k)) * 1e-9;
        let m = colour_matching(l);
        let value = radiance(l) * 0.5e-9;
        (0..3).for_each(|j| xyz[j] += value * m[j]);
    }
    rgb_from_xyz(xyz)
}

/// What it sees of a line.
fn line(wavelength: f64, radiance: f64) -> [f64; 3] {
    rgb_from_xyz(colour_matching(wavelength).map(|m| m * radiance))
}

fn sum(a: [f64; 3], b: [f64; 3], factor: f64) -> [f64; 3] {
    std::array::from_fn(|c| a[c] + factor * b[c])
}

fn rendered(scene: &Scene) -> Film {
    stage::rendered(scene, &stage::sampled()).unwrap()
}

/// Asserts that two colours differ by at most this part of the larger one's largest component.
#[track_caller]
fn assert_close(got: [f64; 3], expected: [f64; 3], tolerance: f64, what: &str) {
    let size = expected.iter().fold(0.0f64, |a, c| a.max(c.abs()));
    assert!(size > 0.0, "{what}: dark");
    for c in 0..3 {
        let error = (got[c] - expected[c]).abs() / size;
        assert!(
            error <= tolerance,
            "{what}: {got:?} is not {expected:?} ({error:.1e})"
        );
    }
}

/// A coloured plane that moves at 0.5 c, under parallel light of a lamp that moves, too, seen by a camera that moves or not.
fn plane(camera: f64, lamp: f64, finish: &str) -> Scene {
    stage::scene(&format!(
        "
render = {{ spectra = \"sampled\" }}
radiance.quantity = \"rgb\"
[camera]
eye = [0, 3, 4]
look_at = [0, 0, 0]
hfov = \"0.5 deg\"
size = [6, 4]
velocity = {{ beta = [0, 0, {camera}] }}
[[object]]
name = \"plane\"
shape = {{ plane = {{ size = [400, 400] }} }}
{finish}
velocity = {{ beta = [0.5, 0, 0] }}
[[light]]
type = \"directional\"
direction = [0.6, -0.8, 0]
irradiance = 2
shadows = false
velocity = {{ beta = [0, 0, {lamp}] }}
[display]
samples_per_pixel = 256"
    ))
}

const COLOUR: [f64; 3] = [0.8, 0.45, 0.15];

/// λ_plane/λ_lamp, and the cosine at which the light falls.
fn falls(lamp: f64) -> (f64, f64) {
    let n = DVec3::new(0.6, -0.8, 0.0);
    // From the lamp's frame to the world, and on to the plane's.
    let gamma = 1.0 / (1.0 - lamp * lamp).sqrt();
    let omega = gamma * (1.0 + lamp * n.z);
    let in_world = DVec3::new(n.x, n.y, gamma * (n.z + lamp)) / omega;
    let g = 1.0 / (1.0f64 - 0.25).sqrt();
    let omega_plane = omega * g * (1.0 - 0.5 * in_world.x);
    let in_plane = DVec3::new(g * (in_world.x - 0.5), in_world.y, in_world.z).normalize();
    (1.0 / omega_plane, -in_plane.y)
}

#[track_caller]
fn give(scene: &mut Scene, spectrum: Spectrum) {
    match &mut scene.lights[0].kind {
        LightKind::Lamp(lamp) => lamp.spectrum = Some(spectrum),
        LightKind::Area { .. } => panic!("no lamp"),
    }
}

/// Compares what is seen with `expected` of each pixel's W, pixel by pixel and over all.
#[track_caller]
fn check(scene: &Scene, expected: impl Fn(f64) -> [f64; 3], tolerances: [f64; 2], what: &str) {
    let film = rendered(scene);
    let met = stage::met(&film);
    assert_eq!(met.len(), 24, "{what}");
    let mut all = [0.0; 3];
    for i in &met {
        let w = stage::value(&film, Aov::WavelengthRatio, *i);
        let expected = expected(w);
        assert_close(film.radiance()[*i], expected, tolerances[0], what);
        all = sum(all, expected, 1.0 / met.len() as f64);
    }
    assert_close(mean(&film, &met), all, tolerances[1], what);
}

/// The speeds of camera and lamp, of which one or both move against the plane.
const SPEEDS: [[f64; 2]; 4] = [[0.0, 0.0], [-0.5, 0.0], [0.0, 0.5], [0.5, -0.5]];

#[test]
fn a_sodium_lamp_on_planes_that_move_is_seen_at_the_wavelength_at_which_it_comes_back() {
    let reflects = reflectance(COLOUR);
    let lines = vec![[589e-9, 3.0], [400e-9, 0.5]];
    for [camera, lamp] in SPEEDS {
        let mut scene = plane(camera, lamp, &format!("colour = {COLOUR:?}"));
        let sodium = SpectrumShape::Lines(lines.clone());
        give(
            &mut scene,
            Spectrum::new(sodium, Scale::Factor(1.0)).unwrap(),
        );
        let (w, cosine) = falls(lamp);
        let expected = |ratio: f64| {
            lines.iter().fold([0.0; 3], |all, [at_rest, energy]| {
                let there = at_rest * w;
                let irradiance = 2.0 * energy * cosine / (w * w);
                let leaves = reflects.at(there) * irradiance / PI;
                sum(all, line(there * ratio, leaves / ratio.powi(4)), 1.0)
            })
        };
        // There is no noise: what is left is that of W over a pixel, and of tables.
        check(
            &scene,
            expected,
            [1e-3, 1e-3],
            &format!("lines, {camera} {lamp}"),
        );
    }
}

#[test]
fn a_metal_reflects_a_line_by_its_colour_there() {
    // F = c + (1 − c)(1 − v·h)⁵ is linear in c: between those of colours 0 and 1.
    let reflects = reflectance(COLOUR);
    for [camera, lamp] in SPEEDS {
        let film = |colour: [f64; 3]| {
            let finish = format!("colour = {colour:?}\nmetallic = 1\nroughness = 0.5");
            let mut scene = plane(camera, lamp, &finish);
            let line = SpectrumShape::Lines(vec![[420e-9, 3.0]]);
            give(&mut scene, Spectrum::new(line, Scale::Factor(1.0)).unwrap());
            rendered(&scene)
        };
        let [black, white, coloured] = [[0.0; 3], [1.0; 3], COLOUR].map(film);
        let c = reflects.at(420e-9 * falls(lamp).0);
        for i in 0..24 {
            let [black, white, coloured] = [&black, &white, &coloured].map(|f| f.radiance()[i]);
            let expected = std::array::from_fn(|k| black[k] + c * (white[k] - black[k]));
            assert_close(coloured, expected, 1e-4, &format!("metal, {camera} {lamp}"));
        }
    }
}

#[test]
fn blackbodies_tables_and_colours_on_planes_that_move_are_products_of_spectra() {
    let reflects = reflectance(COLOUR);
    let rows: Vec<[f64; 2]> = vec![
        [380e-9, 0.0],
        [430e-9, 4.0],
        [470e-9, 0.5],
        [610e-9, 3.0],
        [900e-9, 0.0],
    ];
    let table = {
        let rows = rows.clone();
        Tabulated::new(move |l| {
            let after = rows.partition_point(|row| row[0] <= l);
            match (after.checked_sub(1).map(|k| rows[k]), rows.get(after)) {
                (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (l - a[0]) / (b[0] - a[0]),
                _ => 0.0,
            }
        })
    };
    let green = [0.1, 0.9, 0.2];
    let lights = [
        (
            Some(SpectrumShape::Blackbody(2800.0)),
            Tabulated::new(|l| planck(l.max(1e-9), 2800.0)),
        ),
        (Some(SpectrumShape::Table(rows)), table),
        (None, light(green)),
    ];
    for (number, (shape, source)) in lights.into_iter().enumerate() {
        for [camera, lamp] in SPEEDS {
            let mut scene = plane(camera, lamp, &format!("colour = {COLOUR:?}"));
            match &shape {
                Some(shape) => give(
                    &mut scene,
                    Spectrum::new(shape.clone(), Scale::Factor(1.0)).unwrap(),
                ),
                None => match &mut scene.lights[0].kind {
                    LightKind::Lamp(lamp) => lamp.intensity = green.map(|c| 2.0 * c),
                    LightKind::Area { .. } => panic!("no lamp"),
                },
            }
            let (w, cosine) = falls(lamp);
            let expected = |ratio: f64| {
                seen(|l| {
                    let there = l / ratio;
                    let irradiance = 2.0 * source.at(there / w) * cosine / w.powi(3);
                    reflects.at(there) * irradiance / PI / ratio.powi(5)
                })
            };
            let what = format!("light {number}, {camera} {lamp}");
            // At the end of a table's range few wavelengths meet it.
            check(&scene, expected, [2e-2, 3e-3], &what);
            // By red, green and blue it is another colour.
            if number == 1 && lamp != 0.0 {
                let mut coarse = scene.clone();
                coarse.spectra = Spectra::Rgb;
                let [got, other] = [&scene, &coarse].map(|s| mean(&rendered(s), &[8, 9, 10]));
                let size = got.iter().fold(0.0f64, |a, c| a.max(c.abs()));
                assert!(
                    (0..3).any(|c| (got[c] - other[c]).abs() > 0.03 * size),
                    "{got:?} {other:?}"
                );
            }
        }
    }
}

/// A wide ceiling above a wide floor, which slides past it along x at `beta`.
fn between(beta: f64, bounces: u32, more: &str) -> Scene {
    stage::scene(&format!(
        "
render = {{ spectra = \"sampled\", bounces = {bounces} }}
radiance.quantity = \"rgb\"
[camera]
eye = [0, 0.5, 0]
look_at = [0.02, 0, 0]
up = [1, 0, 0]
hfov = \"20 deg\"
size = [12, 9]
[[object]]
name = \"floor\"
shape = {{ plane = {{ size = [4000, 4000] }} }}
colour = {COLOUR:?}
[[object]]
name = \"ceiling\"
shape = {{ box = {{ size = [4000, 0.1, 4000] }} }}
transform = {{ translate = [0, 1.05, 0] }}
velocity = {{ beta = [{beta}, 0, 0] }}
{more}
[display]
samples_per_pixel = 1024"
    ))
}

/// The sum over directions that a floor looks along, with n·d dω and the x of each: d in its rest frame.
fn over_directions(mut each: impl FnMut(f64, f64)) {
    let (rings, sectors) = (200, 200);
    for ring in 0..rings {
        // sin² θ is uniform for directions by the cosine.
        let sine = ((f64::from(ring) + 0.5) / f64::from(rings)).sqrt();
        for sector in 0..sectors {
            let angle = 2.0 * PI * (f64::from(sector) + 0.5) / f64::from(sectors);
            each(sine * angle.cos(), PI / f64::from(rings * sectors));
        }
    }
}

#[test]
fn a_body_that_shines_lights_one_that_moves_against_it_by_its_spectrum() {
    let beta = 0.5;
    let gamma = 1.0 / (1.0f64 - beta * beta).sqrt();
    let reflects = reflectance(COLOUR);
    for shape in ["line = \"560 nm\"", "blackbody = \"2800 K\""] {
        // Found by rays that go on, and drawn as a light, too.
        for light in [
            "[sky]\nradiance = 0\n",
            "[[light]]\ntype = \"area\"\nobject = \"ceiling\"\nradiance = 1\n",
        ] {
            let more = format!("spectrum = {{ {shape}, luminance = 1 }}\n{light}");
            let scene = between(beta, 1, &more);
            let spectrum = scene.objects[1].spectrum.clone().unwrap();
            let film = rendered(&scene);
            let met = stage::met(&film);
            assert_eq!(met, stage::met_of(&film, 0));
            let mut expected = [0.0; 3];
            match spectrum.shape() {
                SpectrumShape::Lines(lines) => over_directions(|x, part| {
                    let w = gamma * (1.0 + beta * x);
                    let (l, energy) = (lines[0][0] * w, lines[0][1] * spectrum.factor());
                    let leaves = reflects.at(l) / PI * energy / w.powi(4);
                    expected = sum(expected, line(l, leaves), part);
                }),
                _ => {
                    let factor = spectrum.factor();
                    expected = seen(|l| {
                        let mut all = 0.0;
                        // W alone matters: the same directions, with fewer of them.
                        for k in 0..600 {
                            let x = -1.0 + (f64::from(k) + 0.5) / 300.0;
                            let w = gamma * (1.0 + beta * x);
                            // ∫ n·d dω over all directions of this x: 2 √(1 − x²) dx.
                            let part = 2.0 * (1.0 - x * x).sqrt() / 300.0;
                            all += part * factor * planck(l / w, 2800.0) / w.powi(5);
                        }
                        all * reflects.at(l) / PI
                    });
                }
            }
            let got = mean(&film, &met);
            assert_close(got, expected, 0.01, &format!("{shape} {light}"));
        }
    }
}

#[test]
fn a_line_that_two_bodies_reflect_that_move_against_each_other_shifts_between_them() {
    // A lamp that nothing shadows lights the floor, the floor the ceiling, which the camera sees from below.
    let beta = 0.5;
    let gamma = 1.0 / (1.0f64 - beta * beta).sqrt();
    let more = "colour = [0.2, 0.6, 0.9]\n[[light]]\ntype = \"directional\"\ndirection = [0, -1, 0]\nirradiance = 2\n\
                shadows = false\nspectrum = { line = \"560 nm\" }\n";
    let mut scene = between(beta, 1, more);
    // Looking up.
    scene.camera.axes[1] = -scene.camera.axes[1];
    scene.camera.axes[2] = -scene.camera.axes[2];
    let film = rendered(&scene);
    let met = stage::met(&film);
    assert_eq!(met, stage::met_of(&film, 1));
    let spectrum = match &scene.lights[0].kind {
        LightKind::Lamp(lamp) => lamp.spectrum.clone().unwrap(),
        LightKind::Area { .. } => panic!("no lamp"),
    };
    let SpectrumShape::Lines(lines) = spectrum.shape() else {
        panic!("no line")
    };
    let energy = lines[0][1] * spectrum.factor();
    let (floor, ceiling) = (reflectance(COLOUR), reflectance([0.2, 0.6, 0.9]));
    let leaves_floor = floor.at(560e-9) / PI * 2.0 * energy;
    let mut expected = [0.0; 3];
    for i in &met {
        let seen_at = stage::value(&film, Aov::WavelengthRatio, *i);
        let mut one = [0.0; 3];
        over_directions(|x, part| {
            // The floor moves at −β in the ceiling's frame.
            let w = gamma * (1.0 - beta * x);
            let l = 560e-9 * w;
            let leaves = ceiling.at(l) / PI * leaves_floor / w.powi(4);
            one = sum(one, line(l * seen_at, leaves / seen_at.powi(4)), part);
        });
        expected = sum(expected, one, 1.0 / met.len() as f64);
    }
    assert_close(mean(&film, &met), expected, 0.01, "two bodies");
}

/// A room of coloured matte, glossy and glassy bodies, one of which moves, with a lamp and a shining panel of this spectrum.
fn room(spectrum: &str, more: &str) -> Scene {
    let room = stage::room([0.2, 0.0, 0.0], "[0.8, 0.5, 0.2]");
    let ball = stage::ball_at("ball", -0.8);
    stage::scene(&format!(
        "
{more}
radiance.quantity = \"rgb\"
{room}
[[object]]
name = \"wall\"
shape = {{ box = {{ size = [9, 5, 0.1] }} }}
transform = {{ translate = [0, 2, -2] }}
colour = [0.2, 0.7, 0.4]
metallic = 0
roughness = 0.5
{ball}
colour = [0.9, 0.6, 0.3]
metallic = 1
roughness = 0.3
velocity = {{ beta = [0.4, 0, 0] }}
[[object]]
name = \"glass\"
shape = {{ sphere = {{ radius = 0.5, subdivisions = 3 }} }}
colour = [0.9, 1, 0.8]
transmission = 1
roughness = 0
transform = {{ translate = [1.4, 0.6, 1] }}
{PANEL}
velocity = {{ beta = [-0.3, 0, 0] }}
{spectrum}
[[light]]
type = \"area\"
object = \"panel\"
radiance = 2
[[light]]
position = [2, 3, 2]
intensity = 6
{spectrum}
"
    ))
}

#[test]
fn lines_are_narrow_spectra_along_all_paths() {
    // A Gaussian of σ = 6 nm, which is sampled, and a line, which is followed: one light, but for the 1 % that the eye makes of
    // the width, and noise: few samples meet the Gaussian, and few of those the highlights of the metal.
    let of = |shape: &str| {
        let text = format!("spectrum = {{ {shape}, total = 1e-2 }}");
        let more = "render = { spectra = \"sampled\", bounces = 4 }";
        let mut scene = room(&text, more);
        scene.samples_per_pixel = 4096;
        scene
    };
    let [line, gaussian] = [
        "line = \"560 nm\"",
        "gaussian = { centre = \"560 nm\", sigma = \"6 nm\" }",
    ]
    .map(|shape| rendered(&of(shape)));
    for (object, tolerance) in [(0, 0.015), (1, 0.025), (2, 0.06), (3, 0.05)] {
        let pixels = stage::met_of(&line, object);
        assert!(!pixels.is_empty(), "{object}");
        let [a, b] = [&line, &gaussian].map(|film| mean(film, &pixels));
        assert_close(b, a, tolerance, &format!("object {object}"));
    }
}

#[test]
fn white_light_at_rest_is_reflected_as_colours_are() {
    // All that reflects and shines is at rest, and white; the camera is not.
    let (ball, glaze) = (stage::ball_at("ball", -0.8), stage::ball_at("glaze", 0.9));
    let text = |spectra: &str, light: &str, bounces: u32, colour: &str, samples: u32| {
        let room = stage::room([0.0, 0.0, -0.5], colour);
        stage::scene(&format!(
            "
render = {{ spectra = \"{spectra}\", bounces = {bounces} }}
radiance.quantity = \"rgb\"
{room}
{ball}
colour = {colour}
metallic = 1
roughness = 0.7
{glaze}
colour = {colour}
roughness = 0.7
{PANEL}
{light}
[display]
samples_per_pixel = {samples}"
        ))
    };
    let lamp = "[[light]]\nposition = [2, 3, 2]\nintensity = 6\n";
    let panel = "[[light]]\ntype = \"area\"\nobject = \"panel\"\nradiance = 2\n";
    let sky = "[sky]\nradiance = 0.7\nsun = { direction = [1, 2, 1], irradiance = 1 }\n";
    let (coloured, grey) = ("[0.9, 0.4, 0.1]", "[0.6, 0.6, 0.6]");
    // What is left is noise, most so of gloss, which few points of a panel light: of balls about 5 % of either picture at 1024 samples.
    for (light, bounces, colour, samples, tolerances) in [
        (lamp, 0, coloured, 1024, [1e-3, 2e-2]),
        (panel, 0, coloured, 8192, [5e-3, 4e-2]),
        (sky, 0, coloured, 1024, [2e-3, 1e-2]),
        // Of products of albedos those of spectra are those of colours where they are grey.
        (panel, 2, grey, 4096, [1e-2, 4e-2]),
        (sky, 2, grey, 1024, [3e-3, 2e-2]),
    ] {
        let [rgb, sampled] =
            ["rgb", "sampled"].map(|s| rendered(&text(s, light, bounces, colour, samples)));
        for object in 0..3 {
            let pixels = stage::met_of(&rgb, object);
            assert!(pixels.len() > 4, "{object}");
            let [a, b] = [&rgb, &sampled].map(|film| mean(film, &pixels));
            let tolerance = tolerances[usize::from(object > 0)];
            let what = format!("{light} {bounces} object {object}");
            assert_close(b, a, tolerance, &what);
        }
    }
}

#[test]
fn emissive_surfaces_are_seen_without_noise() {
    // A black panel, seen by a camera that approaches: by tables, as where nothing is sampled.
    for bounces in [0, 1] {
        let film = |spectra: &str| {
            rendered(&stage::scene(&format!(
                "
render = {{ spectra = \"{spectra}\", bounces = {bounces} }}
radiance.quantity = \"rgb\"
[camera]
eye = [0, 0, 5]
look_at = [0, 0, 0]
hfov = \"20 deg\"
size = [4, 3]
velocity = {{ beta = [0, 0, -0.5] }}
[[object]]
name = \"panel\"
shape = {{ box = {{ size = [9, 9, 1] }} }}
colour = [0, 0, 0]
[[light]]
type = \"area\"
object = \"panel\"
radiance = [3, 2, 1]
[display]
samples_per_pixel = 4"
            )))
        };
        let [rgb, sampled] = ["rgb", "sampled"].map(film);
        for (a, b) in rgb.radiance().iter().zip(sampled.radiance()) {
            assert!(a[2] > 1.0);
            (0..3).for_each(|c| assert_relative(b[c], a[c], 1e-12, bounces));
        }
    }
}

#[test]
fn a_grey_body_under_a_grey_sky_is_grey_at_any_speed() {
    // The camera at 0.9 c: the body has half of the sky's radiance, wherever it looks. Then the body at 0.9 c: the sum over the sky.
    let (albedo, beta) = (0.5, 0.9);
    let gamma = 1.0 / (1.0f64 - beta * beta).sqrt();
    let white = light([1.0; 3]);
    for (camera, body) in [(beta, 0.0), (0.0, beta)] {
        for bounces in [0, 1] {
            let scene = stage::scene(&format!(
                "
render = {{ spectra = \"sampled\", bounces = {bounces} }}
radiance.quantity = \"rgb\"
[camera]
eye = [0, 3, 0.5]
look_at = [0, 0, 0]
hfov = \"4 deg\"
size = [6, 4]
velocity = {{ beta = [{camera}, 0, 0] }}
[[object]]
name = \"body\"
shape = {{ plane = {{ size = [4000, 4000] }} }}
colour = [{albedo}, {albedo}, {albedo}]
velocity = {{ beta = [{body}, 0, 0] }}
[sky]
radiance = 1
[display]
samples_per_pixel = 4096"
            ));
            let film = rendered(&scene);
            let met = stage::met(&film);
            assert_eq!(met.len(), 24);
            // What leaves the body at λ in its frame.
            let leaves = Tabulated::new(|l| {
                let mut all = 0.0;
                for k in 0..1000 {
                    let x = -1.0 + (f64::from(k) + 0.5) / 500.0;
                    // Light from ahead is shifted to blue.
                    let w = if body > 0.0 {
                        gamma * (1.0 - beta * x)
                    } else {
                        1.0
                    };
                    let part = 2.0 * (1.0 - x * x).sqrt() / 500.0;
                    all += part * white.at((l / w).max(2e-9)) / w.powi(5);
                }
                albedo * all / PI
            });
            let mut expected = [0.0; 3];
            for i in &met {
                let ratio = stage::value(&film, Aov::WavelengthRatio, *i);
                let one = seen(|l| leaves.at(l / ratio) / ratio.powi(5));
                expected = sum(expected, one, 1.0 / met.len() as f64);
            }
            let what = format!("{camera} {body} {bounces}");
            // What lies ahead is 1000 times as bright as what is across, and is met by a ray in some hundred.
            assert_close(mean(&film, &met), expected, 0.03, &what);
        }
    }
}

#[test]
fn boosting_everything_changes_rounding_only_of_sampled_spectra() {
    let line = "spectrum = { line = \"589 nm\" }";
    let scene = room(line, "render = { spectra = \"sampled\", bounces = 3 }");
    let boosted = lorentz::boosted(&scene, DVec3::X * f64::atanh(0.7));
    let (a, b) = (stage::film(&scene), stage::film(&boosted));
    let both = a.radiance().iter().zip(b.radiance());
    let same =
        both.filter(|(a, b)| (0..3).all(|c| (a[c] - b[c]).abs() <= 1e-8 * (a[c].abs() + 1e-3)));
    let (same, all) = (same.count(), stage::pixels(&a));
    assert!(same * 100 >= all * 98, "{same} of {all}");
    assert!(mean(&a, &stage::met(&a))[1] > 1e-3);
}

#[test]
fn sampled_spectra_are_the_same_on_any_number_of_threads() {
    let line = "spectrum = { line = \"589 nm\" }";
    let more = "render = { spectra = \"sampled\", bounces = 2 }";
    let mut scene = room(line, more);
    scene.camera.size = [40, 30];
    let [one, four] = [1, 4].map(|threads| stage::on(threads, || rendered(&scene)));
    assert_eq!(stage::bits(&one), stage::bits(&four));
}

#[test]
fn scenes_that_cannot_be_sampled_spectrally_are_refused() {
    let base = |more: &str| {
        format!(
            "
render.spectra = \"sampled\"
[camera]
eye = [0, 1, 5]
look_at = [0, 0, 0]
hfov = \"50 deg\"
size = [4, 3]
[[object]]
name = \"plane\"
shape = {{ plane = {{ size = [4, 4] }} }}
{more}"
        )
    };
    let parse = |more: &str| {
        let overrides = nullray::scene::Overrides::default();
        nullray::scene::parse(&base(more), "test", std::path::Path::new("."), &overrides)
    };
    let lamp = "[[light]]\nposition = [0, 3, 0]\nemission = { gaussian = { sigma = \"1 m\" } }\n";
    let rgb = "[radiance]\nquantity = \"rgb\"\n";
    for (more, words) in [
        (lamp.to_string(), "of this quantity"),
        (
            format!("{lamp}{rgb}[effects]\ndoppler = false"),
            "these do not",
        ),
        (
            format!("{rgb}[sky]\nstars = {{ count = 5 }}"),
            "stars light surfaces",
        ),
        (
            format!(
                "{rgb}[[source]]\npulse = {{ position = [0, 1, 0], sigma = \"1 m\" }}\nradiance.quantity = \"integrated\""
            ),
            "those of source",
        ),
    ] {
        let error = parse(&more).unwrap_err().to_string();
        assert!(error.contains(words), "{more}: {error}");
    }
    let scene = parse(&format!("{lamp}{rgb}")).unwrap();
    let baked = nullray::render::bake::check(&scene)
        .unwrap_err()
        .to_string();
    assert!(baked.contains("spectra"), "{baked}");
    let raster: nullray::approximate::raster::Method = "raster:none".parse().unwrap();
    let refused = raster
        .plan(&scene, &Request::default())
        .unwrap_err()
        .to_string();
    assert!(refused.contains("wavelengths"), "{refused}");
    // A program may change the scene.
    let mut changed = scene;
    changed.effects.doppler = false;
    let error = Plan::new(&changed, &Request::default()).unwrap_err();
    assert!(error.to_string().contains("these do not"), "{error}");
}
